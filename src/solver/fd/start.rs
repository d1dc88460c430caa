//! The first steps at an end that is suddenly set in motion.
//!
//! There the bar carries a centred fan of fronts, known exactly (see [`crate::wave::similarity`]), that is narrower than a few cells. A
//! scheme that starts it from rest overshoots, and plastic flow keeps the excess in the first cells for good, at any resolution: 12 to
//! 20 % of the strain and of the force. So until the slowest front has travelled [`CELLS`] cells the nodes inside the fan move as the
//! exact solution does, its slower fronts spread over [`RAMP`] cells: each node with the mean of its velocity over the step, so that every
//! cell has just the mean of the strain.
//!
//! That is an impulse on nodes. Its momentum comes from the end; what it takes from the energy, of first order in the cell size, is
//! in `half_step`.

use super::fan::{Front, StartingFan};
use super::grid_filter;
use super::leapfrog::Leapfrog;
use crate::bar::{Driver, EndCondition, InitialFan, Origin, SuddenLoads};
use crate::solver::EndState;

/// Cells that the slowest front travels before the scheme takes over, where the bar has room. Copper on a wall at 60 m/s, 200 cells: the
/// first cell has 0.9 % too much strain with 6, 0.4 % with 24; the error of all benchmarks is least near 24.
const CELLS: f64 = 24.0;

/// Cells over which fronts but the first are spread, as the scheme itself spreads them: with this shape three from a tenth to nine tenths.
/// With sharp ones the cells at which the scheme takes over keep some 1 % too much strain, as the first ones would without a start.
const RAMP: f64 = 7.0;

/// Nodes ahead of the first front that are held, too: the grid filter moves them.
const AHEAD: usize = 2;

impl Leapfrog {
    /// The same bar, the ends of which start with these fans. For a bar at t = 0 whose laws follow the curves of the fans and take no
    /// time. Passed over are fans of joints, of strikers, of ends under a given stress, those that leave the bar elastic, and those above critical.
    ///
    /// The first rows of the histories of the `ends` are the states just after t = 0. A bar that does not yield `at_once` is elastic then.
    #[must_use]
    pub fn starting_with(mut self, ends: &[EndCondition; 2], initial_fans: &[InitialFan], at_once: bool) -> Self {
        let sides = [Origin::Left, Origin::Right];
        for side in [0, 1] {
            let fan = initial_fans.iter().find(|fan| fan.origin == sides[side]);
            let state = fan.map_or_else(|| self.elastic_start(&ends[side], side, at_once), behind);
            if let Some(state) = state {
                let end = if side == 0 { &mut self.left } else { &mut self.right };
                end.start_in(state);
            }
        }
        let fans = initial_fans.iter().filter_map(|initial_fan| {
            let side = sides.iter().position(|side| *side == initial_fan.origin)?;
            self.starting_fan(initial_fan, side)
        });
        self.fans = fans.collect();
        self
    }

    /// The same bar at t = 0, whose ends and joints are loaded like this.
    #[must_use]
    pub fn under_sudden_loads(mut self, loads: SuddenLoads) -> Self {
        for &(k, load, force) in &loads.joints {
            self.contacts
                .iter_mut()
                .filter(|contact| contact.segment == k)
                .for_each(|contact| contact.load(load, force));
        }
        self.sudden = loads;
        self
    }

    /// Exact states of suddenly loaded ends and joints.
    pub fn sudden_loads(&self) -> &SuddenLoads {
        &self.sudden
    }

    /// An end just after t = 0, if the bar is elastic there.
    fn elastic_start(&self, condition: &EndCondition, side: usize, yields_at_once: bool) -> Option<EndState> {
        let (end, block) = match side {
            0 => (&self.left, &self.blocks[0]),
            _ => (&self.right, &self.blocks[self.blocks.len() - 1]),
        };
        let cell = if side == 0 { 0 } else { block.sigma.len() - 1 };
        let state = end.at_once(condition, block.sigma[cell]);
        let carries = block.is_elastic() && state.stress.abs() <= self.laws[block.segment].yield_stress;
        let answers_at_once = self.implicit.is_none() || end.is_characteristic();
        (answers_at_once && (carries || !yields_at_once)).then_some(state)
    }

