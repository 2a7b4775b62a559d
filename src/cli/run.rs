//! `reeldown run`: the main job; and `reeldown merge`: the same, of samples that were computed elsewhere.

use super::arguments::{MergeArguments, RunArguments, RunOutput};
use super::command_line::{quoted, run_of};
use super::figure_files::write_report_figures;
use super::output::{say, say_error, say_notes, stdout_style};
use super::plan_file::Plan;
use super::sensitivity_table::{SENSITIVITY, write_sensitivity};
use super::trade_tables::{TRADE, write_trade};
use super::watch::{carry_out, interruptible};
use super::{Ending, parentage, replay, shards};
use crate::analysis::{self, Findings, Options, Sampling};
use crate::campaign::{self, Progress};
use crate::error::{Error, Result};
use crate::findings::VerdictWord;
use crate::outcomes::OutcomeTable;
use crate::render;
use crate::store::{
    Contents, OutcomesReader, OutcomesWriter, Parentage, ResultDirectory, UnfinishedTable,
};
use crate::streams::{Purpose, open_uniform, stream};
use crate::study::Study;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The table of samples.
const OUTCOMES: &str = "outcomes.parquet";
/// The findings as one tree.
const FINDINGS: &str = "findings.json";
/// The report.
const REPORT: &str = "report.md";
/// The report for a browser.
const REPORT_HTML: &str = "report.html";
/// What may differ between two runs of one study.
const PROVENANCE: &str = "provenance.json";
/// Rows of each row group that is read once more, beside its last, that are computed again.
const SPOT_CHECKS: usize = 8;

/// Runs a study and writes its report and tables.
pub(super) fn run(arguments: &RunArguments) -> Result<Ending> {
    let study = arguments.sampled.load()?;
    study.design.validate()?;
    let command = run_of(&arguments.sampled);
    let asked = Asked {
        study: &study,
        name: &arguments.sampled.study.name(),
        to_go_on: format!("{command} --resume"),
        command,
        source: if arguments.resume { Source::Resumed } else { Source::Computed },
    };
    into_directory(&arguments.output, asked)
}

/// Joins the shards of a plan, and reports on them as if they had been computed here.
pub(super) fn merge(arguments: &MergeArguments) -> Result<Ending> {
    let (plan, study) = Plan::read(&arguments.plan)?;
    let shards = shards::all(&plan, &arguments.plan)?;
    let asked = Asked {
        study: &study,
        name: &plan.name,
        to_go_on: format!("reeldown merge {}", quoted(&arguments.plan.display().to_string())),
        command: plan.command,
        source: Source::Shards(shards),
    };
    into_directory(&arguments.output, asked)
}

/// What is to be run and reported on.
struct Asked<'a> {
    study: &'a Study,
    /// The study's short name.
    name: &'a str,
    /// The command that gives the same numbers.
    command: String,
    /// The command that goes on after an interruption.
    to_go_on: String,
    source: Source,
}

/// Where samples come from before any is computed.
enum Source {
    /// From nowhere: all are computed.
    Computed,
    /// From a shorter run in the same directory, or one that ended early.
    Resumed,
    /// From the shards of a plan, all of them in their order.
    Shards(Vec<OutcomesReader>),
}

fn into_directory(output: &RunOutput, asked: Asked<'_>) -> Result<Ending> {
    let study = asked.study;
    let directory = output.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(asked.name));
    // What stands in the way is said now, not after the descents.
    let contents = Contents {
        kind: "run",
        study: &study.title,
        files: &[OUTCOMES, FINDINGS, REPORT, REPORT_HTML, SENSITIVITY, TRADE, PROVENANCE],
        force: output.force,
    };
    let directory = ResultDirectory::open(&directory, contents)?;
    say_notes(study);
    let progress = interruptible()?;
    carry_out(&progress, output.threads.asked(), |progress| {
        Run { output, study, directory, parentage: parentage::of(study), asked }.carry_out(progress)
    })
}

struct Run<'a> {
    output: &'a RunOutput,
    study: &'a Study,
    directory: ResultDirectory,
    parentage: Parentage,
    asked: Asked<'a>,
}

