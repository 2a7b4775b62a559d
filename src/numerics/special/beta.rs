//! The beta distribution: regularised incomplete beta functions and their inverses.

use super::deviance::{ln_1p_minus, ln_ratio_minus, stirling_error};
use super::gamma::{ln_gamma, ln_gamma_1p};
use super::inversion::{Tail, solve};
use super::normal;
use super::quadrature::integral;
use crate::numerics::elementary::{exp, ln, ln_1p};

/// 1/√(2π).
const INVERSE_ROOT_TWO_PI: f64 = 0.398_942_280_401_432_7;
/// From these shapes on (both) the tail is integrated, since the fraction needs some 2 √min(a, b) terms.
const LARGE_SHAPES: f64 = 1000.0;

/// What does not depend on x: the shapes and their constants.
struct Shapes {
    a: f64,
    b: f64,
    /// a + b in two parts.
    n: f64,
    n_rest: f64,
    /// The constant of the prefix: of the saddle-point form where both shapes are at least one, else −ln B(a, b).
    constant: f64,
}

impl Shapes {
    fn new(a: f64, b: f64) -> Self {
        let n = a + b;
        let (large, small) = if a > b { (a, b) } else { (b, a) };
        let n_rest = small - (n - large);
        let constant = if small >= 1.0 {
            stirling_error(n) - stirling_error(a) - stirling_error(b)
                + 0.5 * ln(a / n * b)
                + ln(INVERSE_ROOT_TWO_PI)
        } else {
            -ln_beta(a, b)
        };
        Shapes { a, b, n, n_rest, constant }
    }

    /// n x − a without cancellation.
    fn excess(&self, x: f64) -> f64 {
        self.n.mul_add(x, -self.a) + self.n_rest * x
    }

    /// ln(x^a (1 − x)^b/B(a, b)) for x ≤ ½.
    fn ln_prefix(&self, x: f64) -> f64 {
        let (a, b) = (self.a, self.b);
        if a >= 1.0 && b >= 1.0 {
            let excess = self.excess(x);
            a * ln_ratio_minus((self.n / a) * x, excess / a)
                + b * ln_1p_minus_far((1.0 - x) * (self.n / b), -excess / b)
                + self.constant
        } else {
            a * ln(x) + b * ln_1p(-x) + self.constant
        }
    }

    /// (I, 1 − I) at x ≤ ½.
    fn tails(&self, x: f64) -> (f64, f64) {
        if x <= 0.0 {
            return (0.0, 1.0);
        }
        let (a, b) = (self.a, self.b);
        let prefix = exp(self.ln_prefix(x));
        let y = 1.0 - x;
        let excess = self.excess(x);
        if a >= LARGE_SHAPES && b >= LARGE_SHAPES {
            let tail = self.integrated_tail(x, prefix);
            if excess < 0.0 { (tail, 1.0 - tail) } else { (1.0 - tail, tail) }
        } else if x <= (a + 1.0) / (self.n + 2.0) {
            let lower = prefix / fraction(a, b, x, y, -excess);
            (lower, 1.0 - lower)
        } else {
            let upper = prefix / fraction(b, a, y, x, excess);
            (1.0 - upper, upper)
        }
    }

    /// The tail beyond `x` away from the mean, from the density at `x` and its fall.
    fn integrated_tail(&self, x: f64, prefix: f64) -> f64 {
        let y = 1.0 - x;
        let (p, q) = (self.a - 1.0, self.b - 1.0);
        // The density at x + t is the one at x times exp(p g(t/x) + q g(−t/y) + slope t), g(u) = ln(1 + u) − u.
        let slope = (2.0f64.mul_add(x, -1.0) - self.excess(x)) / (x * y);
        let fall = |t: f64| exp(p * ln_1p_minus(t / x) + q * ln_1p_minus(-t / y) + slope * t);
        const FALL: f64 = 60.0;
        let curvature = p / (x * x) + q / (y * y);
        let reach = 2.0 * FALL / (slope.abs() + (slope * slope + 2.0 * FALL * curvature).sqrt());
        let (from, to) =
            if self.excess(x) < 0.0 { (-reach.min(x), 0.0) } else { (0.0, reach.min(y)) };
        prefix / (x * y) * integral(from, to, fall)
    }
}

