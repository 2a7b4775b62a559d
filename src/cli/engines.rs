//! What engines are told of a plan: the scripts of a Slurm array job and of the merge after it, and the manifest of a
//! Kubernetes Indexed Job.

use super::command_line::quoted;
use super::plan_file::Plan;
use crate::error::{Error, Result};
use crate::store::write_text;
use std::path::{Path, PathBuf};

/// The script of the array job.
const ARRAY: &str = "array.sbatch";
/// The script of the merge.
const MERGE: &str = "merge.sbatch";
/// The manifest of the Indexed Job.
const JOB: &str = "job.yaml";
/// Tasks that an array has at most where Slurm is configured as it comes (MaxArraySize = 1001).
const LARGEST_ARRAY: u64 = 1000;
/// Letters that the name of a Kubernetes object has at most, less `reeldown-`.
const LONGEST_NAME: usize = 54;
/// Seconds before a limit of time at which Slurm asks a task to end.
const WARNING_S: u64 = 60;

/// Writes the scripts for Slurm beside a plan, and says how they are submitted.
///
/// # Errors
/// If a script cannot name the directory or be written.
pub(super) fn write_slurm(plan: &Plan, path: &Path) -> Result<String> {
    let directory = absolute(path.parent().unwrap_or(Path::new("")))?;
    let here = absolute(Path::new("."))?;
    let program = std::env::current_exe()
        .map_err(|why| Error::argument(format!("--slurm: where is this program? {why}")))?;
    for place in [&directory, &here, &program] {
        nameable(place)?;
    }
    let script = Script { plan, directory: &directory, here: &here, program: &program };
    let [array, merge] = [ARRAY, MERGE].map(|name| directory.join(name));
    write_text(&array, &script.array())?;
    write_text(&merge, &script.merge())?;
    let [array, merge, file] = [array, merge, directory.join("plan.json")].map(|path| word(&path));
    let program = word(&program);
    let mut said = format!(
        "submit: sbatch --dependency=afterany:$(sbatch --parsable {array}) {merge}\n\
         repair: sbatch --dependency=afterany:$(sbatch --parsable --array=$({program} missing {file}) {array}) {merge}"
    );
    if plan.shards > LARGEST_ARRAY {
        said += &format!(
            "\nnote: Slurm as it comes takes arrays of {LARGEST_ARRAY} tasks at most; `scontrol show config` states its MaxArraySize"
        );
    }
    Ok(said)
}

/// Writes the manifest for Kubernetes beside a plan, and says how it is submitted.
///
/// # Errors
/// If the image's name could be taken for something else, or the manifest cannot be written.
pub(super) fn write_kubernetes(plan: &Plan, path: &Path, image: &str) -> Result<String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:@".contains(c);
    if image.is_empty() || !image.chars().all(plain) {
        return Err(Error::argument(format!(
            "--kubernetes {image}: expected the name of an image, such as registry.example/reeldown:0.1"
        )));
    }
    let job = path.with_file_name(JOB);
    write_text(&job, &manifest(plan, image))?;
    Ok(format!(
        "submit: copy the plan to a volume that many may write, claimed as `reeldown`; kubectl apply -f {}",
        word(&job)
    ))
}

fn absolute(path: &Path) -> Result<PathBuf> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    std::path::absolute(path)
        .map(|path| path.components().collect())
        .map_err(|why| Error::file(path, "find", why, "name another directory with --out"))
}

fn word(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// Refuses a path that a line of a script's head cannot name.
fn nameable(path: &Path) -> Result<()> {
    let odd = |c: char| c.is_control() || "\"'\\%".contains(c);
    match path.to_str() {
        Some(text) if !text.contains(odd) => Ok(()),
        _ => {
            let reason =
                "its name has a quote, a backslash, a %, a control character or no Unicode";
            Err(Error::file(path, "name in a script", reason, "use another directory"))
        }
    }
}

/// What the scripts of a plan are made of.
struct Script<'a> {
    plan: &'a Plan,
    directory: &'a Path,
    here: &'a Path,
    program: &'a Path,
}

