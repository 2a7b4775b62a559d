//! What a rig measures.

use crate::descent::driven::{Correction, Drive, Reading};
use crate::study::MeasuredRun;
use crate::units::Quantity;

/// A measured quantity of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// Pull on the line.
    Force,
    /// Speed of the line.
    Speed,
    /// Line paid out.
    Line,
    /// Fluid temperature.
    Fluid,
    /// Temperature of rotors and stators.
    Rotor,
    /// Housing temperature.
    Housing,
}

impl Channel {
    /// All.
    pub const ALL: [Channel; 6] = [
        Channel::Force,
        Channel::Speed,
        Channel::Line,
        Channel::Fluid,
        Channel::Rotor,
        Channel::Housing,
    ];

    /// The name in the header of a run, and in options.
    pub fn name(self) -> &'static str {
        match self {
            Channel::Force => "force",
            Channel::Speed => "speed",
            Channel::Line => "line",
            Channel::Fluid => "fluid",
            Channel::Rotor => "rotor",
            Channel::Housing => "housing",
        }
    }

    /// The channel of a name.
    pub fn from_name(name: &str) -> Option<Channel> {
        Channel::ALL.into_iter().find(|channel| channel.name() == name)
    }

    /// Kind of quantity.
    pub fn quantity(self) -> Quantity {
        match self {
            Channel::Force => Quantity::Force,
            Channel::Speed => Quantity::Speed,
            Channel::Line => Quantity::Length,
            Channel::Fluid | Channel::Rotor | Channel::Housing => Quantity::Temperature,
        }
    }

    /// Whether it is a temperature.
    pub fn is_temperature(self) -> bool {
        self.quantity() == Quantity::Temperature
    }

    /// The reading at which a gain has no effect, SI: of a thermometer the ice point.
    pub fn zero(self) -> f64 {
        if self.is_temperature() { 273.15 } else { 0.0 }
    }

    /// How an instrument with these errors is corrected: truth − zero = (1 + gain) (reading − zero) + offset.
    pub fn correction(self, gain: f64, offset: f64) -> Correction {
        Correction { gain: 1.0 + gain, offset: offset - gain * self.zero() }
    }

    /// The channel that drives a run, if it is one.
    pub fn of_drive(drive: Drive) -> Option<Channel> {
        match drive {
            Drive::Force => Some(Channel::Force),
            Drive::Speed => Some(Channel::Speed),
            Drive::Power => None,
        }
    }

    /// What a run holds of it.
    pub fn measured(self, run: &MeasuredRun) -> Option<&[f64]> {
        match self {
            Channel::Force => run.force_n.as_deref(),
            Channel::Speed => run.speed_m_per_s.as_deref(),
            Channel::Line => run.line_m.as_deref(),
            Channel::Fluid => run.fluid_k.as_deref(),
            Channel::Rotor => run.rotor_k.as_deref(),
            Channel::Housing => run.housing_k.as_deref(),
        }
    }

    /// What a prediction says of it.
    #[inline]
    pub fn predicted<R: Copy>(self, reading: &Reading<R>) -> R {
        match self {
            Channel::Force => reading.force_n,
            Channel::Speed => reading.speed_m_per_s,
            Channel::Line => reading.line_m,
            Channel::Fluid => reading.temperatures_k[0],
            Channel::Rotor => reading.temperatures_k[1],
            Channel::Housing => reading.temperatures_k[2],
        }
    }
}
