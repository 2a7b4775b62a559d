//! The lanes' `exp` and `ln` against arithmetic in twice the precision.
//!
//! The truth here is a sum of two `f64` (106 bits) built from exact products and sums: more than enough to
//! tell an error of one unit in the last place to 1e-6 of it.

use reeldown::numerics::lanes::elementary::{exp, ln};

/// An unevaluated sum of two numbers.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn sum(a: f64, b: f64) -> Double {
        let s = a + b;
        let shadow = s - a;
        Double(s, (a - (s - shadow)) + (b - shadow))
    }
    fn plus(self, other: Double) -> Double {
        let high = Double::sum(self.0, other.0);
        let low = Double::sum(self.1, other.1);
        let first = Double::sum(high.0, high.1 + low.0);
        Double::sum(first.0, first.1 + low.1)
    }
    fn times(self, other: Double) -> Double {
        let product = self.0 * other.0;
        let error = self.0.mul_add(other.0, -product);
        Double::sum(product, error + (self.0 * other.1 + self.1 * other.0))
    }
    fn over(self, divisor: f64) -> Double {
        let first = self.0 / divisor;
        let rest = (-first).mul_add(divisor, self.0) + self.1;
        Double::sum(first, rest / divisor)
    }
}

/// ln 2 to 106 bits (mpmath, 50 digits).
const LN_2: Double = Double(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

/// `eˣ/2^k` and `k`: Taylor's series after halving the reduced argument eight times.
fn exp_double(x: f64) -> (Double, i32) {
    let k = (x / LN_2.0).round();
    let high = k * LN_2.0;
    let error = k.mul_add(LN_2.0, -high);
    let reduced = Double::sum(x, -high).plus(Double(-error - k * LN_2.1, 0.0));
    let r = Double(reduced.0 / 256.0, reduced.1 / 256.0);
    // e^r − 1 to keep the digits through the squarings: (1 + a)² − 1 = a (2 + a).
    let mut term = r;
    let mut sum = r;
    for n in 2..=12 {
        term = term.times(r).over(f64::from(n));
        sum = sum.plus(term);
    }
    for _ in 0..8 {
        sum = sum.times(sum.plus(Double(2.0, 0.0)));
    }
    (sum.plus(Double(1.0, 0.0)), k as i32)
}

/// Distance in units in the last place of the truth's leading part.
fn ulps(got: f64, truth: Double) -> f64 {
    let unit = truth.0.abs().next_up() - truth.0.abs();
    ((got - truth.0) - truth.1).abs() / unit
}

fn exp_error(x: f64) -> f64 {
    let (truth, k) = exp_double(x);
    // Back from the binade, exactly; the truth is not scaled up, as its second part would underflow.
    ulps(exp(x) * f64::from_bits(((1023 - k) as u64) << 52), truth)
}

/// One step of Newton's method in twice the precision from the platform's value: quadratic, so its error
/// is some 1e-31 relative to 1.
fn ln_error(x: f64) -> f64 {
    let y = x.ln();
    let (power, k) = exp_double(y);
    // x e^{−y} − 1 = (x 2^−k)/power − 1
    let scaled = x * f64::from_bits(((1023 - k) as u64) << 52);
    let difference = Double(scaled, 0.0).plus(Double(-power.0, -power.1));
    let correction = difference.over(power.0);
    // ln(1 + c) = c − c²/2 with c ≈ 1e-16
    ulps(ln(x), Double::sum(y, correction.0 - 0.5 * correction.0 * correction.0))
}

#[test]
fn analytic_exp_is_within_one_ulp_over_its_whole_range() {
    // Four million points evenly over the reduced argument's interval and beyond, and over all binades.
    let mut worst: f64 = 0.0;
    for k in 0..2_000_000 {
        let share = (k as f64 + 0.382) / 2_000_000.0;
        worst = worst.max(exp_error(-1.5 + 3.0 * share));
        worst = worst.max(exp_error(-708.0 + 1416.0 * share));
    }
    // Around the ends of the reduction, where neighbouring polynomials meet.
    for k in -1021..1021 {
        let edge = (f64::from(k) + 0.5) * LN_2.0;
        let (mut down, mut up) = (edge, edge);
        for _ in 0..20 {
            down = down.next_down();
            up = up.next_up();
            worst = worst.max(exp_error(down)).max(exp_error(up));
        }
    }
    println!("exp: worst error {worst:.4} ulp");
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn analytic_exp_at_the_edges() {
    assert_eq!(exp(0.0), 1.0);
    assert_eq!(exp(-0.0), 1.0);
    assert_eq!(exp(1e300), exp(708.0));
    assert_eq!(exp(f64::NEG_INFINITY), exp(-708.0));
    assert!(exp(f64::NAN).is_nan());
}

#[test]
fn analytic_ln_is_within_one_ulp() {
    let mut worst: f64 = 0.0;
    for k in 0..2_000_000 {
        let share = (k as f64 + 0.618) / 2_000_000.0;
        worst = worst.max(ln_error(0.5 + 1.5 * share));
        worst = worst.max(ln_error(reeldown::numerics::elementary::exp(-690.0 + 1390.0 * share)));
    }
    // Around one, where the result is small, and around the ends of the mantissa's range.
    for centre in [1.0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::SQRT_2, 2.0] {
        let (mut down, mut up): (f64, f64) = (centre, centre);
        for _ in 0..1000 {
            down = down.next_down();
            up = up.next_up();
            worst = worst.max(ln_error(down)).max(ln_error(up));
        }
    }
    println!("ln: worst error {worst:.4} ulp");
    assert!(worst <= 1.0, "{worst}");
    assert_eq!(ln(1.0), 0.0);
}
