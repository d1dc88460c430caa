//! A result that is some figures and no histories: complete from the start.

use std::path::Path;

use hdf5::File;

use super::attributes::{put, text};
use super::claim::in_place;
use super::create::{build_materials, build_root, describe};

use super::{Header, MaterialRecord};
use crate::error::Result;

type Hdf<T> = hdf5::Result<T>;

/// A number of such a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// Name of the dataset.
    pub name: &'static str,
    /// Its unit.
    pub units: &'static str,
    /// What it is.
    pub long_name: &'static str,
    /// Its value.
    pub value: f64,
}

/// Writes a result file with the root attributes of every one, a material if there is one, and scalar datasets in a group.
///
/// # Errors
/// [`crate::error::Error::File`] where the file cannot be made or replaced; an older file is then untouched.
pub fn write_figures(
    path: &Path,
    header: &Header,
    materials: &[MaterialRecord],
    (group, figures): (&str, &[Figure]),
    (outcome, wall_seconds): (&str, f64),
) -> Result<()> {
    in_place(path, |temporary| -> Hdf<()> {
        let file = File::create(temporary)?;
        build_root(&file, header, true)?;
        build_materials(&file, materials, false)?;
        let group = file.create_group(group)?;
        for figure in figures {
            let dataset = group.new_dataset::<f64>().create(figure.name)?;
            dataset.write_scalar(&figure.value)?;
            describe(&dataset, figure.units, figure.long_name)?;
        }
        put(&file, "wall_seconds", &wall_seconds)?;
        put(&file, "cell_steps", &0_u64)?;
        file.attr("outcome")?.write_scalar(&text(outcome)?)?;
        file.close()
    })
    .map(|_| ())
}
