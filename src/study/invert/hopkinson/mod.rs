//! Split-Hopkinson (Kolsky) bar: from the strain gauges on the bars to the specimen's stress, strain and strain rate.
//!
//! With the incident, reflected and transmitted strains i, r and t at the faces of the specimen (the gauge records, shifted by their
//! distances over the bar speed c), positive in the sense of the incident pulse:
//! faces `v1 = c1 (i - r)`, `v2 = c2 t`; forces `F1 = E1 A1 (i + r)`, `F2 = E2 A2 t`.
//! Three waves: rate `(v1 - v2)/L`, stress `(F1 + F2)/(2 A_s)`. One wave, which assumes equilibrium, `F1 = F2`: stress `F2/A_s`, rate
//! `(-2 c1 r + (c1 E2 A2/(E1 A1) - c2) t)/L`, between equal bars `-2 c1 r/L`.
//! The zero offset of a gauge, its mean before the pulse, is removed.
//! H. Kolsky, Proc. Phys. Soc. B 62, 1949; G. T. Gray, ASM Handbook 8, 2000.
//!
//! Dispersion in the bars is not corrected.

mod pulse;
mod read;
mod reduce;
mod test_set;

pub use read::{Test, records_from_csv};
pub use reduce::{Knot, Moment, Options, Reduced, reduce};
pub use test_set::{ElasticBar, Record, Records, Setup};
