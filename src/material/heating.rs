//! Adiabatic heating: plastic work raises the temperature and lowers the flow stress.
//!
//! With isotropic hardening and flow in one sense only, the work of a plastic strain p is the area under the curve, whatever the elastic excursions
//! in between. The temperature is then a function of p, and the heated material is equivalent to one with another curve, the adiabatic one. Solvers
//! use this curve at no extra cost.

use serde::Serialize;

use super::softening::AdiabaticState;
use super::tabulate::refine;
use super::{Beyond, Curve, CurveError, Material, SLOPE_ROUND_OFF, Sense};
use crate::error::{Error, InputError};
use crate::input::Allowed;
use crate::units::Dimension;

/// Default fraction of the plastic work that is converted to heat (Taylor and Quinney 1934).
pub const DEFAULT_FRACTION: f64 = 0.9;

/// Largest stress difference between the adiabatic table and the softened cold curve, over the largest stress of the cold curve.
pub const TOLERANCE: f64 = 1e-4;

/// Plastic strain at which the continuation of an extended curve towards melting ends.
const FARTHEST: f64 = 1e3;

/// Fraction of its largest stress below which an extended curve counts as molten.
const MOLTEN: f64 = 1e-3;

/// Adiabatic heating of a material by plastic work.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Heating {
    /// Fraction of the plastic work that is converted to heat, 0 to 1.
    pub fraction: f64,
    /// Specific heat, J/(kg K).
    pub specific_heat: f64,
    /// Initial temperature, for which the cold curve holds, K.
    pub reference_temperature: f64,
    /// Melting temperature, at which the flow stress vanishes, K.
    pub melting_temperature: f64,
    /// Exponent m of the softening `1 - ((T - reference)/(melting - reference))^m`.
    pub exponent: f64,
    /// Curves at the reference temperature: tension, and compression if it has a curve of its own.
    pub cold: Vec<Curve>,
    /// Heat capacity per volume, rho c, J/(m^3 K).
    #[serde(skip)]
    capacity: f64,
    /// Plastic work along the adiabatic curves, one table for each cold curve.
    #[serde(skip)]
    work: Vec<WorkTable>,
}

/// Reason why a material cannot be heated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeatingError {
    /// The material does not state these keys of `[heat]`.
    #[error("the material lacks constants of [heat]: {}", .0.join(", "))]
    Missing(Vec<&'static str>),
    /// The curve cannot be softened.
    #[error("the curve of the material cannot be softened: {0}")]
    Curve(CurveError),
    /// The given fraction of the plastic work is not between 0 and 1.
    #[error("{0} is out of range")]
    Fraction(f64),
}

/// Range of the fraction of the plastic work that is converted to heat.
const FRACTIONS: Allowed = Allowed::Within(0.0, 1.0);

impl From<HeatingError> for InputError {
    fn from(error: HeatingError) -> Self {
        let said = Self::new(error.to_string());
        match error {
            HeatingError::Missing(_) => said.help("add them to the material"),
            HeatingError::Curve(_) => said.help("leave the heating out"),
            HeatingError::Fraction(_) => said
                .key("fraction")
                .allowed(FRACTIONS.describe("fraction", Dimension::None))
                .help("give the part of the plastic work that turns into heat, mostly about 0.9"),
        }
    }
}

impl From<HeatingError> for Error {
    fn from(error: HeatingError) -> Self {
        InputError::from(error).into()
    }
}

impl Material {
    /// Returns this material heated by `fraction` of its plastic work (`None`: its own fraction, or else [`DEFAULT_FRACTION`]). Its curves are
    /// replaced by the adiabatic ones, and [`Material::heating`] holds the constants and the cold curves. A material that cannot flow and lacks
    /// constants is returned unchanged, and the curves are not changed if the fraction is 0.
    ///
    /// # Errors
    /// A constant of `[heat]` is missing, the fraction is not between 0 and 1, or a curve cannot be softened.
    pub fn heated(&self, fraction: Option<f64>) -> Result<Self, HeatingError> {
        let given = &self.constants.heat;
        let fraction = fraction.or(given.fraction).unwrap_or(DEFAULT_FRACTION);
        if !FRACTIONS.holds(fraction) {
            return Err(HeatingError::Fraction(fraction));
        }
        let (Some(specific_heat), Some(reference_temperature), Some(melting_temperature), Some(exponent)) =
            (given.specific_heat, given.reference_temperature, given.melting_temperature, given.exponent)
        else {
            return if self.can_flow() { Err(HeatingError::Missing(given.missing())) } else { Ok(self.clone()) };
        };
        let mut heating = Heating {
            fraction,
            specific_heat,
            reference_temperature,
            melting_temperature,
            exponent,
            cold: std::iter::once(&self.tension).chain(&self.compression).cloned().collect(),
            capacity: self.density * specific_heat,
            work: Vec::new(),
        };
        let mut material = self.clone();
        if heating.warms() {
            let cold = AdiabaticState::at(heating.exponent, 0.0);
            let soft = |curve: &Curve| heating.softened(curve, self.modulus, cold).map_err(HeatingError::Curve);
            material.tension = soft(&self.tension)?;
            material.compression = self.compression.as_ref().map(soft).transpose()?;
        }
        let curves = std::iter::once(&material.tension).chain(&material.compression);
        heating.work = curves.map(|curve| WorkTable::new(curve, self.modulus)).collect();
        material.heating = Some(Box::new(heating));
        Ok(material)
    }

