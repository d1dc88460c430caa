//! Convergence study: the number of modes is increased and the step tolerance is reduced until the tolerance of the result is met.

use super::Beam;
use super::extremes::Peak;
use super::observe::Observer;
use crate::impact::Watch;
use crate::impact::contact::{Contact, History, Horizon, Touch};
use crate::impact::solid::judge;
use crate::impact::solution::{Column, Figure, Line, Solution, Table};
use crate::units::Dimension::{AngularVelocity, Force, Impulse, Length, None as Plain, Rate, Time, Torque, Velocity};

/// Number of modes of the first level.
pub(super) const FIRST_MODES: usize = 16;
/// Largest number of modes of a level.
const MOST_MODES: usize = 4096;
/// Number of successive levels with another number of contacts than the level before, after which more modes are not expected to settle the
/// sequence: each contact magnifies the differences of the one before.
const UNSETTLED: usize = 3;
/// Number of modes from which on [`UNSETTLED`] applies.
const UNSETTLED_MODES: usize = 256;
/// Defect allowed in a step, relative to the tolerance of the result.
const STEP_PART: f64 = 0.1;

/// Largest number of contacts listed in the summary.
const MOST_LINES: usize = 12;

/// Difference between the coefficients of restitution by (9.31) and by integration above which a warning is given.
const LARGEST_DIFFERENCE: f64 = 0.05;

/// The result of one integration.
struct Level {
    modes: usize,
    history: History,
    observer: Observer,
}

impl Level {
    /// Returns the values that have to converge, each with its scale: the first contact, the final velocity of the striker, and the extremes at the
    /// gauges.
    fn results(&self, velocity: f64) -> Vec<[f64; 2]> {
        let Some(first) = self.history.touches.first() else { return Vec::new() };
        let own = |value: f64| [value, value];
        let last = self.observer.contact.own("striker_velocity").last().copied().unwrap_or(velocity);
        let mut results = vec![own(first.peak_force), own(first.end), [last, velocity]];
        for reading in [0, 2] {
            let gauges = 0..self.observer.readings.len();
            let extremes: Vec<f64> = gauges.map(|gauge| self.observer.largest(gauge, reading).value).collect();
            // A common scale: a gauge that hardly moves needs the same absolute accuracy as the others.
            let scale = extremes.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            results.extend(extremes.into_iter().map(|value| [value, scale]));
        }
        results
    }

    fn contacts(&self) -> usize {
        self.history.touches.len()
    }

    /// Returns the largest difference between the results of two levels, relative to their scales.
    fn differs(&self, finer: &Self, velocity: f64) -> f64 {
        let pairs = self.results(velocity).into_iter().zip(finer.results(velocity));
        pairs.map(|(a, b)| if b[1] == 0.0 { 0.0 } else { ((a[0] - b[0]) / b[1]).abs() }).fold(0.0, f64::max)
    }
}

impl Beam {
    /// Integrates with twice the modes and a quarter of the step tolerance per level until two levels agree; only once if the number of modes is
    /// given. If interrupted, returns the last complete level, or the first level as far as it was computed.
    pub(super) fn converge(&self, watch: Watch<'_>) -> Solution {
        let (mut modes, mut step) = (self.modes.unwrap_or(FIRST_MODES), STEP_PART * self.tolerance);
        let mut level = self.integrate(modes, step, watch);
        if self.modes.is_some() || level.history.interrupted {
            return self.solution(level, None);
        }
        let (mut error, mut last, mut unsettled) = (None, 0.0, 0);
        loop {
            (modes, step) = (2 * modes, (0.25 * step).max(1e-13));
            let finer = self.integrate(modes, step, watch);
            if finer.history.interrupted {
                return self.last_complete(level, error);
            }
            let change = level.differs(&finer, self.striker.velocity);
            unsettled = if level.contacts() == finer.contacts() { 0 } else { unsettled + 1 };
            // If the levels do not settle, two of them may agree by chance.
            let before = if unsettled > 1 { last } else { 0.0 };
            (level, error, last) = (finer, Some(change.max(before)), change);
            let converged = change <= self.tolerance && unsettled == 0;
            if converged || modes >= MOST_MODES || unsettled >= UNSETTLED && modes >= UNSETTLED_MODES {
                return self.solution(level, error);
            }
        }
    }

