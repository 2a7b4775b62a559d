//! The law of P(e): mean, spread, quantiles and beliefs, with intervals.

use super::{Halves, SECTIONS};
use crate::error::{Error, Result};
use crate::numerics::elementary::ln;
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::{beta, student};

/// Share of the sets below which those that saw an event (or saw it fail to happen) say nothing of the law over all sets:
/// its quantiles would be drawn as straight lines from the others to them.
const LEAST_TOLD: f64 = 0.1;

/// Share of the sets that must carry a mean, by their effective number, for it to be stated with Student's interval: of a rarer
/// event the mean lies with a few sets, most of which were not drawn.
const LEAST_CARRYING: f64 = 0.1;
/// Sets that must carry it, however many there are.
const FEWEST_CARRYING: f64 = 80.0;

/// Sets on either side of a belief below which its interval is the exact one of their number.
const FEWEST_EITHER_SIDE: f64 = 20.0;

/// Sets of a section beyond a quantile below which the sections alone do not tell its error: in the tail of a small section
/// a quantile is biased.
const FEWEST_BEYOND: f64 = 2.0;

/// Sets of a section below which no interval is given.
const FEWEST: usize = 5;

/// What is believed of the conditional probability of an event.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Its mean: the probability of the event.
    pub mean: Estimate,
    /// Its standard deviation.
    pub standard_deviation: Estimate,
    /// Its quantiles: (share, probability).
    pub quantiles: Vec<(f64, Estimate)>,
    /// The belief that it is at most each of the asked probabilities.
    pub beliefs: Vec<(f64, Estimate)>,
    /// Standard deviation of what the inner sampling alone does to one set's mean of halves.
    pub noise: f64,
    /// Sets left out because a half of them could not be evaluated.
    pub left_out: usize,
}

/// The law of shares that are counts of few points: each value stands for what lies about it, so half of its weight
/// is below it, and between values the distribution function is a straight line (Parzen's mid-distribution, J. Am.
/// Stat. Assoc. 74 (1979) 105).
struct MidDistribution {
    /// Values ascending, each with the weight below it and half its own.
    knots: Vec<(f64, f64)>,
}

impl MidDistribution {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        let total = sorted.len() as f64;
        let mut knots = Vec::new();
        let mut below = 0.0;
        for tied in sorted.chunk_by(|a, b| a == b) {
            let weight = tied.len() as f64 / total;
            knots.push((tied[0], below + 0.5 * weight));
            below += weight;
        }
        MidDistribution { knots }
    }

    /// The value at which the distribution function is `share`.
    fn quantile(&self, share: f64) -> f64 {
        let above = self.knots.partition_point(|(_, weight)| *weight < share);
        match (above.checked_sub(1).and_then(|k| self.knots.get(k)), self.knots.get(above)) {
            (Some(&(x, from)), Some(&(y, to))) => x + (y - x) * (share - from) / (to - from),
            (Some(&(x, _)), None) | (None, Some(&(x, _))) => x,
            (None, None) => f64::NAN,
        }
    }

    /// The distribution function at `value`.
    fn weight_to(&self, value: f64) -> f64 {
        let above = self.knots.partition_point(|(x, _)| *x <= value);
        match (above.checked_sub(1).and_then(|k| self.knots.get(k)), self.knots.get(above)) {
            (Some(&(x, from)), Some(&(y, to))) => from + (to - from) * (value - x) / (y - x),
            (Some(_), None) => 1.0,
            _ => 0.0,
        }
    }
}

/// What is asked of the law.
#[derive(Clone, Copy)]
struct Question<'q> {
    shares: &'q [f64],
    at: &'q [f64],
}

impl Question<'_> {
    /// Mean, standard deviation, quantiles and beliefs of some sets' pairs of halves.
    ///
    /// Of anything but the mean, the halves' own scatter is removed by extrapolation: a statistic of the halves is
    /// distorted twice as much, to the first order in the variance of that scatter, as the same statistic of their
    /// means (Cook and Stefanski's simulation-extrapolation, J. Am. Stat. Assoc. 89 (1994) 1314, with the noise
    /// that is there doubled instead of simulated). Of a variance this is exact.
    fn answer(&self, pairs: &[(f64, f64)]) -> Vec<f64> {
        let total = pairs.len() as f64;
        let mean = pairs.iter().map(|(a, b)| 0.5 * (a + b)).sum::<f64>() / total;
        // Unbiased for the square of P(e): the halves are independent given e.
        let product: f64 = pairs.iter().map(|(a, b)| (a - mean) * (b - mean)).sum();
        let mut found = vec![mean, (product / (total - 1.0)).max(0.0).sqrt()];
        let first = MidDistribution::new(pairs.iter().map(|pair| pair.0));
        let second = MidDistribution::new(pairs.iter().map(|pair| pair.1));
        let both = MidDistribution::new(pairs.iter().map(|(a, b)| 0.5 * (a + b)));
        let extrapolated = |read: &dyn Fn(&MidDistribution) -> f64| {
            (2.0 * read(&both) - 0.5 * (read(&first) + read(&second))).clamp(0.0, 1.0)
        };
        let mut least = 0.0_f64;
        for &share in self.shares {
            // A quantile function does not fall.
            least = least.max(extrapolated(&|law| law.quantile(share)));
            found.push(least);
        }
        found.extend(self.at.iter().map(|&value| extrapolated(&|law| law.weight_to(value))));
        found
    }
}

