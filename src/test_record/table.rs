//! Rows of strain and stress from the file of a record.

use std::path::Path;

use super::heading::{self, Heading, Kind};
use crate::columns::{self, Cell, Line, Table};
use crate::error::{Error, InputError, Result};
use crate::input::{Document, nearest};

/// Which columns of a record are meant, by name or number (from 1), in which units, and the specimen's dimensions.
#[derive(Debug, Clone, Default)]
pub struct Reading {
    /// The column of strain or extension; none: the one whose heading says so.
    pub abscissa: Option<(Kind, String)>,
    /// The column of stress or force.
    pub ordinate: Option<(Kind, String)>,
    /// Unit of the strains or extensions where the file names none.
    pub abscissa_unit: Option<String>,
    /// Unit of the stresses or forces where the file names none.
    pub ordinate_unit: Option<String>,
    /// Gauge length, m.
    pub gauge_length: Option<f64>,
    /// Initial area of the cross-section, m^2.
    pub area: Option<f64>,
}

/// Which units of a record are named by the file or the options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitsNamed {
    /// Of strains; extensions without a unit are metres.
    pub strain: bool,
    /// Of stresses or forces.
    pub stress: bool,
}

/// A record in the order of the test.
#[derive(Debug, Clone)]
pub struct Record {
    /// Name of the file.
    pub name: String,
    /// (strain, stress in Pa), with the signs of the file.
    pub rows: Vec<(f64, f64)>,
    /// What was read and how: columns, units, dimensions.
    pub columns: String,
    /// Which units the file or the options name.
    pub units_named: UnitsNamed,
    /// The headings say true strain and true stress.
    pub says_true: bool,
    document: Document,
    spans: Vec<std::ops::Range<usize>>,
}

impl Record {
    /// An error at a row (from 0) of the record.
    pub fn error(&self, row: usize, message: impl Into<String>) -> InputError {
        self.document.error(self.spans.get(row).cloned().unwrap_or(0..0), "", message)
    }
}

/// A chosen column.
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
/// A missing file, one without numbers, columns that are not there or not clear, an unknown unit, a cell that is not a number, dimensions
/// of the specimen that are missing or not needed.
pub fn read(path: &Path, reading: &Reading) -> Result<Record> {
    let (document, encoding) = Document::read_record(path)?;
    let mut table = columns::table(&document)?;
    let abscissa = choose(&document, &table, reading.abscissa.as_ref(), [Kind::Strain, Kind::Extension])?;
    let ordinate = choose(&document, &table, reading.ordinate.as_ref(), [Kind::Stress, Kind::Force])?;
    if abscissa.1 == ordinate.1 {
        let message = format!("column {} is named twice", abscissa.1 + 1);
        return Err(document.error(0..0, "", message).help("name two different columns").into());
    }
    let abscissa = unit(&document, &table, abscissa, reading.abscissa_unit.as_deref(), "--strain-unit")?;
    let ordinate = unit(&document, &table, ordinate, reading.ordinate_unit.as_deref(), "--unit")?;
    let strain =
        abscissa.size / divisor(&abscissa, reading.gauge_length, Kind::Extension, "--gauge-length", "gauge length")?;
    let stress = ordinate.size / divisor(&ordinate, reading.area, Kind::Force, "--area", "cross-section")?;
    keep(&document, &mut table.rows, [abscissa.place, ordinate.place])?;
    let (mut rows, mut spans) = (Vec::new(), Vec::new());
    for line in &table.rows {
        rows.push((number(&document, &line.cells[0])? * strain, number(&document, &line.cells[1])? * stress));
        spans.push(line.span.clone());
    }
    let says_true = [&abscissa, &ordinate].iter().all(|column| is_true(&column.title));
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let encoded = encoding.map_or_else(String::new, |encoding| format!("; the text is {encoding}"));
    let columns = describe(&table, &abscissa, &ordinate) + &encoded;
    let units_named = UnitsNamed { strain: abscissa.named || abscissa.kind == Kind::Extension, stress: ordinate.named };
    Ok(Record { name, rows, columns, units_named, says_true, document, spans })
}

fn is_true(title: &str) -> bool {
    title.to_lowercase().split(|c: char| !c.is_alphabetic()).any(|word| word == "true")
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
    format!("{} rows, {} and {}{preamble}", table.rows.len(), title(abscissa), title(ordinate))
}

