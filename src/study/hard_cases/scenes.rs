//! The scenes in `tests/hard_cases`.

use std::borrow::Cow;

use super::Method;

/// Number of rows of the table that replaces `"NOISY_TABLE"`.
const NOISY_ROWS: u32 = 10_000;

/// A scene whose leading comment lines contain its explanation and its expected behaviour.
#[derive(Debug, Clone, Copy)]
pub struct HardCase {
    /// File name without its extension.
    pub name: &'static str,
    source: &'static str,
}

macro_rules! cases {
    ($($name:literal,)*) => {
        &[$(HardCase {
            name: $name,
            source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hard_cases/", $name, ".toml")),
        },)*]
    };
}

/// All cases, in the order of their names.
pub const CASES: &[HardCase] = cases![
    "01-yield-kink",
    "02-perfect-plasticity",
    "02-perfect-plasticity-in-torsion",
    "03-softening",
    "03-yield-drop",
    "04-lock-up",
    "05-at-the-critical-velocity",
    "05-far-above-the-critical-velocity",
    "05-just-below-the-critical-velocity",
    "06-noisy-table",
    "07-a-segment-of-a-micrometre",
    "07-impedances-1-to-10000",
    "08-a-thousand-reflections",
    "09-courant-number-above-1",
    "09-three-cells",
    "09-two-cells",
    "10-never-relaxed",
    "10-relaxed-at-once",
    "11-chattering-contacts",
    "11-grazing-contact",
    "12-a-rigid-spring",
    "12-a-spring-without-stiffness",
    "12-a-striker-of-a-million",
    "12-a-striker-of-a-millionth",
    "13-an-unsteady-end",
    "14-a-terapascal",
    "14-cable",
    "14-foam-of-1-pascal",
    "14-nanowire",
    "15-a-million-steps",
    "16-a-state-over-x",
    "16-segments-in-motion",
    "16-stressed-and-yielded-segments",
    "17-near-melting",
    "18-taper-to-a-point",
    "19-fragments-in-contact",
    "20-taylor-impact-at-100",
    "20-taylor-impact-at-300",
    "20-taylor-impact-at-600",
];

/// A bound on the magnitude of a field, stated by a comment line such as `# Bound: stress 300 MPa` in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// "stress", "strain" or "velocity".
    pub field: String,
    /// Value with its unit, as written.
    pub value: String,
}

impl HardCase {
    /// Returns the complete text of the scene file.
    pub fn text(&self) -> Cow<'static, str> {
        const PLACE: &str = "\"NOISY_TABLE\"";
        if self.source.contains(PLACE) {
            Cow::Owned(self.source.replace(PLACE, &noisy_table()))
        } else {
            Cow::Borrowed(self.source)
        }
    }

    /// Returns one paragraph that explains what is difficult about the case.
    pub fn explanation(&self) -> String {
        let states = |line: &&str| [BOUND, COARSEST, VARIATION, CONVERGENCE].iter().any(|word| line.starts_with(word));
        let lines: Vec<&str> = self.comments().filter(|line| !states(line)).collect();
        lines.join(" ")
    }

    /// Returns the bounds of the fields that the case states.
    pub fn bounds(&self) -> Vec<Bound> {
        let bound = |line: &str| {
            let (field, value) = line.strip_prefix(BOUND)?.trim().split_once(' ')?;
            Some(Bound { field: field.to_owned(), value: value.to_owned() })
        };
        self.comments().filter_map(bound).collect()
    }

    /// Returns the number of cells of the coarsest grid on which the case shows its convergence, if the case states it.
    pub(super) fn coarsest(&self) -> Option<usize> {
        self.comments().find_map(|line| line.strip_prefix(COARSEST)?.trim().parse().ok())
    }

    /// Returns the bound and the reason of a growing total variation, if the case states them for a method: `at most 1.1: ...`.
    pub(super) fn growth_of_variation(&self, method: Method) -> Option<(f64, &'static str)> {
        let (most, reason) = self.stated(VARIATION, method)?.strip_prefix("at most ")?.split_once(": ")?;
        Some((most.parse().ok()?, reason))
    }

    /// Returns the reason why the results of a method do not converge, if the case states one.
    pub(super) fn why_no_convergence(&self, method: Method) -> Option<&'static str> {
        self.stated(CONVERGENCE, method)
    }

    /// Returns the text after the colon of the line `# <what>, <method>: ...`.
    fn stated(&self, what: &str, method: Method) -> Option<&'static str> {
        self.comments().find_map(|line| {
            let (of, reason) = line.strip_prefix(what)?.strip_prefix(", ")?.split_once(": ")?;
            (of == method.name()).then_some(reason)
        })
    }

    fn comments(&self) -> impl Iterator<Item = &'static str> {
        self.source.lines().map_while(|line| line.strip_prefix('#')).map(str::trim)
    }
}

/// Prefixes of the comment lines that state the expected behaviour.
const BOUND: &str = "Bound:";
const COARSEST: &str = "Cells of the coarsest grid:";
const VARIATION: &str = "Growing variation";
const CONVERGENCE: &str = "No convergence";

/// Returns the rows of a power law with noise, which is the same in every run. The noise changes the slopes by up to 0.8 E.
fn noisy_table() -> String {
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2.0_f64.powi(52) - 1.0
    };
    let row = |k: u32| {
        let strain = 1e-3 * 50.0_f64.powf(f64::from(k) / f64::from(NOISY_ROWS - 1));
        let spacing = strain * 50.0_f64.ln() / f64::from(NOISY_ROWS - 1);
        let error = if k == 0 { 0.0 } else { 0.4 * 200e9 * spacing * noise() };
        format!("[{strain:e}, {:e}]", 200e6 * (strain / 1e-3).powf(0.2) + error)
    };
    let rows: Vec<String> = (0..NOISY_ROWS).map(row).collect();
    format!("[{}]", rows.join(", "))
}
