//! Output of `barwave critical`.

use std::fmt::Write as _;
use std::path::Path;

use super::Studied;
use crate::cli::output;
use crate::study::bracket::{Apparent, Confirmation};
use crate::study::sensitivity::Interval;
use crate::study::uncertainty::{FEWEST, Uncertainty};
use crate::units::{Dimension, Scale, System, format as with_unit};

const PERCENT: f64 = 0.01;

/// Returns the table as text, at most 80 columns wide, followed by the other results requested.
pub(super) fn text(studied: &[Studied], units: System, written: Option<&Path>) -> String {
    let mut text = rows(studied, units);
    for one in studied {
        text += &details(one, units);
    }
    if let Some(line) = written.and_then(output::wrote) {
        let _ = writeln!(text, "\n{line}");
    }
    text
}

fn rows(studied: &[Studied], units: System) -> String {
    let (velocity, stress) = (velocity(units), units.of_columns(Dimension::Stress));
    let cells = |s: &Studied| {
        let r = &s.row;
        vec![
            r.material.clone(),
            output::fixed(r.critical_velocity_m_s.map(|v| velocity.of(v)), 2),
            output::fixed(Some(velocity.of(r.yield_velocity_m_s)), 2),
            output::fixed(r.strain_at_max, 4),
            output::fixed(r.stress_at_max_pa.map(|s| stress.of(s)), 1),
            if r.critical_velocity_m_s.is_some() { r.reason.clone() } else { "none".into() },
        ]
    };
    let [v_c, v_y] = ["v_c", "v_y"].map(|name| format!("{name} {}", velocity.symbol));
    let headings = ["material", &v_c, &v_y, "strain", &format!("stress {}", stress.symbol), "criterion"];
    output::table(&headings, &studied.iter().map(cells).collect::<Vec<_>>(), 1, true)
}

fn velocity(units: System) -> Scale {
    units.of_columns(Dimension::Velocity)
}

