//! Time loop of front tracking: from one output time to the next, in batches of events.

mod checkpoints;

use std::ops::ControlFlow;
use std::time::Instant;

use super::breaks::FailureDetector;
use super::limits::AtLimit;
use super::{Progress, RunRecorder, RunResults, Task, accuracy, companion, flow_both_ways, twisted};
use crate::accuracy::FrontRecorder;
use crate::assemble;
use crate::error::{Error, Result, RunError};
use crate::record::{
    self, Audit, AuditRow, ElasticProbe, EndHistories, EndSummary, ErrorFigure, Extreme, Field, Fragments, Ledger,
    LedgerSummary, Paths, ResidualProfile, SegmentEnd, StepGauges, Summary, Trace, TrackedFronts, TrackingSummary,
    Twisted, View,
};
use crate::scene::Scene;
use crate::simulate::{Interval, Simulation, simulate};
use crate::solver::moc::{FrontSegment, FrontTracking, Piece, Settings, Stopped};

/// Number of events between two calls of the progress function: some milliseconds, and about 200 kB of front segments.
const BURST: u64 = 5_000;

/// Largest relative residual of energy and momentum of a valid run. Rounding errors are 1e-12 to 1e-9 and increase with the number of events.
const CLOSED: f64 = 1e-6;

/// Number of samples of the fields if the scene does not specify it.
const SAMPLES: usize = 1000;

/// Distance from a joint at which its segment is read, relative to the length of the bar.
const BESIDE_JOINT: f64 = 1e-9;

/// Beginning of the reason of a run that reached its limit of events.
pub(super) const OUT_OF_EVENTS: &str = "front tracking reached its limit of";

/// Meaning of a sample of the fields, for the result file.
const SAMPLING: &str = "exact; on a front, the state behind it; at a joint, the state on its right";

/// Converts the stresses at joints to the section on the left of the joint, as on a grid. Joints are read on their right, and are the last of these
/// histories.
fn to_the_left_of_joints(scene: &Scene, histories: &mut [Trace]) {
    let first = histories.len().saturating_sub(super::beside_joints(scene).count());
    for (trace, [left, right]) in histories[first..].iter_mut().zip(super::beside_joints(scene)) {
        let sections = right.end_areas()[0] / left.end_areas()[1];
        trace.stress.iter_mut().for_each(|stress| *stress *= sections);
    }
}

/// Runs a scene by front tracking.
pub(super) fn run(task: Task<'_>, settings: Settings) -> Result<Summary> {
    let checkpoint = task.target.checkpoint.as_ref();
    let mut run = Run::new(task, Settings { front_segments: true, stop_at_limits: true, ..settings })?;
    if let Some(checkpoint) = checkpoint {
        run.resume(checkpoint)?;
    }
    let mut ended = simulate(&mut run, BURST).and_then(|()| run.error_figure());
    if matches!(ended, Err(Error::Interrupted)) {
        ended = run.keep_checkpoint().and(ended);
    }
    run.finish(ended)
}

/// State of a run in progress.
struct Run<'a> {
    recorder: RunRecorder<'a>,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    bar: FrontTracking,
    /// Front segments that have ended since the last look.
    ended: Vec<FrontSegment>,
    settings: Settings,
    /// Times of the pauses, s, the next one last. Pauses do not change the solution.
    pauses: Vec<(f64, Pause)>,
    /// Sampling positions of the fields, m.
    x: Vec<f64>,
    gauges: StepGauges,
    ends: EndHistories,
    /// Recorder for the error estimate.
    response_recorder: FrontRecorder,
    fronts: TrackedFronts,
    paths: Paths,
    ledger: Ledger,
    /// Data of a bar in torsion.
    twisted: Option<Twisted>,
    /// Audit; `None` if it is not used.
    audit: Option<Audit>,
    /// Positions that the audit reads, m.
    watched: Vec<f64>,
    yielded: bool,
    elastic_check: Option<ElasticProbe>,
    breaks: FailureDetector,
}

/// Purpose of a pause between two events.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pause {
    Frame,
    AuditSample,
    ElasticCheck,
    /// Instant of the error estimate.
    Instant,
    End,
}

