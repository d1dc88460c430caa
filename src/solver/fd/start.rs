//! The first steps at an end or a joint that is suddenly set in motion.
//!
//! The bar there carries a centred fan of fronts, known exactly (see [`crate::wave::similarity`]), which is at first narrower than a few
//! cells. A scheme that starts the fan from rest overshoots, and plastic flow keeps the excess in the first cells permanently, at any
//! resolution: 5 to 22 % of the strain. Until the slowest front has travelled [`crate::bar::START_CELLS`] cells, the nodes inside the fan
//! therefore move as in the exact solution, with its plastic fronts spread over [`RAMP`] cells: each node moves with the mean of its
//! velocity over the step, so that every cell has exactly the mean of the strain.
//!
//! A striker at an end slows down. The unloading waves that follow the fan cancel its slowest fronts; see [`crate::solver::unloading`].
//!
//! Imposing this motion is an impulse on the nodes. Its momentum comes from the end, or from the body there. At a joint nothing supplies
//! it: the impulse on the nodes of both sides together, which is zero except for the fractions of single cells that fronts have passed, is
//! owed by the nodes, and they give it back in the last step. Giving it back in every step made the force at contacts 2 % too large, or ran
//! ahead of the waves. A prescribed stress supplies only its own impulse, and a ball only that of its approach: what the nodes receive in
//! addition is owed in the same way.
//!
//! The energy that all this takes, of first order in the cell size, is in `half_step`, except for the share of shocks.

use super::edge::{adjacent_cell_data, last};
use super::grid_filter;
use super::leapfrog::Leapfrog;
use crate::bar::{Driver, EndCondition, InitialFan, Origin, SuddenLoads};
use crate::solver::{EndState, Resolution, StartingFan};

/// Number of cells over which fronts that are not elastic are spread, as the scheme itself spreads them: with this shape, three cells from
/// a tenth to nine tenths. With sharp fronts, the cells at which the scheme takes over keep about 1 % too much strain, like the first cells
/// without a starting fan.
const RAMP: f64 = 7.0;

/// Fraction of the stress, see [`Leapfrog::is_viscous`]. The largest excess strain with the fan and without it is 2 and 7 % at 0.12 (a
/// foam), 1.1 and -0.1 % at 0.21 (copper), 4 and -0.1 % at 0.3 (the foam). At a shock of the foam it is 1.6 and 2.2 %, in the first cells
/// 0.1 and 2 %.
const VISCOUS: f64 = 0.17;

/// Smallest fraction of the time for which a fan is followed that must pass before distributed forces change the fan, at an end that a
/// stress drives. If they change it earlier, the end oscillates more than without a fan: the force at a dashpot was 21 % too large after
/// 0.07 of that time (4 % without a fan), 3.5 % after 0.12, and 0.7 % after 0.2.
const LEAST_LOADED: f64 = 0.15;

/// Smallest number of cells over which the slowest front of a fan that starts after t = 0 must travel before it meets another wave, such as
/// that of a velocity which soon reverses. If it travels 1 or 2 cells, the strain is 9 to 11 % too large, without the fan 4 %; if it
/// travels 3 to 7 cells, 2 to 4 %.
const LEAST_WIDE: f64 = 2.0;

/// The same for a load that decreases, until it has cancelled the slowest fronts. For a stress on copper that vanishes after 20 and 50
/// steps, the impulse was 22 and 3 % too large, and the strain 27 and 26 % too small; without the fan it was 76 and 62 % too small, as the
/// strain extends over less than a cell.
const LEAST_UNLOADED: f64 = 1.0;

/// Number of nodes ahead of the first front that are imposed, too, as the grid filter moves them.
const AHEAD: usize = 2;

