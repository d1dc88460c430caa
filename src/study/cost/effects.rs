//! Cost of each effect of the scene: the same grid with it and without it, alternating.

use serde::Serialize;

use super::measure::{self, Timing, Wanted, Watch, timing};
use super::refinement::Halt;
use super::source::{Family, Resolution, Source};
use crate::scene::{Effects, Scene};

/// Cells of the grid on which effects are timed: it fits into the cache, and its steps are long beside their overhead.
const CELLS: usize = 1000;

/// Turns, at least and at most, and for how long, s.
const LEAST_TURNS: usize = 5;
const MOST_TURNS: usize = 41;
const TURNS_FOR: f64 = 0.5;

/// The cost of one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectCost {
    /// As in summaries, e.g. "hardening: isotropic".
    pub effect: String,
    /// Added by it, ns; null where it cannot be left off alone.
    pub ns_per_cell_step: Option<f64>,
    /// Stepping time with it over that without.
    pub ratio_to_none: Option<f64>,
    /// ns a cell-step with it.
    pub ns_with: Option<f64>,
    /// Cells of the grid.
    pub cells: usize,
    /// "leapfrog", ...
    pub scheme: String,
    /// Distance of the quartiles over the median, of the slower of both.
    pub spread: Option<f64>,
    /// Why there is no figure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// Times every effect that is on; those that the time does not allow are named too.
pub(super) fn effects(
    scene: &Scene,
    source: &Source<'_>,
    families: &[Family],
    watch: &mut Watch<'_>,
) -> (Vec<EffectCost>, bool) {
    let grid = |name: &str| families.iter().find(|f| f.names[1] == name);
    let Some(family) =
        grid("leapfrog").or_else(|| families.iter().find(|f| matches!(f.levels[0], Resolution::Cells(_))))
    else {
        return (Vec::new(), false);
    };
    let mut costs = Vec::new();
    for key in Effects::KEYS {
        let Some(effect) = scene.effects.named(key) else { continue };
        let none = EffectCost {
            effect,
            ns_per_cell_step: None,
            ratio_to_none: None,
            ns_with: None,
            cells: CELLS,
            scheme: family.names[1].into(),
            spread: None,
            why: None,
        };
        match one(source, family, key, watch) {
            Ok((with, without, work)) => {
                let ns = |timing: Timing| timing.median / work * 1e9;
                costs.push(EffectCost {
                    ns_per_cell_step: Some(ns(with) - ns(without)),
                    ratio_to_none: Some(with.median / without.median),
                    ns_with: Some(ns(with)),
                    spread: Some(with.spread.max(without.spread)),
                    ..none
                });
            }
            Err(Halt::Interrupted) => return (costs, true),
            Err(Halt::OutOfTime) => costs.push(EffectCost { why: Some("the budget was used up".into()), ..none }),
            Err(Halt::Failed(why)) => costs.push(EffectCost { why: Some(why), ..none }),
        }
    }
    (costs, false)
}

/// Stepping times with and without an effect, and the cell-steps of a run.
fn one(source: &Source<'_>, family: &Family, key: &str, watch: &mut Watch<'_>) -> Result<(Timing, Timing, f64), Halt> {
    watch.what = format!("cost of {key}");
    let failed = |e: crate::error::Error| Halt::Failed(e.to_string());
    let with = source.at(family.choice, Resolution::Cells(CELLS)).map_err(failed)?;
    let mut overrides = source.overrides(family.choice, Some(Resolution::Cells(CELLS)));
    // What is recorded plays no part here, and could be something that only this effect makes.
    overrides.extend(["record={frames=1,fields=[\"stress\"]}".to_owned(), format!("effects.{key}=")]);
    let alone = |why: &str| Halt::Failed(format!("it cannot be disabled alone: {why}"));
    let without = source.read(&overrides).map_err(|e| match e {
        crate::error::Error::Input(e) => alone(&e.message),
        other => alone(&other.to_string()),
    })?;
    if without.effects.named(key).is_some() {
        return Err(alone("another effect implies it"));
    }
    if without.solve.method != with.solve.method {
        return Err(alone("without it the scene is solved by another scheme"));
    }
    let (mut on, mut off, mut work) = (Vec::new(), Vec::new(), 1.0);
    let from = watch.now();
    while on.len() < LEAST_TURNS || (on.len() < MOST_TURNS && watch.now() - from < TURNS_FOR) {
        let pass = measure::pass(&with, Wanted::TIME, watch)?;
        work = pass.work as f64;
        on.push(pass.seconds);
        off.push(measure::pass(&without, Wanted::TIME, watch)?.seconds);
    }
    Ok((timing(on), timing(off), work))
}
