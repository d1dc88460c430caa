//! Decomposes a picture into filled outlines and stroked lines, for PNG and PDF. Text is drawn with `DejaVu Sans`, which is part of the
//! program, so that pictures look the same on a machine without fonts.

use tiny_skia::{LineJoin, Path, PathBuilder, Pixmap, Rect, Transform};
use ttf_parser::{Face, OutlineBuilder};

use super::colour::rgb;
use super::drawing::{Anchor, Area, EDGE, Element, INK, PAPER, Picture, Shape, Stroke, Text, TextStyle, is_finite};

/// Sentence that states why a picture cannot be drawn.
pub(super) type Reason = String;

/// Target that a picture can be drawn on.
pub(super) trait Canvas {
    fn fill(&mut self, path: &Path, colour: [u8; 3]);
    fn draw(&mut self, path: &Path, line: &Line);
    /// Draws an image stretched over the area.
    fn image(&mut self, area: &Area, pixels: Pixmap);
    /// Starts a clipping region: everything drawn until [`Canvas::unclip`] is cut at the edges of the area.
    fn clip(&mut self, area: &Area);
    /// Ends the clipping region that was started last.
    fn unclip(&mut self);
}

/// Style of a stroked line.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub colour: [u8; 3],
    /// Opacity, 0 to 1.
    pub opacity: f32,
    pub width: f32,
    /// Lengths of dashes and gaps; empty for a solid line.
    pub dashes: Vec<f32>,
    pub join: LineJoin,
}

/// Draws a picture.
///
/// # Errors
/// A sentence with the reason, if an element cannot be drawn.
pub(super) fn draw(picture: &Picture, canvas: &mut impl Canvas) -> Result<(), Reason> {
    elements(&picture.elements, canvas)
}

fn elements(parts: &[Element], canvas: &mut impl Canvas) -> Result<(), Reason> {
    for part in parts {
        match part {
            Element::Shape { shape, fill, stroke, .. } => {
                let Some(path) = outline(shape) else { continue };
                if let Some(fill) = fill {
                    canvas.fill(&path, rgb(fill)?);
                }
                if let Some(stroke) = stroke {
                    canvas.draw(&path, &line(stroke, shape)?);
                }
            }
            Element::Text(text) => write(text, canvas)?,
            Element::Image { area, png } => canvas.image(area, Pixmap::decode_png(png).map_err(|e| e.to_string())?),
            Element::Clipped(area, parts) => {
                canvas.clip(area);
                elements(parts, canvas)?;
                canvas.unclip();
            }
            Element::Group(_, parts) => elements(parts, canvas)?,
        }
    }
    Ok(())
}

fn line(stroke: &Stroke, shape: &Shape) -> Result<Line, Reason> {
    Ok(Line {
        colour: rgb(&stroke.colour)?,
        opacity: stroke.opacity as f32,
        width: stroke.width as f32,
        dashes: stroke.dash.split(' ').filter_map(|length| length.parse().ok()).collect(),
        join: if matches!(shape, Shape::Path(_)) { LineJoin::Round } else { LineJoin::Miter },
    })
}

/// Returns the outline of a shape, or `None` if it is empty.
fn outline(shape: &Shape) -> Option<Path> {
    match shape {
        Shape::Rect(area) => rect(area).map(PathBuilder::from_rect),
        Shape::Line(ends) => through(ends, false),
        Shape::Path(points) => through(points, false),
        Shape::Circle { centre, radius } => PathBuilder::from_circle(centre.0 as f32, centre.1 as f32, *radius as f32),
        Shape::Polygon(corners) => through(corners, true),
    }
}

/// Returns the rectangle of an area, or `None` if the area is invalid, such as one of negative size.
pub(super) fn rect(area: &Area) -> Option<Rect> {
    Rect::from_xywh(area.x as f32, area.y as f32, area.width as f32, area.height as f32)
}

