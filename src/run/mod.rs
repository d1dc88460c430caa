//! Runs scenes: advances the bar and passes its data to the recorders and the result file. The time loops are in `stepped` (grids) and `tracked`
//! (front tracking).

mod accuracy;
mod auto;
mod breaks;
mod checkpoints;
mod choice;
mod chosen;
mod companion;
mod estimate;
mod geometry;
mod impact;
mod limits;
mod output;
mod resume;
mod stepped;
mod tracked;
mod trial;

pub(crate) use impact::impact_to_checked_file;
pub use impact::{plan_impact, run_impact};
pub use output::Solution;
pub use resume::{resume, run_with_checkpoints};
use std::cell::RefCell;
use std::ops::ControlFlow;

use std::path::Path;
use std::time::{Duration, Instant};

use self::checkpoints::Checkpoints;
use self::chosen::Chosen;
use self::output::{Closed, Kept, Output};
use crate::assemble;
use crate::bar::{EndCondition, InitialFan, Segment, initial_fans};
use crate::error::{Error, Result};
use crate::impact::{contact_is_wide, contact_yields};
use crate::law::rate::Overstress;
use crate::law::rupture::{Rupture, Site};
use crate::material::{Material, Sense};
use crate::record::store::{Checkpoint, Header, Layout, RunFigures, Side, Writer, check_output};
use crate::record::{
    self, Account, AuditRow, AutoChoice, Case, ContactReading, ElasticCheck, EndSummary, ErrorFigure, Extreme, Figures,
    Fragments, FrontRow, FrontSummary, Ledger, LedgerSummary, LengthSummary, MaterialRecord, Off, Records,
    ResidualProfile, RuptureSummary, SegmentEnd, Stepped, Summary, Tally, TorsionSummary, Trace, TrackingSummary,
    Tried, Twisted, View, above_critical,
};
use crate::scene::{Effects, Scene, Torsion};
use crate::snapshot::Snapshot;
use crate::solver::moc::Settings;

pub use auto::choose;
pub use choice::predict;
pub use estimate::estimate;
pub(crate) use limits::check_start;
pub use trial::{Trial, trial};

/// Progress of a run.
#[derive(Debug, Clone)]
pub enum Progress {
    /// `effects = "auto"` has decided on an effect.
    Chosen(Box<AutoChoice>),
    /// A coarse run for the selection of the method by `tolerance` has ended.
    Tried {
        /// The coarse run.
        tried: Tried,
        /// The requested tolerance.
        tolerance: f64,
    },
    /// A solver on a grid has advanced.
    Steps {
        /// Steps done so far.
        step: usize,
        /// Total number of steps.
        steps: usize,
        /// Number of cells of the bar.
        cells: usize,
    },
    /// Front tracking has advanced.
    Fronts {
        /// Current time, s.
        time: f64,
        /// End time, s.
        until: f64,
        /// Number of events so far.
        events: u64,
        /// Number of fronts.
        fronts: usize,
    },
}

/// Simulates a scene and writes its result file, if requested. `progress` is called every few milliseconds. A scene with `effects = "auto"` is run
/// again if a relevant effect was neglected. A scene with a tolerance is run by the method that reaches it at the lowest cost. The file contains the
/// last run.
///
/// Missing folders of `output` are created. An existing result file with its checkpoint is replaced as soon as the run begins; any other
/// file is refused. If several runs write to one path at the same time, the file is that of the last one to begin; the others end with a file error.
/// # Errors
/// A [`crate::error::RunError`] if the run stops, [`Error::Interrupted`] if `progress` requests a stop, a file error if the result cannot be written.
/// In the first two cases the result file contains everything up to the stop. An [`InputError`](crate::error::InputError) if `output` is a file that
/// a result must not replace, or is being written by another run.
pub fn run(
    scene: &Scene,
    output: Option<&Path>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    output.map_or(Ok(()), |path| check_output(path, false))?;
    begin(scene, Target { path: output, ..Target::default() }, progress)
}

