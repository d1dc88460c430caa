//! Rate-dependent scenes as users write them: from the text of a scene to its summary and result file.

use std::path::Path;

use barwave::record::store::ResultFile;
use barwave::run::{Wish, run};
use barwave::scene::{Method, Rate, Scene, Unloading};
use barwave::study::plan::plan;

const MODULUS: f64 = 200e9;
const DENSITY: f64 = 7800.0;
const YIELD: f64 = 200e6;

fn scene(effects: &str, solve: &str, rest: &str) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\narea = 1e-4\n[bar.material]\nname = \"steel\"\ndensity = {DENSITY}\nmodulus = {MODULUS}\n\
         beyond = \"extend\"\ncurve = {{ table = [[0.001, 200e6], [0.021, 600e6]] }}\n[left]\nkind = \"velocity\"\n\
         value = 20\n[right]\nkind = \"free\"\n[effects]\n{effects}\n[solve]\nuntil = \"150 us\"\n{solve}\n{rest}"
    );
    Scene::parse("rate", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

const MALVERN: &str = "rate = { model = \"malvern\", k = \"1e4 1/s\" }";

#[test]
fn rate_chooses_the_characteristic_net_and_brings_elastic_unloading() {
    for solve in ["", "method = \"moc\""] {
        let scene = scene(MALVERN, solve, "");
        assert_eq!(scene.solve.method, Method::CharacteristicNet { cells: 1000 });
        assert_eq!(scene.effects.rate, Some(Rate::Malvern { k: 1e4 }));
        assert_eq!(scene.effects.unloading, Some(Unloading::Isotropic));
        let resolved = scene.resolved_json();
        assert_eq!(resolved["effects"]["rate"]["model"], "malvern");
        assert_eq!(resolved["solve"]["cells"], 1000);
    }
    let own = format!("unloading = \"kinematic\"\n{MALVERN}");
    assert_eq!(scene(&own, "cells = 50", "").effects.unloading, Some(Unloading::Kinematic));
    let other = scene("rate = { model = \"cowper-symonds\", D = \"40 1/s\", q = 5 }", "", "").effects.rate;
    assert_eq!(other, Some(Rate::CowperSymonds { d: 40.0, q: 5.0 }));
    let other = scene("rate = { model = \"johnson-cook\", C = 0.014, reference = \"1 1/s\" }", "", "").effects.rate;
    assert_eq!(other, Some(Rate::JohnsonCook { c: 0.014, reference: 1.0 }));
}

#[test]
fn a_run_shows_the_decay_of_the_precursor_in_its_fields_and_gauges() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("rate.h5");
    let rest = "[record]\nframes = 2\nfields = [\"stress\", \"plastic_strain\"]\ngauges = { middle = 0.49995 }";
    let scene = scene(MALVERN, "cells = 10000", rest);
    let summary = run(&scene, Some(&file), &mut |_| Wish::GoOn).expect("it runs");
    assert_eq!((summary.method.as_str(), summary.scheme.as_str()), ("moc", "characteristic-net"));
    assert_eq!(summary.outcome, "done");
    assert!(summary.effects.iter().any(|e| e.starts_with("rate: malvern")), "{:?}", summary.effects);
    // 1e7 cell-steps of rounding.
    assert!(summary.ledger.energy_residual < 1e-12 && summary.ledger.momentum_residual < 1e-12);
    assert!(summary.error.is_none(), "the self-similar solution knows no strain rate");
    let c0 = (MODULUS / DENSITY).sqrt();
    let behind = |x: f64| YIELD + (DENSITY * c0 * 20.0 - YIELD) * (-1e4 * x / (2.0 * c0)).exp();
    let result = ResultFile::open(&file).expect("a result file");
    let gauge = &result.gauges().expect("gauges")[0].trace;
    let first = gauge.stress.iter().position(|s| s.abs() > 0.9 * behind(0.5)).expect("the front arrives");
    // The gauge is in the middle of a cell, half a cell behind the front when it is first passed: k dt/4 of the
    // overstress less than at the front, 5e-5 at most.
    let relative = gauge.stress[first] / -behind(0.49995) - 1.0;
    assert!(relative.abs() < 5e-5, "{relative:e}");
    let late = gauge.time[first] - 0.49995 / c0;
    assert!((0.0..=2e-4 / c0).contains(&late), "{late:e}");
    let ledger = result.ledger().expect("a ledger");
    let last = ledger.last().expect("rows");
    assert!(
        last.energies.viscoplastic > 0.05 * last.energies.plastic,
        "the overstress took work: {} {}",
        last.energies.viscoplastic,
        last.energies.plastic
    );
}

