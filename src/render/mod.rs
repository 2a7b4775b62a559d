//! Findings as text and figures: a terminal summary, a Markdown and an HTML report, SVG. Returns strings; writes and prints nothing.

mod driver_view;
mod figures;
mod figures_of_speech;
mod html;
mod known_view;
mod markdown;
mod paper;
mod rig;
mod tables;
mod terminal;
mod tighten;
mod trade_view;
mod view;

pub use figures::{Figure, ReportFigures, figures, paper_figures, rig_figures, rig_mode_figures};
pub use html::html;
pub use markdown::markdown;
pub use paper::{PaperPage, paper_page};
pub use rig::{rig_comparison_terminal, rig_plan_terminal};
pub use tables::table;
pub use terminal::{Style, terminal};
pub use tighten::{tighten_markdown, tighten_terminal};
