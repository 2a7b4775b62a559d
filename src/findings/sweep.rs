//! The design space of a study: outcomes, margins and probabilities over a grid, and what is best in it.

use super::CONFIDENCE;
use super::known::{GoAnswer, answer, stated};
use super::percent::percent;
use super::sweep_best::{BestFinding, best, choice, lines, searched};
use super::trade::proportion;
use crate::campaign::sweep::{Cell, Grid, Meaning, confirm, confirming_samples};
use crate::campaign::{self, Progress};
use crate::descent::OutcomeQuantity;
use crate::descent::reference::trajectory;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::physics::{Coefficients, Parameter};
use crate::reliability::demonstration::Requirement;
use crate::reliability::probability::Proportion;
use crate::study::{Limit, LimitKind, Study};
use crate::units::Quantity;
use serde::Serialize;
use std::collections::BTreeMap;

/// The design space of a study. Numbers are SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepFinding {
    /// Layout of this tree.
    pub format: u32,
    /// The study's title.
    pub title: String,
    /// The swept paths; of a cell's values the last varies fastest.
    pub paths: Vec<PathFinding>,
    /// The limits of the study.
    pub limits: Vec<LimitFinding>,
    /// Samples in each cell; `None` if only nominal descents were asked for.
    pub samples: Option<u64>,
    /// Samples of each setting that was found by looking over the cells and estimated anew; `None` if there is none.
    pub confirming_samples: Option<u64>,
    /// Largest acceptable probability of any breach, and the confidence with which it is to be shown.
    pub required: Option<(f64, f64)>,
    /// How the numbers were obtained, and what they do not say.
    pub method: Vec<String>,
    /// The cells.
    pub cells: Vec<CellFinding>,
    /// Which path is chosen: the place among the paths for which `best` gives the best value.
    pub choice: usize,
    /// The best value of the chosen path for every value of the other one; one entry for a single path.
    pub best: Vec<BestFinding>,
    /// Courses of nominal descents along a single path.
    pub courses: Vec<CourseFinding>,
    /// What it takes to have the same numbers again.
    pub reproduction: super::ReproductionFinding,
}

/// One swept path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathFinding {
    /// Dotted path.
    pub path: String,
    /// Column in tables, with the unit.
    pub column: String,
    /// What it is.
    pub description: &'static str,
    /// Kind of quantity.
    #[serde(skip)]
    pub quantity: Quantity,
    /// Its values.
    pub values: Vec<f64>,
    /// Its value in the study.
    pub present: f64,
    /// `design`, `held` or `centred`.
    pub meaning: &'static str,
    /// What a value means, in a sentence.
    pub statement: String,
}

/// A limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitFinding {
    /// Name in tables.
    pub name: String,
    /// The limited outcome.
    pub outcome: &'static str,
    /// What it is, for a person.
    #[serde(skip)]
    pub quantity: OutcomeQuantity,
    /// `max` or `min`.
    pub kind: &'static str,
    /// As written.
    pub text: String,
    /// SI.
    pub value: f64,
    /// Whether the study does not state it: the line must run out while a descent is followed.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub implied: bool,
}

/// One cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellFinding {
    /// Values of the swept paths.
    pub values: Vec<f64>,
    /// Whether the nominal line ran out; `None` if the descent could not be computed.
    pub deployed: Option<bool>,
    /// Why the nominal descent could not be computed.
    pub fault: Option<&'static str>,
    /// Nominal outcomes by column name.
    pub outcomes: BTreeMap<String, f64>,
    /// Nominal margin of each limit: negative is a breach.
    pub margins: Vec<Option<f64>>,
    /// The same as a share of what is allowed, see `allowed`.
    pub relative_margins: Vec<Option<f64>>,
    /// Place of the limit with the smallest relative margin.
    pub limiting: Option<usize>,
    /// P(any breach); `None` without samples.
    pub any: Option<Estimate>,
    /// P(any breach) at points independent of the search: of the best cell of each line, the one with the smallest P
    /// and those that seemed to meet the requirement.
    pub confirmed: Option<Estimate>,
    /// Breaches, faults and samples behind it.
    pub confirmed_counts: Option<Proportion>,
    /// P of each limit's breach.
    pub each: Vec<Estimate>,
    /// Breaches, faults and samples of any and of each limit.
    pub counts: Vec<Proportion>,
    /// Quantiles of each limit's outcome: 5 %, 50 %, 95 %.
    pub quantiles: Vec<Option<[f64; 3]>>,
    /// Whether the requirement is demonstrated here; where it seemed to be, by the points independent of the search.
    pub answer: GoAnswer,
}

