//! The result file: what is written can be read, however the writing ends.
// Tests panic at the first unexpected error.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use barwave::error::Error;
use barwave::material::Provenance;
use barwave::record::store::{
    FORMAT_VERSION, Geometry, Header, Layout, Part, RUNNING, ResultFile, RunFigures, Side, StoredScene, Writer,
};
use barwave::record::{
    AuditRow, Compression, ErrorFigure, Field, Frame, FrontRow, LedgerRow, MaterialRecord, PathRow, Precision, Trace,
};
use barwave::solver::Energies;

const SPEED: f64 = 5000.0;
const CELLS: usize = 300;
const FRAMES: usize = 150;

/// Returns a frame with a step that travels to the right: -100 MPa and 2 m/s behind it.
fn frame(index: usize, x: &[f64]) -> Frame {
    let time = index as f64 * 1e-6;
    let behind = |x: f64| x <= SPEED * time;
    let step = |value: f64| x.iter().map(|&x| if behind(x) { value } else { 0.0 }).collect::<Vec<_>>();
    Frame { time, rows: vec![step(-100e6), step(2.0)] }
}

fn layout() -> Layout {
    let edge = |i: usize| i as f64 / CELLS as f64;
    let part = Part { start: 0.0, end: 1.0, material: "copper".into(), areas: Some([2e-4; 2]) };
    let geometry = Geometry {
        length: 1.0,
        parts: vec![part],
        bounds: (0..CELLS).map(|i| [edge(i), edge(i + 1)]).collect(),
        area: Some(vec![2e-4; CELLS]),
        end_factors: Some([2e-4; 2]),
    };
    Layout {
        geometry,
        x: (0..CELLS).map(|i| (i as f64 + 0.5) / CELLS as f64).collect(),
        fields: vec![Field::Stress, Field::Velocity],
        gauges: vec![("middle".into(), 0.5), ("far/end".into(), 0.9)],
        precision: Precision::F64,
        compression: Compression::Deflate,
        area_given: true,
        sampling: String::new(),
        paths: false,
        temperature: false,
    }
}

fn header() -> Header {
    Header {
        title: "A step".into(),
        scene: "title = \"A step\" # Stoßwelle\n".into(),
        scene_resolved: "{}".into(),
        overrides: vec![],
        effects: vec!["unloading".into(), "plasticity".into()],
        method: "fd".into(),
        scheme: "leapfrog".into(),
        critical_velocity: Some(44.5),
        notes: vec!["µ: a note".into()],
        torsion: None,
        ..Header::default()
    }
}

fn material() -> MaterialRecord {
    MaterialRecord {
        name: "copper".into(),
        strain: vec![0.0, 0.001, 0.2],
        stress: vec![0.0, 100e6, 300e6],
        tension: [vec![0.0, 0.001, 0.2], vec![0.0, 100e6, 300e6]],
        compression: [vec![0.0, 0.001, 0.1], vec![0.0, 100e6, 200e6]],
        density: 8930.0,
        modulus: 100e9,
        provenance: Provenance { citation: "somebody, 1950".into(), ..Provenance::default() },
    }
}

fn front() -> FrontRow {
    FrontRow {
        origin: "left".into(),
        strain_behind: -8e-4,
        strain_ahead: 0.0,
        stress_behind: -100e6,
        stress_ahead: 0.0,
        speed: SPEED,
        speed_measured: 4999.0,
        position: 0.745,
        last_seen: 149e-6,
        load_held_until: 60e-6,
        arrivals: vec![1e-4, f64::NAN],
    }
}

fn ledger(index: usize) -> LedgerRow {
    let energies = Energies { kinetic: index as f64, ..Energies::default() };
    LedgerRow { time: index as f64 * 1e-6, energies, residual: 1e-15, ..LedgerRow::default() }
}

fn trace(index: usize) -> Trace {
    let n = index as f64;
    Trace {
        time: vec![n * 1e-6],
        stress: vec![-n],
        strain: vec![n * 1e-9],
        velocity: vec![2.0 * n],
        ..Trace::default()
    }
}

