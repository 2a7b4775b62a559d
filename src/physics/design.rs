//! One design: a value for every parameter, and a gap for every working surface.

use super::balloon::Balloon;
use super::parameters::{PARAMETER_COUNT, PARAMETERS, Parameter};
use crate::error::{Error, Result};
use crate::numerics::real::Real;

/// Where a value goes: a parameter, or the gap of one working surface (counted from 0).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Target {
    /// The parameter.
    pub parameter: Parameter,
    /// The working surface, for a gap of its own.
    pub surface: Option<usize>,
}

impl Target {
    /// The parameter as a whole.
    pub fn whole(parameter: Parameter) -> Self {
        Target { parameter, surface: None }
    }

    /// The gap of working surface `surface`, counted from 0.
    pub fn gap(surface: usize) -> Self {
        Target { parameter: Parameter::BrakeGap, surface: Some(surface) }
    }

    /// The dotted path: `brake.gap[3]` is the third surface, counted from 1 as a person does.
    pub fn path(&self) -> String {
        match self.surface {
            Some(surface) => format!("{}[{}]", self.parameter.info().path, surface + 1),
            None => self.parameter.info().path.to_owned(),
        }
    }

    /// The name of the Parquet column that holds it: `brake_gap_3_m`.
    pub fn column(&self) -> String {
        let info = self.parameter.info();
        let name = info.path.replace('.', "_");
        let suffix = info.quantity.column_suffix();
        match self.surface {
            Some(surface) => format!("{name}_{}{suffix}", surface + 1),
            None => format!("{name}{suffix}"),
        }
    }
}

impl Target {
    /// Whether no other parameter has a say in which of its values are possible.
    pub fn is_checked_alone(&self) -> bool {
        ORDERED.iter().all(|&(small, large)| self.parameter != small && self.parameter != large)
            && !RISING.contains(&self.parameter)
    }
}

/// Pairs of parameters of which the first must be the smaller.
const ORDERED: [(Parameter, Parameter); 3] = [
    (Parameter::BrakeInnerRadius, Parameter::BrakeOuterRadius),
    (Parameter::ReelEmptyRadius, Parameter::ReelFullRadius),
    (Parameter::PayloadExtractedWeight, Parameter::PayloadWeight),
];

/// What decides how fast the balloon rises before release.
const RISING: [Parameter; 5] = [
    Parameter::BalloonMass,
    Parameter::BalloonDragArea,
    Parameter::BalloonAirDensity,
    Parameter::BalloonFreeLift,
    Parameter::PayloadWeight,
];

/// Speed of sound where balloons fly, m/s (U.S. Standard Atmosphere 1976, 11 to 20 km): the drag law holds far below it.
const SPEED_OF_SOUND_M_PER_S: f64 = 295.07;

/// A complete design, SI, in any number type.
#[derive(Debug, Clone, PartialEq)]
pub struct Design<R = f64> {
    values: [R; PARAMETER_COUNT],
    gaps: Vec<R>,
}

impl<R: Real> Design<R> {
    /// The reconstructed baseline of the HABE brake.
    pub fn baseline() -> Self {
        let values = std::array::from_fn(|k| R::constant(PARAMETERS[k].baseline));
        let surfaces = 2 * PARAMETERS[Parameter::BrakeRotors as usize].baseline as usize;
        let gap = values[Parameter::BrakeGap as usize];
        Design { values, gaps: vec![gap; surfaces] }
    }

    /// Value of a parameter; for the gap, the nominal one (see [`Design::gaps`]).
    #[inline(always)]
    pub fn get(&self, parameter: Parameter) -> R {
        self.values[parameter as usize]
    }

    /// The gap of every working surface, m; there are 2n.
    #[inline(always)]
    pub fn gaps(&self) -> &[R] {
        &self.gaps
    }

    /// Number of working surfaces, 2n.
    #[inline(always)]
    pub fn surfaces(&self) -> usize {
        self.gaps.len()
    }

    /// The value at a target.
    pub fn at(&self, target: Target) -> R {
        match target.surface {
            Some(surface) => self.gaps[surface],
            None => self.get(target.parameter),
        }
    }

