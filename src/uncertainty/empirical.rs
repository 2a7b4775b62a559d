//! Laws of listed values: a set of observations, or values with stated probabilities.

use crate::error::{Error, Result};
use crate::numerics::elementary::ln;

/// Values that differ by less than this share of their size are one: two spellings of a reading in different
/// units differ in the last digits of a double, and no instrument has twelve digits.
pub(super) const SAME: f64 = 1e-12;

/// A law whose quantile function is piecewise linear, with atoms and with jumps.
///
/// Every observation keeps its probability, weight over sum of weights, and the law's mean is the
/// observations' mean. A value that was observed more than once, or that has a larger weight than
/// others, is an atom: it is drawn with exactly that probability. Between two neighbours that were observed
/// once each the quantile function is linear from (i − ½)/n to (i + ½)/n, half of the probability of either being
/// spread between them (type 5 of Hyndman and Fan, 1996, after Hazen); the least and the greatest
/// observation keep the half that has no neighbour, and bound the law. A discrete law has atoms alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Empirical {
    /// The corners of the quantile function, left to right: values that do not decrease.
    values: Vec<f64>,
    /// Lower tail at every corner, from 0 to 1.
    below: Vec<f64>,
    /// Upper tail at every corner, from 1 to 0, summed from above so that it keeps its digits.
    above: Vec<f64>,
}

/// A share of the law: its weight, evenly spread over an interval, which of an atom is a point.
#[derive(Debug, Clone, Copy)]
struct Piece {
    weight: f64,
    from: f64,
    to: f64,
}

/// A value with its weight, and whether it was listed once.
type Pooled = (f64, f64, bool);

impl Empirical {
    /// The law of observed `values`, equally weighted or with `weights`.
    ///
    /// # Errors
    /// If a value is not finite, a weight is negative or not finite, their numbers differ, or fewer
    /// than two different values have weight.
    pub fn new(values: Vec<f64>, weights: Option<Vec<f64>>) -> Result<Self> {
        let pooled = pooled("an empirical law", values, weights)?;
        let least = pooled.iter().map(|value| value.1).fold(f64::INFINITY, f64::min);
        let spread_between = |a: &Pooled, b: &Pooled| {
            if a.2 && b.2 && a.1 == least && b.1 == least { least } else { 0.0 }
        };
        let mut pieces = Vec::with_capacity(2 * pooled.len());
        let mut before = 0.0;
        for (k, here) in pooled.iter().enumerate() {
            let next = pooled.get(k + 1);
            let after = next.map_or(0.0, |next| spread_between(here, next));
            let weight = here.1 - 0.5 * before - 0.5 * after;
            pieces.push(Piece { weight, from: here.0, to: here.0 });
            if let Some(next) = next {
                pieces.push(Piece { weight: after, from: here.0, to: next.0 });
            }
            before = after;
        }
        Empirical::of_pieces(&pieces)
    }

    /// The discrete law of `values` with probabilities in proportion to `weights`, or equal ones.
    ///
    /// # Errors
    /// As [`Empirical::new`].
    pub fn discrete(values: Vec<f64>, weights: Option<Vec<f64>>) -> Result<Self> {
        let pooled = pooled("a discrete law", values, weights)?;
        let piece = |&(value, weight, _): &Pooled| Piece { weight, from: value, to: value };
        Empirical::of_pieces(&pooled.iter().map(piece).collect::<Vec<_>>())
    }

    /// The law of pieces that follow each other.
    fn of_pieces(pieces: &[Piece]) -> Result<Self> {
        let pieces: Vec<Piece> =
            pieces.iter().copied().filter(|piece| piece.weight > 0.0).collect();
        let total: f64 = pieces.iter().map(|piece| piece.weight).sum();
        if !(total.is_finite() && total > 0.0) {
            return Err(Error::argument("an empirical law needs weights with a finite sum"));
        }
        let mut law = Empirical { values: Vec::new(), below: Vec::new(), above: Vec::new() };
        let mut sum = 0.0;
        for piece in &pieces {
            if law.values.last() != Some(&piece.from) {
                law.values.push(piece.from);
                law.below.push((sum / total).min(1.0));
            }
            sum += piece.weight;
            law.values.push(piece.to);
            law.below.push((sum / total).min(1.0));
        }
        let mut before = f64::NAN;
        sum = 0.0;
        for piece in pieces.iter().rev() {
            if before != piece.to {
                law.above.push((sum / total).min(1.0));
            }
            sum += piece.weight;
            law.above.push((sum / total).min(1.0));
            before = piece.from;
        }
        law.above.reverse();
        let last = law.values.len() - 1;
        (law.below[0], law.below[last]) = (0.0, 1.0);
        (law.above[0], law.above[last]) = (1.0, 0.0);
        Ok(law)
    }

