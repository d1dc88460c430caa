//! `[beam]` scenes: a sphere on a simply supported beam.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;
use toml::Spanned;

use super::super::check::{BallKeys, Checker};
use super::super::raw::MaterialChoice;
use super::Parts;
use super::body::{RawSphere, elastic_json, raw_body, solid_json};
use crate::error::Result;
use crate::impact::{Beam, Elastic, Foundation, Section};
use crate::input::{Allowed, Number};
use crate::units::{Dimension, Quantity, System, format};

/// A sphere strikes a simply supported beam at rest. Numbers are SI; a text is a number with its unit, such as "10 mm".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave beam scene")]
pub struct RawBeamScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The beam. Required.
    #[schemars(with = "RawBeam")]
    pub beam: Spanned<RawBeam>,
    /// The sphere. Required.
    #[schemars(with = "RawSphere")]
    pub striker: Option<Spanned<RawSphere>>,
    /// How closely and how long the impact is integrated.
    #[serde(default)]
    pub solve: RawBeamSolve,
    /// What is recorded.
    #[serde(default)]
    pub record: RawBeamRecord,
}

raw_body! {
    /// The beam or column: simply supported at both ends, one cross-section.
    RawBeam {
        /// Length between the supports, m, > 0. Required.
        #[schemars(with = "Quantity")]
        pub length: Option<Number>,
        /// Depth in the direction of the impact, m, > 0; with `width` for a rectangular section, with `area` and `inertia` for any.
        #[schemars(with = "Option<Quantity>")]
        pub depth: Option<Number>,
        /// Width of a rectangular section, m, > 0.
        #[schemars(with = "Option<Quantity>")]
        pub width: Option<Number>,
        /// Diameter of a round section, m, > 0; in place of all other keys of the section.
        #[schemars(with = "Option<Quantity>")]
        pub diameter: Option<Number>,
        /// Area of the section, m^2, > 0; with `inertia` and `depth`.
        #[schemars(with = "Option<Quantity>")]
        pub area: Option<Number>,
        /// Second moment of area, m^4, > 0; with `area` and `depth`.
        #[schemars(with = "Option<Quantity>")]
        pub inertia: Option<Number>,
        /// Place of the impact from the left support, m, within the beam. Default: the middle.
        #[schemars(with = "Option<Quantity>")]
        pub at: Option<Number>,
        /// Internal damping c1 of equation 9.23, Pa s, >= 0: stress per rate of strain. Default: 0.
        #[serde(rename = "internal-damping")]
        #[schemars(with = "Option<Quantity>")]
        pub internal: Option<Number>,
        /// External damping c2 of equation 9.23, N s/m^2, >= 0: force per length and velocity. Default: 0.
        #[serde(rename = "external-damping")]
        #[schemars(with = "Option<Quantity>")]
        pub external: Option<Number>,
        /// Modulus k of an elastic foundation, N/m^2, >= 0: force per length and deflection. Default: 0.
        #[schemars(with = "Option<Quantity>")]
        pub foundation: Option<Number>,
        /// Axial force, N, compression positive, below that of buckling. Default: 0.
        #[serde(rename = "axial-force")]
        #[schemars(with = "Option<Quantity>")]
        pub axial: Option<Number>,
    }
}

/// How closely and how long the impact is integrated.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawBeamSolve {
    /// Largest relative change of peak force, contact time, rebound velocity and extremes at the gauges when the modes are doubled and
    /// the step tolerance is divided by 4, 1e-12 to 1e-2; the modes follow from it. A step's defect of Hertz's law stays below a tenth
    /// of it. Default: 1e-5.
    #[schemars(with = "Option<f64>")]
    pub tolerance: Option<Number>,
    /// Modes, in place of those that the tolerance asks for; a whole number, 1 to 10000.
    #[schemars(with = "Option<u64>")]
    pub modes: Option<Number>,
    /// End, s, > 0. Default: when the sphere has left for good, after at least one and at most 50 periods of the lowest mode, or 1.5 and 100
    /// Hertz contact times where these are longer.
    #[schemars(with = "Option<Quantity>")]
    pub until: Option<Number>,
}

/// What is recorded.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawBeamRecord {
    /// Histories of deflection, bending moment and strain: name = place, m from the left support, within the beam. Default: none.
    #[schemars(with = "BTreeMap<String, Quantity>")]
    #[serde(default)]
    pub gauges: BTreeMap<String, Number>,
    /// Deflected shapes, evenly over the time up to the earliest end, and up to twice as many where the contact lasts longer; a whole number,
    /// 0 to 1000. Default: 8.
    #[schemars(with = "Option<u64>")]
    pub shapes: Option<Number>,
}

