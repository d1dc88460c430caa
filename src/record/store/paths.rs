//! `/paths`: the fronts' straight pieces in x and t, a compound table that grows with the run, numbered by `/path`. Both are
//! compressed as the fields are, and then written in whole chunks until the run ends: a compressed chunk that is written
//! again would move, see `create`.

use hdf5::{Dataset, Extent, File};
use ndarray::s;

use super::attributes::{put, put_text};
use super::columns::cut;
use super::filters::{compressed, shuffled};
use super::{bounded, scales};
use crate::record::{Compression, PathRow};

type Hdf<T> = hdf5::Result<T>;

/// Rows in a chunk: also the most that a killed run loses where they are compressed.
const CHUNK: usize = 4096;
/// Rows that wait before they are written without a flush.
const BLOCK: usize = 16 * CHUNK;

/// A row as it stands in the file.
#[derive(hdf5::H5Type, Clone, Copy, Debug, Default)]
#[repr(C)]
struct Row {
    x0: f64,
    t0: f64,
    x1: f64,
    t1: f64,
    stress_jump: f64,
    speed: f64,
}

impl From<&PathRow> for Row {
    fn from(row: &PathRow) -> Self {
        let PathRow { x0, t0, x1, t1, stress_jump, speed } = *row;
        Self { x0, t0, x1, t1, stress_jump, speed }
    }
}

impl From<&Row> for PathRow {
    fn from(row: &Row) -> Self {
        let Row { x0, t0, x1, t1, stress_jump, speed } = *row;
        Self { x0, t0, x1, t1, stress_jump, speed }
    }
}

/// The empty table and its scale.
pub(super) fn build(file: &File, compression: Compression) -> Hdf<()> {
    // A front starts where another ended, and runs at one of few speeds: whole numbers come again, in a third less bytes and
    // half the time that shuffled ones take.
    let builder = compressed(file.new_dataset::<Row>(), compression);
    let table = builder.chunk(CHUNK).shape(Extent::resizable(0)).create("paths")?;
    put_text(
        &table,
        "long_name",
        "straight pieces of fronts: places m, times s, stress behind less ahead Pa, speed m/s",
    )?;
    put(&table, "complete", &0_u8)?;
    let builder = shuffled(file.new_dataset::<i64>(), compression);
    builder.chunk(CHUNK).shape(Extent::resizable(0)).create("path")?;
    scales::attach(file, &["path"], &["paths"])
}

/// All rows of a file.
pub(super) fn read(file: &File) -> Hdf<Vec<PathRow>> {
    let rows: Vec<Row> = bounded::column(&file.dataset("paths")?)?;
    Ok(rows.iter().map(PathRow::from).collect())
}

/// The table of an open file, and the rows that wait.
#[derive(Debug)]
pub(super) struct PathTable {
    table: Dataset,
    numbers: Dataset,
    waiting: Vec<Row>,
    written: usize,
    /// What is written before the end comes in multiples of this.
    multiple: usize,
}

impl PathTable {
    pub fn open(file: &File, compression: Compression) -> Hdf<Self> {
        let (table, numbers) = (file.dataset("paths")?, file.dataset("path")?);
        let multiple = if compression == Compression::None { 1 } else { CHUNK };
        Ok(Self { table, numbers, waiting: Vec::new(), written: 0, multiple })
    }

    /// Keeps the first rows alone, and those that waited when there were so many.
    pub fn cut(&mut self, rows: usize, waiting: &[PathRow]) -> Hdf<()> {
        cut(&self.table, rows)?;
        cut(&self.numbers, rows)?;
        self.waiting = waiting.iter().map(Row::from).collect();
        self.written = rows;
        Ok(())
    }

    /// Rows in the file.
    pub fn written(&self) -> usize {
        self.written
    }

    /// Rows that wait.
    pub fn waiting(&self) -> Vec<PathRow> {
        self.waiting.iter().map(PathRow::from).collect()
    }

    /// Keeps rows; true where it is time to write.
    pub fn push(&mut self, rows: &[PathRow]) -> bool {
        self.waiting.extend(rows.iter().map(Row::from));
        self.waiting.len() >= BLOCK
    }

    /// Bytes that waiting rows take at most.
    pub fn bytes(&self) -> usize {
        (size_of::<Row>() + size_of::<i64>()) * (self.waiting.len() + self.waiting.len() / 8).next_multiple_of(CHUNK)
    }

    /// Writes the waiting rows, as far as a run that goes on can.
    pub fn write(&mut self) -> Hdf<bool> {
        self.write_rows(self.waiting.len() - self.waiting.len() % self.multiple)
    }

    /// Writes the first of the waiting rows, then their numbers.
    fn write_rows(&mut self, rows: usize) -> Hdf<bool> {
        if rows == 0 {
            return Ok(false);
        }
        let (start, end) = (self.written, self.written + rows);
        self.table.resize(end)?;
        self.table.write_slice(&self.waiting[..rows], s![start..end])?;
        self.numbers.resize(end)?;
        let numbers: Vec<i64> = (0_i64..).skip(start).take(rows).collect();
        self.numbers.write_slice(&numbers, s![start..end])?;
        self.waiting.drain(..rows);
        self.written = end;
        Ok(true)
    }

    /// Writes the rest, and says whether every front is in the table.
    pub fn finish(&mut self, complete: bool) -> Hdf<()> {
        self.write_rows(self.waiting.len())?;
        self.table.attr("complete")?.write_scalar(&u8::from(complete))
    }
}
