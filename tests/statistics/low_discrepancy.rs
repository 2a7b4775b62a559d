//! Sobol' and Halton points: the published sequences, their nets, and what scrambling must keep.

use reeldown::numerics::columns::Columns;
use reeldown::sampling::{Design, Sampler, unscrambled_halton, unscrambled_sobol};
use reeldown::streams::Purpose;

use crate::bounds;

const REPLICATES: usize = 256;

/// `replicates` replicates of `n` points.
fn replicated(design: Design, dimension: usize, n: usize, replicates: usize, seed: u64) -> Columns {
    let samples = (n * replicates) as u64;
    let replicates = replicates as u32;
    let sampler =
        Sampler::new(design, dimension, samples, replicates, seed, Purpose::Test).unwrap();
    let mut out = Columns::new(samples as usize, dimension);
    sampler.fill(0, &mut out).unwrap();
    out
}

/// Coordinate `j` of replicate `r`, point by point.
fn own(table: &Columns, replicates: usize, j: usize, r: usize) -> Vec<f64> {
    table.column(j)[r..].iter().step_by(replicates).copied().collect()
}

/// The exact interval of `u` among `n` equal ones.
fn interval(u: f64, n: usize) -> usize {
    (((u * 2f64.powi(53)) as u128 * n as u128) >> 53) as usize
}

/// Whether every one of `cells` cells is hit exactly once.
fn once_each(cells: usize, hits: impl Iterator<Item = usize>) -> bool {
    let mut counts = vec![0; cells];
    hits.for_each(|cell| counts[cell] += 1);
    counts.iter().all(|&count| count == 1)
}

#[test]
fn published_first_sobol_points_of_joe_and_kuo() {
    // Table of the first ten coordinates in Gray-code order (point 2 of the first is 3/4, which the
    // original order has as point 3).
    let published: [(u64, [f64; 10]); 5] = [
        (1, [0.5; 10]),
        (2, [0.75, 0.25, 0.25, 0.25, 0.75, 0.75, 0.25, 0.75, 0.75, 0.75]),
        (3, [0.25, 0.75, 0.75, 0.75, 0.25, 0.25, 0.75, 0.25, 0.25, 0.25]),
        (7, [0.125, 0.625, 0.375, 0.125, 0.125, 0.375, 0.625, 0.625, 0.625, 0.875]),
        (15, [0.0625, 0.9375, 0.5625, 0.3125, 0.6875, 0.1875, 0.8125, 0.3125, 0.3125, 0.6875]),
    ];
    for (index, point) in published {
        assert_eq!(unscrambled_sobol(index, 10).unwrap(), point, "point {index}");
    }
    assert_eq!(unscrambled_sobol(0, 10).unwrap(), [0.0; 10]);
    assert!(unscrambled_sobol(1 << 53, 1).is_err());
    assert!(unscrambled_sobol(0, 1025).is_err());
}

