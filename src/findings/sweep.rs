//! The design space of a study: outcomes, margins and probabilities over a grid, and what is best in it.

use super::CONFIDENCE;
use super::demonstration::percent;
use super::design_value::best_value;
use super::known::{GoAnswer, answer, stated};
use super::trade::proportion;
use crate::campaign::sweep::{Cell, GROUPS, Grid, Meaning, Sampled};
use crate::campaign::{self};
use crate::descent::OutcomeQuantity;
use crate::descent::reference::trajectory;
use crate::error::Result;
use crate::numerics::interval::{Earned, Estimate};
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
    /// The same as a share of what is allowed, see [`allowed`].
    pub relative_margins: Vec<Option<f64>>,
    /// Place of the limit with the smallest relative margin.
    pub limiting: Option<usize>,
    /// P(any breach); `None` without samples.
    pub any: Option<Estimate>,
    /// P of each limit's breach.
    pub each: Vec<Estimate>,
    /// Breaches, faults and samples of any and of each limit.
    pub counts: Vec<Proportion>,
    /// Quantiles of each limit's outcome: 5 %, 50 %, 95 %.
    pub quantiles: Vec<Option<[f64; 3]>>,
    /// Whether the requirement is demonstrated here.
    pub answer: GoAnswer,
}

/// The best value of the chosen path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestFinding {
    /// Value of the other path.
    pub given: Option<f64>,
    /// The value at which P(any breach) is least.
    pub best: Estimate,
    /// P(any breach) at the nearest setting.
    pub probability: Option<Estimate>,
    /// Ends of the settings at which the requirement is demonstrated.
    pub met: Option<(f64, f64)>,
    /// Ends of the settings at which it is not refuted.
    pub open: Option<(f64, f64)>,
    /// The setting with the largest smallest relative margin of the nominal descent, and that margin.
    pub nominal: Option<(f64, f64)>,
    /// Ends of the settings whose nominal descent keeps every limit, interpolated.
    pub feasible: Option<(f64, f64)>,
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

/// Everything there is to say of a sweep.
///
/// # Errors
/// If a statistic refuses the study's requirement.
pub fn sweep(
    study: &Study,
    grid: &Grid,
    cells: &[Cell],
    samples: Option<u64>,
    command: String,
) -> Result<SweepFinding> {
    let requirement = stated(study)?;
    let cells: Vec<(CellFinding, Option<&Sampled>)> = cells
        .iter()
        .map(|cell| {
            let finding = cell_finding(study, grid, cell, requirement.as_ref())?;
            Ok((finding, cell.sampled.as_ref()))
        })
        .collect::<Result<_>>()?;
    let choice = choice(grid);
    let best = lines(grid, choice).iter().map(|line| best(grid, choice, line, &cells)).collect();
    let courses = match &grid.paths[..] {
        [_] => courses(study, grid),
        _ => Vec::new(),
    };
    Ok(SweepFinding {
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
            })
            .collect(),
        samples,
        required: requirement.map(|required| (required.failure_limit(), required.confidence)),
        method: method(study, samples, requirement.as_ref()),
        cells: cells.into_iter().map(|(finding, _)| finding).collect(),
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
    })
}

/// The path that is chosen: the first, unless it alone is one whose value is given to whoever chooses.
fn choice(grid: &Grid) -> usize {
    match &grid.paths[..] {
        [first, second] if first.meaning == Meaning::Held && second.meaning != Meaning::Held => 1,
        _ => 0,
    }
}

