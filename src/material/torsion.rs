//! Conversion of the shear curve of a material to the torque-twist curve of a round section.
//!
//! Cross-sections stay plane, so that the shear strain is proportional to the radius: at s R it is s g, where g is that at the outer radius R. With
//! the torque T and J = pi/2 (R^4 - a^4) for the inner radius a = q R, the *nominal* stress T R/J, which is the stress at the surface of an elastic
//! section, is `tau_n(g) = integral over s from q to 1 of tau(s g) s^2, over the integral of s^3`. In terms of g, this stress and the surface
//! velocity, a bar in torsion is a bar in tension with the area J/R^2: torque, energy and angular momentum follow. The integral is exact for a
//! table that is straight between its rows; the result is not piecewise straight, and is tabulated to a tolerance.
//!
//! The integral is that of first loading. After plastic flow and removal of the torque, a rod retains residual stresses that vary over the radius,
//! and yields again gradually, earlier than by the nominal curve; see the README.

use std::sync::Arc;

use super::tabulate::{elastic_engineering_strain, refine};
use super::{Beyond, Curve, CurveError, Loading, Material, Sense, Tabulated, UltimateReason, true_from_engineering};
use crate::error::InputError;
use crate::root::bisect;

/// Largest stress difference between a nominal curve and the integral, over the largest stress of its data; for its extension, over that of the
/// extension.
pub const TORSION_TOLERANCE: f64 = 1e-4;

/// Largest stress difference between a shear curve and the tension curve from which it is converted, over its largest stress.
pub const SHEAR_TOLERANCE: f64 = 3e-5;

pub(super) const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// Upper limit of the integration of an unbounded curve, relative to its last strain: the core then contributes less than 1/8^3 of the error of the
/// nominal slope.
const EXTENDED: f64 = 8.0;

/// Relative difference of the true stresses in tension and compression up to which both count as one true curve.
const SAME_CURVE: f64 = 0.01;

/// A round section, solid or hollow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubeSection {
    /// Ratio of the inner to the outer radius, 0 <= q < 1.
    pub q: f64,
}

impl TubeSection {
    /// Returns the nominal stress at the surface strain `g`, Pa; exact for the curve.
    pub fn nominal_stress(self, curve: &Curve, g: f64) -> f64 {
        let q = self.q;
        if g <= 0.0 {
            return 0.0;
        }
        let (mut moment, mut from) = (0.0, q);
        let knots = curve.strain().iter().map(|knot| knot / g).filter(|&s| s > q && s < 1.0);
        for to in knots.chain([1.0]) {
            // Between knots tau s^2 is a cubic, for which the two-point Gauss rule is exact.
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let at = |s: f64| curve.stress_at(s * g) * s * s;
            let aside = half / 3.0_f64.sqrt();
            moment += half * (at(middle - aside) + at(middle + aside));
            from = to;
        }
        // Division by the integral of s^3, without cancellation for thin walls.
        4.0 * moment / ((1.0 - q) * (1.0 + q) * (1.0 + q * q))
    }

    /// Returns the curve of the section for first loading, tabulated to [`TORSION_TOLERANCE`], and its largest error, Pa.
    ///
    /// # Errors
    /// The table of the integral is not a valid curve, e.g. if its strains exceed the range of floating-point numbers.
    pub fn nominal_curve(self, curve: &Curve, modulus: f64) -> Result<(Curve, f64), CurveError> {
        let (limit, yields_at) = curve.elastic_limit(modulus);
        let straight = curve.strain().len() == 2 && curve.beyond() == Beyond::Extend;
        if straight || limit == curve.last_strain() {
            return Ok((curve.clone(), 0.0));
        }
        let last = curve.last_strain();
        let start = if limit > 0.0 { limit } else { curve.strain()[1] * 1e-3 };
        let mut table = self.tabulated(curve, &breaks(curve, start, last));
        if curve.beyond() == Beyond::Extend {
            // Tabulated separately, so that stresses far beyond the data do not make the table of the data coarse.
            let extension = self.tabulated(curve, &[last, EXTENDED * last]);
            table.rows.extend_from_slice(&extension.rows[1..]);
            table.error = table.error.max(extension.error);
        }
        if limit > 0.0 {
            // Exactly on the elastic line.
            table.rows[0] = (limit, yields_at);
        }
        Ok((Curve::new(&table.rows, curve.beyond())?, table.error))
    }

