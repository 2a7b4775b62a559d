//! The kernels' equations against the physics written once, and their eliminated solves against the
//! Jacobian by differences.

use super::clock::Clock;
use super::constants::Constants;
use super::detailed;
use super::dynamic::Dynamic;
use super::model::Model;
use super::quasi_steady::QuasiSteady;
use super::rosenbrock::System;
use crate::physics::quasi_steady::Pull;
use crate::physics::{Coefficients, Design, GRAVITY, Parameter, Target, motion, quasi_steady};

/// A design with every term at work: offset, air, and thinning if wanted.
fn coefficients(thinning: bool) -> Coefficients<f64> {
    let mut design = Design::baseline();
    let mut set = |parameter, value| design.set(Target::whole(parameter), value);
    set(Parameter::FluidAveragingOffset, 0.21);
    set(Parameter::ThermalAirConductance, 30.0);
    set(Parameter::ThermalAirTemperature, 240.0);
    if thinning {
        set(Parameter::FluidCrossTimeConstant, 0.02);
        set(Parameter::FluidCrossExponent, 0.7);
    }
    Coefficients::new(&design)
}

const CLOCKS: [Clock<f64>; 2] =
    [Clock { length: 0.0, time: 1.0 }, Clock { length: 1.0, time: 0.0 }];

fn dynamic(thinning: bool, clock: Clock<f64>) -> Dynamic<f64> {
    let constants = Constants::new(&coefficients(thinning));
    Dynamic { constants, clock, any_cross: thinning }
}

fn close(got: f64, want: f64, scale: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance * scale.abs(), "{got} {want} ({scale})");
}

/// States of a run and off it: starting, mid-way, late, not in balance.
const STATES: [[f64; 7]; 4] = [
    [0.0, 4.9, 900.0, 289.0, 289.0, 289.0, 0.0],
    [40.0, 4.7, 24_000.0, 340.0, 310.0, 295.0, 60.0],
    [140.0, 5.1, 18_300.0, 401.0, 395.0, 333.0, 180.0],
    [80.0, 3.0, 15_000.0, 380.0, 330.0, 300.0, 90.0],
];

#[test]
fn analytic_slow_variables_move_as_the_physics_does() {
    for thinning in [false, true] {
        let c = coefficients(thinning);
        for clock in CLOCKS {
            let system = dynamic(thinning, clock);
            let k = &system.constants;
            for y in STATES {
                let m = system.moment(&y);
                let [line, centre, z, fluid, rotor, housing, _] = y;
                // Back to the two velocities.
                let share =
                    (c.payload.weight_n - c.payload.extracted_n(line)) / GRAVITY / k.total_mass;
                let p = c.reel.radius_squared_m2(line);
                let kappa = k.torque * c.fluid.thickening(fluid, rotor) / p;
                let v = z / kappa;
                let (balloon, payload) = (centre + share * v, centre - (1.0 - share) * v);
                let truth = motion::moment(&c, &[line, balloon, payload, fluid, rotor, housing]);
                let [_, balloon_rate, payload_rate, fluid_rate, rotor_rate, housing_rate] =
                    truth.rates;
                let v_rate = balloon_rate - payload_rate;
                let share_rate = -k.share_slope * v;
                let centre_rate = balloon_rate - share_rate * v - share * v_rate;
                let tv = fluid + k.averaging_offset * (fluid - rotor);
                let tv_rate = fluid_rate + k.averaging_offset * (fluid_rate - rotor_rate);
                let growth = -1740.0 / (tv * tv) * tv_rate + k.radius_slope * v / p;
                let z_rate = kappa * v_rate + z * growth;
                let pace = clock.length * v + clock.time;
                let want = [v, centre_rate, z_rate, fluid_rate, rotor_rate, housing_rate, 1.0];
                let scales = [v, 0.1, kappa * v_rate, 1.0, 1.0, 1.0, 1.0];
                for n in 0..7 {
                    // A dozen rounded operations on terms that cancel by at most a thousand.
                    close(m.rates[n] * pace, want[n], scales[n], 1e-11);
                }
                let seen = system.observe(&y, &m);
                let squared = truth.observation[2] * truth.observation[2];
                let wanted = [
                    fluid,
                    truth.observation[1],
                    squared,
                    truth.observation[3],
                    truth.observation[4],
                ];
                for n in 0..5 {
                    close(seen[n], wanted[n], wanted[n], 1e-12);
                }
            }
        }
    }
}

#[test]
fn analytic_quasi_steady_rates_are_the_physics() {
    for thinning in [false, true] {
        let c = coefficients(thinning);
        for clock in CLOCKS {
            let constants = Constants::new(&c);
            let system = QuasiSteady { constants, clock, any_cross: thinning };
            for y in STATES {
                let [line, _, _, fluid, rotor, housing, time] = y;
                let truth = quasi_steady::moment(&c, Pull::Payload, &[line, fluid, rotor, housing]);
                let state = [line, fluid, rotor, housing, time];
                let m = system.moment(&state);
                let pace = clock.length * m.v + clock.time;
                for n in 0..4 {
                    close(m.rates[n] * pace, truth.rates[n], 1.0 + truth.rates[n].abs(), 1e-12);
                }
                close(m.rates[4] * pace, 1.0, 1.0, 1e-14);
            }
        }
    }
}

