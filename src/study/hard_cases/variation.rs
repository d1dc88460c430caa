//! Bound on the total variation of stress and velocity along a suddenly loaded bar.
//!
//! The bound is known for bars of one uniform segment with one free end, whose other end has a constant velocity or stress, is fixed, or is a rigid
//! wall without a gap. The loaded end imposes one jump at t = 0: the stress of its fan, Pa, and |V - v0|, m/s (for a stress, the velocity of the
//! fan). Reflections do not increase the sums of the jumps along the bar. At a free end and at an end of constant stress, the reflected jump in
//! stress equals the incident one, and the reflected jump in velocity, |d sigma|/(rho c), is no larger, because unloading is elastic and has the
//! largest impedance. At an end of constant velocity and at a wall, the reflected jump in velocity equals the incident one. Waves that meet inside
//! the bar can increase the sums if a loading wave passes between regions that have hardened by different amounts. Front tracking verifies that the
//! exact solutions of the scenes satisfy the bound. A scheme that exceeds it generates spurious oscillations (Harten 1983, J. Comput. Phys. 49, 357).

use ndarray::Array2;

use crate::bar::{Bar, EndCondition, initial_fans};
use crate::scene::{Scene, SceneParts};

/// Largest permitted ratio of the total variation to the imposed jump. The excess over 1 allows for second-order schemes for systems, which are
/// monotone only up to higher-order terms.
pub(super) const MOST_VARIATION: f64 = 1.01;

/// Returns the jumps in stress (Pa) and velocity (m/s) that the data impose, or `None` if no bound is known for the scene.
pub(super) fn imposed(scene: &Scene) -> Option<[f64; 2]> {
    let SceneParts { bar, left, right, effects, .. } = &scene.parts;
    let [segment] = bar.segments.as_slice() else { return None };
    let plain = effects.rate.is_none() && effects.damping.is_none() && effects.rupture.is_none();
    if !plain || segment.taper.is_some() || bar.has_initial_state() {
        return None;
    }
    let ((driven, EndCondition::Free) | (EndCondition::Free, driven)) = (left, right) else { return None };
    let fans = initial_fans(bar, left, right);
    let fan = &fans.first()?.fan;
    Some([fan.stress, jump(driven, bar).unwrap_or(fan.velocity)]).filter(|_| is_steady(driven))
}

/// Returns the velocity jump that an end imposes, m/s, or `None` if the end does not impose its velocity.
fn jump(end: &EndCondition, bar: &Bar) -> Option<f64> {
    let start = bar.segments[0].velocity;
    match end {
        EndCondition::Velocity { history, .. } => Some((history.at(0.0) - start).abs()),
        EndCondition::Fixed | EndCondition::Wall { .. } => Some(start.abs()),
        _ => None,
    }
}

fn is_steady(end: &EndCondition) -> bool {
    match end {
        EndCondition::Velocity { history, release } => history.is_constant() && release.is_none(),
        EndCondition::Stress { history } => history.is_constant(),
        EndCondition::Wall { gap } => *gap == 0.0,
        EndCondition::Fixed => true,
        _ => false,
    }
}

/// Returns the largest total variation along the bar over all frames (rows).
pub(super) fn largest(frames: &Array2<f64>) -> f64 {
    let of_row =
        |row: ndarray::ArrayView1<'_, f64>| row.windows(2).into_iter().map(|pair| (pair[1] - pair[0]).abs()).sum();
    frames.rows().into_iter().map(of_row).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const SCENE: &str = r#"
[bar]
length = 1
material = { name = "b", density = 7800, modulus = "200 GPa", curve = { table = [[0.001, "200 MPa"], [0.021, "600 MPa"]] } }
[left]
kind = "velocity"
value = "20 m/s"
[right]
kind = "free"
[solve]
until = "1 ms"
"#;

    fn imposed_by(changes: &[(&str, &str)]) -> Option<[f64; 2]> {
        let mut text = SCENE.to_owned();
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        imposed(&Scene::parse("s.toml", &text, Path::new("."), &[]).expect("a scene"))
    }

    const MOVED: &str = "\"velocity\"\nvalue = \"20 m/s\"";

    #[test]
    fn a_suddenly_moved_end_imposes_its_fan() {
        let [stress, velocity] = imposed_by(&[("20 m/s", "-20 m/s")]).expect("a bound");
        // sigma_y + rho c_t (v - sigma_y/(rho c0))
        assert!((stress / 386.554e6 - 1.0).abs() < 1e-5 && velocity == 20.0, "{stress} {velocity}");
        let [stress, velocity] = imposed_by(&[(MOVED, "\"stress\"\nvalue = -1e8")]).expect("a bound");
        let impedance = (7800.0_f64 * 200e9).sqrt();
        assert!(stress == 1e8 && (velocity * impedance / 1e8 - 1.0).abs() < 1e-12, "{stress} {velocity}");
        let struck = [(MOVED, "\"wall\""), ("length = 1", "length = 1\nvelocity = -3")];
        let [stress, velocity] = imposed_by(&struck).expect("a bound");
        assert!((stress / (3.0 * impedance) - 1.0).abs() < 1e-12 && velocity == 3.0, "{stress} {velocity}");
    }

    #[test]
    fn no_bound_is_known_of_other_scenes() {
        assert_eq!(imposed_by(&[("\"free\"", "\"fixed\"")]), None);
        assert_eq!(imposed_by(&[(MOVED, "\"free\"")]), None);
        assert_eq!(imposed_by(&[("\"20 m/s\"", "\"20 m/s\"\nrelease = 1e-4")]), None);
        assert_eq!(imposed_by(&[("value = \"20 m/s\"", "history = [[0, 20], [1e-5, 10]]")]), None);
        assert_eq!(imposed_by(&[("[solve]", "[effects]\nrate = { model = \"malvern\", k = 1e6 }\n[solve]")]), None);
    }

    #[test]
    fn the_largest_variation_is_that_of_any_frame() {
        let frames = ndarray::arr2(&[[0.0, 1.0, 1.0, 0.0], [0.0, 3.0, -1.0, 0.0], [0.0, 0.0, 0.0, 0.0]]);
        assert_eq!(largest(&frames), 8.0);
    }
}
