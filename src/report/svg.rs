//! Writes a picture as SVG.

use std::fmt::Write as _;

use super::drawing::{
    Anchor, Area, EDGE, Element, INK, Note, PAPER, Picture, Shape, Stroke, Text, TextStyle, is_finite,
};
use super::html::escape;
use super::origin::PROGRAM;

/// Preferred fonts, the first being that of PNG and PDF; none is wider than [`text_width`](super::drawing::text_width) assumes.
const FONT: &str = "DejaVu Sans, Liberation Sans, Arial, Helvetica, sans-serif";

impl Picture {
    /// Returns the picture as the text of an SVG file.
    pub fn svg(&self) -> String {
        const MOST_CLIPS: usize = 100;
        // The number of the picture makes the identifiers of its clip paths unique on a page.
        let mut writer = Writer { text: String::new(), clips: MOST_CLIPS * self.number };
        writer.elements(&self.elements);
        let (Self { width, height, .. }, body) = (self, writer.text);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FONT}\" fill=\"{INK}\" data-generator=\"{PROGRAM}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n{body}</svg>\n"
        )
    }
}

struct Writer {
    text: String,
    clips: usize,
}

impl Writer {
    fn elements(&mut self, elements: &[Element]) {
        for element in elements {
            match element {
                Element::Shape { shape, fill, stroke, note } => {
                    self.shape(shape, fill.as_deref(), stroke.as_ref(), note);
                }
                Element::Text(text) => self.styled(text),
                Element::Image { area, png } => self.push(format_args!(
                    "<image {} preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>",
                    place(area),
                    base64(png)
                )),
                Element::Clipped(area, elements) => self.clipped(area, elements),
                Element::Group(class, elements) => {
                    self.push(format_args!("<g class=\"{class}\">"));
                    self.elements(elements);
                    self.push(format_args!("</g>"));
                }
            }
        }
    }

    fn shape(&mut self, shape: &Shape, fill: Option<&str>, stroke: Option<&Stroke>, note: &Note) {
        let note = match note {
            Note::Nothing => String::new(),
            Note::Name(name) => format!(" data-name=\"{}\"", escape(name)),
            Note::Attributes(attributes) => attributes.clone(),
        };
        let (fill, stroke) = (fill.unwrap_or("none"), stroke.map_or_else(String::new, attributes));
        match shape {
            Shape::Rect(area) => self.push(format_args!("<rect {} fill=\"{fill}\" {stroke}{note}/>", place(area))),
            Shape::Line([from, to]) => self.push(format_args!(
                "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" {stroke}/>",
                from.0, from.1, to.0, to.1
            )),
            Shape::Path(points) => self.push(format_args!(
                "<path d=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {stroke}{note}/>",
                path(points)
            )),
            Shape::Circle { centre, radius } => self.push(format_args!(
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" fill=\"{fill}\" {stroke}/>",
                centre.0, centre.1
            )),
            Shape::Polygon(corners) => {
                let corners: Vec<String> = corners.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
                self.push(format_args!("<polygon points=\"{}\" fill=\"{fill}\" {stroke}/>", corners.join(" ")));
            }
        }
    }

    fn styled(&mut self, Text { at, size, anchor, style, letters }: &Text) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let style = match style {
            TextStyle::Plain => String::new(),
            TextStyle::Bold => " font-weight=\"bold\"".into(),
            TextStyle::Upright => format!(" transform=\"rotate(-90 {:.2} {:.2})\"", at.0, at.1),
            TextStyle::Coloured(colour) => format!(" font-weight=\"bold\" fill=\"{colour}\""),
            TextStyle::Edge => {
                format!(" font-weight=\"bold\" fill=\"{PAPER}\" stroke=\"{PAPER}\" stroke-width=\"{EDGE}\"")
            }
        };
        self.push(format_args!(
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{style}>{}</text>",
            at.0,
            at.1,
            escape(letters)
        ));
    }

    fn clipped(&mut self, area: &Area, elements: &[Element]) {
        let id = self.clips;
        self.clips += 1;
        self.push(format_args!(
            "<clipPath id=\"clip{id}\"><rect {}/></clipPath><g clip-path=\"url(#clip{id})\">",
            place(area)
        ));
        self.elements(elements);
        self.push(format_args!("</g>"));
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.text.write_fmt(element);
        self.text.push('\n');
    }
}

fn place(Area { x, y, width, height }: &Area) -> String {
    format!("x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"")
}

fn path(points: &[(f64, f64)]) -> String {
    let (mut path, mut pen_down) = (String::new(), false);
    for point in points {
        if is_finite(point) {
            let _ = write!(path, "{}{:.2} {:.2}", if pen_down { 'L' } else { 'M' }, point.0, point.1);
        }
        pen_down = is_finite(point);
    }
    path
}

fn attributes(stroke: &Stroke) -> String {
    let Stroke { colour, width, dash, opacity } = stroke;
    let dash = if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") };
    let opacity = if *opacity < 1.0 { format!(" stroke-opacity=\"{opacity:.3}\"") } else { String::new() };
    format!("stroke=\"{colour}\" stroke-width=\"{width:.3}\"{dash}{opacity}")
}

/// Returns bytes as base64 with padding (RFC 4648).
pub(super) fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let sextet = (bits >> (18 - 6 * i)) & 63;
            text.push(if i <= chunk.len() { char::from(ALPHABET[sextet as usize]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Drawing;
    use super::*;

    #[test]
    fn base64_follows_the_standard_examples() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn markup_in_text_is_escaped() {
        let mut drawing = Drawing::default();
        drawing.text((0.0, 0.0), 10.0, Anchor::Start, "a<b & \"c\"");
        assert!(drawing.finish(1.0, 1.0).svg().contains("a&lt;b &amp; &quot;c&quot;"));
    }

    #[test]
    fn a_gap_in_the_data_is_a_gap_in_the_line() {
        let mut drawing = Drawing::default();
        drawing.path(&[(0.0, 0.0), (1.0, f64::NAN), (2.0, 2.0)], &Stroke::new("red", 1.0));
        assert!(drawing.finish(1.0, 1.0).svg().contains("M0.00 0.00M2.00 2.00"));
    }
}
