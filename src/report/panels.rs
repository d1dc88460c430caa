//! The line panels of the figure. Each draws itself and says whether the file had anything for it.

use super::axes::{Axis, Series, line_panel};
use super::colour::{ColourMap, hex};
use super::display::{Unit, field_name};
use super::plot::colour;
use super::svg::{Area, Stroke, Svg};
use super::view::{View, nearest};
use crate::error::Result;
use crate::record::store::{Gauge, Side};
use crate::record::{Field, FrontRow, INTERIOR, LedgerRow, Trace};

/// Profiles in the panel; the last is at the end time.
const PROFILES: usize = 5;
/// With more fronts than this, their levels would be a grey band.
const MOST_LEVELS: usize = 10;

/// The field against x at several times, with the levels behind the fronts where theory gives them.
pub(super) fn profiles(svg: &mut Svg, panel: Area, view: &View, letter: char) -> Result<bool> {
    let (time, length, unit) = (view.time_unit(), view.length_unit(), view.field_unit());
    let fronts = of_theory(view)?;
    let mut series = levels(view, &fronts);
    let mut indices: Vec<usize> =
        (1..=PROFILES).map(|i| nearest(&view.time, view.end_time * i as f64 / PROFILES as f64)).collect();
    indices.dedup();
    for (number, &index) in indices.iter().enumerate() {
        let values = view.file.field(view.field, index..index + 1)?;
        let points = view.x.iter().zip(values.row(0)).map(|(x, v)| (x * length.factor, v * unit.factor)).collect();
        let place = 0.82 * number as f64 / (indices.len().max(2) - 1) as f64;
        let stroke = Stroke::new(hex(ColourMap::Sequential.at(place)), 1.7);
        series.push(Series::line(time.brief(view.time[index]), points, stroke));
    }
    let name = field_name(view.field);
    let x = Axis::new(length.label("position x"), 0.0, view.length * length.factor);
    let y = Axis::around(unit.label(name), with_zero(&series));
    line_panel(svg, panel, &format!("({letter})  {name} along the bar"), x, y, &series);
    Ok(true)
}

/// The fronts that theory knows: the edges of the first fans.
fn of_theory(view: &View) -> Result<Vec<FrontRow>> {
    let mut fronts = view.file.fronts()?;
    fronts.retain(|front| front.origin != INTERIOR);
    Ok(fronts)
}

fn levels(view: &View, fronts: &[FrontRow]) -> Vec<Series> {
    let level = |front: &FrontRow| match view.field {
        Field::Stress => Some(front.stress_behind),
        Field::Strain => Some(front.strain_behind),
        _ => None,
    };
    let mut values: Vec<f64> = fronts.iter().filter_map(level).filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.is_empty() || values.len() > MOST_LEVELS {
        return Vec::new();
    }
    let (factor, end) = (view.field_unit().factor, view.length * view.length_unit().factor);
    let points = values.iter().flat_map(|v| [(0.0, v * factor), (end, v * factor), (end, f64::NAN)]).collect();
    vec![Series::line("theory, behind each front", points, Stroke::new("#777", 1.1).dashed("2 3"))]
}

/// Histories at the gauges: the shown field where gauges record it, stress otherwise.
pub(super) fn gauges(svg: &mut Svg, panel: Area, view: &View, letter: char) -> Result<bool> {
    let field = match view.field {
        Field::Strain | Field::Velocity | Field::Temperature => view.field,
        _ => Field::Stress,
    };
    let (length, unit) = (view.length_unit(), view.units.field(field));
    let series: Vec<Series> = view
        .file
        .gauges()?
        .iter()
        .filter(|gauge| !gauge.trace.time.is_empty())
        .enumerate()
        .map(|(i, gauge)| {
            let name = format!("{}, x = {}", gauge.name, length.brief(gauge.x));
            history(view, name, &gauge.trace.time, column(gauge, field), unit, Stroke::new(colour(i), 1.6))
        })
        .collect();
    let name = field_name(field);
    Ok(histories(svg, panel, view, &format!("({letter})  {name} at the gauges"), unit.label(name), &series))
}

