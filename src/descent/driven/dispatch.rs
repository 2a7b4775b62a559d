//! Members of a batch laid side by side in the machine's registers.

use super::course::course;
use super::record::{Correction, Record};
use super::{Prediction, Reading, Settings};
use crate::descent::vector::InstructionSet;
use crate::numerics::lanes::{Lanes, Wide};
#[cfg(target_arch = "x86_64")]
use crate::numerics::lanes::{Pair, avx2::Quartet, avx512::Octet};
use crate::physics::Coefficients;

/// Follows every member's run. Members whose fluid thins with shear go in groups of their own: the others
/// need none of its arithmetic.
pub(super) fn dispatch(
    set: InstructionSet,
    record: &Record,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    corrections: &[Correction],
    predictions: &mut [Prediction],
) {
    let room = Reading { line_m: 0.0, force_n: 0.0, speed_m_per_s: 0.0, temperatures_k: [0.0; 3] };
    for prediction in predictions.iter_mut() {
        prediction.readings.resize(record.times_s().len(), room);
    }
    for thins in [false, true] {
        let members: Vec<usize> =
            (0..batch.len()).filter(|&k| batch[k].fluid.shear_thinning == thins).collect();
        let mut rest = members.as_slice();
        while !rest.is_empty() {
            let width = widest(set, rest.len());
            let (group, later) = rest.split_at(rest.len().min(width));
            rest = later;
            let run = Run { record, settings, batch, corrections, members: group };
            match (set, width) {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: `widest` has seen that the machine has the features.
                (InstructionSet::Avx512, 16) => unsafe { octets(&run, predictions) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                (InstructionSet::Avx512, 8) => unsafe { octet(&run, predictions) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                (InstructionSet::Avx2, 8) => unsafe { quartets(&run, predictions) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                (InstructionSet::Avx2, 4) => unsafe { quartet(&run, predictions) },
                _ => run.follow::<f64>(predictions),
            }
        }
    }
}

/// Lanes to take for so many members: the wider, two registers, if that fills more than one of them; 1 where
/// the machine lacks the instruction set.
fn widest(set: InstructionSet, members: usize) -> usize {
    let register = match set {
        InstructionSet::Avx512 => 8,
        InstructionSet::Avx2 => 4,
        InstructionSet::Portable => 1,
    };
    match (set.is_available(), members > register) {
        (true, true) if register > 1 => 2 * register,
        (true, _) => register,
        (false, _) => 1,
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn octets(run: &Run<'_>, predictions: &mut [Prediction]) {
    run.follow::<Pair<Octet>>(predictions);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn octet(run: &Run<'_>, predictions: &mut [Prediction]) {
    run.follow::<Octet>(predictions);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn quartets(run: &Run<'_>, predictions: &mut [Prediction]) {
    run.follow::<Pair<Quartet>>(predictions);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn quartet(run: &Run<'_>, predictions: &mut [Prediction]) {
    run.follow::<Quartet>(predictions);
}

/// Some members' runs, one a lane.
struct Run<'a> {
    record: &'a Record,
    settings: &'a Settings,
    batch: &'a [Coefficients<f64>],
    /// Of the drive's instrument; members beyond its end have none.
    corrections: &'a [Correction],
    members: &'a [usize],
}

impl Run<'_> {
    #[inline(always)]
    fn follow<V: Lanes>(&self, predictions: &mut [Prediction]) {
        let Some(&first) = self.members.first() else { return };
        // Lanes without a member repeat the first.
        let mut fields = self.batch[first].fields().map(V::splat);
        for (lane, &member) in self.members.iter().enumerate() {
            for (field, value) in fields.iter_mut().zip(self.batch[member].fields()) {
                field.lanes_mut()[lane] = value;
            }
        }
        let correction =
            |member: usize| self.corrections.get(member).copied().unwrap_or_else(Correction::none);
        let alike = correction(first);
        let (mut gain, mut offset) = (V::splat(alike.gain), V::splat(alike.offset));
        for (lane, &member) in self.members.iter().enumerate() {
            let own = correction(member);
            gain.lanes_mut()[lane] = own.gain;
            offset.lanes_mut()[lane] = own.offset;
        }
        let correction = Correction { gain: Wide(gain), offset: Wide(offset) };
        let thins = self.batch[first].fluid.shear_thinning;
        let coefficients = Coefficients::from_fields(fields.map(Wide), thins);
        let keep = |k: usize, reading: Reading<Wide<V>>| {
            for (lane, &member) in self.members.iter().enumerate() {
                predictions[member].readings[k] = Reading {
                    line_m: reading.line_m.0.lanes()[lane],
                    force_n: reading.force_n.0.lanes()[lane],
                    speed_m_per_s: reading.speed_m_per_s.0.lanes()[lane],
                    temperatures_k: reading.temperatures_k.map(|node| node.0.lanes()[lane]),
                };
            }
        };
        course(self.record, self.settings, &coefficients, correction, keep);
    }
}
