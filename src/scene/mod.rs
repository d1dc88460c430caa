//! A scene: the raw keys (`raw`), their conversion (`check`), and the result as plain data in SI (here).

mod auto;
mod builder;
mod capability;
mod changes;
mod check;
mod critical;
mod damping;
mod deprecated;
mod discretized;
mod effects;
mod impacts;
mod notes;
mod overrides;
mod raw;
mod resolved;
mod value;

use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use toml_edit::DocumentMut;

use crate::bar::{Bar, EndCondition};
use crate::error::{InputError, Result};
use crate::input::{Document, dimensions};
use crate::material::library;
use crate::record::{Compression, Field, Precision, SolvedBy};
use crate::text_file::{self, NamedFiles};
use crate::units::Dimension;

pub use auto::Auto;
pub use builder::SceneBuilder;
pub use capability::methods_table;
pub use damping::Damping;
pub use discretized::{MOST_PIECES, TaperDiscretization};
pub use effects::{Effects, HardeningRule, Heat, Rate, Rupture};
pub use impacts::{ImpactScene, KINDS, Kind};
pub use overrides::CHANGES;
use overrides::Overrides;
pub use raw::{MOST_EVENTS, RawScene};
pub use value::IntoValue;

/// The problem of a scene file.
#[derive(Debug, Clone)]
pub enum Problem {
    /// Waves in a bar.
    Bar(Box<Scene>),
    /// Another impact: the energy method, spheres, a plate, a beam.
    Impact(Box<ImpactScene>),
}

impl Problem {
    /// Reads and checks a scene file of any kind, as [`Scene::read`] does one with a bar.
    ///
    /// # Errors
    /// Input errors only: the first thing that is wrong, with its place.
    pub fn read(path: &Path, changes: &[String]) -> Result<Self> {
        Self::of_document(&Document::read_scene(path)?, path, changes)
    }

    /// Reads and checks a scene of any kind from text in memory, as [`Scene::parse`] does one with a bar.
    ///
    /// # Errors
    /// As for [`Problem::read`].
    pub fn parse(name: &str, text: &str, base_dir: &Path, changes: &[String]) -> Result<Self> {
        let document = Document::new(name, text);
        let typed = Overrides::new(changes)?;
        let edited = typed.apply(&document)?;
        let source = Source { document: &document, edited: &edited, base: base_dir, typed: &typed };
        Self::of_source(source, None, impacts::kind(&document))
    }

    /// The same of a file that has been read.
    ///
    /// # Errors
    /// As for [`Problem::read`].
    pub fn of_document(document: &Document, path: &Path, changes: &[String]) -> Result<Self> {
        let typed = Overrides::new(changes)?;
        let edited = typed.apply(document)?;
        let source = Source { document, edited: &edited, base: &folder(path), typed: &typed };
        Self::of_source(source, Some(path), impacts::kind(document))
    }

    fn of_source(source: Source<'_>, path: Option<&Path>, kind: Option<&Kind>) -> Result<Self> {
        let Some(kind) = kind else {
            let scene = Scene::of_source(source)?;
            return Ok(Self::Bar(Box::new(if let Some(path) = path { scene.at(path) } else { scene })));
        };
        let checked = impacts::check(kind, source.edited, source.base);
        let mut scene = checked.map_err(|e| source.typed.explain(e, source.document))?;
        scene.text = source.document.text.to_string();
        scene.overrides = source.typed.texts();
        Ok(Self::Impact(Box::new(scene)))
    }
}

/// A scene file that is read many times, with other overrides each time: what does not depend on these is done once.
#[derive(Debug, Clone)]
pub struct Template {
    document: Document,
    editable: DocumentMut,
    path: PathBuf,
    base: PathBuf,
    /// Not a bar.
    impact: Option<&'static Kind>,
}

impl Template {
    /// Of a file that has been read.
    ///
    /// # Errors
    /// An input error where the text is no TOML.
    pub fn new(document: Document, path: PathBuf) -> Result<Self> {
        let (editable, base, impact) = (overrides::editable(&document)?, folder(&path), impacts::kind(&document));
        Ok(Self { document, editable, path, base, impact })
    }

    /// The scene's title; the file's stem where it gives none.
    pub fn title(&self) -> String {
        let given = self.editable.get("title").and_then(toml_edit::Item::as_str).map(str::to_owned);
        given.or_else(|| Some(self.path.file_stem()?.to_string_lossy().into_owned())).unwrap_or_default()
    }

