//! The nodes of one segment.

use std::ops::Range;

use super::nodes::{INSIDE, Meeting, Nodes, Work, beyond};
use crate::bar::{Initial, Segment};
use crate::law::rate::{History, RateLaw, RelaxationStep};
use crate::law::{DataEnd, Flowing, Reached};
use crate::material::Sense;

/// A segment.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub law: RateLaw,
    end: DataEnd,
    /// Whole steps of the nodes inside the segment.
    relaxation_step: RelaxationStep,
    /// Its cells, counted over the whole bar.
    pub cells: Range<usize>,
    /// m^2.
    pub area: f64,
    /// rho c0, Pa s/m.
    pub impedance: f64,
    /// Pa.
    pub modulus: f64,
    /// sigma - Z v and sigma + Z v of the cells at whole steps, before they relax, Pa.
    pub f: Vec<f64>,
    pub g: Vec<f64>,
    pub centres: Nodes,
    /// One more than cells; the first and the last belong to the joints or ends there.
    pub borders: Nodes,
    /// Plastic work so far, Pa^2; joules are [`Part::per_work`] times it.
    pub work: Work,
    /// The step under way or the next one, counted from 1, and its length, s.
    pub step: u32,
    pub dt: f64,
}

impl Part {
    pub fn new(law: RateLaw, cells: Range<usize>, dt: f64, segment: &Segment) -> Self {
        let (impedance, modulus) = (segment.material.impedance(), segment.material.modulus);
        let (count, Initial { stress, plastic_strain }) = (cells.len(), segment.initial);
        let history = law.deformed(modulus * plastic_strain);
        Self {
            centres: Nodes::new(&law, count, history),
            borders: Nodes::new(&law, count + 1, history),
            f: vec![stress - impedance * segment.velocity; count],
            g: vec![stress + impedance * segment.velocity; count],
            work: Work::default(),
            step: 1,
            dt,
            relaxation_step: law.relaxation_step(INSIDE, dt),
            end: DataEnd::of(&segment.material),
            law,
            cells,
            area: segment.area,
            impedance,
            modulus,
        }
    }

    /// Joules per [`Work`]: A dt/(2 Z).
    pub fn per_work(&self) -> f64 {
        0.5 * self.area * self.dt / self.impedance
    }

    /// The cells flow for a whole step; then f and g are what leaves them.
    pub fn relax_cells(&mut self) {
        let step = (&self.relaxation_step, self.step, self.dt);
        let work = self.centres.relax(&self.law, step, 0, &mut self.f, &mut self.g);
        self.work.add(work);
    }

    /// What a node meets in the step that it takes.
    pub fn meeting(&self, stress: f64, share: f64) -> Meeting {
        Meeting { step: self.step, stress, share, time: self.dt }
    }

    /// The borders inside the segment flow for a whole step, which ends it; then f and g go on to the next cells. `entering` are the f
    /// and the g that come in at the segment's left and right border.
    pub fn pass_borders(&mut self, entering: [f64; 2]) {
        let last = self.f.len() - 1;
        let step = (&self.relaxation_step, self.step, self.dt);
        let work = self.borders.relax(&self.law, step, 1, &mut self.f[..last], &mut self.g[1..]);
        self.work.add(work);
        self.step += 1;
        self.f.copy_within(..last, 1);
        self.g.copy_within(1.., 0);
        self.f[0] = entering[0];
        self.g[last] = entering[1];
    }

    /// What arrives at the segment's left (side 0: g) or right (side 1: f) border once the cells have flowed.
    pub fn arriving(&self, side: usize) -> f64 {
        if side == 0 { self.g[0] } else { self.f[self.f.len() - 1] }
    }

    /// Stress and history of local cell `i` at the whole step, half of its flow done; and the work of that half.
    pub fn cell(&self, i: usize) -> (f64, History, Work) {
        let stress = 0.5 * (self.f[i] + self.g[i]);
        let (flow, history) = self.centres.half_way(&self.law, i, self.meeting(stress, INSIDE));
        let drop = INSIDE * flow.plastic;
        let work = Work { total: (stress - 0.5 * drop) * flow.plastic, overstress: flow.overstress };
        (stress - drop, history, work)
    }

    /// The limit of what its law knows to which local cell `i` has come, if it has.
    pub fn reached(&self, i: usize) -> Option<Reached> {
        let nodes = &self.centres;
        let before = 0.5 * (self.f[i] + self.g[i]);
        if self.end.is_far(nodes.history[i].accumulated, before) {
            return None;
        }
        let flow = beyond(before, nodes.low[i], nodes.high[i]);
        let (stress, history, _) = self.cell(i);
        let sense = flow.map_or_else(|| Sense::of(before), |(sense, _)| [Sense::Tension, Sense::Compression][sense]);
        let point = Flowing { sense, accumulated: history.accumulated, strain: stress + history.signed };
        self.end.reached(&point, |_| flow.is_some())
    }

    /// Velocity of local cell `i`, m/s.
    pub fn velocity(&self, i: usize) -> f64 {
        (self.g[i] - self.f[i]) / (2.0 * self.impedance)
    }
}