/// Simulates a scene as [`run`] does, to a file that the caller has checked. If `every` is set, checkpoints are written at this interval.
pub(crate) fn to_checked_file(
    scene: &Scene,
    output: &Path,
    every: Option<Duration>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    begin(scene, Target { path: Some(output), every, ..Target::default() }, progress)
}

/// Simulates a scene as [`run`] does, without a file. With front tracking the summary has no audit, which would take a sixth of the time of a short
/// run, except with `effects = "auto"`.
///
/// # Errors
/// As for [`run`], except for those of the file.
pub fn run_unaudited(scene: &Scene, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Summary> {
    begin(scene, Target { unaudited: scene.auto.is_none(), ..Target::default() }, progress)
}

/// Simulates a scene as [`run`] does, in memory: returns the fields and histories as arrays, and the summary.
///
/// ```
/// use std::ops::ControlFlow;
/// use barwave::record::Field;
/// use barwave::run::Progress;
/// use barwave::scene::Scene;
///
/// let scene = Scene::builder()
///     .set("bar.length", "1 m")
///     .set("bar.diameter", 0.02)
///     .set("bar.material", "copper-annealed")
///     .set("left.kind", "velocity")
///     .set("left.value", -30.0)
///     .set("right.kind", "free")
///     .set("effects.hardening", "isotropic")
///     .set("solve.until", 2e-4)
///     .set("solve.cells", 4000)
///     .build()?;
/// // Stopped at half of its steps.
/// let solution = barwave::run::solve(&scene, &mut |at| match at {
///     Progress::Steps { step, steps, .. } if 2 * step > steps => ControlFlow::Break(()),
///     _ => ControlFlow::Continue(()),
/// })?;
/// assert_eq!(solution.summary.outcome, "interrupted");
/// let stress = solution.field(Field::Stress).expect("recorded unless `fields` leaves it out");
/// assert_eq!(stress.dim(), (solution.time.len(), solution.x.len()));
/// assert!(solution.time[solution.time.len() - 1] < 2e-4);
/// # Ok::<(), barwave::error::Error>(())
/// ```
///
/// If `progress` requests a stop, the solution ends at that time and the outcome in its summary is "interrupted".
///
/// # Errors
/// As for [`run`], except for those of the file. [`Error::Interrupted`] only if the stop is requested while effects or a method are being selected.
pub fn solve(scene: &Scene, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Solution> {
    let kept: RefCell<Kept> = RefCell::default();
    let ended = begin(scene, Target { kept: Some(&kept), ..Target::default() }, progress);
    let mut kept = kept.into_inner();
    let interrupted = kept.take_interrupted().filter(|_| matches!(ended, Err(Error::Interrupted)));
    let summary = interrupted.map_or(ended, Ok)?;
    Ok(kept.solution(summary))
}

/// Simulates a scene as [`solve`] does, without a progress function.
///
/// ```
/// use barwave::record::Field;
/// use barwave::scene::Scene;
///
/// let scene = Scene::builder()
///     .set("bar.length", "1 m")
///     .set("bar.diameter", 0.02)
///     .set("bar.material", "copper-annealed")
///     .set("left.kind", "velocity")
///     .set("left.value", -30.0)
///     .set("right.kind", "free")
///     .set("solve.until", 2e-4)
///     .build()?;
/// let solution = barwave::run::solution(&scene)?;
/// let stress = solution.field(Field::Stress).expect("recorded unless `fields` leaves it out");
/// assert_eq!(stress.dim(), (solution.time.len(), solution.x.len()));
/// // Copper yields at 30 m/s, and the plastic wave is slow.
/// assert!(solution.summary.left.strain > 0.005);
/// # Ok::<(), barwave::error::Error>(())
/// ```
///
/// # Errors
/// As for [`run`], except for those of the file.
pub fn solution(scene: &Scene) -> Result<Solution> {
    solve(scene, &mut |_| ControlFlow::Continue(()))
}

/// Runs a scene, and selects its effects and its method if the scene leaves them open.
fn begin(scene: &Scene, target: Target<'_>, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Summary> {
    if scene.auto.is_some() { auto::run(scene, target, progress) } else { accurate(scene, target, progress) }
}

/// Runs a scene whose effects are given, by its method or to within its tolerance.
fn accurate(
    scene: &Scene,
    target: Target<'_>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    if scene.solve.tolerance.is_some() {
        choice::run(scene, target, progress)
    } else {
        run_method(scene, &target, progress)
    }
}

/// Destination of a run, and the state from which it continues.
#[derive(Debug, Default)]
struct Target<'a> {
    /// Result file; `None` if none is written.
    path: Option<&'a Path>,
    /// Destination in memory of the last run, if requested.
    kept: Option<&'a RefCell<Kept>>,
    /// Wall time between two checkpoints; `None` without checkpoints.
    every: Option<Duration>,
    /// Checkpoint from which the run continues, if it is resumed.
    checkpoint: Option<Checkpoint>,
    /// Effects and method that were selected for the run.
    chosen: Chosen,
    /// Whether the audit can be left out because it is not used.
    unaudited: bool,
}

