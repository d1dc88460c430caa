//! Full-rate histories of a bar on a grid: gauges and both ends, one row per step.

use super::Trace;
use super::end_rows::EndRows;
use crate::bar::SuddenLoad;
use crate::solver::EndSample;
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
    ends: [EndRows; 2],
    /// Gauges read the temperature.
    heat: bool,
}

impl Traces {
    /// Gauges at the places of `places`, which read the temperature where there is `heat`, and both ends, which may be loaded suddenly.
    pub fn new(places: Sampling, heat: bool, sudden: [Vec<SuddenLoad>; 2]) -> Self {
        let gauges = places.x().iter().map(|_| gauge(heat)).collect();
        let mut cells = places.cells_read();
        cells.sort_unstable();
        cells.dedup();
        Self { places, cells, gauges, ends: sudden.map(|load| EndRows::new(end(), load)), heat }
    }

    /// The cells that gauges read, increasing.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// True where a batch is full.
    pub fn is_full(&self) -> bool {
        self.ends[0].ready() >= BATCH
    }

    /// Adds the state of a bar at a time (s) to every history; `value` is that of a quantity in a cell.
    pub fn add(&mut self, time: f64, ends: [EndSample; 2], value: impl Fn(Quantity, usize) -> f64) {
        for (rows, end) in self.ends.iter_mut().zip(ends) {
            rows.add(std::iter::once((time, end)));
        }
        for (k, trace) in self.gauges.iter_mut().enumerate() {
            let read = |quantity| self.places.value(k, |cell| value(quantity, cell));
            trace.time.push(time);
            trace.stress.push(read(Quantity::Stress));
            trace.strain.push(read(Quantity::Strain));
            trace.velocity.push(read(Quantity::Velocity));
            if self.heat {
                trace.temperature.push(read(Quantity::Temperature));
            }
        }
    }

    /// Adds what a bar logged, step by step, at these times (s).
    pub fn add_log(&mut self, times: &(impl ExactSizeIterator<Item = f64> + Clone), log: &Log<'_>) {
        for (rows, samples) in self.ends.iter_mut().zip(log.ends) {
            rows.add(times.clone().zip(samples.iter().copied()));
        }
        for (k, trace) in self.gauges.iter_mut().enumerate() {
            let (cell, weight) = self.places.point(k);
            let column = self.cells.partition_point(|&c| c < cell);
            let here = log.cells[column];
            // Without weight nothing is read beyond.
            let there = if weight == 0.0 { here } else { log.cells[column + 1] };
            trace.time.extend(times.clone());
            for step in 0..times.len() {
                let (here, there) = (here.after(step), there.after(step));
                let now: [f64; 4] = std::array::from_fn(|quantity| between(weight, here[quantity], || there[quantity]));
                trace.stress.push(now[0]);
                trace.strain.push(now[1]);
                trace.velocity.push(now[2]);
                if self.heat {
                    trace.temperature.push(now[3]);
                }
            }
        }
    }

    /// Drops the rows from a time on, s, as far as they are not handed on yet.
    pub fn drop_from(&mut self, time: f64) {
        self.ends.iter_mut().for_each(|rows| rows.drop_from(time));
        for trace in &mut self.gauges {
            let kept = trace.time.partition_point(|&at| at < time);
            for column in trace.columns_mut() {
                column.truncate(kept);
            }
        }
    }

    /// The ends have come to the end of their histories.
    pub fn close(&mut self) {
        self.ends.iter_mut().for_each(EndRows::close);
    }

    /// What the ends still hold once everything is handed on, for a checkpoint.
    pub fn waiting(&self) -> &[EndRows; 2] {
        &self.ends
    }

    /// Takes over what [`Self::waiting`] gave.
    pub fn restore(&mut self, waiting: [EndRows; 2]) {
        self.ends = waiting;
    }

    /// Hands on what was gathered since the last call: gauges in order, then the left and right end.
    pub fn take(&mut self) -> (Vec<Trace>, [Trace; 2]) {
        let heat = self.heat;
        let gauges = self.gauges.iter_mut().map(|trace| std::mem::replace(trace, gauge(heat))).collect();
        (gauges, self.ends.each_mut().map(|rows| rows.take(end())))
    }
}

/// Room for a batch, and for the steps that go in one after it is full.
fn column() -> Vec<f64> {
    Vec::with_capacity(BATCH + BATCH / 8)
}

/// An empty history of an end.
fn end() -> Trace {
    Trace { time: column(), stress: column(), velocity: column(), ..Trace::default() }
}

/// An empty history of a gauge.
fn gauge(heat: bool) -> Trace {
    Trace { strain: column(), temperature: if heat { column() } else { Vec::new() }, ..end() }
}