    fn tabulated(self, curve: &Curve, breaks: &[f64]) -> Tabulated {
        // The largest stress of a curve that falls is that of a knot before its end.
        let top = breaks.iter().map(|&g| self.nominal_stress(curve, g)).fold(0.0, f64::max);
        refine(&|g| (g, self.nominal_stress(curve, g)), breaks, TORSION_TOLERANCE, top)
    }
}

impl Material {
    /// Returns this material, whose curve is in shear, as a rod (q = 0) or a tube made of it behaves in torsion, in terms of the surface.
    ///
    /// # Errors
    /// As for [`TubeSection::nominal_curve`].
    pub fn in_torsion(&self, hollow: TubeSection) -> Result<Arc<Self>, CurveError> {
        let (curve, error) = hollow.nominal_curve(&self.tension, self.modulus)?;
        let ratio = (hollow.q * 1e6).round() / 1e6;
        let form = if hollow.q == 0.0 { "rod".to_owned() } else { format!("tube of diameter ratio {ratio}") };
        Ok(Arc::new(Self {
            name: format!("{}, {form}", self.name),
            tension: curve,
            table_error: self.table_error.max(error),
            ..self.clone()
        }))
    }

    /// Converts this material, whose curve is in tension, to shear by von Mises' rule, from its true curve: tau = sigma/sqrt(3), plastic shear
    /// strain sqrt(3) times plastic strain, G = E/(2 (1 + nu)). The area of a twisted section does not change, so that there is no necking: after
    /// the largest engineering stress in tension, the curve continues like that in compression if both are one true curve; otherwise its data end
    /// there. Straight segments of an engineering table are curved in shear, and knots are added so that the table is within 3e-5 of the largest
    /// shear stress. Tables made from a law or from true stresses have enough rows. The constants of rate laws are kept as they are in tension;
    /// [`super::Rate::in_shear`] converts them.
    ///
    /// # Errors
    /// Poisson's ratio is missing, or the converted table is not a valid curve.
    pub fn in_shear(&self) -> Result<Self, InputError> {
        let nu = self.poisson.ok_or_else(|| {
            let error = InputError::new("its Poisson's ratio (`poisson`) is missing, which the shear modulus needs");
            error.key("poisson").allowed("0 <= poisson <= 0.5").help("add it to the material")
        })?;
        let modulus = self.modulus / (2.0 * (1.0 + nu));
        let (end, beyond) = self.end_in_shear();
        let tension = ShearBranch { material: self, sense: Sense::Tension, modulus };
        let mut table = tension.table(&breaks(&self.tension, 0.0, end));
        if beyond != Beyond::Rupture
            && let Some(more) = tension.past(end)
        {
            table.rows.extend_from_slice(&more.rows[1..]);
            table.error = table.error.max(more.error);
        }
        let curve = Curve::new(&table.rows, beyond).map_err(|_| {
            let error = InputError::new("its curve does not give a valid shear curve").key("tension");
            error.help("check the curve and Poisson's ratio, or give the curve in shear")
        })?;
        Ok(Self {
            modulus,
            loading: Loading::Shear,
            tension: curve,
            compression: None,
            // A difference in engineering stress is larger by the factor 1 + strain in true stress.
            table_error: self.table_error * (1.0 + end) / ROOT_3 + table.error,
            branch_errors: [0.0; 2],
            shear_from_tension: Some(modulus / self.modulus),
            ..self.clone()
        })
    }

    /// Returns the engineering strain in tension up to which the curve is converted, and the behaviour after the last row.
    fn end_in_shear(&self) -> (f64, Beyond) {
        let curve = &self.tension;
        let neck = curve.ultimate().filter(|ultimate| ultimate.reason == UltimateReason::MaximumStress);
        let Some(neck) = neck else { return (curve.last_strain(), curve.beyond()) };
        let last = curve.stress().iter().rposition(|&stress| stress >= neck.stress).unwrap_or(0);
        (curve.strain()[last], Beyond::Error)
    }
}

