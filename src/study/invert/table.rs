//! CSV files with a header that names columns and units: `time_us,g1,g2`, `x (mm);strain (%)`.

use std::path::Path;

use crate::columns::{self, Cell};
use crate::error::{InputError, Result};
use crate::input::Document;
use crate::units::{Dimension, in_heading, split};

/// Named columns of numbers in SI units.
pub(super) struct Table {
    pub(super) document: Document,
    pub(super) names: Vec<String>,
    /// Values of each column.
    pub(super) columns: Vec<Vec<f64>>,
    /// Whether the header gives the unit of each column.
    units: Vec<bool>,
    spans: Vec<std::ops::Range<usize>>,
}

/// Largest strain of a column whose unit is not given. Larger values are probably in percent.
const MOST_WITHOUT_UNIT: f64 = 0.5;

impl Table {
    /// Reads a file. `dimension` returns the dimension of a column from its index and name.
    ///
    /// # Errors
    /// A missing file or header, an unknown unit, a cell that is not a finite number.
    pub(super) fn read(path: &Path, dimension: impl Fn(usize, &str) -> Dimension) -> Result<Self> {
        let (document, _) = Document::read_record(path)?;
        let mut wide = columns::table(&document)?;
        wide.complete(&document)?;
        let Some(header) = &wide.header else {
            return Err(InputError::new(format!("{}: the columns have no names", path.display()))
                .help("start the file with a line such as time_us,g1,g2")
                .into());
        };
        let named: Vec<Named> = header
            .cells
            .iter()
            .enumerate()
            .map(|(column, cell)| named(&document, cell, wide.unit_below(column), |name| dimension(column, name)))
            .collect::<Result<_>>()?;
        let mut columns = vec![Vec::with_capacity(wide.rows.len()); named.len()];
        for row in &wide.rows {
            for ((cell, column), named) in row.cells.iter().zip(&mut columns).zip(&named) {
                column.push(number(&document, cell, &named.name)? * named.factor);
            }
        }
        let units = named.iter().map(|named| named.unit).collect();
        let names = named.into_iter().map(|named| named.name).collect();
        let spans = wide.rows.into_iter().map(|row| row.span).collect();
        Ok(Self { document, names, columns, units, spans })
    }

    /// Returns the column of the first of these names that exists. Otherwise returns the only column whose name ends with one of them as a word, as
    /// in "plastic strain".
    fn position(&self, names: &[&str]) -> Option<usize> {
        let found = names.iter().find_map(|name| self.names.iter().position(|own| own == name));
        let ends_so = |own: &str| names.iter().any(|name| own.rsplit([' ', '_', '-']).next() == Some(*name));
        let mut ending = (0..self.names.len()).filter(|column| ends_so(&self.names[*column]));
        found.or_else(|| ending.next().filter(|_| ending.next().is_none()))
    }

    /// Creates an error at a row (from 0).
    pub(super) fn error(&self, row: usize, message: impl Into<String>) -> InputError {
        self.error_in(row, "", message)
    }

    /// Creates an error at a row (from 0) of a column.
    pub(super) fn error_in(&self, row: usize, column: &str, message: impl Into<String>) -> InputError {
        self.document.error(self.spans.get(row).cloned().unwrap_or(0..0), column, message)
    }

    /// Returns the column of the first of these names that exists, or an error.
    pub(super) fn needed(&self, names: &[&str]) -> Result<&[f64]> {
        Ok(&self.columns[self.needed_position(names)?])
    }

    fn needed_position(&self, names: &[&str]) -> Result<usize> {
        self.position(names).ok_or_else(|| {
            let message = format!("{}: there is no column `{}`", self.document.file, names[0]);
            InputError::new(message).allowed(format!("columns {}", self.names.join(", "))).help(HEADER).into()
        })
    }

    /// Returns a column of strains, or an error if it does not exist. Strains without a unit that are probably in percent are refused.
    pub(super) fn needed_strains(&self, names: &[&str]) -> Result<&[f64]> {
        let column = self.needed_position(names)?;
        self.plausible_strains(column)?;
        Ok(&self.columns[column])
    }

    /// Refuses strains without a unit that are probably in percent.
    pub(super) fn plausible_strains(&self, column: usize) -> Result<()> {
        let strain = &self.columns[column];
        let largest = (0..strain.len()).max_by(|&a, &b| strain[a].abs().total_cmp(&strain[b].abs()));
        let large = largest.filter(|&row| strain[row].abs() > MOST_WITHOUT_UNIT);
        let Some(row) = large.filter(|_| !self.units[column]) else { return Ok(()) };
        let name = &self.names[column];
        let message = format!("a strain of {}{}", strain[row], self.unit_note(column));
        Err(self
            .error_in(row, name, message)
            .allowed(format!("|strain| <= {MOST_WITHOUT_UNIT} if no unit is given"))
            .help(format!("name the unit in the first line: {name}_% for percent, {name}_ue for microstrain"))
            .into())
    }

