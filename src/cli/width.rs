//! Text wrapped to the width of the terminal or to `COLUMNS`.

use std::fmt::Write as _;
use std::io::IsTerminal;

/// Smallest supported width.
const NARROWEST: usize = 40;
/// Smallest width to which the last column of a table is reduced by wrapping its text.
const NARROWEST_TEXT: usize = 20;
/// Largest indent of a value behind its label to which continuation lines are aligned.
const WIDEST_LABEL: usize = 24;
/// Spaces between the columns of a table.
const GAP: usize = 2;

/// Returns the width of stdout in columns: `COLUMNS`, or that of the terminal; `None` for a file or a pipe.
pub(super) fn of_stdout() -> Option<usize> {
    let stated = std::env::var("COLUMNS").ok().and_then(|columns| columns.trim().parse().ok());
    let of_terminal = || {
        let terminal = std::io::stdout().is_terminal().then(terminal_size::terminal_size).flatten();
        terminal.map(|(width, _)| usize::from(width.0))
    };
    stated.or_else(of_terminal).map(|width: usize| width.max(NARROWEST))
}

/// Breaks lines at spaces. Continuation lines are aligned with the value of a line that has a label. Single words are not broken.
pub(super) fn wrap(text: &str, width: usize) -> String {
    let mut wrapped = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let end = if line.ends_with('\n') { "\n" } else { "" };
        wrapped += &wrap_line(line.trim_end_matches('\n'), width).join("\n");
        wrapped += end;
    }
    wrapped
}

fn wrap_line(line: &str, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut rest: Vec<char> = line.chars().collect();
    let indent = hanging(&rest).min(width / 2);
    let mut start = rest.iter().take_while(|c| **c == ' ').count();
    while rest.len() > width {
        let is_break = |at: &usize| rest[*at] == ' ' && *at > start;
        let before = (start..=width).rev().find(is_break);
        let Some(at) = before.or_else(|| (width..rest.len()).find(is_break)) else { break };
        let tail: Vec<char> = rest[at..].iter().skip_while(|c| **c == ' ').copied().collect();
        lines.push(rest[..at].iter().collect::<String>().trim_end().to_owned());
        rest = std::iter::repeat_n(' ', indent).chain(tail).collect();
        start = indent;
    }
    lines.push(rest.into_iter().collect());
    lines
}

/// Returns the indent of continuation lines: where the value of a line with a label starts, otherwise a little to the right of the text.
fn hanging(line: &[char]) -> usize {
    let start = line.iter().take_while(|c| **c == ' ').count();
    let gap = (start..line.len().min(WIDEST_LABEL)).find(|at| line[*at..].starts_with(&[' ', ' ']));
    let value = gap.map(|gap| gap + line[gap..].iter().take_while(|c| **c == ' ').count());
    value.filter(|value| *value <= WIDEST_LABEL).unwrap_or(start + GAP)
}

/// Returns rows below their headings. The first `left` columns, and the last one if `last_left`, are aligned left, the others right. If the table
/// is wider than stdout, text in the last column is wrapped, or the columns are split into blocks, each of which starts with the first column.
pub(crate) fn table(headings: &[&str], rows: &[Vec<String>], left: usize, last_left: bool) -> String {
    within(of_stdout().unwrap_or(usize::MAX), headings, rows, (left, last_left))
}

/// Returns a table as [`table`] does, within a given width.
pub(super) fn within(
    limit: usize,
    headings: &[&str],
    rows: &[Vec<String>],
    (left, last_left): (usize, bool),
) -> String {
    let heads: Vec<String> = headings.iter().map(|&heading| heading.to_owned()).collect();
    let all: Vec<&[String]> = std::iter::once(&heads[..]).chain(rows.iter().map(Vec::as_slice)).collect();
    let columns = headings.len();
    let widths: Vec<usize> = (0..columns).map(|c| all.iter().map(|row| width_of(row, c)).max().unwrap_or(0)).collect();
    let is_left = |c: usize| c < left || (last_left && c + 1 == columns);
    let block = |columns: &Vec<usize>| -> String {
        all.iter().map(|row| lines(row, columns, (&widths, limit), &is_left)).collect()
    };
    blocks(&widths, limit, last_left).iter().map(block).collect::<Vec<_>>().join("\n")
}

fn width_of(row: &[String], column: usize) -> usize {
    row.get(column).map_or(0, |cell| cell.chars().count())
}

/// Returns the columns of each block, whose columns are side by side; the first column is in every block.
fn blocks(widths: &[usize], limit: usize, last_is_text: bool) -> Vec<Vec<usize>> {
    let (mut blocks, mut block, mut used) = (Vec::new(), vec![0], widths.first().copied().unwrap_or(0));
    for (column, width) in widths.iter().enumerate().skip(1) {
        let least = if last_is_text && column + 1 == widths.len() { NARROWEST_TEXT.min(*width) } else { *width };
        if used + GAP + least > limit && block.len() > 1 {
            blocks.push(std::mem::replace(&mut block, vec![0]));
            used = widths[0];
        }
        block.push(column);
        used += GAP + width;
    }
    blocks.push(block);
    blocks
}

/// Returns a row of a block: several lines if its last cell is wrapped.
fn lines(
    row: &[String],
    columns: &[usize],
    (widths, limit): (&[usize], usize),
    is_left: &dyn Fn(usize) -> bool,
) -> String {
    let mut line = String::new();
    for (place, &c) in columns.iter().enumerate() {
        let (cell, width) = (row.get(c).map_or("", String::as_str), widths[c]);
        line += if place > 0 { "  " } else { "" };
        let hang = line.chars().count();
        if is_left(c) && place + 1 == columns.len() && hang.saturating_add(width) > limit {
            let parts = wrap_line(cell, limit.saturating_sub(hang).max(1));
            line += &parts.iter().map(|part| part.trim_start()).collect::<Vec<_>>().join(&format!("\n{:hang$}", ""));
        } else if is_left(c) {
            // Writing to a String cannot fail.
            let _ = write!(line, "{cell:<width$}");
        } else {
            let _ = write!(line, "{cell:>width$}");
        }
    }
    format!("{}\n", line.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_at_spaces_below_their_values() {
        let text = "  method      fd leapfrog, 1000 cells\nshort\n";
        assert_eq!(wrap(text, 31), "  method      fd leapfrog, 1000\n              cells\nshort\n");
        assert_eq!(wrap("a-very-long-word-that-stays-whole", 10), "a-very-long-word-that-stays-whole");
        assert_eq!(wrap("one two three", 8), "one two\n  three");
    }

    #[test]
    fn tables_are_split_with_their_first_column() {
        let rows = vec![vec!["iron".to_owned(), "1.5".into(), "22.5".into(), "some words of text".into()]];
        let headings = ["name", "first", "second", "what it is"];
        let wide = within(80, &headings, &rows, (1, true));
        assert_eq!(wide, "name  first  second  what it is\niron    1.5    22.5  some words of text\n");
        let narrow = within(21, &headings, &rows, (1, true));
        let words = "iron  some words of\n      text\n";
        assert_eq!(narrow, format!("name  first  second\niron    1.5    22.5\n\nname  what it is\n{words}"));
    }
}
