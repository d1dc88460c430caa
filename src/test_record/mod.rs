//! Reduction of the record of a tension or compression test to a curve: reading, cleaning, elastic line, proof stress, smoothing, knots.

mod clean;
mod decimate;
mod fit;
mod heading;
mod local;
mod maximum;
mod modulus;
mod noise;
mod reduce;
mod repeats;
mod rounding;
mod short_table;
mod smooth;
mod table;
mod text;

pub use heading::Kind;
pub use modulus::ElasticLine;
pub use reduce::{PROOF_OFFSET, Reduce, Reduction, reduce};
pub use repeats::{Repeats, combine};
pub use rounding::{strain_step, stress_step};
pub use short_table::{Straightened, straighten};
pub use table::{Reading, Record, UnitsNamed, name, read};
pub use text::MaterialText;
