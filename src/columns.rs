//! Reading of delimited text as spreadsheets and instruments write it: files of two columns (`read`), and tables with any number of columns, a
//! preamble and units (`table`).
//!
//! The delimiter is the one of semicolon, tab, comma and blanks that separates most lines into columns. If the delimiter is a semicolon, a tab or
//! blanks, and inside quotes, a comma is the decimal mark unless it can be a separator of thousands. Empty lines and lines that start with `#` are
//! skipped. A first line without numbers is a header. Empty columns after the second are ignored. Other lines may precede the header of a table,
//! and a line of units may follow it; a comment just above the numbers that names every column is also a header.

use std::ops::Range;

use crate::error::{InputError, Result};
use crate::input::{Document, nearest};
use crate::units::{Dimension, in_heading, one, split as split_heading};

/// A cell with its byte range in the text. The decimal mark of numbers is a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cell {
    pub(crate) text: String,
    pub(crate) span: Range<usize>,
}

/// A line with two cells and its byte range.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) cells: [Cell; 2],
    pub(crate) span: Range<usize>,
}

/// The header and the rows of a file with two columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Columns {
    pub(crate) header: Option<Row>,
    pub(crate) rows: Vec<Row>,
}

/// A line with any number of cells and its byte range.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    pub(crate) cells: Vec<Cell>,
    pub(crate) span: Range<usize>,
}

/// A table with any number of columns. Its cells hold the text of the file; decimal commas are not yet replaced.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Table {
    pub(crate) header: Option<Line>,
    /// Line of units below the header.
    pub(crate) units: Option<Line>,
    pub(crate) rows: Vec<Line>,
    /// Number of columns in most rows.
    pub(crate) width: usize,
    /// Number of lines before the header, which are ignored.
    pub(crate) preamble: usize,
    delimiter: char,
}

impl Table {
    /// Returns the unit of a column from the line below the header; empty if there is none.
    pub(crate) fn unit_below(&self, column: usize) -> &str {
        let cell = self.units.as_ref().and_then(|line| line.cells.get(column));
        cell.map_or("", |cell| cell.text.trim_matches(['(', ')', '[', ']']))
    }

    /// Returns the index of the column with this number (from 1) or heading (in any case). `name_of` removes the unit from a heading; `key` is the
    /// key that named the column, for messages.
    ///
    /// # Errors
    /// There is no such column, or several have this heading.
    pub(crate) fn column(
        &self,
        document: &Document,
        name: &str,
        key: &str,
        name_of: impl Fn(&str) -> String,
    ) -> std::result::Result<usize, InputError> {
        let error = |message: String| InputError::new(message).key(key);
        if let Ok(number) = name.trim().parse::<usize>() {
            let missing = || error(format!("there is no column {number} in {}", document.file));
            let allowed = || missing().allowed(format!("1 to {}", self.width)).help("columns are counted from 1");
            return (1..=self.width).contains(&number).then(|| number - 1).ok_or_else(allowed);
        }
        let Some(header) = &self.header else {
            let help = "name the column by its number, from 1";
            return Err(error(format!("`{name}`: {} has no headings", document.file)).help(help));
        };
        let wanted = name.trim().to_lowercase();
        let titles = || header.cells.iter().map(|cell| cell.text.as_str());
        let is_wanted = |title: &str| title.to_lowercase() == wanted || name_of(title).to_lowercase() == wanted;
        let found: Vec<usize> = titles().enumerate().filter(|(_, title)| is_wanted(title)).map(|(k, _)| k).collect();
        match found.as_slice() {
            [one] => Ok(*one),
            [] => {
                let near = nearest(name, titles()).map(|near| format!("did you mean `{near}`?"));
                let all = titles().map(|title| format!("`{title}`")).collect::<Vec<_>>().join(", ");
                let help = near.unwrap_or_else(|| "name a heading, or a number from 1".into());
                Err(error(format!("there is no column `{name}` in {}", document.file)).allowed(all).help(help))
            }
            many => {
                let help = "name the column by its number, from 1";
                Err(error(format!("{} columns are called `{name}`", many.len())).help(help))
            }
        }
    }

