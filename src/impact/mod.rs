//! Impacts that are not followed as waves: closed forms.

mod specimen;

pub use specimen::{Blow, Outcome, Specimen, Toughness};
