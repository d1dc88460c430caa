//! The curve from wave speeds: sigma = rho integral c^2 d eps, v = integral c d eps.

use serde::Serialize;

use super::bands::{HALF_95, deviation};

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl Interval {
    /// Estimate and standard error.
    pub(super) fn of(value: f64, error: f64) -> Self {
        Self { value, low: value - HALF_95 * error, high: value + HALF_95 * error }
    }

    /// Half of its width.
    pub fn half_width(self) -> f64 {
        0.5 * (self.high - self.low)
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
    /// Gauges (or sections) that give the speed.
    pub gauges: usize,
}

/// Speeds at increasing strains and what they integrate to.
#[derive(Debug, Clone)]
pub(super) struct Integrated {
    pub(super) speed: Vec<f64>,
    pub(super) stress: Vec<f64>,
    pub(super) velocity: Vec<f64>,
}

/// Integrates speeds c (m/s) over strains from `start` (strain, stress, velocity), where the speed is at most `fastest`.
///
/// Between two levels c follows a power of the strain, as behind every power-law hardening curve. Below the first level it follows the
/// power of the first two up to the fastest; it is constant where no fastest is known, so the stress is then a lower bound.
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

/// Levels and speeds between the start and the first level, by the power of the first two levels.
fn below_first(strain: &[f64], speed: &[f64], start: f64, fastest: Option<f64>) -> Vec<(f64, f64)> {
    // 2^-24 of the first level counts as zero strain.
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

/// Mean over an interval of a function that is a power of the strain with these values at its ends; linear where the interval starts at
/// zero strain.
fn power_mean([a, b]: [f64; 2], [at_a, at_b]: [f64; 2]) -> f64 {
    let linear = 0.5 * (at_a + at_b);
    if a <= 0.0 || b <= a || at_a <= 0.0 || at_b <= 0.0 || at_a == at_b {
        return linear;
    }
    let power = (at_b / at_a).ln() / (b / a).ln();
    // A front: the speed falls at one strain.
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

/// Points with intervals from replicates of the same levels, the standard errors times `widened`.
pub(super) fn points(
    strain: &[f64],
    best: &Integrated,
    replicates: &[Integrated],
    gauges: &[usize],
    widened: f64,
) -> Vec<WavePoint> {
    let interval = |i: usize, of: fn(&Integrated) -> &[f64]| {
        Interval::of(of(best)[i], widened * deviation(replicates.iter().map(|replicate| of(replicate)[i])))
    };
    let point = |(i, &strain): (usize, &f64)| WavePoint {
        strain,
        wave_speed_m_s: interval(i, |c| &c.speed),
        stress_pa: interval(i, |c| &c.stress),
        velocity_m_s: interval(i, |c| &c.velocity),
        gauges: gauges[i],
    };
    strain.iter().enumerate().map(point).collect()
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
    fn an_elastic_level_integrates_along_the_modulus() {
        let integrated = integrate(8000.0, &[0.001], vec![5000.0], [0.0; 3], Some(5000.0));
        assert!((integrated.stress[0] / 200e6 - 1.0).abs() < 1e-12);
        assert!((integrated.velocity[0] / 5.0 - 1.0).abs() < 1e-12);
    }
}
