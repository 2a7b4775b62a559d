//! Latin hypercube: stratified in every coordinate, its permutations fair.

use reeldown::numerics::columns::Columns;
use reeldown::sampling::{Design, Sampler};
use reeldown::streams::Purpose;

use crate::bounds;

const REPLICATES: u32 = 256;

/// `REPLICATES` hypercubes of `n` points in `dimension` coordinates.
fn hypercubes(n: u64, dimension: usize, seed: u64) -> Columns {
    let samples = n * u64::from(REPLICATES);
    let design = Design::LatinHypercube;
    let sampler =
        Sampler::new(design, dimension, samples, REPLICATES, seed, Purpose::Test).unwrap();
    let mut out = Columns::new(samples as usize, dimension);
    sampler.fill(0, &mut out).unwrap();
    out
}

/// The exact slice of `u` among `n`.
fn slice(u: f64, n: u64) -> usize {
    (((u * 2f64.powi(53)) as u128 * u128::from(n)) >> 53) as usize
}

/// Slices of coordinate `j` of replicate `r`, point by point.
fn slices(table: &Columns, n: u64, j: usize, r: usize) -> Vec<usize> {
    table.column(j)[r..].iter().step_by(REPLICATES as usize).map(|&u| slice(u, n)).collect()
}

#[test]
fn property_every_slice_of_every_coordinate_holds_exactly_one_point() {
    for n in [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 100, 255, 257, 1000] {
        let table = hypercubes(n, 3, n);
        for j in 0..3 {
            for r in 0..REPLICATES as usize {
                let mut found = slices(&table, n, j, r);
                found.sort_unstable();
                assert!(
                    found.into_iter().eq(0..n as usize),
                    "n = {n}, coordinate {j}, replicate {r}"
                );
            }
        }
    }
}

#[test]
fn analytic_all_permutations_of_five_are_equally_frequent() {
    let mut counts = [0u64; 120];
    for seed in 0..40 {
        let table = hypercubes(5, 8, seed);
        for j in 0..8 {
            for r in 0..REPLICATES as usize {
                counts[lehmer(&slices(&table, 5, j, r))] += 1;
            }
        }
    }
    bounds::assert_uniform(&counts, "permutations of 5");
}

/// The rank of a permutation among all of its length.
fn lehmer(permutation: &[usize]) -> usize {
    let smaller_after = |i: usize| permutation[i..].iter().filter(|&&x| x < permutation[i]).count();
    (0..permutation.len()).fold(0, |rank, i| rank * (permutation.len() - i) + smaller_after(i))
}

#[test]
fn analytic_each_point_is_in_each_slice_equally_often() {
    let n = 23;
    let mut counts = vec![[0u64; 23]; 23];
    for seed in 0..4 {
        let table = hypercubes(n, 8, seed);
        for j in 0..8 {
            for r in 0..REPLICATES as usize {
                for (point, slice) in slices(&table, n, j, r).into_iter().enumerate() {
                    counts[point][slice] += 1;
                }
            }
        }
    }
    for (point, counts) in counts.iter().enumerate() {
        bounds::assert_uniform(counts, &format!("point {point}"));
    }
}

#[test]
fn analytic_coordinates_and_neighbours_are_as_uncorrelated_as_random_permutations() {
    for n in [37u64, 64, 500] {
        let table = hypercubes(n, 6, 11 + n);
        let m = n as f64;
        let centred = |slices: Vec<usize>| -> Vec<f64> {
            slices
                .into_iter()
                .map(|s| (s as f64 - (m - 1.0) / 2.0) * (12.0 / (m * m - 1.0)).sqrt())
                .collect()
        };
        let (mut between, mut neighbours, mut with_order) = (0.0, 0.0, 0.0);
        let replicates = REPLICATES as usize;
        for r in 0..replicates {
            let all: Vec<Vec<f64>> = (0..6).map(|j| centred(slices(&table, n, j, r))).collect();
            let order = centred((0..n as usize).collect());
            for a in 0..6 {
                let product =
                    |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>() / m;
                for b in 0..a {
                    // Spearman's correlation of random permutations: mean 0, variance 1/(n − 1).
                    between += (m - 1.0) * product(&all[a], &all[b]).powi(2);
                }
                with_order += (m - 1.0) * product(&all[a], &order).powi(2);
                neighbours += product(&all[a][..n as usize - 1], &all[a][1..]) + 1.0 / m;
            }
        }
        let (low, high) = bounds::chi_squared((15 * replicates) as f64);
        assert!(
            between > low && between < high,
            "n = {n}, coordinates: {between} in {low}..{high}"
        );
        let (low, high) = bounds::chi_squared((6 * replicates) as f64);
        assert!(
            with_order > low && with_order < high,
            "n = {n}, order: {with_order} in {low}..{high}"
        );
        // Neighbours' products sum to −1/m in the mean; their scatter is 1/m to leading order.
        let z = neighbours / (6.0 * replicates as f64 / m).sqrt();
        assert!(z.abs() < bounds::NORMAL, "n = {n}, neighbours: {z}");
    }
}

#[test]
fn analytic_the_mean_of_a_coordinate_has_the_variance_of_jittered_slices() {
    for n in [4u64, 50, 333] {
        let table = hypercubes(n, 8, 100 + n);
        for j in 0..8 {
            let means: Vec<f64> = (0..REPLICATES as usize)
                .map(|r| {
                    let own = table.column(j)[r..].iter().step_by(REPLICATES as usize);
                    own.sum::<f64>() / n as f64
                })
                .collect();
            // n independent uniforms of width 1/n: variance 1/(12 n³).
            let (mean, variance) = bounds::moments(&means);
            let truth = 1.0 / (12.0 * (n as f64).powi(3));
            let df = f64::from(REPLICATES) - 1.0;
            let (low, high) = bounds::chi_squared(df);
            assert!(
                variance * df / truth > low && variance * df / truth < high,
                "n = {n}: {variance}"
            );
            assert!((mean - 0.5).abs() < bounds::NORMAL * (truth / f64::from(REPLICATES)).sqrt());
        }
    }
}

#[test]
fn analytic_places_within_slices_are_uniform() {
    let n = 100;
    let table = hypercubes(n, 4, 5);
    for j in 0..4 {
        let mut counts = [0u64; 64];
        for &u in table.column(j) {
            counts[((u * n as f64).fract() * 64.0) as usize] += 1;
        }
        bounds::assert_uniform(&counts, "places");
    }
}
