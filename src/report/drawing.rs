//! What figures are made of: lines, areas, text, images. Sizes are in px of 1/96 inch; y is downwards.
//!
//! A [`Picture`] is written as SVG by [`super::svg`], as PNG by [`super::png`] and as PDF by [`super::pdf`].

/// Colours with a role. A page gives each its counterpart for the dark, so that pictures use no others for it.
pub(super) const INK: &str = "#222";
pub(super) const PAPER: &str = "white";
pub(super) const BORDER: &str = "#444";
pub(super) const GRID: &str = "#e0e0e0";
pub(super) const FINE: &str = "#f2f2f2";
pub(super) const RUPTURE: &str = "#b2182b";
pub(super) const THEORY: &str = "#777";

/// A finished drawing, on white.
#[derive(Debug, Clone)]
pub struct Picture {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) elements: Vec<Element>,
    /// Among the pictures of one page.
    pub(super) number: usize,
}

/// A drawing under construction.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    elements: Vec<Element>,
    number: usize,
}

/// A part of a drawing.
#[derive(Debug, Clone)]
pub(super) enum Element {
    /// Its area and its outline.
    Shape {
        shape: Shape,
        fill: Option<String>,
        stroke: Option<Stroke>,
        note: Note,
    },
    Text(Text),
    /// A PNG file, stretched over the area.
    Image {
        area: Area,
        png: Vec<u8>,
    },
    /// Elements that are cut at the area's edges.
    Clipped(Area, Vec<Element>),
    /// Elements of this class.
    Group(&'static str, Vec<Element>),
}

#[derive(Debug, Clone)]
pub(super) enum Shape {
    Rect(Area),
    Line([(f64, f64); 2]),
    /// A point that is not finite interrupts it.
    Path(Vec<(f64, f64)>),
    Circle {
        centre: (f64, f64),
        radius: f64,
    },
    Polygon(Vec<(f64, f64)>),
}

/// What a shape tells the script of a page.
#[derive(Debug, Clone)]
pub(super) enum Note {
    Nothing,
    /// The name of a line.
    Name(String),
    /// Attributes of a plot, as they stand in SVG.
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

/// A text's look.
#[derive(Debug, Clone)]
pub(super) enum TextStyle {
    Plain,
    Bold,
    /// It reads upwards.
    Upright,
    /// Bold, in this colour.
    Coloured(String),
    /// The white edge of bold text, below it.
    Edge,
}

/// Width of the white edge of text.
pub(super) const EDGE: f64 = 2.5;

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
    /// Lengths of dashes and of the gaps between them, as in SVG; empty for a full line.
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

impl Drawing {
    /// A drawing that stands on one page with others of other numbers.
    pub fn of_page(number: usize) -> Self {
        Self { number, ..Self::default() }
    }

    pub fn rect(&mut self, area: Area, fill: &str, stroke: Option<&Stroke>) {
        self.shape(Shape::Rect(area), Some(fill), stroke, Note::Nothing);
    }

    /// The border of an area.
    pub fn outline(&mut self, area: Area, stroke: &Stroke) {
        self.shape(Shape::Rect(area), None, Some(stroke), Note::Nothing);
    }

    /// The border of a plot, with the attributes that tell a script what its pixels mean.
    pub fn frame(&mut self, area: Area, stroke: &Stroke, attributes: String) {
        self.shape(Shape::Rect(area), None, Some(stroke), Note::Attributes(attributes));
    }

    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: &Stroke) {
        self.shape(Shape::Line([from, to]), None, Some(stroke), Note::Nothing);
    }

    /// A line through points; a point that is not finite interrupts it.
    pub fn path(&mut self, points: &[(f64, f64)], stroke: &Stroke) {
        self.named_path("", points, stroke);
    }

    /// A line that tells a script its name.
    pub fn named_path(&mut self, name: &str, points: &[(f64, f64)], stroke: &Stroke) {
        let note = if name.is_empty() { Note::Nothing } else { Note::Name(name.into()) };
        if points.iter().any(is_finite) {
            self.shape(Shape::Path(points.into()), None, Some(stroke), note);
        }
    }

    pub fn circle(&mut self, centre: (f64, f64), radius: f64, fill: &str, stroke: &Stroke) {
        self.shape(Shape::Circle { centre, radius }, Some(fill), Some(stroke), Note::Nothing);
    }

    /// A closed area.
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

    /// Bold text in a colour, with a white edge that keeps lines off.
    pub fn coloured(&mut self, at: (f64, f64), size: f64, colour: &str, text: &str) {
        // The edge is text of its own: not every viewer draws it below the letters (paint-order).
        self.styled(at, size, Anchor::Start, TextStyle::Edge, text);
        self.styled(at, size, Anchor::Start, TextStyle::Coloured(colour.into()), text);
    }

    /// Text that reads upwards.
    pub fn upright(&mut self, at: (f64, f64), size: f64, text: &str) {
        self.styled(at, size, Anchor::Middle, TextStyle::Upright, text);
    }

    fn styled(&mut self, at: (f64, f64), size: f64, anchor: Anchor, style: TextStyle, text: &str) {
        self.elements.push(Element::Text(Text { at, size, anchor, style, letters: text.into() }));
    }

    /// A PNG file, stretched over the area.
    pub fn image(&mut self, area: Area, png: Vec<u8>) {
        self.elements.push(Element::Image { area, png });
    }

    /// What `draw` draws is cut at the area's edges.
    pub fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Self)) {
        let ((), elements) = self.apart(draw);
        self.elements.push(Element::Clipped(area, elements));
    }

    /// What `draw` draws is one group of this class.
    pub fn group<T>(&mut self, class: &'static str, draw: impl FnOnce(&mut Self) -> T) -> T {
        let (drawn, elements) = self.apart(draw);
        self.elements.push(Element::Group(class, elements));
        drawn
    }

    /// What `draw` draws, which is not part of the drawing yet.
    fn apart<T>(&mut self, draw: impl FnOnce(&mut Self) -> T) -> (T, Vec<Element>) {
        let outer = std::mem::take(&mut self.elements);
        let drawn = draw(self);
        (drawn, std::mem::replace(&mut self.elements, outer))
    }

    /// The whole picture, of a size in px.
    pub fn finish(self, width: f64, height: f64) -> Picture {
        Picture { width: width.round(), height: height.round(), elements: self.elements, number: self.number }
    }
}

/// Both coordinates are numbers.
pub(super) fn is_finite(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
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
