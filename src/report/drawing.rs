//! Elements of figures: lines, areas, text and images. Sizes are in px of 1/96 inch; y points down.
//!
//! A [`Picture`] is written as SVG by [`super::svg`], as PNG by [`super::png`] and as PDF by [`super::pdf`].

/// Colours by role. An HTML page replaces each by a counterpart in dark mode.
pub(super) const INK: &str = "#222";
pub(super) const PAPER: &str = "white";
pub(super) const BORDER: &str = "#444";
pub(super) const GRID: &str = "#e0e0e0";
pub(super) const FINE: &str = "#f2f2f2";
pub(super) const RUPTURE: &str = "#b2182b";
pub(super) const THEORY: &str = "#777";

/// Finished drawing on a white background.
#[derive(Debug, Clone)]
pub struct Picture {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) elements: Vec<Element>,
    /// Number of the picture among those of a page; it keeps the identifiers of its elements unique.
    pub(super) number: usize,
}

/// Drawing under construction.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    elements: Vec<Element>,
    number: usize,
}

/// Element of a drawing.
#[derive(Debug, Clone)]
pub(super) enum Element {
    /// Shape with an optional fill and outline.
    Shape {
        shape: Shape,
        fill: Option<String>,
        stroke: Option<Stroke>,
        note: Note,
    },
    Text(Text),
    /// PNG file, stretched over the area.
    Image {
        area: Area,
        png: Vec<u8>,
    },
    /// Elements that are clipped to the area.
    Clipped(Area, Vec<Element>),
    /// Elements grouped under a CSS class.
    Group(&'static str, Vec<Element>),
}

#[derive(Debug, Clone)]
pub(super) enum Shape {
    Rect(Area),
    Line([(f64, f64); 2]),
    /// Polyline; a point that is not finite interrupts it.
    Path(Vec<(f64, f64)>),
    Circle {
        centre: (f64, f64),
        radius: f64,
    },
    Polygon(Vec<(f64, f64)>),
}

/// Data that a shape carries for the script of a page.
#[derive(Debug, Clone)]
pub(super) enum Note {
    Nothing,
    /// Name of a line.
    Name(String),
    /// Attributes of a plot, as written in SVG.
    Attributes(String),
}

#[derive(Debug, Clone)]
pub(super) struct Text {
    pub at: (f64, f64),
    pub size: f64,
    pub anchor: Anchor,
    pub style: TextStyle,
    pub letters: String,
}

/// Style of a text.
#[derive(Debug, Clone)]
pub(super) enum TextStyle {
    Plain,
    Bold,
    /// Rotated by 90 degrees, reading upwards.
    Upright,
    /// Bold, in this colour.
    Coloured(String),
    /// White outline that is drawn behind bold text.
    Edge,
}

/// Line width of the white outline of text, px.
pub(super) const EDGE: f64 = 2.5;

/// Alignment of a text relative to its point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Style of a line.
#[derive(Debug, Clone)]
pub(super) struct Stroke {
    pub colour: String,
    pub width: f64,
    /// Lengths of dashes and of the gaps between them, as in SVG; empty for a solid line.
    pub dash: &'static str,
    /// Opacity, 0 to 1.
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
}

/// Rectangle; x and y are those of its upper left corner.
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

impl Drawing {
    /// Creates a drawing for a page that holds several pictures, each with a number of its own.
    pub fn of_page(number: usize) -> Self {
        Self { number, ..Self::default() }
    }

    pub fn rect(&mut self, area: Area, fill: &str, stroke: Option<&Stroke>) {
        self.shape(Shape::Rect(area), Some(fill), stroke, Note::Nothing);
    }

    /// Draws the border of an area.
    pub fn outline(&mut self, area: Area, stroke: &Stroke) {
        self.shape(Shape::Rect(area), None, Some(stroke), Note::Nothing);
    }

    /// Draws the border of a plot, with attributes from which a script can convert pixels to values.
    pub fn frame(&mut self, area: Area, stroke: &Stroke, attributes: String) {
        self.shape(Shape::Rect(area), None, Some(stroke), Note::Attributes(attributes));
    }

    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: &Stroke) {
        self.shape(Shape::Line([from, to]), None, Some(stroke), Note::Nothing);
    }