impl Target<'_> {
    /// Returns whether frames are recorded.
    fn takes_frames(&self) -> bool {
        self.path.is_some() || self.kept.is_some()
    }

    /// Returns the target of a repeated run, with the selected effects of this one, without its checkpoint and method.
    fn for_repeat(&self) -> Self {
        let chosen = Chosen { effects: self.chosen.effects.clone(), attempt: None };
        Self { checkpoint: None, chosen, ..*self }
    }
}

/// Performs one run by the scene's method.
fn run_method(
    scene: &Scene,
    target: &Target<'_>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    let started = Instant::now();
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    assemble::solve(scene, Task { scene, target, started, progress })
}

/// Run of a scene by its method.
struct Task<'a> {
    scene: &'a Scene,
    target: &'a Target<'a>,
    started: Instant,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl assemble::Task for Task<'_> {
    type Output = Result<Summary>;

    fn on_grid(self, bar: impl Stepped + Snapshot) -> Result<Summary> {
        stepped::run(self, bar)
    }

    fn by_fronts(self, settings: Settings) -> Result<Summary> {
        tracked::run(self, settings)
    }
}

/// Returns the notes on impacts above the critical velocity; none with rate dependence, or if the bar fractured (`parted`).
fn above_critical_rows(scene: &Scene, initial_fans: &[InitialFan], parted: bool) -> Vec<AuditRow> {
    if scene.effects.rate.is_some() || parted {
        return Vec::new();
    }
    let critical = scene.critical_velocity().unwrap_or(f64::NAN);
    let row = |initial_fan: &InitialFan| {
        let original = InitialFan { origin: scene.original_origin(initial_fan.origin), ..initial_fan.clone() };
        above_critical(&original, &scene.bar.segments[initial_fan.segment].material, critical)
    };
    initial_fans.iter().filter_map(row).collect()
}

/// Returns the notes on sections of a segment that yielded in both senses. `places` are pairs of accumulated and signed plastic strain at the end.
fn flow_both_ways(scene: &Scene, segment: &Segment, places: impl Iterator<Item = (f64, f64)>) -> Vec<AuditRow> {
    let (places, material): (Vec<_>, _) = (places.collect(), &segment.material);
    let warm = record::flowed_both_ways(material, places.iter().copied()).filter(|_| scene.effects.rate.is_none());
    let reversed = record::reversed_flow(material, places.into_iter(), scene.solve.audit_tolerance);
    warm.into_iter().chain(reversed).collect()
}

/// Returns the data that a scene's audit needs. `cells` is the number of cells of the grid, if there is one.
fn case(scene: &Scene, cells: Option<usize>) -> Case<'_> {
    let effects = &scene.effects;
    let original = original_scene(scene);
    Case {
        bar: &original.bar,
        ends: [&scene.left, &scene.right],
        until: scene.solve.until,
        tolerance: scene.solve.audit_tolerance,
        off: Off {
            unloading: effects.hardening.is_none(),
            rate: effects.rate.is_none(),
            heat: effects.heat.is_none(),
            rupture: effects.rupture.is_none(),
            // Torsion has no lateral inertia.
            lateral_inertia: !effects.lateral_inertia && scene.torsion.is_none(),
        },
        torsion: scene.torsion.is_some(),
        cells,
    }
}

