//! The worth of a further measurement where it is known in closed form.

use nalgebra::DMatrix;
use reeldown::calibration::narrowing::Dependence;
use reeldown::streams::{Purpose, standard_normal, stream};

/// 4000 draws of two independent standard normal parameters, and a quantity linear in them.
fn draws() -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut stream = stream(3, Purpose::Test, 9);
    let draws: Vec<Vec<f64>> = (0..4000)
        .map(|_| vec![standard_normal(&mut stream), standard_normal(&mut stream)])
        .collect();
    let quantity = draws.iter().map(|z| 3.0 * z[0] + 4.0 * z[1] + 1.0).collect();
    (draws, quantity)
}

#[test]
fn analytic_measuring_one_of_two_parameters_leaves_the_other() {
    let (draws, quantity) = draws();
    let dependence = Dependence::new(&draws, &quantity, 0.0).expect("a dependence");
    // Five standard errors of a standard deviation from 4000 draws: 5/√8000 = 5.6 %.
    assert!((dependence.sd() / 5.0 - 1.0).abs() < 0.056);
    // The first parameter measured with error one: its variance halves, 9/2 + 16.
    let mut information = DMatrix::zeros(2, 2);
    information[(0, 0)] = 1.0;
    let after = dependence.sd_after(&information).expect("a number");
    assert!((after / 20.5_f64.sqrt() - 1.0).abs() < 0.056, "{after}");
    // Both measured perfectly: nothing is left.
    let perfect = DMatrix::identity(2, 2) * 1e12;
    assert!(dependence.sd_after(&perfect).expect("a number") < 1e-3);
    // Nothing measured: nothing changes.
    let nothing = DMatrix::zeros(2, 2);
    let same = dependence.sd_after(&nothing).expect("a number");
    assert!((same - dependence.sd()).abs() < 1e-9);
}

#[test]
fn property_too_few_draws_are_refused() {
    let (draws, quantity) = draws();
    assert!(Dependence::new(&draws[..5], &quantity[..5], 0.0).is_err());
}
