//! Reading of rows of strain and stress from the file of a record.

use std::path::Path;

use super::heading::{self, Heading, Kind, Place};
use crate::columns::{self, Cell, Line, Table};
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::material::Measure;

/// Selection of the columns of a record, by heading or number (from 1), their units, and the dimensions of the specimen.
#[derive(Debug, Clone, Default)]
pub struct Reading {
    /// Column of strain or extension; `None`: the one identified by its heading.
    pub abscissa: Option<(Kind, String)>,
    /// Column of stress or force; `None`: the one identified by its heading.
    pub ordinate: Option<(Kind, String)>,
    /// Unit of the strains or extensions if the file states none.
    pub abscissa_unit: Option<String>,
    /// Unit of the stresses or forces if the file states none.
    pub ordinate_unit: Option<String>,
    /// Gauge length, m.
    pub gauge_length: Option<f64>,
    /// Initial area of the cross-section, m^2.
    pub area: Option<f64>,
    /// Measure of strains and stresses; `None`: the one stated in the headings.
    pub measure: Option<Measure>,
}

/// Whether the file or the options state the units of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitsNamed {
    /// Whether the unit of strains is stated; extensions without a unit are in metres.
    pub strain: bool,
    /// Whether the unit of stresses or forces is stated.
    pub stress: bool,
}

/// A record in the order of the test.
#[derive(Debug, Clone)]
pub struct Record {
    /// Name of the file.
    pub name: String,
    /// Rows (strain, stress in Pa), with the signs of the file.
    pub rows: Vec<(f64, f64)>,
    /// Description of what was read: columns, units, dimensions.
    pub columns: String,
    /// Whether the file or the options state the units.
    pub units_named: UnitsNamed,
    /// Measure stated in the headings; `None` if they state none.
    pub measure: Option<Measure>,
    /// Heading of the strains or extensions if it says that they are those of the crosshead.
    pub machine: Option<String>,
    /// Heading of a column of shear, if there is one.
    pub shear: Option<String>,
    document: Document,
    spans: Vec<std::ops::Range<usize>>,
}

impl Record {
    /// Creates an error at a row (from 0) of the record.
    pub fn error(&self, row: usize, message: impl Into<String>) -> InputError {
        self.document.error(self.spans.get(row).cloned().unwrap_or(0..0), "", message)
    }
}

/// A selected column.
struct Column {
    kind: Kind,
    place: usize,
    title: String,
    size: f64,
    named: bool,
}

/// Reads a record.
///
/// # Errors
/// The file is missing or has no numbers, columns are missing or ambiguous, a unit is unknown, a cell is not a number, or dimensions of the
/// specimen are missing or not needed.
pub fn read(path: &Path, reading: &Reading) -> Result<Record> {
    let (document, encoding) = Document::read_record(path)?;
    let mut table = columns::table(&document)?;
    let [abscissa, ordinate] = pair(&document, &table, reading)?;
    if abscissa.1 == ordinate.1 {
        let message = format!("column {} is named twice", abscissa.1 + 1);
        return Err(document.error(0..0, "", message).help("name two different columns").into());
    }
    let abscissa = unit(&document, &table, abscissa, reading.abscissa_unit.as_deref(), "abscissa_unit")?;
    let ordinate = unit(&document, &table, ordinate, reading.ordinate_unit.as_deref(), "ordinate_unit")?;
    let strain =
        abscissa.size / divisor(&abscissa, reading.gauge_length, Kind::Extension, "gauge_length", "gauge length")?;
    let stress = ordinate.size / divisor(&ordinate, reading.area, Kind::Force, "area", "cross-section")?;
    table.keep(&document, [abscissa.place, ordinate.place])?;
    let (mut rows, mut spans) = (Vec::new(), Vec::new());
    for line in &table.rows {
        rows.push((number(&document, &line.cells[0])? * strain, number(&document, &line.cells[1])? * stress));
        spans.push(line.span.clone());
    }
    let measure = measure(&document, &table, [&abscissa, &ordinate], reading)?;
    let machine = (heading::place(&abscissa.title) == Place::Machine).then(|| abscissa.title.clone());
    let shear = [&abscissa, &ordinate].into_iter().find(|column| heading::is_shear(&column.title));
    let shear = shear.map(|column| column.title.clone());
    let name = name(path);
    let encoded = encoding.map_or_else(String::new, |encoding| format!("; the text is {encoding}"));
    let columns = describe(&table, &abscissa, &ordinate) + &encoded;
    let units_named = UnitsNamed { strain: abscissa.named || abscissa.kind == Kind::Extension, stress: ordinate.named };
    Ok(Record { name, rows, columns, units_named, measure, machine, shear, document, spans })
}

