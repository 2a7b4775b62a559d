//! `reeldown plan`, `shard` and `missing`: a run in parts, on whatever starts processes.

use super::Ending;
use super::arguments::{MissingArguments, PlanArguments, ShardArguments};
use super::command_line::{quoted, run_of};
use super::output::{say, say_error, say_notes, stderr_style};
use super::plan_file::{Plan, Shard, compact};
use super::watch::{carry_out, interruptible, stop_on_termination};
use super::{diagnostics, done, engines};
use crate::campaign::{self, RowGroups};
use crate::error::{Error, Result};
use crate::outcomes::OutcomeTable;
use crate::store::OutcomesWriter;
use crate::study::Study;
use std::path::{Path, PathBuf};

/// The plan's file.
const PLAN: &str = "plan.json";

/// Where engines tell a process which of many it is, and the number of the first. An array's index comes before a
/// rank: inside an array a rank is set as well, and is 0 everywhere.
const INDICES: [(&str, u64); 12] = [
    ("SLURM_ARRAY_TASK_ID", 0),
    ("JOB_COMPLETION_INDEX", 0),
    ("AWS_BATCH_JOB_ARRAY_INDEX", 0),
    ("BATCH_TASK_INDEX", 0),
    ("PBS_ARRAY_INDEX", 0),
    ("PBS_ARRAYID", 0),
    ("SGE_TASK_ID", 1),
    ("LSB_JOBINDEX", 1),
    ("HQ_TASK_ID", 0),
    ("SLURM_PROCID", 0),
    ("OMPI_COMM_WORLD_RANK", 0),
    ("PMI_RANK", 0),
];
/// Where Slurm tells how many cores a task may use: it does not always hide the others.
const CORES: &str = "SLURM_CPUS_PER_TASK";

/// Writes a plan.
pub(super) fn plan(arguments: &PlanArguments) -> Result<Ending> {
    let study = arguments.sampled.load()?;
    study.design.validate()?;
    let name = arguments.sampled.study.name();
    let directory = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs").join(format!("{name}-shards")));
    // What a shard would refuse is refused now.
    campaign::sampler(&study)?;
    let plan = Plan::new(&study, &name, run_of(&arguments.sampled), arguments.shards)?;
    let path = directory.join(PLAN);
    plan.write(&path, arguments.force)?;
    say_notes(&study);
    let each = plan.range(0).end;
    let file = quoted(&path.display().to_string());
    let mut engines = String::new();
    if arguments.slurm {
        engines = format!("\n{}", engines::write_slurm(&plan, &path)?);
    }
    if let Some(image) = &arguments.kubernetes {
        engines += &format!("\n{}", engines::write_kubernetes(&plan, &path, image)?);
    }
    done(&format!(
        "{}: {} samples in {} shards of about {each}\n\
         each:      reeldown shard {file} --shard K   (K from 0 to {}; auto takes it from the engine)\n\
         then:      reeldown merge {file}\n\
         meanwhile: reeldown missing {file}{engines}",
        path.display(),
        plan.samples,
        plan.shards,
        plan.shards - 1,
    ))
}

/// Computes one shard.
pub(super) fn shard(arguments: &ShardArguments) -> Result<Ending> {
    // What no second attempt would mend has a code of its own, for engines that try again.
    let (plan, study, k) = match ready(arguments) {
        Ok(ready) => ready,
        Err(error) => {
            say_error(&diagnostics::render(&error, stderr_style()));
            return Ok(Ending::Permanent);
        }
    };
    let path = plan.shard_path(&arguments.plan, k);
    if let Shard::Done(_) = plan.shard(&arguments.plan, k) {
        return done(&format!("{}: already done", path.display()));
    }
    let progress = interruptible()?;
    stop_on_termination(&progress)?;
    let range = plan.range(k);
    let threads = arguments.threads.asked().or_else(cores);
    let computed = carry_out(&progress, threads, |progress| {
        progress.begin("descents", range.end - range.start);
        let writer = OutcomesWriter::create_whole(&path, &study, &plan.shard_parentage(k))?;
        let mut rows = Rows { writer, groups: RowGroups::default() };
        let end = campaign::run(&study, range.clone(), progress, &mut |table| rows.push(table))?;
        if end < range.end {
            return Ok(None);
        }
        rows.finish().map(Some)
    })?;
    if computed.is_none() {
        say_error(&format!("stopped; nothing was left of shard {k}"));
        return Ok(Ending::Terminated);
    }
    done(&format!("{}: samples {} to {}", path.display(), range.start, range.end - 1))
}

