//! Result of an impact without waves in a bar: figures, histories and deflected shapes in one group.

use std::path::Path;

use hdf5::Group;

use super::attributes::{describe, get, get_text, put, put_quantity, put_text, text};
use super::claim::in_place;
use super::create::{build_materials, build_root};
use super::figures::{StoredFigure, scalars};
use super::scales::attach;
use super::{Header, MaterialRecord, ResultFile, bounded};
use crate::error::{InputError, Result};
use crate::impact::{Figure, Shapes, Solution, Table};

type Hdf<T> = hdf5::Result<T>;

/// Root attribute that contains the name of the group.
const GROUP: &str = "impact";

/// Writes a result file with the root attributes of every result file, the materials, and the result in a group named `kind`.
///
/// # Errors
/// [`crate::error::Error::File`] if the file cannot be created or replaced; an older file is then unchanged.
pub fn write_impact(
    path: &Path,
    header: &Header,
    materials: &[MaterialRecord],
    (kind, solution): (&str, &Solution),
    wall_seconds: f64,
) -> Result<()> {
    in_place(path, |file| -> Hdf<()> {
        build_root(file, header, true)?;
        put_text(file, GROUP, kind)?;
        build_materials(file, materials, false)?;
        let group = file.create_group(kind)?;
        put_text(&group, "equation", &solution.equation)?;
        put_text(&group, "validity", &solution.validity)?;
        write_figures(&group, &solution.figures)?;
        solution.tables.iter().try_for_each(|table| write_table(&group, table))?;
        for (name, figures) in &solution.gauges {
            let group = group_at(&group, &format!("gauges/{name}"))?;
            write_figures(&group, figures)?;
        }
        solution.shapes.iter().try_for_each(|shapes| write_shapes(&group, shapes))?;
        put_quantity(file, "wall_seconds", wall_seconds, "s")?;
        put(file, "cell_steps", &0_u64)?;
        file.attr("outcome")?.write_scalar(&text(solution.outcome)?)
    })
    .map(|_| ())
}

/// Writes the figures that have a value, with their order as an attribute, because groups list their links by name.
fn write_figures(group: &Group, figures: &[Figure]) -> Hdf<()> {
    for (index, figure) in (0_u32..).zip(figures).filter(|(_, figure)| figure.value.is_finite()) {
        let dataset = group.new_dataset::<f64>().create(figure.name)?;
        dataset.write_scalar(&figure.value)?;
        describe(&dataset, &figure.dimension.units(), figure.long_name)?;
        put(&dataset, "index", &index)?;
    }
    Ok(())
}

/// Returns the group at a path; missing groups are created.
fn group_at(group: &Group, path: &str) -> Hdf<Group> {
    path.split('/').try_fold(group.clone(), |group, name| {
        if group.link_exists(name) { group.group(name) } else { group.create_group(name) }
    })
}

fn write_table(group: &Group, table: &Table) -> Hdf<()> {
    let group = group_at(group, &table.path)?;
    for (index, column) in (0_u32..).zip(&table.columns) {
        let dataset = group.new_dataset::<f64>().shape(column.values.len()).create(column.name)?;
        dataset.write_raw(&column.values)?;
        describe(&dataset, &column.dimension.units(), column.long_name)?;
        put_text(&dataset, "panel", column.panel)?;
        put(&dataset, "index", &index)?;
    }
    if let Some(x) = table.x {
        put_quantity(&group, "x", x, "m")?;
    }
    let names: Vec<&str> = table.columns.iter().map(|column| column.name).collect();
    let (scale, data) = names.split_at(1);
    attach(&group, scale, data)
}

fn write_shapes(group: &Group, shapes: &Shapes) -> Hdf<()> {
    let group = group.create_group("shapes")?;
    let axes = [
        ("time", "s", "time since the first contact", &shapes.time),
        ("x", "m", "distance from the left support", &shapes.x),
    ];
    for (name, unit, long_name, values) in axes {
        let dataset = group.new_dataset::<f64>().shape(values.len()).create(name)?;
        dataset.write_raw(values)?;
        describe(&dataset, unit, long_name)?;
    }
    let shape = (shapes.time.len(), shapes.x.len());
    let dataset = group.new_dataset::<f64>().shape(shape).create("deflection")?;
    dataset.write_raw(&shapes.deflection)?;
    describe(&dataset, "m", "deflection of the beam")?;
    attach(&group, &["time", "x"], &["deflection"])
}

/// Column as read from a file.
#[derive(Debug, Clone)]
pub struct StoredColumn {
    /// Unit of the values.
    pub units: String,
    /// Description.
    pub long_name: String,
    /// Title of the panel in which the column is drawn; empty if it is not drawn.
    pub panel: String,
    /// Values in SI units.
    pub values: Vec<f64>,
}