impl Simulation for Run<'_> {
    type Solver = FrontTracking;
    type Error = Error;

    fn next(&self) -> Option<f64> {
        self.pauses.last().map(|pause| pause.0)
    }

    fn bar(&mut self) -> (&mut FrontTracking, Option<&mut Vec<FrontSegment>>) {
        (&mut self.bar, Some(&mut self.ended))
    }

    fn look(&mut self, interval: Interval) -> Result<()> {
        self.recorder.stepping += interval.seconds;
        self.collect()?;
        let pause = self.pauses.last().map_or(Pause::End, |pause| pause.1);
        // The arrival at these pauses is not reported as progress.
        let news = !matches!(pause, Pause::AuditSample | Pause::Instant) || interval.arrived != Ok(true);
        match interval.arrived {
            Ok(true) => self.arrive()?,
            Ok(false) => {}
            Err(why) => {
                // The answer is ignored because the run ends here; the search for a tolerance that may follow asks again.
                let _ = self.report();
                return Err(self.stopped(&why));
            }
        }
        if news { self.pause() } else { Ok(()) }
    }
}

impl<'a> Run<'a> {
    fn new(task: Task<'a>, settings: Settings) -> Result<Self> {
        let Task { scene, target, started, progress } = task;
        let before = Instant::now();
        let bar = assemble::front_tracking(scene, settings);
        let stepping = before.elapsed().as_secs_f64();
        let samples = if target.takes_frames() { scene.record.cells.unwrap_or(SAMPLES) } else { 0 };
        let x = even_places(scene.bar.length(), samples);
        let mut recorder = RunRecorder::open(scene, target, x.clone(), SAMPLING, started)?;
        recorder.stepping = stepping;
        let places = super::history_places(scene);
        let audit = (!target.unaudited).then(|| Audit::new(&super::case(scene, None)));
        let elastic_check = ElasticProbe::new(&scene.bar, &recorder.initial_fans, scene.solve.until);
        Ok(Self {
            progress,
            ended: Vec::new(),
            pauses: pauses(scene, elastic_check.as_ref(), audit.is_some()),
            gauges: StepGauges::new(&scene.bar, &places, scene.solve.until),
            ends: EndHistories::default(),
            response_recorder: FrontRecorder::new(&scene.bar, scene.record.gauges.len(), &scene.joints()),
            fronts: TrackedFronts::default(),
            paths: Paths::default(),
            ledger: recorder.ledger(&bar),
            watched: audit.as_ref().map_or_else(Vec::new, |audit| audit.places().to_vec()),
            audit,
            yielded: false,
            twisted: twisted(scene, &x),
            elastic_check,
            breaks: FailureDetector::default(),
            recorder,
            bar,
            settings,
            x,
        })
    }

    /// Performs the work of the next pause and removes the pause.
    fn arrive(&mut self) -> Result<()> {
        match self.pauses.pop() {
            Some((time, Pause::Frame)) => self.frame(time)?,
            Some((_, Pause::AuditSample)) => self.look_for_yield(),
            Some((_, Pause::ElasticCheck)) => self.check_elastic(),
            Some((_, Pause::Instant)) => self.response_recorder.read_fields(&self.bar),
            Some((_, Pause::End)) => self.write_ledger()?,
            None => {}
        }
        Ok(())
    }

    /// Collects the front segments since the last call.
    fn collect(&mut self) -> Result<()> {
        let ended = std::mem::take(&mut self.ended);
        self.breaks.look_at(&self.bar, &ended);
        self.fronts.collect(&ended);
        self.gauges.collect(&self.bar, &ended);
        self.write_paths(ended.into_iter())
    }

    fn write_paths(&mut self, front_segments: impl Iterator<Item = FrontSegment>) -> Result<()> {
        if !self.recorder.scene.record.paths || !self.recorder.writer.takes_frames() {
            return Ok(());
        }
        self.recorder.writer.paths(self.paths.rows(front_segments))
    }

    fn frame(&mut self, time: f64) -> Result<()> {
        self.write_traces()?;
        self.write_ledger()?;
        self.breaks.detect_localization(self.recorder.scene, &self.bar);
        if self.recorder.writer.takes_frames() {
            let (fields, twisted) = (&self.recorder.scene.record.fields, self.twisted.as_ref());
            let frame = record::read_frame(&self.bar, fields, &self.x, self.x.len(), twisted);
            self.recorder.writer.frame(record::Frame { time, ..frame })?;
        }
        Ok(())
    }

