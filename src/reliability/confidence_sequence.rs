//! Confidence sequences of a probability: intervals that hold at every look, however often one looks.
//!
//! For every p, the likelihood of the samples under other probabilities, mixed by a law that may depend on p, over that
//! under p is a martingale where p is true, so by Ville's inequality it exceeds 1/α ever, at any sample size, with
//! probability at most α. The interval holds every p for which it does not. With m breaches among n and the law
//! Beta(κp, κ(1 − p)) it is `B(κp + m, κ(1 − p) + n − m) / (B(κp, κ(1 − p)) p^m (1 − p)^(n − m))`: what it bets on lies
//! about as far from p as n ≈ 8.5 κ samples can tell apart, whatever p is. A tenth of the mass is uniform, for
//! samples too few for that.
//!
//! Widths over that of Clopper and Pearson's interval for a fixed n, at 95 %: 1.4 to 1.6 from 4096 to 20 000 samples, 1.6
//! to 1.9 to a million, at any p; a uniform law alone, the same for all p, has 1.9 to 2.6.
//!
//! Sources: Robbins, Ann. Math. Statist. 41 (1970) 1397; Howard, Ramdas, McAuliffe and Sekhon, Annals of
//! Statistics 49 (2021) 1055, for the tuning; Waudby-Smith and Ramdas, J. R. Stat. Soc. B 86 (2024) 1, for laws that
//! depend on the p that is tested.

use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, ln, ln_1p};
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::beta::ln_beta;

/// Concentration κ of the law about the p that is tested: sharpest near 8.5 κ samples, within a fifth of that from 3 κ to
/// 1000 κ. The first look is at 4096.
const CONCENTRATION: f64 = 1000.0;
/// Mass of the uniform law.
const UNIFORM: f64 = 0.1;

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
    let uniform = ln(UNIFORM) + ln_beta(m + 1.0, rest + 1.0);
    let excess = |p: f64| {
        let breached = if m > 0.0 { m * ln(p) } else { 0.0 };
        let clean = if rest > 0.0 { rest * ln_1p(-p) } else { 0.0 };
        let (a, b) = (CONCENTRATION * p, CONCENTRATION * (1.0 - p));
        let about = ln(1.0 - UNIFORM) + ln_beta(a + m, b + rest) - ln_beta(a, b);
        let (most, least) = (about.max(uniform), about.min(uniform));
        let mixed = most + ln_1p(exp(least - most));
        breached + clean - mixed - ln(risk)
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

    fn interval(breaches: u64, samples: u64, confidence: f64) -> Interval {
        let counts = Proportion::new(breaches, 0, samples).unwrap();
        *confidence_sequence(counts, confidence).unwrap().interval().unwrap()
    }

    #[test]
    fn reference_ends_by_mpmath() {
        // tests/adaptive/references/confidence_sequence.py, 30 digits; the roots here stop at the rounding of ln B.
        let table = [
            (0, 10, 0.0, 0.534_558_637_800_944_4),
            (0, 100, 0.0, 0.093_695_936_950_600_76),
            (0, 1000, 0.0, 0.009734380700099046),
            (0, 4096, 0.0, 0.0012558193767362875),
            (1, 100, 5.162_118_267_649_902e-7, 0.11677720703607957),
            (10, 1000, 0.002_531_188_270_136_39, 0.027_397_546_968_583_49),
            (41, 4096, 0.005_858_256_317_317_344, 0.01562345324780951),
            (50, 100, 0.31580063307199533, 0.684_199_366_928_004_6),
            (1000, 100000, 0.008_990_163_710_532_73, 0.011071701362840545),
        ];
        for (breaches, samples, lower, upper) in table {
            let found = interval(breaches, samples, 0.95);
            assert!((found.lower - lower).abs() <= 1e-9 * lower, "{breaches}/{samples} {found:?}");
            assert!((found.upper / upper - 1.0).abs() < 1e-9, "{breaches}/{samples} {found:?}");
        }
    }

    #[test]
    fn property_width_over_the_exact_interval_of_a_fixed_size() {
        let ratio = |breaches: u64, samples: u64| {
            let counts = Proportion::new(breaches, 0, samples).unwrap();
            let exact = counts.interval(0.95).unwrap();
            interval(breaches, samples, 0.95).width() / exact.interval().unwrap().width()
        };
        for (samples, most) in [(4096, 1.6), (20_000, 1.6), (100_000, 1.7), (1_000_000, 1.9)] {
            for share in [1e-3, 1e-2, 0.1, 0.5] {
                let found = ratio((samples as f64 * share) as u64, samples);
                assert!(found > 1.3 && found < most, "{samples} {share}: {found}");
            }
            assert!(ratio(0, samples) < 1.4, "{samples}: {}", ratio(0, samples));
        }
    }

    #[test]
    fn property_more_breaches_move_both_ends_up() {
        for samples in [5, 60, 1000, 4096, 50_000] {
            let mut last = interval(0, samples, 0.9);
            for k in 1..=40.min(samples) {
                let next = interval(k * samples / 40.min(samples), samples, 0.9);
                assert!(next.lower > last.lower && next.upper >= last.upper, "{k} of {samples}");
                last = next;
            }
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
