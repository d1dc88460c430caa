//! Spheres, plates and beams through the real binary: numbers of the textbook, ledgers, result files, reports, plans and cost studies.

use std::process::Command;

use serde_json::Value;

use crate::common::binary;
use crate::common::impacts::{barwave, number, recorded, run, scene, to_six_digits, within};

#[test]
fn restitution_and_pendulum_have_the_textbook_s_velocities() {
    let summary = run("spheres-restitution.toml", &[]);
    within(&summary, "striker_velocity_m_s", -0.76, 1e-14);
    within(&summary, "struck_velocity_m_s", 2.84, 1e-14);
    // 2*25/2 + 3/2 before the impact, 2*0.5776/2 + 3*8.0656/2 after it.
    within(&summary, "energy_lost_J", 26.5 - 0.5776 - 12.0984, 1e-12);
    within(&run("ballistic-pendulum.toml", &[]), "striker_velocity_before_m_s", 301.5, 1e-11);
}

#[test]
fn the_energy_method_knows_the_critical_velocity_and_elastic_specimens() {
    let light = |velocity: &str| {
        let velocity = format!("striker.velocity=\"{velocity}\"");
        let sets =
            ["specimen.energy=", "specimen.material=\"steel-4340-tempered-315c\"", "striker.mass=\"1 g\"", &velocity];
        run("energy-method.toml", &sets)
    };
    let fast = light("200 m/s");
    let critical = fast["critical_velocity_m_s"].as_f64().expect("a number");
    assert!((97.0..99.0).contains(&critical), "{critical}");
    let notes = fast["notes"].to_string();
    assert!(notes.contains("above the critical velocity") && notes.contains("exceeds it, too"), "{notes}");
    // All of the 20 J is elastic: the striker rebounds with its initial speed.
    within(&fast, "residual_velocity_m_s", -200.0, 0.0);
    assert!(notes.contains("stays elastic"), "{notes}");
    assert!(!light("50 m/s")["notes"].to_string().contains("exceeds"));
    // A striker at rest, as at the start of a sweep.
    let still = light("0 m/s");
    within(&still, "strain", 0.0, 0.0);
    within(&still, "residual_velocity_m_s", 0.0, 0.0);
    assert!(!still["notes"].to_string().contains("rebounds"), "{still}");
    // 200 lb at 80 ft/s make the specimen yield, and are below its critical velocity.
    let sets = ["specimen.energy=", "specimen.material=\"steel-4340-tempered-315c\""];
    assert_eq!(run("energy-method.toml", &sets)["notes"].to_string(), "[]");
}