impl Leapfrog {
    /// Returns the bar with these fans at its ends and joints. For a bar at t = 0 whose laws follow the curves of the fans and do not
    /// depend on the strain rate. Skips fans that leave the bar elastic, those above critical, those of moving ends where viscosity alone
    /// keeps the first cells from overshooting, and, if distributed forces act along the bar, those of joints.
    ///
    /// The first rows of the histories of the `ends` are the states just after t = 0. A bar that does not yield `at_once` is elastic then.
    #[must_use]
    pub fn starting_with(mut self, ends: &[EndCondition; 2], initial_fans: &[InitialFan], at_once: bool) -> Self {
        let sides = [Origin::Left, Origin::Right];
        for side in [0, 1] {
            let is_whole = |fan: &&InitialFan| fan.from == 0.0 && fan.delays.is_empty();
            let fan = initial_fans.iter().find(|fan| fan.origin == sides[side] && is_whole(fan));
            let state = fan.map_or_else(|| self.elastic_start(&ends[side], side, at_once), behind);
            let end = if side == 0 { &mut self.left } else { &mut self.right };
            end.start_in(state.unwrap_or(EndState::UNKNOWN));
        }
        self.fans = initial_fans.iter().filter_map(|fan| self.starting_fan(fan)).collect();
        StartingFan::keep_whole_joints(&mut self.fans, self.grid.segments.len());
        // Joints move with their fans from the start; the account begins with the energy of this motion.
        self.impose_fans();
        self.lost_to_fans = 0.0;
        self.initial_energy = self.initial_energy.map(|_| self.energies());
        self
    }

    /// Returns the bar with these sudden loads on its ends and joints. For a bar at t = 0.
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

    /// Returns the exact states of suddenly loaded ends and joints.
    pub fn sudden_loads(&self) -> &SuddenLoads {
        &self.sudden
    }

    /// Returns the state of an end just after t = 0, if the bar is elastic there.
    fn elastic_start(&self, condition: &EndCondition, side: usize, yields_at_once: bool) -> Option<EndState> {
        let (end, block) = match side {
            0 => (&self.left, &self.blocks[0]),
            _ => (&self.right, &self.blocks[self.blocks.len() - 1]),
        };
        let cell = if side == 0 { 0 } else { block.sigma.len() - 1 };
        let state = end.at_once(condition, block.sigma[cell]);
        let carries = block.carries(&self.laws[block.segment], cell, state.stress);
        let answers_at_once = self.implicit.is_none() || end.is_characteristic();
        (answers_at_once && (carries || !yields_at_once)).then_some(state)
    }

    fn starting_fan(&self, initial_fan: &InitialFan) -> Option<StartingFan> {
        let segment = initial_fan.segment;
        let (part, c, dt) = (&self.grid.segments[segment], &self.constants[segment], self.grid.dt);
        let wave_speed = c.courant * part.dx / dt;
        let grid = Resolution { dx: part.dx, cells: part.cells.len(), dt, wave_speed };
        if self.implicit.is_some() && !starts_beside_forces(initial_fan, &grid) {
            return None;
        }
        let mut fan = StartingFan::new(initial_fan, c.cell_mass / c.cell_volume, &grid, RAMP)?;
        let least = match (initial_fan.decays(), initial_fan.from > 0.0) {
            _ if fan.at_joint || fan.driver == Driver::Body => 0.0,
            (true, _) => LEAST_UNLOADED,
            (false, true) => LEAST_WIDE,
            (false, false) => 0.0,
        };
        if fan.imposed_over(grid.dt) < least * grid.dx {
            return None;
        }
        fan.only_origin = self.is_viscous(initial_fan);
        let drives_alone = fan.at_joint || fan.driver == Driver::Stress && !fan.grows();
        (!fan.only_origin || drives_alone).then_some(fan)
    }

    /// Returns whether the artificial viscosity for shocks keeps the first cells from overshooting: it does if it adds more than the
    /// fraction [`VISCOUS`] of the stress of the slowest front of the fan, and that front is not a shock itself.
    fn is_viscous(&self, initial_fan: &InitialFan) -> bool {
        let (shocks, fan) = (self.laws[initial_fan.segment].shocks, &initial_fan.fan);
        let slowest = fan.edges.last().map_or(0.0, |edge| edge.speed);
        !initial_fan.shock && shocks.loading[initial_fan.sense.index()] * fan.velocity > VISCOUS * slowest
    }

    /// Sets the nodes inside the fans to the motion of the fans in the step ahead.
    pub(super) fn impose_fans(&mut self) {
        let mut fans = std::mem::take(&mut self.fans);
        let mut joint: Option<&mut StartingFan> = None;
        let step = self.step;
        for fan in fans.iter_mut().filter(|fan| fan.is_imposed_at(step)) {
            match (fan.at_joint, joint.take()) {
                (false, _) if step == 0 => self.start_growing(fan),
                (false, _) => self.impose_at_end(fan),
                // The two fans of a joint are adjacent in the list, that of the left side first.
                (true, Some(left)) => self.impose_at_joint(left, fan),
                (true, None) => joint = Some(fan),
            }
        }
        self.share_edges();
        fans.retain(|fan| fan.is_imposed_from(step + 1));
        self.fans = fans;
    }

