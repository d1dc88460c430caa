//! A small SVG writer: lines, text, images. Sizes are in px; y is downwards.

use std::fmt::Write as _;

use super::html::escape;

/// The fonts asked for, as in the other pictures; none is wider than [`text_width`] assumes.
const FONT: &str = "DejaVu Sans, Liberation Sans, Arial, Helvetica, sans-serif";

/// Colours with a role. A page gives each its counterpart for the dark, so that pictures use no others for it.
pub(super) const INK: &str = "#222";
pub(super) const PAPER: &str = "white";
pub(super) const BORDER: &str = "#444";
pub(super) const GRID: &str = "#e0e0e0";
pub(super) const FINE: &str = "#f2f2f2";
pub(super) const RUPTURE: &str = "#b2182b";
pub(super) const THEORY: &str = "#777";

/// A drawing under construction.
#[derive(Debug, Default)]
pub(super) struct Svg {
    body: String,
    clips: usize,
}

/// How a text stands on its point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line's look.
#[derive(Debug, Clone)]
pub(super) struct Stroke {
    pub colour: String,
    pub width: f64,
    /// SVG dash pattern; empty for a full line.
    pub dash: &'static str,
    /// 0 to 1.
    pub opacity: f64,
}

impl Stroke {
    pub fn new(colour: impl Into<String>, width: f64) -> Self {
        Self { colour: colour.into(), width, dash: "", opacity: 1.0 }
    }

    pub fn dashed(mut self, dash: &'static str) -> Self {
        self.dash = dash;
        self
    }

    pub fn opacity(mut self, opacity: f64) -> Self {
        self.opacity = opacity;
        self
    }

    fn attributes(&self) -> String {
        let dash = if self.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", self.dash) };
        let opacity =
            if self.opacity < 1.0 { format!(" stroke-opacity=\"{:.3}\"", self.opacity) } else { String::new() };
        format!("stroke=\"{}\" stroke-width=\"{:.3}\"{dash}{opacity}", self.colour, self.width)
    }
}

/// A rectangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

impl Svg {
    /// A drawing that stands on one page with others of other numbers: what it names inside itself has names of its own.
    pub fn of_page(number: usize) -> Self {
        const MOST_CLIPS: usize = 100;
        Self { clips: MOST_CLIPS * number, ..Self::default() }
    }

    pub fn rect(&mut self, area: Area, fill: &str, stroke: Option<&Stroke>) {
        self.rect_with(area, fill, stroke, "");
    }

