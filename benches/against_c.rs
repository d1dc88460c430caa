//! Compares barwave's leapfrog scheme with a plain one in C (`benches/leapfrog.c`, compiled with `cc -O3 -march=native`): stepping time and error.
//! The programs run alternately, so that both see the same machine load. Nothing is asserted: times depend on the machine.
//!
//! First, the three benchmark problems are run as scenes, in which most of the bar is at rest most of the time. Then, long bars with sinusoidal
//! initial velocity are run, in which every cell is active: with 8 waves, none of the 10^6 cells yields in so few steps; with waves of 125 cells,
//! all cells yield except those at the nodes of the waves.
//!
//! `cargo bench` runs it. Environment: `CC` is the compiler, `ROUNDS` the number of runs of each program (default 7), `PROBLEM` the only problem to
//! run (P1, P2 or P3). `C_PROGRAM` is a compiled program to compare with; it is called with the arguments CELLS PROBLEM, or CELLS PROBLEM 1 STEPS
//! for the 8 waves, and prints the number of steps, the time in seconds, any other numbers, and the error.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use barwave::assemble;
use barwave::scene::Scene;
use barwave::solver::fd::Quantity;

const MODULUS: f64 = 200e9;
const DENSITY: f64 = 7800.0;
const YIELD: f64 = 200e6;
const TANGENT: f64 = 20e9;
const EXPONENT: f64 = 0.2;
const TABLE_END: f64 = 0.05;
const TABLE_ROWS: usize = 60;

/// Benchmark problem, for both programs. The bar is 1 m long; the end time is 0.8 of the elastic wave's transit time.
#[derive(Clone, Copy)]
enum Problem {
    Elastic = 1,
    Bilinear,
    PowerLaw,
}

