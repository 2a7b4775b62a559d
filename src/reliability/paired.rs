//! The difference of two probabilities from the same points: common random numbers.
//!
//! Only the rows in which the two disagree count. The interval is Bonett and Price's for paired
//! proportions (J. Educ. Behav. Stat. 37 (2012) 479): Wald's with one row added to each way of
//! disagreeing, which holds as stated down to no disagreement at all.

use super::binomial_tails::checked_confidence;
use crate::error::Result;
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::{normal, student};

const METHOD: &str = "Bonett-Price, common random numbers";
const METHOD_REPLICATES: &str = "Student t over replicates, common random numbers";

/// How two outcomes of each row go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairedCounts {
    /// Rows.
    pub rows: u64,
    /// Rows that breach only after the change.
    pub gained: u64,
    /// Rows that breach only before it.
    pub lost: u64,
    /// Rows of which one or the other is not known.
    pub unknown: u64,
}

impl PairedCounts {
    /// Takes in a row: breached before, breached after.
    pub fn push(&mut self, before: Option<bool>, after: Option<bool>) {
        self.rows += 1;
        match (before, after) {
            (Some(false), Some(true)) => self.gained += 1,
            (Some(true), Some(false)) => self.lost += 1,
            (Some(_), Some(_)) => {}
            _ => self.unknown += 1,
        }
    }

    /// P after less P before, with its interval; rows that are not known count against either end.
    ///
    /// # Errors
    /// If the confidence is not strictly between 0 and 1.
    pub fn difference(&self, confidence: f64) -> Result<Estimate> {
        let risk = (1.0 - checked_confidence(confidence)?) / 2.0;
        let known = self.rows - self.unknown;
        if known == 0 {
            return Ok(Estimate::none("no row is known before and after"));
        }
        let n = known as f64;
        let (gained, lost) = (self.gained as f64, self.lost as f64);
        let value = (gained - lost) / n;
        let error = ((gained + lost - n * value * value) / n / n).max(0.0).sqrt();
        let z = normal::quantile_upper(risk);
        let end = |gained: f64, lost: f64, sign: f64| {
            let n = self.rows as f64 + 2.0;
            let (gained, lost) = ((gained + 1.0) / n, (lost + 1.0) / n);
            let difference = gained - lost;
            let spread = ((gained + lost - difference * difference) / n).max(0.0).sqrt();
            (difference + sign * z * spread).clamp(-1.0, 1.0)
        };
        let unknown = self.unknown as f64;
        let interval = Interval {
            lower: end(gained, lost + unknown, -1.0),
            upper: end(gained + unknown, lost, 1.0),
            confidence,
            method: METHOD,
        };
        Ok(Estimate { value: Some(value), standard_error: Some(error), interval: interval.into() })
    }
}

/// The same from independent replicates of a design whose points depend on each other.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn replicated_difference(counts: &[PairedCounts], confidence: f64) -> Result<Estimate> {
    let risk = (1.0 - checked_confidence(confidence)?) / 2.0;
    if let [only] = counts {
        return only.difference(confidence);
    }
    if counts.iter().any(|count| count.rows == count.unknown) || counts.is_empty() {
        return Ok(Estimate::none("a replicate has no row that is known before and after"));
    }
    let shares = |of: &dyn Fn(&PairedCounts) -> f64| {
        let values: Vec<f64> = counts.iter().map(|c| of(c) / c.rows as f64).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        (mean, (squares / (count - 1.0) / count).sqrt())
    };
    let (value, error) = shares(&|c| c.gained as f64 - c.lost as f64);
    let low = shares(&|c| c.gained as f64 - (c.lost + c.unknown) as f64);
    let high = shares(&|c| (c.gained + c.unknown) as f64 - c.lost as f64);
    if error == 0.0 {
        let interval = Earned::none("every replicate shows the same difference");
        return Ok(Estimate { value: Some(value), standard_error: None, interval });
    }
    let t = student::quantile_upper(counts.len() as f64 - 1.0, risk);
    let interval = Interval {
        lower: low.0 - t * low.1,
        upper: high.0 + t * high.1,
        confidence,
        method: METHOD_REPLICATES,
    };
    Ok(Estimate { value: Some(value), standard_error: Some(error), interval: interval.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_interval_is_the_formulas() {
        let counts = PairedCounts { rows: 98, gained: 4, lost: 9, unknown: 0 };
        let estimate = counts.difference(0.95).unwrap();
        let interval = estimate.interval.interval().unwrap();
        // By hand: p12 = 0.05, p21 = 0.10, d = −0.05, s = √((0.15 − 0.0025)/100) = 0.038406.
        assert!((interval.lower - (-0.05 - 1.959963984540054 * 0.0384057)).abs() < 1e-6);
        assert!((interval.upper - (-0.05 + 1.959963984540054 * 0.0384057)).abs() < 1e-6);
        assert!((estimate.value.unwrap() + 5.0 / 98.0).abs() < 1e-15);
    }

    #[test]
    fn property_unknown_rows_widen_both_ends() {
        let known = PairedCounts { rows: 200, gained: 4, lost: 9, unknown: 0 };
        let partly = PairedCounts { unknown: 6, ..known };
        let of =
            |counts: PairedCounts| *counts.difference(0.9).unwrap().interval.interval().unwrap();
        assert!(of(partly).lower < of(known).lower && of(partly).upper > of(known).upper);
        let nothing = PairedCounts { rows: 50, gained: 0, lost: 0, unknown: 0 };
        assert!(of(nothing).lower < 0.0 && of(nothing).upper > 0.0);
    }
}
