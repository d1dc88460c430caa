//! Compares two result files bit by bit.

use std::path::Path;

use barwave::record::store::ResultFile;
use hdf5::file::FileBuilder;
use hdf5::types::{FloatSize, TypeDescriptor, VarLenUnicode};
use hdf5::{Container, File, Group};

/// Attributes that may differ between two runs of one scene: times, and links between datasets.
const OF_THE_RUN: [&str; 6] =
    ["created", "run_id", "wall_seconds", "step_wall_seconds", "DIMENSION_LIST", "REFERENCE_LIST"];

/// Returns a builder that opens HDF5 files without a lock, since a child process forked by another test would keep it.
pub fn unlocked() -> FileBuilder {
    File::with_options().with_fapl(|access| access.file_locking(false)).clone()
}

/// Returns all attributes and datasets of a file by name, numbers as their bits.
fn everything(path: &Path) -> Vec<(String, Vec<u8>)> {
    let file = unlocked().open(path);
    let file = file.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut all = Vec::new();
    collect(&file, &mut all);
    // The order of links in a group is not part of the content.
    all.sort();
    // The table of fronts, of numbers and texts, is read by the library.
    let result = ResultFile::open(path).expect("a result");
    let fronts = result.fronts().expect("fronts");
    all.extend(fronts.iter().map(|front| ("front".to_owned(), format!("{front:?}").into_bytes())));
    all
}

fn collect(group: &Group, all: &mut Vec<(String, Vec<u8>)>) {
    attributes(group, all);
    for name in group.member_names().expect("members") {
        if let Ok(inner) = group.group(&name) {
            collect(&inner, all);
        } else {
            let dataset = group.dataset(&name).expect("a dataset");
            attributes(&dataset, all);
            all.push((format!("{} {:?}", dataset.name(), dataset.shape()), bits(&dataset)));
        }
    }
}

fn attributes(of: &hdf5::Location, all: &mut Vec<(String, Vec<u8>)>) {
    for name in of.attr_names().expect("attributes").iter().filter(|name| !OF_THE_RUN.contains(&name.as_str())) {
        all.push((format!("{} @{name}", of.name()), bits(&of.attr(name).expect("an attribute"))));
    }
}

fn bits(values: &Container) -> Vec<u8> {
    let descriptor = values.dtype().and_then(|dtype| dtype.to_descriptor()).expect("a type");
    match descriptor {
        TypeDescriptor::Float(FloatSize::U8) => {
            values.read_raw::<f64>().expect("numbers").iter().flat_map(|number| number.to_be_bytes()).collect()
        }
        TypeDescriptor::Float(_) => {
            values.read_raw::<f32>().expect("numbers").iter().flat_map(|number| number.to_be_bytes()).collect()
        }
        TypeDescriptor::Integer(_) => format!("{:?}", values.read_raw::<i64>().expect("integers")).into_bytes(),
        TypeDescriptor::Unsigned(_) => format!("{:?}", values.read_raw::<u64>().expect("integers")).into_bytes(),
        TypeDescriptor::VarLenUnicode => {
            format!("{:?}", values.read_raw::<VarLenUnicode>().expect("texts")).into_bytes()
        }
        TypeDescriptor::Compound(_) => Vec::new(),
        other => format!("{other:?}").into_bytes(),
    }
}

/// Fails at the first difference between two files.
pub fn assert_same(a: &Path, b: &Path, what: &str) {
    let (a, b) = (everything(a), everything(b));
    for ((name, a), (other, b)) in a.iter().zip(&b) {
        assert_eq!(name, other, "{what}");
        let differs = || a.iter().zip(b).position(|(a, b)| a != b);
        assert!(a == b, "{what}: {name}: {} and {} bytes, first difference at {:?}", a.len(), b.len(), differs());
    }
    assert_eq!(a.len(), b.len(), "{what}");
}