#[test]
fn a_ball_rebounds_from_a_fixed_half_space() {
    let sets = ["spheres.half-space=true", "spheres.mass=", "spheres.velocity="];
    let summary = run("spheres-restitution.toml", &sets);
    // 2 kg at 5 m/s with e = 0.6: 1/2 m v^2 (1 - e^2) = 25 J * 0.64.
    within(&summary, "striker_velocity_m_s", -3.0, 1e-14);
    within(&summary, "struck_velocity_m_s", 0.0, 0.0);
    within(&summary, "energy_lost_J", 16.0, 1e-12);
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |name: &str, sets: &[&str]| {
        let output = barwave(folder.path(), "run", name, sets, &[]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        String::from_utf8(output.stderr).expect("text")
    };
    let mass = refused("spheres-restitution.toml", &["spheres.half-space=true"]);
    assert!(mass.contains("a fixed half-space has no `mass`"), "{mass}");
    let pendulum = refused("ballistic-pendulum.toml", &["spheres.half-space=true", "spheres.mass="]);
    assert!(pendulum.contains("a half-space is fixed"), "{pendulum}");
    // Its density does not affect Hertz's contact.
    let hertz = ["spheres.half-space=true", "spheres.radius="];
    let force = |more: &str| run("spheres.toml", &[hertz[0], hertz[1], more])["peak_force_N"].clone();
    assert_eq!(force("spheres.density="), force("spheres.density=1000"));
}

#[test]
fn steel_balls_have_hertz_s_numbers() {
    let pair = run("spheres.toml", &[]);
    to_six_digits(&pair, "approach_m", 2.05592e-5);
    to_six_digits(&pair, "peak_force_N", 999.613);
    to_six_digits(&pair, "contact_duration_s", 6.05114e-5);
    // "3.895e-6" for steel at 1 m/s.
    within(&pair, "vibration_ratio", 3.895e-6, 5e-10);
    // Equal balls exchange their velocities.
    within(&pair, "striker_velocity_m_s", 0.0, 1e-10);
    within(&pair, "struck_velocity_m_s", 1.0, 1e-10);
    within(&pair, "energy_residual", 0.0, 1e-10);
    let half_space = run("spheres.toml", &["spheres.half-space=true", "spheres.radius="]);
    to_six_digits(&half_space, "approach_m", 2.36163e-5);
    to_six_digits(&half_space, "peak_force_N", 1740.43);
    to_six_digits(&half_space, "contact_duration_s", 6.95093e-5);
    within(&half_space, "striker_velocity_m_s", -1.0, 1e-10);
}

/// The modulus of a shear curve is not Young's modulus.
#[test]
fn bodies_need_a_material_that_is_not_in_shear() {
    let folder = tempfile::tempdir().expect("a folder");
    let shear = "{ name = \"s\", loading = \"shear\", density = 7800, modulus = 80e9, poisson = 0.3, \
                 curve = { table = [[0, 0], [0.002, 160e6], [0.1, 200e6]] }, beyond = \"rupture\" }";
    for (name, key) in [
        ("spheres.toml", "spheres"),
        ("plate.toml", "plate"),
        ("beam.toml", "beam"),
        ("ball-on-bar.toml", "left"),
        ("energy-method.toml", "specimen"),
    ] {
        let set = format!("{key}.material={shear}");
        let output = barwave(folder.path(), "run", name, &[&set], &["-o", "r.h5"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(message.contains("`s` has a shear curve, whose modulus is not Young's"), "{name}: {message}");
        assert!(message.contains(&format!("{key}.material")) && message.contains("help:"), "{name}: {message}");
    }
}

#[test]
fn waves_leave_a_half_space() {
    let run = |sets: &[&str]| {
        run("spheres.toml", &[["spheres.half-space=true", "spheres.radius="].as_slice(), sets].concat())
    };
    // Lamb's problem with Hertz's pulse, both by quadrature; Hunter gives 6.2e-3 for steel.
    let slow = run(&[]);
    within(&slow, "radiated_ratio", 6.72e-3, 0.07e-3);
    assert!(slow["vibration_ratio"].is_null() && slow["notes"] == serde_json::json!([]), "{slow}");
    let fast = run(&["striker.velocity=100"]);
    within(&fast, "radiated_ratio", 0.1065, 0.0011);
    assert!(fast["notes"].to_string().contains("% of the energy leaves in waves"), "{fast}");
    assert!(run(&["spheres.density="])["radiated_ratio"].is_null());
}

#[test]
fn hertz_s_theory_ends_where_the_contact_yields_or_the_spheres_vibrate() {
    let notes = |sets: &[&str]| run("spheres.toml", sets)["notes"].to_string();
    // No curve and no yield stress are given; 1 m/s is slow.
    assert_eq!(notes(&[]), "[]");
    let steel = |key: &str| format!("{key}.material=\"mild-steel\"");
    let (one, two) = (steel("spheres"), steel("striker"));
    let yields = notes(&[&one, &two]);
    assert!(
        yields.contains("the contact yields") && yields.contains("yield stress in compression of 127.0 MPa"),
        "{yields}"
    );
    let slow = notes(&[&one, &two, "striker.velocity=1e-5"]);
    assert_eq!(slow, "[]");
    // 0.01 of 50 c0 is 2567 m/s.
    assert!(notes(&["striker.velocity=2600"]).contains("goes into vibration"));
    assert!(!notes(&["striker.velocity=2500"]).contains("goes into vibration"));
}

/// A body with a spherical face has the given mass; the density of a solid sphere of that mass does not affect its contact.
#[test]
fn a_given_mass_is_the_mass() {
    for (name, more) in
        [("spheres.toml", "spheres.density="), ("plate.toml", ""), ("beam.toml", "solve.tolerance=1e-3")]
    {
        let folder = tempfile::tempdir().expect("a folder");
        for (radius, mass) in [("10 mm", "500 kg"), ("10 mm", "1e-10 kg"), ("1 km", "1 kg")] {
            // The length of a beam limits that of a sphere.
            if name == "beam.toml" && radius == "1 km" {
                continue;
            }
            let [radius, mass] = [format!("striker.radius=\"{radius}\""), format!("striker.mass=\"{mass}\"")];
            let own = if name == "spheres.toml" { "spheres.mass=\"1 kg\"" } else { "solve.until=\"20 us\"" };
            let density = if name == "plate.toml" { "" } else { "striker.density=" };
            let sets = [density, &radius, &mass, own, more];
            let sets: Vec<&str> = sets.into_iter().filter(|set| !set.is_empty()).collect();
            for (command, output) in [("plan", &[][..]), ("run", &["-o", "out.h5", "--force"][..])] {
                let output = barwave(folder.path(), command, name, &sets, output);
                let message = String::from_utf8_lossy(&output.stderr);
                assert_eq!(output.status.code(), Some(0), "{command} {name} {radius} {mass}: {message}");
            }
        }
    }
    // 1e6 m of steel are refused by every command, with the place in the file.
    let folder = tempfile::tempdir().expect("a folder");
    for command in ["plan", "run"] {
        let output = barwave(folder.path(), command, "spheres.toml", &["striker.radius=\"1000 km\""], &[]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {message}");
        assert!(message.contains("`striker.radius`") && message.contains("help:"), "{command}: {message}");
    }
    // The wave speed in the ball is that of its material, for any mass.
    let vibration = |mass: &str| {
        number(&run("spheres.toml", &["striker.material=\"mild-steel\"", "striker.density=", mass]), "vibration_ratio")
    };
    assert_eq!(vibration("striker.mass=\"1 kg\"").to_bits(), vibration("striker.mass=\"1 t\"").to_bits());
}

#[test]
fn a_report_has_its_notes_in_its_units() {
    let sets =
        ["specimen.energy=", "specimen.material=\"copper-annealed\"", "striker.mass=0.1", "striker.velocity=200"];
    let folder = tempfile::tempdir().expect("a folder");
    let output = barwave(folder.path(), "run", "energy-method.toml", &sets, &["-o", "e.h5", "--json"]);
    let notes = String::from_utf8(output.stdout).expect("text");
    assert!(notes.contains("critical velocity of the material, 90.1195 m/s"), "{notes}");
    binary::done(folder.path(), &["report", "e.h5", "-o", "e.html", "--units", "us"]);
    let page = std::fs::read_to_string(folder.path().join("e.html")).expect("a page");
    assert!(page.contains("critical velocity of the material, 295.668 ft/s"), "{page}");
}

/// The contact of a soft ball of 30 mm with a rod of 12 mm would be as wide as the rod.
#[test]
fn a_contact_on_a_bar_is_small_compared_with_it() {
    let soft = [
        "left.material=",
        "left.modulus=\"5 MPa\"",
        "left.poisson=0.49",
        "left.density=1100",
        "left.diameter=\"30 mm\"",
    ];
    let short = ["solve.cells=200", "solve.until=\"2 ms\""];
    let folder = tempfile::tempdir().expect("a folder");
    let audit = |sets: &[&str], file: &str| {
        let output = barwave(folder.path(), "run", "ball-on-bar.toml", sets, &["--json", "-o", file]);
        let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        summary["audit"].to_string()
    };
    let wide = audit(&[&soft[..], &short].concat(), "wide.h5");
    assert!(
        wide.contains("ball at the left end: the contact radius is") && wide.contains("of the radius of the bar"),
        "{wide}"
    );
    let small = audit(&short[..1], "small.h5");
    assert!(!small.contains("the contact radius"), "{small}");
}

#[test]
fn the_share_of_vibration_is_not_more_than_all() {
    let soft = run("spheres.toml", &["spheres.modulus=\"1 Pa\""]);
    assert!(soft["vibration_ratio"].is_null(), "{soft}");
    let notes = soft["notes"].to_string();
    assert!(notes.contains("the estimate is outside its range") && !notes.contains('%'), "{notes}");
}

#[test]
fn impacts_say_why_they_estimate_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["spheres.toml", "plate.toml", "beam.toml", "energy-method.toml"] {
        let output = barwave(folder.path(), "run", name, &[], &["--estimate-error"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && message.contains("has no cells"), "{message}");
    }
}

/// The foil with lambda = 246 is deflected by three times its thickness, and the ball does not measurably rebound.
#[test]
fn foils_are_beyond_linear_theory_and_throw_nothing_back() {
    let foil = run("plate.toml", &["plate.thickness=\"0.1 mm\""]);
    let notes = foil["notes"].to_string();
    assert!(notes.contains("the contact has not ended at the end time, when the sphere has "), "{notes}");
    // 0.6793/246^5, and a nonzero velocity.
    assert!(notes.contains("a coefficient of restitution of 7.5e-13 at lambda = 246.1"), "{notes}");
    assert!(!notes.contains("has 0.00") && !notes.contains("increase `until`"), "{notes}");
    assert!(notes.contains("membrane forces"), "{notes}");
    // The law that the note states, 0.6793/lambda^5, at lambda = 5.
    let thin = run("plate.toml", &["plate.thickness=\"0.7 mm\"", "solve.until=\"1 s\""]);
    let number = |key: &str| thin[key].as_f64().expect("a number");
    assert!((number("restitution") * number("inelasticity").powi(5) - 0.6793).abs() < 1e-4, "{thin}");
    let stopped = run("plate.toml", &["plate.thickness=\"0.7 mm\"", "solve.until=\"0.1 ms\""]);
    assert!(stopped["notes"].to_string().contains("increase `until`"), "{stopped}");
}

/// Linear bending theory holds for small slopes only: a beam that is bent by more than a tenth of its length has a note.
#[test]
fn beams_that_bend_far_are_beyond_linear_theory() {
    let heavy = ["striker.density=", "striker.mass=\"100 kg\"", "solve.until=\"0.2 s\"", "solve.tolerance=0.01"];
    for (velocity, noted) in [("0.1 m/s", false), ("5 m/s", true)] {
        let set = format!("striker.velocity=\"{velocity}\"");
        let beam = run("beam.toml", &[&heavy[..], &[&set]].concat());
        assert_eq!(beam["notes"].to_string().contains("of its length: linear bending theory"), noted, "{beam}");
    }
}

/// Hertz's half-space has no boundaries that a contact could reach.
#[test]
fn contacts_are_small_against_the_width_of_a_beam_and_the_thickness_of_a_plate() {
    let folder = tempfile::tempdir().expect("a folder");
    let narrow = ["beam.width=\"0.1 mm\"", "beam.length=\"30 cm\"", "record.gauges="];
    let output = barwave(folder.path(), "plan", "beam.toml", &narrow, &[]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("wide, more than the width of the beam") && message.contains("help:"), "{message}");
    // lambda = 1.2, and a contact radius of 0.16 mm.
    let plate = |velocity: &str| run("plate.toml", &["plate.thickness=\"1.43 mm\"", velocity])["notes"].to_string();
    assert!(!plate("striker.velocity=0.1").contains("the thickness of the plate;"));
    assert!(
        plate("striker.velocity=50")
            .contains("of the thickness of the plate; Hertz's theory needs a contact that is small")
    );
}

#[test]
fn beams_note_what_is_beyond_the_theory_of_slender_elastic_beams() {
    let folder = tempfile::tempdir().expect("a folder");
    let planned = |set: &str| {
        let output = barwave(folder.path(), "plan", "beam.toml", &["record.gauges=", set], &["--json"]);
        let plan: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        plan["notes"].to_string()
    };
    assert_eq!(planned("beam.depth=\"1.5 cm\""), "[]");
    assert!(planned("beam.depth=\"2 cm\"").contains("7.675 times as long as deep"));
    assert!(planned("beam.at=\"1 cm\"").contains("struck 1.000 of its depth from a support"));
    assert!(planned("beam.at=\"0.1 um\"").contains("struck 1.000e-5 of its depth from a support"));
    // A disturbed radius of 92.5 mm by (9.8) is more than half the width.
    assert_eq!(planned("beam.width=\"9 cm\""), "[]");
    let wide = planned("beam.width=\"20 cm\"");
    assert!(
        wide.contains("(9.8), is 0.925 of half the width") && wide.contains("up to about 2.1 times the energy"),
        "{wide}"
    );
    let long = ["beam.width=\"20 cm\"", "striker.mass=\"1 t\"", "striker.density=", "beam.length=\"10 cm\""];
    let output = barwave(folder.path(), "plan", "beam.toml", &[&["record.gauges="], &long[..]].concat(), &["--json"]);
    let plan: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
    let broad = plan["notes"].to_string();
    assert!(broad.contains("2.00 times as wide as long") && broad.contains("about 1.5 times as far"), "{broad}");
    // 9.03 depths.
    let quick = planned("striker.radius=\"2.5 mm\"");
    let waves = "of the energy goes into the beam, and strains differ by 10 % and more";
    assert!(quick.contains("the flexural waves of the contact are 9.") && quick.contains(waves), "{quick}");
    let steel =
        ["beam.modulus=", "beam.density=", "beam.material=\"mild-steel\"", "record.gauges=", "solve.tolerance=1e-3"];
    let struck = |velocity: &str| run("beam.toml", &[&steel[..], &[velocity]].concat())["notes"].to_string();
    assert!(!struck("striker.velocity=0.01").contains("the beam yields"));
    assert!(struck("striker.velocity=10").contains("the beam yields: its largest stress is"));
    // 20 kN on 1 cm^2 are 200 MPa, above the 127 MPa at which this steel yields.
    let loaded = struck("beam.axial-force=\"20 kN\"");
    assert!(loaded.contains("with that of the axial force, which is not in the strains at gauges"), "{loaded}");
}

#[test]
fn the_plate_has_both_coefficients_of_restitution() {
    let thick = run("plate.toml", &[]);
    let e = |summary: &Value, key: &str| summary[key].as_f64().expect("a number");
    // First-order terms of both: 1 - 1.7302 lambda and 1 - 1.7725 lambda.
    let lambda = e(&thick, "inelasticity");
    assert!(lambda < 0.03, "{lambda}");
    within(&thick, "restitution", 1.0 - 1.7302 * lambda, 2.0 * lambda * lambda);
    within(&thick, "handbook_restitution", 1.0 - 1.7725 * lambda, 2.0 * lambda * lambda);
    within(&thick, "energy_residual", 0.0, 1e-9);
    assert_eq!(thick["notes"], Value::Array(Vec::new()));
    // A plate of a seventh of the thickness: lambda is 49 times as large, 1.2.
    let thin = run("plate.toml", &["plate.thickness=\"1.43 mm\""]);
    assert!(e(&thin, "handbook_restitution") < 0.0 && e(&thin, "restitution") > 0.0, "{thin}");
    assert!(thin["notes"].to_string().contains("(9.13) is negative"), "{thin}");
    // Mindlin's plate with Hertz's pulse: 1.74 times the energy at two thicknesses.
    let block = run("plate.toml", &["plate.thickness=\"67 mm\""])["notes"].to_string();
    assert!(block.contains("2.00 of the thickness") && block.contains("takes about 1.7 times the energy"), "{block}");
    // The disturbed part of the plate grows with the duration of the contact.
    let spread = |key: &str, time: &str| e(&thin, key) / e(&thin, time).sqrt();
    let ratio = spread("contact_spread_radius_m", "contact_duration_s") / spread("spread_radius_m", "hertz_duration_s");
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    // (9.8): a^2 = pi tau h sqrt(E/(3 rho (1 - nu^2))), with the figures of the summary.
    let (tau, a) = (e(&thick, "hertz_duration_s"), e(&thick, "spread_radius_m"));
    let h = 0.005;
    let c = a * a / (std::f64::consts::PI * tau * h);
    assert!((c / (207e9_f64 / (3.0 * 7850.0 * 0.91)).sqrt() - 1.0).abs() < 1e-9, "{c}");
}

#[test]
fn timoshenko_s_beams() {
    let short = run("beam.toml", &[]);
    // As printed in the textbook; the gauges and the tolerance are those of the scene.
    within(&short, "contact_duration_s", 156.4e-6, 0.05e-6);
    within(&short, "peak_force_N", 4.9771, 5e-5);
    within(&short, "time_of_peak_s", 72.6e-6, 0.05e-6);
    within(&short, "striker_velocity_m_s", -0.3023e-2, 0.5e-6);
    within(&short, "error", 0.0, 1e-5);
    let long = run("beam.toml", &["beam.length=\"30.7 cm\"", "record.gauges="]);
    // The printed value is 163.3; an eighth-order Runge-Kutta integration with 64 odd modes gives 163.3710.
    within(&long, "contact_duration_s", 163.371e-6, 0.002e-6);
    within(&long, "contact_duration_s", 163.3e-6, 0.1e-6);
    within(&long, "peak_force_N", 4.9888, 5e-5);
    for (summary, stated) in [(&short, 0.3023), (&long, 0.2905)] {
        within(summary, "restitution", stated, 1e-4);
        // (9.31) within 5 %.
        within(summary, "half_sine_restitution", stated, 0.05 * stated);
        within(summary, "energy_residual", 0.0, 1e-6);
    }
}

/// A support does not move: the rounding of sin(n pi) there is not a result that could converge.
/// An undamped beam struck at midspan has the same deflection with the opposite sign after half a period: the first peak counts.
#[test]
fn the_first_of_equal_peaks_of_a_beam_counts() {
    let summary = run("beam.toml", &[]);
    let period = number(&summary, "lowest_period_s");
    for gauge in ["middle", "quarter"] {
        for name in ["deflection_m", "moment_N_m", "strain"] {
            let quantity = name.split('_').next().expect("a name");
            let peak = number(&summary, &format!("/gauges/{gauge}/peak_{name}"));
            let time = number(&summary, &format!("/gauges/{gauge}/time_of_peak_{quantity}_s"));
            assert!(peak > 0.0 && time > 0.0 && time < 0.5 * period, "{gauge} {name}: {peak} at {time} of {period}");
        }
    }
    // Sum of the modes fitted to the free vibration; parabolas through rows of the history would be 8e-6 and 14e-6 too high at the two peaks.
    to_six_digits(&summary, "/gauges/middle/peak_moment_N_m", 9.479_917e-2);
}

/// The accuracy of a result with a given number of modes is unknown, which is noted.
#[test]
fn a_given_number_of_modes_is_noted() {
    let summary = run("beam.toml", &["solve.modes=64"]);
    assert!(summary["error"].is_null(), "{summary}");
    assert!(
        summary["notes"].to_string().contains("`solve.modes` fixes the number of modes: the error is not estimated"),
        "{summary}"
    );
}

#[test]
fn pages_and_summaries_of_impacts_have_every_figure_once() {
    let summary = run("spheres.toml", &[]);
    within(&summary, "closing_velocity_m_s", 1.0, 0.0);
    within(&summary, "reduced_mass_kg", 2.0 / 3.0 * std::f64::consts::PI * 1e-6 * 7850.0, 1e-15);
    let (_, stored) = recorded("energy-method.toml", &[]);
    let names: Vec<&str> = stored.figures.iter().map(|figure| figure.long_name.as_str()).collect();
    // As in the summary, and without duplicate names.
    assert_eq!(
        names[..3],
        ["kinetic energy of the striker", "energy absorbed to fracture", "energy absorbed to fracture per volume"]
    );
    assert!(names.iter().enumerate().all(|(i, name)| !names[..i].contains(name)), "{names:?}");
}

#[test]
fn gauges_at_the_supports_read_zeros() {
    for length in ["15.35 cm", "10 cm", "70 cm"] {
        let (beam, gauges) =
            (format!("beam.length=\"{length}\""), format!("record.gauges={{ a = 0, b = \"{length}\" }}"));
        let summary = run("beam.toml", &[&beam, &gauges, "solve.tolerance=1e-4"]);
        assert_eq!(summary["outcome"], "done", "{summary}");
        within(&summary, "error", 0.0, 1e-4);
        for key in ["peak_deflection_m", "peak_moment_N_m", "peak_strain"] {
            within(&summary["gauges"]["a"], key, 0.0, 0.0);
            within(&summary["gauges"]["b"], key, 0.0, 0.0);
        }
    }
}

/// A ball of 1 cm radius on a rod of 1 cm: relative radii of 1 cm and 1/3 cm, against an integration of 200 modes with steps of 10 ns. The stiffness,
/// from complete elliptic integrals, is 0.7789 of that on a flat face, for which the results are 919.94 N, 63.13 us, -0.1052 and 2.845 GPa.
#[test]
fn a_round_beam_is_struck_on_its_side() {
    let sets = [
        "beam.length=\"30 cm\"",
        "beam.width=",
        "beam.depth=",
        "beam.diameter=\"1 cm\"",
        "beam.modulus=\"207 GPa\"",
        "beam.density=7850",
        "striker.modulus=\"207 GPa\"",
        "striker.density=7850",
        "striker.velocity=1",
        "record.gauges={ g = \"15 cm\" }",
    ];
    let summary = run("beam.toml", &sets);
    within(&summary, "first_contact_force_N", 850.94, 0.1);
    within(&summary, "first_contact_duration_s", 69.86e-6, 0.02e-6);
    within(&summary, "first_restitution", -0.0791, 2e-4);
    within(&summary, "contact_pressure_Pa", 4.1299e9, 1e6);
    // Semi-axes in the ratio 2.072 to 1; Timoshenko and Goodier's table has 1.486 to 0.717.
    let [along, across] = ["along", "across"].map(|side| number(&summary, &format!("contact_semi_axis_{side}_m")));
    assert!((along / across - 2.07199).abs() < 1e-4, "{along} {across}");
    within(&summary, "contact_area_m2", std::f64::consts::PI * along * across, 1e-12);
}

/// 17 us of contact and 42 ms of free vibration, which must not be integrated in 300 000 steps. The largest strain recurs at half a period and at its
/// end, where all modes are in phase, between the rows.
#[test]
fn free_vibration_takes_few_steps() {
    let light = ["beam.length=\"1 m\"", "striker.radius=\"1 mm\"", "record.gauges={ m = \"0.5 m\" }"];
    let summary = run("beam.toml", &light);
    assert!(summary["steps"].as_f64().expect("a number") < 6000.0, "{summary}");
    within(&summary, "end_time_s", 42.36e-3, 0.1e-3);
    within(&summary, "restitution", 0.99666, 2e-5);
    within(&summary, "error", 0.0, 1e-5);
    within(&summary, "energy_residual", 0.0, 1e-6);
    let peak = |key: &str| summary["gauges"]["m"][key].as_f64().expect("a number").abs();
    assert!((peak("peak_deflection_m") / 1.37811e-8 - 1.0).abs() < 1e-3, "{summary}");
    assert!((peak("peak_strain") / 1.28589e-8 - 1.0).abs() < 1e-3, "{summary}");
}

#[test]
fn a_heavy_ball_strikes_the_beam_three_times() {
    let summary = run("beam-three-contacts.toml", &[]);
    assert_eq!(summary["contact_count"], 3, "{summary}");
    let contacts = summary["contacts"].as_array().expect("contacts");
    assert_eq!(contacts.len(), 3);
    // 434.4, 1782 and 3222 us in Timoshenko's book, computed by hand.
    for (contact, end) in contacts.iter().zip([434.4e-6, 1782e-6, 3222e-6]) {
        within(contact, "end_s", end, 4e-4 * end);
    }
    // Figures of the first contact and of all contacts; each force is at its own time.
    within(&summary, "first_contact_force_N", 9.0079, 1e-3);
    within(&summary, "peak_force_N", 10.298, 1e-3);
    within(&summary, "first_contact_rise_s", 91.29e-6, 0.1e-6);
    within(&summary, "time_of_peak_s", 1.62756e-3, 1e-6);
    within(&summary, "first_contact_duration_s", 434.54e-6, 0.1e-6);
    // 434.54, 445.24 and 423.37 us.
    within(&summary, "contact_duration_s", 1.30315e-3, 0.2e-6);
    within(&summary, "energy_residual", 0.0, 1e-6);
    // (9.31) is for one contact of 295 us; the first lasts 434 us. Its error of the velocity after the contact is 6 % of the velocity before it.
    let (e, first) = (&summary["half_sine_restitution"], &summary["first_restitution"]);
    let off = (e.as_f64().expect("a number") - first.as_f64().expect("a number")).abs();
    assert!((0.05..0.07).contains(&off), "{e} {first}");
}

/// 0.5 kg on a beam of 30 g: there are a hundred contacts, each magnifies the errors of the previous one, and the numbers of contacts differ at every
/// level. The study must not continue to 4096 modes, for minutes, and report `done`. The error of the velocity of the ball is a few percent.
#[test]
fn contacts_that_do_not_converge_are_not_done() {
    let scene = "[beam]\nlength = 0.4\ndiameter = 6e-3\nmodulus = 70e9\npoisson = 0.33\ndensity = 2700\n\
                 [striker]\nradius = 0.025\nvelocity = 0.5\nmodulus = 210e9\npoisson = 0.3\ndensity = 7800\n\
                 [solve]\nuntil = 0.016\n";
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a folder to write to");
    let summary = binary::json(folder.path(), &["run", "--json", "scene.toml"]);
    assert_eq!(summary["outcome"], "not-converged", "{summary}");
    let notes = summary["notes"].to_string();
    assert!(notes.contains("contacts magnifies the errors of the one before"), "{notes}");
    within(&summary, "striker_velocity_m_s", 0.135, 0.01);
    let error = summary["error"].as_f64().expect("an error");
    assert!((1e-3..0.1).contains(&error), "{error}");
    let text = binary::done(folder.path(), &["run", "scene.toml", "--force"]);
    assert_eq!(text.matches("largest force").count(), 13, "twelve contacts and the half-sine pulse: {text}");
    assert!(text.contains("more; the result file lists all"), "{text}");
}

#[test]
fn the_damped_beam_loses_what_its_ledger_says() {
    let summary = run("beam-damped.toml", &[]);
    within(&summary, "energy_residual", 0.0, 1e-6);
    assert!(summary["lowest_damping"].as_f64().expect("a number") > 0.0);
    // Overcritical damping from the first mode: the response is aperiodic, and still integrated to the tolerance.
    let over = run("beam-damped.toml", &["beam.external-damping=\"50 kN*s/m^2\""]);
    assert!(over["lowest_damping"].as_f64().expect("a number") > 1.0, "{over}");
    within(&over, "error", 0.0, 1e-4);
    within(&over, "energy_residual", 0.0, 1e-6);
    // Without damping and foundation, and at midspan, this is the beam of runs/beam.toml.
    let plain = ["beam.internal-damping=", "beam.external-damping=", "beam.foundation=", "beam.at=", "record.gauges="];
    within(&run("beam-damped.toml", &plain), "peak_force_N", 4.9771, 2e-4);
}

/// Impact off midspan with damping below and above critical, a foundation and an axial force, against an integration of 24 modes (15 for the central
/// impact) with `SciPy`'s implicit Runge-Kutta method, and (9.31) against the quadrature of its pulse on each mode. The higher modes, which are
/// omitted there, contribute up to 2e-4.
#[test]
fn beams_agree_with_an_independent_integration() {
    let none = ["beam.internal-damping=", "beam.external-damping=", "beam.foundation="];
    let (column, strong) = ("beam.axial-force=\"37 kN\"", "beam.external-damping=\"50 kN*s/m^2\"");
    let loaded = [none[0], none[1], none[2], column];
    let central = [none[0], none[2], "beam.at=", strong];
    let cases: [(&[&str], [f64; 4]); 5] = [
        (&[], [170.456e-6, 5.007_469, 0.275_472, 0.285_883]),
        (&none, [164.342e-6, 4.961_862, 0.234_298, 0.250_290]),
        (&loaded, [158.676e-6, 4.942_220, 0.210_599, 0.228_921]),
        (&central, [181.209e-6, 5.941_973, 0.753_218, 0.731_004]),
        (&[strong, "beam.axial-force=\"20 kN\""], [180.795e-6, 5.938_283, 0.729_136, 0.708_462]),
    ];
    let keys = ["contact_duration_s", "peak_force_N", "first_restitution", "half_sine_restitution"];
    for (sets, expected) in cases {
        let summary = run("beam-damped.toml", sets);
        for (key, expected) in keys.into_iter().zip(expected) {
            within(&summary, key, expected, 2e-4 * expected);
        }
    }
}

#[test]
fn mirrored_impacts_and_a_vanishing_axial_force_are_the_same() {
    let force = |sets: &[&str]| run("beam.toml", sets)["peak_force_N"].as_f64().expect("a number");
    let [left, right] = ["4 cm", "11.35 cm"].map(|at| force(&[&format!("beam.at=\"{at}\""), "record.gauges="]));
    assert!((left / right - 1.0).abs() < 1e-9, "{left} {right}");
    let none = force(&["record.gauges="]);
    assert_eq!(none, force(&["record.gauges=", "beam.axial-force=0"]));
    // Compression softens the beam, and increases its lowest period.
    let period = |sets: &[&str]| run("beam.toml", sets)["lowest_period_s"].as_f64().expect("a number");
    // Half of the buckling load pi^2 E I/l^2 = 75.3 kN: sqrt(2).
    let ratio = period(&["beam.axial-force=37647.3"]) / period(&[]);
    assert!((ratio - std::f64::consts::SQRT_2).abs() < 1e-3, "{ratio}");
}

/// The lowest mode has a period of 1.8 us and the contact lasts 173 us; the gauge at a quarter of the length moves by 1e-14 m.
#[test]
fn a_rigid_foundation_makes_the_beam_a_half_space() {
    let summary = run("beam.toml", &["beam.foundation=\"1e13 N/m^2\""]);
    within(&summary, "restitution", 1.0, 1e-6);
    within(&summary, "contact_duration_s", 172.7e-6, 0.1e-6);
    within(&summary, "error", 0.0, 1e-5);
    assert_eq!(summary["notes"], Value::Array(Vec::new()));
}

#[test]
fn a_foundation_takes_less_of_the_striker_s_energy() {
    let e = |k: &str| {
        let set = format!("beam.foundation=\"{k}\"");
        run("beam.toml", &[&set, "record.gauges="])["restitution"].as_f64().expect("a number")
    };
    let (none, some, stiff) = (e("0 N/m^2"), e("200 MN/m^2"), e("2 GN/m^2"));
    assert!(none < some && some < stiff && stiff < 1.0, "{none} {some} {stiff}");
}

#[test]
fn reports_plans_and_cost_studies_are_there_for_every_kind() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for (name, panel) in [
        ("spheres.toml", "velocities"),
        ("plate.toml", "contact radius"),
        ("beam.toml", "deflected shapes"),
        ("beam-three-contacts.toml", "strain at the gauges"),
        ("beam-damped.toml", "bending moment at the gauges"),
    ] {
        assert_eq!(barwave(folder, "check", name, &[], &[]).status.code(), Some(0), "{name}");
        assert_eq!(barwave(folder, "run", name, &[], &["-o", "r.h5", "--quiet"]).status.code(), Some(0), "{name}");
        for file in ["r.svg", "r.html", "r.png"] {
            let report = Command::new(env!("CARGO_BIN_EXE_barwave"))
                .current_dir(folder)
                .args(["report", "r.h5", "-o", file])
                .output();
            assert_eq!(report.expect("it starts").status.code(), Some(0), "{name} {file}");
        }
        let text = std::fs::read_to_string(folder.join("r.html")).expect("a page");
        assert!(text.contains(panel) && text.contains("energy"), "{name}");
        assert!(text.contains("equation") && text.contains("validity"), "{name}");
        // Units of the figures and of the panels are typeset.
        assert!(name != "plate.toml" || text.contains(" \u{b5}s</td>") && !text.contains(" us</td>"), "{name}");
        // Counts are whole numbers.
        assert!(name != "beam.toml" || text.contains("modes of the beam</th><td>64</td>"), "{name}");
        assert!(name != "beam.toml" || text.contains("gauge middle: deflection of largest magnitude</th>"), "{name}");
        let plan = barwave(folder, "plan", name, &[], &["--json"]);
        let plan: Value = serde_json::from_slice(&plan.stdout).expect("one JSON value");
        assert!(plan["equation"].as_str().is_some_and(|e| !e.is_empty()) && plan["method"].is_string(), "{plan}");
    }
    // Plans run nothing.
    for name in ["spheres.toml", "plate.toml", "beam.toml", "energy-method.toml", "spheres-restitution.toml"] {
        let plan = barwave(folder, "plan", name, &[], &["--json"]);
        let plan: Value = serde_json::from_slice(&plan.stdout).expect("one JSON value");
        for key in ["outcome", "output", "wall_s"] {
            assert!(plan.get(key).is_none(), "{name} {key}: {plan}");
        }
        for key in ["scene", "method", "scheme", "effects", "equation", "validity", "notes"] {
            assert!(plan.get(key).is_some(), "{name} {key}: {plan}");
        }
    }
    let plan = barwave(folder, "plan", "beam.toml", &[], &["--json"]);
    let plan: Value = serde_json::from_slice(&plan.stdout).expect("one JSON value");
    let steps = plan["expected_steps"].as_f64().expect("a number");
    let taken = run("beam.toml", &[])["steps"].as_f64().expect("a number");
    assert!((taken / steps - 1.0).abs() < 0.2, "{steps} {taken}");
    // Scenes in closed form have a page of tables, but no figure.
    for name in ["spheres-restitution.toml", "ballistic-pendulum.toml", "energy-method.toml"] {
        assert_eq!(barwave(folder, "run", name, &[], &["-o", "r.h5", "--quiet"]).status.code(), Some(0), "{name}");
        let report = |file: &str| {
            let program = Command::new(env!("CARGO_BIN_EXE_barwave"))
                .current_dir(folder)
                .args(["report", "r.h5", "-o", file])
                .output();
            program.expect("it starts").status.code()
        };
        assert_eq!((report("page.html"), report("page.svg")), (Some(0), Some(2)), "{name}");
        let text = std::fs::read_to_string(folder.join("page.html")).expect("a page");
        assert!(
            text.contains("velocity of the striker") && text.contains("equation") && text.contains("validity"),
            "{name}"
        );
        assert!(!text.contains("<svg"), "{name}");
    }
    let cost = barwave(folder, "cost", "spheres-restitution.toml", &[], &[]);
    assert_eq!(cost.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&cost.stderr).contains("closed form"));
    for name in ["spheres.toml", "plate.toml", "beam.toml"] {
        let cost = barwave(folder, "cost", name, &[], &["--measure", "peak-force"]);
        let message = String::from_utf8_lossy(&cost.stderr);
        assert_eq!(cost.status.code(), Some(2), "{name}");
        assert!(message.contains("`--measure`") && message.contains("are those of waves in a bar"), "{message}");
    }
    let stability = Command::new(env!("CARGO_BIN_EXE_barwave")).arg("stability").arg(scene("beam.toml")).output();
    assert_eq!(stability.expect("it starts").status.code(), Some(2));
}

#[test]
fn cost_shows_convergence_in_modes_and_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, has_modes) in [("spheres.toml", false), ("plate.toml", false), ("beam.toml", true)] {
        let output = barwave(folder.path(), "cost", name, &[], &["--json"]);
        let cost: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        let errors = |varied: &str| -> Vec<f64> {
            let points = cost["points"].as_array().expect("points").iter().filter(|p| p["varied"] == varied);
            points.map(|p| p["error"].as_f64().expect("a number")).collect()
        };
        let steps = errors("steps");
        assert_eq!(steps.len(), 8, "{cost}");
        assert!(steps[0] > 100.0 * steps[4] && steps[7] < 1e-8, "{name}: {steps:?}");
        let modes = errors("modes");
        assert_eq!(!modes.is_empty(), has_modes, "{name}");
        if has_modes {
            assert!(modes[1] > 1e3 * modes[5] && modes[6] < 1e-6, "{modes:?}");
        }
    }
    let output = barwave(folder.path(), "cost", "plate.toml", &[], &["-o", "c.svg", "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(std::fs::read_to_string(folder.path().join("c.svg")).expect("a figure").contains("error against steps"));
}

#[test]
fn a_striker_needs_a_body_that_it_strikes() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |text: &str| {
        std::fs::write(folder.path().join("s.toml"), text).expect("written");
        let program =
            Command::new(env!("CARGO_BIN_EXE_barwave")).current_dir(folder.path()).args(["run", "s.toml"]).output();
        String::from_utf8_lossy(&program.expect("it starts").stderr).into_owned()
    };
    let alone = said("[striker]\nradius = \"1 cm\"\nvelocity = 1\n");
    assert!(alone.contains("the scene does not say what is struck"), "{alone}");
    assert!(alone.contains("help: add one of [specimen], [spheres], [plate], [beam]"), "{alone}");
    let beside = said("[bar]\nlength = 1\n[striker]\nvelocity = 1\n");
    assert!(beside.contains("give an end kind = \"striker\""), "{beside}");
}

/// The metrics of the figure are those of all cases, including a sweep whose first case fails, as its bodies do not approach each other.
#[test]
fn a_sweep_whose_first_case_fails_is_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::copy(scene("spheres.toml"), folder.path().join("spheres.toml")).expect("copied");
    let sweep =
        "[sweep]\nscene = \"spheres.toml\"\n[axes]\n\"striker.velocity\" = [\"-1 m/s\", \"1 m/s\", \"2 m/s\"]\n";
    std::fs::write(folder.path().join("sweep.toml"), sweep).expect("written");
    let program = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .current_dir(folder.path())
        .args(["sweep", "sweep.toml", "-o", "out", "--quiet", "--plot", "p.svg"])
        .output()
        .expect("it starts");
    let figure = std::fs::read_to_string(folder.path().join("p.svg"));
    let figure = figure.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&program.stderr)));
    assert!(figure.contains("peak force"), "{figure}");
}

