//! Names of factors: groups of inputs, and `pairs` of `[sensitivity]`, whose second-order index is asked for.

use super::document::{Node, Value};
use super::values::parameter_path;
use super::{Input, read};
use crate::error::Result;
use crate::physics::design::Target;
use crate::units::spelling::nearest;

const EXAMPLE: &str = "[[\"fluid.shear_factor\", \"initial.temperature\"]]";

/// The pairs, by path of the input or name of the group.
pub(super) fn pairs(node: &Node, inputs: &[Input]) -> Result<Vec<(String, String)>> {
    let list = |node: &Node| match &node.value {
        Value::Array(items) => Ok(items.clone()),
        other => {
            let problem = format!("this is {}", other.described());
            let expected = format!("expected a list of pairs, such as {EXAMPLE}");
            Err(node.place.error(problem, expected))
        }
    };
    let mut found: Vec<(String, String)> = Vec::new();
    for pair in list(node)? {
        let names = list(&pair)?;
        let [first, second] = names.as_slice() else {
            let problem = format!("two inputs must be named, not {}", names.len());
            let expected = format!("expected pairs, such as {EXAMPLE}");
            return Err(pair.place.error(problem, expected));
        };
        let (one, other) = (factor(first, inputs)?, factor(second, inputs)?);
        if members(&one, inputs).iter().any(|j| members(&other, inputs).contains(j)) {
            let problem = format!("{one} and {other} share an input, so they have no interaction");
            return Err(second.place.error(problem, "expected two different inputs or groups"));
        }
        let same = |pair: &(String, String)| {
            *pair == (one.clone(), other.clone()) || *pair == (other.clone(), one.clone())
        };
        if found.iter().any(same) {
            let problem = "this pair is named twice";
            return Err(pair.place.error(problem, "expected each pair once"));
        }
        found.push((one, other));
    }
    Ok(found)
}

/// The name of a group of inputs, of which `own` is one. It must not be what another factor is called.
pub(super) fn group(node: &Node, own: Option<Target>) -> Result<String> {
    let name = read::string(node, "the name of a group")?.trim().to_owned();
    let refused = |problem: String| {
        let expected = "expected a name that only this group has, such as \"material data\"";
        Err(node.place.error(problem, expected))
    };
    if name.ends_with("(all)") {
        return refused(format!("\"{name}\" ends in \"(all)\", which is reserved"));
    }
    match parameter_path(&name) {
        Some(path) if own.map(|own| Target::whole(own.parameter)) != Some(path) => {
            refused(format!("\"{name}\" is the name of an input"))
        }
        _ => Ok(name),
    }
}

/// The inputs that a name stands for.
fn members(name: &str, inputs: &[Input]) -> Vec<usize> {
    let all = inputs.iter().enumerate();
    let is = |input: &Input| input.target.path() == name || input.group.as_deref() == Some(name);
    all.filter(|(_, input)| is(input)).map(|(j, _)| j).collect()
}

fn factor(node: &Node, inputs: &[Input]) -> Result<String> {
    let name = read::string(node, "an input")?.trim().to_owned();
    match members(&name, inputs)[..] {
        [] => {}
        // A group of one input is no factor beside that.
        [one] => return Ok(inputs.get(one).map_or(name, |input| input.target.path())),
        _ => return Ok(name),
    }
    let paths: Vec<String> = inputs.iter().map(|input| input.target.path()).collect();
    let groups = inputs.iter().filter_map(|input| input.group.as_deref());
    let known = groups.chain(paths.iter().map(String::as_str));
    let help = nearest(&name, known).map(|near| format!("did you mean \"{near}\"?"));
    let expected = "expected the path of an input of the card, or the name of a group of them";
    Err(node.place.error_with(
        format!("no uncertain input or group is named \"{name}\""),
        expected,
        help,
    ))
}
