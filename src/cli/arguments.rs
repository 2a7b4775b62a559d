//! The command line.

use super::calibrate_arguments::CalibrateArguments;
use super::rig_arguments::RigArguments;
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
/// requirement not met; 4 done, undecided at the stated confidence; 5 shards are missing; 130 stopped by Ctrl-C;
/// 143 a shard that was stopped. Of `shard`, 2 is also a plan or a number that no second attempt would mend.
#[derive(Debug, Parser)]
#[command(name = "reeldown", version, args_conflicts_with_subcommands = true, max_term_width = 100)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Write every figure as PNG too, beside its SVG
    #[arg(long, global = true)]
    pub png: bool,
    #[command(flatten)]
    pub run: RunArguments,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Run a study: probabilities of breach, verdict, margins, drivers; write report and tables
    Run(RunArguments),
    /// Divide a run into shards for a cluster or a queue: writes the plan file that every machine reads
    Plan(PlanArguments),
    /// Compute one shard of a plan; a shard that is complete already is kept
    Shard(ShardArguments),
    /// Print the numbers of the missing shards, in the syntax of array jobs (3,7-9)
    Missing(MissingArguments),
    /// Merge the shards of a plan and report on them, byte for byte as one machine would
    Merge(MergeArguments),
    /// Compute one nominal descent and show its outcomes
    Descend(DescendArguments),
    /// Compare two finished runs: inputs, probabilities, margins, drivers
    Compare(CompareArguments),
    /// Map the design space along one or two paths: outcomes, margins, probabilities, best values
    Sweep(SweepArguments),
    /// Find the cheapest tightenings and design change that meet a target, and confirm them
    Tighten(TightenArguments),
    /// Calibrate the model to rig test data: a posterior, its checks, and a calibrated card
    Calibrate(Box<CalibrateArguments>),
    /// The horizontal rig: one run, its modes compared as test options, or the best tests planned
    Rig(Box<RigArguments>),
    /// Reproduce the paper's figures and check its claims
    Paper(PaperArguments),
    /// Recompute one sample of a run and compare it bit for bit
    Replay(ReplayArguments),
    /// Validate a study and show every resolved input with its unit and source
    Check(CheckArguments),
    /// Explain an input or an outcome: what it is, unit, range, value, law and sources; without a name, list them
    Explain(ExplainArguments),
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

