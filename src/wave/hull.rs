//! Upper concave hull of a loading curve, built point by point.

use crate::material::SLOPE_ROUND_OFF;

/// A point of the curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knot {
    pub(super) strain: f64,
    /// Stress, Pa.
    pub(super) stress: f64,
}

impl Knot {
    pub(super) fn slope_to(self, to: Self) -> f64 {
        (to.stress - self.stress) / (to.strain - self.strain)
    }
}

/// A linear piece of the curve, rising or flat. `to` is `None` for the unbounded extension.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) from: Knot,
    /// Slope d sigma/d eps, Pa.
    pub(super) slope: f64,
    pub(super) to: Option<Knot>,
}

impl Line {
    fn at(self, strain: f64) -> Knot {
        Knot { strain, stress: self.from.stress + self.slope * (strain - self.from.strain) }
    }

    /// Returns true if the piece extends beyond this strain.
    fn contains(self, strain: f64) -> bool {
        self.to.is_none_or(|to| strain < to.strain)
    }
}

/// Hull of the curve up to its last point, updated while that point moves along the curve: knots from (0, 0)
/// with strictly falling slopes, and the velocity change up to each.
#[derive(Debug)]
pub(super) struct Hull {
    density: f64,
    knots: Vec<Knot>,
    velocity: Vec<f64>,
}

impl Hull {
    /// Returns the hull of the origin alone; density in kg/m^3.
    pub(super) fn new(density: f64) -> Self {
        Self { density, knots: vec![Knot { strain: 0.0, stress: 0.0 }], velocity: vec![0.0] }
    }

    pub(super) fn density(&self) -> f64 {
        self.density
    }

    pub(super) fn knots(&self) -> &[Knot] {
        &self.knots
    }

    pub(super) fn last(&self) -> Knot {
        self.knots[self.knots.len() - 1]
    }

    /// Returns the velocity change up to the last point, m/s.
    pub(super) fn velocity(&self) -> f64 {
        self.velocity[self.velocity.len() - 1]
    }

    /// Adds a point of the curve beyond the last one, and removes the knots that then lie under the hull.
    pub(super) fn push(&mut self, to: Knot) {
        if to.strain <= self.last().strain {
            return;
        }
        let kept = self.tangent(to) + 1;
        self.knots.truncate(kept);
        self.velocity.truncate(kept);
        self.velocity.push(self.velocity() + self.jump(self.last(), to));
        self.knots.push(to);
    }

    /// Returns the index of the knot at which the edge of the hull to this later point starts.
    fn tangent(&self, to: Knot) -> usize {
        let mut k = self.knots.len() - 1;
        while k > 0 && self.slope_before(k) <= self.knots[k].slope_to(to) * (1.0 + SLOPE_ROUND_OFF) {
            k -= 1;
        }
        k
    }

    /// Returns the slope of the edge that ends at knot `k` >= 1.
    fn slope_before(&self, k: usize) -> f64 {
        self.knots[k - 1].slope_to(self.knots[k])
    }

    /// Returns the velocity jump of an edge, sqrt(d sigma d eps/rho), m/s.
    fn jump(&self, from: Knot, to: Knot) -> f64 {
        ((to.stress - from.stress) * (to.strain - from.strain) / self.density).sqrt()
    }

    /// Returns the velocity change up to knot `k` and from there to a point beyond it, m/s.
    fn velocity_via(&self, k: usize, to: Knot) -> f64 {
        self.velocity[k] + self.jump(self.knots[k], to)
    }

    /// Returns the point of `line` (which starts at the last point) at which the velocity change is `velocity`. Returns `None` if the
    /// line ends before.
    ///
    /// The hull's last edge runs from a tangent knot to the moving point. While the point moves along a line steeper than the hull's last edges
    /// (lock-up), the tangent knot steps back each time the point crosses the extension of the edge before it. In between, the velocity is V + sqrt(d
    /// sigma d eps/rho), whose inverse is a quadratic equation.
    pub(super) fn reach_velocity(&self, line: Line, velocity: f64) -> Option<Knot> {
        if line.to.is_some_and(|to| self.velocity_via(self.tangent(to), to) < velocity) {
            return None;
        }
        let mut k = self.knots.len() - 1;
        while self.prolongation_meets(k, line).is_some_and(|at| self.velocity_via(k, at) < velocity) {
            k -= 1;
        }
        Some(self.solve_edge(k, line, velocity))
    }

    /// Returns the point at which the extension of the edge that ends at knot `k` meets a steeper line. `None` if they do not meet on the line.
    fn prolongation_meets(&self, k: usize, line: Line) -> Option<Knot> {
        if k == 0 || line.slope <= self.slope_before(k) * (1.0 + SLOPE_ROUND_OFF) {
            return None;
        }
        let (knot, slope) = (self.knots[k], self.slope_before(k));
        let above = knot.stress + slope * (line.from.strain - knot.strain) - line.from.stress;
        let strain = line.from.strain + (above / (line.slope - slope)).max(0.0);
        line.contains(strain).then(|| line.at(strain))
    }

    /// Returns the point of `line` for which an edge from knot `k` makes the velocity change equal to `velocity`.
    fn solve_edge(&self, k: usize, line: Line, velocity: f64) -> Knot {
        let knot = self.knots[k];
        let target = self.density * (velocity - self.velocity[k]).powi(2);
        // With d eps = x, d sigma = lead + slope x: slope x^2 + lead x = target. The form of the root avoids cancellation
        // for either sign of `lead`.
        let lead = line.at(knot.strain).stress - knot.stress;
        let root = (lead * lead + 4.0 * line.slope * target).sqrt();
        let x = if lead >= 0.0 { 2.0 * target / (lead + root) } else { (root - lead) / (2.0 * line.slope) };
        let strain = (knot.strain + x).max(line.from.strain);
        line.to.filter(|_| !line.contains(strain)).unwrap_or_else(|| line.at(strain))
    }

    /// Returns the first point of `line` with this stress. Returns `None` if the line ends before.
    pub(super) fn reach_stress(line: Line, stress: f64) -> Option<Knot> {
        match line.to {
            Some(to) if to.stress < stress => None,
            Some(to) if to.stress == stress => Some(to),
            _ => {
                let strain = line.from.strain + (stress - line.from.stress) / line.slope;
                Some(Knot { strain: strain.max(line.from.strain), stress })
            }
        }
    }
}