fn details(s: &Studied, units: System) -> String {
    let unit = velocity(units);
    let mut text = String::new();
    let name = &s.row.material;
    if s.row.critical_velocity_m_s.is_none() {
        let _ = writeln!(text, "{name}: no critical velocity:\n  {}", s.row.reason);
    }
    if let Some(uncertainty) = &s.scatter {
        text += &scatter(name, uncertainty, unit);
    }
    if let Some(simulated) = &s.simulated {
        text += &simulation(name, simulated.as_ref(), unit);
    }
    if let (Some(Some(found)), Some(velocity)) = (&s.apparent, s.row.critical_velocity_m_s) {
        text += &apparent(name, found, velocity, units);
    }
    if let Some(intervals) = s.sensitivity.as_ref().filter(|intervals| !intervals.is_empty()) {
        text += &sensitivity(name, intervals, unit);
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}

fn scatter(name: &str, u: &Uncertainty, unit: Scale) -> String {
    let symbol = unit.symbol;
    let what = match u.basis {
        "tests" => format!("{} tests", u.tests.len()),
        _ => "band of one standard deviation of the stress".into(),
    };
    let mut text = format!("{name}: {what}\n");
    for test in &u.tests {
        let value = test.critical_velocity_m_s.map_or("none: it ends while the stress rises".into(), |v| {
            let number = output::fixed(Some(unit.of(v)), 2);
            format!("{number:>8} {symbol}")
        });
        let _ = writeln!(text, "  {:<24}{value}", test.record);
    }
    for (name, value) in [("mean", u.mean_m_s), ("standard deviation", u.standard_deviation_m_s)] {
        if let Some(value) = value {
            let _ = writeln!(text, "  {name:<24}{:>8.2} {symbol}", unit.of(value));
        }
    }
    let range = |[low, high]: [f64; 2]| format!("{:.2} to {:.2} {symbol}", unit.of(low), unit.of(high));
    let interval = u.interval_95_m_s.map_or_else(|| too_few(u), range);
    let _ = writeln!(text, "  95 % interval           {interval}");
    text + &of_what(u)
}

fn with_velocity(u: &Uncertainty) -> usize {
    u.tests.iter().filter(|test| test.critical_velocity_m_s.is_some()).count()
}

fn too_few(u: &Uncertainty) -> String {
    match with_velocity(u) {
        all if all == u.tests.len() => format!("none: at least {FEWEST} tests are needed"),
        some => format!("none: {some} of {} tests have a critical velocity, {FEWEST} are needed", u.tests.len()),
    }
}

/// Returns a line that states the quantity to which the interval refers.
fn of_what(u: &Uncertainty) -> String {
    match (u.interval_95_m_s, u.resamples, u.seed) {
        (None, ..) => String::new(),
        (_, Some(specimens), Some(seed)) => {
            format!("  of the critical velocity of a specimen, {specimens} of them drawn, seed {seed}\n")
        }
        _ => {
            let degrees = with_velocity(u).saturating_sub(1);
            format!("  of the mean of the tests, Student's t with {degrees} degrees of freedom\n")
        }
    }
}

fn simulation(name: &str, simulated: Option<&Confirmation>, unit: Scale) -> String {
    let Some(s) = simulated else {
        return format!("{name}: not simulated, no critical velocity within the data\n");
    };
    let (fronts, grid) = (s.fronts, s.grid);
    let verdict = match (s.confirmed, s.converged) {
        (true, _) => "confirmed by simulation",
        (false, true) => "NOT confirmed by simulation",
        (false, false) => "NOT confirmed by simulation: the grid has not converged",
    };
    format!(
        "{name}: {verdict}\n  front tracking  no fracture at {:.3} {v}, fracture at {:.3} {v}\n  leapfrog        \
         no fracture at {:.2} {v}, fracture at {:.2} {v}\n                  ({} cells; changes by {:.2} {v} with half as many)\n",
        unit.of(fronts.holds_m_s),
        unit.of(fronts.breaks_m_s),
        unit.of(grid.bracket.holds_m_s),
        unit.of(grid.bracket.breaks_m_s),
        grid.cells,
        unit.of(grid.resolution_m_s),
        v = unit.symbol,
    )
}

fn apparent(name: &str, a: &Apparent, static_velocity: f64, units: System) -> String {
    let unit = velocity(units);
    let v = unit.symbol;
    let adiabatic = |found| format!("  adiabatic curve {:.2} {v}\n", unit.of(found));
    let adiabatic = a.adiabatic_m_s.map_or_else(String::new, adiabatic);
    format!(
        "{name}: with {}\n  static          {:.2} {v}\n{adiabatic}  apparent        {:.2} {v}, bar of {} ({} \
         cells; changes by {:.2} {v} with half as many)\n  The apparent critical velocity is the lowest constant velocity of \
         the end\n  at which the mean strain of the first 1 % of the bar exceeds the strain of the\n  largest static stress \
         ({:.4}) before the elastic wave returns from the far end\n  (2 L/c0).\n",
        a.effects.join(", "),
        unit.of(static_velocity),
        unit.of(a.grid.bracket.middle()),
        with_unit(a.length_m, Dimension::Length, units),
        a.grid.cells,
        unit.of(a.grid.resolution_m_s),
        a.strain_limit
    )
}

fn sensitivity(name: &str, intervals: &[Interval], unit: Scale) -> String {
    let row = |i: &Interval| {
        vec![
            format!("{:.4} to {:.4}", i.from, i.to),
            format!("{:.2}", unit.of(i.contribution_m_s)),
            format!("{:.1}", i.share / PERCENT),
            format!("{:+.3}", unit.of(i.per_percent_of_stress_m_s)),
        ]
    };
    let v = unit.symbol;
    let headings = ["strain", &format!("contribution {v}"), "fraction %", &format!("{v} per 1 % of stress")];
    let rows: Vec<_> = intervals.iter().map(row).collect();
    let table = output::table(&headings, &rows, 1, false);
    format!(
        "{name}: contributions of strain intervals to the critical velocity\n{}",
        table.lines().flat_map(|line| ["  ", line, "\n"]).collect::<String>()
    )
}

/// Returns the table as CSV, one row for each material; a cell without a value is empty.
pub(super) fn csv(studied: &[Studied]) -> String {
    let mut text = String::from(
        "material,density_kg_m3,sense,critical_velocity_m_s,yield_velocity_m_s,strain_at_max,stress_at_max_Pa,reason,\
         mean_m_s,standard_deviation_m_s,interval_95_low_m_s,interval_95_high_m_s,fronts_hold_m_s,fronts_break_m_s,\
         apparent_velocity_m_s,adiabatic_velocity_m_s\n",
    );
    let cell = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
    let quoted = |text: &str| {
        if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
    };
    for s in studied {
        let (r, u) = (&s.row, s.scatter.as_ref());
        let interval = u.and_then(|u| u.interval_95_m_s);
        let fronts = s.simulated.flatten().map(|simulated| simulated.fronts);
        let apparent = s.apparent.iter().flatten().next();
        let cells = [
            quoted(&r.material),
            r.density_kg_m3.to_string(),
            r.sense.name().into(),
            cell(r.critical_velocity_m_s),
            r.yield_velocity_m_s.to_string(),
            cell(r.strain_at_max),
            cell(r.stress_at_max_pa),
            quoted(&r.reason),
            cell(u.and_then(|u| u.mean_m_s)),
            cell(u.and_then(|u| u.standard_deviation_m_s)),
            cell(interval.map(|i| i[0])),
            cell(interval.map(|i| i[1])),
            cell(fronts.map(|f| f.holds_m_s)),
            cell(fronts.map(|f| f.breaks_m_s)),
            cell(apparent.map(|a| a.grid.bracket.middle())),
            cell(apparent.and_then(|a| a.adiabatic_m_s)),
        ];
        text += &(cells.join(",") + "\n");
    }
    text
}
