//! Builds bars on a characteristic net, without scene files.
#![allow(dead_code, reason = "every test file takes what it needs")]

use barwave::bar::{Bar, EndCondition, Segment};
use barwave::law::Table;
use barwave::law::rate::{Overstress, RateLaw};
use barwave::material::{Material, Sense};
use barwave::solver::fd::Quantity;
use barwave::solver::net::{self, Net};

/// Returns the rate law of a material.
pub fn law(material: &Material, overstress: Overstress, kinematic: f64) -> RateLaw {
    let table = |sense| Table::new(material.branch(sense), material.modulus);
    let compression = material.compression.is_some().then(|| table(Sense::Compression));
    RateLaw::new(overstress, &table(Sense::Tension), compression.as_ref(), kinematic)
}

/// Returns the net at t = 0, with the same overstress law in all segments.
pub fn net(
    segments: Vec<Segment>,
    ends: [EndCondition; 2],
    overstress: Overstress,
    kinematic: f64,
    cells: usize,
) -> Net {
    let laws = segments.iter().map(|s| law(&s.material, overstress, kinematic)).collect();
    let bar = Bar { segments, area_given: true };
    Net::new(&bar, net::grid(&bar, cells), laws, ends)
}

/// Returns a net with Malvern's law and isotropic hardening.
pub fn malvern(segments: Vec<Segment>, ends: [EndCondition; 2], k: f64, cells: usize) -> Net {
    net(segments, ends, Overstress::Malvern { k }, 0.0, cells)
}

/// Advances a net to the step nearest to a time.
pub fn advance_to(net: &mut Net, time: f64) {
    while net.time() < time - 0.5 * net.grid().dt {
        net.advance();
    }
}

/// Returns a quantity in every cell.
pub fn profile(net: &Net, quantity: Quantity) -> Vec<f64> {
    let mut values = vec![0.0; net.grid().cells()];
    net.profile(quantity, &mut values);
    values
}

/// Balance of energy and momentum of a net since t = 0.
pub struct Balance {
    start: (f64, f64),
}

impl Balance {
    /// Records the state at t = 0.
    pub fn new(net: &Net) -> Self {
        let energies = net.energies();
        Self { start: (energies.total(), energies.momentum) }
    }

    /// Returns the residuals of the energy and of the momentum balance, relative to the largest contribution.
    pub fn residuals(&self, net: &Net) -> [f64; 2] {
        let (energies, work, impulse) = (net.energies(), net.work(), net.impulse());
        let energy = energies.total() - self.start.0 - work[0] - work[1];
        let energy_scale = energies.total().max(self.start.0).max(work[0].abs()).max(work[1].abs());
        let momentum = energies.momentum - self.start.1 - impulse[0] - impulse[1];
        let momentum_scale = net.throughput() + self.start.1.abs();
        let relative = |part: f64, of: f64| if part == 0.0 { 0.0 } else { part.abs() / of };
        [relative(energy, energy_scale), relative(momentum, momentum_scale)]
    }
}
