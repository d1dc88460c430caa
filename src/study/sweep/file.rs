//! The sweep file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use super::axis::{Axis, RANDOM, Values};
use super::names::unknown;
use super::plan::{Combine, FIELDS, Plan};
use crate::error::{Error, InputError, Place, Result};
use crate::input::{Checked, Document, GivenKey};
use crate::record::store::checksum;
use crate::scene::{CHANGES, Problem, Template};
use crate::text_file;
use crate::units::Dimension;

/// Range of bytes of a text.
type Span = std::ops::Range<usize>;

/// A sweep that has been read from a file or created from a scene.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Stem of the file name, which names the default output.
    pub name: String,
    /// Cases of the sweep.
    pub plan: Plan,
    /// Scene that the cases change.
    template: Template,
    /// Positions of the keys that the cases change, in the sweep file; empty for a sweep without a file.
    given: Vec<Given>,
}

/// Position in the sweep file of the values of a key.
#[derive(Debug, Clone)]
struct Given {
    /// Key of the scene.
    key: String,
    /// Key of the sweep file.
    named: String,
    place: Place,
}

/// A scene that runs many times with other values of some keys.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave sweep")]
pub(crate) struct RawFile {
    sweep: RawSweep,
    /// The scene keys that vary, dotted as for `--set`, with their values.
    #[serde(default)]
    #[schemars(required, with = "BTreeMap<String, Values>")]
    axes: toml::Table,
}

/// What runs and what is kept.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RawSweep {
    /// The scene file, relative to this one.
    #[schemars(with = "PathBuf")]
    scene: Spanned<PathBuf>,
    /// How axes are combined.
    #[serde(default)]
    combine: Combine,
    /// Names of the results in the table, dotted as in the summary JSON. Default: every scalar of the summary except computing times.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    metrics: Vec<Spanned<String>>,
    /// Fields to keep of every case, each in a result file of its own. Default: none.
    #[serde(default)]
    fields: Vec<String>,
}

impl Sweep {
    /// Reads and checks a sweep file, and its scene with the values of the first case.
    ///
    /// # Errors
    /// Input errors only: the first error with its position.
    pub fn read(path: &Path) -> Result<Self> {
        Self::of_document(&Document::read_scene(path)?, path)
    }

    /// Creates a sweep from a sweep file that has been read, and reads and checks its scene.
    ///
    /// # Errors
    /// As for [`Sweep::read`].
    pub fn of_document(file: &Document, path: &Path) -> Result<Self> {
        let parsed = file.parsed()?;
        let places = parsed.keys_in("axes");
        let raw: RawFile = parsed.read()?;
        let scene = path.parent().unwrap_or(Path::new("")).join(raw.sweep.scene.get_ref());
        let document = Document::read(&scene).map_err(|e| beside(e, file, &raw.sweep.scene))?;
        let name = path.file_stem().map_or_else(|| "sweep".into(), |stem| stem.to_string_lossy().into_owned());
        let spans: Vec<Span> = raw.sweep.metrics.iter().map(Spanned::span).collect();
        let metrics = raw.sweep.metrics.into_iter().map(Spanned::into_inner).collect();
        let axes = axes(file, &places, &raw.axes)?;
        let sweep = Self::of_scene(name, document, &scene, axes, raw.sweep.combine, metrics, raw.sweep.fields)
            .map_err(|error| in_file(error, file, &spans))?;
        Ok(Self { given: given(file, &places), ..sweep })
    }

    /// Creates a sweep of a scene that has been read. Axes that are combined by "zip" need equal numbers of values.
    ///
    /// # Errors
    /// Input errors only: a text that is not a scene; a metric that no bar has; no axes, an axis without values, two axes of one key, axes of unequal
    /// length that are combined by "zip", or too many cases.
    pub fn of_scene(
        name: String,
        document: Document,
        scene: &Path,
        axes: Vec<Axis>,
        combine: Combine,
        metrics: Vec<String>,
        fields: Vec<String>,
    ) -> Result<Self> {
        if document.parsed().is_ok_and(|scene| scene.has("bar")) {
            check_metrics(&metrics)?;
        }
        let scene_text = checksum(&document.text);
        let template = Template::new(document, scene.to_owned())?;
        let title = template.title();
        let mut plan = Plan { program: program(), title, scene: scene_text, files: 0, axes, combine, metrics, fields };
        plan.check()?;
        state_units(&mut plan, &template);
        plan.files = checksum_of_files(&plan, &template);
        Ok(Self { name, plan, template, given: Vec::new() })
    }

    /// Returns the scene of a case.
    ///
    /// # Errors
    /// Input errors: a case that the sweep does not have; an error in the scene with these values, which has its position in the sweep file if it
    /// is an error of these values.
    pub fn problem(&self, case: usize) -> Result<Problem> {
        self.unplaced_problem(case).map_err(|error| self.in_sweep_file(error))
    }

    /// Returns the scene of a case as [`Sweep::problem`] does. The positions of errors in the values are those in the changes of the scene.
    pub(super) fn unplaced_problem(&self, case: usize) -> Result<Problem> {
        self.template.problem(&self.plan.overrides(case)?)
    }