/// One branch of the curve of a material, converted to shear.
#[derive(Clone, Copy)]
struct ShearBranch<'a> {
    material: &'a Material,
    sense: Sense,
    /// Shear modulus, Pa.
    modulus: f64,
}

impl ShearBranch<'_> {
    /// Returns the true plastic strain and the true stress (Pa) at an engineering strain.
    fn true_point(self, strain: f64) -> (f64, f64) {
        let stress = self.material.branch(self.sense).stress_at(strain);
        let (strain, stress) = true_from_engineering(self.sense, strain, stress);
        let elastic = elastic_engineering_strain(self.sense, stress / self.material.modulus);
        let (elastic, _) = true_from_engineering(self.sense, elastic, 0.0);
        ((strain - elastic).max(0.0), stress)
    }

    /// Converts true plastic strain and true stress (Pa) to shear strain and shear stress (Pa).
    fn in_shear(self, (plastic, stress): (f64, f64)) -> (f64, f64) {
        let shear = stress / ROOT_3;
        (ROOT_3 * plastic + shear / self.modulus, shear)
    }

    /// Returns the shear curve between engineering strains at which its slope may change.
    fn table(self, breaks: &[f64]) -> Tabulated {
        self.refined(breaks, |_| 1.0)
    }

    /// Returns [`Self::table`] with stresses multiplied by a factor.
    fn refined(self, breaks: &[f64], factor: impl Fn(f64) -> f64) -> Tabulated {
        let point = |strain: f64| {
            let (plastic, stress) = self.true_point(strain);
            self.in_shear((plastic, factor(strain) * stress))
        };
        let top = breaks.iter().map(|&strain| point(strain).1).fold(0.0, f64::max);
        let made = self.material.branch_errors[usize::from(self.sense == Sense::Compression)] > 0.0;
        refine(&point, breaks, if made { f64::INFINITY } else { SHEAR_TOLERANCE }, top)
    }

    /// Returns the compression curve from the true strain at which the tension curve ends, if both are one true curve there; their small difference
    /// is removed gradually up to the next row.
    fn past(self, end: f64) -> Option<Tabulated> {
        let compression = Self { sense: Sense::Compression, ..self };
        let curve = self.material.compression.as_ref()?;
        let (plastic, stress) = self.true_point(end);
        let before = |strain: f64| compression.true_point(strain).0 <= plastic;
        let next = curve.strain().partition_point(|&strain| before(strain));
        let (&low, &high) = (curve.strain()[..next].last()?, curve.strain().get(next)?);
        let from = bisect([low, high], 0.0, before);
        let ratio = stress / compression.true_point(from).1;
        let factor = |strain: f64| 1.0 + (ratio - 1.0) * ((high - strain) / (high - from)).max(0.0);
        ((ratio - 1.0).abs() < SAME_CURVE)
            .then(|| compression.refined(&breaks(curve, from, curve.last_strain()), factor))
    }
}

