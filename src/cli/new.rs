//! `barwave new`.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::output;
use crate::error::{Error, InputError, Result};

/// Options of `barwave new`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Name of the scene; writes NAME.toml. A file that exists is never overwritten.
    name: PathBuf,
}

/// The scene that is written, with a mark where the title goes.
const TEMPLATE: &str = include_str!("new_scene.toml");

pub(crate) fn run(args: &Args) -> Result<()> {
    let path = target(&args.name)?;
    write_new(&path, &text(&path))?;
    output::text(&format!("wrote {0}; try `barwave check {0}`\n", path.display()))
}

/// NAME.toml for NAME and NAME.toml.
fn target(name: &Path) -> Result<PathBuf> {
    let Some(last) = name.file_name() else {
        let error = InputError::new(format!("`{}` names no file", name.display()));
        return Err(error.help("give a name, e.g. barwave new copper-bar").into());
    };
    if name.extension().is_some_and(|e| e == "toml") {
        return Ok(name.to_owned());
    }
    let mut with_extension = last.to_owned();
    with_extension.push(".toml");
    Ok(name.with_file_name(with_extension))
}

fn text(path: &Path) -> String {
    let stem = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let title = toml::Value::String(stem).to_string();
    TEMPLATE.replace("\"TITLE\"", &title)
}

/// Writes a file that must not exist, whole or not at all.
fn write_new(path: &Path, text: &str) -> Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).map_err(|e| match e.kind() {
        ErrorKind::AlreadyExists => InputError::new(format!("`{}` exists already", path.display()))
            .help("choose another name, or delete the file first")
            .into(),
        ErrorKind::NotFound => {
            InputError::new(format!("there is no folder for `{}`", path.display())).help("make the folder first").into()
        }
        _ => Error::file(path, e),
    })?;
    file.write_all(text.as_bytes()).map_err(|e| {
        // Nothing half-written stays under the name; that it cannot be deleted either adds nothing.
        let _ = std::fs::remove_file(path);
        Error::file(path, e)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn the_template_is_a_right_scene() {
        let text = text(Path::new("my \"first\" bar.toml"));
        let scene = Scene::parse("my \"first\" bar.toml", &text, Path::new(""), &[]).expect("the template is right");
        assert_eq!(scene.title, "my \"first\" bar");
    }

    #[test]
    fn names_get_their_extension_once() {
        let target = |name: &str| target(Path::new(name)).expect("has a name").display().to_string();
        assert_eq!(target("a"), "a.toml");
        assert_eq!(target("d/a.toml"), "d/a.toml");
        assert_eq!(target("v1.5"), "v1.5.toml");
        assert!(super::target(Path::new("..")).is_err());
    }
}
