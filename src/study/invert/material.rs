//! Material files with inverted curves.

use std::fmt::Write as _;

use super::curve::WavePoint;

/// What a material file states beside its curve.
#[derive(Debug, Clone)]
pub struct MaterialText<'a> {
    /// Name of the material.
    pub name: &'a str,
    /// One line.
    pub description: &'a str,
    /// kg/m^3.
    pub density: f64,
    /// Pa, where known.
    pub modulus: Option<f64>,
    /// "tension" or "compression".
    pub sense: &'a str,
    /// What was measured, and how the curve follows from it.
    pub measured: &'a str,
}

/// A knot of a curve, magnitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredKnot {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    pub stress: f64,
    /// Its 95 % interval, Pa.
    pub interval: [f64; 2],
}

/// The curve of a test ends a little below its largest strain, so a run of the test goes past its end.
fn rises_at_end(knots: &[MeasuredKnot]) -> bool {
    knots.len() < 2 || knots.windows(2).next_back().is_some_and(|pair| pair[1].stress >= pair[0].stress)
}

/// What is said of the strains past the last knot.
pub fn extended(knots: &[MeasuredKnot]) -> Option<String> {
    let last = knots.last().filter(|_| rises_at_end(knots))?;
    Some(format!("past strain {:.4} nothing is measured: the last slope is continued", last.strain))
}

/// Part of the elastic speed above which a speed whose interval holds it is the elastic one, and above which any is.
const ABOUT_ELASTIC: f64 = 0.95;
const ELASTIC: f64 = 0.99;

/// The knots of a curve by wave theory: where the first speeds are the elastic one within their uncertainty, the curve is the elastic line,
/// and the others continue from its end.
pub fn from_waves(points: &[WavePoint], density: f64, modulus: Option<f64>) -> Vec<MeasuredKnot> {
    let c0 = modulus.map_or(f64::INFINITY, |modulus| (modulus / density).sqrt());
    let is_elastic = |point: &&WavePoint| {
        let speed = point.wave_speed_m_s;
        speed.value >= ELASTIC * c0 || speed.value >= ABOUT_ELASTIC * c0 && speed.high >= c0
    };
    let first = points.iter().take_while(is_elastic).count().saturating_sub(1);
    let missing = |point: &WavePoint| modulus.map_or(0.0, |modulus| modulus * point.strain - point.stress_pa.value);
    let shift = points.first().filter(is_elastic).map_or(0.0, |_| missing(&points[first]));
    let knot = |p: &WavePoint| MeasuredKnot {
        strain: p.strain,
        stress: p.stress_pa.value + shift,
        interval: [p.stress_pa.low + shift, p.stress_pa.high + shift],
    };
    points[first.min(points.len())..].iter().map(knot).collect()
}

/// Part of the largest stress that is no difference: the start of the pulse, and so the strain, is not known more closely.
const KNOWN: f64 = 0.01;

/// Largest part of the knots whose line is prolonged to the elastic line, and so many where they are few.
const IN_LINE: f64 = 0.25;
const FEW: usize = 3;

/// A curve that starts past its elastic part, with a modulus: what lies on the elastic line within its interval is left out, and the line
/// through the first of the other knots, as many as lie on one within their intervals, is prolonged to it. A concave curve lies between that
/// and the chord from the origin.
pub fn with_elastic_part(knots: &[MeasuredKnot], modulus: f64) -> Vec<MeasuredKnot> {
    let known = known_stress(knots);
    let on_line = |k: &&MeasuredKnot| modulus * k.strain - k.stress <= (k.interval[1] - k.stress).min(known);
    let elastic = knots.iter().take_while(on_line).count();
    let rest = &knots[elastic..];
    let Some(first) = rest.first() else {
        let end = knots.last().map(|last| MeasuredKnot { stress: modulus * last.strain, ..*last });
        return end.into_iter().collect();
    };
    let (slope, at_zero) = first_line(rest);
    let strain = (at_zero / (modulus - slope)).min(first.stress / modulus);
    let below = elastic.checked_sub(1).map_or(0.0, |last| knots[last].strain);
    let strain = strain.max(below.min(first.stress / modulus));
    let knee = MeasuredKnot {
        strain,
        stress: modulus * strain,
        interval: [first.stress * strain / first.strain, modulus * strain],
    };
    let is_one = strain > 0.0 && slope < modulus;
    is_one.then_some(knee).into_iter().chain(rest.iter().copied()).collect()
}

/// To what a knot on the elastic line agrees with it, Pa: the median half width of all. Those of knots on steep parts hold the slope, too.
fn known_stress(knots: &[MeasuredKnot]) -> f64 {
    let mut half: Vec<f64> = knots.iter().map(|k| k.interval[1] - k.stress).collect();
    half.sort_by(f64::total_cmp);
    let largest = knots.iter().fold(0.0_f64, |top, k| top.max(k.stress));
    half.get(half.len() / 2).map_or(0.0, |median| median.max(KNOWN * largest))
}

/// Slope and value at zero strain of the line through the first knots.
fn first_line(knots: &[MeasuredKnot]) -> (f64, f64) {
    let most = ((IN_LINE * knots.len() as f64) as usize).max(FEW).min(knots.len());
    let straight = |count: &usize| {
        let (slope, at_zero) = line(&knots[..*count]);
        knots[..*count].iter().all(|k| (k.interval[0]..=k.interval[1]).contains(&(at_zero + slope * k.strain)))
    };
    line(&knots[..(FEW..=most).rev().find(straight).unwrap_or(2.min(knots.len()))])
}

/// Slope and value at zero strain of the line of least squares.
fn line(knots: &[MeasuredKnot]) -> (f64, f64) {
    let mean = |of: &dyn Fn(&MeasuredKnot) -> f64| knots.iter().map(of).sum::<f64>() / knots.len() as f64;
    let (strain, stress) = (mean(&|k| k.strain), mean(&|k| k.stress));
    let square = mean(&|k| (k.strain - strain).powi(2));
    let slope = if square > 0.0 { mean(&|k| (k.strain - strain) * (k.stress - stress)) / square } else { 0.0 };
    (slope, stress - slope * strain)
}

/// The text of a material file with this curve, strain strictly increasing from above 0.
pub fn material_text(material: &MaterialText<'_>, knots: &[MeasuredKnot]) -> String {
    let quote = |text: &str| toml_edit::Value::from(text).to_string();
    let mut text = String::new();
    let mut line = |key: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{key} = {value}");
    };
    line("name", quote(material.name));
    line("description", quote(material.description));
    line("density", format!("{:?}", material.density));
    if let Some(modulus) = material.modulus {
        line("modulus", format!("{modulus:?}"));
    }
    line("measure", quote("engineering"));
    line("sense", quote(material.sense));
    line("beyond", quote(if rises_at_end(knots) { "extend" } else { "error" }));
    text += &extended(knots).map_or_else(String::new, |sentence| format!("# {sentence}\n"));
    text += "\n[curve]\n# strain, stress in Pa; 95 % interval of the stress\ntable = [\n";
    for MeasuredKnot { strain, stress, interval: [low, high] } in knots {
        let _ = writeln!(text, "    [{strain:e}, {stress:e}],  # {low:.4e} to {high:.4e}");
    }
    text += "]\n\n[source]\ncitation = \"\"\n";
    let _ = writeln!(text, "measured = {}\nconfidence = \"measured\"", quote(material.measured));
    text
}