/// Table as read from a file; the first column is the scale of the others.
#[derive(Debug, Clone)]
pub struct StoredTable {
    /// Name of the group.
    pub name: String,
    /// Position of the table, m, if it belongs to one place.
    pub x: Option<f64>,
    /// All columns.
    pub columns: Vec<StoredColumn>,
}

/// Result of an impact as read from a file.
#[derive(Debug, Clone)]
pub struct StoredImpact {
    /// Kind of the impact: "spheres", "plate", "beam" or "energy".
    pub kind: String,
    /// Equations used; empty if the file does not contain them.
    pub equation: String,
    /// Range of validity of the equations.
    pub validity: String,
    /// Figures; the description of a gauge's figure starts with the name of the gauge.
    pub figures: Vec<StoredFigure>,
    /// Histories.
    pub tables: Vec<StoredTable>,
    /// Deflected shapes, if there are any.
    pub shapes: Option<Shapes>,
}

impl StoredImpact {
    /// Returns true if there are histories or shapes besides the figures.
    pub fn has_histories(&self) -> bool {
        self.shapes.is_some() || self.tables.iter().flat_map(|t| &t.columns).any(|column| !column.panel.is_empty())
    }
}

impl ResultFile {
    /// Refuses the result of an impact without waves in a bar.
    ///
    /// # Errors
    /// An [`InputError`] that states the kind of the impact.
    pub fn needs_bar(&self) -> Result<()> {
        let Ok(Ok(kind)) = self.run(|file| Ok(get_text(file, GROUP))) else { return Ok(()) };
        let message = format!(
            "{}: the file holds an impact of the kind `{kind}`, without fields along a bar",
            self.path().display()
        );
        Err(InputError::new(message)
            .allowed("results of scenes with a [bar] that are run with waves")
            .help("`barwave report` draws this file")
            .into())
    }

    /// Returns the result of an impact without waves in a bar; `None` for the file of a bar.
    ///
    /// # Errors
    /// An error if the file cannot be read.
    pub fn impact(&self) -> Result<Option<StoredImpact>> {
        self.run(|file| {
            let Ok(kind) = get_text(file, GROUP) else { return Ok(None) };
            file.group(&kind).and_then(|group| read(kind, &group)).map(Some)
        })
    }
}

fn read(kind: String, group: &Group) -> Hdf<StoredImpact> {
    let sentence = |name| get_text(group, name).unwrap_or_default();
    let mut figures = scalars(group)?;
    let mut tables = Vec::new();
    for (parent, prefix) in [("contact", ""), ("gauges", "*"), ("ledger", "")] {
        if !group.link_exists(parent) {
            continue;
        }
        let parent = group.group(parent)?;
        if prefix.is_empty() {
            tables.push(read_table(&parent)?);
        } else {
            let groups = parent.groups()?;
            let mut gauges = groups.iter().map(read_table).collect::<Hdf<Vec<_>>>()?;
            for (group, table) in groups.iter().zip(&gauges) {
                let of_gauge = |figure: StoredFigure| StoredFigure {
                    long_name: format!("gauge {}: {}", table.name, figure.long_name),
                    ..figure
                };
                figures.extend(scalars(group)?.into_iter().map(of_gauge));
            }
            gauges.sort_by(|a, b| a.x.unwrap_or(0.0).total_cmp(&b.x.unwrap_or(0.0)));
            tables.extend(gauges);
        }
    }
    let shapes =
        group.link_exists("shapes").then(|| group.group("shapes").and_then(|g| read_shapes(&g))).transpose()?;
    Ok(StoredImpact { kind, equation: sentence("equation"), validity: sentence("validity"), figures, tables, shapes })
}

fn read_table(group: &Group) -> Hdf<StoredTable> {
    let mut columns = Vec::new();
    for dataset in group.datasets()?.into_iter().filter(|dataset| !dataset.is_scalar()) {
        let column = StoredColumn {
            units: get_text(&dataset, "units")?,
            long_name: get_text(&dataset, "long_name")?,
            panel: get_text(&dataset, "panel")?,
            values: bounded::column(&dataset)?,
        };
        columns.push((get::<u32>(&dataset, "index")?, column));
    }
    // Groups list their links by name.
    columns.sort_by_key(|(index, _)| *index);
    let columns = columns.into_iter().map(|(_, column)| column).collect();
    let name = group.name().rsplit('/').next().unwrap_or_default().to_owned();
    Ok(StoredTable { name, x: get(group, "x").ok(), columns })
}

fn read_shapes(group: &Group) -> Hdf<Shapes> {
    let column = |name| group.dataset(name).and_then(|dataset| bounded::column(&dataset));
    let deflection = group.dataset("deflection")?;
    bounded::check(&deflection)?;
    Ok(Shapes { time: column("time")?, x: column("x")?, deflection: deflection.read_raw()? })
}