fn column(gauge: &Gauge, field: Field) -> &[f64] {
    match field {
        Field::Strain => &gauge.trace.strain,
        Field::Velocity => &gauge.trace.velocity,
        Field::Temperature => &gauge.trace.temperature,
        _ => &gauge.trace.stress,
    }
}

/// Stress at both ends.
pub(super) fn ends(svg: &mut Svg, panel: Area, view: &View, letter: char) -> Result<bool> {
    let unit = view.units.stress();
    let (left, right) = (view.file.end(Side::Left)?, view.file.end(Side::Right)?);
    let end = |name: &str, trace: &Trace, i: usize| {
        history(view, name.into(), &trace.time, &trace.stress, unit, Stroke::new(colour(i), 1.6))
    };
    let series = [end("left end", &left, 0), end("right end", &right, 1)];
    let series: Vec<Series> = series.into_iter().filter(|s| !s.points.is_empty()).collect();
    Ok(histories(svg, panel, view, &format!("({letter})  stress at the ends"), unit.label("stress"), &series))
}

/// Energies against time: where the work of the ends went.
pub(super) fn ledger(svg: &mut Svg, panel: Area, view: &View, letter: char) -> Result<bool> {
    let rows = view.file.ledger()?;
    let unit = view.units.energy(&view.file.facts().energy_units);
    let times: Vec<f64> = rows.iter().map(|row| row.time).collect();
    let line = |name: &str, stroke: Stroke, value: fn(&LedgerRow) -> f64| {
        let values: Vec<f64> = rows.iter().map(value).collect();
        history(view, name.into(), &times, &values, unit, stroke)
    };
    let mut series = vec![
        line("kinetic", Stroke::new(colour(0), 1.6), |row| row.energies.kinetic),
        line("elastic", Stroke::new(colour(2), 1.6), |row| row.energies.elastic),
        line("plastic", Stroke::new(colour(1), 1.6), |row| row.energies.plastic),
        line("sum", Stroke::new("#222", 1.6), |row| row.energies.total()),
    ];
    if rows.iter().any(|row| row.energies.heat > 0.0) {
        series.push(line("heat", Stroke::new(colour(1), 1.6).dashed("6 3"), |row| row.energies.heat));
    }
    // Where overstress takes little it would only be one line more on the axis.
    if rows.iter().any(|row| row.energies.viscoplastic > 1e-2 * (row.energies.plastic + row.energies.heat)) {
        series.push(line("viscoplastic", Stroke::new(colour(3), 1.6), |row| row.energies.viscoplastic));
    }
    if rows.iter().any(|row| row.energies.numerical > 1e-2 * row.energies.total()) {
        series.push(line("numerical", Stroke::new(colour(3), 1.6).dashed("2 3"), |row| row.energies.numerical));
    }
    if rows.iter().any(|row| row.energies.damping != 0.0) {
        series.push(line("damping", Stroke::new(colour(4), 1.6), |row| row.energies.damping));
    }
    if rows.iter().any(|row| row.energies.foundation != 0.0) {
        series.push(line("foundation", Stroke::new(colour(4), 1.6).dashed("2 3"), |row| row.energies.foundation));
    }
    // What there was at the start and what came in since: the sum has to lie on it.
    let work = |row: &LedgerRow| row.work_left + row.work_right;
    let start = rows.first().map_or(0.0, |row| row.energies.total() - work(row));
    let supplied: Vec<f64> = rows.iter().map(|row| start + work(row)).collect();
    let stroke = Stroke::new(colour(5), 2.2).dashed("6 5");
    series.push(history(view, "start + work of the ends".into(), &times, &supplied, unit, stroke));
    series.retain(|s| !s.points.is_empty());
    Ok(histories(svg, panel, view, &format!("({letter})  energy"), unit.label("energy"), &series))
}

