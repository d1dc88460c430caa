//! `barwave new`.

use std::path::{Path, PathBuf};

use super::{output, settings};
use crate::destination;
use crate::error::{Error, InputError, Result};

/// Options of `barwave new`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave new my-bar\n  barwave new taylor/cylinder --kind taylor\n  barwave new - --kind \
                  hopkinson > hopkinson.toml"
)]
pub(crate) struct Args {
    /// Name of the scene; writes NAME.toml, and its folder if it is missing. A file that exists is never overwritten; `-` is standard
    /// output.
    name: PathBuf,
    /// What to start from.
    #[arg(short, long, value_enum, default_value = "bar")]
    kind: Kind,
}

/// Declares the kinds of templates: the file of each, and the command that runs it.
macro_rules! kinds {
    ($($(#[doc = $doc:literal])* $name:ident: $file:literal, $command:literal;)*) => {
        /// Template to start from.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
        enum Kind {
            $($(#[doc = $doc])* $name,)*
        }

        impl Kind {
            /// Returns the text of the template, with placeholders such as that of the title.
            fn template(self) -> &'static str {
                match self { $(Self::$name => include_str!(concat!("templates/", $file)),)* }
            }

            /// Returns the command that runs the file.
            fn command(self) -> &'static str {
                match self { $(Self::$name => $command,)* }
            }
        }
    };
}

kinds! {
    /// A bar that is pulled, with every key explained.
    Bar: "bar.toml", "run";
    /// A specimen that is pulled until it breaks.
    TensionImpact: "tension-impact.toml", "run";
    /// A cylinder that strikes a wall.
    Taylor: "taylor.toml", "run";
    /// A split-Hopkinson set: striker, incident bar, specimen, transmission bar.
    Hopkinson: "hopkinson.toml", "run";
    /// A mass that falls on a column.
    DropWeight: "drop-weight.toml", "run";
    /// A pulse that breaks a scab off the free end.
    Spall: "spall.toml", "run";
    /// A striker and a specimen by the energy method, without waves.
    EnergyMethod: "energy-method.toml", "run";
    /// Two spheres that collide.
    Spheres: "spheres.toml", "run";
    /// A sphere that strikes a plate.
    Plate: "plate.toml", "run";
    /// A sphere that strikes a simply supported beam.
    Beam: "beam.toml", "run";
    /// A sweep, and NAME-scene.toml, the scene that it varies.
    Sweep: "sweep.toml", "sweep";
}

pub(crate) fn run(args: &Args) -> Result<()> {
    if destination::is_stdout(&args.name) {
        output::check(settings::json(), [Some(args.name.as_path())])?;
        return output::text(&text(Path::new("scene.toml"), args.kind));
    }
    let path = target(&args.name)?;
    destination::make_folder(&path)?;
    let mut wrote = vec![path.clone()];
    if args.kind == Kind::Sweep {
        let scene = path.with_file_name(scene_name(&path));
        if path.exists() {
            return Err(exists(&path));
        }
        destination::write_new(&scene, text(&scene, Kind::Bar).as_bytes(), || exists(&scene))?;
        wrote.push(scene);
    }
    destination::write_new(&path, text(&path, args.kind).as_bytes(), || exists(&path))?;
    let command = args.kind.command();
    let names: Vec<String> = wrote.iter().map(|path| path.display().to_string()).collect();
    let said = format!(
        "wrote {}; try `barwave check {1}`, then `barwave {command} {1}`\n",
        names.join(" and "),
        output::shell_word(&path)
    );
    output::written(&wrote.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &said)
}

/// Returns the file name of the scene of a sweep.
fn scene_name(sweep: &Path) -> String {
    format!("{}-scene.toml", stem(sweep))
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// Returns NAME.toml for NAME and for NAME.toml.
fn target(name: &Path) -> Result<PathBuf> {
    let Some(last) = name.file_name() else {
        let error = InputError::new(format!("`{}` is not a file name", name.display()));
        return Err(error.help("give a name, e.g. barwave new copper-bar").into());
    };
    if name.extension().is_some_and(|e| e == "toml") {
        return Ok(name.to_owned());
    }
    let mut with_extension = last.to_owned();
    with_extension.push(".toml");
    Ok(name.with_file_name(with_extension))
}

fn text(path: &Path, kind: Kind) -> String {
    let quoted = |text: String| toml::Value::String(text).to_string();
    let text = kind.template().replace("\"TITLE\"", &quoted(stem(path)));
    text.replace("\"SCENE\"", &quoted(scene_name(path))).replace("NAME.toml", &output::shell_word(path))
}

fn exists(path: &Path) -> Error {
    let error = InputError::new(format!("`{}` exists already", path.display()));
    error.help("choose another name, or delete the file first").into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Problem;

    #[test]
    fn templates_are_right_scenes() {
        use clap::ValueEnum;
        for &kind in Kind::value_variants().iter().filter(|kind| **kind != Kind::Sweep) {
            let text = text(Path::new("my \"first\" bar.toml"), kind);
            let read = Problem::parse("my \"first\" bar.toml", &text, Path::new(""), &[]);
            let title = match read.expect("the template is right") {
                Problem::Bar(scene) => scene.title.clone(),
                Problem::Impact(scene) => scene.title,
            };
            assert_eq!(title, "my \"first\" bar");
        }
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