/// Returns the names of a scene's effects as they are written to files and summaries.
pub fn effect_names(effects: &Effects, plasticity: bool) -> Vec<String> {
    plasticity.then(|| "plasticity".to_owned()).into_iter().chain(effects.names()).collect()
}

/// Data of a run that do not depend on the method: the scene, its initial fans and critical velocity, and the result file.
struct RunRecorder<'a> {
    scene: &'a Scene,
    initial_fans: Vec<InitialFan>,
    critical: Option<f64>,
    writer: Output,
    kept: Option<&'a RefCell<Kept>>,
    output: String,
    started: Instant,
    /// Figures of the histories so far.
    tally: Tally,
    /// Time spent in the solver, s.
    stepping: f64,
    /// Schedule of the checkpoints; `None` if the run writes none.
    checkpoints: Option<Checkpoints>,
}

/// Results of a run that depend on the method.
struct RunResults {
    cells: usize,
    steps: usize,
    events: u64,
    /// Data of front tracking; the recorder sets `events_per_s`.
    tracking: Option<TrackingSummary>,
    end_time: f64,
    ends: [EndSummary; 2],
    fronts: Vec<FrontRow>,
    audit: Vec<AuditRow>,
    elastic: bool,
    elastic_check: Option<ElasticCheck>,
    ledger: LedgerSummary,
    error: Option<ErrorFigure>,
    /// Whether a section failed after the start: beyond the data of its curve, at an end above its critical velocity, or by strain that gathers.
    ruptured: bool,
    /// Fractures; `None` without a fracture criterion.
    ruptures: Option<Vec<Rupture>>,
    /// Largest temperature rise, K; `None` without the effect of heat.
    temperature_rise: Option<f64>,
    /// State of the simulated segments at the end.
    segments: Vec<SegmentEnd>,
    fragments: Fragments,
    residual_profile: ResidualProfile,
    account: Account,
    contacts: Vec<ContactReading>,
    paths_complete: bool,
}

impl RunResults {
    /// Returns whether the bar fractured by its criterion.
    fn parted(&self) -> bool {
        self.ruptures.as_ref().is_some_and(|ruptures| !ruptures.is_empty())
    }
}

impl<'a> RunRecorder<'a> {
    /// Opens the recorder and, if requested, the result file (a new one, or that of a resumed run). `x` are the sampling positions of the fields, m.
    fn open(scene: &'a Scene, target: &Target<'a>, x: Vec<f64>, sampling: &str, started: Instant) -> Result<Self> {
        let [left, right] = scene.ends_in_run();
        let initial_fans = initial_fans(&scene.bar, &left, &right);
        let critical = scene.critical_velocity();
        let (output, layout) = (target.path, layout(scene, x, sampling));
        let writer = match (output, &target.checkpoint) {
            (Some(path), Some(checkpoint)) => Output::File(Writer::resume(path, &layout, checkpoint)?),
            (Some(path), None) => Output::File(create_file(scene, path, &layout, critical)?),
            (None, _) if target.kept.is_some() => {
                Output::Memory(Box::new(Kept::new(layout.x, layout.fields, layout.gauges)))
            }
            (None, _) => Output::None,
        };
        let output = output.map(|p| p.display().to_string()).unwrap_or_default();
        let checkpoints = Checkpoints::of(target, scene);
        let law = |segment: &Segment| Overstress::of(scene.effects.rate?, &segment.material);
        let relaxes = scene.bar.segments.iter().filter_map(law).any(Overstress::relaxes_at_once);
        let tally = Tally::new(&original_scene(scene).bar, scene.record.gauges.len(), relaxes);
        let kept = target.kept;
        Ok(Self { scene, initial_fans, critical, writer, kept, output, started, tally, stepping: 0.0, checkpoints })
    }

    /// Returns the energy and momentum balance of a bar at t = 0.
    fn ledger(&self, bar: &impl View) -> Ledger {
        Ledger::new(bar).with_arm(self.scene.torsion.as_ref().map_or(1.0, |torsion| torsion.radius))
    }

