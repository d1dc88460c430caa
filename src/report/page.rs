//! The HTML page of a result file: panels and tables.

use super::display::{PLAIN, Unit, Units, four_digits};
use super::figure::{Figure, pictures};
use super::html::{escape, html, listed, table};
use super::{impact, results};
use crate::error::Result;
use crate::record::FrontRow;
use crate::record::store::{Metadata, ResultFile, StoredImpact};
use crate::solver::Energies;

/// Width and height of a panel of the page, px. Scaled to a phone of 360 px width, its text is still 10 px high.
const PANEL: [f64; 2] = [420.0, 330.0];

/// Returns a self-contained HTML page: panels, metadata, figures, ruptures, fronts, ledger, audit, materials and scene.
///
/// # Errors
/// The same as those of [`draw`](super::draw).
pub fn page(file: &ResultFile, figure: &Figure) -> Result<String> {
    let (metadata, units) = (file.metadata(), figure.units);
    let panels = pictures(file, figure, PANEL)?;
    if let Some(impact) = file.impact()? {
        return impact_page(file, &impact, &panels, units);
    }
    let (results, ruptures) = (results::figures(file, units)?, results::ruptures(file, units)?);
    let fronts = fronts_table(file, units)?;
    let ledger = ledger_table(file, units)?;
    let audit = audit_list(file, units)?;
    let materials = materials_table(file, units)?;
    let scene = format!("<pre tabindex=\"0\">{}</pre>", escape(&metadata.scene));
    let about = metadata_table(metadata, units);
    let mut sections = vec![("", panels.as_str()), ("Run", about.as_str())];
    let optional = [
        ("Results", &results),
        ("Ruptures", &ruptures),
        ("Fronts", &fronts),
        ("Ledger", &ledger),
        ("Neglected effects", &audit),
        ("Materials", &materials),
        ("Scene", &scene),
    ];
    sections.extend(optional.into_iter().filter(|(_, content)| !content.is_empty()).map(|(h, c)| (h, c.as_str())));
    Ok(html(&metadata.title, &sections))
}

/// Returns the page of an impact without waves in a bar; `panels` is empty if it has no histories.
fn impact_page(file: &ResultFile, impact: &StoredImpact, panels: &str, units: Units) -> Result<String> {
    let metadata = file.metadata();
    let results = table("Results", &[], &impact::figures(impact, units));
    let notes: Vec<String> =
        metadata.notes.iter().map(|note| format!("<li>{}</li>\n", escape(&units.sentence(note)))).collect();
    let notes = if notes.is_empty() { String::new() } else { format!("<ul>\n{}</ul>\n", notes.concat()) };
    let (about, materials) = (metadata_table(metadata, units), materials_table(file, units)?);
    let scene = format!("<pre tabindex=\"0\">{}</pre>", escape(&metadata.scene));
    let sections = [
        ("", panels),
        ("Run", &about),
        ("Results", &results),
        ("Notes", &notes),
        ("Materials", &materials),
        ("Scene", &scene),
    ];
    let kept: Vec<(&str, &str)> = sections.into_iter().filter(|(_, content)| !content.is_empty()).collect();
    Ok(html(&metadata.title, &kept))
}

/// Rows of names and values of the root attributes.
type Rows = Vec<Vec<String>>;

fn metadata_table(metadata: &Metadata, units: Units) -> String {
    let mut rows = method_rows(metadata, units);
    rows.extend(cost_rows(metadata));
    let mut add = |name: &str, value: String| rows.push(vec![name.into(), value]);
    if !metadata.overrides.is_empty() {
        add("overrides", metadata.overrides.join("; "));
    }
    let commit = metadata.git_revision.as_ref().map_or_else(String::new, |r| format!(", commit {r}"));
    add("program", format!("barwave {}{commit}", metadata.program_version));
    add("started", metadata.created.clone());
    table("Run", &[], &rows)
}

/// Returns the outcome of the run, the method, the effects and the notes.
fn method_rows(metadata: &Metadata, units: Units) -> Rows {
    let mut rows = Rows::new();
    let mut add = |name: &str, value: String| rows.push(vec![name.into(), value]);
    let outcome = if metadata.is_unfinished() {
        "unfinished: the run is in progress or was killed".into()
    } else {
        metadata.outcome.clone()
    };
    add("outcome", outcome);
    if let Some(reason) = &metadata.reason {
        add("reason", reason.clone());
    }
    add("method", format!("{} {}", metadata.method, metadata.scheme));
    add(
        "effects",
        if metadata.effects.is_empty() { "none".into() } else { units.sentence(&metadata.effects.join(", ")) },
    );
    for note in &metadata.notes {
        add("note", units.sentence(note));
    }
    if let Some(velocity) = metadata.critical_velocity {
        add("critical impact velocity", units.velocity().show(velocity));
    }
    rows
}

/// Returns the size of the run, its computing time and its error.
fn cost_rows(metadata: &Metadata) -> Rows {
    let mut rows = Rows::new();
    let mut add = |name: &str, value: String| rows.push(vec![name.into(), value]);
    let counts = [
        ("cells", metadata.cells),
        // With front tracking, a step is an event.
        ("steps", metadata.steps.filter(|_| metadata.method != "moc")),
        ("events", metadata.events),
        ("cell steps", metadata.cell_steps),
    ];
    for (name, count) in counts.into_iter().filter_map(|(name, count)| Some((name, count.filter(|c| *c > 0)?))) {
        add(name, count.to_string());
    }
    if let Some(error) = &metadata.error {
        add("error", format!("{:.2e}: {}, against {}", error.value, error.measure, error.reference));
        if let Some(table) = &error.table {
            add("errors", table.to_string());
        }
    }
    for (name, seconds) in [("wall time", metadata.wall_seconds), ("time steps", metadata.step_wall_seconds)] {
        if let Some(seconds) = seconds {
            add(name, format!("{} s", four_digits(seconds)));
        }
    }
    rows
}

