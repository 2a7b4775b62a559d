//! Rows of a joint sample among other inputs.

use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::sampling::{Design, Sampler};
use reeldown::streams::Purpose;
use reeldown::uncertainty::{Copula, Joint, JointSample, Law, Marginal, Measure, Statement};
use std::collections::BTreeMap;

const ROWS: usize = 200;

/// Rows on a noisy line, the second falling where the first rises.
fn columns() -> [Vec<f64>; 2] {
    let x: Vec<f64> = (0..ROWS).map(|k| ((k * 73) % ROWS) as f64).collect();
    let y = x.iter().enumerate().map(|(k, x)| -2.0 * x + ((k * 31) % 17) as f64).collect();
    [x, y]
}

/// A normal input, two inputs drawn together about another normal one.
fn joint(copula: bool) -> Joint {
    let [x, y] = columns();
    let empirical =
        |values: &[f64]| Marginal::untruncated(Law::empirical(values.to_vec(), None).unwrap());
    let standard = Marginal::untruncated(Law::normal(0.0, 1.0).unwrap());
    let marginals = vec![standard.clone(), empirical(&x), standard, empirical(&y)];
    let sample = JointSample::new(vec![1, 3], &[x, y]).unwrap();
    let statement = Statement { first: 0, second: 2, measure: Measure::Normal(0.5) };
    let copula = copula.then(|| Copula::new(4, &[statement]).unwrap());
    Joint::new(marginals, copula).unwrap().with_samples(vec![sample]).unwrap()
}

fn points(design: Design, rows: usize) -> Columns {
    let sampler = Sampler::new(design, 4, rows as u64, 1, 7, Purpose::Test).unwrap();
    let mut u = Columns::new(rows, 4);
    sampler.fill(0, &mut u).unwrap();
    u
}

#[test]
fn property_rows_stay_whole_and_come_equally_often() {
    let [x, y] = columns();
    let pair: BTreeMap<u64, f64> = x.iter().zip(&y).map(|(x, y)| (x.to_bits(), *y)).collect();
    for copula in [false, true] {
        // A Latin hypercube of three points a row: every row comes three times exactly.
        let u = points(Design::LatinHypercube, 3 * ROWS);
        let mut draws = Columns::default();
        joint(copula).from_uniform(&u, &mut draws);
        let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
        for k in 0..draws.rows() {
            let x = draws.get(k, 1);
            assert_eq!(pair[&x.to_bits()], draws.get(k, 3));
            *counts.entry(x.to_bits()).or_default() += 1;
        }
        assert_eq!(counts.len(), ROWS);
        assert!(counts.values().all(|count| *count == 3));
    }
}

#[test]
fn property_the_other_inputs_are_what_they_were() {
    let u = points(Design::MonteCarlo, 64);
    for copula in [false, true] {
        let with = joint(copula);
        let without = Joint::new(with.marginals().to_vec(), with.copula().cloned()).unwrap();
        let (mut a, mut b) = (Columns::default(), Columns::default());
        with.from_uniform(&u, &mut a);
        without.from_uniform(&u, &mut b);
        assert_eq!((a.column(0), a.column(2)), (b.column(0), b.column(2)));
    }
}

#[test]
fn property_uniform_and_normal_points_pick_the_same_rows() {
    let u = points(Design::MonteCarlo, 500);
    let mut z = Columns::new(500, 4);
    for j in 0..4 {
        normal::quantile_column(u.column(j), z.column_mut(j));
    }
    let joint = joint(false);
    let (mut a, mut b) = (Columns::default(), Columns::default());
    joint.from_uniform(&u, &mut a);
    joint.from_standard_normal(&z, &mut b);
    assert_eq!(a.column(1), b.column(1));
    assert_eq!(a.column(3), b.column(3));
    // And back: the middle of a row's part of the axis picks the row.
    for k in 0..20 {
        let back = joint.to_standard_normal(&a.row(k));
        let mut again = Columns::default();
        joint.from_standard_normal(&Columns::from_rows(&[&back]), &mut again);
        assert_eq!((again.get(0, 1), again.get(0, 3)), (a.get(k, 1), a.get(k, 3)));
        assert_eq!(back[3], 0.0, "the coordinate of the second is not read");
    }
}

#[test]
fn analytic_the_coordinate_runs_along_the_line() {
    // The rows lie about y = −2x with noise of 5 against a range of 400: along the first principal
    // component the rank correlation with x is nearly one. Sign: the loading of largest size is positive;
    // whichever it is, the order is monotone.
    let sample = JointSample::new(vec![0, 1], &columns()).unwrap();
    let x = sample.rows().column(0);
    let rising = x.windows(2).filter(|pair| pair[1] > pair[0]).count();
    assert!(!(20..=180).contains(&rising), "{rising}");
}

#[test]
fn property_what_cannot_be_joined_is_refused() {
    let joint = joint(true);
    let sample = |inputs: Vec<usize>| JointSample::new(inputs, &columns()).unwrap();
    let plain = || Joint::new(joint.marginals().to_vec(), joint.copula().cloned()).unwrap();
    assert!(plain().with_samples(vec![sample(vec![1, 3])]).is_ok());
    assert!(plain().with_samples(vec![sample(vec![1, 4])]).is_err(), "no such input");
    assert!(plain().with_samples(vec![sample(vec![1, 2])]).is_err(), "correlated");
    assert!(plain().with_samples(vec![sample(vec![1, 3]), sample(vec![1, 3])]).is_err(), "twice");
}