    /// Starts an end with the motion of a fan that grows there; none of its fronts has reached another node yet.
    fn start_growing(&mut self, fan: &StartingFan) {
        let dt = self.grid.dt;
        let end = if fan.side == 0 { &mut self.left } else { &mut self.right };
        // With distributed forces all nodes move together; the end then makes up for this step in the next one.
        if fan.grows() && self.implicit.is_none() {
            end.start_moving(fan.moved(dt) / dt);
        }
    }

    fn impose_at_end(&mut self, fan: &mut StartingFan) {
        let (time, dt) = (self.time() - fan.from, self.grid.dt);
        let end = if fan.side == 0 { &self.left } else { &self.right };
        let middle = time + 0.5 * dt;
        if time >= 0.0 && !fan.grows_at(time) {
            match fan.driver {
                Driver::Stress => fan.record_stress(self.step, middle, end.stress_ahead()),
                _ => fan.record_velocity(self.step, middle, end.velocity_of_body()),
            }
            fan.placed -= fan.slowed(middle) * dt;
        }
        let by_ball = fan.driver == Driver::Stress && end.has_body();
        let by_force = fan.driver == Driver::Stress && end.imposes_force();
        if fan.driver == Driver::Stress && fan.from > 0.0 && fan.begins_at(self.step) {
            fan.placed = end.displacement() - fan.moved(time);
        }
        let gives_back = by_force && fan.ends_at(self.step);
        let Imposed { mut impulse, mass, mut energy } = self.impose_with_end(fan, 0.0, gives_back);
        if by_force {
            // A prescribed force gives no more than its own impulse.
            let owed = fan.add_unbalanced_impulse(self.step, impulse);
            impulse = 0.0;
            if gives_back {
                energy += self.impose_with_end(fan, -owed / mass, true).energy;
            }
        }
        let end = if fan.side == 0 { &mut self.left } else { &mut self.right };
        if by_ball {
            // A narrow fan gives single cells more than its momentum; the excess can be as large as the momentum of a light ball.
            let filtered = end.given_to_filter();
            impulse = fan.add_unbalanced_impulse(self.step, impulse + filtered) - filtered;
        } else if fan.driver == Driver::Stress && !by_force {
            end.set_stress_ahead(fan.means(0.0, time, dt)[1]);
        }
        let [given, taken] = end.apply_impulse(impulse, fan.velocity_at_origin(time, dt));
        // A load that starts within the step ahead does not act yet.
        if time >= 0.0 {
            end.set_recorded_stress(if by_ball {
                fan.stress_of_departed(time)
            } else {
                fan.stress_at_origin(time, dt)
            });
        }
        energy += taken;
        if self.implicit.is_some() {
            self.share_edges();
        }
        if let Some(nodes) = &mut self.implicit {
            energy = nodes.adopt_velocities(&self.blocks);
        }
        self.note_lost(given - energy);
    }

    /// As [`Self::impose`], including the node of an end that does not prescribe its velocity.
    fn impose_with_end(&mut self, fan: &StartingFan, shift: f64, all: bool) -> Imposed {
        let (time, dt) = (self.time() - fan.from, self.grid.dt);
        let mut imposed = self.impose(fan, shift, all);
        if fan.driver == Driver::Stress {
            let end = if fan.side == 0 { &mut self.left } else { &mut self.right };
            // In the first step the end moved as if the bar stayed elastic. It makes up for the difference, unless viscosity would turn
            // this into a shock.
            let change = if fan.only_origin {
                fan.velocity_behind - fan.slowed(time + 0.5 * dt) - end.velocity_after()
            } else {
                (fan.placed + fan.moved(time + dt) - end.displacement_ahead()) / dt
            };
            imposed.note(end.mass(), change + shift, 1.0);
            imposed.energy += end.impose(change + shift);
        }
        imposed
    }

    /// Records energy (J) that ends gave, or the bar had, and that the nodes did not receive; negative if they received more. The fans undo
    /// what the filter has just done to these nodes, so that the work of the filter is known only together with this energy. Shocks have
    /// the same share in it as in the work of the filter.
    fn note_lost(&mut self, lost: f64) {
        let in_shocks = self.taken_in_shocks();
        if in_shocks == 0.0 {
            self.lost_to_fans += lost;
            return;
        }
        let taken = self.taken_by_filter().max(in_shocks);
        for block in &mut self.blocks {
            block.note_lost_in_shocks(lost * block.shock_loss.dissipated() / taken);
        }
        self.lost_to_fans += lost * (1.0 - in_shocks / taken);
    }

