//! Intervals of the indices of a rare event, where a bootstrap sees nothing.
//!
//! For an indicator with probability p the first-order index is (π − p²)/(p(1 − p)), π the probability
//! of the event in both b and w, and the total index θ/(2p(1 − p)), θ the probability that a and w
//! differ. Both are falling in p up to one half, so exact intervals of π or θ and of p, each at half the
//! risk, bound the index by Bonferroni's inequality. With fewer than [`FEWEST`] rows that count, a bootstrap
//! interval for 95 % was measured to hold 5 to 70 %; these hold at least as stated.

use crate::numerics::interval::Interval;
use crate::numerics::special::beta;

/// Rows that must count for a bootstrap to be trusted.
pub(crate) const FEWEST: u64 = 10;

const METHOD: &str = "Clopper-Pearson on few events";

/// Counts of an indicator over the rows of one index.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct EventCounts {
    rows: u64,
    /// Events in A and B together, of the rarer of the indicator's two values.
    events: u64,
    /// Rows with the event in both b and w.
    joint: u64,
    /// Rows in which a and w differ.
    differing: u64,
}

/// Whether every known outcome of these blocks is 0 or 1.
pub(crate) fn is_indicator(blocks: &[&[f64]]) -> bool {
    blocks
        .iter()
        .flat_map(|block| *block)
        .all(|value| !value.is_finite() || *value == 0.0 || *value == 1.0)
}

impl EventCounts {
    /// The counts over the rows in which all three outcomes are known.
    pub(crate) fn of(a: &[f64], b: &[f64], w: &[f64]) -> Self {
        let known = || {
            let rows = a.iter().zip(b).zip(w);
            rows.map(|((a, b), w)| (*a, *b, *w))
                .filter(|(a, b, w)| a.is_finite() && b.is_finite() && w.is_finite())
        };
        let rows = known().count() as u64;
        let ones = known().map(|(a, b, _)| u64::from(a == 1.0) + u64::from(b == 1.0)).sum::<u64>();
        let rarer = if ones <= rows { 1.0 } else { 0.0 };
        EventCounts {
            rows,
            events: ones.min(2 * rows - ones),
            joint: known().filter(|(_, b, w)| *b == rarer && *w == rarer).count() as u64,
            differing: known().filter(|(a, _, w)| a != w).count() as u64,
        }
    }

    /// Whether too few rows have the event twice for a bootstrap of the first-order index.
    pub(crate) fn joint_is_rare(&self) -> bool {
        self.joint < FEWEST
    }

    /// The first-order index's interval, if a bootstrap is not to be trusted.
    pub(crate) fn first(&self, confidence: f64) -> Option<Interval> {
        let index = |joint: f64, p: f64| (joint - p * p) / (p * (1.0 - p));
        self.joint_is_rare().then(|| self.interval(self.joint, confidence, index))
    }

    /// The total index's interval, if a bootstrap is not to be trusted.
    pub(crate) fn total(&self, confidence: f64) -> Option<Interval> {
        let index = |differing: f64, p: f64| differing / (2.0 * p * (1.0 - p));
        (self.differing < FEWEST).then(|| self.interval(self.differing, confidence, index))
    }

    fn interval(&self, count: u64, confidence: f64, index: impl Fn(f64, f64) -> f64) -> Interval {
        let tail = (1.0 - confidence) / 4.0;
        let (least, most) = clopper_pearson(count, self.rows, tail);
        // A and B are independent: twice the rows.
        let (rarest, commonest) = clopper_pearson(self.events, 2 * self.rows, tail);
        let lower = index(least, commonest.min(0.5)).clamp(0.0, 1.0);
        // Without an event nothing bounds the index.
        let upper = if rarest > 0.0 { index(most, rarest).clamp(0.0, 1.0) } else { 1.0 };
        Interval { lower, upper, confidence, method: METHOD }
    }
}

/// Exact ends for a probability, each with this tail.
fn clopper_pearson(count: u64, rows: u64, tail: f64) -> (f64, f64) {
    let (k, n) = (count as f64, rows as f64);
    let lower = if count == 0 { 0.0 } else { beta::quantile_lower(k, n - k + 1.0, tail) };
    let upper = if count == rows { 1.0 } else { beta::quantile_upper(k + 1.0, n - k, tail) };
    (lower, upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_the_rarer_value_is_the_event() {
        let (a, b, w) =
            ([1.0, 1.0, 1.0, 0.0, f64::NAN], [1.0, 0.0, 1.0, 1.0, 0.0], [1.0, 0.0, 1.0, 1.0, 1.0]);
        let counts = EventCounts::of(&a, &b, &w);
        assert_eq!((counts.rows, counts.events, counts.joint, counts.differing), (4, 2, 1, 2));
        assert!(is_indicator(&[&a, &b, &w]) && !is_indicator(&[&[0.5]]));
    }

    #[test]
    fn property_no_event_bounds_nothing() {
        let counts = EventCounts { rows: 10, events: 0, joint: 0, differing: 0 };
        assert_eq!(counts.first(0.9).map(|i| (i.lower, i.upper)), Some((0.0, 1.0)));
    }
}