impl Problem {
    fn name(self) -> &'static str {
        match self {
            Self::Elastic => "P1 elastic",
            Self::Bilinear => "P2 bilinear",
            Self::PowerLaw => "P3 power law",
        }
    }

    fn velocity(self) -> f64 {
        if matches!(self, Self::Elastic) { 10.0 } else { 20.0 }
    }

    fn table(self) -> Vec<[f64; 2]> {
        let yield_strain = YIELD / MODULUS;
        let mut rows = vec![[0.0, 0.0]];
        match self {
            Self::Elastic => rows.push([0.003, 0.003 * MODULUS]),
            Self::Bilinear => rows.extend([[yield_strain, YIELD], [yield_strain + 0.02, YIELD + 0.02 * TANGENT]]),
            Self::PowerLaw => rows.extend((0..TABLE_ROWS).map(|k| {
                let ratio = (TABLE_END / yield_strain).powf(k as f64 / (TABLE_ROWS - 1) as f64);
                [yield_strain * ratio, YIELD * ratio.powf(EXPONENT)]
            })),
        }
        rows
    }

    fn scene(self, cells: usize) -> Scene {
        // The elastic problem has no [effects], as it has no yield stress in C.
        let effects = if matches!(self, Self::Elastic) { "" } else { "[effects]\nhardening = \"isotropic\"" };
        let text = format!(
            "title = \"{}\"\n[bar]\nlength = 1\n[bar.material]\nname = \"bench\"\ndensity = {DENSITY}\n\
             modulus = {MODULUS}\nbeyond = \"extend\"\ncurve = {{ table = {:?} }}\n[left]\nkind = \"velocity\"\n\
             value = {:?}\n[right]\nkind = \"free\"\n{effects}\n[solve]\nuntil = {:?}\ncells = {cells}\n\
             [record]\nframes = 2\n",
            self.name(),
            self.table(),
            self.velocity(),
            end_time(),
        );
        Scene::parse("bench", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Returns the exact stress at x/t = `speed` in a long bar, compression positive, as in C.
    fn exact(self, speed: f64) -> f64 {
        let (c0, c1) = (elastic_speed(), (TANGENT / DENSITY).sqrt());
        let yield_velocity = YIELD / (DENSITY * c0);
        match self {
            _ if speed >= c0 => 0.0,
            Self::Elastic => DENSITY * c0 * self.velocity(),
            Self::Bilinear if speed < c1 => YIELD + DENSITY * c1 * (self.velocity() - yield_velocity),
            Self::Bilinear => YIELD,
            Self::PowerLaw => {
                let (n, root) = (EXPONENT, EXPONENT.sqrt());
                let largest =
                    ((self.velocity() / yield_velocity - 1.0) * (n + 1.0) / 2.0 / root + 1.0).powf(2.0 / (n + 1.0));
                let ratio = (speed / (root * c0)).powf(2.0 / (n - 1.0));
                YIELD * ratio.max(1.0).min(largest).powf(n)
            }
        }
    }
}

fn elastic_speed() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

fn end_time() -> f64 {
    0.8 / elastic_speed()
}

/// Measurements of one run.
struct Outcome {
    steps: usize,
    seconds: f64,
    error: f64,
}

fn run_here(problem: Problem, cells: usize) -> Outcome {
    let scene = problem.scene(cells);
    let mut bar = assemble::leapfrog(&scene, cells, 1.0);
    let steps = bar.grid().steps_to(scene.solve.until);
    let start = Instant::now();
    bar.advance_by(steps);
    let seconds = start.elapsed().as_secs_f64();
    let mut stress = vec![0.0; cells];
    bar.profile(Quantity::Stress, &mut stress);
    let (mut difference, mut sum) = (0.0, 0.0);
    for (x, stress) in bar.grid().centres().into_iter().zip(stress) {
        let wanted = problem.exact(x / bar.time());
        difference += (-stress - wanted).abs();
        sum += wanted.abs();
    }
    Outcome { steps, seconds, error: difference / sum }
}

/// Number of steps of a long bar.
const LONG_STEPS: usize = 200;

/// Number of cells of a long bar.
const LONG_CELLS: usize = 1_000_000;

/// Runs a bar of [`LONG_CELLS`] cells with free ends, all of which move, on `threads` threads.
fn run_long(problem: Problem, waves: usize, threads: usize) -> Outcome {
    let free = problem.scene(LONG_CELLS).with(&["left={ kind = \"free\" }", "right={ kind = \"free\" }"]);
    let scene = free.unwrap_or_else(|e| panic!("{e}"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let velocity = |x: f64| problem.velocity() * (2.0 * std::f64::consts::PI * waves as f64 * x).sin();
        let mut bar = assemble::leapfrog(&scene, LONG_CELLS, 1.0).moving(velocity);
        let start = Instant::now();
        bar.advance_by(LONG_STEPS);
        let seconds = start.elapsed().as_secs_f64();
        assert!(waves < 1000 || matches!(problem, Problem::Elastic) || !bar.stayed_elastic(), "nothing yielded");
        Outcome { steps: LONG_STEPS, seconds, error: 0.0 }
    })
}

/// Program to compare with.
enum Peer {
    /// Program compiled from benches/leapfrog.c.
    Own(PathBuf),
    /// Program named by `C_PROGRAM`.
    Other(PathBuf),
}

impl Peer {
    /// Returns the program to compare with, or `None` without a C compiler.
    fn new() -> Option<Self> {
        match std::env::var_os("C_PROGRAM") {
            Some(program) => Some(Self::Other(program.into())),
            None => compile().map(Self::Own),
        }
    }

    /// Runs a problem, or with `waves` a long bar. Returns `None` if the program cannot run it.
    fn run(&self, problem: Problem, cells: usize, waves: Option<usize>) -> Option<Outcome> {
        let number = (problem as u8).to_string();
        let mut arguments = vec![cells.to_string(), number];
        let program = match (self, waves) {
            (Self::Own(program) | Self::Other(program), None) => program,
            (Self::Own(program), Some(waves)) => {
                arguments.extend([LONG_STEPS.to_string(), waves.to_string()]);
                program
            }
            (Self::Other(program), Some(8)) => {
                arguments.extend(["1".to_owned(), LONG_STEPS.to_string()]);
                program
            }
            _ => return None,
        };
        let output = Command::new(program).args(arguments).output();
        let output = output.unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        assert!(output.status.success(), "the C program failed");
        let text = String::from_utf8_lossy(&output.stdout);
        let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect("a number")).collect();
        Some(Outcome { steps: numbers[0] as usize, seconds: numbers[1], error: numbers[numbers.len() - 1] })
    }
}

