//! The same run twice: in other units, thinned out, with fewer digits.

use super::channel::Channel;
use crate::error::{Error, Result};
use crate::study::MeasuredRun;

/// Share of a channel's range within which two readings are the same.
const SAME: f64 = 1e-3;
/// Share of the readings that must be the same.
const MOST: f64 = 0.95;
/// Fewest readings from which that can be told.
const LEAST: usize = 5;

/// Refuses runs whose contents are the same, calibrated ones and held-out ones.
///
/// # Errors
/// [`Error::Argument`] naming both.
pub fn refuse_twice(runs: &[&MeasuredRun], held_out: &[&MeasuredRun]) -> Result<()> {
    let all: Vec<(&MeasuredRun, bool)> = runs
        .iter()
        .map(|run| (*run, false))
        .chain(held_out.iter().map(|run| (*run, true)))
        .collect();
    for (k, (run, held)) in all.iter().enumerate() {
        let Some((other, other_held)) = all[..k].iter().find(|(other, _)| same(other, run)) else {
            continue;
        };
        let why = match held == other_held {
            true => "each run counts once",
            false => "a run that was calibrated with is no test of the calibration",
        };
        return Err(Error::argument(format!(
            "{} and {} hold the same readings: {why}",
            other.origin, run.origin
        )));
    }
    Ok(())
}

/// Whether two runs have the same readings, whatever units, digits and lines of theirs were kept: at nearly every time
/// of the one with fewer, every channel of both reads the same.
pub fn same(a: &MeasuredRun, b: &MeasuredRun) -> bool {
    if a.digest == b.digest {
        return true;
    }
    let (more, fewer) = if a.time_s.len() >= b.time_s.len() { (a, b) } else { (b, a) };
    let common: Vec<(&[f64], &[f64], f64)> = Channel::ALL
        .into_iter()
        .filter_map(|channel| Some((channel.measured(more)?, channel.measured(fewer)?)))
        .map(|(more, fewer)| (more, fewer, SAME * range(more)))
        .collect();
    if common.is_empty() || fewer.time_s.len() < LEAST {
        return false;
    }
    let alike = |shift_s: f64| {
        let there = |k: usize| {
            common.iter().all(|(more_values, fewer_values, within)| {
                at(&more.time_s, more_values, fewer.time_s[k] + shift_s)
                    .is_some_and(|value| (value - fewer_values[k]).abs() <= *within)
            })
        };
        let count = (0..fewer.time_s.len()).filter(|&k| there(k)).count();
        count as f64 >= MOST * fewer.time_s.len() as f64
    };
    // By the same clock, or each by its own from the first reading on.
    alike(0.0) || alike(more.time_s[0] - fewer.time_s[0])
}

/// How far readings range; of readings that do not, their size.
fn range(values: &[f64]) -> f64 {
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    if high > low { high - low } else { high.abs() }
}

/// A history at a time, linear between its readings; nothing outside of it.
fn at(times: &[f64], values: &[f64], time: f64) -> Option<f64> {
    let slack = 1e-6 * (times.last()? - times.first()?);
    let after = times.partition_point(|&t| t < time - slack);
    let (t, value) = (*times.get(after)?, *values.get(after)?);
    if (t - time).abs() <= slack || after == 0 {
        return ((t - time).abs() <= slack).then_some(value);
    }
    let (t0, v0) = (times[after - 1], values[after - 1]);
    Some(v0 + (time - t0) / (t - t0) * (value - v0))
}