    /// Whether the law is of atoms alone.
    pub fn is_discrete(&self) -> bool {
        self.pieces().all(|(piece, _)| piece.from == piece.to)
    }

    /// Whether the quantile function jumps: then an outcome has no slope in the input's coordinate.
    pub fn has_jumps(&self) -> bool {
        (1..self.values.len())
            .any(|k| self.values[k] > self.values[k - 1] && self.mass(k - 1) == 0.0)
    }

    /// Least and greatest value.
    pub fn support(&self) -> (f64, f64) {
        (self.values[0], self.values[self.values.len() - 1])
    }

    /// The pieces with some probability, left to right, each with its tails at either end.
    fn pieces(&self) -> impl Iterator<Item = (Piece, usize)> {
        (0..self.values.len() - 1)
            .map(|k| {
                let (from, to) = (self.values[k], self.values[k + 1]);
                (Piece { weight: self.mass(k), from, to }, k)
            })
            .filter(|(piece, _)| piece.weight > 0.0)
    }

    /// The law between its corners as pieces of constant density over the probability: from and to in the
    /// lower tail (with the upper tail), and in the value. For integrals over its quantile function.
    pub(super) fn steps(&self) -> impl Iterator<Item = ([(f64, f64); 2], (f64, f64))> {
        (0..self.values.len() - 1).filter(|&k| self.values[k + 1] > self.values[k]).map(|k| {
            let tails = [(self.below[k], self.above[k]), (self.below[k + 1], self.above[k + 1])];
            (tails, (self.values[k], self.values[k + 1]))
        })
    }

    /// The value whose `lower` or upper tail is `tail`: the least x with as much probability at or below it.
    pub(super) fn quantile_of_tail(&self, tail: f64, lower: bool) -> f64 {
        if tail.is_nan() {
            return tail;
        }
        let last = self.values.len() - 1;
        let tails = if lower { &self.below } else { &self.above };
        let k = match lower {
            true => self.below.partition_point(|&p| p < tail),
            false => self.above.partition_point(|&q| q > tail),
        };
        if k == 0 || k > last {
            return self.values[k.min(last)];
        }
        let (from, to) = (self.values[k - 1], self.values[k]);
        let share = (tail - tails[k - 1]) / (tails[k] - tails[k - 1]);
        // From the nearer end, so that both ends are hit exactly.
        let x = if share <= 0.5 {
            from + (to - from) * share
        } else {
            to - (to - from) * (1.0 - share)
        };
        x.clamp(from, to)
    }

    /// Lower and upper tail at `x`, the probability of `x` itself being part of the lower one or, if not
    /// `included`, of the upper one.
    fn tails_with(&self, x: f64, included: bool) -> (f64, f64) {
        let k = match included {
            true => self.values.partition_point(|&value| value <= x),
            false => self.values.partition_point(|&value| value < x),
        };
        let count = self.values.len();
        if k == 0 {
            return (0.0, 1.0);
        }
        if k == count {
            return (1.0, 0.0);
        }
        // The corners k − 1 and k are the last before x and the first after it.
        let share = (x - self.values[k - 1]) / (self.values[k] - self.values[k - 1]);
        let between = |tails: &[f64]| tails[k - 1] * (1.0 - share) + tails[k] * share;
        (between(&self.below), between(&self.above))
    }

    /// P(X ≤ `x`) and P(X > `x`).
    pub(super) fn tails(&self, x: f64) -> (f64, f64) {
        self.tails_with(x, true)
    }

    /// The tails at `x` with half of its own probability on either side.
    pub(super) fn middle_tails(&self, x: f64) -> (f64, f64) {
        let (with, without) = (self.tails_with(x, true), self.tails_with(x, false));
        (0.5 * with.0 + 0.5 * without.0, 0.5 * with.1 + 0.5 * without.1)
    }

    /// ln of the piecewise constant density at `x`, at a corner of the piece above it; of an atom, ln of its
    /// probability; −∞ where there is neither.
    pub(super) fn ln_density(&self, x: f64) -> f64 {
        let (with, without) = (self.tails_with(x, true), self.tails_with(x, false));
        let atom = (with.0 - without.0).max(without.1 - with.1);
        if atom > 0.0 {
            return ln(atom);
        }
        let last = self.values.len() - 1;
        let k = self.values.partition_point(|&value| value <= x).clamp(1, last) - 1;
        ln(self.mass(k) / (self.values[k + 1] - self.values[k]))
    }

