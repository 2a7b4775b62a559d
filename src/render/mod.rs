//! Findings as text and figures: a terminal summary, a Markdown and an HTML report, SVG. Returns strings; writes and prints nothing.

mod calibrated_view;
mod driver_view;
mod epistemic_view;
mod figures;
mod figures_of_speech;
mod html;
mod known_view;
mod markdown;
mod tables;
mod terminal;
mod tighten;
mod trade_view;
mod view;

pub use figures::{Figure, ReportFigures, figures, paper_figures};
pub use html::html;
pub use markdown::markdown;
pub use tables::table;
pub use terminal::{Style, terminal};
pub use tighten::{tighten_markdown, tighten_terminal};