    /// Moves the position of an error in a change of the scene to the values of its key in the sweep file.
    fn in_sweep_file(&self, error: Error) -> Error {
        let Error::Input(error) = error else { return error };
        let change = match &error.place {
            Some(place) if place.file == CHANGES => place.text.to_string(),
            None if error.key == CHANGES => error.message.clone(),
            _ => return error.into(),
        };
        let sets = |given: &&Given| change.strip_prefix(&given.key).is_some_and(|rest| rest.starts_with('='));
        match self.given.iter().find(sets) {
            Some(given) => error.key(&given.named).at(given.place.clone()).into(),
            None => InputError { place: None, ..error }.into(),
        }
    }
}

/// Returns the positions of the axes and of the fields in a sweep file.
fn given(file: &Document, axes: &[GivenKey]) -> Vec<Given> {
    let axis = |axis: &GivenKey| Given {
        key: axis.name.clone(),
        named: format!("axes.{}", axis.name),
        place: file.place(axis.value.clone()),
    };
    let named = "sweep.fields";
    let fields = |span| Given { key: FIELDS.to_owned(), named: named.to_owned(), place: file.place(span) };
    axes.iter().map(axis).chain(file.span_of(named).map(fields)).collect()
}

/// Sets the units of axes whose values are all plain numbers to those with which the scene reads them in the first case.
fn state_units(plan: &mut Plan, template: &Template) {
    let is_plain = |axis: &Axis| axis.unit.is_empty() && axis.levels.iter().all(|level| level.si.is_some());
    let plain: Vec<usize> = (0..plan.axes.len()).filter(|&k| is_plain(&plan.axes[k])).collect();
    if plain.is_empty() {
        return;
    }
    let keys: Vec<&str> = plain.iter().map(|&k| plan.axes[k].key.as_str()).collect();
    let found = template.dimensions(&plan.changes(0), &keys);
    for (k, dimension) in plain.into_iter().zip(found) {
        plan.axes[k].unit = dimension.map_or_else(String::new, Dimension::spaced_symbol);
    }
}

/// Returns the checksum of the files that the scene names, such as materials, which are not part of its text.
fn checksum_of_files(plan: &Plan, template: &Template) -> u32 {
    // A refused case has read its files, too.
    let of_case = |case| text_file::recorded(|| template.problem(&plan.changes(case))).1;
    let texts: BTreeSet<String> = plan.cases_of_texts().into_iter().flat_map(of_case).map(|(_, text)| text).collect();
    checksum(&Vec::from_iter(texts).join("\n"))
}

/// Returns the name and version of the program, since other versions may give other results.
fn program() -> String {
    format!("barwave {}", env!("CARGO_PKG_VERSION"))
}

/// Converts an error of the scene file to one at the position where the sweep file names the scene.
fn beside(error: Error, file: &Document, scene: &Spanned<PathBuf>) -> Error {
    match error {
        Error::Input(error) => {
            let help = "the path is relative to the sweep file";
            let message = format!("cannot read the scene: {}", error.message);
            file.error(scene.span(), "sweep.scene", message).help(help).into()
        }
        other => other,
    }
}

/// Reads the axes in the order of the file.
fn axes(file: &Document, places: &[GivenKey], values: &toml::Table) -> Result<Vec<Axis>> {
    let axis = |GivenKey { name: key, value: span, .. }: &GivenKey| {
        let wrong = |message| {
            let help = "e.g. \"left.value\" = { from = \"-5 m/s\", to = \"-50 m/s\", count = 10 }, or a list of values";
            Error::from(file.error(span.clone(), &format!("axes.{key}"), message).help(help))
        };
        let value = values.get(key).ok_or_else(|| wrong("missing".to_owned()))?;
        // `left.value = [...]` without quotes is a nested table in TOML.
        if !key.contains('.')
            && let Some((inner, _)) =
                value.as_table().and_then(|table| table.iter().find(|(_, value)| value.is_table() || value.is_array()))
            && !RANDOM.contains(&inner.as_str())
        {
            return Err(wrong(format!("quote the key of an axis: \"{key}.{inner}\" = ...")));
        }
        Axis::read(key, value).map_err(wrong)
    };
    places.iter().map(axis).collect()
}

/// Refuses names that no bar has, before any case is run.
fn check_metrics(metrics: &[String]) -> Checked {
    for (k, metric) in metrics.iter().enumerate() {
        if let Some(help) = unknown(metric) {
            let error = InputError::new(format!("unknown metric `{metric}`"));
            return Err(error.key(format!("{METRICS}{k}")).help(help));
        }
    }
    Ok(())
}

/// Prefix of the number of a metric in the keys of errors.
const METRICS: &str = "metrics.";

/// Adds the position in the file to an error of axes or metrics. `metrics` are the positions of the metrics.
fn in_file(error: Error, file: &Document, metrics: &[Span]) -> Error {
    let Error::Input(error) = error else { return error };
    let metric = error.key.strip_prefix(METRICS).and_then(|k| metrics.get(k.parse::<usize>().ok()?));
    let (key, span) = match (metric, error.key.as_str()) {
        (Some(span), _) => ("sweep.metrics", Some(span.clone())),
        (None, "combine") => ("sweep.combine", file.span_of("sweep.combine")),
        (None, key) if key.starts_with("axes") => ("axes", file.span_of("axes")),
        _ => return error.into(),
    };
    let of_file = file.error(span.unwrap_or(0..0), key, error.message);
    of_file.allowed(error.allowed).help(error.help).into()
}
