//! Two result files held against each other, bit by bit.

use std::path::Path;

use barwave::record::store::ResultFile;
use hdf5::types::{FloatSize, TypeDescriptor, VarLenUnicode};
use hdf5::{Container, File, Group};

/// What two runs of one scene need not have in common: times, and links between datasets.
const OF_THE_RUN: [&str; 6] =
    ["created", "run_id", "wall_seconds", "step_wall_seconds", "DIMENSION_LIST", "REFERENCE_LIST"];

/// Everything in a file: a line for each attribute and dataset, numbers as their bits.
pub fn everything(path: &Path) -> Vec<String> {
    // Without a lock, which a child that another test forks would keep.
    let file = File::with_options().with_fapl(|access| access.file_locking(false)).open(path);
    let file = file.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = Vec::new();
    collect(&file, &mut lines);
    // The order of links in a group is no content.
    lines.sort();
    // A table of numbers and texts has no reader of its own here.
    let result = ResultFile::open(path).expect("a result");
    lines.extend(result.fronts().expect("fronts").iter().map(|front| format!("{front:?}")));
    if file.link_exists("paths") {
        lines.extend(result.paths().expect("paths").iter().map(|path| format!("{path:?}")));
    }
    lines
}

fn collect(group: &Group, lines: &mut Vec<String>) {
    attributes(group, lines);
    for name in group.member_names().expect("members") {
        if let Ok(inner) = group.group(&name) {
            collect(&inner, lines);
        } else {
            let dataset = group.dataset(&name).expect("a dataset");
            attributes(&dataset, lines);
            lines.push(format!("{} {:?} {}", dataset.name(), dataset.shape(), bits(&dataset)));
        }
    }
}

fn attributes(of: &hdf5::Location, lines: &mut Vec<String>) {
    for name in of.attr_names().expect("attributes").iter().filter(|name| !OF_THE_RUN.contains(&name.as_str())) {
        lines.push(format!("{} @{name} {}", of.name(), bits(&of.attr(name).expect("an attribute"))));
    }
}

fn bits(values: &Container) -> String {
    let descriptor = values.dtype().and_then(|dtype| dtype.to_descriptor()).expect("a type");
    match descriptor {
        TypeDescriptor::Float(FloatSize::U8) => {
            let all = values.read_raw::<f64>().expect("numbers");
            format!("{:x?}", all.iter().map(|number| number.to_bits()).collect::<Vec<_>>())
        }
        TypeDescriptor::Float(_) => {
            let all = values.read_raw::<f32>().expect("numbers");
            format!("{:x?}", all.iter().map(|number| number.to_bits()).collect::<Vec<_>>())
        }
        TypeDescriptor::Integer(_) => format!("{:?}", values.read_raw::<i64>().expect("integers")),
        TypeDescriptor::Unsigned(_) => format!("{:?}", values.read_raw::<u64>().expect("integers")),
        TypeDescriptor::VarLenUnicode => format!("{:?}", values.read_raw::<VarLenUnicode>().expect("texts")),
        TypeDescriptor::Compound(_) => String::new(),
        other => format!("{other:?}"),
    }
}

/// Fails at the first difference.
pub fn assert_same(a: &Path, b: &Path, what: &str) {
    let (a, b) = (everything(a), everything(b));
    let start = |line: &str| line.chars().take(200).collect::<String>();
    for (a, b) in a.iter().zip(&b) {
        assert!(a == b, "{what}:\n{}\n{}", start(a), start(b));
    }
    assert_eq!(a.len(), b.len(), "{what}");
}
