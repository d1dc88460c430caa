//! `barwave report` of result files written here: figures of finished and unfinished runs, the page, invalid requests.
// Tests panic at the first unexpected error.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use barwave::error::Error;
use barwave::law::rupture::{Cause, Rupture, Site};
use barwave::record::store::{Geometry, Header, Layout, ResultFile, RunFigures, Side, Writer};
use barwave::record::{AuditRow, Compression, Field, Frame, FrontRow, LedgerRow, Precision, Trace};
use barwave::report::{Figure, PanelName, Units, draw, page};
use barwave::solver::Energies;

use crate::common::binary;

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
        load_held_until: f64::INFINITY,
        arrivals: vec![5e-5],
    }
}

pub(crate) fn layout(fields: Vec<Field>) -> Layout {
    Layout {
        geometry: Geometry::default(),
        x: (0..50).map(|i| (f64::from(i) + 0.5) / 50.0).collect(),
        fields,
        gauges: vec![("a <gauge>".into(), 0.25)],
        precision: Precision::F64,
        compression: Compression::Deflate,
        area_given: false,
        sampling: String::new(),
        paths: false,
        temperature: false,
    }
}

/// Starts a result file of `frames` frames with this stress everywhere.
pub(crate) fn start(path: &Path, frames: usize, stress: f64) -> Writer {
    let header = Header { title: "Pull & <let go>".into(), scene: "x = \"<&>\"".into(), ..Header::default() };
    let mut writer = Writer::create(path, &header, &layout(vec![Field::Stress]), &[]).unwrap();
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

pub(crate) fn finished(path: &Path) -> ResultFile {
    let audit = AuditRow {
        effect: "heat".into(),
        estimate: 9.0,
        threshold: 3.0,
        finding: "it would be 9 K warmer".into(),
        ..AuditRow::default()
    };
    let fronts = [front(5000.0, 1e8), front(500.0, 2e8)];
    start(path, 11, 1e8).finish("done", &fronts, &[audit], RunFigures::default()).unwrap();
    ResultFile::open(path).unwrap()
}

#[test]
fn a_finished_run_has_every_panel() {
    let folder = tempfile::tempdir().unwrap();
    let svg = draw(&finished(&folder.path().join("a.h5")), &Figure::default()).unwrap().svg();
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
fn a_pdf_is_one_page_of_the_size_of_the_figure() {
    let folder = tempfile::tempdir().unwrap();
    let size = Some([900.0, 1200.0]);
    let lines = Figure { panels: vec![PanelName::Energy, PanelName::Gauges], size, ..Figure::default() };
    for (figure, images) in [(Figure::default(), 1), (lines, 0)] {
        let picture = draw(&finished(&folder.path().join("a.h5")), &figure).unwrap();
        let (svg, bytes) = (picture.svg(), picture.pdf().unwrap());
        let text = String::from_utf8_lossy(&bytes);
        // A px is three quarters of a point.
        let points = |name| {
            let (_, rest) = svg.split_once(&format!(" {name}=\"")).unwrap();
            0.75 * rest.split_once('"').unwrap().0.parse::<f64>().unwrap()
        };
        let media_box = format!("/MediaBox [0 0 {} {}]", points("width"), points("height"));
        assert!(text.starts_with("%PDF-1.") && text.trim_end().ends_with("%%EOF"));
        assert_eq!(text.matches("/Type /Page\n").count(), 1);
        assert!(text.contains(&media_box), "{media_box}");
        assert_eq!(text.matches("/Subtype /Image").count(), images);
    }
}

#[test]
fn every_figure_can_be_a_pdf() {
    let folder = tempfile::tempdir().unwrap();
    binary::done(folder.path(), &["compare", "mild-steel", "-o", "curves.pdf"]);
    drop(start(&folder.path().join("a.h5"), 3, 1e8));
    binary::done(folder.path(), &["report", "a.h5", "-o", "figure.PDF"]);
    for name in ["curves.pdf", "figure.PDF"] {
        assert!(std::fs::read(folder.path().join(name)).unwrap().starts_with(b"%PDF-"), "{name}");
    }
    let message = binary::refused(folder.path(), &["report", "a.h5", "-o", "figure.eps"]);
    assert!(message.contains("a file name ending in .svg, .png, .pdf or .html"), "{message}");
}

#[test]
fn inch_pound_units_reach_every_axis() {
    let folder = tempfile::tempdir().unwrap();
    let svg =
        draw(&finished(&folder.path().join("a.h5")), &Figure { units: Units::Us, ..Figure::default() }).unwrap().svg();
    for label in ["stress (ksi)", "position x (in)", "front speed (ft/s)", "energy (ft\u{b7}lbf/in\u{b2})"] {
        assert!(svg.contains(label), "{label}");
    }
    assert!(!svg.contains("MPa"));
}

#[test]
fn the_page_has_the_tables() {
    let folder = tempfile::tempdir().unwrap();
    let file = finished(&folder.path().join("a.h5"));
    let page = page(&file, &Figure::default()).unwrap();
    for text in [
        "x = &quot;&lt;&amp;&gt;&quot;",
        "it would be 9 K warmer",
        "(above the threshold)",
        "+1.00",
        "speed, theory (m/s)",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("http:") || page.matches("http:").count() == page.matches("http://www.w3.org/").count());
}

#[test]
fn an_unfinished_run_is_drawn_as_far_as_it_came() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    drop(start(&path, 4, -1e8));
    let svg = draw(&ResultFile::open(&path).unwrap(), &Figure::default()).unwrap().svg();
    assert!(svg.contains("unfinished") && svg.contains("(e)  energy") && !svg.contains("speed of the fronts"));
}

#[test]
fn one_frame_of_zeros_and_not_a_number_can_be_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for (frames, stress) in [(1, 0.0), (1, 5.0), (3, 0.0), (3, f64::NAN)] {
        let path = folder.path().join("a.h5");
        drop(start(&path, frames, stress));
        let picture = draw(&ResultFile::open(&path).unwrap(), &Figure::default()).unwrap();
        let svg = picture.svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{frames} frames of {stress}");
        assert!(picture.png(0.5).unwrap().len() > 1000);
    }
}