/// Newton's inversion of the thinning has converged for exponents and groups far beyond silicone fluids.
#[test]
fn analytic_six_newton_steps_invert_the_thinning() {
    for exponent in [0.05, 0.2, 0.5, 0.8, 0.95] {
        for time_constant in [1e-6, 1e-3, 0.02, 0.3] {
            let mut design = Design::baseline();
            design.set(Target::whole(Parameter::FluidCrossTimeConstant), time_constant);
            design.set(Target::whole(Parameter::FluidCrossExponent), exponent);
            let c = Coefficients::new(&design);
            let constants = Constants::new(&c);
            let system = QuasiSteady { constants, clock: CLOCKS[0], any_cross: true };
            let m = system.moment(&[50.0, 330.0, 310.0, 300.0, 0.0]);
            // The torque at the speed found is that of the load.
            let radius = c.reel.radius_squared_m2(50.0).sqrt();
            let pull = c.fluid.torque_nm(m.v / radius, 330.0, 310.0) / radius;
            // ln x is off by an ulp of up to 2e2/(1 − m) at worst.
            close(pull, m.load, m.load, 1e-12);
        }
    }
}

/// `(I/hγ − J) u` by central differences of the rates against `r`, for `u = solve(r)`.
fn residual<S: System<f64, N>, const N: usize>(system: &S, y: &[f64; N], scales: &[f64; N]) -> f64 {
    let h_gamma = 0.3;
    let factored = system.factor(y, &system.moment(y), h_gamma, 1.0 / h_gamma);
    let mut worst = 0.0f64;
    for direction in 0..N {
        let mut r = [0.0; N];
        for n in 0..N {
            r[n] = scales[n] * if n == direction { 1.0 } else { 0.1 + 0.05 * n as f64 };
        }
        let u = S::solve(&factored, &r);
        let length = (0..N).map(|n| (u[n] / scales[n]).abs()).fold(0.0, f64::max);
        let eps = 1e-5 / length;
        let at = |sign: f64| {
            let moved = std::array::from_fn(|n| y[n] + sign * eps * u[n]);
            S::rates(&system.moment(&moved))
        };
        let (up, down) = (at(1.0), at(-1.0));
        for n in 0..N {
            let product = u[n] / h_gamma - (up[n] - down[n]) / (2.0 * eps);
            worst = worst.max(((product - r[n]) / scales[n]).abs());
        }
    }
    worst
}

#[test]
fn analytic_the_eliminated_solve_inverts_the_jacobian() {
    for thinning in [false, true] {
        for clock in CLOCKS {
            let system = dynamic(thinning, clock);
            for y in STATES {
                let scales = [1.0, 1.0, 1e3, 1.0, 1.0, 1.0, 1.0];
                // Central differences of rates up to 1e4: 1e-5² of third derivatives, or rounding over 1e-5.
                let off = residual(&system, &y, &scales);
                assert!(off < 2e-5, "dynamic, thinning {thinning}: {off}");
            }
            let constants = Constants::new(&coefficients(thinning));
            let system = QuasiSteady { constants, clock, any_cross: thinning };
            for [line, _, _, fluid, rotor, housing, time] in STATES {
                let off = residual(&system, &[line, fluid, rotor, housing, time], &[1.0; 5]);
                assert!(off < 2e-5, "quasi-steady, thinning {thinning}: {off}");
            }
        }
    }
}

/// The observables' rates against differences along the flow.
#[test]
fn analytic_observable_rates_follow_the_flow() {
    for thinning in [false, true] {
        let system = dynamic(thinning, CLOCKS[0]);
        for y in STATES {
            let m = system.moment(&y);
            let rates = system.observable_rates(&m, m.rates[2]);
            let eps = 1e-6;
            let at = |sign: f64| {
                let moved = std::array::from_fn(|n| y[n] + sign * eps * m.rates[n]);
                system.observe(&moved, &system.moment(&moved))
            };
            let (up, down) = (at(1.0), at(-1.0));
            for n in 0..5 {
                let difference = (up[n] - down[n]) / (2.0 * eps);
                close(rates[n], difference, difference.abs() + 1e-3 * up[n].abs(), 1e-6);
            }
        }
    }
}

/// [`residual`] of a detailed model at fields that no run has.
fn detailed_residual<M: Model<f64, N>, const N: usize>(
    thinning: bool,
    clock: Clock<f64>,
    motion: &[f64],
) -> f64 {
    let mut system = M::new(Constants::new(&coefficients(thinning)));
    system.set_any_cross(thinning);
    system.set_clock(clock);
    let mut y = [50.0; N];
    y[..motion.len()].copy_from_slice(motion);
    for (k, temperature) in y[motion.len()..N - 1].iter_mut().enumerate() {
        *temperature = 320.0 + 4.0 * k as f64 + 9.0 * ((7 * k) % 5) as f64;
    }
    residual(&system, &y, &[1.0; N])
}

#[test]
fn analytic_the_detailed_solves_invert_their_jacobians() {
    for thinning in [false, true] {
        for clock in CLOCKS {
            for (line, v) in [(0.0, 0.4), (60.0, 0.9), (150.0, 0.3)] {
                let motion = [line, 4.7, v];
                let off = [
                    detailed_residual::<detailed::Dynamic<f64, 6, 3>, 23>(thinning, clock, &motion),
                    detailed_residual::<detailed::Dynamic<f64, 7, 4>, 33>(thinning, clock, &motion),
                    detailed_residual::<detailed::QuasiSteady<f64, 6, 3>, 21>(
                        thinning,
                        clock,
                        &motion[..1],
                    ),
                    detailed_residual::<detailed::QuasiSteady<f64, 7, 4>, 31>(
                        thinning,
                        clock,
                        &motion[..1],
                    ),
                ];
                // Temperatures that jump by 36 K from point to point make rates of 1e3 1/s: the differences are worth a digit less.
                assert!(off.iter().all(|&off| off < 2e-4), "thinning {thinning}, {line}: {off:?}");
            }
        }
    }
}
