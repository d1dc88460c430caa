//! The methods, and the state of a bar with any of them.

use barwave::assemble::{self, Task};
use barwave::record::{Ledger, Stepped};
use barwave::scene::Scene;
use barwave::snapshot::Snapshot;
use barwave::solver::fd::Quantity;
use barwave::solver::moc::Settings;

use super::{YIELD, material};

/// Method of solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    Leapfrog,
    Godunov,
    Fronts,
    /// Characteristic net, with a rate-dependent bar.
    Net,
}

/// Number of positions at which tracked bars are sampled.
const SAMPLES: usize = 400;

impl By {
    pub const ALL: [Self; 4] = [Self::Leapfrog, Self::Godunov, Self::Fronts, Self::Net];
    pub const RATE_INDEPENDENT: [Self; 3] = [Self::Leapfrog, Self::Godunov, Self::Fronts];

    /// Returns the keys of `[solve]` for a run with about `cells` cells at Courant number 1; front tracking merges no waves.
    pub fn solve(self, until: f64, cells: usize) -> String {
        let tolerance = if self == Self::Fronts { "\nfront-tolerance = 0" } else { "" };
        self.solve_within(until, cells, 1.0) + tolerance
    }

    /// Returns the keys of `[solve]` with a given Courant number; front tracking merges waves.
    pub fn solve_within(self, until: f64, cells: usize, cfl: f64) -> String {
        let method = match self {
            Self::Leapfrog => format!("method = \"fd\"\ncells = {cells}\ncfl = {cfl}"),
            Self::Godunov => format!("method = \"fd\"\nscheme = \"muscl\"\ncells = {cells}\ncfl = {cfl}"),
            Self::Fronts => "method = \"moc\"".to_owned(),
            Self::Net => format!("method = \"moc\"\ncells = {cells}"),
        };
        format!("until = {until}\n{method}")
    }

    /// Returns the steel, with a rate law if the method requires one.
    pub fn material(self, more: &str) -> String {
        let rate = if self == Self::Net { ", rate.malvern = { k = \"2e6 1/s\" }" } else { "" };
        material(YIELD, &format!("{rate}{more}"))
    }

    pub fn effects(self, others: &str) -> String {
        let rate = if self == Self::Net { "rate = \"material\"" } else { "" };
        format!("{others}\n{rate}")
    }
}

/// State of a bar at one time, in cells or at samples between fronts.
#[derive(Debug, Clone)]
pub struct Seen {
    pub time: f64,
    pub x: Vec<f64>,
    pub stress: Vec<f64>,
    pub velocity: Vec<f64>,
    pub plastic: Vec<f64>,
    pub ledger: Ledger,
}

/// Returns the state of the bar of a scene at `time`, s; on a grid, at the nearest step.
pub fn follow(scene: &Scene, time: f64) -> Seen {
    assemble::solve(scene, Following { scene, time })
}

struct Following<'a> {
    scene: &'a Scene,
    time: f64,
}

impl Task for Following<'_> {
    type Output = Seen;

    fn on_grid(self, mut bar: impl Stepped + Snapshot) -> Seen {
        let mut ledger = Ledger::new(&bar);
        ledger.row(&bar);
        while bar.time() < self.time - 0.5 * bar.grid().dt {
            bar.advance();
            ledger.row(&bar);
        }
        let read = |quantity: Quantity| {
            let mut values = vec![0.0; bar.grid().cells()];
            bar.profile(quantity, &mut values);
            values
        };
        let [stress, velocity, plastic] = [Quantity::Stress, Quantity::Velocity, Quantity::PlasticStrain].map(read);
        Seen { time: bar.time(), x: bar.grid().centres(), stress, velocity, plastic, ledger }
    }

    fn by_fronts(self, settings: Settings) -> Seen {
        follow_fronts(self.scene, settings, self.time)
    }
}

fn follow_fronts(scene: &Scene, settings: Settings, time: f64) -> Seen {
    let mut bar = assemble::front_tracking(scene, settings);
    let mut ledger = Ledger::new(&bar);
    ledger.row(&bar);
    bar.advance_to(time).unwrap_or_else(|e| panic!("{e}"));
    ledger.row(&bar);
    let part = scene.bar.length() / SAMPLES as f64;
    let x: Vec<f64> = (0..SAMPLES).map(|i| (i as f64 + 0.5) * part).collect();
    let (mut stress, mut velocity, mut plastic) = (Vec::new(), Vec::new(), Vec::new());
    bar.sweep(&x, |_, segment, point| {
        stress.push(point.stress);
        velocity.push(point.velocity);
        plastic.push(bar.medium(segment).plastic_strain(point));
    });
    Seen { time, x, stress, velocity, plastic, ledger }
}
