//! The pieces of a saddle-point form of the gamma and beta densities.
//!
//! After C. Loader, *Fast and Accurate Computation of Binomial Probabilities* (2000): with Stirling's
//! error and the deviance apart, a density at shapes of 1e7 keeps its digits, where the difference of
//! logarithms of gamma functions would lose eight of them.

use super::kernels::descending;
use crate::numerics::elementary::{ln, ln_1p};

/// 2/(2k + 3) for k = 15 … 0.
const SERIES: [f64; 16] = [
    2.0 / 33.0,
    2.0 / 31.0,
    2.0 / 29.0,
    2.0 / 27.0,
    2.0 / 25.0,
    2.0 / 23.0,
    2.0 / 21.0,
    2.0 / 19.0,
    2.0 / 17.0,
    2.0 / 15.0,
    2.0 / 13.0,
    2.0 / 11.0,
    2.0 / 9.0,
    2.0 / 7.0,
    2.0 / 5.0,
    2.0 / 3.0,
];

/// ln(1 + `u`) − `u`, accurate near zero, for `u` > −1.
pub(super) fn ln_1p_minus(u: f64) -> f64 {
    if u > -0.4 && u < 0.6 {
        // ln(1 + u) = 2 artanh s with s = u/(2 + u), and 2s − u = −s u.
        let s = u / (2.0 + u);
        let square = s * s;
        s * (square * descending(&SERIES, square) - u)
    } else {
        ln_1p(u) - u
    }
}

/// ln(`ratio`) − (`ratio` − 1), where the caller knows both `ratio` and `excess` = `ratio` − 1 without
/// cancellation.
pub(super) fn ln_ratio_minus(ratio: f64, excess: f64) -> f64 {
    if excess > -0.4 { ln_1p_minus(excess) } else { ln(ratio) - excess }
}

/// Stirling's error ln Γ(a) − [(a − ½) ln a − a + ½ ln 2π] for `a` ≥ 1, to an absolute 1e-15.
pub(super) fn stirling_error(a: f64) -> f64 {
    // The coefficients B(2k)/(2k (2k − 1)) of the asymptotic series, from k = 1.
    const SERIES: [f64; 8] = [
        -3617.0 / 122_400.0,
        1.0 / 156.0,
        -691.0 / 360_360.0,
        1.0 / 1_188.0,
        -1.0 / 1_680.0,
        1.0 / 1_260.0,
        -1.0 / 360.0,
        1.0 / 12.0,
    ];
    let mut shifted = a;
    let mut sum = 0.0;
    // The first term left out is below 1e-17 from 13 on.
    while shifted < 13.0 {
        // error(a) − error(a + 1) = (a + ½) ln(1 + 1/a) − 1
        //                         = ½ /a + (a + ½) (ln(1 + 1/a) − 1/a).
        let inverse = 1.0 / shifted;
        sum += 0.5 * inverse + (shifted + 0.5) * ln_1p_minus(inverse);
        shifted += 1.0;
    }
    let inverse = 1.0 / shifted;
    sum + inverse * descending(&SERIES, inverse * inverse)
}
