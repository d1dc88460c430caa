//! The x-t diagram: a field as colours over the bar and time, one embedded picture, with fronts and gauges on top.

use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

use super::axes::{self, Axis, Frame};
use super::colour::{Range, hex};
use super::display::field_name;
use super::svg::{Anchor, Area, Stroke, Svg, text_width};
use super::view::{View, nearest};
use crate::error::{Error, Result};
use crate::record::{FrontRow, PathRow};

/// Pixels of the picture for each unit of the drawing: sharp in print without a large file.
const FINENESS: f64 = 2.0;
/// Room for the colour bar, px.
const BAR_ROOM: f64 = 104.0;

/// Draws the diagram: x to the right, time upwards.
pub(super) fn draw(svg: &mut Svg, panel: Area, view: &View) -> Result<()> {
    let (time, length) = (view.time_unit(), view.length_unit());
    let name = field_name(view.field);
    axes::title(svg, panel, &format!("(a)  {name} over the bar and time"));
    let frame = Frame {
        plot: axes::plot_area(panel, 1, BAR_ROOM),
        x: Axis::new(length.label("position x"), 0.0, view.length * length.factor),
        y: Axis::new(time.label("time"), 0.0, view.end_time * time.factor),
    };
    let (picture, range) = picture(&frame, view)?;
    svg.image(frame.plot, &picture);
    let lines = draw_lines(svg, &frame, view)?;
    draw_gauges(svg, &frame, view)?;
    frame.draw(svg, false);
    legend(svg, panel, lines);
    colour_bar(svg, &frame, &range, &view.field_unit().label(name));
    Ok(())
}

/// The nearest frame for each row of pixels and the nearest sample for each column; NaN and no time yet are grey.
fn picture(frame: &Frame, view: &View) -> Result<(Vec<u8>, Range)> {
    let (columns, rows) = ((frame.plot.width * FINENESS) as usize, (frame.plot.height * FINENESS) as usize);
    let samples: Vec<usize> =
        (0..columns).map(|i| nearest(&view.x, (i as f64 + 0.5) / columns as f64 * view.length)).collect();
    let frames: Vec<usize> =
        (0..rows).map(|i| nearest(&view.time, (1.0 - (i as f64 + 0.5) / rows as f64) * view.end_time)).collect();
    let lines = read_lines(view, &frames, &samples)?;
    let (low, high) = extremes(&lines);
    let range = Range::of(low, high);
    let mut pixels = Pixmap::new(columns as u32, rows as u32)
        .ok_or_else(|| Error::file(view.file.path(), "the picture has no size"))?;
    for (pixel, value) in pixels.pixels_mut().iter_mut().zip(lines.iter().flat_map(|line| line.iter())) {
        let [r, g, b] = range.colour(*value);
        if let Some(colour) = PremultipliedColorU8::from_rgba(r, g, b, 255) {
            *pixel = colour;
        }
    }
    let png = pixels.encode_png().map_err(|e| Error::file(view.file.path(), e))?;
    Ok((png, range))
}

/// One line of sampled values for each row of pixels, in shown units. Frames are read one at a time, each once: a
/// field may be larger than memory.
fn read_lines(view: &View, frames: &[usize], samples: &[usize]) -> Result<Vec<Vec<f64>>> {
    let factor = view.field_unit().factor;
    let mut lines: Vec<Vec<f64>> = Vec::with_capacity(frames.len());
    for (row, &index) in frames.iter().enumerate() {
        if row > 0 && frames[row - 1] == index {
            lines.push(lines[row - 1].clone());
            continue;
        }
        let values = view.file.field(view.field, index..index + 1)?;
        lines.push(samples.iter().map(|&i| values[(0, i)] * factor).collect());
    }
    Ok(lines)
}

fn extremes(lines: &[Vec<f64>]) -> (f64, f64) {
    let finite = lines.iter().flatten().filter(|v| v.is_finite());
    finite.fold((0.0, 0.0), |(low, high): (f64, f64), &v| (low.min(v), high.max(v)))
}

/// What was drawn over the map.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Lines {
    None,
    /// Theoretical speeds.
    Theory,
    /// The tracked fronts, all of them or the strongest.
    Tracked {
        all: bool,
    },
}

/// The fronts themselves where the file has them, otherwise lines at the speeds of theory.
fn draw_lines(svg: &mut Svg, frame: &Frame, view: &View) -> Result<Lines> {
    let paths = view.file.paths()?;
    if !paths.is_empty() {
        return Ok(Lines::Tracked { all: draw_paths(svg, frame, view, &paths) });
    }
    let fronts = view.file.fronts()?;
    Ok(if draw_fronts(svg, frame, view, &fronts) { Lines::Theory } else { Lines::None })
}

/// Most straight pieces that are drawn: more would hide the map.
const MOST_PATHS: usize = 4000;
/// Weights of line, from the strongest jump down, each for jumps this many times weaker than the one before.
const WEIGHTS: usize = 12;
const WEAKER: f64 = 1.5;
/// Pieces shorter than this, px, are not seen.
const SHORTEST: f64 = 0.4;