/// A single frame is drawn as a stripe, not over the whole time of the run.
#[test]
fn a_single_frame_is_a_stripe() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "[bar]\nlength = 1\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue = 30\n[right]\nkind = \"free\"\n\
                 [solve]\nuntil = 1e-4\ncells = 50\n[record]\nframes = 1\n";
    std::fs::write(folder.path().join("bar.toml"), scene).expect("a folder to write to");
    binary::done(folder.path(), &["run", "bar.toml", "-o", "out.h5"]);
    binary::done(folder.path(), &["report", "out.h5", "-o", "out.svg"]);
    let svg = std::fs::read_to_string(folder.path().join("out.svg")).expect("a figure");
    assert!(svg.contains("stress over the bar at one time") && !svg.contains("energy"), "{svg}");
}

#[test]
fn wrong_requests_say_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    drop(start(&path, 0, 0.0));
    let file = ResultFile::open(&path).unwrap();
    let complaint = |field| match draw(&file, &Figure { field, ..Figure::default() }).unwrap_err() {
        Error::Input(error) => error.to_string(),
        other => panic!("{other}"),
    };
    assert!(complaint(None).contains("it has no frames yet"));
    let message = complaint(Some(Field::Strain));
    assert!(message.contains("no field `strain`") && message.contains("(allowed: stress)"), "{message}");
}

fn drawn(folder: &Path, figure: &Figure) -> Result<String, Error> {
    Ok(draw(&finished(&folder.join("a.h5")), figure)?.svg())
}

#[test]
fn free_ends_have_no_panel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    start(&path, 5, 0.0).finish("done", &[], &[], RunFigures::default()).unwrap();
    let file = ResultFile::open(&path).unwrap();
    let svg = draw(&file, &Figure::default()).unwrap().svg();
    assert!(!svg.contains("stress at the") || svg.contains("stress at the gauges"));
    assert!(!svg.contains("left end") && !svg.contains("right end"));
    let error = draw(&file, &Figure { panels: vec![PanelName::Ends], ..Figure::default() }).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("no stress at an end"), "{error}");
}

#[test]
fn front_speeds_are_on_a_logarithmic_axis() {
    let folder = tempfile::tempdir().unwrap();
    let figure = Figure { panels: vec![PanelName::FrontSpeeds], ..Figure::default() };
    let svg = drawn(folder.path(), &figure).unwrap();
    assert!(svg.contains(" log\" data-y-label=\"front speed (m/s)\""));
    // 500 and 5000 m/s with a margin.
    for label in [">500<", ">1000<", ">2000<", ">5000<"] {
        assert!(svg.contains(label), "{label}");
    }
}

