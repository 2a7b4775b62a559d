//! The design space: nominal descents and breach probabilities over a grid of one or two paths.
//!
//! Every cell looks at the same points of the unit cube (common random numbers), so what differs between
//! two cells is the design and not the luck of the draw: the map is smooth, and the best setting is found
//! with a far smaller error than either probability has.
//!
//! What is found by looking over the cells has the luck of these points on its side. It is estimated anew at points that
//! the search has not seen ([`confirm`]).

use super::common_numbers::{Breaches, Change, CommonSample, Event};
use super::{Progress, in_parallel};
use crate::descent::reference::{REFERENCE_TOLERANCE, descend};
use crate::descent::{Fault, Outcome};
use crate::error::{Error, Result};
use crate::outcomes::OutcomeTable;
use crate::physics::{Coefficients, Design, Target};
use crate::reliability::probability::Proportion;
use crate::streams::Purpose;
use crate::study::{Known, Over, Study};

/// Groups of rows from which the error of a best setting is read.
pub const GROUPS: usize = 20;
/// Descents that a sweep shares among its cells unless told otherwise.
const BUDGET: u64 = 8_000_000;
/// Samples of a cell unless told otherwise: at least and at most.
const USUAL: (u64, u64) = (1000, 100_000);
/// Samples of a setting that is estimated anew: at most, unless the cells have more.
const MOST_CONFIRMING: u64 = 100_000;
/// Shares of the quantiles of a limited outcome.
pub const SHARES: [f64; 3] = [0.05, 0.5, 0.95];

/// What a swept value means where the card has a law for the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// The card says nothing of it: it is a design value.
    Design,
    /// The value is known: it takes the law's place, and other inputs follow their laws given it.
    Held,
    /// The value is the law's mean: the law moves there with its spread.
    Centred,
}

/// One swept path.
#[derive(Debug, Clone, PartialEq)]
pub struct SweptPath {
    /// Where its values go.
    pub target: Target,
    /// Its values, SI, ascending.
    pub values: Vec<f64>,
    /// What they mean.
    pub meaning: Meaning,
}

impl SweptPath {
    /// A path of a study with its usual meaning: what is measured on the day is held, since whoever asks
    /// what to do at a value of it will know it; any other uncertain value is a law's centre, since
    /// choosing a nominal value does not make the hardware exact.
    pub fn of(study: &Study, over: &Over) -> Self {
        let inputs = inputs_at(study, over.target);
        let on_the_day = inputs.iter().any(|&j| study.inputs[j].known == Known::OnTheDay);
        let meaning = match (inputs.is_empty(), on_the_day) {
            (true, _) => Meaning::Design,
            (false, true) => Meaning::Held,
            (false, false) => Meaning::Centred,
        };
        SweptPath { target: over.target, values: over.values(), meaning }
    }
}

/// The inputs of a study that a value at `target` concerns.
fn inputs_at(study: &Study, target: Target) -> Vec<usize> {
    let concerns = |input: Target| {
        input.parameter == target.parameter
            && (target.surface.is_none() || input.surface == target.surface)
    };
    (0..study.inputs.len()).filter(|&j| concerns(study.inputs[j].target)).collect()
}

/// A grid of one or two paths; the last varies fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The paths.
    pub paths: Vec<SweptPath>,
}

impl Grid {
    /// The values of every cell, in order.
    pub fn cells(&self) -> Vec<Vec<f64>> {
        let mut cells = vec![Vec::new()];
        for path in &self.paths {
            cells = cells
                .iter()
                .flat_map(|cell: &Vec<f64>| {
                    path.values.iter().map(move |&value| [&cell[..], &[value]].concat())
                })
                .collect();
        }
        cells
    }

    /// The nominal design of a cell.
    pub fn design(&self, study: &Study, values: &[f64]) -> Design {
        let mut design = study.design.clone();
        for (path, &value) in self.paths.iter().zip(values) {
            design.set(path.target, value);
        }
        design
    }

