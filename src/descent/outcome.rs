//! What one descent ends in.

use crate::units::Quantity;

/// A quantity by which a descent is judged; the discriminant is its place in [`Outcome::values`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(usize)]
pub enum OutcomeQuantity {
    /// Time from release to the end of the line.
    Time,
    /// Separation velocity when the line ends.
    FinalVelocity,
    /// Highest fluid temperature at any moment.
    PeakFluidTemperature,
    /// Highest line tension at any moment.
    PeakTension,
    /// Highest reel speed at any moment.
    PeakReelSpeed,
    /// Highest brake power at any moment.
    PeakPower,
    /// Highest separation velocity at any moment.
    PeakVelocity,
    /// Fluid temperature at the end.
    FinalFluidTemperature,
    /// Rotor and stator temperature at the end.
    FinalRotorTemperature,
    /// Housing temperature at the end.
    FinalHousingTemperature,
}

/// Number of outcome quantities.
pub const OUTCOME_COUNT: usize = 10;

impl OutcomeQuantity {
    /// All, in the order of [`Outcome::values`].
    pub const ALL: [OutcomeQuantity; OUTCOME_COUNT] = [
        OutcomeQuantity::Time,
        OutcomeQuantity::FinalVelocity,
        OutcomeQuantity::PeakFluidTemperature,
        OutcomeQuantity::PeakTension,
        OutcomeQuantity::PeakReelSpeed,
        OutcomeQuantity::PeakPower,
        OutcomeQuantity::PeakVelocity,
        OutcomeQuantity::FinalFluidTemperature,
        OutcomeQuantity::FinalRotorTemperature,
        OutcomeQuantity::FinalHousingTemperature,
    ];

    /// The name in study files.
    pub fn name(self) -> &'static str {
        match self {
            OutcomeQuantity::Time => "time",
            OutcomeQuantity::FinalVelocity => "final_velocity",
            OutcomeQuantity::PeakFluidTemperature => "peak_fluid_temperature",
            OutcomeQuantity::PeakTension => "peak_tension",
            OutcomeQuantity::PeakReelSpeed => "peak_reel_speed",
            OutcomeQuantity::PeakPower => "peak_power",
            OutcomeQuantity::PeakVelocity => "peak_velocity",
            OutcomeQuantity::FinalFluidTemperature => "final_fluid_temperature",
            OutcomeQuantity::FinalRotorTemperature => "final_rotor_temperature",
            OutcomeQuantity::FinalHousingTemperature => "final_housing_temperature",
        }
    }

    /// What it is, for a person.
    pub fn title(self) -> &'static str {
        match self {
            OutcomeQuantity::Time => "reel-down time",
            OutcomeQuantity::FinalVelocity => "final separation velocity",
            OutcomeQuantity::PeakFluidTemperature => "peak fluid temperature",
            OutcomeQuantity::PeakTension => "peak line tension",
            OutcomeQuantity::PeakReelSpeed => "peak reel speed",
            OutcomeQuantity::PeakPower => "peak brake power",
            OutcomeQuantity::PeakVelocity => "peak separation velocity",
            OutcomeQuantity::FinalFluidTemperature => "final fluid temperature",
            OutcomeQuantity::FinalRotorTemperature => "final rotor temperature",
            OutcomeQuantity::FinalHousingTemperature => "final housing temperature",
        }
    }

    /// The kind of quantity.
    pub fn quantity(self) -> Quantity {
        match self {
            OutcomeQuantity::Time => Quantity::Time,
            OutcomeQuantity::FinalVelocity | OutcomeQuantity::PeakVelocity => Quantity::Speed,
            OutcomeQuantity::PeakFluidTemperature
            | OutcomeQuantity::FinalFluidTemperature
            | OutcomeQuantity::FinalRotorTemperature
            | OutcomeQuantity::FinalHousingTemperature => Quantity::Temperature,
            OutcomeQuantity::PeakTension => Quantity::Force,
            OutcomeQuantity::PeakReelSpeed => Quantity::RotationalSpeed,
            OutcomeQuantity::PeakPower => Quantity::Power,
        }
    }

    /// The Parquet column and JSON key: the name with its SI unit.
    pub fn column(self) -> String {
        format!("{}{}", self.name(), self.quantity().column_suffix())
    }

    /// The outcome quantity of a name.
    pub fn from_name(name: &str) -> Option<OutcomeQuantity> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == name)
    }
}

/// What one descent ended in, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Whether the line ran out before the time limit. If not, the values are those at the limit.
    pub deployed: bool,
    /// The outcome quantities, in the order of [`OutcomeQuantity::ALL`].
    pub values: [f64; OUTCOME_COUNT],
}

impl Outcome {
    /// One quantity, SI.
    pub fn get(&self, quantity: OutcomeQuantity) -> f64 {
        self.values[quantity as usize]
    }
}

/// Why a descent could not be computed. Not a breach and not a success: see the fault bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Fault {
    /// A drawn input is outside what is physically possible.
    ImpossibleInput,
    /// The integrator took more steps than it is allowed.
    TooManySteps,
    /// The step size fell below what the arithmetic can resolve.
    StepTooSmall,
    /// A value stopped being finite.
    NotFinite,
    /// What came out is physically impossible, or does not settle as the tolerance is tightened.
    Inaccurate,
}

impl Fault {
    /// Every kind of fault.
    pub const ALL: [Fault; 5] = [
        Fault::ImpossibleInput,
        Fault::TooManySteps,
        Fault::StepTooSmall,
        Fault::NotFinite,
        Fault::Inaccurate,
    ];

    /// The fault of a name.
    pub fn from_name(name: &str) -> Option<Fault> {
        Self::ALL.into_iter().find(|fault| fault.name() == name)
    }

    /// The name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Fault::ImpossibleInput => "impossible-input",
            Fault::TooManySteps => "too-many-steps",
            Fault::StepTooSmall => "step-too-small",
            Fault::NotFinite => "not-finite",
            Fault::Inaccurate => "inaccurate",
        }
    }
}

/// The time limit of a descent, s: one that has not ended by then did not deploy.
pub const TIME_LIMIT_S: f64 = 1800.0;
