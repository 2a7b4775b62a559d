//! Whether the measures agree on which factor matters most.

use super::{IndexColumn, MeasuredFactor, MeasuredOutput};
use crate::campaign::common_numbers::Event;
use crate::campaign::given_sample::GivenSample;
use crate::findings::drivers::DriversFinding;
use crate::findings::named::{FactorName, Output};
use crate::findings::shapley::ShapleyFinding;
use crate::numerics::interval::Estimate;
use crate::numerics::words::{self, Word};
use crate::study::{Limit, Study};
use serde::{Deserialize, Serialize};

/// The measures that are compared, beside Sobol' total and Shapley: index, and its name in a table.
const COMPARED: [(&str, &str); 8] = [
    ("first_order", "S₁ (ranks)"),
    ("borgonovo_delta", "Borgonovo δ"),
    ("pawn", "PAWN"),
    ("hsic", "HSIC"),
    ("srrc", "SRRC"),
    ("prcc", "PRCC"),
    ("morris_mu_star", "Morris μ*"),
    ("derivative_times_sd", "slope × sd"),
];

/// Ranks of the factors by every measure, of the outcome whose limit is breached most often.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankingFinding {
    /// The outcome, and in words.
    pub output: Output,
    /// See `output`.
    pub title: String,
    /// The measures.
    #[serde(deserialize_with = "words::list")]
    pub measures: Vec<Word>,
    /// One entry a factor: inputs, and groups instead of their members, by their mean rank.
    pub rows: Vec<RankRow>,
    /// Kendall's coefficient of concordance: 1 if all measures rank alike, 0 if at random.
    pub concordance: Option<f64>,
    /// How many of the measures put the same factor first.
    pub agree_on_first: usize,
}

/// The ranks of one factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankRow {
    /// Path of the input, or name of the group.
    pub factor: String,
    /// How many inputs it is.
    pub inputs: usize,
    /// Rank by every measure, from 1.
    pub ranks: Vec<usize>,
    /// Whether the measure tells the factor's effect from none; null if it cannot say.
    pub distinct: Vec<Option<bool>>,
}

/// One measure: a size of each factor, and whether it is told from nothing.
struct Measure {
    name: &'static str,
    sizes: Vec<f64>,
    distinct: Vec<Option<bool>>,
}

/// The ranking of the outcome that is breached most often, or of the first; `None` if fewer than two
/// measures have a value for every factor.
pub(super) fn ranking(
    study: &Study,
    sample: &GivenSample,
    factors: &[MeasuredFactor],
    outputs: &[MeasuredOutput],
    drivers: &DriversFinding,
    shapley: &ShapleyFinding,
) -> Option<RankingFinding> {
    let share = |name: &Output| {
        let is = |limit: &Limit| *name == Output::Outcome(limit.outcome);
        let limits = study.limits.iter().enumerate().filter(|(_, limit)| is(limit));
        let counts = limits.map(|(i, _)| sample.breaches.count(Event::Limit(i)).breaches);
        counts.max().unwrap_or(0)
    };
    let mut output = outputs.iter().find(|output| !output.breach)?;
    for other in outputs.iter().filter(|output| !output.breach) {
        if share(&other.name) > share(&output.name) {
            output = other;
        }
    }
    let places: Vec<usize> = (0..factors.len()).filter(|&f| !factors[f].grouped).collect();
    let names: Vec<&FactorName> = places.iter().map(|&f| &factors[f].name).collect();
    let mut measures: Vec<Measure> = Vec::new();
    let pick_freeze = drivers.outputs.iter().find(|found| found.name == output.name);
    measures.extend(pick_freeze.and_then(|found| {
        of_estimates("Sobol' total", &names, |name| {
            Some(&found.factors.iter().find(|factor| factor.name == *name)?.indices.total)
        })
    }));
    let shares = shapley.outputs.iter().find(|found| found.name == output.name);
    measures.extend(shares.and_then(|found| {
        of_estimates("Shapley", &names, |name| {
            Some(&found.effects.iter().find(|(factor, _)| *factor == name.name)?.1)
        })
    }));
    for (index, name) in COMPARED {
        let column = output.indices.iter().find(|column| column.index == index);
        measures.extend(column.and_then(|column| of_column(name, column, &places)));
    }
    if measures.len() < 2 || places.len() < 2 {
        return None;
    }
    let ranks: Vec<Vec<usize>> = measures.iter().map(|measure| ranks(&measure.sizes)).collect();
    let sum = |f: usize| ranks.iter().map(|ranks| ranks[f]).sum::<usize>();
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by_key(|&f| (sum(f), f));
    let first = |f: usize| ranks.iter().filter(|ranks| ranks[f] == 1).count();
    Some(RankingFinding {
        output: output.name.clone(),
        title: output.title.clone(),
        measures: measures.iter().map(|measure| measure.name).collect(),
        concordance: concordance(
            measures.len(),
            &order.iter().map(|&f| sum(f)).collect::<Vec<_>>(),
        ),
        agree_on_first: (0..places.len()).map(first).max().unwrap_or(0),
        rows: order
            .iter()
            .map(|&f| RankRow {
                factor: names[f].name.clone(),
                inputs: factors[places[f]].inputs,
                ranks: ranks.iter().map(|ranks| ranks[f]).collect(),
                distinct: measures.iter().map(|measure| measure.distinct[f]).collect(),
            })
            .collect(),
    })
}

