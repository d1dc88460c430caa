//! One branch of a material: conversion of `[curve]` or `[compression]` to a checked engineering table.

use std::ops::Range;

use super::csv::{self, CsvTable};
use super::curve::above_modulus;
use super::formula::{self, RawCurve, RawTabulate};
use super::keys::Keys;
use super::raw::RawMaterial;
use super::row::TableRow;
use super::tabulate::{check_true_strains, elastic_error};
use super::{Beyond, Curve, CurveError, Law, Measure, Sense, Tabulate, Tabulated, tabulate_law, tabulate_true_rows};
use crate::error::{Error, InputError, Result};
use crate::input::Allowed;
use crate::typed::Placed;
use crate::units::Dimension;

/// Units whose numbers are often given without the unit and then read as Pa, with their size, Pa.
const SLIPS: [(f64, &str); 5] = [(1e3, "kPa"), (6.894_757e3, "psi"), (1e6, "MPa"), (6.894_757e6, "ksi"), (1e9, "GPa")];

/// A checked branch.
#[derive(Debug)]
pub(super) struct Branch {
    pub(super) curve: Curve,
    /// Largest stress difference from the law or the rows that the curve was made from, Pa.
    pub(super) error: f64,
}

/// A curve as given in the file, in its own measure.
#[derive(Debug)]
pub(super) struct Given<'a> {
    name: &'static str,
    pub(super) measure: Measure,
    pub(super) sense: Sense,
    beyond: Beyond,
    how: Tabulate,
    /// Whether the unit of its stresses is given.
    has_unit: bool,
    data: Data<'a>,
}

/// Source of the numbers, with what is needed to point error messages at them.
#[derive(Debug)]
enum Data<'a> {
    Law(Law, Range<usize>),
    Table(Vec<(f64, f64)>, &'a [TableRow]),
    Csv(CsvTable),
}

impl<'a> Given<'a> {
    /// Reads the branch under the key `name`. Its numbers are checked individually, not yet as a curve.
    pub(super) fn read(
        name: &'static str,
        material: &'a RawMaterial,
        raw: &'a Placed<RawCurve>,
        keys: Keys<'_>,
    ) -> Result<Self> {
        let curve = raw.get_ref();
        let measure = one_of("measure", material.measure.as_ref(), curve.measure.as_ref(), name, keys)?;
        let beyond = one_of("beyond", material.beyond.as_ref(), curve.beyond.as_ref(), name, keys)?;
        let sense = if name == "compression" {
            sense_of_compression(curve, keys)?
        } else {
            one_of("sense", material.sense.as_ref(), curve.sense.as_ref(), name, keys)?.unwrap_or(Sense::Tension)
        };
        Ok(Self {
            name,
            measure: measure.unwrap_or_default(),
            sense,
            beyond: beyond.unwrap_or(Beyond::Error),
            how: tabulate(curve.tabulate.as_ref(), sense, keys)?,
            has_unit: curve.unit.is_some(),
            data: Data::read(raw, name, keys)?,
        })
    }

    /// Returns the law as one line; `None` for a table.
    pub(super) fn describe(&self) -> Option<String> {
        let Data::Law(law, _) = &self.data else { return None };
        let measure = match self.measure {
            Measure::Engineering => "engineering",
            Measure::True => "true",
        };
        Some(format!("{law} ({measure} stress and strain)"))
    }

    /// Returns the checked engineering table for a sense of loading.
    pub(super) fn branch(&self, sense: Sense, modulus: Option<f64>, keys: Keys<'_>) -> Result<Branch> {
        let table = match &self.data {
            Data::Law(law, span) => self.of_law(law, span, sense, modulus, keys)?,
            Data::Table(rows, _) => self.of_rows(rows, sense, modulus, keys)?,
            Data::Csv(file) => self.of_rows(&file.rows, sense, modulus, keys)?,
        };
        let mut curve = Curve::new(&table.rows, self.beyond).map_err(|e| self.row_error(&e, keys))?;
        if self.is_engineering_table() {
            let modulus = modulus.unwrap_or_else(|| curve.steepest());
            curve = curve.on_elastic_line(modulus);
        }
        if let Some(modulus) = modulus {
            self.check_slopes(&curve, modulus, keys)?;
            self.check_unit(&curve, modulus, keys)?;
        }
        Ok(Branch { curve, error: table.error })
    }

    fn of_law(
        &self,
        law: &Law,
        span: &Range<usize>,
        sense: Sense,
        modulus: Option<f64>,
        keys: Keys<'_>,
    ) -> Result<Tabulated> {
        let Some(modulus) = modulus else {
            let error = keys.error(span.clone(), "modulus", "a formula needs the elastic modulus");
            return Err(error.help("add e.g. modulus = \"200 GPa\"").into());
        };
        let mut table = tabulate_law(law, modulus, self.measure, sense, self.how)
            .map_err(|error| keys.error(span.clone(), &format!("{}.formula", self.name), error.message))
            .map_err(|e| e.help("increase `tabulate.to-strain`, or check the constants"))?;
        table.error += elastic_error(law, modulus, self.measure, sense, &table.rows);
        Ok(table)
    }

