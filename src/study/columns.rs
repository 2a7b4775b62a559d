//! A column of a file and its unit: in brackets behind its name, in the card, or in the name itself.

use super::files::SampleColumn;
use crate::units::spelling::nearest;
use crate::units::{self, Quantity};

/// What is wrong with a column.
pub(super) struct Complaint {
    pub problem: String,
    pub expected: String,
    pub help: Option<String>,
}

/// A column with the unit that is stated for it.
#[derive(Clone, Copy)]
pub(super) struct Found<'f> {
    pub column: &'f SampleColumn,
    pub unit: Option<&'f str>,
}

/// "fluid.viscosity [m²/s]" is a name and a unit.
pub(super) fn name_and_unit(header: &str) -> (&str, Option<&str>) {
    let inside = header.trim().strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    match inside {
        // brake.gap[3] is a path, not a unit.
        Some((name, unit)) if !unit.bytes().all(|byte| byte.is_ascii_digit()) => {
            (name.trim(), Some(unit.trim()))
        }
        _ => (header.trim(), None),
    }
}

/// The column that a card calls `wanted`: by its whole header, or by its name with the unit in the header or in
/// the card.
pub(super) fn find<'f>(
    file: &str,
    columns: &'f [SampleColumn],
    wanted: &'f str,
) -> Result<Found<'f>, Complaint> {
    let wanted = wanted.trim();
    let (name, unit) = name_and_unit(wanted);
    if let Some(column) = columns.iter().find(|(header, _)| header == wanted) {
        return Ok(Found { column, unit });
    }
    let named = columns.iter().find(|(header, _)| match (name_and_unit(header), unit) {
        ((own, _), None) => own == wanted,
        ((own, None), Some(_)) => own == name,
        _ => false,
    });
    if let Some(column) = named {
        return Ok(Found { column, unit: unit.or(name_and_unit(&column.0).1) });
    }
    let headers = columns.iter().map(|(header, _)| header.as_str());
    let all: Vec<&str> = headers.clone().take(12).collect();
    Err(Complaint {
        problem: format!("{file} has no column \"{wanted}\""),
        expected: format!("expected one of its columns: {}", all.join(", ")),
        help: nearest(wanted, headers).map(|near| format!("did you mean \"{near}\"?")),
    })
}

/// The numbers of a column in SI; what has a dimension names its unit.
pub(super) fn in_si(found: Found<'_>, quantity: Quantity) -> Result<Vec<f64>, Complaint> {
    let (header, values) = found.column;
    let values = values.as_ref().map_err(|reason| Complaint {
        problem: format!("column \"{header}\": {reason}"),
        expected: "expected a finite number in every row of the column".to_owned(),
        help: None,
    })?;
    let unit = found.unit.filter(|unit| !unit.is_empty() && *unit != "1" && *unit != "-");
    let Some(unit) = unit else {
        let suffix = quantity.column_suffix();
        if header.ends_with(suffix) {
            return Ok(values.clone());
        }
        let usual = quantity.usual_units().first().unwrap_or(&"");
        let name = name_and_unit(header).0;
        return Err(Complaint {
            problem: format!("column \"{header}\" has no unit"),
            expected: format!(
                "expected {} with its unit in brackets, \"{name} [{usual}]\"",
                quantity.described()
            ),
            help: Some(format!(
                "write the unit in the file's header or in the card; a name that ends in {suffix} is in {}",
                quantity.si_unit()
            )),
        });
    };
    let convert = |value: &f64| units::parse(&format!("{value} {unit}"), quantity);
    values.iter().map(convert).collect::<Result<_, _>>().map_err(|error| Complaint {
        problem: format!("column \"{header}\": {}", error.problem),
        expected: error.expected,
        help: error.help,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_headers_have_names_and_units() {
        assert_eq!(
            name_and_unit("thermal.fluid_capacity [J/K]"),
            ("thermal.fluid_capacity", Some("J/K"))
        );
        assert_eq!(name_and_unit("brake.gap[3]"), ("brake.gap[3]", None));
        assert_eq!(name_and_unit("brake.gap[3] [in]"), ("brake.gap[3]", Some("in")));
        assert_eq!(name_and_unit("fluid.shear_factor"), ("fluid.shear_factor", None));
    }

    fn read(header: &str, wanted: &str, quantity: Quantity) -> Result<Vec<f64>, String> {
        let columns = [(header.to_owned(), Ok(vec![60.0]))];
        find("a.csv", &columns, wanted)
            .and_then(|found| in_si(found, quantity))
            .map_err(|complaint| complaint.problem)
    }

    #[test]
    fn analytic_the_unit_is_taken_from_header_card_or_name() {
        let fahrenheit = (60.0 + 459.67) / 1.8;
        let temperature = Quantity::Temperature;
        for (header, wanted, kelvin) in [
            ("T [°F]", "T [°F]", fahrenheit),
            ("T [°F]", "T", fahrenheit),
            ("T", "T [°F]", fahrenheit),
            ("T_k", "T_k", 60.0),
            ("T_k", "T_k [°F]", fahrenheit),
        ] {
            assert_eq!(read(header, wanted, temperature), Ok(vec![kelvin]), "{header} {wanted}");
        }
        assert_eq!(read("f", "f", Quantity::Number), Ok(vec![60.0]));
        assert_eq!(read("f [%]", "f", Quantity::Number), Ok(vec![0.6]));
        for unitless in ["T", "T_m", "T [-]", "T []"] {
            let problem = read(unitless, unitless, temperature).unwrap_err();
            assert!(problem.ends_with("has no unit"), "{problem}");
        }
        // Where header and card contradict each other neither is taken.
        assert_eq!(
            read("T [°F]", "T [°C]", temperature).unwrap_err(),
            "a.csv has no column \"T [°C]\""
        );
    }
}