    fn starting_fan(&self, initial_fan: &InitialFan, side: usize) -> Option<StartingFan> {
        let fan = &initial_fan.fan;
        // The node of an end under a given stress finds its own velocity: it runs ahead of nodes that are made to move.
        if initial_fan.driver != Driver::Velocity {
            return None;
        }
        let [stress, velocity_behind] = initial_fan.state_behind()?;
        let slowest = fan.edges.last().filter(|edge| fan.edges.len() > 1 && edge.speed > 0.0)?;
        let block = if side == 0 { &self.blocks[0] } else { &self.blocks[self.blocks.len() - 1] };
        if block.taper.is_some() {
            return None;
        }
        let (part, dt) = (&self.grid.segments[initial_fan.segment], self.grid.dt);
        let wanted = (CELLS * part.dx / (slowest.speed * dt)).ceil();
        let possible = (initial_fan.known_until(part.dx * part.cells.len() as f64) / dt).floor() - 1.0;
        let sense = -initial_fan.direction * initial_fan.sense.sign();
        let mut velocity = initial_fan.velocity_ahead;
        let fronts = fan.edges.iter().map(|edge| {
            let (velocity_ahead, jump) = (velocity, sense * edge.velocity_jump());
            velocity += jump;
            Front { speed: edge.speed, jump, velocity_ahead }
        });
        let fronts: Vec<Front> = fronts.collect();
        Some(StartingFan {
            side,
            segment: initial_fan.segment,
            fronts,
            velocity_behind,
            stress,
            ramp: RAMP * part.dx,
            steps: wanted.min(possible).max(0.0) as usize,
            nodes: if initial_fan.alone { part.cells.len() } else { (part.cells.len() - 1) / 2 },
            lost: 0.0,
        })
    }

    /// Steps that are still to be taken one by one.
    pub(super) fn starts_until(&self) -> usize {
        self.fans.iter().map(|fan| fan.steps).max().unwrap_or(0)
    }

    /// Makes the nodes inside the fans move as the fans do in the step ahead.
    pub(super) fn impose_fans(&mut self) {
        let (mut fans, step) = (std::mem::take(&mut self.fans), self.step);
        for fan in fans.iter_mut().filter(|fan| step < fan.steps) {
            let [impulse, energy] = self.impose(fan);
            let end = if fan.side == 0 { &mut self.left } else { &mut self.right };
            end.add_impulse(impulse, fan.velocity_behind, fan.stress);
            fan.lost += impulse * fan.velocity_behind - energy;
        }
        self.fans = fans;
    }

    /// Impulse (N s in +x) and energy (J) that the nodes get.
    fn impose(&mut self, fan: &StartingFan) -> [f64; 2] {
        let (time, dt) = (self.time(), self.grid.dt);
        let reach = fan.fronts[0].speed * (time + dt);
        let count = self.blocks.len();
        let (c, part) = (self.constants[fan.segment], &self.grid.segments[fan.segment]);
        let end_node = if fan.side == 0 { part.cells.start } else { part.cells.end };
        let distance = |node: usize| part.dx * node.abs_diff(end_node) as f64;
        let (mut impulse, mut energy) = (0.0, 0.0);
        for n in 0..count {
            let k = if fan.side == 0 { n } else { count - 1 - n };
            let block = &mut self.blocks[k];
            let ends_here = block.segment != fan.segment;
            if ends_here || distance(block.cells.start).min(distance(block.cells.end)) >= reach + AHEAD as f64 * part.dx
            {
                break;
            }
            block.wake();
            let (first, cells) = (block.cells.start, block.sigma.len());
            let nodes_reached = ((reach / part.dx).ceil() as usize + AHEAD).min(fan.nodes);
            let inside = match fan.side {
                0 => 1..cells.min((end_node + nodes_reached).saturating_sub(first)),
                _ => (end_node.saturating_sub(nodes_reached) + 1).saturating_sub(first).max(1)..cells,
            };
            for i in inside {
                let change = fan.mean_velocity(distance(first + i), time, dt) - block.v[i];
                let velocity_increment = block.velocity_increment(c.velocity_gain, i);
                impulse += c.cell_mass * change;
                energy -= 0.5 * c.cell_mass * grid_filter::node(velocity_increment, change, &mut block.v[i]);
            }
            block.note_undamped();
            // The edge beyond it, where that is inside the segment.
            let edge = if fan.side == 0 { k } else { k.wrapping_sub(1) };
            let beyond = if fan.side == 0 { self.blocks[k].cells.end } else { self.blocks[k].cells.start };
            let inside = part.cells.start < beyond && beyond < part.cells.end;
            if let Some(edge) = self.edges.get_mut(edge).filter(|_| inside) {
                let change = fan.mean_velocity(distance(beyond), time, dt) - edge.after;
                impulse += edge.mass * change;
                energy += edge.impose(change);
            }
        }
        self.share_edges();
        [impulse, energy]
    }
}

/// The end behind a fan, where it holds just after t = 0.
fn behind(initial_fan: &InitialFan) -> Option<EndState> {
    let at_start = initial_fan.holds_until > 0.0 || initial_fan.loads_until == 0.0;
    let [stress, velocity] = initial_fan.state_behind().filter(|_| at_start)?;
    Some(EndState { stress, velocity })
}
