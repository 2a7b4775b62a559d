//! The score-function estimate of [`super::score`] from sums over the samples, which arrive in pieces.

use super::score::{FEWEST_BREACHES, ProbabilityDerivative};
use crate::error::{Error, Result};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::normal;

/// Sums over samples of a breach indicator b and a score s: their count, Σs, Σs², Σbs and Σbs².
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    count: f64,
    score: f64,
    squares: f64,
    product: f64,
    product_squares: f64,
}

impl Sums {
    fn push(&mut self, breached: bool, score: f64) {
        self.count += 1.0;
        self.score += score;
        self.squares += score * score;
        if breached {
            self.product += score;
            self.product_squares += score * score;
        }
    }

    fn add(&mut self, other: &Sums) {
        self.count += other.count;
        self.score += other.score;
        self.squares += other.squares;
        self.product += other.product;
        self.product_squares += other.product_squares;
    }

    /// The mean of b·s less the multiple of the mean score that makes its variance least, and its
    /// standard error. b is 0 or 1, so that (b s)² and (b s)·s are both b s².
    fn controlled(&self) -> (f64, f64) {
        let n = self.count;
        let (product, score) = (self.product / n, self.score / n);
        let variance = self.product_squares / n - product * product;
        let covariance = self.product_squares / n - product * score;
        let spread = self.squares / n - score * score;
        let slope = if spread > 0.0 { covariance / spread } else { 0.0 };
        let left = (variance - slope * covariance).max(0.0) * n;
        (product - slope * score, (left / (n - 2.0).max(1.0) / n).sqrt())
    }
}

/// What dP/dθ needs to know of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ScoreSums {
    known: Sums,
    lowest: Sums,
    highest: Sums,
    samples: u64,
    breaches: u64,
}

impl ScoreSums {
    /// Takes in a sample: whether it breached, if that is known, and its score ∂ln f/∂θ.
    pub fn push(&mut self, breached: Option<bool>, score: f64) {
        self.samples += 1;
        self.breaches += u64::from(breached == Some(true));
        if let Some(breached) = breached {
            self.known.push(breached, score);
        }
        // What is not known is taken as what would move the derivative furthest either way.
        self.lowest.push(breached.unwrap_or(score < 0.0), score);
        self.highest.push(breached.unwrap_or(score > 0.0), score);
    }

    /// Takes in the sums of further samples.
    pub fn add(&mut self, other: &ScoreSums) {
        self.known.add(&other.known);
        self.lowest.add(&other.lowest);
        self.highest.add(&other.highest);
        self.samples += other.samples;
        self.breaches += other.breaches;
    }

    /// dP/dθ over the samples: the estimate of [`super::score::probability_derivative`], to rounding.
    ///
    /// # Errors
    /// If a score was not finite, or the confidence is not strictly between 0 and 1.
    pub fn derivative(&self, confidence: f64) -> Result<ProbabilityDerivative> {
        if !(confidence > 0.0 && confidence < 1.0) {
            return Err(Error::argument(format!(
                "a confidence lies strictly between 0 and 1, not {confidence}"
            )));
        }
        if !self.lowest.squares.is_finite() {
            return Err(Error::argument("every sample needs a finite score"));
        }
        let known = self.known.count as u64;
        let (faults, clean) = (self.samples - known, known - self.breaches);
        if known == 0 {
            let derivative = Estimate::none("no sample has its outcome");
            return Ok(ProbabilityDerivative { derivative, faults });
        }
        let (value, error) = self.known.controlled();
        let z = normal::quantile_upper((1.0 - confidence) / 2.0);
        let (interval, standard_error) = if self.breaches.min(clean) < FEWEST_BREACHES {
            let breaches = self.breaches;
            let why = format!(
                "{breaches} breaches and {clean} clean samples: at least {FEWEST_BREACHES} of each are needed for \
                 an interval of a derivative"
            );
            (Earned::none(why), None)
        } else if error == 0.0 {
            (Earned::none("the score does not vary over the samples"), None)
        } else {
            let (low, high) = (self.lowest.controlled(), self.highest.controlled());
            let (lower, upper) = match faults {
                0 => (value - z * error, value + z * error),
                _ => (
                    (low.0 - z * low.1).min(value - z * error),
                    (high.0 + z * high.1).max(value + z * error),
                ),
            };
            let method = match faults {
                0 => "score function, normal",
                _ => "score function, normal, faults counted both ways",
            };
            (Interval { lower, upper, confidence, method }.into(), Some(error))
        };
        let derivative = Estimate { value: Some(value), standard_error, interval };
        Ok(ProbabilityDerivative { derivative, faults })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::score::probability_derivative;

    #[test]
    fn property_sums_in_pieces_give_the_estimate_of_the_columns() {
        let score: Vec<f64> = (0..400).map(|k| ((k * 37 % 101) as f64 - 50.0) / 25.0).collect();
        let breached = |k: usize| if k.is_multiple_of(97) { None } else { Some(score[k] > 0.6) };
        let number = |k| breached(k).map_or(f64::NAN, |b| f64::from(u8::from(b)));
        let column: Vec<f64> = (0..400).map(number).collect();
        let whole = probability_derivative(&column, &score, 0.9).unwrap();
        let mut sums = ScoreSums::default();
        for piece in [0..150, 150..400] {
            let mut part = ScoreSums::default();
            piece.for_each(|k| part.push(breached(k), score[k]));
            sums.add(&part);
        }
        let pieces = sums.derivative(0.9).unwrap();
        assert_eq!(pieces.faults, whole.faults);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(pieces.derivative.value.unwrap(), whole.derivative.value.unwrap()));
        let (a, b) = (pieces.derivative.interval, whole.derivative.interval);
        let (a, b) = (a.interval().unwrap().to_owned(), b.interval().unwrap().to_owned());
        assert!(near(a.lower, b.lower) && near(a.upper, b.upper));
    }
}