/// On how many threads a command computes.
#[derive(Debug, Args)]
pub(super) struct Threads {
    /// Number of threads [default: one a core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

impl Threads {
    /// The number asked for.
    pub fn asked(&self) -> Option<usize> {
        self.threads.map(usize::from)
    }
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
    /// Change a value: a design path (fluid.nominal_viscosity="105000 cSt"), a key of the study
    /// (limits.time.max="200 s") or of its card (brake.gap.sd="0.002 in")
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub set: Vec<String>,
}

/// A study whose samples are wanted.
#[derive(Debug, Args)]
pub(super) struct SampledStudy {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Number of samples, in place of the study's; or the sampling budget if the study has a stopping rule
    #[arg(long, value_name = "N")]
    pub samples: Option<String>,
    /// Seed of every random stream, in place of the study's
    #[arg(long, value_name = "S")]
    pub seed: Option<String>,
}

/// Where the results of a run go, and how.
#[derive(Debug, Args)]
pub(super) struct RunOutput {
    /// Directory for report and tables [default: runs/<study>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the directory even if it holds something else than earlier results of this study
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub threads: Threads,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
    /// Print nothing on standard output but errors; the exit code tells the verdict
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct RunArguments {
    #[command(flatten)]
    pub sampled: SampledStudy,
    #[command(flatten)]
    pub output: RunOutput,
    /// Continue a run that was interrupted or killed, or a shorter one, in the same directory
    #[arg(long)]
    pub resume: bool,
}

#[derive(Debug, Args)]
pub(super) struct PlanArguments {
    #[command(flatten)]
    pub sampled: SampledStudy,
    /// Number of shards; Slurm as it comes takes at most 1000
    #[arg(long, value_name = "M")]
    pub shards: u64,
    /// Directory for plan.json and the shards [default: runs/<study>-shards]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace another plan
    #[arg(long)]
    pub force: bool,
    /// Write the scripts of a Slurm array job and of the merge after it
    #[arg(long)]
    pub slurm: bool,
    /// Write the manifest of a Kubernetes Indexed Job that runs this image
    #[arg(long, value_name = "IMAGE")]
    pub kubernetes: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct ShardArguments {
    /// The plan
    #[arg(value_name = "PLAN.json")]
    pub plan: PathBuf,
    /// Number of the shard, from 0; auto: from the environment, where array jobs, indexed jobs and parallel
    /// launchers put it
    #[arg(long, value_name = "K|auto")]
    pub shard: String,
    #[command(flatten)]
    pub threads: Threads,
}

#[derive(Debug, Args)]
pub(super) struct MissingArguments {
    /// The plan
    #[arg(value_name = "PLAN.json")]
    pub plan: PathBuf,
    /// Number that the first shard has in what is printed: 1 for engines that count from 1
    #[arg(long, value_name = "FIRST", default_value_t = 0, value_parser = clap::value_parser!(u64).range(0..=1))]
    pub from: u64,
}

#[derive(Debug, Args)]
pub(super) struct MergeArguments {
    /// The plan; its shards are beside it
    #[arg(value_name = "PLAN.json")]
    pub plan: PathBuf,
    #[command(flatten)]
    pub output: RunOutput,
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
pub(super) struct CompareArguments {
    /// Directory of the run before
    #[arg(value_name = "RUN_A")]
    pub before: PathBuf,
    /// Directory of the run after
    #[arg(value_name = "RUN_B")]
    pub after: PathBuf,
    /// Write the comparison as Markdown too
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Write the comparison as an HTML page too
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Print the comparison as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct SweepArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// A design path and its values, such as fluid.nominal_viscosity=80000cSt..160000cSt:33; once or twice
    #[arg(long, value_name = "PATH=FROM..TO:N", required = true)]
    pub over: Vec<String>,
    /// Take the values of this swept path as exact, in place of the card's law for it [default for what
    /// becomes known on the day]
    #[arg(long, value_name = "PATH")]
    pub hold: Vec<String>,
    /// Move the card's law for this swept path to each value, with its spread [default for everything
    /// else that is uncertain]
    #[arg(long, value_name = "PATH")]
    pub centre: Vec<String>,
    /// Samples in each cell, the same points in all of them [default: 8 million descents shared among the
    /// cells, at most 100000 a cell]
    #[arg(long, value_name = "N", conflicts_with = "nominal")]
    pub samples: Option<String>,
    /// Outcomes and margins of nominal descents only, no probabilities
    #[arg(long)]
    pub nominal: bool,
    /// Seed of every random stream, in place of the study's
    #[arg(long, value_name = "S")]
    pub seed: Option<String>,
    /// Directory for report, figures and table [default: runs/<study>-sweep]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the directory even if it holds something else than earlier results of this study
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub threads: Threads,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
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
    /// Let a design value move at no cost, in place of the study's (fluid.nominal_viscosity="90000 cSt..140000 cSt");
    /// may be given several times; "none" holds every one
    #[arg(long = "move", value_name = "PATH=LEAST..MOST")]
    pub moves: Vec<String>,
    /// Directory for tighten.json and tighten.md
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the directory even if it holds something else than earlier results of this study
    #[arg(long, requires = "out")]
    pub force: bool,
    #[command(flatten)]
    pub threads: Threads,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct PaperArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Directory for report.md, paper.json and the figures
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the directory even if it holds something else than earlier results of this study
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
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

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// A dotted path such as brake.gap, or an outcome such as peak_tension
    pub name: Option<String>,
    /// Study whose values are shown [default: the embedded study of the HABE brake]
    #[arg(long, value_name = "FILE")]
    study: Option<PathBuf>,
}

impl ExplainArguments {
    /// The study whose values are shown.
    pub fn study(&self) -> Result<Study> {
        StudyArguments { study: self.study.clone(), set: Vec::new() }.load(&[])
    }
}

impl SampledStudy {
    /// Loads the study with everything that is typed beside it.
    pub fn load(&self) -> Result<Study> {
        let options = [("--samples", "samples", &self.samples), ("--seed", "seed", &self.seed)];
        let options = options.into_iter().filter_map(|(option, key, value)| {
            Some((option, format!("sampling.{key}={}", value.as_ref()?)))
        });
        self.study.load(&options.collect::<Vec<_>>())
    }
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
