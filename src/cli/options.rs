//! Arguments of the library as options of the command line.

use std::path::Path;

use crate::error::{Error, InputError, Result};
use crate::report::plot::Format;
use crate::scene::CHANGES;

/// An argument of the library: its name there, the option (empty: none), and what the help says of it (empty: nothing).
pub(super) type OptionOf<'a> = (&'a str, &'a str, &'a str);

/// An error that names an argument of the library names its option, and what that adds to the help.
pub(super) fn name(error: Error, options: &[OptionOf<'_>]) -> Error {
    let Error::Input(error) = error else { return error };
    let Some((_, option, of_option)) = options.iter().find(|(argument, ..)| *argument == error.key) else {
        return error.into();
    };
    let help = [error.help.as_str(), of_option].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>();
    InputError { key: (*option).to_owned(), help: help.join("; "), ..error }.into()
}

/// Words of the library in the help of an error, and those of the command line.
const WORDS: [(&str, &str); 1] = [("`material::library::names`", "`barwave materials`")];

/// An error of the library in the words of the command line.
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

/// The option of changes of keys.
const SET: &str = "--set";

/// The format of the picture that an option names.
pub(super) fn picture(path: &Path, option: &str) -> Result<Format> {
    Format::of(path).map_err(|error| name(error, &[("path", option, &format!("e.g. {option} figure.svg"))]))
}
