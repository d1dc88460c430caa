//! Time loop of a bar on a grid, step by step.

mod checkpoints;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::accuracy;
use super::limits::AtLimit;
use super::{Progress, RunRecorder, RunResults, Task, flow_both_ways, twisted};
use crate::accuracy::GridRecorder;
use crate::assemble;
use crate::bar::Segment;
use crate::error::{Error, Result, RunError};
use crate::law::rupture::{Rupture, Site};
use crate::record::{
    self, Audit, AuditRow, ElasticProbe, EndState, EndSummary, ErrorFigure, Extreme, Fragments, Frames, FrontTracker,
    JointRows, Ledger, LedgerSummary, ResidualProfile, SegmentEnd, Stepped, Summary, Traces,
};
use crate::scene::{Method, Rate};
use crate::simulate::{Interval, Simulation, simulate};
use crate::snapshot::Snapshot;
use crate::solver::fd::{Quantity, Sampling, SegmentGrid};

/// Largest fraction of the total energy that a method may add to the bar. Second-order schemes add up to a tenth in bars of a few cells whose ends
/// change their direction of motion within a few steps.
const MOST_GIVEN: f64 = 0.2;

/// Work between two calls of the progress function, cell-steps: a few milliseconds.
const WORK_BETWEEN_CALLS: usize = 4_000_000;

/// Longest wall time between two calls of the progress function while frames are recorded.
const BETWEEN_CALLS: Duration = Duration::from_millis(20);

/// Number of frames recorded between two readings of the clock.
const FRAMES_AT_ONCE: usize = 32;

/// Number of observations of every front during a run: sufficient for a speed to four digits, at a small fraction of the cost of the steps.
const FRONT_SIGHTINGS: usize = 256;

/// Number of cells between an end and the cell whose strain represents it in the summary. Cells closer to a suddenly moved end retain too much
/// plastic strain from the start: 12 % in the first and 0.5 % in the third cell of a bilinear bar.
const CELLS_FROM_END: usize = 4;

/// Largest number of steps after which a run detects that it has to stop at a limit of the material data. The solver records the step itself; the
/// results of later steps are discarded.
const STEPS_BETWEEN_LIMIT_CHECKS: usize = 32;

/// Work limit of an interval that ends only at the next look.
const UP_TO_THE_LOOK: u64 = u64::MAX;

/// Runs a scene on the grid of `bar`.
pub(super) fn run(task: Task<'_>, bar: impl Stepped + Snapshot) -> Result<Summary> {
    let checkpoint = task.target.checkpoint.as_ref();
    let mut run = Run::new(task, bar)?;
    if let Some(checkpoint) = checkpoint {
        run.resume(checkpoint)?;
    }
    let mut ended = run.start().and_then(|()| simulate(&mut run, UP_TO_THE_LOOK)).and_then(|()| run.error());
    if matches!(ended, Err(Error::Interrupted)) {
        ended = run.keep_checkpoint().and(ended);
    }
    run.finish(ended)
}

/// State of a run in progress.
struct Run<'a, S> {
    recorder: RunRecorder<'a>,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    bar: S,
    steps: usize,
    frames: Frames,
    traces: Traces,
    joints: JointRows,
    ledger: Ledger,
    tracker: FrontTracker,
    audit: Audit,
    /// Positions that the audit reads.
    watched: Sampling,
    /// Points at which the bar reached a limit of the material data, in order of time.
    limits: Vec<AtLimit>,
    /// Time of the limit that stopped the run, s.
    stopped_at: Option<f64>,
    /// Centres of the cells, m.
    centres: Vec<f64>,
    elastic_check: Option<Probe>,
    /// Recorder for the error estimate, if requested.
    response_recorder: Option<GridRecorder>,
    /// Time of the last call of the progress function.
    latest_call: Instant,
    /// Whether the run was resumed from a checkpoint.
    resumed: bool,
}

/// Elastic check with its step and cell.
struct Probe {
    check: ElasticProbe,
    step: usize,
    cell: usize,
}

