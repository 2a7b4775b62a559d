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
    /// A constant of a law in absolute temperature, K, such as that of `exp(B/T)`.
    TemperatureConstant,
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
    /// Thermal conductivity, W/m/K.
    Conductivity,
    /// Heat capacity by volume, J/m³/K.
    VolumetricHeatCapacity,
    /// Thermal expansion, 1/K.
    Expansion,
}

impl Quantity {
    /// The SI unit, as printed.
    pub fn si_unit(self) -> &'static str {
        match self {
            Quantity::Number => "",
            Quantity::Length => "m",
            Quantity::Time => "s",
            Quantity::Temperature
            | Quantity::TemperatureDifference
            | Quantity::TemperatureConstant => "K",
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
            Quantity::Conductivity => "W/m/K",
            Quantity::VolumetricHeatCapacity => "J/m³/K",
            Quantity::Expansion => "1/K",
        }
    }

    /// The SI unit as a column name's ending: `_m_per_s`, or nothing for a pure number.
    pub fn column_suffix(self) -> &'static str {
        match self {
            Quantity::Number => "",
            Quantity::Length => "_m",
            Quantity::Time => "_s",
            Quantity::Temperature
            | Quantity::TemperatureDifference
            | Quantity::TemperatureConstant => "_k",
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
            Quantity::Conductivity => "_w_per_m_k",
            Quantity::VolumetricHeatCapacity => "_j_per_m3_k",
            Quantity::Expansion => "_per_k",
        }
    }

    /// The quantity in which a spread of this one is measured: a temperature's is a difference.
    pub fn of_difference(self) -> Quantity {
        match self {
            Quantity::Temperature => Quantity::TemperatureDifference,
            other => other,
        }
    }

    /// All kinds.
    pub const ALL: [Quantity; 20] = [
        Quantity::Number,
        Quantity::Length,
        Quantity::Time,
        Quantity::Temperature,
        Quantity::TemperatureDifference,
        Quantity::TemperatureConstant,
        Quantity::Speed,
        Quantity::RotationalSpeed,
        Quantity::KinematicViscosity,
        Quantity::Density,
        Quantity::Mass,
        Quantity::Force,
        Quantity::Power,
        Quantity::Inertia,
        Quantity::Area,
        Quantity::HeatCapacity,
        Quantity::Conductance,
        Quantity::Conductivity,
        Quantity::VolumetricHeatCapacity,
        Quantity::Expansion,
    ];

    /// The kind, with its article, as a sentence needs it: "a length".
    pub fn described(self) -> &'static str {
        match self {
            Quantity::Number => "a pure number",
            Quantity::Length => "a length",
            Quantity::Time => "a time",
            Quantity::Temperature => "a temperature",
            Quantity::TemperatureDifference => "a temperature difference",
            Quantity::TemperatureConstant => "a temperature constant",
            Quantity::Speed => "a speed",
            Quantity::RotationalSpeed => "a rotational speed",
            Quantity::KinematicViscosity => "a kinematic viscosity",
            Quantity::Density => "a density",
            Quantity::Mass => "a mass",
            Quantity::Force => "a force",
            Quantity::Power => "a power",
            Quantity::Inertia => "a moment of inertia",
            Quantity::Area => "an area",
            Quantity::HeatCapacity => "a heat capacity",
            Quantity::Conductance => "a thermal conductance",
            Quantity::Conductivity => "a thermal conductivity",
            Quantity::VolumetricHeatCapacity => "a heat capacity by volume",
            Quantity::Expansion => "a thermal expansion",
        }
    }

    /// Units in which an engineer writes it, the usual one first and an SI one among them.
    pub fn usual_units(self) -> &'static [&'static str] {
        match self {
            Quantity::Number => &[],
            Quantity::Length => &["in", "mm", "m"],
            Quantity::Time => &["s", "min"],
            Quantity::Temperature | Quantity::TemperatureDifference => &["°F", "°C", "K"],
            Quantity::TemperatureConstant => &["K"],
            Quantity::Speed => &["ft/s", "m/s"],
            Quantity::RotationalSpeed => &["rpm", "rad/s"],
            Quantity::KinematicViscosity => &["cSt", "m²/s"],
            Quantity::Density => &["kg/m³", "lb/ft³"],
            Quantity::Mass => &["kg", "lb"],
            Quantity::Force => &["lbf", "N"],
            Quantity::Power => &["kW", "hp", "W"],
            Quantity::Inertia => &["kg·m²", "slug·ft²"],
            Quantity::Area => &["m²", "ft²"],
            Quantity::HeatCapacity => &["J/K", "BTU/°F"],
            Quantity::Conductance => &["W/K", "BTU/h/°F"],
            Quantity::Conductivity => &["W/m/K"],
            Quantity::VolumetricHeatCapacity => &["MJ/m³/K"],
            Quantity::Expansion => &["%/K", "K⁻¹"],
        }
    }

    /// A value as an engineer writes it: "0.062 in".
    pub fn example(self) -> &'static str {
        match self {
            Quantity::Number => "5 %",
            Quantity::Length => "0.062 in",
            Quantity::Time => "3.5 min",
            Quantity::Temperature => "60 °F",
            Quantity::TemperatureDifference => "10 °F",
            Quantity::TemperatureConstant => "1740 K",
            Quantity::Speed => "2.5 ft/s",
            Quantity::RotationalSpeed => "120 rpm",
            Quantity::KinematicViscosity => "125000 cSt",
            Quantity::Density => "970 kg/m³",
            Quantity::Mass => "1000 kg",
            Quantity::Force => "6000 lbf",
            Quantity::Power => "40 kW",
            Quantity::Inertia => "30 kg·m²",
            Quantity::Area => "500 m²",
            Quantity::HeatCapacity => "3990 J/K",
            Quantity::Conductance => "680 W/K",
            Quantity::Conductivity => "0.16 W/m/K",
            Quantity::VolumetricHeatCapacity => "3.6 MJ/m³/K",
            Quantity::Expansion => "0.095 %/K",
        }
    }
}
