//! Names of the metrics of bars: those of the summary and of its figures.

use crate::input::nearest;
use crate::record::definitions;

/// Keys of the summary of a bar, besides the figures, with which a metric can start. Names inside its lists are not checked.
const SUMMARY: [&str; 32] = [
    "method",
    "scheme",
    "effects",
    "cells",
    "steps",
    "events",
    "wall_s",
    "step_wall_s",
    "cell_steps_per_s",
    "front_tolerance",
    "stress_scale_Pa",
    "fronts_under_way",
    "events_per_s",
    "end_time_s",
    "lengths",
    "torsion",
    "fronts",
    "critical_velocity_m_s",
    "above_critical",
    "elastic_check",
    "ledger",
    "error",
    "errors",
    "choice",
    "ruptures",
    "auto",
    "largest_temperature_rise_K",
    "audit",
    "notes",
    "scene",
    "outcome",
    "output",
];

/// Keys of the ends, besides their figures.
const ENDS: [&str; 4] = ["stress_Pa", "strain", "velocity_m_s", "striker_velocity_m_s"];

/// Returns the keys of the figures of a place, as the reference names it.
fn figures(place: &str) -> Vec<String> {
    definitions().into_iter().filter(|[places, ..]| places.contains(place)).map(|[_, key, ..]| key).collect()
}

/// Returns the part of a metric name up to its unknown component, with the names that are valid in its place, or `None` if the name is known.
fn alternatives(name: &str) -> Option<(String, Vec<String>)> {
    let parts: Vec<&str> = name.strip_prefix("figures.").unwrap_or(name).split('.').collect();
    let of_place = |at: usize, known: Vec<String>| {
        let part = parts.get(at)?;
        let known: Vec<String> = known.iter().map(|key| format!("{}.{key}", parts[..at].join("."))).collect();
        let own = format!("{}.{part}", parts[..at].join("."));
        (!known.contains(&own)).then_some((own, known))
    };
    match parts[0] {
        end @ ("left" | "right") => {
            let all = figures(&format!("`{end}`")).into_iter().chain(ENDS.map(str::to_owned));
            of_place(1, all.collect())
        }
        "joints" => of_place(2, figures("`joints.N`")),
        "segments" => of_place(2, figures("`segments.N`")),
        // The name of a gauge may contain dots.
        "gauges" => None,
        first => {
            let known: Vec<String> = figures("bar").into_iter().chain(SUMMARY.map(str::to_owned)).collect();
            let with_places =
                known.iter().cloned().chain(["left", "right", "joints", "segments", "gauges"].map(str::to_owned));
            (!known.iter().any(|key| key == first)).then(|| (first.to_owned(), with_places.collect()))
        }
    }
}

/// Returns a help text for the name of a metric that no bar has, or `None` if a bar may have it.
pub(super) fn unknown(name: &str) -> Option<String> {
    let (own, known) = alternatives(name)?;
    let near = nearest(&own, known.iter().map(String::as_str));
    let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
    Some(format!("{near}The names are those of `barwave run --json`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_no_bar_has_are_told() {
        for known in [
            "left.peak_force_N",
            "right.strain",
            "figures.left.restitution",
            "joints.1.peak_stress_Pa",
            "gauges.a.b.peak_strain",
            "residual_strain_profile.3",
            "fronts.0.speed_m_s",
            "ledger.energy_residual",
            "permanent_elongation_m",
        ] {
            assert_eq!(unknown(known), None, "{known}");
        }
        let help = |name: &str| unknown(name).unwrap_or_default();
        assert!(help("left.peak_forc_N").starts_with("did you mean `left.peak_force_N`? "));
        assert!(help("lefft.peak_force_N").contains("`left`"));
        assert!(help("permanent_elongation").contains("`permanent_elongation_m`"));
        assert!(help("segments.0.final_lenght_m").contains("`segments.0.final_length_m`"));
        assert!(unknown("zzz").is_some());
    }
}
