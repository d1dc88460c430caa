//! Initial values of a bar and its segments: constants, and tables over x.

use std::sync::Arc;

use super::super::raw::{Given, INITIAL, RawBar, RawDistribution, RawInitial};
use super::Checker;
use super::csv_history::{Abscissa, MadeOfRows};
use crate::bar::{Bar, Distribution, InitialProfile, Segment};
use crate::error::Result;
use crate::input::Allowed;
use crate::typed::{self, Placed};
use crate::units::{Dimension, System, format};

/// Indices of values in [`INITIAL`].
pub(super) const STRESS: usize = 1;
pub(super) const STRAIN: usize = 2;
pub(super) const PLASTIC: usize = 3;
pub(super) const ACCUMULATED: usize = 4;
pub(super) const TEMPERATURE: usize = 5;

/// Values as functions of x, in the order of [`INITIAL`].
pub(super) type Values = [Option<Distribution>; 6];

/// Relative difference (of the length) up to which positions count as equal.
const SAME_PLACE: f64 = 1e-9;

/// Conditions for the rows of a table over x, and help on how to write them.
const ROWS: &str = "x does not decrease; at most two rows have the same x";
const ROWS_HELP: &str = "sort the rows by x; two rows with the same x are a jump";

const X: Abscissa = Abscissa {
    key: "x",
    what: "a place",
    example: "x [mm]",
    dimension: Dimension::Length,
    names: &["x", "position", "place", "distance", "z"],
    of_more: "write x and the value into a file of their own",
    of_negative: "measure x from the left end of the bar or segment",
};