impl<S: Stepped + Snapshot> Simulation for Run<'_, S> {
    type Solver = S;
    type Error = Error;

    fn next(&self) -> Option<usize> {
        (self.bar.step() < self.steps).then(|| self.next_look())
    }

    fn bar(&mut self) -> (&mut S, Option<&mut Traces>) {
        (&mut self.bar, Some(&mut self.traces))
    }

    fn look(&mut self, interval: Interval) -> Result<()> {
        self.recorder.stepping += interval.seconds;
        self.check_limits()?;
        self.record()?;
        self.take_frames()?;
        if self.bar.step().is_multiple_of(self.between_pauses()) || self.bar.step() == self.steps {
            self.check_finite()?;
            self.pause()?;
        }
        Ok(())
    }
}

impl<'a, S: Stepped + Snapshot> Run<'a, S> {
    fn new(task: Task<'a>, mut bar: S) -> Result<Self> {
        let Task { scene, target, started, progress } = task;
        let sampling = match scene.record.cells {
            Some(count) => Sampling::even(&scene.bar, bar.grid(), count),
            None => Sampling::cells(bar.grid()),
        };
        let twisted = twisted(scene, sampling.x());
        let frames = Frames::new(scene.record.times.clone(), scene.record.fields.clone(), sampling).twisted(twisted);
        let joints = JointRows::new(&scene.bar, bar.grid(), &scene.joints());
        let places = scene.record.gauge_places().into_iter().chain(joints.places()).collect();
        let mut recorder = RunRecorder::open(scene, target, frames.x().to_vec(), "", started)?;
        let sudden = bar.sudden_loads();
        let loaded = sudden.joints.iter().filter_map(|&(k, load, force)| {
            let Site::Joint(joint) = scene.original_site(Site::Joint(k)) else { return None };
            Some((joint, load, force / scene.bar.segments[k].end_areas()[1]))
        });
        recorder.tally.start_under(loaded);
        let tracker = FrontTracker::new(&scene.bar, bar.grid(), &recorder.initial_fans, [&scene.left, &scene.right]);
        // sigma = rho c0 v holds only without distributed forces.
        let plain = assemble::distributed_forces(&scene.bar, &scene.effects).is_none();
        let probe = ElasticProbe::new(&scene.bar, &recorder.initial_fans, scene.solve.until).filter(|_| plain);
        let audit = Audit::new(&super::case(scene, Some(bar.grid().cells())));
        let traces = Traces::new(Sampling::at(bar.grid(), places), scene.effects.heat.is_some(), sudden.ends);
        bar.watch(&traces);
        let steps = bar.grid().steps_to(scene.solve.until);
        let response_recorder = scene.solve.estimate_error.then(|| {
            let instants = accuracy::common_instants(steps, bar.grid().dt);
            GridRecorder::new(&scene.bar, &bar, &instants, scene.record.gauges.len(), &scene.joints())
        });
        Ok(Self {
            progress,
            steps,
            traces,
            joints,
            ledger: recorder.ledger(&bar),
            watched: Sampling::at(bar.grid(), audit.places().to_vec()),
            audit,
            elastic_check: probe.map(|probe| {
                let (step, cell) = probe.on_grid(bar.grid());
                Probe { check: probe, step, cell }
            }),
            limits: Vec::new(),
            stopped_at: None,
            centres: bar.grid().centres(),
            response_recorder,
            latest_call: Instant::now(),
            resumed: false,
            recorder,
            bar,
            frames,
            tracker,
        })
    }

    /// Records the initial state, or repeats the checks of a resumed run, before the first step.
    fn start(&mut self) -> Result<()> {
        if self.resumed {
            if self.bar.step().is_multiple_of(self.between_pauses()) || self.bar.step() == self.steps {
                self.check_finite()?;
            }
            self.check_limits()?;
        } else {
            self.bar.add_to(&mut self.traces);
            self.record()?;
        }
        self.take_frames()?;
        self.stop_at(if self.resumed { None } else { AtLimit::at_start(self.recorder.scene) })
    }

    /// Returns the number of steps between two pauses. Pauses are at multiples of this number, so that a resumed run performs its checks at the same
    /// steps.
    fn between_pauses(&self) -> usize {
        (WORK_BETWEEN_CALLS / self.bar.grid().cells()).max(1)
    }

