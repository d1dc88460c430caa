//! `[beam]` scenes: impact of a sphere on a simply supported beam.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use super::super::check::{Checker, first_given};
use super::super::raw::{BodyKeys, Gauges, MaterialChoice, raw_body};
use super::Parts;
use super::body::{RawSphere, Tolerance, elastic_json, solid_json};
use crate::error::{InputError, Result};
use crate::impact::{Beam, Elastic, Face, Foundation, Section, buckling};
use crate::input::Allowed;
use crate::typed::{Count, Key, NotNegative, Of, Or, Placed, Plain, Poisson, Positive};
use crate::units::{Dimension, System, format, measures};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;

/// A sphere strikes a simply supported beam at rest. Numbers are SI; a text is a number with its unit, such as "10 mm".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave beam scene")]
pub struct RawBeamScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The beam. Required.
    pub beam: Placed<RawBeam>,
    /// The sphere. Required.
    #[schemars(with = "RawSphere")]
    pub striker: Option<Placed<RawSphere>>,
    /// Accuracy and duration of the impact integration.
    #[serde(default)]
    pub solve: RawBeamSolve,
    /// What is recorded.
    #[serde(default)]
    pub record: RawBeamRecord,
}

raw_body! {
    /// The beam or column: simply supported at both ends, one cross-section.
    RawBeam {
        /// Length between the supports.
        pub length: Of<measures::Length, Positive>,
        /// Depth in the direction of the impact; with `width` for a rectangular section, with `area` and `inertia` for any.
        pub depth: Option<Of<measures::Length, Positive>>,
        /// Width of a rectangular section.
        pub width: Option<Of<measures::Length, Positive>>,
        /// Diameter of a round section, on which the area of contact is an ellipse; instead of all other keys of the section.
        pub diameter: Option<Of<measures::Length, Positive>>,
        /// Area of the section; with `inertia` and `depth`. The struck face is taken as flat.
        pub area: Option<Of<measures::Area, Positive>>,
        /// Second moment of area, at most `area*depth^2/4`; with `area` and `depth`.
        pub inertia: Option<Of<measures::SecondMomentOfArea, Positive>>,
        /// Position of the impact from the left support, within the beam. Default: midspan.
        pub at: Option<Of<measures::Length>>,
        /// Internal damping c1 of equation 9.23: stress per rate of strain.
        #[schemars(default)]
        pub internal_damping: Or<Of<measures::Viscosity, NotNegative>, 0>,
        /// External damping c2 of equation 9.23: force per length and velocity.
        #[schemars(default)]
        pub external_damping: Or<Of<measures::Drag, NotNegative>, 0>,
        /// Modulus k of an elastic foundation: force per length and deflection.
        #[schemars(default)]
        pub foundation: Or<Of<measures::Foundation, NotNegative>, 0>,
        /// Axial force, compression positive, less than the buckling load.
        #[schemars(default)]
        pub axial_force: Or<Of<measures::Force>, 0>,
    }
}

/// Accuracy and duration of the impact integration.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawBeamSolve {
    /// Largest relative change of peak force, contact time, rebound velocity and extremes at the gauges when the modes are doubled and
    /// the step tolerance is divided by 4; it determines the number of modes. The defect of Hertz's law in a step is below a tenth of it.
    #[schemars(default)]
    pub tolerance: Or<Tolerance, 1, 100_000>,
    /// Number of modes, instead of that from the tolerance.
    pub modes: Option<Count<1, { Beam::MOST_MODES }>>,
    /// End time. Default: after the final separation, between 1 and 50 periods of the lowest mode, or between 1.5 and 100 Hertz contact times if these are longer.
    pub until: Option<Of<measures::Time, Positive>>,
}

/// What is recorded.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawBeamRecord {
    /// Histories of deflection, bending moment and strain: name = position, m from the left support, within the beam. Default: none.
    #[serde(default)]
    pub gauges: Gauges,
    /// Number of deflected shapes, evenly spaced up to the earliest end time; up to twice as many if the contact lasts longer.
    #[schemars(default)]
    pub shapes: Or<Count<0, { Beam::MOST_SHAPES }>, 8>,
}

/// Largest number of steps, each 1/128 of the contact time, over which the extremes at gauges are searched.
const MOST_STEPS: f64 = 2e7;

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawBeamScene = checker.document.parse()?;
    let help = "add [striker] with radius, material and velocity";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let (span, own) = (raw.beam.span(), raw.beam.get_ref());
    let length = checker.si(&own.length)?;
    let section = checker.beam_section(own, span.clone())?;
    let (elastic, one) = checker.elastic(&own.keys(), span, "beam")?;
    let (sphere, two) = checker.sphere(striker, "striker")?;
    let within = Allowed::Between(0.0, length);
    let at = own.at.as_ref().map(|at| at.si_within(checker.document, within)).transpose()?;
    let beam = Beam {
        length,
        section,
        elastic,
        foundation: checker.beam_foundation(own, length, section, &elastic)?,
        striker: sphere,
        at: at.unwrap_or(0.5 * length),
        gauges: checker.gauges(&raw.record.gauges, length, "beam")?,
        shapes: checker.si(&raw.record.shapes)?,
        until: checker.si(&raw.solve.until)?,
        tolerance: checker.si(&raw.solve.tolerance)?,
        modes: checker.si(&raw.solve.modes)?,
    };
    checker.sphere_fits(&beam, striker)?;
    checker.gauges_can_be_searched(&beam, &raw)?;
    let resolved = resolved(&beam);
    let materials = [one, two].into_iter().flatten().collect();
    Ok(Parts { title: raw.title, problem: Arc::new(beam), materials, resolved })
}