    /// Keeps these two columns of every row and replaces their decimal commas by points.
    ///
    /// # Errors
    /// A row lacks one of the columns or has more cells than the header, or the meaning of a comma in a number is ambiguous.
    pub(crate) fn keep(&mut self, document: &Document, places: [usize; 2]) -> Result<()> {
        self.within_header(document)?;
        let needed = places[0].max(places[1]);
        for row in &mut self.rows {
            let empty = places.into_iter().find(|&place| is_empty(document, row, place, self.delimiter));
            if let Some(place) = empty {
                return Err(empty_cell(document, row, place, self.header.as_ref()).into());
            }
            if needed >= row.cells.len() {
                let message = match row.cells.len() {
                    1 => "this line has only 1 column".into(),
                    count => format!("this line has {count} columns"),
                };
                let help =
                    "remove the line, or complete it; if commas mark the decimals, separate the columns by semicolons";
                let error = document.error(row.span.clone(), "", message);
                return Err(error.allowed(format!("at least {} columns", needed + 1)).help(help).into());
            }
            row.cells = places.map(|place| row.cells[place].clone()).to_vec();
        }
        self.decimal_commas(document)
    }

    /// Refuses rows with more cells than the header, whose columns have no name: decimal commas split numbers that are separated by commas.
    fn within_header(&self, document: &Document) -> Result<()> {
        let Some(wanted) = self.header.as_ref().map(|header| header.cells.len()) else { return Ok(()) };
        let Some(row) = self.rows.iter().find(|row| row.cells.len() > wanted) else { return Ok(()) };
        Err(wrong_count(document, row.span.clone(), row.cells.len(), wanted, self.delimiter).into())
    }

    fn decimal_commas(&mut self, document: &Document) -> Result<()> {
        decimal_commas(document, &mut self.rows.iter_mut().flat_map(|row| &mut row.cells).collect::<Vec<_>>())
    }

    /// Replaces the decimal commas of all rows by points.
    ///
    /// # Errors
    /// A row has an empty cell, more cells than the header or not the usual number of them, or the meaning of a comma in a number is ambiguous.
    pub(crate) fn complete(&mut self, document: &Document) -> Result<()> {
        self.within_header(document)?;
        for row in &self.rows {
            if let Some(place) = (0..self.width).find(|&place| is_empty(document, row, place, self.delimiter)) {
                return Err(empty_cell(document, row, place, self.header.as_ref()).into());
            }
            if row.cells.len() != self.width {
                return Err(wrong_count(document, row.span.clone(), row.cells.len(), self.width, self.delimiter).into());
            }
        }
        self.decimal_commas(document)
    }
}

/// Reads a table. Its numbers start at the first of two successive lines that have the usual number of cells and two or more numbers each; lines
/// just before them that start with a number belong to the numbers, too.
///
/// # Errors
/// The text has no such lines.
pub(crate) fn table(document: &Document) -> Result<Table> {
    let delimiter = delimiter(&document.text);
    let mut rows: Vec<Line> = lines(&document.text).map(|(span, line)| cells(span, line, delimiter, 2)).collect();
    let width = usual_width(&rows);
    let Some(start) = first_data(&rows, width) else {
        let message = "no table: fewer than two lines with at least two numbers";
        let help = "separate the columns by commas, semicolons, tabs or blanks";
        return Err(document
            .error(0..0, "", message)
            .allowed("columns of numbers, one row per line")
            .help(help)
            .into());
    };
    let data = rows.split_off(start);
    let named = |rows: &mut Vec<Line>| rows.pop_if(|row| row.cells.len() > 1 && !row.cells.iter().any(is_number));
    let mut header = named(&mut rows);
    let mut units = None;
    if header.as_ref().is_some_and(|line| line.cells.iter().all(|cell| is_unit(&cell.text))) {
        units = header;
        header = named(&mut rows);
    }
    let header = header.or_else(|| header_in_comment(&document.text[..data[0].span.start], delimiter, width));
    Ok(Table { header, units, rows: data, width, preamble: rows.len(), delimiter })
}

