//! `reeldown`: Monte Carlo uncertainty and reliability analysis of viscous-brake reel-downs.
//!
//! See `ARCHITECTURE.md` for the floors and what may import what.

#![warn(missing_docs)]

pub mod calibration;
pub mod campaign;
pub mod cli;
pub mod descent;
pub mod error;
pub mod findings;
pub mod numerics;
pub mod outcomes;
pub mod physics;
pub mod reliability;
pub mod render;
pub mod sampling;
pub mod sensitivity;
pub mod store;
pub mod streams;
pub mod study;
pub mod uncertainty;
pub mod units;
