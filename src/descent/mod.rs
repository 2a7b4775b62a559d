//! One life of the rig: from release to the end of the line, an outcome or a fault.

pub mod model;
pub mod outcome;
pub mod reference;

pub use model::Model;
pub use outcome::{Fault, Outcome, OutcomeQuantity};
