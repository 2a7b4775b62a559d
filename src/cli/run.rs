//! `reeldown run`: the main job.

use super::arguments::RunArguments;
use super::figure_files::write_figures;
use super::output::{say, say_error, say_notes, stdout_style};
use super::sensitivity_table::{SENSITIVITY, write_sensitivity};
use super::trade_tables::{TRADE, write_trade};
use super::watch::{Watch, stop_on_interrupt};
use super::{Ending, parentage, replay};
use crate::campaign::{self, Looks, Progress, ROW_GROUP, Record, RowGroups};
use crate::error::{Error, Result};
use crate::findings::{self, Evidence, Findings, VerdictWord};
use crate::outcomes::OutcomeTable;
use crate::render;
use crate::store::{OutcomesReader, OutcomesWriter, Parentage, refuse_obstacle, write_text};
use crate::study::Study;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The table of samples.
const OUTCOMES: &str = "outcomes.parquet";
/// The findings as one tree.
const FINDINGS: &str = "findings.json";
/// The report.
const REPORT: &str = "report.md";
/// The report for a browser.
const REPORT_HTML: &str = "report.html";
/// The directory of its figures.
const FIGURES: &str = "figures";
/// What may differ between two runs of one study.
const PROVENANCE: &str = "provenance.json";

/// Runs a study and writes its report and tables.
pub(super) fn run(arguments: &RunArguments) -> Result<Ending> {
    let options =
        [("--samples", "samples", &arguments.samples), ("--seed", "seed", &arguments.seed)];
    let options: Vec<(&str, String)> = options
        .into_iter()
        .filter_map(|(option, key, value)| {
            Some((option, format!("sampling.{key}={}", value.as_ref()?)))
        })
        .collect();
    let study = arguments.study.load(&options)?;
    study.design.validate()?;
    let directory =
        arguments.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(arguments.study.name()));
    // What stands in the way is said now, not after the descents.
    for name in [OUTCOMES, FINDINGS, REPORT, REPORT_HTML, SENSITIVITY, TRADE, PROVENANCE] {
        refuse_obstacle(&directory.join(name))?;
    }
    say_notes(&study);
    campaign::with_threads(arguments.threads.asked(), || {
        Run { arguments, study: &study, directory: &directory, parentage: parentage::of(&study) }
            .carry_out()
    })?
}

struct Run<'a> {
    arguments: &'a RunArguments,
    study: &'a Study,
    directory: &'a Path,
    parentage: Parentage,
}