#[test]
fn impacts_can_be_swept() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::copy(scene("plate.toml"), folder.path().join("plate.toml")).expect("copied");
    let sweep = "[sweep]\nscene = \"plate.toml\"\nmetrics = [\"restitution\", \"peak_force_N\"]\n[axes]\n\
                 \"plate.thickness\" = [\"2 mm\", \"5 mm\", \"10 mm\"]\n";
    std::fs::write(folder.path().join("sweep.toml"), sweep).expect("written");
    let program = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .current_dir(folder.path())
        .args(["sweep", "sweep.toml", "-o", "out", "--quiet"])
        .output()
        .expect("it starts");
    assert_eq!(program.status.code(), Some(0), "{}", String::from_utf8_lossy(&program.stderr));
    let table = std::fs::read_to_string(folder.path().join("out/table.csv")).expect("a table");
    assert_eq!(table.lines().filter(|line| line.contains(",done,")).count(), 3, "{table}");
    // All scalars of the summary, but no texts.
    std::fs::write(folder.path().join("sweep.toml"), sweep.replace("metrics", "# metrics")).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .current_dir(folder.path())
        .args(["sweep", "sweep.toml", "-o", "all", "--quiet"])
        .output();
    assert_eq!(output.expect("it starts").status.code(), Some(0));
    let table = std::fs::read_to_string(folder.path().join("all/table.csv")).expect("a table");
    assert!(
        table.contains("handbook_restitution") && !table.contains("Zener") && !table.contains("validity"),
        "{table}"
    );
}
