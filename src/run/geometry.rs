//! Geometry of a bar in its result file.

use crate::bar::{Bar, Segment};
use crate::record::store::{Geometry, Part};
use crate::scene::Scene;

/// Largest distance of samples from the cell centres of a uniform grid, relative to the cell size, for which the grid counts as uniform.
const EVEN: f64 = 1e-9;

/// Returns the geometry of the original bar, with the cells around the samples `x` (m, increasing).
pub(super) fn geometry(scene: &Scene, x: &[f64]) -> Geometry {
    let bar = &super::original_scene(scene).bar;
    let has_area = bar.area_given && scene.torsion.is_none();
    let factors = match &scene.torsion {
        Some(torsion) => {
            Some([torsion.polar.first(), torsion.polar.last()].map(|j| j.map_or(0.0, |j| j / torsion.radius)))
        }
        None if has_area => Some([bar.segments.first(), bar.segments.last()])
            .map(|ends| [0, 1].map(|side| ends[side].map_or(0.0, |segment| segment.end_areas()[side]))),
        None => None,
    };
    Geometry {
        length: bar.length(),
        parts: parts(bar).map(|(start, segment)| part(start, segment, has_area)).collect(),
        bounds: bounds(bar, x),
        area: has_area.then(|| areas(bar, x)),
        end_factors: factors,
    }
}

/// Iterates over the segments with the positions of their left ends, m.
fn parts(bar: &Bar) -> impl Iterator<Item = (f64, &Segment)> {
    bar.segments.iter().scan(0.0, |end, segment| {
        let start = *end;
        *end += segment.length;
        Some((start, segment))
    })
}

fn part(start: f64, segment: &Segment, has_area: bool) -> Part {
    Part {
        start,
        end: start + segment.length,
        material: segment.material.name.clone(),
        areas: has_area.then(|| segment.end_areas()),
    }
}

/// Returns the left and right bound of the cell around each sample, m: cells of a uniform grid over the bar, or of a uniform grid in each segment.
fn bounds(bar: &Bar, x: &[f64]) -> Vec<[f64; 2]> {
    let size = bar.length() / x.len() as f64;
    let is_even = x.iter().enumerate().all(|(i, x)| (x - (i as f64 + 0.5) * size).abs() <= EVEN * size);
    let cells = |start: f64, length: f64, count: usize| {
        let edge = move |i: usize| start + length * i as f64 / count as f64;
        (0..count).map(move |i| [edge(i), edge(i + 1)])
    };
    if is_even {
        return cells(0.0, bar.length(), x.len()).collect();
    }
    let within = |start: f64, end: f64| x.iter().filter(|x| start < **x && **x < end).count();
    parts(bar).flat_map(|(start, s)| cells(start, s.length, within(start, start + s.length))).collect()
}

/// Returns the cross-section at each sample, m^2; at a joint that of the segment on its right.
fn areas(bar: &Bar, x: &[f64]) -> Vec<f64> {
    let at = |x: f64| {
        let (start, segment) = parts(bar).take_while(|(start, _)| *start <= x).last()?;
        Some(segment.taper.as_ref().map_or(segment.area, |taper| taper.area((x - start).min(segment.length))))
    };
    x.iter().map(|x| at(*x).unwrap_or(bar.segments[0].area)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn of(bar: &str, x: &[f64]) -> Geometry {
        let text = format!(
            "[bar]\n{bar}\n[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n[solve]\nuntil = 1e-6\nmethod = \"fd\"\n"
        );
        geometry(&Scene::parse("a.toml", &text, Path::new("."), &[]).expect("a scene"), x)
    }

    #[test]
    fn cells_lie_between_their_bounds_in_every_segment() {
        let bar = "segment = [{ length = 1, area = 2e-4, material = \"mild-steel\" }, { length = 0.3, area = 1e-4, material = \
                   \"mild-steel\" }]";
        let uneven = of(bar, &[0.25, 0.75, 1.05, 1.15, 1.25]);
        assert_eq!(uneven.bounds[..2], [[0.0, 0.5], [0.5, 1.0]]);
        assert!((uneven.bounds[4][1] - 1.3).abs() < 1e-15);
        assert_eq!(uneven.area.as_deref(), Some(&[2e-4, 2e-4, 1e-4, 1e-4, 1e-4][..]));
        assert_eq!(uneven.end_factors, Some([2e-4, 1e-4]));
        let even = of(bar, &[0.325, 0.975]);
        assert_eq!(even.bounds, [[0.0, 0.65], [0.65, 1.3]]);
        assert_eq!((even.parts[1].start, even.parts[1].areas), (1.0, Some([1e-4; 2])));
    }

    #[test]
    fn without_an_area_there_is_no_force() {
        let bare = of("length = 1\nmaterial = \"mild-steel\"", &[0.5]);
        assert_eq!((bare.length, bare.area, bare.end_factors, bare.parts[0].areas), (1.0, None, None, None));
    }
}
