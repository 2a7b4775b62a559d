//! Reading "0.062 in" into SI.

use super::Quantity;
use super::spelling::nearest;
use super::table::{DYNAMIC_VISCOSITY, Dimension, FORCE, MASS, RATE, UNITS, Unit, dimension_name};
use std::ops::Range;

/// Why a text is not a value of the quantity that was expected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitError {
    /// The bytes of the text that are wrong.
    pub span: Range<usize>,
    /// What is wrong.
    pub problem: String,
    /// What was expected, with an example.
    pub expected: String,
    /// What to write instead, where that can be guessed.
    pub help: Option<String>,
}

/// Takes a number without a unit, which only a pure number is. `written` is the number as its text stands.
///
/// # Errors
/// A quantity with a dimension, with how to write it: also 0, which is three different temperatures.
pub fn bare(value: f64, written: &str, quantity: Quantity) -> Result<f64, UnitError> {
    match quantity {
        Quantity::Number => Ok(value),
        _ => Err(without_unit(written, 0..written.len(), quantity)),
    }
}

/// The error of a number whose unit is missing.
fn without_unit(written: &str, span: Range<usize>, quantity: Quantity) -> UnitError {
    let units = quantity.usual_units();
    let choices: Vec<String> =
        units.iter().map(|unit| format!("\"{} {unit}\"", written.trim())).collect();
    let choices = match choices.as_slice() {
        [all @ .., last] if !all.is_empty() => format!("{} or {last}", all.join(", ")),
        few => few.join(""),
    };
    UnitError {
        span,
        problem: format!("{} has no unit", written.trim()),
        expected: format!(
            "expected {} with its unit, such as \"{}\"",
            quantity.described(),
            quantity.example()
        ),
        help: Some(format!("write {choices}")),
    }
}

/// Reads a number with its unit, in SI: `parse("0.062 in", Quantity::Length)` is 0.0015748.
///
/// Units multiply (`·`, `*`, a space, a hyphen), divide (`/`) and are raised to whole powers (`²`, `2`,
/// `^2`, `**2`). What follows a `/` up to the next `·`, `*` or space is divided by: of hyphens, and of what
/// stands in parentheses, all. A point on a temperature scale takes the scale's zero into account, a difference and a
/// unit inside a product do not. Only a pure number needs no unit.
///
/// # Errors
/// [`UnitError`]: not a number, an unknown unit (with the nearest known one), a unit of another quantity.
pub fn parse(text: &str, quantity: Quantity) -> Result<f64, UnitError> {
    let reader = Reader { text, quantity };
    let (number, rest) = reader.number()?;
    let factors = reader.factors(rest)?;
    reader.convert(&number, &factors)
}

/// A number and the digits that it was read from.
struct Number {
    value: f64,
    digits: String,
}

impl Number {
    /// The number times 10 to the power `shift`, rounded once: "99.73 %" is 0.9973.
    fn shifted(&self, shift: i32) -> f64 {
        let (mantissa, exponent) =
            self.digits.split_once(['e', 'E']).unwrap_or((&self.digits, "0"));
        let exponent = exponent.parse::<i32>().unwrap_or(0).saturating_add(shift);
        format!("{mantissa}e{exponent}").parse().unwrap_or(f64::NAN)
    }
}

/// One unit of a product, with its power.
struct Factor {
    unit: &'static Unit,
    power: i8,
    span: Range<usize>,
}

struct Reader<'a> {
    text: &'a str,
    quantity: Quantity,
}

