//! Rate-dependent scenes from the text of a scene to its summary and result file.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::law::rate::Overstress;
use barwave::record::Field;
use barwave::record::store::ResultFile;
use barwave::run::run;
use barwave::scene::{HardeningRule, Method, Rate, Scene};
use barwave::study::plan::plan;

/// A process that is started while a result file is open inherits its lock.
static FILES: std::sync::Mutex<()> = std::sync::Mutex::new(());

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
        assert_eq!(scene.effects.hardening, Some(HardeningRule::Isotropic));
        let resolved = scene.resolved_json();
        assert_eq!(resolved["effects"]["rate"]["model"], "malvern");
        assert_eq!(resolved["solve"]["cells"], 1000);
    }
    let own = format!("hardening = \"kinematic\"\n{MALVERN}");
    assert_eq!(scene(&own, "cells = 50", "").effects.hardening, Some(HardeningRule::Kinematic));
    let other = scene("rate = { model = \"cowper-symonds\", D = \"40 1/s\", q = 5 }", "", "").effects.rate;
    assert_eq!(other, Some(Rate::CowperSymonds { d: 40.0, q: 5.0 }));
    let other = scene("rate = { model = \"johnson-cook\", C = 0.014, reference = \"1 1/s\" }", "", "").effects.rate;
    assert_eq!(other, Some(Rate::JohnsonCook { c: 0.014, reference: 1.0 }));
}

const ZERILLI_ARMSTRONG: &str = "rate = { model = \"zerilli-armstrong\", C1 = \"1 GPa\", C3 = \"0.007 1/K\", C4 = \"8e-4 \
                                 1/K\", reference = \"1e-3 1/s\" }";

/// Returns the same bar with the temperature at which its curve is valid.
fn at_300_kelvin(effects: &str, solve: &str, rest: &str) -> String {
    let text = scene(MALVERN, solve, rest).text.clone();
    let material = "beyond = \"extend\"\nheat = { specific-heat = 460, reference-temperature = 300, melting-temperature = \
                    1800, m = 1 }";
    text.replace("beyond = \"extend\"", material).replace(MALVERN, effects)
}

/// Through the binary: behind the elastic front, the overstress x of a bar at its yield stress decreases with the distance s as `dx/ds = -q(x)/(2
/// c0)`.
#[test]
fn the_precursor_of_zerilli_and_armstrong_decays() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (c0, sensitivity) = ((MODULUS / DENSITY).sqrt(), 8e-4 * 300.0);
    let reference_stress = 1e9 * (-0.007 * 300.0 + sensitivity * 1e-3_f64.ln()).exp();
    let power = 1.0 - 1.0 / sensitivity;
    let behind = |s: f64| {
        let start = (DENSITY * c0 * 20.0 - YIELD + reference_stress) / reference_stress;
        let fall = power * MODULUS * 1e-3 / reference_stress * s / (2.0 * c0);
        YIELD + reference_stress * ((start.powf(power) - fall).powf(1.0 / power) - 1.0)
    };
    let record = "[record]\ntimes = [\"90 us\"]\nfields = [\"stress\"]";
    let heated = format!("heat = {{}}\n{ZERILLI_ARMSTRONG}");
    for (effects, solve, bound) in [
        (ZERILLI_ARMSTRONG, "method = \"moc\"\ncells = 2000", 1e-3),
        (ZERILLI_ARMSTRONG, "method = \"fd\"\ncells = 2000", 1e-3),
        (&heated, "method = \"fd\"\ncells = 2000", 1e-3),
    ] {
        let file = folder.path().join("scene.toml");
        // The bar is no longer than the distance that the wave travels.
        let text =
            at_300_kelvin(effects, solve, record).replace("length = 1", "length = 0.5").replace("150 us", "91 us");
        std::fs::write(&file, text).expect("written");
        let _alone = FILES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_barwave"))
            .args(["run", "scene.toml", "-o", "out.h5"])
            .current_dir(folder.path())
            .output()
            .expect("the binary runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let result = ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
        let frames = result.field(Field::Stress, 0..1).expect("stresses");
        let stress: Vec<f64> = frames.iter().map(|s| s.abs()).collect();
        // The cell that contains the front has a mean over time.
        let front = stress.iter().rposition(|s| *s > 0.9 * behind(90e-6 * c0)).expect("a front") - 2;
        let exact = behind((front as f64 + 0.5) / 4000.0);
        println!("{solve}: {} {exact}", stress[front]);
        assert!((front as f64 / 4000.0 - 90e-6 * c0).abs() < 1e-3, "{front}");
        assert!((stress[front] / exact - 1.0).abs() < bound, "{solve}: {} {exact}", stress[front]);
    }
}

