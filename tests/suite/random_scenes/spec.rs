//! A scene before it is written to a file: keys, with values that can be mirrored.

use std::fmt::Write as _;
use std::path::Path;

use barwave::material::{Material, Sense};
use barwave::scene::Scene;

/// Value of a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// TOML text that is the same in the mirror image.
    Same(String),
    /// Number with its unit that changes sign in the mirror image.
    Signed(f64, &'static str),
    /// Rows [time, value] whose values change sign in the mirror image.
    SignedRows(Vec<(f64, f64)>),
    /// Rows [x, value] along a piece of the given length.
    Along(Vec<(f64, f64)>, f64),
    /// Rows [x, value] whose values change sign in the mirror image.
    SignedAlong(Vec<(f64, f64)>, f64),
}

pub type Keys = Vec<(&'static str, Value)>;

impl Value {
    pub fn number(value: f64) -> Self {
        Self::Same(format!("{value}"))
    }

    pub fn unit(value: f64, unit: &str) -> Self {
        Self::Same(format!("\"{value} {unit}\""))
    }

    pub fn word(word: &str) -> Self {
        Self::Same(format!("\"{word}\""))
    }

    /// Returns true for a table over x.
    pub fn is_along(&self) -> bool {
        matches!(self, Self::Along(..) | Self::SignedAlong(..))
    }

    fn text(&self) -> String {
        let rows = |rows: &[(f64, f64)]| {
            let rows: Vec<String> = rows.iter().map(|(a, b)| format!("[{a:e}, {b}]")).collect();
            format!("[{}]", rows.join(", "))
        };
        match self {
            Self::Same(text) => text.clone(),
            Self::Signed(value, "") => format!("{value}"),
            Self::Signed(value, unit) => format!("\"{value} {unit}\""),
            Self::SignedRows(pairs) | Self::Along(pairs, _) | Self::SignedAlong(pairs, _) => rows(pairs),
        }
    }

    fn mirrored(&self) -> Self {
        match self {
            Self::Same(text) => Self::Same(text.clone()),
            Self::Signed(value, unit) => Self::Signed(-value, unit),
            Self::SignedRows(rows) => Self::SignedRows(rows.iter().map(|&(t, v)| (t, -v)).collect()),
            Self::Along(rows, length) => Self::Along(reversed(rows, *length, 1.0), *length),
            Self::SignedAlong(rows, length) => Self::SignedAlong(reversed(rows, *length, -1.0), *length),
        }
    }
}

/// Scene without a method, from which the scenes of all methods are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    /// Keys of [bar] except the segments.
    pub bar: Keys,
    pub segments: Vec<Keys>,
    /// Keys of the joint behind each segment except the last.
    pub joints: Vec<Keys>,
    pub ends: [Keys; 2],
    /// Effects; `None` for `effects = "auto"`.
    pub effects: Option<Keys>,
    /// End time, s.
    pub until: f64,
    pub cells: usize,
    pub cfl: f64,
    pub front_tolerance: f64,
}

/// Method of the scene language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    Leapfrog,
    Muscl,
    Moc,
}

/// Event limit of front tracking, so that a run takes about 10 ms.
pub const MAX_EVENTS: u64 = 3_000;

impl Method {
    pub const ALL: [Self; 3] = [Self::Leapfrog, Self::Muscl, Self::Moc];
}

fn reversed(rows: &[(f64, f64)], length: f64, sign: f64) -> Vec<(f64, f64)> {
    rows.iter().rev().map(|&(x, value)| (length - x, sign * value)).collect()
}

/// Keys of the initial state of a bar.
const INITIAL: [&str; 6] =
    ["velocity", "stress", "strain", "plastic-strain", "accumulated-plastic-strain", "temperature"];

impl Spec {
    pub fn mirrored(&self) -> Self {
        let keys = |keys: &Keys| keys.iter().map(|(key, value)| (*key, value.mirrored())).collect::<Keys>();
        let [left, right] = &self.ends;
        Self {
            bar: keys(&self.bar),
            segments: self.segments.iter().rev().map(keys).collect(),
            joints: self.joints.iter().rev().map(keys).collect(),
            ends: [keys(right), keys(left)],
            ..self.clone()
        }
    }

    pub fn has_effect(&self, name: &str) -> bool {
        self.effects.iter().flatten().any(|(key, _)| *key == name)
    }

    /// Returns true if the curve of any material falls somewhere.
    pub fn has_falling_curve(&self) -> bool {
        let scene = Scene::parse("falls.toml", &self.text(Method::Leapfrog, 1), Path::new("."), &[]);
        let falls = |material: &Material| {
            let curves = [Sense::Tension, Sense::Compression].map(|sense| material.branch(sense));
            curves.iter().any(|curve| curve.slopes().any(|slope| slope < 0.0))
        };
        scene.is_ok_and(|scene| scene.bar.segments.iter().any(|segment| falls(&segment.material)))
    }

