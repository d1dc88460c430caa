//! Data of a bar from the resolved scene in a result file.

use serde_json::Value;

use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, member};
use crate::record::store::{Metadata, ResultFile};
use crate::units::Dimension;

/// Default number of bootstrap replicates.
pub const REPLICATES: usize = 200;
/// Default seed of the random numbers.
pub const SEED: u64 = 1;

/// Allowed numbers of replicates. Fewer replicates give no 95 % interval.
const ALLOWED_REPLICATES: Allowed = Allowed::Within(20.0, 1e5);

/// Checks the number of bootstrap replicates.
pub(super) fn check_replicates(count: usize) -> Checked {
    member("replicates", count as f64, Dimension::None, ALLOWED_REPLICATES)
}

/// One segment of the bar.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    /// Position of the left end, m.
    pub(super) start: f64,
    /// Length, m.
    pub(super) length: f64,
    /// Area of the section, m^2; `None` if the scene does not give it.
    pub(super) area: Option<f64>,
    /// Density, kg/m^3.
    pub(super) density: f64,
    /// Elastic modulus, Pa.
    pub(super) modulus: f64,
    pub(super) name: String,
    material: Value,
}

impl Segment {
    pub(super) fn end(&self) -> f64 {
        self.start + self.length
    }

    /// Returns the elastic wave speed, m/s.
    pub(super) fn c0(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }

    /// Returns the knots (strain, stress in Pa) of the curve that the run used: in compression if that is requested and exists, otherwise in tension.
    pub(super) fn curve(&self, compression: bool) -> Vec<(f64, f64)> {
        let own = if compression && !self.material["compression"].is_null() { "compression" } else { "tension" };
        let column = |name: &str| numbers(&self.material[own][name]);
        column("strain").into_iter().zip(column("stress")).collect()
    }
}

/// Refuses distances from the loaded end that exceed the length of the bar.
///
/// # Errors
/// A gauge or a section beyond the far end.
pub(super) fn on_the_bar(distances: impl Iterator<Item = f64>, length: Option<f64>) -> Result<()> {
    let farthest = distances.fold(0.0, f64::max);
    // Positions in a result file are rounded.
    let Some(length) = length.filter(|length| farthest > length * (1.0 + 1e-6)) else { return Ok(()) };
    let message =
        format!("the bar is {length} m long, and strains are given at up to {farthest} m from its loaded end");
    let error = InputError::new(message).key("length").allowed(format!("at least {farthest} m"));
    Err(error.help("check the length and the positions, and their units").into())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// Returns the segments of the bar in a result file, from left to right.
///
/// # Errors
/// A result without a bar, or one whose resolved scene lacks these data.
pub(super) fn segments(file: &ResultFile) -> Result<Vec<Segment>> {
    let wrong = || {
        let message = format!("{} contains no bar", file.path().display());
        InputError::new(message).help("name the result of a scene with a [bar]")
    };
    let scene: Value = serde_json::from_str(&file.metadata().scene_resolved).map_err(|_| wrong())?;
    let mut start = 0.0;
    let mut all = Vec::new();
    for value in scene["bar"]["segment"].as_array().ok_or_else(wrong)? {
        let material = &value["material"];
        let number = |value: &Value| value.as_f64().ok_or_else(wrong);
        let length = number(&value["length"])?;
        all.push(Segment {
            start,
            length,
            area: value["area"].as_f64(),
            density: number(&material["density"])?,
            modulus: number(&material["modulus"])?,
            name: material["name"].as_str().unwrap_or_default().to_owned(),
            material: material.clone(),
        });
        start += length;
    }
    Ok(all)
}

/// Returns whether a run has an effect whose name starts with `name`.
pub(super) fn has_effect(metadata: &Metadata, name: &str) -> bool {
    metadata.effects.iter().any(|effect| effect.starts_with(name))
}

/// Returns one sentence for each simulated effect that simple-wave theory does not describe.
pub(super) fn outside_theory(metadata: &Metadata) -> Vec<String> {
    let has = |name: &str| has_effect(metadata, name);
    let mut notes = Vec::new();
    if has("rate") {
        let what = "the run has a rate law: strain levels do not propagate at constant speeds, and the inverted curve";
        notes.push(format!("{what} depends on the gauge positions"));
    }
    if has("damping") || has("lateral-inertia") {
        notes.push("the run has damping or lateral inertia, which simple-wave theory does not describe".to_owned());
    }
    notes
}
