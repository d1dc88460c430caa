//! The scene solved by other methods: its text is read again with another `[solve]` table, so that all checks apply.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{Error, InputError, Result};
use crate::record::SolvedBy;
use crate::scene::{Method, MethodChoice, Scene};

/// A method that does not support the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Unable {
    /// "fd" or "moc".
    pub method: String,
    /// Scheme, if the method has several.
    pub scheme: Option<String>,
    /// Reason why the method does not support the scene.
    pub why: String,
}

/// Resolution of a method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resolution {
    /// Requested number of cells of the bar.
    Cells(usize),
    /// Front tolerance.
    FrontTolerance(f64),
}

impl Resolution {
    /// Returns this resolution together with a method and scheme.
    pub(super) fn solved_by(self, [method, scheme]: [&str; 2]) -> SolvedBy {
        let (cells, front_tolerance) = match self {
            Self::Cells(cells) => (Some(cells), None),
            Self::FrontTolerance(tolerance) => (None, Some(tolerance)),
        };
        SolvedBy { method: method.into(), scheme: scheme.into(), cells, front_tolerance }
    }
}

/// A method with a scheme, and all its resolutions, coarse to fine.
#[derive(Debug, Clone)]
pub(super) struct Family {
    pub choice: MethodChoice,
    /// Method and scheme as in the scene file.
    pub names: [&'static str; 2],
    pub levels: Vec<Resolution>,
}

/// Cells of the coarsest grid, and number of levels, each with twice the cells of the previous one.
const FIRST_CELLS: usize = 100;
const DOUBLINGS: u32 = 14;

/// Front tolerances of the levels of front tracking.
const TOLERANCES: [f64; 10] = [1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 0.0];

/// The scene as it was read.
#[derive(Debug)]
pub(super) struct Source<'a> {
    scene: &'a Scene,
    base: PathBuf,
    /// Whether the scene sets `record.paths`, which only front tracking supports.
    records_paths: bool,
}

impl<'a> Source<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let base = scene.path.as_deref().and_then(Path::parent).map_or_else(PathBuf::new, Path::to_owned);
        let table: toml::Table = scene.text.parse().unwrap_or_default();
        let set = |typed: &String| typed.trim_start().starts_with("record.paths");
        let written = table.get("record").and_then(|r| r.get("paths")).is_some();
        Self { scene, base, records_paths: written || scene.overrides.iter().any(set) }
    }

    /// Returns the methods that support the scene, and those that do not, with the reason.
    pub fn families(&self) -> (Vec<Family>, Vec<Unable>) {
        let (mut able, mut unable) = (Vec::new(), Vec::new());
        for choice in MethodChoice::ALL {
            match self.read(&self.overrides(choice, None)) {
                Ok(scene) => {
                    let levels = if scene.solve.method.tracks_fronts() {
                        TOLERANCES.into_iter().map(Resolution::FrontTolerance).collect()
                    } else {
                        (0..DOUBLINGS).map(|k| Resolution::Cells(FIRST_CELLS << k)).collect()
                    };
                    able.push(Family { choice, names: scene.solve.method.names(), levels });
                }
                Err(error) => {
                    let why = if let Error::Input(e) = &error { e.message.clone() } else { error.to_string() };
                    unable.push(Unable { method: choice.method.into(), scheme: choice.scheme.map(str::to_owned), why });
                }
            }
        }
        (able, unable)
    }

    /// Returns the overrides that select a method and a resolution, or the default resolution if `None`.
    pub fn overrides(&self, choice: MethodChoice, resolution: Option<Resolution>) -> Vec<String> {
        let mut solve = vec![format!("until={:e}", self.scene.solve.until), format!("method=\"{}\"", choice.method)];
        solve.extend(choice.scheme.map(|scheme| format!("scheme=\"{scheme}\"")));
        match (self.scene.solve.method, choice.scheme) {
            (Method::Leapfrog { cfl, .. }, Some("leapfrog")) | (Method::Muscl { cfl, .. }, Some("muscl"))
                if cfl != 1.0 =>
            {
                solve.push(format!("cfl={cfl:e}"));
            }
            _ => {}
        }
        solve.extend(resolution.map(|resolution| match resolution {
            Resolution::Cells(cells) => format!("cells={cells}"),
            Resolution::FrontTolerance(tolerance) => format!("front-tolerance={tolerance:e}"),
        }));
        let mut all = self.scene.overrides.clone();
        if self.records_paths {
            all.push("record.paths=".into());
        }
        all.push(format!("solve={{{}}}", solve.join(",")));
        all
    }

    /// Reads the scene with these overrides.
    pub fn read(&self, overrides: &[String]) -> Result<Scene> {
        if self.scene.text.is_empty() {
            let message = "this scene has no source text that can be read again with another method";
            return Err(InputError::new(message).help("read it from a file or with Scene::parse").into());
        }
        let name = self.scene.path.as_ref().map_or_else(|| self.scene.name.clone(), |p| p.display().to_string());
        Scene::parse(&name, &self.scene.text, &self.base, overrides)
    }

    /// Returns the scene with this method and resolution.
    pub fn at(&self, choice: MethodChoice, resolution: Resolution) -> Result<Scene> {
        self.read(&self.overrides(choice, Some(resolution)))
    }
}