    /// Records all frames that are due, with pauses: one step can contain millions of frames.
    fn take_frames(&mut self) -> Result<()> {
        loop {
            let keep = |frame| self.recorder.writer.frame(frame);
            let more = self.frames.take(&self.bar, FRAMES_AT_ONCE, keep)?;
            if self.latest_call.elapsed() > BETWEEN_CALLS {
                self.pause()?;
            }
            if !more {
                return Ok(());
            }
        }
    }

    /// Returns the next step after which the bar is read; the quantities needed at every step are logged by the solver.
    fn next_look(&self) -> usize {
        let step = self.bar.step();
        let multiple_of = |every: usize| (step / every + 1) * every;
        let mut next = self.frames.next_step(step, self.bar.grid().dt).min(self.steps);
        for looks in [FRONT_SIGHTINGS, record::AUDIT_SAMPLES] {
            next = next.min(multiple_of((self.steps / looks).max(1)));
        }
        if !self.bar.stayed_elastic() {
            next = next.min(multiple_of(STEPS_BETWEEN_LIMIT_CHECKS));
        }
        next = next.min(multiple_of(self.between_pauses()));
        let probe = self.elastic_check.as_ref().map(|probe| probe.step);
        let instant = self.response_recorder.as_ref().and_then(|response_recorder| response_recorder.next(step));
        [probe, instant].into_iter().flatten().filter(|&at| at > step).fold(next, usize::min)
    }

    /// Records everything except frames, after a step and once at the start.
    fn record(&mut self) -> Result<()> {
        let step = self.bar.step();
        if let Some(response_recorder) = &mut self.response_recorder {
            response_recorder.read_fields(&self.bar);
        }
        if self.traces.is_full() {
            self.write_traces()?;
        }
        let last = step == self.steps;
        let look = last || step.is_multiple_of((self.steps / record::AUDIT_SAMPLES).max(1));
        let yielded = look && !self.bar.stayed_elastic();
        if self.frames.is_due(&self.bar) || last {
            let row = self.ledger.row(&self.bar);
            self.recorder.writer.ledger(row)?;
        } else if yielded {
            // The residual and the energy added by the method are those of the whole run, even if it has few frames.
            self.ledger.row(&self.bar);
        }
        if last || step.is_multiple_of((self.steps / FRONT_SIGHTINGS).max(1)) {
            self.tracker.observe(&self.bar);
        }
        if yielded {
            self.audit.sample(&self.bar, &self.watched);
        }
        if let Some(Probe { check, cell, .. }) = self.elastic_check.as_mut().filter(|p| p.step == step) {
            check.take(self.bar.value(Quantity::Stress, *cell));
        }
        Ok(())
    }

    fn write_traces(&mut self) -> Result<()> {
        let (mut gauges, ends) = self.traces.take();
        self.joints.join(&mut gauges);
        if let Some(response_recorder) = &mut self.response_recorder {
            response_recorder.add_rows(&gauges, &ends, self.bar.ruptures());
        }
        self.recorder.write_traces(gauges, ends, self.bar.ruptures())
    }

    /// Stops the run at a limit of the material data, before states beyond the limit are recorded.
    fn check_limits(&mut self) -> Result<()> {
        let (scene, dt) = (self.recorder.scene, self.bar.grid().dt);
        let due = self.bar.limits_reached();
        self.limits.clear();
        self.limits.extend(due.in_order().map(|passed| AtLimit::on_grid(&passed, &self.centres, dt)));
        self.stop_at(self.limits.iter().copied().find(|limit| limit.stops(scene)))
    }

    /// Stops the run at this limit if the material has no data beyond it.
    fn stop_at(&mut self, limit: Option<AtLimit>) -> Result<()> {
        let scene = self.recorder.scene;
        let Some(stop) = limit.filter(|limit| limit.stops(scene)) else { return Ok(()) };
        self.traces.drop_from(stop.time);
        self.stopped_at = Some(stop.time);
        Err(stop.error(scene))
    }

    fn check_finite(&self) -> Result<()> {
        match self.bar.not_finite() {
            None => Ok(()),
            Some(cell) => Err(self.stopped(
                cell,
                format!("the stress is not a finite number (step {})", self.bar.step()),
                "check the scene for values far outside the material's range; the frames before this one are valid",
            )),
        }
    }

