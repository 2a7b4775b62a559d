//! How often a method's interval holds the truth: one row of a coverage certificate.

use super::Benchmark;
use reeldown::reliability::cross_entropy::{CrossEntropyOptions, cross_entropy};
use reeldown::reliability::crude::{CrudeOptions, crude_monte_carlo};
use reeldown::reliability::directional::{DirectionalOptions, directional_sampling};
use reeldown::reliability::estimate::{Estimate, Method};
use reeldown::reliability::importance::{ImportanceOptions, importance_sampling};
use reeldown::reliability::line::{LineOptions, line_sampling};
use reeldown::reliability::subset::{SubsetOptions, subset_simulation};

/// The methods that state intervals.
pub const METHODS: [Method; 6] = [
    Method::CrudeMonteCarlo,
    Method::ImportanceSampling,
    Method::SubsetSimulation,
    Method::LineSampling,
    Method::DirectionalSampling,
    Method::CrossEntropy,
];

/// Columns of the certificate's data.
pub const CSV_HEADER: &str = "method,problem,probability,first_seed,seeds,stated,held,below,mean_ratio,rms_relative_error,evaluations";

/// One method's answer with its default options, save the seed and the effort: a share of the default
/// samples of each method.
pub fn answer(method: Method, benchmark: &Benchmark, seed: u64, effort: f64) -> Estimate {
    let (state, event) = (&benchmark.limits, benchmark.event);
    let share = |samples: f64| (samples * effort) as u64;
    match method {
        Method::CrudeMonteCarlo => {
            let options = CrudeOptions { samples: share(1e5), ..CrudeOptions::seeded(seed) };
            crude_monte_carlo(state, event, &options)
        }
        Method::ImportanceSampling => {
            let options =
                ImportanceOptions { samples: share(2e4), ..ImportanceOptions::seeded(seed) };
            importance_sampling(state, event, &options).map(|(estimate, _)| estimate)
        }
        Method::SubsetSimulation => {
            let samples_per_level = share(1e3) as usize;
            let options = SubsetOptions { samples_per_level, ..SubsetOptions::seeded(seed) };
            subset_simulation(state, event, &options)
        }
        Method::LineSampling => {
            let options = LineOptions { lines: share(32.0).max(8), ..LineOptions::seeded(seed) };
            line_sampling(state, event, &options)
        }
        Method::DirectionalSampling => {
            let options =
                DirectionalOptions { directions: share(2e3), ..DirectionalOptions::seeded(seed) };
            directional_sampling(state, event, &options)
        }
        Method::CrossEntropy => {
            let options = CrossEntropyOptions {
                final_samples: share(2e4),
                ..CrossEntropyOptions::seeded(seed)
            };
            cross_entropy(state, event, &options)
        }
        _ => panic!("{} states no interval", method.name()),
    }
    .expect("benchmarks can be evaluated")
}

/// What many seeds of one method on one problem showed.
pub struct Coverage {
    pub method: Method,
    pub problem: &'static str,
    /// The certified probability.
    pub probability: f64,
    /// The first seed; the others follow it.
    pub first_seed: u64,
    /// Seeds run.
    pub seeds: u64,
    /// Seeds that stated an interval.
    pub stated: u64,
    /// Stated intervals that hold the truth, with the reference's own error allowed for.
    pub held: u64,
    /// Stated intervals wholly below the truth.
    pub below: u64,
    /// Mean estimate over the truth; none if no seed gave a number.
    pub ratio: Option<f64>,
    /// Root mean square of the relative error.
    pub relative_error: Option<f64>,
    /// Mean number of evaluations.
    pub evaluations: f64,
}

/// One seed of one method on one problem.
pub struct Trial {
    /// The seed.
    pub seed: u64,
    /// The answer.
    pub estimate: Estimate,
    /// Whether an interval was stated.
    pub stated: bool,
    /// Whether it lies wholly below the truth, with the reference's own error allowed for.
    pub below: bool,
    /// Whether it lies wholly above it.
    pub above: bool,
}

impl Trial {
    /// Runs one seed.
    pub fn run(method: Method, benchmark: &Benchmark, seed: u64, effort: f64) -> Trial {
        let estimate = answer(method, benchmark, seed, effort);
        let slack = benchmark.probability * benchmark.relative_error;
        let ends = estimate.interval.interval().map(|interval| (interval.lower, interval.upper));
        let below = ends.is_some_and(|(_, upper)| upper < benchmark.probability - slack);
        let above = ends.is_some_and(|(lower, _)| lower > benchmark.probability + slack);
        Trial { seed, stated: ends.is_some(), below, above, estimate }
    }
}