    /// Returns the result of an interrupted convergence study.
    fn last_complete(&self, level: Level, error: Option<f64>) -> Solution {
        let known = if error.is_some() { "the tolerance is not reached" } else { "the error is not known" };
        let warning = format!("interrupted after the integration with {} modes: {known}", level.modes);
        let mut solution = self.solution(level, None);
        solution.outcome = Solution::INTERRUPTED;
        solution.warnings.push(warning);
        solution
    }

    fn integrate(&self, modes: usize, tolerance: f64, watch: Watch<'_>) -> Level {
        let [least, most] = self.ends();
        let mut observer = Observer::new(self, modes, self.half_sine(), least);
        // Gauges and shapes are sampled at the ends of steps.
        let looked_at = !self.gauges.is_empty() || self.shapes > 0;
        let doublings = if looked_at { 0 } else { Horizon::CONTACT_ALONE };
        let horizon = Horizon { least, most, tolerance, doublings };
        let history = Contact::new(self.contact(), self.system(modes)).run(horizon, |moment| {
            observer.look(&moment);
            watch((moment.time / least).min(1.0))
        });
        Level { modes, history, observer }
    }

    fn solution(&self, level: Level, error: Option<f64>) -> Solution {
        let Level { modes, history, observer } = level;
        let mut solution = self.approximation();
        self.contacts(&mut solution, &history);
        let last = observer.contact.own("striker_velocity").last().copied().unwrap_or(self.striker.velocity);
        let figure = |name, dimension, long_name, value| Figure::new(name, dimension, long_name, value);
        let restitution = if history.separated { -last / self.striker.velocity } else { f64::NAN };
        let values = [(last, Velocity), (restitution, Plain)];
        solution.lines.push(if history.separated {
            Line::new("striker after", "{}: coefficient of restitution {}", &values)
        } else {
            Line::new("striker at end", "{}", &values)
        });
        solution.figures.extend([
            figure("striker_velocity", Velocity, "velocity of the striker at the end", last),
            figure("restitution", Plain, "minus the ratio of final to initial velocity of the striker", restitution),
            figure("end_time", Time, "end of the integration", history.end),
            Figure { key: "modes", ..Figure::count("mode_count", "modes of the beam", modes) },
            figure(
                "error",
                Plain,
                "relative change of the results from half the modes and longer time steps",
                error.unwrap_or(f64::NAN),
            ),
        ]);
        solution.lines.push(Line::new("modes", "{}", &[(modes as f64, Plain)]));
        if let Some(error) = error {
            let values = [(error, Plain), (self.tolerance, Plain)];
            solution.lines.push(Line::new("error", "{} from half the modes, tolerance {}", &values));
        }
        self.extremes(&mut solution, &observer);
        super::super::account(&mut solution, &observer.ledger, &history);
        self.warn(&mut solution, &history, error);
        solution.warnings.extend(self.bends_beyond_yield(observer.strain()));
        let deflection = observer.contact.own("deflection").iter().fold(0.0, |most: f64, w| most.max(w.abs()));
        solution.warnings.extend(self.bends_far(deflection));
        solution.shapes = (!observer.shapes.time.is_empty()).then_some(observer.shapes);
        let tables = vec![observer.contact, contacts_table(&history), observer.ledger, self.modes_table(modes)];
        solution.tables = [tables, observer.readings].concat();
        solution
    }