/// [`ln_ratio_minus`], under the name of its second use.
fn ln_1p_minus_far(ratio: f64, excess: f64) -> f64 {
    ln_ratio_minus(ratio, excess)
}

/// ln B(a, b), a, b > 0.
pub fn ln_beta(a: f64, b: f64) -> f64 {
    let (large, small) = if a > b { (a, b) } else { (b, a) };
    let n = a + b;
    if small >= 1.0 {
        let ratio = small / n;
        // The saddle-point form again, at the mean, where the deviance is zero.
        small * ln(ratio) + large * ln_1p(-ratio) - 0.5 * ln(small / n * large)
            + stirling_error(small)
            + stirling_error(large)
            - stirling_error(n)
            - ln(INVERSE_ROOT_TWO_PI)
    } else {
        let ln_gamma_small = ln_gamma_1p(small) - ln(small);
        if large < 10.0 {
            return ln_gamma_small + (ln_gamma(large) - ln_gamma(n));
        }
        // ln Γ(large + small) − ln Γ(large) by Stirling's series, without the difference of its leading terms.
        let growth = small * ln(large) + (n - 0.5) * ln_1p(small / large) - small
            + stirling_error(n)
            - stirling_error(large);
        ln_gamma_small - growth
    }
}

/// The continued fraction F of I = x^a y^b/(B(a, b) F), `slack` = a − (a + b) x, by Lentz' method.
///
/// A. DiDonato and A. Morris, *Algorithm 708* (ACM TOMS 18, 1992), their second form: through the
/// slack it does not mind that y is rounded.
fn fraction(a: f64, b: f64, x: f64, y: f64, slack: f64) -> f64 {
    let term = |m: f64| {
        let twice = a + 2.0 * m;
        m + m * (b - m) * x / (twice - 1.0)
            + (a + m) * (slack + 1.0 + m * (1.0 + y)) / (twice + 1.0)
    };
    const TINY: f64 = 1e-300;
    let mut value = a * (slack + 1.0) / (a + 1.0);
    if value == 0.0 {
        value = TINY;
    }
    let mut c = value;
    let mut d = 0.0;
    for k in 1..100_000 {
        let m = f64::from(k);
        let twice = a + 2.0 * m - 1.0;
        let numerator =
            ((a + m - 1.0) / twice) * ((a + b + m - 1.0) * x / twice) * (m * (b - m) * x);
        if numerator == 0.0 {
            break;
        }
        let denominator = term(m);
        d = denominator + numerator * d;
        if d == 0.0 {
            d = TINY;
        }
        d = 1.0 / d;
        c = denominator + numerator / c;
        if c == 0.0 {
            c = TINY;
        }
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() < 2e-16 {
            break;
        }
    }
    value
}

/// Whether the shapes are usable.
fn valid(a: f64, b: f64) -> bool {
    a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite()
}

/// (I, 1 − I) at `x` of [0, 1].
fn tails(a: f64, b: f64, x: f64) -> (f64, f64) {
    if !valid(a, b) || x.is_nan() {
        (f64::NAN, f64::NAN)
    } else if x <= 0.0 {
        (0.0, 1.0)
    } else if x >= 1.0 {
        (1.0, 0.0)
    } else if x <= 0.5 {
        Shapes::new(a, b).tails(x)
    } else {
        let (upper, lower) = Shapes::new(b, a).tails(1.0 - x);
        (lower, upper)
    }
}

/// I_x(a, b): the lower tail at `x` of the beta law with shapes `a`, `b` > 0.
pub fn regularized(a: f64, b: f64, x: f64) -> f64 {
    tails(a, b, x).0
}

/// 1 − I_x(a, b): the upper tail.
pub fn regularized_upper(a: f64, b: f64, x: f64) -> f64 {
    tails(a, b, x).1
}

/// (I, 1 − I) at a point given by the smaller of x and 1 − x: `small` ≤ ½, and which of them it is.
pub(crate) fn tails_at(a: f64, b: f64, small: f64, is_complement: bool) -> (f64, f64) {
    if !valid(a, b) {
        (f64::NAN, f64::NAN)
    } else if is_complement {
        let (upper, lower) = Shapes::new(b, a).tails(small);
        (lower, upper)
    } else {
        Shapes::new(a, b).tails(small)
    }
}

