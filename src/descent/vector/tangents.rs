//! The kernel differentiated: one descent, with the derivatives of its outcomes along several directions.

use super::constants::Constants;
use super::detailed;
use super::dynamic::Dynamic;
use super::group::Group;
use super::model::Model;
use super::quasi_steady::QuasiSteady;
use super::settings::{Attempt, Settings};
use super::settle::attempt_of;
use crate::descent::model::Model as Kind;
use crate::descent::outcome::{Fault, OUTCOME_COUNT, Outcome};
use crate::numerics::dual::Dual;
use crate::numerics::lanes::Tangent;
use crate::physics::Coefficients;

/// Directions of one pass, as many as are worth one integration.
pub const DIRECTIONS: usize = 8;

/// An outcome, and the derivatives of each of its quantities along the directions.
pub type Derivatives = (Outcome, [[f64; DIRECTIONS]; OUTCOME_COUNT]);

/// Integrates one descent with derivatives. The values are those of the plain kernel to the bit; step
/// sizes are taken as constants, so that the derivatives are those of the sequence of steps, as accurate as
/// the steps themselves.
///
/// # Errors
/// The fault of the descent.
pub fn differentiate(
    model: Kind,
    settings: &Settings,
    coefficients: &Coefficients<Dual<DIRECTIONS>>,
    plain: &Coefficients<f64>,
) -> Result<Derivatives, Fault> {
    type Lane = Tangent<DIRECTIONS>;
    let attempt = attempt_of(model, settings, plain)?;
    match model {
        Kind::Dynamic => run::<Dynamic<Lane>, 7>(attempt, coefficients, plain),
        Kind::QuasiSteady => run::<QuasiSteady<Lane>, 5>(attempt, coefficients, plain),
        Kind::DetailedDynamic if attempt.fine_space => {
            run::<detailed::Dynamic<Lane, 7, 4>, 33>(attempt, coefficients, plain)
        }
        Kind::DetailedQuasiSteady if attempt.fine_space => {
            run::<detailed::QuasiSteady<Lane, 7, 4>, 31>(attempt, coefficients, plain)
        }
        Kind::DetailedDynamic => {
            run::<detailed::Dynamic<Lane, 6, 3>, 23>(attempt, coefficients, plain)
        }
        Kind::DetailedQuasiSteady => {
            run::<detailed::QuasiSteady<Lane, 6, 3>, 21>(attempt, coefficients, plain)
        }
    }
}

#[inline(always)]
fn run<M: Model<Tangent<DIRECTIONS>, N>, const N: usize>(
    attempt: Attempt,
    coefficients: &Coefficients<Dual<DIRECTIONS>>,
    plain: &Coefficients<f64>,
) -> Result<Derivatives, Fault> {
    let values = Constants::possible(plain).ok_or(Fault::ImpossibleInput)?;
    let constants =
        Constants::new(coefficients).map(|dual| Tangent { value: dual.value, slopes: dual.slopes });
    let mut start = M::start(&constants, &attempt);
    start.step.slopes = [0.0; DIRECTIONS];
    let mut group = Group::<_, M, N>::new(M::new(constants), &start, attempt);
    group.model.set_any_cross(values.cross_on > 0.5);
    loop {
        let moment = group.look();
        if group.finished() != 0 {
            let outcome = group.result(0).0?;
            return Ok((outcome, group.outcomes().map(|value| value.slopes)));
        }
        group.advance(&moment);
    }
}
