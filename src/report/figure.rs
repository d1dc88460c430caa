//! The figure of a result file: x-t diagram, profiles, histories, energies and front speeds in one picture.

use super::display::Units;
use super::drawing::Picture;
use super::html::picture;
use super::layout::{Content, Heading, alone, compose};
use super::slider::Profiles;
use super::view::View;
use super::{histories, impact, profiles, theory};
use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, member};
use crate::record::Field;
use crate::record::store::{Metadata, ResultFile};
use crate::units::Dimension;

/// Panel of the figure of a bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum PanelName {
    /// Field over the bar and time, with fronts, gauges and ruptures.
    #[value(name = "x-t")]
    Map,
    /// Field along the bar at several times.
    Profiles,
    /// Field at the gauges against time.
    Gauges,
    /// Field at the ends against time.
    Ends,
    /// Energies against time.
    Energy,
    /// Speed of the fronts against strain, with theory.
    FrontSpeeds,
    /// Strain (or the given field) against x/t, with theory.
    SelfSimilar,
    /// Path in the stress-strain plane, with the curves of the materials.
    StressStrain,
}

/// All panels in their order in the figure.
const ALL: [PanelName; 8] = [
    PanelName::Map,
    PanelName::Profiles,
    PanelName::Gauges,
    PanelName::Ends,
    PanelName::Energy,
    PanelName::FrontSpeeds,
    PanelName::SelfSimilar,
    PanelName::StressStrain,
];

/// Contents and size of the figure of a result file.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Field to show. `None`: stress if the file has it, otherwise its first field.
    pub field: Option<Field>,
    /// Units of all axes.
    pub units: Units,
    /// Panels in this order, without a title. Empty: all panels for which the file has data, under a title.
    pub panels: Vec<PanelName>,
    /// Width and height of the figure, px of 1/96 inch, 1 to 10000. `None`: as large as the panels need.
    pub size: Option<[f64; 2]>,
}

/// Allowed widths and heights of a figure, px.
const SIZES: Allowed = Allowed::Within(1.0, 10_000.0);

impl Figure {
    /// Checks the size, which determines how much memory the picture needs.
    fn check_size(&self) -> Checked {
        self.size.into_iter().flatten().try_for_each(|px| member("size", px, Dimension::None, SIZES))
    }
}

/// Draws a result file as one picture. Panels without data are omitted, unless they are requested by name.
///
/// # Errors
/// [`InputError`] if the file lacks the field or a requested panel, has no frame or cannot be read, or if the size is out of range.
pub fn draw(file: &ResultFile, figure: &Figure) -> Result<Picture> {
    figure.check_size()?;
    let heading = figure.panels.is_empty().then(|| heading(file.metadata(), figure.units));
    if let Some(impact) = file.impact()? {
        return compose(heading.as_ref(), &impact_contents(file, &impact, figure)?, figure.size);
    }
    let view = view(file, figure)?;
    compose(heading.as_ref(), &contents(&view, &figure.panels)?, figure.size)
}

/// Returns each panel as a picture of its own for an HTML page, with the time slider of the profile among them; `size` in px. Empty if there
/// is nothing to draw.
pub(super) fn pictures(file: &ResultFile, figure: &Figure, size: [f64; 2]) -> Result<String> {
    figure.check_size()?;
    if let Some(impact) = file.impact()? {
        // An impact in closed form has no histories; its page shows tables only.
        if !impact.has_histories() {
            return Ok(String::new());
        }
        let contents = impact_contents(file, &impact, figure)?;
        let profiles = impact.shapes.as_ref().and_then(|shapes| Profiles::of_beam(shapes, figure.units));
        return gallery(&contents, contents.len(), profiles, size);
    }
    let view = view(file, figure)?;
    let asked = figure.panels.is_empty() || figure.panels.contains(&PanelName::Profiles);
    let profiles = if asked { Some(Profiles::of_bar(&view)?) } else { None };
    // Placed after the x-t diagram and the profiles at several times.
    gallery(&contents(&view, &figure.panels)?, 2, profiles, size)
}

/// Returns the pictures of the panels as HTML, with the time slider of the profile inserted at position `place`.
fn gallery(contents: &[Content], place: usize, profiles: Option<Profiles>, size: [f64; 2]) -> Result<String> {
    let mut figures = Vec::with_capacity(contents.len() + 1);
    for (index, content) in contents.iter().enumerate() {
        let svg = picture(&content.heading(), &alone(content, size, index)?.svg());
        figures.push(format!("<figure>\n{svg}</figure>\n"));
    }
    if let Some(profiles) = profiles {
        figures.insert(place.min(contents.len()), profiles.html(size, contents.len())?);
    }
    Ok(format!("<div class=\"panels\">\n{}</div>\n", figures.concat()))
}