    fn of_rows(&self, rows: &[(f64, f64)], sense: Sense, modulus: Option<f64>, keys: Keys<'_>) -> Result<Tabulated> {
        // The rows are checked as given, before the conversion can hide what is wrong with them.
        Curve::new(rows, self.beyond).map_err(|e| self.row_error(&e, keys))?;
        if self.measure == Measure::Engineering {
            return Ok(Tabulated { rows: rows.to_vec(), error: 0.0 });
        }
        let past_origin = &rows[usize::from(rows[0].0 == 0.0)..];
        check_true_strains(past_origin).map_err(|e| {
            let row = e.row + rows.len() - past_origin.len();
            self.row_error(&CurveError { row, ..e }, keys)
        })?;
        Ok(tabulate_true_rows(past_origin, modulus, sense, self.how.tolerance)?)
    }

    /// Whether the rows as given are those of the curve.
    fn is_engineering_table(&self) -> bool {
        self.measure == Measure::Engineering && !matches!(self.data, Data::Law(..))
    }

    /// Rejects slopes above the modulus.
    fn check_slopes(&self, curve: &Curve, modulus: f64, keys: Keys<'_>) -> Result<()> {
        let Some((knot, slope)) = curve.steeper_than(modulus) else { return Ok(()) };
        let (strain, stress) = (curve.strain()[knot], curve.stress()[knot]);
        let as_given = self.is_engineering_table();
        let row = if as_given { self.row_of_knot(knot) } else { 0 };
        let message = format!(
            "row {}: the slope up to strain {strain:e}, stress {stress:e} Pa is {}",
            if as_given { row + 1 } else { knot },
            above_modulus(slope, modulus)
        );
        let help = "correct the row, or set `modulus` to the steepest slope (the default)";
        Err(self.at_row(row, message, keys).allowed(format!("slopes <= {modulus:e} Pa")).help(help).into())
    }

    /// Rejects a table whose initial slope differs from the modulus by the factor of a wrong unit of stress.
    fn check_unit(&self, curve: &Curve, modulus: f64, keys: Keys<'_>) -> Result<()> {
        let ratio = curve.slopes().next().map_or(1.0, |slope| slope / modulus);
        let Some((_, unit)) = SLIPS.into_iter().find(|(size, _)| (0.4..1.5).contains(&(ratio * size))) else {
            return Ok(());
        };
        if matches!(self.data, Data::Law(..)) {
            return Ok(());
        }
        let slope = format!("the initial slope of the curve is {ratio:.2e} of the modulus {modulus:e} Pa");
        let (message, help) = if self.has_unit {
            (slope, "check the modulus, and the unit of the stresses".to_owned())
        } else {
            let help = format!(
                "set unit = \"{unit}\" in [{}] (in a CSV file: a header `strain,stress_{unit}`), or write stresses with \
                 their unit; and check the modulus",
                self.name
            );
            (format!("{slope}: the stresses seem to be in {unit}, not in Pa"), help)
        };
        let row = self.row_of_knot(1);
        Err(self
            .at_row(row, message, keys)
            .allowed("an initial slope of more than 0.0015 of the modulus")
            .help(help)
            .into())
    }

    /// Returns the row as given, from 0, of a knot of the curve (which may have an added origin).
    fn row_of_knot(&self, knot: usize) -> usize {
        let starts_at_origin = match &self.data {
            Data::Law(..) => false,
            Data::Table(rows, _) => rows.first().is_some_and(|r| r.0 == 0.0),
            Data::Csv(file) => file.rows.first().is_some_and(|r| r.0 == 0.0),
        };
        if starts_at_origin { knot } else { knot - 1 }
    }

    fn row_error(&self, error: &CurveError, keys: Keys<'_>) -> InputError {
        self.at_row(error.row, error.to_string(), keys)
            .allowed(CurveError::ALLOWED)
            .help("rows are [strain, stress] as magnitudes; the first row is (0, 0) or omitted")
    }

    /// Creates an error at a row as given.
    fn at_row(&self, row: usize, message: String, keys: Keys<'_>) -> InputError {
        match &self.data {
            Data::Law(_, span) => keys.error(span.clone(), &format!("{}.formula", self.name), message),
            Data::Table(_, numbers) => {
                let key = format!("{}.table", self.name);
                let of_row = numbers.get(row).map(|TableRow(a, b)| a.span().start..b.span().end);
                // For an empty table, the error points at the table itself.
                let span = of_row.or_else(|| keys.span_of(&key)).unwrap_or(0..0);
                keys.error(span, &key, message)
            }
            Data::Csv(file) => file.error(row, &keys.key(&format!("{}.csv", self.name)), message),
        }
    }
}