fn resolved(beam: &Beam) -> serde_json::Value {
    let (section, along) = (beam.section, beam.foundation);
    let width = match section.face {
        Face::Flat { width } => Some(width).filter(|width| width.is_finite()),
        Face::Round => None,
    };
    let gauges: serde_json::Map<_, _> = beam.gauges.iter().map(|(name, x)| (name.clone(), json!(x))).collect();
    json!({
        "beam": {
            "length": beam.length, "area": section.area, "inertia": section.inertia, "depth": section.depth, "at": beam.at,
            "round": section.face == Face::Round, "width": width,
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
        if let Some(diameter) = &raw.diameter {
            let others = first_given([
                ("depth", raw.depth.place()),
                ("width", raw.width.place()),
                ("area", raw.area.place()),
                ("inertia", raw.inertia.place()),
            ]);
            if let Some((name, other)) = others {
                let error = self.error(other, &format!("beam.{name}"), "the section is already given by its diameter");
                return Err(error.help(format!("keep `diameter` or `{name}`, not both")).into());
            }
            let d = self.si(diameter)?;
            return Ok(Section { area: PI / 4.0 * d * d, inertia: PI / 64.0 * d.powi(4), depth: d, face: Face::Round });
        }
        let depth = self.needed(raw.depth.as_ref(), "depth", span.clone(), "beam")?;
        if raw.area.is_none() && raw.inertia.is_none() {
            let width = self.needed(raw.width.as_ref(), "width", span, "beam")?;
            let (area, inertia) = (width * depth, width * depth.powi(3) / 12.0);
            return Ok(Section { area, inertia, depth, face: Face::Flat { width } });
        }
        if let Some(width) = &raw.width {
            let error = self.error(
                width.span(),
                "beam.width",
                "`width` is for a rectangular section, `area` and `inertia` for any other",
            );
            return Err(error.help("keep `width`, or `area` and `inertia`").into());
        }
        self.any_section(raw, depth, span)
    }

    /// Returns a section given by its area and second moment of area.
    fn any_section(&self, raw: &RawBeam, depth: f64, span: Range<usize>) -> Result<Section> {
        let area = self.needed(raw.area.as_ref(), "area", span.clone(), "beam")?;
        let inertia = self.needed(raw.inertia.as_ref(), "inertia", span, "beam")?;
        let section = Section { area, inertia, depth, face: Face::Flat { width: f64::INFINITY } };
        let place = |raw: &RawBeam| Some(self.document.place(raw.inertia.as_ref()?.span()));
        section.check().map_err(|e| InputError { key: "beam.inertia".into(), place: place(raw).map(Box::new), ..e })?;
        Ok(section)
    }

    fn beam_foundation(&self, raw: &RawBeam, length: f64, section: Section, elastic: &Elastic) -> Result<Foundation> {
        let foundation = Foundation {
            internal: self.si(&raw.internal_damping)?,
            external: self.si(&raw.external_damping)?,
            modulus: self.si(&raw.foundation)?,
            axial: self.si(&raw.axial_force)?,
        };
        let buckling = buckling(length, elastic.modulus * section.inertia, foundation.modulus);
        if let Some(axial) = raw.axial_force.typed().filter(|_| foundation.axial >= buckling) {
            let message = format!("{} buckles the beam before the impact", axial.get_ref());
            let allowed = format!("axial-force < {}", format(buckling, Dimension::Force, System::Si));
            let error = self.error(axial.span(), "beam.axial-force", message).allowed(allowed);
            return Err(error
                .help("compression is positive; give a smaller force, or a stiffer or shorter beam")
                .into());
        }
        Ok(foundation)
    }

    fn gauges_can_be_searched(&self, beam: &Beam, raw: &RawBeamScene) -> Result<()> {
        let steps = beam.finest_steps();
        if beam.gauges.is_empty() || steps <= MOST_STEPS {
            return Ok(());
        }
        let end = raw.solve.until.as_ref();
        let message = format!("the gauges would be searched over about {steps:.1e} steps of 1/128 of the contact time");
        let (span, key) = end.map_or((raw.beam.span(), "beam.length"), |until| (until.span(), "solve.until"));
        let error = self.error(span, key, message).allowed(format!("at most {MOST_STEPS:.0e} steps"));
        Err(error.help("give `solve.until` a shorter time, or record no gauges").into())
    }

    /// Refuses a contact wider than the section, or a sphere longer than the beam: the theory assumes contact at a point.
    fn sphere_fits(&self, beam: &Beam, striker: &Placed<RawSphere>) -> Result<()> {
        let contact = beam.area_of_contact();
        let approach = contact.law.largest_approach(beam.striker.mass, beam.striker.velocity);
        let [_, across] = contact.semi_axes(approach);
        let patch = 2.0 * across;
        let depth = (beam.section.depth, "depth");
        let (most, what) = match beam.section.face {
            Face::Flat { width } if width < depth.0 => (width, "width"),
            _ => depth,
        };
        let shown = |value| format(value, Dimension::Length, System::Si);
        let raw = striker.get_ref();
        let span = raw.radius.place().or(raw.diameter.place()).unwrap_or_else(|| striker.span());
        let key = if raw.diameter.is_some() { "striker.diameter" } else { "striker.radius" };
        let diameter = 2.0 * beam.striker.radius;
        let (message, allowed) = if diameter > beam.length {
            let message = format!("the sphere, {} across, is longer than the beam", shown(diameter));
            (message, format!("diameter <= {}", shown(beam.length)))
        } else if patch > most {
            let message = format!("the contact would be {} wide, more than the {what} of the beam", shown(patch));
            (message, format!("a contact up to {}", shown(most)))
        } else {
            return Ok(());
        };
        let error = self.error(span, key, message).allowed(allowed);
        Err(error
            .help("the theory is for a contact at a point of the beam: give a smaller sphere or a slower one")
            .into())
    }
}
