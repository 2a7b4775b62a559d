//! Confidence sequences of a probability: intervals that hold at every look, however often one looks.
//!
//! The mixture of binomial likelihoods over a uniform prior is a martingale under the true p, so by
//! Ville's inequality it exceeds 1/α ever, at any sample size, with probability at most α. The interval
//! of m breaches among n holds every p with `p^m (1 − p)^(n − m) ≥ α B(m + 1, n − m + 1)`.
//!
//! Sources: Robbins, Ann. Math. Statist. 41 (1970) 1397; Howard, Ramdas, McAuliffe and Sekhon, Annals of
//! Statistics 49 (2021) 1055.

use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::elementary::{ln, ln_1p};
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::beta::ln_beta;

/// The interval of one probability at one look of a sequence that errs ever with probability at most
/// `1 − confidence`. Faults widen it as everywhere: lower end from m, upper end from m + f.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn confidence_sequence(counts: Proportion, confidence: f64) -> Result<Earned> {
    if !(0.0 < confidence && confidence < 1.0) {
        return Err(Error::argument(format!("{confidence} is not a confidence between 0 and 1")));
    }
    if counts.samples == 0 {
        return Ok(Earned::none("no sample was run"));
    }
    let risk = 1.0 - confidence;
    let n = counts.samples;
    let lower = match counts.breaches {
        0 => 0.0,
        m => end(m, n, risk, 0.0),
    };
    let upper = match counts.most_breaches() {
        m if m >= n => 1.0,
        m => end(m, n, risk, 1.0),
    };
    let method = "beta-binomial confidence sequence";
    Ok(Interval { lower, upper, confidence, method }.into())
}

/// The p between the share m/n and `far` (0 or 1) where the sequence begins to exclude.
fn end(count: u64, samples: u64, risk: f64, far: f64) -> f64 {
    let (m, rest) = (count as f64, (samples - count) as f64);
    let level = ln(risk) + ln_beta(m + 1.0, rest + 1.0);
    let excess = |p: f64| {
        let breached = if m > 0.0 { m * ln(p) } else { 0.0 };
        let clean = if rest > 0.0 { rest * ln_1p(-p) } else { 0.0 };
        breached + clean - level
    };
    // The likelihood falls from m/n, where it is always above the level, to 0 at `far`.
    let (mut inside, mut outside) = (m / (m + rest), far);
    for _ in 0..2000 {
        let (least, most) = (inside.min(outside), inside.max(outside));
        // Geometric steps reach small ends in few of them.
        let middle = match least {
            0.0 => most * 1e-3,
            _ if most > 4.0 * least => (least * most).sqrt(),
            _ => 0.5 * (least + most),
        };
        if middle <= least || middle >= most || middle < 1e-300 {
            break;
        }
        if excess(middle) < 0.0 { outside = middle } else { inside = middle }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_beta_binomial_table() {
        // Recomputed for this project in 30 digits; the roots here stop at the rounding of ln B.
        let table = [
            (0, 10, 0.0, 0.41688027565653607),
            (0, 100, 0.0, 0.0732843734028999),
            (0, 1000, 0.0, 0.009855599157285205),
            (1, 100, 4.9529230734415055e-6, 0.09479696364339948),
            (10, 1000, 0.0020754812028412136, 0.02794174744363319),
            (50, 100, 0.34459026927787906, 0.6554097307221209),
        ];
        for (breaches, samples, lower, upper) in table {
            let counts = Proportion::new(breaches, 0, samples).unwrap();
            let earned = confidence_sequence(counts, 0.95).unwrap();
            let interval = earned.interval().unwrap();
            assert!((interval.lower - lower).abs() <= 1e-10 * lower, "{breaches}/{samples}");
            assert!((interval.upper / upper - 1.0).abs() < 1e-10, "{breaches}/{samples}");
        }
    }

    #[test]
    fn property_faults_only_widen() {
        let clean = confidence_sequence(Proportion::new(10, 0, 1000).unwrap(), 0.9).unwrap();
        let faulty = confidence_sequence(Proportion::new(10, 5, 1000).unwrap(), 0.9).unwrap();
        let (clean, faulty) = (clean.interval().unwrap(), faulty.interval().unwrap());
        assert_eq!(clean.lower, faulty.lower);
        assert!(clean.upper < faulty.upper);
        assert!(confidence_sequence(Proportion::new(1, 0, 10).unwrap(), 1.0).is_err());
    }
}