/// Compiles benches/leapfrog.c; returns `None` without a C compiler.
fn compile() -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/leapfrog.c");
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("leapfrog_c");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let status =
        Command::new(&compiler).args(["-O3", "-march=native", "-o"]).arg(&program).arg(source).arg("-lm").status();
    match status {
        Ok(status) if status.success() => Some(program),
        Ok(status) => {
            println!("{compiler} could not compile benches/leapfrog.c ({status}): nothing to compare with");
            None
        }
        Err(error) => {
            println!("no C compiler ({compiler}: {error}): nothing to compare with");
            None
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

fn main() {
    // `cargo test --benches` only checks that this program starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let rounds = std::env::var("ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(7).max(1);
    let Some(peer) = Peer::new() else { return };
    println!("medians of {rounds} runs each, in turn; time of stepping only; error: relative L1 of stress at the end");
    println!(
        "{:<14}{:>9}{:>7}{:>12}{:>12}{:>9}{:>13}{:>10}{:>12}{:>12}",
        "problem", "cells", "steps", "barwave ms", "C ms", "ratio", "barwave ns", "C ns", "error", "C error"
    );
    let only = std::env::var("PROBLEM").unwrap_or_default();
    let problems = [Problem::Elastic, Problem::Bilinear, Problem::PowerLaw];
    let problems = problems.into_iter().filter(|problem| problem.name().starts_with(&only));
    for problem in problems.clone() {
        for cells in [1000, 10_000] {
            compare(&peer, problem, cells, rounds);
        }
    }
    println!(
        "\n{LONG_CELLS} cells, every one at work, {LONG_STEPS} steps; gain: shortest run on one thread over that on two, the same bits"
    );
    println!(
        "{:<14}{:>9}{:>12}{:>12}{:>9}{:>13}{:>10}{:>14}{:>7}",
        "problem", "waves", "barwave ms", "C ms", "ratio", "barwave ns", "C ns", "2 threads ms", "gain"
    );
    for problem in problems {
        for waves in [8, 8000] {
            compare_long(&peer, problem, waves, rounds);
        }
    }
    println!("ratio: barwave/C; ns: per cell and step");
}

fn compare(peer: &Peer, problem: Problem, cells: usize, rounds: usize) {
    let (mut here, mut c): (Vec<Outcome>, Vec<Outcome>) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        here.push(run_here(problem, cells));
        c.extend(peer.run(problem, cells, None));
    }
    let (ours, theirs) = (&here[0], &c[0]);
    assert_eq!(ours.steps, theirs.steps, "both take the same steps");
    let (a, b) = (seconds(&here), seconds(&c));
    let ns = 1e9 / (cells * ours.steps) as f64;
    println!(
        "{:<14}{:>9}{:>7}{:>12.3}{:>12.3}{:>9.2}{:>13.3}{:>10.3}{:>12.2e}{:>12.2e}",
        problem.name(),
        cells,
        ours.steps,
        a * 1e3,
        b * 1e3,
        a / b,
        a * ns,
        b * ns,
        ours.error,
        theirs.error
    );
}

fn compare_long(peer: &Peer, problem: Problem, waves: usize, rounds: usize) {
    let (mut one, mut pair, mut c) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds.min(5) {
        one.push(run_long(problem, waves, 1));
        pair.push(run_long(problem, waves, 2));
        match peer.run(problem, LONG_CELLS, Some(waves)) {
            Some(outcome) => c.push(outcome),
            None => return,
        }
    }
    let [a, b, two] = [&one, &c, &pair].map(|outcomes| seconds(outcomes));
    let ns = 1e9 / (LONG_CELLS * LONG_STEPS) as f64;
    println!(
        "{:<14}{:>9}{:>12.1}{:>12.1}{:>9.2}{:>13.3}{:>10.3}{:>14.1}{:>7.2}",
        problem.name(),
        waves,
        a * 1e3,
        b * 1e3,
        a / b,
        a * ns,
        b * ns,
        two * 1e3,
        shortest(&one) / shortest(&pair)
    );
}

fn shortest(outcomes: &[Outcome]) -> f64 {
    outcomes.iter().map(|o| o.seconds).fold(f64::INFINITY, f64::min)
}

fn seconds(outcomes: &[Outcome]) -> f64 {
    median(outcomes.iter().map(|o| o.seconds).collect())
}
