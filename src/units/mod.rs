//! Physical quantities and the units an engineer types.

pub mod quantity;

pub use quantity::Quantity;
