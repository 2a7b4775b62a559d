//! A run in shards: whatever their number and whoever computed them, the results of one machine, byte for byte.

use super::determinism::assert_same;
use super::program::{Answer, Place, program, reeldown};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

/// What makes a run cheap that is about its samples.
const CHEAP: [&str; 6] = [
    "--set",
    "sensitivity.base_samples=0",
    "--set",
    "trade.samples=0",
    "--set",
    "epistemic.outer=0",
];

/// Plans the embedded study in a directory, and says where the plan is.
fn planned(place: &Place, directory: &str, shards: u64, arguments: &[&str]) -> String {
    let (shards, out) = (shards.to_string(), place.at(directory));
    let fixed = ["plan", "--shards", &shards, "--out", &out];
    reeldown(&[&fixed, &CHEAP[..], arguments].concat()).ended_with(0);
    place.at(&format!("{directory}/plan.json"))
}

fn shard(plan: &str, k: u64) -> Answer {
    reeldown(&["shard", plan, "--shard", &k.to_string()])
}

fn whole(place: &Place, directory: &str, arguments: &[&str]) {
    let out = place.at(directory);
    let fixed = ["run", "--quiet", "--out", &out];
    let answer = reeldown(&[&fixed, &CHEAP[..], arguments].concat());
    assert!([0, 3, 4].contains(&answer.code), "{}", answer.err);
}

fn merged(place: &Place, plan: &str, directory: &str) {
    let answer = reeldown(&["merge", plan, "--quiet", "--out", &place.at(directory)]);
    assert!([0, 3, 4].contains(&answer.code), "{}", answer.err);
}

/// A shard told its number by the environment.
fn auto(plan: &str, variables: &[(&str, &str)]) -> Answer {
    let mut command = program();
    for name in [
        "SLURM_ARRAY_TASK_ID",
        "JOB_COMPLETION_INDEX",
        "AWS_BATCH_JOB_ARRAY_INDEX",
        "BATCH_TASK_INDEX",
        "PBS_ARRAY_INDEX",
        "PBS_ARRAYID",
        "SGE_TASK_ID",
        "LSB_JOBINDEX",
        "HQ_TASK_ID",
        "SLURM_PROCID",
        "OMPI_COMM_WORLD_RANK",
        "PMI_RANK",
        "SLURM_CPUS_PER_TASK",
    ] {
        command.env_remove(name);
    }
    command.envs(variables.iter().copied()).args(["shard", plan, "--shard", "auto"]);
    Answer::of(command.output().expect("the program starts"))
}

#[test]
fn property_merged_shards_are_the_run_of_one_machine() {
    let place = Place::new("merged");
    // More than a row group, in shards that end within it.
    let arguments = ["--samples", "70001", "--set", "model=quasi-steady"];
    whole(&place, "whole", &arguments);
    for shards in [1, 3, 7] {
        let plan = planned(&place, &format!("plan-{shards}"), shards, &arguments);
        // In any order, on any number of threads.
        for k in (0..shards).rev() {
            let threads = (1 + k % 3).to_string();
            let k = k.to_string();
            reeldown(&["shard", &plan, "--shard", &k, "--threads", &threads]).ended_with(0);
        }
        let out = format!("merged-{shards}");
        merged(&place, &plan, &out);
        assert_same(&place, "whole", &out);
        for name in ["trade.parquet", "report.html", "manifest.json"] {
            let [a, b] = ["whole", &out].map(|at| place.bytes(&format!("{at}/{name}")));
            assert!(a == b, "{name} of {shards} shards");
        }
    }
    assert_eq!(place.unfinished(), Vec::<PathBuf>::new());
}

#[test]
fn property_every_design_and_rule_of_stopping_merges() {
    let place = Place::new("merged-designs");
    let until = "sampling.until={ relative_error = 0.1, confidence = 0.9, budget = 4000 }";
    let studies: [&[&str]; 4] = [
        &["--samples", "512", "--set", "sampling.design=sobol"],
        &["--samples", "512", "--set", "sampling.design=halton", "--seed", "5"],
        &["--samples", "512", "--set", "sampling.design=latin-hypercube"],
        &["--set", until],
    ];
    for (k, arguments) in studies.into_iter().enumerate() {
        let [one, plan, out] = ["whole", "plan", "merged"].map(|name| format!("{name}-{k}"));
        whole(&place, &one, arguments);
        let plan = planned(&place, &plan, 3, arguments);
        (0..3).for_each(|k| drop(shard(&plan, k).ended_with(0)));
        merged(&place, &plan, &out);
        assert_same(&place, &one, &out);
    }
}