/// Writes `frames` frames with their traces and ledger rows.
fn start(path: &Path, layout: &Layout, frames: usize) -> Writer {
    let mut writer = Writer::create(path, &header(), layout, &[material()]).unwrap();
    for index in 0..frames {
        writer.frame(frame(index, &layout.x)).unwrap();
        writer.gauge(0, trace(index)).unwrap();
        writer.gauge(1, trace(index)).unwrap();
        writer.end(Side::Left, trace(index)).unwrap();
        writer.ledger(ledger(index)).unwrap();
    }
    writer
}

fn audit() -> AuditRow {
    AuditRow {
        effect: "heat".into(),
        estimate: 3.0,
        threshold: 10.0,
        finding: "3 K warmer".into(),
        remedy: "Add `heat = {}` under [effects] to include it".into(),
        ..AuditRow::default()
    }
}

fn finish(writer: Writer) {
    let error = ErrorFigure { value: 1e-3, measure: "relative L1".into(), reference: "exact".into(), table: None };
    let figures = RunFigures { wall_seconds: 1.5, cell_steps: 12_345, error: Some(error), ..RunFigures::default() };
    writer.finish("done", &[front()], &[audit()], figures).unwrap();
}

fn assert_frames(file: &ResultFile, layout: &Layout, frames: usize) {
    let time = file.time().unwrap();
    assert_eq!(time.len(), frames);
    let stress = file.field(Field::Stress, 0..frames).unwrap();
    let velocity = file.field(Field::Velocity, 0..frames).unwrap();
    assert_eq!(stress.dim(), (frames, layout.x.len()));
    for (index, &time) in time.iter().enumerate() {
        let expected = frame(index, &layout.x);
        assert_eq!(time, expected.time);
        assert_eq!(stress.row(index).to_vec(), expected.rows[0]);
        assert_eq!(velocity.row(index).to_vec(), expected.rows[1]);
    }
}

#[test]
fn a_finished_file_gives_everything_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/er/step.h5");
    let layout = layout();
    finish(start(&path, &layout, FRAMES));

    let file = ResultFile::open(&path).unwrap();
    assert_frames(&file, &layout, FRAMES);
    assert_eq!(file.x().unwrap(), layout.x);
    assert_eq!(file.fields(), layout.fields);
    let facts = file.metadata();
    assert_eq!((facts.outcome.as_str(), facts.is_unfinished()), ("done", false));
    assert_eq!((&facts.scene, &facts.effects), (&header().scene, &header().effects));
    assert_eq!((facts.critical_velocity, facts.notes.as_slice()), (Some(44.5), ["µ: a note".to_owned()].as_slice()));
    assert_eq!((facts.wall_seconds, facts.cell_steps), (Some(1.5), Some(12_345)));
    assert_eq!(facts.error.as_ref().unwrap().value, 1e-3);
    assert_eq!(facts.energy_units, "J");

    let gauges = file.gauges().unwrap();
    assert_eq!(gauges.iter().map(|g| (g.name.as_str(), g.x)).collect::<Vec<_>>(), [("middle", 0.5), ("far/end", 0.9)]);
    assert_eq!(gauges[0].trace.stress, (0..FRAMES).map(|n| -(n as f64)).collect::<Vec<_>>());
    let left = file.end(Side::Left).unwrap();
    assert_eq!((left.velocity[3], left.strain.len()), (6.0, 0));
    assert_eq!(file.end(Side::Right).unwrap().time.len(), 0);
    assert_eq!(file.ledger().unwrap(), (0..FRAMES).map(ledger).collect::<Vec<_>>());
    // The file has the finding and its remedy in one message.
    let [row] = file.audit().unwrap().try_into().unwrap();
    assert_eq!(AuditRow { finding: row.finding.clone(), remedy: String::new(), ..audit() }, row);
    assert_eq!(row.message(), "heat: 3 K warmer. Add `heat = {}` under [effects] to include it");
    assert_eq!(file.materials().unwrap(), [material()]);

    let fronts = file.fronts().unwrap();
    assert_eq!((fronts.len(), fronts[0].origin.as_str()), (1, "left"));
    assert_eq!((fronts[0].speed_measured, fronts[0].arrivals[0]), (4999.0, 1e-4));
    assert!(fronts[0].arrivals[1].is_nan());
}