/// Returns the two given strains, and those of the rows between them.
fn breaks(curve: &Curve, from: f64, to: f64) -> Vec<f64> {
    let rows = curve.strain().iter().copied().filter(|&strain| from < strain && strain < to);
    std::iter::once(from).chain(rows).chain([to]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: f64 = 80e9;

    fn perfectly_plastic() -> Curve {
        Curve::new(&[(0.002, 160e6), (0.2, 160e6)], Beyond::Rupture).expect("rows rise")
    }

    #[test]
    fn a_perfectly_plastic_rod_follows_the_closed_form() {
        let (curve, solid) = (perfectly_plastic(), TubeSection { q: 0.0 });
        let (table, _) = solid.nominal_curve(&curve, G).expect("a curve");
        for k in 1..400 {
            let g = 0.2 * f64::from(k) / 400.0;
            // T = 4/3 Ty (1 - (gy/g)^3/4).
            let exact = if g < 0.002 { G * g } else { 4.0 / 3.0 * 160e6 * (1.0 - (0.002 / g).powi(3) / 4.0) };
            let rounding = 1e-13 * exact;
            assert!((solid.nominal_stress(&curve, g) - exact).abs() < rounding, "{g}");
            assert!((table.stress_at(g) - exact).abs() < 1.5 * TORSION_TOLERANCE * 213e6, "{g}");
        }
        assert_eq!(table.elastic_limit(G), (0.002, 160e6));
    }

    /// A curve that has fallen to nothing at its end was tabulated to a tolerance of nothing, without end.
    #[test]
    fn a_tube_of_a_material_that_softens_to_nothing_has_a_short_table() {
        let rows = [(2.03e-3, 6.09e6), (5.3592e-2, 0.0), (6.400_59e-2, 0.0)];
        let curve = Curve::new(&rows, Beyond::Extend).expect("rows are in order");
        let (table, error) = TubeSection { q: 512.0 / 586.0 }.nominal_curve(&curve, 3e9).expect("a curve");
        assert!(table.strain().len() < 1000 && error < 1.5 * TORSION_TOLERANCE * 6.09e6, "{error}");
    }

    /// Such a rod was simulated with the shear curve of its material, and its table's error reported as 0.
    #[test]
    fn a_section_without_a_nominal_curve_is_an_error() {
        let curve = Curve::new(&[(0.002, 160e6), (1e12, 170e6)], Beyond::Extend).expect("rows rise");
        assert!(TubeSection { q: 0.0 }.nominal_curve(&curve, G).is_err());
        let rod = Material::from_curve("steel", 7800.0, curve).expect("a material").in_torsion(TubeSection { q: 0.0 });
        assert!(rod.is_err());
    }

    #[test]
    fn a_power_law_rod_follows_the_closed_form() {
        // tau = K g^n all the way: T R/J = 4 K g^n/(3 + n). The table of the law has 2000 rows.
        let (k, n) = (500e6_f64, 0.3_f64);
        let rows: Vec<(f64, f64)> =
            (1..=2000).map(|i| (1e-4 * f64::from(i), k * (1e-4 * f64::from(i)).powf(n))).collect();
        let curve = Curve::new(&rows, Beyond::Error).expect("rows rise");
        for g in [0.05_f64, 0.1, 0.2] {
            let exact = 4.0 / (3.0 + n) * k * g.powf(n);
            assert!((TubeSection { q: 0.0 }.nominal_stress(&curve, g) / exact - 1.0).abs() < 1e-6, "{g}");
        }
    }

    #[test]
    fn a_thick_tube_tends_to_the_thin_one() {
        let curve = Curve::new(&[(0.002, 160e6), (0.05, 240e6), (0.2, 300e6)], Beyond::Error).expect("rows rise");
        let mut before = f64::INFINITY;
        for wall in [0.1, 0.01, 0.001, 1e-6] {
            let tube = TubeSection { q: 1.0 - wall };
            // The wall's middle has the strain (1 - wall/2) g and the nominal stress counts at the surface.
            let middle = 1.0 - 0.5 * wall;
            let off = (tube.nominal_stress(&curve, 0.1) * middle / curve.stress_at(0.1 * middle) - 1.0).abs();
            assert!(off < 0.5 * wall, "{wall}: {off:e}");
            assert!(off < before || off < 1e-9);
            before = off;
        }
    }

    #[test]
    fn von_mises_keeps_elastic_and_plastic_parts_apart() {
        let rows = [(0.001, 200e6), (0.011, 400e6)];
        let curve = Curve::new(&rows, Beyond::Extend).expect("rows rise");
        let mut steel = Material::from_curve("steel", 7800.0, curve).expect("a material");
        assert!(steel.in_shear().is_err());
        steel.poisson = Some(0.25);
        let shear = steel.in_shear().expect("poisson is known");
        assert!((shear.modulus - 80e9).abs() < 1.0 && shear.loading == Loading::Shear);
        let root = 3.0_f64.sqrt();
        // True stress at the engineering strain 0.001.
        assert!((shear.tension.elastic_limit(shear.modulus).1 - 200e6 * 1.001 / root).abs() < 1.0);
        // Engineering strain 0.011, of which 0.002 less a little is elastic, at 400 MPa times 1.011.
        let stress = 400e6 * 1.011;
        let elastic = 0.5 * ((1.0_f64 + 4.0 * stress / 200e9).sqrt() - 1.0);
        let expected = root * (0.011_f64.ln_1p() - elastic.ln_1p()) + stress / root / 80e9;
        assert!((shear.tension.last_strain() / expected - 1.0).abs() < 1e-12);
    }

    /// Two rows gave a straight shear curve: a tube had 4 % too little strain behind a wave, or a quarter too much slope.
    #[test]
    fn between_rows_the_shear_curve_is_that_of_the_straight_tension_curve() {
        let (modulus, nu) = (70e9, 0.33);
        let slope = 2e9;
        let curve = Curve::new(&[(0.002, 140e6), (0.302, 740e6)], Beyond::Extend).expect("rows rise");
        let mut metal = Material::from_curve("metal", 2700.0, curve).expect("a material");
        metal.poisson = Some(nu);
        let shear = metal.in_shear().expect("poisson is known");
        let root = 3.0_f64.sqrt();
        let top = shear.tension.stress()[shear.tension.stress().len() - 1];
        for k in 0..=300 {
            let strain = 0.002 + 1e-3 * f64::from(k);
            let stress = (140e6 + slope * (strain - 0.002)) * (1.0 + strain);
            let elastic = 0.5 * ((1.0_f64 + 4.0 * stress / modulus).sqrt() - 1.0);
            let plastic = strain.ln_1p() - elastic.ln_1p();
            let gamma = root * plastic + stress / root / shear.modulus;
            let off = shear.tension.stress_at(gamma) - stress / root;
            assert!(off.abs() <= shear.table_error + 1e-9 * top, "{strain}: {off:e}");
        }
        assert!((0.0..=SHEAR_TOLERANCE * top).contains(&shear.table_error), "{}", shear.table_error);
    }

    /// Where tension necks, at true strain 0.3, torsion goes on: tau = K (gamma/sqrt(3))^n/sqrt(3).
    #[test]
    fn twisting_makes_no_neck() {
        let (k, n) = (500e6_f64, 0.3_f64);
        let true_rows: Vec<(f64, f64)> =
            (0..290).map(|i| 4e-4 * 1.03_f64.powi(i)).map(|e| (e, k * e.powf(n))).collect();
        let branch = |sense: Sense| {
            let rows: Vec<(f64, f64)> =
                true_rows.iter().map(|&(e, s)| super::super::engineering_from_true(sense, e, s)).collect();
            Curve::new(&rows, Beyond::Error).expect("rows rise")
        };
        let mut copper = Material::from_curve("copper", 8960.0, branch(Sense::Tension)).expect("a material");
        copper.poisson = Some(0.34);
        assert!(copper.tension.ultimate().is_some_and(|top| (top.strain - 0.3_f64.exp_m1()).abs() < 0.02));
        let alone = copper.in_shear().expect("a curve").tension;
        assert!(alone.stops_at_end() && alone.last_strain() < 0.54, "{}", alone.last_strain());
        copper.compression = Some(branch(Sense::Compression));
        let whole = copper.in_shear().expect("a curve").tension;
        assert!(whole.stops_at_end() && whole.last_strain() > 3.4);
        for gamma in [0.1, 0.5, 1.0, 2.0, 3.0] {
            let plastic = |stress: f64| (gamma - stress / copper.in_shear().unwrap().modulus) / 3.0_f64.sqrt();
            let stress = whole.stress_at(gamma);
            let expected = k * (plastic(stress) + stress * 3.0_f64.sqrt() / copper.modulus).powf(n) / 3.0_f64.sqrt();
            assert!((stress / expected - 1.0).abs() < 2e-3, "{gamma}: {stress:e} {expected:e}");
        }
    }
}
