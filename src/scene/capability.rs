//! Capabilities in two tables: the features that each method supports, and the features that exclude each other. Error messages with their
//! alternatives, the default method, and the table of docs/guide/methods.md are derived from them.

use std::ops::Range;

use super::raw::{RawBar, RawEffects, RawHardening, RawMethod, RawSolve};
use crate::bar::{Bar, EndCondition, Joint, Segment};
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::law::Table;
use crate::material::Sense;
use crate::typed::Placed;

/// Solvers, in the order of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Solver {
    Leapfrog,
    Godunov,
    FrontTracking,
    Net,
}

/// Support of a feature by a solver.
#[derive(Debug, Clone, Copy)]
enum Can {
    Yes,
    /// Supported in a different form.
    As(&'static str),
    No,
    /// Supported only in a restricted case of the row.
    Only(&'static str),
    /// Not applicable: the method then uses another solver.
    Other,
}

/// Features that a scene requires of its method.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) effects: &'a RawEffects,
    /// Whether `effects = "auto"` is used.
    pub(super) auto: bool,
    pub(super) bar: &'a Bar,
    pub(super) ends: &'a [EndCondition],
}

/// Feature of a scene, and the solvers that support it.
struct Row {
    /// Title in the table of the guide.
    title: &'static str,
    /// Returns `None` if the scene does not require the feature, otherwise the text for `{}` in the name.
    asked: fn(&Asked<'_>) -> Option<String>,
    /// Name in messages.
    name: &'static str,
    /// Reason for which some solvers do not support it; may be empty.
    why: &'static str,
    /// Alternative to another method; may be empty.
    or: &'static str,
    can: [Can; 4],
}

use Can::{As, No, Only, Other, Yes};

const IN_PIECES: Can = As("as uniform pieces");
const NOT_ONE_CURVE: &str = "the temperature is then a state variable of each cell, not a function of plastic strain";
const NO_CHARACTERISTICS: &str = "it couples all nodes of a grid";
/// Alternative to the overlay model.
pub(super) const MIXED: &str =
    "use hardening = { mixed = 1 }, which moves the elastic range along the curve by the accumulated plastic strain";

/// Features in the order of the checks, with the columns leapfrog, Godunov, front tracking, net.
#[rustfmt::skip]
const METHODS: &[Row] = &[
    row("`hardening` isotropic, mixed", |_| None, "isotropic hardening", "", "",
        [Yes, Yes, Yes, Yes]),
    row("`hardening` kinematic", several_lines,
        "kinematic hardening along several lines, as that of {}", "it stores no reversal points", MIXED,
        [Yes, Yes, Only("curves with one hardening line"), Yes]),
    row("`hardening` Armstrong-Frederick", |a| when(a.effects.armstrong_frederick().is_some()),
        "Armstrong-Frederick hardening", "its reverse-flow curve is derived from the first-loading curve", MIXED,
        [Yes, No, No, No]),
    row("`effects = \"auto\"`", |a| when(a.auto),
        "effects = \"auto\"", "", "name the effects",
        [Yes, No, Yes, Other]),
    row("`rate`", |a| when(rate(a)),
        "the effect `rate`", "", "remove `rate` from [effects]",
        [Yes, No, Other, Yes]),
    row("`heat`, isotropic", |a| when(heat(a)),
        "the effect `heat`", "it stores no temperature", "remove `heat` or `rate` from [effects]",
        [Yes, Yes, Yes, No]),
    row("`heat` with `rate`, kinematic or mixed hardening", |a| when(heat(a) && moves(a)),
        "the effect `heat` with kinematic or mixed hardening", NOT_ONE_CURVE, "remove `heat` from [effects]",
        [Yes, No, No, No]),
    row("`heat` with an initial temperature or plastic strain", |a| when(starts_warm(a)),
        "the effect `heat` with an initial temperature or plastic strain", NOT_ONE_CURVE, "remove the initial values",
        [Yes, No, No, No]),
    row("`rupture`", |a| when(a.effects.rupture.is_some()),
        "the effect `rupture`", "", "remove `rupture` from [effects]",
        [Yes, No, Yes, No]),
    row("`damping`", |a| when(a.effects.damping.is_some()),
        "the effect `damping`", NO_CHARACTERISTICS, "remove `damping` from [effects]",
        [Yes, No, No, No]),
    row("`lateral-inertia`", |a| when(a.effects.lateral_inertia().is_some()),
        "the effect `lateral-inertia`", NO_CHARACTERISTICS, "remove `lateral-inertia` from [effects]",
        [Yes, No, No, No]),
    row("`hardening` mixed, along a curve that stiffens or drops", stiffens,
        "kinematic or mixed hardening along a curve that stiffens or drops, as that of {}", "", "use hardening = \"isotropic\"",
        [Yes, No, Yes, Yes]),
    row("contact joints", |_| None, "contact joints", "", "",
        [Yes, Yes, Yes, Yes]),
    row("tapers", |a| when(tapered(a.bar).is_some()), "tapered segments", "", "",
        [Yes, No, IN_PIECES, IN_PIECES]),
    row("end `ball`", |a| when(ball(a)), "a ball at an end", "", "",
        [Yes, No, Yes, Yes]),
    row("torsion", |_| None, "torsion", "", "",
        [Yes, Yes, Yes, Yes]),
    row("checkpoints", |_| None, "checkpoints", "", "",
        [Yes, Yes, No, Yes]),
];

const fn row(
    title: &'static str,
    asked: fn(&Asked<'_>) -> Option<String>,
    name: &'static str,
    why: &'static str,
    or: &'static str,
    can: [Can; 4],
) -> Row {
    Row { title, asked, name, why, or, can }
}

fn when(asked: bool) -> Option<String> {
    asked.then(String::new)
}

fn rate(asked: &Asked<'_>) -> bool {
    asked.effects.rate.is_some()
}

fn heat(asked: &Asked<'_>) -> bool {
    asked.effects.heat.is_some()
}

fn ball(asked: &Asked<'_>) -> bool {
    asked.ends.iter().any(|end| matches!(end, EndCondition::Ball { .. }))
}

/// Returns whether hardening moves the elastic range.
fn moves(asked: &Asked<'_>) -> bool {
    asked.effects.hardening.as_ref().is_some_and(|u| !matches!(u.get_ref(), RawHardening::Isotropic))
}

fn curve(segment: &Segment, sense: Sense) -> Table {
    Table::new(segment.material.branch(sense), segment.material.modulus)
}

/// Returns the name of the material of the first segment for which `such` returns true.
fn material_of(asked: &Asked<'_>, such: impl Fn(&&Segment) -> bool) -> Option<String> {
    asked.bar.segments.iter().find(such).map(|segment| format!("`{}`", segment.material.name))
}

fn several_lines(asked: &Asked<'_>) -> Option<String> {
    material_of(asked, |s| asked.effects.overlays() && curve(s, Sense::Tension).is_multilinear())
}

fn stiffens(asked: &Asked<'_>) -> Option<String> {
    let concave = |s: &Segment| [Sense::Tension, Sense::Compression].iter().all(|sense| curve(s, *sense).is_concave());
    material_of(asked, |s| moves(asked) && !concave(s))
}

/// Returns whether the temperature is a state variable from the start.
fn starts_warm(asked: &Asked<'_>) -> bool {
    asked.bar.segments.iter().any(|s| s.material.is_adiabatic() && (s.has_yielded() || s.starts_warm()))
}

fn tapered(bar: &Bar) -> Option<usize> {
    bar.segments.iter().position(|s| s.taper.is_some())
}

impl RawEffects {
    /// Returns the key `lateral-inertia` if it is true.
    pub(super) fn lateral_inertia(&self) -> Option<&Placed<bool>> {
        self.lateral_inertia.as_ref().filter(|on| *on.get_ref())
    }

    /// Returns the key `hardening` if it is Armstrong-Frederick.
    fn armstrong_frederick(&self) -> Option<&Placed<RawHardening>> {
        self.hardening.as_ref().filter(|rule| matches!(rule.get_ref(), RawHardening::ArmstrongFrederick(_)))
    }

    /// Returns whether a curve with several hardening lines uses [`crate::law::Overlay`]; never with rate dependence or heating.
    pub(super) fn overlays(&self) -> bool {
        let kinematic = self.hardening.as_ref().is_some_and(|u| matches!(u.get_ref(), RawHardening::Kinematic));
        kinematic && self.rate.is_none() && self.heat.is_none()
    }
}

impl Solver {
    /// Returns the solver of a method of the scene language.
    pub(super) fn of(method: RawMethod, muscl: bool, rate: bool) -> Self {
        match (method, rate) {
            (RawMethod::Fd, _) if muscl => Self::Godunov,
            (RawMethod::Fd, _) => Self::Leapfrog,
            (RawMethod::Moc, true) => Self::Net,
            (RawMethod::Moc, false) => Self::FrontTracking,
        }
    }

    /// Returns the keys that select the solver, with the name of the method.
    fn words(self) -> &'static str {
        match self {
            Self::Leapfrog => "method = \"fd\"",
            Self::Godunov => "scheme = \"muscl\"",
            Self::FrontTracking => "method = \"moc\" (front tracking)",
            Self::Net => "method = \"moc\" (a characteristic net)",
        }
    }

    /// Returns the first feature of a scene that the solver does not support.
    fn misses(self, asked: &Asked<'_>) -> Option<(&'static Row, String)> {
        let mut missed = METHODS.iter().filter(|row| matches!(row.can[self as usize], No | Only(_)));
        missed.find_map(|row| Some((row, (row.asked)(asked)?)))
    }

    /// Returns whether the solver supports the whole scene.
    pub(super) fn can(self, asked: &Asked<'_>) -> bool {
        self.misses(asked).is_none()
    }

    /// Returns the other solvers that support the whole scene, as they are named in help lines.
    fn instead(self, asked: &Asked<'_>) -> Vec<&'static str> {
        let of_moc = if rate(asked) { Self::Net } else { Self::FrontTracking };
        let leapfrog = if self == Self::Godunov { "scheme = \"leapfrog\"" } else { Self::Leapfrog.words() };
        let all = [(Self::Leapfrog, leapfrog), (of_moc, of_moc.words()), (Self::Godunov, Self::Godunov.words())];
        all.into_iter().filter(|(other, _)| *other != self && other.can(asked)).map(|(_, words)| words).collect()
    }
}

/// Refuses a solver that does not support a feature of the scene. The position of the error is that of the key of the method.
pub(super) fn method_can(document: &Document, raw: &RawSolve, solver: Solver, asked: &Asked<'_>) -> Result<()> {
    let Some((row, of)) = solver.misses(asked) else { return Ok(()) };
    let (key, span, allowed) = if solver == Solver::Godunov {
        ("solve.scheme", raw.scheme.as_ref().map(Placed::span), "\"leapfrog\"")
    } else {
        ("solve.method", raw.method.as_ref().map(Placed::span), "\"fd\"")
    };
    let why = if row.why.is_empty() { String::new() } else { format!(": {}", row.why) };
    let message = format!("{} does not simulate {}{why}", solver.words(), row.name.replace("{}", &of));
    let methods = match solver.instead(asked).split_first() {
        None => String::new(),
        Some((first, [])) => format!("use {first}, which does"),
        Some((first, rest)) => format!("use {first}, which does, or {}", rest.join(", or ")),
    };
    let ways: Vec<&str> = [&methods, row.or].into_iter().filter(|way| !way.is_empty()).collect();
    let help = ways.join("; or ");
    Err(document.error(span.unwrap_or(0..0), key, message).allowed(allowed).help(help).into())
}

/// Feature of a scene and its position in the file.
struct Found {
    /// Name in messages; the number of a segment.
    name: String,
    key: String,
    span: Range<usize>,
}

/// Features of a scene that can exclude each other.
struct Parts<'a> {
    raw_bar: &'a RawBar,
    effects: &'a RawEffects,
    bar: &'a Bar,
}

/// Two features that exclude each other with every method. `{1}` and `{2}` in the texts are their names. The position of the error is that of the
/// first.
struct Pair {
    first: fn(&Parts<'_>) -> Option<Found>,
    second: fn(&Parts<'_>) -> Option<Found>,
    message: &'static str,
    help: &'static str,
}

const AXIAL: &str = "remove it, or use mode = \"axial\"";
const GOES_ON: &str = "remove it: the run reports the end of the curve data and the largest torque";
const IN_TORSION: &str = "`{1}` is not simulated in torsion";

#[rustfmt::skip]
const TOGETHER: &[Pair] = &[
    Pair { first: recalled, second: rated,   message: "`{1}` is not simulated together with `{2}`",
           help: "use hardening = \"kinematic\" or { mixed = 0 to 1 }, or remove `{2}` from [effects]" },
    Pair { first: rupture,  second: torsion, message: IN_TORSION, help: GOES_ON },
    Pair { first: heating,  second: torsion, message: IN_TORSION, help: AXIAL },
    Pair { first: along,    second: torsion, message: IN_TORSION, help: AXIAL },
    Pair { first: contact,  second: torsion, message: "a contact joint carries no torque",
           help: "use joint = \"bonded\", or end the bar there with a boundary condition" },
    Pair { first: taper,    second: torsion, message: "a taper is not simulated in torsion",
           help: "give one diameter; `inner-diameter` can differ from segment to segment" },
    Pair { first: rupture,  second: along,   message: "`rupture` is not simulated together with `{2}`",
           help: "remove `rupture` or `{2}` from [effects]: method = \"fd\" simulates each without the other" },
    Pair { first: along,    second: taper,   message: "`{1}` is not simulated in a bar with a taper (segment {2})",
           help: "use uniform segments, or remove `{1}` from [effects]: method = \"fd\" and \"moc\" then simulate the taper" },
    Pair { first: along,    second: contact, message: "`{1}` is not simulated in a bar with contact joints (segment {2})",
           help: "use joint = \"bonded\", or remove `{1}` from [effects]: all methods then simulate contact joints" },
];

fn effect<T>(name: &str, given: Option<&Placed<T>>) -> Option<Found> {
    given.map(|given| Found { name: name.to_owned(), key: format!("effects.{name}"), span: given.span() })
}

fn rupture(parts: &Parts<'_>) -> Option<Found> {
    effect("rupture", parts.effects.rupture.as_ref())
}

fn heating(parts: &Parts<'_>) -> Option<Found> {
    effect("heat", parts.effects.heat.as_ref())
}

fn recalled(parts: &Parts<'_>) -> Option<Found> {
    parts.effects.armstrong_frederick().map(|rule| Found {
        name: "armstrong-frederick".to_owned(),
        key: "effects.hardening".to_owned(),
        span: rule.span(),
    })
}

/// Returns the first enabled effect of `rate` and `heat`, with which the elastic range depends on more than the plastic strain.
fn rated(parts: &Parts<'_>) -> Option<Found> {
    effect("rate", parts.effects.rate.as_ref()).or_else(|| heating(parts))
}

/// Returns the first enabled effect of `damping` and `lateral-inertia`, which cause distributed forces.
fn along(parts: &Parts<'_>) -> Option<Found> {
    let lateral = || effect("lateral-inertia", parts.effects.lateral_inertia());
    effect("damping", parts.effects.damping.as_ref()).or_else(lateral)
}

fn torsion(parts: &Parts<'_>) -> Option<Found> {
    let mode = parts.raw_bar.mode.as_ref().filter(|_| parts.raw_bar.is_torsion());
    mode.map(|mode| Found { name: "torsion".to_owned(), key: "bar.mode".to_owned(), span: mode.span() })
}

fn contact(parts: &Parts<'_>) -> Option<Found> {
    let k = parts.bar.segments.iter().position(|s| matches!(s.joint, Joint::Contact { .. }))?;
    let joint = parts.raw_bar.segment.as_ref()?[k].get_ref().joint.as_ref()?;
    Some(Found { name: (k + 1).to_string(), key: format!("bar.segment.{k}.joint"), span: joint.span() })
}

fn taper(parts: &Parts<'_>) -> Option<Found> {
    let k = tapered(parts.bar)?;
    let (key, span) = parts.raw_bar.section_of(k)?;
    Some(Found { name: (k + 1).to_string(), key, span })
}

/// Refuses features of a scene that exclude each other.
pub(super) fn all_go_together(document: &Document, raw_bar: &RawBar, effects: &RawEffects, bar: &Bar) -> Result<()> {
    let parts = Parts { raw_bar, effects, bar };
    for pair in TOGETHER {
        if let (Some(first), Some(second)) = ((pair.first)(&parts), (pair.second)(&parts)) {
            let text = |text: &str| text.replace("{1}", &first.name).replace("{2}", &second.name);
            let error = document.error(first.span.clone(), &first.key, text(pair.message));
            return Err(error.help(text(pair.help)).into());
        }
    }
    Ok(())
}

/// Keys that a bar scene does not have but that name a known feature: the key, the reason, and the alternative.
#[rustfmt::skip]
const ELSEWHERE: &[(&str, &str, &str)] = &[
    ("striker", "this version does not simulate a striking body of its own",
     "give an end kind = \"striker\" with mass and velocity, or join two segments with joint = \"contact\""),
    ("solve.viscosity", "artificial viscosity is part of the scheme and has no key",
     "remove it: leapfrog adds artificial viscosity by itself, and only where shocks can form (curves that stiffen or are followed both ways); \
      scheme = \"muscl\" and method = \"moc\" need none"),
];

/// Replaces the error "unknown key" by an explanation if the key is in [`ELSEWHERE`], or if it is `striker` in a scene without anything that it
/// strikes.
pub(super) fn not_a_key(error: Error, has_bar: bool) -> Error {
    let Error::Input(error) = error else { return error };
    if error.key == "striker" && !has_bar && error.message.starts_with("unknown key") {
        let help =
            "add one of [specimen], [spheres], [plate], [beam]; the striker of a bar is an end with kind = \"striker\"";
        return InputError { message: "the scene does not say what is struck".into(), ..error }.help(help).into();
    }
    let word = ELSEWHERE.iter().find(|(key, ..)| *key == error.key && error.message.starts_with("unknown key"));
    let Some((_, why, help)) = word else { return error.into() };
    InputError { message: (*why).to_owned(), ..error }.help(*help).into()
}

/// Returns the table of the guide in Markdown: the heading, and one line per feature.
pub fn methods_table() -> String {
    let cell = |can: &Can| match can {
        Yes => "yes",
        No => "no",
        As(how) | Only(how) => how,
        Other => "",
    };
    let line = |row: &Row| format!("| {} | {} |\n", row.title, row.can.each_ref().map(cell).join(" | "));
    let head = "| | leapfrog | Godunov | front tracking | net (`rate`) |\n|---|---|---|---|---|\n";
    head.to_owned() + &METHODS.iter().map(line).collect::<String>()
}