/// Returns the name of a record: that of its file, without the folder.
pub fn name(path: &Path) -> String {
    if path == Path::new("-") {
        return "standard input".into();
    }
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

const ABSCISSA: [Kind; 2] = [Kind::Strain, Kind::Extension];
const ORDINATE: [Kind; 2] = [Kind::Stress, Kind::Force];

/// Returns the columns of strain and stress. Engineering values are preferred, unless only one of the two has them.
fn pair(document: &Document, table: &Table, reading: &Reading) -> Result<[(Kind, usize); 2]> {
    let both = |prefer: Measure| -> Result<[(Kind, usize); 2]> {
        Ok([
            choose(document, table, reading.abscissa.as_ref(), ABSCISSA, prefer)?,
            choose(document, table, reading.ordinate.as_ref(), ORDINATE, prefer)?,
        ])
    };
    let title =
        |place: usize| table.header.as_ref().and_then(|line| line.cells.get(place)).map_or("", |cell| &cell.text);
    let are_true = |columns: &[(Kind, usize); 2]| {
        columns.iter().filter(|(kind, place)| heading::measure(title(*place), *kind) == Some(Measure::True)).count()
    };
    let columns = both(reading.measure.unwrap_or_default())?;
    if are_true(&columns) != 1 {
        return Ok(columns);
    }
    Ok(both(Measure::True).ok().filter(|others| are_true(others) == 2).unwrap_or(columns))
}

/// Returns the measure stated in the headings of the two columns; `None` if they state none. If only one heading states true values, the measure is
/// ambiguous, which is an error: some programs label strains as true beside engineering stresses.
fn measure(document: &Document, table: &Table, columns: [&Column; 2], reading: &Reading) -> Result<Option<Measure>> {
    if reading.measure == Some(Measure::True) {
        on_current_dimensions(columns)?;
    }
    let [strain, stress] = columns.map(|column| heading::measure(&column.title, column.kind));
    let one_is_true = [strain, stress].contains(&Some(Measure::True)) && strain != stress;
    if reading.measure.is_some() || !one_is_true {
        return Ok(strain.or(stress));
    }
    let span = table.header.as_ref().map_or(0..0, |header| header.span.clone());
    let message = format!("only one of `{}` and `{}` is named as true", columns[0].title, columns[1].title);
    let help = "state the measure of both, true or engineering, or convert one of the columns";
    Err(document.error(span, "measure", message).allowed("both engineering or both true").help(help).into())
}

/// Rejects true values in columns that are divided by the initial gauge length or cross-section.
fn on_current_dimensions(columns: [&Column; 2]) -> Result<()> {
    let divided = |column: &&Column| matches!(column.kind, Kind::Extension | Kind::Force);
    let Some(column) = columns.into_iter().find(divided) else { return Ok(()) };
    let what = match column.kind {
        Kind::Force => "a force over the initial cross-section",
        _ => "an extension over the initial gauge length",
    };
    let message = format!("`{}` is {what}: an engineering value", column.title);
    let error = InputError::new(message).key("measure").allowed("columns of true strain and true stress");
    Err(error.help("leave the measure out").into())
}

fn describe(table: &Table, abscissa: &Column, ordinate: &Column) -> String {
    let title = |column: &Column| match column.title.as_str() {
        "" => format!("{} (column {})", column.kind.name(), column.place + 1),
        title => format!("{} `{title}`", column.kind.name()),
    };
    let preamble = match table.preamble {
        0 => String::new(),
        1 => "; 1 line before the header ignored".into(),
        lines => format!("; {lines} lines before the header ignored"),
    };
    let others = [not_used(table, ABSCISSA, abscissa.place), not_used(table, ORDINATE, ordinate.place)].concat();
    let others = if others.is_empty() { String::new() } else { format!("; not used: {}", others.join(", ")) };
    format!("{} rows, {} and {}{others}{preamble}", table.rows.len(), title(abscissa), title(ordinate))
}

/// Returns the column of one of two kinds: the requested one, or the one identified by its heading. Without headings the two columns are strain and
/// stress.
fn choose(
    document: &Document,
    table: &Table,
    asked: Option<&(Kind, String)>,
    kinds: [Kind; 2],
    prefer: Measure,
) -> Result<(Kind, usize)> {
    if let Some((kind, name)) = asked {
        let key = format!("--{}-column", kind.name());
        return Ok((*kind, table.column(document, name, &key, |title| heading::split(title).name)?));
    }
    let option = format!("--{}-column or --{}-column", kinds[0].name(), kinds[1].name());
    let Some(header) = &table.header else {
        let place = usize::from(kinds[0] == Kind::Stress);
        if table.width == 2 {
            return Ok((kinds[0], place));
        }
        let message =
            format!("{} columns without headings: which is {} or {}?", table.width, kinds[0].name(), kinds[1].name());
        let help = format!("name the column by its number (from 1) with {option}");
        return Err(document.error(table.rows[0].span.clone(), "", message).help(help).into());
    };
    for group in groups(table, header, kinds) {
        match narrowed(header, &group, prefer).as_slice() {
            [] => {}
            [one] => return Ok(*one),
            many => {
                let (kind, places) = (many[0].0, many.iter().map(|column| column.1).collect::<Vec<_>>());
                let message = format!("{} columns of {}: {}", many.len(), kind.name(), titles(header, &places));
                let help = format!("name one of them with --{}-column", kind.name());
                return Err(document.error(header.span.clone(), "", message).help(help).into());
            }
        }
    }
    let all: Vec<usize> = (0..header.cells.len()).collect();
    let message = format!("no column of {} or {}", kinds[0].name(), kinds[1].name());
    let help = format!("name the column by its heading or number with {option}");
    Err(document.error(header.span.clone(), "", message).allowed(titles(header, &all)).help(help).into())
}

/// Returns the columns of two kinds in order of preference: the first kind before the second, but an extensometer before the strain of a crosshead.
fn groups(table: &Table, header: &Line, kinds: [Kind; 2]) -> [Vec<(Kind, usize)>; 4] {
    let of_kind = |kind: Kind, wanted: &dyn Fn(Place) -> bool| {
        let fits = |k: &usize| {
            heading::kind(&whole(table, *k)) == Some(kind) && wanted(heading::place(&header.cells[*k].text))
        };
        (0..header.cells.len()).filter(fits).map(|k| (kind, k)).collect()
    };
    [
        of_kind(kinds[0], &|place| place != Place::Machine),
        of_kind(kinds[1], &|place| place == Place::Specimen),
        of_kind(kinds[0], &|_| true),
        of_kind(kinds[1], &|_| true),
    ]
}

/// Returns, of several columns of one kind, those of an extensometer if there are any, and of these the ones that are not of the other measure.
fn narrowed(header: &Line, columns: &[(Kind, usize)], prefer: Measure) -> Vec<(Kind, usize)> {
    let title = |column: &(Kind, usize)| header.cells[column.1].text.as_str();
    let specimen = |column: &&(Kind, usize)| heading::place(title(column)) == Place::Specimen;
    let best: Vec<_> = columns.iter().filter(specimen).copied().collect();
    let best = if best.is_empty() { columns.to_vec() } else { best };
    let [same, other]: [Vec<_>; 2] = [true, false].map(|same| {
        let measure = |column: &&(Kind, usize)| heading::measure(title(column), column.0);
        let fits = |column: &&(Kind, usize)| measure(column).is_some_and(|measure| (measure == prefer) == same);
        best.iter().filter(fits).copied().collect()
    });
    let neutral: Vec<_> =
        best.iter().filter(|column| !same.contains(column) && !other.contains(column)).copied().collect();
    // A heading without a measure next to one of true values denotes engineering values.
    let order =
        if prefer == Measure::True { [same, neutral, other] } else { [[same, neutral].concat(), other, Vec::new()] };
    order.into_iter().find(|columns| !columns.is_empty()).unwrap_or_default()
}

/// Returns the headings of the other columns of two kinds, which could have been meant.
fn not_used(table: &Table, kinds: [Kind; 2], taken: usize) -> Vec<String> {
    let Some(header) = &table.header else { return Vec::new() };
    let other = |k: &usize| *k != taken && heading::kind(&whole(table, *k)).is_some_and(|kind| kinds.contains(&kind));
    (0..header.cells.len()).filter(other).map(|k| format!("`{}`", header.cells[k].text)).collect()
}

fn titles(header: &Line, places: &[usize]) -> String {
    places.iter().map(|k| format!("`{}`", header.cells[*k].text)).collect::<Vec<_>>().join(", ")
}

/// Returns a heading, with the unit of the line below if it has none of its own.
fn whole(table: &Table, place: usize) -> Heading {
    let title = table.header.as_ref().and_then(|line| line.cells.get(place)).map_or("", |cell| cell.text.as_str());
    let mut heading = heading::split(title);
    let below = !table.unit_below(place).is_empty() && !heading::is_unit(&heading.unit);
    if heading.unit.is_empty() || below {
        table.unit_below(place).clone_into(&mut heading.unit);
    }
    heading
}

/// Returns a column with the SI value of its unit.
fn unit(
    document: &Document,
    table: &Table,
    (kind, place): (Kind, usize),
    given: Option<&str>,
    argument: &str,
) -> Result<Column> {
    let stated = whole(table, place);
    let title = table.header.as_ref().and_then(|h| h.cells.get(place)).map_or(String::new(), |cell| cell.text.clone());
    let span = || table.header.as_ref().map_or(0..0, |header| header.cells[place].span.clone());
    let column = |size, named| Column { kind, place, title: title.clone(), size, named };
    let example = match kind {
        Kind::Strain => "%",
        Kind::Extension => "mm",
        Kind::Stress => "MPa",
        Kind::Force => "kN",
    };
    if !stated.unit.is_empty() {
        if given.is_some() && heading::size(&stated.unit, kind).is_some() {
            let message =
                format!("the unit of {} is given twice: in the heading `{title}`, and beside it", kind.name());
            return Err(document.error(span(), argument, message).help("leave out the one beside it").into());
        }
        if let Some(size) = heading::size(&stated.unit, kind) {
            return Ok(column(size, true));
        }
        if given.is_none() {
            let message = format!("`{}` is not a unit of {}", stated.unit, kind.name());
            let help = heading::most_like(&stated.unit, kind).map_or_else(
                || format!("write a unit such as {example} in the heading, or give it beside the record"),
                |near| format!("did you mean `{near}`? Write it in the heading, or give it beside the record"),
            );
            return Err(document.error(span(), argument, message).help(help).into());
        }
    }
    let Some(given) = given else { return Ok(column(1.0, false)) };
    heading::size(given, kind).map(|size| column(size, true)).ok_or_else(|| {
        let message = format!("`{given}` is not a unit of {}", kind.name());
        let help = heading::most_like(given, kind)
            .map_or_else(|| format!("write a unit such as {example}"), |near| format!("did you mean `{near}`?"));
        InputError::new(message).key(argument).help(help).into()
    })
}

/// Returns the divisor that converts an extension to a strain, or a force to a stress; 1 if the column is one already.
fn divisor(column: &Column, given: Option<f64>, needs: Kind, argument: &str, what: &str) -> Result<f64> {
    match (column.kind == needs, given) {
        (true, Some(value)) => Ok(value),
        (false, None) => Ok(1.0),
        (true, None) => {
            let error = InputError::new(format!("{} needs the {what} of the specimen", needs.name())).key(argument);
            Err(error.help(format!("give the {what}")).into())
        }
        (false, Some(_)) => {
            let message = format!("the record holds {}, which needs no {what}", column.kind.name());
            Err(InputError::new(message)
                .key(argument)
                .help(format!("leave it out, or name the column of the {}", needs.name()))
                .into())
        }
    }
}

fn number(document: &Document, cell: &Cell) -> Result<f64> {
    let text = cell.text.replace('\u{2212}', "-");
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
        let message = format!("`{text}` is not a number");
        Error::from(document.error(cell.span.clone(), "", message).help("remove the line, or correct the number"))
    })
}
