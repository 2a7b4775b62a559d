//! `reeldown`: Monte Carlo uncertainty and reliability analysis of viscous-brake reel-downs.
//!
//! See `ARCHITECTURE.md` for the floors and what may import what.

#![warn(missing_docs)]

pub mod descent;
pub mod error;
pub mod numerics;
pub mod physics;
pub mod streams;
pub mod units;
