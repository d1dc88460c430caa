//! Material files with inverted curves.

use std::fmt::Write as _;

use super::curve::WavePoint;

/// Content of a material file besides its curve.
#[derive(Debug, Clone)]
pub struct MaterialText<'a> {
    /// Name of the material.
    pub name: &'a str,
    /// Description, one line.
    pub description: &'a str,
    /// Density, kg/m^3.
    pub density: f64,
    /// Elastic modulus, Pa, if known.
    pub modulus: Option<f64>,
    /// "tension" or "compression".
    pub sense: &'a str,
    /// Description of the measurement and of its evaluation.
    pub measured: &'a str,
}

/// Knot of a measured curve; magnitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredKnot {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    pub stress: f64,
    /// 95 % interval of the stress, Pa.
    pub interval: [f64; 2],
}

/// Returns whether the stress does not decrease at the end of the curve, so that it can be extrapolated. The curve of a test ends slightly below the
/// largest strain of the test, so a simulation of the test exceeds it.
fn rises_at_end(knots: &[MeasuredKnot]) -> bool {
    knots.len() < 2 || knots.windows(2).next_back().is_some_and(|pair| pair[1].stress >= pair[0].stress)
}

/// Returns a sentence on the extrapolation beyond the last knot, or `None` if the curve is not extrapolated.
pub fn extended(knots: &[MeasuredKnot]) -> Option<String> {
    let last = knots.last().filter(|_| rises_at_end(knots))?;
    Some(format!("past strain {:.4} nothing is measured: the last slope is continued", last.strain))
}

/// Speeds relative to the elastic one: above `ABOUT_ELASTIC` a speed whose interval includes the elastic speed counts as elastic, above `ELASTIC` any
/// speed does.
const ABOUT_ELASTIC: f64 = 0.95;
const ELASTIC: f64 = 0.99;

/// Returns the knots of a curve determined by wave theory. While the first speeds equal the elastic one within their uncertainty, the curve is the
/// elastic line; the other knots continue from its end.
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

/// Stress differences below this fraction of the largest stress are not significant: the start of the pulse, and thus the strain, is not known more
/// precisely.
const KNOWN: f64 = 0.01;

/// Largest fraction of the knots through which the line to the elastic limit is fitted, and the least number that is tried.
const IN_LINE: f64 = 0.25;
const FEW: usize = 3;

/// Adds the elastic part to a curve that starts beyond it. Knots that lie on the elastic line of `modulus` within their intervals are removed. A line
/// is fitted to the first of the other knots, as many as lie on a line within their intervals, and extended to the elastic line. A concave curve lies
/// between this line and the chord from the origin.
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

/// Returns the stress difference up to which a knot agrees with the elastic line, Pa: the median half width of all intervals. The median is used
/// because the half widths on steep parts of the curve include its slope.
fn known_stress(knots: &[MeasuredKnot]) -> f64 {
    let mut half: Vec<f64> = knots.iter().map(|k| k.interval[1] - k.stress).collect();
    half.sort_by(f64::total_cmp);
    let largest = knots.iter().fold(0.0_f64, |top, k| top.max(k.stress));
    half.get(half.len() / 2).map_or(0.0, |median| median.max(KNOWN * largest))
}

/// Returns the slope and the value at zero strain of the line through the first knots.
fn first_line(knots: &[MeasuredKnot]) -> (f64, f64) {
    let most = ((IN_LINE * knots.len() as f64) as usize).max(FEW).min(knots.len());
    let straight = |count: &usize| {
        let (slope, at_zero) = line(&knots[..*count]);
        knots[..*count].iter().all(|k| (k.interval[0]..=k.interval[1]).contains(&(at_zero + slope * k.strain)))
    };
    line(&knots[..(FEW..=most).rev().find(straight).unwrap_or(2.min(knots.len()))])
}

/// Returns the slope and the value at zero strain of the least-squares line.
fn line(knots: &[MeasuredKnot]) -> (f64, f64) {
    let mean = |of: &dyn Fn(&MeasuredKnot) -> f64| knots.iter().map(of).sum::<f64>() / knots.len() as f64;
    let (strain, stress) = (mean(&|k| k.strain), mean(&|k| k.stress));
    let square = mean(&|k| (k.strain - strain).powi(2));
    let slope = if square > 0.0 { mean(&|k| (k.strain - strain) * (k.stress - stress)) / square } else { 0.0 };
    (slope, stress - slope * strain)
}

/// Returns the text of a material file with this curve, whose strains are > 0 and strictly increasing.
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
