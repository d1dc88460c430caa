//! Cost of the effect `rupture` on a grid: stepping time in nanoseconds per cell and step, without it, and with a threshold that is never reached.
//! Nothing is asserted: times depend on the machine. `cargo bench --bench rupture` runs it.

mod common;

use common::{CELLS, scene, shortest};

const RUNS: usize = 7;

fn main() {
    // `cargo test --benches` only checks that this program starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("ns for a cell and a step at {CELLS} cells; shortest of {RUNS} runs");
    println!("{:<10}{:>8}{:>16}{:>10}{:>10}", "bar", "off", "critical-strain", "energy", "spall");
    for (name, velocity) in [("elastic", -4.0), ("bilinear", -20.0)] {
        let ns = ["", "rupture = \"critical-strain\"", "rupture = { energy = 1e12 }", "rupture = { spall = 1e12 }"]
            .map(|rupture| format!("hardening = \"isotropic\"\n{rupture}"))
            .map(|effects| shortest(&scene(velocity, "", "beyond = \"rupture\"", &effects), RUNS));
        println!("{name:<10}{:>8.2}{:>16.2}{:>10.2}{:>10.2}", ns[0], ns[1], ns[2], ns[3]);
    }
}
