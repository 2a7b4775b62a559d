//! The dynamic model: two bodies on an inextensible line, the brake between them, and the heat.

use super::GRAVITY;
use super::coefficients::Coefficients;
use crate::numerics::real::Real;

/// State of the dynamic model: line paid out `l` (m), upward velocities `V1` of the tow balloon and
/// `V2` of the payload (m/s), temperatures of fluid, rotors and housing (K).
pub type DynamicState<R> = [R; 6];

/// What can be read off a moment of a descent, in the order of [`OBSERVABLES`]: fluid temperature (K),
/// line tension (N), reel speed (rad/s), brake power (W), separation velocity (m/s).
pub type Observation<R> = [R; 5];

/// The names of the entries of an [`Observation`].
pub const OBSERVABLES: [&str; 5] =
    ["fluid_temperature_k", "tension_n", "reel_speed_rad_per_s", "power_w", "velocity_m_per_s"];

/// A moment of a descent: the rates of its state, and what can be read off it.
#[derive(Debug, Clone, Copy)]
pub struct Moment<S, R> {
    /// Time derivatives of the state.
    pub rates: S,
    /// Tension, speeds, power.
    pub observation: Observation<R>,
    /// Brake torque `M`, N·m.
    pub torque_nm: R,
}

/// The state at release: no line out, both bodies rising at the steady speed, one temperature.
pub fn initial<R: Real>(c: &Coefficients<R>) -> DynamicState<R> {
    let rise = c.balloon.rise_speed_m_per_s;
    let warm = c.initial_temperature_k;
    [R::constant(0.0), rise, rise, warm, warm, warm]
}

/// What the forces do to both bodies, given the brake's torque.
#[derive(Debug, Clone, Copy)]
pub struct Forces<R> {
    /// Upward acceleration of the tow balloon, m/s².
    pub balloon_rate: R,
    /// Upward acceleration of the payload, m/s².
    pub payload_rate: R,
    /// Line tension, N.
    pub tension_n: R,
}

impl<R: Real> Forces<R> {
    /// The forces at a line paid out and both upward velocities: paper (2), (3), (4), (13), (14), with the spool-inertia
    /// term of (13) and (14) over `2 L R²`, as its dimensions require.
    #[inline(always)]
    pub fn new(c: &Coefficients<R>, motion: [R; 3], torque: R) -> Self {
        let [line, balloon_speed, payload_speed] = motion;
        let one = R::constant(1.0);
        let inverse_gravity = R::constant(1.0 / GRAVITY);
        let radius_squared = c.reel.radius_squared_m2(line);
        let radius = radius_squared.sqrt();
        let speed = (balloon_speed - payload_speed) / radius;

        let extracted = c.payload.extracted_n(line);
        let suspended = c.payload.weight_n - extracted;
        let balloon_mass = extracted.mul_add(inverse_gravity, c.balloon.moving_mass_kg);
        let payload_mass = suspended * inverse_gravity;
        let spool_mass = c.reel.inertia_kg_m2 / radius_squared;
        let spool_pull =
            R::constant(0.5) * spool_mass * c.reel.squared_radius_slope_m * speed * speed;
        let brake_pull = spool_pull + torque / radius;

        let balloon_force =
            c.balloon.net_lift_n - extracted - c.balloon.drag_n(balloon_speed) - brake_pull;
        let payload_force = brake_pull - suspended;
        let determinant =
            spool_mass.mul_add(balloon_mass + payload_mass, balloon_mass * payload_mass);
        let inverse = one / determinant;
        let both = spool_mass * (balloon_force + payload_force);
        let balloon_rate = payload_mass.mul_add(balloon_force, both) * inverse;
        let payload_rate = balloon_mass.mul_add(payload_force, both) * inverse;
        let tension_n = spool_mass.mul_add(balloon_rate - payload_rate, brake_pull);
        Forces { balloon_rate, payload_rate, tension_n }
    }
}

/// Rates and readings of the dynamic model: [`Forces`], paper (8), (16), (17).
pub fn moment<R: Real>(c: &Coefficients<R>, state: &DynamicState<R>) -> Moment<DynamicState<R>, R> {
    let [line, balloon_speed, payload_speed, fluid_k, rotor_k, housing_k] = *state;
    let radius = c.reel.radius_squared_m2(line).sqrt();
    let velocity = balloon_speed - payload_speed;
    let speed = velocity / radius;
    let torque = c.fluid.torque_nm(speed, fluid_k, rotor_k);
    let power = torque * speed;
    let forces = Forces::new(c, [line, balloon_speed, payload_speed], torque);
    let [fluid_rate, rotor_rate, housing_rate] =
        c.thermal.rates([fluid_k, rotor_k, housing_k], power);
    Moment {
        rates: [
            velocity,
            forces.balloon_rate,
            forces.payload_rate,
            fluid_rate,
            rotor_rate,
            housing_rate,
        ],
        observation: [fluid_k, forces.tension_n, speed, power, velocity],
        torque_nm: torque,
    }
}
