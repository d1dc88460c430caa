//! The x-t diagram: a colour map of a field over position and time, as an embedded image with fronts, gauges and ruptures on top.

use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::axes::{self, Frame};
use super::axis::Axis;
use super::colour::{Range, hex};
use super::display::four_digits;
use super::drawing::{Anchor, Area, Drawing, INK, PAPER, RUPTURE, Stroke, text_width};
use super::panel::{Series, draw_legend, draw_series, legend_rows};
use super::view::{View, nearest};
use crate::error::{Error, Result};
use crate::record::store::Gauge;
use crate::record::{FrontRow, PathRow};

/// Pixels of the image for each px of the drawing: sharp in print without a large file.
const FINENESS: f64 = 2.0;
/// Width of the space for the colour bar, px.
const BAR_ROOM: f64 = 104.0;

/// Number of frames below which the field is not interpolated in time: each frame is a stripe.
const FEW_FRAMES: usize = 20;
/// Height of a stripe, px.
const STRIPE: f64 = 8.0;

pub(super) fn heading(view: &View) -> String {
    let (field, frames) = (view.field_name(), view.time.len());
    match frames {
        1 => format!("{field} over the bar at one time"),
        _ if is_sparse(view) => format!("{field} over the bar at {frames} times"),
        _ => format!("{field} over the bar and time"),
    }
}

fn is_sparse(view: &View) -> bool {
    view.time.len() < FEW_FRAMES
}

/// Draws the diagram with x to the right and time upwards.
pub(super) fn draw(drawing: &mut Drawing, panel: Area, view: &View, heading: &str) -> Result<()> {
    let (time, length) = (view.time_unit(), view.length_unit());
    let gauges = view.file.gauges()?;
    axes::title(drawing, panel, heading);
    let frame = Frame {
        // One row above the plot for the legend, and one for the names of the gauges.
        plot: axes::plot_area(panel, 1 + usize::from(!gauges.is_empty()), BAR_ROOM),
        x: Axis::new(length.label("position x"), 0.0, view.length * length.factor),
        y: Axis::new(time.label("time"), 0.0, view.end_time * time.factor),
    };
    let (picture, range, extremes) = picture(&frame, view)?;
    drawing.image(frame.plot, picture);
    let entries = drawing.group("on-map", |drawing| -> Result<_> {
        let mut entries = draw_lines(drawing, &frame, view)?;
        draw_gauges(drawing, &frame, view, gauges);
        entries.extend(draw_ruptures(drawing, &frame, view));
        Ok(entries)
    })?;
    frame.draw(drawing, false);
    draw_legend(drawing, panel, &legend_rows(&entries, panel.width));
    colour_bar(drawing, &frame, &range, extremes, &view.field_unit().label(view.field_name()));
    Ok(())
}

/// Returns the image as PNG, with the nearest frame for each row of pixels and the nearest sample for each column. NaN and times without a frame
/// are grey. Also returns the range of the colours and the extreme values.
fn picture(frame: &Frame, view: &View) -> Result<(Vec<u8>, Range, Extremes)> {
    let (columns, rows) = ((frame.plot.width * FINENESS) as usize, (frame.plot.height * FINENESS) as usize);
    let samples: Vec<usize> =
        (0..columns).map(|i| nearest(&view.x, (i as f64 + 0.5) / columns as f64 * view.length)).collect();
    let reach = if is_sparse(view) { 0.5 * STRIPE / frame.plot.height } else { f64::INFINITY };
    let frames: Vec<Option<usize>> = (0..rows)
        .map(|i| {
            let time = (1.0 - (i as f64 + 0.5) / rows as f64) * view.end_time;
            let index = nearest(&view.time, time);
            ((view.time[index] - time).abs() <= reach * view.end_time).then_some(index)
        })
        .collect();
    let lines = read_lines(view, &frames, &samples)?;
    let extremes = Extremes::of(lines.concat(), View::zero(view.field));
    let range = Range::of(extremes.shown[0], extremes.shown[1]);
    let mut pixels = Pixmap::new(columns as u32, rows as u32)
        .ok_or_else(|| Error::file(view.file.path(), "the picture has no size"))?;
    for (pixel, value) in pixels.pixels_mut().iter_mut().zip(lines.iter().flat_map(|line| line.iter())) {
        let [r, g, b] = range.colour(*value);
        if let Some(colour) = PremultipliedColorU8::from_rgba(r, g, b, 255) {
            *pixel = colour;
        }
    }
    let png = pixels.encode_png().map_err(|e| Error::file(view.file.path(), e))?;
    Ok((png, range, extremes))
}