    fn stopped(&self, cell: usize, reason: String, help: &str) -> Error {
        let x = Some(self.centres[cell]);
        RunError { reason, time: self.bar.time(), x, help: help.to_owned() }.into()
    }

    /// Checks that the method has not added more energy to the bar than the errors of a coarse grid explain.
    ///
    /// # # Errors
    /// A [`RunError`] if it has: the result is invalid.
    fn check_energy_added(&self) -> Result<()> {
        let given = self.ledger.largest_energy_gain();
        if given <= MOST_GIVEN {
            return Ok(());
        }
        Err(RunError {
            reason: format!("the numerical method added energy to the bar: {:.0} % of the total", 100.0 * given),
            time: self.bar.time(),
            x: None,
            help: match self.recorder.scene.solve.method {
                Method::Leapfrog { .. } => "use more cells, or method = \"moc\"",
                _ => {
                    "this scheme cannot simulate a level or falling part of the curve; use scheme = \"leapfrog\" or method = \
                     \"moc\""
                }
            }
            .to_owned(),
        }
        .into())
    }

    /// Passes the results to the recorder, which closes the file after any outcome.
    fn finish(mut self, ended: Result<Option<ErrorFigure>>) -> Result<Summary> {
        let (ended, error) = match ended {
            Ok(error) => (self.check_energy_added(), error),
            Err(why) => (Err(why), None),
        };
        self.traces.close();
        self.write_traces()?;
        let (segments, fragments) = self.parts();
        let results = RunResults {
            cells: self.bar.grid().cells(),
            steps: self.bar.step(),
            events: 0,
            tracking: None,
            end_time: self.stopped_at.unwrap_or_else(|| self.bar.time()),
            ends: self.ends(),
            fronts: self.recorder.named(self.tracker.rows(&self.recorder.scene.record.gauges)),
            audit: self.audit(),
            elastic: self.bar.stayed_elastic(),
            elastic_check: self.elastic_check.as_ref().and_then(|p| p.check.check()),
            ledger: LedgerSummary {
                energy_residual: self.ledger.worst_energy(),
                momentum_residual: self.ledger.worst_momentum(),
            },
            error,
            ruptured: self.limits.iter().any(|limit| limit.broken(self.recorder.scene).is_some()),
            ruptures: self.recorder.ruptures(&self.bar),
            temperature_rise: self.temperature_rise(),
            segments,
            fragments,
            residual_profile: self.residual_profile(),
            account: self.bar.account(),
            contacts: self.bar.contacts(),
            paths_complete: false,
        };
        self.recorder.close(ended, results)
    }

    /// Returns the error of the run: relative to the self-similar solution, which exists without rate dependence, distributed forces and fracture;
    /// otherwise, if an error estimate was requested, from coarser runs. `None` if neither is available.
    ///
    /// # # Errors
    /// [`Error::Interrupted`] if `progress` requests a stop: the run is complete, but its error estimate is not.
    fn error(&mut self) -> Result<Option<ErrorFigure>> {
        self.traces.close();
        self.write_traces()?;
        let scene = self.recorder.scene;
        let plain = scene.effects.rate.is_none() && assemble::distributed_forces(&scene.bar, &scene.effects).is_none();
        let known = plain && self.bar.ruptures().is_empty();
        let Some(response_recorder) = &self.response_recorder else {
            let similar = || record::against_similarity(&scene.bar, &self.bar, &self.recorder.initial_fans);
            return Ok(known.then(similar).flatten());
        };
        let response = response_recorder.response();
        let exact = || accuracy::similar(scene, &self.recorder.initial_fans, &response);
        match known.then(exact).flatten() {
            Some(exact) => Ok(Some(accuracy::figure(response.errors(&exact), accuracy::SIMILAR.into()))),
            None => accuracy::error_figure(scene, &response, self.bar.stayed_elastic(), self.progress),
        }
    }

    fn temperature_rise(&self) -> Option<f64> {
        let segments = self.recorder.scene.bar.segments.iter().zip(&self.bar.grid().segments);
        let rises = segments.filter_map(|(segment, part)| {
            let temperature = |cell: usize| {
                let [from, to] = part.cell(cell);
                let at_start = segment.initial_between(from, to).temperature_rise;
                (self.bar.value(Quantity::Temperature, cell), at_start)
            };
            record::largest_rise(&segment.material, part.cells.clone().map(temperature))
        });
        rises.reduce(f64::max)
    }

