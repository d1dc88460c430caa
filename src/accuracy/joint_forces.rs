//! The largest forces at the joints of a bar.

use serde::{Deserialize, Serialize};

use crate::bar::{Bar, Joint, SuddenLoad};
use crate::law::rupture::{Rupture, Site};
use crate::record::{ContactReading, Extreme, Trace};

/// What the joints of a bar have carried so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JointForces(Vec<JointForce>);

#[derive(Debug, Clone, Serialize, Deserialize)]
struct JointForce {
    /// On its left.
    segment: usize,
    /// Sections of the bar to its left and right, m^2.
    areas: [f64; 2],
    opens: bool,
    /// A sudden load, with its force, N.
    sudden: Option<(SuddenLoad, f64)>,
    /// N.
    largest: Extreme,
}

impl JointForces {
    /// Of the joints on the right of these segments of a bar.
    pub fn new(bar: &Bar, joints: &[usize]) -> Self {
        let of = |&segment: &usize| JointForce {
            segment,
            areas: [bar.segments[segment].end_areas()[1], bar.segments[segment + 1].end_areas()[0]],
            opens: bar.segments[segment].joint != Joint::Bonded,
            sudden: None,
            largest: Extreme::default(),
        };
        Self(joints.iter().map(of).collect())
    }

    /// Joints on the right of segments are suddenly loaded, with these forces (N).
    pub fn start_under(&mut self, loads: &[(usize, SuddenLoad, f64)]) {
        for joint in &mut self.0 {
            joint.sudden = loads.iter().find(|load| load.0 == joint.segment).map(|&(_, load, force)| (load, force));
        }
    }

    /// Takes the rows up to `until` (s) of histories of the stress on their left (0) or right (1) `side`. From a rupture on the stress
    /// beside a joint is that of a fragment.
    pub fn hear(&mut self, rows: &[Trace], side: usize, until: f64, ruptures: &[Rupture]) {
        for (joint, rows) in self.0.iter_mut().zip(rows) {
            let last = joint.broken(ruptures).map_or(until, |rupture| rupture.time.min(until));
            for (&time, &stress) in rows.time.iter().zip(&rows.stress).take_while(|row| *row.0 <= last) {
                let force = joint.areas[side] * stress;
                let force = joint.sudden.map_or(force, |(load, known)| load.blend(time, known, force));
                joint.largest.add(time, force);
            }
        }
    }

    /// The bar has come to its end: what joints broke of, and what the faces of those that open have carried.
    pub fn close(&mut self, ruptures: &[Rupture], contacts: &[ContactReading]) {
        for joint in &mut self.0 {
            if let Some(broken) = joint.broken(ruptures) {
                let area = joint.areas[usize::from(broken.segment != joint.segment)];
                joint.largest.add(broken.time, area * broken.stress);
            }
            if let Some(faces) = contacts.iter().find(|contact| contact.joint == joint.segment) {
                // The force between the faces themselves.
                if joint.opens {
                    joint.largest = Extreme::default();
                }
                joint.largest.add(faces.pressed.time_of_peak, faces.pressed.peak);
            }
        }
    }

    /// Their peaks.
    pub fn peaks(&self) -> impl Iterator<Item = Peak> + '_ {
        self.0.iter().map(|joint| Peak::new(joint.largest, joint.sudden.iter().map(|(load, _)| load)))
    }
}

impl JointForce {
    fn broken<'a>(&self, ruptures: &'a [Rupture]) -> Option<&'a Rupture> {
        ruptures.iter().find(|rupture| rupture.site == Site::Joint(self.segment))
    }
}

/// The largest force at a place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Magnitude, N.
    pub force: f64,
    /// It is that of a sudden load, and the larger the shorter the time step is.
    pub has_no_limit: bool,
}

impl Peak {
    /// The largest force, N, at a place that is suddenly loaded by `loads`.
    pub fn new<'a>(largest: Extreme, mut loads: impl Iterator<Item = &'a SuddenLoad>) -> Self {
        let has_no_limit = loads.any(|load| load.has_no_limit_at(largest.at));
        Self { force: largest.value.abs(), has_no_limit }
    }
}

/// Places of the joints on the right of these segments of a bar, m.
pub fn joint_places(bar: &Bar, joints: &[usize]) -> Vec<f64> {
    joints.iter().map(|&k| bar.segments[..=k].iter().map(|segment| segment.length).sum()).collect()
}
