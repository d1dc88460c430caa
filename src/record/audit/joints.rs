//! Tension at bonded joints, at which a contact joint would open. It is reported for information only.

use serde::{Deserialize, Serialize};

use super::places::Places;
use super::{AuditRow, Reading};
use crate::bar::{Bar, Joint};
use crate::material::Sense;
use crate::units::{Dimension, System, format};

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Joints(Vec<Watched>);

/// Bonded joint whose tension is recorded.
#[derive(Debug, Serialize, Deserialize)]
struct Watched {
    /// Number of the joint, counted from 0.
    number: usize,
    x: f64,
    /// Last sampling place to the left of the joint.
    place: usize,
    /// Largest force that the weaker side carries, over the area of the left side, Pa.
    strength: f64,
    /// Largest tension so far, Pa, and its time, s.
    tension: f64,
    time: f64,
}

impl Joints {
    /// Creates the records of the bonded joints between materials of which at least one has a known strength.
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

    pub fn sample(&mut self, now: &Reading) {
        for joint in &mut self.0 {
            if now.stress[joint.place] > joint.tension {
                (joint.tension, joint.time) = (now.stress[joint.place], now.time);
            }
        }
    }

    /// Returns the row of the joint that carried the largest fraction of its strength; `None` without tension.
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