impl Script<'_> {
    fn head(&self, job: &str, log: &str) -> String {
        format!(
            "#!/bin/bash\n\
             #SBATCH --job-name={job}\n\
             #SBATCH --ntasks=1\n\
             #SBATCH --cpus-per-task=1\n\
             #SBATCH --output=\"{}/{log}\"\n\
             #SBATCH --open-mode=append\n",
            self.directory.display()
        )
    }

    fn array(&self) -> String {
        format!(
            "{head}\
             #SBATCH --array=0-{last}\n\
             #SBATCH --requeue\n\
             #SBATCH --signal=B:TERM@{WARNING_S}\n\
             # One shard a task; a complete shard is kept. Add what this cluster wants: partition,\n\
             # account, --time, --mem; more cores a task with --cpus-per-task.\n\
             cd {here} || exit\n\
             # In the shell's place, so that a request to end reaches it.\n\
             exec {program} shard {file} --shard auto\n",
            head = self.head(&format!("reeldown-{}", label(&self.plan.name)), "shard-%a.log"),
            last = self.plan.shards - 1,
            here = word(self.here),
            program = word(self.program),
            file = word(&self.directory.join("plan.json")),
        )
    }

    fn merge(&self) -> String {
        format!(
            "{head}\
             # After the array, however it ended: what is missing is refused here, and listed.\n\
             # Analyses beside the samples are computed here: give it cores.\n\
             cd {here} || exit\n\
             exec {program} merge {file} --out {out} --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
            head = self.head(&format!("reeldown-{}-merge", label(&self.plan.name)), "merge.log"),
            here = word(self.here),
            program = word(self.program),
            file = word(&self.directory.join("plan.json")),
            out = word(&self.directory.join("results")),
        )
    }
}

/// A name as jobs and objects of Kubernetes may have it: small letters, digits and hyphens, none of these at an end.
fn label(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let label: String = name.chars().map(plain).take(LONGEST_NAME).collect();
    let label = label.trim_matches('-');
    if label.is_empty() { "study".to_owned() } else { label.to_owned() }
}

fn manifest(plan: &Plan, image: &str) -> String {
    format!(
        "# {shards} shards of a plan that lies in the volume as plan.json. A complete shard is kept:\n\
         # to repair, delete the job and apply this again. Exit code 2 is for what no second attempt would mend.\n\
         apiVersion: batch/v1\n\
         kind: Job\n\
         metadata:\n\
         \x20 name: reeldown-{name}\n\
         spec:\n\
         \x20 completionMode: Indexed\n\
         \x20 completions: {shards}\n\
         \x20 parallelism: {shards}\n\
         \x20 backoffLimitPerIndex: 3\n\
         \x20 maxFailedIndexes: 0\n\
         \x20 podReplacementPolicy: Failed\n\
         \x20 podFailurePolicy:\n\
         \x20   rules:\n\
         \x20     - action: Ignore\n\
         \x20       onPodConditions:\n\
         \x20         - type: DisruptionTarget\n\
         \x20           status: \"True\"\n\
         \x20     - action: FailIndex\n\
         \x20       onExitCodes:\n\
         \x20         containerName: shard\n\
         \x20         operator: In\n\
         \x20         values: [2]\n\
         \x20 template:\n\
         \x20   spec:\n\
         \x20     restartPolicy: Never\n\
         \x20     containers:\n\
         \x20       - name: shard\n\
         \x20         image: \"{image}\"\n\
         \x20         command: [reeldown, shard, /plan/plan.json, --shard, auto]\n\
         \x20         resources:\n\
         \x20           requests: {{ cpu: \"1\", memory: 256Mi }}\n\
         \x20           limits: {{ cpu: \"1\", memory: 1Gi }}\n\
         \x20         volumeMounts:\n\
         \x20           - name: plan\n\
         \x20             mountPath: /plan\n\
         \x20     volumes:\n\
         \x20       - name: plan\n\
         \x20         persistentVolumeClaim:\n\
         \x20           claimName: reeldown\n",
        shards = plan.shards,
        name = label(&plan.name),
    )
}
