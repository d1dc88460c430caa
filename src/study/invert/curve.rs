//! Curve from wave speeds: sigma = rho integral c^2 d eps, v = integral c d eps.

use serde::Serialize;

use super::bands::{HALF_95, bias, deviation};

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Estimate.
    pub value: f64,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl Interval {
    /// Creates the interval of an estimate from bootstrap replicates, whose standard deviation is multiplied by `widened`. The mean deviation of the
    /// replicates from the estimate approximates that of the estimate from the true value, so the interval is extended by it on the opposite side.
    pub(super) fn of_replicates(value: f64, replicates: impl Iterator<Item = f64> + Clone, widened: f64) -> Self {
        let half = HALF_95 * widened * deviation(replicates.clone());
        let bias = bias(replicates, value);
        Self { value, low: value - half - bias.max(0.0), high: value + half + (-bias).max(0.0) }
    }

    /// Limits the interval of a magnitude to values >= 0.
    pub(super) fn magnitude(self) -> Self {
        Self { low: self.low.max(0.0), ..self }
    }

    /// Extends the interval by the bounds of the estimate, which result from the unknown curve between the levels.
    pub(super) fn within(self, [low, high]: [f64; 2]) -> Self {
        Self {
            value: self.value,
            low: self.low - (self.value - low).max(0.0),
            high: self.high + (high - self.value).max(0.0),
        }
    }
}

/// One strain level of an inverted curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WavePoint {
    /// Engineering strain.
    pub strain: f64,
    /// Speed at which this strain propagates, m/s.
    pub wave_speed_m_s: Interval,
    /// Engineering stress, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress_pa: Interval,
    /// Impact velocity that loads a long bar to this strain, m/s.
    pub velocity_m_s: Interval,
    /// Number of gauges (or sections) that give the speed.
    pub gauges: usize,
}

/// Speeds at increasing strains, and the stresses and velocities integrated from them.
#[derive(Debug, Clone)]
pub(super) struct Integrated {
    pub(super) speed: Vec<f64>,
    pub(super) stress: Vec<f64>,
    pub(super) velocity: Vec<f64>,
}

/// Integrates speeds c (m/s) over the strain from `start` (strain, stress, velocity). No speed exceeds `fastest`.
///
/// Between two levels c is a power of the strain, as for every power-law hardening curve. Below the first level it follows the power of the first two
/// levels up to `fastest`. If that is not known, c is constant there, so the stress is a lower bound.
pub(super) fn integrate(
    density: f64,
    strain: &[f64],
    speed: Vec<f64>,
    start: [f64; 3],
    fastest: Option<f64>,
) -> Integrated {
    let (mut stress, mut velocity) = (Vec::with_capacity(strain.len()), Vec::with_capacity(strain.len()));
    let [mut before, mut sigma, mut v] = start;
    let mut speed_before = speed.first().copied().unwrap_or(0.0);
    let mut add = |e: f64, c: f64| {
        let mean = |power: i32| power_mean([before, e], [speed_before.powi(power), c.powi(power)]);
        sigma += density * mean(2) * (e - before);
        v += mean(1) * (e - before);
        (before, speed_before) = (e, c);
        (sigma, v)
    };
    for (e, c) in below_first(strain, &speed, start[0], fastest) {
        add(e, c);
    }
    for (&e, &c) in strain.iter().zip(&speed) {
        let (sigma, v) = add(e, c);
        stress.push(sigma);
        velocity.push(v);
    }
    Integrated { speed, stress, velocity }
}

/// Returns levels and speeds between the start and the first level, from the power law of the first two levels.
fn below_first(strain: &[f64], speed: &[f64], start: f64, fastest: Option<f64>) -> Vec<(f64, f64)> {
    // The smallest level, 2^-24 of the first one, counts as zero strain.
    const HALVINGS: i32 = 24;
    let (Some(fastest), true) = (fastest, strain.len() > 1) else { return Vec::new() };
    let power = (speed[0] / speed[1]).ln() / (strain[1] / strain[0]).ln();
    if power.is_nan() || power <= 0.0 {
        return Vec::new();
    }
    let level = |halvings: i32| strain[0] * 0.5_f64.powi(halvings);
    let speed_at = |e: f64| (speed[0] * (strain[0] / e).powf(power)).clamp(speed[0], fastest.max(speed[0]));
    (1..=HALVINGS).rev().map(level).filter(|&e| e > start).map(|e| (e, speed_at(e))).collect()
}

/// Returns the mean over an interval of strain of a power function with the given values at the ends of the interval; linear if the interval starts
/// at zero strain.
fn power_mean([a, b]: [f64; 2], [at_a, at_b]: [f64; 2]) -> f64 {
    let linear = 0.5 * (at_a + at_b);
    if a <= 0.0 || b <= a || at_a <= 0.0 || at_b <= 0.0 || at_a == at_b {
        return linear;
    }
    let power = (at_b / at_a).ln() / (b / a).ln();
    // A front: the speed decreases at one strain.
    if power.abs() > 20.0 {
        return linear;
    }
    let ratio = b / a;
    let integral = if (power + 1.0).abs() < 1e-9 {
        at_a * a * ratio.ln()
    } else {
        at_a * a * (ratio.powf(power + 1.0) - 1.0) / (power + 1.0)
    };
    integral / (b - a)
}