/// Returns a line of sampled values in display units for each row of pixels. Frames are read one at a time, each once, since a field may be
/// larger than memory.
fn read_lines(view: &View, frames: &[Option<usize>], samples: &[usize]) -> Result<Vec<Vec<f64>>> {
    let factor = view.field_unit().factor;
    let mut lines: Vec<Vec<f64>> = Vec::with_capacity(frames.len());
    for (row, &frame) in frames.iter().enumerate() {
        if row > 0 && frames[row - 1] == frame {
            lines.push(lines[row - 1].clone());
            continue;
        }
        let Some(index) = frame else {
            lines.push(vec![f64::NAN; samples.len()]);
            continue;
        };
        let values = view.file.field(view.field, index..index + 1)?;
        lines.push(samples.iter().map(|&i| values[(0, i)] * factor).collect());
    }
    Ok(lines)
}

/// Extreme values of the field (`all`) and those at the ends of the colour range (`shown`). If the outermost thousandth of the pixels takes up
/// more than half of the range, the colour range leaves it out.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extremes {
    all: [f64; 2],
    shown: [f64; 2],
}

impl Extremes {
    /// Determines the extremes of the values, including `other` if given.
    fn of(mut values: Vec<f64>, other: Option<f64>) -> Self {
        /// One in this many pixels may be left out at either end.
        const FEW: usize = 1000;
        values.retain(|v| v.is_finite());
        if values.is_empty() {
            return Self { all: [0.0; 2], shown: [0.0; 2] };
        }
        let last = values.len() - 1;
        let mut value = |place: usize| *values.select_nth_unstable_by(place, f64::total_cmp).1;
        // `min` and `max` ignore a NaN argument.
        let other = other.unwrap_or(f64::NAN);
        let (low, high) = (value(0).min(other), value(last).max(other));
        let (inner_low, inner_high) = (value(last / FEW).min(other), value(last - last / FEW).max(other));
        let keep = |outer: f64, inner: f64| if (outer - inner).abs() > 0.5 * (high - low) { inner } else { outer };
        Self { all: [low, high], shown: [keep(low, inner_low), keep(high, inner_high)] }
    }
}

/// Draws the tracked fronts if the file has them, otherwise lines at the theoretical front speeds. Returns the legend entries.
fn draw_lines(drawing: &mut Drawing, frame: &Frame, view: &View) -> Result<Vec<Series>> {
    let paths = view.file.paths()?;
    if !paths.is_empty() {
        let name = if draw_paths(drawing, frame, view, &paths) { "fronts, by strength" } else { "strongest fronts" };
        return Ok(vec![Series::line(name, Vec::new(), Stroke::new("black", 1.4))]);
    }
    let drawn = draw_fronts(drawing, frame, view, &view.file.fronts()?);
    let stroke = Stroke::new("black", 1.2).dashed("6 3");
    Ok(drawn
        .then(|| Series::line(format!("front speeds, {}", view.theory()), Vec::new(), stroke))
        .into_iter()
        .collect())
}

/// Largest number of front segments that are drawn; more would hide the map.
const MOST_PATHS: usize = 4000;
/// Number of line weights, and ratio of the stress jumps of successive weights; the strongest jump has the heaviest line.
const WEIGHTS: usize = 12;
const WEAKER: f64 = 1.5;
/// Length below which a front segment is not visible, px.
const SHORTEST: f64 = 0.4;