/// Places of the cells along the chosen path, for every value of the other.
fn lines(grid: &Grid, choice: usize) -> Vec<Vec<usize>> {
    let counts: Vec<usize> = grid.paths.iter().map(|path| path.values.len()).collect();
    match counts[..] {
        [rows, columns] if choice == 0 => {
            (0..columns).map(|c| (0..rows).map(|r| r * columns + c).collect()).collect()
        }
        [rows, columns] => {
            (0..rows).map(|r| (0..columns).map(|c| r * columns + c).collect()).collect()
        }
        _ => vec![(0..counts.iter().product()).collect()],
    }
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

fn method(study: &Study, samples: Option<u64>, required: Option<&Requirement>) -> Vec<String> {
    let mut lines = vec![format!(
        "Nominal: one descent a cell by the plain integrator, {} model, every other input at its nominal \
         value.",
        study.model.name()
    )];
    if let Some(samples) = samples {
        lines.push(format!(
            "Probabilities: {samples} plain Monte Carlo samples a cell, the same points in every cell (common \
             random numbers), so that the map is smooth and neighbours differ by their design alone. The \
             errors of neighbouring cells are therefore alike: the whole map may lie a little high or low."
        ));
        lines.push(format!(
            "Intervals: Clopper-Pearson, {} %, each cell by itself.",
            100.0 * CONFIDENCE
        ));
        lines.push(
            "Best values: the least point of a parabola through ln P about the smallest P; its interval is by \
             leaving out one of 20 groups of samples at a time, and as much wider as the parabola through \
             the three nearest settings differs."
                .to_owned(),
        );
    }
    if let (Some(required), Some(_)) = (required, samples) {
        lines.push(format!(
            "A cell meets the requirement if P(any breach) ≤ {} is demonstrated there at {} confidence, each \
             cell by itself: of many cells that just miss it, some will seem to meet it.",
            percent(required.failure_limit()),
            percent(required.confidence)
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
        each: counts.iter().skip(1).map(proportion).collect::<Result<_>>()?,
        answer: match counts.first() {
            Some(any) => answer(requirement, any)?,
            None => GoAnswer::NoRequirement,
        },
        counts,
        quantiles: cell.sampled.as_ref().map_or(Vec::new(), |s| s.quantiles.clone()),
    })
}

/// The longest run of settings that hold, by its ends.
fn longest_run(line: &[usize], holds: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
    let mut longest: Option<(usize, usize)> = None;
    let mut start = None;
    for (k, &cell) in line.iter().enumerate() {
        start = if holds(cell) { start.or(Some(k)) } else { None };
        if let Some(start) = start
            && longest.is_none_or(|(a, b)| k - start > b - a)
        {
            longest = Some((start, k));
        }
    }
    longest
}

fn best(
    grid: &Grid,
    choice: usize,
    line: &[usize],
    cells: &[(CellFinding, Option<&Sampled>)],
) -> BestFinding {
    let xs = &grid.paths[choice].values;
    let ends = |run: Option<(usize, usize)>| run.map(|(a, b)| (xs[a], xs[b]));
    let given = (grid.paths.len() == 2).then(|| cells[line[0]].0.values[1 - choice]);
    let sampled: Option<Vec<&Sampled>> = line.iter().map(|&cell| cells[cell].1).collect();
    let (best, at) = match sampled {
        Some(sampled) => least(xs, &sampled),
        None => (Estimate::none("no samples were asked for"), None),
    };
    let smallest_margin = |k: usize| {
        let cell = &cells[line[k]].0;
        cell.relative_margins[cell.limiting?]
    };
    let margins: Vec<f64> =
        (0..line.len()).map(|k| smallest_margin(k).unwrap_or(f64::NEG_INFINITY)).collect();
    let roomiest = (0..line.len()).max_by(|&a, &b| margins[a].total_cmp(&margins[b]));
    BestFinding {
        given,
        best,
        probability: at.and_then(|at| cells[line[at]].0.any.clone()),
        met: ends(longest_run(line, |cell| cells[cell].0.answer == GoAnswer::Go)),
        open: ends(longest_run(line, |cell| {
            matches!(cells[cell].0.answer, GoAnswer::Go | GoAnswer::Undecided)
        })),
        nominal: roomiest.filter(|&k| margins[k].is_finite()).map(|k| (xs[k], margins[k])),
        feasible: feasible(xs, &margins),
    }
}

/// The ends of the longest stretch with a margin of at least zero, interpolated between settings.
fn feasible(xs: &[f64], margins: &[f64]) -> Option<(f64, f64)> {
    let places: Vec<usize> = (0..xs.len()).collect();
    let (a, b) = longest_run(&places, |k| margins[k] >= 0.0)?;
    let crossing = |inside: usize, outside: Option<usize>| match outside {
        Some(k) if k < xs.len() && margins[k].is_finite() => {
            xs[inside] + (xs[k] - xs[inside]) * margins[inside] / (margins[inside] - margins[k])
        }
        _ => xs[inside],
    };
    Some((crossing(a, a.checked_sub(1)), crossing(b, Some(b + 1))))
}

/// The setting with the least P(any breach) and the place of the computed one nearest to it.
fn least(xs: &[f64], sampled: &[&Sampled]) -> (Estimate, Option<usize>) {
    let worst: Vec<u64> = sampled.iter().map(|cell| cell.any.most_breaches()).collect();
    let samples = sampled.first().map_or(0, |cell| cell.any.samples);
    let Some(smallest) = worst.iter().copied().min() else {
        return (Estimate::none("there is no setting"), None);
    };
    if smallest == samples {
        return (Estimate::none("every sample breaches a limit at every setting"), None);
    }
    let places: Vec<usize> = (0..xs.len()).collect();
    let Some((a, b)) = longest_run(&places, |k| worst[k] == smallest) else {
        return (Estimate::none("there is no setting"), None);
    };
    let middle = a + (b - a) / 2;
    if b > a {
        let why = match smallest {
            0 => format!("no breach was seen from the setting {} to {} (SI)", xs[a], xs[b]),
            _ => format!("P is the same from the setting {} to {} (SI)", xs[a], xs[b]),
        };
        let value = 0.5 * (xs[a] + xs[b]);
        let interval = Earned::none(why);
        return (Estimate { value: Some(value), standard_error: None, interval }, Some(middle));
    }
    // The parabola is asked where P is of the order of its least value, five settings at least.
    let near = |k: usize| 2 * worst[k] <= 3 * smallest + 10;
    let (mut from, mut to) = (middle, middle);
    while from > 0 && near(from - 1) {
        from -= 1;
    }
    while to + 1 < xs.len() && near(to + 1) {
        to += 1;
    }
    from = from.min(middle.saturating_sub(2));
    to = to.max((middle + 2).min(xs.len() - 1));
    let shares = |left_out: Option<usize>| -> Vec<f64> {
        let kept = |cell: &&Sampled| {
            let groups = (0..GROUPS).filter(|g| left_out != Some(*g)).map(|g| cell.groups[g]);
            let (breaches, samples) =
                groups.fold((0, 0), |(m, n), g| (m + g.most_breaches(), n + g.samples));
            (breaches as f64 + 0.5) / (samples as f64 + 1.0)
        };
        sampled[from..=to].iter().map(kept).collect()
    };
    let mut estimate = best_value(&xs[from..=to], &shares, (xs[0], xs[xs.len() - 1]));
    if let (Some(wide), Earned::Interval(interval)) = (estimate.value, &mut estimate.interval) {
        // What a parabola is not shows in how far that through the nearest three settings differs.
        let three = (middle - from).saturating_sub(1)..=(middle - from + 1).min(to - from);
        let narrow = |left_out: Option<usize>| shares(left_out)[three.clone()].to_vec();
        let settings = &xs[from..=to][three.clone()];
        let other = best_value(settings, &narrow, (xs[0], xs[xs.len() - 1])).value;
        let apart = other.map_or(0.0, |other| (other - wide).abs());
        interval.lower -= apart;
        interval.upper += apart;
        interval.method = "parabola through ln P, delete-a-group jackknife, and its own misfit";
    }
    let nearest = estimate.value.and_then(|value| {
        places.into_iter().min_by(|&a, &b| (xs[a] - value).abs().total_cmp(&(xs[b] - value).abs()))
    });
    (estimate, nearest)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elementary::exp;

    #[test]
    fn analytic_the_least_point_of_a_parabola_is_found_and_ends_have_no_interval() {
        // ln P is a parabola about 103, the same counts in every group.
        let cells = |centre: f64| -> Vec<Sampled> {
            let part = |x: f64| {
                let share = 0.01 * exp((x - centre) * (x - centre) / 400.0);
                Proportion { breaches: (share * 1e6) as u64, faults: 0, samples: 1_000_000 }
            };
            let cell = |k: usize| {
                let group = part(80.0 + 5.0 * k as f64);
                let any = Proportion {
                    breaches: 20 * group.breaches,
                    faults: 0,
                    samples: 20 * group.samples,
                };
                Sampled {
                    any,
                    limits: Vec::new(),
                    groups: vec![group; GROUPS],
                    quantiles: Vec::new(),
                }
            };
            (0..9).map(cell).collect()
        };
        let xs: Vec<f64> = (0..9).map(|k| 80.0 + 5.0 * k as f64).collect();
        let found = |centre: f64| {
            let cells = cells(centre);
            least(&xs, &cells.iter().collect::<Vec<_>>())
        };
        let (best, at) = found(103.0);
        assert!((best.value.unwrap() - 103.0).abs() < 0.01, "{best:?}");
        assert_eq!(at, Some(5));
        let (best, at) = found(60.0);
        assert_eq!((best.value, at), (Some(80.0), Some(0)));
        assert!(best.interval.why_none().unwrap().contains("end of its range"));
    }

    #[test]
    fn analytic_runs_and_crossings_of_a_margin() {
        let margins = [-1.0, 1.0, 2.0, 1.0, -3.0, 0.5];
        let xs = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(feasible(&xs, &margins), Some((0.5, 3.25)));
        assert_eq!(feasible(&xs, &[1.0; 6]), Some((0.0, 5.0)));
        assert_eq!(feasible(&xs, &[-1.0; 6]), None);
    }
}
