//! Panels of histories: at the gauges, at the ends, and of the energies.

use super::axis::Axis;
use super::display::Unit;
use super::drawing::{INK, Stroke};
use super::panel::{LinePanel, Series};
use super::plot::colour;
use super::view::{View, nearest};
use crate::error::Result;
use crate::record::store::Side;
use crate::record::{Field, LedgerRow, Trace};

/// Returns the histories of the displayed field at the gauges, or `None` if there are none.
pub(super) fn gauges(view: &View) -> Result<Option<LinePanel>> {
    let length = view.length_unit();
    let gauges: Vec<_> = view.file.gauges()?.into_iter().filter(|gauge| !gauge.trace.time.is_empty()).collect();
    let samples: Vec<usize> = gauges.iter().map(|gauge| nearest(&view.x, gauge.x)).collect();
    let traces: Vec<Own> = gauges.iter().map(|gauge| own(&gauge.trace, view.field)).collect();
    let name = |name: &str, place: String| if name == place { place } else { format!("{name}, x = {place}") };
    let names: Vec<String> = gauges.iter().map(|gauge| name(&gauge.name, length.brief(gauge.x))).collect();
    let series = at_places(view, &names, &traces, &samples)?;
    Ok(histories(
        view,
        &format!("{} at the gauges", view.field_name()),
        view.field_unit().label(view.field_name()),
        View::zero(view.field),
        series,
    ))
}

/// Returns the histories of the displayed field at both ends. The stress at a free end is zero and is not shown.
pub(super) fn ends(view: &View) -> Result<Option<LinePanel>> {
    let traces = [view.file.end(Side::Left)?, view.file.end(Side::Right)?];
    let torques = [view.file.end_torque(Side::Left)?, view.file.end_torque(Side::Right)?];
    let names = ["left end", "right end"].map(String::from);
    let last = view.x.len().saturating_sub(1);
    let of_end = |k: usize| match view.field {
        Field::Torque => (&traces[k].time[..], &torques[k][..]),
        field => own(&traces[k], field),
    };
    let mut series = at_places(view, &names, &[of_end(0), of_end(1)], &[0, last])?;
    if view.field == Field::Stress {
        series.retain(|s| s.points.iter().any(|p| p.1 != 0.0));
    }
    let place = match &series[..] {
        [only] => only.name.clone(),
        _ => "ends".into(),
    };
    let name = view.field_name();
    let heading = format!("{name} at the {place}");
    Ok(histories(view, &heading, view.field_unit().label(name), View::zero(view.field), series))
}

/// Times and values recorded at a gauge or an end; the values are empty if the field is not recorded there.
type Own<'a> = (&'a [f64], &'a [f64]);

fn own(trace: &Trace, field: Field) -> Own<'_> {
    let values = match field {
        Field::Stress => &trace.stress[..],
        Field::Strain => &trace.strain,
        Field::Velocity => &trace.velocity,
        Field::Temperature => &trace.temperature,
        _ => &[],
    };
    (&trace.time, values)
}

/// Returns a history for each position: the one recorded there, or otherwise the field at the nearest sample, frame by frame.
fn at_places(view: &View, names: &[String], histories: &[Own], samples: &[usize]) -> Result<Vec<Series>> {
    let mut from_frames = None;
    let mut series = Vec::new();
    for (i, (name, &(times, own))) in names.iter().zip(histories).enumerate() {
        let stroke = Stroke::new(colour(i), 1.6);
        series.push(if own.is_empty() {
            if from_frames.is_none() {
                from_frames = Some(view.columns(view.field, samples)?);
            }
            let columns = from_frames.as_deref().unwrap_or_default();
            history(view, name, &view.time, &columns[i], view.field_unit(), stroke)
        } else {
            history(view, name, times, own, view.field_unit(), stroke)
        });
    }
    Ok(series)
}

/// Returns the energies against time with the energy supplied, or `None` if there are fewer than two rows.
pub(super) fn ledger(view: &View) -> Result<Option<LinePanel>> {
    let rows = view.file.ledger()?;
    if rows.len() < 2 {
        return Ok(None);
    }
    let unit = view.units.energy(&view.file.metadata().energy_units);
    let times: Vec<f64> = rows.iter().map(|row| row.time).collect();
    let line = |name: &str, stroke: Stroke, value: fn(&LedgerRow) -> f64| {
        let values: Vec<f64> = rows.iter().map(value).collect();
        history(view, name, &times, &values, unit, stroke)
    };
    let mut series = vec![
        line("kinetic", Stroke::new(colour(0), 1.6), |row| row.energies.kinetic),
        line("elastic", Stroke::new(colour(2), 1.6), |row| row.energies.elastic),
        line("plastic", Stroke::new(colour(1), 1.6), |row| row.energies.plastic),
        line("sum", Stroke::new(INK, 1.6), |row| row.energies.total()),
    ];
    if rows.iter().any(|row| row.energies.heat > 0.0) {
        series.push(line("heat", Stroke::new(colour(1), 1.6).dashed("6 3"), |row| row.energies.heat));
    }
    // The viscoplastic energy is omitted where it is below 1 % of the dissipation: its line would coincide with the axis.
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
    series.push(supplied(view, &rows, &times, unit));
    Ok(histories(view, "energy", unit.label("energy"), Some(0.0), series))
}

/// Returns the initial energy plus the work of the ends since then; the sum of the energies must coincide with this line.
fn supplied(view: &View, rows: &[LedgerRow], times: &[f64], unit: Unit) -> Series {
    let work = |row: &LedgerRow| row.work_left + row.work_right;
    let start = rows.first().map_or(0.0, |row| row.energies.total() - work(row));
    let values: Vec<f64> = rows.iter().map(|row| start + work(row)).collect();
    history(view, "initial energy + work of the ends", times, &values, unit, Stroke::new(colour(5), 2.2).dashed("6 5"))
}

fn history(view: &View, name: &str, times: &[f64], values: &[f64], unit: Unit, stroke: Stroke) -> Series {
    let time = view.time_unit().factor;
    let points = times.iter().zip(values).map(|(t, v)| (t * time, v * unit.factor)).collect();
    Series::line(name, points, stroke)
}

/// Returns a panel of histories whose vertical axis also includes `zero`, or `None` if all of them are empty.
fn histories(
    view: &View,
    heading: &str,
    label: String,
    zero: Option<f64>,
    mut series: Vec<Series>,
) -> Option<LinePanel> {
    series.retain(|s| !s.points.is_empty());
    if series.is_empty() {
        return None;
    }
    let unit = view.time_unit();
    let last = series.iter().filter_map(|s| s.points.last()).fold(view.end_time * unit.factor, |a, p| a.max(p.0));
    let values: Vec<f64> = series.iter().flat_map(|s| view.limits(&s.points)).collect();
    let y = Axis::around(label, values.into_iter().chain(zero));
    series.iter_mut().filter(|s| rings(&s.points, y.high - y.low)).for_each(|s| s.stroke.opacity = 0.35);
    let mut panel = LinePanel { heading: heading.into(), x: Axis::new(unit.label("time"), 0.0, last), y, series };
    panel.mark("rupture", &view.ruptures.iter().map(|r| r.time * unit.factor).collect::<Vec<_>>());
    Some(panel)
}

/// Returns true for a line that oscillates so often that it hides the lines below it, such as that of a broken piece that rings.
fn rings(points: &[(f64, f64)], height: f64) -> bool {
    const HEIGHTS: f64 = 25.0;
    points.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).filter(|v| v.is_finite()).sum::<f64>()
        > HEIGHTS * height
}
