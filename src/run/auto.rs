//! `effects = "auto"`: enables the effects that would change the result by more than the audit's tolerance. The initial selection is based on
//! estimates before the run. If the audit of a run shows that a relevant effect was neglected, the effect is added and the run repeated. An enabled
//! effect stays enabled unless it cannot be simulated together with a larger one.

use std::ops::ControlFlow;

use super::{Progress, Target, accurate, estimate};
use crate::error::{Error, Result};
use crate::record::{AuditRow, AutoChoice, Summary};
use crate::scene::Scene;

/// How each effect is written into a scene. Effects that need constants use those of the materials.
const WRITTEN: [(&str, &str); 5] = [
    ("hardening", "\"isotropic\""),
    ("rate", "\"material\""),
    ("heat", "{}"),
    ("rupture", "\"critical-strain\""),
    ("lateral-inertia", "true"),
];

/// Changes of `[solve]` that are tried in turn for a set of effects, if the scene leaves the method open.
const METHODS: [&[&str]; 2] = [&[], &["solve.method=fd"]];

/// Changes that are tried if the scene names its method: they remove keys that the method no longer accepts.
const WITHOUT_KEYS: [&[&str]; 4] =
    [&[], &["solve.front-tolerance="], &["solve.max-events="], &["solve.front-tolerance=", "solve.max-events="]];

