//! Subset simulation: a rare event as a product of events that are not, walked by Markov chains.
//!
//! Chains move by conditional sampling in standard-normal space, z' = ρ z + √(1 − ρ²) w, which is
//! stationary without a rejection of its own; the spread √(1 − ρ²) of each coordinate follows the seeds'
//! spread and adapts to an acceptance of 0.44. A union is walked limit by limit, each breach counted as
//! 1/(number of limits breached there): walks by the least of several margins follow whichever margin
//! falls first and lose the others (benchmark RP110).
//!
//! Sources: Au and Beck, Probabilistic Engineering Mechanics 16 (2001) 263; Papaioannou, Betz, Zwirglmaier
//! and Straub, Probabilistic Engineering Mechanics 41 (2015) 89, adaptive conditional sampling.

use super::draws::standard_normal;
use super::estimate::{Estimate, Method};
use super::event::{Evaluator, Event, FaultReading};
use super::limit_state::LimitState;
use super::log_replicates::interval_of_replicates;
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

impl Default for SubsetOptions {
    fn default() -> Self {
        SubsetOptions {
            samples_per_level: 1000,
            level_probability: 0.1,
            replicates: 10,
            least_probability: 1e-15,
            confidence: 0.95,
            seed: 0,
        }
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
    let seeds = (options.samples_per_level as f64 * options.level_probability).round();
    if !(0.0 < options.level_probability && options.level_probability <= 0.5) || seeds < 2.0 {
        return Err(Error::argument("subset simulation needs at least two seeds a level"));
    }
    if options.replicates < 3 {
        return Err(Error::argument("subset simulation needs at least three replicates"));
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
    let members = event.members(state.limits())?;
    // A union is walked by its limits, an intersection by its own margin.
    let parts: Vec<Event> = match event.is_union() {
        true => members.iter().map(|&limit| Event::Limit(limit)).collect(),
        false => vec![event],
    };
    let mut evaluators = parts
        .iter()
        .map(|&part| Evaluator::new(state, part, reading))
        .collect::<Result<Vec<_>>>()?;
    let shared = parts.len() > 1;
    let mut walks: Vec<Walk> = Vec::new();
    for part in 0..parts.len() {
        for replicate in 0..options.replicates {
            let key = (replicate * parts.len() + part) as u64;
            walks.push(Walk::new(part, replicate, key, options, state.dimension()));
        }
    }
    let mut values = Vec::new();
    while walks.iter().any(|walk| walk.answer.is_none()) {
        for (part, evaluator) in evaluators.iter_mut().enumerate() {
            // All replicates of a part take their step in one batch.
            let mut rows: Vec<Vec<f64>> = Vec::new();
            let active = |walk: &Walk| walk.part == part && walk.answer.is_none();
            for walk in walks.iter_mut().filter(|walk| active(walk)) {
                rows.extend(walk.propose());
            }
            if rows.is_empty() {
                continue;
            }
            evaluator.evaluate(&Columns::from_rows(&rows), &mut values)?;
            let margins = evaluator.last_margins();
            let share = |row: usize| {
                if !shared {
                    return 1.0;
                }
                let breached = (0..margins.columns()).filter(|&limit| {
                    let margin = margins.get(row, limit);
                    margin < 0.0 || (margin.is_nan() && reading == FaultReading::Breach)
                });
                1.0 / breached.count().max(1) as f64
            };
            let mut first = 0;
            for walk in walks.iter_mut().filter(|walk| active(walk)) {
                let count = walk.proposed.len();
                let states = (first..first + count).map(|row| (values[row], share(row)));
                walk.accept(states.collect(), options);
                first += count;
            }
        }
        for replicate in 0..options.replicates {
            give_up_negligible(&mut walks, replicate);
        }
    }
    Ok(estimate(event, &walks, &evaluators, options))
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

fn estimate(
    event: Event,
    walks: &[Walk],
    evaluators: &[Evaluator],
    options: &SubsetOptions,
) -> Estimate {
    let mut replicates = vec![0.0; options.replicates];
    let (mut stuck, mut vanished) = (0, 0);
    for walk in walks {
        if let Some(answer) = &walk.answer {
            replicates[walk.replicate] += answer.probability;
            stuck += usize::from(answer.end == End::Stuck);
            vanished += usize::from(answer.end == End::Vanished);
        }
    }
    let (mean, standard_error, mut interval) =
        interval_of_replicates(&replicates, options.confidence);
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
    Estimate {
        method: Method::SubsetSimulation,
        event,
        probability: Some(mean),
        probability_with_faults: Some(mean),
        standard_error: Some(standard_error),
        interval,
        evaluations: evaluators.iter().map(|e| e.evaluations).sum(),
        faults: evaluators.iter().map(|e| e.faults).sum(),
        diagnostics,
    }
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
    part: usize,
    replicate: usize,
    stream: Stream,
    dimension: usize,
    level: usize,
    /// Probability of the level reached.
    reached: f64,
    threshold: f64,
    samples: Vec<State>,
    chains: Vec<State>,
    spreads: Vec<f64>,
    scale: f64,
    step: usize,
    accepted: f64,
    proposed: Vec<Vec<f64>>,
    answer: Option<Answer>,
}

impl Walk {
    fn new(
        part: usize,
        replicate: usize,
        key: u64,
        options: &SubsetOptions,
        dimension: usize,
    ) -> Self {
        Walk {
            part,
            replicate,
            stream: stream(options.seed, Purpose::SubsetSimulation, key),
            dimension,
            level: 0,
            reached: 1.0,
            threshold: f64::INFINITY,
            samples: Vec::with_capacity(options.samples_per_level),
            chains: Vec::new(),
            spreads: Vec::new(),
            scale: 0.6,
            step: 0,
            accepted: 0.0,
            proposed: vec![Vec::new(); options.samples_per_level],
            answer: None,
        }
    }

    /// The next points to evaluate: the whole first level, or one move of every chain.
    fn propose(&mut self) -> Vec<Vec<f64>> {
        let draw = |stream: &mut Stream| standard_normal(stream);
        if self.level == 0 {
            for point in &mut self.proposed {
                *point = (0..self.dimension).map(|_| draw(&mut self.stream)).collect();
            }
        } else {
            self.proposed.clear();
            for chain in &self.chains {
                let mut point = chain.point.clone();
                for (x, spread) in point.iter_mut().zip(&self.spreads) {
                    let sigma = (self.scale * spread).min(1.0);
                    *x = (1.0 - sigma * sigma).sqrt() * *x + sigma * draw(&mut self.stream);
                }
                self.proposed.push(point);
            }
        }
        self.proposed.clone()
    }

    /// Takes the margins of the proposed points, and goes a level down when the level is full.
    fn accept(&mut self, states: Vec<(f64, f64)>, options: &SubsetOptions) {
        let proposed = std::mem::take(&mut self.proposed);
        let states = proposed.into_iter().zip(states).map(|(point, (margin, share))| State {
            point,
            margin,
            share,
        });
        if self.level == 0 {
            self.samples = states.collect();
        } else {
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
        }
        if self.samples.len() >= options.samples_per_level {
            self.descend(options);
        }
    }

    fn descend(&mut self, options: &SubsetOptions) {
        let n = self.samples.len();
        let seeds = (options.samples_per_level as f64 * options.level_probability).round() as usize;
        self.samples.sort_by(|a, b| a.margin.total_cmp(&b.margin));
        let breaches = self.samples.iter().filter(|state| state.margin < 0.0);
        let shares: f64 = breaches.clone().map(|state| state.share).sum();
        if breaches.count() >= seeds {
            let probability = self.reached * shares / n as f64;
            self.answer = Some(Answer { probability, end: End::Breach });
            return;
        }
        // Survivors lie strictly below the sample that sets the threshold: the product of survivors'
        // shares is then unbiased, where counting that sample in would add 1/seeds a level.
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
        self.chains = std::mem::take(&mut self.samples);
        self.spreads = vec![1.0; self.dimension];
        self.samples.clear();
        self.samples.extend(self.chains.iter().cloned());
        if self.level > 0 {
            self.scale *= exp(self.accepted / self.step as f64 - ACCEPTANCE);
        }
        self.accepted = 0.0;
        self.level += 1;
        self.step = 0;
    }
}

/// Standard deviation of coordinate `j` over the seeds.
fn spread(seeds: &[State], j: usize) -> f64 {
    let n = seeds.len() as f64;
    let mean = seeds.iter().map(|seed| seed.point[j]).sum::<f64>() / n;
    let squares: f64 =
        seeds.iter().map(|seed| (seed.point[j] - mean) * (seed.point[j] - mean)).sum();
    (squares / (n - 1.0).max(1.0)).sqrt().max(1e-3)
}