/// Draws the strongest and longest of the fronts' straight pieces, thicker and darker the larger the jump in stress; true where all
/// that could be seen are drawn.
fn draw_paths(svg: &mut Svg, frame: &Frame, view: &View, paths: &[PathRow]) -> bool {
    let (time, length) = (view.time_unit().factor, view.length_unit().factor);
    let ends = |p: &PathRow| [(p.x0, p.t0), (p.x1, p.t1)].map(|(x, t)| frame.place((x * length, t * time)));
    let size = |[a, b]: [(f64, f64); 2]| (a.0 - b.0).hypot(a.1 - b.1);
    let mut visible: Vec<(f64, [(f64, f64); 2])> = paths
        .iter()
        .map(|p| (p.stress_jump.abs(), ends(p)))
        .filter(|(jump, ends)| *jump > 0.0 && size(*ends) >= SHORTEST)
        .collect();
    let all = visible.len() <= MOST_PATHS;
    // Of a long weak front more is seen than of a short strong one.
    visible.sort_by(|a, b| (b.0 * size(b.1)).total_cmp(&(a.0 * size(a.1))));
    visible.truncate(MOST_PATHS);
    visible.sort_by(|a, b| b.0.total_cmp(&a.0));
    let strongest = visible.first().map_or(1.0, |p| p.0);
    let weight = |jump: f64| ((strongest / jump).ln() / WEAKER.ln()).min(WEIGHTS as f64 - 1.0) as usize;
    svg.clipped(frame.plot, |svg| {
        // The weak ones first: the strong ones lie on top.
        for class in visible.chunk_by(|a, b| weight(a.0) == weight(b.0)).rev() {
            let strength = 1.0 - weight(class[0].0) as f64 / WEIGHTS as f64;
            let points: Vec<(f64, f64)> = class.iter().flat_map(|(_, [a, b])| [*a, *b, (f64::NAN, f64::NAN)]).collect();
            svg.path(&points, &Stroke::new("white", 0.6 + 2.0 * strength).opacity(0.35 * strength));
            svg.path(&points, &Stroke::new("black", 0.25 + 1.25 * strength).opacity(0.12 + 0.88 * strength));
        }
    });
    all
}

/// Lines at the theoretical speeds, from where each front started to where it was last seen. Of lines that would end
/// closer together than this, px, only one is drawn: a smooth curve has dozens of fronts, which would hide the map.
const APART: f64 = 22.0;

/// Draws the fronts; true where there was one.
fn draw_fronts(svg: &mut Svg, frame: &Frame, view: &View, fronts: &[FrontRow]) -> bool {
    let (time, length) = (view.time_unit().factor, view.length_unit().factor);
    let mut last_end: Option<(f64, f64)> = None;
    svg.clipped(frame.plot, |svg| {
        for front in fronts.iter().filter(|f| f.last_seen.is_finite() && f.speed != 0.0) {
            let start = match front.origin.as_str() {
                "left" => 0.0,
                "right" => view.length,
                _ => front.position - front.speed * front.last_seen,
            };
            let end = start + front.speed * front.last_seen;
            let from = frame.place((start * length, 0.0));
            let to = frame.place((end * length, front.last_seen * time));
            if last_end.is_some_and(|last| (last.0 - to.0).hypot(last.1 - to.1) < APART) {
                continue;
            }
            last_end = Some(to);
            svg.line(from, to, &Stroke::new("white", 2.6));
            svg.line(from, to, &Stroke::new("black", 1.2).dashed("6 3"));
        }
    });
    last_end.is_some()
}

fn draw_gauges(svg: &mut Svg, frame: &Frame, view: &View) -> Result<()> {
    let mut free_from = f64::NEG_INFINITY;
    let mut gauges = view.file.gauges()?;
    gauges.sort_by(|a, b| a.x.total_cmp(&b.x));
    for gauge in &gauges {
        let x = frame.place((gauge.x * view.length_unit().factor, 0.0)).0;
        svg.line((x, frame.plot.y), (x, frame.plot.bottom()), &Stroke::new("white", 2.4));
        svg.line((x, frame.plot.y), (x, frame.plot.bottom()), &Stroke::new("#333", 1.2).dashed("1.5 3"));
        // A name that would run into the one before it is left out; the histories name every gauge.
        let half = text_width(&gauge.name, 11.0) / 2.0;
        if x - half > free_from {
            svg.text((x, frame.plot.y - 6.0), 11.0, Anchor::Middle, &gauge.name);
            free_from = x + half + 6.0;
        }
    }
    Ok(())
}

fn legend(svg: &mut Svg, panel: Area, lines: Lines) {
    let (text, stroke) = match lines {
        Lines::None => return,
        Lines::Theory => ("front speeds, theory", Stroke::new("black", 1.2).dashed("6 3")),
        Lines::Tracked { all: true } => ("fronts, by strength", Stroke::new("black", 1.4)),
        Lines::Tracked { all: false } => ("strongest fronts", Stroke::new("black", 1.4)),
    };
    let (x, y) = (panel.right() - text_width(text, 12.0) - 6.0, panel.y + 12.0);
    svg.line((x - 32.0, y), (x - 6.0, y), &stroke);
    svg.text((x, y + 4.0), 12.0, Anchor::Start, text);
}

fn colour_bar(svg: &mut Svg, frame: &Frame, range: &Range, label: &str) {
    const STEPS: usize = 128;
    let bar = Area { x: frame.plot.right() + 14.0, width: 16.0, ..frame.plot };
    let step = bar.height / STEPS as f64;
    for i in 0..STEPS {
        let value = range.low + (range.high - range.low) * (i as f64 + 0.5) / STEPS as f64;
        // A little overlap, or renderers leave hairlines between the steps.
        let area = Area { y: bar.bottom() - step * (i + 1) as f64, height: step + 0.6, ..bar };
        svg.rect(area, &hex(range.colour(value)), None);
    }
    let scale = Frame { plot: bar, x: Axis::new("", 0.0, 1.0), y: Axis::new(label, range.low, range.high) };
    scale.draw_right(svg);
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn nearest_takes_the_closer_neighbour_and_stays_inside() {
        let values = [0.5, 1.5, 2.5];
        let found: Vec<_> = [-1.0, 0.9, 1.1, 2.0, 9.0].iter().map(|t| nearest(&values, *t)).collect();
        assert_eq!(found, [0, 0, 1, 1, 2]);
    }
}