    /// Draws a polyline; a point that is not finite interrupts it.
    pub fn path(&mut self, points: &[(f64, f64)], stroke: &Stroke) {
        self.named_path("", points, stroke);
    }

    /// Draws a polyline whose name is available to the script of a page.
    pub fn named_path(&mut self, name: &str, points: &[(f64, f64)], stroke: &Stroke) {
        let note = if name.is_empty() { Note::Nothing } else { Note::Name(name.into()) };
        if points.iter().any(is_finite) {
            self.shape(Shape::Path(points.into()), None, Some(stroke), note);
        }
    }

    pub fn circle(&mut self, centre: (f64, f64), radius: f64, fill: &str, stroke: &Stroke) {
        self.shape(Shape::Circle { centre, radius }, Some(fill), Some(stroke), Note::Nothing);
    }

    /// Draws a closed polygon.
    pub fn polygon(&mut self, corners: &[(f64, f64)], fill: &str, stroke: &Stroke) {
        self.shape(Shape::Polygon(corners.into()), Some(fill), Some(stroke), Note::Nothing);
    }

    fn shape(&mut self, shape: Shape, fill: Option<&str>, stroke: Option<&Stroke>, note: Note) {
        self.elements.push(Element::Shape { shape, fill: fill.map(Into::into), stroke: stroke.cloned(), note });
    }

    pub fn text(&mut self, at: (f64, f64), size: f64, anchor: Anchor, text: &str) {
        self.styled(at, size, anchor, TextStyle::Plain, text);
    }

    pub fn bold(&mut self, at: (f64, f64), size: f64, anchor: Anchor, text: &str) {
        self.styled(at, size, anchor, TextStyle::Bold, text);
    }

    /// Draws bold text in a colour, with a white outline that separates it from lines behind it.
    pub fn coloured(&mut self, at: (f64, f64), size: f64, colour: &str, text: &str) {
        // The outline is a separate text element: not every viewer draws it below the letters (paint-order).
        self.styled(at, size, Anchor::Start, TextStyle::Edge, text);
        self.styled(at, size, Anchor::Start, TextStyle::Coloured(colour.into()), text);
    }

    /// Draws text that reads upwards, centred at the point.
    pub fn upright(&mut self, at: (f64, f64), size: f64, text: &str) {
        self.styled(at, size, Anchor::Middle, TextStyle::Upright, text);
    }

    fn styled(&mut self, at: (f64, f64), size: f64, anchor: Anchor, style: TextStyle, text: &str) {
        self.elements.push(Element::Text(Text { at, size, anchor, style, letters: text.into() }));
    }

    /// Draws a PNG file, stretched over the area.
    pub fn image(&mut self, area: Area, png: Vec<u8>) {
        self.elements.push(Element::Image { area, png });
    }

    /// Adds the elements that `draw` draws, clipped to the area.
    pub fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Self)) {
        let ((), elements) = self.apart(draw);
        self.elements.push(Element::Clipped(area, elements));
    }

    /// Adds the elements that `draw` draws as one group of this CSS class.
    pub fn group<T>(&mut self, class: &'static str, draw: impl FnOnce(&mut Self) -> T) -> T {
        let (drawn, elements) = self.apart(draw);
        self.elements.push(Element::Group(class, elements));
        drawn
    }

    /// Returns the elements that `draw` draws without adding them to the drawing.
    fn apart<T>(&mut self, draw: impl FnOnce(&mut Self) -> T) -> (T, Vec<Element>) {
        let outer = std::mem::take(&mut self.elements);
        let drawn = draw(self);
        (drawn, std::mem::replace(&mut self.elements, outer))
    }

    /// Finishes the picture, which gets this size in px.
    pub fn finish(self, width: f64, height: f64) -> Picture {
        Picture { width: width.round(), height: height.round(), elements: self.elements, number: self.number }
    }
}

/// Returns true if both coordinates are finite.
pub(super) fn is_finite(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Returns the text cut to at most `length` characters, the last one an ellipsis if it was cut.
pub(super) fn shortened(text: &str, length: usize) -> String {
    if text.chars().count() <= length {
        return text.to_owned();
    }
    text.chars().take(length - 1).chain(std::iter::once('\u{2026}')).collect()
}

/// Returns the estimated width of a text, px: slightly more than the actual width in each of the fonts of the SVG.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.57 * size * text.chars().count() as f64
}
