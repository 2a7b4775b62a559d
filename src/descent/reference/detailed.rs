//! The detailed models as systems of equations: temperature over the radius and across the film.
//!
//! State: line paid out, in the dynamic model the two upward velocities, the field of temperatures radius by radius from the
//! bore to the rim and at each from the wall to the middle of the film, the housing's temperature.

use super::radau::Equations;
use super::systems::{LINE_FLOOR, ReelDown, TEMPERATURE_FLOOR, VELOCITY_FLOOR, along, variables};
use crate::numerics::dual::Dual;
use crate::numerics::real::Real;
use crate::physics::Coefficients;
use crate::physics::film::{self, Demand, Faces, Field, Paths, Resistance, Shear};
use crate::physics::motion::{Forces, Moment, Observation};
use crate::physics::quasi_steady::Pull;
use crate::physics::space::Space;

/// The detailed dynamic model of one descent: `N = P K + 4` states.
#[derive(Debug, Clone)]
pub struct Dynamic<const P: usize, const K: usize, const N: usize> {
    plain: Coefficients<f64>,
    dual: Coefficients<Dual<N>>,
    space: Space<P, K>,
}

/// The detailed quasi-steady model of one descent or rig run: `N = P K + 2` states.
#[derive(Debug, Clone)]
pub struct QuasiSteady<const P: usize, const K: usize, const N: usize> {
    plain: Coefficients<f64>,
    dual: Coefficients<Dual<N>>,
    pull: Pull<f64>,
    space: Space<P, K>,
}

impl<const P: usize, const K: usize, const N: usize> Dynamic<P, K, N> {
    /// The model with the given constants and points.
    pub fn new(coefficients: &Coefficients<f64>, space: Space<P, K>) -> Self {
        const { assert!(N == P * K + 4, "line, two velocities, the field, the housing") };
        Dynamic { plain: *coefficients, dual: coefficients.lift(), space }
    }

    fn moment_of<R: Real>(&self, c: &Coefficients<R>, state: &[R; N]) -> Moment<[R; N], R> {
        let (line, housing_k) = (state[0], state[N - 1]);
        let (field, faces, resistance) = brake(c, &self.space, &state[3..]);
        let radius = c.reel.radius_squared_m2(line).sqrt();
        let velocity = state[1] - state[2];
        let speed = velocity / radius;
        let shear = Shear::new(&c.film, &faces, &resistance.thickening, speed, cross(c));
        let torque = c.fluid.torque_per_speed_nms * shear.stiffness * speed;
        let forces = Forces::new(c, [line, state[1], state[2]], torque);
        let drive = drive(c, speed);
        let heat = film::heating(
            &c.film,
            &Paths::new(&c.thermal),
            &self.space,
            &faces,
            &resistance,
            &shear,
            drive,
            (&field, housing_k),
        );
        let mut rates = [velocity; N];
        (rates[1], rates[2]) = (forces.balloon_rate, forces.payload_rate);
        fill(&mut rates[3..], &heat.field, heat.housing);
        let observation = [hottest(&field), forces.tension_n, speed, torque * speed, velocity];
        Moment { rates, observation, torque_nm: torque }
    }
}

impl<const P: usize, const K: usize, const N: usize> QuasiSteady<P, K, N> {
    /// The model with the given constants, pull and points.
    pub fn new(coefficients: &Coefficients<f64>, pull: Pull<f64>, space: Space<P, K>) -> Self {
        const { assert!(N == P * K + 2, "line, the field, the housing") };
        QuasiSteady { plain: *coefficients, dual: coefficients.lift(), pull, space }
    }

    fn moment_of<R: Real>(&self, c: &Coefficients<R>, state: &[R; N]) -> Moment<[R; N], R> {
        let (line, housing_k) = (state[0], state[N - 1]);
        let (field, faces, resistance) = brake(c, &self.space, &state[1..]);
        let radius = c.reel.radius_squared_m2(line).sqrt();
        let factor = c.fluid.torque_per_speed_nms;
        let solve =
            |demand| film::speed_of(&c.film, &faces, &resistance.thickening, demand, cross(c));
        let speed = match self.pull {
            Pull::Payload => {
                let load = c.payload.weight_n - c.payload.extracted_n(line);
                solve(Demand::Torque(load * radius / factor))
            }
            Pull::Force(force) => solve(Demand::Torque(R::constant(force) * radius / factor)),
            Pull::Speed(velocity) => R::constant(velocity) / radius,
            Pull::Power(power) => solve(Demand::Power(R::constant(power) / factor)),
        };
        let shear = Shear::new(&c.film, &faces, &resistance.thickening, speed, cross(c));
        let torque = factor * shear.stiffness * speed;
        let drive = drive(c, speed);
        let heat = film::heating(
            &c.film,
            &Paths::new(&c.thermal),
            &self.space,
            &faces,
            &resistance,
            &shear,
            drive,
            (&field, housing_k),
        );
        let velocity = speed * radius;
        let mut rates = [velocity; N];
        fill(&mut rates[1..], &heat.field, heat.housing);
        let observation = [hottest(&field), torque / radius, speed, torque * speed, velocity];
        Moment { rates, observation, torque_nm: torque }
    }
}