    /// A rectangle with further attributes.
    pub fn rect_with(&mut self, area: Area, fill: &str, stroke: Option<&Stroke>, attributes: &str) {
        let stroke = stroke.map_or_else(String::new, Stroke::attributes);
        let Area { x, y, width, height } = area;
        self.push(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{fill}\" {stroke}{attributes}/>"
        ));
    }

    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: &Stroke) {
        let stroke = stroke.attributes();
        self.push(format_args!(
            "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" {stroke}/>",
            from.0, from.1, to.0, to.1
        ));
    }

    /// A line through points; a point that is not finite interrupts it.
    pub fn path(&mut self, points: &[(f64, f64)], stroke: &Stroke) {
        self.named_path("", points, stroke);
    }

    /// A line that tells a script its name.
    pub fn named_path(&mut self, name: &str, points: &[(f64, f64)], stroke: &Stroke) {
        let mut path = String::new();
        let mut pen_down = false;
        for &(x, y) in points {
            if x.is_finite() && y.is_finite() {
                let _ = write!(path, "{}{x:.2} {y:.2}", if pen_down { 'L' } else { 'M' });
                pen_down = true;
            } else {
                pen_down = false;
            }
        }
        if !path.is_empty() {
            let stroke = stroke.attributes();
            let name = if name.is_empty() { String::new() } else { format!(" data-name=\"{}\"", escape(name)) };
            self.push(format_args!("<path d=\"{path}\" fill=\"none\" stroke-linejoin=\"round\" {stroke}{name}/>"));
        }
    }

    pub fn circle(&mut self, centre: (f64, f64), radius: f64, fill: &str, stroke: &Stroke) {
        let stroke = stroke.attributes();
        self.push(format_args!(
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" fill=\"{fill}\" {stroke}/>",
            centre.0, centre.1
        ));
    }

    /// A closed area.
    pub fn polygon(&mut self, corners: &[(f64, f64)], fill: &str, stroke: &Stroke) {
        let corners: Vec<String> = corners.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
        let (corners, stroke) = (corners.join(" "), stroke.attributes());
        self.push(format_args!("<polygon points=\"{corners}\" fill=\"{fill}\" {stroke}/>"));
    }

    pub fn text(&mut self, at: (f64, f64), size: f64, anchor: Anchor, text: &str) {
        self.styled_text(at, size, anchor, "", text);
    }

    pub fn bold(&mut self, at: (f64, f64), size: f64, anchor: Anchor, text: &str) {
        self.styled_text(at, size, anchor, " font-weight=\"bold\"", text);
    }

    /// Bold text in a colour, with a white edge that keeps lines off.
    pub fn coloured(&mut self, at: (f64, f64), size: f64, colour: &str, text: &str) {
        // The edge is text of its own: not every viewer draws it below the letters (paint-order).
        let edge = " font-weight=\"bold\" fill=\"white\" stroke=\"white\" stroke-width=\"2.5\"";
        self.styled_text(at, size, Anchor::Start, edge, text);
        self.styled_text(at, size, Anchor::Start, &format!(" font-weight=\"bold\" fill=\"{colour}\""), text);
    }

    /// Text that reads upwards.
    pub fn upright(&mut self, at: (f64, f64), size: f64, text: &str) {
        let turn = format!(" transform=\"rotate(-90 {:.2} {:.2})\"", at.0, at.1);
        self.styled_text(at, size, Anchor::Middle, &turn, text);
    }

    fn styled_text(&mut self, at: (f64, f64), size: f64, anchor: Anchor, style: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escape(text);
        self.push(format_args!(
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{style}>{text}</text>",
            at.0, at.1
        ));
    }

    /// A PNG picture, stretched over the area.
    pub fn image(&mut self, area: Area, png: &[u8]) {
        let Area { x, y, width, height } = area;
        let data = base64(png);
        self.push(format_args!(
            "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" \
             preserveAspectRatio=\"none\" href=\"data:image/png;base64,{data}\"/>"
        ));
    }

    /// What `draw` draws is cut at the area's edges.
    pub fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Self)) {
        let id = self.clips;
        self.clips += 1;
        let Area { x, y, width, height } = area;
        self.push(format_args!(
            "<clipPath id=\"clip{id}\"><rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/>\
             </clipPath><g clip-path=\"url(#clip{id})\">"
        ));
        draw(self);
        self.push(format_args!("</g>"));
    }

    /// What `draw` draws is one group of this class.
    pub fn group<T>(&mut self, class: &str, draw: impl FnOnce(&mut Self) -> T) -> T {
        self.push(format_args!("<g class=\"{class}\">"));
        let drawn = draw(self);
        self.push(format_args!("</g>"));
        drawn
    }

    /// The whole document, on white.
    pub fn document(&self, width: f64, height: f64) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FONT}\" fill=\"{INK}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n{}</svg>\n",
            self.body
        )
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }
}

/// At most `length` characters.
pub(super) fn shortened(text: &str, length: usize) -> String {
    if text.chars().count() <= length {
        return text.to_owned();
    }
    text.chars().take(length - 1).chain(std::iter::once('\u{2026}')).collect()
}

/// Width that a text takes, a little on the safe side for every font asked for.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.57 * size * text.chars().count() as f64
}

/// Base64 with padding (RFC 4648).
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
    use super::*;

    #[test]
    fn base64_follows_the_standard_examples() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn markup_in_text_is_escaped() {
        let mut svg = Svg::default();
        svg.text((0.0, 0.0), 10.0, Anchor::Start, "a<b & \"c\"");
        assert!(svg.document(1.0, 1.0).contains("a&lt;b &amp; &quot;c&quot;"));
    }

    #[test]
    fn a_gap_in_the_data_is_a_gap_in_the_line() {
        let mut svg = Svg::default();
        svg.path(&[(0.0, 0.0), (1.0, f64::NAN), (2.0, 2.0)], &Stroke::new("red", 1.0));
        assert!(svg.document(1.0, 1.0).contains("M0.00 0.00M2.00 2.00"));
    }
}