    /// Returns the fracture time of each joint, s, according to the fractures so far; infinite for a joint that holds.
    fn breaks(&self, ruptures: &[Rupture]) -> Vec<f64> {
        let near = 1e-9 * self.scene.bar.length();
        let broken = |x: f64| ruptures.iter().find(|rupture| (rupture.x - x).abs() < near);
        joint_places(self.scene).map(|x| broken(x).map_or(f64::INFINITY, |rupture| rupture.time)).collect()
    }

    /// Writes the histories since the last call: the gauges in order, and both ends. Histories of joints follow those of the gauges and are not
    /// written.
    fn write_traces(&mut self, gauges: Vec<Trace>, ends: [Trace; 2], ruptures: &[Rupture]) -> Result<()> {
        let breaks = self.breaks(ruptures);
        self.tally.add_rows(&gauges, &ends, &breaks);
        let (writer, [left, right]) = (&mut self.writer, ends);
        for (k, trace) in
            gauges.into_iter().take(self.tally.gauges()).enumerate().filter(|(_, trace)| !trace.time.is_empty())
        {
            writer.gauge(k, trace)?;
        }
        writer.end(Side::Left, left)?;
        writer.end(Side::Right, right)
    }

    /// Returns whether the bar is loaded above its critical velocity from the start.
    fn above_critical(&self) -> bool {
        self.scene.is_above_critical()
    }

    /// Returns whether the theory predicts fracture at t = 0. The critical velocity is that of the static curve: above it, a rate-dependent bar can
    /// transmit the strain for a while.
    fn breaks_at_once(&self) -> bool {
        self.initial_fans.iter().any(|l| l.fan.above_critical) && self.scene.effects.rate.is_none()
    }

    /// Returns the fractures of a bar, with sites and segments of the original scene; `None` without a fracture criterion.
    fn ruptures(&self, bar: &impl View) -> Option<Vec<Rupture>> {
        let scene = self.scene;
        let named = |rupture: &Rupture| Rupture {
            site: scene.original_site(rupture.site),
            segment: scene.original_segment(rupture.segment),
            ..*rupture
        };
        self.scene.effects.rupture.as_ref().map(|_| bar.ruptures().iter().map(named).collect())
    }

    /// Returns the notes on impacts above the critical velocity; none if the bar fractured (`parted`).
    fn audit(&self, parted: bool) -> Vec<AuditRow> {
        above_critical_rows(self.scene, &self.initial_fans, parted)
    }

    /// Replaces the origins of fronts by those of the original scene.
    fn named(&self, mut rows: Vec<FrontRow>) -> Vec<FrontRow> {
        if self.scene.discretized.is_some() {
            for row in &mut rows {
                if let Some(initial_fan) =
                    self.initial_fans.iter().find(|initial_fan| initial_fan.origin.to_string() == row.origin)
                {
                    row.origin = self.scene.original_origin(initial_fan.origin).to_string();
                }
            }
        }
        rows
    }

    /// Closes the file after any outcome and returns the summary.
    fn close(mut self, ended: Result<()>, mut results: RunResults) -> Result<Summary> {
        let (outcome, reason) = match &ended {
            Ok(()) if results.ruptured || results.parted() || self.breaks_at_once() => ("rupture", None),
            Ok(()) => ("done", None),
            Err(Error::Interrupted) => ("interrupted", None),
            Err(error @ Error::Run(_)) => ("stopped", Some(error.to_string())),
            // The file itself failed, so nothing more can be written.
            Err(_) => return Err(ended.err().unwrap_or(Error::Interrupted)),
        };
        self.tally.close();
        let read_off = figures(self.scene, &self.tally, &results);
        results.audit.extend(contacts_beyond_hertz(self.scene, &read_off));
        let paths_complete = self.scene.record.paths && results.paths_complete && ended.is_ok();
        let fronts = results.fronts.clone();
        let (writer, kept) = (std::mem::replace(&mut self.writer, Output::None), self.kept);
        let mut arrays = None;
        if let Output::File(writer) = writer {
            let figures = RunFigures {
                wall_seconds: self.started.elapsed().as_secs_f64(),
                step_wall_seconds: self.stepping,
                cells: results.cells as u64,
                steps: results.steps as u64,
                events: results.events,
                cell_steps: (results.cells * results.steps) as u64,
                reason,
                error: results.error.clone(),
                paths_complete,
                ruptures: results.ruptures.clone(),
                figures: read_off.clone(),
            };
            writer.finish(outcome, &results.fronts, &results.audit, figures)?;
        } else if let Output::Memory(memory) = writer {
            arrays = Some(*memory);
        }
        let summary = self.summary(outcome, results, read_off);
        if let (Some(arrays), Some(kept)) = (arrays, kept) {
            let interrupted = matches!(ended, Err(Error::Interrupted)).then(|| summary.clone());
            kept.replace(arrays.close(Closed { fronts, paths_complete, interrupted }));
        }
        ended.map(|()| summary)
    }

