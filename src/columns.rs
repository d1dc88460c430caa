//! Text with two columns, as spreadsheets and instruments write it.
//!
//! The delimiter is a semicolon, a tab or a comma: the one that parts most lines. Next to a semicolon or a tab, and inside quotes, a comma
//! marks the decimals, where it cannot mean thousands. Empty lines and lines that start with `#` are skipped. A first line without numbers
//! is a header. Empty columns after the second are ignored.

use std::ops::Range;

use crate::error::Result;
use crate::input::Document;

/// A cell with its bytes in the text. In cells of numbers the decimal mark is a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cell {
    pub(crate) text: String,
    pub(crate) span: Range<usize>,
}

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) cells: [Cell; 2],
    pub(crate) span: Range<usize>,
}

/// The lines of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Columns {
    pub(crate) header: Option<Row>,
    pub(crate) rows: Vec<Row>,
}

/// Reads all lines.
///
/// # Errors
/// A line with fewer or more than two columns, or a comma in a number whose meaning is not certain.
pub(crate) fn read(document: &Document) -> Result<Columns> {
    let delimiter = delimiter(&document.text);
    let rows = lines(&document.text).map(|(span, line)| row(document, span, line, delimiter));
    let mut rows = rows.collect::<Result<Vec<Row>>>()?;
    let named = rows.first().is_some_and(|row| row.cells.iter().all(|cell| is_name(&cell.text)));
    let header = named.then(|| rows.remove(0));
    decimal_commas(document, &mut rows)?;
    Ok(Columns { header, rows })
}

/// Lines with content, with the bytes they take.
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

/// The one of `;`, tab and comma that parts most lines; the first of these, where several part as many.
fn delimiter(text: &str) -> char {
    let mut counts = [(';', 0), ('\t', 0), (',', 0)];
    for (_, line) in lines(text) {
        for (delimiter, count) in &mut counts {
            // A tab after a comma only fills up.
            let parts = |cells: Vec<(usize, &str)>| {
                cells.len() > 1
                    && cells[..2].iter().all(|(_, cell)| !cell.trim().starts_with(',') && !cell.trim().ends_with(','))
            };
            *count += usize::from(parts(split(line, *delimiter)));
        }
    }
    // The last of equal maxima would win.
    counts.into_iter().rev().max_by_key(|(_, count)| *count).map_or(',', |(delimiter, _)| delimiter)
}

/// The pieces of a line between delimiters outside quotes, each with where it starts.
fn split(line: &str, delimiter: char) -> Vec<(usize, &str)> {
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

fn row(document: &Document, span: Range<usize>, line: &str, delimiter: char) -> Result<Row> {
    let pieces = split(line, delimiter);
    let cell = |(start, piece): (usize, &str)| {
        let start = span.start + start;
        Cell { text: piece.trim().trim_matches('"').trim().to_owned(), span: start..start + piece.len() }
    };
    let mut cells: Vec<Cell> = pieces.into_iter().map(cell).collect();
    while cells.len() > 2 && cells.last().is_some_and(|cell| cell.text.is_empty()) {
        cells.pop();
    }
    let found = cells.len();
    match <[Cell; 2]>::try_from(cells) {
        Ok(cells) if cells.iter().all(|cell| !cell.text.is_empty()) => Ok(Row { cells, span }),
        Ok(_) => Err(wrong_count(document, span, 1, delimiter)),
        Err(_) => Err(wrong_count(document, span, found, delimiter)),
    }
}

fn wrong_count(document: &Document, span: Range<usize>, found: usize, delimiter: char) -> crate::error::Error {
    let help = match (found, delimiter) {
        (1, _) => "separate the two columns by a comma, a semicolon or a tab",
        (_, ',') => "keep two columns; if commas mark the decimals, separate the columns by semicolons",
        _ => "keep two columns",
    };
    let plural = if found == 1 { "" } else { "s" };
    let message = format!("this line has {found} column{plural}");
    document.error(span, "", message).allowed("2 columns").help(help).into()
}

/// A word, as headers have them: no number, and nothing that starts like one.
fn is_name(cell: &str) -> bool {
    !cell.starts_with(|c: char| c.is_ascii_digit() || "+-.,\u{2212}".contains(c)) && cell.parse::<f64>().is_err()
}

/// Makes points of decimal commas.
fn decimal_commas(document: &Document, rows: &mut [Row]) -> Result<()> {
    let cells = || rows.iter().flat_map(|row| &row.cells);
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
            format!("`{}` has a point, and `{}` a comma: which of them marks the decimals?", cell.text, first.text),
        );
    }
    if cells().filter(|cell| cell.text.contains(',')).all(|cell| could_be_thousands(&cell.text)) {
        return refuse(
            first,
            format!("`{0}` can be {1} or {2}", first.text, first.text.replace(',', "."), first.text.replace(',', "")),
        );
    }
    for cell in rows.iter_mut().flat_map(|row| &mut row.cells) {
        cell.text = cell.text.replace(',', ".");
    }
    Ok(())
}

/// One to three digits that do not start with 0, a comma, three digits.
fn could_be_thousands(text: &str) -> bool {
    let unsigned = text.trim_start_matches(['+', '-', '\u{2212}']);
    let digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
    unsigned.split_once(',').is_some_and(|(whole, rest)| {
        (1..=3).contains(&whole.len()) && !whole.starts_with('0') && rest.len() == 3 && digits(whole) && digits(rest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<[String; 2]> {
        let rows = read(&Document::new("a.csv", text)).expect("it is right").rows;
        rows.into_iter().map(|row| row.cells.map(|cell| cell.text)).collect()
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
        ] {
            assert_eq!(texts(text), [["0.001", "200.5"], ["0.02", "300"]], "{text}");
        }
    }

    #[test]
    fn what_is_not_certain_is_refused() {
        for (text, words) in [
            ("0.001\n", "this line has 1 column"),
            ("0.001 200\n", "this line has 1 column"),
            ("0,001,200\n", "this line has 3 columns"),
            ("0.001;\n", "this line has 1 column"),
            ("0.001;200,5\n", "which of them marks the decimals"),
            ("1;1,234\n", "`1,234` can be 1.234 or 1234"),
            ("0;1,234,567\n", "more than one comma"),
        ] {
            let error = read(&Document::new("a.csv", text)).expect_err(text).to_string();
            assert!(error.contains(words) && error.starts_with("a.csv:1: "), "{text}: {error}");
        }
    }

    #[test]
    fn headers_are_words() {
        let columns = read(&Document::new("a.csv", "time [us],v\n1,2\n")).expect("it is right");
        assert_eq!((columns.header.map(|row| row.cells[0].span.clone()), columns.rows.len()), (Some(0..9), 1));
        assert!(read(&Document::new("a.csv", "nan,nan\n1,2\n")).expect("two columns").header.is_none());
    }
}
