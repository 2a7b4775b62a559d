//! `reeldown run`: the main job.

use super::arguments::RunArguments;
use super::figure_files::write_report_figures;
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
use crate::store::{
    Contents, OutcomesReader, OutcomesWriter, Parentage, ResultDirectory, UnfinishedTable,
};
use crate::streams::{Purpose, open_uniform, stream};
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
/// What may differ between two runs of one study.
const PROVENANCE: &str = "provenance.json";
/// Rows of each row group that is read once more, beside its last, that are computed again.
const SPOT_CHECKS: usize = 8;

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
    let contents = Contents {
        kind: "run",
        study: &study.title,
        files: &[OUTCOMES, FINDINGS, REPORT, REPORT_HTML, SENSITIVITY, TRADE, PROVENANCE],
        force: arguments.force,
    };
    let directory = ResultDirectory::open(&directory, contents)?;
    say_notes(&study);
    campaign::with_threads(arguments.threads.asked(), || {
        Run { arguments, study: &study, directory, parentage: parentage::of(&study) }.carry_out()
    })?
}

struct Run<'a> {
    arguments: &'a RunArguments,
    study: &'a Study,
    directory: ResultDirectory,
    parentage: Parentage,
}

impl Run<'_> {
    fn carry_out(self) -> Result<Ending> {
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
        let (given, screening, shapley, trade, known, epistemic, exact) = {
            let descents = campaign::shapley::shapley_descents(self.study)
                + campaign::given_sample::given_descents(self.study)
                + campaign::screening::screening_descents(self.study)
                + campaign::trade::trade_descents(self.study)
                + campaign::known::known_descents(self.study)
                + campaign::epistemic::epistemic_descents(self.study)
                + campaign::exact::exact_descents(self.study);
            let _watch = Watch::start(&progress, descents, "trade of tolerances");
            (
                campaign::given_sample::run_given(self.study, &record, &progress),
                campaign::screening::run_screening(self.study, &progress),
                campaign::shapley::run_shapley(self.study, &progress),
                campaign::trade::run_trade(self.study, &record, &progress),
                campaign::known::run_known(self.study, &progress),
                campaign::epistemic::run_epistemic(self.study, &progress),
                campaign::exact::run_exact(self.study, &progress),
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
            exact: or_reason(exact, "the study has no limit"),
            command: self.command(),
        })?;
        self.write(&findings)?;
        let times = (begun.elapsed().as_secs_f64(), sampled.as_secs_f64());
        self.write_provenance(times, progress.done(), (computed, samples - computed))?;
        let Run { arguments, directory, .. } = self;
        let path = directory.path().join(REPORT);
        directory.finish()?;
        report(arguments, &findings, &path)
    }

    /// Computes the samples that are not there yet and writes all of them.
    fn sample(&self, progress: &Arc<Progress>) -> Result<(Record, Looks, u64)> {
        let path = self.directory.path().join(OUTCOMES);
        let most = self.study.sampling.samples;
        let sampler = campaign::sampler(self.study)?;
        let mut looks = Looks::new(self.study)?;
        self.take_up(&path)?;
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
        self.directory.table(OUTCOMES)?;
        Ok((rows.finish()?, looks, computed))
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
                let help =
                    "the file was changed, or this build computes other bits: run without --resume";
                return Err(Error::file(path, "resume", reason, help));
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
        if !self.arguments.resume {
            say_error(&format!(
                "note: the {rows} samples of a run that ended early are replaced; --resume would have kept them"
            ));
            return left.discard();
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
        same("version") && same("row_digest")
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
            self.directory.path().join(OUTCOMES).display(),
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
        self.directory.write_varying(PROVENANCE, &format!("{provenance:#}\n"))
    }
}

/// Shows a finished run, and says how it ended.
fn report(arguments: &RunArguments, findings: &Findings, path: &Path) -> Result<Ending> {
    if arguments.json {
        say(&render::json(findings)?)?;
    } else if !arguments.quiet {
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