/// ln of the beta density at `x`.
pub fn ln_density(a: f64, b: f64, x: f64) -> f64 {
    if !(x > 0.0 && x < 1.0) {
        let edge = |shape: f64| {
            if shape == 1.0 {
                -ln_beta(a, b)
            } else if shape < 1.0 {
                f64::INFINITY
            } else {
                f64::NEG_INFINITY
            }
        };
        return if x == 0.0 {
            edge(a)
        } else if x == 1.0 {
            edge(b)
        } else {
            f64::NEG_INFINITY
        };
    }
    let prefix = if x <= 0.5 {
        Shapes::new(a, b).ln_prefix(x)
    } else {
        Shapes::new(b, a).ln_prefix(1.0 - x)
    };
    prefix - ln(x) - ln_1p(-x)
}

/// The x whose lower tail I_x(a, b) is `p`.
pub fn quantile_lower(a: f64, b: f64, p: f64) -> f64 {
    quantile_pair(a, b, p, true).0
}

/// The x whose upper tail 1 − I_x(a, b) is `q`.
pub fn quantile_upper(a: f64, b: f64, q: f64) -> f64 {
    quantile_pair(a, b, q, false).0
}

/// (x, 1 − x), both accurate, for the x whose lower or upper tail is `p`.
pub fn quantile_pair(a: f64, b: f64, p: f64, lower: bool) -> (f64, f64) {
    if !valid(a, b) || !(0.0..=1.0).contains(&p) {
        return (f64::NAN, f64::NAN);
    }
    // Work with the smaller tail: 1 − p is exact for p ≥ ½.
    let (p, lower) = if p > 0.5 { (1.0 - p, !lower) } else { (p, lower) };
    if p == 0.0 {
        return if lower { (0.0, 1.0) } else { (1.0, 0.0) };
    }
    let shapes = Shapes::new(a, b);
    let (below, above) = shapes.tails(0.5);
    // And with the smaller of x and 1 − x.
    let left = if lower { p <= below } else { p >= above };
    if left {
        let x = invert(&shapes, p, lower);
        (x, 1.0 - x)
    } else {
        let y = invert(&Shapes::new(b, a), p, !lower);
        (1.0 - y, y)
    }
}

/// The x ≤ ½ whose lower or upper tail is `p` ≤ ½.
fn invert(shapes: &Shapes, p: f64, lower: bool) -> f64 {
    let &Shapes { a, b, .. } = shapes;
    // The leading term near zero: I ≈ x^a/(a B(a, b)).
    let below = if lower { p } else { 1.0 - p };
    let near_zero = exp((ln(below) + ln(a) + ln_beta(a, b)) / a);
    if lower && near_zero * b.max(1.0) < 1e-17 {
        return near_zero;
    }
    let start = if a > 1.0 && b > 1.0 {
        // Cochran's approximation as refined by Carter (1947); z is the upper-tail deviate.
        let z = if lower { -normal::quantile(p) } else { normal::quantile(p) };
        let (inverse_a, inverse_b) = (1.0 / (2.0 * a - 1.0), 1.0 / (2.0 * b - 1.0));
        let h = 2.0 / (inverse_a + inverse_b);
        let lambda = (z * z - 3.0) / 6.0;
        let w = z * (lambda + h).max(0.0).sqrt() / h
            - (inverse_b - inverse_a) * (lambda + 5.0 / 6.0 - 2.0 / (3.0 * h));
        let carter = 1.0 / (1.0 + b / a * exp(2.0 * w));
        if lambda + h > 0.0 && carter > 0.0 { carter } else { near_zero }
    } else {
        near_zero
    };
    let sign = if lower { 1.0 } else { -1.0 };
    solve(p, start.min(0.5), (0.0, 0.5), lower, |x| {
        let (below, above) = shapes.tails(x);
        let y = 1.0 - x;
        Tail {
            value: if lower { below } else { above },
            weight: sign * exp(shapes.ln_prefix(x)) / y,
            bend: a - (b - 1.0) * x / y,
        }
    })
}
