//! The time loop: steps the bar of a scene, and hands what it sees to the recorders and the result file.

use std::path::Path;
use std::time::Instant;

use crate::assemble;
use crate::bar::{Launch, launches};
use crate::error::{Error, Result, RunError};
use crate::material::{Beyond, Material, Sense};
use crate::record::store::{Finish, Header, Layout, Side, Writer};
use crate::record::{
    self, AuditRow, ElasticProbe, EndSummary, ErrorFigure, Frames, FrontSummary, FrontTracker, Ledger, LedgerSummary,
    MaterialRecord, Summary, Traces, UnloadingWatch,
};
use crate::scene::{Effects, Method, Scene, Unloading};
use crate::solver::fd::{Device, Leapfrog, Passed, Quantity, Sampling};
use crate::wave::similarity;

/// How far a run is.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Steps taken.
    pub step: usize,
    /// Steps to take.
    pub steps: usize,
    /// Cells of the bar.
    pub cells: usize,
}

/// What the caller wants of a run that is under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// Go on.
    GoOn,
    /// Finish the step, close the file, and return [`Error::Interrupted`].
    Stop,
}

/// Work between two calls of the progress function, cell-steps: a few milliseconds.
const WORK_BETWEEN_CALLS: usize = 4_000_000;

/// Sightings of every front over a run: enough for a speed to four digits and cheap beside the stepping.
const FRONT_SIGHTINGS: usize = 256;

/// Cells between an end and the one whose strain stands for it in the summary: those nearer to a suddenly moved end keep
/// too much plastic strain from the start, by 12 % in the first and 0.5 % in the third of a bilinear bar.
const CELLS_FROM_END: usize = 4;

/// Steps between two looks for cells past the end of their data, each a pass over the yielded cells: the time that is
/// reported for it is late by no more than the time a wave takes across as many cells.
const STEPS_BETWEEN_DATA_CHECKS: usize = 16;

/// Looks at the bar for neglected unloading over a run, each a pass over all cells.
const UNLOADING_LOOKS: usize = 100;

/// Simulates a scene and writes its result file, where one is asked for. `progress` is called every few
/// milliseconds.
///
/// # Errors
/// A [`RunError`] where the run cannot go on, [`Error::Interrupted`] where `progress` asked to stop, a file error
/// where the result cannot be written. In the first two cases the result file holds everything up to then.
pub fn run(scene: &Scene, output: Option<&Path>, progress: &mut dyn FnMut(Progress) -> Wish) -> Result<Summary> {
    let started = Instant::now();
    let mut run = Run::new(scene, output)?;
    let ended = run.step_to_end(progress);
    run.finish(ended, started)
}

/// Effects of a scene by name, as they are written to files and summaries.
pub fn effect_names(effects: &Effects, plasticity: bool) -> Vec<String> {
    let mut names = Vec::new();
    if plasticity {
        names.push("plasticity".to_owned());
    }
    match effects.unloading {
        Some(Unloading::Isotropic) => names.push("unloading: isotropic".to_owned()),
        Some(Unloading::Kinematic) => names.push("unloading: kinematic".to_owned()),
        Some(Unloading::Mixed(fraction)) => names.push(format!("unloading: mixed {fraction}")),
        None => {}
    }
    names
}

/// The critical velocity that goes with a bar's loading: of the struck material in the sense in which it is struck.
pub fn critical_velocity(scene: &Scene, launches: &[Launch]) -> Option<f64> {
    let (segment, sense) = launches.first().map_or((0, Sense::Tension), |l| (l.segment, l.sense));
    let material = &scene.bar.segments[segment].material;
    similarity::critical(material.branch(sense), material.density).map(|c| c.velocity)
}

/// Steps of a run: the first that reaches the end time.
pub fn steps(scene: &Scene, dt: f64) -> usize {
    // Rounding in until/dt must not cost a whole extra step.
    ((scene.solve.until / dt - 1e-9).ceil() as usize).max(1)
}