    /// Returns this heated material for loading that starts `rise` (K) above the reference temperature. Only its curves are converted, not the
    /// temperatures along them. `None` if the material is not heated, or if a converted table is not a valid curve.
    #[must_use]
    pub fn at_rise(&self, rise: f64) -> Option<Self> {
        let heating = self.heating.as_ref()?;
        let warm = |curve: &Curve| {
            let start = AdiabaticState::at(heating.exponent, rise / heating.range());
            heating.softened(curve, self.modulus, start).ok()
        };
        let tension = warm(&heating.cold[0])?;
        let compression = match heating.cold.get(1) {
            Some(curve) => Some(warm(curve)?),
            None => None,
        };
        Some(Self { tension, compression, ..self.clone() })
    }

    /// Whether its curves are adiabatic ones.
    pub fn is_adiabatic(&self) -> bool {
        self.heating.as_ref().is_some_and(|heating| heating.warms())
    }

    /// Whether the curves include plastic strain.
    pub(crate) fn can_flow(&self) -> bool {
        let bends = |curve: &Curve| curve.elastic_limit(self.modulus).0 < curve.last_strain();
        bends(&self.tension) || self.compression.as_ref().is_some_and(bends)
    }
}

/// Not inlined, because compilers would otherwise compute the power in both cases and select afterwards.
#[inline(never)]
fn power(share: f64, exponent: f64) -> f64 {
    share.powf(exponent)
}

impl Heating {
    /// Whether the heated fraction is positive; if it is zero, the material is the cold one.
    pub fn warms(&self) -> bool {
        self.fraction > 0.0
    }

    /// Returns the temperature after plastic work per volume, J/m^3, since the start, K; at most the melting temperature.
    pub fn temperature_after(&self, work: f64) -> f64 {
        (self.reference_temperature + self.fraction * work / self.capacity).min(self.melting_temperature)
    }

    /// Returns the temperature at an accumulated plastic strain >= 0 of a point that flowed in one sense only, K.
    pub fn temperature(&self, sense: Sense, plastic_strain: f64) -> f64 {
        let which = usize::from(sense == Sense::Compression).min(self.work.len() - 1);
        self.temperature_after(self.work[which].at(plastic_strain))
    }

    /// Returns the largest temperature rise above the reference temperature, up to melting, K.
    pub fn range(&self) -> f64 {
        self.melting_temperature - self.reference_temperature
    }

    /// Returns the temperature rise per plastic work per volume, K m^3/J.
    pub fn rise_per_work(&self) -> f64 {
        self.fraction / self.capacity
    }

    /// Returns the factor of the flow stress, 1 to 0, at a rise above the reference temperature, K.
    pub fn softening(&self, rise: f64) -> f64 {
        let share = (rise / self.range()).clamp(0.0, 1.0);
        1.0 - if self.exponent == 1.0 { share } else { power(share, self.exponent) }
    }

    /// Returns the adiabatic curve of a cold one for loading that starts in this state: stress f(p) g(T(p)) at the strain p + stress/E. It includes
    /// the drop after its largest stress. Knots are added so that it is within [`TOLERANCE`].
    fn softened(&self, cold: &Curve, modulus: f64, start: AdiabaticState) -> Result<Curve, CurveError> {
        let omega = self.rise_per_work() / self.range();
        let top = cold.stress().iter().copied().fold(0.0, f64::max);
        let (mut adiabatic, at_first) = (start, start.strength());
        let mut rows: Vec<(f64, f64)> = Vec::new();
        let knots = flow_knots(cold, modulus);
        for (k, pair) in knots.windows(2).enumerate() {
            let [(p, f), (p_end, f_end)] = [pair[0], pair[1]];
            let width = p_end - p;
            if width == 0.0 {
                // Nothing flows along the elastic line. Before the first flow the cold knots are kept, scaled by the initial strength.
                let stress = f_end * adiabatic.strength();
                let strain = if p == 0.0 { cold.strain()[k + 1] * at_first } else { p + stress / modulus };
                rows.push((strain, stress));
                continue;
            }
            let slope = (f_end - f) / width;
            let after = |x: f64| adiabatic.after(omega * x * (f + 0.5 * slope * x));
            let point = |x: f64| {
                let stress = (f + slope * x) * after(x).strength();
                (p + x + stress / modulus, stress)
            };
            rows.extend(refine(&point, &[0.0, width], TOLERANCE, top).rows.into_iter().skip(1));
            adiabatic = after(width);
        }
        extend(cold, modulus, (omega, top), (knots[knots.len() - 1], adiabatic), &mut rows);
        // For m < 1 the stress can drop at first flow faster than the plastic strain grows; the strain would decrease there.
        let mut last = 0.0;
        rows.retain(|row| {
            let keep = row.0 > last;
            last = row.0.max(last);
            keep
        });
        // Near melting, stresses below the smallest allowed magnitude are set to zero.
        let least = Dimension::Stress.magnitudes().least;
        rows.iter_mut().filter(|row| row.1 < least).for_each(|row| row.1 = 0.0);
        Curve::new(&rows, cold.beyond())
    }
}

