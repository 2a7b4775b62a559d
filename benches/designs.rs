//! Nanoseconds a coordinate for each design of experiment: `cargo bench --bench designs`.
//!
//! Medians over repeated runs of one thread filling chunks of a million-sample design.

use std::hint::black_box;
use std::time::Instant;

use reeldown::numerics::columns::Columns;
use reeldown::sampling::{DEFAULT_REPLICATES, Design, Sampler};
use reeldown::streams::Purpose;

const SAMPLES: u64 = 1 << 20;
const RUNS: usize = 9;

fn main() {
    println!("{:<18}{:>10}{:>10}{:>16}", "design", "inputs", "chunk", "ns/coordinate");
    for dimension in [23, 64] {
        for chunk in [256, 1024, 4096] {
            for design in Design::ALL {
                let median = median_ns_per_coordinate(design, dimension, chunk);
                println!("{:<18}{dimension:>10}{chunk:>10}{median:>16.2}", design.name());
            }
        }
    }
}

fn median_ns_per_coordinate(design: Design, dimension: usize, chunk: usize) -> f64 {
    let made = Sampler::new(design, dimension, SAMPLES, DEFAULT_REPLICATES, 1993, Purpose::Test);
    let sampler = made.expect("the design is within its limits");
    let mut out = Columns::new(chunk, dimension);
    let chunks = 1 + 2_000_000 / (chunk * dimension) as u64;
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            for c in 0..chunks {
                // Chunks from all over the design, so that random access is paid for as in a run.
                let first = c * 7919 * chunk as u64 % (SAMPLES - chunk as u64);
                sampler.fill(first, &mut out).expect("the chunk is inside the design");
                black_box(&out);
            }
            let coordinates = chunks as f64 * (chunk * dimension) as f64;
            start.elapsed().as_nanos() as f64 / coordinates
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}
