//! The filters of datasets.

use hdf5::DatasetBuilderEmpty;

use crate::record::Compression;

/// Compressed with the bytes of numbers sorted by their weight: for rows of numbers that are close to one another.
pub(super) fn shuffled(builder: DatasetBuilderEmpty, compression: Compression) -> DatasetBuilderEmpty {
    match compression {
        Compression::None => builder,
        _ => compressed(builder.shuffle(), compression),
    }
}

/// Compressed as it is: for numbers that come again as they were.
pub(super) fn compressed(builder: DatasetBuilderEmpty, compression: Compression) -> DatasetBuilderEmpty {
    match compression {
        Compression::Deflate => builder.deflate(1),
        Compression::Lzf => builder.lzf(),
        Compression::None => builder,
    }
}
