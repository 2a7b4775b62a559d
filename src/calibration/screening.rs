//! A look at readings before anything is believed of them: gaps, outliers, sensors at their stops, and units that
//! were mistaken.

use crate::numerics::elementary::{exp, ln};
use serde::Serialize;

/// Something about a channel's readings that a person should look at.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Suspicion {
    /// No readings for several times the usual interval.
    Gap {
        /// Last reading before, s.
        from_s: f64,
        /// First reading after, s.
        to_s: f64,
    },
    /// A reading far from its neighbours.
    Outlier {
        /// When, s.
        time_s: f64,
        /// The reading, SI.
        value: f64,
        /// Distance from its neighbours' mean, in robust standard deviations of such distances.
        deviations: f64,
    },
    /// The same reading many times in a row: at the top or the bottom a sensor at its stop, else one that hangs.
    Stuck {
        /// First such reading, s.
        from_s: f64,
        /// Last such reading, s.
        to_s: f64,
        /// The reading, SI.
        value: f64,
        /// Whether it is the largest or the smallest of the channel.
        at_the_stop: bool,
    },
    /// The readings are off by a factor that mistaken units have.
    Unit {
        /// Median of reading over prediction.
        ratio: f64,
        /// The usual factor near it.
        factor: f64,
        /// What was probably taken for what.
        mistake: &'static str,
    },
    /// The readings are off by more than the card allows, and by no usual factor.
    Implausible {
        /// Median of reading over prediction.
        ratio: f64,
        /// The largest ratio, or the smallest, that the card explains.
        bound: f64,
    },
}

/// An interval this many times the usual one is a gap.
const GAP: f64 = 3.5;
/// Robust standard deviations beyond which a reading is an outlier.
const OUTLYING: f64 = 12.0;
/// How near to a whole number of steps a difference must be.
const WHOLE: f64 = 0.01;
/// Different readings from which on a step can be told.
const FEWEST_STEPS: usize = 10;
/// Equal readings in a row that make a sensor suspect.
const STUCK: usize = 8;
/// Standard deviations of the prior prediction beyond which readings are not explained.
const UNEXPLAINED: f64 = 4.0;

/// Gaps, outliers and stuck sensors of a channel: times (s) and readings.
pub fn screen(times_s: &[f64], values: &[f64]) -> Vec<Suspicion> {
    let mut found = gaps(times_s);
    found.extend(stuck(times_s, values));
    found.extend(outliers(times_s, values));
    found
}

fn gaps(times_s: &[f64]) -> Vec<Suspicion> {
    let intervals: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(usual) = median(&intervals) else { return Vec::new() };
    times_s
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > GAP * usual)
        .map(|pair| Suspicion::Gap { from_s: pair[0], to_s: pair[1] })
        .collect()
}

fn stuck(times_s: &[f64], values: &[f64]) -> Vec<Suspicion> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut found = Vec::new();
    let mut start = 0;
    for k in 1..=values.len() {
        if k < values.len() && values[k] == values[start] {
            continue;
        }
        // A channel that never changes is a constant, not a stop.
        if k - start >= STUCK && low < high {
            let value = values[start];
            found.push(Suspicion::Stuck {
                from_s: times_s[start],
                to_s: times_s[k - 1],
                value,
                at_the_stop: value == low || value == high,
            });
        }
        start = k;
    }
    found
}

fn outliers(times_s: &[f64], values: &[f64]) -> Vec<Suspicion> {
    let bends: Vec<f64> =
        values.windows(3).map(|three| (three[1] - 0.5 * (three[0] + three[2])).abs()).collect();
    let Some(usual) = median(&bends) else { return Vec::new() };
    // The median of |N(0, 1)| is 0.6745; a channel of few digits has many equal neighbours.
    let scale = (usual / 0.674_489_750_196_081_7).max(1e-9 * values[0].abs());
    let mut found = Vec::new();
    for (k, three) in values.windows(3).enumerate() {
        // A spike stands off both its neighbours on the same side; where a ramp ends, one of them is level.
        let (before, after) = (three[1] - three[0], three[1] - three[2]);
        if before * after <= 0.0 {
            continue;
        }
        let deviations = before.abs().min(after.abs()) / scale;
        if deviations > OUTLYING {
            found.push(Suspicion::Outlier {
                time_s: times_s[k + 1],
                value: values[k + 1],
                deviations,
            });
        }
    }
    found
}