/// The course of one nominal descent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CourseFinding {
    /// Value of the swept path.
    pub value: f64,
    /// Time since release, s.
    pub time_s: Vec<f64>,
    /// Separation velocity, m/s.
    pub velocity_m_per_s: Vec<f64>,
    /// Fluid temperature, K.
    pub fluid_temperature_k: Vec<f64>,
}

/// Everything there is to say of a sweep, what was found by looking estimated anew. `None` if `progress` asks for a stop.
///
/// # Errors
/// If a statistic refuses the study's requirement.
pub fn sweep(
    study: &Study,
    grid: &Grid,
    cells: &[Cell],
    samples: Option<u64>,
    command: String,
    progress: &Progress,
) -> Result<Option<SweepFinding>> {
    let requirement = stated(study)?;
    let mut found: Vec<CellFinding> = cells
        .iter()
        .map(|cell| cell_finding(study, grid, cell, requirement.as_ref()))
        .collect::<Result<_>>()?;
    let choice = choice(grid);
    let lines = lines(grid, choice);
    let xs = &grid.paths[choice].values;
    let searched: Vec<_> = lines.iter().map(|line| searched(xs, line, cells)).collect();
    let nearest: Vec<Option<usize>> = searched.iter().map(|found| found.at).collect();
    let mut confirming = None;
    if let Some(samples) = samples {
        let anew = found_by_looking(&lines, &nearest, &found);
        let settings = anew.iter().map(Vec::len).sum::<usize>() as u64;
        let rows = confirming_samples(samples, cells.len() as u64, settings);
        let values: Vec<Vec<Vec<f64>>> = anew
            .iter()
            .map(|line| line.iter().map(|&cell| found[cell].values.clone()).collect())
            .collect();
        let Some(counts) = confirm(study, grid, &values, rows, progress)? else { return Ok(None) };
        for (&cell, counts) in anew.iter().flatten().zip(counts.iter().flatten()) {
            let known = &mut found[cell];
            if known.answer == GoAnswer::Go {
                known.answer = answer(requirement.as_ref(), counts)?;
            }
            known.confirmed = Some(proportion(counts)?);
            known.confirmed_counts = Some(*counts);
        }
        confirming = (settings > 0).then_some(rows);
    }
    let best = lines
        .iter()
        .zip(searched)
        .map(|(line, searched)| best(grid, choice, line, &found, searched))
        .collect();
    let courses = match &grid.paths[..] {
        [_] => courses(study, grid),
        _ => Vec::new(),
    };
    Ok(Some(SweepFinding {
        format: 1,
        title: study.title.clone(),
        paths: (0..grid.paths.len()).map(|k| path_finding(study, grid, k)).collect(),
        limits: study
            .limits
            .iter()
            .map(|limit| LimitFinding {
                name: limit.name(),
                outcome: limit.outcome.name(),
                quantity: limit.outcome,
                kind: limit.kind.name(),
                text: limit.text.clone(),
                value: limit.value,
                implied: limit.implied,
            })
            .collect(),
        samples,
        confirming_samples: confirming,
        required: requirement.map(|required| (required.failure_limit(), required.confidence)),
        method: method(study, samples, confirming, requirement.as_ref()),
        cells: found,
        choice,
        best,
        courses,
        reproduction: super::ReproductionFinding {
            version: env!("CARGO_PKG_VERSION"),
            seed: study.sampling.seed,
            study_digest: study.digest(),
            files: study.file_digests(),
            command,
        },
    }))
}

