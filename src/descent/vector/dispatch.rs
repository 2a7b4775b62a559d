//! Which instruction set runs the kernel.

use super::dynamic::Dynamic;
use super::quasi_steady::QuasiSteady;
use super::queue::run;
use super::settings::{Counts, Settings};
use crate::descent::model::Model;
use crate::descent::outcome::{Fault, Outcome};
use crate::numerics::lanes::Lanes;
use crate::physics::Coefficients;

/// An instruction set that the kernel has a path for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InstructionSet {
    /// One lane, on any machine.
    Portable,
    /// Four-lane registers with fused multiply-add.
    Avx2,
    /// Eight-lane registers.
    Avx512,
}

impl InstructionSet {
    /// All, the fastest last.
    pub const ALL: [InstructionSet; 3] =
        [InstructionSet::Portable, InstructionSet::Avx2, InstructionSet::Avx512];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            InstructionSet::Portable => "portable",
            InstructionSet::Avx2 => "AVX2",
            InstructionSet::Avx512 => "AVX-512",
        }
    }

    /// Whether this machine has it.
    pub fn is_available(self) -> bool {
        match self {
            InstructionSet::Portable => true,
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => {
                is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
            }
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => {
                is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The fastest that this machine has.
    pub fn best() -> Self {
        Self::ALL.into_iter().rev().find(|set| set.is_available()).unwrap_or(Self::Portable)
    }
}

/// Runs the kernel of a model with an instruction set, or portably where the machine lacks it.
pub(super) fn dispatch(
    set: InstructionSet,
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    match set {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx512 if set.is_available() => unsafe {
            avx512(model, settings, batch, results)
        },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx2 if set.is_available() => unsafe {
            avx2(model, settings, batch, results)
        },
        _ => with_lanes::<f64>(model, settings, batch, results),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn avx512(
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    type Octets = crate::numerics::lanes::Pair<crate::numerics::lanes::avx512::Octet>;
    with_lanes::<Octets>(model, settings, batch, results)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2(
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    type Quartets = crate::numerics::lanes::Pair<crate::numerics::lanes::avx2::Quartet>;
    with_lanes::<Quartets>(model, settings, batch, results)
}

#[inline(always)]
fn with_lanes<V: Lanes>(
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    match model {
        Model::Dynamic => run::<V, Dynamic<V>, 7>(settings, batch, results),
        Model::QuasiSteady => run::<V, QuasiSteady<V>, 5>(settings, batch, results),
    }
}