/// Returns the index of the first row of numbers.
fn first_data(rows: &[Line], width: usize) -> Option<usize> {
    let starts_with_number = |row: &Line| row.cells.len() > 1 && row.cells.first().is_some_and(is_number);
    let is_data = |row: &Line| row.cells.len() == width && row.cells.iter().filter(|cell| is_number(cell)).count() >= 2;
    let starts = |k: &usize| is_data(&rows[*k]) && rows.get(k + 1).is_none_or(is_data);
    let sure = (0..rows.len()).find(starts).or_else(|| rows.iter().position(starts_with_number))?;
    // A row with one wrong cell belongs to the numbers: it is an error, not a part of the preamble.
    let before = rows[..sure].iter().rev().take_while(|row| row.cells.len() == width && starts_with_number(row));
    Some(sure - before.count())
}

/// Returns the last comment of a text if it names all columns: `# strain stress_MPa`, as numerical programs write it.
fn header_in_comment(before: &str, delimiter: char, width: usize) -> Option<Line> {
    let line = before.trim_end().rsplit('\n').next()?;
    let text = line.trim_start().strip_prefix('#')?.trim_start();
    let start = before.trim_end().len() - text.len();
    let header = cells(start..start + text.len(), text, delimiter, 2);
    (header.cells.len() == width && !header.cells.iter().any(is_number)).then_some(header)
}

/// Returns the number of cells of most lines; the largest number if several are equally frequent.
fn usual_width(rows: &[Line]) -> usize {
    let mut widths: Vec<usize> = rows.iter().map(|row| row.cells.len()).collect();
    widths.sort_unstable();
    widths.chunk_by(|a, b| a == b).max_by_key(|same| same.len()).map_or(0, |same| same[0])
}

fn is_number(cell: &Cell) -> bool {
    let text = cell.text.replace('\u{2212}', "-");
    let finite = |text: &str| text.parse::<f64>().is_ok_and(f64::is_finite);
    finite(&text.replace(',', ".")) || [Grouping::ENGLISH, Grouping::GERMAN].iter().any(|g| g.certain(&text))
}

/// Whether a cell can belong to a line of units: `(mm)`, `[kN]`, `MPa` or nothing.
fn is_unit(text: &str) -> bool {
    let known = |dimension| in_heading(text, dimension).is_ok();
    text.is_empty()
        || (text.starts_with(['(', '[']) && text.ends_with([')', ']']))
        || [Dimension::None, Dimension::Length, Dimension::Force, Dimension::Stress, Dimension::Time]
            .map(known)
            .contains(&true)
}

/// Reads all lines of a file with two columns. `of_more` is the help text for files with more columns.
///
/// # Errors
/// A line does not have two columns, or the meaning of a comma in a number is ambiguous.
pub(crate) fn read(document: &Document, of_more: &str) -> Result<Columns> {
    let delimiter = delimiter(&document.text);
    let row = |(span, line)| pair(document, span, line, delimiter, of_more);
    let mut rows = lines(&document.text).map(row).collect::<Result<Vec<_>>>()?;
    let named = rows.first().is_some_and(|row| row.cells.iter().all(|cell| is_name(&cell.text)));
    let header = named.then(|| rows.remove(0));
    decimal_commas(document, &mut rows.iter_mut().flat_map(|row| &mut row.cells).collect::<Vec<_>>())?;
    Ok(Columns { header, rows })
}

/// Iterates over the lines with content, with their byte ranges.
fn lines(text: &str) -> impl Iterator<Item = (Range<usize>, &str)> {
    let mut start = 0;
    text.split_inclusive('\n').filter_map(move |whole| {
        let line = whole.trim_end_matches(['\n', '\r', ' ']);
        let span = start..start + line.len();
        start += whole.len();
        let content = line.trim_start();
        (!content.is_empty() && !content.starts_with('#')).then_some((span, line))
    })
}

/// Represents any number of blanks.
const BLANKS: char = ' ';

