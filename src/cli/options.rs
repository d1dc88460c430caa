//! Arguments of the library as options of the command line.

use std::path::Path;

use crate::error::{Error, InputError, Result};
use crate::report::plot::Format;

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

/// The format of the picture that an option names.
pub(super) fn picture(path: &Path, option: &str) -> Result<Format> {
    Format::of(path).map_err(|error| name(error, &[("path", option, &format!("e.g. {option} figure.svg"))]))
}
