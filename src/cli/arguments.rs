//! The command line.

use crate::error::Result;
use crate::store::PARQUET;
use crate::study::{Override, Study};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// How likely is a viscous-brake reel-down to miss a limit, how sure is that, and what drives it?
///
/// Without a command: `run`, on the embedded study of the HABE brake.
///
/// Exit codes: 0 done and the requirement, if any, is met; 1 the study cannot be run; 2 usage; 3 done,
/// requirement not met; 4 done, undecided at the stated confidence; 130 stopped by Ctrl-C.
#[derive(Debug, Parser)]
#[command(name = "reeldown", version, args_conflicts_with_subcommands = true, max_term_width = 100)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub run: RunArguments,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Run a study: probabilities of breach, verdict, margins, drivers; write report and tables
    Run(RunArguments),
    /// Compute one nominal descent and show its outcomes
    Descend(DescendArguments),
    /// Find the cheapest tightenings and design change that meet a target, and confirm them
    Tighten(TightenArguments),
    /// Learn the brake from measured rig runs: a posterior, its checks, and a calibrated card
    Calibrate(CalibrateArguments),
    /// Compute one sample of a run again, and compare it bit for bit
    Replay(ReplayArguments),
    /// Validate a study and show every resolved input with its unit and source
    Check(CheckArguments),
    /// Print the JSON Schema of study files or of cards
    Schema {
        /// Which schema
        #[arg(value_enum, default_value = "study")]
        kind: SchemaKind,
    },
    /// Print a shell's completion script
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    Man,
}

/// Which schema is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum SchemaKind {
    /// The study file
    Study,
    /// The uncertainty card
    Card,
}

/// A study and what is changed in it.
#[derive(Debug, Args)]
pub(super) struct StudyArguments {
    /// Study file; without one, the embedded study of the HABE brake
    pub study: Option<PathBuf>,
    /// Change a value: a design path (initial.temperature="40 °F"), a key of the study
    /// (limits.time.max="200 s") or of its card (brake.gap.sd="0.002 in")
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub set: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct RunArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Number of samples, in place of the study's; the budget of a study that samples until something
    #[arg(long, value_name = "N")]
    pub samples: Option<String>,
    /// Seed of every random stream, in place of the study's
    #[arg(long, value_name = "S")]
    pub seed: Option<String>,
    /// Directory for report and tables [default: runs/<study>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Continue an interrupted or shorter run in the same directory
    #[arg(long)]
    pub resume: bool,
    /// Number of threads [default: one a core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
    /// Print nothing on standard output but errors; the exit code tells the verdict
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct DescendArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Equations of motion, in place of the study's: dynamic, quasi-steady
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    /// Write the course of the descent to a Parquet file
    #[arg(long, value_name = "FILE.parquet")]
    pub trace: Option<PathBuf>,
    /// Draw the paper's Figures 4 to 9 from this design into a directory, as SVG
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Print the outcomes as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct TightenArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Largest acceptable probability of any breach, in place of the study's: 0.01 or "1 %"
    #[arg(long, value_name = "P")]
    pub target: Option<String>,
    /// Directory for tighten.json and tighten.md
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads [default: one a core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct CalibrateArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// A measured run, CSV with units in its header or Parquet in SI; once for each run
    #[arg(long, value_name = "FILE", required = true)]
    pub data: Vec<PathBuf>,
    /// A measured run that is predicted only, to check the posterior
    #[arg(long, value_name = "FILE")]
    pub hold_out: Vec<PathBuf>,
    /// What drives the predictions: force, speed [default: force where it was recorded]
    #[arg(long, value_name = "QUANTITY")]
    pub drive: Option<String>,
    /// Standard deviation of a channel's sensor, such as speed="0.02 ft/s"; estimated where not stated
    #[arg(long, value_name = "CHANNEL=VALUE")]
    pub sensor_sd: Vec<String>,
    /// What the model's discrepancy is expected to be, as a share of each channel's range; none for a
    /// model that is taken as right [default: 1 %]
    #[arg(long, value_name = "SHARE")]
    pub discrepancy: Option<String>,
    /// Noise with heavy tails, Student's t with so many degrees of freedom: outliers count less
    #[arg(long, value_name = "DF", value_parser = degrees_of_freedom)]
    pub heavy_tails: Option<f64>,
    /// Calibrate even if a unit seems wrong or the card cannot explain the readings
    #[arg(long)]
    pub accept: bool,
    /// Particles of each replicate [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    pub particles: Option<u32>,
    /// Independent replicates of the sampling [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100))]
    pub replicates: Option<u32>,
    /// Seed of every random stream, in place of the study's
    #[arg(long, value_name = "S")]
    pub seed: Option<String>,
    /// Directory for report, joint sample and cards [default: runs/<study>-calibrated]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads [default: one a core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

/// Degrees of freedom of Student's t: more than two, for the variance to exist.
fn degrees_of_freedom(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 2.0 && value <= 1e6 => Ok(value),
        _ => Err("expected a number above 2, such as 4".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(super) struct ReplayArguments {
    /// The outcomes.parquet of a run
    pub outcomes: PathBuf,
    /// Index of the sample
    #[arg(long, value_name = "K")]
    pub index: u64,
    /// Write the course of the descent to a Parquet file
    #[arg(long, value_name = "FILE.parquet")]
    pub trace: Option<PathBuf>,
    /// Print inputs and outcomes as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Print the resolved study as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

impl StudyArguments {
    /// Loads the study with what `--set` changes and what `options` (name of the option, statement) do.
    pub fn load(&self, options: &[(&str, String)]) -> Result<Study> {
        let set = self.set.iter().map(|statement| ("--set", statement.as_str()));
        let options = options.iter().map(|(option, statement)| (*option, statement.as_str()));
        let overrides = set
            .chain(options)
            .map(|(option, statement)| Override::parse(option, statement))
            .collect::<Result<Vec<_>>>()?;
        Study::load_with(self.study.as_deref(), &overrides, PARQUET)
    }

    /// A short name for the study: its file's, or its directory's if the file is called `study.toml`.
    pub fn name(&self) -> String {
        let Some(path) = &self.study else { return "habe".to_owned() };
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if stem != "study" {
            return stem;
        }
        let parent = std::path::absolute(path).ok().and_then(|p| Some(p.parent()?.to_owned()));
        let name = parent.and_then(|p| Some(p.file_name()?.to_string_lossy().into_owned()));
        name.unwrap_or(stem)
    }
}