impl<'a> Data<'a> {
    fn read(raw: &'a Placed<RawCurve>, name: &str, keys: Keys<'_>) -> Result<Self> {
        let curve = raw.get_ref();
        if curve.formula.is_none() {
            formula::refuse_constants(curve, name, keys)?;
        }
        match (&curve.table, &curve.csv, &curve.formula) {
            (Some(table), None, None) => Ok(Self::Table(table_rows(table, curve, name, keys)?, table)),
            (None, Some(csv), None) => csv_rows(csv, curve, name, keys).map(Self::Csv),
            (None, None, Some(formula)) => {
                if let Some(unit) = &curve.unit {
                    let error = keys.error(unit.span(), &format!("{name}.unit"), "`unit` does not apply to a formula");
                    return Err(error.help("write units with the constants, e.g. K = \"530 MPa\"").into());
                }
                let law = formula::read(formula, curve, name, keys)?;
                Ok(Self::Law(law, formula.span()))
            }
            _ => {
                let error = keys.error(raw.span(), name, "a curve is exactly one of `table`, `csv` and `formula`");
                Err(error.help("e.g. table = [[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]").into())
            }
        }
    }
}

/// Returns the value of a key that is allowed both at the top level of the material and in the curve, but not with different values.
fn one_of<T: Copy + PartialEq>(
    key: &str,
    top: Option<&Placed<T>>,
    inner: Option<&Placed<T>>,
    name: &str,
    keys: Keys<'_>,
) -> Result<Option<T>> {
    if let (Some(top), Some(inner)) = (top, inner)
        && top.get_ref() != inner.get_ref()
    {
        let error =
            keys.error(inner.span(), &format!("{name}.{key}"), format!("`{key}` is given twice with different values"));
        return Err(error.help("give it once").into());
    }
    Ok(inner.or(top).map(|value| *value.get_ref()))
}

fn sense_of_compression(curve: &RawCurve, keys: Keys<'_>) -> Result<Sense> {
    if let Some(sense) = curve.sense.as_ref().filter(|s| *s.get_ref() == Sense::Tension) {
        let error = keys.error(sense.span(), "compression.sense", "the compression branch has sense = \"tension\"");
        return Err(error.help("remove `sense` here").into());
    }
    Ok(Sense::Compression)
}

fn tabulate(raw: Option<&RawTabulate>, sense: Sense, keys: Keys<'_>) -> Result<Tabulate> {
    let farthest = if sense == Sense::Compression { Tabulate::MOST_COMPRESSION } else { 10.0 };
    let range = Allowed::Above(0.0, farthest);
    let raw = raw.cloned().unwrap_or_default();
    let to_strain = raw.to_strain.as_ref().map(|given| given.si_within(keys.doc, range)).transpose()?;
    Ok(Tabulate { tolerance: keys.si(&raw.tolerance)?, to_strain })
}

/// Returns the SI value of the key `unit`.
fn stress_unit(curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<Option<f64>> {
    let Some(unit) = &curve.unit else { return Ok(None) };
    let wrong = |e: InputError| keys.error(unit.span(), &format!("{name}.unit"), e.message).help(e.help);
    csv::factor(unit.get_ref(), Dimension::Stress).map(Some).map_err(|e| wrong(e).into())
}

fn table_rows(table: &[TableRow], curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<Vec<(f64, f64)>> {
    let unit = stress_unit(curve, name, keys)?.unwrap_or(1.0);
    let key = format!("{name}.table");
    let rows = table.iter().enumerate().map(|(row, TableRow(strain, stress))| {
        let strain = keys.number_in_row(strain, (&key, row, "strain"), Dimension::None, Allowed::Finite)?;
        let si = keys.number_in_row(stress, (&key, row, "stress"), Dimension::Stress, Allowed::Finite)?;
        let plain = matches!(stress.get_ref(), crate::units::Quantity::Number(_));
        Ok((strain, if plain { si * unit } else { si }))
    });
    rows.collect()
}

fn csv_rows(csv: &Placed<String>, curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<CsvTable> {
    let unit = stress_unit(curve, name, keys)?;
    csv::read(&keys.base_dir.join(csv.get_ref()), unit).map_err(|e| match e {
        Error::Input(e) if e.place.is_none() => {
            let help = if e.message.contains("no such file") {
                "the path is relative to the folder of this file".into()
            } else {
                e.help
            };
            keys.error(csv.span(), &format!("{name}.csv"), e.message).allowed(e.allowed).help(help).into()
        }
        other => other,
    })
}