/// A list of numbers of the reference.
fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn reference_scipy_unscrambled_points_of_64_coordinates_and_far_indices() {
    let text = include_str!("references/low_discrepancy.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let sobol = reference["sobol"].as_array().unwrap();
    assert_eq!(sobol.len(), 15);
    for entry in sobol.iter().chain([&reference["sobol_1024"]]) {
        let (index, point) = (entry["index"].as_u64().unwrap(), numbers(&entry["point"]));
        // At most 53 binary digits each: both sides are exact.
        assert_eq!(unscrambled_sobol(index, point.len()).unwrap(), point, "Sobol' point {index}");
    }
    let halton = reference["halton"].as_array().unwrap();
    assert_eq!(halton.len(), 9);
    for entry in halton {
        let (index, point) = (entry["index"].as_u64().unwrap(), numbers(&entry["point"]));
        for (ours, theirs) in unscrambled_halton(index, point.len()).unwrap().iter().zip(point) {
            // SciPy adds up to 32 rounded quotients; ours is rounded three times.
            assert!((ours - theirs).abs() <= 35.0 * f64::EPSILON * theirs, "Halton point {index}");
        }
    }
}

#[test]
fn published_van_der_corput_points() {
    let expected =
        [[0.0, 0.0], [1.0 / 2.0, 1.0 / 3.0], [1.0 / 4.0, 2.0 / 3.0], [3.0 / 4.0, 1.0 / 9.0]];
    for (index, point) in expected.iter().enumerate() {
        assert_eq!(unscrambled_halton(index as u64, 2).unwrap(), point);
    }
    assert_eq!(unscrambled_halton(6, 3).unwrap(), [3.0 / 8.0, 2.0 / 9.0, 6.0 / 25.0]);
    assert!(unscrambled_halton(0, 1025).is_err());
    assert!(unscrambled_halton(1 << 50, 1).is_err());
}

#[test]
fn property_scrambled_sobol_fills_every_elementary_interval_once() {
    let n = 1 << 10;
    let table = replicated(Design::Sobol, 64, n, 8, 1993);
    for r in 0..8 {
        let columns: Vec<Vec<f64>> = (0..64).map(|j| own(&table, 8, j, r)).collect();
        for bits in 0..=10 {
            let m = 1usize << bits;
            for (j, column) in columns.iter().enumerate() {
                for block in column.chunks_exact(m) {
                    assert!(once_each(m, block.iter().map(|&u| interval(u, m))), "coordinate {j}");
                }
            }
            // The first two coordinates are a (0, m, 2)-net: every shape of box of area 1/m.
            for split in 0..=bits {
                let (wide, high) = (1 << split, m >> split);
                for (us, vs) in columns[0].chunks_exact(m).zip(columns[1].chunks_exact(m)) {
                    let boxes = us
                        .iter()
                        .zip(vs)
                        .map(|(&u, &v)| interval(u, wide) * high + interval(v, high));
                    assert!(once_each(m, boxes), "boxes of 1/{wide} by 1/{high}");
                }
            }
        }
    }
}

#[test]
fn property_scrambled_halton_fills_every_elementary_interval_once() {
    let table = replicated(Design::Halton, 6, 2500, 8, 1993);
    for r in 0..8 {
        let columns: Vec<Vec<f64>> = (0..6).map(|j| own(&table, 8, j, r)).collect();
        for (column, prime) in columns.iter().zip([2usize, 3, 5, 7, 11, 13]) {
            let mut m = 1;
            while m <= 2500 {
                for block in column.chunks_exact(m) {
                    assert!(
                        once_each(m, block.iter().map(|&u| interval(u, m))),
                        "base {prime}, {m}"
                    );
                }
                m *= prime;
            }
        }
        // Boxes of the first two coordinates, by the Chinese remainder theorem.
        for (wide, high) in [(2, 3), (4, 3), (2, 9), (8, 9), (16, 27), (32, 27), (16, 81)] {
            let pairs =
                columns[0].chunks_exact(wide * high).zip(columns[1].chunks_exact(wide * high));
            for (us, vs) in pairs {
                let boxes =
                    us.iter().zip(vs).map(|(&u, &v)| interval(u, wide) * high + interval(v, high));
                assert!(once_each(wide * high, boxes), "boxes of 1/{wide} by 1/{high}");
            }
        }
    }
}

#[test]
fn analytic_scrambled_points_are_uniform_one_by_one() {
    for design in [Design::Sobol, Design::Halton] {
        let table = replicated(design, 6, 64, REPLICATES, 17);
        let later = replicated(design, 6, 64, REPLICATES, 18);
        for j in 0..6 {
            for point in 0..64 {
                let mut counts = [0u64; 16];
                for table in [&table, &later] {
                    for &u in &table.column(j)[point * REPLICATES..(point + 1) * REPLICATES] {
                        counts[interval(u, 16)] += 1;
                    }
                }
                bounds::assert_uniform(
                    &counts,
                    &format!("{design:?} point {point}, coordinate {j}"),
                );
            }
        }
    }
}

#[test]
fn analytic_all_nested_scrambles_of_three_binary_digits_are_equally_frequent() {
    // Owen's scrambling flips at 1 + 2 + 4 nodes, independently: 128 equally likely maps of the eighths.
    for j in [0usize, 1, 5, 40] {
        let raw: Vec<usize> =
            (0..8).map(|k| interval(unscrambled_sobol(k, j + 1).unwrap()[j], 8)).collect();
        let mut counts = [0u64; 128];
        for seed in 0..50 {
            let table = replicated(Design::Sobol, j + 1, 8, REPLICATES, seed);
            for r in 0..REPLICATES {
                let mut image = [0; 8];
                for (&from, to) in raw.iter().zip(own(&table, REPLICATES, j, r)) {
                    image[from] = interval(to, 8);
                }
                // One flip a node: of the first digit; of the second and the third below each prefix.
                let flips = [0, 4].map(|x| image[x] >> 1 & 1);
                let lowest = [0, 2, 4, 6].map(|x| image[x] & 1);
                let nodes =
                    flips.into_iter().chain(lowest).fold(image[0] >> 2, |all, bit| all * 2 + bit);
                counts[nodes] += 1;
            }
        }
        bounds::assert_uniform(&counts, &format!("coordinate {j}"));
    }
}

#[test]
fn analytic_halton_digit_permutations_are_fair() {
    // Base 3: the maps h d + g are all six permutations.
    let mut counts = [0u64; 6];
    for seed in 0..40 {
        let table = replicated(Design::Halton, 2, 3, REPLICATES, seed);
        for r in 0..REPLICATES {
            let first: Vec<usize> =
                own(&table, REPLICATES, 1, r).iter().map(|&u| interval(u, 3)).collect();
            counts[first[0] * 2 + usize::from(first[1] > first[2])] += 1;
        }
    }
    bounds::assert_uniform(&counts, "permutations of the first digit in base 3");
    // The second digit below different first digits: every pair of images equally often (base 3).
    let mut pairs = [0u64; 9];
    for seed in 100..140 {
        let table = replicated(Design::Halton, 2, 3, REPLICATES, seed);
        for r in 0..REPLICATES {
            let second: Vec<usize> =
                own(&table, REPLICATES, 1, r).iter().map(|&u| interval(u, 9) % 3).collect();
            pairs[second[0] * 3 + second[1]] += 1;
        }
    }
    bounds::assert_uniform(&pairs, "second digits of two points that differ in the first");
}

#[test]
fn analytic_the_mean_of_a_coordinate_has_the_variance_of_jittered_strata() {
    // n points, one uniform in each n-th, independent given the strata: variance 1/(12 n³).
    let primes = [2usize, 3, 5, 7, 11, 13];
    for (design, powers) in [(Design::Sobol, [8; 6]), (Design::Halton, [8, 5, 3, 2, 2, 2])] {
        for j in 0..6 {
            let base = if design == Design::Sobol { 2 } else { primes[j] };
            let n = base.pow(powers[j]);
            let table = replicated(design, 6, n, REPLICATES, 5 + j as u64);
            let means: Vec<f64> = (0..REPLICATES)
                .map(|r| own(&table, REPLICATES, j, r).iter().sum::<f64>() / n as f64)
                .collect();
            let (mean, variance) = bounds::moments(&means);
            let truth = 1.0 / (12.0 * (n as f64).powi(3));
            let df = REPLICATES as f64 - 1.0;
            let (low, high) = bounds::chi_squared(df);
            let statistic = variance * df / truth;
            assert!(
                statistic > low && statistic < high,
                "{design:?} {j}: {statistic} in {low}..{high}"
            );
            assert!((mean - 0.5).abs() < bounds::NORMAL * (truth / REPLICATES as f64).sqrt());
        }
    }
}

/// Replicates' estimates of ∫ Π e^{u_j} over `dimension` coordinates, which is (e − 1)^dimension.
fn estimates(design: Design, dimension: usize, n: usize, seed: u64) -> Vec<f64> {
    let table = replicated(design, dimension, n, REPLICATES, seed);
    let mut sums = vec![0.0; REPLICATES];
    for k in 0..table.rows() {
        let exponent: f64 = (0..dimension).map(|j| table.get(k, j)).sum();
        sums[k % REPLICATES] += libm::exp(exponent) / n as f64;
    }
    sums
}

#[test]
fn analytic_scrambled_integrals_are_unbiased() {
    let truth = (std::f64::consts::E - 1.0).powi(3);
    for design in [Design::Sobol, Design::Halton, Design::LatinHypercube] {
        for n in [1, 4, 13] {
            let all: Vec<f64> = (0..20).flat_map(|seed| estimates(design, 3, n, seed)).collect();
            let (mean, variance) = bounds::moments(&all);
            let z = (mean - truth) / (variance / all.len() as f64).sqrt();
            assert!(z.abs() < bounds::NORMAL, "{design:?}, {n} points: {z}");
        }
    }
}

#[test]
fn analytic_variance_falls_at_the_rate_of_scrambled_nets() {
    let variance = |design, n| bounds::moments(&estimates(design, 2, n, 77)).1;
    let truth = {
        let second = (libm::exp(2.0) - 1.0) / 2.0;
        second * second - (std::f64::consts::E - 1.0).powi(4)
    };
    for n in [64usize, 1024] {
        // Sobol': in two dimensions at most a Monte Carlo sample's (its gain coefficients are 1), and
        // for a smooth integrand of order n^−3 log n (Owen, Annals of Statistics 25, 1997).
        assert!(variance(Design::Sobol, n) < truth / n as f64 / 10.0);
    }
    // From 64 to 1024 points: n^−3 log n makes 4096 · 6/10 = 2458, Monte Carlo 16. The bound allows for
    // the estimates' own scatter: a ratio of two variances of 255 degrees of freedom is within
    // exp(4.75 · √(4/255)) = 1.8 at the level 1e-6.
    let gain = variance(Design::Sobol, 64) / variance(Design::Sobol, 1024);
    assert!(gain > 2458.0 / 1.8, "Sobol': {gain}");
    // Halton, at least n^−2: 256.
    let gain = variance(Design::Halton, 64) / variance(Design::Halton, 1024);
    assert!(gain > 256.0 / 1.8, "Halton: {gain}");
}

#[test]
fn analytic_replicates_are_uncorrelated() {
    let truth = (std::f64::consts::E - 1.0).powi(2);
    for design in [Design::Sobol, Design::Halton, Design::LatinHypercube] {
        for lag in [1, 2, 16] {
            let (mut products, mut squares, mut terms) = (0.0, 0.0, 0.0);
            for seed in 0..20 {
                let errors: Vec<f64> = estimates(design, 2, 16, seed)
                    .iter()
                    .map(|estimate| estimate - truth)
                    .collect();
                for (a, b) in errors.iter().zip(&errors[lag..]) {
                    products += a * b;
                    squares += (a * b).powi(2);
                    terms += 1.0;
                }
            }
            // Products of independent errors: mean 0, uncorrelated, their variance as observed.
            let z = products / squares.sqrt();
            assert!(terms > 4000.0 && z.abs() < bounds::NORMAL, "{design:?}, lag {lag}: {z}");
        }
    }
}

#[test]
fn analytic_coordinates_are_scrambled_independently() {
    // One point of each replicate: coordinates independent and uniform across replicates.
    for design in [Design::Sobol, Design::Halton, Design::LatinHypercube] {
        let mut counts = [0u64; 64];
        for seed in 0..20 {
            let table = replicated(design, 3, 2, REPLICATES, seed);
            for r in 0..REPLICATES {
                let digit = |j: usize| interval(table.get(r, j), 4);
                counts[digit(0) * 16 + digit(1) * 4 + digit(2)] += 1;
            }
        }
        bounds::assert_uniform(&counts, &format!("{design:?}"));
    }
}
