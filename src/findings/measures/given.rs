//! The indices from samples already run.

use super::MeasuredOutput;
use super::index::IndexColumn;
use crate::campaign::common_numbers::Event;
use crate::campaign::given_sample::{Breaching, GivenSample};
use crate::campaign::in_parallel;
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::findings::CONFIDENCE;
use crate::findings::named::Output;
use crate::findings::probabilities::breach_of;
use crate::sensitivity::borgonovo::borgonovo_delta;
use crate::sensitivity::given_data::GivenData;
use crate::sensitivity::hsic::hsic;
use crate::sensitivity::pawn::pawn;
use crate::sensitivity::rank_index::first_order;
use crate::sensitivity::regression::{Regression, rank_regression, regression};
use crate::sensitivity::target::among_breaches;
use crate::study::Study;

/// Samples that the distances between laws are estimated from: their cost grows with them.
const DISTANCE_ROWS: usize = 4_000;
/// Samples that the dependence and its permutation test are estimated from.
const DEPENDENCE_ROWS: usize = 2_000;
/// Permutations of the test: no p-value is below one over one more.
const PERMUTATIONS: usize = 499;

const ERROR: &str = "its sampling error is larger than the index";
const BIAS: &str = "what chance alone makes of it was taken off, and no more was left";
const REPLICATED: &str = "the points of this design are not independent";

/// What one task estimates.
#[derive(Debug, Clone, Copy)]
enum Method {
    FirstOrder,
    Delta,
    Pawn,
    Dependence,
    Regression,
    RankRegression,
    Among,
}

/// What is looked at.
#[derive(Debug, Clone, Copy)]
enum Asked {
    Outcome(OutcomeQuantity),
    Breach(usize, Event),
}

/// The outputs of a study with their indices from the sample.
pub(super) fn outputs(study: &Study, sample: &GivenSample) -> Result<Vec<MeasuredOutput>> {
    let limited = |q: &OutcomeQuantity| {
        study.limits.is_empty() || study.limits.iter().any(|limit| limit.outcome == *q)
    };
    let outcomes = OutcomeQuantity::ALL.into_iter().filter(limited).map(Asked::Outcome);
    let events = sample.breaching.iter().enumerate().map(|(i, _)| match i {
        i if i < study.limits.len() => Asked::Breach(i, Event::Limit(i)),
        i => Asked::Breach(i, Event::Any),
    });
    let outputs: Vec<Asked> = outcomes.chain(events).collect();
    let tasks: Vec<(usize, Method)> = outputs
        .iter()
        .enumerate()
        .flat_map(|(o, output)| output.methods().iter().map(move |method| (o, *method)))
        .collect();
    let found = in_parallel(&tasks, |&(o, method)| -> Result<(usize, Vec<IndexColumn>)> {
        let columns = outputs[o].estimate(study, sample, method)?.into_iter();
        let replicated = sample.replicates > 1;
        let earned = |c: IndexColumn| if replicated { c.without_intervals(REPLICATED) } else { c };
        Ok((o, columns.map(earned).collect()))
    });
    let mut all: Vec<MeasuredOutput> = outputs.iter().map(|output| output.named(study)).collect();
    for columns in found {
        let (o, columns) = columns?;
        all[o].indices.extend(columns);
    }
    Ok(all)
}

