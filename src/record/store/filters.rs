//! Filters of datasets.

use hdf5::DatasetBuilderEmpty;

use crate::record::Compression;

/// Adds the shuffle filter and compression, for rows of similar numbers: it sorts the bytes of the numbers by significance.
pub(super) fn shuffled(builder: DatasetBuilderEmpty, compression: Compression) -> DatasetBuilderEmpty {
    match compression {
        Compression::None => builder,
        _ => compressed(builder.shuffle(), compression),
    }
}

/// Adds compression without the shuffle filter, for numbers that recur exactly.
pub(super) fn compressed(builder: DatasetBuilderEmpty, compression: Compression) -> DatasetBuilderEmpty {
    match compression {
        Compression::Deflate => builder.deflate(1),
        Compression::Lzf => builder.lzf(),
        Compression::None => builder,
    }
}
