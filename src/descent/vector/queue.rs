//! The queue: lanes are refilled as they finish, so that a slow descent does not hold its mates idle.

use super::batch::Batch;
use super::group::{Group, WIDEST};
use super::model::Model;
use super::ready::Ready;
use super::rosenbrock::STAGES;
use super::settings::{Attempt, Counts};
use crate::descent::outcome::{Fault, Outcome};
use crate::numerics::lanes::Lanes;

/// Integrates every descent of the batch once; the places of those worth a second look are left in `doubtful`.
#[inline(always)]
pub fn run<V: Lanes, M: Model<V, N>, const N: usize>(
    attempt: Attempt,
    batch: Batch,
    results: &mut [Result<Outcome, Fault>],
    doubtful: &mut Vec<usize>,
) -> Counts {
    let mut counts = Counts::default();
    let mut ready = Ready::<V, N>::new(batch, attempt);
    let mut group = ready.group::<M>();
    let mut sample = [0; WIDEST];
    let mut live = 0u32;
    // At first every lane waits for a descent.
    let mut vacant = u32::MAX >> (32 - V::WIDTH);
    loop {
        let moment = group.look();
        let mut done = (group.finished() & live) | vacant;
        vacant = 0;
        let refill = done != 0;
        while done != 0 {
            let lane = done.trailing_zeros() as usize;
            done &= done - 1;
            if live & (1 << lane) != 0 {
                let (result, doubt) = group.result(lane);
                results[sample[lane]] = result;
                if doubt {
                    doubtful.push(sample[lane]);
                }
                counts.attempts += group.attempts.lanes()[lane] as u64;
                counts.descents += 1;
                counts.evaluations += 1;
            }
            match ready.next::<M>(results) {
                Some((index, from)) => {
                    live |= 1 << lane;
                    sample[lane] = index;
                    ready.load(from, &mut group, lane);
                }
                None => live &= !(1 << lane),
            }
        }
        if refill {
            if live == 0 {
                return counts;
            }
            notice_cross(&mut group);
        }
        let (tried, accepted) = group.advance(&moment);
        let rejected = u64::from((tried & !accepted & live).count_ones());
        counts.rejected += rejected;
        counts.evaluations += STAGES as u64 * u64::from((tried & live).count_ones()) - rejected;
    }
}

fn notice_cross<V: Lanes, M: Model<V, N>, const N: usize>(group: &mut Group<V, M, N>) {
    let any = group.model.constants().cross_on.lanes().iter().any(|&on| on > 0.5);
    group.model.set_any_cross(any);
}