impl Run<'_> {
    fn carry_out(&self) -> Result<Ending> {
        let begun = Instant::now();
        let progress = Arc::new(Progress::default());
        stop_on_interrupt(&progress)?;
        let (record, looks, computed) = self.sample(&progress)?;
        let sampled = begun.elapsed();
        let samples = looks.taken();
        if !looks.over() {
            return Ok(self.interrupted(samples, false));
        }
        let pick_freeze = {
            let _watch = Watch::start(&progress, self.sensitivity_descents(), "sensitivity");
            match campaign::run_pick_freeze(self.study, &progress) {
                Ok(Some(design)) => Ok(design),
                Ok(None) if progress.stopping() => return Ok(self.interrupted(samples, true)),
                Ok(None) => Err(NO_SENSITIVITY.to_owned()),
                Err(reason) => Err(reason.to_string()),
            }
        };
        let rare = campaign::rare_events(self.study, &record, &progress)?;
        if progress.stopping() {
            return Ok(self.interrupted(samples, true));
        }
        let (given, screening, shapley, trade, known, epistemic) = {
            let descents = campaign::shapley::shapley_descents(self.study)
                + campaign::given_sample::given_descents(self.study)
                + campaign::screening::screening_descents(self.study)
                + campaign::trade::trade_descents(self.study)
                + campaign::known::known_descents(self.study)
                + campaign::epistemic::epistemic_descents(self.study);
            let _watch = Watch::start(&progress, descents, "trade of tolerances");
            (
                campaign::given_sample::run_given(self.study, &record, &progress),
                campaign::screening::run_screening(self.study, &progress),
                campaign::shapley::run_shapley(self.study, &progress),
                campaign::trade::run_trade(self.study, &record, &progress),
                campaign::known::run_known(self.study, &progress),
                campaign::epistemic::run_epistemic(self.study, &progress),
            )
        };
        if progress.stopping() {
            return Ok(self.interrupted(samples, true));
        }
        let calibrated = campaign::calibrated::run_calibrated(self.study, &record, &progress)?;
        if progress.stopping() {
            return Ok(self.interrupted(samples, true));
        }
        let findings = findings::gather(&Evidence {
            study: self.study,
            record: &record,
            stop: looks.stop()?,
            rare,
            nominal: campaign::nominal(self.study),
            verification: campaign::verify(self.study, &record)?,
            pick_freeze,
            shapley: or_reason(shapley, NO_SENSITIVITY),
            given: or_reason(given, NO_SENSITIVITY),
            screening: or_reason(screening, NO_SENSITIVITY),
            slopes: campaign::screening::slopes(self.study),
            trade: or_reason(trade, NO_TRADE),
            known: or_reason(known, NO_TRADE),
            calibrated,
            epistemic: or_reason(epistemic, NO_EPISTEMIC),
            command: self.command(),
        })?;
        self.write(&findings)?;
        let times = (begun.elapsed().as_secs_f64(), sampled.as_secs_f64());
        self.write_provenance(times, progress.done(), (computed, samples - computed))?;
        self.report(&findings)
    }

    /// Computes the samples that are not there yet and writes all of them.
    fn sample(&self, progress: &Arc<Progress>) -> Result<(Record, Looks, u64)> {
        let path = self.directory.join(OUTCOMES);
        let most = self.study.sampling.samples;
        let sampler = campaign::sampler(self.study)?;
        let mut looks = Looks::new(self.study)?;
        let before = if self.arguments.resume { self.earlier(&path)? } else { None };
        if let Some(reader) = before.as_ref().filter(|reader| reader.rows() > most) {
            return Err(too_many(&path, reader.rows(), most));
        }
        let mut rows = Rows {
            record: Record::new(self.study, sampler.replicates())?,
            writer: OutcomesWriter::create(&path, self.study, &self.parentage)?,
            groups: RowGroups::default(),
        };
        if let Some(reader) = &before {
            while looks.taken() < reader.rows() && !looks.over() {
                let start = looks.taken();
                let count = (reader.rows() - start).min(ROW_GROUP) as usize;
                let table = reader.read(self.study, start, count)?;
                self.verify(&path, &table)?;
                looks.take(&table)?;
                rows.push(table)?;
            }
            // A run with another rule has more rows than this study takes: none of them is thrown away.
            if looks.taken() < reader.rows() {
                return Err(too_many(&path, reader.rows(), looks.taken()));
            }
        }
        let read = looks.taken();
        {
            let _watch = Watch::start(progress, most - read, "descents");
            let mut sink = |table: OutcomeTable| rows.push(table);
            campaign::run_until(self.study, &mut looks, progress, &mut sink)?;
        }
        let computed = looks.taken() - read;
        Ok((rows.finish()?, looks, computed))
    }

    /// Computes the last sample of a table that was read once more, and refuses a file that differs.
    fn verify(&self, path: &Path, table: &OutcomeTable) -> Result<()> {
        let last = table.first + table.rows() as u64 - 1;
        let again = replay::compute(self.study, last)?;
        if replay::same_bits((table, table.rows() - 1), (&again, 0)) {
            return Ok(());
        }
        let reason = format!("sample {last} computed again differs from its row");
        let help = "the file was changed, or this build computes other bits: run without --resume";
        Err(Error::file(path, "resume", reason, help))
    }

    /// The run to continue, if there is one and it is of this study.
    fn earlier(&self, path: &Path) -> Result<Option<OutcomesReader>> {
        if !path.exists() {
            say_error(&format!("{} is not there: starting from the first sample", path.display()));
            return Ok(None);
        }
        let reader = OutcomesReader::open(path)?;
        let same = |key: &str| reader.parentage().0.get(key) == self.parentage.0.get(key);
        if !same("version") || !same("row_digest") {
            return Err(Error::file(
                path,
                "resume",
                "it was made by another study, seed or version, so its samples are others",
                "run without --resume to replace it, or name another directory with --out",
            ));
        }
        Ok(Some(reader))
    }

    fn interrupted(&self, computed: u64, all: bool) -> Ending {
        let plan = &self.study.sampling;
        let most = if plan.stopping.is_some() { "at most " } else { "" };
        let when = if all {
            format!("stopped after all {computed} samples, before the report")
        } else {
            format!("stopped after {computed} of {most}{} samples", plan.samples)
        };
        say_error(&format!(
            "{when}; they are in {}\nto go on: {} --resume{}",
            self.directory.join(OUTCOMES).display(),
            self.command(),
            self.arguments.out.as_ref().map_or(String::new(), |out| {
                format!(" --out {}", quoted(&out.display().to_string()))
            }),
        ));
        Ending::Interrupted
    }

    fn sensitivity_descents(&self) -> u64 {
        let factors = campaign::factors(self.study).len() as u64;
        let pairs = self.study.sensitivity.pairs.len() as u64;
        self.study.sensitivity.base_samples * (2 + factors + pairs)
    }

    /// The command that gives the same numbers.
    fn command(&self) -> String {
        let mut words = vec!["reeldown".to_owned(), "run".to_owned()];
        if let Some(study) = &self.arguments.study.study {
            words.push(quoted(&study.display().to_string()));
        }
        let options = [("--samples", &self.arguments.samples), ("--seed", &self.arguments.seed)];
        for (option, value) in options {
            words.extend(value.iter().map(|value| format!("{option} {}", quoted(value))));
        }
        words.extend(self.arguments.study.set.iter().map(|s| format!("--set {}", quoted(s))));
        words.join(" ")
    }

    fn write(&self, findings: &Findings) -> Result<()> {
        let at = |name: &str| self.directory.join(name);
        write_text(&at(FINDINGS), &render::json(findings)?)?;
        let figures = render::figures(findings);
        write_figures(&at(FIGURES), figures.all())?;
        write_text(&at(REPORT), &render::markdown(findings, &figures)?)?;
        write_text(&at(REPORT_HTML), &render::html(findings, &figures)?)?;
        write_sensitivity(&at(SENSITIVITY), findings, &self.parentage)?;
        write_trade(&at(TRADE), findings, &self.parentage)
    }

    /// What may differ between two runs of the same study: kept out of everything else.
    fn write_provenance(&self, times: (f64, f64), descents: u64, rows: (u64, u64)) -> Result<()> {
        let ((seconds, sampling), (computed, read)) = (times, rows);
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_secs());
        let provenance = serde_json::json!({
            "version": env!("CARGO_PKG_VERSION"),
            "command": std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect::<Vec<_>>(),
            "finished_unix_s": since_1970,
            "host": std::fs::read_to_string("/proc/sys/kernel/hostname").ok().map(|h| h.trim().to_owned()),
            "architecture": std::env::consts::ARCH,
            "operating_system": std::env::consts::OS,
            "threads": self.arguments.threads.asked().unwrap_or_else(campaign::threads),
            "wall_time_s": seconds,
            "sampling_time_s": sampling,
            "descents_computed": descents,
            "samples_computed": computed,
            "samples_read_again": read,
            "study_digest": self.study.digest(),
        });
        write_text(&self.directory.join(PROVENANCE), &format!("{provenance:#}\n"))
    }

    fn report(&self, findings: &Findings) -> Result<Ending> {
        if self.arguments.json {
            say(&render::json(findings)?)?;
        } else if !self.arguments.quiet {
            let summary = render::terminal(findings, stdout_style());
            say(&format!("{summary}\nreport: {}", self.directory.join(REPORT).display()))?;
        }
        Ok(match findings.verdict.word {
            VerdictWord::Met | VerdictWord::NoRequirement => Ending::Done,
            VerdictWord::NotMet => Ending::NotMet,
            VerdictWord::Undecided => Ending::Undecided,
        })
    }
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

