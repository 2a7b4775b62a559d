//! The quasi-steady model: accelerations dropped, the brake's torque balances the line's pull at
//! every moment. It also serves the horizontal rig, where a truck pulls instead of the payload.

use super::coefficients::Coefficients;
use super::motion::Moment;
use crate::numerics::real::Real;

/// State of the quasi-steady model: line paid out (m), temperatures of fluid, rotors, housing (K).
pub type QuasiSteadyState<R> = [R; 4];

/// What pulls the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pull<R> {
    /// The hanging payload: tension `W2 − ΔW(l)`.
    Payload,
    /// A truck that holds a force, N: `M = F R`.
    Force(R),
    /// A truck that holds a speed, m/s: `ω = v/R`.
    Speed(R),
    /// A truck that holds a power, W: `M ω = P`.
    Power(R),
}

/// The state at release.
#[inline(always)]
pub fn initial<R: Real>(c: &Coefficients<R>) -> QuasiSteadyState<R> {
    let warm = c.initial_temperature_k;
    [R::constant(0.0), warm, warm, warm]
}

/// Rates and readings of the quasi-steady model: paper (8), (15), (16), (17).
#[inline(always)]
pub fn moment<R: Real>(
    c: &Coefficients<R>,
    pull: Pull<R>,
    state: &QuasiSteadyState<R>,
) -> Moment<QuasiSteadyState<R>, R> {
    let [line, fluid_k, rotor_k, housing_k] = *state;
    let radius = c.reel.radius_squared_m2(line).sqrt();
    let (speed, torque) = match pull {
        Pull::Payload => {
            let torque = (c.payload.weight_n - c.payload.extracted_n(line)) * radius;
            (c.fluid.speed_of_torque(torque, fluid_k, rotor_k), torque)
        }
        Pull::Force(force) => {
            let torque = force * radius;
            (c.fluid.speed_of_torque(torque, fluid_k, rotor_k), torque)
        }
        Pull::Speed(velocity) => {
            let speed = velocity / radius;
            (speed, c.fluid.torque_nm(speed, fluid_k, rotor_k))
        }
        Pull::Power(power) => {
            let speed = c.fluid.speed_of_power(power, fluid_k, rotor_k);
            (speed, power / speed)
        }
    };
    let power = torque * speed;
    let velocity = speed * radius;
    let [fluid_rate, rotor_rate, housing_rate] =
        c.thermal.rates([fluid_k, rotor_k, housing_k], power);
    Moment {
        rates: [velocity, fluid_rate, rotor_rate, housing_rate],
        observation: [fluid_k, torque / radius, speed, power, velocity],
        torque_nm: torque,
    }
}