    fn impose_at_joint(&mut self, left: &mut StartingFan, right: &mut StartingFan) {
        if left.follows_wave() && !left.begins_at(self.step) {
            self.follow_wave(left, right);
        }
        let ends = left.ends_at(self.step);
        let made = self.impose_on_both(left, right, 0.0, ends);
        let owed = left.add_unbalanced_impulse(self.step, made.impulse);
        if ends {
            self.impose_on_both(left, right, -owed / made.mass, ends);
        }
    }

    /// Reduces the fans of a joint by what the wave that starts them has lost.
    fn follow_wave(&mut self, left: &mut StartingFan, right: &mut StartingFan) {
        let Some(k) = self.blocks.iter().position(|block| block.segment == right.segment) else { return };
        let (time, dt) = (self.time() - left.from, self.grid.dt);
        for block in &mut self.blocks[k - 1..=k] {
            block.stop_travelling(self.constants[block.segment].velocity_gain);
        }
        let pair = &self.blocks[k - 1..=k];
        // Velocity of the joint half a step before the time of the stresses. With them it gives the mean of what arrives half a step before
        // and half a step after that time.
        let before = left.velocity_at_origin(time - dt, dt);
        let stresses = [last(&pair[0].sigma), pair[1].sigma[0]];
        let [_, areas, _] = adjacent_cell_data(pair, &self.constants, dt);
        StartingFan::follow_wave([left, right], self.step, [time, dt], stresses.map(|stress| [stress, before]), areas);
    }

    /// Imposes the fans on a joint and on the nodes on both sides, faster by `shift` (m/s) at the joint: as far as any front has travelled
    /// if `all`, otherwise as far as the fans are imposed.
    fn impose_on_both(&mut self, left: &StartingFan, right: &StartingFan, shift: f64, all: bool) -> Imposed {
        let mut made = self.impose_on_joint([left, right], shift);
        for fan in [left, right] {
            made.add(self.impose(fan, shift, all));
        }
        self.note_lost(-made.energy);
        made
    }

    /// Returns the impulse that nodes inside fans have received from no source so far, N s in +x.
    pub(super) fn unbalanced_impulse(&self) -> f64 {
        self.fans.iter().map(|fan| fan.unbalanced_impulse).sum()
    }

    /// Imposes two fans on the nodes at the joint between them. Returns impulse and energy as [`Self::impose`] does.
    fn impose_on_joint(&mut self, fans: [&StartingFan; 2], shift: f64) -> Imposed {
        let (time, dt) = (self.time() - fans[0].from, self.grid.dt);
        let velocities = fans.map(|fan| fan.means(0.0, time, dt)[0] + shift);
        let Some(right) = self.blocks.iter().position(|block| block.segment == fans[1].segment) else {
            return Imposed::default();
        };
        let (mut imposed, edge) = (Imposed::default(), right - 1);
        if let Some(contact) = self.contacts.iter_mut().find(|contact| contact.edge == edge) {
            let changes = [0, 1].map(|side| velocities[side] - contact.velocities(side)[1]);
            for side in [0, 1] {
                imposed.note(contact.mass(side, dt), changes[side], 1.0);
            }
            imposed.energy += contact.impose(changes, dt);
        } else {
            let node = &mut self.edges[edge];
            let change = velocities[1] - node.after;
            imposed.note(node.mass, change, 1.0);
            imposed.energy += node.impose(change);
        }
        imposed
    }

