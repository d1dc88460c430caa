//! SVG as a PDF of one page: lines and areas stay vectors, letters become areas, maps stay pictures.
//!
//! Written is what figures are made of; anything else (gradients, masks, filters) is an error, never a figure with something missing.

use std::collections::BTreeSet;

use libdeflater::{CompressionLvl, Compressor};
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref};
use resvg::tiny_skia::{PathSegment, Pixmap, Point};
use resvg::usvg;
use usvg::{Group, ImageKind, Node, Paint, Transform};

/// Points for each px of 1/96 inch.
const POINTS: f32 = 0.75;

/// What is wrong with a picture.
type Reason = String;

/// A document of one page as large as the drawing.
///
/// # Errors
/// A message: the drawing has an element that is not supported.
pub(super) fn pdf(tree: &usvg::Tree) -> Result<Vec<u8>, Reason> {
    let (width, height) = (tree.size().width() * POINTS, tree.size().height() * POINTS);
    let mut page = Page { content: Content::new(), images: Vec::new(), opacities: BTreeSet::new() };
    page.content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height]);
    page.group(tree.root())?;
    Ok(page.document(width, height))
}

fn compressed(data: &[u8]) -> Vec<u8> {
    let mut compressor = Compressor::new(CompressionLvl::default());
    let mut compressed = vec![0; compressor.zlib_compress_bound(data.len())];
    let length = compressor.zlib_compress(data, &mut compressed).expect("room for the longest result");
    compressed.truncate(length);
    compressed
}

/// What is on the page so far.
struct Page {
    content: Content,
    images: Vec<Pixmap>,
    /// In thousandths.
    opacities: BTreeSet<u16>,
}

fn image_name(index: usize) -> String {
    format!("picture{index}")
}

fn opacity_name(thousandths: u16) -> String {
    format!("opacity{thousandths}")
}

fn matrix(t: Transform) -> [f32; 6] {
    [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty]
}

