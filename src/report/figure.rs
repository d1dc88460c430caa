//! The figure of a result file: x-t map, profiles, histories, ledger, wave speeds, as one SVG.

use super::display::Units;
use super::svg::{Anchor, Area, Svg};
use super::view::View;
use super::{impact, map, panels};
use crate::error::{InputError, Result};
use crate::record::Field;
use crate::record::store::{Facts, ResultFile};

const WIDTH: f64 = 1240.0;
const MARGIN: f64 = 18.0;
const GAP: f64 = 22.0;
const HEADER: f64 = 64.0;
/// Heights of the first row of panels and of those below.
const TALL: f64 = 430.0;
const LOW: f64 = 300.0;

/// Draws a result file as one SVG: what is in the file is drawn, what is not leaves no hole.
///
/// `field` is shown over x and t; none: stress, or else the first field there is.
///
/// # Errors
/// [`InputError`] where the file has not that field, or no frame at all; a file that cannot be read.
pub fn draw(file: &ResultFile, field: Option<Field>, units: Units) -> Result<String> {
    if let Some(impact) = file.impact()? {
        return impact::draw(file, &impact, units);
    }
    let view = view(file, field, units)?;
    let mut svg = Svg::default();
    header(&mut svg, file.facts());
    let half = (WIDTH - 2.0 * MARGIN - GAP) / 2.0;
    let area =
        |column: usize, y: f64, height: f64| Area { x: MARGIN + (half + GAP) * column as f64, y, width: half, height };
    map::draw(&mut svg, area(0, HEADER, TALL), &view)?;
    panels::profiles(&mut svg, area(1, HEADER, TALL), &view, 'b')?;
    let mut y = HEADER + TALL + GAP;
    let mut column = 0;
    let mut letter = 'c';
    for panel in [panels::gauges, panels::ends, panels::ledger, panels::speeds] {
        if panel(&mut svg, area(column, y, LOW), &view, letter)? {
            column += 1;
            letter = char::from(letter as u8 + 1);
        }
        if column == 2 {
            (column, y) = (0, y + LOW + GAP);
        }
    }
    let bottom = if column == 0 { y - GAP } else { y + LOW };
    Ok(svg.document(WIDTH, bottom + MARGIN))
}

fn view(file: &ResultFile, field: Option<Field>, units: Units) -> Result<View<'_>> {
    let time = file.time()?;
    let x = file.x()?;
    let fields = file.fields();
    let preferred = if fields.contains(&Field::Stress) { Some(Field::Stress) } else { fields.first().copied() };
    let Some(field) = field.or(preferred) else {
        return Err(nothing(file, "no field was recorded").into());
    };
    if !fields.contains(&field) {
        let names: Vec<_> = fields.iter().map(|f| f.name()).collect();
        return Err(InputError::new(format!("{} has no field `{}`", file.path().display(), field.name()))
            .key("--field")
            .allowed(names.join(", "))
            .help("add it to `fields` under [record] in the scene, and run it again")
            .into());
    }
    let (Some(&end_time), Some(&last)) = (time.last(), x.last()) else {
        return Err(nothing(file, "there is no frame in it yet").into());
    };
    // Samples are cell centres: the bar ends half a cell beyond the last one.
    let half_cell = if x.len() > 1 { (last - x[x.len() - 2]) / 2.0 } else { last };
    Ok(View { file, field, units, time, x, length: last + half_cell, end_time })
}

fn nothing(file: &ResultFile, why: &str) -> InputError {
    InputError::new(format!("{} has nothing to draw: {why}", file.path().display()))
        .help("a run that was stopped before its first frame leaves none; run the scene again")
}

fn header(svg: &mut Svg, facts: &Facts) {
    svg.bold((MARGIN, 28.0), 19.0, Anchor::Start, &shortened(&facts.title, 100));
    let mut parts = vec![format!("{} {}", facts.method, facts.scheme)];
    if let Some(cells) = facts.cells.filter(|cells| *cells > 0) {
        parts.push(format!("{cells} cells"));
    }
    if let Some(events) = facts.events.filter(|events| *events > 0) {
        parts.push(format!("{events} events"));
    }
    if !facts.effects.is_empty() {
        parts.push(facts.effects.join(", "));
    }
    parts.push(if facts.is_unfinished() { "unfinished".into() } else { format!("outcome: {}", facts.outcome) });
    if let Some(error) = &facts.error {
        parts.push(format!("error {:.1e} ({})", error.value, error.reference));
    }
    svg.text((MARGIN, 50.0), 13.0, Anchor::Start, &shortened(&parts.join("  \u{b7}  "), 150));
}

/// At most `length` characters.
fn shortened(text: &str, length: usize) -> String {
    if text.chars().count() <= length {
        return text.to_owned();
    }
    text.chars().take(length - 1).chain(std::iter::once('\u{2026}')).collect()
}