/// Speed of every front over the strains that it carries: theory as steps, measurement as rings.
pub(super) fn speeds(svg: &mut Svg, panel: Area, view: &View, letter: char) -> Result<bool> {
    let fronts = of_theory(view)?;
    if fronts.is_empty() {
        return Ok(false);
    }
    let unit = view.units.velocity();
    let step = |f: &FrontRow| {
        let speed = f.speed.abs() * unit.factor;
        [(f.strain_ahead, speed), (f.strain_behind, speed), (f.strain_behind, f64::NAN)]
    };
    let middle = |f: &FrontRow| (0.5 * (f.strain_ahead + f.strain_behind), f.speed_measured.abs() * unit.factor);
    let mut series = vec![Series::line("theory", fronts.iter().flat_map(step).collect(), Stroke::new(colour(0), 2.2))];
    let measured: Vec<(f64, f64)> = fronts.iter().map(middle).filter(|p| p.1.is_finite()).collect();
    if !measured.is_empty() {
        series.push(Series::marks("measured in the fields", measured, Stroke::new(colour(1), 1.6)));
    }
    let strains = fronts.iter().flat_map(|f| [f.strain_ahead, f.strain_behind]);
    let x = Axis::around("strain", strains);
    let y = Axis::around(unit.label("front speed"), with_zero(&series));
    line_panel(svg, panel, &format!("({letter})  speed of the fronts"), x, y, &series);
    Ok(true)
}

/// The values of all series, and zero.
fn with_zero(series: &[Series]) -> impl Iterator<Item = f64> {
    series.iter().flat_map(|s| s.points.iter().map(|p| p.1)).chain(std::iter::once(0.0))
}

fn history(view: &View, name: String, times: &[f64], values: &[f64], unit: Unit, stroke: Stroke) -> Series {
    let time = view.time_unit().factor;
    let points = times.iter().zip(values).map(|(t, v)| (t * time, v * unit.factor)).collect();
    Series::line(name, points, stroke)
}

/// A panel of histories; false where there is none.
fn histories(svg: &mut Svg, panel: Area, view: &View, title: &str, label: String, series: &[Series]) -> bool {
    if series.is_empty() {
        return false;
    }
    let unit = view.time_unit();
    let last = series.iter().filter_map(|s| s.points.last()).fold(view.end_time * unit.factor, |a, p| a.max(p.0));
    let x = Axis::new(unit.label("time"), 0.0, last);
    // Steps of fronts are few rows and no spikes.
    let exact = view.file.facts().method == "moc";
    let points = |s: &Series| if exact { all_values(&s.points) } else { without_spikes(&s.points) };
    let values = series.iter().flat_map(points).chain([0.0]);
    line_panel(svg, panel, title, x, Axis::around(label, values), series);
    true
}

fn all_values(points: &[(f64, f64)]) -> Vec<f64> {
    points.iter().map(|p| p.1).collect()
}

/// Lowest and highest value for the axis. A sudden start can leave a few samples far outside (a first step carries
/// the whole jump); where leaving out the five most extreme samples halves the range, they run out of the frame.
fn without_spikes(points: &[(f64, f64)]) -> Vec<f64> {
    const SPIKE: usize = 5;
    let mut values: Vec<f64> = points.iter().map(|p| p.1).filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else {
        return values;
    };
    if values.len() < 40 * SPIKE {
        return vec![low, high];
    }
    let (inner_low, inner_high) = (values[SPIKE], values[values.len() - 1 - SPIKE]);
    let keep = |outer: f64, inner: f64| if (outer - inner).abs() > 0.5 * (high - low) { inner } else { outer };
    vec![keep(low, inner_low), keep(high, inner_high)]
}

#[cfg(test)]
mod tests {
    use super::without_spikes;

    #[test]
    fn a_spike_of_a_few_samples_does_not_set_the_axis() {
        let mut points: Vec<(f64, f64)> = (0..1000).map(|i| (f64::from(i), f64::from(i % 100))).collect();
        assert_eq!(without_spikes(&points), [0.0, 99.0]);
        points[3].1 = -5000.0;
        assert_eq!(without_spikes(&points), [0.0, 99.0]);
        // A pulse that lasts is no spike.
        points[10..30].iter_mut().for_each(|p| p.1 = -5000.0);
        assert_eq!(without_spikes(&points), [-5000.0, 99.0]);
    }
}