#[test]
fn nothing_but_the_result_is_left_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    finish(start(&folder.path().join("step.h5"), &layout(), 3));
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["step.h5"]);
}

#[test]
fn a_dropped_writer_leaves_every_frame_and_says_running() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dropped.h5");
    let layout = layout();
    drop(start(&path, &layout, 70));

    let file = ResultFile::open(&path).unwrap();
    assert_eq!(file.metadata().outcome, RUNNING);
    assert!(file.metadata().is_unfinished());
    assert_frames(&file, &layout, 70);
    assert!(file.fronts().unwrap().is_empty());
    assert!(file.audit().unwrap().is_empty());
    assert_eq!(file.metadata().wall_seconds, None);
}

#[test]
fn other_numbers_and_compressions_read_alike() {
    let folder = tempfile::tempdir().unwrap();
    for compression in [Compression::Lzf, Compression::None, Compression::Deflate] {
        let path = folder.path().join("step.h5");
        let layout = Layout { compression, precision: Precision::F32, ..layout() };
        finish(start(&path, &layout, FRAMES));
        // -100e6 and 2 are exact in 4 bytes, so that the comparison is exact.
        assert_frames(&ResultFile::open(&path).unwrap(), &layout, FRAMES);
    }
}

fn piece(index: usize) -> PathRow {
    let n = index as f64;
    PathRow { x0: n, t0: 0.1 * n, x1: n + 1.0, t1: 0.1 * n + 0.1, stress_jump: -n, speed: 10.0 }
}

/// More front segments than several chunks hold, written in portions that fill no chunk.
#[test]
fn pieces_of_fronts_are_kept_whatever_the_compression() {
    let folder = tempfile::tempdir().unwrap();
    let pieces: Vec<PathRow> = (0..9900).map(piece).collect();
    for compression in [Compression::Lzf, Compression::None, Compression::Deflate] {
        let path = folder.path().join("fronts.h5");
        let layout = Layout { compression, paths: true, ..layout() };
        let begin = || {
            let mut writer = start(&path, &layout, 2);
            pieces.chunks(700).for_each(|rows| writer.paths(rows.to_vec()).unwrap());
            writer
        };
        finish(begin());
        assert_eq!(ResultFile::open(&path).unwrap().paths().unwrap(), pieces);
        // If a run never finishes, a part of a chunk may be missing where chunks are compressed.
        drop(begin());
        let kept = ResultFile::open(&path).unwrap().paths().unwrap();
        let lost = if compression == Compression::None { 0 } else { pieces.len() % 4096 };
        assert_eq!(kept, pieces[..pieces.len() - lost]);
    }
}

#[test]
fn a_start_that_fails_leaves_the_older_result_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("step.h5");
    finish(start(&path, &layout(), 5));
    let before = std::fs::read(&path).unwrap();

    let mut twice = layout();
    twice.fields = vec![Field::Stress, Field::Stress];
    let error = Writer::create(&path, &header(), &twice, &[]).unwrap_err();
    assert!(matches!(error, Error::File { .. }), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), before);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_folder_or_a_file_in_the_way_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let error = Writer::create(folder.path(), &header(), &layout(), &[]).unwrap_err();
    assert!(error.to_string().contains("is a folder"), "{error}");
    std::fs::write(folder.path().join("taken"), "").unwrap();
    assert!(Writer::create(&folder.path().join("taken/step.h5"), &header(), &layout(), &[]).is_err());
}

#[test]
fn a_frame_that_does_not_fit_is_an_error_of_a_later_call() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = start(&folder.path().join("step.h5"), &layout(), 1);
    let _ = writer.frame(Frame { time: 1.0, rows: vec![vec![0.0; 3]] });
    let error = writer.finish("done", &[], &[], RunFigures::default()).unwrap_err();
    assert!(error.to_string().contains("does not fit 2 fields of 300 samples"), "{error}");
}

#[test]
fn what_is_no_result_file_is_a_clear_input_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.h5");
    let complaint = |path: &Path| match ResultFile::open(path).unwrap_err() {
        Error::Input(error) => error.to_string(),
        other => panic!("{other}"),
    };
    assert!(complaint(&path).contains("no such file"));
    std::fs::write(&path, "not HDF5").unwrap();
    assert!(complaint(&path).contains("this is not an HDF5 file"), "{}", complaint(&path));
}