/// Lower and upper bounds of the stress and of the velocity at each level.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    pub(super) stress: Vec<[f64; 2]>,
    pub(super) velocity: Vec<[f64; 2]>,
}

/// Returns bounds of the results of [`integrate`]. Along a concave curve the speed does not increase with the strain, so between two levels it is at
/// most that of the lower level and at least that of the upper one. Below the first level it is at most `fastest`. If that is not known, the speed of
/// the first level is used in its place, and the result is not an upper bound.
pub(super) fn bounds(
    density: f64,
    strain: &[f64],
    speed: &[f64],
    [start, stress, velocity]: [f64; 3],
    fastest: Option<f64>,
) -> Bounds {
    let mut all = Bounds { stress: Vec::with_capacity(strain.len()), velocity: Vec::with_capacity(strain.len()) };
    let (mut before, mut sigma, mut v) = (start, [stress; 2], [velocity; 2]);
    let mut above = fastest.or(speed.first().copied()).unwrap_or(0.0);
    for (&e, &c) in strain.iter().zip(speed) {
        for (k, speed) in [c.min(above), c.max(above)].into_iter().enumerate() {
            sigma[k] += density * speed * speed * (e - before);
            v[k] += speed * (e - before);
        }
        (before, above) = (e, c);
        all.stress.push(sigma);
        all.velocity.push(v);
    }
    all
}

/// Returns the points with their intervals, from replicates at the same levels, whose standard errors are multiplied by `widened`, and from the
/// bounds.
pub(super) fn points(
    strain: &[f64],
    best: &Integrated,
    replicates: &[Integrated],
    bounds: &Bounds,
    gauges: &[usize],
    widened: f64,
) -> Vec<WavePoint> {
    let interval = |i: usize, of: fn(&Integrated) -> &[f64]| {
        Interval::of_replicates(of(best)[i], replicates.iter().map(move |replicate| of(replicate)[i]), widened)
    };
    let point = |(i, &strain): (usize, &f64)| WavePoint {
        strain,
        wave_speed_m_s: interval(i, |c| &c.speed).magnitude(),
        stress_pa: interval(i, |c| &c.stress).within(bounds.stress[i]).magnitude(),
        velocity_m_s: interval(i, |c| &c.velocity).within(bounds.velocity[i]).magnitude(),
        gauges: gauges[i],
    };
    strain.iter().enumerate().map(point).collect()
}

/// Largest uncertainty of the first point, relative to the largest stress, for which no warning is given.
const KNOWN_START: f64 = 0.25;

/// Returns a warning if the curve below the first point is not known well enough: its uncertainty shifts all stresses. The points are ordered by
/// strain.
pub(super) fn unknown_start(points: &[WavePoint], help: &str) -> Option<String> {
    let WavePoint { strain, stress_pa: Interval { value, low, high }, .. } = *points.first()?;
    (high - low > KNOWN_START * points.last()?.stress_pa.value).then(|| {
        format!(
            "the curve below the lowest strain level, {strain:.6}, is not known: all stresses may be too large by {:.0} MPa, or too small by \
             {:.0} MPa, together; {help}",
            (value - low) / 1e6,
            (high - value) / 1e6
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_of_a_power_law_integrate_to_it() {
        // sigma = K e^n: c^2 = K n e^(n - 1)/rho.
        let (density, k, n) = (8960.0, 500e6, 0.4);
        let strain: Vec<f64> = (1..=8).map(|i| 0.01 * f64::from(i)).collect();
        let speed = strain.iter().map(|e| (k * n * e.powf(n - 1.0) / density).sqrt()).collect();
        let integrated = integrate(density, &strain, speed, [0.0; 3], Some(1e5));
        for (e, stress) in strain.iter().zip(&integrated.stress) {
            // The elastic part is short, and what is below 2^-24 of the first level is left out.
            assert!((stress / (k * e.powf(n)) - 1.0).abs() < 2e-3, "{e}: {stress:e}");
        }
    }

    #[test]
    fn estimates_lie_between_the_bounds_of_a_falling_speed() {
        // Sharp yield at 0.001: no level lies at the knee.
        let (density, strain, speed) = (8000.0, [0.0005, 0.002, 0.01], vec![5000.0, 1000.0, 500.0]);
        let bounds = bounds(density, &strain, &speed, [0.0; 3], Some(5000.0));
        let integrated = integrate(density, &strain, speed, [0.0; 3], Some(5000.0));
        for (of, bounds) in [(&integrated.stress, &bounds.stress), (&integrated.velocity, &bounds.velocity)] {
            for (value, [low, high]) in of.iter().zip(bounds) {
                assert!((low * (1.0 - 1e-12)..=high * (1.0 + 1e-12)).contains(value), "{low:e} {value:e} {high:e}");
            }
        }
        // 100 MPa elastic, then 0.0015 at 1000 or at 5000 m/s.
        for (bound, expected) in bounds.stress[1].iter().zip([112e6, 400e6]) {
            assert!((bound / expected - 1.0_f64).abs() < 1e-12, "{bound:e}");
        }
    }

    #[test]
    fn an_elastic_level_integrates_along_the_modulus() {
        let integrated = integrate(8000.0, &[0.001], vec![5000.0], [0.0; 3], Some(5000.0));
        assert!((integrated.stress[0] / 200e6 - 1.0).abs() < 1e-12);
        assert!((integrated.velocity[0] / 5.0 - 1.0).abs() < 1e-12);
    }
}
