//! The distribution of a limited outcome: a histogram whose bins end at the limit, and the empirical
//! probability of lying beyond a value, with its bands.
//!
//! Source of the simultaneous band: Dvoretzky, Kiefer and Wolfowitz with Massart's constant, Annals of
//! Probability 18 (1990) 1269.

use crate::campaign::{Record, in_parallel};
use crate::error::Result;
use crate::findings::CONFIDENCE;
use crate::numerics::elementary::ln;
use crate::numerics::words::{self, Word};
use crate::reliability::probability::Proportion;
use crate::study::{LimitKind, Study};
use serde::{Deserialize, Serialize};

/// Bins over the range that is drawn.
const BINS: f64 = 48.0;
/// Values of the empirical distribution per bin.
const STATIONS_PER_BIN: i64 = 2;
/// The range ends where a tail this many times as long as the one that holds all but a thousandth would.
const TAIL: f64 = 1.6;

/// How an outcome with a limit is distributed, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    /// Name of the limit.
    pub limit: String,
    /// Name of the outcome.
    #[serde(deserialize_with = "words::one")]
    pub outcome: Word,
    /// The limit as written.
    pub limit_text: String,
    /// The limit.
    pub limit_value: f64,
    /// Whether values above the limit breach it.
    pub upper: bool,
    /// Samples that could be computed.
    pub samples: u64,
    /// Samples that could not.
    pub faults: u64,
    /// Ends of the bins, ascending, one more than the counts; the limit is one of them or lies outside.
    pub edges: Vec<f64>,
    /// Samples in each bin.
    pub counts: Vec<u64>,
    /// Samples below and above the bins.
    pub outside: (u64, u64),
    /// The probability of lying beyond a value, on the breaching side, from the clean side on.
    pub exceedance: Vec<Exceedance>,
    /// Half-width of the band that holds the whole distribution at once; `None` if that is
    /// not known.
    pub simultaneous_half_width: Option<f64>,
    /// Why the exceedance has no intervals, if it has none.
    #[serde(deserialize_with = "words::maybe")]
    pub why_no_interval: Option<Word>,
}

/// The probability of an outcome beyond a value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exceedance {
    /// The value.
    pub value: f64,
    /// Share of the samples beyond it.
    pub share: f64,
    /// Ends of the exact interval of the probability, faults counted both ways.
    pub interval: Option<(f64, f64)>,
}

/// The distribution of every limited outcome that has a computed sample.
pub(super) fn distributions(study: &Study, record: &Record) -> Result<Vec<Distribution>> {
    let limits = study.stated_limits();
    let all = in_parallel(&limits, |&i| distribution(study, record, i));
    Ok(all.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
}

fn distribution(study: &Study, record: &Record, i: usize) -> Result<Option<Distribution>> {
    let limit = &study.limits[i];
    let margins = record.margins(i);
    // Beyond the limit is positive, whichever side the limit is on.
    let mut beyond: Vec<f64> = margins.iter().map(|m| -m).filter(|e| !e.is_nan()).collect();
    beyond.sort_by(f64::total_cmp);
    let (Some(&first), Some(&last)) = (beyond.first(), beyond.last()) else { return Ok(None) };
    let samples = beyond.len() as u64;
    let faults = margins.len() as u64 - samples;
    let at = |share: f64| {
        let k = ((beyond.len() - 1) as f64 * share) as usize;
        beyond[k.min(beyond.len() - 1)]
    };
    let middle = at(0.5);
    let low = first.max(middle - TAIL * (middle - at(0.001)));
    let high = last.min(middle + TAIL * (at(0.999) - middle));
    let span = if high > low { high - low } else { middle.abs().max(1.0) * 1e-6 };
    let width = span / BINS;
    // Bin k holds (k·width, (k + 1)·width] beyond the limit: a value at the limit is clean.
    let bin = |e: f64| (e / width).ceil() as i64 - 1;
    let (from, to) = (bin(low), bin(high).max(bin(low)) + 1);
    let mut counts = vec![0u64; (to - from) as usize];
    let (mut under, mut over) = (0, 0);
    for &e in &beyond {
        match bin(e) {
            k if k < from => under += 1,
            k if k >= to => over += 1,
            k => counts[(k - from) as usize] += 1,
        }
    }
    let upper = limit.kind == LimitKind::Max;
    let value = |e: f64| if upper { limit.value + e } else { limit.value - e };
    let mut edges: Vec<f64> = (from..=to).map(|k| value(k as f64 * width)).collect();
    let mut outside = (under, over);
    if !upper {
        edges.reverse();
        counts.reverse();
        outside = (over, under);
    }
    let why_no_interval = if !record.by_replicate().is_empty() {
        Some("the points of a replicated design are not independent")
    } else if study.sampling.stopping.is_some() {
        Some("the number of samples was decided while looking at them")
    } else {
        None
    };
    let earned = why_no_interval.is_none();
    // The tail is followed to the limit even where no sample went.
    let end = (to.max(bin(last) + 1).min(to + BINS as i64)).max(2);
    let stations = (from.min(-1) * STATIONS_PER_BIN)..=(end * STATIONS_PER_BIN);
    let exceedance = thinned(stations, 240)
        .map(|k| {
            let e = k as f64 * width / STATIONS_PER_BIN as f64;
            let count = beyond.len() - beyond.partition_point(|&x| x <= e);
            let counts = Proportion::new(count as u64, faults, samples + faults)?;
            let interval = match earned {
                true => counts.interval(CONFIDENCE)?.interval().map(|i| (i.lower, i.upper)),
                false => None,
            };
            Ok(Exceedance { value: value(e), share: counts.estimate().unwrap_or(0.0), interval })
        })
        .collect::<Result<Vec<_>>>()?;
    let half_width = (-ln((1.0 - CONFIDENCE) / 2.0) / (2.0 * samples as f64)).sqrt();
    Ok(Some(Distribution {
        limit: limit.name(),
        outcome: limit.outcome.name(),
        limit_text: limit.text.clone(),
        limit_value: limit.value,
        upper,
        samples,
        faults,
        edges,
        counts,
        outside,
        exceedance,
        simultaneous_half_width: (earned && faults == 0).then_some(half_width),
        why_no_interval,
    }))
}

/// Every `step`-th member, so that about `most` are left, with zero among them if it was.
fn thinned(range: std::ops::RangeInclusive<i64>, most: i64) -> impl Iterator<Item = i64> {
    let (start, end) = range.into_inner();
    let step = ((end - start) / most).max(1);
    let first = start + (-start).rem_euclid(step);
    (first..=end).step_by(usize::try_from(step).unwrap_or(usize::MAX))
}

#[cfg(test)]
mod tests {
    use super::thinned;

    #[test]
    fn property_thinning_keeps_zero_and_takes_no_time_over_a_long_range() {
        for range in [-7..=5, -1000..=3, -5_000_000_000..=2, 0..=0, -10..=10_000_000_000] {
            let kept: Vec<i64> = thinned(range.clone(), 240).collect();
            assert!(kept.contains(&0) && kept.len() < 500, "{range:?}");
            assert!(kept.iter().all(|k| range.contains(k)));
        }
    }
}
