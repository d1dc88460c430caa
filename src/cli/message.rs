//! Error messages on stderr: what is wrong, where with the line of the file, the allowed range, and help.

use std::path::Path;

use serde::Serialize;

use super::{options, output, settings};
use crate::error::Error;
use crate::error::text::{Paint, column, lines};

/// Writes an error to stderr, with `--json` as an object.
pub(super) fn show(error: &Error) {
    if settings::json() {
        return output::json_note(&Failure { error: error.into() });
    }
    output::note(&render(error, Paint(settings::colors())));
}

/// Writes an error in one of several files to stderr, with the name of the file.
pub(super) fn show_of(error: &Error, file: &Path) {
    if settings::json() {
        let error = Details { input: Some(file.display().to_string()), ..error.into() };
        return output::json_note(&Failure { error });
    }
    output::note(&format!("{}: ", file.display()));
    show(error);
}

/// Writes a usage error to stderr as an object.
pub(super) fn show_usage(error: &clap::Error) {
    let text = error.render().to_string();
    // Only the first paragraph; its lines list the missing arguments.
    let lines = text.lines().take_while(|line| !line.trim().is_empty()).map(str::trim);
    let message = lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned();
    let code = u8::try_from(error.exit_code()).unwrap_or(1);
    let tip = text.lines().find_map(|line| line.trim().strip_prefix("tip: ").map(str::to_owned));
    let help = "`barwave --help` lists the commands, `barwave COMMAND --help` their options";
    let help = Some(tip.unwrap_or_else(|| help.to_owned()));
    output::json_note(&Failure { error: Details { message, help, ..Details::of_kind("usage", code) } });
}

/// JSON object of an error.
#[derive(Debug, Serialize)]
struct Failure {
    error: Details,
}

/// Properties of an error.
#[derive(Debug, Default, Serialize)]
struct Details {
    kind: &'static str,
    exit_code: u8,
    message: String,
    /// File that was being processed, if there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    input: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    key: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    column: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    allowed: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    x_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
    /// Files that are left behind, and how to continue.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

impl Details {
    fn of_kind(kind: &'static str, exit_code: u8) -> Self {
        Self { kind, exit_code, notes: output::take_remarks(), ..Self::default() }
    }
}

impl From<&Error> for Details {
    fn from(error: &Error) -> Self {
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        let kind = |kind| Self { message: error.to_string(), ..Self::of_kind(kind, error.exit_code()) };
        match error {
            Error::Input(input) => {
                let input = options::worded(input);
                Self {
                    message: input.message.clone(),
                    key: some(&input.key),
                    file: input.place.as_ref().map(|place| place.file.clone()),
                    line: input.place.as_ref().map(|place| place.line()),
                    column: input.place.as_ref().map(|place| column(place) + 1),
                    allowed: some(&input.allowed),
                    help: some(&input.help),
                    ..kind("input")
                }
            }
            Error::Run(run) => Self {
                message: run.reason.clone(),
                time_s: Some(run.time),
                x_m: run.x,
                help: some(&run.help),
                ..kind("run")
            },
            Error::File { path, reason, help } => Self {
                message: reason.clone(),
                file: Some(path.display().to_string()),
                help: some(help),
                ..kind("file")
            },
            Error::Checks(_) => kind("checks"),
            Error::Interrupted => kind("interrupted"),
        }
    }
}

fn render(error: &Error, paint: Paint) -> String {
    let of = |error: &Error| format!("{}: {}", paint.red("error"), lines(error, paint));
    match error {
        // Not an error: the interrupted command has already stated what it leaves behind.
        Error::Interrupted => String::new(),
        Error::Input(input) => of(&options::worded(input).into()),
        _ => of(error),
    }
}