impl Reader<'_> {
    fn error(&self, span: Range<usize>, problem: String, help: Option<String>) -> UnitError {
        let quantity = self.quantity;
        let expected =
            format!("expected {}, such as \"{}\"", quantity.described(), quantity.example());
        UnitError { span, problem, expected, help }
    }

    /// The number at the start, and where the rest begins.
    fn number(&self) -> Result<(Number, usize), UnitError> {
        let start = self.text.len() - self.text.trim_start().len();
        let mut digits = String::new();
        let mut end = start;
        let mut previous = ' ';
        let mut characters = self.text[start..].char_indices().peekable();
        while let Some((offset, character)) = characters.next() {
            let next = characters.peek().map_or(' ', |&(_, next)| next);
            let sign = matches!(character, '+' | '-' | '−');
            let part = match character {
                '0'..='9' | '.' => true,
                '_' => previous.is_ascii_digit() && next.is_ascii_digit(),
                'e' | 'E' => {
                    previous.is_ascii_digit() && self.is_exponent(start + offset + 1)
                        || previous == '.' && self.is_exponent(start + offset + 1)
                }
                _ => sign && (offset == 0 || matches!(previous, 'e' | 'E')),
            };
            if !part {
                break;
            }
            match character {
                '_' => {}
                '−' => digits.push('-'),
                other => digits.push(other),
            }
            previous = character;
            end = start + offset + character.len_utf8();
        }
        let whole = start..self.text.trim_end().len().max(start);
        let value: f64 = match digits.parse() {
            Ok(value) => value,
            Err(_) => {
                let problem = format!("\"{}\" does not start with a number", self.text.trim());
                return Err(self.error(whole, problem, None));
            }
        };
        if !value.is_finite() {
            let problem = format!("{} is too large for a number", &self.text[start..end]);
            return Err(self.error(start..end, problem, None));
        }
        let rest = self.text[end..].trim_start();
        if rest.starts_with([',', '.', '_']) || rest.starts_with(|c: char| c.is_ascii_digit()) {
            let span = self.text.len() - rest.len()..whole.end;
            let help = "write a number without separators, with a decimal point: 1000.5";
            let problem = format!("\"{}\" after the number {digits} is not a unit", rest.trim());
            return Err(self.error(span, problem, Some(help.to_owned())));
        }
        Ok((Number { value, digits }, end))
    }

    /// Whether the digits of an exponent start at `at`, after an optional sign.
    fn is_exponent(&self, at: usize) -> bool {
        let rest = self.text.get(at..).unwrap_or("");
        rest.strip_prefix(['+', '-', '−']).unwrap_or(rest).starts_with(|c: char| c.is_ascii_digit())
    }

    fn factors(&self, start: usize) -> Result<Vec<Factor>, UnitError> {
        let text = self.text;
        let mut factors: Vec<Factor> = Vec::new();
        let mut at = start;
        let mut sign = 1i8;
        // True where a unit must follow: after an operator.
        let mut pending: Option<usize> = None;
        // Where a denominator in parentheses began.
        let mut open: Option<usize> = None;
        loop {
            at += text[at..].len() - text[at..].trim_start().len();
            let Some(character) = text[at..].chars().next() else { break };
            let power_mark = text[at..].starts_with("**") || character == '^';
            let hyphen =
                matches!(character, '-' | '‐' | '‑') && self.is_name(at + character.len_utf8());
            if (matches!(character, '·' | '⋅' | '∙' | '•' | '*' | '/') || hyphen) && !power_mark
            {
                // "1/s" has no unit before its operator; "/s" after nothing but a number neither.
                if pending.is_some() || factors.is_empty() && character != '/' {
                    let problem = format!("`{character}` has no unit before it");
                    return Err(self.error(at..at + character.len_utf8(), problem, None));
                }
                if character == '/' && open.is_some() {
                    let problem = "a `/` inside parentheses is ambiguous".to_owned();
                    return Err(self.error(at..at + 1, problem, None));
                }
                sign = match character {
                    '/' => -1,
                    // A hyphen joins what belongs together: BTU/h-°F.
                    _ if hyphen => factors.last().map_or(1, |last| last.power.signum()),
                    _ => 1,
                };
                pending = Some(at);
                at += character.len_utf8();
                continue;
            }
            if character == '(' && open.is_none() && pending.is_some() && sign == -1 {
                open = Some(at);
                at += 1;
                continue;
            }
            if character == ')' && open.is_some() && pending.is_none() {
                open = None;
                at += 1;
                continue;
            }
            let (unit, end) = self.unit_at(at)?;
            let name_start = at;
            at = end;
            let power = self.power(&mut at)?;
            let sign_here = if open.is_some() { -1 } else { sign };
            factors.push(Factor { unit, power: sign_here * power, span: name_start..at });
            sign = 1;
            pending = None;
        }
        if let Some(operator) = pending.or(open) {
            let problem = match open {
                Some(_) => "a parenthesis is not closed".to_owned(),
                None => "a unit is missing after the operator".to_owned(),
            };
            return Err(self.error(operator..text.trim_end().len(), problem, None));
        }
        Ok(factors)
    }

    /// Whether a unit's name begins at `at`.
    fn is_name(&self, at: usize) -> bool {
        self.text.get(at..).unwrap_or("").chars().next().is_some_and(is_unit_character)
    }

    /// Where the name that begins at `at` ends.
    fn name_end(&self, at: usize) -> usize {
        let rest = self.text.get(at..).unwrap_or("");
        let end = rest.char_indices().find(|&(_, c)| !is_unit_character(c));
        end.map_or(self.text.len(), |(offset, _)| at + offset)
    }

    /// The unit whose name begins at `at`, and where it ends; also "pound-force" and "deg F".
    fn unit_at(&self, at: usize) -> Result<(&'static Unit, usize), UnitError> {
        let first = self.text[at..].chars().next().map_or(0, char::len_utf8);
        let end = self.name_end(at).max(at + first);
        let rest = self.text.get(end..).unwrap_or("");
        let blank = rest.len() - rest.trim_start().len();
        let join = match rest.strip_prefix('-') {
            Some(_) => Some((end + 1, "-")),
            None if blank > 0 => Some((end + blank, "")),
            None => None,
        };
        if let Some((next, between)) = join {
            let last = self.name_end(next);
            let degree = match self.text.get(at..end) {
                Some("deg" | "degree" | "degrees" | "°" | "º") => "°",
                _ if between.is_empty() => "?",
                Some(other) => other,
                None => "?",
            };
            let joined = format!("{degree}{between}{}", self.text.get(next..last).unwrap_or(""));
            let name = match joined.as_str() {
                "°Fahrenheit" => "Fahrenheit",
                "°Celsius" => "Celsius",
                "°Rankine" => "Rankine",
                other => other,
            };
            let found = UNITS.iter().find(|unit| unit.names.contains(&name));
            if let (Some(unit), true) = (found, last > next) {
                return Ok((unit, last));
            }
        }
        Ok((self.unit(at..end)?, end))
    }

    fn unit(&self, span: Range<usize>) -> Result<&'static Unit, UnitError> {
        let name = &self.text[span.clone()];
        if let Some(unit) = UNITS.iter().find(|unit| unit.names.contains(&name)) {
            return Ok(unit);
        }
        let wanted = self.quantity.dimension();
        let help = match name {
            "F" | "f" => Some("write °F or degF".to_owned()),
            "C" | "c" => Some("write °C or degC".to_owned()),
            _ => {
                // A near spelling of the quantity's own dimension is likelier than any other.
                let fitting = UNITS.iter().filter(|unit| unit.dimension == wanted);
                let candidates = |units: &mut dyn Iterator<Item = &'static Unit>| {
                    nearest(name, units.flat_map(|unit| unit.names.iter().copied()))
                };
                candidates(&mut fitting.into_iter())
                    .or_else(|| candidates(&mut UNITS.iter()))
                    .map(|name| format!("did you mean `{name}`?"))
            }
        };
        Err(self.error(span.clone(), format!("unknown unit `{name}`"), help))
    }

    /// The power at `at`, which moves behind it; 1 where there is none.
    fn power(&self, at: &mut usize) -> Result<i8, UnitError> {
        let start = *at;
        let rest = &self.text[start..];
        let minus = usize::from(rest.starts_with('-'));
        let plain = match rest[minus..].bytes().take_while(u8::is_ascii_digit).count() {
            0 => 0,
            digits => digits + minus,
        };
        let marked = rest.strip_prefix("**").or_else(|| rest.strip_prefix('^'));
        let (digits, length) = match marked {
            Some(after) => {
                let sign = usize::from(after.starts_with('-'));
                let digits = after[sign..].bytes().take_while(u8::is_ascii_digit).count() + sign;
                (after[..digits].to_owned(), rest.len() - after.len() + digits)
            }
            // m2, s-1: as it is typed where there is no raised digit.
            None if plain > 0 => (rest[..plain].to_owned(), plain),
            None => {
                let raised: String = rest.chars().map_while(superscript).collect();
                let length = rest.chars().take(raised.chars().count()).map(char::len_utf8).sum();
                if raised.is_empty() {
                    return Ok(1);
                }
                (raised, length)
            }
        };
        *at = start + length;
        match digits.parse::<i8>() {
            Ok(power) if power != 0 && power.abs() <= 9 => Ok(power),
            _ => {
                let end = (start + length).max(start + 1).min(self.text.len());
                let problem = "a power is a whole number from -9 to 9, not 0".to_owned();
                Err(self.error(start..end, problem, None))
            }
        }
    }

    fn convert(&self, number: &Number, factors: &[Factor]) -> Result<f64, UnitError> {
        let mut dimension: Dimension = [0; 4];
        let (mut numerator, mut denominator) = (1.0, 1.0);
        for factor in factors {
            for (sum, exponent) in dimension.iter_mut().zip(factor.unit.dimension) {
                *sum = sum.saturating_add(exponent.saturating_mul(factor.power));
            }
            for _ in 0..factor.power.unsigned_abs() {
                let (up, down) = (factor.unit.numerator, factor.unit.denominator);
                let (up, down) = if factor.power > 0 { (up, down) } else { (down, up) };
                numerator *= up;
                denominator *= down;
            }
        }
        let span = match (factors.first(), factors.last()) {
            (Some(first), Some(last)) => first.span.start..last.span.end,
            _ => {
                let start = self.text.len() - self.text.trim_start().len();
                start..self.text.trim_end().len().max(start)
            }
        };
        if factors.is_empty() && self.quantity != Quantity::Number {
            return Err(without_unit(self.text, span, self.quantity));
        }
        if dimension != self.quantity.dimension() {
            let units = &self.text[span.clone()];
            let problem = format!("`{units}` is a unit of {}", dimension_name(dimension));
            return Err(self.error(span, problem, self.confusion(units, dimension)));
        }
        let zero = match factors {
            [only] if self.quantity == Quantity::Temperature => only.unit.zero,
            _ => 0.0,
        };
        let si = match power_of_ten(numerator, denominator) {
            Some(shift) if zero == 0.0 => number.shifted(shift),
            _ => (number.value + zero) * numerator / denominator,
        };
        if si.is_finite() {
            Ok(si)
        } else {
            Err(self.error(span, "the value is too large in SI".to_owned(), None))
        }
    }

    /// The unit that was probably meant, for the usual confusions.
    fn confusion(&self, units: &str, dimension: Dimension) -> Option<String> {
        Some(match (self.quantity, dimension) {
            (Quantity::Force, MASS) if units.contains("lb") || units.contains("pound") => {
                format!("{units} is a mass; write lbf")
            }
            (Quantity::Force, MASS) => format!("{units} is a mass; write N or kgf"),
            (Quantity::Mass, FORCE) if units == "lbf" => "lbf is a force; write lb".to_owned(),
            (Quantity::Mass, FORCE) => format!("{units} is a weight; write kg or lb"),
            (Quantity::KinematicViscosity, DYNAMIC_VISCOSITY) => {
                "that is the dynamic viscosity; divide by the density and write cSt".to_owned()
            }
            (Quantity::Speed, RATE) => "write ft/s or m/s".to_owned(),
            _ => return None,
        })
    }
}

/// The exponent of `numerator / denominator`, if it is a small power of ten.
fn power_of_ten(numerator: f64, denominator: f64) -> Option<i32> {
    // Powers of ten are exact up to 10²².
    let exponent = |value: f64| {
        let powers = std::iter::successors(Some(1.0), |power| Some(power * 10.0));
        (0..=22).zip(powers).find(|&(_, power)| power == value).map(|(exponent, _)| exponent)
    };
    Some(exponent(numerator)? - exponent(denominator)?)
}

/// Whether a character can be part of a unit's name.
fn is_unit_character(character: char) -> bool {
    character.is_alphabetic()
        || matches!(character, '°' | 'º' | '%' | '"' | '\'' | '′' | '″' | '℃' | '℉')
}

/// The plain digit or sign of a superscript one.
fn superscript(character: char) -> Option<char> {
    Some(match character {
        '⁰' => '0',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁴' => '4',
        '⁵' => '5',
        '⁶' => '6',
        '⁷' => '7',
        '⁸' => '8',
        '⁹' => '9',
        '⁻' => '-',
        '⁺' => '+',
        _ => return None,
    })
}
