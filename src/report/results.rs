//! Tables of the figures and the ruptures of a bar for the page.

use super::display::{PLAIN, Unit, Units};
use super::html::{listed, table};
use super::impact::shown;
use crate::error::Result;
use crate::record::figure_names;
use crate::record::store::{ResultFile, StoredFigure, StoredPlace, StoredRupture};

/// Kinds of places that share a table, and the heading of its first column.
const TABLES: [(&[&str], &str); 4] = [
    (&["left", "right", "joints"], "end or joint"),
    (&["gauges"], "gauge"),
    (&["segments"], "segment"),
    (&["fragments"], "fragment"),
];

/// Returns the tables of figures as HTML: those of the whole bar, and one table for each kind of place. Empty if there are no figures.
pub(super) fn figures(file: &ResultFile, units: Units) -> Result<String> {
    let mut places = file.figures()?;
    let time = Units::time(file.time()?.last().copied().unwrap_or_default());
    let names = figure_names();
    // Unknown figures, such as those of older versions, come last.
    let order = |name: &str| names.iter().position(|known| *known == name).unwrap_or(names.len());
    for place in &mut places {
        place.figures.sort_by_key(|figure| order(&figure.name));
    }
    let of_bar = places.iter().filter(|place| place.kind.is_empty()).flat_map(|place| &place.figures);
    let facts: Vec<Vec<String>> = of_bar.map(|figure| vec![words(&figure.name), shown(figure, units)]).collect();
    let mut html = if facts.is_empty() { String::new() } else { table("Results of the bar", &[], &facts) };
    for (kinds, head) in TABLES {
        let alike: Vec<&StoredPlace> = places.iter().filter(|place| kinds.contains(&place.kind)).collect();
        let mut columns: Vec<&str> = Vec::new();
        for figure in alike.iter().flat_map(|place| &place.figures) {
            if !columns.contains(&figure.name.as_str()) {
                columns.push(&figure.name);
            }
        }
        columns.sort_by_key(|name| order(name));
        if !columns.is_empty() {
            let columns: Vec<Column> = columns.into_iter().map(|name| column(&alike, name, (units, time))).collect();
            let name = |place: &StoredPlace| {
                if kinds.len() == 1 { place.name.clone() } else { place_name(place.kind, &place.name) }
            };
            html += &place_table(&alike, name, head, &columns);
        }
    }
    Ok(html)
}

/// Figure of several places, with a common unit.
struct Column<'a> {
    name: &'a str,
    unit: Unit,
}

/// Returns a table with a row for each place and a column for each figure.
fn place_table(
    places: &[&StoredPlace],
    name: impl Fn(&StoredPlace) -> String,
    kind: &str,
    columns: &[Column],
) -> String {
    let labels = columns.iter().map(|column| column.unit.label(&words(column.name)));
    let head: Vec<String> = std::iter::once(kind.to_owned()).chain(labels).collect();
    let row = |place: &&StoredPlace| {
        let cells = columns.iter().map(|column| column.unit.number(value(place, column.name)));
        std::iter::once(name(place)).chain(cells).collect()
    };
    listed(&format!("Results of each {kind}"), &head, places.iter().map(row), "/figures")
}

fn figure<'a>(place: &'a StoredPlace, name: &str) -> Option<&'a StoredFigure> {
    place.figures.iter().find(|figure| figure.name == name)
}

/// Returns the value of a figure of a place; NaN if the place does not have it.
fn value(place: &StoredPlace, name: &str) -> f64 {
    figure(place, name).map_or(f64::NAN, |figure| figure.value)
}

/// Returns a column. Times have the unit of the times of the run; other values have the unit that suits the largest one.
fn column<'a>(places: &[&StoredPlace], name: &'a str, (units, time): (Units, Unit)) -> Column<'a> {
    let symbol = places.iter().find_map(|place| figure(place, name)).map_or("1", |figure| figure.units.as_str());
    let most = places.iter().map(|place| value(place, name).abs()).fold(0.0, f64::max);
    Column { name, unit: if symbol == "s" { time } else { units.of_symbol(symbol, most) } }
}

/// Returns the name of a figure in words.
pub(super) fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// Returns the name of a place in words: "left end", "joint 2", "gauge middle".
pub(super) fn place_name(kind: &str, name: &str) -> String {
    if name.is_empty() { format!("{kind} end") } else { format!("{} {name}", kind.trim_end_matches('s')) }
}

/// Returns the table of ruptures (site, cause, position, time, stress, strain) in order of time; empty if the bar did not fracture.
pub(super) fn ruptures(file: &ResultFile, units: Units) -> Result<String> {
    let ruptures = file.ruptures()?;
    let (Some(last), false) = (file.x()?.last().copied(), ruptures.is_empty()) else {
        return Ok(String::new());
    };
    let latest = ruptures.iter().map(|rupture| rupture.time).fold(0.0, f64::max);
    let (time, length, stress) = (Units::time(latest), units.length(last), units.stress());
    let head =
        ["site".into(), "cause".into(), length.label("x"), time.label("time"), stress.label("stress"), "strain".into()];
    let row = |r: &StoredRupture| {
        let strain = PLAIN.number(r.strain);
        vec![r.site.clone(), r.cause.clone(), length.number(r.x), time.number(r.time), stress.number(r.stress), strain]
    };
    Ok(listed("Ruptures", &head, ruptures.iter().map(row), "/ruptures"))
}
