//! Scenes: the raw keys (`raw`), their conversion (`check`), and the result as plain data in SI units (here).

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

/// Problem described by a scene file.
#[derive(Debug, Clone)]
pub enum Problem {
    /// Waves in a bar.
    Bar(Box<Scene>),
    /// Another kind of impact: the energy method, spheres, a plate or a beam.
    Impact(Box<ImpactScene>),
}

impl Problem {
    /// Reads and checks a scene file of any kind, as [`Scene::read`] does for a bar.
    ///
    /// # Errors
    /// Only input errors: the first error in the scene, with its position.
    pub fn read(path: &Path, changes: &[String]) -> Result<Self> {
        Self::of_document(&Document::read_scene(path)?, path, changes)
    }

    /// Reads and checks a scene of any kind from text in memory, as [`Scene::parse`] does for a bar.
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

    /// Reads and checks a scene of any kind from a document that has been read from a file.
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

/// Scene file that is read many times with different overrides; everything that does not depend on them is done only once.
#[derive(Debug, Clone)]
pub struct Template {
    document: Document,
    editable: DocumentMut,
    path: PathBuf,
    base: PathBuf,
    /// Kind of impact; `None` for a bar.
    impact: Option<&'static Kind>,
}

impl Template {
    /// Creates a template from a document that has been read from a file.
    ///
    /// # Errors
    /// An input error if the text is not valid TOML.
    pub fn new(document: Document, path: PathBuf) -> Result<Self> {
        let (editable, base, impact) = (overrides::editable(&document)?, folder(&path), impacts::kind(&document));
        Ok(Self { document, editable, path, base, impact })
    }

    /// Returns the scene's title; the stem of the file if the scene has none.
    pub fn title(&self) -> String {
        let given = self.editable.get("title").and_then(toml_edit::Item::as_str).map(str::to_owned);
        given.or_else(|| Some(self.path.file_stem()?.to_string_lossy().into_owned())).unwrap_or_default()
    }

    /// Returns the scene with overrides, as [`Problem::of_document`] does.
    ///
    /// # Errors
    /// As for [`Problem::read`].
    pub fn problem(&self, overrides: &[String]) -> Result<Problem> {
        let typed = Overrides::new(overrides)?;
        let edited = typed.edit(&self.document, self.editable.clone())?;
        let source = Source { document: &self.document, edited: &edited, base: &self.base, typed: &typed };
        Problem::of_source(source, Some(&self.path), self.impact)
    }

    /// Returns the dimensions of the numbers at these dotted keys; `None` for a key that the scene with these overrides does not read as a number.
    pub(crate) fn dimensions(&self, overrides: &[String], keys: &[&str]) -> Vec<Option<Dimension>> {
        let none = || vec![None; keys.len()];
        let Ok(typed) = Overrides::new(overrides) else { return none() };
        let Ok(edited) = typed.edit(&self.document, self.editable.clone()) else { return none() };
        let source = Source { document: &self.document, edited: &edited, base: &self.base, typed: &typed };
        // Errors of the scene are ignored here because running it reports them.
        dimensions::of_keys(&edited, keys, || Problem::of_source(source, Some(&self.path), self.impact).is_ok())
    }
}

/// Text with its overrides, before it is converted to a scene.
#[derive(Debug, Clone, Copy)]
struct Source<'a> {
    /// Text as it was read.
    document: &'a Document,
    /// Text with the overrides applied.
    edited: &'a Document,
    /// Folder to which paths are relative.
    base: &'a Path,
    typed: &'a Overrides,
}