/// Returns the one of `;`, tab, blanks and comma that separates most lines; in case of a tie the first in this order. Blanks count only on lines of
/// numbers.
fn delimiter(text: &str) -> char {
    let mut counts = [(';', 0), ('\t', 0), (BLANKS, 0), (',', 0)];
    let is_number = |piece: &str| piece.replace(',', ".").replace('\u{2212}', "-").parse::<f64>().is_ok();
    for (_, line) in lines(text) {
        for (delimiter, count) in &mut counts {
            if *delimiter == BLANKS {
                let numbers = !line.contains('\t') && line.split_whitespace().all(is_number);
                *count += usize::from(numbers && line.split_whitespace().nth(1).is_some());
                continue;
            }
            // A tab after a comma is only padding.
            let parts = |cells: Vec<(usize, &str)>| {
                cells.len() > 1
                    && cells[..2].iter().all(|(_, cell)| !cell.trim().starts_with(',') && !cell.trim().ends_with(','))
            };
            *count += usize::from(parts(split(line, *delimiter)));
        }
    }
    // `max_by_key` returns the last of equal maxima, hence the reversed order.
    counts.into_iter().rev().max_by_key(|(_, count)| *count).map_or(',', |(delimiter, _)| delimiter)
}

/// Splits a line at the delimiters outside quotes; returns each piece with its byte offset.
fn split(line: &str, delimiter: char) -> Vec<(usize, &str)> {
    if delimiter == BLANKS {
        return split_at_blanks(line);
    }
    let (mut pieces, mut start, mut quoted) = (Vec::new(), 0, false);
    for (at, c) in line.char_indices() {
        if c == '"' {
            quoted = !quoted;
        } else if c == delimiter && !quoted {
            pieces.push((start, &line[start..at]));
            start = at + c.len_utf8();
        }
    }
    pieces.push((start, &line[start..]));
    pieces
}

/// Splits a line at blanks; a unit in brackets belongs to the name before it.
fn split_at_blanks(line: &str) -> Vec<(usize, &str)> {
    let mut pieces: Vec<(usize, &str)> = Vec::new();
    for piece in line.split_whitespace() {
        let start = piece.as_ptr() as usize - line.as_ptr() as usize;
        match pieces.last_mut() {
            Some(last) if piece.starts_with(['(', '[']) => last.1 = &line[last.0..start + piece.len()],
            _ => pieces.push((start, piece)),
        }
    }
    pieces
}

/// Returns the cells of a line without empty cells at its end; the first `least` cells are always kept.
fn cells(span: Range<usize>, line: &str, delimiter: char, least: usize) -> Line {
    let pieces = split(line, delimiter);
    let cell = |(start, piece): (usize, &str)| {
        let start = span.start + start;
        Cell { text: piece.trim().trim_matches('"').trim().to_owned(), span: start..start + piece.len() }
    };
    let mut cells: Vec<Cell> = pieces.into_iter().map(cell).collect();
    while cells.len() > least && cells.last().is_some_and(|cell| cell.text.is_empty()) {
        cells.pop();
    }
    Line { cells, span }
}

/// Returns the row of a line with two columns, or the error of a line with more or fewer.
fn pair(document: &Document, span: Range<usize>, line: &str, delimiter: char, of_more: &str) -> Result<Row> {
    let Line { cells, span } = cells(span, line, delimiter, 2);
    let filled = cells.iter().filter(|cell| !cell.text.is_empty()).count();
    let all_filled = filled == cells.len();
    match <[Cell; 2]>::try_from(cells) {
        Ok(cells) if all_filled => Ok(Row { cells, span }),
        _ => {
            let error = wrong_count(document, span, filled, 2, delimiter);
            let help = if filled > 2 { format!("{}; {of_more}", error.help) } else { error.help.clone() };
            Err(error.help(help).into())
        }
    }
}