/// A run under way.
struct Run<'a> {
    scene: &'a Scene,
    bar: Leapfrog,
    steps: usize,
    launches: Vec<Launch>,
    critical: Option<f64>,
    frames: Frames,
    traces: Traces,
    ledger: Ledger,
    tracker: FrontTracker,
    unloading: Option<UnloadingWatch>,
    passed: Option<(Passed, f64)>,
    elastic_check: Option<ElasticProbe>,
    writer: Option<Writer>,
    output: String,
    stepping: f64,
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene, output: Option<&Path>) -> Result<Self> {
        let bar = assemble::leapfrog(scene);
        let launches = launches(&scene.bar, &scene.left, &scene.right);
        let critical = critical_velocity(scene, &launches);
        let sampling = match scene.record.cells {
            Some(count) => Sampling::even(&scene.bar, bar.grid(), count),
            None => Sampling::cells(bar.grid()),
        };
        let frames = Frames::new(scene.record.times.clone(), scene.record.fields.clone(), sampling);
        let places = scene.record.gauges.iter().map(|g| g.1).collect();
        let writer = output.map(|path| create_file(scene, path, &frames, critical)).transpose()?;
        let yield_strain = |m: &Material| m.tension.elastic_limit(m.modulus).0;
        let yield_strains: Vec<f64> = scene.bar.segments.iter().map(|s| yield_strain(&s.material)).collect();
        let tracker = FrontTracker::new(&scene.bar, bar.grid(), &launches, [&scene.left, &scene.right]);
        Ok(Self {
            steps: steps(scene, bar.grid().dt),
            traces: Traces::new(Sampling::at(bar.grid(), places)),
            ledger: Ledger::new(&bar),
            unloading: scene.effects.unloading.is_none().then(|| UnloadingWatch::new(&bar, &yield_strains)),
            elastic_check: ElasticProbe::new(&scene.bar, &bar, &launches, scene.solve.until),
            output: output.map(|p| p.display().to_string()).unwrap_or_default(),
            passed: None,
            stepping: 0.0,
            scene,
            bar,
            launches,
            critical,
            frames,
            tracker,
            writer,
        })
    }

    /// All steps, until the end, an error, or a wish to stop.
    fn step_to_end(&mut self, progress: &mut dyn FnMut(Progress) -> Wish) -> Result<()> {
        let cells = self.bar.grid().cells();
        let every = (WORK_BETWEEN_CALLS / cells).max(1);
        self.record()?;
        while self.bar.step() < self.steps {
            let burst = every.min(self.steps - self.bar.step());
            for _ in 0..burst {
                let before = Instant::now();
                self.bar.advance();
                self.stepping += before.elapsed().as_secs_f64();
                self.record()?;
                self.check_end_of_data()?;
            }
            self.check_finite()?;
            if progress(Progress { step: self.bar.step(), steps: self.steps, cells }) == Wish::Stop {
                return Err(Error::Interrupted);
            }
        }
        Ok(())
    }

    /// Everything that is recorded after a step, and once at the start.
    fn record(&mut self) -> Result<()> {
        let step = self.bar.step();
        if self.traces.add(&self.bar) {
            self.write_traces()?;
        }
        let due = self.frames.take(&self.bar);
        let last = step == self.steps;
        if !due.is_empty() || last {
            let row = self.ledger.row(&self.bar);
            if let Some(writer) = &mut self.writer {
                writer.ledger(row)?;
                due.into_iter().try_for_each(|frame| writer.frame(frame))?;
            }
        }
        if last || step.is_multiple_of((self.steps / FRONT_SIGHTINGS).max(1)) {
            self.tracker.observe(&self.bar);
        }
        if let Some(watch) =
            self.unloading.as_mut().filter(|_| last || step.is_multiple_of((self.steps / UNLOADING_LOOKS).max(1)))
        {
            watch.look(&self.bar);
        }
        if let Some(probe) = &mut self.elastic_check {
            probe.look(&self.bar);
        }
        Ok(())
    }

    fn write_traces(&mut self) -> Result<()> {
        let Some(writer) = &mut self.writer else {
            self.traces.take();
            return Ok(());
        };
        let (gauges, [left, right]) = self.traces.take();
        for (k, trace) in gauges.into_iter().enumerate() {
            writer.gauge(k, trace)?;
        }
        writer.end(Side::Left, left)?;
        writer.end(Side::Right, right)
    }

    /// Past the last knot the material file decides: stop, or note the rupture and go on under the largest stress.
    fn check_end_of_data(&mut self) -> Result<()> {
        let due = self.bar.step().is_multiple_of(STEPS_BETWEEN_DATA_CHECKS) || self.bar.step() == self.steps;
        if self.passed.is_some() || !due || !self.bar.data_can_end() {
            return Ok(());
        }
        let Some(passed) = self.bar.passed_end_of_data() else { return Ok(()) };
        self.passed = Some((passed, self.bar.time()));
        let material = &self.scene.bar.segments[passed.segment].material;
        let curve = material.branch(Sense::of(passed.strain));
        // Past a largest stress inside the data nothing more is needed of them: the bar carries no more than that.
        if curve.beyond() != Beyond::Error || curve.ultimate().is_some() {
            return Ok(());
        }
        Err(self.stopped(
            passed.cell,
            format!(
                "strain {:.4} is past the end of the data of {} ({:.4})",
                passed.strain.abs(),
                material.name,
                curve.last_strain()
            ),
            "give the material more data, or say what happens there with beyond = \"rupture\" or \"extend\"",
        ))
    }

    fn check_finite(&self) -> Result<()> {
        match self.bar.not_finite() {
            None => Ok(()),
            Some(cell) => Err(self.stopped(
                cell,
                format!("the stress is not a finite number (step {})", self.bar.step()),
                "check the scene for values far outside the material's range; the frames before this one are good",
            )),
        }
    }

    fn stopped(&self, cell: usize, reason: String, help: &str) -> Error {
        RunError { reason, time: self.bar.time(), x: self.bar.grid().centres()[cell], help: help.to_owned() }.into()
    }

    /// Closes the file, whatever the end was, and sums up.
    fn finish(mut self, ended: Result<()>, started: Instant) -> Result<Summary> {
        let (outcome, reason) = match &ended {
            Ok(()) if self.ruptured() => ("rupture", None),
            Ok(()) => ("done", None),
            Err(Error::Interrupted) => ("interrupted", None),
            Err(error @ Error::Run(_)) => ("stopped", Some(error.to_string())),
            // The file itself failed: there is nothing left to write to.
            Err(_) => return Err(ended.err().unwrap_or(Error::Interrupted)),
        };
        self.write_traces()?;
        let fronts = self.tracker.rows(&self.scene.record.gauges);
        let audit = self.audit();
        let error = record::against_similarity(&self.scene.bar, &self.bar, &self.launches);
        let wall = started.elapsed().as_secs_f64();
        let cells = self.bar.grid().cells();
        if let Some(writer) = self.writer.take() {
            let figures = Finish {
                wall_seconds: wall,
                step_wall_seconds: self.stepping,
                cells: cells as u64,
                steps: self.bar.step() as u64,
                events: 0,
                cell_steps: (cells * self.bar.step()) as u64,
                reason,
                error: error.clone(),
            };
            writer.finish(outcome, &fronts, &audit, figures)?;
        }
        ended?;
        Ok(self.summary(outcome, &fronts, audit, error, started.elapsed().as_secs_f64()))
    }

    fn ruptured(&self) -> bool {
        let broke = self.passed.as_ref().is_some_and(|(p, _)| {
            let material = &self.scene.bar.segments[p.segment].material;
            let curve = material.branch(Sense::of(p.strain));
            curve.beyond() == Beyond::Rupture || curve.ultimate().is_some()
        });
        broke || self.launches.iter().any(|l| l.fan.above_critical)
    }

    fn audit(&self) -> Vec<AuditRow> {
        let x = self.bar.grid().centres();
        let segments = &self.scene.bar.segments;
        let mut rows: Vec<AuditRow> = self.unloading.as_ref().and_then(|w| w.row(&x)).into_iter().collect();
        for launch in &self.launches {
            let material = &segments[launch.segment].material;
            rows.extend(record::above_critical(launch, material, self.critical.unwrap_or(f64::NAN)));
        }
        if let Some((passed, time)) = &self.passed {
            rows.push(record::past_data(passed, *time, x[passed.cell], &segments[passed.segment].material));
        }
        rows.extend(segments.iter().enumerate().filter_map(|(k, s)| record::heating(&self.bar, k, &s.material)));
        rows
    }

    fn summary(
        self,
        outcome: &str,
        fronts: &[record::FrontRow],
        audit: Vec<AuditRow>,
        error: Option<ErrorFigure>,
        wall: f64,
    ) -> Summary {
        let cells = self.bar.grid().cells();
        let steps = self.bar.step();
        let inside = CELLS_FROM_END.min((cells - 1) / 2);
        let end = |device: &Device, cell: usize| EndSummary {
            stress: device.stress(),
            strain: self.bar.value(Quantity::Strain, cell),
            velocity: device.velocity(),
        };
        let elastic = self.bar.stayed_elastic();
        Summary {
            scene: self.scene.title.clone(),
            outcome: outcome.to_owned(),
            method: "fd".into(),
            scheme: "leapfrog".into(),
            effects: effect_names(&self.scene.effects, !elastic),
            cells,
            steps,
            events: 0,
            wall_s: wall,
            step_wall_s: self.stepping,
            cell_steps_per_s: (cells * steps) as f64 / self.stepping,
            end_time_s: self.bar.time(),
            left: end(self.bar.left(), inside),
            right: end(self.bar.right(), cells - 1 - inside),
            fronts: fronts.iter().map(FrontSummary::from).collect(),
            critical_velocity: self.critical,
            above_critical: self.launches.iter().any(|l| l.fan.above_critical),
            elastic_check: self.elastic_check.filter(|_| elastic).and_then(|p| p.check()),
            ledger: LedgerSummary {
                energy_residual: self.ledger.worst_energy(),
                momentum_residual: self.ledger.worst_momentum(),
            },
            error,
            audit,
            output: self.output,
        }
    }
}

