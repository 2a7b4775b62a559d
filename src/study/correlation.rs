//! Statements of dependence, and the joint distribution that they make.

use super::document::{Node, Value};
use super::place::Place;
use super::read::{self, Section};
use super::together::already_dependent;
use super::values::parameter_path;
use super::vocabulary::CORRELATION;
use super::{Correlation, Input};
use crate::error::{Error, Result};
use crate::physics::design::Target;
use crate::physics::parameters::{PARAMETERS, Parameter};
use crate::uncertainty::{
    Copula, Joint, JointSample, Marginal, Measure, NEAREST_TO_ONE, Refusal, Statement,
};
use crate::units::Quantity;
use crate::units::number;
use crate::units::spelling::nearest;
use std::collections::BTreeMap;
use std::sync::Arc;

const EXAMPLE: &str = "[\"thermal.fluid_capacity\", \"thermal.rotor_capacity\"]";

/// The most surfaces of which one statement correlates every two: a mistake among more pairs than
/// these would take minutes to find.
const MOST_SURFACES: usize = 64;

/// The key of a kind of coefficient, and what it makes of the number.
type MeasureKey = (&'static str, fn(f64) -> Measure);

/// The keys of the kinds of coefficient.
pub(super) const MEASURES: [MeasureKey; 3] =
    [("normal", Measure::Normal), ("spearman", Measure::Spearman), ("kendall", Measure::Kendall)];

/// A statement with the place that a complaint about it points to.
struct Placed {
    correlation: Correlation,
    place: Place,
}

/// The joint distribution of inputs, and the statements behind it, pair by pair.
///
/// # Errors
/// A diagnostic: an unknown key or input, a coefficient outside (−1, 1), two statements about a
/// pair, coefficients that no distribution can have together.
pub(super) fn joint(
    inputs: &[Input],
    samples: Vec<JointSample>,
    statements: &[Node],
) -> Result<(Joint, Vec<Correlation>)> {
    let mut by_pair: BTreeMap<(usize, usize), Placed> = BTreeMap::new();
    for statement in statements {
        for new in read_statement(inputs, statement)? {
            let pair = new.correlation.between;
            let drawn = |k: &&usize| samples.iter().any(|sample| sample.inputs().contains(k));
            if let Some(&k) = [pair.0, pair.1].iter().find(drawn) {
                let path = inputs.get(k).map_or(String::new(), |input| input.target.path());
                return Err(already_dependent(statement, &path));
            }
            // A later card wins, as it does for inputs; within one card a pair is stated once.
            if by_pair.get(&pair).is_some_and(|old| Arc::ptr_eq(&old.place.text, &new.place.text)) {
                let problem = "duplicate correlation for this pair";
                return Err(new.place.error(problem, "expected one statement for each pair"));
            }
            by_pair.insert(pair, new);
        }
    }
    let placed: Vec<Placed> = by_pair.into_values().collect();
    let marginals: Vec<Marginal> = inputs.iter().map(|input| input.marginal.clone()).collect();
    if placed.is_empty() {
        return Ok((Joint::independent(marginals).with_samples(samples)?, Vec::new()));
    }
    let statements: Vec<Statement> = placed
        .iter()
        .map(
            |Placed {
                 correlation: Correlation { between: (first, second), measure, .. }, ..
             }| { Statement { first: *first, second: *second, measure: *measure } },
        )
        .collect();
    let copula = Copula::new(inputs.len(), &statements)
        .map_err(|refusal| blame(inputs, &placed, refusal))?;
    let joint = Joint::new(marginals, Some(copula))?.with_samples(samples)?;
    Ok((joint, placed.into_iter().map(|placed| placed.correlation).collect()))
}

fn read_statement(inputs: &[Input], statement: &Node) -> Result<Vec<Placed>> {
    let entries = read::table(statement, &format!("between = {EXAMPLE}"))?;
    let section = Section::new("[[correlation]]", &statement.place, entries, CORRELATION)?;
    let between = section.require("between", EXAMPLE)?;
    let Value::Array(names) = &between.value else {
        let problem = format!("this is {}", between.value.described());
        return Err(between
            .place
            .error(problem, format!("expected two inputs, such as {EXAMPLE}")));
    };
    let [first, second] = names.as_slice() else {
        let problem = format!("two inputs must be named, not {}", names.len());
        return Err(between
            .place
            .error(problem, format!("expected two inputs, such as {EXAMPLE}")));
    };
    let stated: Vec<_> = MEASURES
        .iter()
        .filter_map(|(name, measure)| Some((measure, section.entry(name)?)))
        .collect();
    let measures = "expected one of `normal`, `spearman`, `kendall`";
    let (measure, node) = match stated.as_slice() {
        [(measure, (_, node))] => (measure, node),
        [] => {
            let problem = "the correlation has no coefficient";
            return Err(statement.place.error(problem, measures));
        }
        [_, (_, (key, _)), ..] => {
            return Err(key.place.error("the correlation has two coefficients", measures));
        }
    };
    let coefficient = read::quantity(node, Quantity::Number)?;
    if !(coefficient > -1.0 && coefficient < 1.0) {
        let problem = format!("the correlation {coefficient} is impossible");
        return Err(node.place.error(problem, "expected a number strictly between -1 and 1"));
    }
    let source = section.require("source", "\"…\": where the coefficient comes from")?;
    let source = read::string(source, "where the coefficient comes from")?.trim().to_owned();
    let pairs = pairs(inputs, first, second)?;
    Ok(pairs
        .into_iter()
        .map(|(a, b)| Placed {
            correlation: Correlation {
                between: (a.min(b), a.max(b)),
                measure: measure(coefficient),
                source: source.clone(),
            },
            place: node.place.clone(),
        })
        .collect())
}

/// The pairs of inputs that two names stand for: one, or every two surfaces.
fn pairs(inputs: &[Input], first: &Node, second: &Node) -> Result<Vec<(usize, usize)>> {
    let (a, b) = (places(inputs, first)?, places(inputs, second)?);
    match (a.as_slice(), b.as_slice()) {
        ([a], [b]) if a == b => {
            let problem = "an input is correlated with itself";
            Err(second.place.error(problem, "expected two different inputs"))
        }
        ([a], [b]) => Ok(vec![(*a, *b)]),
        _ if a == b && a.len() > MOST_SURFACES => {
            let problem = format!("brake.gap stands for {} surfaces", a.len());
            let expected =
                format!("expected at most {MOST_SURFACES}, or statements of single pairs");
            Err(second.place.error(problem, expected))
        }
        _ if a == b => {
            let all = &a;
            Ok(all
                .iter()
                .enumerate()
                .flat_map(|(k, &one)| all.iter().skip(k + 1).map(move |&other| (one, other)))
                .collect())
        }
        _ => {
            let node = if a.len() > 1 { first } else { second };
            let problem = "brake.gap stands for an input on every surface";
            let expected =
                "expected one surface, such as \"brake.gap[1]\", or brake.gap on both sides";
            Err(node.place.error(problem, expected))
        }
    }
}

/// The places of the inputs that a name stands for; never none.
fn places(inputs: &[Input], node: &Node) -> Result<Vec<usize>> {
    let name = read::string(node, "the path of an input")?;
    let target = parameter_path(name);
    let exact = inputs.iter().position(|input| Some(input.target) == target);
    if let Some(place) = exact {
        return Ok(vec![place]);
    }
    if target == Some(Target::whole(Parameter::BrakeGap)) {
        let gaps: Vec<usize> = (0..inputs.len())
            .filter(|&k| inputs.get(k).is_some_and(|i| i.target.parameter == Parameter::BrakeGap))
            .collect();
        if !gaps.is_empty() {
            return Ok(gaps);
        }
    }
    if target.is_some() {
        let problem = format!("{name} is not uncertain in this card");
        return Err(node
            .place
            .error(problem, format!("expected an input that has a law: [{name}]")));
    }
    let paths = PARAMETERS.iter().map(|info| info.path);
    let help = nearest(name, paths).map(|near| format!("did you mean \"{near}\"?"));
    let problem = format!("unknown input \"{name}\"");
    Err(node.place.error_with(problem, "expected the path of an uncertain input", help))
}

/// The diagnostic of coefficients that no distribution can have together.
fn blame(inputs: &[Input], placed: &[Placed], refusal: Refusal) -> Error {
    let Some(culprit) = placed.get(refusal.statement) else { return refusal.into() };
    let (a, b) = culprit.correlation.between;
    let path = |k: usize| inputs.get(k).map_or(String::new(), |input| input.target.path());
    if refusal.alone {
        // What a single statement can say wrong was refused where it was read, but for this.
        let problem = format!("the correlation makes {} and {} one input", path(a), path(b));
        let expected =
            format!("expected at most {NEAREST_TO_ONE} in size, or the two as a single input");
        return culprit.place.error(problem, expected);
    }
    let is_same = |other: &&Placed| {
        Arc::ptr_eq(&other.place.text, &culprit.place.text)
            && other.place.span == culprit.place.span
    };
    // What one pair may be says nothing of a statement about all surfaces.
    let alone = placed.iter().filter(is_same).count() == 1;
    let help = refusal.admissible.filter(|_| alone).map(|(least, most)| {
        format!("the others leave it {} to {}", number(least, 3), number(most, 3))
    });
    culprit.place.error_with(
        format!("the correlation of {} and {} contradicts the others", path(a), path(b)),
        "expected correlations that one distribution can have (a positive definite matrix)",
        help,
    )
}
