//! Findings as text and figures: a terminal summary, a Markdown and an HTML report, SVG. Returns strings; writes and prints nothing.

mod calibrated_view;
mod calibration;
mod compare;
mod driver_view;
mod epistemic_view;
mod exact_view;
mod figures;
mod figures_of_speech;
mod html;
mod json;
mod known_view;
mod markdown;
mod measures_view;
mod model_form_view;
mod page;
mod paper;
mod png;
mod rig;
mod sketch;
mod sweep;
mod tables;
mod terminal;
mod tighten;
mod trade_view;
mod view;

pub use calibration::{
    calibrated_card, calibrated_laws, calibration_markdown, calibration_terminal,
};
pub use compare::{compare_markdown, compare_terminal};
pub use figures::{
    Figure, ReportFigures, calibration_figures, figures, paper_figures, rig_figures,
    rig_mode_figures, sweep_figures,
};
pub use html::html;
pub use json::json;
pub use markdown::markdown;
pub use page::{Mark, page};
pub use paper::{PaperPage, paper_count, paper_page};
pub use png::png;
pub use rig::{
    rig_comparison_markdown, rig_comparison_terminal, rig_plan_markdown, rig_plan_terminal,
};
pub use sweep::{sweep_markdown, sweep_terminal};
pub use tables::table;
pub use terminal::{Style, terminal};
pub use tighten::{tighten_markdown, tighten_terminal};
