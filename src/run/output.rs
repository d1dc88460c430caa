//! Destination of the frames and histories of a run: a result file, memory, or none.

use std::collections::BTreeMap;

use ndarray::{Array1, Array2, ArrayView1};

use crate::error::Result;
use crate::record::store::{Side, Writer};
use crate::record::{Field, Frame, FrontRow, LedgerRow, PathRow, Summary, Trace};

/// Results of a run in memory: the frames, histories, ledger, fronts and paths of a result file as arrays.
#[derive(Debug)]
pub struct Solution {
    /// Summary of the run. If `progress` requested a stop, the outcome is "interrupted" and everything else describes the run up to the stop.
    pub summary: Summary,
    /// Sampling positions of the fields along the bar, m, of shape (`n_x`).
    pub x: Array1<f64>,
    /// Times of the frames, s, of shape (`n_t`).
    pub time: Array1<f64>,
    /// Recorded fields (`fields` under `[record]`) of shape (`n_t`, `n_x`), in SI units; stress in Pa, tension positive.
    pub fields: Vec<(Field, Array2<f64>)>,
    /// Histories at the gauges by name: every step of a grid, or every change with front tracking.
    pub gauges: BTreeMap<String, Trace>,
    /// Names and positions of the gauges, m from the left end, in the order of the scene.
    pub gauge_places: Vec<(String, f64)>,
    /// Histories of stress and velocity at the left and the right end; the other columns are empty.
    pub ends: [Trace; 2],
    /// Energies and momentum, one row per frame.
    pub ledger: Vec<LedgerRow>,
    /// Fronts with their arrival times at the gauges, in the order of [`Solution::gauge_places`].
    pub fronts: Vec<FrontRow>,
    /// Straight segments of all fronts, if the scene records them (`record.paths`) and front tracking is used.
    pub paths: Vec<PathRow>,
    /// Whether [`Solution::paths`] covers the whole run: it recorded them, reached its end, and their number did not exceed the limit.
    pub paths_complete: bool,
}

impl Solution {
    /// Returns a recorded field of shape (`n_t`, `n_x`); `None` if it was not recorded.
    pub fn field(&self, field: Field) -> Option<&Array2<f64>> {
        self.fields.iter().find(|(recorded, _)| *recorded == field).map(|(_, values)| values)
    }

    /// Returns the last frame of a recorded field, of shape (`n_x`).
    pub fn last(&self, field: Field) -> Option<ArrayView1<'_, f64>> {
        let values = self.field(field)?;
        values.rows().into_iter().next_back()
    }
}

/// Data of a run, collected in memory.
#[derive(Debug, Default)]
pub(super) struct Kept {
    x: Vec<f64>,
    time: Vec<f64>,
    fields: Vec<Field>,
    rows: Vec<Vec<f64>>,
    places: Vec<(String, f64)>,
    gauges: Vec<Trace>,
    ends: [Trace; 2],
    ledger: Vec<LedgerRow>,
    paths: Vec<PathRow>,
    closed: Option<Closed>,
}

/// Data that are known when a run closes.
#[derive(Debug)]
pub(super) struct Closed {
    pub fronts: Vec<FrontRow>,
    pub paths_complete: bool,
    /// Summary of an interrupted run, which returns an error instead of a summary.
    pub interrupted: Option<Summary>,
}

impl Kept {
    /// Creates the storage for fields at positions `x` (m), and for gauges with their names and positions.
    pub fn new(x: Vec<f64>, fields: Vec<Field>, places: Vec<(String, f64)>) -> Self {
        let (rows, gauges) = (vec![Vec::new(); fields.len()], vec![Trace::default(); places.len()]);
        Self { x, fields, rows, places, gauges, ..Self::default() }
    }

    /// Adds the data that are known at the end.
    pub fn close(self, closed: Closed) -> Self {
        Self { closed: Some(closed), ..self }
    }

    /// Takes the summary of an interrupted run.
    pub fn take_interrupted(&mut self) -> Option<Summary> {
        self.closed.as_mut()?.interrupted.take()
    }

    pub fn solution(self, summary: Summary) -> Solution {
        let shape = (self.time.len(), self.x.len());
        let field = |values: Vec<f64>| Array2::from_shape_vec(shape, values).unwrap_or_else(|_| Array2::zeros((0, 0)));
        Solution {
            summary,
            fields: self.fields.into_iter().zip(self.rows.into_iter().map(field)).collect(),
            x: self.x.into(),
            time: self.time.into(),
            gauges: self.places.iter().map(|(name, _)| name.clone()).zip(self.gauges).collect(),
            gauge_places: self.places,
            ends: self.ends,
            ledger: self.ledger,
            paths: self.paths,
            paths_complete: self.closed.as_ref().is_some_and(|closed| closed.paths_complete),
            fronts: self.closed.map(|closed| closed.fronts).unwrap_or_default(),
        }
    }
}

/// Destination of the data of a run.
#[derive(Debug)]
pub(super) enum Output {
    /// Data are discarded.
    None,
    File(Writer),
    Memory(Box<Kept>),
}

impl Output {
    /// Returns whether frames are recorded.
    pub fn takes_frames(&self) -> bool {
        !matches!(self, Self::None)
    }

    pub fn frame(&mut self, frame: Frame) -> Result<()> {
        match self {
            Self::None => Ok(()),
            Self::File(writer) => writer.frame(frame),
            Self::Memory(kept) => {
                kept.time.push(frame.time);
                for (rows, row) in kept.rows.iter_mut().zip(frame.rows) {
                    rows.extend(row);
                }
                Ok(())
            }
        }
    }

    pub fn gauge(&mut self, index: usize, trace: Trace) -> Result<()> {
        match self {
            Self::None => Ok(()),
            Self::File(writer) => writer.gauge(index, trace),
            Self::Memory(kept) => {
                append(&mut kept.gauges[index], trace);
                Ok(())
            }
        }
    }

    pub fn end(&mut self, side: Side, trace: Trace) -> Result<()> {
        match self {
            Self::None => Ok(()),
            Self::File(writer) => writer.end(side, trace),
            Self::Memory(kept) => {
                append(&mut kept.ends[side as usize], trace);
                Ok(())
            }
        }
    }

    pub fn ledger(&mut self, row: LedgerRow) -> Result<()> {
        match self {
            Self::None => Ok(()),
            Self::File(writer) => writer.ledger(row),
            Self::Memory(kept) => {
                kept.ledger.push(row);
                Ok(())
            }
        }
    }

    /// Adds paths of fronts.
    pub fn paths(&mut self, rows: Vec<PathRow>) -> Result<()> {
        match self {
            Self::File(writer) if !rows.is_empty() => writer.paths(rows),
            Self::None | Self::File(_) => Ok(()),
            Self::Memory(kept) => {
                kept.paths.extend(rows);
                Ok(())
            }
        }
    }

    /// Returns the result file, if there is one.
    pub fn writer(&mut self) -> Option<&mut Writer> {
        if let Self::File(writer) = self { Some(writer) } else { None }
    }
}

fn append(to: &mut Trace, mut trace: Trace) {
    for (to, column) in to.columns_mut().into_iter().zip(trace.columns_mut()) {
        to.append(column);
    }
}
