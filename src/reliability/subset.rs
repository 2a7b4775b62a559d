//! Subset simulation: a rare event as a product of events that are not, walked by Markov chains.
//!
//! Chains move by conditional sampling in standard-normal space, z' = √(1 − s²) z + s w, which is
//! stationary without a rejection of its own; the spread s adapts from level to level to an acceptance of
//! 0.44. It is one for all coordinates and fixed within a level: spreads taken from the seeds they move
//! biased the 100-dimensional benchmark by 25 %. A level's survivors lie strictly below the sample that
//! sets its threshold, which makes the product of their shares unbiased (adaptive multilevel splitting);
//! counting that sample in biases by about 1/seeds a level.
//!
//! A union is walked limit by limit from common first levels, each breach counted as 1/(number of limits
//! breached there): walks by the least of several margins follow whichever margin falls first and lose
//! the others (benchmark RP110).
//!
//! Where the first level alone sees the event often enough, its points are plain Monte Carlo: they are counted, and the
//! interval is the exact one. Replicates near certainty agree with each other long before they are certain.
//!
//! Sources: Au and Beck, Probabilistic Engineering Mechanics 16 (2001) 263; Papaioannou, Betz, Zwirglmaier
//! and Straub, Probabilistic Engineering Mechanics 41 (2015) 89, adaptive conditional sampling; Bréhier,
//! Gazeau, Goudenège, Lelièvre and Rousset, Annals of Applied Probability 26 (2016) 3559, unbiasedness.

use super::draws::standard_normal;
use super::estimate::{Estimate, Method};
use super::event::{Evaluator, Event, FaultReading};
use super::limit_state::LimitState;
use super::log_replicates::{LEAST, interval_of_replicates};
use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::elementary::exp;
use crate::numerics::interval::Earned;
use crate::streams::{Purpose, Stream, stream};

/// How subset simulation is done.
#[derive(Debug, Clone, PartialEq)]
pub struct SubsetOptions {
    /// Samples of one level of one replicate.
    pub samples_per_level: usize,
    /// Share of a level's samples that seed the next one.
    pub level_probability: f64,
    /// Independent replicates: the interval comes from their spread.
    pub replicates: usize,
    /// A walk stops as negligible below this probability.
    pub least_probability: f64,
    /// Confidence of the interval.
    pub confidence: f64,
    /// Seed.
    pub seed: u64,
}

impl SubsetOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        SubsetOptions {
            samples_per_level: 1000,
            level_probability: 0.1,
            replicates: 10,
            least_probability: 1e-15,
            confidence: 0.95,
            seed,
        }
    }
}

impl SubsetOptions {
    /// Samples of a level that seed the next one.
    fn seeds(&self) -> usize {
        (self.samples_per_level as f64 * self.level_probability).round() as usize
    }
}

/// Share of the union's probability below which the walk of one of its limits is not continued.
const NEGLIGIBLE_SHARE: f64 = 1e-4;

/// Acceptance that the spread of a move is adapted to.
const ACCEPTANCE: f64 = 0.44;

/// Subset simulation of an event, without gradients.
///
/// With faults met, the whole is run again with every fault read as a breach.
///
/// # Errors
/// If an option is out of range, the event does not fit, or the limit state fails.
pub fn subset_simulation(
    state: &dyn LimitState,
    event: Event,
    options: &SubsetOptions,
) -> Result<Estimate> {
    if !(0.0 < options.level_probability && options.level_probability <= 0.5) || options.seeds() < 2
    {
        return Err(Error::argument("subset simulation needs at least two seeds a level"));
    }
    if options.replicates < LEAST {
        return Err(Error::argument(format!("subset simulation needs {LEAST} replicates")));
    }
    let safe = run(state, event, options, FaultReading::Safe)?;
    if safe.faults == 0 {
        return Ok(safe);
    }
    let breach = run(state, event, options, FaultReading::Breach)?;
    Ok(Estimate::joined(safe, breach))
}