/// The cells of every line that were found by looking over them: the best one, those that seem to meet the requirement,
/// and the one with the smallest P of all.
fn found_by_looking(
    lines: &[Vec<usize>],
    nearest: &[Option<usize>],
    cells: &[CellFinding],
) -> Vec<Vec<usize>> {
    let smallest = smallest(cells);
    let of_line = |(line, &nearest): (&Vec<usize>, &Option<usize>)| {
        let chosen = |&cell: &usize| {
            nearest == Some(cell) || smallest == Some(cell) || cells[cell].answer == GoAnswer::Go
        };
        line.iter().copied().filter(chosen).collect()
    };
    lines.iter().zip(nearest).map(of_line).collect()
}

/// The cell with the fewest breaches, faults counted; `None` where every sample of every cell breaches.
fn smallest(cells: &[CellFinding]) -> Option<usize> {
    let worst = |k: usize| cells[k].counts.first().map_or(u64::MAX, Proportion::most_breaches);
    let found = (0..cells.len()).min_by_key(|&k| worst(k))?;
    let any = cells[found].counts.first()?;
    (any.most_breaches() < any.samples).then_some(found)
}

fn path_finding(study: &Study, grid: &Grid, k: usize) -> PathFinding {
    let path = &grid.paths[k];
    let info = path.target.parameter.info();
    let name = path.target.path();
    let (meaning, statement) = match path.meaning {
        Meaning::Design => ("design", "a design value, of which the card says nothing".to_owned()),
        Meaning::Held => (
            "held",
            format!(
                "its value is taken as known: it replaces the card's law, since whoever asks what to do at a \
                 value of it will have measured it (--centre {name} moves the law there instead)"
            ),
        ),
        Meaning::Centred => (
            "centred",
            format!(
                "its value is nominal: the card's law moves there with its mean and keeps its spread (--hold \
                 {name} takes the value as exact)"
            ),
        ),
    };
    PathFinding {
        column: path.target.column(),
        path: name,
        description: info.description,
        quantity: info.quantity,
        values: path.values.clone(),
        present: study.design.at(path.target),
        meaning,
        statement,
    }
}

fn method(
    study: &Study,
    samples: Option<u64>,
    confirming: Option<u64>,
    required: Option<&Requirement>,
) -> Vec<String> {
    let mut lines = vec![format!(
        "Nominal: one descent a cell by the plain integrator, {} model, every other input at its nominal \
         value.",
        study.model.name()
    )];
    if let Some(samples) = samples {
        lines.push(format!(
            "Probabilities: {samples} plain Monte Carlo samples a cell, the same points in every cell (common \
             random numbers), so that the map is smooth and neighbours differ by their design alone. The \
             errors of all cells are therefore alike: the whole map may lie a little high or low, and its cells \
             do not confirm each other."
        ));
        lines.push(format!(
            "Intervals: Clopper-Pearson, {} %, each cell by itself; of many cells some intervals miss, and as the \
             cells share their points, they miss together.",
            100.0 * CONFIDENCE
        ));
        lines.push(
            "Best values: the least point of a parabola through ln P about the smallest P; its interval is by \
             leaving out one of 20 groups of samples at a time, and as much wider as the parabola through \
             the three nearest settings differs."
                .to_owned(),
        );
    }
    if let Some(rows) = confirming {
        lines.push(format!(
            "What was found by looking over the cells has the luck of their points on its side: the best cell of each \
             line, the cell with the smallest P and every cell that seems to meet the requirement are estimated anew \
             with {rows} plain Monte Carlo samples independent of the search. P at a best value is that estimate. \
             Cells of one line share these points and err together; lines are independent of each other."
        ));
    }
    if let (Some(required), Some(_)) = (required, samples) {
        lines.push(format!(
            "A cell meets the requirement if the samples independent of the search demonstrate P(any breach) ≤ {} \
             there at {} confidence. This holds for each cell by itself and not for all at once: of many cells that \
             just miss the requirement, up to {} will be said to meet it.",
            percent(required.failure_limit()),
            percent(required.confidence),
            percent(1.0 - required.confidence)
        ));
    }
    lines
}

