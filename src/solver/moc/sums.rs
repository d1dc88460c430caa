//! Energies and momentum of a front-tracking bar: exact sums over its constant pieces.

use super::FrontTracking;
use super::list::{Kind, NONE};
use super::tracking::FrontWork;

/// Balance at one time, J and N s (per m^2 if the bar has no area of its own).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Balance {
    /// Kinetic energy, sum of rho v^2/2 dV.
    pub kinetic: f64,
    /// Strain energy, sum of sigma^2/(2E) dV.
    pub elastic: f64,
    /// Plastic work that was not converted to heat, and dissipation in shocks along the chords of a stiffening curve.
    pub plastic: f64,
    /// Plastic work that was converted to heat.
    pub heat: f64,
    /// Work dissipated at single points where a level curve keeps the velocities of the two sides different.
    pub concentrated: f64,
    /// Energy dissipated by the method: the spread of the values that merging of waves averages, less what fronts return after merging made them flow
    /// against their stress; what the steps of bodies at the ends do not resolve; and the effect of rounding positions and of moving near fronts to
    /// one point.
    pub numerical: f64,
    /// Momentum, positive in +x.
    pub momentum: f64,
    /// Momentum that rounding of positions and moving near fronts to one point added to the bar.
    pub shifted: f64,
    /// Work done on the bar through its left and right ends: the energy lost by a body there, otherwise the work of the force on the face.
    pub work: [f64; 2],
    /// Impulse given to the bar through its left and right ends.
    pub impulse: [f64; 2],
    /// Sum of the magnitudes of all impulses of both ends.
    pub throughput: f64,
}

impl Balance {
    /// Total energy of the bar including all dissipation.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.plastic + self.heat + self.concentrated + self.numerical
    }
}

impl FrontTracking {
    /// Returns energies, momentum, and work and impulse through the ends, at the present time.
    pub fn balance(&self) -> Balance {
        let FrontWork { plastic, heat, against } = self.total_front_work();
        let mut sum = Balance {
            plastic,
            heat,
            concentrated: self.removed_nodes.concentrated,
            numerical: self.merging.energy + against - self.removed_nodes.shifted.energy,
            shifted: self.removed_nodes.shifted.momentum,
            ..Balance::default()
        };
        for node in self.list.iter().filter(|node| node.next != NONE) {
            let (medium, point) = (self.medium(node.segment as usize), &node.right);
            let volume = medium.area * self.length_after(node);
            sum.kinetic += 0.5 * medium.density * point.velocity * point.velocity * volume;
            sum.elastic += 0.5 * point.stress * point.stress / medium.modulus * volume;
            let heats = self.heating(node.segment as usize).map_or(0.0, |heating| heating.fraction);
            sum.plastic += (1.0 - heats) * (point.work * volume);
            sum.heat += heats * (point.work * volume);
            sum.momentum += medium.density * point.velocity * volume;
        }
        for node in self.list.iter().filter(|n| matches!(n.kind, Kind::Contact | Kind::Joint)) {
            sum.concentrated += self.stretch_work(node);
        }
        for (k, end) in self.ends.iter().enumerate() {
            let through = end.sums(self.time());
            sum.work[k] = through.work;
            sum.concentrated += through.gathered;
            sum.numerical += through.work - through.on_face;
            sum.impulse[k] = end.face.inward * through.impulse;
            sum.throughput += through.throughput;
        }
        sum
    }
}