    /// The scene with overrides, as [`Problem::of_document`] gives it.
    ///
    /// # Errors
    /// As for [`Problem::read`].
    pub fn problem(&self, overrides: &[String]) -> Result<Problem> {
        let typed = Overrides::new(overrides)?;
        let edited = typed.edit(&self.document, self.editable.clone())?;
        let source = Source { document: &self.document, edited: &edited, base: &self.base, typed: &typed };
        Problem::of_source(source, Some(&self.path), self.impact)
    }

    /// The dimensions of the numbers at these dotted keys, as far as the scene with overrides reads them.
    pub(crate) fn dimensions(&self, overrides: &[String], keys: &[&str]) -> Vec<Option<Dimension>> {
        let none = || vec![None; keys.len()];
        let Ok(typed) = Overrides::new(overrides) else { return none() };
        let Ok(edited) = typed.edit(&self.document, self.editable.clone()) else { return none() };
        let source = Source { document: &self.document, edited: &edited, base: &self.base, typed: &typed };
        // What is wrong with the scene is found again by who runs it.
        dimensions::of_keys(&edited, keys, || Problem::of_source(source, Some(&self.path), self.impact).is_ok())
    }
}

/// A text with its overrides, on its way to a scene.
#[derive(Debug, Clone, Copy)]
struct Source<'a> {
    /// As read.
    document: &'a Document,
    /// With the overrides in their places.
    edited: &'a Document,
    /// The folder that paths are relative to.
    base: &'a Path,
    typed: &'a Overrides,
}

fn folder(path: &Path) -> PathBuf {
    path.parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// A checked scene: what it holds ([`SceneParts`]) can be read, and is changed by its keys alone ([`Scene::with`]), so that a run can rely on
/// it and the text in the result file is that of the run.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) parts: SceneParts,
}

impl Deref for Scene {
    type Target = SceneParts;

    fn deref(&self) -> &SceneParts {
        &self.parts
    }
}

/// What a checked scene holds. Every default is filled in.
#[derive(Debug, Clone)]
pub struct SceneParts {
    /// Title; by default the stem of the file.
    pub title: String,
    /// The file's stem: names the default output.
    pub name: String,
    /// The file, where it came from one.
    pub path: Option<PathBuf>,
    /// The scene's exact text, as read.
    pub text: String,
    /// Changes of keys (on the command line `--set`), as typed.
    pub overrides: Vec<String>,
    /// The bar.
    pub bar: Bar,
    /// Left end.
    pub left: EndCondition,
    /// Right end.
    pub right: EndCondition,
    /// Effects beyond the curve itself.
    pub effects: Effects,
    /// `effects = "auto"`: `Self::effects` is what was chosen so far.
    pub auto: Option<Auto>,
    /// The folder that paths in the scene are relative to.
    pub base: PathBuf,
    /// The materials and histories that were read from files.
    pub files: NamedFiles,
    /// How to solve.
    pub solve: Solve,
    /// What to record.
    pub record: Record,
    /// The original of a scene whose tapered segments were divided into uniform pieces; none for a scene as read.
    pub discretized: Option<Box<TaperDiscretization>>,
    /// Of a bar in torsion: what its surface quantities stand for. None for an axial bar.
    pub torsion: Option<Torsion>,
}

/// A bar in torsion, in terms of the surface. Stress is T R/J, T being the torque in the section; strain R dtheta/dx; velocity
/// R omega; the area of a segment J/R^2; its material's curve that of the section, see [`crate::material::TubeSection`].
#[derive(Debug, Clone, PartialEq)]
pub struct Torsion {
    /// R, m: the outer radius; of thin tubes the mean one.
    pub radius: f64,
    /// J of each segment, m^4.
    pub polar: Vec<f64>,
    /// Arms of the levers at the left and the right end that balls strike, over R; 1 where there is none.
    pub levers: [f64; 2],
}

impl Torsion {
    /// Torque over the stress at the surface of each segment, m^3.
    pub fn torque_per_stress(&self) -> impl Iterator<Item = f64> {
        self.polar.iter().map(|polar| polar / self.radius)
    }
}

/// Numerical method and end time.
#[derive(Debug, Clone, PartialEq)]
pub struct Solve {
    /// End time, s, > 0.
    pub until: f64,
    /// Method and its settings; with a tolerance, the first of its methods.
    pub method: Method,
    /// Allowed error, instead of a method.
    pub tolerance: Option<Tolerance>,
    /// The run estimates its error, with further runs if needed.
    pub estimate_error: bool,
    /// Relative change of the stress above which a neglected effect is significant, 0 < . < 1.
    pub audit_tolerance: f64,
}