    /// Returns whether the header gives the unit of a column.
    pub(super) fn has_unit(&self, column: usize) -> bool {
        self.units[column]
    }

    /// Returns a note for messages on a value whose column has no unit.
    pub(super) fn unit_note(&self, column: usize) -> &'static str {
        if self.units[column] { "" } else { ", as a plain number since the unit is not given" }
    }
}

const HEADER: &str = "name the columns in the first line, with their units: x_mm,strain_%,time_us";

const STRAINS: &str = "write e.g. `incident [ue]` or `strain_%`; a signal in volts has to be converted to strain";

/// Content of a column heading.
struct Named {
    name: String,
    /// Value of the unit in SI units; 1 without a unit.
    factor: f64,
    /// Whether the heading gives a unit.
    unit: bool,
}

/// Returns the name in lower case and the SI factor of a heading such as `time_us`, `Time (us)` or `strain [%]`, or of one with its unit in the line
/// below.
fn named(document: &Document, cell: &Cell, unit_below: &str, dimension: impl Fn(&str) -> Dimension) -> Result<Named> {
    let below = !unit_below.is_empty() && !cell.text.contains(['(', '[']);
    let (name, unit) = if below { (cell.text.as_str(), unit_below) } else { split(&cell.text) };
    let name = name.trim().to_lowercase();
    if unit.is_empty() {
        return Ok(Named { name, factor: 1.0, unit: false });
    }
    let dimension = dimension(&name);
    let wrong = |reason: String| {
        let error = columns::wrong_unit(document, cell, dimension, &reason);
        let of_strain = error.clone().allowed("a unit of strain such as % or ue, or none").help(STRAINS);
        if dimension == Dimension::None { of_strain } else { error }
    };
    let factor = in_heading(unit, dimension).map_err(wrong)?;
    Ok(Named { name, factor, unit: true })
}

fn number(document: &Document, cell: &Cell, name: &str) -> Result<f64> {
    let wrong = || document.error(cell.span.clone(), name, format!("`{}` is not a finite number", cell.text));
    let value: f64 = cell.text.parse().map_err(|_| wrong().help("write plain numbers; units belong in the header"))?;
    if value.is_finite() { Ok(value) } else { Err(wrong().help("remove the row").into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Table> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        std::fs::write(&path, text).expect("a file");
        Table::read(&path, |column, _| if column == 0 { Dimension::Time } else { Dimension::None })
    }

    #[test]
    fn headers_name_columns_and_units() {
        let read = table("Time (us);g_1;strain [%];ax (ue)\n2;0,5;10;1000\n").expect("it is right");
        assert_eq!(read.names, ["time", "g_1", "strain", "ax"]);
        let row: Vec<f64> = read.columns.iter().map(|column| column[0]).collect();
        for (value, expected) in row.iter().zip([2e-6, 0.5, 0.1, 1e-3]) {
            assert!((value / expected - 1.0_f64).abs() < 1e-14, "{row:?}");
        }
        let strains =
            table("time_us;a (\u{2030});b [mstrain];c_\u{b5}\u{3b5};d_1\n1;2;2;2000;0,002\n").expect("it is right");
        assert_eq!(strains.names, ["time", "a", "b", "c", "d_1"]);
        for column in &strains.columns[1..] {
            assert!((column[0] / 2e-3 - 1.0).abs() < 1e-14, "{:?}", strains.columns);
        }
        let below = table("exported;2026\nTime;strain\ns;%\n2;10\n4;20\n").expect("it is right");
        assert_eq!(
            (below.names, below.columns),
            (vec!["time".into(), "strain".into()], vec![vec![2.0, 4.0], vec![0.1, 0.2]])
        );
        for (text, words) in [
            ("1,2\n3,4\n", "have no names"),
            ("time_us,a\n1,x\n", "`x` is not a finite number"),
            ("time (kg),a\n1,2\n", "kg"),
            ("time_us,a\n1,nan\n", "not a finite number"),
            ("time_usec,a\n1,2\n", "unknown unit `usec`"),
            ("time_mm,a\n1,2\n", "`mm` is a length"),
            ("time kN,a\n1,2\n", "`kN` is a force"),
            ("time_us,a_V\n1,2\n", "in the heading `a_V`: unknown unit `V`"),
            ("time_us,a_mV\n1,2\n", "unknown unit `mV`"),
            ("time_us,a_mm\n1,2\n", "`mm` is a length"),
            ("time_us,a MPa\n1,2\n", "`MPa` is a stress"),
        ] {
            let error = table(text).err().unwrap_or_else(|| panic!("{text}")).to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
