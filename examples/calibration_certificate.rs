//! Repeats calibrations and counts how often the truth lies where the posterior says.
//!
//! `cargo run --release --example calibration_certificate -- --repetitions 200` writes
//! `reports/certificates/calibration.md`: truths drawn from the prior, whose ranks among the posterior's draws must be
//! uniform (simulation-based calibration: Talts and others, 2018), and the example campaign's own truth, noise drawn anew.

#[path = "../tests/calibration/campaign.rs"]
mod campaign;
#[path = "../tests/fixtures/habe.rs"]
mod habe;
#[path = "../tests/calibration/repetitions.rs"]
mod repetitions;

use rayon::prelude::*;
use reeldown::calibration::sample;
use reeldown::campaign::Progress;
use reeldown::campaign::calibration::{
    Channel, Options, RigLikelihood, Systematic, is_hardware, plan, risk,
};
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::{binomial, chi_squared as chi};
use reeldown::streams::{Purpose, standard_normal, stream};
use reeldown::study::{MeasuredRun, Study};
use repetitions::{Repetition, chi_squared, from_prior, of_campaign, problem, small_plan};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

const BINS: usize = 10;

fn main() -> ExitCode {
    match write() {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("calibration_certificate: {why}");
            ExitCode::FAILURE
        }
    }
}

fn write() -> Result<(), String> {
    let mut out = PathBuf::from("reports/certificates");
    let (mut repetitions, mut bands) = (200, 100);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        match word.as_str() {
            "--repetitions" => {
                repetitions = value.parse().map_err(|_| format!("{value}: a number"))?;
            }
            "--bands" => bands = value.parse().map_err(|_| format!("{value}: a number"))?,
            "--out" => out = PathBuf::from(value),
            _ => return Err(format!("{word}: --repetitions N, --bands N or --out DIR")),
        }
    }
    std::fs::create_dir_all(&out).map_err(|why| why.to_string())?;
    let study = habe::pinned(&[]);
    if bands > 0 {
        let path = out.join("calibration_bands.md");
        std::fs::write(&path, band_table(&study, bands))
            .map_err(|why| format!("{}: {why}", path.display()))?;
    }
    if repetitions == 0 {
        return Ok(());
    }
    let problem = problem(&study);
    let run = |what: &str, one: &(dyn Fn(u64) -> Repetition + Sync)| -> Vec<Repetition> {
        let done = AtomicU64::new(0);
        let numbers = 0..repetitions;
        let told = |k| {
            let repetition = one(k);
            eprintln!("{what}: {} of {repetitions}", done.fetch_add(1, Ordering::Relaxed) + 1);
            repetition
        };
        numbers.into_par_iter().map(told).collect()
    };
    let prior = run("prior", &|k| from_prior(&study, &problem, k, small_plan));
    let campaign = run("campaign", &|k| of_campaign(&study, k));
    let mut text = format!(
        "# Calibration certificate\n\nMade by `cargo run --release --example calibration_certificate -- --repetitions \
         {repetitions}`; version {}. Each repetition is a posterior of 2 replicates of 400 particles, \
         a fifth of what `calibrate` takes.\n\n\
         | truths | repetitions | truth in the 95 % region | share, exact 95 % interval | repetitions with a failed gate |\n\
         | --- | ---: | ---: | --- | ---: |\n",
        env!("CARGO_PKG_VERSION")
    );
    for (name, all) in [
        ("drawn from the prior, data from the model", &prior),
        ("the example campaign's one truth", &campaign),
    ] {
        let inside = all.iter().filter(|r| r.inside).count();
        let failed = all.iter().filter(|r| !r.failures.is_empty()).count();
        let (low, high) = interval(inside as u64, repetitions);
        text += &format!(
            "| {name} | {repetitions} | {inside} | {:.1} % ({:.1} … {:.1} %) | {failed} |\n",
            100.0 * inside as f64 / repetitions as f64,
            100.0 * low,
            100.0 * high
        );
    }
    text += &format!(
        "\nThe 95 % region is of the {} hardware parameters together: the truth is inside if it is no farther from the \
         mean of half the replicates' draws, in their covariance, than 95 % of the other half's. For truths drawn from the prior the share must be \
         95 %; for a single truth a Bayesian region has no such duty.\n\n\
         ## Ranks\n\nSimulation-based calibration: the truth's rank among the draws is uniform if the posterior is right. \
         Chi-squared over {BINS} bins; of {} coordinates tested, about one in twenty falls below 0.05 by chance.\n\n\
         | coordinate | chi-squared | p |\n| --- | ---: | ---: |\n",
        22,
        prior[0].ranks.len()
    );
    let mut low = 0;
    let mut all = Vec::new();
    for j in 0..prior[0].ranks.len() {
        let shares: Vec<f64> = prior.iter().map(|r| r.ranks[j].1).collect();
        let statistic = chi_squared(&shares, BINS);
        let p = chi::survival(BINS as f64 - 1.0, statistic);
        low += usize::from(p < 0.05);
        text += &format!("| `{}` | {statistic:.1} | {p:.3} |\n", prior[0].ranks[j].0);
        all.push(p);
    }
    let smallest = all.iter().copied().fold(1.0, f64::min);
    text += &format!(
        "\n{low} of {} lie below 0.05; the smallest is {smallest:.4}, which among so many has probability {:.2}.\n",
        all.len(),
        1.0 - reeldown::numerics::elementary::pow(1.0 - smallest, all.len() as f64)
    );
    let path = out.join("calibration.md");
    std::fs::write(&path, text).map_err(|why| format!("{}: {why}", path.display()))
}

