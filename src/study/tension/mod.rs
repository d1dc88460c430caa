//! The tension-impact test: a specimen is pulled at one end with one of many impact velocities until it breaks.
//!
//! The elongation at fracture against the impact velocity has its maximum below the critical velocity and falls sharply above it, where the
//! specimen breaks at the struck end at once: T. von Kármán and P. Duwez, J. Appl. Phys. 21 (1950) 987; D. S. Clark and D. S. Wood, Trans. ASM
//! 42 (1950) 45; M. Manjoine and A. Nadai, Proc. ASTM 40 (1940) 822.

mod plan;
mod results;

pub use plan::{FarEnd, SPECIMEN, Specimen, Test};
pub use results::{Point, Results, results, write_csv, write_hdf5};