const GIB: f64 = 1_073_741_824.0;
/// Most bytes of histories.
const MOST_BYTES: f64 = 4.0 * GIB;
/// Most modes that a scene can ask for.
const MOST_MODES: usize = 10_000;

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawBeamScene = checker.document.parse()?;
    let help = "add [striker] with radius, material and velocity";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let (span, own) = (raw.beam.span(), raw.beam.get_ref());
    let length = (own.length.as_ref(), "length", Dimension::Length, Allowed::Positive);
    let length = checker.own_number(length, span.clone(), "beam")?;
    let section = checker.beam_section(own, span.clone())?;
    let (elastic, one) = checker.elastic(&own.keys(), span, "beam")?;
    let (sphere, two) = checker.sphere(striker, "striker", Allowed::Positive)?;
    let number =
        |value: Option<&Number>, key: &str, dimension, range| checker.document.optional(value, key, dimension, range);
    let at = number(own.at.as_ref(), "beam.at", Dimension::Length, Allowed::Between(0.0, length))?;
    let beam = Beam {
        length,
        section,
        elastic,
        foundation: checker.beam_foundation(own, length, section, &elastic)?,
        striker: sphere,
        at: at.unwrap_or(0.5 * length),
        gauges: checker.gauges(&raw.record.gauges, length, "beam")?,
        shapes: raw.record.shapes.as_ref().map_or(Ok(8), |n| checker.document.count(n, "record.shapes", 0, 1000))?,
        until: number(raw.solve.until.as_ref(), "solve.until", Dimension::Time, Allowed::Positive)?,
        tolerance: checker.contact_tolerance(raw.solve.tolerance.as_ref(), 1e-5)?,
        modes: raw.solve.modes.as_ref().map(|n| checker.document.count(n, "solve.modes", 1, MOST_MODES)).transpose()?,
    };
    checker.sphere_fits(&beam, striker)?;
    checker.histories_fit(&beam, &raw)?;
    let resolved = resolved(&beam);
    let materials = [one, two].into_iter().flatten().collect();
    Ok(Parts { title: raw.title, problem: Arc::new(beam), materials, resolved })
}

fn resolved(beam: &Beam) -> serde_json::Value {
    let (section, along) = (beam.section, beam.foundation);
    let gauges: serde_json::Map<_, _> = beam.gauges.iter().map(|(name, x)| (name.clone(), json!(x))).collect();
    json!({
        "beam": {
            "length": beam.length, "area": section.area, "inertia": section.inertia, "depth": section.depth, "at": beam.at,
            "elastic": elastic_json(&beam.elastic), "internal-damping": along.internal, "external-damping": along.external,
            "foundation": along.modulus, "axial-force": along.axial,
        },
        "striker": solid_json(&beam.striker),
        "solve": { "tolerance": beam.tolerance, "modes": beam.modes, "until": beam.until },
        "record": { "gauges": gauges, "shapes": beam.shapes },
    })
}