/// A campaign by instruments with systematic errors, and P(any breach) of its brake.
struct Instrumented {
    /// P(any breach) of the brake that the runs were made with.
    truth: f64,
    /// The posterior's band over brakes: 5 %, 50 % and 95 %.
    band: [f64; 3],
    /// Which gates failed.
    failures: Vec<String>,
}

impl Instrumented {
    /// Whether the band holds the truth.
    fn inside(&self) -> bool {
        (self.band[0]..=self.band[2]).contains(&self.truth)
    }
}

/// Repetition `k`: a brake drawn from the card; every instrument with a gain and an offset drawn from what is assumed of
/// them where nothing is stated; the campaign's three runs; calibrated with `options`.
fn with_systematic_errors(study: &Study, k: u64, options: &Options) -> Instrumented {
    let mut stream = stream(9_000_000 + k, Purpose::Test, 0);
    let mut draw = |sd: f64| sd * standard_normal(&mut stream);
    let (brake, design) = loop {
        let z: Vec<f64> = study.inputs.iter().map(|_| draw(1.0)).collect();
        let mut brake = Columns::default();
        study.joint.from_standard_normal(&Columns::from_rows(&[&z]), &mut brake);
        let mut design = study.design.clone();
        for (j, input) in study.inputs.iter().enumerate() {
            if is_hardware(input.target.parameter) {
                design.set(input.target, brake.get(0, j));
            }
        }
        if design.is_possible() {
            break (brake, design);
        }
    };
    let instruments = campaign::instruments().map(|mut instrument| {
        let assumed = Systematic::assumed(instrument.channel);
        instrument.systematic = (draw(assumed.gain), draw(assumed.offset));
        instrument
    });
    let runs: Vec<MeasuredRun> = campaign::runs_of(&design, &instruments, 9_000_000 + k)
        .expect("the campaign can be made")
        .into_iter()
        .filter(|(name, _)| *name != "hold_out.csv")
        .map(|(name, text)| MeasuredRun::from_csv(name, &text, Default::default()).expect("a run"))
        .collect();
    let planned = plan::planned(&runs.iter().collect::<Vec<_>>(), study, options)
        .expect("runs that can be compared");
    let likelihood = RigLikelihood::of_runs(study, planned, options);
    let posterior = sample(&likelihood, &small_plan(k)).expect("a posterior");
    let brakes = likelihood.inputs(&Columns::from_rows(&posterior.draws()));
    let risk = |brakes: &Columns| risk::risk(study, brakes, &Progress::default()).expect("limits");
    Instrumented {
        truth: risk(&brake).probability,
        band: risk(&brakes).band,
        failures: posterior.diagnosis.failures,
    }
}

/// Campaigns by instruments with systematic errors: does the 90 % band on P(any breach) hold the brake's own?
fn band_table(study: &Study, repetitions: u64) -> String {
    let assumed = Options::seeded(1993);
    let none: Vec<(Channel, f64)> = Channel::ALL.map(|channel| (channel, 0.0)).to_vec();
    let exact = Options { gain_sd: none.clone(), offset_sd: none, ..Options::seeded(1993) };
    let mut text = format!(
        "# Bands of calibrations by instruments that err\n\nMade by `cargo run --release --example \
         calibration_certificate -- --repetitions 0 --bands {repetitions}`; version {}. Each repetition draws a brake from \
         the card and a gain or an offset of every instrument from what is assumed of them, makes the example campaign's \
         three runs up and calibrates (2 replicates of 400 particles). The band on P(any breach) is the 90 % that \
         `calibrate` states.\n\n\
         | instruments are taken | repetitions | P in the 90 % band | share, exact 95 % interval | median width of the band, points |\n\
         | --- | ---: | ---: | --- | ---: |\n",
        env!("CARGO_PKG_VERSION")
    );
    for (name, options) in [("to err, as by default", &assumed), ("to be exact", &exact)] {
        let all: Vec<Instrumented> = (0..repetitions)
            .into_par_iter()
            .map(|k| {
                let one = with_systematic_errors(study, k, options);
                eprintln!(
                    "{name}, {k}: {:.4} in {:.4?}: {} {:?}",
                    one.truth,
                    one.band,
                    one.inside(),
                    one.failures
                );
                one
            })
            .collect();
        let inside = all.iter().filter(|one| one.inside()).count();
        let mut widths: Vec<f64> =
            all.iter().map(|one| 100.0 * (one.band[2] - one.band[0])).collect();
        widths.sort_by(f64::total_cmp);
        let (low, high) = interval(inside as u64, repetitions);
        text += &format!(
            "| {name} | {repetitions} | {inside} | {:.1} % ({:.1} … {:.1} %) | {:.1} |\n",
            100.0 * inside as f64 / repetitions as f64,
            100.0 * low,
            100.0 * high,
            widths[widths.len() / 2]
        );
    }
    text
}

/// Clopper and Pearson's interval of a share, 95 %.
fn interval(count: u64, of: u64) -> (f64, f64) {
    let solve = |wanted: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if wanted(middle) { low = middle } else { high = middle }
        }
        low
    };
    let low =
        if count == 0 { 0.0 } else { solve(&|p| binomial::survival(count - 1, of, p) < 0.025) };
    let high = if count == of { 1.0 } else { solve(&|p| binomial::cdf(count, of, p) > 0.025) };
    (low, high)
}