    fn write_traces(&mut self) -> Result<()> {
        let mut gauges = self.gauges.take();
        self.response_recorder.add_rows(&gauges, self.bar.ruptures());
        to_the_left_of_joints(self.recorder.scene, &mut gauges);
        let ends = self.ends.take(&self.bar);
        self.recorder.write_traces(gauges, ends, self.bar.ruptures())
    }

    fn write_ledger(&mut self) -> Result<()> {
        let row = self.ledger.row(&self.bar);
        self.recorder.writer.ledger(row)
    }

    /// Lets the audit read the bar, unless it is still elastic.
    fn look_for_yield(&mut self) {
        let flowed = |p: Piece<'_>| p.point.plastic != 0.0 || p.point.accumulated != 0.0;
        self.yielded = self.yielded || self.bar.pieces().any(flowed);
        if let Some(audit) = self.audit.as_mut().filter(|_| self.yielded) {
            audit.sample(&self.bar, self.watched.as_slice());
        }
    }

    fn check_elastic(&mut self) {
        if let Some(probe) = &mut self.elastic_check {
            probe.take(self.bar.state_at(probe.x()).stress);
        }
    }

    fn stopped(&mut self, why: &Stopped) -> Error {
        match *why {
            Stopped::AtLimit(point) => return AtLimit::from(&point).error(self.recorder.scene),
            Stopped::EventBudget { time, events, fronts }
                if self.recorder.scene.discretized.as_ref().is_some_and(|cut| cut.has_tapers()) =>
            RunError {
                reason: format!("{OUT_OF_EVENTS} {events} events with {fronts} active fronts"),
                time,
                x: None,
                help: "each step of the discretized taper splits every front: use method = \"fd\", which resolves the taper \
                       directly, or increase front-tolerance for fewer steps, or increase max-events"
                    .into(),
            },
            Stopped::EventBudget { time, events, fronts } => {
                // With a tolerance, the caller tries other methods instead.
                let alone = self.recorder.scene.solve.tolerance.is_none();
                let carries = || companion::tolerance_that_carries(self.recorder.scene, self.settings, self.progress);
                let help = match alone.then(carries).unwrap_or(Ok(None)) {
                    Err(interrupted) => return interrupted,
                    Ok(None) => format!(
                        "the run does not complete with any front-tolerance up to {}: use method = \"fd\", or increase \
                         max-events in [solve]",
                        companion::LARGEST_TRIED
                    ),
                    Ok(Some(tolerance)) => format!(
                        "set front-tolerance = {tolerance:.1e} in [solve], with which the run completes (tested), or increase \
                         max-events"
                    ),
                };
                RunError {
                    reason: format!("{OUT_OF_EVENTS} {events} events with {fronts} active fronts"),
                    time,
                    x: None,
                    help,
                }
            }
            Stopped::NotANumber { time, x } => RunError {
                reason: "a stress or velocity is not a finite number".into(),
                time,
                x: Some(x),
                help: "check the scene for values far outside the material's range; the frames so far are valid".into(),
            },
        }
        .into()
    }

    /// Passes the results to the recorder, which closes the file after any outcome.
    fn finish(mut self, ended: Result<Option<ErrorFigure>>) -> Result<Summary> {
        let (ended, error) = match ended {
            Ok(error) => (self.ledger_closes(), error),
            Err(why) => (Err(why), None),
        };
        self.breaks.detect_localization(self.recorder.scene, &self.bar);
        let last = self.bar.take_front_segments();
        let living: Vec<FrontSegment> = self.bar.living_front_segments().collect();
        self.breaks.look_at(&self.bar, &living);
        self.gauges.close(&self.bar, &last);
        self.write_traces()?;
        self.recorder.write_traces(Vec::new(), EndHistories::last(&self.bar), self.bar.ruptures())?;
        self.write_paths(last.into_iter().chain(living))?;
        let results = RunResults {
            cells: 0,
            steps: self.bar.events() as usize,
            events: self.bar.events(),
            tracking: Some(TrackingSummary {
                front_tolerance: self.settings.front_tolerance,
                stress_scale: self.bar.stress_scale(),
                fronts_under_way: self.bar.front_count(),
                events_per_s: 0.0,
            }),
            end_time: self.bar.time(),
            ends: self.end_states(),
            fronts: self.recorder.named(self.fronts.rows(
                &self.bar,
                &self.recorder.initial_fans,
                &self.recorder.scene.record.gauges,
            )),
            audit: self.audit(),
            elastic: self.breaks.stayed_elastic(&self.bar),
            elastic_check: self.elastic_check.as_ref().and_then(ElasticProbe::check),
            ledger: LedgerSummary {
                energy_residual: self.ledger.worst_energy(),
                momentum_residual: self.ledger.worst_momentum(),
            },
            error,
            ruptured: self.breaks.ruptured(self.recorder.scene, &self.bar),
            ruptures: self.recorder.ruptures(&self.bar),
            temperature_rise: self.temperature_rise(),
            segments: self.segments(),
            fragments: self.fragments(),
            residual_profile: self.residual_profile(),
            account: self.bar.account(),
            contacts: View::contacts(&self.bar),
            paths_complete: self.paths.complete(),
        };
        self.recorder.close(ended, results)
    }

