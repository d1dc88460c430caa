//! The result file: the only file that names the hdf5 crate.
