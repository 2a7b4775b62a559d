//! What a caller chooses, and what the kernel counts.

use crate::descent::model::Model;

/// The numerical settings of an ensemble.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Largest relative error wanted in time, final velocity and peak fluid temperature, in [`TOLERANCES`];
    /// beyond either end, that end.
    ///
    /// Measured against runs at 1e-11: it holds for the worst of 10 000 members of the default study, and
    /// ten times it for a stress set (viscosity × 0.2 … × 5, 0 … 100 °F, Cross thinning, runaways, descents
    /// that do not deploy). The other outcomes keep to thirty and to a hundred times it, of the detailed models to a hundred times
    /// it in both sets: their peaks are read off a cubic over steps that the film's own start-up bends.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { tolerance: default_tolerance() }
    }
}

/// The tolerances that can be kept: below, rounding is larger; above, the steps are no longer those of a
/// smooth solution.
pub const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-12..=1e-3;

/// The tolerance of a study that names none.
pub fn default_tolerance() -> f64 {
    1e-6
}

/// The detailed models resolve time, final velocity and hottest fluid to 1e-4 with six points along the radius and five across
/// the film, and to some 3e-6, the best that they promise, with seven and seven.
const COARSEST_FINE: f64 = 5e-5;

impl Settings {
    /// Whether a detailed model takes its finer points.
    pub(super) fn fine_space(&self) -> bool {
        self.tolerance < COARSEST_FINE
    }

    /// The bound on a step's weighted error: measured to give the wanted one at the end.
    pub(super) fn local_tolerance(&self, model: Model) -> f64 {
        let factor = match model {
            Model::Dynamic => 2.4,
            Model::QuasiSteady => 1.8,
            Model::DetailedDynamic | Model::DetailedQuasiSteady => 1.4,
        };
        factor * self.tolerance.clamp(*TOLERANCES.start(), *TOLERANCES.end())
    }
}

/// What an ensemble cost. The same whatever the batch's order and the instruction set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Descents integrated, faults included, impossible inputs not.
    pub descents: u64,
    /// Step attempts.
    pub attempts: u64,
    /// Attempts that were rejected.
    pub rejected: u64,
    /// Right-hand sides that the steps needed.
    pub evaluations: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.descents += other.descents;
        self.attempts += other.attempts;
        self.rejected += other.rejected;
        self.evaluations += other.evaluations;
    }
}
