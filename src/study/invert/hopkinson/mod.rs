//! Split-Hopkinson (Kolsky) bar: stress, strain and strain rate of the specimen from the strain gauges on the bars.
//!
//! The incident, reflected and transmitted strains i, r and t at the faces of the specimen are the gauge records, shifted by the gauge distances over
//! the bar speed c. They are positive in the sense of the incident pulse. Face velocities: `v1 = c1 (i - r)`, `v2 = c2 t`. Face forces:
//! `F1 = E1 A1 (i + r)`, `F2 = E2 A2 t`.
//!
//! Three-wave analysis: rate `(v1 - v2)/L`, stress `(F1 + F2)/(2 A_s)`. One-wave analysis, which assumes equilibrium, `F1 = F2`: stress `F2/A_s`,
//! rate `(-2 c1 r + (c1 E2 A2/(E1 A1) - c2) t)/L`, which is `-2 c1 r/L` for equal bars. The zero offset of a gauge, its mean before the pulse, is
//! removed. H. Kolsky, Proc. Phys. Soc. B 62, 1949; G. T. Gray, ASM Handbook 8, 2000.
//!
//! Dispersion in the bars is not corrected.

mod pulse;
mod read;
mod reduce;
mod test_set;

pub use read::{Test, records_from_csv};
pub use reduce::{Knot, Moment, Options, Reduced, reduce};
pub use test_set::{ElasticBar, Record, Records, Setup};
