//! `reeldown compare`: what changed between two finished runs.

use super::arguments::CompareArguments;
use super::output::say;
use super::{Ending, done, parentage};
use crate::analysis::compare::{FinishedRun, compare as findings};
use crate::analysis::{Findings, Unreadable};
use crate::campaign::ROW_GROUP;
use crate::error::{Error, Result};
use crate::render::{self, Mark};
use crate::store::{OutcomesReader, refuse_unfinished, verify_listed, write_text};
use std::path::Path;

const HELP: &str = "name the directories of two runs that `reeldown run` has finished";

/// Reads two runs, compares and shows them.
pub(super) fn compare(arguments: &CompareArguments) -> Result<Ending> {
    let [before, after] = [&arguments.before, &arguments.after].map(|path| read(path));
    let finding = findings(&before?, &after?)?;
    if let Some(path) = &arguments.markdown {
        write_text(path, &render::compare_markdown(&finding))?;
    }
    if let Some(path) = &arguments.html {
        let report = render::compare_markdown(&finding);
        write_text(path, &render::page("Two runs compared", Mark::None, &report, &[])?)?;
    }
    if arguments.json {
        let json = serde_json::to_string_pretty(&finding)
            .map_err(|reason| Error::argument(format!("it cannot be written: {reason}")))?;
        return done(&json);
    }
    say(&render::compare_terminal(&finding))?;
    Ok(Ending::Done)
}

/// One run: its findings, its study out of its table's footer, and its margins.
fn read(directory: &Path) -> Result<FinishedRun> {
    let fail = |reason: String| Error::file(directory, "compare", reason, HELP);
    if !directory.is_dir() {
        return Err(fail("there is no such directory".to_owned()));
    }
    let (json, table) = (directory.join("findings.json"), directory.join("outcomes.parquet"));
    for file in [&json, &table] {
        if !file.is_file() {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            return Err(fail(format!("it is no finished run: it lacks {name}")));
        }
    }
    refuse_unfinished(directory, "compare")?;
    let bytes = std::fs::read(&json).map_err(|why| Error::file(&json, "read", why, HELP))?;
    verify_listed(directory, "findings.json", &bytes)?;
    let findings = Findings::read(&bytes).map_err(|why| match why {
        Unreadable::NotJson(why) => {
            Error::file(&json, "read", format!("it is not JSON: {why}"), HELP)
        }
        Unreadable::NotFindings(why) => {
            Error::file(&json, "read", format!("it is not what a run has found: {why}"), HELP)
        }
        Unreadable::OtherVersion(made_by) => {
            let here = env!("CARGO_PKG_VERSION");
            let reason = format!("its findings are of reeldown {made_by}, and this is {here}");
            let help = "run its study again with this version: the report says how";
            Error::file(&json, "compare", reason, help)
        }
    })?;
    let reader = OutcomesReader::open(&table)?;
    let entry = |key: &str| reader.parentage().0.get(key).map(String::as_str);
    if entry("study_digest") != Some(&findings.reproduction.study_digest)
        || reader.rows() != findings.method.samples
    {
        let reason = "findings.json and outcomes.parquet are of different runs".to_owned();
        let help = "finish the run: reeldown run --resume";
        return Err(Error::file(directory, "compare", reason, help));
    }
    let study = parentage::study(&table, reader.parentage())?;
    let mut margins = vec![Vec::with_capacity(reader.rows() as usize); study.limits.len()];
    let mut next = 0;
    while next < reader.rows() {
        let rows = (reader.rows() - next).min(ROW_GROUP) as usize;
        let part = reader.read(&study, next, rows)?;
        for (limit, margins) in study.limits.iter().zip(&mut margins) {
            margins.extend(part.outcome(limit.outcome).iter().map(|&v| limit.margin_of(v)));
        }
        next += rows as u64;
    }
    Ok(FinishedRun { name: directory.display().to_string(), study, findings, margins })
}
