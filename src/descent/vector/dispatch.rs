//! Which instruction set runs the kernel.

use super::batch::Batch;
use super::detailed;
use super::dynamic::Dynamic;
use super::quasi_steady::QuasiSteady;
use super::queue::run;
use super::settings::{Attempt, Counts};
use crate::descent::model::Model;
use crate::descent::outcome::{Fault, Outcome};
use crate::numerics::lanes::{InstructionSet, Lanes};

/// Runs the kernel of a model with an instruction set, or portably where the machine lacks it.
pub(super) fn dispatch(
    set: InstructionSet,
    model: Model,
    attempt: Attempt,
    batch: Batch,
    results: &mut [Result<Outcome, Fault>],
    doubtful: &mut Vec<usize>,
) -> Counts {
    match set {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx512 if set.is_available() => unsafe {
            avx512(model, attempt, batch, results, doubtful)
        },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx2 if set.is_available() => unsafe {
            avx2(model, attempt, batch, results, doubtful)
        },
        _ => with_lanes::<f64, f64>(model, attempt, batch, results, doubtful),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn avx512(
    model: Model,
    attempt: Attempt,
    batch: Batch,
    results: &mut [Result<Outcome, Fault>],
    doubtful: &mut Vec<usize>,
) -> Counts {
    use crate::numerics::lanes::{Pair, avx512::Octet};
    with_lanes::<Pair<Octet>, Octet>(model, attempt, batch, results, doubtful)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2(
    model: Model,
    attempt: Attempt,
    batch: Batch,
    results: &mut [Result<Outcome, Fault>],
    doubtful: &mut Vec<usize>,
) -> Counts {
    use crate::numerics::lanes::{Pair, avx2::Quartet};
    with_lanes::<Pair<Quartet>, Quartet>(model, attempt, batch, results, doubtful)
}

/// Runs the kernel over lanes; the detailed models over narrower ones, whose states are wide enough by themselves.
#[inline(always)]
fn with_lanes<V: Lanes, W: Lanes>(
    model: Model,
    attempt: Attempt,
    batch: Batch,
    results: &mut [Result<Outcome, Fault>],
    doubtful: &mut Vec<usize>,
) -> Counts {
    match model {
        Model::Dynamic => run::<V, Dynamic<V>, 7>(attempt, batch, results, doubtful),
        Model::QuasiSteady => run::<V, QuasiSteady<V>, 5>(attempt, batch, results, doubtful),
        Model::DetailedDynamic if attempt.fine_space => {
            run::<W, detailed::Dynamic<W, 7, 4>, 33>(attempt, batch, results, doubtful)
        }
        Model::DetailedQuasiSteady if attempt.fine_space => {
            run::<W, detailed::QuasiSteady<W, 7, 4>, 31>(attempt, batch, results, doubtful)
        }
        Model::DetailedDynamic => {
            run::<W, detailed::Dynamic<W, 6, 3>, 23>(attempt, batch, results, doubtful)
        }
        Model::DetailedQuasiSteady => {
            run::<W, detailed::QuasiSteady<W, 6, 3>, 21>(attempt, batch, results, doubtful)
        }
    }
}
