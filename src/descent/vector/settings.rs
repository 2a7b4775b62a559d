//! What a caller chooses, and what the kernel counts.

use crate::descent::model::Model;
use crate::descent::outcome::{OUTCOME_COUNT, OutcomeQuantity};

/// The numerical settings of an ensemble.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Largest relative error wanted in time, final velocity and peak fluid temperature, in [`TOLERANCES`];
    /// beyond either end, that end.
    ///
    /// Measured against runs at 1e-11: it holds for the worst of 10 000 members of the default study, and
    /// ten times it for a stress set (viscosity × 0.2 … × 5, 0 … 100 °F, Cross thinning, runaways, descents
    /// that do not deploy). The other outcomes keep to thirty and to a hundred times it, of the detailed models to a hundred times
    /// it in both sets: their peaks are read off a cubic over steps that the film's own start-up bends. What holds
    /// whatever the design is [`Settings::promise`].
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { tolerance: default_tolerance(Model::default()) }
    }
}

/// The tolerances that can be kept: below, rounding is larger; above, the steps are no longer those of a
/// smooth solution.
pub const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-12..=1e-3;

/// The tolerance of a study that names none: of the detailed models the finest that their few points in space keep, as
/// more points take four times as long.
pub fn default_tolerance(model: Model) -> f64 {
    if model.is_detailed() { 1e-4 } else { 1e-6 }
}

/// The detailed models resolve time, final velocity and hottest fluid to 1e-4 with six points along the radius and five across
/// the film where that is not much thinner where it is hot (see `possible.rs`), and to some 3e-6, the best that they
/// promise, with seven and seven.
const COARSEST_FINE: f64 = 5e-5;

/// Tightest tolerance that the arithmetic can serve.
pub(super) const TIGHTEST: f64 = 1e-12;

/// An outcome beyond what is possible by this many tolerances is impossible.
pub(super) const IMPOSSIBLE_SLACK: f64 = 10.0;

impl Settings {
    /// The tolerance that is used.
    fn used(&self) -> f64 {
        self.tolerance.clamp(TIGHTEST, 1e-3)
    }

    /// The first attempt at every descent.
    pub(super) fn attempt(&self) -> Attempt {
        Attempt {
            tolerance: self.used(),
            first_step: None,
            fine_space: self.tolerance < COARSEST_FINE,
        }
    }

    /// The attempts at a descent that the first left in doubt, each from rest, tighter by ten and with a shorter
    /// first step than the one before: two that share their first step would share what it misses. The detailed models
    /// take their finer points.
    pub(super) fn closer(&self) -> impl Iterator<Item = Attempt> {
        let (mut tolerance, mut share) = (self.used(), 0.1);
        std::iter::from_fn(move || {
            (tolerance, share) = (0.1 * tolerance, 0.1 * share);
            let attempt = Attempt { tolerance, first_step: Some(share), fine_space: true };
            (tolerance >= 0.99 * TIGHTEST).then_some(attempt)
        })
    }

    /// The largest relative error of an outcome that a descent is returned with, whatever the design, as far as
    /// runs at several tolerances tell: so many times the tolerance, and twice that below 1e-6 (nothing below 1e-8 is
    /// promised). Measured on 60 000 hard designs at each tolerance from 1e-3 to 1e-8: `tests/truth/hard_designs.rs`.
    pub fn promise(&self, outcome: OutcomeQuantity) -> f64 {
        let used = self.used().max(1e-8);
        // A peak's error falls with the square of a step, the step with the fourth root of the tolerance.
        let close = if used < 0.99e-6 { 2.0 } else { 1.0 };
        close * PROMISED[outcome as usize] * used
    }
}

/// By how many times the tolerance each outcome may err on a hard design, in the order of
/// [`OutcomeQuantity::ALL`].
pub(super) const PROMISED: [f64; OUTCOME_COUNT] =
    [30.0, 100.0, 30.0, 100.0, 100.0, 100.0, 100.0, 30.0, 10.0, 10.0];

/// One attempt at descents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attempt {
    /// Relative error wanted.
    pub tolerance: f64,
    /// Where not none: from rest always, with this share of the usual first step.
    pub first_step: Option<f64>,
    /// Whether a detailed model takes its finer points.
    pub fine_space: bool,
}

impl Attempt {
    /// The bound on a step's weighted error: measured to give the wanted one at the end.
    pub fn local_tolerance(&self, model: Model) -> f64 {
        let factor = match model {
            Model::Dynamic => 2.4,
            Model::QuasiSteady => 1.8,
            Model::DetailedDynamic | Model::DetailedQuasiSteady => 1.4,
        };
        factor * self.tolerance
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
