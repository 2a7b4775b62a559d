//! Inversion of a tail probability in logarithmic space.

use crate::numerics::elementary::{exp, exp_m1, ln, ln_1p};

/// A tail probability at a point, with what a third-order step needs.
pub(super) struct Tail {
    /// The tail probability F(x).
    pub value: f64,
    /// x f(x) with the sign of F's slope, f the density.
    pub weight: f64,
    /// d ln(x f(x))/d ln x.
    pub bend: f64,
}

/// The x > 0 at which `tail` takes the value `target`, `increasing` or decreasing in x.
///
/// Halley's steps for ln F against ln x, which is nearly straight far out in either tail, inside a
/// bracket that starts as (`low`, `high`) and only shrinks; a step that leaves it becomes a bisection.
pub(super) fn solve(
    target: f64,
    start: f64,
    (mut low, mut high): (f64, f64),
    increasing: bool,
    tail: impl Fn(f64) -> Tail,
) -> f64 {
    // A step of more than this in ln x is taken for a sign that the expansion does not hold.
    const LONGEST_STEP: f64 = 6.0;
    let ln_target = ln(target);
    let mut x = start.clamp(low.max(f64::MIN_POSITIVE), high.min(f64::MAX));
    for round in 0..400 {
        let at = tail(x);
        if at.value.is_nan() {
            return f64::NAN;
        }
        if (at.value < target) == increasing {
            low = x;
        } else {
            high = x;
        }
        let residual = if (at.value / target - 1.0).abs() < 0.5 {
            ln_1p((at.value - target) / target)
        } else {
            ln(at.value) - ln_target
        };
        let slope = at.weight / at.value;
        let curvature = at.bend - slope;
        let newton = -residual / slope;
        let mut step = newton / (1.0 + (0.5 * newton * curvature).clamp(-0.5, 1.0));
        let far = step.is_nan() || step.abs() > LONGEST_STEP;
        if far {
            step =
                LONGEST_STEP.copysign(if (at.value < target) == increasing { 1.0 } else { -1.0 });
        }
        let mut next = x + x * exp_m1(step);
        let bracketed = low > 0.0 && high.is_finite();
        let inside = next >= low && next <= high && !(far && bracketed) && round % 16 != 15;
        if !inside {
            next = if bracketed {
                low.sqrt() * high.sqrt()
            } else if low > 0.0 {
                x + x * exp_m1(LONGEST_STEP)
            } else {
                x * exp(-LONGEST_STEP)
            };
        }
        // After a step s the error of a third-order method is about K² s³, K the relative curvature.
        let bend = step * curvature.abs().max(1.0);
        let error = step.abs() * bend * bend;
        if next == x || high == low || (inside && error < 1e-17) {
            return next;
        }
        x = next;
    }
    x
}