fn folder(path: &Path) -> PathBuf {
    path.parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// Checked scene. Its contents ([`SceneParts`]) can be read, and can be changed only through its keys ([`Scene::with`]). A run can therefore rely on
/// the checks, and the text in the result file is that of the run.
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

/// Contents of a checked scene, with all defaults filled in.
#[derive(Debug, Clone)]
pub struct SceneParts {
    /// Title; by default the stem of the file.
    pub title: String,
    /// Stem of the file, used for the name of the default output.
    pub name: String,
    /// Path of the file, if the scene was read from one.
    pub path: Option<PathBuf>,
    /// Exact text of the scene, as read.
    pub text: String,
    /// Changes of keys (`--set` on the command line), as typed.
    pub overrides: Vec<String>,
    /// The bar.
    pub bar: Bar,
    /// Left end.
    pub left: EndCondition,
    /// Right end.
    pub right: EndCondition,
    /// Effects beyond the stress-strain curve.
    pub effects: Effects,
    /// Selections of `effects = "auto"`, if the scene uses it; `Self::effects` are the effects selected so far.
    pub auto: Option<Auto>,
    /// Folder to which paths in the scene are relative.
    pub base: PathBuf,
    /// Materials and histories that were read from files.
    pub files: NamedFiles,
    /// Numerical method and end time.
    pub solve: Solve,
    /// Output that is recorded.
    pub record: Record,
    /// Original scene and its discretization, if tapered segments or initial states were divided into uniform pieces; `None` for a scene as read.
    pub discretized: Option<Box<TaperDiscretization>>,
    /// Meaning of the surface quantities of a bar in torsion; `None` for an axial bar.
    pub torsion: Option<Torsion>,
}

/// Bar in torsion, described by quantities of its surface. The stress is T R/J, where T is the torque in the section; the strain is R dtheta/dx; the
/// velocity is R omega; the area of a segment is J/R^2. The material has the curve of the section, see [`crate::material::TubeSection`].
#[derive(Debug, Clone, PartialEq)]
pub struct Torsion {
    /// Radius R, m: the outer radius; for thin tubes the mean radius.
    pub radius: f64,
    /// Polar second moment of area J of each segment, m^4.
    pub polar: Vec<f64>,
    /// Arm of the lever at the left and the right end that a ball strikes, divided by R; 1 without a lever.
    pub levers: [f64; 2],
}

impl Torsion {
    /// Returns the ratio of the torque to the stress at the surface of each segment, m^3.
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
    /// Whether the run estimates its error, with further runs if needed.
    pub estimate_error: bool,
    /// Relative change of the stress above which a neglected effect is significant, 0 < . < 1.
    pub audit_tolerance: f64,
}

/// Allowed error, from which the method is selected.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// Largest relative error, > 0, of the stress over the bar and time, at the ends and gauges, of the residual plastic strain and of the peak
    /// force.
    pub value: f64,
    /// Methods that support the scene, with default settings.
    pub methods: Vec<Method>,
}

/// Method of the scene language, with its scheme if there is a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodChoice {
    /// "moc" or "fd".
    pub method: &'static str,
    /// Scheme, such as "leapfrog"; `None` for a method without a choice of schemes.
    pub scheme: Option<&'static str>,
}

