//! Joint counts of breaches: each constraint, any of them, each pair.
//!
//! All counts are integers, so chunks may be counted apart and merged in any order with one result.

use super::probability::Proportion;
use crate::error::{Error, Result};

/// Most constraints that one mask can hold.
pub const MOST_CONSTRAINTS: usize = 32;

/// Counts of breaches over samples that hold several constraints at once.
///
/// A sample is two masks: constraint i is bit i, set in `breached` if the sample breached it and in
/// `unknown` if it could not be said. An event is *known* as soon as what is known decides it: a
/// sample that breached one constraint has breached "any", whatever the unknown ones would have been.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BreachCounts {
    constraints: usize,
    samples: u64,
    faulted: u64,
    any: Tally,
    each: Vec<Tally>,
    /// Pairs (i, j), i < j, in the order (0,1), (0,2), …, (1,2), ….
    pairs: Vec<Tally>,
}

/// How often an event happened, and how often it could not be said.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Tally {
    breaches: u64,
    faults: u64,
}

impl Tally {
    fn count(&mut self, happened: bool, unknown: bool) {
        self.breaches += u64::from(happened);
        self.faults += u64::from(unknown && !happened);
    }

    fn add(&mut self, other: &Tally) {
        self.breaches += other.breaches;
        self.faults += other.faults;
    }
}

impl BreachCounts {
    /// No sample yet, for this number of constraints.
    ///
    /// # Errors
    /// If there are more than 32 constraints.
    pub fn new(constraints: usize) -> Result<Self> {
        if constraints > MOST_CONSTRAINTS {
            return Err(Error::argument(format!(
                "at most {MOST_CONSTRAINTS} limits can be counted together, not {constraints}"
            )));
        }
        let pairs = constraints * constraints.saturating_sub(1) / 2;
        Ok(BreachCounts {
            constraints,
            samples: 0,
            faulted: 0,
            any: Tally::default(),
            each: vec![Tally::default(); constraints],
            pairs: vec![Tally::default(); pairs],
        })
    }

    /// Counts a sample whose every constraint is known.
    pub fn push(&mut self, breached: u32) {
        self.push_partly(breached, 0);
    }

    /// Counts a faulted sample: nothing is known of it.
    pub fn push_fault(&mut self) {
        self.push_partly(0, u32::MAX);
    }

    /// Counts a sample of which the constraints in `unknown` could not be computed. Bits beyond the
    /// constraints are ignored, and a bit set in both masks counts as breached.
    pub fn push_partly(&mut self, breached: u32, unknown: u32) {
        let all = u32::MAX.checked_shr((MOST_CONSTRAINTS - self.constraints) as u32).unwrap_or(0);
        let breached = breached & all;
        let open = unknown & all & !breached;
        self.samples += 1;
        // A fault without any constraint is still a fault.
        self.faulted += u64::from(open != 0 || (self.constraints == 0 && unknown != 0));
        self.any.count(breached != 0, open != 0);
        let possible = breached | open;
        if possible == 0 {
            return;
        }
        for (i, tally) in self.each.iter_mut().enumerate() {
            tally.count(breached >> i & 1 == 1, open >> i & 1 == 1);
        }
        if possible.count_ones() < 2 {
            return;
        }
        let both = (0..self.constraints)
            .flat_map(|i| (i + 1..self.constraints).map(move |j| 1 << i | 1 << j));
        for (tally, bits) in self.pairs.iter_mut().zip(both) {
            let bits: u32 = bits;
            tally.count(breached & bits == bits, possible & bits == bits);
        }
    }

    /// Counts one constraint per slice of margins, sample by sample: below zero is a breach, NaN is
    /// unknown.
    ///
    /// # Errors
    /// If the number of slices is not that of the constraints, or their lengths differ.
    pub fn push_margins(&mut self, margins: &[&[f64]]) -> Result<()> {
        let rows = margins.first().map_or(0, |column| column.len());
        if margins.len() != self.constraints || margins.iter().any(|column| column.len() != rows) {
            return Err(Error::argument(format!(
                "margins of {} limits were given where {} are counted, or of different lengths",
                margins.len(),
                self.constraints
            )));
        }
        for k in 0..rows {
            let (mut breached, mut unknown) = (0u32, 0u32);
            for (i, column) in margins.iter().enumerate() {
                breached |= u32::from(column[k] < 0.0) << i;
                unknown |= u32::from(column[k].is_nan()) << i;
            }
            self.push_partly(breached, unknown);
        }
        Ok(())
    }