#[test]
fn a_law_of_temperature_needs_that_of_the_curve() {
    let text = scene(MALVERN, "", "").text.replace(MALVERN, ZERILLI_ARMSTRONG);
    let refused = Scene::parse("rate", &text, Path::new("."), &[]).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|message| message.contains("needs the reference temperature of the curve of `steel`")));
    let stated = ZERILLI_ARMSTRONG.replace("rate = { model = \"zerilli-armstrong\",", "rate.zerilli-armstrong = {");
    let material = |heat: &str| {
        let own = format!("beyond = \"extend\"\n{stated}\n{heat}");
        let text = scene(MALVERN, "", "").text.replace(MALVERN, "rate = \"material\"");
        Scene::parse("rate", &text.replace("beyond = \"extend\"", &own), Path::new("."), &[])
    };
    let refused = material("").err().map(|error| error.to_string());
    assert!(refused.is_some_and(|message| message.contains("needs the reference temperature of the curve")));
    let scene = material("heat = { reference-temperature = 300 }").unwrap_or_else(|error| panic!("{error}"));
    let steel = &scene.bar.segments[0].material;
    let law = Rate::ZerilliArmstrong { c1: 1e9, c3: 0.007, c4: 8e-4, reference: 1e-3 };
    assert_eq!(steel.constants.rate, [law]);
    assert!(
        Overstress::of(law, steel).is_some() && Overstress::of(Rate::Material, steel) == Overstress::of(law, steel)
    );
}

#[test]
fn a_run_shows_the_decay_of_the_precursor_in_its_fields_and_gauges() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("rate.h5");
    let rest = "[record]\nframes = 2\nfields = [\"stress\", \"plastic_strain\"]\ngauges = { middle = 0.49995 }";
    let scene = scene(MALVERN, "cells = 10000", rest);
    let _alone = FILES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let summary = run(&scene, Some(&file), &mut |_| ControlFlow::Continue(())).expect("it runs");
    assert_eq!((summary.method.as_str(), summary.scheme.as_str()), ("moc", "characteristic-net"));
    assert_eq!(summary.outcome, "done");
    assert!(summary.effects.iter().any(|e| e.starts_with("rate: malvern")), "{:?}", summary.effects);
    // Rounding of 1e7 cell-steps.
    assert!(summary.ledger.energy_residual < 1e-12 && summary.ledger.momentum_residual < 1e-12);
    assert!(summary.error.is_none(), "the self-similar solution knows no strain rate");
    let c0 = (MODULUS / DENSITY).sqrt();
    let behind = |x: f64| YIELD + (DENSITY * c0 * 20.0 - YIELD) * (-1e4 * x / (2.0 * c0)).exp();
    let result = ResultFile::open(&file).expect("a result file");
    let gauge = &result.gauges().expect("gauges")[0].trace;
    let first = gauge.stress.iter().position(|s| s.abs() > 0.9 * behind(0.5)).expect("the front arrives");
    // The gauge is in the middle of a cell, half a cell behind the front at first: the overstress is less than at the front by k dt/4 of it, 5e-5 at
    // most.
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
    let mut text = scene(effects, "cells = 300", "").text.clone();
    text = text.replace("[0.021, 600e6]", "[0.05, 250e6]").replace("\"extend\"", "\"rupture\"");
    text = text.replace("value = 20", "value = 60").replace("\"150 us\"", "\"20 us\"");
    let scene = Scene::parse("rate", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"));
    let summary = run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    assert!(summary.above_critical, "of the static curve");
    assert_eq!(summary.outcome, "done", "the strain at the end has not reached the end of the data");
}

