//! Design paths and design values as a person writes them, checked.

use super::document::{Key, Node, Value};
use super::vocabulary::CARD;
use crate::error::Result;
use crate::physics::design::{Design, Target};
use crate::physics::parameters::{PARAMETERS, Parameter, ParameterInfo};
use crate::units::spelling::nearest;

/// The target of a dotted path: `brake.gap[3]` is the gap of surface 3, counted from 1.
pub(super) fn parameter_path(path: &str) -> Option<Target> {
    if let Some(parameter) = Parameter::from_path(path) {
        return Some(Target::whole(parameter));
    }
    let number = path.strip_prefix(Parameter::BrakeGap.info().path)?;
    let number = number.strip_prefix('[')?.strip_suffix(']')?.trim();
    if !number.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let surface: usize = number.parse().ok()?;
    Some(Target::gap(surface.checked_sub(1)?))
}

/// The diagnostic of an input that nothing knows.
pub(super) fn unknown_input(path: &str, key: &Key) -> crate::error::Error {
    let paths = PARAMETERS.iter().map(|info| info.path);
    let groups = paths.clone().filter_map(|path| path.split_once('.')).map(|(group, _)| group);
    let others = CARD.iter().map(|info| info.name);
    let help = nearest(path, paths.chain(others).chain(groups));
    key.place.error_with(
        format!("unknown input `{path}`"),
        "expected a dotted path, such as [brake.gap] or [initial.temperature]",
        help.map(|near| format!("did you mean `{near}`?")),
    )
}

/// A value as written, without its quotes.
pub(super) fn written(node: &Node) -> String {
    match &node.value {
        Value::String(text) => text.trim().to_owned(),
        _ => node.place.written().trim().to_owned(),
    }
}

/// "expected a value between 1 and 1000", in SI.
pub(super) fn possible_range(parameter: Parameter) -> String {
    let info = parameter.info();
    let unit = info.quantity.si_unit();
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let (lower, upper) = (info.lower, info.upper);
    match (upper.is_finite(), info.open) {
        (false, true) => format!("expected more than {lower}{unit}"),
        (false, false) => format!("expected {lower}{unit} or more"),
        (true, true) => format!("expected a value strictly between {lower} and {upper}{unit}"),
        (true, false) => format!("expected a value from {lower} to {upper}{unit}"),
    }
}

/// Checks that a gap's surface exists.
pub(super) fn check_surface(target: Target, design: &Design<f64>, key: &Key) -> Result<()> {
    match target.surface {
        Some(surface) if surface >= design.surfaces() => {
            let problem = format!("there is no working surface {}", surface + 1);
            let last = design.surfaces();
            let expected = format!("expected brake.gap[1] to brake.gap[{last}]: two a rotor");
            Err(key.place.error(problem, expected))
        }
        _ => Ok(()),
    }
}

/// Checks that a value lies in the closure of what the parameter admits.
pub(super) fn check_possible(
    parameter: &ParameterInfo,
    key: &str,
    value: f64,
    node: &Node,
) -> Result<()> {
    if (parameter.lower..=parameter.upper).contains(&value) {
        return Ok(());
    }
    let problem = format!("{key} = {} is impossible for {}", written(node), parameter.path);
    Err(node.place.error(problem, possible_range(parameter.parameter)))
}
