//! Findings as text: a terminal summary and a Markdown report. Returns strings; writes and prints nothing.

mod driver_view;
mod figures_of_speech;
mod known_view;
mod markdown;
mod tables;
mod terminal;
mod tighten;
mod trade_view;
mod view;

pub use markdown::markdown;
pub use tables::table;
pub use terminal::{Style, terminal};
pub use tighten::{tighten_markdown, tighten_terminal};
