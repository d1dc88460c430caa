//! The summary of a run as text.

use super::lines::Lines;
use super::width;
use crate::record::{
    AuditRow, AutoChoice, ChoiceSummary, EndSummary, Figures, FrontSummary, INTERIOR, LengthSummary, RuptureSummary,
    Summary, TorsionSummary,
};
use crate::units::{Dimension, System, format, in_units};

/// Relative change of length after unloading up to which the final length of a segment is not listed.
const LEAST_STRAIN: f64 = 1e-6;

/// Largest number of fronts, and of ruptures, that are listed; a curve of many knots has as many fronts.
const LISTED: usize = 12;

/// Returns the whole summary.
pub(super) fn text(s: &Summary, units: System) -> String {
    let mut lines = Lines::under(&s.scene);
    add_method(&mut lines, s, units);
    add_ends(&mut lines, s, units);
    add_figures(&mut lines, &s.figures, units);
    add_limits(&mut lines, s, units);
    add_accuracy(&mut lines, s);
    lines.add("time", time_text(s));
    lines.add("result", &s.output);
    lines.extend(front_lines(&s.fronts, units));
    lines.extend(note_lines(&s.notes, units));
    lines.extend(audit_lines(&s.audit, units));
    lines.text()
}

/// Adds the outcome, automatic choices, the method and the effects.
fn add_method(lines: &mut Lines, s: &Summary, units: System) {
    lines.add("outcome", &s.outcome);
    for choice in s.auto.iter().flatten() {
        lines.add("auto", choice_text(choice, units));
    }
    let end = format(s.end_time_s, Dimension::Time, units);
    let how = match &s.tracking {
        None => std::format!("{} cells, {} steps to {end}", s.cells, s.steps),
        Some(t) => std::format!("{} events to {end}, {} active fronts", s.events, t.fronts_under_way),
    };
    lines.add("method", std::format!("{} {}, {how}", s.method, s.scheme));
    lines.add(
        "effects",
        match &s.effects[..] {
            [] => "none: the run stayed elastic".into(),
            effects => in_units(&effects.join(", "), units),
        },
    );
}

/// Adds the state of the ends and the final lengths of the segments.
fn add_ends(lines: &mut Lines, s: &Summary, units: System) {
    if let Some(torsion) = &s.torsion {
        lines.add("torsion", torsion_text(torsion, units));
    }
    for (label, end) in [("left end", &s.left), ("right end", &s.right)] {
        lines.add(label, end_text(end, units));
        if let Some(velocity) = end.striker {
            lines.add("striker", std::format!("velocity {}", format(velocity, Dimension::Velocity, units)));
        }
    }
    for (label, value) in length_lines(s, units) {
        lines.add(&label, value);
    }
}

/// Adds forces, contact, gauges and residual deformation, one line per group.
fn add_figures(lines: &mut Lines, figures: &Figures, units: System) {
    for group in figures.0.iter().filter(|group| group.in_summary) {
        let shown = group.figures.iter().filter(|figure| !figure.phrase.is_empty());
        let parts = shown.enumerate().flat_map(|(k, figure)| {
            let same_fact = figure.phrase.starts_with("at");
            let separator = if k == 0 {
                ""
            } else if same_fact {
                " "
            } else {
                ", "
            };
            [separator.to_owned(), std::format!("{} {}", figure.phrase, format(figure.value, figure.dimension, units))]
        });
        let text: String = parts.collect();
        lines.add(&group.label, text);
    }
}

/// Adds the elastic check, the critical velocity, the temperature rise and the ruptures.
fn add_limits(lines: &mut Lines, s: &Summary, units: System) {
    if let Some(check) = &s.elastic_check {
        let [found, expected] = [check.stress, check.expected].map(|stress| format(stress, Dimension::Stress, units));
        let relative = check.relative;
        lines
            .add("elastic check", std::format!("{found}, theory rho c0 v = {expected}, relative error {relative:.1e}"));
    }
    let exceeded = match s.fronts.iter().find(|front| front.origin != "interior") {
        // Rate dependence can transport strain away from the end for a while, so that the bar does not fracture there.
        _ if s.above_critical && s.outcome != "rupture" => ", exceeded",
        Some(front) if s.above_critical && front.stress_behind < 0.0 => {
            ", exceeded: the strain localizes at the loaded end"
        }
        _ if s.above_critical => ", exceeded: the bar fractures at the loaded end",
        _ => "",
    };
    let shown = |velocity| std::format!("{}{exceeded}", format(velocity, Dimension::Velocity, units));
    add_critical(lines, s.critical_velocity.map(shown), &s.fronts);
    if let Some(rise) = s.temperature_rise {
        lines.add("heat", std::format!("temperature rise up to {rise:.4} K"));
    }
    let ruptures = s.ruptures.as_deref().unwrap_or_default();
    for rupture in ruptures.iter().take(LISTED) {
        lines.add("rupture", rupture_text(rupture, units));
    }
    if ruptures.len() > LISTED {
        lines.add("", std::format!("... and {} more; --json lists all", ruptures.len() - LISTED));
    }
}