/// Mean and quantiles at ascending `shares`, as [`band`] has them, without intervals; none with fewer than two sets.
pub fn central(halves: &Halves, shares: &[f64]) -> Option<(f64, Vec<f64>)> {
    let pairs: Vec<(f64, f64)> = halves.complete().collect();
    if pairs.len() < 2 {
        return None;
    }
    let mut found = Question { shares, at: &[] }.answer(&pairs);
    let quantiles = found.split_off(2);
    Some((found[0], quantiles))
}

/// The law of the conditional probability, from its halves: quantiles at the ascending `shares`, and the beliefs that it is
/// at most each of `at`.
///
/// The sections of the sets are independent Latin hypercubes: the scatter of a statistic from section to section is the
/// error of the statistic of all sets (sectioning; M. K. Nakayama, ACM Trans. Model. Comput. Simul. 24 (2014) 19).
/// A belief about a probability that the points of a set cannot resolve has no number.
///
/// # Errors
/// If fewer than two sets have both halves, or the confidence is not between 0 and 1.
pub fn band(halves: &Halves, shares: &[f64], at: &[f64], confidence: f64) -> Result<Band> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(Error::argument("a confidence lies between 0 and 1"));
    }
    let pairs: Vec<(f64, f64)> = halves.complete().collect();
    let sets = pairs.len();
    if sets < 2 {
        return Err(Error::argument("a band needs two sets that could be evaluated"));
    }
    let question = Question { shares, at };
    let all = question.answer(&pairs);
    let sections: Vec<Vec<f64>> = (0..SECTIONS)
        .map(|section| halves.section(section).collect::<Vec<_>>())
        .filter(|pairs| pairs.len() >= FEWEST)
        .map(|pairs| question.answer(&pairs))
        .collect();
    let estimate = |place: usize| {
        let values: Vec<f64> = sections.iter().map(|found| found[place]).collect();
        sectioned(all[place], &values, confidence)
    };
    let beliefs = at.iter().enumerate().map(|(k, &value)| {
        if value < halves.resolution {
            let why = format!("the descents with each set do not resolve a probability of {value}");
            return (value, Estimate::none(why));
        }
        let mut belief = estimate(2 + shares.len() + k);
        let below = belief.value.unwrap_or(0.0);
        let few = below.min(1.0 - below) * (sets as f64) < FEWEST_EITHER_SIDE;
        if (few || belief.interval.interval().is_none()) && sections.len() == SECTIONS {
            belief.interval = binomial(belief.value.unwrap_or(0.0), sets as f64, confidence).into();
        }
        (value, belief)
    });
    let differences: f64 = pairs.iter().map(|(a, b)| (a - b) * (a - b)).sum();
    let happened = pairs.iter().filter(|(a, b)| a + b > 0.0).count();
    let failed_to = pairs.iter().filter(|(a, b)| a + b < 2.0).count();
    let untold = untold(happened, failed_to, sets);
    let means: Vec<f64> = pairs.iter().map(|(a, b)| 0.5 * (a + b)).collect();
    let law = MidDistribution::new(means.iter().copied());
    let mean = match carrying(&means) < FEWEST_CARRYING.max(LEAST_CARRYING * sets as f64) {
        true => bounded(all[0], sets as f64, confidence),
        false => estimate(0),
    };
    Ok(Band {
        mean,
        standard_deviation: estimate(1),
        quantiles: shares
            .iter()
            .enumerate()
            .map(|(k, &share)| {
                if let Some(why) = &untold {
                    return (share, Estimate::none(why.clone()));
                }
                let mut quantile = estimate(2 + k);
                let beyond = share.min(1.0 - share) * (sets / SECTIONS) as f64;
                if let (true, Earned::Interval(own)) =
                    (beyond < FEWEST_BEYOND, &mut quantile.interval)
                {
                    // Woodruff's (J. Am. Stat. Assoc. 47 (1952) 635): the values at the ends of the share's interval.
                    let ends = binomial(share, sets as f64, confidence);
                    own.lower = own.lower.min(law.quantile(ends.lower));
                    own.upper = own.upper.max(law.quantile(ends.upper));
                }
                (share, resolved(quantile, sections.len(), halves.resolution, confidence))
            })
            .collect(),
        beliefs: beliefs.collect(),
        noise: (0.25 * differences / sets as f64).sqrt(),
        left_out: halves.first.len() - sets,
    })
}

