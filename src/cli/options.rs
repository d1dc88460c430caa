//! Translates errors of the library into the terms of the command line.

use std::path::Path;

use crate::error::{Error, InputError, Result};
use crate::report::plot::Format;
use crate::scene::CHANGES;

/// Library argument: its name, its option (or empty), and an addition to the help (or empty).
pub(super) type OptionOf<'a> = (&'a str, &'a str, &'a str);

/// Replaces the library argument that an error names by its option, and appends the addition to the help.
pub(super) fn name(error: Error, options: &[OptionOf<'_>]) -> Error {
    let Error::Input(error) = error else { return error };
    let Some((_, option, of_option)) = options.iter().find(|(argument, ..)| *argument == error.key) else {
        return error.into();
    };
    let help = [error.help.as_str(), of_option].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>();
    InputError { key: (*option).to_owned(), help: help.join("; "), ..error }.into()
}

/// Library terms in the help of errors, and their replacements on the command line.
const WORDS: [(&str, &str); 1] = [("`material::library::names`", "`barwave materials`")];

/// Returns an error of the library in the terms of the command line.
pub(super) fn worded(error: &InputError) -> InputError {
    let mut error = error.clone();
    for (library, here) in WORDS {
        error.help = error.help.replace(library, here);
    }
    if let Some(place) = error.place.as_mut().filter(|place| place.file == CHANGES) {
        SET.clone_into(&mut place.file);
    } else if error.key == CHANGES {
        let help = format!("write e.g. {SET} solve.cells=4000 or {SET} left.value=\"-40 m/s\"");
        return InputError { key: String::new(), message: format!("{SET} {}", error.message), help, ..error };
    }
    error
}

/// Option that changes keys of a scene.
const SET: &str = "--set";

/// Returns the format of a picture file given by `option`.
pub(super) fn picture(path: &Path, option: &str) -> Result<Format> {
    Format::of(path).map_err(|error| name(error, &[("path", option, &format!("e.g. {option} figure.svg"))]))
}
