//! Cost of each effect of the scene: the same grid with and without it, in alternating runs.

use serde::Serialize;

use super::measure::{self, Timing, Wanted, Watch, interquartile_range, timing};
use super::refinement::Halt;
use super::source::{Family, Resolution, Source};
use crate::scene::{Effects, Scene};

/// Cells of the grid on which effects are timed. The grid fits into the cache, and its steps are long compared with their overhead.
const CELLS: usize = 1000;

/// Fewest and most pairs of runs with and without an effect, and the time after which no further pair is started, s.
const LEAST_TURNS: usize = 5;
const MOST_TURNS: usize = 41;
const TURNS_FOR: f64 = 0.5;

/// Cost of one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectCost {
    /// Effect as in summaries, e.g. "hardening: isotropic".
    pub effect: String,
    /// Time per cell-step added by the effect, ns; null if the effect cannot be disabled alone.
    pub ns_per_cell_step: Option<f64>,
    /// Interquartile range of this time over the pairs of runs with and without the effect, ns. A smaller added time is not measurable.
    pub ns_spread: Option<f64>,
    /// Ratio of the stepping times with and without the effect.
    pub ratio_to_none: Option<f64>,
    /// Time per cell-step with the effect, ns.
    pub ns_with: Option<f64>,
    /// Cells of the grid.
    pub cells: usize,
    /// "leapfrog", ...
    pub scheme: String,
    /// Interquartile range of the stepping times relative to their median; the larger value of the runs with and without the effect.
    pub spread: Option<f64>,
    /// Reason why there is no figure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// Times every active effect. Effects that could not be timed are listed with the reason. The flag is true if the user interrupted the study.
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
            ns_spread: None,
            ratio_to_none: None,
            ns_with: None,
            cells: CELLS,
            scheme: family.names[1].into(),
            spread: None,
            why: None,
        };
        match one(source, family, key, watch) {
            Ok(Pairs { with, without, spread, work }) => {
                let ns = |seconds: f64| seconds / work * 1e9;
                costs.push(EffectCost {
                    ns_per_cell_step: Some(ns(with.median) - ns(without.median)),
                    ns_spread: Some(ns(spread)),
                    ratio_to_none: Some(with.median / without.median),
                    ns_with: Some(ns(with.median)),
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

/// Stepping times of alternating runs with and without an effect.
struct Pairs {
    with: Timing,
    without: Timing,
    /// Interquartile range of the differences between the two runs of a pair, s.
    spread: f64,
    /// Cell-steps of a run.
    work: f64,
}

/// Times one effect.
fn one(source: &Source<'_>, family: &Family, key: &str, watch: &mut Watch<'_>) -> Result<Pairs, Halt> {
    watch.what = format!("cost of {key}");
    let failed = |e: crate::error::Error| Halt::Failed(e.to_string());
    let with = source.at(family.choice, Resolution::Cells(CELLS)).map_err(failed)?;
    let mut overrides = source.overrides(family.choice, Some(Resolution::Cells(CELLS)));
    // Recording does not affect the stepping time, and a recorded field may exist only with this effect.
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
    let mut added: Vec<f64> = on.iter().zip(&off).map(|(on, off)| on - off).collect();
    added.sort_by(f64::total_cmp);
    Ok(Pairs { spread: interquartile_range(&added), with: timing(on), without: timing(off), work })
}