    fn change(&self, study: &Study, values: &[f64]) -> Result<Change> {
        let mut change = Change::default();
        for (path, &value) in self.paths.iter().zip(values) {
            let inputs = inputs_at(study, path.target);
            if !inputs.iter().any(|&j| study.inputs[j].target == path.target) {
                change.design.push((path.target, value));
            }
            for j in inputs {
                let law = &study.inputs[j].marginal;
                match path.meaning {
                    Meaning::Held => change.known.push((j, conditioned(study, j, value)?)),
                    Meaning::Design | Meaning::Centred => {
                        let moved = law.with_shifted_mean(value - law.law().anchor())?;
                        change.marginals.push((j, moved));
                    }
                }
            }
        }
        Ok(change)
    }
}

/// The value to condition on: just inside the ends of a law on whose value others depend.
fn conditioned(study: &Study, input: usize, value: f64) -> Result<f64> {
    let path = study.inputs[input].target.path();
    if study.joint.sample_of(input).is_some() {
        return Err(Error::argument(format!(
            "{path} is drawn together with other inputs, row by row of a file, so nothing says what they are \
             given a value of it: move its law with --centre {path}"
        )));
    }
    if study.joint.is_independent() {
        return Ok(value);
    }
    let (lower, upper) = study.inputs[input].marginal.support();
    if value < lower || value > upper {
        return Err(Error::argument(format!(
            "{path} = {value} (SI) lies outside its law, and the card's correlations say of other inputs what \
             they are given it: sweep inside the law, or move the law with --centre {path}"
        )));
    }
    let inside = if (upper - lower).is_finite() { 1e-9 * (upper - lower) } else { 0.0 };
    Ok(value.clamp(lower + inside, upper - inside))
}

/// What was sampled in a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Breaches of any limit.
    pub any: Proportion,
    /// Breaches of each limit.
    pub limits: Vec<Proportion>,
    /// Breaches of any limit in each of [`GROUPS`] groups of rows, the same rows in every cell.
    pub groups: Vec<Proportion>,
    /// Quantiles at [`SHARES`] of each limit's outcome, SI; `None` if nothing could be computed.
    pub quantiles: Vec<Option<[f64; 3]>>,
}

/// One cell of the grid.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Its values, SI, in the order of the paths.
    pub values: Vec<f64>,
    /// Its nominal descent.
    pub nominal: std::result::Result<Outcome, Fault>,
    /// Its samples.
    pub sampled: Option<Sampled>,
}

/// Samples of a cell unless told otherwise: fewer the more cells there are, to two digits.
pub fn usual_samples(cells: u64) -> u64 {
    to_two_digits((BUDGET / cells.max(1)).clamp(USUAL.0, USUAL.1))
}

/// Samples of each of `settings` settings estimated anew after a sweep of `cells` cells with `samples` each: half of the
/// sweep's descents shared among them, and never fewer than a cell has.
pub fn confirming_samples(samples: u64, cells: u64, settings: u64) -> u64 {
    let share = samples.saturating_mul(cells) / 2 / settings.max(1);
    to_two_digits(share.min(MOST_CONFIRMING)).max(samples)
}

fn to_two_digits(count: u64) -> u64 {
    let mut unit = 1;
    while count / unit >= 100 {
        unit *= 10;
    }
    count / unit * unit
}

/// Checks that every cell is a possible design.
///
/// # Errors
/// The first cell that is not, with the reason.
pub fn check(study: &Study, grid: &Grid) -> Result<()> {
    for values in grid.cells() {
        grid.design(study, &values).validate()?;
    }
    Ok(())
}

