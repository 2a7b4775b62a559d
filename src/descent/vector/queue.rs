//! The queue: lanes are refilled as they finish, so that a slow descent does not hold its mates idle.

use super::constants::Constants;
use super::group::Group;
use super::model::Model;
use super::rosenbrock::STAGES;
use super::settings::{Counts, Settings};
use crate::descent::outcome::{Fault, Outcome};
use crate::numerics::lanes::Lanes;
use crate::physics::Coefficients;

/// Widest lane type: two AVX-512 registers.
const WIDEST: usize = 16;

/// The descents that are waiting.
struct Queue<'a> {
    batch: &'a [Coefficients<f64>],
    next: usize,
}

impl Queue<'_> {
    /// The next descent that is possible; the impossible ones before it get their fault.
    fn next(&mut self, results: &mut [Result<Outcome, Fault>]) -> Option<(usize, Constants<f64>)> {
        while let Some(coefficients) = self.batch.get(self.next) {
            let index = self.next;
            self.next += 1;
            match Constants::possible(coefficients) {
                Some(constants) => return Some((index, constants)),
                None => results[index] = Err(Fault::ImpossibleInput),
            }
        }
        None
    }
}

/// Integrates every descent of the batch.
#[inline(always)]
pub fn run<V: Lanes, M: Model<V, N>, const N: usize>(
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    let mut counts = Counts::default();
    let mut queue = Queue { batch, next: 0 };
    let Some((index, constants)) = queue.next(results) else { return counts };

    // All lanes start with the first descent; those that find no other run it along unread.
    let lanes = Constants::splat(&constants);
    let state = M::start(&lanes);
    let step = V::splat(M::first_step(&constants));
    let tolerance = settings.local_tolerance(M::KIND);
    let mut group = Group::<V, M, N>::new(M::new(lanes), state, step, tolerance);
    let mut sample = [index; WIDEST];
    let mut live = 1u32;
    for (lane, place) in sample.iter_mut().enumerate().take(V::WIDTH).skip(1) {
        let Some((index, constants)) = queue.next(results) else { break };
        *place = index;
        live |= 1 << lane;
        load(&mut group, lane, &constants);
    }
    notice_cross(&mut group);

    while live != 0 {
        let moment = group.look();
        let mut done = group.finished() & live;
        let refill = done != 0;
        while done != 0 {
            let lane = done.trailing_zeros() as usize;
            done &= done - 1;
            results[sample[lane]] = group.result(lane);
            counts.attempts += group.attempts.lanes()[lane] as u64;
            counts.descents += 1;
            counts.evaluations += 1;
            match queue.next(results) {
                Some((index, constants)) => {
                    sample[lane] = index;
                    load(&mut group, lane, &constants);
                }
                None => live &= !(1 << lane),
            }
        }
        if refill {
            notice_cross(&mut group);
        }
        let (tried, accepted) = group.advance(&moment);
        let rejected = u64::from((tried & !accepted & live).count_ones());
        counts.rejected += rejected;
        counts.evaluations += STAGES as u64 * u64::from((tried & live).count_ones()) - rejected;
    }
    counts
}

#[inline(always)]
fn load<V: Lanes, M: Model<V, N>, const N: usize>(
    group: &mut Group<V, M, N>,
    lane: usize,
    constants: &Constants<f64>,
) {
    group.model.constants().set_lane(lane, constants);
    group.restart(lane, &M::start(constants), M::first_step(constants));
}

fn notice_cross<V: Lanes, M: Model<V, N>, const N: usize>(group: &mut Group<V, M, N>) {
    let any = group.model.constants().cross_on.lanes().iter().any(|&on| on > 0.5);
    group.model.set_any_cross(any);
}
