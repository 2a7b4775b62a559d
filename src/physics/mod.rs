//! The equations of a viscous-brake reel-down, one file a subject, generic over the number type.
//!
//! Source of the equations, unless a formula says otherwise: G. Jumper, *Improved Viscous Brake
//! Design Using Simulation*; "paper (7)" means its equation 7.

pub mod balloon;
pub mod brake;
pub mod coefficients;
pub mod design;
pub mod film;
pub mod fluid;
pub mod motion;
pub mod parameters;
pub mod payload;
pub mod quasi_steady;
pub mod reel;
pub mod space;
pub mod thermal;

pub use coefficients::{Coefficients, FIELD_COUNT};
pub use design::{Design, Target};
pub use parameters::{PARAMETERS, Parameter, ParameterInfo};

/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.80665;
