//! Name of the program in figures and pages, by which it recognizes its own files.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use memchr::memmem;

/// Name of the program, as written into figures and pages.
pub(super) const PROGRAM: &str = "barwave";

/// Forms of the name in SVG, HTML, PNG and PDF files.
const MARKS: [&[u8]; 4] = [
    b"data-generator=\"barwave\"",
    b"<meta name=\"generator\" content=\"barwave\">",
    b"tEXtSoftware\0barwave",
    b"/Producer (barwave)",
];

/// Length of the start of a file that contains the name.
const START: u64 = 4096;

/// Returns true if a file is empty, or a figure or page of this program, or starts with the line `heading` of a table of this program.
pub fn is_own(path: &Path, heading: Option<&str>) -> bool {
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(START).read_to_end(&mut start));
    let is_table = || heading.is_some_and(|heading| start.starts_with(heading.as_bytes()));
    let marked = || MARKS.iter().any(|mark| memmem::find(&start, mark).is_some());
    read.is_ok() && (start.is_empty() || is_table() || marked())
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Drawing;
    use super::super::plot::{self, PNG_SCALE};
    use super::*;

    #[test]
    fn figures_of_every_format_are_recognized() {
        let folder = tempfile::tempdir().expect("a folder");
        let picture = Drawing::default().finish(60.0, 20.0);
        for name in ["a.svg", "a.png", "a.pdf", "a.html"] {
            let path = folder.path().join(name);
            plot::save(&path, "a title", &picture).expect("a picture");
            assert!(is_own(&path, None), "{name}");
        }
        let path = folder.path().join("a");
        for (text, own) in [("", true), ("a,b\n1,2\n", true), ("<svg/>", false), ("barwave", false)] {
            std::fs::write(&path, text).expect("written");
            assert_eq!(is_own(&path, Some("a,b\n")), own, "{text}");
        }
        assert!(tiny_skia::Pixmap::decode_png(&picture.png(PNG_SCALE).expect("a picture")).is_ok());
    }
}
