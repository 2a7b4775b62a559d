//! Rig runs in, a posterior of the card's inputs out.

mod channel;
mod likelihood;
mod plan;

pub use channel::Channel;
pub use likelihood::{Coordinate, RigLikelihood, Slopes};
pub use plan::*;
