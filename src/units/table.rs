//! The units: spellings, dimensions and exact factors to SI.

use super::Quantity;

/// Exponents of kilogram, metre, second and kelvin. Angles are pure numbers.
pub(super) type Dimension = [i8; 4];

/// One unit. A value in it is `value · numerator / denominator` in SI.
pub(super) struct Unit {
    /// Spellings; the first is the one to suggest.
    pub names: &'static [&'static str],
    /// Dimension.
    pub dimension: Dimension,
    /// Factor to SI, numerator.
    pub numerator: f64,
    /// Factor to SI, denominator; kept apart because `v / 100` is rounded once and `v · 0.01` twice.
    pub denominator: f64,
    /// What is added to a point on this temperature scale before the factor is applied.
    pub zero: f64,
}

const fn unit(
    names: &'static [&'static str],
    dimension: Dimension,
    numerator: f64,
    denominator: f64,
) -> Unit {
    Unit { names, dimension, numerator, denominator, zero: 0.0 }
}

const NONE: Dimension = [0, 0, 0, 0];
const LENGTH: Dimension = [0, 1, 0, 0];
const TIME: Dimension = [0, 0, 1, 0];
pub(super) const MASS: Dimension = [1, 0, 0, 0];
pub(super) const FORCE: Dimension = [1, 1, -2, 0];
const PRESSURE: Dimension = [1, -1, -2, 0];
const ENERGY: Dimension = [1, 2, -2, 0];
const POWER: Dimension = [1, 2, -3, 0];
const TEMPERATURE: Dimension = [0, 0, 0, 1];
const SPEED: Dimension = [0, 1, -1, 0];
const VISCOSITY: Dimension = [0, 2, -1, 0];
pub(super) const DYNAMIC_VISCOSITY: Dimension = [1, -1, -1, 0];
pub(super) const RATE: Dimension = [0, 0, -1, 0];
const TAU: f64 = std::f64::consts::TAU;
/// Pound, kg: exact by definition (international yard and pound agreement, 1959).
const POUND: f64 = 0.453_592_37;
/// Pound-force, N: the pound times standard gravity.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// British thermal unit of the International Tables, J.
const BTU: f64 = 1_055.055_852_62;

/// Every unit. Factors are exact by definition (NIST SP 811, appendix B), or π.
pub(super) static UNITS: &[Unit] = &[
    unit(&["%", "percent"], NONE, 1.0, 100.0),
    unit(&["ppm"], NONE, 1.0, 1e6),
    unit(&["rad", "radian", "radians"], NONE, 1.0, 1.0),
    unit(&["rev", "revs", "revolution", "revolutions"], NONE, TAU, 1.0),
    unit(&["deg", "°", "degree", "degrees"], NONE, TAU, 360.0),
    unit(&["rpm", "RPM"], RATE, TAU, 60.0),
    unit(&["m", "meter", "meters", "metre", "metres"], LENGTH, 1.0, 1.0),
    unit(&["mm", "millimeter", "millimeters", "millimetre", "millimetres"], LENGTH, 1.0, 1e3),
    unit(&["cm", "centimeter", "centimeters", "centimetre", "centimetres"], LENGTH, 1.0, 1e2),
    unit(&["um", "µm", "μm", "micron", "microns"], LENGTH, 1.0, 1e6),
    unit(&["km", "kilometer", "kilometers", "kilometre", "kilometres"], LENGTH, 1e3, 1.0),
    unit(&["in", "inch", "inches", "\"", "″"], LENGTH, 0.0254, 1.0),
    unit(&["ft", "foot", "feet", "'", "′"], LENGTH, 0.3048, 1.0),
    unit(&["yd", "yard", "yards"], LENGTH, 0.9144, 1.0),
    unit(&["mil", "mils", "thou"], LENGTH, 2.54e-5, 1.0),
    unit(&["mi", "mile", "miles"], LENGTH, 1_609.344, 1.0),
    unit(&["s", "sec", "secs", "second", "seconds"], TIME, 1.0, 1.0),
    unit(&["ms", "millisecond", "milliseconds"], TIME, 1.0, 1e3),
    unit(&["µs", "μs", "us", "microsecond", "microseconds"], TIME, 1.0, 1e6),
    unit(&["min", "mins", "minute", "minutes"], TIME, 60.0, 1.0),
    unit(&["h", "hr", "hrs", "hour", "hours"], TIME, 3_600.0, 1.0),
    unit(&["day", "days"], TIME, 86_400.0, 1.0),
    unit(&["kg", "kilogram", "kilograms", "kilogramme", "kilogrammes"], MASS, 1.0, 1.0),
    unit(&["g", "gram", "grams", "gramme", "grammes"], MASS, 1.0, 1e3),
    unit(&["t", "tonne", "tonnes"], MASS, 1e3, 1.0),
    unit(&["lb", "lbm", "lbs", "pound", "pounds"], MASS, POUND, 1.0),
    unit(&["oz", "ounce", "ounces"], MASS, POUND, 16.0),
    unit(&["slug", "slugs"], MASS, POUND_FORCE, 0.3048),
    unit(&["N", "newton", "newtons", "Newton", "Newtons"], FORCE, 1.0, 1.0),
    unit(&["kN", "kilonewton", "kilonewtons"], FORCE, 1e3, 1.0),
    unit(&["daN"], FORCE, 10.0, 1.0),
    unit(&["MN"], FORCE, 1e6, 1.0),
    unit(&["lbf", "lb-f", "lbs-f", "pound-force", "pounds-force"], FORCE, POUND_FORCE, 1.0),
    unit(&["kip", "kips", "klbf"], FORCE, 1e3 * POUND_FORCE, 1.0),
    unit(&["kgf", "kg-f", "kp"], FORCE, 9.80665, 1.0),
    unit(&["mPa"], PRESSURE, 1.0, 1e3),
    unit(&["Pa", "pascal", "pascals"], PRESSURE, 1.0, 1.0),
    unit(&["kPa"], PRESSURE, 1e3, 1.0),
    unit(&["MPa"], PRESSURE, 1e6, 1.0),
    unit(&["bar"], PRESSURE, 1e5, 1.0),
    unit(&["ksi"], PRESSURE, 1e3 * POUND_FORCE, 0.000_645_16),
    unit(&["psi"], PRESSURE, POUND_FORCE, 0.000_645_16),
    unit(&["J", "joule", "joules"], ENERGY, 1.0, 1.0),
    unit(&["kJ", "kilojoule", "kilojoules"], ENERGY, 1e3, 1.0),
    unit(&["MJ"], ENERGY, 1e6, 1.0),
    unit(&["kWh"], ENERGY, 3.6e6, 1.0),
    unit(&["BTU", "Btu", "btu"], ENERGY, BTU, 1.0),
    unit(&["W", "watt", "watts"], POWER, 1.0, 1.0),
    unit(&["kW", "kilowatt", "kilowatts"], POWER, 1e3, 1.0),
    unit(&["MW"], POWER, 1e6, 1.0),
    unit(&["hp", "HP", "horsepower"], POWER, 550.0 * POUND_FORCE * 0.3048, 1.0),
    unit(&["K", "kelvin", "kelvins", "Kelvin"], TEMPERATURE, 1.0, 1.0),
    Unit {
        zero: 273.15,
        ..unit(&["°C", "degC", "ºC", "℃", "Celsius", "celsius"], TEMPERATURE, 1.0, 1.0)
    },
    Unit {
        zero: 459.67,
        ..unit(&["°F", "degF", "ºF", "℉", "Fahrenheit", "fahrenheit"], TEMPERATURE, 1.0, 1.8)
    },
    unit(&["°R", "degR", "ºR", "Rankine", "rankine"], TEMPERATURE, 1.0, 1.8),
    unit(&["cSt", "centistoke", "centistokes"], VISCOSITY, 1.0, 1e6),
    unit(&["St", "stokes"], VISCOSITY, 1.0, 1e4),
    unit(&["mph"], SPEED, 0.447_04, 1.0),
    unit(&["kph", "kmh"], SPEED, 1.0, 3.6),
    unit(&["fps"], SPEED, 0.3048, 1.0),
    unit(&["kt", "kts", "knot", "knots"], SPEED, 1_852.0, 3_600.0),
    unit(&["P", "poise"], DYNAMIC_VISCOSITY, 1.0, 10.0),
    unit(&["cP", "centipoise"], DYNAMIC_VISCOSITY, 1.0, 1e3),
];