/// Where the samples of a run go, row group by row group.
struct Rows {
    record: Record,
    writer: OutcomesWriter,
    groups: RowGroups,
}

impl Rows {
    fn push(&mut self, table: OutcomeTable) -> Result<()> {
        match self.groups.push(table) {
            Some(group) => self.keep(&group),
            None => Ok(()),
        }
    }

    fn keep(&mut self, group: &[OutcomeTable]) -> Result<()> {
        group.iter().for_each(|table| self.record.absorb(table));
        self.writer.write(group)
    }

    fn finish(mut self) -> Result<Record> {
        let rest = self.groups.rest();
        if !rest.is_empty() {
            self.keep(&rest)?;
        }
        self.writer.finish()?;
        Ok(self.record)
    }
}

/// Why there are no indices where a study has none.
const NO_SENSITIVITY: &str = "the study asks for none (sensitivity.base_samples = 0)";
/// Why there is no trade of tolerances where a study has none.
const NO_TRADE: &str = "the study asks for none (trade.samples = 0) or states no limit";

/// Why what is not known is not told apart where a study asks for none.
const NO_EPISTEMIC: &str = "the study asks for none (epistemic.outer = 0) or states no limit";

/// What was computed, or why it was not.
fn or_reason<T>(found: Result<Option<T>>, none: &str) -> std::result::Result<T, String> {
    match found {
        Ok(found) => found.ok_or_else(|| none.to_owned()),
        Err(reason) => Err(reason.to_string()),
    }
}

/// A word of a command line, quoted if the shell would take it apart.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
