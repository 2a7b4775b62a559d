//! Descents a second, and what they cost: `cargo bench --bench descents`.
//!
//! One thread and two, every instruction set of the machine, members of the default study in the order
//! drawn (shuffled) and sorted by viscosity (coherent). All variants take turns within one run, so that a
//! busy machine slows them alike, and the fastest turn of each counts; ratios between lines hold better
//! than the lines. The share of peak is that of the machine's fused multiply-add rate, measured in the same
//! run, with the floating-point operations of a step attempt counted once by an instrumented lane type.

use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use reeldown::descent::vector::{Counts, InstructionSet, Settings, descend, descend_with};
use reeldown::descent::{Fault, Model, Outcome, reference};
use reeldown::physics::Coefficients;

#[path = "../tests/truth/vector_members.rs"]
mod members;

const MEMBERS: usize = 1024;
const TURNS: usize = 40;
/// Batches that one thread, or two, compute in a turn.
const BATCHES: usize = 32;

/// Additions, multiplications, divisions and roots of a step attempt, a fused multiply-add being two.
const DYNAMIC_OPERATIONS: f64 = 1890.0;
const QUASI_STEADY_OPERATIONS: f64 = 1230.0;

struct Variant<'a> {
    name: String,
    members: usize,
    run: Box<dyn Fn() -> Counts + 'a>,
    operations_per_attempt: f64,
    threads: f64,
}

fn results(count: usize) -> Vec<Result<Outcome, Fault>> {
    vec![Err(Fault::NotFinite); count]
}

fn main() {
    let shuffled = members::default_study(MEMBERS);
    let mut coherent = shuffled.clone();
    coherent.sort_by(|a, b| a.fluid.torque_per_speed_nms.total_cmp(&b.fluid.torque_per_speed_nms));
    let stress = members::stress(MEMBERS);
    let mut variants = Vec::new();
    for (model, operations) in
        [(Model::Dynamic, DYNAMIC_OPERATIONS), (Model::QuasiSteady, QUASI_STEADY_OPERATIONS)]
    {
        for tolerance in [1e-5, 1e-6] {
            let settings = Settings { tolerance };
            let label = format!("{} {tolerance:.0e}", model.name());
            for set in InstructionSet::ALL.into_iter().rev().filter(|set| set.is_available()) {
                let batch = &shuffled;
                let run = move || {
                    let mut out = results(batch.len());
                    descend_with(set, model, &settings, batch, black_box(&mut out))
                };
                variants.push(Variant {
                    name: format!("{label} {}", set.name()),
                    members: MEMBERS,
                    run: Box::new(run),
                    operations_per_attempt: operations,
                    threads: 1.0,
                });
            }
            for (kind, batch) in [("coherent", &coherent), ("stress set", &stress)] {
                // Shear thinning costs more operations than are counted here.
                let thins = batch.iter().any(|c| c.fluid.shear_thinning);
                variants.push(Variant {
                    name: format!("{label} {kind}"),
                    members: MEMBERS,
                    run: Box::new(move || {
                        let mut out = results(batch.len());
                        descend(model, &settings, batch, black_box(&mut out))
                    }),
                    operations_per_attempt: if thins { f64::NAN } else { operations },
                    threads: 1.0,
                });
            }
            for threads in [1, 2] {
                let batch = &shuffled;
                variants.push(Variant {
                    name: format!("{label} {BATCHES} batches, {threads} thr."),
                    members: BATCHES * MEMBERS,
                    run: Box::new(move || batches(threads, model, &settings, batch)),
                    operations_per_attempt: operations,
                    threads: threads as f64,
                });
            }
        }
        let few = &shuffled[..4];
        variants.push(Variant {
            name: format!("{} reference 1e-8", model.name()),
            members: few.len(),
            run: Box::new(move || {
                for c in few {
                    let _ = black_box(reference::descend(c, model, 1e-8));
                }
                Counts::default()
            }),
            operations_per_attempt: f64::NAN,
            threads: 1.0,
        });
    }

    let mut best = vec![f64::INFINITY; variants.len()];
    let mut counts = vec![Counts::default(); variants.len()];
    let mut peak = 0.0f64;
    for _ in 0..TURNS {
        peak = peak.max(multiply_add_rate());
        for (k, variant) in variants.iter().enumerate() {
            let start = Instant::now();
            counts[k] = (variant.run)();
            best[k] = best[k].min(start.elapsed().as_secs_f64());
        }
    }

    println!("fused multiply-adds: {:.1} Gflop/s on one core", peak / 1e9);
    println!(
        "{:<34}{:>14}{:>10}{:>10}{:>12}{:>10}",
        "", "descents/s", "attempts", "rejected", "evaluations", "of peak"
    );
    for (k, variant) in variants.iter().enumerate() {
        let rate = variant.members as f64 / best[k];
        let each = |count: u64| count as f64 / counts[k].descents as f64;
        let flops = rate * each(counts[k].attempts) * variant.operations_per_attempt;
        println!(
            "{:<34}{rate:>14.0}{:>10.2}{:>10.2}{:>12.1}{:>9.0}%",
            variant.name,
            each(counts[k].attempts),
            each(counts[k].rejected),
            each(counts[k].evaluations),
            100.0 * flops / (peak * variant.threads)
        );
    }
}

/// The batch, [`BATCHES`] times, by threads that take the next one as they finish: as an ensemble is computed.
fn batches(
    threads: usize,
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
) -> Counts {
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut out, mut counts) = (results(batch.len()), Counts::default());
        while next.fetch_add(1, Ordering::Relaxed) < BATCHES {
            counts += descend(model, settings, batch, black_box(&mut out));
        }
        counts
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut counts = work();
        for other in others {
            counts += other.join().expect("a thread of the bench");
        }
        counts
    })
}

/// Floating-point operations a second of independent fused multiply-adds in the widest registers.
fn multiply_add_rate() -> f64 {
    const ROUNDS: usize = 100_000;
    let start = Instant::now();
    let operations = match InstructionSet::best() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx512 => unsafe { chains_512(ROUNDS) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx2 => unsafe { chains_256(ROUNDS) },
        _ => return f64::NAN,
    };
    operations / start.elapsed().as_secs_f64()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn chains_512(rounds: usize) -> f64 {
    use std::arch::x86_64::{_mm512_fmadd_pd, _mm512_set1_pd};
    let factor = _mm512_set1_pd(black_box(0.999_999));
    let mut chains = [_mm512_set1_pd(1.0); 16];
    for _ in 0..rounds {
        for chain in &mut chains {
            *chain = _mm512_fmadd_pd(*chain, factor, factor);
        }
    }
    black_box(chains);
    (rounds * 16 * 8 * 2) as f64
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn chains_256(rounds: usize) -> f64 {
    use std::arch::x86_64::{_mm256_fmadd_pd, _mm256_set1_pd};
    let factor = _mm256_set1_pd(black_box(0.999_999));
    let mut chains = [_mm256_set1_pd(1.0); 12];
    for _ in 0..rounds {
        for chain in &mut chains {
            *chain = _mm256_fmadd_pd(*chain, factor, factor);
        }
    }
    black_box(chains);
    (rounds * 12 * 4 * 2) as f64
}
