//! Ranges on the command line: `--over PATH=FROM..TO:N`, a design path and the values to be tried.

use super::Study;
use super::place::{Place, Text};
use super::values::parameter_path;
use crate::error::{Error, Result};
use crate::physics::design::Target;
use crate::physics::parameters::{PARAMETERS, Parameter};
use crate::units::spelling::nearest;
use crate::units::{self, Quantity};
use std::ops::Range;
use std::sync::Arc;

/// Most settings of one path.
pub const MOST_SETTINGS: u64 = 1000;
/// Most settings of two paths together.
pub const MOST_CELLS: u64 = 10_000;

const EXAMPLE: &str = "expected PATH=FROM..TO:N, such as initial.temperature=0°F..100°F:21";

/// A design path and the evenly spaced values that it is to take.
#[derive(Debug, Clone, PartialEq)]
pub struct Over {
    /// Where the values go.
    pub target: Target,
    /// The first value, SI.
    pub from: f64,
    /// The last value, SI, above the first.
    pub to: f64,
    /// Number of values, at least two.
    pub count: usize,
    path: Place,
    range: Place,
}

impl Over {
    /// Reads `PATH=FROM..TO:N` as given to `option` ("--over"). A unit at one end alone is that of both.
    ///
    /// # Errors
    /// A diagnostic in the option's text: a part that is missing, an unknown path, a unit of another
    /// quantity, a range that is reversed, a single point, or outside what is possible.
    pub fn parse(option: &str, statement: &str) -> Result<Self> {
        let text = Arc::new(Text { origin: option.to_owned(), text: statement.to_owned() });
        let place = |span: Range<usize>| Place::new(&text, trimmed(statement, span));
        let Some(equals) = statement.find('=') else {
            return Err(place(0..statement.len()).error("there is no `=`", EXAMPLE));
        };
        let path = place(0..equals);
        let target = known_path(&path)?;
        let Some(dots) = statement[equals..].find("..").map(|at| equals + at) else {
            let problem = "there is no `..` between two values";
            return Err(place(equals + 1..statement.len()).error(problem, EXAMPLE));
        };
        let Some(colon) = statement[dots..].rfind(':').map(|at| dots + at) else {
            let problem = "there is no `:` with the number of values after it";
            return Err(place(dots..statement.len()).error(problem, EXAMPLE));
        };
        let quantity = target.parameter.info().quantity;
        let (first, last) = (place(equals + 1..dots), place(dots + 2..colon));
        let unit = |end: &Place| {
            let written = end.written();
            let digits = written.trim_start_matches(|c: char| "+-−.eE_0123456789".contains(c));
            digits.trim().to_owned()
        };
        // A unit that only the last end has is at fault there.
        let to = end_value(&last, quantity, &unit(&first))?;
        let from = end_value(&first, quantity, &unit(&last))?;
        let count = number_of_values(&place(colon + 1..statement.len()))?;
        let range = place(equals + 1..statement.len());
        let over = Over { target, from, to, count, path, range };
        over.checked(&first, &last)
    }

    fn checked(self, first: &Place, last: &Place) -> Result<Self> {
        if self.from == self.to {
            let expected = "expected two different ends";
            let help = format!("for one value: --set {}={}", self.path.written(), first.written());
            return Err(self.range.error_with("the range is a single point", expected, Some(help)));
        }
        if self.from > self.to {
            let (a, b) = (last.written(), first.written());
            let help = format!("write {}={a}..{b}:{}", self.path.written(), self.count);
            let expected = "expected the smaller end first";
            return Err(self.range.error_with("the range is reversed", expected, Some(help)));
        }
        let info = self.target.parameter.info();
        for (value, end) in [(self.from, first), (self.to, last)] {
            if !info.admits(value) {
                let problem = format!("{} = {} is impossible", info.path, end.written());
                let expected = format!(
                    "expected a value {} {} and {} {}",
                    if info.open { "strictly between" } else { "between" },
                    info.lower,
                    info.upper,
                    info.quantity.si_unit(),
                );
                return Err(end.error(problem, expected));
            }
        }
        if self.target.parameter == Parameter::BrakeRotors {
            let problem = "brake.rotors cannot be swept: the number of gaps changes with it";
            let help = "sweep something else with --set brake.rotors=… for each number";
            let expected = "expected another path";
            return Err(self.path.error_with(problem, expected, Some(help.to_owned())));
        }
        Ok(self)
    }

    /// The values, SI, ascending.
    pub fn values(&self) -> Vec<f64> {
        let last = (self.count - 1) as f64;
        let at = |k: usize| self.from + (self.to - self.from) * (k as f64 / last);
        (0..self.count).map(|k| if k + 1 == self.count { self.to } else { at(k) }).collect()
    }

