//! A history that drives the rig.

use crate::error::{Error, Result};
use crate::numerics::real::Real;
use crate::physics::quasi_steady::Pull;

/// Which quantity the truck is known to have applied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Drive {
    /// Force, N; speed is predicted.
    Force,
    /// Speed, m/s; force is predicted.
    Speed,
    /// Power, W; force and speed are predicted. Nobody records it, but runs are planned by it.
    Power,
}

impl Drive {
    /// All.
    pub const ALL: [Drive; 3] = [Drive::Force, Drive::Speed, Drive::Power];

    /// The name in options and tables.
    pub fn name(self) -> &'static str {
        match self {
            Drive::Force => "force",
            Drive::Speed => "speed",
            Drive::Power => "power",
        }
    }

    /// The pull of a value, SI.
    #[inline(always)]
    pub(super) fn pull<R>(self, value: R) -> Pull<R> {
        match self {
            Drive::Force => Pull::Force(value),
            Drive::Speed => Pull::Speed(value),
            Drive::Power => Pull::Power(value),
        }
    }
}

/// How the instrument that recorded a history errs in all of its readings alike: what was applied is
/// `gain · read + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction<R = f64> {
    /// What was applied over what was read.
    pub gain: R,
    /// What was applied when nothing was read, SI.
    pub offset: R,
}

impl<R: Real> Correction<R> {
    /// That of an instrument that does not err.
    pub fn none() -> Self {
        Correction { gain: R::constant(1.0), offset: R::constant(0.0) }
    }
}

impl Correction {
    /// What the instrument reads of a true value.
    #[inline]
    pub fn reading(&self, truth: f64) -> f64 {
        (truth - self.offset) / self.gain
    }
}

/// A force, speed or power history, linear between its times.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    drive: Drive,
    times_s: Vec<f64>,
    values: Vec<f64>,
    /// How much warmer than the design's initial temperature fluid, rotors and housing are at the first
    /// time, K: a run that follows another starts with hot rotors and a cooler housing.
    pub start_offsets_k: [f64; 3],
}

impl Record {
    /// A history: times (s, strictly increasing) and the values at them (SI, not negative).
    ///
    /// # Errors
    /// [`Error::Argument`]: fewer than two times, lengths that differ, times that do not increase, a
    /// value that is negative or not finite.
    pub fn new(drive: Drive, times_s: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        let name = drive.name();
        if times_s.len() != values.len() || times_s.len() < 2 {
            return Err(Error::argument(format!(
                "a {name} history needs two times at least and a value at each, not {} and {}",
                times_s.len(),
                values.len()
            )));
        }
        let ordered = times_s.windows(2).all(|pair| pair[0] < pair[1]);
        if !ordered || !times_s.iter().all(|time| time.is_finite()) {
            return Err(Error::argument(format!("the times of a {name} history must increase")));
        }
        if let Some(value) = values.iter().find(|value| !(value.is_finite() && **value >= 0.0)) {
            return Err(Error::argument(format!(
                "a {name} of {value} cannot be applied to a line"
            )));
        }
        Ok(Record { drive, times_s, values, start_offsets_k: [0.0; 3] })
    }

    /// A truck that holds a value from time 0 to `end_s`, read every `every_s`.
    ///
    /// # Errors
    /// As [`Record::new`].
    pub fn held(drive: Drive, value: f64, end_s: f64, every_s: f64) -> Result<Self> {
        let intervals = (end_s / every_s).ceil();
        if !(every_s > 0.0 && (1.0..=1e6).contains(&intervals)) {
            return Err(Error::argument(format!(
                "a history of {end_s} s cannot be read every {every_s} s"
            )));
        }
        let times_s: Vec<f64> = (0..=intervals as usize).map(|k| k as f64 * every_s).collect();
        let values = vec![value; times_s.len()];
        Record::new(drive, times_s, values)
    }

    /// What is applied.
    pub fn drive(&self) -> Drive {
        self.drive
    }

    /// The times, s.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// What is applied at each of the times, SI.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
