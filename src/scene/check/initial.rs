//! Checks of the initial values of a segment.

use super::super::raw::{INITIAL, RawBar, RawEffects};
use super::super::{Effects, HardeningRule, Method};
use super::Checker;
use super::distribution::{ACCUMULATED, PLASTIC, STRAIN, STRESS, TEMPERATURE};
use crate::bar::{Bar, Initial, Segment};
use crate::error::{Error, Result};
use crate::law::rate::Hardening;
use crate::law::{BackStress, Table};
use crate::material::{Curve, Sense};
use crate::scene::discretized::{MOST_PIECES, steps_needed};
use crate::units::{Dimension, System, format};

/// Relative rounding error of values that are combined from several tables.
const ROUNDING: f64 = 1e-9;

/// Plastic strains below this value are rounding errors, where a steep table crosses zero.
const LEAST_STRAIN: f64 = 1e-12;

/// Segment with its index, the keys of the bar, and the position of its left end, m.
struct Given<'a> {
    raw: &'a RawBar,
    k: usize,
    segment: &'a Segment,
    x0: f64,
}

impl Checker<'_> {
    /// Checks that the initial states are possible for the materials and allowed by the effects.
    pub(super) fn initial_states(
        &self,
        raw: &RawBar,
        raw_effects: &RawEffects,
        effects: &Effects,
        bar: &Bar,
    ) -> Result<()> {
        let mut x0 = 0.0;
        for (k, segment) in bar.segments.iter().enumerate() {
            let given = Given { raw, k, segment, x0 };
            x0 += segment.length;
            if (1..INITIAL.len()).all(|which| raw.initial_of(k, which).is_none()) {
                continue;
            }
            self.heat_of_start(&given, raw_effects)?;
            if raw.initial_of(k, PLASTIC).or_else(|| raw.initial_of(k, ACCUMULATED)).is_some() {
                self.can_have_yielded(&given, effects)?;
            }
            self.stress_is_elastic(&given, effects)?;
        }
        Ok(())
    }

    /// Returns an error at the first of these keys that is given.
    fn at_key(&self, given: &Given<'_>, keys: &[usize], message: String) -> crate::error::InputError {
        let place = keys.iter().find_map(|&which| given.raw.initial_of(given.k, which));
        let (key, span) = place.unwrap_or_default();
        self.error(span, &key, message)
    }

    /// Checks that temperatures are used only with heating, and are within the range of the material.
    fn heat_of_start(&self, given: &Given<'_>, raw_effects: &RawEffects) -> Result<()> {
        let warm = given.raw.initial_of(given.k, TEMPERATURE).is_some();
        let heating = given.segment.material.heating.as_deref().filter(|heating| heating.warms());
        let Some(heating) = heating else {
            if !warm {
                return Ok(());
            }
            let message =
                "an initial temperature needs the effect `heat` with a fraction above 0: the curve is independent of \
                           temperature otherwise"
                    .to_owned();
            let help = if raw_effects.heat.is_some() {
                "remove `temperature`"
            } else {
                "add heat = {} to [effects], or remove `temperature`"
            };
            return Err(self.at_key(given, &[TEMPERATURE], message).help(help).into());
        };
        let range = heating.range();
        let outside = |initial: &Initial| !(0.0..range).contains(&initial.temperature_rise);
        let Some((initial, place)) = states(given, &[]).into_iter().find(|(initial, _)| outside(initial)) else {
            return Ok(());
        };
        let kelvin = |rise: f64| heating.reference_temperature + rise;
        let message =
            format!("an initial temperature of {} K{place} is out of range", kelvin(initial.temperature_rise));
        let allowed = format!(
            "{} K (reference temperature) <= temperature < {} K (melting temperature)",
            kelvin(0.0),
            kelvin(range)
        );
        Err(self
            .at_key(given, &[TEMPERATURE], message)
            .allowed(allowed)
            .help("give a temperature in the allowed range, with its unit: K, degC")
            .into())
    }

    fn can_have_yielded(&self, given: &Given<'_>, effects: &Effects) -> Result<()> {
        let keys = [PLASTIC, ACCUMULATED];
        if effects.hardening.is_none() && effects.rate.is_none() {
            let message =
                "an initial plastic strain needs a hardening rule: without one, unloading follows the loading curve"
                    .to_owned();
            let help = "add hardening = \"isotropic\" to [effects]";
            return Err(self.at_key(given, &keys, message).help(help).into());
        }
        if given.raw.initial_of(given.k, ACCUMULATED).is_some() && moves(effects) {
            let message =
                "with kinematic or mixed hardening, the accumulated plastic strain does not determine the elastic range"
                    .to_owned();
            let help =
                "remove it: `plastic-strain` is then that of monotonic loading; or use hardening = \"isotropic\"";
            return Err(self.at_key(given, &[ACCUMULATED], message).help(help).into());
        }
        for (initial, place) in states(given, &[]) {
            let Initial { plastic_strain: plastic, accumulated, .. } = initial;
            if accumulated < plastic.abs() * (1.0 - ROUNDING) - LEAST_STRAIN {
                let message = format!(
                    "an accumulated plastic strain of {accumulated}{place} is less than the plastic strain, {plastic}"
                );
                let help = "accumulated-plastic-strain >= |plastic-strain|";
                return Err(self.at_key(given, &[ACCUMULATED, PLASTIC], message).help(help).into());
            }
            self.is_within_data(given, &initial, &place)?;
        }
        Ok(())
    }

    fn is_within_data(&self, given: &Given<'_>, initial: &Initial, place: &str) -> Result<()> {
        let material = &given.segment.material;
        let table = Table::new(static_curve(given.segment, Sense::of(initial.plastic_strain)), material.modulus);
        let most = table.plastic_strain(table.end()) / material.modulus;
        if initial.accumulated <= most * (1.0 + ROUNDING) {
            return Ok(());
        }
        let (name, value) = (
            &material.name,
            if initial.accumulated > initial.plastic_strain.abs() {
                initial.accumulated
            } else {
                initial.plastic_strain
            },
        );
        let message = format!("an initial plastic strain of {value}{place} is beyond the data of {name}");
        let allowed = format!("|plastic-strain| <= {most:.4}, the value at the end of the curve");
        Err(self
            .at_key(given, &[PLASTIC, ACCUMULATED], message)
            .allowed(allowed)
            .help("reduce it, or extend the curve to this strain")
            .into())
    }

    fn stress_is_elastic(&self, given: &Given<'_>, effects: &Effects) -> Result<()> {
        let modulus = given.segment.material.modulus;
        let starts = |sense| {
            let hardening = Hardening::new(&Table::new(static_curve(given.segment, sense), modulus));
            hardening.pieces().iter().map(|piece| piece.start / modulus).collect::<Vec<_>>()
        };
        let corners = [Sense::Tension, Sense::Compression].map(starts).concat();
        let range = |initial: &Initial| elastic_range(given.segment, initial, effects);
        let outside = |initial: &Initial| {
            let [low, high] = range(initial);
            let slack = if given.segment.profile.is_some() { ROUNDING * high.abs().min(low.abs()) } else { 0.0 };
            !(low - slack..=high + slack).contains(&initial.stress)
        };
        let Some((initial, place)) = states(given, &corners).into_iter().find(|(initial, _)| outside(initial)) else {
            return Ok(());
        };
        let ([low, high], stress) = (range(&initial), initial.stress);
        let message = format!("an initial stress of {stress:.6e} Pa{place} is outside the elastic range");
        let allowed = format!("{low:.6e} Pa to {high:.6e} Pa with this plastic strain");
        let help = "give the `plastic-strain` at which this stress is within the elastic range";
        Err(self
            .at_key(given, &[STRESS, STRAIN, PLASTIC, ACCUMULATED, TEMPERATURE], message)
            .allowed(allowed)
            .help(help)
            .into())
    }

    /// Checks the number of steps of the staircase into which front tracking divides an initial state that varies along the bar.
    pub(super) fn staircase_is_short(&self, raw: &RawBar, bar: &Bar, method: &Method) -> Result<()> {
        let steps = steps_needed(bar, method);
        if steps <= MOST_PIECES {
            return Ok(());
        }
        let given = |(k, segment)| Given { raw, k, segment, x0: 0.0 };
        let mut segments = bar.segments.iter().enumerate().filter(|(_, segment)| segment.profile.is_some());
        let message =
            format!("method = \"moc\" discretizes the initial state into uniform steps and would need {steps} of them");
        let error: Option<Error> = segments.next().map(given).map(|given| {
            let error = self.at_key(&given, &[STRESS, STRAIN, PLASTIC, 0, ACCUMULATED, TEMPERATURE], message);
            let help = "use method = \"fd\", or reduce the rows of the table, or increase front-tolerance";
            error.allowed(format!("at most {MOST_PIECES}")).help(help).into()
        });
        error.map_or(Ok(()), Err)
    }
}