impl Page {
    fn group(&mut self, group: &Group) -> Result<(), Reason> {
        if group.mask().is_some() || !group.filters().is_empty() || group.opacity() != usvg::Opacity::ONE {
            return Err("masks, filters and opacity of groups cannot be written as PDF".into());
        }
        self.content.save_state();
        self.content.transform(matrix(group.transform()));
        if let Some(clip) = group.clip_path() {
            self.clip(clip)?;
        }
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group)?,
                Node::Path(path) if path.is_visible() => self.path(path)?,
                Node::Text(text) => self.group(text.flattened())?,
                Node::Image(image) if image.is_visible() => self.image(image)?,
                Node::Path(_) | Node::Image(_) => {}
            }
        }
        self.content.restore_state();
        Ok(())
    }

    /// What comes after, up to the end of the group, is cut at the edges of the paths.
    fn clip(&mut self, clip: &usvg::ClipPath) -> Result<(), Reason> {
        for node in clip.root().children() {
            let Node::Path(path) = node else {
                return Err("only paths can clip in a PDF".into());
            };
            self.outline(path.data().clone().transform(clip.transform().pre_concat(path.abs_transform())).as_ref());
        }
        self.content.clip_nonzero().end_path();
        Ok(())
    }

    fn outline(&mut self, path: Option<&resvg::tiny_skia::Path>) {
        let mut from = (0.0, 0.0);
        for segment in path.iter().flat_map(|path| path.segments()).map(rounded) {
            match segment {
                PathSegment::MoveTo(p) => self.content.move_to(p.x, p.y),
                PathSegment::LineTo(p) => self.content.line_to(p.x, p.y),
                // PDF has no curves of the second degree.
                PathSegment::QuadTo(c, p) => {
                    let third = |end: f32, control: f32| end + (control - end) * 2.0 / 3.0;
                    let (x1, y1) = (third(from.0, c.x), third(from.1, c.y));
                    self.content.cubic_to(x1, y1, third(p.x, c.x), third(p.y, c.y), p.x, p.y)
                }
                PathSegment::CubicTo(a, b, p) => self.content.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y),
                PathSegment::Close => self.content.close_path(),
            };
            if let PathSegment::MoveTo(p)
            | PathSegment::LineTo(p)
            | PathSegment::QuadTo(_, p)
            | PathSegment::CubicTo(.., p) = segment
            {
                from = (p.x, p.y);
            }
        }
    }

    fn path(&mut self, path: &usvg::Path) -> Result<(), Reason> {
        if let Some(fill) = path.fill() {
            let [r, g, b] = rgb(fill.paint())?;
            self.opacity(fill.opacity());
            self.content.set_fill_rgb(r, g, b);
            self.outline(Some(path.data()));
            match fill.rule() {
                usvg::FillRule::NonZero => self.content.fill_nonzero(),
                usvg::FillRule::EvenOdd => self.content.fill_even_odd(),
            };
        }
        if let Some(stroke) = path.stroke() {
            let [r, g, b] = rgb(stroke.paint())?;
            self.opacity(stroke.opacity());
            self.content.set_stroke_rgb(r, g, b).set_line_width(stroke.width().get());
            self.content.set_line_cap(cap(stroke.linecap())).set_line_join(join(stroke.linejoin()));
            self.content.set_miter_limit(stroke.miterlimit().get());
            let dashes = stroke.dasharray().unwrap_or_default();
            self.content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
            self.outline(Some(path.data()));
            self.content.stroke();
        }
        Ok(())
    }

    fn opacity(&mut self, opacity: usvg::Opacity) {
        let thousandths = (1000.0 * opacity.get()).round() as u16;
        self.opacities.insert(thousandths);
        self.content.set_parameters(Name(opacity_name(thousandths).as_bytes()));
    }

    fn image(&mut self, image: &usvg::Image) -> Result<(), Reason> {
        let ImageKind::PNG(data) = image.kind() else {
            return Err("only PNG pictures can be written as PDF".into());
        };
        let pixels = Pixmap::decode_png(data).map_err(|e| e.to_string())?;
        let (width, height) = (image.size().width(), image.size().height());
        // A picture of PDF fills the unit square, and its first row is on top.
        self.opacity(usvg::Opacity::ONE);
        self.content.save_state().transform([width, 0.0, 0.0, -height, 0.0, height]);
        self.content.x_object(Name(image_name(self.images.len()).as_bytes())).restore_state();
        self.images.push(pixels);
        Ok(())
    }

    fn document(self, width: f32, height: f32) -> Vec<u8> {
        let [catalog, pages, page, contents] = [1, 2, 3, 4].map(Ref::new);
        let image = |index: usize| Ref::new(5 + index as i32);
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
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

/// Red, green and blue of each pixel, on white paper.
fn on_white(pixels: &Pixmap) -> Vec<u8> {
    let opaque = |p: &resvg::tiny_skia::PremultipliedColorU8| {
        [p.red(), p.green(), p.blue()].map(|part| part + (255 - p.alpha()))
    };
    pixels.pixels().iter().flat_map(opaque).collect()
}

/// Coordinates to a hundredth of a px: letters have many, and nobody sees more.
fn rounded(segment: PathSegment) -> PathSegment {
    let round = |p: Point| Point::from_xy((100.0 * p.x).round() / 100.0, (100.0 * p.y).round() / 100.0);
    match segment {
        PathSegment::MoveTo(p) => PathSegment::MoveTo(round(p)),
        PathSegment::LineTo(p) => PathSegment::LineTo(round(p)),
        PathSegment::QuadTo(c, p) => PathSegment::QuadTo(round(c), round(p)),
        PathSegment::CubicTo(a, b, p) => PathSegment::CubicTo(round(a), round(b), round(p)),
        PathSegment::Close => PathSegment::Close,
    }
}

fn rgb(paint: &Paint) -> Result<[f32; 3], Reason> {
    match paint {
        Paint::Color(c) => Ok([c.red, c.green, c.blue].map(|part| f32::from(part) / 255.0)),
        _ => Err("gradients and patterns cannot be written as PDF".into()),
    }
}

fn cap(cap: usvg::LineCap) -> LineCapStyle {
    match cap {
        usvg::LineCap::Butt => LineCapStyle::ButtCap,
        usvg::LineCap::Round => LineCapStyle::RoundCap,
        usvg::LineCap::Square => LineCapStyle::ProjectingSquareCap,
    }
}

fn join(join: usvg::LineJoin) -> LineJoinStyle {
    match join {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => LineJoinStyle::MiterJoin,
        usvg::LineJoin::Round => LineJoinStyle::RoundJoin,
        usvg::LineJoin::Bevel => LineJoinStyle::BevelJoin,
    }
}
