//! Riemann problems inside one medium whose solution is elastic on both sides. Most interactions of fronts in a bar are of this kind.

use super::medium::{Flow, Medium, Point};
use super::path::Emitted;

impl Medium {
    /// Returns true if a change from a point's stress to `stress` (Pa) is elastic by more than rounding.
    fn stays_elastic(&self, point: &Point, stress: f64) -> bool {
        match self.flow {
            Flow::PathIndependent => {
                let inside = |stress: f64| stress.abs() < self.lines(stress).first_yield - self.round_off;
                self.is_on_elastic_line(point) && inside(point.stress) && inside(stress)
            }
            Flow::Plastic { kinematic } => {
                let sense = 1.0_f64.copysign(stress - point.stress);
                sense * stress < self.limit(point.accumulated, point.back, sense, kinematic) - self.round_off
            }
            Flow::Overlay => false,
        }
    }

    /// Returns the elastic waves that two adjacent points of this medium emit into each other (in -x, and in +x), each at most one. Returns `None` if
    /// one of the points leaves the elastic line, and for overlays.
    pub fn elastic_waves(&self, left: &Point, right: &Point) -> Option<[Emitted; 2]> {
        let impedance = self.impedance();
        let stress = 0.5 * (left.stress + right.stress) + 0.5 * impedance * (right.velocity - left.velocity);
        let behind = |point: &Point, direction: f64| {
            let change = stress - point.stress;
            // A wave within rounding is not emitted.
            if change.abs() <= self.round_off {
                return *point;
            }
            Point { stress, velocity: point.velocity - direction * change / impedance, ..*point }
        };
        let elastic = self.stays_elastic(left, stress) && self.stays_elastic(right, stress);
        // Computed as for waves along paths, to the last bit: the distance of two fronts close to each other then stays constant.
        let speed = 1.0 / (self.density * (1.0 / impedance));
        elastic.then(|| [(left, -1.0), (right, 1.0)].map(|(point, way)| Emitted { speed, behind: behind(point, way) }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Path, Side, Workspace, solve};
    use super::*;
    use crate::law::Table;
    use crate::material::{Beyond, Curve};

    fn medium(flow: Flow) -> Medium {
        let rows = [(1e-3, 2e8), (1e-2, 3e8), (1e-1, 4e8)];
        let table = Table::new(&Curve::new(&rows, Beyond::Extend).expect("a curve"), 2e11);
        Medium::new([&table, &table], 2e11, 7800.0, 1e-4, flow, 1e-5)
    }

    /// Returns points that have flowed or not, at stresses within their elastic range.
    fn points(medium: &Medium) -> Vec<Point> {
        let (flowed, kinematic) = match medium.flow {
            Flow::Plastic { kinematic } => (vec![(0.0, 1.0), (1e9, 1.0), (8e9, -1.0)], kinematic),
            _ => (vec![(0.0, 1.0)], 0.0),
        };
        let mut points = Vec::new();
        for (accumulated, sense) in flowed {
            let lines = medium.lines(sense);
            let hardening = lines.at_accumulated(accumulated).2 - lines.first_yield;
            let back = sense * kinematic * hardening;
            for part in [-0.9, 0.0, 0.3, 1.0] {
                let stress = back + part * (lines.first_yield + (1.0 - kinematic) * hardening);
                for velocity in [-3.0, 0.0, 5.0] {
                    points.push(Point { stress, velocity, accumulated, plastic: sense * accumulated, back, work: 1.0 });
                }
            }
        }
        points
    }

    /// Returns the states behind the waves of the general problem.
    fn solved(medium: &Medium, left: &Point, right: &Point) -> [Point; 2] {
        let (mut work, mut sent) = (Workspace::default(), Vec::new());
        let star = solve(Side::Bar(medium, left), Side::Bar(medium, right), &mut work);
        let tau = |path: &Path| path.sense() * star.force / path.area();
        let (left, right) = (tau(&work.left), tau(&work.right));
        [work.left.emit(left, -1.0, &mut sent), work.right.emit(right, 1.0, &mut sent)]
    }

    #[test]
    fn they_are_the_waves_of_the_general_problem_where_nothing_flows() {
        let flows = [0.0, 0.4, 1.0].map(|kinematic| Flow::Plastic { kinematic });
        for medium in flows.into_iter().chain([Flow::PathIndependent]).map(medium) {
            let (points, mut elastic) = (points(&medium), 0);
            for (left, right) in points.iter().flat_map(|a| points.iter().map(move |b| (a, b))) {
                let general = solved(&medium, left, right);
                let flow = general[0].plastic - left.plastic + right.plastic - general[1].plastic;
                let Some(waves) = medium.elastic_waves(left, right) else {
                    // At the yield stress rounding decides.
                    let at_yield = |point: &Point| medium.stays_elastic(point, general[0].stress);
                    assert!(flow != 0.0 || !at_yield(left) || !at_yield(right), "{left:?} {right:?}");
                    continue;
                };
                elastic += 1;
                for (Emitted { speed, behind: wave }, general) in waves.iter().zip(&general) {
                    assert!((speed / medium.c0() - 1.0).abs() < 1e-15);
                    let near = |a: f64, b: f64, most: f64| (a - b).abs() <= most;
                    assert!(near(wave.stress, general.stress, 1e-5) && near(wave.velocity, general.velocity, 1e-11));
                    assert!(near(wave.plastic, general.plastic, 1e-5) && near(wave.work, general.work, 1e-9));
                }
            }
            assert!(elastic > points.len(), "{elastic}");
        }
    }

    #[test]
    fn a_wave_within_rounding_is_not_sent() {
        let medium = medium(Flow::Plastic { kinematic: 0.0 });
        let (left, right) = (Point::default(), Point { stress: 1e-6, ..Point::default() });
        assert_eq!(medium.elastic_waves(&left, &right).map(|waves| waves.map(|wave| wave.behind)), Some([left, right]));
    }
}