fn create_file(scene: &Scene, path: &Path, frames: &Frames, critical: Option<f64>) -> Result<Writer> {
    let Method::Leapfrog { .. } = scene.solve.method;
    let yields = scene.bar.segments.iter().any(|s| s.material.tension.strain().len() > 2);
    let header = Header {
        title: scene.title.clone(),
        scene: scene.text.clone(),
        scene_resolved: scene.resolved_json().to_string(),
        overrides: scene.overrides.clone(),
        effects: effect_names(&scene.effects, yields),
        method: "fd".into(),
        scheme: "leapfrog".into(),
        critical_velocity: critical,
    };
    let layout = Layout {
        x: frames.x().to_vec(),
        fields: scene.record.fields.clone(),
        gauges: scene.record.gauges.clone(),
        precision: scene.record.precision,
        compression: scene.record.compression,
        area_given: scene.bar.area_given,
    };
    Writer::create(path, &header, &layout, &material_records(scene))
}

/// Each different material of the bar once.
fn material_records(scene: &Scene) -> Vec<MaterialRecord> {
    let mut records: Vec<MaterialRecord> = Vec::new();
    for segment in &scene.bar.segments {
        let record = MaterialRecord::from(segment.material.as_ref());
        if !records.iter().any(|r| r.name == record.name) {
            records.push(record);
        }
    }
    records
}