    fn summary(self, outcome: &str, results: RunResults, figures: Figures) -> Summary {
        let [method, scheme] = self.scene.solve.method.names();
        let [left, right] = results.ends;
        let [at_left, at_right] = levers(self.scene);
        let [left, right] = [(left, at_left), (right, at_right)]
            .map(|(end, lever)| EndSummary { striker: end.striker.map(|velocity| lever * velocity), ..end });
        let as_theory = results.elastic && !results.parted();
        Summary {
            scene: self.scene.title.clone(),
            outcome: outcome.to_owned(),
            method: method.into(),
            scheme: scheme.into(),
            effects: effect_names(&self.scene.effects, !results.elastic),
            cells: results.cells,
            steps: results.steps,
            events: results.events,
            wall_s: self.started.elapsed().as_secs_f64(),
            step_wall_s: self.stepping,
            cell_steps_per_s: (results.cells * results.steps) as f64 / self.stepping.max(f64::MIN_POSITIVE),
            tracking: results.tracking.map(|t| TrackingSummary {
                events_per_s: results.events as f64 / self.stepping.max(f64::MIN_POSITIVE),
                ..t
            }),
            end_time_s: results.end_time,
            left,
            right,
            lengths: lengths(self.scene, &results.segments),
            figures,
            torsion: self.scene.torsion.as_ref().map(|torsion| torsion_summary(torsion, [left, right])),
            fronts: results.fronts.iter().map(FrontSummary::from).collect(),
            critical_velocity: self.critical,
            above_critical: self.above_critical(),
            errors: results.error.as_ref().and_then(|error| error.table),
            elastic_check: results.elastic_check.filter(|_| as_theory),
            ledger: results.ledger,
            error: results.error,
            choice: None,
            ruptures: results.ruptures.map(|all| all.iter().map(RuptureSummary::from).collect()),
            auto: None,
            temperature_rise: results.temperature_rise,
            notes: notes(self.scene, &results.audit),
            audit: results.audit,
            output: self.output,
        }
    }
}

/// Returns the notes on the scene and on the neglected effects that its audit found relevant.
fn notes(scene: &Scene, audit: &[AuditRow]) -> Vec<String> {
    let neglected = audit.iter().filter(|row| row.matters()).map(AuditRow::note);
    scene.notes().into_iter().chain(neglected).collect()
}

/// Returns the rows for balls whose contact pressure exceeds the elastic limit of the bar, although the contact is simulated as elastic, or whose
/// contact is not small.
fn contacts_beyond_hertz(scene: &Scene, figures: &Figures) -> Vec<AuditRow> {
    let last = scene.bar.segments.len() - 1;
    let rows = |(side, end, segment, k): (&str, &EndCondition, usize, usize)| {
        let EndCondition::Ball { contact, .. } = end else { return Vec::new() };
        let Some(force) = figures.get(&[side], "peak_force").map(f64::abs) else { return Vec::new() };
        let segment = &scene.bar.segments[segment];
        let limit = segment.material.branch(Sense::Compression).elastic_limit(segment.material.modulus).1;
        let radius = (segment.end_areas()[k] / std::f64::consts::PI).sqrt();
        let findings = [contact_yields(contact, force, limit), contact_is_wide(contact, force, radius)];
        let row = |(estimate, finding)| {
            let finding = std::format!("ball at the {side} end: {finding}");
            AuditRow { effect: "contact".into(), estimate, threshold: 1.0, finding, ..AuditRow::default() }
        };
        findings.into_iter().flatten().map(row).collect()
    };
    [("left", &scene.left, 0, 0), ("right", &scene.right, last, 1)].into_iter().flat_map(rows).collect()
}

