//! `/paths`: the fronts' straight pieces in x and t, a compound table that grows with the run, numbered by `/path`.

use hdf5::{Dataset, Extent, File};
use ndarray::s;

use super::create::{put, put_text};
use super::scales;
use crate::record::PathRow;

type Hdf<T> = hdf5::Result<T>;

/// Rows in a chunk: written whole but for the last.
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
pub(super) fn build(file: &File) -> Hdf<()> {
    let table = file.new_dataset::<Row>().chunk(CHUNK).shape(Extent::resizable(0)).create("paths")?;
    put_text(
        &table,
        "long_name",
        "straight pieces of fronts: places m, times s, stress behind less ahead Pa, speed m/s",
    )?;
    put(&table, "complete", &0_u8)?;
    file.new_dataset::<i64>().chunk(CHUNK).shape(Extent::resizable(0)).create("path")?;
    scales::attach(file, &["path"], &["paths"])
}

/// All rows of a file.
pub(super) fn read(file: &File) -> Hdf<Vec<PathRow>> {
    let rows: Vec<Row> = file.dataset("paths")?.read_raw()?;
    Ok(rows.iter().map(PathRow::from).collect())
}

/// The table of an open file, and the rows that wait.
#[derive(Debug)]
pub(super) struct PathTable {
    table: Dataset,
    numbers: Dataset,
    waiting: Vec<Row>,
    written: usize,
}

impl PathTable {
    pub fn open(file: &File) -> Hdf<Self> {
        let (table, numbers) = (file.dataset("paths")?, file.dataset("path")?);
        Ok(Self { table, numbers, waiting: Vec::new(), written: 0 })
    }

    /// Keeps rows; true where it is time to write.
    pub fn push(&mut self, rows: &[PathRow]) -> bool {
        self.waiting.extend(rows.iter().map(Row::from));
        self.waiting.len() >= BLOCK
    }

    /// Writes the waiting rows, then their numbers.
    pub fn write(&mut self) -> Hdf<bool> {
        if self.waiting.is_empty() {
            return Ok(false);
        }
        let (start, end) = (self.written, self.written + self.waiting.len());
        self.table.resize(end)?;
        self.table.write_slice(&self.waiting, s![start..end])?;
        self.numbers.resize(end)?;
        let numbers: Vec<i64> = (0_i64..).skip(start).take(end - start).collect();
        self.numbers.write_slice(&numbers, s![start..end])?;
        self.waiting.clear();
        self.written = end;
        Ok(true)
    }

    /// Says whether every front is in the table.
    pub fn finish(&self, complete: bool) -> Hdf<()> {
        self.table.attr("complete")?.write_scalar(&u8::from(complete))
    }
}