/// Adds the residuals of the ledger, the error, and the choice of the method for a tolerance.
fn add_accuracy(lines: &mut Lines, s: &Summary) {
    let (energy, momentum) = (s.ledger.energy_residual, s.ledger.momentum_residual);
    lines.add("ledger", std::format!("energy residual {energy:.1e}, momentum residual {momentum:.1e}"));
    if let Some(error) = &s.error {
        lines.add("error", std::format!("{:.2e}, {}, against the {}", error.value, error.measure, error.reference));
        if let Some(table) = &error.table {
            lines.add("errors", table.to_string());
        }
    }
    if let Some(choice) = &s.choice {
        lines.add("chosen", tolerance_text(choice));
    }
}

fn time_text(s: &Summary) -> String {
    let rate = match &s.tracking {
        None => std::format!("{:.0} million cell-steps/s", s.cell_steps_per_s / 1e6),
        Some(t) => std::format!("{:.2} million events/s", t.events_per_s / 1e6),
    };
    std::format!("{:.3} s, time steps {:.3} s ({rate})", s.wall_s, s.step_wall_s)
}

fn torsion_text(torsion: &TorsionSummary, units: System) -> String {
    let [left, right] = [0, 1].map(|k| {
        let torque = format(torsion.torque[k], Dimension::Torque, units);
        let velocity = format(torsion.angular_velocity_rad_s[k], Dimension::AngularVelocity, units);
        std::format!("{torque} at {velocity}")
    });
    let radius = format(torsion.radius_m, Dimension::Length, units);
    std::format!("left {left}, right {right}; in terms of the surface (radius {radius}):")
}

/// Returns the final lengths of the segments that have yielded, each with a label.
fn length_lines(s: &Summary, units: System) -> Vec<(String, String)> {
    let show = |length| format(length, Dimension::Length, units);
    let text = |length: &LengthSummary| {
        let [at_end, unloaded] = [length.at_end, length.unloaded].map(show);
        let share = length.unloaded / length.initial;
        std::format!("{at_end}, unloaded {unloaded} ({share:.4} of {})", show(length.initial))
    };
    let label =
        |k: usize| if s.lengths.len() == 1 { "final length".into() } else { std::format!("segment {} length", k + 1) };
    let flowed = |length: &LengthSummary| (length.unloaded - length.initial).abs() > LEAST_STRAIN * length.initial;
    s.lengths.iter().enumerate().filter(|(_, l)| flowed(l)).map(|(k, l)| (label(k), text(l))).collect()
}

fn tolerance_text(choice: &ChoiceSummary) -> String {
    let runs = choice.tried.len();
    std::format!("{} ({} runs in all, the coarse ones included)", choice.why, runs)
}

/// Returns whether an effect is on or off, and why: "heat on: ...".
pub(super) fn choice_text(choice: &AutoChoice, units: System) -> String {
    let why = in_units(&choice.why, units);
    std::format!("{} {}: {}", choice.effect, if choice.on { "on" } else { "off" }, why)
}

/// Returns the notes below a summary or a plan, one line each.
pub(super) fn note_lines(notes: &[String], units: System) -> impl Iterator<Item = String> {
    notes.iter().map(move |note| std::format!("  note: {}", in_units(note, units)))
}

/// Adds the critical velocity. For a compressed bar, nothing is added if the data end before it.
pub(super) fn add_critical(lines: &mut Lines, critical: Option<String>, fronts: &[FrontSummary]) {
    // Fronts that load a bar at rest in tension; reflections of compression waves do not count.
    let loads = |front: &FrontSummary| front.stress_ahead >= 0.0 && front.stress_behind > front.stress_ahead;
    let pulled = fronts.iter().any(|front| front.origin != INTERIOR && loads(front));
    let none = || pulled.then(|| "not reached within the data of the curve".to_owned());
    if let Some(text) = critical.or_else(none) {
        lines.add("critical velocity", text);
    }
}