/// Returns the ratios of the velocities of the bodies at the ends to those of the bar there; 1 without a lever.
fn levers(scene: &Scene) -> [f64; 2] {
    scene.torsion.as_ref().map_or([1.0; 2], |torsion| torsion.levers)
}

/// Returns the lengths of the segments of the original scene; empty in torsion, where strains are shear strains.
fn lengths(scene: &Scene, simulated: &[SegmentEnd]) -> Vec<LengthSummary> {
    if scene.torsion.is_some() {
        return Vec::new();
    }
    let ends = original_segments(scene, simulated);
    let of = |(segment, end): (&Segment, &SegmentEnd)| LengthSummary {
        initial: segment.length,
        at_end: segment.length + end.elongation,
        unloaded: segment.length + end.plastic_elongation,
    };
    original_scene(scene).bar.segments.iter().zip(&ends).map(of).collect()
}

/// Returns the original scene, before its tapers and initial states were discretized.
fn original_scene(scene: &Scene) -> &Scene {
    scene.discretized.as_ref().map_or(scene, |cut| &cut.original)
}

/// Returns the results of the segments of the original scene, as sums over their pieces.
fn original_segments(scene: &Scene, simulated: &[SegmentEnd]) -> Vec<SegmentEnd> {
    let mut ends = vec![SegmentEnd::default(); original_scene(scene).bar.segments.len()];
    for (k, end) in simulated.iter().enumerate() {
        ends[scene.original_segment(k)].add(end);
    }
    ends
}

/// Returns the contacts at joints of the original scene, with its joint numbers.
fn original_contacts(scene: &Scene, simulated: &[ContactReading]) -> Vec<ContactReading> {
    let named = |contact: &ContactReading| match scene.original_site(Site::Joint(contact.joint)) {
        Site::Joint(joint) => Some(ContactReading { joint, ..*contact }),
        _ => None,
    };
    simulated.iter().filter_map(named).collect()
}

/// Returns the positions of full-rate histories, m: the gauges, then the joints, whose histories are needed for figures.
fn history_places(scene: &Scene) -> Vec<f64> {
    scene.record.gauge_places().into_iter().chain(joint_places(scene)).collect()
}

/// Returns the positions of the joints of the original scene, m.
fn joint_places(scene: &Scene) -> impl Iterator<Item = f64> {
    let segments = &original_scene(scene).bar.segments;
    let ends = segments.iter().scan(0.0, |end, segment| {
        *end += segment.length;
        Some(*end)
    });
    ends.take(segments.len() - 1)
}

/// Returns the simulated segments to the left and right of each joint: the segments themselves, or their pieces at the joint.
fn beside_joints(scene: &Scene) -> impl Iterator<Item = [&Segment; 2]> {
    scene.joints().into_iter().map(|k| [&scene.bar.segments[k], &scene.bar.segments[k + 1]])
}

/// Returns the force at which joint `k` broke, N, and the time, s; 0 if it holds.
fn breaks(segments: &[Segment], ruptures: Option<&[Rupture]>, k: usize) -> Extreme {
    let broken = ruptures.and_then(|all| all.iter().find(|rupture| rupture.site == Site::Joint(k)));
    broken.map_or_else(Extreme::default, |rupture| {
        let area = segments[rupture.segment].end_areas()[usize::from(rupture.segment == k)];
        Extreme { value: rupture.stress * area, at: rupture.time }
    })
}

