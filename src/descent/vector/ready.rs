//! Descents made ready for a lane, as many at a time as there are lanes.
//!
//! A descent's constants, its start and its first step are worked out side by side, so that refilling a lane
//! is a copy: worked out one by one they cost as much as three steps.

use super::batch::{Batch, Source};
use super::constants::Constants;
use super::group::Group;
use super::model::Model;
use super::possible::Possible;
use super::settings::Attempt;
use super::start::Start;
use crate::descent::outcome::{Fault, Outcome};
use crate::numerics::lanes::{Lanes, Mask, Wide};
use crate::physics::{Coefficients, FIELD_COUNT};

/// The descents of a batch that are waiting, the next of them ready.
pub struct Ready<'a, V, const N: usize> {
    source: Source<'a, V>,
    /// Number of descents in the batch.
    length: usize,
    /// Where in the batch the prepared ones begin and end, and the next of them.
    first: usize,
    end: usize,
    next: usize,
    /// Bit `k` is set where the prepared one in lane `k` is possible.
    possible: u32,
    constants: Constants<V>,
    starts: Start<V, N>,
    bounds: Option<Possible<V>>,
    attempt: Attempt,
}

impl<'a, V: Lanes, const N: usize> Ready<'a, V, N> {
    /// The whole batch waiting, none of it ready.
    #[inline(always)]
    pub fn new(batch: Batch<'a>, attempt: Attempt) -> Self {
        let nothing = [Wide(V::splat(0.0)); FIELD_COUNT];
        Ready {
            source: batch.source(),
            length: batch.len(),
            first: 0,
            end: 0,
            next: 0,
            possible: 0,
            constants: Constants::new(&Coefficients::from_fields(nothing, false))
                .map(|wide| wide.0),
            starts: Start::nowhere(),
            bounds: None,
            attempt,
        }
    }

    /// A group to be filled, whose lanes stand nowhere.
    #[inline(always)]
    pub fn group<M: Model<V, N>>(&self) -> Group<V, M, N> {
        Group::new(M::new(self.constants), &self.starts, self.attempt)
    }

    /// Works out the next descents of the batch, which has some.
    #[inline(always)]
    fn prepare<M: Model<V, N>>(&mut self) {
        self.first = self.end;
        self.next = self.end;
        self.end = self.length.min(self.first + V::WIDTH);
        let some = self.source.abreast(self.first..self.end);
        self.constants = Constants::new(&some.coefficients).map(|wide| wide.0);
        if some.thins != 0 {
            for lane in (0..V::WIDTH).filter(|lane| some.thins & (1 << lane) == 0) {
                self.constants.set_newtonian(lane);
            }
        }
        let heat = &some.coefficients.thermal;
        let capacities = [heat.rotor_capacity_j_per_k.0, heat.housing_capacity_j_per_k.0];
        let moving_mass = some.coefficients.balloon.moving_mass_kg.0;
        let possible = self.constants.possible_lanes(moving_mass, capacities).bits();
        self.possible = possible & !some.impossible;
        self.starts = M::start(&self.constants, &self.attempt);
        self.bounds = Some(Possible::new(M::KIND, &self.constants));
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
                if self.end == self.length {
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
        let possible = self.bounds.map_or(Possible::ANYTHING, |bounds| bounds.lane(from));
        group.restart(to, &self.starts, possible, from);
    }
}