/// What a margin is a share of: the limit itself; of a highest temperature, the rise from the start to it.
fn allowed(study: &Study, grid: &Grid, values: &[f64], limit: &Limit) -> f64 {
    let is_temperature = limit.outcome.quantity() == Quantity::Temperature;
    if is_temperature && limit.kind == LimitKind::Max {
        let rise = limit.value - grid.design(study, values).get(Parameter::InitialTemperature);
        if rise > 0.0 {
            return rise;
        }
    }
    if limit.value == 0.0 { 1.0 } else { limit.value.abs() }
}

fn cell_finding(
    study: &Study,
    grid: &Grid,
    cell: &Cell,
    requirement: Option<&Requirement>,
) -> Result<CellFinding> {
    let nominal = cell.nominal.as_ref().ok();
    let margins: Vec<Option<f64>> =
        study.limits.iter().map(|limit| Some(limit.margin(nominal?))).collect();
    let relative_margins: Vec<Option<f64>> = study
        .limits
        .iter()
        .zip(&margins)
        .map(|(limit, margin)| Some((*margin)? / allowed(study, grid, &cell.values, limit)))
        .collect();
    let known = relative_margins.iter().enumerate().filter_map(|(k, m)| Some((k, (*m)?)));
    let limiting = known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
    let counts = cell.sampled.iter().flat_map(|s| std::iter::once(&s.any).chain(&s.limits));
    let counts: Vec<Proportion> = counts.copied().collect();
    Ok(CellFinding {
        values: cell.values.clone(),
        deployed: nominal.map(|outcome| outcome.deployed),
        fault: cell.nominal.as_ref().err().map(|fault| fault.name()),
        outcomes: nominal
            .into_iter()
            .flat_map(|o| OutcomeQuantity::ALL.map(|q| (q.column(), o.get(q))))
            .collect(),
        margins,
        relative_margins,
        limiting,
        any: counts.first().map(proportion).transpose()?,
        confirmed: None,
        confirmed_counts: None,
        each: counts.iter().skip(1).map(proportion).collect::<Result<_>>()?,
        answer: match counts.first() {
            Some(any) => answer(requirement, any)?,
            None => GoAnswer::NoRequirement,
        },
        counts,
        quantiles: cell.sampled.as_ref().map_or(Vec::new(), |s| s.quantiles.clone()),
    })
}

/// Most courses drawn together.
const MOST_COURSES: usize = 6;
/// Accuracy of a course, and its longest step, s: fine enough to draw from.
const COURSE: (f64, f64) = (1e-7, 1.0);

/// The courses of a few descents from end to end of a path.
fn courses(study: &Study, grid: &Grid) -> Vec<CourseFinding> {
    let cells = grid.cells();
    let shown = cells.len().min(MOST_COURSES);
    let places: Vec<usize> = (0..shown).map(|k| k * (cells.len() - 1) / (shown - 1)).collect();
    let found = campaign::in_parallel(&places, |&k| {
        let coefficients = Coefficients::new(&grid.design(study, &cells[k]));
        let course = trajectory(&coefficients, study.model, COURSE.0, COURSE.1).ok()?;
        let samples = &course.samples;
        Some(CourseFinding {
            value: cells[k][0],
            time_s: samples.iter().map(|s| s.time_s).collect(),
            velocity_m_per_s: samples.iter().map(|s| s.observation[4]).collect(),
            fluid_temperature_k: samples.iter().map(|s| s.temperatures_k[0]).collect(),
        })
    });
    found.into_iter().flatten().collect()
}
