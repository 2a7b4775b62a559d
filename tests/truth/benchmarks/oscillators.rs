//! Two oscillators: the standard cases against trusting FORM alone.

use super::laws::lognormal;
use super::{Benchmark, component};
use reeldown::numerics::elementary::sin;
use std::f64::consts::PI;

/// The problems of this file. References by randomised quasi-Monte Carlo of a conditional integrand.
pub fn all() -> Vec<Benchmark> {
    vec![
        // FORM 2.19e-2: 4.6 times too high.
        component("DAMPED_15_0", 8, |z, m| m.push(damped(z, 15.0)), 0.00477401459861939, 3.8e-4),
        // FORM 3.91e-6: 10.3 times too high.
        component("DAMPED_27_5", 8, |z, m| m.push(damped(z, 27.5)), 3.7843170600712966e-7, 8e-5),
        component(
            "UNDAMPED_1_0",
            6,
            |z, m| m.push(undamped(z, 1.0, 0.2)),
            0.028595552331942383,
            1.3e-5,
        ),
        component(
            "UNDAMPED_0_45",
            6,
            |z, m| m.push(undamped(z, 0.45, 0.075)),
            1.51444123507608e-8,
            1.8e-6,
        ),
    ]
}

/// Two degrees of freedom under white noise; lognormal masses, stiffnesses, dampings, intensity, strength.
fn damped(z: &[f64], strength: f64) -> f64 {
    let mean = [1.5, 0.01, 1.0, 0.01, 0.05, 0.02, 100.0, strength];
    let variation = [0.1, 0.1, 0.2, 0.2, 0.4, 0.5, 0.1, 0.1];
    let x: Vec<f64> = (0..8).map(|j| lognormal(mean[j], variation[j], z[j])).collect();
    let (mp, ms, kp, ks, zp, zs, s0, fs) = (x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]);
    let (wp, ws) = ((kp / mp).sqrt(), (ks / ms).sqrt());
    let (wa, za) = ((wp + ws) / 2.0, (zp + zs) / 2.0);
    let (gm, th) = (ms / mp, (wp - ws) / wa);
    let power = PI * s0 / (4.0 * zs * ws * ws * ws) * za * zs
        / (zp * zs * (4.0 * za * za + th * th) + gm * za * za)
        * (zp * wp * wp * wp + zs * ws * ws * ws)
        * wp
        / (4.0 * za * wa * wa * wa * wa);
    fs - 3.0 * ks * power.sqrt()
}

/// One degree of freedom under a rectangular pulse; normal variables.
fn undamped(z: &[f64], force_mean: f64, force_sd: f64) -> f64 {
    let (m, c1, c2) = (1.0 + 0.05 * z[0], 1.0 + 0.1 * z[1], 0.1 + 0.01 * z[2]);
    let (r, t1) = (0.5 + 0.05 * z[3], 1.0 + 0.2 * z[5]);
    let force = force_mean + force_sd * z[4];
    3.0 * r - (2.0 * force / (c1 + c2) * sin(((c1 + c2) / m).sqrt() * t1 / 2.0)).abs()
}
