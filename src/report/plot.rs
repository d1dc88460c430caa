//! Common parts of all figures: colours, and output as SVG, PNG, PDF or HTML.
//!
//! SVG and HTML name the font `DejaVu Sans` with common substitutes; PNG and PDF are drawn with `DejaVu Sans` itself, which
//! is part of the program, so they look the same on a machine without fonts.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use resvg::{tiny_skia, usvg};

use super::html::{html, picture};
use crate::destination::{is_stdout, write_whole};
use crate::error::{Error, InputError, Result};

/// Pixels of a PNG for each SVG unit: 2.5 makes a panel of 520 units 1300 pixels wide, 300 dpi over 11 cm.
pub const PNG_SCALE: f32 = 2.5;

/// Line colours that stay apart for colour-blind readers and in print (after Okabe and Ito, without the yellow).
pub const COLOURS: [&str; 7] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"];

/// Colour of the i-th line; they repeat after the last.
pub fn colour(i: usize) -> &'static str {
    COLOURS[i % COLOURS.len()]
}

/// Kind of picture file, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Vector picture.
    Svg,
    /// Pixels.
    Png,
    /// Vector picture on a page of its size.
    Pdf,
    /// A page that needs nothing else.
    Html,
}

impl Format {
    /// The format of a file name, so that a wrong one is refused before any work is done.
    ///
    /// # Errors
    /// An [`InputError`] where the name ends in none of .svg, .png, .pdf, .html.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            "pdf" => Ok(Self::Pdf),
            "html" | "htm" => Ok(Self::Html),
            _ if is_stdout(path) => Ok(Self::Svg),
            _ => Err(InputError::new(format!("unknown picture format `{}`", path.display()))
                .key("-o")
                .allowed("a file name ending in .svg, .png, .pdf or .html")
                .help("e.g. -o figure.svg")
                .into()),
        }
    }
}

/// Writes a picture in the format that the file name asks for. `title` is the title of an HTML page.
///
/// # Errors
/// A name of no known kind, or a file that cannot be written.
pub fn save(path: &Path, title: &str, svg: &str) -> Result<()> {
    match Format::of(path)? {
        Format::Svg => write_whole(path, svg.as_bytes()),
        Format::Png => write_whole(path, &png(svg, PNG_SCALE).map_err(|reason| Error::file(path, reason))?),
        Format::Pdf => write_whole(path, &pdf(svg).map_err(|reason| Error::file(path, reason))?),
        Format::Html => write_whole(path, page(title, svg).as_bytes()),
    }
}

/// A page of one figure.
fn page(title: &str, svg: &str) -> String {
    html(title, &[("", &["<figure class=\"whole\">\n", &picture(title, svg), "</figure>"].concat())])
}

/// Draws SVG text as a PNG file, `scale` pixels a unit.
///
/// # Errors
/// One sentence: text that is no SVG, or a picture too large for memory.
pub fn png(svg: &str, scale: f32) -> std::result::Result<Vec<u8>, String> {
    let tree = tree(svg)?;
    let size = tree.size().to_int_size().scale_by(scale).ok_or("the picture has no size")?;
    let mut pixels =
        tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("the picture is too large for memory")?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| e.to_string())
}

/// Draws SVG text as a PDF file of one page, 1 px as 1/96 inch.
///
/// # Errors
/// A message: invalid SVG, or an SVG element that is not supported.
pub fn pdf(svg: &str) -> std::result::Result<Vec<u8>, String> {
    super::pdf::pdf(&tree(svg)?)
}

fn tree(svg: &str) -> std::result::Result<usvg::Tree, String> {
    let options = usvg::Options { fontdb: fonts(), font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
    usvg::Tree::from_str(svg, &options).map_err(|e| e.to_string())
}

/// `DejaVu Sans`, for [`png`] and [`pdf`].
fn fonts() -> Arc<usvg::fontdb::Database> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    let load = || {
        let mut fonts = usvg::fontdb::Database::new();
        for font in [dejavu::sans::regular(), dejavu::sans::bold()] {
            fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(font)));
        }
        fonts.set_sans_serif_family("DejaVu Sans");
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_is_there_and_text_leaves_ink() {
        assert_eq!(fonts().faces().count(), 2);
        let text = "<svg xmlns='http://www.w3.org/2000/svg' width='60' height='20'>\
                    <text x='2' y='15' font-family='DejaVu Sans, Arial'>stress</text></svg>";
        let blank = "<svg xmlns='http://www.w3.org/2000/svg' width='60' height='20'></svg>";
        let ink = |svg| {
            let picture = png(svg, 1.0).expect("it is SVG");
            let pixels = tiny_skia::Pixmap::decode_png(&picture).expect("it is PNG");
            pixels.pixels().iter().filter(|p| p.red() < 128).count()
        };
        assert_eq!(ink(blank), 0);
        assert!(ink(text) > 50, "{}", ink(text));
    }

    #[test]
    fn formats_go_by_the_name() {
        assert_eq!(Format::of(Path::new("a/b.PNG")).expect("known"), Format::Png);
        assert_eq!(Format::of(Path::new("b.pdf")).expect("known"), Format::Pdf);
        assert_eq!(Format::of(Path::new("b.eps")).expect_err("unknown").exit_code(), 2);
        assert_eq!(Format::of(Path::new("svg")).expect_err("unknown").exit_code(), 2);
    }
}
