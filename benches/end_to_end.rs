//! What a whole run costs beside its kernel: `cargo bench --bench end_to_end [-- SAMPLES]`.
//!
//! A million samples of the default study (or as many as are asked for). On the same cores, in turn, the
//! fastest of three turns each: the kernel alone over coefficients that were drawn before; drawing; drawing
//! and integrating. Then `reeldown run` as a user types it, three times as well: what it says of its samples,
//! drawn, integrated and written as Parquet; and the whole, whose analyses integrate more descents than the
//! samples: its time is held against what the kernel needs for all of them. Peak memory is the program's own high-water mark.

use rayon::prelude::*;
use reeldown::campaign::{Ensemble, Looks, Progress, run_until, sampler};
use reeldown::descent::{Fault, descend_batch};
use reeldown::numerics::columns::Columns;
use reeldown::physics::Coefficients;
use reeldown::study::Study;
use std::hint::black_box;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const TURNS: usize = 3;
const CHUNK: usize = 1024;

fn main() {
    let samples = std::env::args().filter_map(|word| word.parse().ok()).next().unwrap_or(1_000_000);
    let study = study(samples);
    println!("{samples} samples on {} threads\n", rayon::current_num_threads());

    let batch = coefficients(&study, samples);
    let kernel = fastest(|| {
        batch.par_chunks(CHUNK).for_each(|part| {
            let mut results = vec![Err(Fault::NotFinite); part.len()];
            descend_batch(study.model, study.numerics.tolerance, part, &mut results);
            black_box(&results);
        });
    });
    drop(batch);
    line("kernel alone", kernel, kernel);
    let drawing = fastest(|| {
        black_box(draws(&study, samples));
    });
    line("drawing", drawing, kernel);
    let integrating = fastest(|| {
        let mut looks = Looks::fixed(0..samples);
        run_until(&study, &mut looks, &Progress::default(), &mut |table| {
            black_box(table);
            Ok(())
        })
        .expect("the study runs");
    });
    line("drawing and integrating", integrating, kernel);

    let runs = [(); TURNS].map(|()| program(samples));
    let least = |of: fn(&Run) -> f64| runs.iter().map(of).fold(f64::INFINITY, f64::min);
    let sampling = Duration::from_secs_f64(least(|run| run.sampling_s));
    line("the run's samples, with Parquet", sampling, kernel);
    let descents = runs[0].descents;
    line(
        &format!("the whole run, {descents:.0} descents"),
        Duration::from_secs_f64(least(|run| run.wall_s)),
        kernel.mul_f64(descents / samples as f64),
    );
    let memory_mib = runs.iter().map(|run| run.memory_mib).fold(0.0, f64::max);
    println!("\npeak memory {memory_mib:.0} MiB");
}

fn study(samples: u64) -> Study {
    let mut study = Study::load(None, &[]).expect("the embedded study");
    study.sampling.samples = samples;
    study
}

fn draws(study: &Study, samples: u64) -> Vec<Columns> {
    let sampler = sampler(study).expect("a sampler");
    let starts: Vec<u64> = (0..samples).step_by(CHUNK).collect();
    starts
        .par_iter()
        .map(|&start| {
            let rows = (samples - start).min(CHUNK as u64) as usize;
            let mut uniforms = Columns::new(rows, study.inputs.len());
            sampler.fill(start, &mut uniforms).expect("the samples exist");
            let mut inputs = Columns::new(rows, study.inputs.len());
            study.joint.from_uniform(&uniforms, &mut inputs);
            inputs
        })
        .collect()
}

fn coefficients(study: &Study, samples: u64) -> Vec<Coefficients<f64>> {
    let ensemble = Ensemble::new(study);
    let of = |inputs: &Columns| -> Vec<_> {
        (0..inputs.rows()).map(|k| Coefficients::new(&ensemble.design_of(&inputs.row(k)))).collect()
    };
    draws(study, samples).iter().flat_map(of).collect()
}

fn fastest(mut work: impl FnMut()) -> Duration {
    let turn = |_| {
        let begun = Instant::now();
        work();
        begun.elapsed()
    };
    (0..TURNS).map(turn).min().unwrap_or_default()
}

fn line(what: &str, time: Duration, kernel: Duration) {
    let (time, kernel) = (time.as_secs_f64(), kernel.as_secs_f64());
    println!("{what:45} {time:8.3} s   {:5.2} x the kernel's {kernel:.3} s", time / kernel);
}

/// What one run of the program took.
struct Run {
    wall_s: f64,
    sampling_s: f64,
    descents: f64,
    memory_mib: f64,
}

/// Runs the program once.
fn program(samples: u64) -> Run {
    let name = format!("reeldown-end-to-end-{}", std::process::id());
    let directory = std::env::temp_dir().join(name);
    let begun = Instant::now();
    let mut child = Command::new(env!("CARGO_BIN_EXE_reeldown"))
        .args(["run", "--quiet", "--samples", &samples.to_string(), "--out"])
        .arg(&directory)
        .stdout(Stdio::null())
        .spawn()
        .expect("the program starts");
    let status = format!("/proc/{}/status", child.id());
    let mut peak_kib = 0.0f64;
    while child.try_wait().expect("our child").is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let mark = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = mark.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<f64>().ok());
        peak_kib = peak_kib.max(kib.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(5));
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let provenance =
        std::fs::read_to_string(directory.join("provenance.json")).expect("a finished run");
    let told: serde_json::Value = serde_json::from_str(&provenance).expect("JSON");
    let number = |key: &str| told[key].as_f64().expect("a number");
    let run = Run {
        wall_s,
        sampling_s: number("sampling_time_s"),
        descents: number("descents_computed"),
        memory_mib: peak_kib / 1024.0,
    };
    std::fs::remove_dir_all(&directory).expect("the directory was ours");
    run
}
