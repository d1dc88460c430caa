//! What the fuzz targets call, and `tests/suite/fuzz_cases.rs` with the inputs that were found: any bytes end in a result or in an error with
//! a help line, never in a panic.

use std::fs;
use std::path::Path;

use barwave::error::{Error, Result};
use barwave::input::Document;
use barwave::material::{self, Sense};
use barwave::record::store::ResultFile;
use barwave::report::{Figure, Units, draw, page};
use barwave::scene::{Problem, Scene};
use barwave::wave::similarity;

/// A wrong input says what to do.
fn explained<T>(result: Result<T>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(Error::Input(error)) => {
            assert!(!error.message.is_empty() && !error.help.is_empty(), "no help: {error}");
            None
        }
        Err(_) => None,
    }
}

/// A scene file.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let document = Document::new("fuzz.toml", text);
    if let Some(Problem::Bar(scene)) = explained(Problem::of_document(&document, Path::new("fuzz.toml"), &[])) {
        let _ = (scene.notes(), scene.resolved_json());
    }
}

/// A material file.
pub fn material(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let document = Document::new("fuzz.toml", text);
    let Some(material) = explained(material::file::of_document(&document, Path::new("fuzz.toml"))) else { return };
    for sense in [Sense::Tension, Sense::Compression] {
        similarity::critical(material.branch(sense), material.density);
    }
}

const HISTORY: &str = "[bar]\nlength = 1\nmaterial = \"mild-steel\"\n[left]\nkind = \"velocity\"\ncsv = \"record.csv\"\n[right]\n\
                       kind = \"free\"\n[solve]\nuntil = 1e-5\ncells = 10\n";
const CURVE: &str = "[bar]\nlength = 1\nmaterial = { density = 7800, curve = { csv = \"record.csv\" } }\n[left]\n\
                     kind = \"fixed\"\n[right]\nkind = \"free\"\n[solve]\nuntil = 1e-5\ncells = 10\n";

/// A file with two columns, as the history of an end and as the curve of a material.
pub fn csv(bytes: &[u8], folder: &Path) {
    fs::write(folder.join("record.csv"), bytes).expect("written");
    for text in [HISTORY, CURVE] {
        explained(Scene::parse("fuzz.toml", text, folder, &[]));
    }
}

/// A result file, as `barwave report` reads it.
pub fn result(bytes: &[u8], folder: &Path) {
    let path = folder.join("out.h5");
    fs::write(&path, bytes).expect("written");
    let Some(file) = explained(ResultFile::open(&path)) else { return };
    if explained(draw(&file, &Figure::default())).is_some() {
        explained(page(&file, &Figure { units: Units::Us, ..Figure::default() }));
    }
}
