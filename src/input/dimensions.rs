//! Which dimension the numbers of a text are read with: that of a key may depend on others, such as the `kind` beside it.

use std::cell::RefCell;
use std::ops::Range;

use super::Document;
use crate::units::Dimension;

/// A number that was read.
#[derive(Debug, Clone, PartialEq)]
struct ReadNumber {
    file: String,
    span: Range<usize>,
    dimension: Dimension,
}

thread_local! {
    // Numbers are read deep inside the checks of a scene; a parameter would go through all of them.
    static READ: RefCell<Option<Vec<ReadNumber>>> = const { RefCell::new(None) };
}

/// Stops the recording when it is dropped.
struct Scope;

impl Drop for Scope {
    fn drop(&mut self) {
        READ.take();
    }
}

/// Notes a number of a document, where someone asked for it.
pub(super) fn note(document: &Document, span: &Range<usize>, dimension: Dimension) {
    READ.with_borrow_mut(|read| {
        if let Some(read) = read {
            read.push(ReadNumber { file: document.file.clone(), span: span.clone(), dimension });
        }
    });
}

/// Dimensions with which `read` reads the numbers of these dotted keys of a document; none of a key that it does not read as a number.
pub fn of_keys<T>(document: &Document, keys: &[&str], read: impl FnOnce() -> T) -> Vec<Option<Dimension>> {
    let scope = Scope;
    READ.set(Some(Vec::new()));
    read();
    let numbers = READ.take().unwrap_or_default();
    drop(scope);
    let of = |key: &&str| {
        let span = document.span_of(key)?;
        numbers.iter().rfind(|number| number.file == document.file && number.span == span).map(|n| n.dimension)
    };
    keys.iter().map(of).collect()
}
