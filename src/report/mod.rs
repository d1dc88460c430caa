//! Pictures and pages from result files and studies.

mod axes;
mod colour;
pub mod compare;
pub mod cost;
mod display;
mod figure;
mod map;
mod page;
mod panels;
pub mod plot;
mod svg;
mod view;

pub use display::Units;
pub use figure::draw;
pub use page::page;