/// The column of one of two kinds: the one that is asked for, or the one whose heading says so. Without headings the columns are strain
/// and stress.
fn choose(
    document: &Document,
    table: &Table,
    asked: Option<&(Kind, String)>,
    kinds: [Kind; 2],
) -> Result<(Kind, usize)> {
    if let Some((kind, name)) = asked {
        return Ok((*kind, by_name(document, table, name, *kind)?));
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
    for kind in kinds {
        let of_kind: Vec<usize> =
            (0..header.cells.len()).filter(|k| heading::kind(&whole(table, *k)) == Some(kind)).collect();
        let engineering: Vec<usize> = of_kind.iter().copied().filter(|k| !is_true(&header.cells[*k].text)).collect();
        match (of_kind.as_slice(), engineering.as_slice()) {
            ([], _) => {}
            ([one], _) | (_, [one]) => return Ok((kind, *one)),
            (many, _) => {
                let message = format!("{} columns of {}: {}", many.len(), kind.name(), titles(header, many));
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

fn titles(header: &Line, places: &[usize]) -> String {
    places.iter().map(|k| format!("`{}`", header.cells[*k].text)).collect::<Vec<_>>().join(", ")
}

/// A heading with the unit of the line below, if it has none of its own.
fn whole(table: &Table, place: usize) -> Heading {
    let title = table.header.as_ref().and_then(|line| line.cells.get(place)).map_or("", |cell| cell.text.as_str());
    let mut heading = heading::split(title);
    if heading.unit.is_empty() {
        table.unit_below(place).clone_into(&mut heading.unit);
    }
    heading
}

/// The place of a column by its number or heading, with or without the unit, in any case.
fn by_name(document: &Document, table: &Table, name: &str, kind: Kind) -> Result<usize> {
    let key = format!("--{}-column", kind.name());
    if let Ok(number) = name.trim().parse::<usize>() {
        return if (1..=table.width).contains(&number) {
            Ok(number - 1)
        } else {
            let message = format!("there is no column {number}");
            let error = InputError::new(message).key(key).allowed(format!("1 to {}", table.width));
            Err(error.help("columns are counted from 1").into())
        };
    }
    let Some(header) = &table.header else {
        let error = InputError::new(format!("`{name}`: {} has no headings", document.file)).key(key);
        return Err(error.help("name the column by its number, from 1").into());
    };
    let wanted = name.trim().to_lowercase();
    let matches = |k: &usize| {
        let full = header.cells[*k].text.to_lowercase();
        full == wanted || whole(table, *k).name.to_lowercase() == wanted
    };
    let found: Vec<usize> = (0..header.cells.len()).filter(matches).collect();
    let all: Vec<usize> = (0..header.cells.len()).collect();
    match found.as_slice() {
        [one] => Ok(*one),
        [] => {
            let near = nearest(name, header.cells.iter().map(|cell| cell.text.as_str()));
            let help =
                near.map_or("name a heading, or a number from 1".into(), |near| format!("did you mean `{near}`?"));
            let error = InputError::new(format!("there is no column `{name}` in {}", document.file)).key(key);
            Err(error.allowed(titles(header, &all)).help(help).into())
        }
        many => {
            let message = format!("{} columns are called `{name}`", many.len());
            Err(InputError::new(message).key(key).help("name the column by its number, from 1").into())
        }
    }
}

/// The column with the SI size of its unit.
fn unit(
    document: &Document,
    table: &Table,
    (kind, place): (Kind, usize),
    given: Option<&str>,
    option: &str,
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
            let message = format!("the unit of {} is given twice: `{title}` and {option}", kind.name());
            return Err(document.error(span(), "", message).help(format!("remove {option}")).into());
        }
        if let Some(size) = heading::size(&stated.unit, kind) {
            return Ok(column(size, true));
        }
        if given.is_none() {
            let message = format!("`{}` is not a unit of {}", stated.unit, kind.name());
            let help = format!("write a unit such as {example} in the heading, or name it with {option}");
            return Err(document.error(span(), "", message).help(help).into());
        }
    }
    let Some(given) = given else { return Ok(column(1.0, false)) };
    heading::size(given, kind).map(|size| column(size, true)).ok_or_else(|| {
        let message = format!("`{given}` is not a unit of {}", kind.name());
        InputError::new(message).key(option).help(format!("write a unit such as {example}")).into()
    })
}

/// What turns an extension into a strain, or a force into a stress; 1 where the column is one already.
fn divisor(column: &Column, given: Option<f64>, needs: Kind, option: &str, what: &str) -> Result<f64> {
    match (column.kind == needs, given) {
        (true, Some(value)) => Ok(value),
        (false, None) => Ok(1.0),
        (true, None) => {
            let error = InputError::new(format!("{} needs the {what} of the specimen", needs.name())).key(option);
            let help = if needs == Kind::Force {
                "e.g. --area \"28.3 mm^2\" or --diameter \"6 mm\""
            } else {
                "e.g. --gauge-length \"25 mm\""
            };
            Err(error.help(help).into())
        }
        (false, Some(_)) => {
            let message = format!("the record holds {}, which needs no {what}", column.kind.name());
            Err(InputError::new(message)
                .key(option)
                .help(format!("remove it, or give the column with --{}-column", needs.name()))
                .into())
        }
    }
}

/// Keeps two cells of each row, with decimal points.
fn keep(document: &Document, rows: &mut [Line], places: [usize; 2]) -> Result<()> {
    let needed = places[0].max(places[1]);
    for row in rows.iter_mut() {
        if needed >= row.cells.len() {
            let message = format!("this line has {} columns", row.cells.len());
            let help =
                "remove the line, or complete it; if commas mark the decimals, separate the columns by semicolons";
            let error =
                document.error(row.span.clone(), "", message).allowed(format!("at least {} columns", needed + 1));
            return Err(error.help(help).into());
        }
        row.cells = places.map(|place| row.cells[place].clone()).to_vec();
    }
    columns::decimal_commas(document, &mut rows.iter_mut().flat_map(|row| &mut row.cells).collect::<Vec<_>>())
}

fn number(document: &Document, cell: &Cell) -> Result<f64> {
    let text = cell.text.replace('\u{2212}', "-");
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
        let message = if text.is_empty() { "the cell is empty".into() } else { format!("`{text}` is not a number") };
        Error::from(document.error(cell.span.clone(), "", message).help("remove the line, or correct the number"))
    })
}
