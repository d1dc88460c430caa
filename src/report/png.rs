//! Writes a picture as PNG.

use tiny_skia::{
    Color, FillRule, FilterQuality, Mask, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Stroke, StrokeDash, Transform,
};

use super::canvas::{self, Canvas, Line, Reason, rect};
use super::drawing::{Area, Picture};
use super::origin::PROGRAM;

impl Picture {
    /// Returns the picture as a PNG file with `scale` pixels per px of the drawing.
    ///
    /// # Errors
    /// A sentence, if the picture has no size or is too large for memory, or if an element cannot be drawn.
    pub fn png(&self, scale: f32) -> Result<Vec<u8>, Reason> {
        let [width, height] = [self.width, self.height].map(|size| (size as f32 * scale).ceil() as u32);
        let pixels = Pixmap::new(width, height).ok_or("the picture has no size, or is too large for memory")?;
        let mut canvas = Sheet { pixels, scale: Transform::from_scale(scale, scale), clips: Vec::new() };
        canvas.pixels.fill(Color::WHITE);
        canvas::draw(self, &mut canvas)?;
        canvas.pixels.encode_png().map(with_origin).map_err(|e| e.to_string())
    }
}

/// Adds the text chunk that names the program to a PNG file, behind its signature (8 bytes) and header chunk (25 bytes).
fn with_origin(mut png: Vec<u8>) -> Vec<u8> {
    let text = [b"tEXtSoftware\0", PROGRAM.as_bytes()].concat();
    // The length of a chunk does not include its type, of four bytes.
    let length = (text.len() - 4) as u32;
    let chunk = [&length.to_be_bytes(), &text[..], &libdeflater::crc32(&text).to_be_bytes()].concat();
    png.splice(33..33, chunk);
    png
}

struct Sheet {
    pixels: Pixmap,
    scale: Transform,
    /// Active clipping regions, the innermost one last; each is the intersection with all outer ones.
    clips: Vec<Option<Mask>>,
}

impl Sheet {
    fn paint([r, g, b]: [u8; 3], opacity: f32) -> Paint<'static> {
        let mut paint = Paint::default();
        paint.set_color_rgba8(r, g, b, (255.0 * opacity).round() as u8);
        paint
    }
}

impl Canvas for Sheet {
    fn fill(&mut self, path: &Path, colour: [u8; 3]) {
        let clip = self.clips.last().and_then(Option::as_ref);
        self.pixels.fill_path(path, &Self::paint(colour, 1.0), FillRule::Winding, self.scale, clip);
    }

    fn draw(&mut self, path: &Path, line: &Line) {
        let clip = self.clips.last().and_then(Option::as_ref);
        let dash = StrokeDash::new(line.dashes.clone(), 0.0);
        let stroke = Stroke { width: line.width, line_join: line.join, dash, ..Stroke::default() };
        self.pixels.stroke_path(path, &Self::paint(line.colour, line.opacity), &stroke, self.scale, clip);
    }

    fn image(&mut self, area: &Area, pixels: Pixmap) {
        let clip = self.clips.last().and_then(Option::as_ref);
        let stretch = [area.width / f64::from(pixels.width()), area.height / f64::from(pixels.height())];
        let place = Transform::from_scale(stretch[0] as f32, stretch[1] as f32)
            .post_translate(area.x as f32, area.y as f32)
            .post_concat(self.scale);
        let paint = PixmapPaint { quality: FilterQuality::Bicubic, ..PixmapPaint::default() };
        self.pixels.draw_pixmap(0, 0, pixels.as_ref(), &paint, place, clip);
    }

    fn clip(&mut self, area: &Area) {
        let outer = self.clips.last().cloned().flatten();
        let mut mask = Mask::new(self.pixels.width(), self.pixels.height());
        if let (Some(mask), Some(path)) = (&mut mask, rect(area).map(PathBuilder::from_rect)) {
            match outer {
                Some(outer) => {
                    *mask = outer;
                    mask.intersect_path(&path, FillRule::Winding, true, self.scale);
                }
                None => mask.fill_path(&path, FillRule::Winding, true, self.scale),
            }
        }
        self.clips.push(mask);
    }

    fn unclip(&mut self) {
        self.clips.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Anchor, Drawing};
    use super::*;

    /// Counts the dark pixels of a drawing of 60 by 20 px.
    fn ink(draw: impl FnOnce(&mut Drawing)) -> usize {
        let mut drawing = Drawing::default();
        draw(&mut drawing);
        let picture = drawing.finish(60.0, 20.0).png(1.0).expect("a picture");
        let pixels = Pixmap::decode_png(&picture).expect("it is PNG");
        pixels.pixels().iter().filter(|p| p.red() < 128).count()
    }

    #[test]
    fn text_leaves_ink() {
        assert_eq!(ink(|_| {}), 0);
        let text = ink(|drawing| drawing.text((2.0, 15.0), 12.0, Anchor::Start, "stress"));
        assert!(text > 50, "{text}");
    }

    #[test]
    fn what_is_clipped_ends_at_the_edges() {
        let area = |x: f64, width: f64| Area { x, y: 0.0, width, height: 10.0 };
        let fill = |drawing: &mut Drawing| drawing.rect(area(0.0, 60.0), "black", None);
        assert_eq!(ink(fill), 600);
        assert_eq!(ink(|drawing| drawing.clipped(area(10.0, 20.0), fill)), 200);
        let nested = |drawing: &mut Drawing| drawing.clipped(area(20.0, 30.0), fill);
        assert_eq!(ink(|drawing| drawing.clipped(area(10.0, 20.0), nested)), 100);
    }
}