/// Returns straight lines through points; a point that is not finite interrupts them.
fn through(points: &[(f64, f64)], closed: bool) -> Option<Path> {
    let (mut path, mut pen_down) = (PathBuilder::new(), false);
    for point in points {
        let (x, y) = (point.0 as f32, point.1 as f32);
        match (is_finite(point), pen_down) {
            (true, true) => path.line_to(x, y),
            (true, false) => path.move_to(x, y),
            (false, _) => {}
        }
        pen_down = is_finite(point);
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn write(text: &Text, canvas: &mut impl Canvas) -> Result<(), Reason> {
    let Some(letters) = letters(text)? else { return Ok(()) };
    let colour = match &text.style {
        TextStyle::Plain | TextStyle::Bold | TextStyle::Upright => INK,
        TextStyle::Coloured(colour) => colour,
        TextStyle::Edge => PAPER,
    };
    canvas.fill(&letters, rgb(colour)?);
    if matches!(text.style, TextStyle::Edge) {
        let edge =
            Line { colour: rgb(PAPER)?, opacity: 1.0, width: EDGE as f32, dashes: Vec::new(), join: LineJoin::Miter };
        canvas.draw(&letters, &edge);
    }
    Ok(())
}

/// Returns the outlines of the letters of a text, or `None` if it is blank.
fn letters(text: &Text) -> Result<Option<Path>, Reason> {
    let font = match text.style {
        TextStyle::Plain | TextStyle::Upright => dejavu::sans::regular(),
        TextStyle::Bold | TextStyle::Coloured(_) | TextStyle::Edge => dejavu::sans::bold(),
    };
    let font = Face::parse(font, 0).map_err(|e| e.to_string())?;
    let mut pen = Pen { path: PathBuilder::new(), x: 0.0 };
    // As in SVG, consecutive spaces count as one.
    let words: Vec<&str> = text.letters.split_whitespace().collect();
    for letter in words.join(" ").chars() {
        // A character that the font lacks is drawn as the empty box of the font.
        let glyph = font.glyph_index(letter).unwrap_or_default();
        font.outline_glyph(glyph, &mut pen);
        pen.x += f32::from(font.glyph_hor_advance(glyph).unwrap_or_default());
    }
    let scale = text.size as f32 / f32::from(font.units_per_em());
    let start = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -0.5 * pen.x,
        Anchor::End => -pen.x,
    };
    let turn = if matches!(text.style, TextStyle::Upright) { -90.0 } else { 0.0 };
    let (x, y) = (text.at.0 as f32, text.at.1 as f32);
    let place = Transform::from_translate(start, 0.0).post_scale(scale, scale).post_rotate(turn).post_translate(x, y);
    Ok(pen.path.finish().and_then(|path| path.transform(place)))
}

/// Appends the outlines of letters along a baseline that starts at the origin, in font units, in which y points up.
struct Pen {
    path: PathBuilder,
    /// Position of the current letter on the baseline, font units.
    x: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, -y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, -y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + cx, -cy, self.x + x, -y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.path.cubic_to(self.x + ax, -ay, self.x + bx, -by, self.x + x, -y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a text written at (100, 50).
    fn written(anchor: Anchor, style: TextStyle, text: &str) -> Option<Rect> {
        let text = Text { at: (100.0, 50.0), size: 12.0, anchor, style, letters: text.into() };
        letters(&text).expect("the font").map(|path| path.bounds())
    }

    #[test]
    fn text_stands_where_it_is_anchored() {
        let [start, middle, end] =
            [Anchor::Start, Anchor::Middle, Anchor::End].map(|a| written(a, TextStyle::Plain, "HHHH").expect("ink"));
        assert!((100.0..102.0).contains(&start.left()) && (start.bottom() - 50.0).abs() < 0.01, "{start:?}");
        assert!((98.0..100.0).contains(&end.right()), "{end:?}");
        assert!((middle.left() + middle.right() - 200.0).abs() < 0.1, "{middle:?}");
        let upright = written(Anchor::Middle, TextStyle::Upright, "HHHH").expect("ink");
        assert!((upright.right() - 100.0).abs() < 0.01 && upright.height() == middle.width(), "{upright:?}");
        assert!(written(Anchor::Start, TextStyle::Bold, "HHHH").expect("ink").width() > start.width());
        assert!(written(Anchor::Start, TextStyle::Plain, " ").is_none());
    }
}