fn run(
    state: &dyn LimitState,
    event: Event,
    options: &SubsetOptions,
    reading: FaultReading,
) -> Result<Estimate> {
    let mut evaluator = Evaluator::new(state, event, reading)?;
    // A union is walked by its limits, an intersection by its own margin.
    let parts: Vec<Option<usize>> = match event.is_union() {
        true => event.members(state.limits())?.into_iter().map(Some).collect(),
        false => vec![None],
    };
    let mut walks: Vec<Walk> = Vec::new();
    let mut values = Vec::new();
    let (seeds, mut seen) = (options.seeds(), 0);
    for replicate in 0..options.replicates {
        let key = (replicate * (parts.len() + 1)) as u64;
        let points = first_level(options, key, state.dimension());
        evaluator.evaluate(&Columns::from_rows(&points), &mut values)?;
        let breaches = values.iter().filter(|&&margin| margin < 0.0).count();
        seen += breaches as u64;
        // A union that breaches as often as a level needs is known well enough: its limits need no walks.
        let enough = if breaches >= seeds { 0 } else { seeds };
        for (k, &part) in parts.iter().enumerate() {
            let own = stream(options.seed, Purpose::SubsetSimulation, key + 1 + k as u64);
            let mut walk = Walk::new(part, replicate, own, state.dimension());
            walk.samples = states(points.clone(), &values, &evaluator, part, reading, 0);
            walk.descend(options, enough);
            walks.push(walk);
        }
    }
    while walks.iter().any(|walk| walk.answer.is_none()) {
        for &part in &parts {
            // All replicates of a part take their step in one batch.
            let active = |walk: &Walk| walk.part == part && walk.answer.is_none();
            let proposals: Vec<Vec<Vec<f64>>> =
                walks.iter_mut().filter(|walk| active(walk)).map(Walk::propose).collect();
            let rows: Vec<&Vec<f64>> = proposals.iter().flatten().collect();
            if rows.is_empty() {
                continue;
            }
            evaluator.evaluate(&Columns::from_rows(&rows), &mut values)?;
            let mut first = 0;
            for (walk, points) in walks.iter_mut().filter(|walk| active(walk)).zip(proposals) {
                let count = points.len();
                walk.accept(states(points, &values, &evaluator, part, reading, first), options);
                first += count;
            }
        }
        for replicate in 0..options.replicates {
            give_up_negligible(&mut walks, replicate);
        }
    }
    estimate(event, &walks, seen, &evaluator, options)
}

/// The plain sample that all parts of a replicate start from.
fn first_level(options: &SubsetOptions, key: u64, dimension: usize) -> Vec<Vec<f64>> {
    let mut stream = stream(options.seed, Purpose::SubsetSimulation, key);
    let mut point = || (0..dimension).map(|_| standard_normal(&mut stream)).collect();
    (0..options.samples_per_level).map(|_| point()).collect()
}

/// Points with their margins, from row `first` of the batch evaluated last: of the event, or of one
/// limit of a union, whose breaches are shared with the other limits breached there.
fn states(
    points: Vec<Vec<f64>>,
    values: &[f64],
    evaluator: &Evaluator,
    part: Option<usize>,
    reading: FaultReading,
    first: usize,
) -> Vec<State> {
    let margins = evaluator.last_margins();
    let breach_read = reading == FaultReading::Breach;
    points
        .into_iter()
        .zip(first..)
        .map(|(point, row)| {
            let Some(limit) = part else {
                return State { point, margin: values[row], share: 1.0 };
            };
            let margin = match margins.get(row, limit) {
                margin if !margin.is_nan() => margin,
                _ if breach_read => f64::NEG_INFINITY,
                _ => f64::INFINITY,
            };
            let breached = (0..margins.columns()).filter(|&other| {
                let margin = margins.get(row, other);
                margin < 0.0 || (breach_read && margin.is_nan())
            });
            State { point, margin, share: 1.0 / breached.count().max(1) as f64 }
        })
        .collect()
}

/// Ends the walks of a replicate that can no longer matter beside those that have ended.
fn give_up_negligible(walks: &mut [Walk], replicate: usize) {
    let found: f64 = walks
        .iter()
        .filter(|walk| walk.replicate == replicate)
        .filter_map(|walk| walk.answer.as_ref().map(|answer| answer.probability))
        .sum();
    let waiting = walks.iter_mut().filter(|w| w.replicate == replicate && w.answer.is_none());
    for walk in waiting.filter(|walk| walk.reached < NEGLIGIBLE_SHARE * found) {
        walk.answer = Some(Answer { probability: 0.0, end: End::Negligible });
    }
}

