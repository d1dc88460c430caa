//! The tension-impact test: a specimen is pulled at one end at each of a series of impact velocities until it fractures.
//!
//! As the impact velocity increases, the elongation at fracture has a maximum below the critical velocity. Above it, the elongation falls sharply,
//! because the specimen fractures immediately at the struck end: T. von Kármán and P. Duwez, J. Appl. Phys. 21 (1950) 987; D. S. Clark and D. S.
//! Wood, Trans. ASM 42 (1950) 45; M. Manjoine and A. Nadai, Proc. ASTM 40 (1940) 822.

mod limit;
mod plan;
mod results;

pub use plan::{FarEnd, SPECIMEN, Specimen, Test};
pub use results::{Point, Results, results, write_csv, write_hdf5};
