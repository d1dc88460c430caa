//! Tables of the figures and the ruptures of a bar.

use super::display::{PLAIN, Unit, Units};
use super::html::{listed, table};
use super::impact::shown;
use crate::error::Result;
use crate::record::figure_names;
use crate::record::store::{ResultFile, StoredFigure, StoredPlace, StoredRupture};

/// Kinds of places that have a table in common, and the head of its first column.
const TABLES: [(&[&str], &str); 4] = [
    (&["left", "right", "joints"], "end or joint"),
    (&["gauges"], "gauge"),
    (&["segments"], "segment"),
    (&["fragments"], "fragment"),
];

/// The figures: those of the whole bar, and a table for each kind of place; empty where there are none.
pub(super) fn figures(file: &ResultFile, units: Units) -> Result<String> {
    let mut places = file.figures()?;
    let time = Units::time(file.time()?.last().copied().unwrap_or_default());
    let names = figure_names();
    // Those of older programs come last.
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

/// A figure of several places, with the unit of all its values.
struct Column<'a> {
    name: &'a str,
    unit: Unit,
}

/// A row for each place, a column for each figure.
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

/// Not a number where the place has no such figure.
fn value(place: &StoredPlace, name: &str) -> f64 {
    figure(place, name).map_or(f64::NAN, |figure| figure.value)
}

/// Times are in the unit of those of the run, other values in that in which the largest one reads best.
fn column<'a>(places: &[&StoredPlace], name: &'a str, (units, time): (Units, Unit)) -> Column<'a> {
    let symbol = places.iter().find_map(|place| figure(place, name)).map_or("1", |figure| figure.units.as_str());
    let most = places.iter().map(|place| value(place, name).abs()).fold(0.0, f64::max);
    Column { name, unit: if symbol == "s" { time } else { units.of_symbol(symbol, most) } }
}

/// A name of a figure in words.
pub(super) fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// A place in words: "left end", "joint 2", "gauge middle".
pub(super) fn place_name(kind: &str, name: &str) -> String {
    if name.is_empty() { format!("{kind} end") } else { format!("{} {name}", kind.trim_end_matches('s')) }
}

/// Where, when and of what the bar broke, in order of time; empty where it did not.
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