/// An error in place of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// Relative L1 of stress over the bar at the end time, > 0.
    pub value: f64,
    /// The methods that can do the scene, with default settings.
    pub methods: Vec<Method>,
}

/// A method of the scene language, and the scheme where there is a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodChoice {
    /// "moc" or "fd".
    pub method: &'static str,
    /// "leapfrog", ...
    pub scheme: Option<&'static str>,
}

impl MethodChoice {
    /// All of them.
    pub const ALL: [Self; 3] = [
        Self { method: "moc", scheme: None },
        Self { method: "fd", scheme: Some("muscl") },
        Self { method: "fd", scheme: Some("leapfrog") },
    ];
}

impl Solve {
    /// Default of [`Solve::audit_tolerance`].
    pub const AUDIT_TOLERANCE: f64 = 0.01;
}

/// A method with its settings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Finite differences on a staggered grid.
    Leapfrog {
        /// Cells over the whole bar, >= 2, shared out so that waves take equal time across each.
        cells: usize,
        /// Courant number of the fastest wave, 0 < cfl <= 1.
        cfl: f64,
    },
    /// Conservative finite differences with the exact Riemann flux.
    Muscl {
        /// Cells over the whole bar, >= 2, shared out so that waves take equal time across each.
        cells: usize,
        /// Courant number of the fastest wave, 0 < cfl <= 1.
        cfl: f64,
    },
    /// The method of characteristics: fronts followed one by one, no grid.
    FrontTracking {
        /// Smallest stress jump that is tracked as a front of its own, relative to the largest stress that the scene's data can
        /// reach, 0 <= and < 1; 0 tracks all.
        front_tolerance: f64,
        /// Most events that the run may take, >= 1.
        event_budget: u64,
    },
    /// The method of characteristics for rate-dependent bars: a net of straight characteristics.
    CharacteristicNet {
        /// Cells over the whole bar, >= 2, each crossed by the elastic wave in one step.
        cells: usize,
    },
}

impl From<Method> for SolvedBy {
    fn from(method: Method) -> Self {
        let [name, scheme] = method.names();
        let front_tolerance = match method {
            Method::FrontTracking { front_tolerance, .. } => Some(front_tolerance),
            _ => None,
        };
        Self { method: name.into(), scheme: scheme.into(), cells: method.cells(), front_tolerance }
    }
}

impl Method {
    /// True where fronts are followed one by one: no cells, but paths.
    pub fn tracks_fronts(&self) -> bool {
        matches!(self, Self::FrontTracking { .. })
    }

    /// Cells over the whole bar; none where there are no cells.
    pub fn cells(&self) -> Option<usize> {
        match *self {
            Self::Leapfrog { cells, .. } | Self::Muscl { cells, .. } | Self::CharacteristicNet { cells } => Some(cells),
            Self::FrontTracking { .. } => None,
        }
    }

    /// The method with another number of cells; unchanged if it has none.
    #[must_use]
    pub fn with_cells(self, cells: usize) -> Self {
        match self {
            Self::Leapfrog { cfl, .. } => Self::Leapfrog { cells, cfl },
            Self::Muscl { cfl, .. } => Self::Muscl { cells, cfl },
            Self::CharacteristicNet { .. } => Self::CharacteristicNet { cells },
            Self::FrontTracking { .. } => self,
        }
    }

    /// The method with another front tolerance; unchanged if it has none.
    #[must_use]
    pub fn with_front_tolerance(self, front_tolerance: f64) -> Self {
        match self {
            Self::FrontTracking { event_budget, .. } => Self::FrontTracking { front_tolerance, event_budget },
            other => other,
        }
    }

    /// The words of the scene language for the method and its scheme.
    pub fn names(&self) -> [&'static str; 2] {
        match self {
            Self::Leapfrog { .. } => ["fd", "leapfrog"],
            Self::Muscl { .. } => ["fd", "muscl"],
            Self::FrontTracking { .. } => ["moc", "front-tracking"],
            Self::CharacteristicNet { .. } => ["moc", "characteristic-net"],
        }
    }
}