/// Returns the figures of a run.
fn figures(scene: &Scene, tally: &Tally, results: &RunResults) -> Figures {
    let scene = (scene, original_scene(scene));
    let segments = &scene.1.bar.segments;
    let residual_profile = results.residual_profile.means();
    Records {
        bar: &scene.1.bar,
        ends: [&scene.1.left, &scene.1.right],
        twisted: scene.1.torsion.as_ref().map(|torsion| Twisted {
            radius: torsion.radius,
            torque_per_stress: torsion.torque_per_stress().collect(),
        }),
        levers: levers(scene.1),
        gauges: scene.1.record.gauges.iter().map(|gauge| gauge.0.as_str()).collect(),
        tally,
        joint_areas: beside_joints(scene.0).map(|[left, _]| left.end_areas()[1]).collect(),
        residual_profile: &residual_profile,
        segments: original_segments(scene.0, &results.segments),
        account: results.account,
        contacts: original_contacts(scene.0, &results.contacts),
        strikers: [results.ends[0].striker, results.ends[1].striker],
        breaks: (0..segments.len() - 1).map(|k| breaks(segments, results.ruptures.as_deref(), k)).collect(),
        broken: results.parted(),
        fragments: &results.fragments,
    }
    .figures()
}

fn torsion_summary(torsion: &Torsion, ends: [EndSummary; 2]) -> TorsionSummary {
    let (radius, per_stress): (f64, Vec<f64>) = (torsion.radius, torsion.torque_per_stress().collect());
    TorsionSummary {
        radius_m: radius,
        torque: [(0, 0), (1, per_stress.len() - 1)].map(|(k, segment)| ends[k].stress * per_stress[segment]),
        angular_velocity_rad_s: ends.map(|end| end.velocity / radius),
    }
}

/// Returns the data for converting the fields of a bar in torsion into torques and angles at the positions `x` (m, increasing); `None` without
/// torsion.
fn twisted(scene: &Scene, x: &[f64]) -> Option<Twisted> {
    let torsion = scene.torsion.as_ref()?;
    let (mut k, mut end) = (0, scene.bar.segments[0].length);
    let of_segments: Vec<f64> = torsion.torque_per_stress().collect();
    let mut torque_per_stress = Vec::with_capacity(x.len());
    for &x in x {
        while x >= end && k + 1 < scene.bar.segments.len() {
            k += 1;
            end += scene.bar.segments[k].length;
        }
        torque_per_stress.push(of_segments[k]);
    }
    Some(Twisted { radius: torsion.radius, torque_per_stress })
}

fn layout(scene: &Scene, x: Vec<f64>, sampling: &str) -> Layout {
    Layout {
        geometry: geometry::geometry(scene, &x),
        x,
        fields: scene.record.fields.clone(),
        gauges: scene.record.gauges.clone(),
        precision: scene.record.precision,
        compression: scene.record.compression,
        area_given: scene.bar.area_given,
        sampling: sampling.into(),
        paths: scene.record.paths,
        temperature: scene.effects.heat.is_some(),
    }
}

fn create_file(scene: &Scene, path: &Path, layout: &Layout, critical: Option<f64>) -> Result<Writer> {
    let yields = scene.bar.segments.iter().any(|s| s.material.tension.strain().len() > 2);
    let [method, scheme] = scene.solve.method.names();
    let header = Header {
        title: scene.title.clone(),
        scene: scene.text.clone(),
        scene_resolved: scene.resolved_json().to_string(),
        overrides: scene.overrides.clone(),
        effects: effect_names(&scene.effects, yields),
        method: method.into(),
        scheme: scheme.into(),
        critical_velocity: critical,
        notes: scene.notes(),
        torsion: scene.torsion.as_ref().map(|torsion| torsion.radius),
        files: scene.files.clone(),
    };
    Writer::create(path, &header, layout, &material_records(scene))
}

/// Returns each distinct material of the bar once.
fn material_records(scene: &Scene) -> Vec<MaterialRecord> {
    distinct(scene.bar.segments.iter().map(|segment| segment.material.as_ref()))
}

/// Returns each distinct material once.
fn distinct<'a>(materials: impl Iterator<Item = &'a Material>) -> Vec<MaterialRecord> {
    let mut records: Vec<MaterialRecord> = Vec::new();
    for record in materials.map(MaterialRecord::from) {
        if !records.contains(&record) {
            records.push(record);
        }
    }
    records
}
