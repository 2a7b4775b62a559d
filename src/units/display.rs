//! Values as an engineer reads them.

use super::Quantity;

/// A unit to show values in: `shown = (SI value) · scale + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// The symbol, as printed after the number; empty for a pure number.
    pub symbol: &'static str,
    /// What an SI value is multiplied by.
    pub scale: f64,
    /// What is added afterwards.
    pub offset: f64,
}

/// Whose units to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum System {
    /// US customary, as the paper writes: °F, in, ft/s, lbf; SI where it writes SI.
    UsCustomary,
    /// SI.
    Si,
}

impl DisplayUnit {
    /// The number to show for an SI value.
    pub fn shown(&self, value_si: f64) -> f64 {
        value_si * self.scale + self.offset
    }
}

const fn scaled(symbol: &'static str, scale: f64) -> DisplayUnit {
    DisplayUnit { symbol, scale, offset: 0.0 }
}

/// The unit in which the paper's reader expects a quantity.
pub fn display(quantity: Quantity) -> DisplayUnit {
    match quantity {
        Quantity::Number => scaled("", 1.0),
        Quantity::Length => scaled("in", 1.0 / 0.0254),
        Quantity::Time => scaled("s", 1.0),
        Quantity::Temperature => DisplayUnit { symbol: "°F", scale: 1.8, offset: -459.67 },
        Quantity::TemperatureDifference => scaled("°F", 1.8),
        Quantity::TemperatureConstant => scaled("K", 1.0),
        Quantity::Speed => scaled("ft/s", 1.0 / 0.3048),
        Quantity::RotationalSpeed => scaled("rpm", 60.0 / std::f64::consts::TAU),
        Quantity::KinematicViscosity => scaled("cSt", 1e6),
        Quantity::Density => scaled("kg/m³", 1.0),
        Quantity::Mass => scaled("kg", 1.0),
        Quantity::Force => scaled("lbf", 1.0 / 4.448_221_615_260_5),
        Quantity::Power => scaled("kW", 1e-3),
        Quantity::Inertia => scaled("kg·m²", 1.0),
        Quantity::Area => scaled("m²", 1.0),
        Quantity::HeatCapacity => scaled("J/K", 1.0),
        Quantity::Conductance => scaled("W/K", 1.0),
        Quantity::Conductivity => scaled("W/m/K", 1.0),
        Quantity::VolumetricHeatCapacity => scaled("MJ/m³/K", 1e-6),
        Quantity::Expansion => scaled("1/K", 1.0),
    }
}

/// A value with its unit in a system, to `digits` significant digits: "450 °F".
pub fn format_engineering(
    value_si: f64,
    quantity: Quantity,
    system: System,
    digits: usize,
) -> String {
    let unit = match system {
        System::Si => scaled(quantity.si_unit(), 1.0),
        // Half a thousand inches say less than forty feet.
        System::UsCustomary if quantity == Quantity::Length && value_si.abs() >= 0.9144 => {
            scaled("ft", 1.0 / 0.3048)
        }
        System::UsCustomary => display(quantity),
    };
    let shown = number(unit.shown(value_si), digits);
    if unit.symbol.is_empty() { shown } else { format!("{shown} {}", unit.symbol) }
}

/// A value in the paper's units with SI beside it where that differs: "450 °F (505.372 K)".
pub fn engineering(value_si: f64, quantity: Quantity) -> String {
    let paper = format_engineering(value_si, quantity, System::UsCustomary, 6);
    let si = format_engineering(value_si, quantity, System::Si, 6);
    if paper == si { paper } else { format!("{paper} ({si})") }
}

/// A number to `digits` significant digits without trailing zeros: "0.062", "125000", "1.5e-9".
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let digits = digits.clamp(1, 17);
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trim = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.to_owned()
        }
    };
    if (-5..digits.max(7) as i32).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        // Through the rounded scientific form, so that large numbers keep only their digits.
        let rounded: f64 = scientific.parse().unwrap_or(value);
        trim(&format!("{rounded:.decimals$}"))
    } else {
        format!("{}e{exponent}", trim(mantissa))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_limits_are_shown_as_the_paper_writes_them() {
        let us = |value, quantity| format_engineering(value, quantity, System::UsCustomary, 6);
        assert_eq!(us((450.0 + 459.67) / 1.8, Quantity::Temperature), "450 °F");
        assert_eq!(us(0.762, Quantity::Speed), "2.5 ft/s");
        assert_eq!(us(152.4, Quantity::Length), "500 ft");
        assert_eq!(us(0.062 * 0.0254, Quantity::Length), "0.062 in");
        assert_eq!(us(0.125, Quantity::KinematicViscosity), "125000 cSt");
        assert_eq!(us(0.05, Quantity::Number), "0.05");
        assert_eq!(engineering(210.0, Quantity::Time), "210 s");
        assert_eq!(
            engineering((450.0 + 459.67) / 1.8, Quantity::Temperature),
            "450 °F (505.372 K)"
        );
    }

    #[test]
    fn analytic_numbers_keep_their_digits_and_no_more() {
        for (value, digits, text) in [
            (201.024_6, 6, "201.025"),
            (200.0, 6, "200"),
            (0.0, 3, "0"),
            (-1234.5678, 6, "-1234.57"),
            (1.5e-9, 3, "1.5e-9"),
            (1234567.0, 3, "1230000"),
            (9.999_999_9, 6, "10"),
            (6.02e23, 3, "6.02e23"),
        ] {
            assert_eq!(number(value, digits), text);
        }
        assert_eq!(number(f64::INFINITY, 3), "inf");
    }
}