    /// Checks that the residuals of energy and momentum do not exceed rounding errors.
    ///
    /// # # Errors
    /// A [`RunError`] if they do: the result is invalid.
    fn ledger_closes(&self) -> Result<()> {
        let [energy, momentum] = [self.ledger.worst_energy(), self.ledger.worst_momentum()];
        if energy <= CLOSED && momentum <= CLOSED {
            return Ok(());
        }
        Err(RunError {
            reason: format!(
                "energy or momentum is not conserved: energy residual {energy:.1e}, momentum residual {momentum:.1e}"
            ),
            time: self.bar.time(),
            x: None,
            help: "use method = \"fd\" for this scene, and please report this case: front tracking conserves both to rounding \
                   error"
                .into(),
        }
        .into())
    }

    /// Returns the error estimate of the run; `None` if it is unknown.
    fn error_figure(&mut self) -> Result<Option<ErrorFigure>> {
        self.write_traces()?;
        let response = self.response_recorder.clone().response(&self.bar);
        let similar = || accuracy::similar(self.recorder.scene, &self.recorder.initial_fans, &response);
        match self.bar.ruptures().is_empty().then(similar).flatten() {
            Some(exact) => Ok(Some(accuracy::figure(response.errors(&exact), accuracy::SIMILAR.into()))),
            None => companion::error_figure(self.recorder.scene, self.settings, &self.bar, &response, self.progress),
        }
    }

    fn temperature_rise(&self) -> Option<f64> {
        let segments = self.recorder.scene.bar.segments.iter().enumerate();
        let rises = segments.filter_map(|(k, segment)| {
            let pieces = self.bar.pieces().filter(|p| p.segment == k);
            record::largest_rise(&segment.material, pieces.map(|p| (self.bar.temperature(k, p.point), 0.0)))
        });
        rises.reduce(f64::max)
    }

    fn residual_profile(&self) -> ResidualProfile {
        let mut profile = ResidualProfile::new(self.recorder.scene.bar.length());
        for piece in self.bar.pieces() {
            profile.add([piece.from, piece.to], self.bar.medium(piece.segment).plastic_strain(piece.point));
        }
        profile
    }

