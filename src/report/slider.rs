//! Profile with a time slider on an HTML page, from the first stored time to the last.

use super::axis::Axis;
use super::display::{Unit, Units};
use super::drawing::Stroke;
use super::html::picture;
use super::layout::{Content, alone};
use super::panel::{LinePanel, Series};
use super::plot::colour;
use super::svg::base64;
use super::view::View;
use crate::error::Result;
use crate::impact::Shapes;

/// Largest numbers of times and of positions on a page; together they take 533 kB in base64.
const MOST_FRAMES: usize = 200;
const MOST_PLACES: usize = 500;

/// Profiles at several times, in display units except for `time`.
pub(super) struct Profiles {
    heading: String,
    labels: [String; 2],
    /// Length of the bar or beam.
    length: f64,
    time_unit: Unit,
    /// Times, s.
    time: Vec<f64>,
    x: Vec<f64>,
    /// Values at the positions `x`, one row for each time.
    rows: Vec<Vec<f64>>,
    /// Values that the vertical axis must contain.
    limits: Vec<f64>,
    /// Numbers of times and of positions in the file.
    stored: [usize; 2],
}

/// Returns at most `most` of the indices below `count`, evenly distributed, with the first and the last.
fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| (i * (count - 1) + (most - 1) / 2) / (most - 1)).collect()
}

impl Profiles {
    /// Creates the profiles of the field that the figure shows.
    pub fn of_bar(view: &View) -> Result<Self> {
        let (length, unit) = (view.length_unit(), view.field_unit());
        let (frames, places) = (spread(view.time.len(), MOST_FRAMES), spread(view.x.len(), MOST_PLACES));
        let x: Vec<f64> = places.iter().map(|&i| view.x[i] * length.factor).collect();
        let (mut rows, mut limits) = (Vec::with_capacity(frames.len()), Vec::new());
        // Frames are read one at a time, since a field may be larger than memory.
        for &frame in &frames {
            let values = view.file.field(view.field, frame..frame + 1)?;
            let row: Vec<f64> = places.iter().map(|&i| values[(0, i)] * unit.factor).collect();
            limits.extend(view.limits(&x.iter().copied().zip(row.iter().copied()).collect::<Vec<_>>()));
            rows.push(row);
        }
        let name = view.field_name();
        Ok(Self {
            heading: format!("{name} along the bar at one instant"),
            labels: [length.label("position x"), unit.label(name)],
            length: view.length * length.factor,
            time_unit: view.time_unit(),
            time: frames.iter().map(|&i| view.time[i]).collect(),
            x,
            rows,
            limits: limits.into_iter().chain(View::zero(view.field)).collect(),
            stored: [view.time.len(), view.x.len()],
        })
    }

    /// Creates the profiles of the deflection of a beam, or returns `None` if no shape is stored.
    pub fn of_beam(shapes: &Shapes, units: Units) -> Option<Self> {
        let (&end, &length) = (shapes.time.last()?, shapes.x.last()?);
        let most = shapes.deflection.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let (unit, place) = (units.of_symbol("m", most), units.length(length));
        let (frames, places) = (spread(shapes.time.len(), MOST_FRAMES), spread(shapes.x.len(), MOST_PLACES));
        let value = |frame: usize, i: &usize| shapes.deflection[frame * shapes.x.len() + i] * unit.factor;
        let rows: Vec<Vec<f64>> =
            frames.iter().map(|&frame| places.iter().map(|i| value(frame, i)).collect()).collect();
        Some(Self {
            heading: "deflection along the beam at one instant".into(),
            labels: [place.label("position x"), unit.label("deflection")],
            length: length * place.factor,
            time_unit: Units::time(end),
            time: frames.iter().map(|&i| shapes.time[i]).collect(),
            x: places.iter().map(|&i| shapes.x[i] * place.factor).collect(),
            limits: [rows.concat(), vec![0.0]].concat(),
            rows,
            stored: [shapes.time.len(), shapes.x.len()],
        })
    }

    /// Returns the last profile as HTML, with the data from which a script shows the others; empty if there is only one.
    pub fn html(&self, size: [f64; 2], index: usize) -> Result<String> {
        let (Some(last), Some(&end)) = (self.rows.last().filter(|_| self.rows.len() > 1), self.time.last()) else {
            return Ok(String::new());
        };
        let svg = alone(&Content::Lines(self.panel(last)), size, index)?.svg();
        let most = self.rows.len() - 1;
        Ok(format!(
            "<figure class=\"player\">\n{svg}<div class=\"controls\" hidden>\n\
             <button type=\"button\">Play</button>\n\
             <input type=\"range\" min=\"0\" max=\"{most}\" value=\"{most}\" aria-label=\"time\">\n</div>\n\
             <figcaption><output>time {time}</output>{left_out}</figcaption>\n\
             <script type=\"application/json\">{data}</script>\n</figure>\n",
            svg = picture(&self.heading, &svg),
            time = self.time_unit.brief(end),
            left_out = self.left_out(),
            data = self.data(),
        ))
    }

    fn panel(&self, row: &[f64]) -> LinePanel {
        let points = self.x.iter().copied().zip(row.iter().copied()).collect();
        let [x, y] = &self.labels;
        LinePanel {
            heading: self.heading.clone(),
            x: Axis::new(x, 0.0, self.length),
            y: Axis::around(y, self.limits.iter().copied()),
            series: vec![Series::line("", points, Stroke::new(colour(0), 1.8))],
        }
    }

    fn left_out(&self) -> String {
        let [frames, places] = self.stored;
        if (frames, places) == (self.rows.len(), self.x.len()) {
            return String::new();
        }
        format!(" \u{b7} {} of {frames} frames, {} of {places} points", self.rows.len(), self.x.len())
    }

    /// Returns the data as JSON, with arrays as base64 of little-endian binary32: half as long as the same digits as text.
    fn data(&self) -> String {
        let text = |values: &mut dyn Iterator<Item = f64>| {
            base64(&values.flat_map(|value| (value as f32).to_le_bytes()).collect::<Vec<u8>>())
        };
        let time = text(&mut self.time.iter().map(|t| t * self.time_unit.factor));
        let (x, values) = (text(&mut self.x.iter().copied()), text(&mut self.rows.iter().flatten().copied()));
        let label = self.time_unit.label("time");
        serde_json::json!({ "label": label, "time": time, "x": x, "values": values }).to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn what_is_left_out_is_evenly_spread() {
        assert_eq!(spread(3, 5), [0, 1, 2]);
        assert_eq!(spread(9, 5), [0, 2, 4, 6, 8]);
        let many = spread(2000, 500);
        assert_eq!((many[0], many[499], many.len()), (0, 1999, 500));
        assert!(many.windows(2).all(|pair| (4..=5).contains(&(pair[1] - pair[0]))));
    }
}
