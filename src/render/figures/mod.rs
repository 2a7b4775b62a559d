//! The figures of a report as SVG text.
//!
//! Axes, ticks, scales, text metrics and the SVG itself are the `kuva` library's (MIT, one light tree of
//! dependencies, pinned because it moves fast). It was chosen over `plotters` by looking at the same
//! histogram, log tail and fan drawn by both: plotters puts every mark on a whole pixel, which shows in
//! bands and narrow bins, prints `100.0` on every tick, and measures no text, so labels collide; kuva
//! draws to a hundredth of a pixel and reserves margins from real glyph widths. Of kuva only this level is
//! used: its ready-made histogram puts ticks on bin edges and starts a log axis at 10⁻⁴ of a count, and it
//! draws limits over data, so the marks and keys are placed by [`chart`] on kuva's scene. Its SVG has no
//! `viewBox` and no accessible name; both are added here.
//!
//! The palette is Okabe and Ito's, distinct to colour-blind eyes and in grey: what keeps the limits is
//! blue, what breaches them vermillion, and a limit is a labelled dashed line.
//!
//! The same findings give the same bytes. PNG is made from the SVG on request ([`super::png`]).

mod axis;
mod calibration;
mod chart;
mod contour;
mod convergence;
mod curves;
mod distribution;
mod drivers;
mod fan;
mod go;
mod go_map;
mod interaction;
mod key;
mod paper;
mod rig;
mod svg;
mod sweep;
mod sweep_map;
mod trade;
mod unknown;

use crate::analysis::Findings;

pub use calibration::calibration_figures;
pub use paper::{paper_figures, starting_temperature_figure};
pub use rig::{rig_figures, rig_mode_figures};
pub use sweep::sweep_figures;

/// One figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// File name without ending, unique in a report: `histogram-time`.
    pub name: String,
    /// What it shows, as a heading.
    pub title: String,
    /// How to read it, in a sentence or two.
    pub caption: String,
    /// What is seen, for who cannot see it.
    pub alternative: String,
    /// A complete SVG document.
    pub svg: String,
}

impl Figure {
    /// The file's name in the directory of figures.
    pub fn file_name(&self) -> String {
        format!("{}.svg", self.name)
    }

    /// The figure in a Markdown report beside the directory `figures`, with its caption.
    pub(super) fn markdown(&self) -> String {
        format!(
            "![{}](figures/{})\n\n{}\n\n",
            self.alternative.replace(['[', ']'], ""),
            self.file_name(),
            self.caption
        )
    }
}

/// Where in a report figures go.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportFigures {
    /// Beside the probabilities: how the estimate settled.
    pub probabilities: Vec<Figure>,
    /// Beside the margins: how each limited outcome is distributed.
    pub margins: Vec<Figure>,
    /// Beside the drivers: tornado, interaction.
    pub drivers: Vec<Figure>,
    /// Beside the trade of tolerances: P(any breach) against spreads.
    pub trade: Vec<Figure>,
    /// Beside what becomes known when: go or no go.
    pub known: Vec<Figure>,
    /// Beside what is not known: the belief about P, p-boxes.
    pub epistemic: Vec<Figure>,
    /// Beside the descents: fans.
    pub descents: Vec<Figure>,
}

impl ReportFigures {
    /// All, in the order in which they appear.
    pub fn all(&self) -> impl Iterator<Item = &Figure> {
        let sections = [
            &self.probabilities,
            &self.margins,
            &self.drivers,
            &self.trade,
            &self.known,
            &self.epistemic,
            &self.descents,
        ];
        sections.into_iter().flatten()
    }
}

/// Every figure of a run's report.
pub fn figures(findings: &Findings) -> ReportFigures {
    let data = &findings.figures;
    ReportFigures {
        probabilities: data.convergence.iter().filter_map(convergence::figure).collect(),
        margins: data
            .distributions
            .iter()
            .flat_map(|d| [distribution::histogram(d), distribution::exceedance(d)])
            .flatten()
            .collect(),
        drivers: drivers::figures(findings)
            .into_iter()
            .chain(data.interaction.as_ref().ok().and_then(interaction::figure))
            .collect(),
        trade: trade::figure(findings).into_iter().collect(),
        known: findings
            .known
            .charts
            .iter()
            .filter_map(go::figure)
            .chain(findings.known.map.as_ref().and_then(go_map::figure))
            .collect(),
        epistemic: unknown::figures(&findings.epistemic),
        descents: fan::figures(findings),
    }
}
