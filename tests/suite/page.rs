//! The HTML page of a result: requirements of phones, dark mode, printers and screen readers, and the data of its time slider.
// Tests panic at the first unexpected error.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use barwave::record::store::{Header, ResultFile, Writer};
use barwave::record::{Field, Frame};
use barwave::report::{Figure, PanelName, page};

use crate::common::binary;
use crate::report::{finished, layout, start};

fn of(path: &Path) -> String {
    page(&ResultFile::open(path).unwrap(), &Figure::default()).unwrap()
}

fn has_slider(page: &str) -> bool {
    let (figure, control) = (page.contains("<figure class=\"player\">"), page.contains("<input type=\"range\""));
    assert_eq!(figure, control);
    figure
}

#[test]
fn a_page_suits_phones_dark_screens_printers_and_screen_readers() {
    let folder = tempfile::tempdir().unwrap();
    let page = page(&finished(&folder.path().join("a.h5")), &Figure::default()).unwrap();
    for text in [
        "<html lang=\"en\">",
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">",
        "@media screen and (prefers-color-scheme: dark)",
        "@media print",
        "<main>",
        "<th scope=\"col\">strain ahead</th>",
        "<th scope=\"row\">method</th>",
        "aria-label=\"stress over the bar at 11 times\"",
        "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"Fronts\">",
    ] {
        assert!(page.contains(text), "{text}");
    }
    let drawings = page.matches("<svg ").count();
    assert!(drawings > 6, "{drawings}");
    assert_eq!(page.matches("<svg role=\"img\" aria-label=\"").count(), drawings);
    // Every table can be scrolled separately.
    assert_eq!(page.matches("<table").count(), page.matches("<div class=\"wide\"").count());
    for loaded in [" src=", "@import", "url(http", "fetch(", "<link"] {
        assert!(!page.contains(loaded), "{loaded}");
    }
}

#[test]
fn every_line_of_a_drawing_has_its_colour_for_the_dark() {
    let folder = tempfile::tempdir().unwrap();
    let page = page(&finished(&folder.path().join("a.h5")), &Figure::default()).unwrap();
    let (style, body) = page.split_once("</style>").unwrap();
    let colours = || body.split(" stroke=\"#").skip(1).map(|rest| rest.split('"').next().unwrap());
    assert!(colours().count() > 50);
    for colour in colours() {
        assert!(style.contains(&format!("[stroke=\"#{colour}\"]")), "{colour}");
    }
}

#[test]
fn there_is_a_slider_where_there_are_profiles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let with = |panels: &[PanelName]| {
        let figure = Figure { panels: panels.to_vec(), ..Figure::default() };
        has_slider(&page(&finished(&folder.path().join("b.h5")), &figure).unwrap())
    };
    assert!(with(&[]) && with(&[PanelName::Profiles]));
    assert!(!with(&[PanelName::Energy]));
    for (frames, expected) in [(1, false), (2, true)] {
        drop(start(&path, frames, 1e8));
        assert_eq!(has_slider(&of(&path)), expected, "{frames} frames");
    }
    // A beam has deflected shapes, spheres only have histories.
    for (scene, expected) in [("beam", true), ("spheres", false)] {
        let scene = format!("{}/runs/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
        binary::done(folder.path(), &["run", &scene, "-o", "impact.h5", "--quiet"]);
        assert_eq!(has_slider(&of(&folder.path().join("impact.h5"))), expected, "{scene}");
    }
}

/// Returns a stress that is different for each frame and position.
fn stress(frame: usize, place: usize) -> f64 {
    1e6 * (frame as f64 + 1e-3 * place as f64)
}

/// Writes a run with these numbers of frames and positions.
fn written(path: &Path, frames: usize, places: usize) {
    let mut layout = layout(vec![Field::Stress]);
    layout.x = (0..places).map(|i| (i as f64 + 0.5) / places as f64).collect();
    let mut writer = Writer::create(path, &Header::default(), &layout, &[]).unwrap();
    for frame in 0..frames {
        let row = (0..places).map(|place| stress(frame, place)).collect();
        writer.frame(Frame { time: frame as f64 * 1e-6, rows: vec![row] }).unwrap();
    }
}

/// Returns the binary32 numbers of a base64 text.
fn numbers(text: &str) -> Vec<f32> {
    let sextet = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    for four in text.trim_end_matches('=').as_bytes().chunks(4) {
        let bits = four.iter().enumerate().fold(0, |bits, (i, &c)| bits | u32::from(sextet(c)) << (18 - 6 * i));
        bytes.extend_from_slice(&bits.to_be_bytes()[1..four.len()]);
    }
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
}

/// Returns the times, positions and values of the slider.
fn embedded(page: &str) -> [Vec<f32>; 3] {
    let (_, rest) = page.split_once("<script type=\"application/json\">").unwrap();
    let data: serde_json::Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    assert_eq!(data["label"], "time (\u{b5}s)");
    ["time", "x", "values"].map(|name| numbers(data[name].as_str().unwrap()))
}