/// Returns the curve at the reference temperature.
fn static_curve(segment: &Segment, sense: Sense) -> &Curve {
    let cold = segment.material.heating.as_ref().map(|heating| &heating.cold[..]);
    match cold {
        Some([tension]) => tension,
        Some([tension, compression, ..]) => {
            if sense == Sense::Tension {
                tension
            } else {
                compression
            }
        }
        _ => segment.material.branch(sense),
    }
}

/// Returns the initial states of a segment that have to be checked, with their positions in words: the uniform state, or the states on both sides of
/// every row and wherever the plastic strain or its accumulated value equals one of `corners` in magnitude. The state is linear between these
/// positions.
fn states(given: &Given<'_>, corners: &[f64]) -> Vec<(Initial, String)> {
    let Some(profile) = &given.segment.profile else { return vec![(given.segment.initial, String::new())] };
    let mut places = profile.knots();
    places.push(given.segment.length);
    let mut between = Vec::new();
    for pair in places.windows(2) {
        for table in [&profile.accumulated, &profile.plastic_strain] {
            let [from, to] = [table.at(pair[0]), table.before(pair[1])];
            let parts =
                corners.iter().flat_map(|corner| [*corner, -corner]).map(|corner| (corner - from) / (to - from));
            between.extend(
                parts.filter(|part| 0.0 < *part && *part < 1.0).map(|part| pair[0] + part * (pair[1] - pair[0])),
            );
        }
    }
    places.extend(between);
    places.sort_by(f64::total_cmp);
    places.dedup();
    let of = |x: f64| {
        let words = std::format!(" at x = {}", format(given.x0 + x, Dimension::Length, System::Si));
        [0, 1].map(|side| (profile.one_sided_limit(x, side), words.clone()))
    };
    places.into_iter().flat_map(of).collect()
}

