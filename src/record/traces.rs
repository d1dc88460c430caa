//! Full-rate histories of a bar on a grid: gauges and both ends, one row per step.

use super::Trace;
use super::end_rows::EndRows;
use crate::bar::SuddenLoad;
use crate::solver::EndSample;
use crate::solver::fd::{Log, Quantity, Sampling, between};

/// Number of rows that are collected before they are passed on.
const BATCH: usize = 4096;

/// Histories under construction.
#[derive(Debug)]
pub struct Traces {
    places: Sampling,
    /// Indices of the cells that the gauges read, increasing.
    cells: Vec<usize>,
    gauges: Vec<Trace>,
    ends: [EndRows; 2],
    /// True if the gauges record the temperature.
    heat: bool,
}

impl Traces {
    /// Creates the histories of gauges at the places of `places`, with the temperature if `heat` is set, and of both ends with their sudden loads.
    pub fn new(places: Sampling, heat: bool, sudden: [Vec<SuddenLoad>; 2]) -> Self {
        let gauges = places.x().iter().map(|_| gauge(heat)).collect();
        let mut cells = places.cells_read();
        cells.sort_unstable();
        cells.dedup();
        Self { places, cells, gauges, ends: sudden.map(|load| EndRows::new(end(), load)), heat }
    }

    /// Returns the indices of the cells that the gauges read, increasing.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Returns true if a batch is full.
    pub fn is_full(&self) -> bool {
        self.ends[0].ready() >= BATCH
    }

    /// Adds the state of a bar at a time (s) to every history; `value` returns a quantity in a cell.
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

    /// Adds the states that a bar logged at each of its steps; `times` are the times of these steps, s.
    pub fn add_log(&mut self, times: &(impl ExactSizeIterator<Item = f64> + Clone), log: &Log<'_>) {
        for (rows, samples) in self.ends.iter_mut().zip(log.ends) {
            rows.add(times.clone().zip(samples.iter().copied()));
        }
        for (k, trace) in self.gauges.iter_mut().enumerate() {
            let (cell, weight) = self.places.point(k);
            let column = self.cells.partition_point(|&c| c < cell);
            let here = log.cells[column];
            // With zero weight the second cell is not read: it may not exist.
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

    /// Discards the rows from a time (s) onwards that have not been passed on yet.
    pub fn drop_from(&mut self, time: f64) {
        self.ends.iter_mut().for_each(|rows| rows.drop_from(time));
        for trace in &mut self.gauges {
            let kept = trace.time.partition_point(|&at| at < time);
            for column in trace.columns_mut() {
                column.truncate(kept);
            }
        }
    }

    /// Completes the histories of the ends at the end of a run.
    pub fn close(&mut self) {
        self.ends.iter_mut().for_each(EndRows::close);
    }

    /// Returns the incomplete histories of the ends that remain after [`Self::take`], for a checkpoint.
    pub fn waiting(&self) -> &[EndRows; 2] {
        &self.ends
    }

    /// Restores the histories returned by [`Self::waiting`].
    pub fn restore(&mut self, waiting: [EndRows; 2]) {
        self.ends = waiting;
    }

    /// Returns the rows collected since the last call: the gauges in order, then the left and the right end.
    pub fn take(&mut self) -> (Vec<Trace>, [Trace; 2]) {
        let heat = self.heat;
        let gauges = self.gauges.iter_mut().map(|trace| std::mem::replace(trace, gauge(heat))).collect();
        (gauges, self.ends.each_mut().map(|rows| rows.take(end())))
    }
}

/// Returns an empty column with capacity for a batch and for the steps that are added after it is full.
fn column() -> Vec<f64> {
    Vec::with_capacity(BATCH + BATCH / 8)
}

/// Returns an empty history of an end.
fn end() -> Trace {
    Trace { time: column(), stress: column(), velocity: column(), ..Trace::default() }
}

/// Returns an empty history of a gauge.
fn gauge(heat: bool) -> Trace {
    Trace { strain: column(), temperature: if heat { column() } else { Vec::new() }, ..end() }
}
