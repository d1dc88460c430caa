//! The seven qualitative results of the chapter's section on beams, with the numbers of `runs/beam.toml`. The page on other impacts shows the same
//! runs and figures.

use std::f64::consts::PI;

use barwave::record::store::StoredImpact;
use serde_json::Value;

use crate::common::impacts::{number, recorded, run};

const STRAIN: &str = "/gauges/middle/peak_strain";
const SHAPES: &str = "record.shapes=200";
/// A fifth of critical damping in mode 1.
const EXTERNAL: &str = "beam.external-damping=\"2 kN*s/m^2\"";
const INTERNAL: &str = "beam.internal-damping=\"1 MPa*s\"";
const RISE: &str = "solve.until=\"100 us\"";

fn strain(sets: &[&str]) -> f64 {
    number(&run("beam.toml", sets), STRAIN).abs()
}

#[track_caller]
fn close(value: f64, shown: f64) {
    assert!((value / shown - 1.0).abs() < 0.006, "{value}, the page shows {shown}");
}

/// Returns times and modal displacements of mode n, m, by projection of the deflected shapes.
fn modal(impact: &StoredImpact, n: usize) -> Vec<[f64; 2]> {
    let shapes = impact.shapes.as_ref().expect("deflected shapes");
    let count = shapes.x.len();
    let project = |row: &[f64]| {
        let terms = row.iter().enumerate().map(|(i, w)| w * (PI * n as f64 * i as f64 / (count - 1) as f64).sin());
        2.0 / (count - 1) as f64 * terms.sum::<f64>()
    };
    shapes.time.iter().zip(shapes.deflection.chunks(count)).map(|(t, row)| [*t, project(row)]).collect()
}

fn largest<'a>(history: impl Iterator<Item = &'a [f64; 2]>) -> f64 {
    history.fold(0.0, |most: f64, [_, q]| most.max(q.abs()))
}

/// Returns the largest displacement of a mode, and that in the second half of the run.
fn amplitudes(impact: &StoredImpact, n: usize) -> [f64; 2] {
    let history = modal(impact, n);
    let half = 0.5 * history.last().expect("rows")[0];
    [largest(history.iter()), largest(history.iter().filter(|[t, _]| *t > half))]
}

/// Returns the damping ratio of mode n: that of the lowest mode is in the summary, and each kind is proportional to a power of n.
fn damping(summary: &Value, n: f64, power: i32) -> f64 {
    number(summary, "lowest_damping") * n.powi(power)
}

#[test]
fn result_1_small_slow_masses_cause_significant_strains() {
    let summary = run("beam.toml", &["striker.radius=\"5 mm\"", "striker.velocity=\"3 m/s\""]);
    close(number(&summary, STRAIN), 3.3e-4);
    // 4.2 g compared with 122 g of the beam; E times the strain is 71.5 MPa.
    close(4.0 / 3.0 * PI * 0.005_f64.powi(3) * 7960.0, 4.17e-3);
    close(number(&summary, STRAIN) * 2.2e6 * 9.806_65e4, 71.5e6);
}

#[test]
fn result_2_external_damping_acts_on_the_lowest_modes() {
    let (plain, damped) = (recorded("beam.toml", &[SHAPES]).1, recorded("beam.toml", &[SHAPES, EXTERNAL]));
    let reduction = |n| 1.0 - amplitudes(&damped.1, n)[0] / amplitudes(&plain, n)[0];
    let [one, three, five] = [1, 3, 5].map(reduction);
    assert!((0.215..0.225).contains(&one) && (0.018..0.022).contains(&three) && five < 0.001, "{one} {three} {five}");
    for (n, shown) in [(1.0, 0.2), (3.0, 0.0222), (9.0, 0.002_46)] {
        close(damping(&damped.0, n, -2), shown);
    }
}

#[test]
fn result_3_internal_damping_acts_on_the_higher_modes() {
    let (plain, damped) = (recorded("beam.toml", &[SHAPES]).1, recorded("beam.toml", &[SHAPES, INTERNAL]));
    let reduction = |n| 1.0 - amplitudes(&damped.1, n)[1] / amplitudes(&plain, n)[1];
    let [one, three, five] = [1, 3, 5].map(reduction);
    assert!((0.07..0.075).contains(&one) && (0.945..0.955).contains(&three) && five > 0.999, "{one} {three} {five}");
    for (n, shown) in [(1.0, 0.0146), (3.0, 0.131), (9.0, 1.18)] {
        close(damping(&damped.0, n, 2), shown);
    }
    // Aperiodic: after the contact, mode 9 returns without oscillation. Without damping it oscillates.
    let after = |impact: &StoredImpact| {
        let history: Vec<f64> = modal(impact, 9).iter().filter(|[t, _]| *t > 160e-6).map(|[_, q]| *q).collect();
        // Below a millionth of the largest displacement, 3e-10 m, the projection is rounding.
        history.windows(2).filter(|w| w[0] * w[1] < 0.0 && w[0].abs().max(w[1].abs()) > 3e-16).count()
    };
    assert!(after(&damped.1) <= 1 && after(&plain) > 50, "{} {}", after(&damped.1), after(&plain));
}

#[test]
fn result_4_a_stiffer_foundation_takes_less_energy() {
    let taken = |k: &str| {
        let e =
            number(&run("beam.toml", &[&format!("beam.foundation=\"{k} MN/m^2\""), "record.gauges="]), "restitution");
        (e, 1.0 - e * e)
    };
    let all = ["0", "50", "200", "1000", "2000"].map(taken);
    assert!(all.windows(2).all(|pair| pair[1].1 < pair[0].1), "{all:?}");
    close(all[0].0, 0.302);
    close(all[2].0, 0.477);
    close(all[0].1, 0.909);
    close(all[2].1, 0.773);
}

#[test]
fn result_5_damping_leaves_the_initial_rise_of_strain() {
    let [plain, external, internal] = [&[RISE][..], &[RISE, EXTERNAL], &[RISE, INTERNAL]].map(strain);
    close(plain, 1.553e-6);
    close(external, 1.539e-6);
    close(internal, 1.511e-6);
    assert!(external < plain && internal < plain && internal > 0.97 * plain, "{plain} {external} {internal}");
}

#[test]
fn result_6_ordinary_damping_leaves_the_strain_of_every_impact() {
    let (plain, damped) = (strain(&[]), run("beam.toml", &["beam.external-damping=\"200 N*s/m^2\""]));
    close(number(&damped, "lowest_damping"), 0.02);
    let largest = number(&damped, STRAIN).abs();
    close(plain, 2.636e-6);
    close(largest, 2.560e-6);
}

#[test]
fn result_7_one_degree_of_freedom_misses_the_strain() {
    let length = "beam.length=\"30.7 cm\"";
    let gauge = "record.gauges={ middle = \"15.35 cm\" }";
    let (all, one) = (strain(&[length, gauge]), strain(&[length, gauge, "solve.modes=1"]));
    close(all, 2.736e-6);
    close(one, 1.890e-6);
}