    /// Sets a value. The gap as a whole sets every surface's. A surface beyond the last is ignored:
    /// the study checks that it exists.
    #[inline(always)]
    pub fn set(&mut self, target: Target, value: R) {
        match target.surface {
            Some(surface) => {
                if let Some(gap) = self.gaps.get_mut(surface) {
                    *gap = value;
                }
            }
            None => {
                self.values[target.parameter as usize] = value;
                if target.parameter == Parameter::BrakeGap {
                    self.gaps.fill(value);
                }
            }
        }
    }

    /// The same design in another number type.
    pub fn map<S: Real>(&self, convert: impl Fn(R) -> S) -> Design<S> {
        Design {
            values: std::array::from_fn(|k| convert(self.values[k])),
            gaps: self.gaps.iter().map(|&gap| convert(gap)).collect(),
        }
    }
}

impl Design<f64> {
    /// Sets the number of rotors, and with it the number of working surfaces, each with the nominal gap.
    pub fn set_rotors(&mut self, rotors: usize) {
        self.values[Parameter::BrakeRotors as usize] = rotors as f64;
        self.gaps = vec![self.get(Parameter::BrakeGap); 2 * rotors];
    }

    /// Whether every value is possible and the values fit each other: [`Design::validate`] without words,
    /// for the inner loop.
    pub fn is_possible(&self) -> bool {
        let fit = |small: Parameter, large: Parameter| self.get(small) < self.get(large);
        PARAMETERS.iter().all(|info| info.admits(self.get(info.parameter)))
            && self.gaps.iter().all(|&gap| Parameter::BrakeGap.info().admits(gap))
            && ORDERED.iter().all(|&(small, large)| fit(small, large))
            && self.rise_speed_m_per_s() < SPEED_OF_SOUND_M_PER_S
    }

    /// How fast the balloon rises before release, m/s.
    fn rise_speed_m_per_s(&self) -> f64 {
        Balloon::new(|parameter| self.get(parameter)).rise_speed_m_per_s
    }

    /// Checks that every value is possible and that the values fit each other.
    ///
    /// # Errors
    /// [`Error::Argument`] naming the path, its value and what is possible.
    pub fn validate(&self) -> Result<()> {
        for info in &PARAMETERS {
            let value = self.get(info.parameter);
            if !info.admits(value) {
                return Err(Error::argument(format!(
                    "{} = {value} {} is impossible: it must lie {} {} and {}",
                    info.path,
                    info.quantity.si_unit(),
                    if info.open { "strictly between" } else { "between" },
                    info.lower,
                    info.upper,
                )));
            }
        }
        let rotors = self.get(Parameter::BrakeRotors);
        if rotors.fract() != 0.0 {
            return Err(Error::argument(format!("brake.rotors = {rotors} is not a whole number")));
        }
        if let Some(surface) =
            self.gaps.iter().position(|&gap| !Parameter::BrakeGap.info().admits(gap))
        {
            return Err(Error::argument(format!(
                "{} = {} m is impossible: a gap is positive",
                Target::gap(surface).path(),
                self.gaps[surface]
            )));
        }
        for (small, large) in ORDERED {
            if self.get(small) >= self.get(large) {
                let (small, large) = (small.info(), large.info());
                return Err(Error::argument(format!(
                    "{} = {} {unit} must be smaller than {} = {} {unit}",
                    small.path,
                    self.get(small.parameter),
                    large.path,
                    self.get(large.parameter),
                    unit = small.quantity.si_unit(),
                )));
            }
        }
        let rise = self.rise_speed_m_per_s();
        if rise.is_nan() || rise >= SPEED_OF_SOUND_M_PER_S {
            let named = RISING.map(|parameter| parameter.info().path).join(", ");
            return Err(Error::argument(format!(
                "the balloon would rise at {rise:.3e} m/s, faster than sound ({SPEED_OF_SOUND_M_PER_S} m/s): {named} do not \
                 fit each other"
            )));
        }
        Ok(())
    }
}
