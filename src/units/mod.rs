//! Physical quantities and the units an engineer types.

mod display;
mod parse;
pub mod quantity;
pub mod spelling;
mod table;

pub use display::{DisplayUnit, System, display, engineering, format_engineering, number};
pub use parse::{UnitError, bare, parse};
pub use quantity::Quantity;