/// An axis of front speeds has several labels, in ft/s, too.
#[test]
fn an_axis_of_like_front_speeds_has_several_labels_in_any_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    start(&path, 3, 1e8).finish("done", &[front(5000.0, 1e8)], &[], RunFigures::default()).unwrap();
    let file = ResultFile::open(&path).unwrap();
    for (units, labels) in [(Units::Si, [">4000<", ">5000<", ">6000<"]), (Units::Us, [">14000<", ">16000<", ">18000<"])]
    {
        let figure = Figure { panels: vec![PanelName::FrontSpeeds], units, ..Figure::default() };
        let svg = draw(&file, &figure).unwrap().svg();
        for label in labels {
            assert!(svg.contains(label), "{label} {svg}");
        }
    }
}

#[test]
fn panels_are_drawn_alone_in_the_size_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let one = |size| Figure { panels: vec![PanelName::Energy], size, ..Figure::default() };
    let svg = drawn(folder.path(), &one(Some([400.0, 300.0]))).unwrap();
    assert!(svg.contains("width=\"400\" height=\"300\"") && svg.contains(">energy<"));
    assert!(!svg.contains("(a)") && !svg.contains("Pull &amp;") && !svg.contains("<image"));
    let two = Figure { panels: vec![PanelName::Energy, PanelName::Gauges], ..Figure::default() };
    let svg = drawn(folder.path(), &two).unwrap();
    assert!(svg.contains("(a)  energy") && svg.contains("(b)  stress at the gauges"));
    let error = drawn(folder.path(), &one(Some([200.0, 100.0]))).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("at least 260 x 200 px"), "{error}");
}

#[test]
fn ruptures_are_read_back_and_marked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let rupture = Rupture {
        time: 4e-5,
        x: 0.6,
        site: Site::Inside(0),
        segment: 0,
        cause: Cause::Spall,
        stress: 5e8,
        strain: 0.01,
        absorbed: 1.0,
        bar_absorbed: 2.0,
    };
    let ending = RunFigures { ruptures: Some(vec![rupture]), ..RunFigures::default() };
    start(&path, 11, 1e8).finish("rupture", &[], &[], ending).unwrap();
    let file = ResultFile::open(&path).unwrap();
    let stored = file.ruptures().unwrap();
    assert_eq!((stored[0].time, stored[0].x, stored[0].cause.as_str()), (4e-5, 0.6, "spall"));
    // Panels: x-t diagram, profiles, gauges, ends and energy.
    assert_eq!(draw(&file, &Figure::default()).unwrap().svg().matches(">rupture<").count(), 5);
    assert_eq!(drawn(folder.path(), &Figure::default()).unwrap().matches(">rupture<").count(), 0);
}

#[test]
fn a_field_that_no_gauge_records_is_read_from_the_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let (layout, header) = (layout(vec![Field::Displacement]), Header::default());
    let mut writer = Writer::create(&path, &header, &layout, &[]).unwrap();
    for index in 0..3 {
        let time = f64::from(index) * 1e-5;
        writer.frame(Frame { time, rows: vec![vec![0.002 * f64::from(index); 50]] }).unwrap();
        let [time, stress, zero] = [time, 1e8, 0.0].map(|value| vec![value]);
        writer.gauge(0, Trace { time, stress, strain: zero.clone(), velocity: zero, ..Trace::default() }).unwrap();
    }
    drop(writer);
    let figure = Figure { panels: vec![PanelName::Gauges], ..Figure::default() };
    let svg = draw(&ResultFile::open(&path).unwrap(), &figure).unwrap().svg();
    assert!(svg.contains("displacement at the gauges") && svg.contains("displacement (mm)") && !svg.contains("MPa"));
    // From 0 to 4 mm with a margin.
    assert!(svg.contains("data-y=\"-2e-1 4.2e0\""), "{svg}");
}

/// The levels behind fronts are not drawn after these have met other waves.
#[test]
fn theory_is_drawn_while_its_fronts_run() {
    let folder = tempfile::tempdir().unwrap();
    for (last_seen, is_drawn) in [(1e-4, true), (1e-5, false)] {
        let path = folder.path().join(format!("{is_drawn}.h5"));
        let fronts = [FrontRow { last_seen, ..front(5000.0, 1e8) }];
        start(&path, 11, 1e8).finish("done", &fronts, &[], RunFigures::default()).unwrap();
        let figure = Figure { panels: vec![PanelName::Profiles], ..Figure::default() };
        let svg = draw(&ResultFile::open(&path).unwrap(), &figure).unwrap().svg();
        assert_eq!(svg.contains("behind each front at its start"), is_drawn, "{last_seen}");
    }
}