#[test]
fn property_what_is_missing_damaged_or_foreign_is_listed_and_not_merged() {
    let place = Place::new("missing");
    let plan = planned(&place, "plan", 7, &["--samples", "1000"]);
    let missing = || {
        let answer = reeldown(&["missing", &plan]);
        (answer.code, answer.out.trim().to_owned())
    };
    assert_eq!(missing(), (5, "0-6".to_owned()));
    for k in [0, 1, 2, 4, 5, 6] {
        shard(&plan, k).ended_with(0);
    }
    assert_eq!(missing(), (5, "3".to_owned()));
    assert_eq!(reeldown(&["missing", &plan, "--from", "1"]).ended_with(5).out.trim(), "4");
    shard(&plan, 3).ended_with(0);
    assert_eq!(missing(), (0, String::new()));
    // A flipped byte, an empty file, another's shard.
    let name = |k: u64| format!("plan/shard-{k:05}-of-00007.parquet");
    let mut bytes = place.bytes(&name(1));
    bytes[700] ^= 4;
    place.write(&name(1), bytes);
    place.write(&name(5), "");
    let other = planned(&place, "other", 7, &["--samples", "1000", "--seed", "9"]);
    shard(&other, 6).ended_with(0);
    std::fs::copy(place.at("other/shard-00006-of-00007.parquet"), place.at(&name(6)))
        .expect("a copy");
    std::fs::copy(place.at(&name(0)), place.at(&name(2))).expect("a copy");
    assert_eq!(missing(), (5, "1-2,5-6".to_owned()));
    let answer = reeldown(&["merge", &plan, "--out", &place.at("out")]).ended_with(1);
    for part in
        ["cannot merge", "these are missing: 1-2,5-6", "row group 0 (rows 0 to", "reeldown missing"]
    {
        assert!(answer.err.contains(part), "no {part:?} in {}", answer.err);
    }
    assert!(!place.path().join("out").exists(), "nothing was begun");
    // The repair computes those that are not right, and leaves those that are.
    let before = place.bytes(&name(4));
    for k in 0..7 {
        let answer = shard(&plan, k).ended_with(0);
        assert_eq!(answer.out.contains("already done"), [0, 3, 4].contains(&k), "{}", answer.out);
    }
    assert_eq!(place.bytes(&name(4)), before);
    assert_eq!(missing(), (0, String::new()));
    merged(&place, &plan, "out");
    whole(&place, "whole", &["--samples", "1000"]);
    assert_same(&place, "whole", "out");
}

#[test]
fn property_the_number_of_a_shard_is_told_by_the_engine_or_it_fails() {
    let place = Place::new("auto");
    let plan = planned(&place, "plan", 4, &["--samples", "40"]);
    let answer = auto(&plan, &[]).ended_with(2);
    assert!(answer.err.contains("no engine says which shard this is"), "{}", answer.err);
    let says = |variables: &[(&str, &str)], k: u64, from: &str| {
        let answer = auto(&plan, variables).ended_with(0);
        assert!(answer.err.contains(&format!("shard {k} of 4 ({from})")), "{}", answer.err);
    };
    for (name, first) in [
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
    ] {
        says(&[(name, &(2 + first).to_string())], 2, &format!("{name}={}", 2 + first));
    }
    // Inside an array a rank is set as well, and is 0 everywhere.
    let both = [("SLURM_PROCID", "0"), ("SLURM_ARRAY_TASK_ID", "3"), ("SLURM_CPUS_PER_TASK", "1")];
    says(&both, 3, "SLURM_ARRAY_TASK_ID=3");
    for value in ["4", "-1", "x", ""] {
        auto(&plan, &[("SLURM_ARRAY_TASK_ID", value)]).ended_with(2);
    }
    // SGE says "undefined" outside of arrays, and counts from 1.
    for value in ["undefined", "0", "5"] {
        auto(&plan, &[("SGE_TASK_ID", value)]).ended_with(2);
    }
}