/// The estimate from walks that have ended; `seen` points of all first levels breach.
fn estimate(
    event: Event,
    walks: &[Walk],
    seen: u64,
    evaluator: &Evaluator,
    options: &SubsetOptions,
) -> Result<Estimate> {
    let mut replicates = vec![0.0; options.replicates];
    let (mut stuck, mut vanished) = (0, 0);
    for walk in walks {
        if let Some(answer) = &walk.answer {
            replicates[walk.replicate] += answer.probability;
        }
        stuck += usize::from(walk.ended(End::Stuck));
        vanished += usize::from(walk.ended(End::Vanished));
    }
    let plain = walks.iter().all(|walk| walk.level == 0 && walk.ended(End::Breach));
    let (mean, standard_error, mut interval) = if plain {
        let samples = (options.replicates * options.samples_per_level) as u64;
        let mean = seen as f64 / samples as f64;
        let counts = Proportion::new(seen, 0, samples)?;
        let error = (mean * (1.0 - mean) / samples as f64).sqrt();
        (mean, error, counts.interval(options.confidence)?)
    } else {
        interval_of_replicates(&replicates, options.confidence)
    };
    let levels = walks.iter().map(|walk| walk.level + 1).max().unwrap_or(0);
    let mut diagnostics = vec![format!(
        "{} replicates of {} samples a level, at most {levels} levels",
        options.replicates, options.samples_per_level
    )];
    if stuck > 0 {
        let why = format!("{stuck} walks ended on a plateau of the margin");
        interval = Earned::none(why.clone());
        diagnostics.push(why);
    }
    if vanished > 0 {
        diagnostics.push(format!("{vanished} walks ended below {:e}", options.least_probability));
    }
    Ok(Estimate {
        method: Method::SubsetSimulation,
        event,
        probability: Some(mean),
        probability_with_faults: Some(mean),
        standard_error: Some(standard_error),
        interval,
        evaluations: evaluator.evaluations,
        faults: evaluator.faults,
        diagnostics,
        replicates: if plain { Vec::new() } else { replicates },
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Breach,
    /// Every sample has the level's margin: no way down can be seen.
    Stuck,
    /// Below the least probability.
    Vanished,
    /// Negligible beside the union's other limits.
    Negligible,
}

struct Answer {
    probability: f64,
    end: End,
}

/// A point of a chain: its coordinates, the event's margin, and what it counts as a breach.
#[derive(Clone)]
struct State {
    point: Vec<f64>,
    margin: f64,
    share: f64,
}

/// One replicate's walk down the levels of one part.
struct Walk {
    part: Option<usize>,
    replicate: usize,
    stream: Stream,
    dimension: usize,
    level: usize,
    /// Probability of the level reached.
    reached: f64,
    threshold: f64,
    samples: Vec<State>,
    chains: Vec<State>,
    /// Spread s of a move.
    spread: f64,
    step: usize,
    accepted: f64,
    answer: Option<Answer>,
}

impl Walk {
    fn new(part: Option<usize>, replicate: usize, stream: Stream, dimension: usize) -> Self {
        Walk {
            part,
            replicate,
            stream,
            dimension,
            level: 0,
            reached: 1.0,
            threshold: f64::INFINITY,
            samples: Vec::new(),
            chains: Vec::new(),
            spread: 0.6,
            step: 0,
            accepted: 0.0,
            answer: None,
        }
    }

    fn ended(&self, end: End) -> bool {
        self.answer.as_ref().is_some_and(|answer| answer.end == end)
    }

    /// One move of every chain, to be evaluated.
    fn propose(&mut self) -> Vec<Vec<f64>> {
        let kept = (1.0 - self.spread * self.spread).sqrt();
        let mut points = Vec::with_capacity(self.chains.len());
        for chain in &self.chains {
            let mut point = chain.point.clone();
            for x in point.iter_mut().take(self.dimension) {
                *x = kept * *x + self.spread * standard_normal(&mut self.stream);
            }
            points.push(point);
        }
        points
    }

    /// Takes the evaluated moves, and goes a level down when the level is full.
    fn accept(&mut self, states: Vec<State>, options: &SubsetOptions) {
        let mut accepted = 0;
        for (chain, state) in self.chains.iter_mut().zip(states) {
            if state.margin < self.threshold {
                *chain = state;
                accepted += 1;
            }
        }
        self.step += 1;
        self.accepted += f64::from(accepted) / self.chains.len() as f64;
        self.samples.extend(self.chains.iter().cloned());
        if self.samples.len() >= options.samples_per_level {
            self.descend(options, options.seeds());
        }
    }

    /// Ends the walk where at least `enough` of the level's samples breach, else goes a level down.
    fn descend(&mut self, options: &SubsetOptions, enough: usize) {
        let n = self.samples.len();
        let seeds = options.seeds();
        self.samples.sort_by(|a, b| a.margin.total_cmp(&b.margin));
        let breaches = self.samples.iter().filter(|state| state.margin < 0.0);
        let shares: f64 = breaches.clone().map(|state| state.share).sum();
        if breaches.count() >= enough {
            let probability = self.reached * shares / n as f64;
            self.answer = Some(Answer { probability, end: End::Breach });
            return;
        }
        self.threshold = self.samples[seeds].margin;
        let below = self.samples.iter().filter(|state| state.margin < self.threshold).count();
        if below == 0 {
            self.answer = Some(Answer { probability: 0.0, end: End::Stuck });
            return;
        }
        self.reached *= below as f64 / n as f64;
        if self.reached < options.least_probability {
            self.answer = Some(Answer { probability: 0.0, end: End::Vanished });
            return;
        }
        self.samples.truncate(below);
        self.chains.clone_from(&self.samples);
        if self.step > 0 {
            let rate = self.accepted / self.step as f64;
            self.spread = (self.spread * exp(rate - ACCEPTANCE)).min(1.0);
        }
        self.accepted = 0.0;
        self.step = 0;
        self.level += 1;
    }
}