impl MethodChoice {
    /// All methods and schemes from which a tolerance selects.
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

/// Method with its settings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Finite differences on a staggered grid.
    Leapfrog {
        /// Cells over the whole bar, >= 2, distributed so that the elastic waves take equal times to cross each cell.
        cells: usize,
        /// Courant number of the fastest wave, 0 < cfl <= 1.
        cfl: f64,
    },
    /// Conservative finite differences with the exact Riemann flux.
    Muscl {
        /// Cells over the whole bar, >= 2, distributed so that the elastic waves take equal times to cross each cell.
        cells: usize,
        /// Courant number of the fastest wave, 0 < cfl <= 1.
        cfl: f64,
    },
    /// Method of characteristics without a grid: fronts are tracked individually.
    FrontTracking {
        /// Smallest stress jump that is tracked as a separate front, relative to the largest stress possible in the scene; 0 <= `front_tolerance` < 1.
        /// 0 tracks all jumps.
        front_tolerance: f64,
        /// Largest number of events of the run, >= 1.
        event_budget: u64,
    },
    /// Method of characteristics for rate-dependent bars: a net of straight characteristics.
    CharacteristicNet {
        /// Cells over the whole bar, >= 2; the elastic wave crosses one cell per step.
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
    /// Returns true for front tracking, which has no cells but records paths of fronts.
    pub fn tracks_fronts(&self) -> bool {
        matches!(self, Self::FrontTracking { .. })
    }

    /// Returns the number of cells over the whole bar; `None` for front tracking.
    pub fn cells(&self) -> Option<usize> {
        match *self {
            Self::Leapfrog { cells, .. } | Self::Muscl { cells, .. } | Self::CharacteristicNet { cells } => Some(cells),
            Self::FrontTracking { .. } => None,
        }
    }

    /// Returns the method with another number of cells; unchanged if it has none.
    #[must_use]
    pub fn with_cells(self, cells: usize) -> Self {
        match self {
            Self::Leapfrog { cfl, .. } => Self::Leapfrog { cells, cfl },
            Self::Muscl { cfl, .. } => Self::Muscl { cells, cfl },
            Self::CharacteristicNet { .. } => Self::CharacteristicNet { cells },
            Self::FrontTracking { .. } => self,
        }
    }

    /// Returns the method with another front tolerance; unchanged if it has none.
    #[must_use]
    pub fn with_front_tolerance(self, front_tolerance: f64) -> Self {
        match self {
            Self::FrontTracking { event_budget, .. } => Self::FrontTracking { front_tolerance, event_budget },
            other => other,
        }
    }

    /// Returns the names of the method and its scheme in the scene language.
    pub fn names(&self) -> [&'static str; 2] {
        match self {
            Self::Leapfrog { .. } => ["fd", "leapfrog"],
            Self::Muscl { .. } => ["fd", "muscl"],
            Self::FrontTracking { .. } => ["moc", "front-tracking"],
            Self::CharacteristicNet { .. } => ["moc", "characteristic-net"],
        }
    }
}

/// Output that is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Times of the frames, s, increasing, within 0..=until.
    pub times: Vec<f64>,
    /// Number of samples of the fields over x; `None` for the cells of the solver (never `None` for front tracking).
    pub cells: Option<usize>,
    /// Whether the straight segments of all fronts are recorded (front tracking only).
    pub paths: bool,
    /// Recorded fields, without repetitions.
    pub fields: Vec<Field>,
    /// Names and positions of the gauges, m from the left end, in the order of the scene.
    pub gauges: Vec<(String, f64)>,
    /// Floating-point format of the fields in the file.
    pub precision: Precision,
    /// Compression of the fields in the file.
    pub compression: Compression,
}

impl Record {
    /// Returns the positions of the gauges, m from the left end.
    pub fn gauge_places(&self) -> Vec<f64> {
        self.gauges.iter().map(|gauge| gauge.1).collect()
    }
}

impl Scene {
    /// Reads and checks a scene file. `changes` are texts `KEY=VALUE`, applied in order before anything is checked. KEY is a dotted key
    /// ("bar.segment.0.length"). VALUE is TOML or, if it is not valid TOML, a string ("-40 m/s"); an empty value removes the key.
    ///
    /// # Errors
    /// Only input errors: the first error in the scene, with its position in the file or, for a change, in [`CHANGES`]. A scene without a bar has to
    /// be read by [`Problem::read`].
    pub fn read(path: &Path, changes: &[String]) -> Result<Self> {
        Ok(Self::from_document(&Document::read_scene(path)?, &folder(path), changes)?.at(path))
    }

    /// Sets the path of the file from which the scene was read.
    fn at(mut self, path: &Path) -> Self {
        self.parts.path = Some(path.to_owned());
        self
    }

    /// Returns a builder for a scene that is set key by key.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }

    /// Checks a scene from text in memory. `name` replaces the name of the file in messages; paths in the scene are relative to `base_dir`.
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

    /// Returns all input values of the run in SI units, with all defaults filled in and including the tables of the materials, for `scene_resolved`
    /// of the result file.
    pub fn resolved_json(&self) -> serde_json::Value {
        resolved::json(self)
    }
}

/// Finds the methods that support a scene with a tolerance: each method is inserted into the text in place of the tolerance, and the whole scene is
/// checked.
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
    /// Returns a copper bar pulled at one end, for tests of functions that use scenes.
    pub(crate) fn pulled() -> Self {
        let text = "[bar]\nlength = \"1 m\"\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue = \"-30 m/s\"\n\
                    [right]\nkind = \"free\"\n[effects]\n[solve]\nuntil = \"1 ms\"\n";
        Self::parse("bar.toml", text, Path::new(""), &[]).expect("a scene")
    }
}

#[cfg(test)]
mod tests;
