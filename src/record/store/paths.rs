//! `/paths`: straight segments of the fronts in x and t, a table that grows during the run. It is compressed as the
//! fields are, and then written in whole chunks until the run ends, because a compressed chunk that is written again
//! would move, see `create`.

use hdf5::{Dataset, Extent, File, Group};
use ndarray::s;

use super::attributes::{describe, put, put_text};
use super::chunks::Chunks;
use super::columns::{append, cut};
use super::filters::{compressed, shuffled};
use super::{bounded, scales};
use crate::record::{Compression, PathRow};

type Hdf<T> = hdf5::Result<T>;

/// Number of rows in a chunk, which is also the largest number that a killed run loses if the table is compressed.
const CHUNK: usize = 4096;
/// Number of waiting rows at which they are written without a flush.
const BLOCK: usize = 16 * CHUNK;

/// Column: name, units, long name, value.
type PathColumn = (&'static str, &'static str, &'static str, fn(&PathRow) -> f64);

const COLUMNS: [PathColumn; 6] = [
    ("x0", "m", "position of the start", |row| row.x0),
    ("t0", "s", "time of the start", |row| row.t0),
    ("x1", "m", "position of the end", |row| row.x1),
    ("t1", "s", "time of the end", |row| row.t1),
    ("stress_jump", "Pa", "stress behind minus stress ahead", |row| row.stress_jump),
    ("speed", "m/s", "speed, positive in +x", |row| row.speed),
];

/// Name of the scale that numbers the rows.
const NUMBER: &str = "path";

/// Creates the empty table and its scale.
pub(super) fn build(file: &File, compression: Compression) -> Hdf<()> {
    let group = file.create_group("paths")?;
    put_text(&group, "long_name", "straight segments of fronts")?;
    put(&group, "complete", &0_u8)?;
    for (name, units, long_name, _) in COLUMNS {
        // A front starts where another one ended, and has one of few speeds, so that whole numbers recur. Without
        // shuffling they need a quarter fewer bytes.
        let builder = compressed(group.new_dataset::<f64>(), compression);
        describe(&builder.chunk(CHUNK).shape(Extent::resizable(0)).create(name)?, units, long_name)?;
    }
    let builder = shuffled(group.new_dataset::<i64>(), compression);
    builder.chunk(CHUNK).shape(Extent::resizable(0)).create(NUMBER)?;
    scales::attach(&group, &[NUMBER], &COLUMNS.map(|column| column.0))
}

/// Returns all rows of a file.
pub(super) fn read(file: &File) -> Hdf<Vec<PathRow>> {
    let group = file.group("paths")?;
    let mut columns = Vec::with_capacity(COLUMNS.len());
    for (name, ..) in COLUMNS {
        columns.push(bounded::column::<f64>(&group.dataset(name)?)?);
    }
    // Columns differ in length only if the file was cut off during a flush.
    let rows = columns.iter().map(Vec::len).min().unwrap_or(0);
    let row = |i: usize| PathRow {
        x0: columns[0][i],
        t0: columns[1][i],
        x1: columns[2][i],
        t1: columns[3][i],
        stress_jump: columns[4][i],
        speed: columns[5][i],
    };
    Ok((0..rows).map(row).collect())
}

/// Table of an open file, and the rows that have not been written yet.
#[derive(Debug)]
pub(super) struct PathTable {
    group: Group,
    columns: Vec<Dataset>,
    numbers: Dataset,
    waiting: Vec<PathRow>,
    written: usize,
    /// Compressor, if the rows are compressed here and not by the library.
    chunks: Option<Chunks>,
    /// Rows are written in multiples of this number before the end of the run.
    multiple: usize,
}

impl PathTable {
    pub fn open(file: &File, compression: Compression) -> Hdf<Self> {
        let group = file.group("paths")?;
        let columns = COLUMNS.iter().map(|column| group.dataset(column.0)).collect::<Hdf<Vec<_>>>()?;
        let multiple = if compression == Compression::None { 1 } else { CHUNK };
        let chunks = (compression == Compression::Deflate).then(Chunks::new);
        Ok(Self { numbers: group.dataset(NUMBER)?, group, columns, waiting: Vec::new(), written: 0, chunks, multiple })
    }

    /// Truncates the table to its first `rows` rows, and restores the rows that were waiting at this state.
    pub fn cut(&mut self, rows: usize, waiting: &[PathRow]) -> Hdf<()> {
        self.columns.iter().chain([&self.numbers]).try_for_each(|column| cut(column, rows))?;
        self.waiting = waiting.to_vec();
        self.written = rows;
        Ok(())
    }

    /// Returns the number of rows in the file.
    pub fn written(&self) -> usize {
        self.written
    }

    /// Returns the rows that have not been written yet.
    pub fn waiting(&self) -> Vec<PathRow> {
        self.waiting.clone()
    }

    /// Adds rows to the waiting ones; returns true if it is time to write them.
    pub fn push(&mut self, rows: &[PathRow]) -> bool {
        self.waiting.extend_from_slice(rows);
        self.waiting.len() >= BLOCK
    }

    /// Returns an upper bound of the size of the waiting rows in the file, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<i64>() * (COLUMNS.len() + 1) * (self.waiting.len() + self.waiting.len() / 8).next_multiple_of(CHUNK)
    }

    /// Writes the complete blocks of the waiting rows while the run continues; returns true if something was written.
    pub fn write(&mut self) -> Hdf<bool> {
        self.write_rows(self.waiting.len() - self.waiting.len() % self.multiple)
    }

    /// Writes the first `rows` waiting rows, then their numbers; returns true if something was written.
    fn write_rows(&mut self, rows: usize) -> Hdf<bool> {
        if rows == 0 {
            return Ok(false);
        }
        let (start, end) = (self.written, self.written + rows);
        for (column, (.., value)) in self.columns.iter().zip(COLUMNS) {
            let values: Vec<f64> = self.waiting[..rows].iter().map(value).collect();
            match &mut self.chunks {
                Some(chunks) => {
                    column.resize(end)?;
                    chunks.write_numbers(column, start, CHUNK, &values)?;
                }
                None => append(column, start, &values)?,
            }
        }
        self.numbers.resize(end)?;
        let numbers: Vec<i64> = (0_i64..).skip(start).take(rows).collect();
        self.numbers.write_slice(&numbers, s![start..end])?;
        self.waiting.drain(..rows);
        self.written = end;
        Ok(true)
    }

    /// Writes the remaining rows; `complete` is true if every front is in the table.
    pub fn finish(&mut self, complete: bool) -> Hdf<()> {
        self.write_rows(self.waiting.len())?;
        self.group.attr("complete")?.write_scalar(&u8::from(complete))
    }
}