/// The reader refuses files of other layouts with help, and never reads them by mistake.
#[test]
fn files_of_another_format_version_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("step.h5");
    finish(start(&path, &layout(), 2));
    for (version, said) in
        [(FORMAT_VERSION + 1, "read it with a newer barwave"), (1, "simulate its scene again: barwave run")]
    {
        hdf5::File::open_rw(&path).unwrap().attr("format_version").unwrap().write_scalar(&version).unwrap();
        let Error::Input(error) = ResultFile::open(&path).unwrap_err() else { panic!("no input error") };
        assert!(error.message.contains(&format!("format version {version}; this program reads {FORMAT_VERSION}")));
        assert!(error.help.contains(said), "{}", error.help);
        // The scene of an older file can be run again; that of a newer file may have another meaning.
        let scene = StoredScene::read(&path).map(|_| ()).map_err(|error| error.to_string());
        assert!(version < FORMAT_VERSION || scene.is_err_and(|error| error.contains("format version")));
    }
}

/// The file contains the geometry, forces and units that a reader needs.
#[test]
fn the_file_has_its_geometry_and_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("step.h5");
    finish(start(&path, &layout(), 4));
    let file = hdf5::File::open(&path).unwrap();
    let column = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    assert_eq!(column("bar/length"), [1.0]);
    assert_eq!(column("x_bounds")[..4], [0.0, 1.0 / 300.0, 1.0 / 300.0, 2.0 / 300.0]);
    assert_eq!((column("area").len(), column("bar/area_left")), (CELLS, vec![2e-4]));
    assert_eq!(column("ends/left/force"), [0.0, 1.0, 2.0, 3.0].map(|stress| -2e-4 * stress));
    assert_eq!(column("material/copper/compression_stress"), [0.0, 100e6, 200e6]);
    let text = |name: &str| file.attr(name).unwrap().read_scalar::<hdf5::types::VarLenUnicode>().unwrap().to_string();
    assert_eq!((text("Conventions").as_str(), text("critical_velocity_units").as_str()), ("CF-1.11", "m/s"));
    assert!(file.attr("error_value").is_err() && file.group("error").unwrap().attr("value").is_ok());
}

/// Every number in a table or history has a unit.
#[test]
fn every_column_has_its_unit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("step.h5");
    finish(start(&path, &Layout { paths: true, ..layout() }, 2));
    let file = hdf5::File::open(&path).unwrap();
    let groups = ["/", "fronts", "audit", "paths", "ledger", "ends/left", "gauges/middle", "bar", "material/copper"];
    let mut columns = 0;
    for group in groups {
        for dataset in file.group(group).unwrap().datasets().unwrap() {
            let is_number = dataset.dtype().unwrap().is::<f64>();
            assert!(!is_number || dataset.attr("units").is_ok(), "{}", dataset.name());
            columns += usize::from(is_number);
        }
    }
    assert!(columns > 40, "{columns}");
}

/// A child process shares open files and their locks until it executes its program. Tests that start programs while others write files must not
/// encounter "another run writes this file" after a file has been closed.
#[cfg(unix)]
#[test]
fn a_finished_file_is_free_although_a_child_was_forked_meanwhile() {
    use std::os::unix::process::CommandExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.h5");
    let writer = start(&path, &layout(), 2);
    let [forked, may_go] = [folder.path().join("forked"), folder.path().join("may go")];
    let child = std::thread::spawn({
        let (forked, may_go) = (forked.clone(), may_go.clone());
        move || {
            let mut command = std::process::Command::new("true");
            let wait = move || {
                std::fs::write(&forked, [])?;
                while !may_go.exists() {
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
                Ok(())
            };
            // SAFETY: between fork and exec the child only creates one file, looks for another and sleeps.
            #[allow(unsafe_code)]
            unsafe {
                command.pre_exec(wait);
            }
            command.status()
        }
    });
    while !forked.exists() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    finish(writer);
    let again = Writer::create(&path, &header(), &layout(), &[material()]);
    std::fs::write(&may_go, []).unwrap();
    assert!(child.join().unwrap().unwrap().success());
    finish(again.unwrap());
}