fn of_estimates<'e>(
    name: &'static str,
    factors: &[&FactorName],
    find: impl Fn(&FactorName) -> Option<&'e Estimate>,
) -> Option<Measure> {
    let estimates: Vec<&Estimate> =
        factors.iter().map(|factor| find(factor)).collect::<Option<_>>()?;
    let sizes = estimates.iter().map(|estimate| estimate.value).collect::<Option<_>>()?;
    let distinct = estimates.iter().map(|e| Some(!e.interval.interval()?.contains(0.0))).collect();
    Some(Measure { name, sizes, distinct })
}

fn of_column(name: &'static str, column: &IndexColumn, places: &[usize]) -> Option<Measure> {
    let size = |&f: &usize| Some(column.estimates.get(f)?.value?.abs());
    // A size below zero is no size: only coefficients have a sign that says a direction.
    let signed = matches!(column.index, "srrc" | "prcc" | "derivative_times_sd");
    let sizes =
        places.iter().map(|f| if signed { size(f) } else { column.estimates.get(*f)?.value });
    let sizes = sizes.collect::<Option<_>>()?;
    Some(Measure { name, sizes, distinct: places.iter().map(|&f| column.distinct(f)).collect() })
}

/// Ranks from 1 for the largest; of equals the first comes first.
fn ranks(sizes: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]).then(a.cmp(&b)));
    let mut ranks = vec![0; sizes.len()];
    for (rank, &f) in order.iter().enumerate() {
        ranks[f] = rank + 1;
    }
    ranks
}

/// Kendall's W of sums of ranks: 12 Σ(R − R̄)² / (m² (n³ − n)).
fn concordance(measures: usize, sums: &[usize]) -> Option<f64> {
    let (m, n) = (measures as f64, sums.len() as f64);
    let mean = sums.iter().sum::<usize>() as f64 / n;
    let squares: f64 = sums.iter().map(|&sum| (sum as f64 - mean) * (sum as f64 - mean)).sum();
    (n > 1.0).then(|| 12.0 * squares / (m * m * (n * n * n - n)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_concordance_is_one_for_the_same_ranks_and_zero_for_opposite_ones() {
        assert_eq!(ranks(&[0.1, 0.5, 0.1, -0.2]), [2, 1, 3, 4]);
        assert_eq!(concordance(3, &[3, 6, 9, 12]), Some(1.0));
        assert_eq!(concordance(2, &[5, 5, 5, 5]), Some(0.0));
    }
}