fn wrong_count(document: &Document, span: Range<usize>, found: usize, wanted: usize, delimiter: char) -> InputError {
    let all = if wanted == 2 { "two columns".to_owned() } else { format!("{wanted} columns") };
    let help = match (found, delimiter) {
        (1, _) => format!("separate the {all} by a comma, a semicolon, a tab or blanks"),
        (_, ',') => format!("keep {all}; if commas mark the decimals, separate the columns by semicolons"),
        _ => format!("keep {all}"),
    };
    let plural = if found == 1 { "" } else { "s" };
    let message = format!("this line has {found} column{plural}");
    document.error(span, "", message).allowed(format!("{wanted} columns")).help(help)
}

/// Whether a row has an empty cell in a column. Empty cells at the end of a row are not kept, but their delimiters are in the text.
fn is_empty(document: &Document, row: &Line, place: usize, delimiter: char) -> bool {
    let Some(cell) = row.cells.get(place) else {
        let end = row.cells.last().map_or(row.span.start, |cell| cell.span.end);
        let rest = document.text.get(end..row.span.end).unwrap_or("");
        return delimiter != BLANKS && rest.matches(delimiter).count() > place - row.cells.len();
    };
    cell.text.is_empty()
}

fn empty_cell(document: &Document, row: &Line, place: usize, header: Option<&Line>) -> InputError {
    let name = header.and_then(|header| header.cells.get(place)).map_or("", |cell| cell.text.as_str());
    let of = if name.is_empty() { format!("column {}", place + 1) } else { format!("column `{name}`") };
    let error = document.error(row.span.clone(), "", format!("the cell in {of} is empty"));
    error.allowed("a number in each row").help("remove the line, or fill the cell")
}

/// Whether a cell is a word as in headers: neither a number nor text that starts like one.
fn is_name(cell: &str) -> bool {
    !cell.starts_with(|c: char| c.is_ascii_digit() || "+-.,\u{2212}".contains(c)) && cell.parse::<f64>().is_err()
}

/// A notation of numbers with separators of thousands.
struct Grouping {
    separator: char,
    decimal: char,
}

impl Grouping {
    const ENGLISH: Self = Self { separator: ',', decimal: '.' };
    const GERMAN: Self = Self { separator: '.', decimal: ',' };

    /// Whether a number can be written in this notation: one to three digits, groups of three, decimals.
    fn possible(&self, text: &str) -> bool {
        let unsigned = text.trim_start_matches(['+', '-', '\u{2212}']);
        let (whole, decimals) = unsigned.split_once(self.decimal).unwrap_or((unsigned, ""));
        let digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
        let mut groups = whole.split(self.separator);
        let first = groups.next().unwrap_or("");
        (1..=3).contains(&first.len())
            && digits(first)
            && digits(decimals)
            && groups.all(|group| group.len() == 3 && digits(group))
    }

    /// Whether a number has both marks of this notation, which leaves no other meaning.
    fn certain(&self, text: &str) -> bool {
        text.contains(self.separator) && text.contains(self.decimal) && self.possible(text)
    }
}

/// Removes the separators of thousands if at least one number has both marks and all others can be written in the same notation.
fn remove_groups(numbers: &mut [&mut Cell]) {
    for grouping in [Grouping::ENGLISH, Grouping::GERMAN] {
        let certain = numbers.iter().any(|cell| grouping.certain(&cell.text));
        let grouped = |cell: &&mut Cell| cell.text.contains(grouping.separator);
        if certain && numbers.iter().filter(|cell| grouped(cell)).all(|cell| grouping.possible(&cell.text)) {
            for cell in numbers.iter_mut() {
                cell.text = cell.text.replace(grouping.separator, "").replace(grouping.decimal, ".");
            }
        }
    }
}

