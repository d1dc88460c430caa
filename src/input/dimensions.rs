//! Records the dimensions with which the numbers of a text are read: that of a key can depend on other keys, such as the `kind` of an end.

use std::cell::RefCell;
use std::ops::Range;

use super::Document;
use crate::units::Dimension;

/// Number that was read.
#[derive(Debug, Clone, PartialEq)]
struct ReadNumber {
    file: String,
    span: Range<usize>,
    dimension: Dimension,
}

thread_local! {
    // Thread-local, because numbers are read deep inside the checks of a scene; otherwise every check would need a parameter for the recording.
    static READ: RefCell<Option<Vec<ReadNumber>>> = const { RefCell::new(None) };
}

/// Guard that stops the recording when it is dropped.
struct Scope;

impl Drop for Scope {
    fn drop(&mut self) {
        READ.take();
    }
}

/// Records a number of a document, if a recording is active.
pub(super) fn note(document: &Document, span: &Range<usize>, dimension: Dimension) {
    READ.with_borrow_mut(|read| {
        if let Some(read) = read {
            read.push(ReadNumber { file: document.file.clone(), span: span.clone(), dimension });
        }
    });
}

/// Returns the dimensions with which `read` reads the numbers of these dotted keys of a document; `None` for a key that it does not read as a number.
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