impl Checker<'_> {
    /// Reads the values given for a piece of the bar of length `length`, m.
    pub(super) fn distributions(&self, typed: &RawInitial<'_>, key: &str, length: f64) -> Result<Values> {
        let mut values: Values = std::array::from_fn(|_| None);
        for (value, (given, name)) in values.iter_mut().zip(typed.iter().zip(INITIAL)) {
            let read = |given| self.distribution(given, &format!("{key}.{name}"), name, length);
            *value = given.as_ref().map(read).transpose()?;
        }
        if let (Some(strain), true) = (&typed[STRAIN], self.torsion) {
            let error = self.error(
                strain.span.clone(),
                &format!("{key}.strain"),
                "an initial strain is not available in torsion",
            );
            return Err(error.help("give `stress`, the shear stress of the surface").into());
        }
        if let (Some(_), Some(strain)) = (&typed[STRESS], &typed[STRAIN]) {
            let error =
                self.error(strain.span.clone(), &format!("{key}.strain"), "`stress` and `strain` are both given");
            return Err(error.help("keep one: stress = E (strain - plastic strain)").into());
        }
        Ok(values)
    }

    /// Reads the rows [x, value] of a quantity along the bar; `name` is the name of the value in messages.
    pub(super) fn rows(&self, given: &Given<'_>, key: &str, name: &str) -> Result<Vec<(f64, f64)>> {
        let dimensions = [Dimension::Length, given.dimension(self.torsion)];
        typed::pairs(given.rows(), self.document, key, ["x", name], (dimensions, given.allowed))
    }

    fn distribution(&self, given: &Given<'_>, key: &str, name: &str, length: f64) -> Result<Distribution> {
        let (dimension, allowed) = (given.dimension(self.torsion), given.allowed);
        if let Some(value) = given.uniform() {
            return self.document.number_at(&value, dimension, allowed).map(Distribution::constant);
        }
        if let RawDistribution::Csv(file) = given.value {
            let make = |rows: &[(f64, f64)]| table(rows, length, allowed);
            let place = (file.csv.get_ref().as_str(), file.csv.span(), key);
            return self.csv_rows(place, &X, dimension, make, [ROWS, ROWS_HELP]);
        }
        let pairs = self.rows(given, key, name)?;
        table(&pairs, length, allowed).map_err(|(i, why)| {
            let span = given.rows().get(i).map_or_else(|| given.span.clone(), Placed::span);
            let what = if pairs.is_empty() { why.to_owned() } else { format!("row {} {why}", i + 1) };
            let end = format(length, Dimension::Length, System::Si);
            let error = self.error(span, &format!("{key}.{i}"), what);
            error.allowed(format!("0 <= x <= {end}; {ROWS}")).help(ROWS_HELP).into()
        })
    }

    /// Sets the initial states of the segments from their own values and from the tables over the `whole` bar, of which each segment takes its part.
    pub(super) fn start_with(&self, raw: &RawBar, bar: &mut Bar, own: &[Values], whole: &Values) -> Result<()> {
        let mut x0 = 0.0;
        for (k, (segment, own)) in bar.segments.iter_mut().zip(own).enumerate() {
            let end = x0 + segment.length;
            let mut values = own.clone();
            for (which, value) in values.iter_mut().enumerate() {
                let Some(table) = &whole[which] else { continue };
                if value.is_some() {
                    let (key, span) = raw.initial_of(k, which).unwrap_or_default();
                    let message =
                        format!("`{}` is given for this segment and, as a table, for the whole bar", INITIAL[which]);
                    return Err(self.error(span, &key, message).help("keep one of them").into());
                }
                *value = Some(table.part(x0, end));
            }
            self.start_segment(raw, k, segment, values)?;
            x0 = end;
        }
        Ok(())
    }

    fn start_segment(&self, raw: &RawBar, k: usize, segment: &mut Segment, values: Values) -> Result<()> {
        if values.iter().all(Option::is_none) {
            return Ok(());
        }
        let [velocity, stress, strain, plastic, accumulated, temperature] = values;
        let modulus = segment.material.modulus;
        let or_zero = |value: Option<Distribution>| value.unwrap_or_else(|| Distribution::constant(0.0));
        let plastic_strain = or_zero(plastic);
        let of_strain =
            |strain: &Distribution| Distribution::combined([strain, &plastic_strain], |[e, p]| modulus * (e - p));
        let stress = or_zero(stress.or_else(|| strain.as_ref().map(of_strain)));
        let accumulated = accumulated.unwrap_or_else(|| plastic_strain.size());
        let temperature_rise = match temperature {
            Some(temperature) => {
                let Some(reference) = segment.material.constants.heat.reference_temperature else {
                    let (key, span) = raw.initial_of(k, TEMPERATURE).unwrap_or_default();
                    let message = format!("`{}` has no reference temperature", segment.material.name);
                    let help = "add reference-temperature to the material's [heat] table, or remove `temperature`";
                    return Err(self.error(span, &key, message).help(help).into());
                };
                Distribution::combined([&temperature], |[t]| t - reference)
            }
            None => Distribution::constant(0.0),
        };
        let profile =
            InitialProfile { velocity: or_zero(velocity), stress, plastic_strain, accumulated, temperature_rise };
        if profile.is_uniform() {
            (segment.velocity, segment.initial) = (profile.velocity.at(0.0), profile.one_sided_limit(0.0, 1));
            return Ok(());
        }
        segment.velocity = match &segment.taper {
            Some(taper) => taper.mean_of(&profile.velocity),
            None => profile.velocity.mean(0.0, segment.length),
        };
        segment.initial = profile.mean(0.0, segment.length);
        segment.profile = Some(Arc::new(profile));
        Ok(())
    }
}

/// Creates a table over a piece of length `length`, m. An x slightly beyond the end, due to rounding, is moved to the end.
fn table(rows: &[(f64, f64)], length: f64, allowed: Allowed) -> MadeOfRows<Distribution> {
    if let Some(i) = rows.iter().position(|&(x, _)| x > length * (1.0 + SAME_PLACE)) {
        return Err((i, "lies beyond the right end"));
    }
    if let Some(i) = rows.iter().position(|&(_, value)| !allowed.holds(value)) {
        return Err((i, "has a value out of range"));
    }
    let rows: Vec<(f64, f64)> = rows.iter().map(|&(x, value)| (x.min(length), value)).collect();
    Distribution::new(&rows).map_err(|error| (error.at(), error.rule))
}