    /// Imposes a fan on the nodes inside it, faster by `shift` (m/s) at its origin and by less and less from there on: as far as any front
    /// has travelled if `all`, otherwise as far as the fan is imposed. Returns the impulse and the energy of the nodes.
    fn impose(&mut self, fan: &StartingFan, shift: f64, all: bool) -> Imposed {
        let (time, dt) = (self.time() - fan.from, self.grid.dt);
        let (c, part) = (self.constants[fan.segment], &self.grid.segments[fan.segment]);
        let imposed_reach = fan.imposed_reach(time + dt);
        let reach = if all { fan.reach(time + dt) } else { imposed_reach };
        if reach == 0.0 {
            return Imposed::default();
        }
        let weight = |distance: f64| (1.0 - distance / (reach + AHEAD as f64 * part.dx)).max(0.0);
        let is_free = |distance: f64| fan.only_origin || distance >= imposed_reach + AHEAD as f64 * part.dx;
        let change = |distance: f64, velocity: f64| {
            let fans = if is_free(distance) { 0.0 } else { fan.means(distance, time, dt)[0] - velocity };
            fans + shift * weight(distance)
        };
        let end_node = if fan.side == 0 { part.cells.start } else { part.cells.end };
        let distance = |node: usize| part.dx * node.abs_diff(end_node) as f64;
        let mut imposed = Imposed::default();
        let ours: Vec<usize> = (0..self.blocks.len()).filter(|&k| self.blocks[k].segment == fan.segment).collect();
        for n in 0..ours.len() {
            let k = if fan.side == 0 { ours[n] } else { ours[ours.len() - 1 - n] };
            let block = &mut self.blocks[k];
            if distance(block.cells.start).min(distance(block.cells.end)) >= reach + AHEAD as f64 * part.dx {
                break;
            }
            let (first, cells) = (block.cells.start, block.sigma.len());
            let nodes_reached = ((reach / part.dx).ceil() as usize + AHEAD).min(fan.nodes);
            let inside = match fan.side {
                0 => 1..cells.min((end_node + nodes_reached).saturating_sub(first)),
                _ => (end_node.saturating_sub(nodes_reached) + 1).saturating_sub(first).max(1)..cells,
            };
            block.stop_travelling(c.velocity_gain);
            block.wake();
            for i in inside {
                let distance = distance(first + i);
                let change = change(distance, block.v[i]);
                let mass = c.cell_mass * block.node_mass(i);
                imposed.note(mass, change, weight(distance));
                let velocity_increment = block.velocity_increment(c.velocity_gain, i);
                imposed.energy -= 0.5 * mass * grid_filter::node(velocity_increment, change, &mut block.v[i]);
            }
            block.note_undamped();
            // The edge beyond the block, if it is inside the segment.
            let edge = if fan.side == 0 { k } else { k.wrapping_sub(1) };
            let beyond = if fan.side == 0 { self.blocks[k].cells.end } else { self.blocks[k].cells.start };
            let inside =
                part.cells.start < beyond && beyond < part.cells.end && end_node.abs_diff(beyond) < nodes_reached;
            if let Some(edge) = self.edges.get_mut(edge).filter(|_| inside) {
                let change = change(distance(beyond), edge.after);
                imposed.note(edge.mass, change, weight(distance(beyond)));
                imposed.energy += edge.impose(change);
            }
        }
        imposed
    }
}

/// Returns whether a bar with distributed forces starts with this fan, on this grid.
fn starts_beside_forces(fan: &InitialFan, grid: &Resolution) -> bool {
    let Resolution { dx, cells, wave_speed, .. } = *grid;
    let lasts = || fan.known_until(dx * cells as f64) >= LEAST_LOADED * fan.followed_for(dx, wave_speed);
    !matches!(fan.origin, Origin::Joint(_)) && (fan.driver != Driver::Stress || lasts())
}

/// Totals over nodes whose motion is imposed.
#[derive(Debug, Clone, Copy, Default)]
struct Imposed {
    /// Impulse, N s in +x.
    impulse: f64,
    /// Mass of the nodes, each weighted with the fraction of the shift that it receives, kg.
    mass: f64,
    /// Energy, J.
    energy: f64,
}

impl Imposed {
    /// Adds a node of this mass (kg), which receives this fraction of the shift and this change of velocity (m/s).
    fn note(&mut self, mass: f64, change: f64, shifted: f64) {
        self.impulse += mass * change;
        self.mass += mass * shifted;
    }

    fn add(&mut self, other: Self) {
        self.impulse += other.impulse;
        self.mass += other.mass;
        self.energy += other.energy;
    }
}

/// Returns the state of the end behind a fan, if the fan holds just after t = 0.
fn behind(initial_fan: &InitialFan) -> Option<EndState> {
    let at_start = initial_fan.holds_until > 0.0 || initial_fan.loads_until == 0.0;
    let [stress, velocity] = initial_fan.state_behind().filter(|_| at_start)?;
    Some(EndState { stress, velocity })
}
