//! Full-rate histories of a bar on a grid: gauges and both ends, a row a step.

use super::{Stepped, Trace};
use crate::solver::fd::{Log, Quantity, Sampling, between};

/// Rows that are gathered before they are handed on.
const BATCH: usize = 4096;

/// Histories being gathered.
#[derive(Debug)]
pub struct Traces {
    places: Sampling,
    /// The cells that gauges read, increasing.
    cells: Vec<usize>,
    gauges: Vec<Trace>,
    ends: [Trace; 2],
    /// Gauges read the temperature.
    heat: bool,
}

impl Traces {
    /// Gauges at the places of `places`, which read the temperature where there is `heat`, and both ends.
    pub fn new(places: Sampling, heat: bool) -> Self {
        let gauges = vec![Trace::default(); places.x().len()];
        let mut cells = places.cells_read();
        cells.sort_unstable();
        cells.dedup();
        Self { places, cells, gauges, ends: [Trace::default(), Trace::default()], heat }
    }

    /// The cells that gauges read, increasing.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// True where a batch is full.
    pub fn is_full(&self) -> bool {
        self.ends[0].time.len() >= BATCH
    }

    /// Adds the bar's current state to every history.
    pub fn add(&mut self, bar: &impl Stepped) {
        let time = bar.time();
        for (trace, end) in self.ends.iter_mut().zip(bar.ends()) {
            trace.time.push(time);
            trace.stress.push(end.stress);
            trace.velocity.push(end.velocity);
        }
        for (k, trace) in self.gauges.iter_mut().enumerate() {
            let read = |quantity| self.places.value(k, |cell| bar.value(quantity, cell));
            trace.time.push(time);
            trace.stress.push(read(Quantity::Stress));
            trace.strain.push(read(Quantity::Strain));
            trace.velocity.push(read(Quantity::Velocity));
            if self.heat {
                trace.temperature.push(read(Quantity::Temperature));
            }
        }
    }

    /// Takes a bar so many steps on, one by one, and adds each.
    pub fn follow(&mut self, bar: &mut impl Stepped, steps: usize) {
        for _ in 0..steps {
            bar.advance();
            self.add(bar);
        }
    }

    /// Adds what a bar logged, step by step, at these times (s).
    pub fn add_log(&mut self, times: &[f64], log: &Log) {
        for (trace, rows) in self.ends.iter_mut().zip(&log.ends) {
            trace.time.extend(times);
            trace.stress.extend(rows.iter().map(|row| row[0]));
            trace.velocity.extend(rows.iter().map(|row| row[1]));
        }
        for (k, trace) in self.gauges.iter_mut().enumerate() {
            let (cell, weight) = self.places.point(k);
            let column = self.cells.partition_point(|&c| c < cell);
            let (here, there) = (&log.cells[column], log.cells.get(column + 1));
            let history = |quantity: usize| {
                let beyond = move |step: usize| there.map_or(f64::NAN, |rows| rows[step][quantity]);
                let value = move |(step, row): (usize, &[f64; 4])| between(weight, row[quantity], || beyond(step));
                here.iter().enumerate().map(value)
            };
            trace.time.extend(times);
            trace.stress.extend(history(0));
            trace.strain.extend(history(1));
            trace.velocity.extend(history(2));
            if self.heat {
                trace.temperature.extend(history(3));
            }
        }
    }

    /// Hands on what was gathered since the last call: gauges in order, then the left and right end.
    pub fn take(&mut self) -> (Vec<Trace>, [Trace; 2]) {
        let gauges = self.gauges.iter_mut().map(std::mem::take).collect();
        (gauges, std::mem::take(&mut self.ends))
    }
}