impl Checker<'_> {
    fn beam_section(&self, raw: &RawBeam, span: Range<usize>) -> Result<Section> {
        let own = |value: &Option<Number>, name, dimension| {
            self.own_number((value.as_ref(), name, dimension, Allowed::Positive), span.clone(), "beam")
        };
        if let Some(diameter) = &raw.diameter {
            let others = [(&raw.depth, "depth"), (&raw.width, "width"), (&raw.area, "area"), (&raw.inertia, "inertia")];
            if let Some((other, name)) = others.into_iter().find_map(|(v, name)| Some((v.as_ref()?, name))) {
                let error =
                    self.error(other.span(), &format!("beam.{name}"), "the section is given by its diameter already");
                return Err(error.help(format!("keep `diameter` or `{name}`, not both")).into());
            }
            let d = self.document.number(diameter, "beam.diameter", Dimension::Length, Allowed::Positive)?;
            return Ok(Section { area: PI / 4.0 * d * d, inertia: PI / 64.0 * d.powi(4), depth: d });
        }
        let depth = own(&raw.depth, "depth", Dimension::Length)?;
        if raw.area.is_none() && raw.inertia.is_none() {
            let width = own(&raw.width, "width", Dimension::Length)?;
            return Ok(Section { area: width * depth, inertia: width * depth.powi(3) / 12.0, depth });
        }
        if let Some(width) = &raw.width {
            let error = self.error(
                width.span(),
                "beam.width",
                "`width` is for a rectangular section, `area` and `inertia` for any other",
            );
            return Err(error.help("keep `width`, or `area` and `inertia`").into());
        }
        let area = own(&raw.area, "area", Dimension::Area)?;
        Ok(Section { area, inertia: own(&raw.inertia, "inertia", Dimension::SecondMomentOfArea)?, depth })
    }

    fn beam_foundation(&self, raw: &RawBeam, length: f64, section: Section, elastic: &Elastic) -> Result<Foundation> {
        let number = |value: &Option<Number>, key, dimension, range| {
            self.document.optional(value.as_ref(), key, dimension, range).map(Option::unwrap_or_default)
        };
        let foundation = Foundation {
            internal: number(&raw.internal, "beam.internal-damping", Dimension::Viscosity, Allowed::NotNegative)?,
            external: number(&raw.external, "beam.external-damping", Dimension::Drag, Allowed::NotNegative)?,
            modulus: number(&raw.foundation, "beam.foundation", Dimension::Foundation, Allowed::NotNegative)?,
            axial: number(&raw.axial, "beam.axial-force", Dimension::Force, Allowed::Finite)?,
        };
        let buckling = buckling(length, elastic.modulus * section.inertia, foundation.modulus);
        if let Some(axial) = raw.axial.as_ref().filter(|_| foundation.axial >= buckling) {
            let message = format!("{} buckles the beam before the impact", axial.get_ref());
            let allowed = format!("axial-force < {}", format(buckling, Dimension::Force, System::Si));
            let error = self.error(axial.span(), "beam.axial-force", message).allowed(allowed);
            return Err(error
                .help("compression is positive; give a smaller force, or a stiffer or shorter beam")
                .into());
        }
        Ok(foundation)
    }

    /// The histories of two integrations are in memory at a time.
    fn histories_fit(&self, beam: &Beam, raw: &RawBeamScene) -> Result<()> {
        let bytes = beam.expected_bytes();
        if bytes <= MOST_BYTES {
            return Ok(());
        }
        let end = raw.solve.until.as_ref();
        let message =
            format!("histories of about {:.1e} time steps take {:.1} GiB", beam.expected_steps(), bytes / GIB);
        let (span, key) = end.map_or((raw.beam.span(), "beam.length"), |until| (until.span(), "solve.until"));
        let error = self.error(span, key, message).allowed(format!("at most {:.0} GiB", MOST_BYTES / GIB));
        let help = "the steps are 1/128 of the contact time; give `solve.until` a shorter time, or record fewer gauges";
        Err(error.help(help).into())
    }

    /// A contact wider than the section, or a sphere longer than the beam, is no contact at a point.
    fn sphere_fits(&self, beam: &Beam, striker: &Spanned<RawSphere>) -> Result<()> {
        let contact = beam.contact();
        let approach = contact.largest_approach(beam.striker.mass, beam.striker.velocity);
        let patch = 2.0 * (contact.radius * approach).sqrt();
        let shown = |value| format(value, Dimension::Length, System::Si);
        let raw = striker.get_ref();
        let span = raw.radius.as_ref().or(raw.diameter.as_ref()).map_or(striker.span(), Spanned::span);
        let key = if raw.diameter.is_some() { "striker.diameter" } else { "striker.radius" };
        let diameter = 2.0 * beam.striker.radius;
        let (message, allowed) = if diameter > beam.length {
            let message = format!("the sphere, {} across, is longer than the beam", shown(diameter));
            (message, format!("diameter <= {}", shown(beam.length)))
        } else if patch > beam.section.depth {
            let message = format!("the contact would be {} wide, more than the beam is deep", shown(patch));
            (message, format!("a contact up to {}", shown(beam.section.depth)))
        } else {
            return Ok(());
        };
        let error = self.error(span, key, message).allowed(allowed);
        Err(error
            .help("the theory is for a contact at a point of the beam: give a smaller sphere or a slower one")
            .into())
    }
}

/// Smallest axial force, N, at which a mode has no stiffness: E I (n pi/l)^2 + k/(n pi/l)^2 over all n.
fn buckling(length: f64, bending: f64, modulus: f64) -> f64 {
    let load = |n: f64| {
        let k2 = (n * PI / length).powi(2);
        bending * k2 + modulus / k2
    };
    // The best wave number is the fourth root of modulus/bending; the whole numbers beside it hold the smallest.
    let best = ((modulus / bending).powf(0.25) * length / PI).floor().max(1.0);
    load(best).min(load(best + 1.0))
}