impl Run<'_> {
    fn carry_out(self, progress: &Progress) -> Result<Ending> {
        let begun = Instant::now();
        let sampling = self.sample(progress)?;
        let sampled = begun.elapsed();
        let command = Some(self.asked.command.clone());
        let options = Options { command, ..Options::default() };
        let Some(findings) = analysis::analyse(self.study, &sampling, &options, progress)? else {
            return Ok(self.interrupted(&sampling));
        };
        self.write(&findings)?;
        let times = (begun.elapsed().as_secs_f64(), sampled.as_secs_f64());
        self.write_provenance(times, progress.done(), &sampling)?;
        let Run { output, directory, .. } = self;
        let path = directory.path().join(REPORT);
        directory.finish()?;
        report(output, &findings, &path)
    }

    /// Computes the samples that are not there yet and writes all of them.
    fn sample(&self, progress: &Progress) -> Result<Sampling> {
        let path = self.directory.path().join(OUTCOMES);
        let most = self.study.sampling.samples;
        campaign::sampler(self.study)?;
        self.take_up(&path)?;
        let resumed = match self.asked.source {
            Source::Resumed => self.earlier(&path)?,
            _ => None,
        };
        if let Some(reader) = resumed.as_ref().filter(|reader| reader.rows() > most) {
            return Err(too_many(&path, reader.rows(), most));
        }
        let before = match &self.asked.source {
            Source::Shards(shards) => &shards[..],
            _ => resumed.as_slice(),
        };
        let mut writer = OutcomesWriter::create(&path, self.study, &self.parentage)?;
        let mut source = |wanted: Range<u64>| self.read(before, wanted);
        let mut sink = |group: &[OutcomeTable]| writer.write(group);
        let sampling = analysis::sample(self.study, &mut source, &mut sink, progress)?;
        if let Some(reader) = resumed.filter(|_| !progress.stopping()) {
            // A run with another rule has more rows than this study takes: none of them is thrown away.
            if sampling.read < reader.rows() {
                return Err(too_many(&path, reader.rows(), sampling.read));
            }
        }
        self.directory.table(OUTCOMES)?;
        writer.finish()?;
        Ok(sampling)
    }

    /// The first of the wanted samples that tables hold, if one does.
    fn read(&self, before: &[OutcomesReader], wanted: Range<u64>) -> Result<Option<OutcomeTable>> {
        let end = |reader: &OutcomesReader| reader.first() + reader.rows();
        let Some(reader) = before.iter().find(|reader| wanted.start < end(reader)) else {
            return Ok(None);
        };
        let count = end(reader).min(wanted.end) - wanted.start;
        let table = reader.read(self.study, wanted.start, count as usize)?;
        self.verify(reader.path(), &table)?;
        Ok(Some(table))
    }

    /// Computes the last sample of a table that was read once more, and some others, and refuses a file that differs.
    /// Checksums tell of damage; this tells of a build or a machine that computes other bits.
    fn verify(&self, path: &Path, table: &OutcomeTable) -> Result<()> {
        let mut stream = stream(self.study.sampling.seed, Purpose::SpotCheck, table.first);
        let rows = table.rows();
        let drawn = (0..SPOT_CHECKS).map(|_| (open_uniform(&mut stream) * rows as f64) as usize);
        for row in std::iter::once(rows - 1).chain(drawn) {
            let index = table.first + row as u64;
            let again = replay::compute(self.study, index)?;
            if !replay::same_bits((table, row), (&again, 0)) {
                let reason = format!("sample {index} computed again differs from its row");
                let (action, remedy) = match self.asked.source {
                    Source::Shards(_) => ("merge", "compute shards and merge them with one build"),
                    _ => ("resume", "run without --resume"),
                };
                let help =
                    format!("the file was changed, or this build computes other bits: {remedy}");
                return Err(Error::file(path, action, reason, help));
            }
        }
        Ok(())
    }

    /// Takes up the row groups of a run that died, if it is to be continued and they are more than its table has;
    /// else removes them.
    fn take_up(&self, path: &Path) -> Result<()> {
        let Some(left) = UnfinishedTable::recover(path)? else { return Ok(()) };
        let reader = OutcomesReader::open(&left.path())?;
        let rows = reader.rows();
        match self.asked.source {
            Source::Resumed => {}
            Source::Computed => {
                say_error(&format!(
                    "note: the {rows} samples of a run that ended early are replaced; --resume would have kept them"
                ));
                return left.discard();
            }
            Source::Shards(_) => return left.discard(),
        }
        // A table that cannot be read is no reason to drop one that can.
        let kept = OutcomesReader::open(path).ok().filter(|kept| self.holds_rows_of_this(kept));
        if self.holds_rows_of_this(&reader) && kept.is_none_or(|kept| kept.rows() < rows) {
            say_error(&format!("note: taking up {rows} samples of a run that ended early"));
            self.directory.table(OUTCOMES)?;
            return left.adopt();
        }
        left.discard()
    }

    /// Whether the rows of a table are those that this run computes.
    fn holds_rows_of_this(&self, reader: &OutcomesReader) -> bool {
        let same = |key: &str| reader.parentage().0.get(key) == self.parentage.0.get(key);
        same("version") && same("row_digest") && reader.first() == 0
    }

    /// The run to continue, if there is one and it is of this study.
    fn earlier(&self, path: &Path) -> Result<Option<OutcomesReader>> {
        if !path.exists() {
            say_error(&format!("{} is not there: starting from the first sample", path.display()));
            return Ok(None);
        }
        let reader = OutcomesReader::open(path)?;
        if !self.holds_rows_of_this(&reader) {
            return Err(Error::file(
                path,
                "resume",
                "it was made by another study, seed or version, so its samples are others",
                "run without --resume to replace it, or name another directory with --out",
            ));
        }
        Ok(Some(reader))
    }

    fn interrupted(&self, sampling: &Sampling) -> Ending {
        let (plan, computed) = (&self.study.sampling, sampling.samples);
        let most = if plan.stopping.is_some() { "at most " } else { "" };
        let when = if sampling.complete {
            format!("stopped after all {computed} samples, before the report")
        } else {
            format!("stopped after {computed} of {most}{} samples", plan.samples)
        };
        say_error(&format!(
            "{when}; they are in {}\nto go on: {}{}",
            self.directory.path().join(OUTCOMES).display(),
            self.asked.to_go_on,
            self.output.out.as_ref().map_or(String::new(), |out| {
                format!(" --out {}", quoted(&out.display().to_string()))
            }),
        ));
        Ending::Interrupted
    }

    fn write(&self, findings: &Findings) -> Result<()> {
        let directory = &self.directory;
        directory.write_text(FINDINGS, &render::json(findings)?)?;
        let figures = render::figures(findings);
        write_report_figures(directory, figures.all())?;
        directory.write_text(REPORT, &render::markdown(findings, &figures)?)?;
        directory.write_text(REPORT_HTML, &render::html(findings, &figures)?)?;
        write_sensitivity(&directory.table(SENSITIVITY)?, findings, &self.parentage)?;
        write_trade(&directory.table(TRADE)?, findings, &self.parentage)
    }

    /// What may differ between two runs of the same study: kept out of everything else.
    fn write_provenance(
        &self,
        (seconds, sampling_seconds): (f64, f64),
        descents: u64,
        sampling: &Sampling,
    ) -> Result<()> {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_secs());
        let provenance = serde_json::json!({
            "version": env!("CARGO_PKG_VERSION"),
            "command": std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect::<Vec<_>>(),
            "finished_unix_s": since_1970,
            "host": std::fs::read_to_string("/proc/sys/kernel/hostname").ok().map(|h| h.trim().to_owned()),
            "architecture": std::env::consts::ARCH,
            "operating_system": std::env::consts::OS,
            "threads": self.output.threads.asked().unwrap_or_else(campaign::threads),
            "wall_time_s": seconds,
            "sampling_time_s": sampling_seconds,
            "descents_computed": descents,
            "samples_computed": sampling.samples - sampling.read,
            "samples_read_again": sampling.read,
            "study_digest": self.study.digest(),
        });
        self.directory.write_varying(PROVENANCE, &format!("{provenance:#}\n"))
    }
}

/// Shows a finished run, and says how it ended.
fn report(output: &RunOutput, findings: &Findings, path: &Path) -> Result<Ending> {
    if output.json {
        say(&render::json(findings)?)?;
    } else if !output.quiet {
        let summary = render::terminal(findings, stdout_style());
        say(&format!("{summary}\nreport: {}", path.display()))?;
    }
    Ok(match findings.verdict.word {
        VerdictWord::Met | VerdictWord::NoRequirement => Ending::Done,
        VerdictWord::NotMet => Ending::NotMet,
        VerdictWord::Undecided => Ending::Undecided,
    })
}

/// A table that has more samples than the run that is to continue it.
fn too_many(path: &Path, rows: u64, wanted: u64) -> Error {
    let reason = format!("it has {rows} samples, and this run ends after {wanted}");
    let help = format!(
        "give --samples {rows} or more (with sampling.until: the rule that it was made with), name another \
         directory with --out, or run without --resume to replace it"
    );
    Error::file(path, "resume", reason, help)
}
