//! Runs scenes with every method through the program.
#![allow(dead_code, reason = "every test file takes what it needs")]

use barwave::record::LedgerRow;
use barwave::record::store::ResultFile;
use tempfile::TempDir;

use super::binary::barwave;

/// Name, `[solve]` without the end time, and `[effects]` of a method.
pub type Method = (&'static str, &'static str, &'static str);

pub const METHODS: [Method; 4] = [
    ("leapfrog", "cells = 100", "hardening = \"isotropic\""),
    ("muscl", "scheme = \"muscl\", cells = 100", "hardening = \"isotropic\""),
    ("front tracking", "method = \"moc\"", "hardening = \"isotropic\""),
    ("net", "method = \"moc\", cells = 100", "rate = { model = \"malvern\", k = \"1e9 1/s\" }"),
];

pub const BILINEAR: &str = "{ name = \"bilinear\", density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }";
pub const AREA: f64 = 1e-4;

/// Returns the impedance rho c0 A, N s/m.
pub fn impedance() -> f64 {
    AREA * (7800.0 * 200e9_f64).sqrt()
}

/// Runs a scene in a folder of its own and returns the folder and the result.
pub fn finished(name: &str, scene: &str) -> (TempDir, ResultFile) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a folder to write to");
    let output = barwave(folder.path(), &["run", "--quiet", "-o", "out.h5", "scene.toml"]);
    assert_eq!(output.status.code(), Some(0), "{name}: {}\n{scene}", String::from_utf8_lossy(&output.stderr));
    let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
    (folder, file)
}

/// Checks that the energy balance closes, no energy is negative and dissipation does not decrease; returns the ledger.
pub fn assert_ledger(name: &str, file: &ResultFile, scene: &str) -> Vec<LedgerRow> {
    let ledger = file.ledger().expect("a ledger");
    let scale = ledger.iter().map(|row| row.energies.total().abs()).fold(f64::MIN_POSITIVE, f64::max);
    let mut taken = [0.0; 3];
    for row in &ledger {
        let e = &row.energies;
        assert!(row.residual.abs() < 1e-10, "{name}: residual {:e} at {}\n{scene}", row.residual, row.time);
        for (what, energy) in [("kinetic", e.kinetic), ("elastic", e.elastic), ("foundation", e.foundation)] {
            assert!(energy >= 0.0, "{name}: {what} {energy:e}\n{scene}");
        }
        // Allowance for rounding of sums over cells.
        let rounding = 1e-13 * scale;
        for (least, energy) in taken.iter_mut().zip([e.damping, e.plastic + e.heat, e.viscoplastic]) {
            assert!(energy >= *least - rounding, "{name}: dissipation falls from {least:e} to {energy:e}\n{scene}");
            *least = least.max(energy);
        }
    }
    ledger
}
