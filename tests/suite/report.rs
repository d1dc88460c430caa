//! `barwave report` on result files written here: figures of finished and unfinished runs, the page, wrong requests.
// A test that meets an error is to fail there.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use barwave::error::Error;
use barwave::record::store::{Finish, Geometry, Header, Layout, ResultFile, Side, Writer};
use barwave::record::{AuditRow, Compression, Field, Frame, FrontRow, LedgerRow, Precision, Trace};
use barwave::report::plot::png;
use barwave::report::{Units, draw, page};
use barwave::solver::Energies;

fn front(speed: f64, stress_behind: f64) -> FrontRow {
    FrontRow {
        origin: "left".into(),
        strain_behind: 0.01,
        strain_ahead: 0.0,
        stress_behind,
        stress_ahead: 0.0,
        speed,
        speed_measured: speed * 1.01,
        position: speed * 1e-4,
        last_seen: 1e-4,
        arrivals: vec![5e-5],
    }
}

/// Starts a run of `frames` frames of stress with the given value everywhere.
fn start(path: &Path, frames: usize, stress: f64) -> Writer {
    let layout = Layout {
        geometry: Geometry::default(),
        x: (0..50).map(|i| (f64::from(i) + 0.5) / 50.0).collect(),
        fields: vec![Field::Stress],
        gauges: vec![("a <gauge>".into(), 0.25)],
        precision: Precision::F64,
        compression: Compression::Deflate,
        area_given: false,
        sampling: String::new(),
        paths: false,
        temperature: false,
    };
    let header = Header { title: "Pull & <let go>".into(), scene: "x = \"<&>\"".into(), ..Header::default() };
    let mut writer = Writer::create(path, &header, &layout, &[]).unwrap();
    for index in 0..frames {
        let time = index as f64 * 1e-5;
        writer.frame(Frame { time, rows: vec![vec![stress; 50]] }).unwrap();
        let trace = Trace {
            time: vec![time],
            stress: vec![stress],
            strain: vec![0.0],
            velocity: vec![0.0],
            ..Trace::default()
        };
        writer.gauge(0, trace.clone()).unwrap();
        writer.end(Side::Left, trace).unwrap();
        writer
            .ledger(LedgerRow {
                time,
                energies: Energies { kinetic: time, ..Energies::default() },
                ..LedgerRow::default()
            })
            .unwrap();
    }
    writer
}

fn finished(path: &Path) -> ResultFile {
    let audit = AuditRow {
        effect: "heat".into(),
        estimate: 9.0,
        threshold: 3.0,
        finding: "it would be 9 K warmer".into(),
        remedy: String::new(),
    };
    let fronts = [front(5000.0, 1e8), front(500.0, 2e8)];
    start(path, 11, 1e8).finish("done", &fronts, &[audit], Finish::default()).unwrap();
    ResultFile::open(path).unwrap()
}

#[test]
fn a_finished_run_has_every_panel() {
    let folder = tempfile::tempdir().unwrap();
    let svg = draw(&finished(&folder.path().join("a.h5")), None, Units::Si).unwrap();
    for panel in [
        "(a)  stress over",
        "(b)  stress along",
        "(c)  stress at the gauges",
        "(d)  stress at the ends",
        "(e)  energy",
        "(f)  speed",
    ] {
        assert!(svg.contains(panel), "{panel}");
    }
    assert_eq!(svg.matches("<image").count(), 1);
    assert!(svg.contains("stress (MPa)") && svg.contains("energy (kJ/m\u{b2})"));
    assert!(svg.contains("Pull &amp; &lt;let go&gt;") && svg.contains("a &lt;gauge&gt;"));
}

#[test]
fn inch_pound_units_reach_every_axis() {
    let folder = tempfile::tempdir().unwrap();
    let svg = draw(&finished(&folder.path().join("a.h5")), None, Units::Us).unwrap();
    for label in ["stress (ksi)", "position x (in)", "front speed (ft/s)", "energy (ft\u{b7}lbf/in\u{b2})"] {
        assert!(svg.contains(label), "{label}");
    }
    assert!(!svg.contains("MPa"));
}

#[test]
fn the_page_has_the_tables() {
    let folder = tempfile::tempdir().unwrap();
    let file = finished(&folder.path().join("a.h5"));
    let svg = draw(&file, None, Units::Si).unwrap();
    let page = page(&file, &svg, Units::Si).unwrap();
    for text in ["x = &quot;&lt;&amp;&gt;&quot;", "it would be 9 K warmer", "(matters)", "+1.00", "speed, theory (m/s)"]
    {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("http:") || page.matches("http:").count() == page.matches("http://www.w3.org/").count());
}

#[test]
fn an_unfinished_run_is_drawn_as_far_as_it_came() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    drop(start(&path, 4, -1e8));
    let svg = draw(&ResultFile::open(&path).unwrap(), None, Units::Si).unwrap();
    assert!(svg.contains("unfinished") && svg.contains("(e)  energy") && !svg.contains("speed of the fronts"));
}

#[test]
fn one_frame_of_zeros_and_not_a_number_can_be_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for (frames, stress) in [(1, 0.0), (1, 5.0), (3, 0.0), (3, f64::NAN)] {
        let path = folder.path().join("a.h5");
        drop(start(&path, frames, stress));
        let svg = draw(&ResultFile::open(&path).unwrap(), None, Units::Si).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{frames} frames of {stress}");
        assert!(png(&svg, 0.5).unwrap().len() > 1000);
    }
}

#[test]
fn wrong_requests_say_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    drop(start(&path, 0, 0.0));
    let file = ResultFile::open(&path).unwrap();
    let complaint = |field| match draw(&file, field, Units::Si).unwrap_err() {
        Error::Input(error) => error.to_string(),
        other => panic!("{other}"),
    };
    assert!(complaint(None).contains("there is no frame in it yet"));
    let message = complaint(Some(Field::Strain));
    assert!(message.contains("no field `strain`") && message.contains("(allowed: stress)"), "{message}");
}
