//! Descents made ready for a lane, as many at a time as there are lanes.
//!
//! A descent's constants, its start and its first step are worked out side by side, so that refilling a lane
//! is a copy: worked out one by one they cost as much as three steps.

use super::constants::Constants;
use super::group::Group;
use super::model::Model;
use super::start::Start;
use crate::descent::outcome::{Fault, Outcome};
use crate::numerics::lanes::{Lanes, Mask, Wide};
use crate::physics::{Coefficients, FIELD_COUNT};

/// The descents of a batch that are waiting, the next of them ready.
pub struct Ready<'a, V, const N: usize> {
    batch: &'a [Coefficients<f64>],
    /// Where in the batch the prepared ones begin and end, and the next of them.
    first: usize,
    end: usize,
    next: usize,
    /// Bit `k` is set where the prepared one in lane `k` is possible.
    possible: u32,
    constants: Constants<V>,
    starts: Start<V, N>,
    local_tolerance: f64,
}

impl<'a, V: Lanes, const N: usize> Ready<'a, V, N> {
    /// The whole batch waiting, none of it ready; nothing if it is empty.
    #[inline(always)]
    pub fn new(batch: &'a [Coefficients<f64>], local_tolerance: f64) -> Option<Self> {
        let constants = Constants::splat(&Constants::new(batch.first()?));
        let starts = Start::nowhere();
        Some(Ready {
            batch,
            first: 0,
            end: 0,
            next: 0,
            possible: 0,
            constants,
            starts,
            local_tolerance,
        })
    }

    /// A group to be filled: of the batch's first descent's constants, standing nowhere.
    #[inline(always)]
    pub fn group<M: Model<V, N>>(&self) -> Group<V, M, N> {
        Group::new(M::new(self.constants), &self.starts, self.local_tolerance)
    }

    /// Works out the next descents of the batch, which has some; lanes too many repeat the last.
    #[inline(always)]
    fn prepare<M: Model<V, N>>(&mut self) {
        self.first = self.end;
        self.next = self.end;
        self.end = self.batch.len().min(self.first + V::WIDTH);
        let mut fields = [Wide(V::splat(0.0)); FIELD_COUNT];
        let mut thins = false;
        for lane in 0..V::WIDTH {
            let one = &self.batch[(self.first + lane).min(self.end - 1)];
            for (field, value) in fields.iter_mut().zip(one.fields()) {
                field.0.lanes_mut()[lane] = value;
            }
            thins |= one.fluid.shear_thinning;
        }
        let side_by_side = Coefficients::from_fields(fields, thins);
        self.constants = Constants::new(&side_by_side).map(|wide| wide.0);
        if thins {
            for lane in 0..self.end - self.first {
                let one = &self.batch[self.first + lane];
                if !one.fluid.shear_thinning {
                    self.constants.set_newtonian(lane);
                }
            }
        }
        let heat = &side_by_side.thermal;
        let capacities = [heat.rotor_capacity_j_per_k.0, heat.housing_capacity_j_per_k.0];
        let moving_mass = side_by_side.balloon.moving_mass_kg.0;
        self.possible = self.constants.possible_lanes(moving_mass, capacities).bits();
        self.starts = M::start(&self.constants, self.local_tolerance);
    }

    /// The next possible descent: its place in the batch and its lane among the prepared. The impossible
    /// ones before it get their fault.
    #[inline(always)]
    pub fn next<M: Model<V, N>>(
        &mut self,
        results: &mut [Result<Outcome, Fault>],
    ) -> Option<(usize, usize)> {
        loop {
            if self.next == self.end {
                if self.end == self.batch.len() {
                    return None;
                }
                self.prepare::<M>();
            }
            let (place, lane) = (self.next, self.next - self.first);
            self.next += 1;
            if self.possible & (1 << lane) != 0 {
                return Some((place, lane));
            }
            results[place] = Err(Fault::ImpossibleInput);
        }
    }

    /// Puts the prepared descent in lane `from` into lane `to` of a group.
    #[inline(always)]
    pub fn load<M: Model<V, N>>(&self, from: usize, group: &mut Group<V, M, N>, to: usize) {
        group.model.constants().copy_lane(to, &self.constants, from);
        group.restart(to, &self.starts, from);
    }
}