    /// Checks ranges that are swept together against a study.
    ///
    /// # Errors
    /// None or more than two of them, a path twice, a surface that the brake lacks, a gap that the card
    /// sets as a whole, too many settings together.
    pub fn check_together(overs: &[Over], study: &Study) -> Result<()> {
        if let Some(third) = overs.get(2) {
            let expected = "expected one or two --over";
            return Err(third.path.error("more than two paths are swept", expected));
        }
        for over in overs {
            if over.target.surface.is_some_and(|surface| surface >= study.design.surfaces()) {
                let problem = format!("the brake has no surface of `{}`", over.path.written());
                let expected = format!("expected a surface from 1 to {}", study.design.surfaces());
                return Err(over.path.error(problem, expected));
            }
            let whole = Target::whole(over.target.parameter);
            let as_one = study.inputs.iter().any(|input| input.target == whole);
            if over.target.surface.is_some() && as_one {
                let problem = "the card gives every surface one gap, drawn as a whole";
                let expected = "expected brake.gap, or a card with each_surface = true";
                return Err(over.path.error(problem, expected));
            }
        }
        if let [first, second] = overs {
            if first.target.parameter == second.target.parameter
                && (first.target == second.target
                    || first.target.surface.is_none()
                    || second.target.surface.is_none())
            {
                let problem = format!("{} is swept twice", second.path.written());
                return Err(second.path.error(problem, "expected two different paths"));
            }
            let cells = first.count as u64 * second.count as u64;
            if cells > MOST_CELLS {
                let problem = format!("{cells} settings together are too many");
                let expected = format!("expected at most {MOST_CELLS}");
                return Err(second.range.error(problem, expected));
            }
        }
        Ok(())
    }
}

/// The design path that an option names, for a message in its text if there is none.
///
/// # Errors
/// A diagnostic that names the nearest path.
pub fn design_path(option: &str, path: &str) -> Result<Target> {
    let text = Arc::new(Text { origin: option.to_owned(), text: path.to_owned() });
    known_path(&Place::new(&text, trimmed(path, 0..path.len())))
}

/// An option's statement at fault as a whole.
pub fn option_error(option: &str, statement: &str, problem: &str, expected: &str) -> Error {
    let text = Arc::new(Text { origin: option.to_owned(), text: statement.to_owned() });
    Place::new(&text, 0..statement.len()).error(problem, expected)
}

fn known_path(path: &Place) -> Result<Target> {
    let name = path.written();
    if name.is_empty() {
        return Err(path.error("there is no path before the `=`", EXAMPLE));
    }
    parameter_path(name).ok_or_else(|| {
        let paths = PARAMETERS.iter().map(|info| info.path);
        // A key of the study or card may end in a path that can be swept.
        let help = nearest(name, paths).map(|near| format!("did you mean `{near}`?"));
        let expected = "expected a design path, such as fluid.nominal_viscosity";
        path.error_with(format!("unknown path `{name}`"), expected, help)
    })
}

fn end_value(end: &Place, quantity: Quantity, other_unit: &str) -> Result<f64> {
    let written = end.written();
    if let Ok(number) = written.replace('−', "-").parse::<f64>()
        && number.is_finite()
    {
        if other_unit.is_empty() {
            return units::bare(number, written, quantity)
                .map_err(|error| end.error_with(error.problem, error.expected, error.help));
        }
        // The unit is at fault, if any, at the end where it is written.
        return units::parse(&format!("{written} {other_unit}"), quantity)
            .map_err(|error| end.error_with(error.problem, error.expected, error.help));
    }
    units::parse(written, quantity).map_err(|error| {
        let start = end.span.start;
        let place = match error.span.is_empty() {
            true => end.clone(),
            false => Place::new(&end.text, start + error.span.start..start + error.span.end),
        };
        place.error_with(error.problem, error.expected, error.help)
    })
}

fn number_of_values(place: &Place) -> Result<usize> {
    let expected = format!("expected a whole number from 2 to {MOST_SETTINGS}");
    match place.written().parse::<u64>() {
        Ok(count @ 2..=MOST_SETTINGS) => Ok(count as usize),
        Ok(1) => {
            let help = "for one value use --set with another command";
            Err(place.error_with("one value is no range", expected, Some(help.to_owned())))
        }
        Ok(count) if count > MOST_SETTINGS => {
            Err(place.error(format!("{count} values are too many"), expected))
        }
        _ => Err(place.error("this is not a number of values", expected)),
    }
}

/// The stretch without blanks at its ends.
fn trimmed(text: &str, span: Range<usize>) -> Range<usize> {
    let part = text.get(span.clone()).unwrap_or("");
    let start = span.start + (part.len() - part.trim_start().len());
    start..start + part.trim().len()
}