    /// Returns the scene file for a method, with `by` times the cells.
    pub fn text(&self, method: Method, by: usize) -> String {
        let mut text = String::new();
        if self.effects.is_none() {
            text += "effects = \"auto\"\n";
        }
        let uniform = self.segments.len() == 1;
        if uniform || !self.bar.is_empty() {
            text += "[bar]\n";
            write(&mut text, &self.bar);
        }
        for (k, segment) in self.segments.iter().enumerate() {
            text += if uniform { "" } else { "[[bar.segment]]\n" };
            write(&mut text, segment);
            if let Some(joint) = self.joints.get(k) {
                write(&mut text, joint);
            }
        }
        for (name, end) in ["[left]\n", "[right]\n"].into_iter().zip(&self.ends) {
            text += name;
            write(&mut text, end);
        }
        if let Some(effects) = self.effects.as_ref().filter(|effects| !effects.is_empty()) {
            text += "[effects]\n";
            write(&mut text, effects);
        }
        self.solve(&mut text, method, by);
        text
    }

    fn solve(&self, text: &mut String, method: Method, by: usize) {
        let (cells, cfl) = (self.cells * by, self.cfl);
        let _ = writeln!(text, "[solve]\nuntil = {:e}", self.until);
        let _ = match method {
            Method::Leapfrog => writeln!(text, "method = \"fd\"\ncells = {cells}\ncfl = {cfl}"),
            Method::Muscl => writeln!(text, "method = \"fd\"\nscheme = \"muscl\"\ncells = {cells}\ncfl = {cfl}"),
            Method::Moc if self.has_effect("rate") => writeln!(text, "method = \"moc\"\ncells = {cells}"),
            Method::Moc => {
                let tolerance = self.front_tolerance / by as f64;
                writeln!(text, "method = \"moc\"\nfront-tolerance = {tolerance:e}\nmax-events = {MAX_EVENTS}")
            }
        };
        *text += "[record]\nframes = 2\n";
    }

    /// Returns simpler scenes, of which one may fail in the same way.
    pub fn simpler(&self) -> Vec<Self> {
        let mut simpler = Vec::new();
        let mut offer = |change: &dyn Fn(&mut Self)| {
            let mut spec = self.clone();
            change(&mut spec);
            if spec != *self {
                simpler.push(spec);
            }
        };
        for k in (0..self.segments.len()).filter(|_| self.segments.len() > 1) {
            offer(&|spec| {
                spec.segments.remove(k);
                spec.joints.remove(k.min(spec.joints.len() - 1));
            });
        }
        for k in 0..self.effects.as_ref().map_or(0, Vec::len) {
            offer(&|spec| drop(spec.effects.as_mut().map(|effects| effects.remove(k))));
        }
        for end in 0..2 {
            offer(&|spec| spec.ends[end] = vec![("kind", Value::word("free"))]);
            offer(&|spec| spec.ends[end] = vec![("kind", Value::word("fixed"))]);
        }
        for k in 0..self.joints.len() {
            offer(&|spec| spec.joints[k] = Vec::new());
        }
        for k in 0..self.segments.len() {
            for initial in INITIAL {
                offer(&|spec| spec.segments[k].retain(|(key, _)| *key != initial));
            }
            offer(&|spec| spec.segments[k].retain(|(key, _)| !key.ends_with("stress-concentration")));
            offer(&|spec| {
                let first = spec.segments[0].iter().find(|(key, _)| *key == "material").cloned();
                let own = spec.segments[k].iter_mut().find(|(key, _)| *key == "material");
                if let (Some(first), Some(own)) = (first, own) {
                    *own = first;
                }
            });
        }
        for initial in INITIAL {
            offer(&|spec| spec.bar.retain(|(key, _)| *key != initial));
        }
        for part in [0.25, 0.5, 0.8] {
            offer(&|spec| spec.until = round(part * spec.until));
            offer(&|spec| spec.cells = ((part * spec.cells as f64) as usize).max(4));
        }
        offer(&|spec| spec.cfl = 1.0);
        simpler
    }
}

/// Rounds to three digits, as a person would write.
pub fn round(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10.0_f64.powi(2 - value.abs().log10().floor() as i32);
    let rounded = (value * scale).round() / scale;
    format!("{rounded:.6e}").parse().unwrap_or(rounded)
}

fn write(text: &mut String, keys: &Keys) {
    for (key, value) in keys {
        let _ = writeln!(text, "{key} = {}", value.text());
    }
}
