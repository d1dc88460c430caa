//! Figures and pages from result files and studies.

mod axes;
mod axis;
mod canvas;
mod colour;
pub mod compare;
pub mod compare_results;
pub mod cost;
mod display;
mod drawing;
mod figure;
mod grid;
mod histories;
mod html;
mod impact;
pub mod impact_cost;
pub mod invert;
mod layout;
pub mod lines;
mod map;
mod page;
mod panel;
mod pdf;
pub mod plot;
mod png;
mod profiles;
mod slider;
mod svg;
pub mod sweep;
pub mod tension;
pub mod test_record;
mod theory;
mod view;

pub use display::Units;
pub use drawing::Picture;
pub use figure::{Figure, PanelName, draw};
pub use page::page;
