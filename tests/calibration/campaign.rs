//! The example campaign: a truck, a brake whose every number is known, and three instruments that err.
//!
//! The truth lies within the card of `tests/fixtures/habe`, and each channel wanders about the model: the discrepancy
//! that a calibration has to live with.

use reeldown::calibration::noise::Noise;
use reeldown::campaign::calibration::Channel;
use reeldown::campaign::calibration::synthetic::{Instrument, Schedule, run};
use reeldown::descent::driven::Drive;
use reeldown::error::Result;
use reeldown::physics::design::{Design, Target};
use reeldown::physics::parameters::Parameter;

/// Seed of the campaign that is shipped.
pub const SEED: u64 = 1991;

const LBF: f64 = 4.448_221_615_260_5;
const FT: f64 = 0.3048;
const IN: f64 = 0.0254;

/// What is true of the brake, besides the gaps: path's parameter, value in SI, and as a person writes it.
pub const TRUTH: [(Parameter, f64, &str); 8] = [
    (Parameter::FluidShearFactor, 1.07, "1.07"),
    (Parameter::FluidAveragingOffset, 0.06, "0.06"),
    (Parameter::ThermalFluidCapacity, 3760.0, "3760 J/K"),
    (Parameter::ThermalRotorCapacity, 22_300.0, "22300 J/K"),
    (Parameter::ThermalHousingCapacity, 13_900.0, "13900 J/K"),
    (Parameter::ThermalFluidRotorConductance, 770.0, "770 W/K"),
    (Parameter::ThermalFluidHousingConductance, 42.0, "42 W/K"),
    (Parameter::ThermalRotorHousingConductance, 10.3, "10.3 W/K"),
];

/// The gaps, thousandths of an inch.
pub const GAPS: [f64; 14] =
    [60.1, 63.5, 61.2, 58.9, 66.0, 62.3, 59.4, 64.8, 61.9, 57.6, 63.0, 60.7, 65.1, 62.6];

/// The brake as it really is.
pub fn truth() -> Design {
    let mut design = Design::baseline();
    for (parameter, value, _) in TRUTH {
        design.set(Target::whole(parameter), value);
    }
    for (surface, gap) in GAPS.iter().enumerate() {
        design.set(Target::gap(surface), gap * 1e-3 * IN);
    }
    design
}

/// The instruments: a load cell, a wheel and two thermocouples. The rotors turn, and carry none.
pub fn instruments() -> [Instrument; 5] {
    let instrument = |channel, sensor_sd, discrepancy_sd, unit, step| Instrument {
        channel,
        noise: Noise { sensor_sd, discrepancy_sd, correlation_time_s: 40.0 },
        systematic: (0.0, 0.0),
        unit,
        step,
    };
    [
        instrument(Channel::Force, 25.0 * LBF, 0.0, "lbf", 1.0),
        instrument(Channel::Speed, 0.02 * FT, 0.012 * FT, "ft/s", 0.001),
        instrument(Channel::Line, 0.1 * FT, 0.0, "ft", 0.1),
        instrument(Channel::Fluid, 0.8 / 1.8, 2.0 / 1.8, "°F", 0.1),
        instrument(Channel::Housing, 0.5 / 1.8, 0.4 / 1.8, "°F", 0.1),
    ]
}

/// The schedules: three modes to calibrate with, and a fourth run at another level and temperature to hold out.
pub fn schedules() -> [(&'static str, Schedule); 4] {
    let schedule = |hold, level, initial_f: f64| Schedule {
        hold,
        level,
        wobble: (0.03, 6.0),
        initial_k: (initial_f + 459.67) / 1.8,
        end_s: 240.0,
        every_s: 1.0,
    };
    [
        ("constant_force.csv", schedule(Drive::Force, 5000.0 * LBF, 68.0)),
        ("constant_speed.csv", schedule(Drive::Speed, 2.6 * FT, 74.0)),
        ("constant_power.csv", schedule(Drive::Power, 17_000.0, 71.0)),
        ("hold_out.csv", schedule(Drive::Force, 5800.0 * LBF, 61.0)),
    ]
}

/// Name and text of every run.
pub fn runs(seed: u64) -> Result<Vec<(&'static str, String)>> {
    runs_of(&truth(), &instruments(), seed)
}

/// The same of another brake, by instruments that err otherwise.
pub fn runs_of(
    truth: &Design,
    instruments: &[Instrument],
    seed: u64,
) -> Result<Vec<(&'static str, String)>> {
    schedules()
        .into_iter()
        .enumerate()
        .map(|(k, (name, schedule))| {
            let key = (seed, k as u64);
            Ok((name, run(truth, &schedule, instruments, Drive::Force, key)?))
        })
        .collect()
}