    /// Probability between the corners `k` and `k` + 1.
    fn mass(&self, k: usize) -> f64 {
        // The difference of the smaller tails loses less.
        if self.below[k] < 0.5 {
            self.below[k + 1] - self.below[k]
        } else {
            self.above[k] - self.above[k + 1]
        }
    }

    /// Mean and standard deviation.
    pub(super) fn moments(&self) -> (f64, f64) {
        // About a value in the middle, so that a narrow law far from zero keeps its digits.
        let centre = self.quantile_of_tail(0.5, true);
        let (mut mass, mut first) = (0.0, 0.0);
        for (piece, _) in self.pieces() {
            mass += piece.weight;
            first += piece.weight * (0.5 * (piece.from - centre) + 0.5 * (piece.to - centre));
        }
        let shift = first / mass;
        let mut second = 0.0;
        for (piece, _) in self.pieces() {
            let middle = 0.5 * (piece.from - centre) + 0.5 * (piece.to - centre) - shift;
            let width = piece.to - piece.from;
            second += piece.weight * (middle * middle + width * width / 12.0);
        }
        (centre + shift, (second / mass).sqrt())
    }

    /// The law restricted to [`lower`, `upper`], ends included, and the probability that it had there.
    ///
    /// # Errors
    /// If it leaves fewer than two values.
    pub(super) fn restricted(&self, lower: f64, upper: f64) -> Result<(Self, f64)> {
        let kept: Vec<Piece> = self
            .pieces()
            .filter_map(|(piece, _)| {
                let (from, to) = (piece.from.max(lower), piece.to.min(upper));
                if piece.from == piece.to {
                    return (lower..=upper).contains(&piece.from).then_some(piece);
                }
                let share = (to - from) / (piece.to - piece.from);
                (from < to).then_some(Piece { weight: piece.weight * share, from, to })
            })
            .collect();
        let (first, last) = (kept.first().map(|p| p.from), kept.last().map(|p| p.to));
        if first == last {
            return Err(Error::argument(format!(
                "the truncation to [{lower}, {upper}] leaves fewer than two values of the law"
            )));
        }
        let mass = kept.iter().map(|piece| piece.weight).sum();
        Ok((Empirical::of_pieces(&kept)?, mass))
    }

    /// The same law with every value sent through an increasing `map`.
    ///
    /// # Errors
    /// If all values fall together or one is no longer finite.
    pub(super) fn mapped(&self, map: impl Fn(f64) -> f64) -> Result<Self> {
        let values: Vec<f64> = self.values.iter().map(|&x| map(x)).collect();
        let ordered = values.windows(2).all(|pair| pair[0] <= pair[1]);
        if ordered && values.iter().all(|x| x.is_finite()) && values.first() < values.last() {
            Ok(Empirical { values, below: self.below.clone(), above: self.above.clone() })
        } else {
            Err(Error::argument("the observations of an empirical law would no longer be distinct"))
        }
    }
}

/// The different values in ascending order, each with its joint weight.
fn pooled(law: &str, values: Vec<f64>, weights: Option<Vec<f64>>) -> Result<Vec<Pooled>> {
    let weights = match weights {
        Some(weights) if weights.len() != values.len() => {
            return Err(Error::argument(format!(
                "{law} needs one weight a value, not {} for {} values",
                weights.len(),
                values.len()
            )));
        }
        Some(weights) => weights,
        None => vec![1.0; values.len()],
    };
    if let Some((k, value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(Error::argument(format!(
            "{law} needs finite values, and value {} is {value}",
            k + 1
        )));
    }
    let wrong = |weight: f64| !(weight >= 0.0 && weight.is_finite());
    if let Some((k, weight)) = weights.iter().enumerate().find(|(_, weight)| wrong(**weight)) {
        return Err(Error::argument(format!(
            "{law} needs weights of zero or more, and weight {} is {weight}",
            k + 1
        )));
    }
    let mut pairs: Vec<(f64, f64)> =
        values.into_iter().zip(weights).filter(|&(_, weight)| weight > 0.0).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pooled: Vec<Pooled> = Vec::with_capacity(pairs.len());
    for (value, weight) in pairs {
        match pooled.last_mut() {
            Some(last) if value - last.0 <= SAME * value.abs() => {
                last.1 += weight;
                last.2 = false;
            }
            _ => pooled.push((value, weight, true)),
        }
    }
    if pooled.len() < 2 {
        return Err(Error::argument(format!(
            "{law} needs at least two different values; state a constant as a constant"
        )));
    }
    Ok(pooled)
}
