//! Findings as text and figures: a terminal summary, a Markdown and an HTML report, SVG. Returns strings; writes and prints nothing.

mod calibration;
mod driver_view;
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

pub use calibration::{
    calibrated_card, calibrated_laws, calibration_markdown, calibration_terminal,
};
pub use figures::{Figure, ReportFigures, calibration_figures, figures, paper_figures};
pub use html::html;
pub use markdown::markdown;
pub use tables::table;
pub use terminal::{Style, terminal};
pub use tighten::{tighten_markdown, tighten_terminal};
