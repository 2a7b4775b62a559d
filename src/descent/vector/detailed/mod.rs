//! The detailed models over lanes: temperature over the radius and across the film (see [`crate::physics::film`]).
//!
//! State: `l`, in the dynamic model `U` and `v`, the field of temperatures (radius by radius from the bore, at each from the wall to
//! the film's middle), the housing's temperature, `t`. The motion is that of `dynamic.rs` and `quasi_steady.rs`, with `v` itself in
//! place of `z = κ v`.

#![allow(
    clippy::needless_range_loop,
    reason = "an index is a point in space, of several fields at once"
)]

mod brake;
mod dynamic;
mod linear;
mod quasi_steady;

pub use dynamic::Dynamic;
pub use quasi_steady::QuasiSteady;