/// Computes every cell, with `samples` of the card's uncertainties in each, or none. `None` if `progress`
/// asks for a stop.
///
/// The points are plain Monte Carlo whatever the study's design, so that intervals are exact; where the
/// study's own design is plain Monte Carlo too they are the first points of its run.
///
/// # Errors
/// If nothing is uncertain, or a law cannot be moved to a swept value.
pub fn run_sweep(
    study: &Study,
    grid: &Grid,
    samples: Option<u64>,
    progress: &Progress,
) -> Result<Option<Vec<Cell>>> {
    let sample = match samples {
        Some(rows) => Some(CommonSample::independent(study, 0..rows, Purpose::Design)?),
        None => None,
    };
    let cells = grid.cells();
    let found = in_parallel(&cells, |values| {
        if progress.stopping() {
            return Ok(None);
        }
        let coefficients = Coefficients::new(&grid.design(study, values));
        let nominal = descend(&coefficients, study.model, REFERENCE_TOLERANCE);
        let sampled = match &sample {
            Some(sample) => {
                let table = sample.table(&grid.change(study, values)?, progress)?;
                Some(sampled(study, &table))
            }
            None => None,
        };
        Ok(Some(Cell { values: values.clone(), nominal, sampled }))
    });
    let cells: Option<Vec<Cell>> = found.into_iter().collect::<Result<_>>()?;
    Ok(cells.filter(|_| !progress.stopping()))
}

/// Breaches of any limit at settings that were found by looking over the cells, at `samples` fresh plain Monte Carlo
/// points each, in the order of the settings. Settings of one line share their points, so that they differ by their
/// design alone; lines do not. `None` if `progress` asks for a stop.
///
/// # Errors
/// If nothing is uncertain, or a law cannot be moved to a swept value.
pub fn confirm(
    study: &Study,
    grid: &Grid,
    lines: &[Vec<Vec<f64>>],
    samples: u64,
    progress: &Progress,
) -> Result<Option<Vec<Vec<Proportion>>>> {
    let mut all = Vec::with_capacity(lines.len());
    for (settings, line) in lines.iter().zip(0u64..) {
        if settings.is_empty() {
            all.push(Vec::new());
            continue;
        }
        let rows = line * samples..(line + 1) * samples;
        let sample = CommonSample::independent(study, rows, Purpose::Confirmation)?;
        let counts = in_parallel(settings, |values| {
            let breaches = sample.changed(&grid.change(study, values)?, progress)?;
            Ok(breaches.count(Event::Any))
        });
        all.push(counts.into_iter().collect::<Result<_>>()?);
        if progress.stopping() {
            return Ok(None);
        }
    }
    Ok(Some(all))
}

fn sampled(study: &Study, table: &OutcomeTable) -> Sampled {
    let breaches = Breaches::of(study, table);
    let group = |g: usize| breaches.counts(Event::Any, (g..table.rows()).step_by(GROUPS));
    Sampled {
        any: breaches.count(Event::Any),
        limits: (0..study.limits.len()).map(|i| breaches.count(Event::Limit(i))).collect(),
        groups: (0..GROUPS).map(group).collect(),
        quantiles: study.limits.iter().map(|l| quantiles(table.outcome(l.outcome))).collect(),
    }
}

/// Order statistics at [`SHARES`] of the values that are numbers.
fn quantiles(values: &[f64]) -> Option<[f64; 3]> {
    let mut known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    let last = known.len().checked_sub(1)?;
    Some(SHARES.map(|share| {
        let at = (share * last as f64) as usize;
        *known.select_nth_unstable_by(at, f64::total_cmp).1
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_samples_share_a_budget() {
        assert_eq!(usual_samples(693), 11_000);
        assert_eq!(usual_samples(33), 100_000);
        assert_eq!(usual_samples(10_000), 1000);
        // Half of 693 × 11 000 descents for 45 settings; never fewer than a cell has, nor more than is of use.
        assert_eq!(confirming_samples(11_000, 693, 45), 84_000);
        assert_eq!(confirming_samples(11_000, 693, 600), 11_000);
        assert_eq!(confirming_samples(11_000, 693, 21), 100_000);
        assert_eq!(confirming_samples(200_000, 3, 1), 200_000);
    }

    #[test]
    fn analytic_the_last_path_varies_fastest() {
        let path = |values: &[f64]| SweptPath {
            target: Target::gap(0),
            values: values.to_vec(),
            meaning: Meaning::Design,
        };
        let grid = Grid { paths: vec![path(&[1.0, 2.0]), path(&[5.0, 6.0])] };
        assert_eq!(grid.cells(), [[1.0, 5.0], [1.0, 6.0], [2.0, 5.0], [2.0, 6.0]]);
    }
}