impl Asked {
    fn methods(self) -> &'static [Method] {
        match self {
            // The dear ones first, so that the last thread is not left with one.
            Asked::Outcome(_) => &[
                Method::Delta,
                Method::Dependence,
                Method::Pawn,
                Method::RankRegression,
                Method::Regression,
                Method::FirstOrder,
            ],
            Asked::Breach(..) => &[Method::Dependence, Method::Among, Method::FirstOrder],
        }
    }

    fn named(self, study: &Study) -> MeasuredOutput {
        let (name, title, breach) = match self {
            Asked::Outcome(q) => (Output::Outcome(q), q.title().to_owned(), false),
            Asked::Breach(_, Event::Limit(i)) => {
                let limit = &study.limits[i];
                (Output::breach_of(limit), breach_of(limit), true)
            }
            Asked::Breach(_, Event::Any) => {
                (Output::AnyBreach, "breach of any limit".to_owned(), true)
            }
        };
        MeasuredOutput { name, title, breach, indices: Vec::new() }
    }

    fn values(self, sample: &GivenSample) -> Vec<f64> {
        match self {
            Asked::Outcome(quantity) => sample.outcomes.column(quantity as usize).to_vec(),
            Asked::Breach(_, event) => sample.breaches.indicator(event),
        }
    }

    fn estimate(
        self,
        study: &Study,
        sample: &GivenSample,
        method: Method,
    ) -> Result<Vec<IndexColumn>> {
        let values = self.values(sample);
        let seed = study.sampling.seed;
        let breach = matches!(self, Asked::Breach(..));
        Ok(match method {
            Method::FirstOrder => {
                let data = first_rows(&sample.scores, &values, values.len())?;
                let found = first_order(&data, CONFIDENCE)?;
                let name = if breach { "target_first_order" } else { "first_order" };
                let method = "ranks (Chatterjee)";
                vec![
                    IndexColumn::new(name, method, data.rows(), found, Some(ERROR))
                        .leaving_out(data.left_out()),
                ]
            }
            Method::Delta => {
                let data = first_rows(&sample.scores, &values, DISTANCE_ROWS)?;
                let found = borgonovo_delta(&data, CONFIDENCE)?;
                let method = "cross-fitted copula density";
                vec![
                    IndexColumn::new("borgonovo_delta", method, data.rows(), found, Some(ERROR))
                        .leaving_out(data.left_out()),
                ]
            }
            Method::Pawn => {
                let data = first_rows(&sample.scores, &values, DISTANCE_ROWS)?;
                let found = pawn(&data, CONFIDENCE, seed)?;
                let found = found.into_iter().map(|found| found.mean).collect();
                let method = "mean Kolmogorov-Smirnov distance over classes, bias taken off";
                vec![
                    IndexColumn::new("pawn", method, data.rows(), found, Some(BIAS))
                        .leaving_out(data.left_out()),
                ]
            }
            Method::Dependence => {
                let name = if breach { "target_hsic" } else { "hsic" };
                vec![dependence(name, &sample.scores, &values, seed)?]
            }
            Method::Regression => {
                let data = first_rows(&sample.values, &values, values.len())?;
                let found = regression(&data, &factors(sample), CONFIDENCE)?;
                let names = ["src", "pcc"];
                regressed(names, "linear regression", &data, found)
            }
            Method::RankRegression => {
                let data =
                    first_rows(&sample.scores[..sample.values.len()], &values, values.len())?;
                let found = rank_regression(&data, &factors(sample), CONFIDENCE)?;
                regressed(["srrc", "prcc"], "regression of ranks", &data, found)
            }
            Method::Among => self.among(sample, seed)?,
        })
    }

    /// The conditional sensitivities: of and among the samples that breach.
    fn among(self, sample: &GivenSample, seed: u64) -> Result<Vec<IndexColumn>> {
        let Asked::Breach(event, _) = self else { return Ok(Vec::new()) };
        let Some(Breaching { scores, excess, .. }) = sample.breaching.get(event) else {
            return Ok(Vec::new());
        };
        let rows = excess.len();
        let found: Vec<_> =
            scores.iter().map(|scores| among_breaches(scores, CONFIDENCE)).collect();
        let p_values = found.iter().map(|found| found.p_value).collect();
        let (shifts, distances) = found.into_iter().map(|f| (f.shift, f.distance)).unzip();
        let shift = "mean normal score among the breaching samples";
        let distance =
            "Kolmogorov-Smirnov distance of the breaching samples' law from the input's own";
        let mut columns = vec![
            IndexColumn::new("conditional_shift", shift, rows, shifts, None),
            IndexColumn::new("conditional_distance", distance, rows, distances, None)
                .tested(p_values),
        ];
        columns.push(dependence("conditional_hsic", scores, excess, seed)?);
        Ok(columns)
    }
}

/// The first rows of a sample, without what could not be computed.
fn first_rows(columns: &[Vec<f64>], values: &[f64], rows: usize) -> Result<GivenData> {
    let rows = rows.min(values.len());
    let columns: Vec<&[f64]> = columns.iter().map(|column| &column[..rows]).collect();
    GivenData::new(&columns, &values[..rows])
}

fn dependence(
    name: &'static str,
    scores: &[Vec<f64>],
    values: &[f64],
    seed: u64,
) -> Result<IndexColumn> {
    let data = first_rows(scores, values, DEPENDENCE_ROWS)?;
    let found = hsic(&data, CONFIDENCE, PERMUTATIONS, seed)?;
    let p_values = found.iter().map(|found| found.p_value).collect();
    let found = found.into_iter().map(|found| found.coefficient).collect();
    let method = "HSIC of ranks, less its mean over permutations; p-value by 499 of them";
    Ok(IndexColumn::new(name, method, data.rows(), found, Some(BIAS))
        .tested(p_values)
        .leaving_out(data.left_out()))
}

fn factors(sample: &GivenSample) -> Vec<&[usize]> {
    sample.factors.iter().map(|factor| factor.columns.as_slice()).collect()
}

fn regressed(
    names: [&'static str; 2],
    method: &'static str,
    data: &GivenData,
    found: Regression,
) -> Vec<IndexColumn> {
    let columns = names.into_iter().zip([found.standardized, found.partial]);
    let columns = columns.map(|(name, found)| {
        IndexColumn::new(name, method, data.rows(), found, None).leaving_out(data.left_out())
    });
    columns.collect()
}