#[test]
fn property_a_plan_is_believed_whole_or_not_at_all() {
    let place = Place::new("plans");
    let plan = planned(&place, "plan", 3, &["--samples", "60"]);
    // The same again is no conflict; another is, until it is forced.
    planned(&place, "plan", 3, &["--samples", "60"]);
    let out = place.at("plan");
    let other =
        [&["plan", "--shards", "3", "--out", &out][..], &CHEAP, &["--samples", "61"]].concat();
    let answer = reeldown(&other).ended_with(1);
    assert!(answer.err.contains("another plan is there"), "{}", answer.err);
    for shards in ["0", "61", "x", "-1"] {
        let answer =
            reeldown(&["plan", "--samples", "60", "--shards", shards, "--out", &place.at("no")]);
        assert!([1, 2].contains(&answer.code), "{}", answer.err);
    }
    assert!(!place.path().join("no").exists());
    // No text of it can be changed, cut or put in.
    let text = String::from_utf8(place.bytes("plan/plan.json")).expect("UTF-8");
    let seed = text.replacen("\"shards\": 3", "\"shards\": 2", 1);
    assert_ne!(seed, text);
    let card = text.replacen("[brake.gap]", "[brake.lap]", 1);
    assert_ne!(card, text, "the plan has the texts of study and card");
    for changed in [seed, card, text[..text.len() / 2].to_owned(), String::new(), "{}".to_owned()] {
        let bad = place.write("bad.json", changed);
        // What no second attempt mends has a code of its own.
        let answer = shard(&bad, 0).ended_with(2);
        assert!(answer.err.contains("bad.json") && answer.out.is_empty(), "{}", answer.err);
        reeldown(&["missing", &bad]).ended_with(1);
        reeldown(&["merge", &bad]).ended_with(1);
    }
    // One of another version, whole in itself.
    let (made, rest) = text.split_once("  \"digest\": \"").expect("the digest is the last entry");
    let made = made.replace(env!("CARGO_PKG_VERSION"), "0.0.9") + "  \"digest\": \"";
    let digest = reeldown::study::sha256(format!("{made}{}", &rest[64..]).as_bytes());
    let bad = place.write("bad.json", format!("{made}{digest}{}", &rest[64..]));
    let answer = shard(&bad, 0).ended_with(2);
    assert!(answer.err.contains("it was made by reeldown 0.0.9, and this is"), "{}", answer.err);
    shard(&place.at("nowhere.json"), 0).ended_with(2);
    shard(&plan, 3).ended_with(2);
    shard(&plan, 0).ended_with(0);
    // A shard is replayed by the indices of its samples, and is no run to be continued.
    shard(&plan, 1).ended_with(0);
    let file = place.at("plan/shard-00001-of-00003.parquet");
    reeldown(&["replay", &file, "--index", "25"]).ended_with(0);
    let answer = reeldown(&["replay", &file, "--index", "10"]).ended_with(1);
    assert!(answer.err.contains("holds samples 20 to 39"), "{}", answer.err);
    std::fs::create_dir(place.path().join("run")).expect("a directory");
    std::fs::copy(&file, place.at("run/outcomes.parquet")).expect("a copy");
    let run = ["run", "--quiet", "--resume", "--samples", "60", "--out", &place.at("run")];
    let answer = reeldown(&[&run[..], &CHEAP].concat()).ended_with(1);
    assert!(answer.err.contains("another study, seed or version"), "{}", answer.err);
}

