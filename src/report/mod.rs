//! Pictures and pages from result files and studies.

mod axes;
mod colour;
pub mod compare;
pub mod compare_results;
pub mod cost;
mod display;
mod figure;
mod grid;
mod impact;
pub mod impact_cost;
pub mod invert;
pub mod lines;
mod map;
mod page;
mod panels;
pub mod plot;
mod svg;
pub mod sweep;
pub mod tension;
pub mod test_record;
mod view;

pub use display::Units;
pub use figure::draw;
pub use page::page;