fn fronts_table(file: &ResultFile, units: Units) -> Result<String> {
    let fronts = file.fronts()?;
    let (Some(&end), Some(&last)) = (file.time()?.last(), file.x()?.last()) else {
        return Ok(String::new());
    };
    if fronts.is_empty() {
        return Ok(String::new());
    }
    let (length, time) = (units.length(last), Units::time(end));
    let gauges = file.gauges()?;
    let arrivals = gauges.iter().map(|gauge| time.label(&format!("arrival at {}", gauge.name)));
    let head: Vec<String> = front_head(units, length).into_iter().chain(arrivals).collect();
    let row = |front: &FrontRow| {
        let arrivals = front.arrivals.iter().map(|t| time.number(*t));
        front_cells(front, units, length).into_iter().chain(arrivals).collect()
    };
    Ok(listed("Fronts", &head, fronts.iter().map(row), "/fronts"))
}

fn front_head(units: Units, length: Unit) -> [String; 9] {
    let (stress, speed) = (units.stress(), units.velocity());
    [
        "from".into(),
        "strain ahead".into(),
        "strain behind".into(),
        stress.label("stress ahead"),
        stress.label("stress behind"),
        speed.label("speed, theory"),
        speed.label("speed, measured"),
        "difference (%)".into(),
        length.label("last seen at"),
    ]
}

/// Returns the cells of a front in the columns of [`front_head`].
fn front_cells(front: &FrontRow, units: Units, length: Unit) -> [String; 9] {
    let (stress, speed) = (units.stress(), units.velocity());
    let difference = 100.0 * (front.speed_measured / front.speed - 1.0);
    let signed = || format!("{difference:+.2}").replace('-', "\u{2212}");
    [
        front.origin.clone(),
        PLAIN.number(front.strain_ahead),
        PLAIN.number(front.strain_behind),
        stress.number(front.stress_ahead),
        stress.number(front.stress_behind),
        speed.number(front.speed),
        speed.number(front.speed_measured),
        if difference.is_finite() { signed() } else { "\u{2013}".into() },
        length.number(front.position),
    ]
}

fn ledger_table(file: &ResultFile, units: Units) -> Result<String> {
    let rows = file.ledger()?;
    let Some(last) = rows.last() else {
        return Ok(String::new());
    };
    let stored = &file.metadata().energy_units;
    let energy = units.energy(stored);
    let momentum = units.of_symbol(file.momentum_units(), last.energies.momentum.abs().max(last.impulse.abs()));
    let [momentum_name, impulse_name] = if file.is_in_torsion() {
        ["angular momentum at the end", "angular impulse on the bar"]
    } else {
        ["momentum at the end", "impulse on the bar"]
    };
    let residual = rows.iter().map(|row| row.residual.abs()).fold(0.0, f64::max);
    let mut values: Vec<(&str, String)> = Energies::COLUMNS
        .iter()
        .zip(last.energies.values())
        .map(|([_, long_name], value)| (*long_name, energy.show(value)))
        .collect();
    values.extend([
        ("work of the left end", energy.show(last.work_left)),
        ("work of the right end", energy.show(last.work_right)),
        ("largest energy residual, relative", format!("{residual:.1e}")),
        (momentum_name, momentum.show(last.energies.momentum)),
        (impulse_name, momentum.show(last.impulse)),
    ]);
    Ok(table("Ledger", &[], &values.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect::<Vec<_>>()))
}

fn audit_list(file: &ResultFile, units: Units) -> Result<String> {
    let rows = file.audit()?;
    if rows.is_empty() {
        return Ok(String::new());
    }
    let items: String = rows
        .iter()
        .map(|row| {
            let line = format!("<b>{}</b>: {}", escape(&row.effect), escape(&units.sentence(&row.advice())));
            if row.estimate.abs() >= row.threshold {
                format!("<li>{line} <em>(above the threshold)</em></li>\n")
            } else {
                format!("<li>{line}</li>\n")
            }
        })
        .collect();
    Ok(format!("<ul>\n{items}</ul>\n"))
}

fn materials_table(file: &ResultFile, units: Units) -> Result<String> {
    let (stress, density) = (units.stress(), units.density());
    let head = ["material", "knots"].map(String::from).into_iter().chain([
        density.label("density"),
        stress.label("modulus"),
        "source".into(),
        "confidence".into(),
    ]);
    let rows: Vec<Vec<String>> = file
        .materials()?
        .iter()
        .map(|m| {
            vec![
                m.name.clone(),
                m.strain.len().to_string(),
                density.number(m.density),
                stress.number(m.modulus),
                [m.provenance.citation.as_str(), m.provenance.measured.as_str()]
                    .iter()
                    .filter(|text| !text.is_empty())
                    .copied()
                    .collect::<Vec<_>>()
                    .join("; "),
                m.provenance.confidence.clone(),
            ]
        })
        .collect();
    Ok(if rows.is_empty() { String::new() } else { table("Materials", &head.collect::<Vec<_>>(), &rows) })
}
