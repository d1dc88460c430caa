//! HDF5 dimension scales, written attribute by attribute (the library's own functions are in its high-level part, which
//! is not linked). The layout is that of the HDF5 dimension scale specification: `CLASS` and `NAME` on the scale,
//! `DIMENSION_LIST` on the data, `REFERENCE_LIST` back on the scale.
#![allow(unsafe_code)]

use std::ffi::CString;

use hdf5::types::VarLenArray;
use hdf5::{Group, Location, ObjectReference1, Result};
use hdf5_sys::h5a::{H5Aclose, H5Acreate2, H5Awrite};
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::{H5S_class_t, H5Sclose, H5Screate};
use hdf5_sys::h5t::{H5Tclose, H5Tcopy, H5Tset_size};

/// Entry of `REFERENCE_LIST`: a dataset, and the index of its dimension that the scale labels.
#[derive(hdf5::H5Type, Clone, Copy)]
#[repr(C)]
struct BackReference {
    dataset: ObjectReference1,
    dimension: i32,
}

/// Dimension of a group, given by the name of its scale.
#[derive(Debug, Clone, Copy)]
pub(super) enum Axis<'a> {
    /// Scale whose values are the coordinates of its dimension.
    Coordinate(&'a str),
    /// Scale without values: netCDF reads it as a dimension without a coordinate.
    Bare(&'a str),
}

impl<'a> Axis<'a> {
    fn name(self) -> &'a str {
        match self {
            Self::Coordinate(name) | Self::Bare(name) => name,
        }
    }
}

/// Attaches the datasets `scales` of a group to the dimensions of the datasets `data`, the first scale to the first
/// dimension. Each dataset has as many dimensions as there are scales.
pub(super) fn attach(group: &Group, scales: &[&str], data: &[&str]) -> Result<()> {
    let data: Vec<(&str, usize)> = data.iter().map(|name| (*name, scales.len())).collect();
    attach_first(group, scales, &data)
}

/// Attaches the scales to datasets with fewer dimensions: each dataset is given with the number of its dimensions,
/// which are labelled by the first scales.
pub(super) fn attach_first(group: &Group, scales: &[&str], data: &[(&str, usize)]) -> Result<()> {
    let axes: Vec<Axis> = scales.iter().map(|name| Axis::Coordinate(name)).collect();
    let data: Vec<(&str, &[&str])> = data.iter().map(|(name, dimensions)| (*name, &scales[..*dimensions])).collect();
    attach_axes(group, &axes, &data)
}

/// Turns `axes` into scales and attaches them to the dimensions of datasets, each given with its list of scales. To be
/// called once for a group, because every scale gets its complete list.
pub(super) fn attach_axes(group: &Group, axes: &[Axis<'_>], data: &[(&str, &[&str])]) -> Result<()> {
    for axis in axes {
        let dataset = group.dataset(axis.name())?;
        match axis {
            Axis::Coordinate(name) => identify(&dataset, name)?,
            Axis::Bare(_) => {
                identify(
                    &dataset,
                    &format!("This is a netCDF dimension but not a netCDF variable.{:10}", dataset.size()),
                )?;
            }
        }
    }
    data.iter().try_for_each(|(name, scales)| label(group, name, scales))?;
    axes.iter().try_for_each(|axis| refer_back(group, axis.name(), data))
}

fn identify(scale: &Location, name: &str) -> Result<()> {
    null_terminated_attribute(scale, "CLASS", "DIMENSION_SCALE")?;
    null_terminated_attribute(scale, "NAME", name)
}

fn label(group: &Group, name: &str, scales: &[&str]) -> Result<()> {
    let mut lists = Vec::with_capacity(scales.len());
    for scale in scales {
        lists.push(VarLenArray::from_slice(&[group.reference::<ObjectReference1>(scale)?]));
    }
    let dataset = group.dataset(name)?;
    let attribute = dataset.new_attr::<VarLenArray<ObjectReference1>>().shape(lists.len()).create("DIMENSION_LIST")?;
    attribute.write_raw(&lists)
}

fn refer_back(group: &Group, scale: &str, data: &[(&str, &[&str])]) -> Result<()> {
    let mut list = Vec::with_capacity(data.len());
    for (name, scales) in data {
        for (dimension, _) in (0_i32..).zip(*scales).filter(|(_, other)| **other == scale) {
            list.push(BackReference { dataset: group.reference(name)?, dimension });
        }
    }
    if list.is_empty() {
        return Ok(());
    }
    let dataset = group.dataset(scale)?;
    dataset.new_attr::<BackReference>().shape(list.len()).create("REFERENCE_LIST")?.write_raw(&list)
}

/// Writes a fixed-length text attribute terminated by a zero byte. Readers recognize a scale only by a `CLASS` of this
/// form; the fixed-length texts of the safe interface are padded instead.
fn null_terminated_attribute(location: &Location, name: &str, value: &str) -> Result<()> {
    let to_c = |s: &str| CString::new(s).map_err(|e| hdf5::Error::from(e.to_string()));
    let (name, value) = (to_c(name)?, to_c(value)?);
    let size = value.as_bytes_with_nul().len();
    // SAFETY: every id is created, checked and closed here; `value` has `size` bytes, which is the size of the type.
    let written = hdf5::sync::sync(|| unsafe {
        let text = H5Tcopy(*hdf5::globals::H5T_C_S1);
        let space = H5Screate(H5S_class_t::H5S_SCALAR);
        let sized = H5Tset_size(text, size);
        let attribute = H5Acreate2(location.id(), name.as_ptr(), text, space, H5P_DEFAULT, H5P_DEFAULT);
        let written = if sized < 0 || attribute < 0 { -1 } else { H5Awrite(attribute, text, value.as_ptr().cast()) };
        if attribute >= 0 {
            H5Aclose(attribute);
        }
        H5Sclose(space);
        H5Tclose(text);
        written
    });
    hdf5::h5check(written).map(|_| ())
}
