//! One life of the rig: from release to the end of the line, an outcome or a fault.

pub mod outcome;

pub use outcome::{Fault, Outcome, OutcomeQuantity};
