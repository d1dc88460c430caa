//! Cases of a tension-impact test.

use std::path::Path;

use toml::Value;

use super::limit::Limit;
use crate::bar::EndCondition;
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::material::Sense;
use crate::scene::{Problem, Scene};
use crate::study::critical::critical;
use crate::study::sweep::{Axis, Combine, Level, Sweep};

/// Number of default impact velocities. They are the odd multiples 3, 5, ... of 1/40 of the critical velocity.
const VELOCITIES: usize = 27;

/// A run ends at `MARGIN` times the time at which the mean strain would equal the strain at the maximum of the curve (at its [`Limit`] if it has no
/// maximum), plus `TRANSITS` elastic transit times, in which the fragments unload.
const MARGIN: f64 = 1.05;
const TRANSITS: f64 = 8.0;

/// Metrics read from the summary of every case. The results refer to them by their position in this list.
pub(super) const METRICS: [&str; 5] =
    ["permanent_elongation_m", "energy_absorbed_J", "ruptures.0.x_m", "ruptures.0.time_s", "ruptures.0.site"];

/// File name used in messages for the generated scene of a specimen.
pub const SPECIMEN: &str = "specimen";

/// Condition of the end of the specimen that is not struck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum FarEnd {
    /// It does not move.
    Fixed,
    /// The end is free of stress.
    Free,
}

/// A uniform specimen. Lengths are numbers with units, as in a scene.
#[derive(Debug, Clone)]
pub struct Specimen<'a> {
    /// Library name, or path of a material file.
    pub material: &'a str,
    /// Gauge length.
    pub length: &'a str,
    /// Diameter of the cross-section.
    pub diameter: &'a str,
    /// Condition of the far end.
    pub far_end: FarEnd,
    /// Number of grid cells.
    pub cells: usize,
}

/// A tension-impact test: its cases, and the critical values from the curve of its material.
#[derive(Debug)]
pub struct Test {
    /// Sweep with one case per impact velocity.
    pub sweep: Sweep,
    /// Name of the struck material.
    pub material: String,
    /// Gauge length, m.
    pub length: f64,
    /// Elastic transit time, s.
    pub transit: f64,
    /// Impact velocities, m/s, increasing, one per case.
    pub velocities: Vec<f64>,
    /// Curve used for `critical_velocity` and `static_elongation`: `static`, or `adiabatic` for a material with heating.
    pub curve: &'static str,
    /// Critical velocity of the curve up to its maximum, or to the strain of fracture if that is smaller, m/s.
    pub critical_velocity: f64,
    /// Plastic strain there, which is the elongation over the gauge length in a test without waves.
    pub static_elongation: f64,
}

impl Specimen<'_> {
    /// Returns the scene that the test varies.
    pub fn scene(&self) -> Document {
        let material = Value::from(self.material).to_string();
        // A plain number is in SI units, as everywhere on the command line.
        let quantity =
            |text: &str| text.trim().parse::<f64>().map_or_else(|_| Value::from(text), Value::from).to_string();
        let [length, diameter] = [self.length, self.diameter].map(quantity);
        let far = if self.far_end == FarEnd::Fixed { "fixed" } else { "free" };
        let text = format!(
            "title = \"Tension impact\"\n[bar]\nlength = {length}\ndiameter = {diameter}\nmaterial = {material}\n[left]\nkind = \
             \"velocity\"\nvalue = -1\n[right]\nkind = \"{far}\"\n[effects]\nhardening = \"isotropic\"\nrupture = \
             \"critical-strain\"\n\
             [solve]\nuntil = 1\nmethod = \"fd\"\ncells = {}\n[record]\nframes = 2\n",
            self.cells
        );
        Document::new(SPECIMEN, text)
    }
}

impl Test {
    /// Returns the time in which an elastic wave returns from the far end, s.
    pub(super) fn return_time(&self) -> f64 {
        2.0 * self.transit
    }