/// Replaces decimal commas by points in cells of numbers, and removes separators of thousands if they are unambiguous.
///
/// # Errors
/// The meaning of a comma is ambiguous.
fn decimal_commas(document: &Document, numbers: &mut [&mut Cell]) -> Result<()> {
    remove_groups(numbers);
    let cells = || numbers.iter().map(|cell| &**cell);
    let Some(first) = cells().find(|cell| cell.text.contains(',')) else { return Ok(()) };
    let refuse = |cell: &Cell, message: String| {
        let help = "write every number with a decimal point and without separators of thousands";
        Err(document
            .error(cell.span.clone(), "", message)
            .allowed("one decimal mark, the same in the whole file")
            .help(help)
            .into())
    };
    if let Some(cell) = cells().find(|cell| cell.text.matches(',').count() > 1) {
        return refuse(cell, format!("`{}` has more than one comma", cell.text));
    }
    if let Some(cell) = cells().find(|cell| cell.text.contains('.')) {
        return refuse(
            cell,
            format!("`{}` has a point and `{}` a comma: the decimal mark is ambiguous", cell.text, first.text),
        );
    }
    if cells().filter(|cell| cell.text.contains(',')).all(|cell| could_be_thousands(&cell.text)) {
        return refuse(
            first,
            format!("`{0}` can be {1} or {2}", first.text, first.text.replace(',', "."), first.text.replace(',', "")),
        );
    }
    for cell in numbers {
        cell.text = cell.text.replace(',', ".");
    }
    Ok(())
}

/// Whether a number can be read as thousands: one to three digits that do not start with 0, a comma, three digits.
fn could_be_thousands(text: &str) -> bool {
    let unsigned = text.trim_start_matches(['+', '-', '\u{2212}']);
    let digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
    unsigned.split_once(',').is_some_and(|(whole, rest)| {
        (1..=3).contains(&whole.len()) && !whole.starts_with('0') && rest.len() == 3 && digits(whole) && digits(rest)
    })
}

/// Returns the unit in a heading; `None` if it has none.
///
/// # Errors
/// The unit does not have this dimension.
pub(crate) fn unit_of<'a>(document: &Document, heading: &'a Cell, dimension: Dimension) -> Result<Option<&'a str>> {
    let (_, unit) = split_heading(&heading.text);
    if unit.is_empty() {
        return Ok(None);
    }
    one(unit, dimension).map(|_| Some(unit)).map_err(|reason| wrong_unit(document, heading, dimension, &reason).into())
}