#[test]
fn fronts_paths_are_refused_where_no_fronts_are_followed() {
    let text = scene(MALVERN, "", "").text.clone() + "[record]\npaths = true";
    let refused = Scene::parse("rate", &text, Path::new("."), &[]).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|message| message.contains("does not apply to a rate-dependent bar")));
}

#[test]
fn flow_that_the_net_does_not_resolve_is_noted() {
    let notes = |k: &str| {
        let effects = format!("rate = {{ model = \"malvern\", k = \"{k} 1/s\" }}");
        let summary =
            run(&scene(&effects, "cells = 100", ""), None, &mut |_| ControlFlow::Continue(())).expect("it runs");
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
    let summary = run(&on_grid, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    assert_eq!((summary.method.as_str(), summary.scheme.as_str()), ("fd", "leapfrog"));
    assert!(summary.effects.iter().any(|e| e.starts_with("rate: malvern")), "{:?}", summary.effects);
    // Rounding of 1e6 cell-steps.
    assert!(summary.ledger.energy_residual < 1e-12 && summary.ledger.momentum_residual < 1e-12, "{:?}", summary.ledger);
    let bytes = |effects: &str| {
        let work = serde_json::to_value(plan(&scene(effects, "method = \"fd\"", ""))).expect("json");
        work["bytes_per_yielded_cell"].as_u64()
    };
    // Stress, velocity, the flow indicator of the cell (4 bytes), 2, 5 or 6 state variables of the law, and two waves once the cell is elastic again.
    assert_eq!(bytes("hardening = \"isotropic\""), Some(52));
    assert_eq!(bytes(MALVERN), Some(76));
    assert_eq!(bytes(&format!("hardening = \"kinematic\"\n{MALVERN}")), Some(84));
}

/// A cell that is represented by two waves has two numbers more than it needs once it has yielded without hardening.
#[test]
fn the_largest_memory_is_that_of_elastic_or_of_yielded_cells() {
    for effects in ["", "hardening = \"isotropic\""] {
        let work = serde_json::to_value(plan(&scene(effects, "method = \"fd\"", ""))).expect("json");
        let number = |key: &str| work[key].as_u64().expect("a number");
        let most = number("bytes_per_elastic_cell").max(number("bytes_per_yielded_cell"));
        assert_eq!(number("memory_bytes"), number("cells") * most, "{effects}");
    }
}

/// A segment whose material has no rate constants follows the quasi-static curve, which the run notes.
#[test]
fn segments_without_rate_constants_are_noted() {
    let segment = |material: &str| format!("[[bar.segment]]\nlength = 0.2\nmaterial = \"{material}\"\n");
    let text = |second: &str| {
        format!(
            "{}{}[left]\nkind = \"velocity\"\nvalue = 5\n[right]\nkind = \"free\"\n[effects]\nrate = \"material\"\n\
             [solve]\nuntil = 1e-5\n",
            segment("aluminium-6061-t6-jc"),
            segment(second)
        )
    };
    let notes = |second: &str| Scene::parse("s.toml", &text(second), Path::new("."), &[]).expect("a scene").notes();
    assert!(notes("aluminium-6061-t6-jc").is_empty());
    let noted = notes("copper-annealed");
    assert!(noted.len() == 1 && noted[0].contains("segment 2 (copper-annealed)"), "{noted:?}");
}