    /// Returns the state of the segments at the current time. The elongation includes strain that has gathered at a point of a level curve, but not
    /// the opening of a joint or of a fracture.
    fn segments(&self) -> Vec<SegmentEnd> {
        let segments = &self.recorder.scene.bar.segments;
        let inside = BESIDE_JOINT * self.recorder.scene.bar.length();
        let (mut of, mut places, mut end) = (Vec::new(), Vec::with_capacity(2 * segments.len()), 0.0);
        for (k, segment) in segments.iter().enumerate() {
            let start = end;
            end += segment.length;
            let broken = self.bar.ruptures().iter().map(|rupture| rupture.x);
            let mut broken: Vec<f64> = broken.filter(|&x| start + inside < x && x < end - inside).collect();
            broken.sort_by(f64::total_cmp);
            places.push(if k == 0 { start } else { start + inside });
            places.extend(broken.iter().flat_map(|x| [x - inside, x + inside]));
            places.push(if k + 1 == segments.len() { end } else { end - inside });
            of.extend(std::iter::repeat_n(k, broken.len() + 1));
        }
        let mut displacements = vec![0.0; places.len()];
        self.bar.displacements(&places, &mut displacements);
        let mut segments = vec![SegmentEnd::default(); segments.len()];
        for (k, ends) in of.into_iter().zip(displacements.chunks_exact(2)) {
            let elongation = ends[1] - ends[0];
            segments[k].add(&SegmentEnd { elongation, plastic_elongation: elongation, ..SegmentEnd::default() });
        }
        for piece in self.bar.pieces() {
            let (medium, point, length) = (self.bar.medium(piece.segment), piece.point, piece.to - piece.from);
            let mass = self.bar.mass_of(&piece);
            segments[piece.segment].add(&SegmentEnd {
                mass,
                elongation: 0.0,
                plastic_elongation: -point.stress / medium.modulus * length,
                momentum: mass * point.velocity,
                residual: Extreme { value: medium.plastic_strain(point), at: 0.5 * (piece.from + piece.to) },
                // Without the hardening effect no plastic strain is accumulated: flow follows the curve in both directions.
                accumulated: (point.accumulated / medium.modulus).max(medium.plastic_strain(point).abs()),
            });
        }
        segments
    }

    /// Returns the fragments of a fractured bar at the current time.
    fn fragments(&self) -> Fragments {
        let mut fragments = Fragments::new(self.recorder.scene.bar.length(), self.bar.ruptures());
        for piece in self.bar.pieces() {
            fragments.add(0.5 * (piece.from + piece.to), self.bar.mass_of(&piece), piece.point.velocity);
        }
        fragments
    }

    fn audit(&self) -> Vec<AuditRow> {
        let Some(audit) = &self.audit else { return Vec::new() };
        let parted = !self.bar.ruptures().is_empty();
        let mut broken = self.recorder.audit(parted);
        if !parted {
            broken.extend(self.breaks.audit(self.recorder.scene, &self.bar, self.recorder.above_critical()));
        }
        let segments = &self.recorder.scene.bar.segments;
        let mut rows = audit.rows(broken);
        for (k, segment) in segments.iter().enumerate() {
            let modulus = self.bar.medium(k).modulus;
            let pieces = self.bar.pieces().filter(|p| p.segment == k);
            let plastic = pieces.map(|p| (p.point.accumulated / modulus, p.point.plastic / modulus));
            rows.extend(flow_both_ways(self.recorder.scene, segment, plastic));
        }
        rows
    }

    /// Returns stress, velocity and strain at the ends.
    fn end_states(&self) -> [EndSummary; 2] {
        let mut strains = [0.0; 2];
        self.bar.sample(Field::Strain, &[0.0, self.recorder.scene.bar.length()], &mut strains);
        let (ends, strikers) = (View::ends(&self.bar), self.bar.strikers());
        std::array::from_fn(|k| EndSummary {
            stress: ends[k].stress,
            strain: strains[k],
            velocity: ends[k].velocity,
            striker: strikers[k],
        })
    }
}

/// Returns the times of the pauses, s, the last one first.
fn pauses(scene: &Scene, elastic_check: Option<&ElasticProbe>, audited: bool) -> Vec<(f64, Pause)> {
    let until = scene.solve.until;
    let mut pauses: Vec<(f64, Pause)> = scene.record.times.iter().map(|&time| (time, Pause::Frame)).collect();
    let look = |k: usize| (until * k as f64 / record::AUDIT_SAMPLES as f64, Pause::AuditSample);
    pauses.extend((1..=record::AUDIT_SAMPLES).filter(|_| audited).map(look));
    pauses.extend(companion::instants(until).into_iter().map(|time| (time, Pause::Instant)));
    pauses.extend(elastic_check.map(|probe| (probe.time(), Pause::ElasticCheck)));
    if scene.record.times.last() != Some(&until) {
        pauses.push((until, Pause::End));
    }
    pauses.sort_by(|a, b| a.0.total_cmp(&b.0));
    pauses.reverse();
    pauses
}

/// Returns the centres of `count` equal parts of the bar, m.
fn even_places(length: f64, count: usize) -> Vec<f64> {
    let part = length / count as f64;
    (0..count).map(|i| (i as f64 + 0.5) * part).collect()
}