/// Draws the front segments with the largest product of stress jump and length, heavier and darker the larger the jump. Returns true if all
/// visible segments are drawn.
fn draw_paths(drawing: &mut Drawing, frame: &Frame, view: &View, paths: &[PathRow]) -> bool {
    let (time, length) = (view.time_unit().factor, view.length_unit().factor);
    let ends = |p: &PathRow| [(p.x0, p.t0), (p.x1, p.t1)].map(|(x, t)| frame.place((x * length, t * time)));
    let size = |[a, b]: [(f64, f64); 2]| (a.0 - b.0).hypot(a.1 - b.1);
    let mut visible: Vec<(f64, [(f64, f64); 2])> = paths
        .iter()
        .map(|p| (p.stress_jump.abs(), ends(p)))
        .filter(|(jump, ends)| *jump > 0.0 && size(*ends) >= SHORTEST)
        .collect();
    let all = visible.len() <= MOST_PATHS;
    // A long weak front is more visible than a short strong one.
    visible.sort_by(|a, b| (b.0 * size(b.1)).total_cmp(&(a.0 * size(a.1))));
    visible.truncate(MOST_PATHS);
    visible.sort_by(|a, b| b.0.total_cmp(&a.0));
    let strongest = visible.first().map_or(1.0, |p| p.0);
    let weight = |jump: f64| ((strongest / jump).ln() / WEAKER.ln()).min(WEIGHTS as f64 - 1.0) as usize;
    drawing.clipped(frame.plot, |drawing| {
        // Weak fronts are drawn first, so that strong ones lie on top.
        for class in visible.chunk_by(|a, b| weight(a.0) == weight(b.0)).rev() {
            let strength = 1.0 - weight(class[0].0) as f64 / WEIGHTS as f64;
            let points: Vec<(f64, f64)> = class.iter().flat_map(|(_, [a, b])| [*a, *b, (f64::NAN, f64::NAN)]).collect();
            drawing.path(&points, &Stroke::new("white", 0.6 + 2.0 * strength).opacity(0.35 * strength));
            drawing.path(&points, &Stroke::new("black", 0.25 + 1.25 * strength).opacity(0.12 + 0.88 * strength));
        }
    });
    all
}

/// Smallest distance between the ends of neighbouring theoretical front lines, px; a line that ends closer to the one before is omitted. A
/// smooth curve has dozens of fronts, which would hide the map.
const APART: f64 = 22.0;
/// Distance between the lines of a fan below which only the first is drawn, px, so that the origin of the fan remains visible.
const OPEN: f64 = 9.0;

/// Draws lines at the theoretical speeds from the origin of each front to where it was last seen. Returns true if any line is drawn.
fn draw_fronts(drawing: &mut Drawing, frame: &Frame, view: &View, fronts: &[FrontRow]) -> bool {
    let (time, length) = (view.time_unit().factor, view.length_unit().factor);
    let mut last: Option<[(f64, f64); 2]> = None;
    drawing.clipped(frame.plot, |drawing| {
        for front in fronts.iter().filter(|f| f.last_seen.is_finite() && f.speed != 0.0) {
            let start = match front.origin.as_str() {
                "left" => 0.0,
                "right" => view.length,
                _ => front.position - front.speed * front.last_seen,
            };
            let end = start + front.speed * front.last_seen;
            let from = frame.place((start * length, 0.0));
            let to = frame.place((end * length, front.last_seen * time));
            let apart = last.map_or(f64::INFINITY, |[_, end]| (end.0 - to.0).hypot(end.1 - to.1));
            if apart < APART {
                continue;
            }
            let hidden = if last.is_some_and(|[start, _]| start == from) { OPEN / apart } else { 0.0 };
            last = Some([from, to]);
            let from = (from.0 + hidden * (to.0 - from.0), from.1 + hidden * (to.1 - from.1));
            drawing.line(from, to, &Stroke::new("white", 2.4).opacity(0.7));
            drawing.line(from, to, &Stroke::new("black", 1.2).dashed("6 3"));
        }
    });
    last.is_some()
}

fn draw_gauges(drawing: &mut Drawing, frame: &Frame, view: &View, mut gauges: Vec<Gauge>) {
    let mut free_from = f64::NEG_INFINITY;
    gauges.sort_by(|a, b| a.x.total_cmp(&b.x));
    for gauge in &gauges {
        let x = frame.place((gauge.x * view.length_unit().factor, 0.0)).0;
        drawing.line((x, frame.plot.y), (x, frame.plot.bottom()), &Stroke::new("white", 2.4).opacity(0.7));
        drawing.line((x, frame.plot.y), (x, frame.plot.bottom()), &Stroke::new("#333", 1.2).dashed("1.5 3"));
        // A name lies within the width of the plot and does not overlap the previous one. If it would no longer be above its line, it is omitted.
        let half = text_width(&gauge.name, 11.0) / 2.0;
        let middle = x.min(frame.plot.right() - half).max(frame.plot.x + half).max(free_from + half);
        if middle - half <= x {
            drawing.text((middle, frame.plot.y - 6.0), 11.0, Anchor::Middle, &gauge.name);
            free_from = middle + half + 4.0;
        }
    }
}

