//! Time stepping of the net.

use super::end::End;
use super::joint::Joint;
use super::part::NetSegment;
use crate::bar::{Bar, EndCondition, SuddenLoads};
use crate::law::FirstPassed;
use crate::law::rate::RateLaw;
use crate::solver::fd::Grid;

/// A bar on a characteristic net, between steps: all quantities hold at [`Net::time`].
#[derive(Debug, Clone)]
pub struct Net {
    pub(super) grid: Grid,
    pub(super) parts: Vec<NetSegment>,
    /// Joints, one fewer than segments.
    pub(super) joints: Vec<Joint>,
    pub(super) ends: [End; 2],
    /// Waves that enter each segment at its left border (f) and at its right one (g) in the current step.
    entering: Vec<[f64; 2]>,
    pub(super) step: usize,
    pub(super) passed: FirstPassed,
    sudden: SuddenLoads,
}

impl Net {
    /// Creates a bar at t = 0 in the state of its segments, on a [`super::grid`]. `laws` has one entry per segment.
    pub fn new(bar: &Bar, grid: Grid, laws: Vec<RateLaw>, ends: [EndCondition; 2]) -> Self {
        let parts: Vec<NetSegment> = bar
            .segments
            .iter()
            .zip(&grid.segments)
            .zip(laws)
            .map(|((segment, part), law)| NetSegment::new(law, part, grid.dt, segment))
            .collect();
        let [left, right] = ends;
        let last = parts.len() - 1;
        let velocity = |k: usize, side: usize| bar.segments[k].end_velocities()[side];
        let ends = [
            End::new(&left, 1.0, &parts[0], velocity(0, 0), grid.dt),
            End::new(&right, -1.0, &parts[last], velocity(last, 1), grid.dt),
        ];
        let joints = bar.segments[..last].iter().map(|s| Joint::new(s.joint)).collect();
        Self {
            entering: vec![[0.0; 2]; parts.len()],
            grid,
            parts,
            joints,
            ends,
            step: 0,
            passed: FirstPassed::default(),
            sudden: SuddenLoads::default(),
        }
    }

    /// Adds the sudden loads of ends and joints to a bar at t = 0.
    #[must_use]
    pub fn under_sudden_loads(mut self, loads: SuddenLoads) -> Self {
        for &(k, load, force) in &loads.joints {
            self.joints[k].load(load, force);
        }
        self.sudden = loads;
        self
    }

    /// Returns the states behind sudden loads of ends and joints.
    pub fn sudden_loads(&self) -> &SuddenLoads {
        &self.sudden
    }

    /// Advances the bar by one step. Allocates nothing.
    pub fn advance(&mut self) {
        let time = self.time();
        for part in &mut self.parts {
            part.relax_cells();
        }
        self.meet_at_joints();
        self.meet_at_ends(time);
        for (part, entering) in self.parts.iter_mut().zip(&self.entering) {
            part.pass_borders(*entering);
        }
        self.step += 1;
        self.note_limits();
    }

    fn meet_at_joints(&mut self) {
        for k in 1..self.parts.len() {
            let (before, after) = self.parts.split_at_mut(k);
            let passed = self.joints[k - 1].transmit(&mut before[k - 1], &mut after[0], self.grid.dt);
            self.entering[k - 1][1] = passed.to_left;
            self.entering[k][0] = passed.to_right;
        }
    }

    fn meet_at_ends(&mut self, time: f64) {
        let last = self.parts.len() - 1;
        let [left, right] = &mut self.ends;
        let arriving = self.parts[0].arriving(0);
        self.entering[0][0] = left.advance(time, arriving, &mut self.parts[0]);
        let part = &mut self.parts[last];
        let arriving = part.arriving(1);
        self.entering[last][1] = right.advance(time, arriving, part);
    }

    /// Number of steps taken.
    pub fn step(&self) -> usize {
        self.step
    }

    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.step as f64 * self.grid.dt
    }

    /// Cells and time step.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}
