//! Colours of all figures, and output as SVG, PNG, PDF or HTML.

use std::path::Path;

use super::drawing::Picture;
use super::html::{html, picture};
use crate::destination::{is_stdout, write_whole};
use crate::error::{Error, InputError, Result};

/// Pixels of a PNG per px of the drawing. With 2.5, a panel of 520 px is 1300 pixels wide: 300 dpi over 11 cm.
pub const PNG_SCALE: f32 = 2.5;

/// Line colours that colour-blind readers can distinguish, also in print (after Okabe and Ito, without yellow).
pub const COLOURS: [&str; 7] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"];

/// Returns the colour of the i-th line; the colours repeat after the last.
pub fn colour(i: usize) -> &'static str {
    COLOURS[i % COLOURS.len()]
}

/// Format of a picture file, determined by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Vector picture.
    Svg,
    /// Raster image.
    Png,
    /// Vector picture on a page of its size.
    Pdf,
    /// Self-contained page.
    Html,
}

impl Format {
    /// Returns the format of a file name, so that a wrong name is refused before any work is done.
    ///
    /// # Errors
    /// An [`InputError`] if the name ends in none of .svg, .png, .pdf, .html.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            "pdf" => Ok(Self::Pdf),
            "html" | "htm" => Ok(Self::Html),
            _ if is_stdout(path) => Ok(Self::Svg),
            _ => Err(InputError::new(format!("unknown picture format `{}`", path.display()))
                .key("path")
                .allowed("a file name ending in .svg, .png, .pdf or .html")
                .help("the ending of the name is the format")
                .into()),
        }
    }
}

/// Writes a picture in the format of the file name. `title` is the title of an HTML page.
///
/// # Errors
/// An error if the format is unknown or the file cannot be written.
pub fn save(path: &Path, title: &str, figure: &Picture) -> Result<()> {
    let failed = |reason| Error::file(path, reason);
    match Format::of(path)? {
        Format::Svg => write_whole(path, figure.svg().as_bytes()),
        Format::Png => write_whole(path, &figure.png(PNG_SCALE).map_err(failed)?),
        Format::Pdf => write_whole(path, &figure.pdf().map_err(failed)?),
        Format::Html => write_whole(path, page(title, &figure.svg()).as_bytes()),
    }
}

/// Returns a page of one figure.
fn page(title: &str, svg: &str) -> String {
    html(title, &[("", &["<figure class=\"whole\">\n", &picture(title, svg), "</figure>"].concat())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_the_name() {
        assert_eq!(Format::of(Path::new("a/b.PNG")).expect("known"), Format::Png);
        assert_eq!(Format::of(Path::new("b.pdf")).expect("known"), Format::Pdf);
        assert_eq!(Format::of(Path::new("b.eps")).expect_err("unknown").exit_code(), 2);
        assert_eq!(Format::of(Path::new("svg")).expect_err("unknown").exit_code(), 2);
    }
}