    /// Creates the test of a specimen or of the bar of a scene. `velocities` is a list or a range, as on the axis of a sweep.
    ///
    /// # Errors
    /// Input errors: the left end of the scene is not pulled, the scene does not simulate fracture, the material has no critical velocity, or a value
    /// in `velocities` is not an impact velocity.
    pub fn new(document: Document, path: &Path, velocities: Option<&Value>) -> Result<Self> {
        let scene = match Problem::of_document(&document, path, &[])? {
            Problem::Bar(scene) => scene,
            Problem::Impact(scene) => {
                let message = format!("a scene with [{}] has no bar that is pulled", scene.problem.kind());
                return Err(InputError::new(message).help("give a material, or a scene with [bar]").into());
            }
        };
        check(&scene)?;
        let segment = &scene.bar.segments[0];
        let row = critical(&segment.material, Sense::Tension);
        let Some(limit) = Limit::of(&scene) else {
            let message = format!("{} has no critical velocity: {}", row.material, row.reason);
            let help = "use a material whose curve includes its largest stress (`barwave critical` lists them), or reaches the \
                        threshold of the fracture criterion";
            return Err(InputError::new(message).help(help).into());
        };
        let velocity = limit.velocity(&segment.material);
        // With a smaller limit, the time up to the maximum of the curve is long enough, too.
        let strain = row.strain_at_max.unwrap_or(limit.strain);
        let velocities = velocities.map_or_else(|| Ok(around(velocity)), positive)?;
        let length = scene.bar.length();
        let transit = scene.bar.transit_time();
        let until = |v: f64| MARGIN * strain * length / v + TRANSITS * transit;
        let axes = vec![
            axis("left.value", "m/s", velocities.iter().map(|v| -v)),
            axis("solve.until", "s", velocities.iter().map(|&v| rounded(until(v)))),
        ];
        let metrics = METRICS.map(str::to_owned).to_vec();
        let name = format!("tension-impact-{}", row.material);
        let fields = vec!["plastic_strain".to_owned()];
        Ok(Self {
            sweep: Sweep::of_scene(name, document, path, axes, Combine::Zip, metrics, fields)?,
            static_elongation: limit.strain - limit.stress / segment.material.modulus,
            curve: if segment.material.is_adiabatic() { "adiabatic" } else { "static" },
            critical_velocity: velocity,
            material: row.material,
            velocities,
            length,
            transit,
        })
    }
}

/// Refuses a scene whose left end is not pulled or that does not simulate fracture.
fn check(scene: &Scene) -> Result<()> {
    let wrong = |key: &str, message: &str, help: &str| Err(InputError::new(message).key(key).help(help).into());
    if !matches!(scene.left, EndCondition::Velocity { .. }) {
        return wrong("left.kind", "the left end is not pulled", "use [left] kind = \"velocity\" with a `value`");
    }
    if scene.effects.rupture.is_none() {
        return wrong(
            "effects.rupture",
            "the scene does not simulate fracture",
            "add rupture = \"critical-strain\" to [effects]",
        );
    }
    Ok(())
}

/// Returns the default velocities below and above the critical velocity, m/s. None of them equals the critical velocity.
fn around(critical: f64) -> Vec<f64> {
    (1..=VELOCITIES).map(|k| rounded(critical * (2 * k + 1) as f64 / 40.0)).collect()
}

/// Rounds to six significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Returns the velocities of a list or range in increasing order without duplicates, m/s.
fn positive(given: &Value) -> Result<Vec<f64>> {
    let wrong = |message: String| {
        let error = InputError::new(message).key("velocities").allowed("velocities > 0");
        Error::from(error.help("give a list, or the first and the last one and their number"))
    };
    let axis = Axis::read("velocity", given).map_err(wrong)?;
    let value = |level: &Level| {
        let si = level.si.filter(|si| *si > 0.0 && ["", "m/s"].contains(&axis.unit.as_str()));
        si.ok_or_else(|| wrong(format!("{} is not an impact velocity", level.typed)))
    };
    let mut velocities = axis.levels.iter().map(value).collect::<Result<Vec<f64>>>()?;
    velocities.sort_by(f64::total_cmp);
    velocities.dedup();
    Ok(velocities)
}

fn axis(key: &str, unit: &str, values: impl Iterator<Item = f64>) -> Axis {
    let levels = values.map(|value| Level { typed: format!("{value:?}"), si: Some(value) }).collect();
    Axis { key: key.to_owned(), unit: unit.to_owned(), levels, logarithmic: false }
}