fn impact_contents<'a>(
    file: &ResultFile,
    impact: &crate::record::store::StoredImpact,
    figure: &Figure,
) -> Result<Vec<Content<'a>>> {
    if !figure.panels.is_empty() {
        let message = format!("{} contains an impact of the kind `{}`", file.path().display(), impact.kind);
        return Err(InputError::new(message).key("panels").help("only results of bars have selectable panels").into());
    }
    impact::panels(file, impact, figure.units)
}

/// Returns the requested panels, or all panels that have data.
fn contents<'a>(view: &'a View<'a>, asked: &[PanelName]) -> Result<Vec<Content<'a>>> {
    let mut contents = Vec::new();
    for name in if asked.is_empty() { &ALL[..] } else { asked } {
        match content(view, *name)? {
            Some(content) => contents.push(content),
            None if asked.is_empty() => {}
            None => return Err(nothing_in(view, *name).into()),
        }
    }
    Ok(contents)
}

fn content<'a>(view: &'a View<'a>, name: PanelName) -> Result<Option<Content<'a>>> {
    let lines = match name {
        PanelName::Map => return Ok(Some(Content::Map(view))),
        PanelName::Profiles => profiles::profiles(view)?,
        PanelName::Gauges => histories::gauges(view)?,
        PanelName::Ends => histories::ends(view)?,
        PanelName::Energy => histories::ledger(view)?,
        PanelName::FrontSpeeds => theory::speeds(view)?,
        PanelName::SelfSimilar => theory::similarity(view)?,
        PanelName::StressStrain => theory::path(view)?,
    };
    Ok(lines.map(Content::Lines))
}

fn nothing_in(view: &View, name: PanelName) -> InputError {
    let (panel, help) = match name {
        PanelName::Map | PanelName::Profiles => ("field", "no frame has been written yet"),
        PanelName::Gauges => ("gauge", "add `gauges` under [record] in the scene, and run it again"),
        PanelName::Ends => ("stress at an end", "both ends are free; try the field `velocity`"),
        PanelName::Energy => ("course of the energy", "it needs two rows of the ledger, and each frame has one"),
        PanelName::FrontSpeeds | PanelName::SelfSimilar => (
            "theoretical front",
            "it needs an end or a joint with a jump in velocity or stress at t = 0, and a finished run",
        ),
        PanelName::StressStrain => (
            "change of strain",
            "add gauges where the bar is strained, or `stress` and `strain` to `fields`, under [record]",
        ),
    };
    InputError::new(format!("{} has no {panel} to plot", view.file.path().display())).key("panels").help(help)
}

pub(super) fn view<'a>(file: &'a ResultFile, figure: &Figure) -> Result<View<'a>> {
    let time = file.time()?;
    let x = file.x()?;
    let fields = file.fields();
    let preferred = if fields.contains(&Field::Stress) { Some(Field::Stress) } else { fields.first().copied() };
    let Some(field) = figure.field.or(preferred) else {
        return Err(nothing(file, "no field was recorded").into());
    };
    if !fields.contains(&field) {
        let names: Vec<_> = fields.iter().map(|f| f.name()).collect();
        return Err(InputError::new(format!("{} has no field `{}`", file.path().display(), field.name()))
            .key("field")
            .allowed(names.join(", "))
            .help("add it to `fields` under [record] in the scene, and run it again")
            .into());
    }
    let (Some(&end_time), Some(&last)) = (time.last(), x.last()) else {
        return Err(nothing(file, "it has no frames yet").into());
    };
    // Samples are at cell centres: the bar ends half a cell beyond the last one.
    let half_cell = if x.len() > 1 { (last - x[x.len() - 2]) / 2.0 } else { last };
    let (asked, ruptures) = (figure.field.is_some(), file.ruptures()?);
    let (units, torsion) = (figure.units, file.is_in_torsion());
    Ok(View { file, field, asked, units, time, x, length: last + half_cell, end_time, ruptures, torsion })
}

fn nothing(file: &ResultFile, why: &str) -> InputError {
    InputError::new(format!("{} has nothing to plot: {why}", file.path().display()))
        .help("a run stopped before its first frame has no frames; run the scene again")
}

fn heading(metadata: &Metadata, units: Units) -> Heading {
    let mut parts = vec![format!("{} {}", metadata.method, metadata.scheme)];
    if let Some(cells) = metadata.cells.filter(|cells| *cells > 0) {
        parts.push(format!("{cells} cells"));
    }
    if let Some(events) = metadata.events.filter(|events| *events > 0) {
        parts.push(format!("{events} events"));
    }
    if !metadata.effects.is_empty() {
        parts.push(units.sentence(&metadata.effects.join(", ")));
    }
    parts.push(if metadata.is_unfinished() { "unfinished".into() } else { format!("outcome: {}", metadata.outcome) });
    if let Some(error) = &metadata.error {
        parts.push(format!("error {:.1e} ({})", error.value, error.reference));
    }
    Heading { title: metadata.title.clone(), about: parts.join("  \u{b7}  ") }
}
