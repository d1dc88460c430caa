//! Largest forces at the joints of a bar.

use serde::{Deserialize, Serialize};

use crate::bar::{Bar, Joint, SuddenLoad};
use crate::law::rupture::{Rupture, Site};
use crate::record::{ContactReading, Extreme, Trace};

/// Largest forces that the joints of a bar have carried so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JointForces(Vec<JointForce>);

#[derive(Debug, Clone, Serialize, Deserialize)]
struct JointForce {
    /// Index of the segment to the left of the joint.
    segment: usize,
    /// Cross-sections of the bar to the left and right of the joint, m^2.
    areas: [f64; 2],
    opens: bool,
    /// Sudden load and its force, N, tension positive.
    sudden: Option<(SuddenLoad, f64)>,
    /// Force of largest magnitude, N, and its time, s.
    largest: Extreme,
}

impl JointForces {
    /// Creates the records of the joints on the right of the given segments of a bar.
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

    /// Sets the sudden loads of joints, each given by the segment on its left, with their forces (N).
    pub fn start_under(&mut self, loads: &[(usize, SuddenLoad, f64)]) {
        for joint in &mut self.0 {
            joint.sudden = loads.iter().find(|load| load.0 == joint.segment).map(|&(_, load, force)| (load, force));
        }
    }

    /// Adds the rows up to `until` (s) of the stress histories on the left (`side` 0) or right (1) of the joints. After
    /// a fracture the stress next to a joint is that of a fragment, and is ignored.
    pub fn add_rows(&mut self, rows: &[Trace], side: usize, until: f64, ruptures: &[Rupture]) {
        for (joint, rows) in self.0.iter_mut().zip(rows) {
            let last = joint.broken(ruptures).map_or(until, |rupture| rupture.time.min(until));
            for (&time, &stress) in rows.time.iter().zip(&rows.stress).take_while(|row| *row.0 <= last) {
                let force = joint.areas[side] * stress;
                let force = joint.sudden.map_or(force, |(load, known)| load.blend(time, known, force));
                joint.largest.add(time, force);
            }
        }
    }

    /// Adds the forces at which joints fractured and the forces on the faces of open joints, at the end of the simulation.
    pub fn close(&mut self, ruptures: &[Rupture], contacts: &[ContactReading]) {
        for joint in &mut self.0 {
            if let Some(broken) = joint.broken(ruptures) {
                let area = joint.areas[usize::from(broken.segment != joint.segment)];
                joint.largest.add(broken.time, area * broken.stress);
            }
            if let Some(faces) = contacts.iter().find(|contact| contact.joint == joint.segment) {
                // The force between the faces themselves replaces that of the cells.
                if joint.opens {
                    joint.largest = Extreme::default();
                }
                joint.largest.add(faces.pressed.time_of_peak, faces.pressed.peak);
            }
        }
    }

    /// Returns the peaks of the joints.
    pub fn peaks(&self) -> impl Iterator<Item = Peak> + '_ {
        self.0.iter().map(|joint| Peak::new(joint.largest, joint.sudden.iter().map(|(load, _)| load)))
    }
}

impl JointForce {
    fn broken<'a>(&self, ruptures: &'a [Rupture]) -> Option<&'a Rupture> {
        ruptures.iter().find(|rupture| rupture.site == Site::Joint(self.segment))
    }
}

/// Largest force at a place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Magnitude of the force, N.
    pub force: f64,
    /// True if the force is that of a sudden load and grows without limit as the time step decreases.
    pub has_no_limit: bool,
}

impl Peak {
    /// Creates the peak of a place with the sudden loads `loads`; `largest` is its largest force, N, and the time of this force, s.
    pub fn new<'a>(largest: Extreme, mut loads: impl Iterator<Item = &'a SuddenLoad>) -> Self {
        let has_no_limit = loads.any(|load| load.has_no_limit_at(largest.at));
        Self { force: largest.value.abs(), has_no_limit }
    }
}

/// Returns the positions of the joints on the right of the given segments of a bar, m.
pub fn joint_places(bar: &Bar, joints: &[usize]) -> Vec<f64> {
    joints.iter().map(|&k| bar.segments[..=k].iter().map(|segment| segment.length).sum()).collect()
}
