//! What a test is made with, where nothing is stated: in proportion to what the brake has to carry.

use super::information::Instruments;
use super::run::flight_means;
use crate::campaign::calibration::plan::{GAIN, OFFSET_K};
use crate::error::{Error, Result};
use crate::physics::{Design, Parameter};

/// Proof load over the payload's weight.
const PROOF: f64 = 1.5;
/// Random error of a force reading over the payload's weight: 50 lbf for 6000.
const FORCE: f64 = 1.0 / 120.0;
/// Random error of a speed reading over the flight's mean speed: 0.05 ft/s for 2.5.
const SPEED: f64 = 0.02;

/// The proof load and the instruments of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Equipment {
    /// Load that no run may exceed, N.
    pub proof_load_n: f64,
    /// The instruments.
    pub instruments: Instruments,
    /// What of it nobody has stated, each with where it is from.
    pub assumed: Vec<String>,
}

impl Equipment {
    /// What is assumed of the tests of a design.
    ///
    /// # Errors
    /// If the flight cannot be computed.
    pub fn assumed(design: &Design) -> Result<Self> {
        Self::stated(design, &Stated::default())
    }

    /// The same with what is stated.
    ///
    /// # Errors
    /// If the flight cannot be computed; an error or a load that is not positive.
    pub fn stated(design: &Design, stated: &Stated) -> Result<Self> {
        let weight_n = design.get(Parameter::PayloadWeight);
        let mut assumed = Vec::new();
        let mut or = |given: Option<f64>, value: f64, what: &str| {
            given.unwrap_or_else(|| {
                assumed.push(what.to_owned());
                value
            })
        };
        let proof_load_n =
            or(stated.proof_load_n, PROOF * weight_n, "proof load, 1.5 times the payload's weight");
        let force_noise_n = or(
            stated.force_noise_n,
            FORCE * weight_n,
            "random error of force, 1/120 of the payload's weight",
        );
        let speed_noise_m_per_s = match stated.speed_noise_m_per_s {
            Some(given) => given,
            None => or(
                None,
                SPEED * flight_means(design)?[1],
                "random error of speed, 2 % of the flight's mean speed",
            ),
        };
        let instruments = Instruments {
            every_s: or(stated.every_s, 1.0, "time between readings, 1 s"),
            force_noise_n,
            force_gain: or(stated.force_gain, GAIN, "systematic error of force, 1 %"),
            speed_noise_m_per_s,
            speed_gain: or(stated.speed_gain, GAIN, "systematic error of speed, 1 %"),
            temperature_noise_k: or(
                stated.temperature_noise_k,
                2.0 / 1.8,
                "random error of temperature, 2 °F",
            ),
            temperature_offset_k: or(
                stated.temperature_offset_k,
                OFFSET_K,
                "systematic error of temperature, 2 °F",
            ),
            thermometers: stated.thermometers.unwrap_or_else(|| {
                assumed.push("thermometers in fluid and housing".to_owned());
                [true, false, true]
            }),
        };
        if !(proof_load_n.is_finite() && proof_load_n > 0.0) {
            return Err(Error::argument("--proof-load: a proof load is positive"));
        }
        instruments.validate()?;
        Ok(Equipment { proof_load_n, instruments, assumed })
    }
}

/// What is stated of a test, SI; see [`Equipment`] and [`Instruments`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stated {
    /// Proof load, N.
    pub proof_load_n: Option<f64>,
    /// Time between readings, s.
    pub every_s: Option<f64>,
    /// Random error of force, N.
    pub force_noise_n: Option<f64>,
    /// Systematic error of force, as a share.
    pub force_gain: Option<f64>,
    /// Random error of speed, m/s.
    pub speed_noise_m_per_s: Option<f64>,
    /// Systematic error of speed, as a share.
    pub speed_gain: Option<f64>,
    /// Random error of temperature, K.
    pub temperature_noise_k: Option<f64>,
    /// Systematic error of each thermometer, K.
    pub temperature_offset_k: Option<f64>,
    /// Which nodes have a thermometer.
    pub thermometers: Option<[bool; 3]>,
}