/// Why the quantiles of P(event | set) cannot be told, where an event `happened` with so few of the `sets`, or
/// `failed_to` happen with so few, that those say nothing of the law over all sets.
pub fn untold(happened: usize, failed_to: usize, sets: usize) -> Option<String> {
    let too_few = |count: usize| (count as f64) < LEAST_TOLD * sets as f64;
    match (happened, failed_to) {
        _ if sets == 0 => Some("no set of values could be evaluated".to_owned()),
        (_, 0) => Some(format!("it always happened, with each of {sets} sets of values")),
        _ if too_few(happened) => {
            Some(format!("it happened with {happened} of {sets} sets of values only"))
        }
        _ if too_few(failed_to) => {
            Some(format!("with all but {failed_to} of {sets} sets of values it always happened"))
        }
        _ => None,
    }
}

/// A number of all sets with the error that its values by section show.
fn sectioned(value: f64, sections: &[f64], confidence: f64) -> Estimate {
    let count = sections.len() as f64;
    let none = |why: String| Estimate {
        value: Some(value),
        standard_error: None,
        interval: Earned::none(why),
    };
    if sections.len() < SECTIONS {
        return none(format!("fewer than {FEWEST} sets in a section"));
    }
    // About the value of all sets, so that a bias of the small sections widens the interval.
    let squares: f64 = sections.iter().map(|x| (x - value) * (x - value)).sum();
    let error = (squares / (count - 1.0) / count).sqrt();
    if !(error > 0.0 && error.is_finite()) {
        return none("every section of the sets shows the same".to_owned());
    }
    let reach = error * student::quantile_upper(count - 1.0, 0.5 * (1.0 - confidence));
    let interval = Interval {
        lower: (value - reach).max(0.0),
        upper: (value + reach).min(1.0),
        confidence,
        method: "Student t over sections of the sets",
    };
    Estimate { value: Some(value), standard_error: Some(error), interval: interval.into() }
}

/// How many sets carry the mean of the event, or of its opposite, whichever is rarer: (Σ P)² / Σ P².
fn carrying(shares: &[f64]) -> f64 {
    let of = |sum: f64, squares: f64| if squares > 0.0 { sum * sum / squares } else { 0.0 };
    let sums = |value: &dyn Fn(f64) -> f64| {
        let each = || shares.iter().map(|&p| value(p));
        of(each().sum(), each().map(|x| x * x).sum())
    };
    sums(&|p| p).min(sums(&|p| 1.0 - p))
}

/// The mean of a rare event (or of one that is rarely missed), of which the sets have seen too little for a number: bounds
/// that hold at any number of independent sets and for any law of P(e) on [0, 1], since sets · KL(mean, bound) is at most
/// the logarithm of one over the risk (Hoeffding, J. Am. Stat. Assoc. 58 (1963) 13, theorem 1). Stratified sets lie no
/// farther from the mean than independent ones.
fn bounded(mean: f64, sets: f64, confidence: f64) -> Estimate {
    let mean = mean.clamp(0.0, 1.0);
    let most = -ln(0.5 * (1.0 - confidence)) / sets;
    let distance = |bound: f64| {
        let part =
            |share: f64, other: f64| if share > 0.0 { share * ln(share / other) } else { 0.0 };
        part(mean, bound) + part(1.0 - mean, 1.0 - bound)
    };
    let bound = |end: f64| {
        let (mut inside, mut outside) = (mean, end);
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if distance(middle) <= most { inside = middle } else { outside = middle }
        }
        outside
    };
    let interval = Interval {
        lower: if mean > 0.0 { bound(0.0) } else { 0.0 },
        upper: if mean < 1.0 { bound(1.0) } else { 1.0 },
        confidence,
        method: "Hoeffding's bound over sets",
    };
    Estimate { value: None, standard_error: None, interval: interval.into() }
}

/// A quantile of P with its interval widened by half of what a set resolves either way.
fn resolved(mut quantile: Estimate, sections: usize, resolution: f64, confidence: f64) -> Estimate {
    let (Some(value), SECTIONS) = (quantile.value, sections) else { return quantile };
    let (lower, upper) =
        quantile.interval.interval().map_or((value, value), |i| (i.lower, i.upper));
    let half = 0.5 * resolution;
    quantile.interval = Earned::Interval(Interval {
        lower: (lower - half).max(0.0),
        upper: (upper + half).min(1.0),
        confidence,
        method: "Student t over sections of the sets, and the resolution of a set",
    });
    quantile
}

/// Clopper and Pearson's interval of a share of independent sets: wider than stratified ones need.
fn binomial(share: f64, sets: f64, confidence: f64) -> Interval {
    let count = (share * sets).round();
    let tail = 0.5 * (1.0 - confidence);
    let lower =
        if count > 0.0 { beta::quantile_lower(count, sets - count + 1.0, tail) } else { 0.0 };
    let upper =
        if count < sets { beta::quantile_upper(count + 1.0, sets - count, tail) } else { 1.0 };
    Interval { lower, upper, confidence, method: "Clopper-Pearson over sets" }
}
