//! Units and the parameters' own texts.

use reeldown::physics::parameters::PARAMETERS;
use reeldown::units::{Quantity, UnitError, parse};

#[test]
fn property_the_baseline_texts_are_the_baselines_bit_for_bit() {
    for info in &PARAMETERS {
        assert_eq!(parse(info.baseline_text, info.quantity), Ok(info.baseline), "{}", info.path);
    }
}

#[test]
fn property_the_examples_are_values_of_their_quantity_alone() {
    // Temperatures, their differences and the constant B are all written in kelvins.
    let unit = Quantity::si_unit;
    for quantity in Quantity::ALL {
        assert!(parse(quantity.example(), quantity).is_ok(), "{}", quantity.described());
        for other in Quantity::ALL {
            let same = unit(quantity) == unit(other);
            assert_eq!(parse(quantity.example(), other).is_ok(), same, "{quantity:?} as {other:?}");
        }
    }
}

fn si(text: &str, quantity: Quantity) -> f64 {
    parse(text, quantity).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn refused(text: &str, quantity: Quantity) -> UnitError {
    match parse(text, quantity) {
        Ok(value) => panic!("{text} was read as {value}"),
        Err(error) => error,
    }
}

#[test]
fn analytic_values_by_the_definitions_of_the_units() {
    use Quantity::*;
    for (text, quantity, expected) in [
        ("0.062 in", Length, 0.062 * 0.0254),
        ("0.062\"", Length, 0.062 * 0.0254),
        ("62 mil", Length, 62.0 * 2.54e-5),
        ("500 ft", Length, 152.4),
        ("500'", Length, 152.4),
        ("1 mi", Length, 1609.344),
        ("1.5748 mm", Length, 1.5748e-3),
        ("60 °F", Temperature, (60.0 + 459.67) / 1.8),
        ("60 degF", Temperature, (60.0 + 459.67) / 1.8),
        ("0°F", Temperature, 459.67 / 1.8),
        ("−40 °F", Temperature, 233.15),
        ("-40 degC", Temperature, 233.15),
        ("300 K", Temperature, 300.0),
        ("491.67 °R", Temperature, 273.15),
        ("10 °F", TemperatureDifference, 10.0 / 1.8),
        ("10 °C", TemperatureDifference, 10.0),
        ("125000 cSt", KinematicViscosity, 0.125),
        ("125_000 cSt", KinematicViscosity, 0.125),
        ("1.25e5cSt", KinematicViscosity, 0.125),
        ("1250 St", KinematicViscosity, 0.125),
        ("125000 mm²/s", KinematicViscosity, 0.125),
        ("1 ft^2/s", KinematicViscosity, 0.3048 * 0.3048),
        ("6000 lbf", Force, 6000.0 * 4.448_221_615_260_5),
        ("5 %", Number, 0.05),
        ("99.73 %", Number, 0.9973),
        ("250 ppm", Number, 2.5e-4),
        ("1e-3", Number, 1e-3),
        (".5", Number, 0.5),
        ("1 rev", Number, std::f64::consts::TAU),
        ("30 kg·m²", Inertia, 30.0),
        ("30 kg*m^2", Inertia, 30.0),
        ("30 kg m**2", Inertia, 30.0),
        ("1 slug·ft²", Inertia, 4.448_221_615_260_5 / 0.3048 * 0.3048 * 0.3048),
        ("2.5 ft/s", Speed, 0.762),
        ("2.5 ft·s⁻¹", Speed, 0.762),
        ("2.5 ft s^-1", Speed, 0.762),
        ("3.5 min", Time, 210.0),
        ("680 W/K", Conductance, 680.0),
        ("1 BTU/h/°F", Conductance, 1_055.055_852_62 / 3600.0 * 1.8),
        ("1 BTU/°F", HeatCapacity, 1_055.055_852_62 * 1.8),
        ("500 m²", Area, 500.0),
        ("0.30 kg/m³", Density, 0.30),
        ("1 g/cm^3", Density, 1000.0),
        ("120 rpm", RotationalSpeed, 4.0 * std::f64::consts::PI),
        ("2 rev/s", RotationalSpeed, 4.0 * std::f64::consts::PI),
        ("1 hp", Power, 745.699_871_582_270_2),
        ("1 kN·m/s", Power, 1000.0),
        ("2200 lb", Mass, 2200.0 * 0.453_592_37),
        ("2200 pounds", Mass, 2200.0 * 0.453_592_37),
        ("6 kip", Force, 6000.0 * 4.448_221_615_260_5),
        ("6000 pounds-force", Force, 6000.0 * 4.448_221_615_260_5),
        ("6000 lb-f", Force, 6000.0 * 4.448_221_615_260_5),
        ("26.7 kilonewtons", Force, 26_700.0),
        ("30 kg·m2", Inertia, 30.0),
        ("30 kg m^2", Inertia, 30.0),
        ("30 kg-m2", Inertia, 30.0),
        ("1 slug-ft2", Inertia, 4.448_221_615_260_5 / 0.3048 * 0.3048 * 0.3048),
        ("0.125 m2/s", KinematicViscosity, 0.125),
        ("125000 mm2/s", KinematicViscosity, 0.125),
        ("121.25 Pa·s m3/kg", KinematicViscosity, 121.25),
        ("125 centistokes", KinematicViscosity, 1.25e-4),
        ("60 deg F", Temperature, (60.0 + 459.67) / 1.8),
        ("60 ° F", Temperature, (60.0 + 459.67) / 1.8),
        ("60 degrees Fahrenheit", Temperature, (60.0 + 459.67) / 1.8),
        ("10 deg C", TemperatureDifference, 10.0),
        ("1 BTU/(h·°F)", Conductance, 1_055.055_852_62 / 3600.0 * 1.8),
        ("1 BTU/h-°F", Conductance, 1_055.055_852_62 / 3600.0 * 1.8),
        ("680 W/(K)", Conductance, 680.0),
        ("1 kWh/K", HeatCapacity, 3.6e6),
        ("100 mph", Speed, 44.704),
        ("36 kph", Speed, 10.0),
        ("10 knots", Speed, 10.0 * 1852.0 / 3600.0),
        ("2.5 fps", Speed, 0.762),
        ("2.5 m s-1", Speed, 2.5),
        ("970 kg/m3", Density, 970.0),
        ("60 lb/ft3", Density, 60.0 * 0.453_592_37 / (0.3048 * 0.3048 * 0.3048)),
        ("500 m2", Area, 500.0),
        ("1 day", Time, 86_400.0),
        ("10 lbf-ft/s", Power, 10.0 * 4.448_221_615_260_5 * 0.3048),
    ] {
        let value = si(text, quantity);
        // A few roundings of factors that are exact: 4 ulp.
        assert!(
            (value - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(),
            "{text} is {value}"
        );
    }
}

#[test]
fn property_a_wrong_unit_says_what_was_expected() {
    let error = refused("6000 lb", Quantity::Force);
    assert_eq!(error.span, 5..7);
    assert_eq!(error.problem, "`lb` is a unit of a mass");
    assert_eq!(error.expected, "expected a force, such as \"6000 lbf\"");
    assert_eq!(error.help.as_deref(), Some("lb is a mass; write lbf"));
    let suggestion = |text, quantity| refused(text, quantity).help.unwrap_or_default();
    assert_eq!(suggestion("60 F", Quantity::Temperature), "write °F or degF");
    assert_eq!(suggestion("125000 cst", Quantity::KinematicViscosity), "did you mean `cSt`?");
    assert_eq!(suggestion("0.062 inchs", Quantity::Length), "did you mean `inch`?");
    let bare = refused("0.062", Quantity::Length);
    assert_eq!(bare.problem, "0.062 has no unit");
    assert_eq!(bare.help.as_deref(), Some("write \"0.062 in\", \"0.062 mm\" or \"0.062 m\""));
    assert!(suggestion("6000 pounds", Quantity::Force).ends_with("write lbf"));
    for dynamic in ["121 Pa·s", "121 Pa-s", "121000 mPa·s", "1210 P", "121 N·s/m2"] {
        assert!(suggestion(dynamic, Quantity::KinematicViscosity).contains("dynamic viscosity"));
    }
    assert!(suggestion("1 000 cSt", Quantity::KinematicViscosity).contains("separators"));
    assert!(suggestion("125,000 cSt", Quantity::KinematicViscosity).contains("separators"));
}

#[test]
fn property_what_is_no_value_is_refused_inside_its_text() {
    for text in [
        "",
        " ",
        "in",
        "1 in in",
        "1 in/",
        "1 *in",
        "1 in^",
        "1 in^0",
        "1 in^99",
        "1 m^200",
        "1e999 m",
        "1e308 km",
        "nan m",
        "inf m",
        "--1 m",
        "1..2 m",
        "1e m",
        "1 m//s",
        "1 ²m",
        "é",
        "1 é",
        "1 m é",
        "1 m⁻",
        "1 ☃",
        "0x10 m",
        "1_ m",
        "+",
        "-",
        "−",
        "1 °",
        "5 % m/s/m",
        "5 W/(m",
        "5 W/m)",
        "5 (m)",
        "5 W/(m/K)",
        "5 W/()",
        "5 m-",
        "5 -m",
        "5 m--s",
        "5 deg",
        "5 deg X",
    ] {
        for quantity in [Quantity::Length, Quantity::Temperature] {
            let error = refused(text, quantity);
            assert!(error.span.end <= text.len() && error.span.start <= error.span.end, "{text}");
            assert!(text.is_char_boundary(error.span.start), "{text}");
            assert!(text.is_char_boundary(error.span.end), "{text}");
        }
    }
}

#[test]
fn property_only_a_pure_number_is_taken_without_a_unit() {
    for quantity in Quantity::ALL {
        for written in ["0", "450", "-1e-3"] {
            let value: f64 = written.parse().expect("a number");
            let bare = reeldown::units::bare(value, written, quantity);
            let texts =
                [bare.map_err(|e| e.problem), parse(written, quantity).map_err(|e| e.problem)];
            for answer in texts {
                match quantity {
                    Quantity::Number => assert_eq!(answer, Ok(value)),
                    _ => assert_eq!(answer, Err(format!("{written} has no unit"))),
                }
            }
        }
        // What the message proposes is read, and as this quantity.
        for unit in quantity.usual_units() {
            assert!(parse(&format!("1 {unit}"), quantity).is_ok(), "{unit}");
        }
    }
}