fn moves(effects: &Effects) -> bool {
    effects.hardening.is_some_and(HardeningRule::moves)
}

/// Returns the elastic range of a section with this initial state, as lower and upper stress, Pa.
fn elastic_range(segment: &Segment, initial: &Initial, effects: &Effects) -> [f64; 2] {
    let modulus = segment.material.modulus;
    let hardening = |sense| Hardening::new(&Table::new(static_curve(segment, sense), modulus));
    let [tension, compression] = [Sense::Tension, Sense::Compression].map(hardening);
    let flow = |side: &Hardening, p: f64| {
        let pieces = side.pieces();
        pieces[side.find(p) as usize].at(p)
    };
    let heating = segment.material.heating.as_ref().filter(|heating| heating.warms());
    let softening = heating.map_or(1.0, |heating| heating.softening(initial.temperature_rise));
    let p = modulus * if moves(effects) { initial.plastic_strain.abs() } else { initial.accumulated };
    if !moves(effects) {
        return [-flow(&compression, p), flow(&tension, p)].map(|limit| softening * limit);
    }
    // Hardening that moves the elastic range requires a single curve for tension and compression.
    let flow_stress = flow(&tension, p);
    let moved = match effects.hardening {
        Some(HardeningRule::ArmstrongFrederick { c, gamma }) => BackStress::new(c, gamma, modulus).first_loading(p),
        rule => rule.map_or(0.0, HardeningRule::kinematic_fraction) * (flow_stress - tension.yield_stress()),
    };
    let (back, half) = (moved.copysign(initial.plastic_strain), flow_stress - moved);
    [back - half, back + half].map(|limit| softening * limit)
}
