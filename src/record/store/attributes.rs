//! Attributes of groups and datasets: numbers and texts.

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, H5Type, Location};

use super::{FORMAT_VERSION, bounded, git_revision};

type Hdf<T> = hdf5::Result<T>;

/// Conventions for attributes and coordinates that the files follow.
const CONVENTIONS: &str = "CF-1.11";

pub(super) fn put<T: H5Type>(location: &Location, name: &str, value: &T) -> Hdf<()> {
    location.new_attr::<T>().create(name)?.write_scalar(value)
}

/// Writes a number, and its unit in a second attribute.
pub(super) fn put_quantity(location: &Location, name: &str, value: f64, units: &str) -> Hdf<()> {
    put(location, name, &value)?;
    put_text(location, &format!("{name}_units"), units)
}

/// Writes the unit and the description of a dataset.
pub(super) fn describe(dataset: &Dataset, units: &str, long_name: &str) -> Hdf<()> {
    put_text(dataset, "units", units)?;
    put_text(dataset, "long_name", long_name)
}

pub(super) fn put_text(location: &Location, name: &str, value: &str) -> Hdf<()> {
    put(location, name, &text(value)?)
}

pub(super) fn put_texts(location: &Location, name: &str, values: &[String]) -> Hdf<()> {
    let values = values.iter().map(|value| text(value)).collect::<Hdf<Vec<_>>>()?;
    let attribute = location.new_attr::<VarLenUnicode>().shape(values.len()).create(name)?;
    if values.is_empty() { Ok(()) } else { attribute.write_raw(&values) }
}

/// Converts a text. HDF5 texts end at a zero byte, which text files do not contain; a text that contains one is
/// truncated there instead of being refused.
pub(super) fn text(value: &str) -> Hdf<VarLenUnicode> {
    let until_zero = value.split('\0').next().unwrap_or_default();
    until_zero.parse().map_err(|e: hdf5::types::StringError| e.to_string().into())
}

/// Value of the root attribute `format` of result files.
pub(super) const FORMAT: &str = "barwave";

/// Writes the attributes with which every file of the program starts: its kind, the program that wrote it, and its title.
pub(super) fn identify(file: &Location, format: &str, title: &str) -> Hdf<()> {
    put_text(file, "format", format)?;
    put(file, "format_version", &FORMAT_VERSION)?;
    put_text(file, "Conventions", CONVENTIONS)?;
    put_text(file, "program_version", env!("CARGO_PKG_VERSION"))?;
    if let Some(revision) = git_revision() {
        put_text(file, "git_revision", revision)?;
    }
    put_text(file, "title", title)
}

pub(super) fn get<T: H5Type>(location: &Location, name: &str) -> Hdf<T> {
    location.attr(name)?.read_scalar()
}

pub(super) fn get_text(location: &Location, name: &str) -> Hdf<String> {
    Ok(get::<VarLenUnicode>(location, name)?.to_string())
}

pub(super) fn get_texts(location: &Location, name: &str) -> Hdf<Vec<String>> {
    let attribute = location.attr(name)?;
    if attribute.size() == 0 {
        return Ok(Vec::new());
    }
    bounded::attribute_fits(&attribute, location.file()?.size())?;
    Ok(attribute.read_raw::<VarLenUnicode>()?.iter().map(ToString::to_string).collect())
}
