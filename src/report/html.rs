//! Elements of self-contained HTML pages, which refer to no network address and no other file.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::colour::bytes;
use super::origin::PROGRAM;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Background colour in dark mode, as in page.css.
const DARK_PAPER: [u8; 3] = [0x15, 0x18, 0x1c];

/// Returns a page of sections with headings; contents are HTML. The page refers to nothing outside itself and is complete without its script.
pub(super) fn html(title: &str, sections: &[(&str, &str)]) -> String {
    let mut body = String::new();
    for (heading, content) in sections {
        let heading = if heading.is_empty() { String::new() } else { ["<h2>", &escape(heading), "</h2>\n"].concat() };
        body += &["<section>\n", &heading, content, "\n</section>\n"].concat();
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"generator\" content=\"{PROGRAM}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}{dark}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<main>\n{body}</main>\n\
         <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        title = escape(title),
        dark = dark_rules(&body),
    )
}

/// Returns text escaped for HTML.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns an SVG drawing with a label for screen readers.
pub(super) fn picture(label: &str, svg: &str) -> String {
    svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{}\" ", escape(label)), 1)
}

/// Returns a table in a box that scrolls horizontally. Without a head, the first cell of each row is its header. Cells are escaped here.
pub(super) fn table(label: &str, head: &[String], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String], first: &str, others: &str| {
        let cells = cells.iter().enumerate().map(|(i, cell)| {
            let (open, close) = (if i == 0 { first } else { others }, if i == 0 { &first[..2] } else { &others[..2] });
            format!("<{open}>{}</{close}>", escape(cell))
        });
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let column = "th scope=\"col\"";
    let (class, first) = if head.is_empty() { ("facts", "th scope=\"row\"") } else { ("columns", "td") };
    let head = if head.is_empty() { String::new() } else { line(head, column, column) };
    let body: String = rows.iter().map(|row| line(row, first, "td")).collect();
    // A scrollable element must be reachable by keyboard.
    format!(
        "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n\
         <table class=\"{class}\">\n{head}{body}</table>\n</div>\n",
        escape(label)
    )
}

/// Largest number of rows of one table on a page; a run can end with thousands of fronts.
const MOST_ROWS: usize = 100;

/// Returns a table of at most [`MOST_ROWS`] rows, followed by the number of omitted rows and the table of the result file that has them.
pub(super) fn listed(
    label: &str,
    head: &[String],
    rows: impl ExactSizeIterator<Item = Vec<String>>,
    stored: &str,
) -> String {
    let left_out = rows.len().saturating_sub(MOST_ROWS);
    let html = table(label, head, &rows.take(MOST_ROWS).collect::<Vec<_>>());
    if left_out == 0 {
        return html;
    }
    format!("{html}<p>... and {left_out} more, in the table {stored} of the file</p>\n")
}

/// Returns CSS rules that lighten the lines and texts of drawings in dark mode. Filled areas and everything on a map keep their colours.
fn dark_rules(drawings: &str) -> String {
    let mut colours = BTreeSet::new();
    for element in drawings.split('<') {
        let kinds: &[&str] = if element.starts_with("text ") { &["stroke", "fill"] } else { &["stroke"] };
        for &kind in kinds {
            if let Some((_, rest)) = element.split_once(&format!(" {kind}=\"#"))
                && let Some((colour, _)) = rest.split_once('"')
            {
                colours.insert((kind, colour));
            }
        }
    }
    let mut rules = String::from("@media screen and (prefers-color-scheme: dark) {\n");
    for (kind, colour) in colours {
        if let Some([r, g, b]) = bytes(colour).map(lightened) {
            // Writing to a String cannot fail.
            let element = if kind == "fill" { "text" } else { "" };
            let _ = writeln!(
                rules,
                "  {element}[{kind}=\"#{colour}\"]:not(.on-map *) {{ {kind}: #{r:02x}{g:02x}{b:02x} }}"
            );
        }
    }
    rules + "}\n"
}

/// Returns the colour mixed with as little white as makes it readable on the dark background.
fn lightened(colour: [u8; 3]) -> [u8; 3] {
    /// Smallest contrast of text (WCAG 2.2, 1.4.3).
    const READABLE: f64 = 4.5;
    let mixed = |white: f64| colour.map(|c| (f64::from(c) * (1.0 - white) + 255.0 * white).round() as u8);
    let contrast = |colour: [u8; 3]| (luminance(colour) + 0.05) / (luminance(DARK_PAPER) + 0.05);
    (0..=20).map(|i| mixed(f64::from(i) / 20.0)).find(|c| contrast(*c) >= READABLE).unwrap_or([255; 3])
}

/// Returns the relative luminance of an sRGB colour.
fn luminance(colour: [u8; 3]) -> f64 {
    let linear = |c: u8| match f64::from(c) / 255.0 {
        dark if dark <= 0.040_45 => dark / 12.92,
        c => ((c + 0.055) / 1.055).powf(2.4),
    };
    let [r, g, b] = colour.map(linear);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{FINE, GRID, INK, PAPER};
    use super::*;

    #[test]
    fn tables_of_names_and_values_have_rules_of_their_own() {
        let text = table("run", &[], &[vec!["method".into(), "fd".into()]]);
        let class = text.split("<table class=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a class");
        assert!(STYLE.contains(&format!(".{class} td {{")), "no rule for {class}");
    }

    #[test]
    fn lines_are_readable_on_dark_paper_and_light_ones_stay() {
        assert_eq!(bytes("444"), Some([0x44; 3]));
        assert_eq!(bytes("0072B2"), Some([0, 0x72, 0xb2]));
        assert_eq!(lightened([0xe6, 0x9f, 0]), [0xe6, 0x9f, 0]);
        // Black becomes a grey of contrast 4.5, and no lighter than needed.
        let [grey, ..] = lightened([0; 3]);
        assert!((0x70..0x90).contains(&grey), "{grey:x}");
        let rules = dark_rules("<path stroke=\"#000000\"/><rect fill=\"#440154\"/><text fill=\"#b03060\">a</text>");
        assert!(rules.contains("[stroke=\"#000000\"]") && rules.contains("text[fill=\"#b03060\"]"));
        assert!(!rules.contains("#440154"), "an area: {rules}");
    }

    #[test]
    fn colours_with_a_role_have_their_counterpart() {
        let [r, g, b] = DARK_PAPER;
        assert!(STYLE.contains(&format!("--paper: #{r:02x}{g:02x}{b:02x}")));
        for rule in [
            format!("[fill=\"{INK}\"]"),
            format!("[fill=\"{PAPER}\"]"),
            format!("[stroke=\"{GRID}\"]"),
            format!("[stroke=\"{FINE}\"]"),
        ] {
            assert!(STYLE.contains(&rule), "{rule}");
        }
    }

    #[test]
    fn tables_have_headers_and_safe_cells() {
        let cells = |texts: [&str; 2]| texts.map(String::from).to_vec();
        let page = table("Fronts", &cells(["from", "a<b"]), &[cells(["left", "1"])]);
        assert!(page.contains("<th scope=\"col\">a&lt;b</th>") && page.contains("<td>left</td>"));
        assert!(table("Run", &[], &[cells(["method", "fd"])]).contains("<th scope=\"row\">method</th><td>fd</td>"));
    }
}