/// A line that oscillates is drawn pale, since it would hide the other lines.
#[test]
fn ringing_is_drawn_pale() {
    let folder = tempfile::tempdir().unwrap();
    for (count, is_pale) in [(10, false), (500, true)] {
        let zeros: Vec<f64> = (0..count).map(|_| 0.0).collect();
        let path = folder.path().join(format!("{count}.h5"));
        let mut writer = start(&path, 2, 1e8);
        let trace = Trace {
            time: (0..count).map(|i| 1e-5 + 1e-9 * f64::from(i)).collect(),
            stress: (0..count).map(|i| if i % 2 == 0 { 1e8 } else { -1e8 }).collect(),
            strain: zeros.clone(),
            velocity: zeros,
            ..Trace::default()
        };
        writer.gauge(0, trace).unwrap();
        drop(writer);
        let figure = Figure { panels: vec![PanelName::Gauges], ..Figure::default() };
        let svg = draw(&ResultFile::open(&path).unwrap(), &figure).unwrap().svg();
        assert_eq!(svg.contains("stroke-opacity=\"0.350\""), is_pale, "{count}");
    }
}

#[test]
fn a_spike_that_the_axis_cuts_off_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let mut writer = start(&path, 2, 1e8);
    let stress = |i: i32| if i == 40 { -9e9 } else { 1e6 * f64::from(i % 100) };
    let trace = Trace {
        time: (0..500).map(|i| 1e-5 + 1e-9 * f64::from(i)).collect(),
        stress: (0..500).map(stress).collect(),
        strain: vec![0.0; 500],
        velocity: vec![0.0; 500],
        ..Trace::default()
    };
    writer.gauge(0, trace).unwrap();
    drop(writer);
    let figure = Figure { panels: vec![PanelName::Gauges], ..Figure::default() };
    let svg = draw(&ResultFile::open(&path).unwrap(), &figure).unwrap().svg();
    assert!(svg.contains("extends to \u{2212}9000"), "{svg}");
}

/// Returns a panel of a bar between a moving and an absorbing end, or `None` if the file has no data for it.
fn panel_of(panel: PanelName, until: &str, [moved, absorbing]: [&str; 2], value: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let material =
        "{ name = \"steel\", density = 7800, modulus = 200e9, curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }";
    let scene = format!(
        "[bar]\nlength = 1\nmaterial = {material}\n[{moved}]\nkind = \"velocity\"\n{value}\n\
         [{absorbing}]\nkind = \"absorbing\"\n[solve]\ncells = 200\nuntil = \"{until}\"\n[record]\nframes = 13\n"
    );
    std::fs::write(folder.path().join("a.toml"), scene).unwrap();
    let output = binary::barwave(folder.path(), &["run", "a.toml", "-o", "a.h5", "--quiet"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let figure = Figure { panels: vec![panel], ..Figure::default() };
    draw(&ResultFile::open(&folder.path().join("a.h5")).unwrap(), &figure).ok().map(|picture| picture.svg())
}

fn over_x_t(value: &str) -> Option<String> {
    panel_of(PanelName::SelfSimilar, "120 us", ["left", "right"], value)
}

#[test]
fn the_stress_strain_panel_shows_the_places_that_are_strained() {
    let path = |until, ends, value| panel_of(PanelName::StressStrain, until, ends, value);
    let ends = ["right", "left"];
    // The wave has travelled 0.2 m, then through the middle of the bar.
    let one = path("40 us", ends, "value = 12").unwrap();
    assert_eq!(one.matches(">x = ").count(), 1, "{one}");
    let two = path("120 us", ends, "value = 12").unwrap();
    assert_eq!(two.matches(">x = ").count(), 2, "{two}");
    assert_eq!(path("40 us", ends, "value = 0"), None);
}

#[test]
fn the_panel_over_x_t_ends_where_the_load_changes() {
    let shows = |svg: &str, time: &str| svg.contains(&format!(">{time} \u{b5}s<"));
    let held = over_x_t("value = -12").unwrap();
    assert!(shows(&held, "40") && shows(&held, "80") && shows(&held, "120"), "{held}");
    let reversed = over_x_t("history = [[0, -12], [60e-6, -12], [60e-6, 5]]").unwrap();
    assert!(shows(&reversed, "20") && shows(&reversed, "40") && shows(&reversed, "60"), "{reversed}");
    assert!(!shows(&reversed, "80") && !shows(&reversed, "120"), "{reversed}");
    // The theoretical fan is that of 20 m/s, which does not exist before 60 us.
    assert_eq!(over_x_t("history = [[0, -12], [60e-6, -12], [60e-6, -20]]"), None);
}