    fn residual_profile(&self) -> ResidualProfile {
        let mut profile = ResidualProfile::new(self.recorder.scene.bar.length());
        for part in &self.bar.grid().segments {
            for cell in part.cells.clone() {
                let sides = [-0.5, 0.5].map(|half| self.centres[cell] + half * part.spacing);
                profile.add(sides, self.bar.value(Quantity::PlasticStrain, cell));
            }
        }
        profile
    }

    /// Returns the state of the segments and the fragments of a fractured bar at the current time. Passes over all cells.
    fn parts(&self) -> (Vec<SegmentEnd>, Fragments) {
        let bar = &self.recorder.scene.bar;
        let mut fragments = Fragments::new(bar.length(), self.bar.ruptures());
        let profile = |quantity| {
            let mut values = vec![0.0; self.centres.len()];
            self.bar.profile(quantity, &mut values);
            values
        };
        let plastic = [Quantity::PlasticStrain, Quantity::AccumulatedPlasticStrain].map(profile);
        let [strain, velocity] = [Quantity::Strain, Quantity::Velocity].map(profile);
        let segment = |(segment, part): (&Segment, &SegmentGrid)| {
            let mut end = SegmentEnd::default();
            for cell in part.cells.clone() {
                let [from, to] = part.cell(cell);
                let mass = segment.material.density * segment.mean_area(from, to) * part.dx;
                fragments.add(self.centres[cell], mass, velocity[cell]);
                end.add(&SegmentEnd {
                    elongation: part.dx * strain[cell],
                    plastic_elongation: part.dx * plastic[0][cell],
                    mass,
                    momentum: mass * velocity[cell],
                    residual: Extreme { value: plastic[0][cell], at: self.centres[cell] },
                    // Without the hardening effect no plastic strain is accumulated: flow follows the curve in both directions.
                    accumulated: plastic[1][cell].max(plastic[0][cell].abs()),
                });
            }
            end
        };
        let segments = bar.segments.iter().zip(&self.bar.grid().segments).map(segment).collect();
        (segments, fragments)
    }

    fn audit(&self) -> Vec<AuditRow> {
        let (grid, segments) = (self.bar.grid(), &self.recorder.scene.bar.segments);
        let parted = !self.bar.ruptures().is_empty();
        let mut broken = self.recorder.audit(parted);
        if !parted {
            broken.extend(self.limits.iter().filter_map(|limit| limit.broken(self.recorder.scene)));
        }
        broken.extend(self.bar.unresolved_tension().as_ref().map(record::short_tension));
        let modulus = |rupture: &Rupture| segments[rupture.segment].material.modulus;
        let first = self.bar.ruptures().first();
        broken.extend(first.and_then(|rupture| record::late_fracture(rupture, modulus(rupture))));
        let mut rows = self.audit.rows(broken);
        if let Some(Rate::Malvern { k }) = self.recorder.scene.effects.rate {
            rows.extend(record::unresolved_flow(k, grid.dt));
        }
        let strain = |cell: usize| self.bar.value(Quantity::AccumulatedPlasticStrain, cell);
        for (segment, part) in segments.iter().zip(&grid.segments) {
            let plastic = |cell| (strain(cell), self.bar.value(Quantity::PlasticStrain, cell));
            rows.extend(flow_both_ways(self.recorder.scene, segment, part.cells.clone().map(plastic)));
        }
        rows
    }

    fn ends(&self) -> [EndSummary; 2] {
        let cells = self.bar.grid().cells();
        let inside = CELLS_FROM_END.min((cells - 1) / 2);
        let end = |end: EndState, striker: Option<f64>, cell: usize| EndSummary {
            stress: end.stress,
            strain: self.bar.value(Quantity::Strain, cell),
            velocity: end.velocity,
            striker,
        };
        let ([left, right], [left_striker, right_striker]) = (self.bar.ends(), self.bar.strikers());
        [end(left, left_striker, inside), end(right, right_striker, cells - 1 - inside)]
    }
}