/// The field out of a row of temperatures, and what the brake is at it.
fn brake<R: Real, const P: usize, const K: usize>(
    c: &Coefficients<R>,
    space: &Space<P, K>,
    row: &[R],
) -> (Field<R, P, K>, Faces<R, P>, Resistance<R, P, K>) {
    let field = std::array::from_fn(|i| std::array::from_fn(|a| row[i * K + a]));
    let faces = Faces::new(&c.film, space);
    let resistance = Resistance::new(&c.film, space, c.fluid.viscosity_temperature_k, &field);
    (field, faces, resistance)
}

/// Rates of the field and of the housing into a row.
fn fill<R: Real, const P: usize, const K: usize>(
    row: &mut [R],
    field: &Field<R, P, K>,
    housing: R,
) {
    for (to, from) in row.iter_mut().zip(field.as_flattened()) {
        *to = *from;
    }
    row[P * K] = housing;
}

/// The Cross exponent where the fluid thins with shear.
fn cross<R: Real>(c: &Coefficients<R>) -> Option<R> {
    c.fluid.shear_thinning.then_some(c.fluid.cross_exponent)
}

/// `k ω²/C1`.
fn drive<R: Real>(c: &Coefficients<R>, speed: R) -> R {
    c.fluid.torque_per_speed_nms * speed * speed / c.thermal.fluid_capacity_j_per_k
}

/// The hottest of the points, K.
fn hottest<R: Real, const P: usize, const K: usize>(field: &Field<R, P, K>) -> R {
    let coldest_mirror = field.as_flattened().iter().map(|&t| -t).reduce(R::min);
    -coldest_mirror.unwrap_or(R::constant(0.0))
}

/// Means over the fluid's volume and the metal's area, and the housing's temperature.
fn means<const P: usize, const K: usize>(
    c: &Coefficients<f64>,
    space: &Space<P, K>,
    row: &[f64],
) -> [f64; 3] {
    let faces = Faces::new(&c.film, space);
    let of = |i: usize, a: usize| row[i * K + a];
    let across = std::array::from_fn(|i| (0..K).map(|a| space.share[a] * of(i, a)).sum());
    [faces.mean(&across), faces.mean(&std::array::from_fn(|i| of(i, 0))), row[P * K]]
}

/// Sizes below which an error counts absolutely: the line, velocities, temperatures.
fn floor<const N: usize>(velocities: usize) -> [f64; N] {
    std::array::from_fn(|n| match n {
        0 => LINE_FLOOR,
        n if n <= velocities => VELOCITY_FLOOR,
        _ => TEMPERATURE_FLOOR,
    })
}

macro_rules! system {
    ($Model:ident, $velocities:literal, $balloon:expr) => {
        impl<const P: usize, const K: usize, const N: usize> Equations<N> for $Model<P, K, N> {
            fn rates(&self, _: f64, state: &[f64; N]) -> [f64; N] {
                self.moment_of(&self.plain, state).rates
            }
            fn jacobian(&self, _: f64, state: &[f64; N]) -> [[f64; N]; N] {
                self.moment_of(&self.dual, &variables(state)).rates.map(|rate| rate.slopes)
            }
        }

        impl<const P: usize, const K: usize, const N: usize> ReelDown<N> for $Model<P, K, N> {
            fn initial(&self) -> [f64; N] {
                let c = &self.plain;
                let mut state = [c.initial_temperature_k; N];
                state[0] = 0.0;
                state[1..1 + $velocities].fill(c.balloon.rise_speed_m_per_s);
                state
            }
            fn moment(&self, state: &[f64; N]) -> Moment<[f64; N], f64> {
                self.moment_of(&self.plain, state)
            }
            fn trends(&self, state: &[f64; N]) -> Observation<f64> {
                let moment = self.moment_of(&self.dual, &variables(state));
                along(&moment.observation, &moment.rates.map(|rate| rate.value))
            }
            fn floor(&self) -> [f64; N] {
                floor($velocities)
            }
            fn line_length_m(&self) -> f64 {
                self.plain.reel.line_length_m
            }
            fn temperatures_k(&self, state: &[f64; N]) -> [f64; 3] {
                means(&self.plain, &self.space, &state[$velocities + 1..])
            }
            fn balloon_velocity_m_per_s(&self, state: &[f64; N]) -> Option<f64> {
                let balloon: fn(&[f64; N]) -> Option<f64> = $balloon;
                balloon(state)
            }
        }
    };
}
system!(Dynamic, 2, |state| Some(state[1]));
system!(QuasiSteady, 0, |_| None);
