//! Panels and tables of impact problems without waves in a bar.

use super::axis::Axis;
use super::colour::{ColourMap, hex};
use super::display::{Unit, Units};
use super::drawing::Stroke;
use super::layout::Content;
use super::panel::{LinePanel, Series};
use super::plot::colour;
use crate::error::{InputError, Result};
use crate::record::store::{ResultFile, StoredColumn, StoredFigure, StoredImpact, StoredTable};

/// Whole numbers below this are shown with all digits.
const MOST_COUNT: f64 = 1e12;

/// Returns the histories of an impact, one panel for each title among its columns, and its deflected shapes.
///
/// # Errors
/// [`InputError`] if the result has neither histories nor shapes.
pub(super) fn panels<'a>(file: &ResultFile, impact: &StoredImpact, units: Units) -> Result<Vec<Content<'a>>> {
    let mut panels = histories(impact, units);
    panels.extend(shapes(impact, units));
    if panels.is_empty() {
        let message = format!("{} has nothing to plot: it has results but no histories", file.path().display());
        let help = "`barwave report FILE -o FILE.html` shows them in a table";
        return Err(InputError::new(message).help(help).into());
    }
    Ok(panels.into_iter().map(Content::Lines).collect())
}

/// Returns the panels of histories in the order of the columns.
fn histories(impact: &StoredImpact, units: Units) -> Vec<LinePanel> {
    let mut titles: Vec<&str> = Vec::new();
    let shown = |column: &&StoredColumn| !column.panel.is_empty();
    for column in impact.tables.iter().flat_map(|table| table.columns.iter().filter(shown)) {
        if !titles.contains(&column.panel.as_str()) {
            titles.push(&column.panel);
        }
    }
    titles.into_iter().map(|title| history(impact, title, units)).collect()
}

fn history(impact: &StoredImpact, title: &str, units: Units) -> LinePanel {
    let of_title =
        |table: &StoredTable| table.columns.iter().filter(|column| column.panel == title).cloned().collect::<Vec<_>>();
    let tables: Vec<(&StoredTable, Vec<StoredColumn>)> = impact.tables.iter().map(|t| (t, of_title(t))).collect();
    let columns = || tables.iter().flat_map(|(_, columns)| columns);
    let most = columns().flat_map(|c| c.values.iter()).fold(0.0, |most: f64, v| most.max(v.abs()));
    let symbol = columns().next().map_or("", |column| column.units.as_str());
    let of = |(table, columns): &(&StoredTable, Vec<StoredColumn>)| shown_until(&table.columns[0], columns);
    let last = tables.iter().filter(|(_, columns)| !columns.is_empty()).map(of).fold(0.0, f64::max);
    let (unit, time) = (units.of_symbol(symbol, most), Units::time(last));
    let several = columns().count() > 1;
    let mut series = Vec::new();
    for (i, (table, columns)) in tables.iter().filter(|(_, columns)| !columns.is_empty()).enumerate() {
        for (j, column) in columns.iter().enumerate() {
            let points = table.columns[0].values.iter().zip(&column.values);
            let points = points.filter(|(t, _)| **t <= last);
            let points = points.map(|(t, v)| (t * time.factor, v * unit.factor)).collect();
            // Each of several tables of one kind, such as gauges, has its own colour; otherwise each column has.
            let stroke = match (table.x, j) {
                (Some(_), 0) => Stroke::new(colour(i), 1.6),
                (Some(_), _) => Stroke::new(colour(i), 1.4).dashed("6 4"),
                (None, _) => Stroke::new(colour(j), 1.6),
            };
            let name = match table.x {
                Some(_) => format!("{}: {}", table.name, column.long_name),
                None if several => column.long_name.clone(),
                None => String::new(),
            };
            series.push(Series::line(name, points, stroke));
        }
    }
    let values = series.iter().flat_map(|s| s.points.iter().map(|p| p.1)).chain([0.0]).collect::<Vec<_>>();
    let quantity = title.strip_suffix(" at the gauges").unwrap_or(title);
    LinePanel {
        heading: title.to_owned(),
        x: Axis::new(time.label("time"), 0.0, last * time.factor),
        y: Axis::around(unit.label(quantity), values.into_iter()),
        series,
    }
}

