//! The kinds of physical quantity that a study speaks of.

/// A kind of quantity. Inside the program its value is always in the SI unit of [`Quantity::si_unit`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A pure number.
    Number,
    /// Length, m.
    Length,
    /// Time, s.
    Time,
    /// A point on the temperature scale, K: "60 °F" is 288.706 K.
    Temperature,
    /// A difference of temperatures, K: "10 °F" is 5.556 K.
    TemperatureDifference,
    /// Speed, m/s.
    Speed,
    /// Rotational speed, rad/s.
    RotationalSpeed,
    /// Kinematic viscosity, m²/s.
    KinematicViscosity,
    /// Density, kg/m³.
    Density,
    /// Mass, kg.
    Mass,
    /// Force, N.
    Force,
    /// Power, W.
    Power,
    /// Moment of inertia, kg·m².
    Inertia,
    /// Area, m².
    Area,
    /// Heat capacity (thermal mass), J/K.
    HeatCapacity,
    /// Thermal conductance, W/K.
    Conductance,
}

impl Quantity {
    /// The SI unit, as printed.
    pub fn si_unit(self) -> &'static str {
        match self {
            Quantity::Number => "",
            Quantity::Length => "m",
            Quantity::Time => "s",
            Quantity::Temperature | Quantity::TemperatureDifference => "K",
            Quantity::Speed => "m/s",
            Quantity::RotationalSpeed => "rad/s",
            Quantity::KinematicViscosity => "m²/s",
            Quantity::Density => "kg/m³",
            Quantity::Mass => "kg",
            Quantity::Force => "N",
            Quantity::Power => "W",
            Quantity::Inertia => "kg·m²",
            Quantity::Area => "m²",
            Quantity::HeatCapacity => "J/K",
            Quantity::Conductance => "W/K",
        }
    }

    /// The SI unit as a column name's ending: `_m_per_s`, or nothing for a pure number.
    pub fn column_suffix(self) -> &'static str {
        match self {
            Quantity::Number => "",
            Quantity::Length => "_m",
            Quantity::Time => "_s",
            Quantity::Temperature | Quantity::TemperatureDifference => "_k",
            Quantity::Speed => "_m_per_s",
            Quantity::RotationalSpeed => "_rad_per_s",
            Quantity::KinematicViscosity => "_m2_per_s",
            Quantity::Density => "_kg_per_m3",
            Quantity::Mass => "_kg",
            Quantity::Force => "_n",
            Quantity::Power => "_w",
            Quantity::Inertia => "_kg_m2",
            Quantity::Area => "_m2",
            Quantity::HeatCapacity => "_j_per_k",
            Quantity::Conductance => "_w_per_k",
        }
    }

    /// The quantity in which a spread of this one is measured: a temperature's is a difference.
    pub fn of_difference(self) -> Quantity {
        match self {
            Quantity::Temperature => Quantity::TemperatureDifference,
            other => other,
        }
    }
}