    fn contacts(&self, solution: &mut Solution, history: &History) {
        let figure = |name, dimension, long_name, value| Figure::new(name, dimension, long_name, value);
        let Some(first) = history.touches.first() else { return };
        let touches = || history.touches.iter();
        let largest = touches().fold(first, |a, b| if b.peak_force > a.peak_force { b } else { a });
        solution.figures.extend([
            Figure::count("contact_count", "number of contacts", history.touches.len()),
            figure("peak_force", Force, "largest contact force of all contacts", largest.peak_force),
            figure("time_of_peak", Time, "time of the largest contact force of all contacts", largest.peak_time),
            figure("contact_duration", Time, "time in contact, all contacts", touches().map(Touch::duration).sum()),
            figure("approach", Length, "largest approach of all contacts", largest.approach),
            figure("impulse", Impulse, "impulse of all contacts", touches().map(|t| t.impulse).sum()),
        ]);
        self.first_contact(solution, first);
        for touch in history.touches.iter().take(MOST_LINES) {
            let values = [(touch.start, Time), (touch.end, Time), (touch.peak_force, Force), (touch.peak_time, Time)];
            let open = if touch.ended { "" } else { ", not ended" };
            solution.lines.push(Line::new(
                "contact",
                format!("{{}} to {{}}{open}, largest force {{}} at {{}}"),
                &values,
            ));
        }
        if let Some(more @ 1..) = history.touches.len().checked_sub(MOST_LINES) {
            solution.lines.push(Line::new("contact", format!("... and {more} more; the result file lists all"), &[]));
        }
        judge(solution, &self.area_of_contact(), [&self.striker.elastic, &self.elastic], largest.approach);
    }

    fn first_contact(&self, solution: &mut Solution, first: &Touch) {
        let figure = |name, dimension, long_name, value| Figure::new(name, dimension, long_name, value);
        let restitution = if first.ended { self.rebound(first.impulse) } else { f64::NAN };
        solution.figures.extend([
            figure("first_contact_force", Force, "largest contact force of the first contact", first.peak_force),
            figure(
                "first_contact_rise",
                Time,
                "time of the largest contact force of the first contact",
                first.peak_time,
            ),
            figure("first_contact_duration", Time, "duration of the first contact", first.duration()),
            figure("first_restitution", Plain, "coefficient of restitution of the first contact", restitution),
        ]);
    }

    /// Returns the frequency and damping of each mode.
    fn modes_table(&self, count: usize) -> Table {
        let columns = vec![
            Column::new("mode", Plain, "number of the mode", ""),
            Column::new("frequency", AngularVelocity, "undamped angular frequency", ""),
            Column::new("damping_number", Rate, "damping number delta", ""),
            Column::new("damping", Plain, "damping ratio", ""),
            Column::new("shape", Plain, "sin(n pi x0/l) at the impact point", ""),
        ];
        let mut table = Table::new("modes", columns);
        for n in 1..=count {
            let [omega, delta] = self.frequency(n);
            table.push(&[n as f64, omega, delta, delta / omega, self.shape(n, self.at)]);
        }
        table
    }

    /// Returns the coefficient of restitution after an impulse: minus the velocity of the striker over its velocity before.
    fn rebound(&self, impulse: f64) -> f64 {
        impulse / (self.striker.mass * self.striker.velocity) - 1.0
    }

    fn extremes(&self, solution: &mut Solution, observer: &Observer) {
        for (gauge, (name, _)) in self.gauges.iter().enumerate() {
            let [w, m, e] = [0, 1, 2].map(|reading| observer.largest(gauge, reading));
            let name_shown = name.replace(['{', '}'], "");
            let text =
                format!("{name_shown}: largest deflection {{}} at {{}}, moment {{}} at {{}}, strain {{}} at {{}}");
            let values = [(w, Length), (m, Torque), (e, Plain)];
            let values = values.map(|(peak, dimension)| [(peak.value, dimension), (peak.time, Time)]).concat();
            solution.lines.push(Line::new("gauge", text, &values));
            let time = |name, long_name, peak: Peak| {
                Figure::new(name, Time, long_name, if peak.value == 0.0 { f64::NAN } else { peak.time })
            };
            let figures = vec![
                Figure::new("peak_deflection", Length, "deflection of largest magnitude", w.value),
                time("time_of_peak_deflection", "time at which the peak deflection is first reached", w),
                Figure::new("peak_moment", Torque, "bending moment of largest magnitude", m.value),
                time("time_of_peak_moment", "time at which the peak moment is first reached", m),
                Figure::new("peak_strain", Plain, "strain of largest magnitude", e.value),
                time("time_of_peak_strain", "time at which the peak strain is first reached", e),
            ];
            solution.gauges.push((name.clone(), figures));
        }
    }