#[test]
fn the_slider_holds_the_frames_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    for (frames, places, expected) in [(7, 30, [7, 30]), (300, 1200, [200, 500])] {
        written(&path, frames, places);
        let page = of(&path);
        let [time, x, values] = embedded(&page);
        assert_eq!(([time.len(), x.len()], values.len()), (expected, time.len() * x.len()));
        // Frames are 1 us apart; the bar is 1 m long.
        let frame: Vec<usize> = time.iter().map(|t| t.round() as usize).collect();
        let place: Vec<usize> = x.iter().map(|x| (f64::from(*x) * places as f64 - 0.5).round() as usize).collect();
        for (kept, count) in [(&frame, frames), (&place, places)] {
            assert_eq!((kept[0], kept[kept.len() - 1]), (0, count - 1));
            assert!(kept.windows(2).all(|pair| (1..=3).contains(&(pair[1] - pair[0]))));
        }
        for (i, &frame) in frame.iter().enumerate() {
            for (j, &place) in place.iter().enumerate() {
                assert_eq!(values[i * x.len() + j], (stress(frame, place) * 1e-6) as f32, "{frame} {place}");
            }
        }
        let told = page.contains(&format!("200 of {frames} frames, 500 of {places} points"));
        assert_eq!(told, frames == 300);
    }
}

#[test]
fn what_is_not_a_number_is_a_gap_and_no_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    drop(start(&path, 3, f64::NAN));
    let page = of(&path);
    assert!(embedded(&page)[2].iter().all(|value| value.is_nan()));
    assert!(!page.split_once("</script>").unwrap().0.contains("NaN"));
}

/// Returns the heading and the numbers in the rows of a table of a page with this label; NaN for a text.
fn table_of(page: &str, label: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let (_, rest) = page.split_once(&format!("aria-label=\"{label}\">")).unwrap();
    let table = rest.split_once("</table>").unwrap().0;
    let cells = |row: &str| -> Vec<String> {
        let cell = |cell: &str| cell.split_once('>').unwrap().1.split_once('<').unwrap().0.to_owned();
        row.replace("<td", "\n<t").replace("<th", "\n<t").split("\n<t").skip(1).map(cell).collect()
    };
    let mut rows = table.split("<tr>").skip(1).map(cells);
    let head = rows.next().unwrap();
    (head, rows.collect())
}

/// Checks that a cell of a table shows the four digits of a number.
fn assert_shows(cell: &str, value: f64) {
    let shown: f64 = cell.replace('\u{2212}', "-").parse().unwrap();
    assert!((shown - value).abs() <= 6e-4 * value.abs(), "{cell}: {value}");
}

/// Pages of bars show the figures and the ruptures.
#[test]
fn a_page_has_the_figures_and_the_ruptures_of_a_bar() {
    let folder = tempfile::tempdir().unwrap();
    let scene = format!("{}/runs/spall.toml", env!("CARGO_MANIFEST_DIR"));
    let summary = binary::json(folder.path(), &["run", &scene, "-o", "a.h5", "--json"]);
    let page = of(&folder.path().join("a.h5"));
    assert!(page.contains("<h2>Results</h2>") && page.contains("<h2>Ruptures</h2>"));
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let (head, rows) = table_of(&page, "Results of each end or joint");
    assert_eq!(head[..4], ["end or joint", "peak force (kN)", "time of peak (\u{b5}s)", "impulse (N\u{b7}s)"]);
    for (row, side) in rows.iter().zip(["left", "right"]) {
        let figures = &summary["figures"][side];
        assert_eq!(row[0], format!("{side} end"));
        assert_shows(&row[3], number(&figures["impulse_N_s"]));
    }
    let (head, rows) = table_of(&page, "Results of each fragment");
    let fragments = summary["figures"]["fragments"].as_object().unwrap();
    assert_eq!((rows.len(), head[4].as_str()), (fragments.len(), "velocity (m/s)"));
    assert!(rows.len() > 1);
    for (k, row) in rows.iter().enumerate() {
        assert_shows(&row[4], number(&fragments[&(k + 1).to_string()]["velocity_m_s"]));
    }
    let (head, rows) = table_of(&page, "Ruptures");
    assert_eq!(head[..4], ["site", "cause", "x (mm)", "time (\u{b5}s)"]);
    let ruptures = summary["ruptures"].as_array().unwrap();
    assert_eq!(rows.len(), ruptures.len());
    for (row, rupture) in rows.iter().zip(ruptures) {
        assert_eq!(
            (row[0].as_str(), row[1].as_str()),
            (rupture["site"].as_str().unwrap(), rupture["cause"].as_str().unwrap())
        );
        assert_shows(&row[2], 1e3 * number(&rupture["x_m"]));
        assert_shows(&row[3], 1e6 * number(&rupture["time_s"]));
    }
    let (_, bar) = page.split_once("aria-label=\"Results of the bar\"").unwrap();
    assert!(bar.split_once("</table>").unwrap().0.contains("energy absorbed"));
}