/// Factors of usual mistakes, reading over truth, for quantities with a true zero.
const FACTORS: [(f64, &str); 16] = [
    (
        1.0 / 0.3048,
        "m/s were written as ft/s, or metres as feet, and the factor applied the wrong way round",
    ),
    (0.3048, "m/s called ft/s, or metres called feet"),
    (1.0 / 4.448_221_615_260_5, "N called lbf, and the conversion applied the wrong way round"),
    (4.448_221_615_260_5, "N called lbf"),
    (0.453_592_37, "lbf called kgf"),
    (1.0 / 0.453_592_37, "kgf called lbf"),
    (9.806_65, "N called kgf"),
    (1.0 / 9.806_65, "kgf called N"),
    (1.0 / 1.466_666_666_666_666_7, "mph called ft/s"),
    (1.466_666_666_666_666_7, "ft/s called mph"),
    (60.0, "per minute called per second"),
    (1.0 / 60.0, "per second called per minute"),
    (1000.0, "thousandths called whole units"),
    (1e-3, "thousands called whole units"),
    (0.514_444_444_444_444_5, "m/s called knots, and the conversion applied the wrong way round"),
    (1.943_844_492_440_604_9, "knots called m/s"),
];

/// Looks for a mistaken unit in a quantity with a true zero: `ratio` is the median of reading over prediction at the
/// centre of the prior, `ln_sd` the spread of the logarithm of predictions over the prior.
pub fn suspect_factor(ratio: f64, ln_sd: f64) -> Option<Suspicion> {
    let (spread, off) = (ln_sd.max(0.02), ln(ratio.max(1e-300)));
    if off.abs() <= UNEXPLAINED * spread {
        return None;
    }
    let nearest = FACTORS
        .iter()
        .map(|&(factor, mistake)| ((off - ln(factor)).abs(), factor, mistake))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(distance, ..)| *distance <= 2.5 * spread);
    Some(match nearest {
        Some((_, factor, mistake)) => Suspicion::Unit { ratio, factor, mistake },
        None => {
            let bound = exp(UNEXPLAINED * spread * off.signum());
            Suspicion::Implausible { ratio, bound }
        }
    })
}

/// Looks for a mistaken scale in temperatures, K: `reading` and `predicted` are medians over the run, `sd` the spread
/// of the prediction over the prior.
pub fn suspect_scale(reading_k: f64, predicted_k: f64, sd_k: f64) -> Option<Suspicion> {
    let spread = sd_k.max(3.0);
    let far = |k: f64| (k - predicted_k).abs() / spread;
    if far(reading_k) <= UNEXPLAINED {
        return None;
    }
    let celsius = reading_k - 273.15;
    let fahrenheit = 1.8 * celsius + 32.0;
    let mistakes = [
        (fahrenheit + 273.15, "°C called °F"),
        ((celsius - 32.0) / 1.8 + 273.15, "°F called °C"),
        ((reading_k + 459.67) / 1.8, "°F called K"),
        (reading_k + 273.15, "°C called K"),
        (celsius, "K called °C"),
    ];
    let nearest = mistakes.into_iter().min_by(|a, b| far(a.0).total_cmp(&far(b.0)));
    let ratio = reading_k / predicted_k;
    Some(match nearest {
        Some((meant, mistake)) if far(meant) <= 3.0 => {
            Suspicion::Unit { ratio, factor: reading_k / meant, mistake }
        }
        _ => Suspicion::Implausible {
            ratio,
            bound: 1.0 + (reading_k - predicted_k).signum() * UNEXPLAINED * spread / predicted_k,
        },
    })
}

/// The middle one of some numbers.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => None,
        _ if n % 2 == 1 => Some(sorted[n / 2]),
        _ => Some(0.5 * (sorted[n / 2 - 1] + sorted[n / 2])),
    }
}

/// The step to which readings are rounded: the smallest difference between any two, if all are whole multiples of it apart;
/// none for readings that are not rounded, as far as one can see.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let range = sorted.last()? - sorted.first()?;
    let differences: Vec<f64> = sorted
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|difference| *difference > 1e-9 * range)
        .collect();
    let step = differences.iter().copied().reduce(f64::min)?;
    let whole = |difference: &f64| {
        let steps = difference / step;
        (steps - steps.round()).abs() < WHOLE
    };
    // A few different values could be anything.
    (differences.len() >= FEWEST_STEPS && differences.iter().all(whole)).then_some(step)
}