/// Returns one line for all insignificant neglected effects, and one for each that cannot be estimated. Significant ones are among the notes.
fn audit_lines(rows: &[AuditRow], units: System) -> Vec<String> {
    let mut lines = Vec::new();
    let (unknown, small): (Vec<&AuditRow>, Vec<&AuditRow>) =
        rows.iter().filter(|row| !row.matters()).partition(|row| row.estimate.is_nan());
    let small: Vec<String> = small.iter().map(|r| std::format!("{} {:.2} %", r.effect, 100.0 * r.estimate)).collect();
    if !small.is_empty() {
        lines.push(std::format!("  {:<18}{}", "not simulated", small.join(", ")));
    }
    lines
        .extend(unknown.iter().map(|row| std::format!("  {:<18}{}", "not simulated", in_units(&row.message(), units))));
    lines
}

fn rupture_text(r: &RuptureSummary, units: System) -> String {
    std::format!(
        "{} ({}) at t = {}, x = {}: stress {}, strain {}, {} absorbed there",
        r.cause.name(),
        r.site,
        format(r.time_s, Dimension::Time, units),
        format(r.x_m, Dimension::Length, units),
        format(r.stress, Dimension::Stress, units),
        format(r.strain, Dimension::None, units),
        format(r.absorbed, Dimension::EnergyDensity, units)
    )
}

/// Magnitudes of stress (Pa), strain and velocity (m/s) below which a value is a rounding error and shown as zero.
const AT_REST: [f64; 3] = [1e-6, 1e-15, 1e-12];

fn end_text(end: &EndSummary, units: System) -> String {
    let values = [
        ("stress", end.stress, Dimension::Stress),
        ("strain", end.strain, Dimension::None),
        ("velocity", end.velocity, Dimension::Velocity),
    ];
    let shown = |((name, value, dimension), rest): ((&str, f64, Dimension), f64)| {
        std::format!("{name} {}", format(if value.abs() < rest { 0.0 } else { value }, dimension, units))
    };
    values.into_iter().zip(AT_REST).map(shown).collect::<Vec<_>>().join(", ")
}

/// Indent of the rows of fronts.
const INDENT: &str = "  ";

fn front_row(front: &FrontSummary, units: System) -> Vec<String> {
    let unknown = || "-".to_owned();
    vec![
        front.origin.clone(),
        // Adding zero turns -0 into 0: a compression wave into a bar at rest starts from 0.
        std::format!("{:.6}", front.strain_ahead + 0.0),
        std::format!("{:.6}", front.strain_behind + 0.0),
        format(front.stress_behind, Dimension::Stress, units),
        format(front.speed, Dimension::Velocity, units),
        front.speed_measured.map_or_else(unknown, |v| format(v, Dimension::Velocity, units)),
        front.position.map_or_else(unknown, |x| format(x, Dimension::Length, units)),
    ]
}

pub(super) fn front_lines(fronts: &[FrontSummary], units: System) -> Vec<String> {
    if fronts.is_empty() {
        return Vec::new();
    }
    let limit = width::of_stdout().unwrap_or(usize::MAX).saturating_sub(INDENT.len());
    let wide =
        ["front    ", "strain from", "         to", "    stress to", "        speed", "    measured", "last seen at"];
    let mut narrow = wide.map(str::trim);
    narrow[wide.len() - 1] = "at x";
    let is_wide = limit >= wide.iter().map(|heading| heading.len() + 2).sum();
    // Before a run, only the theory of the fronts is known.
    let seen = fronts.iter().any(|front| front.speed_measured.is_some() || front.position.is_some());
    let columns = if seen { wide.len() } else { wide.len() - 2 };
    let row = |front| front_row(front, units).into_iter().take(columns).collect();
    let rows: Vec<Vec<String>> = fronts.iter().take(LISTED).map(row).collect();
    let headings = if is_wide { &wide[..columns] } else { &narrow[..columns] };
    let table = width::within(limit, headings, &rows, (1, false));
    let mut lines: Vec<String> =
        table.lines().map(|line| std::format!("{INDENT}{line}").trim_end().to_owned()).collect();
    if fronts.len() > LISTED {
        lines.push(std::format!("  ... and {} more; --json lists all", fronts.len() - LISTED));
    }
    lines
}