/// Requeued and partitioned tasks do run twice.
#[cfg(unix)]
#[test]
fn property_a_shard_computed_twice_at_once_or_stopped_leaves_what_it_should() {
    let place = Place::new("twice");
    let samples = 300_000;
    let plan = planned(&place, "plan", 2, &["--samples", &(2 * samples).to_string()]);
    let begin = |k: &str| {
        program()
            .args(["shard", &plan, "--shard", k])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts")
    };
    let begun = || {
        while place.unfinished().is_empty() {
            thread::sleep(Duration::from_millis(1));
        }
    };
    // Asked to end: nothing is left.
    let child = begin("0");
    begun();
    let told = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    assert!(told.expect("kill runs").success());
    let answer = Answer::of(child.wait_with_output().expect("it ends")).ended_with(143);
    assert!(answer.err.contains("nothing was left of shard 0"), "{}", answer.err);
    assert_eq!(place.unfinished(), Vec::<PathBuf>::new());
    // Killed: what is left is in nobody's way, and goes with the next attempt.
    let mut child = begin("0");
    begun();
    child.kill().expect("kill works");
    child.wait().expect("it ends");
    assert_eq!(place.unfinished().len(), 1);
    let twice = [begin("0"), begin("0")];
    for child in twice {
        Answer::of(child.wait_with_output().expect("it ends")).ended_with(0);
    }
    assert_eq!(place.unfinished(), Vec::<PathBuf>::new());
    assert_eq!(reeldown(&["missing", &plan]).ended_with(5).out.trim(), "1");
}

/// The scripts, as Slurm starts them; on a real cluster: `.ci/slurm`.
#[cfg(unix)]
#[test]
fn property_the_scripts_for_slurm_compute_and_merge() {
    let place = Place::new("slurm scripts");
    let arguments = ["--samples", "300"];
    let plan = planned(&place, "a plan", 3, &[&arguments[..], &["--slurm"]].concat());
    let script = |name: &str, task: &str| {
        let mut command = Command::new("bash");
        command.arg(place.at(&format!("a plan/{name}"))).env("SLURM_ARRAY_TASK_ID", task);
        Answer::of(command.env("SLURM_CPUS_PER_TASK", "1").output().expect("bash starts"))
    };
    let array = String::from_utf8(place.bytes("a plan/array.sbatch")).expect("UTF-8");
    let log = format!("#SBATCH --output=\"{}\"", place.at("a plan/shard-%a.log"));
    for line in ["#!/bin/bash", "#SBATCH --array=0-2", "#SBATCH --requeue", &log] {
        assert!(array.lines().any(|found| found == line), "no {line} in {array}");
    }
    for task in ["0", "2"] {
        script("array.sbatch", task).ended_with(0);
    }
    let answer = script("merge.sbatch", "0").ended_with(1);
    assert!(answer.err.contains("these are missing: 1 "), "{}", answer.err);
    script("array.sbatch", "1").ended_with(0);
    script("merge.sbatch", "0");
    whole(&place, "whole", &arguments);
    assert_same(&place, "whole", "a plan/results");
    assert_eq!(reeldown(&["missing", &plan]).ended_with(0).out, "");
    // What a line of a script's head cannot name.
    for odd in ["50%", "quo\"te", "line\nend"] {
        let out = place.at(odd);
        let answer =
            reeldown(&["plan", "--samples", "9", "--shards", "3", "--out", &out, "--slurm"]);
        assert!(answer.ended_with(1).err.contains("use another directory"));
    }
}

#[test]
fn reference_kubernetes_validate_accepts_the_manifest() {
    let place = Place::new("kubernetes");
    let image = ["--kubernetes", "registry.example/reeldown:0.1"];
    planned(&place, "plan", 7, &[&["--samples", "300"], &image[..]].concat());
    let job = String::from_utf8(place.bytes("plan/job.yaml")).expect("UTF-8");
    // What is on record was accepted by kubernetes-validate 1.37.0 against the schemas of Kubernetes 1.29 and 1.33:
    // `kubernetes-validate -k 1.33 --strict tests/cli/references/job.yaml`.
    let recorded = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cli/references/job.yaml");
    assert_eq!(job, std::fs::read_to_string(recorded).expect("the recorded manifest"));
    for image in ["", "a b", "x\"\n"] {
        let out = place.at("none");
        let answer = reeldown(&[
            "plan",
            "--samples",
            "9",
            "--shards",
            "3",
            "--out",
            &out,
            "--kubernetes",
            image,
        ]);
        assert!(answer.ended_with(1).err.contains("expected the name of an image"));
    }
}