    /// Adds the counts of other samples.
    ///
    /// # Errors
    /// If the other counts are of another number of constraints.
    pub fn merge(&mut self, other: &BreachCounts) -> Result<()> {
        if other.constraints != self.constraints {
            return Err(Error::argument(format!(
                "counts of {} limits cannot be added to counts of {}",
                other.constraints, self.constraints
            )));
        }
        self.samples += other.samples;
        self.faulted += other.faulted;
        self.any.add(&other.any);
        self.each.iter_mut().zip(&other.each).for_each(|(a, b)| a.add(b));
        self.pairs.iter_mut().zip(&other.pairs).for_each(|(a, b)| a.add(b));
        Ok(())
    }

    /// Number of constraints.
    pub fn constraints(&self) -> usize {
        self.constraints
    }

    /// Samples counted, faulted ones included.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Samples of which at least one constraint is unknown.
    pub fn faulted(&self) -> u64 {
        self.faulted
    }

    /// Breach of any constraint.
    pub fn any(&self) -> Proportion {
        self.proportion(&self.any)
    }

    /// Breach of constraint `i`; `None` if there is no such constraint.
    pub fn constraint(&self, i: usize) -> Option<Proportion> {
        self.each.get(i).map(|tally| self.proportion(tally))
    }

    /// Breach of both constraints `i` and `j`, in either order; `None` if there is no such pair.
    pub fn pair(&self, i: usize, j: usize) -> Option<Proportion> {
        let (i, j) = (i.min(j), i.max(j));
        if i == j || j >= self.constraints {
            return None;
        }
        let before = i * (2 * self.constraints - i - 1) / 2;
        self.pairs.get(before + j - i - 1).map(|tally| self.proportion(tally))
    }

    fn proportion(&self, tally: &Tally) -> Proportion {
        Proportion { breaches: tally.breaches, faults: tally.faults, samples: self.samples }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn proportion(breaches: u64, faults: u64, samples: u64) -> Option<Proportion> {
        Some(Proportion { breaches, faults, samples })
    }

    #[test]
    fn property_events_are_known_as_soon_as_they_are_decided() {
        let mut counts = BreachCounts::new(3).unwrap();
        counts.push(0b000);
        counts.push(0b101);
        counts.push_fault();
        counts.push_partly(0b001, 0b010);
        assert_eq!(Some(counts.any()), proportion(2, 1, 4));
        assert_eq!(counts.constraint(0), proportion(2, 1, 4));
        assert_eq!(counts.constraint(1), proportion(0, 2, 4));
        assert_eq!(counts.constraint(2), proportion(1, 1, 4));
        assert_eq!(counts.pair(0, 2), proportion(1, 1, 4));
        assert_eq!(counts.pair(1, 0), proportion(0, 2, 4));
        // The fourth sample is known to hold constraint 2, so it did not breach both.
        assert_eq!(counts.pair(1, 2), proportion(0, 1, 4));
        assert_eq!(
            (counts.pair(1, 1), counts.pair(0, 3), counts.constraint(3)),
            (None, None, None)
        );
        assert_eq!((counts.samples(), counts.faulted()), (4, 2));
    }

    #[test]
    fn property_thirty_two_constraints_fit_and_one_more_is_refused() {
        let mut counts = BreachCounts::new(32).unwrap();
        counts.push(1 << 31 | 1);
        assert_eq!(counts.pair(0, 31), proportion(1, 0, 1));
        assert_eq!(counts.pair(30, 31), proportion(0, 0, 1));
        assert!(BreachCounts::new(33).is_err());
        let mut none = BreachCounts::new(0).unwrap();
        none.push_fault();
        assert_eq!((none.any(), none.faulted()), (proportion(0, 0, 1).unwrap(), 1));
    }
}
