//! Layout of panels in one figure.

use super::drawing::{Anchor, Area, Drawing, Picture, shortened};
use super::map;
use super::panel::LinePanel;
use super::view::View;
use crate::error::{InputError, Result};

const MARGIN: f64 = 18.0;
const GAP: f64 = 22.0;
const HEADER: f64 = 64.0;
/// Widths of a figure with two columns, and of a single panel, px.
const WIDTH: f64 = 1240.0;
const ALONE: f64 = 620.0;
/// Width below which a figure has one column, px.
const NARROW: f64 = 800.0;
/// Heights of a row with an x-t diagram (and of a single panel), and of other rows, px.
const TALL: f64 = 430.0;
const LOW: f64 = 310.0;
/// Width and height of the smallest panel in which titles, ticks and labels leave space for lines, px.
const SMALLEST: [f64; 2] = [260.0, 200.0];

/// Content of a panel.
pub(super) enum Content<'a> {
    Map(&'a View<'a>),
    Lines(LinePanel),
}

impl Content<'_> {
    pub fn heading(&self) -> String {
        match self {
            Self::Map(view) => map::heading(view),
            Self::Lines(panel) => panel.heading.clone(),
        }
    }

    fn draw(&self, drawing: &mut Drawing, area: Area, letter: Option<char>) -> Result<()> {
        let heading = letter.map_or_else(|| self.heading(), |letter| format!("({letter})  {}", self.heading()));
        match self {
            Self::Map(view) => map::draw(drawing, area, view, &heading),
            Self::Lines(panel) => {
                LinePanel { heading, ..panel.clone() }.draw(drawing, area);
                Ok(())
            }
        }
    }
}

/// Title and line of run parameters above the panels.
pub(super) struct Heading {
    pub title: String,
    pub about: String,
}

/// Draws all panels, lettered if there are several, in two columns if the figure is wide enough. `size` is that of the whole figure, px.
pub(super) fn compose(heading: Option<&Heading>, contents: &[Content], size: Option<[f64; 2]>) -> Result<Picture> {
    let header = if heading.is_some() { HEADER } else { MARGIN };
    let count = contents.len();
    let width = size.map_or(if count == 1 { ALONE } else { WIDTH }, |size| size[0]);
    let columns = if count == 1 || width < NARROW { 1 } else { 2 };
    let rows: Vec<&[Content]> = contents.chunks(columns).collect();
    let usual =
        |row: &&[Content]| if count == 1 || row.iter().any(|c| matches!(c, Content::Map(_))) { TALL } else { LOW };
    let usual: Vec<f64> = rows.iter().map(usual).collect();
    let gaps = GAP * (rows.len() - 1) as f64;
    let total = usual.iter().sum::<f64>();
    let room = size.map_or(total, |size| size[1] - header - MARGIN - gaps);
    let wide = (width - 2.0 * MARGIN - GAP * (columns - 1) as f64) / columns as f64;
    let lowest = room * usual.iter().fold(f64::INFINITY, |a, b| a.min(*b)) / total;
    if let Some([width, height]) = size
        && (wide < SMALLEST[0] || lowest < SMALLEST[1])
    {
        return Err(too_small([width, height], [wide, lowest], count).into());
    }
    let mut drawing = Drawing::default();
    if let Some(heading) = heading {
        draw_heading(&mut drawing, heading, width);
    }
    let mut y = header;
    let mut letters = ('a'..='z').cycle();
    for (row, usual) in rows.iter().zip(&usual) {
        let height = room * usual / total;
        for (column, content) in row.iter().enumerate() {
            let area = Area { x: MARGIN + (wide + GAP) * column as f64, y, width: wide, height };
            content.draw(&mut drawing, area, letters.next().filter(|_| count > 1))?;
        }
        y += height + GAP;
    }
    Ok(drawing.finish(width, y - GAP + MARGIN))
}

/// Draws a single panel without margins; `index` is its number among the pictures of a page.
pub(super) fn alone(content: &Content, [width, height]: [f64; 2], index: usize) -> Result<Picture> {
    let mut drawing = Drawing::of_page(index);
    content.draw(&mut drawing, Area { x: 0.0, y: 0.0, width, height }, None)?;
    Ok(drawing.finish(width, height))
}

fn draw_heading(drawing: &mut Drawing, heading: &Heading, width: f64) {
    let fitting = |size: f64| ((width - 2.0 * MARGIN) / (0.6 * size)) as usize;
    drawing.bold((MARGIN, 28.0), 19.0, Anchor::Start, &shortened(&heading.title, fitting(19.0)));
    drawing.text((MARGIN, 50.0), 13.0, Anchor::Start, &shortened(&heading.about, fitting(13.0)));
}

fn too_small([width, height]: [f64; 2], [wide, high]: [f64; 2], count: usize) -> InputError {
    let [least_wide, least_high] = SMALLEST;
    let panels = if count == 1 { "the panel".into() } else { format!("each of {count} panels") };
    let left = format!("{:.0} x {:.0} px for {panels}", wide.max(0.0), high.max(0.0));
    InputError::new(format!("a figure of {width} x {height} px leaves {left}"))
        .key("size")
        .allowed(format!("at least {least_wide} x {least_high} px for each panel"))
        .help("choose a larger size, or fewer panels")
}