    fn warn(&self, solution: &mut Solution, history: &History, error: Option<f64>) {
        if error.is_some_and(|error| error > self.tolerance) {
            solution.outcome = Solution::NOT_CONVERGED;
            let modes = solution.figure("mode_count").unwrap_or_default();
            let warning = match history.touches.len() {
                0 | 1 => format!("the tolerance is not reached with {modes} modes"),
                contacts => format!(
                    "the tolerance is not reached with {modes} modes: each of the {contacts} contacts magnifies the errors of the one before, and \
                     what comes late in the sequence is one possible course; set `solve.until` to end the run earlier, or `solve.tolerance`"
                ),
            };
            solution.warnings.push(warning);
        }
        if !history.separated && !history.interrupted {
            let open = history.touches.last().is_some_and(|touch| !touch.ended);
            let state = if open { "are still in contact at" } else { "may meet again after" };
            solution.warnings.push(format!("sphere and beam {state} the end time"));
        }
        let [approximate, integrated] =
            ["half_sine_restitution", "first_restitution"].map(|name| solution.figure(name).unwrap_or(f64::NAN));
        let several = if history.touches.len() > 1 { "first " } else { "" };
        if (approximate - integrated).abs() > LARGEST_DIFFERENCE {
            solution.warnings.push(format!(
                "the {several}contact has the coefficient of restitution {integrated:.4} and (9.31) gives {approximate:.4}: \
                 the contact force \
                 is not the half-sine pulse of duration (9.30)"
            ));
        } else if !several.is_empty() {
            solution.warnings.push("several contacts: (9.31) is for the first".into());
        }
        if self.striker.radius > self.section.depth {
            let warning = "the sphere radius exceeds the depth of the beam: the contact law of a half-space holds only for a \
                           small contact";
            solution.warnings.push(warning.into());
        }
    }
}

impl Beam {
    /// Returns the bending strain at which the beam yields; `None` if the yield stress is unknown.
    pub(super) fn yield_strain(&self) -> Option<f64> {
        let axial = (self.foundation.axial / self.section.area).abs();
        Some((self.elastic.yield_stress? - axial) / self.elastic.modulus)
    }

    /// Warns if the largest bending strain exceeds the strain at yield; `None` if the yield stress is unknown.
    fn bends_beyond_yield(&self, strain: f64) -> Option<String> {
        let axial = (self.foundation.axial / self.section.area).abs();
        let ratio = (self.elastic.modulus * strain + axial) / self.elastic.yield_stress?;
        let with =
            if axial > 0.0 { ", with that of the axial force, which is not in the strains at gauges," } else { "" };
        (ratio > 1.0).then(|| {
            format!(
                "the beam yields: its largest stress{with} is {ratio:.2} times the yield stress; the elastic solution \
                 overestimates moment and rebound velocity"
            )
        })
    }
}

/// Deflection over length above which a note states that the slopes are not small. A half sine wave of this height has a slope of 0.31, whose square,
/// which linear bending theory neglects, is 0.1.
const MOST_DEFLECTION: f64 = 0.1;

impl Beam {
    /// Warns if the deflection at the impact is too large for linear bending theory.
    fn bends_far(&self, deflection: f64) -> Option<String> {
        let ratio = deflection / self.length;
        (ratio > MOST_DEFLECTION).then(|| {
            format!("the beam deflects by {ratio:.2} of its length: linear bending theory holds for small slopes only")
        })
    }
}

/// Returns a table with one row per contact.
fn contacts_table(history: &History) -> Table {
    let columns = vec![
        Column::new("start", Time, "start of the contact", ""),
        Column::new("end", Time, "end of the contact", ""),
        Column::new("peak_force", Force, "largest force", ""),
        Column::new("time_of_peak", Time, "time of the largest force", ""),
        Column::new("impulse", Impulse, "impulse of the contact force", ""),
    ];
    let mut table = Table::new("contacts", columns);
    history.touches.iter().for_each(|t| table.push(&[t.start, t.end, t.peak_force, t.peak_time, t.impulse]));
    table
}