/// Time after the last contact that a panel of forces shows, relative to the time of the last contact.
const AFTER: f64 = 0.1;

/// Returns the time up to which columns are shown, s: the end of the run, or for forces soon after the last contact.
fn shown_until(time: &StoredColumn, columns: &[StoredColumn]) -> f64 {
    let end = time.values.last().copied().unwrap_or(0.0);
    let acts = |row: &usize| columns.iter().any(|column| column.values.get(*row).is_some_and(|value| *value != 0.0));
    match (0..time.values.len()).rev().find(acts) {
        Some(row) if columns[0].units == "N" => end.min((1.0 + AFTER) * time.values[row]),
        _ => end,
    }
}

/// Returns the deflection against position, one line for each time, or `None` if there are no shapes.
fn shapes(impact: &StoredImpact, units: Units) -> Option<LinePanel> {
    let shapes = impact.shapes.as_ref()?;
    let (&end, &length) = (shapes.time.last()?, shapes.x.last()?);
    let most = shapes.deflection.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let (unit, place, time): (Unit, Unit, Unit) = (units.of_symbol("m", most), units.length(length), Units::time(end));
    let count = (shapes.time.len().max(2) - 1) as f64;
    let line = |(i, (t, row)): (usize, (&f64, &[f64]))| {
        let points = shapes.x.iter().zip(row).map(|(x, w)| (x * place.factor, w * unit.factor)).collect();
        let stroke = Stroke::new(hex(ColourMap::Sequential.at(0.82 * i as f64 / count)), 1.6);
        Series::line(time.brief(*t), points, stroke)
    };
    let rows = shapes.time.iter().zip(shapes.deflection.chunks(shapes.x.len()));
    let series: Vec<Series> = rows.enumerate().map(line).collect();
    let values: Vec<f64> = series.iter().flat_map(|s| s.points.iter().map(|p| p.1)).chain([0.0]).collect();
    Some(LinePanel {
        heading: "deflected shapes".into(),
        x: Axis::new(place.label("position x"), 0.0, length * place.factor),
        y: Axis::around(unit.label("deflection"), values.into_iter()),
        series,
    })
}

/// Returns the value of a figure with its unit.
pub(super) fn shown(figure: &StoredFigure, units: Units) -> String {
    let value = figure.value;
    // Whole numbers are counts, or fractions of exactly 0 or 1. Adding zero turns -0 into 0.
    let is_whole = figure.units == "1" && value.fract() == 0.0 && value.abs() < MOST_COUNT;
    if is_whole { format!("{:.0}", value + 0.0) } else { units.of_symbol(&figure.units, value.abs()).show(value) }
}

/// Returns the rows of the table of figures: description, value with unit.
pub(super) fn figures(impact: &StoredImpact, units: Units) -> Vec<Vec<String>> {
    let row = |figure: &StoredFigure| vec![figure.long_name.clone(), shown(figure, units)];
    let sentences = [("equation", &impact.equation), ("validity", &impact.validity)];
    let sentences =
        sentences.into_iter().filter(|(_, text)| !text.is_empty()).map(|(name, text)| vec![name.into(), text.clone()]);
    sentences.chain(impact.figures.iter().map(row)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_forces_end_soon_after_the_contact() {
        let column = |units: &str, values: &[f64]| StoredColumn {
            units: units.into(),
            long_name: String::new(),
            panel: String::new(),
            values: values.to_vec(),
        };
        let time = column("s", &[0.0, 1.0, 2.0, 10.0]);
        let until =
            |units: &str, values: &[f64]| shown_until(&time, &[column(units, &[0.0; 4]), column(units, values)]);
        assert_eq!(until("N", &[0.0, 5.0, 0.0, 0.0]), 1.1);
        assert_eq!(until("N", &[0.0, 5.0, 0.0, 5.0]), 10.0);
        assert_eq!(until("N", &[0.0; 4]), 10.0);
        assert_eq!(until("m", &[0.0, 5.0, 0.0, 0.0]), 10.0);
    }
}