/// Creates the error for a heading whose unit does not have a dimension.
pub(crate) fn wrong_unit(document: &Document, heading: &Cell, dimension: Dimension, reason: &str) -> InputError {
    let (name, example, what) = (split_heading(&heading.text).0, dimension.si_symbol(), dimension.describe());
    let message = format!("in the heading `{}`: {}", heading.text, reason.replace("`1 ", "`"));
    let error = document.error(heading.span.clone(), "", message);
    error.allowed(format!("a unit of {what}, or none")).help(format!("write e.g. `{name} [{example}]`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<[String; 2]> {
        let rows = read(&Document::new("a.csv", text), "").expect("it is right").rows;
        rows.into_iter().map(|row| row.cells.map(|cell| cell.text)).collect()
    }

    #[test]
    fn any_number_of_columns_is_read_and_kept() {
        let complete = |text: &str| {
            let document = Document::new("a.csv", text);
            table(&document).and_then(|mut table| table.complete(&document).map(|()| table))
        };
        let wide = complete("t [us];a;b\n0,5;1;2\n1,5;3;4\n").expect("it is right");
        let texts: Vec<&str> = wide.rows[1].cells.iter().map(|cell| cell.text.as_str()).collect();
        assert_eq!((texts, wide.header.map(|row| row.cells.len())), (vec!["1.5", "3", "4"], Some(3)));
        for (text, words) in [
            ("1,2,3\n1,2\n", "a.csv:2: this line has 2 columns (allowed: 3 columns)"),
            ("1,2,3\n1,,3\n", "a.csv:2: the cell in column 2 is empty"),
            ("a,b,c\n1,2,3\n1,2,\n", "a.csv:3: the cell in column `c` is empty"),
            ("a,b,c\n1,5,2,5\n2,5,3,5\n", "a.csv:2: this line has 4 columns (allowed: 3 columns)"),
        ] {
            let error = complete(text).expect_err(text).to_string();
            assert!(error.contains(words), "{error}");
        }
        // Two columns of a wide table, too.
        let kept = |text: &str| {
            let document = Document::new("a.csv", text);
            table(&document).and_then(|mut table| table.keep(&document, [0, 1])).map_err(|error| error.to_string())
        };
        assert_eq!(kept("a,b,c\n1,2,\n3,4,\n"), Ok(()));
        let error = kept("a,b\n1,5,2,5\n2,5,3,5\n").expect_err("decimal commas");
        assert!(error.contains("this line has 4 columns (allowed: 2 columns)"), "{error}");
        assert!(kept("a,b,c\n1,2,3\n3,,5\n").is_err_and(|error| error.contains("the cell in column `b` is empty")));
    }

    #[test]
    fn every_delimiter_and_decimal_mark_that_is_certain_is_read() {
        for text in [
            "0.001,200.5\n0.02,300\n",
            "time,value\r\n0.001,200.5\r\n\r\n0.02,300,,\r\n",
            "0.001;200.5\n0.02;300\n",
            "0.001\t200.5\n0.02\t300\n",
            "# measured; at 20 C\n0.001,\t200.5\n0.02,\t300\n",
            "strain;stress, MPa\n0,001;200,5\n0,02;300\n",
            "0,001\t200,5\n0,02\t300\n",
            "\"0,001\",\"200,5\"\n\"0,02\",300\n",
            "0.001  200.5\n 0.02 300\n",
            "0,001 200,5\n0,02 300\n",
        ] {
            assert_eq!(texts(text), [["0.001", "200.5"], ["0.02", "300"]], "{text}");
        }
    }

    #[test]
    fn what_is_not_certain_is_refused() {
        for (text, words) in [
            ("0.001\n", "this line has 1 column"),
            ("0.001 about 200\n", "this line has 1 column"),
            ("0,001,200\n", "this line has 3 columns"),
            ("0.001;\n", "this line has 1 column"),
            ("0.001;200,5\n", "the decimal mark is ambiguous"),
            ("1;1,234\n", "`1,234` can be 1.234 or 1234"),
            ("0;1,234,567\n", "more than one comma"),
        ] {
            let error = read(&Document::new("a.csv", text), "").expect_err(text).to_string();
            assert!(error.contains(words) && error.starts_with("a.csv:1: "), "{text}: {error}");
        }
    }

    #[test]
    fn thousands_are_removed_where_a_number_has_both_marks() {
        for text in ["0.001,\"1,200.5\"\n0.02,\"1,234\"\n", "0,001;1.200,5\n0,02;1.234\n"] {
            assert_eq!(texts(text), [["0.001", "1200.5"], ["0.02", "1234"]], "{text}");
        }
    }

    #[test]
    fn names_and_units_stand_above_the_numbers() {
        for (text, names, units) in [
            ("# made by a program\n# strain stress_MPa\n0.1 200\n0.2 300\n", ["strain", "stress_MPa"], ["", ""]),
            ("Strain (%)  Stress [MPa]\n0.1 200\n0.2 300\n", ["Strain (%)", "Stress [MPa]"], ["", ""]),
            ("\"Load\",\"Way\"\n\"(kN)\",\"(mm)\"\n1,2\n3,4\n", ["Load", "Way"], ["kN", "mm"]),
        ] {
            let table = table(&Document::new("a.csv", text)).expect(text);
            let header = table.header.as_ref().expect("a header");
            assert_eq!(header.cells.iter().map(|cell| cell.text.as_str()).collect::<Vec<_>>(), names, "{text}");
            assert_eq!([table.unit_below(0), table.unit_below(1)], units, "{text}");
        }
        // A wrong cell is an error of its row: the row is no part of the preamble.
        let wrong = table(&Document::new("a.csv", "strain,stress\n0.1,abc\n0.2,300\n")).expect("a table");
        assert_eq!((wrong.rows.len(), wrong.header.is_some()), (2, true));
    }

    #[test]
    fn headers_are_words() {
        let columns = read(&Document::new("a.csv", "time [us],v\n1,2\n"), "").expect("it is right");
        assert_eq!((columns.header.map(|row| row.cells[0].span.clone()), columns.rows.len()), (Some(0..9), 1));
        assert!(read(&Document::new("a.csv", "nan,nan\n1,2\n"), "").expect("two columns").header.is_none());
    }
}