impl Quantity {
    /// Exponents of kilogram, metre, second and kelvin.
    pub(super) fn dimension(self) -> Dimension {
        match self {
            Quantity::Number => NONE,
            Quantity::Length => LENGTH,
            Quantity::Time => TIME,
            Quantity::Temperature
            | Quantity::TemperatureDifference
            | Quantity::TemperatureConstant => TEMPERATURE,
            Quantity::Speed => SPEED,
            Quantity::RotationalSpeed => RATE,
            Quantity::KinematicViscosity => VISCOSITY,
            Quantity::Density => [1, -3, 0, 0],
            Quantity::Mass => MASS,
            Quantity::Force => FORCE,
            Quantity::Power => POWER,
            Quantity::Inertia => [1, 2, 0, 0],
            Quantity::Area => [0, 2, 0, 0],
            Quantity::HeatCapacity => [1, 2, -2, -1],
            Quantity::Conductance => [1, 2, -3, -1],
            Quantity::Conductivity => [1, 1, -3, -1],
            Quantity::VolumetricHeatCapacity => [1, -1, -2, -1],
            Quantity::Expansion => [0, 0, 0, -1],
        }
    }
}

/// What a unit of this dimension measures, where it has a name.
pub(super) fn dimension_name(dimension: Dimension) -> &'static str {
    match dimension {
        NONE => "a pure number",
        LENGTH => "a length",
        TIME => "a time",
        MASS => "a mass",
        FORCE => "a force",
        PRESSURE => "a pressure",
        ENERGY => "an energy or a torque",
        POWER => "a power",
        TEMPERATURE => "a temperature",
        VISCOSITY => "a kinematic viscosity",
        DYNAMIC_VISCOSITY => "a dynamic viscosity",
        RATE => "a rate",
        SPEED => "a speed",
        [1, -3, 0, 0] => "a density",
        [1, 2, 0, 0] => "a moment of inertia",
        [0, 2, 0, 0] => "an area",
        [0, 3, 0, 0] => "a volume",
        [1, 2, -2, -1] => "a heat capacity",
        [1, 2, -3, -1] => "a thermal conductance",
        [1, 1, -3, -1] => "a thermal conductivity",
        [1, -1, -2, -1] => "a heat capacity by volume",
        [0, 0, 0, -1] => "a thermal expansion",
        _ => "another quantity",
    }
}