/// What is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Frame times, s, increasing, within 0..=until.
    pub times: Vec<f64>,
    /// x samples of the fields; none: the solver's own cells (always some where it has none).
    pub cells: Option<usize>,
    /// The straight pieces of all fronts are recorded (front tracking only).
    pub paths: bool,
    /// Fields, no repeats.
    pub fields: Vec<Field>,
    /// Gauges: name and place, m from the left end, in the scene's order.
    pub gauges: Vec<(String, f64)>,
    /// Floating-point format of the fields in the file.
    pub precision: Precision,
    /// Compression of the fields in the file.
    pub compression: Compression,
}

impl Record {
    /// Places of the gauges, m from the left end.
    pub fn gauge_places(&self) -> Vec<f64> {
        self.gauges.iter().map(|gauge| gauge.1).collect()
    }
}

impl Scene {
    /// Reads and checks a scene file. `changes` are `KEY=VALUE` texts, applied in order before anything is
    /// checked: a dotted key ("bar.segment.0.length"), and a value that is TOML or else text ("-40 m/s"); an empty
    /// value takes the key out.
    ///
    /// # Errors
    /// Input errors only: the first thing that is wrong, with its place in the file or, of a change, in [`CHANGES`]. A scene without a bar
    /// is one for [`Problem::read`].
    pub fn read(path: &Path, changes: &[String]) -> Result<Self> {
        Ok(Self::from_document(&Document::read_scene(path)?, &folder(path), changes)?.at(path))
    }

    /// The same, read from this file.
    fn at(mut self, path: &Path) -> Self {
        self.parts.path = Some(path.to_owned());
        self
    }

    /// A scene put together key by key.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }

    /// Checks a scene from text in memory. `name` stands for the file in messages; paths in the scene are
    /// relative to `base_dir`.
    ///
    /// # Errors
    /// As for [`Scene::read`].
    pub fn parse(name: &str, text: &str, base_dir: &Path, changes: &[String]) -> Result<Self> {
        Self::from_document(&Document::new(name, text), base_dir, changes)
    }

    fn from_document(original: &Document, base: &Path, typed: &[String]) -> Result<Self> {
        if let Some(kind) = impacts::kind(original) {
            let message = format!("this needs a scene with [bar], not [{}]", kind.key);
            let help = "read it with `scene::Problem`, and solve it with `run::run_impact`";
            return Err(InputError::new(message).key(kind.key).help(help).into());
        }
        let overrides = Overrides::new(typed)?;
        let edited = overrides.apply(original)?;
        Self::of_source(Source { document: original, edited: &edited, base, typed: &overrides })
    }

    fn of_source(source: Source<'_>) -> Result<Self> {
        let Source { document, edited, base, typed } = source;
        let (checked, texts) = text_file::recorded(|| check::check(edited, base));
        let mut scene = checked.map_err(|e| typed.explain(e, document))?;
        let materials = library::user_folder().map(|folder| folder.display().to_string());
        scene.parts.files = NamedFiles { base: base.display().to_string(), materials, texts };
        find_methods(&mut scene, edited, base);
        scene.parts.text = document.text.to_string();
        scene.parts.overrides = typed.texts();
        Ok(scene)
    }

    /// Everything that the run uses, every default filled in, SI, the materials' tables included: for the result
    /// file's `scene_resolved`.
    pub fn resolved_json(&self) -> serde_json::Value {
        resolved::json(self)
    }
}

/// The methods that can do a scene with a tolerance: each is put into its text in the place of that, and checked with all
/// else.
fn find_methods(scene: &mut Scene, document: &Document, base: &Path) {
    let Some(tolerance) = &mut scene.parts.solve.tolerance else { return };
    let with = |choice: MethodChoice| {
        let mut typed = vec!["solve.tolerance=".to_owned(), format!("solve.method=\"{}\"", choice.method)];
        typed.extend(choice.scheme.map(|scheme| format!("solve.scheme=\"{scheme}\"")));
        let edited = Overrides::new(&typed).and_then(|overrides| overrides.apply(document)).ok()?;
        check::check(&edited, base).ok().map(|scene| scene.solve.method)
    };
    tolerance.methods = MethodChoice::ALL.into_iter().filter_map(with).collect();
}

#[cfg(test)]
impl Scene {
    /// A copper bar whose end is pulled, for tests of what is done with scenes.
    pub(crate) fn pulled() -> Self {
        let text = "[bar]\nlength = \"1 m\"\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue = \"-30 m/s\"\n\
                    [right]\nkind = \"free\"\n[effects]\n[solve]\nuntil = \"1 ms\"\n";
        Self::parse("bar.toml", text, Path::new(""), &[]).expect("a scene")
    }
}

#[cfg(test)]
mod tests;
