//! `barwave compare` of result files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::output;
use crate::destination;
use crate::error::{InputError, Result};
use crate::inputs;
use crate::record::Field;
use crate::record::store::ResultFile;
use crate::report::{self, plot};
use crate::study::compare_results::{Difference, Norms, compare_results};
use crate::units::{Dimension, System, format};

/// Outputs of the comparison.
pub(super) struct Outputs<'a> {
    pub(super) file: Option<&'a Path>,
    pub(super) json: bool,
    pub(super) field: Option<Field>,
}

pub(super) fn run(paths: &[PathBuf], outputs: &Outputs<'_>) -> Result<()> {
    let files = paths.iter().map(|path| ResultFile::open(path)).collect::<Result<Vec<_>>>()?;
    for path in paths {
        inputs::protect(path);
    }
    let differences = compare_results(&files)?;
    if let Some(field) =
        outputs.field.filter(|f| differences.iter().any(|d| d.fields.iter().all(|own| own.field != *f)))
    {
        let known: Vec<&str> = differences.iter().flat_map(|d| d.fields.iter().map(|f| f.field.name())).collect();
        return Err(InputError::new(std::format!("not every result has the field `{}`", field.name()))
            .key("--field")
            .allowed(known.join(", "))
            .help("record it in every scene, or choose another")
            .into());
    }
    match outputs.file {
        Some(path) if output::is_csv(path) => destination::write_whole(path, csv(&differences).as_bytes())?,
        Some(path) => {
            let figure = report::compare_results::figure(&files, &differences, outputs.field)?;
            plot::save(path, "Results side by side", &figure)?;
        }
        None => {}
    }
    if outputs.json {
        return output::json_list(&differences);
    }
    let text: String = differences.iter().map(|difference| text(&paths[0], difference)).collect();
    let written = outputs.file.and_then(output::wrote).map_or_else(String::new, |line| line + "\n");
    output::text_beside([outputs.file], &(text + &written))
}

fn text(first: &Path, difference: &Difference) -> String {
    let show = |value, dimension| format(value, dimension, System::Si);
    let mut text = std::format!("{} against {}\n", difference.file.display(), first.display());
    let [columns, rows] = difference.grid;
    let (x, t) =
        (difference.x_m.map(|x| show(x, Dimension::Length)), difference.time_s.map(|t| show(t, Dimension::Time)));
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "  on {columns} samples from {} to {} and {rows} frames from {} to {}, linearly interpolated",
        x[0], x[1], t[0], t[1]
    );
    for note in &difference.notes {
        let _ = writeln!(text, "  note: {note}");
    }
    let mut rows: Vec<Vec<String>> = Vec::new();
    for f in &difference.fields {
        let at =
            std::format!("{}, {}", show(f.largest.x_m, Dimension::Length), show(f.largest.time_s, Dimension::Time));
        rows.push(row(f.field.name(), f.units, f.norms, at));
    }
    for h in &difference.histories {
        rows.push(row(&std::format!("stress, {}", h.name), "Pa", h.norms, show(h.largest_at_s, Dimension::Time)));
    }
    text + &output::table(&["difference", "unit", "L1", "rel", "L2", "rel", "max", "rel", "largest at"], &rows, 2, true)
}

fn row(name: &str, units: &str, norms: Norms, at: String) -> Vec<String> {
    let mut cells = vec![name.to_owned(), units.to_owned()];
    for norm in [norms.l1, norms.l2, norms.max] {
        cells.push(if norm.value == 0.0 { "0".to_owned() } else { std::format!("{:.3e}", norm.value) });
        cells.push(norm.relative.map_or_else(|| "-".to_owned(), |r| std::format!("{:.2} %", 100.0 * r)));
    }
    // If nothing differs, there is no position of the largest difference.
    cells.push(if norms.max.value == 0.0 { "-".to_owned() } else { at });
    cells
}

/// First line of the table of differences.
pub(super) const HEADING: &str =
    "file,what,unit,l1,l1_relative,l2,l2_relative,max,max_relative,largest_at_x_m,largest_at_time_s\n";

/// Returns the norms of the differences of each field and history as CSV, with the position of the largest difference.
fn csv(differences: &[Difference]) -> String {
    let mut text = HEADING.to_owned();
    for difference in differences {
        let mut line = |what: &str, units: &str, norms: Norms, x: Option<f64>, time: f64| {
            let relative = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
            let cells = [norms.l1, norms.l2, norms.max].map(|n| std::format!("{},{}", n.value, relative(n.relative)));
            let file = difference.file.display();
            let _ = writeln!(text, "\"{file}\",{what},{units},{},{},{time}", cells.join(","), relative(x));
        };
        for f in &difference.fields {
            line(f.field.name(), f.units, f.norms, Some(f.largest.x_m), f.largest.time_s);
        }
        for h in &difference.histories {
            line(&std::format!("stress of {}", h.name), "Pa", h.norms, None, h.largest_at_s);
        }
    }
    text
}
