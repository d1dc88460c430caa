//! Rows of a field and columns of a table, compressed here and written directly. The result is identical to that of the
//! library's own shuffle and deflate filters, which initialize the compression for every chunk and take nearly twice as
//! long.
#![allow(unsafe_code)]

use hdf5::Dataset;
use hdf5_sys::h5d::H5Dwrite_chunk;
use hdf5_sys::h5p::H5P_DEFAULT;
use libdeflater::{CompressionLvl, Compressor};

use crate::record::Precision;

/// Level of compression. Beyond what the shuffled bytes have in common, fields are nearly incompressible, so that the lowest level suffices.
const LEVEL: i32 = 1;

/// Compressor of chunks.
pub(super) struct Chunks {
    compressor: Compressor,
    bytes: Vec<u8>,
    compressed: Vec<u8>,
}

impl std::fmt::Debug for Chunks {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Chunks")
    }
}

impl Chunks {
    pub fn new() -> Self {
        let level = CompressionLvl::new(LEVEL).unwrap_or_default();
        Self { compressor: Compressor::new(level), bytes: Vec::new(), compressed: Vec::new() }
    }

    /// Writes row `row` of a dataset whose chunks are 1 by `columns` and whose filters are shuffle and deflate. The
    /// dataset must already have the row, empty.
    pub fn write_row(
        &mut self,
        dataset: &Dataset,
        row: usize,
        columns: usize,
        values: &[f64],
        precision: Precision,
    ) -> hdf5::Result<()> {
        for (k, part) in values.chunks(columns).enumerate() {
            match precision {
                Precision::F64 => self.shuffle(part, columns, f64::to_ne_bytes),
                Precision::F32 => self.shuffle(part, columns, |value| (value as f32).to_ne_bytes()),
            }
            self.write(dataset, &[row as u64, (k * columns) as u64])?;
        }
        Ok(())
    }

    /// Writes numbers from row `start` onwards, a multiple of `length`, into a dataset whose chunks have `length` rows
    /// and whose filter is deflate. The dataset must already have the rows, empty.
    pub fn write_numbers(
        &mut self,
        dataset: &Dataset,
        start: usize,
        length: usize,
        values: &[f64],
    ) -> hdf5::Result<()> {
        for (k, part) in values.chunks(length).enumerate() {
            self.bytes.clear();
            self.bytes.extend(part.iter().flat_map(|value| value.to_ne_bytes()));
            self.bytes.resize(size_of::<f64>() * length, 0);
            self.write(dataset, &[(start + k * length) as u64])?;
        }
        Ok(())
    }

    /// Compresses the bytes of a chunk and writes them.
    fn write(&mut self, dataset: &Dataset, offset: &[u64]) -> hdf5::Result<()> {
        self.compressed.resize(self.compressor.zlib_compress_bound(self.bytes.len()), 0);
        let compressed = self.compressor.zlib_compress(&self.bytes, &mut self.compressed);
        let length = compressed.map_err(|e| e.to_string())?;
        write_chunk(dataset, offset, &self.compressed[..length])
    }

    /// Stores the first bytes of all `columns` numbers of a chunk, then all second bytes, and so on; a chunk at the right edge is padded with zeros.
    fn shuffle<const BYTES: usize>(&mut self, values: &[f64], columns: usize, bytes: impl Fn(f64) -> [u8; BYTES]) {
        self.bytes.clear();
        self.bytes.resize(BYTES * columns, 0);
        for (k, plane) in self.bytes.chunks_exact_mut(columns).enumerate() {
            for (byte, value) in plane.iter_mut().zip(values) {
                *byte = bytes(*value)[k];
            }
        }
    }
}

/// Writes a chunk in the form in which it is stored on the disk; `offset` has one number for each dimension of the dataset.
fn write_chunk(dataset: &Dataset, offset: &[u64], bytes: &[u8]) -> hdf5::Result<()> {
    if offset.len() != dataset.ndim() {
        return Err(format!("a chunk in {} dimensions for `{}`", offset.len(), dataset.name()).into());
    }
    hdf5::sync::sync(|| {
        // SAFETY: the dataset lives through the call and has as many dimensions as `offset`; the length is that of `bytes`.
        let status = unsafe {
            H5Dwrite_chunk(dataset.id(), H5P_DEFAULT, 0, offset.as_ptr(), bytes.len(), bytes.as_ptr().cast())
        };
        hdf5::h5check(status).map(|_| ())
    })
}
