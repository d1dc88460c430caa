//! Tension at bonded joints, at which a contact joint would open. For information only.

use serde::{Deserialize, Serialize};

use super::places::Places;
use super::{AuditRow, Reading};
use crate::bar::{Bar, Joint};
use crate::material::Sense;
use crate::units::{Dimension, System, format};

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Joints(Vec<Watched>);

/// A bonded joint.
#[derive(Debug, Serialize, Deserialize)]
struct Watched {
    /// Counted from 0.
    number: usize,
    x: f64,
    /// The last place to its left.
    place: usize,
    /// Force that the weaker side carries at most, over the left side's area, Pa.
    strength: f64,
    /// Largest tension so far, Pa, and when.
    tension: f64,
    time: f64,
}

impl Joints {
    /// Joints of materials whose strength is known.
    pub fn new(bar: &Bar, places: &Places) -> Self {
        let (mut x, mut joints) = (0.0, Vec::new());
        for (number, pair) in bar.segments.windows(2).enumerate() {
            x += pair[0].length;
            let sections = [pair[0].end_areas()[1], pair[1].end_areas()[0]];
            let strength = |k: usize| {
                let ultimate = pair[k].material.branch(Sense::Tension).ultimate();
                ultimate.map(|u| u.stress * sections[k] / sections[0])
            };
            let strength = [strength(0), strength(1)].into_iter().flatten().fold(f64::INFINITY, f64::min);
            let place = places.segment.partition_point(|&s| s <= number) - 1;
            if pair[0].joint == Joint::Bonded && strength.is_finite() {
                joints.push(Watched { number, x, place, strength, tension: 0.0, time: 0.0 });
            }
        }
        Self(joints)
    }

    pub fn look(&mut self, now: &Reading) {
        for joint in &mut self.0 {
            if now.stress[joint.place] > joint.tension {
                (joint.tension, joint.time) = (now.stress[joint.place], now.time);
            }
        }
    }

    /// The joint that used up most of its strength.
    pub fn row(&self) -> Option<AuditRow> {
        let used = |j: &Watched| j.tension / j.strength;
        let joint = self.0.iter().filter(|j| j.tension > 0.0).max_by(|a, b| used(a).total_cmp(&used(b)))?;
        let show = |value, dimension| format(value, dimension, System::Si);
        let finding = std::format!(
            "bonded joint {} at x = {} carried a tension of {} at t = {}, {:.0} % of the strength of its weaker side; a contact joint \
             (joint = \"contact\") would have opened",
            joint.number + 1,
            show(joint.x, Dimension::Length),
            show(joint.tension, Dimension::Stress),
            show(joint.time, Dimension::Time),
            100.0 * used(joint),
        );
        Some(AuditRow {
            effect: "separation".into(),
            estimate: used(joint),
            threshold: 1.0,
            finding,
            ..AuditRow::default()
        })
    }
}