impl Coverage {
    /// Sums up the trials of a method on a problem.
    pub fn of(method: Method, benchmark: &Benchmark, trials: &[Trial]) -> Coverage {
        let truth = benchmark.probability;
        let count = |which: fn(&Trial) -> bool| trials.iter().filter(|t| which(t)).count() as u64;
        let ratios: Vec<f64> =
            trials.iter().filter_map(|trial| Some(trial.estimate.probability? / truth)).collect();
        let mean = |of: &dyn Fn(f64) -> f64| {
            let sum: f64 = ratios.iter().map(|&ratio| of(ratio)).sum();
            (!ratios.is_empty()).then(|| sum / ratios.len() as f64)
        };
        let cost: u64 = trials.iter().map(|trial| trial.estimate.evaluations).sum();
        Coverage {
            method,
            problem: benchmark.id,
            probability: truth,
            first_seed: trials.first().map_or(0, |trial| trial.seed),
            seeds: trials.len() as u64,
            stated: count(|trial| trial.stated),
            held: count(|trial| trial.stated && !trial.below && !trial.above),
            below: count(|trial| trial.below),
            ratio: mean(&|ratio| ratio),
            relative_error: mean(&|ratio| (ratio - 1.0) * (ratio - 1.0)).map(f64::sqrt),
            evaluations: cost as f64 / trials.len() as f64,
        }
    }

    /// Share of the stated intervals that hold the truth, and its Monte Carlo standard error.
    pub fn share(&self) -> Option<(f64, f64)> {
        let n = self.stated as f64;
        let share = self.held as f64 / n;
        // A share of 1 has no binomial error of its own; one miss more or less is what it could be.
        let error = (share * (1.0 - share) / n).sqrt().max(1.0 / n);
        (self.stated > 0).then_some((share, error))
    }

    /// In words, against the bar of 93 %: what the certificate says about this pair.
    pub fn verdict(&self) -> &'static str {
        match self.share() {
            None => "unfit: says so, states no interval",
            Some(_) if self.unfit() => "unfit: says so in nearly every seed",
            Some((share, _)) if share < 0.93 => "FALLS SHORT",
            Some(_) if 2 * self.stated < self.seeds => "holds where stated; mostly withdrawn",
            Some(_) => "holds",
        }
    }

    /// Whether the method's self-checks withdraw the interval in more than nine seeds of ten. The few that get through
    /// are those that happened to look better than they were: nothing is claimed of them.
    pub fn unfit(&self) -> bool {
        10 * self.stated < self.seeds
    }

    /// The pair's row, read back from a line of [`Coverage::csv`]; none if the line is of another pair
    /// or damaged.
    pub fn from_csv(method: Method, benchmark: &Benchmark, line: &str) -> Option<Coverage> {
        let fields: Vec<&str> = line.split(',').collect();
        let &[name, problem, _, first, seeds, stated, held, below, ratio, error, cost] =
            &fields[..]
        else {
            return None;
        };
        let number = |text: &str| (!text.is_empty()).then(|| text.parse().ok()).flatten();
        (name == method.name() && problem == benchmark.id).then_some(())?;
        Some(Coverage {
            method,
            problem: benchmark.id,
            probability: benchmark.probability,
            first_seed: first.parse().ok()?,
            seeds: seeds.parse().ok()?,
            stated: stated.parse().ok()?,
            held: held.parse().ok()?,
            below: below.parse().ok()?,
            ratio: number(ratio),
            relative_error: number(error),
            evaluations: cost.parse().ok()?,
        })
    }

    /// A row of the certificate's table.
    pub fn markdown(&self) -> String {
        let number = |x: Option<f64>| x.map_or("none".to_owned(), |x| format!("{x:.4}"));
        let coverage = self.share().map_or("none".to_owned(), |(share, error)| {
            format!("{:.1} ± {:.1} %", 100.0 * share, 100.0 * error)
        });
        format!(
            "| {} | {:.4e} | {} | {} | {:.0} | {} of {} | {coverage} | {} / {} | {} |",
            self.problem,
            self.probability,
            number(self.ratio),
            number(self.relative_error),
            self.evaluations,
            self.stated,
            self.seeds,
            self.below,
            self.stated - self.held - self.below,
            self.verdict()
        )
    }

    /// A row of the certificate's data, under [`CSV_HEADER`].
    pub fn csv(&self) -> String {
        let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x}"));
        format!(
            "{},{},{},{},{},{},{},{},{},{},{}",
            self.method.name(),
            self.problem,
            self.probability,
            self.first_seed,
            self.seeds,
            self.stated,
            self.held,
            self.below,
            number(self.ratio),
            number(self.relative_error),
            self.evaluations
        )
    }
}