/// Continues an extended curve along its last slope to the melting point.
fn extend(
    cold: &Curve,
    modulus: f64,
    (omega, top): (f64, f64),
    ((p, f), adiabatic): ((f64, f64), AdiabaticState),
    rows: &mut Vec<(f64, f64)>,
) {
    let slope = cold.last_slope();
    if cold.beyond() != Beyond::Extend || slope >= modulus * (1.0 - SLOPE_ROUND_OFF) {
        return;
    }
    let hardening = slope / (1.0 - slope / modulus);
    let flow = |x: f64| (f + hardening * x).max(0.0);
    // A falling line ends where its stress is zero.
    let reach = if hardening < 0.0 { -f / hardening } else { f64::INFINITY };
    let after = |x: f64| {
        let x = x.min(reach);
        adiabatic.after(omega * x * (f + 0.5 * hardening * x))
    };
    let point = |x: f64| {
        let stress = flow(x) * after(x).strength();
        (p + x + stress / modulus, stress)
    };
    let mut breaks = vec![0.0, 0.01];
    let last = |breaks: &[f64]| breaks[breaks.len() - 1];
    while point(last(&breaks)).1 > MOLTEN * top && last(&breaks) < FARTHEST {
        breaks.push(2.0 * last(&breaks));
    }
    rows.extend(refine(&point, &breaks, TOLERANCE, top).rows.into_iter().skip(1));
    // The rest is horizontal.
    let end = last(&breaks);
    let (strain, stress) = point(end);
    rows.push((strain + end, stress));
}

/// Returns the knots of a curve as plastic strain and stress, Pa; the plastic strain never decreases.
fn flow_knots(curve: &Curve, modulus: f64) -> Vec<(f64, f64)> {
    let mut knots = vec![(0.0, 0.0)];
    let mut p = 0.0;
    for (e, s) in curve.strain().windows(2).zip(curve.stress().windows(2)) {
        let (strain, stress) = (e[1] - e[0], s[1] - s[0]);
        let flow = strain - stress / modulus;
        p += if flow > 2.0 * SLOPE_ROUND_OFF * strain { flow } else { 0.0 };
        knots.push((p, s[1]));
    }
    knots
}

/// Plastic work along a curve with its drops filled, as the solvers follow it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WorkTable {
    plastic: Vec<f64>,
    stress: Vec<f64>,
    /// Plastic work per volume at the knots, J/m^3.
    work: Vec<f64>,
    /// Slope d stress/d plastic strain after the last knot, Pa.
    slope: f64,
}

impl WorkTable {
    /// Creates the table for a curve with the elastic modulus `modulus`, Pa.
    pub fn new(curve: &Curve, modulus: f64) -> Self {
        let filled = curve.running_maximum();
        let last = filled.last_slope();
        let extends = filled.beyond() == Beyond::Extend && last < modulus * (1.0 - SLOPE_ROUND_OFF);
        let slope = if extends { last / (1.0 - last / modulus) } else { 0.0 };
        let (plastic, stress): (Vec<f64>, Vec<f64>) = flow_knots(&filled, modulus).into_iter().unzip();
        let mut work = vec![0.0];
        for (p, s) in plastic.windows(2).zip(stress.windows(2)) {
            work.push(work[work.len() - 1] + 0.5 * (s[0] + s[1]) * (p[1] - p[0]));
        }
        Self { plastic, stress, work, slope }
    }

    /// Returns the work per volume up to a plastic strain >= 0, J/m^3.
    pub fn at(&self, plastic: f64) -> f64 {
        // Of several knots at one plastic strain, the last one holds the stress at larger strains.
        let k = self.plastic.partition_point(|&p| p <= plastic).max(1) - 1;
        let slope = match self.plastic.get(k + 1) {
            Some(next) => (self.stress[k + 1] - self.stress[k]) / (next - self.plastic[k]),
            None => self.slope,
        };
        let flow = plastic - self.plastic[k];
        self.work[k] + flow * (self.stress[k] + 0.5 * slope * flow)
    }
}
