//! What every design of experiment promises, and plain Monte Carlo's uniformity.

use proptest::prelude::*;
use reeldown::numerics::columns::Columns;
use reeldown::sampling::{DEFAULT_REPLICATES, Design, MAX_REPLICATES, MAX_SAMPLES, Sampler};
use reeldown::streams::Purpose;

use crate::bounds;

/// A default design of `samples` points under `seed`.
fn sampler(design: Design, dimension: usize, samples: u64, seed: u64) -> Sampler {
    Sampler::new(design, dimension, samples, DEFAULT_REPLICATES, seed, Purpose::Test).unwrap()
}

/// Points `first .. first + count`.
fn points(sampler: &Sampler, first: u64, count: usize) -> Columns {
    let mut out = Columns::new(count, sampler.dimension());
    sampler.fill(first, &mut out).unwrap();
    out
}

/// Whether two tables have the same bits.
fn same_bits(a: &Columns, b: &Columns) -> bool {
    a.rows() == b.rows()
        && (0..a.columns()).all(|j| {
            let bits = |column: &[f64]| column.iter().map(|u| u.to_bits()).collect::<Vec<_>>();
            bits(a.column(j)) == bits(b.column(j))
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn property_a_point_is_the_same_alone_and_in_any_chunk(
        which in 0usize..4, dimension in 1usize..40, shares in 1u64..200, replicates in 1u32..20,
        seed: u64, from in 0.0f64..1.0, to in 0.0f64..1.0,
    ) {
        let samples = shares * u64::from(replicates);
        let sampler =
            Sampler::new(Design::ALL[which], dimension, samples, replicates, seed, Purpose::Test).unwrap();
        let whole = points(&sampler, 0, samples as usize);
        let first = ((samples - 1) as f64 * from) as usize;
        let count = 1 + ((samples as usize - first - 1) as f64 * to) as usize;
        let part = points(&sampler, first as u64, count);
        let alone = points(&sampler, first as u64, 1);
        for j in 0..dimension {
            prop_assert_eq!(part.column(j), &whole.column(j)[first..first + count]);
            prop_assert_eq!(alone.get(0, j).to_bits(), whole.get(first, j).to_bits());
        }
    }

    #[test]
    fn property_uniforms_are_inside_the_open_interval_on_the_53_bit_grid(
        which in 0usize..4, dimension in 1usize..80, shares in 1u64..300, replicates in 1u32..20,
        seed: u64,
    ) {
        let samples = shares * u64::from(replicates);
        let sampler =
            Sampler::new(Design::ALL[which], dimension, samples, replicates, seed, Purpose::Test).unwrap();
        let whole = points(&sampler, 0, samples as usize);
        for j in 0..dimension {
            for &u in whole.column(j) {
                let scaled = u * 2f64.powi(53);
                prop_assert!(u > 0.0 && u < 1.0 && (scaled == scaled.trunc() || scaled == 0.5), "{}", u);
            }
        }
    }
}

#[test]
fn property_chunks_of_any_size_make_the_whole() {
    for design in Design::ALL {
        let sampler = sampler(design, 23, 1200, 7);
        let whole = points(&sampler, 0, 1200);
        for chunk in [1, 7, 16, 32, 100, 1199] {
            let mut assembled = Columns::new(1200, 23);
            for first in (0..1200).step_by(chunk) {
                let part = points(&sampler, first as u64, chunk.min(1200 - first));
                for j in 0..23 {
                    assembled.column_mut(j)[first..first + part.rows()]
                        .copy_from_slice(part.column(j));
                }
            }
            assert!(same_bits(&whole, &assembled), "{design:?} in chunks of {chunk}");
        }
    }
}

#[test]
fn property_a_longer_run_has_the_shorter_as_its_first_rows() {
    for design in Design::ALL {
        let short = points(&sampler(design, 9, 480, 3), 0, 480);
        let long = points(&sampler(design, 9, 16_000, 3), 0, 480);
        assert_eq!(same_bits(&short, &long), design.is_extensible(), "{design:?}");
        assert_eq!(sampler(design, 9, 480, 3).extensible(), design.is_extensible());
    }
}

#[test]
fn property_a_later_coordinate_leaves_the_earlier_ones_alone() {
    for design in Design::ALL {
        let few = points(&sampler(design, 5, 320, 3), 0, 320);
        let more = points(&sampler(design, 8, 320, 3), 0, 320);
        assert!((0..5).all(|j| few.column(j) == more.column(j)), "{design:?}");
    }
}

#[test]
fn property_seed_and_purpose_each_make_another_design() {
    for design in Design::ALL {
        let base = points(&sampler(design, 4, 64, 1), 0, 64);
        assert!(!same_bits(&base, &points(&sampler(design, 4, 64, 2), 0, 64)), "{design:?}");
        let other =
            Sampler::new(design, 4, 64, DEFAULT_REPLICATES, 1, Purpose::Confirmation).unwrap();
        assert!(!same_bits(&base, &points(&other, 0, 64)), "{design:?}");
    }
}

#[test]
fn property_points_far_beyond_two_to_the_thirty_are_reached() {
    let samples = MAX_SAMPLES;
    for design in Design::ALL {
        let sampler = sampler(design, 64, samples, 5);
        for first in [1 << 31, (1 << 40) + 11, samples - 40] {
            let part = points(&sampler, first, 40);
            let last = points(&sampler, first + 39, 1);
            assert_eq!(part.row(39), last.row(0), "{design:?} at {first}");
            let mut distinct = part.column(0).to_vec();
            distinct.sort_by(f64::total_cmp);
            distinct.dedup();
            assert_eq!(distinct.len(), 40, "{design:?} at {first}");
        }
        assert!(sampler.fill(samples - 39, &mut Columns::new(40, 64)).is_err());
        assert!(sampler.fill(u64::MAX, &mut Columns::new(40, 64)).is_err());
        assert!(sampler.fill(0, &mut Columns::new(40, 63)).is_err());
    }
}

#[test]
fn property_names_are_those_of_a_study_and_go_both_ways() {
    let names = Design::ALL.map(Design::name);
    assert_eq!(names, ["monte-carlo", "latin-hypercube", "sobol", "halton"]);
    for design in Design::ALL {
        assert_eq!(Design::from_name(design.name()), Some(design));
    }
    assert_eq!(Design::from_name("Sobol"), None);
}

#[test]
fn property_an_impossible_design_is_refused_with_what_would_do() {
    let refusal = |design, dimension, samples, replicates| {
        let made = Sampler::new(design, dimension, samples, replicates, 1, Purpose::Test);
        made.err().map(|error| error.to_string()).unwrap_or_default()
    };
    for design in Design::ALL {
        assert!(refusal(design, 0, 16, 16).contains("at least one input"));
        assert!(refusal(design, 3, 0, 16).contains("at least one input"));
        let most = design.max_dimension();
        assert!(refusal(design, most + 1, 16, 16).contains(&format!("at most {most} inputs")));
        assert_eq!(refusal(design, most, 16, 16), "");
        assert!(refusal(design, 3, MAX_SAMPLES + 16, 16).contains("samples"));
    }
    for design in [Design::LatinHypercube, Design::Sobol, Design::Halton] {
        assert!(refusal(design, 3, 1000, 16).contains("use 1008 samples"));
        assert!(refusal(design, 3, 16, 0).contains("one replicate"));
        assert!(refusal(design, 3, 512, MAX_REPLICATES + 1).contains("at most 256 replicates"));
    }
    assert_eq!(refusal(Design::MonteCarlo, 3, 1001, 16), "");
}

#[test]
fn property_replicates_are_interleaved_and_monte_carlo_has_none() {
    let replicated = sampler(Design::Sobol, 2, 160, 1);
    assert_eq!((replicated.replicates(), replicated.points_per_replicate()), (16, 10));
    assert_eq!([0, 1, 15, 16, 33].map(|k| replicated.replicate_of(k)), [0, 1, 15, 0, 1]);
    let plain = sampler(Design::MonteCarlo, 2, 161, 1);
    assert_eq!((plain.replicates(), plain.replicate_of(77)), (1, 0));
}

#[test]
fn property_advice_is_given_where_there_is_some() {
    let advice = |design, samples, replicates| {
        Sampler::new(design, 3, samples, replicates, 1, Purpose::Test).unwrap().advice()
    };
    assert_eq!(advice(Design::Sobol, 1 << 17, 16), None);
    let text = advice(Design::Sobol, 100_000, 16).unwrap();
    assert!(text.contains("65536 or 131072"), "{text}");
    assert!(advice(Design::Halton, 100, 1).unwrap().contains("no error estimate"));
    assert_eq!(advice(Design::Halton, 100_000, 16), None);
    assert_eq!(advice(Design::LatinHypercube, 100_000, 16), None);
    assert_eq!(advice(Design::MonteCarlo, 100_000, 1), None);
    for design in Design::ALL {
        let text = sampler(design, 3, 160, 1).describe();
        assert!(text.contains("160 samples of 3 inputs"), "{text}");
        assert_eq!(text.contains("16 independent replicates of 10 points"), design.is_replicated());
    }
}

#[test]
fn analytic_monte_carlo_points_are_uniform_in_every_coordinate() {
    let n = 1 << 15;
    let table = points(&sampler(Design::MonteCarlo, 12, n as u64, 1993), 0, n);
    for j in 0..12 {
        let mut counts = [0u64; 128];
        let mut ones = [0u64; 53];
        for &u in table.column(j) {
            counts[(u * 128.0) as usize] += 1;
            let word = (u * 2f64.powi(53)) as u64;
            for (bit, ones) in ones.iter_mut().enumerate() {
                *ones += word >> bit & 1;
            }
        }
        bounds::assert_uniform(&counts, "128 cells");
        for ones in ones {
            // A fair bit: mean n/2, variance n/4.
            assert!(
                (ones as f64 - n as f64 / 2.0).abs() < bounds::NORMAL * (n as f64 / 4.0).sqrt()
            );
        }
        let mut sorted = table.column(j).to_vec();
        sorted.sort_by(f64::total_cmp);
        let distance = sorted.iter().enumerate().fold(0.0f64, |worst, (k, u)| {
            worst.max(u - k as f64 / n as f64).max((k + 1) as f64 / n as f64 - u)
        });
        assert!(distance * (n as f64).sqrt() < bounds::KOLMOGOROV, "coordinate {j}: {distance}");
    }
}

#[test]
fn analytic_monte_carlo_points_are_uncorrelated_across_points_and_coordinates() {
    let n = 1 << 15;
    let table = points(&sampler(Design::MonteCarlo, 12, n as u64, 42), 0, n);
    for a in 0..12 {
        for b in 0..12 {
            // Lags around the 32 points that share a stream, and one that leaves it.
            for lag in [0, 1, 2, 16, 31, 32, 33, 64] {
                if a == b && lag == 0 {
                    continue;
                }
                let pairs = table.column(a).iter().zip(&table.column(b)[lag..]);
                let sum: f64 = pairs.map(|(u, v)| (u - 0.5) * (v - 0.5)).sum();
                // Terms of variance 1/144, uncorrelated.
                let z = sum * 12.0 / ((n - lag) as f64).sqrt();
                assert!(z.abs() < bounds::NORMAL, "coordinates {a}, {b}, lag {lag}: {z}");
            }
        }
    }
}

#[test]
fn analytic_monte_carlo_pairs_and_triples_fill_their_cells_evenly() {
    let n = 1 << 16;
    let table = points(&sampler(Design::MonteCarlo, 3, n as u64, 8), 0, n);
    let cell = |j: usize, k: usize| (table.get(k, j) * 8.0) as usize;
    let mut within = [0u64; 512];
    let mut along = [0u64; 512];
    for k in 0..n {
        within[cell(0, k) * 64 + cell(1, k) * 8 + cell(2, k)] += 1;
    }
    for k in (0..n - 2).step_by(3) {
        along[cell(0, k) * 64 + cell(0, k + 1) * 8 + cell(0, k + 2)] += 1;
    }
    bounds::assert_uniform(&within, "three coordinates");
    bounds::assert_uniform(&along, "three points");
}

#[test]
fn regression_first_points_of_every_design() {
    // Seeded studies of earlier versions stay what they were.
    let first = Design::ALL.map(|design| points(&sampler(design, 2, 64, 1993), 0, 1).row(0));
    let bits = first.map(|row| [row[0].to_bits(), row[1].to_bits()]);
    assert_eq!(bits, REGRESSION, "{bits:#x?}");
}

/// First points of version 0.1.0.
const REGRESSION: [[u64; 2]; 4] = [
    [0x3fbf_b39a_8398_60c8, 0x3fe0_d29c_9553_58ad],
    [0x3fba_65b8_123f_b360, 0x3fbd_5313_255a_f9e0],
    [0x3f3e_4712_46b2_e800, 0x3fe2_e1e0_5ced_fbd8],
    [0x3f8c_2bb8_9d48_4b00, 0x3fc1_cda7_79ca_2c94],
];
