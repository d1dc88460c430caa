//! Writes a picture as a PDF of one page: lines and areas are vectors, letters are filled outlines, images are embedded.

use std::collections::BTreeSet;

use libdeflater::{CompressionLvl, Compressor};
use pdf_writer::types::LineJoinStyle;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use tiny_skia::{LineJoin, Path, PathSegment, Pixmap, Point, PremultipliedColorU8};

use super::canvas::{self, Canvas, Line, Reason};
use super::drawing::{Area, Picture};
use super::origin::PROGRAM;

/// Points per px of 1/96 inch.
const POINTS: f32 = 0.75;

/// Miter limit, as the default of SVG.
const MITER_LIMIT: f32 = 4.0;

impl Picture {
    /// Returns the picture as a PDF file with one page of the size of the picture.
    ///
    /// # Errors
    /// A sentence with the reason, if an element cannot be drawn.
    pub fn pdf(&self) -> Result<Vec<u8>, Reason> {
        let [width, height] = [self.width, self.height].map(|size| size as f32 * POINTS);
        let mut page = Page { content: Content::new(), images: Vec::new(), opacities: BTreeSet::new() };
        page.content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height]);
        canvas::draw(self, &mut page)?;
        Ok(page.document(width, height))
    }
}

fn compressed(data: &[u8]) -> Vec<u8> {
    let mut compressor = Compressor::new(CompressionLvl::default());
    let mut compressed = vec![0; compressor.zlib_compress_bound(data.len())];
    let length = compressor.zlib_compress(data, &mut compressed).expect("room for the longest result");
    compressed.truncate(length);
    compressed
}

/// Content of the page so far.
struct Page {
    content: Content,
    images: Vec<Pixmap>,
    /// Opacities used so far, in thousandths.
    opacities: BTreeSet<u16>,
}

fn image_name(index: usize) -> String {
    format!("picture{index}")
}

fn opacity_name(thousandths: u16) -> String {
    format!("opacity{thousandths}")
}

impl Canvas for Page {
    fn fill(&mut self, path: &Path, colour: [u8; 3]) {
        let [r, g, b] = colour.map(|part| f32::from(part) / 255.0);
        self.opacity(1.0);
        self.content.set_fill_rgb(r, g, b);
        self.outline(path);
        self.content.fill_nonzero();
    }

    fn draw(&mut self, path: &Path, line: &Line) {
        let [r, g, b] = line.colour.map(|part| f32::from(part) / 255.0);
        let join = match line.join {
            LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
            LineJoin::Round => LineJoinStyle::RoundJoin,
            LineJoin::Bevel => LineJoinStyle::BevelJoin,
        };
        self.opacity(line.opacity);
        self.content.set_stroke_rgb(r, g, b).set_line_width(line.width).set_line_join(join);
        self.content.set_miter_limit(MITER_LIMIT).set_dash_pattern(line.dashes.iter().copied(), 0.0);
        self.outline(path);
        self.content.stroke();
    }

    fn image(&mut self, area: &Area, pixels: Pixmap) {
        let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(|number| number as f32);
        // A PDF image fills the unit square with its first row at the top.
        self.opacity(1.0);
        self.content.save_state().transform([width, 0.0, 0.0, -height, x, y + height]);
        self.content.x_object(Name(image_name(self.images.len()).as_bytes())).restore_state();
        self.images.push(pixels);
    }

    fn clip(&mut self, area: &Area) {
        let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(|number| number as f32);
        self.content.save_state().rect(x, y, width, height).clip_nonzero().end_path();
    }

    fn unclip(&mut self) {
        self.content.restore_state();
    }
}

impl Page {
    fn outline(&mut self, path: &Path) {
        let mut from = Point::zero();
        for segment in path.segments() {
            from = match segment {
                PathSegment::MoveTo(p) => {
                    let p = rounded(p);
                    self.content.move_to(p.x, p.y);
                    p
                }
                PathSegment::LineTo(p) => {
                    let p = rounded(p);
                    self.content.line_to(p.x, p.y);
                    p
                }
                // PDF has no quadratic curves; the cubic one is identical.
                PathSegment::QuadTo(control, p) => {
                    let third = |end: Point| {
                        let part = |end: f32, control: f32| end + (control - end) * 2.0 / 3.0;
                        Point::from_xy(part(end.x, control.x), part(end.y, control.y))
                    };
                    self.curve(third(from), third(p), p)
                }
                PathSegment::CubicTo(a, b, p) => self.curve(a, b, p),
                PathSegment::Close => {
                    self.content.close_path();
                    from
                }
            };
        }
    }

    fn curve(&mut self, a: Point, b: Point, p: Point) -> Point {
        let [a, b, p] = [a, b, p].map(rounded);
        self.content.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y);
        p
    }

    fn opacity(&mut self, opacity: f32) {
        let thousandths = (1000.0 * opacity).round() as u16;
        self.opacities.insert(thousandths);
        self.content.set_parameters(Name(opacity_name(thousandths).as_bytes()));
    }

    fn document(self, width: f32, height: f32) -> Vec<u8> {
        let [catalog, pages, page, contents] = [1, 2, 3, 4].map(Ref::new);
        let image = |index: usize| Ref::new(5 + index as i32);
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
        pdf.document_info(image(self.images.len())).producer(TextStr(PROGRAM));
        pdf.pages(pages).kids([page]).count(1);
        let mut written = pdf.page(page);
        written.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(contents);
        let mut resources = written.resources();
        let mut pictures = resources.x_objects();
        for index in 0..self.images.len() {
            pictures.pair(Name(image_name(index).as_bytes()), image(index));
        }
        pictures.finish();
        let mut states = resources.ext_g_states();
        for &thousandths in &self.opacities {
            let opacity = f32::from(thousandths) / 1000.0;
            let mut state = states.insert(Name(opacity_name(thousandths).as_bytes())).start();
            pdf_writer::writers::ExtGraphicsState::stroking_alpha(&mut state, opacity).non_stroking_alpha(opacity);
        }
        states.finish();
        resources.finish();
        written.finish();
        pdf.stream(contents, &compressed(&self.content.finish())).filter(Filter::FlateDecode);
        for (index, pixels) in self.images.iter().enumerate() {
            let data = compressed(&on_white(pixels));
            let mut picture = pdf.image_xobject(image(index), &data);
            picture.filter(Filter::FlateDecode);
            picture.width(pixels.width() as i32).height(pixels.height() as i32).bits_per_component(8);
            picture.color_space().device_rgb();
        }
        pdf.finish()
    }
}

/// Returns red, green and blue of each pixel, blended with a white background.
fn on_white(pixels: &Pixmap) -> Vec<u8> {
    let opaque = |p: &PremultipliedColorU8| [p.red(), p.green(), p.blue()].map(|part| part + (255 - p.alpha()));
    pixels.pixels().iter().flat_map(opaque).collect()
}

/// Rounds to a hundredth of a px: outlines of letters have many points, and finer differences are invisible.
fn rounded(p: Point) -> Point {
    Point::from_xy((100.0 * p.x).round() / 100.0, (100.0 * p.y).round() / 100.0)
}
