//! Synthetic test records from known curves, with noise, toe, unloading and fracture.

use std::fmt::Write as _;

/// Generator of random numbers that are the same in every run (xorshift64*).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a standard normal random number.
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}

/// Known curve, with its modulus (Pa) and its last strain.
pub struct Truth {
    pub modulus: f64,
    pub end: f64,
    stress: fn(f64) -> f64,
}

impl Truth {
    /// Returns the engineering stress at an engineering strain, Pa.
    pub fn stress(&self, strain: f64) -> f64 {
        (self.stress)(strain)
    }

    /// Returns the stress at a plastic strain of 0.2 %, Pa.
    pub fn proof_stress(&self) -> f64 {
        let above = |e: f64| self.stress(e) - self.modulus * (e - 0.002);
        let (mut low, mut high) = (0.002, self.end);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            *if above(middle) > 0.0 { &mut low } else { &mut high } = middle;
        }
        self.stress(low)
    }

    /// Returns the integral of the wave speed over strain up to the largest stress, m/s, which is the critical velocity for a concave curve.
    pub fn critical_velocity(&self, density: f64) -> f64 {
        // Strains in cubic progression, since the curvature is largest at the start.
        let points: Vec<(f64, f64)> =
            (0..=200_000).map(|i| self.end * (f64::from(i) / 200_000.0).powi(3)).map(|e| (e, self.stress(e))).collect();
        let top = (0..points.len()).max_by(|a, b| points[*a].1.total_cmp(&points[*b].1)).expect("points");
        points[..=top].windows(2).map(|p| ((p[1].0 - p[0].0) * (p[1].1 - p[0].1).max(0.0) / density).sqrt()).sum()
    }
}

/// Ramberg-Osgood curve minus a term that makes the engineering stress decrease after a strain of about 12 %.
pub const RAMBERG_OSGOOD: Truth = Truth { modulus: 205e9, end: 0.25, stress: ramberg_osgood };

fn ramberg_osgood(strain: f64) -> f64 {
    let total = |s: f64| s / 205e9 + 0.002 * (s / 400e6).powi(12);
    let (mut low, mut high) = (0.0, 1e9);
    for _ in 0..70 {
        let middle = 0.5 * (low + high);
        *if total(middle) < strain { &mut low } else { &mut high } = middle;
    }
    low - 1.2e9 * strain * strain
}

/// Two straight lines, then fracture.
pub const BILINEAR: Truth =
    Truth { modulus: 70e9, end: 0.1, stress: |e| if e < 0.004 { 70e9 * e } else { 280e6 + 1.2e9 * (e - 0.004) } };

/// Imperfections of a record.
#[derive(Clone, Copy)]
pub struct Faults {
    pub rows: u32,
    /// Standard deviation of the stress relative to the current stress, and relative to the largest stress.
    pub relative_noise: f64,
    pub noise: f64,
    /// Standard deviation of the strain.
    pub strain_noise: f64,
    /// Strain by which the toe shifts the curve.
    pub toe: f64,
    /// True if the specimen is unloaded to 60 % of the stress and reloaded, at half of the rows.
    pub unloads: bool,
    pub fractures: bool,
    pub seed: u64,
}

pub const CLEAN: Faults = Faults {
    rows: 5000,
    relative_noise: 0.0,
    noise: 0.0,
    strain_noise: 0.0,
    toe: 0.0,
    unloads: false,
    fractures: false,
    seed: 1,
};

/// All imperfections of a laboratory record.
pub const LABORATORY: Faults =
    Faults { relative_noise: 0.005, strain_noise: 3e-6, toe: 3e-4, unloads: true, fractures: true, ..CLEAN };

/// Returns (strain, stress) in the order of the test. 30 % of the rows are below a strain of 1 %, since tests run more slowly up to yield.
pub fn record(truth: &Truth, faults: &Faults) -> Vec<(f64, f64)> {
    let slow = 0.3 * f64::from(faults.rows);
    let strain = |i: u32| {
        let i = f64::from(i);
        if i < slow {
            0.01 * i / slow
        } else {
            0.01 + (truth.end - 0.01) * (i - slow) / (f64::from(faults.rows - 1) - slow)
        }
    };
    let mut rows: Vec<(f64, f64)> = (0..faults.rows).map(strain).map(|e| (e, truth.stress(e))).collect();
    let largest = rows.iter().map(|row| row.1).fold(0.0, f64::max);
    for row in &mut rows {
        // The grips settle until the stress reaches a tenth of its maximum.
        row.0 += faults.toe * (1.0 - (1.0 - row.1 / (0.1 * largest)).max(0.0).powi(2));
    }
    if faults.unloads {
        let k = rows.len() / 2;
        let (e, s) = rows[k];
        let down: Vec<_> = (1..=40).map(|i| 0.01 * f64::from(i) * s).map(|d| (e - d / truth.modulus, s - d)).collect();
        let around: Vec<_> = down.iter().chain(down.iter().rev().skip(1)).copied().collect();
        let tail = rows.split_off(k + 1);
        rows.extend(around);
        rows.extend(tail);
    }
    let mut random = Random::new(faults.seed);
    for row in &mut rows {
        row.1 += faults.relative_noise * row.1 * random.normal() + faults.noise * largest * random.normal();
        row.0 += faults.strain_noise * random.normal();
    }
    if faults.fractures {
        let (e, s) = rows[rows.len() - 1];
        rows.extend([(e + 1e-4, 0.4 * s), (e + 2e-4, 0.02 * s), (e + 3e-4, 0.0)]);
    }
    rows
}

/// Returns the rows as CSV: strain and stress in MPa with a header.
pub fn csv(rows: &[(f64, f64)]) -> String {
    let mut text = String::from("strain,stress_MPa\n");
    for (strain, stress) in rows {
        writeln!(text, "{strain:.8},{:.5}", stress / 1e6).expect("a string");
    }
    text
}
