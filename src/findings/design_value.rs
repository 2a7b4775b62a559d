//! The best value of a design variable, with its uncertainty: the paper's question of which nominal
//! viscosity.

use super::CONFIDENCE;
use super::trade::{Paired, TradePoint, limit_shares};
use crate::campaign::common_numbers::Event;
use crate::campaign::trade::{Sweep, TradeOutcomes, design_value_anew};
use crate::error::Result;
use crate::numerics::elementary::ln;
use crate::numerics::interval::{Earned, Estimate};
use crate::reliability::jackknife::delete_a_group;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The best value of a design variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignValueFinding {
    /// Its path.
    pub path: String,
    /// Its value now, SI.
    pub present: f64,
    /// The range over which it was swept, SI.
    pub range: (f64, f64),
    /// The value at which P(any breach) is least, SI.
    pub best: Estimate,
    /// P(any breach) there, at points that the search has not seen.
    pub probability: Estimate,
    /// P there less P now, at the same points.
    pub difference: Estimate,
    /// P(any breach) over the range.
    pub points: Vec<TradePoint>,
}

/// Groups of rows from which the error of a best value is read.
const GROUPS: usize = 20;

/// The best value of a swept design variable.
pub(super) fn design_value(
    study: &Study,
    outcomes: &TradeOutcomes<'_>,
    paired: Paired,
    sweep: &Sweep,
) -> Result<DesignValueFinding> {
    let mut points = Vec::new();
    for setting in sweep.coarse.iter().chain(&sweep.fine) {
        points.push(TradePoint {
            setting: setting.value,
            probability: paired.probability(&setting.breaches, Event::Any)?,
            difference: paired.difference(&outcomes.base, &setting.breaches, Event::Any)?,
            limits: limit_shares(study, &setting.breaches),
            reweighted: None,
        });
    }
    points.sort_by(|a, b| a.setting.total_cmp(&b.setting));
    points.dedup_by(|a, b| a.setting == b.setting);
    let rows = outcomes.base.rows();
    let xs: Vec<f64> = sweep.fine.iter().map(|setting| setting.value).collect();
    let shares = |left_out: Option<usize>| -> Vec<f64> {
        let rows = || (0..rows).filter(|k| left_out != Some(k % GROUPS));
        sweep
            .fine
            .iter()
            .map(|setting| {
                let counts = setting.breaches.counts(Event::Any, rows());
                counts.most_breaches() as f64 / counts.samples.max(1) as f64
            })
            .collect()
    };
    let clean = shares(None).iter().any(|&share| share <= 0.0);
    let best = if clean {
        Estimate::none(format!("over a part of its range none of {rows} samples breaches a limit"))
    } else {
        best_value(&xs, &shares, (sweep.range.lower, sweep.range.upper)).0
    };
    // The nearest computed setting stands for P at the best value.
    let near = best.value.and_then(|value| {
        sweep.fine.iter().min_by(|a, b| (a.value - value).abs().total_cmp(&(b.value - value).abs()))
    });
    let none = || Estimate::none("no best value was found");
    let (probability, difference) = match near {
        Some(setting) => {
            let target = sweep.range.target;
            let (base, there) = design_value_anew(study, target, setting.value, rows as u64)?;
            let independent = Paired { replicates: 1 };
            (
                independent.probability(&there, Event::Any)?,
                independent.difference(&base, &there, Event::Any)?,
            )
        }
        None => (none(), none()),
    };
    Ok(DesignValueFinding {
        path: sweep.range.target.path(),
        present: study.design.at(sweep.range.target),
        range: (sweep.range.lower, sweep.range.upper),
        best,
        probability,
        difference,
        points,
    })
}

/// Why a best value has no interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unresolved {
    /// It is an end of its range.
    EndOfRange,
    /// Nothing breaches about it.
    NoBreach,
    /// P has no clear minimum.
    NoClearMinimum,
}

/// The least point of a parabola through ln P over the settings, with its error by leaving out one of
/// [`GROUPS`] groups of rows at a time (the delete-a-group jackknife).
pub(super) fn best_value(
    xs: &[f64],
    shares: &dyn Fn(Option<usize>) -> Vec<f64>,
    range: (f64, f64),
) -> (Estimate, Option<Unresolved>) {
    let ends = (xs.first().copied().unwrap_or(0.0), xs.last().copied().unwrap_or(0.0));
    let vertex = |left_out: Option<usize>| parabola_vertex(xs, &shares(left_out));
    let Some(value) = vertex(None).filter(|x| (ends.0..=ends.1).contains(x)) else {
        let ps = shares(None);
        let best = (0..xs.len()).min_by(|&a, &b| ps[a].total_cmp(&ps[b])).map(|k| xs[k]);
        let (unresolved, why) = match best {
            Some(x) if x <= range.0 || x >= range.1 => {
                (Unresolved::EndOfRange, "the best value is an end of its range")
            }
            _ => (Unresolved::NoClearMinimum, "P has no clear minimum over the range"),
        };
        let interval = Earned::none(why);
        return (Estimate { value: best, standard_error: None, interval }, Some(unresolved));
    };
    let parts: Option<Vec<f64>> = (0..GROUPS).map(|group| vertex(Some(group))).collect();
    let Some(parts) = parts else {
        let interval = Earned::none("without some of the samples P has no minimum");
        let estimate = Estimate { value: Some(value), standard_error: None, interval };
        return (estimate, Some(Unresolved::NoClearMinimum));
    };
    let method = "parabola through ln P, delete-a-group jackknife";
    (delete_a_group(value, &parts, CONFIDENCE, method), None)
}

/// The vertex of the least-squares parabola through (x, ln p), each weighted by p; `None` if it opens
/// downwards or a p is not positive in too many places.
fn parabola_vertex(xs: &[f64], ps: &[f64]) -> Option<f64> {
    let (first, last) = (*xs.first()?, *xs.last()?);
    let (centre, half) = (0.5 * (first + last), 0.5 * (last - first));
    let mut sums = [0.0; 5];
    let mut right = [0.0; 3];
    for (&x, &p) in xs.iter().zip(ps) {
        if p <= 0.0 {
            continue;
        }
        // ln of a count has variance 1/count.
        let (t, y) = ((x - centre) / half, ln(p));
        let mut power = p;
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += power;
            if k < 3 {
                right[k] += power * y;
            }
            power *= t;
        }
    }
    let matrix = nalgebra::Matrix3::new(
        sums[0], sums[1], sums[2], sums[1], sums[2], sums[3], sums[2], sums[3], sums[4],
    );
    let fit = matrix.lu().solve(&nalgebra::Vector3::from(right))?;
    (fit[2] > 0.0).then(|| centre - half * fit[1] / (2.0 * fit[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elementary::exp;

    #[test]
    fn analytic_the_vertex_of_a_parabola_is_found() {
        let xs: Vec<f64> = (0..9).map(|k| 80.0 + 5.0 * k as f64).collect();
        let ps: Vec<f64> =
            xs.iter().map(|x| exp((x - 103.0) * (x - 103.0) / 200.0 - 3.0)).collect();
        assert!((parabola_vertex(&xs, &ps).unwrap() - 103.0).abs() < 1e-9);
        assert_eq!(parabola_vertex(&xs, &[0.0; 9]), None);
    }
}