/// Draws the ruptures, each with a dashed line from then on. Returns the legend entry, or `None` if there are no ruptures.
fn draw_ruptures(drawing: &mut Drawing, frame: &Frame, view: &View) -> Option<Series> {
    let (time, length) = (view.time_unit().factor, view.length_unit().factor);
    let points: Vec<(f64, f64)> = view.ruptures.iter().map(|r| (r.x * length, r.time * time)).collect();
    for &(x, t) in points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
        let (from, to) = (frame.place((x, t)), frame.place((x, frame.y.high)));
        drawing.line(from, to, &Stroke::new(PAPER, 2.6));
        drawing.line(from, to, &Stroke::new(RUPTURE, 1.3).dashed("4 3"));
    }
    let marks = Series::marks("rupture", points, Stroke::new(RUPTURE, 2.0));
    draw_series(drawing, frame, &marks);
    (!marks.points.is_empty()).then_some(marks)
}

fn colour_bar(drawing: &mut Drawing, frame: &Frame, range: &Range, extremes: Extremes, label: &str) {
    const STEPS: usize = 128;
    let bar = Area { x: frame.plot.right() + 14.0, width: 16.0, ..frame.plot };
    let step = bar.height / STEPS as f64;
    for i in 0..STEPS {
        let value = range.low + (range.high - range.low) * (i as f64 + 0.5) / STEPS as f64;
        // Adjacent steps overlap slightly, since renderers would leave hairlines between them.
        let area = Area { y: bar.bottom() - step * (i + 1) as f64, height: step + 0.6, ..bar };
        drawing.rect(area, &hex(range.colour(value)), None);
    }
    let scale = Frame { plot: bar, x: Axis::new("", 0.0, 1.0), y: Axis::new(label, range.low, range.high) };
    scale.draw_right(drawing);
    draw_cut(drawing, bar, extremes);
}

/// Writes the extreme values outside the colour range at the ends of the colour bar.
fn draw_cut(drawing: &mut Drawing, bar: Area, Extremes { all, shown }: Extremes) {
    let (middle, ink) = (bar.x + 0.5 * bar.width, Stroke::new(INK, 0.8));
    let ends = [(1, bar.y, -1.0, "up to"), (0, bar.bottom(), 1.0, "down to")];
    for (end, edge, outward, words) in ends.into_iter().filter(|&(end, ..)| all[end] != shown[end]) {
        let tip = [(bar.x, edge), (bar.right(), edge), (middle, edge + 8.0 * outward)];
        drawing.polygon(&tip, PAPER, &ink);
        let y = edge + if outward < 0.0 { -10.0 } else { 18.0 };
        drawing.text((bar.x, y), 11.0, Anchor::Start, &format!("{words} {}", four_digits(all[end])));
    }
}

#[cfg(test)]
mod tests {
    use super::Extremes;

    #[test]
    fn a_spike_of_a_few_pixels_does_not_take_the_colours_and_is_told() {
        let mut values: Vec<f64> = (0..100_000).map(|i| f64::from(i % 101)).collect();
        let plain = Extremes::of(values.clone(), Some(0.0));
        assert_eq!((plain.all, plain.shown), ([0.0, 100.0], [0.0, 100.0]));
        values[..20].fill(-3000.0);
        values[20] = f64::NAN;
        let spiked = Extremes::of(values.clone(), Some(0.0));
        assert_eq!((spiked.all, spiked.shown), ([-3000.0, 100.0], [0.0, 100.0]));
        // A pulse that covers a part of the image is no spike.
        values[..200].fill(-3000.0);
        assert_eq!(Extremes::of(values, Some(0.0)).shown, [-3000.0, 100.0]);
    }
}