/// Selects effects from the estimates before the run, and passes every choice to `progress`. A scene that names its effects is returned unchanged.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop.
pub fn choose(scene: &Scene, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Scene> {
    let mut scene = with_recorded(scene, progress)?;
    // Each round decides on at least one effect.
    while scene.auto.is_some() {
        let mut stopped = false;
        let (rows, _) = estimate(&scene, &mut |at| {
            let flow = progress(at);
            stopped |= flow.is_break();
            flow
        });
        if stopped {
            return Err(Error::Interrupted);
        }
        match decide(&scene, &rows, 0, progress)? {
            (next, true) => scene = next,
            (next, false) => return Ok(next),
        }
    }
    Ok(scene)
}

/// Returns the scene with the effects that its recorded fields require.
fn with_recorded(scene: &Scene, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Scene> {
    if scene.auto.is_none() || !choices(scene).is_empty() {
        return Ok(scene.clone());
    }
    let needs = |(effect, _): &(&str, &str)| {
        let field = scene.record.fields.iter().find(|field| field.needs() == Some(effect))?;
        let why = format!("`{}` is recorded", field.name());
        Some(AutoChoice { effect: (*effect).to_owned(), on: true, why, estimate: f64::INFINITY, round: 0 })
    };
    let needed: Vec<AutoChoice> = WRITTEN.iter().filter_map(needs).collect();
    if needed.is_empty() {
        return Ok(scene.clone());
    }
    for choice in &needed {
        if progress(Progress::Chosen(Box::new(choice.clone()))).is_break() {
            return Err(Error::Interrupted);
        }
    }
    with(scene, &needed)
}

/// Runs a scene, and repeats the run if an effect was neglected: at most once per effect, since each is decided on only once.
pub(super) fn run(
    scene: &Scene,
    mut target: Target<'_>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    let (mut scene, mut round) = match target.chosen.effects {
        Some((round, _)) => (scene.clone(), round),
        None => (choose(scene, progress)?, 1),
    };
    loop {
        let next = target.for_repeat();
        target.chosen.effects = Some((round, choices(&scene).to_vec()));
        let summary = accurate(&scene, target, progress)?;
        let (decided, again) = decide(&scene, &summary.audit, round, progress)?;
        if !again {
            let choices = decided.parts.auto.map(|auto| auto.choices);
            return Ok(Summary { auto: choices, ..summary });
        }
        (scene, target, round) = (decided, next, round + 1);
    }
}

/// Returns the scene with the selected effects.
///
/// # Errors
/// Those of a scene that this version of the program refuses with these effects.
pub(super) fn chosen(mut scene: Scene, choices: &[AutoChoice]) -> Result<Scene> {
    if choices.iter().any(|choice| choice.on) {
        return with(&scene, choices);
    }
    if let Some(auto) = &mut scene.parts.auto {
        auto.choices = choices.to_vec();
    }
    Ok(scene)
}

/// Decides on the relevant effects that are still undecided. Returns the scene and whether its set of effects has changed.
fn decide(
    scene: &Scene,
    rows: &[AuditRow],
    round: usize,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(Scene, bool)> {
    let mut wanted: Vec<&AuditRow> = rows.iter().filter(|row| row.matters() && can_be_written(&row.effect)).collect();
    wanted.sort_by(|a, b| b.estimate.total_cmp(&a.estimate));
    let (mut scene, mut changed) = (scene.clone(), false);
    for row in wanted {
        if choices(&scene).iter().any(|c| c.effect == row.effect) {
            continue;
        }
        let choice = AutoChoice { effect: row.effect.clone(), on: true, why: why(row), estimate: row.estimate, round };
        let (next, on) = take(&scene, &choice);
        let old = choices(&scene).to_vec();
        for choice in choices(&next).iter().filter(|c| !old.contains(c)) {
            if progress(Progress::Chosen(Box::new(choice.clone()))).is_break() {
                return Err(Error::Interrupted);
            }
        }
        (scene, changed) = (next, changed || on);
    }
    Ok((scene, changed))
}

/// Returns the scene with one more effect, if necessary in place of a smaller one, and `true`; otherwise the scene with the reason for the refusal,
/// and `false`.
fn take(scene: &Scene, choice: &AutoChoice) -> (Scene, bool) {
    let mut all = choices(scene).to_vec();
    all.push(choice.clone());
    let refusal = match with(scene, &all) {
        Ok(next) => return (next, true),
        Err(refusal) => refusal.to_string(),
    };
    for k in 0..all.len() - 1 {
        if all[k].on && all[k].estimate < choice.estimate {
            let mut other = all.clone();
            other[k].on = false;
            other[k].why =
                format!("excluded in favour of {}, whose effect is larger: {}", choice.effect, first_line(&refusal));
            if let Ok(next) = with(scene, &other) {
                return (next, true);
            }
        }
    }
    if let Some(last) = all.last_mut() {
        last.on = false;
        last.why = format!("{}; but it cannot be simulated here: {}", last.why, first_line(&refusal));
    }
    let mut next = scene.clone();
    if let Some(auto) = &mut next.parts.auto {
        auto.choices = all;
    }
    (next, false)
}

/// Returns the scene with the selected effects and a method that supports them.
fn with(scene: &Scene, choices: &[AutoChoice]) -> Result<Scene> {
    let on = |key: &str| choices.iter().any(|c| c.on && c.effect == key);
    let written: Vec<String> =
        WRITTEN.iter().filter(|(key, _)| on(key)).map(|(key, value)| format!("{key} = {value}")).collect();
    let effects = format!("effects={{ {} }}", written.join(", "));
    let names_method = scene.names("solve.method");
    let tries: &[&[&str]] = if names_method { &WITHOUT_KEYS } else { &METHODS };
    let mut refusal = None;
    for extra in tries {
        let changes: Vec<String> =
            std::iter::once(effects.clone()).chain(extra.iter().map(|&s| s.to_owned())).collect();
        match scene.with_changes(&changes) {
            Ok(mut next) => {
                if let Some(auto) = &mut next.parts.auto {
                    auto.choices = choices.to_vec();
                }
                return Ok(next);
            }
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    Err(refusal.unwrap_or(Error::Interrupted))
}

fn choices(scene: &Scene) -> &[AutoChoice] {
    scene.auto.as_ref().map_or(&[], |auto| &auto.choices)
}

fn can_be_written(effect: &str) -> bool {
    WRITTEN.iter().any(|(key, _)| *key == effect)
}

fn why(row: &AuditRow) -> String {
    format!("{} (tolerance {:.2} %)", row.considered(), 100.0 * row.threshold)
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}
