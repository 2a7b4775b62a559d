//! Derivatives of a descent's outcomes with respect to the inputs of its design.
//!
//! The vector kernel is run over numbers that carry derivatives, from the design's values through the
//! coefficients to the outcomes. A peak's derivative is that of the value at the moment of the peak;
//! where two moments tie, or a descent is about to miss the time limit, the derivative is one-sided.

use super::model::Model;
use super::outcome::{Fault, OUTCOME_COUNT, Outcome, OutcomeQuantity};
use super::vector::Settings;
use super::vector::tangents::{DIRECTIONS, differentiate};
use crate::numerics::dual::Dual;
use crate::numerics::real::Real;
use crate::physics::{Coefficients, Design, Parameter, Target};

/// An outcome and its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// The outcome at the design, the same bits as a descent without derivatives gives.
    pub outcome: Outcome,
    /// For each target, the derivatives of [`Outcome::values`] with respect to it, SI.
    pub derivatives: Vec<[f64; OUTCOME_COUNT]>,
}

impl Gradient {
    /// The derivatives of one quantity with respect to every target, SI.
    pub fn of(&self, quantity: OutcomeQuantity) -> Vec<f64> {
        self.derivatives.iter().map(|row| row[quantity as usize]).collect()
    }
}

/// The outcome of a design and its derivatives with respect to the targets.
///
/// A whole gap's derivative is that of moving every surface's gap together. The number of rotors is a whole
/// number: its derivative is zero. So is that of a surface that the design does not have. Cost: one
/// descent for every eight targets, each some fifteen times a plain one in a lane of its own.
///
/// # Errors
/// The fault of the descent.
pub fn gradient(
    model: Model,
    settings: &Settings,
    design: &Design<f64>,
    targets: &[Target],
) -> Result<Gradient, Fault> {
    let thinning = design.get(Parameter::FluidCrossTimeConstant) > 0.0;
    let plain = Coefficients::new(design);
    let base = design.map(Dual::<DIRECTIONS>::constant);
    let mut outcome = None;
    let mut derivatives = Vec::with_capacity(targets.len());
    let mut rest = targets;
    while outcome.is_none() || !rest.is_empty() {
        let (chunk, later) = rest.split_at(rest.len().min(DIRECTIONS));
        rest = later;
        let mut varied = base.clone();
        for (k, &target) in chunk.iter().enumerate() {
            vary(&mut varied, target, k);
        }
        let coefficients = Coefficients::with_shear_thinning(&varied, thinning);
        let (found, slopes) = differentiate(model, settings, &coefficients, &plain)?;
        outcome = Some(found);
        for k in 0..chunk.len() {
            derivatives.push(slopes.map(|slope| slope[k]));
        }
    }
    outcome.map(|outcome| Gradient { outcome, derivatives }).ok_or(Fault::NotFinite)
}

/// Lets the design vary along direction `k` at a target, on top of the directions it varies along already.
fn vary(design: &mut Design<Dual<DIRECTIONS>>, target: Target, k: usize) {
    let nudge = |mut value: Dual<DIRECTIONS>| {
        value.slopes[k] += 1.0;
        value
    };
    match target.surface {
        Some(surface) => {
            if let Some(&gap) = design.gaps().get(surface) {
                design.set(target, nudge(gap));
            }
        }
        None if target.parameter == Parameter::BrakeGap => {
            for surface in 0..design.surfaces() {
                vary(design, Target::gap(surface), k);
            }
        }
        None if target.parameter == Parameter::BrakeRotors => {}
        None => design.set(target, nudge(design.get(target.parameter))),
    }
}