#[test]
fn a_plan_says_how_well_the_flow_is_resolved_and_what_rounding_costs() {
    let work = serde_json::to_value(plan(&scene(MALVERN, "cells = 100", ""))).expect("json");
    let dt = 1.0 / 100.0 / (MODULUS / DENSITY).sqrt();
    assert!((work["k_dt"].as_f64().expect("a number") / (1e4 * dt) - 1.0).abs() < 1e-12);
    assert_eq!(work["largest_transit_shift"], 0.0);
    assert_eq!((work["scheme"].as_str(), work["cells"].as_u64()), (Some("characteristic-net"), Some(100)));
}

#[test]
fn above_the_static_critical_velocity_the_rate_carries_the_bar_on() {
    let effects = "rate = { model = \"malvern\", k = \"1e5 1/s\" }";
    let mut text = scene(effects, "cells = 300", "").text;
    text = text.replace("[0.021, 600e6]", "[0.05, 250e6]").replace("\"extend\"", "\"rupture\"");
    text = text.replace("value = 20", "value = 60").replace("\"150 us\"", "\"20 us\"");
    let scene = Scene::parse("rate", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"));
    let summary = run(&scene, None, &mut |_| Wish::GoOn).expect("it runs");
    assert!(summary.above_critical, "of the static curve");
    assert_eq!(summary.outcome, "done", "the strain at the end has not reached the end of the data");
}

#[test]
fn fronts_paths_are_refused_where_no_fronts_are_followed() {
    let text = scene(MALVERN, "", "").text + "[record]\npaths = true";
    let refused = Scene::parse("rate", &text, Path::new("."), &[]).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|message| message.contains("means nothing for a rate-dependent bar")));
}

#[test]
fn flow_that_the_net_does_not_resolve_is_noted() {
    let notes = |k: &str| {
        let effects = format!("rate = {{ model = \"malvern\", k = \"{k} 1/s\" }}");
        let summary = run(&scene(&effects, "cells = 100", ""), None, &mut |_| Wish::GoOn).expect("it runs");
        summary.audit.into_iter().filter(|row| row.effect == "rate").map(|row| row.estimate).collect::<Vec<_>>()
    };
    assert!(notes("1e5").is_empty());
    let dt = 0.01 / (MODULUS / DENSITY).sqrt();
    assert!(notes("1e7").iter().all(|k_dt| (k_dt / (1e7 * dt) - 1.0).abs() < 1e-12));
    assert_eq!(notes("1e7").len(), 1);
}

#[test]
fn a_rate_scene_runs_on_the_grid_where_it_asks_for_that() {
    let on_grid = scene(MALVERN, "method = \"fd\"\ncells = 1000", "");
    let summary = run(&on_grid, None, &mut |_| Wish::GoOn).expect("it runs");
    assert_eq!((summary.method.as_str(), summary.scheme.as_str()), ("fd", "leapfrog"));
    assert!(summary.effects.iter().any(|e| e.starts_with("rate: malvern")), "{:?}", summary.effects);
    // 1e6 cell-steps of rounding.
    assert!(summary.ledger.energy_residual < 1e-12 && summary.ledger.momentum_residual < 1e-12, "{:?}", summary.ledger);
    let bytes = |effects: &str| {
        let work = serde_json::to_value(plan(&scene(effects, "method = \"fd\"", ""))).expect("json");
        work["bytes_per_yielded_cell"].as_u64()
    };
    // Stress, velocity and the damping's byte, and 2, 5 or 6 numbers of the law.
    assert_eq!(bytes("unloading = \"isotropic\""), Some(33));
    assert_eq!(bytes(MALVERN), Some(57));
    assert_eq!(bytes(&format!("unloading = \"kinematic\"\n{MALVERN}")), Some(65));
}
