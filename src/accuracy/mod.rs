//! Differences between runs: responses of a bar, the error of one response against another, and Richardson extrapolation.

mod front_errors;
mod joint_forces;
mod recorders;
mod respond;
mod response;
mod richardson;
mod shape;
mod similar;

pub use front_errors::{Companions, SAFETY_OF_TRACKING};
pub use recorders::{FrontRecorder, GridRecorder};
pub use respond::{Ended, Respond, ResponseRequest, respond};
pub use response::{INSTANTS, Response, evenly};
pub use richardson::{Estimate, Rules, SAFETY, SAFETY_OF_FRONTS, extrapolate};
pub use shape::{Cells, Shape};
pub use similar::similar_response;