/// Plan, study and number of the shard that is asked for.
fn ready(arguments: &ShardArguments) -> Result<(Plan, Study, u64)> {
    let (plan, study) = Plan::read(&arguments.plan)?;
    let (k, from) = number(&arguments.shard)?;
    if k >= plan.shards {
        return Err(Error::argument(format!(
            "{from}: the plan has shards 0 to {}; one has been asked for beyond them",
            plan.shards - 1
        )));
    }
    say_error(&format!("shard {k} of {} ({from})", plan.shards));
    Ok((plan, study, k))
}

/// The number of a shard as it was typed, or as the engine tells it; and where it is from.
fn number(asked: &str) -> Result<(u64, String)> {
    if asked != "auto" {
        let found = asked.parse().map(|k| (k, format!("--shard {asked}")));
        return found.map_err(|_| {
            Error::argument(format!("--shard {asked}: expected a number from 0, or auto"))
        });
    }
    for (name, first) in INDICES {
        let Some(value) = std::env::var_os(name) else { continue };
        let value = value.to_string_lossy();
        let from = format!("{name}={value}");
        let k = value.parse::<u64>().ok().and_then(|k| k.checked_sub(first));
        return k.map(|k| (k, from)).ok_or_else(|| {
            Error::argument(format!("--shard auto: {name} is {value:?}, not a number from {first}"))
        });
    }
    let names: Vec<&str> = INDICES.iter().map(|(name, _)| *name).collect();
    Err(Error::argument(format!(
        "--shard auto: no engine says which shard this is: none of {} is set; give --shard K",
        names.join(", ")
    )))
}

/// Cores that Slurm gives a task.
fn cores() -> Option<usize> {
    std::env::var(CORES).ok()?.parse().ok().filter(|&cores| cores > 0)
}

/// Where the samples of a shard go.
struct Rows {
    writer: OutcomesWriter,
    groups: RowGroups,
}

impl Rows {
    fn push(&mut self, table: OutcomeTable) -> Result<()> {
        self.groups.push(table).map_or(Ok(()), |group| self.writer.write(&group))
    }

    fn finish(mut self) -> Result<()> {
        let rest = self.groups.rest();
        if !rest.is_empty() {
            self.writer.write(&rest)?;
        }
        self.writer.finish()
    }
}

/// Prints the numbers of the shards that are not there.
pub(super) fn missing(arguments: &MissingArguments) -> Result<Ending> {
    let (plan, _) = Plan::read(&arguments.plan)?;
    let missing = look_for(&plan, &arguments.plan).1;
    if missing.is_empty() {
        say_error(&format!("all {} shards are there", plan.shards));
        return Ok(Ending::Done);
    }
    let numbers: Vec<u64> = missing.iter().map(|(k, _)| k + arguments.from).collect();
    say_error(&format!("{} of {} shards are missing", numbers.len(), plan.shards));
    say(&compact(&numbers))?;
    Ok(Ending::Incomplete)
}

/// The shards of a plan that are there, in their order, and those that are not, with why.
fn look_for(plan: &Plan, path: &Path) -> (Vec<crate::store::OutcomesReader>, Vec<(u64, String)>) {
    let (mut there, mut missing) = (Vec::new(), Vec::new());
    for k in 0..plan.shards {
        match plan.shard(path, k) {
            Shard::Done(reader) => there.push(*reader),
            Shard::Missing(why) => missing.push((k, why)),
        }
    }
    (there, missing)
}

/// All shards of a plan, in their order.
///
/// # Errors
/// If any is not there: which, and why the first of them is not.
pub(super) fn all(plan: &Plan, path: &Path) -> Result<Vec<crate::store::OutcomesReader>> {
    let (there, missing) = look_for(plan, path);
    let Some((first, why)) = missing.first() else { return Ok(there) };
    let numbers: Vec<u64> = missing.iter().map(|(k, _)| *k).collect();
    let reason = format!(
        "of {} shards these are missing: {} (shard {first}: {why})",
        plan.shards,
        compact(&numbers)
    );
    let help = "compute them: reeldown shard PLAN --shard K; `reeldown missing PLAN` lists them";
    Err(Error::file(path, "merge", reason, help))
}
