//! What may be tightened at what cost, and which design values may move: `cost` of an input, `[trade]`
//! and `[tighten]` of a study.

use super::Known;
use super::document::{Node, Value};
use super::mistakes::Mistakes;
use super::read::{self, Section};
use super::sections::design_entries;
use super::values::{check_surface, possible_range, written};
use super::vocabulary as keys;
use crate::error::Result;
use crate::physics::design::{Design, Target};
use crate::physics::parameters::Parameter;
use crate::sampling;
use crate::units::Quantity;

/// Samples behind each point of a trade curve, unless the study says otherwise.
const DEFAULT_TRADE_SAMPLES: u64 = 20_000;
/// Samples on which a plan is searched for, unless the study says otherwise.
const DEFAULT_TIGHTEN_SAMPLES: u64 = 20_000;
/// Share of its value by which the nominal viscosity may move either way unless the study says otherwise.
const DEFAULT_MOVE: f64 = 0.3;

/// What it costs to narrow the spread of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum TighteningCost {
    /// So much for each halving; a spread factor s costs this · log₂(1/s).
    PerHalving(f64),
    /// Grades that can be bought, the widest first.
    Grades(Vec<Grade>),
    /// It cannot be bought.
    None,
}

impl TighteningCost {
    /// The cost of an input of which none is stated: one for each halving, and none at all of what nobody sells. The
    /// weather of the day and the error of the model itself are no tolerances.
    pub fn usual(parameter: Parameter, known: Known) -> Self {
        match known == Known::OnTheDay || parameter == Parameter::FluidAveragingOffset {
            true => TighteningCost::None,
            false => TighteningCost::PerHalving(1.0),
        }
    }
}

/// A purchasable grade of an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grade {
    /// Spread as a factor of the card's, in [0, 1).
    pub spread: f64,
    /// Its cost, at least 0.
    pub cost: f64,
}

/// How the tolerance trade is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TradePlan {
    /// Samples behind each point of a curve; 0 leaves the trade out.
    pub samples: u64,
}

/// What `reeldown tighten` looks for.
#[derive(Debug, Clone, PartialEq)]
pub struct TightenPlan {
    /// Largest acceptable probability of any breach; without one, the requirement's.
    pub target: Option<f64>,
    /// Samples on which a plan is searched for.
    pub samples: u64,
    /// Design values that may move.
    pub design: Vec<DesignRange>,
}

/// A design value that may move, and how far.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRange {
    /// Where the value goes.
    pub target: Target,
    /// Smallest value, SI.
    pub lower: f64,
    /// Largest value, SI.
    pub upper: f64,
}

/// `cost` of an input.
pub(super) fn cost(node: &Node) -> Result<TighteningCost> {
    let expected = "expected a number (the cost of each halving of the spread), \"none\", or a list of \
                    grades such as [{ spread = 0.5, cost = 100 }]";
    match &node.value {
        Value::Integer(..) | Value::Float(_) => {
            let value = not_negative(node, "a cost")?;
            Ok(TighteningCost::PerHalving(value))
        }
        Value::String(text) if text.trim() == "none" => Ok(TighteningCost::None),
        Value::Array(items) if !items.is_empty() => {
            let mut grades = items.iter().map(grade).collect::<Result<Vec<_>>>()?;
            grades.sort_by(|a, b| b.spread.total_cmp(&a.spread));
            if grades.windows(2).any(|pair| pair[0].spread == pair[1].spread) {
                return Err(node
                    .place
                    .error("two grades have the same spread", "expected each once"));
            }
            Ok(TighteningCost::Grades(grades))
        }
        other => {
            let problem = match other {
                Value::String(text) => format!("invalid cost \"{text}\""),
                Value::Array(_) => "the list of grades is empty".to_owned(),
                other => format!("this is {}", other.described()),
            };
            Err(node.place.error(problem, expected))
        }
    }
}

fn grade(node: &Node) -> Result<Grade> {
    let example = "{ spread = 0.5, cost = 100 }";
    let section = Section::new("a grade", &node.place, read::table(node, example)?, keys::GRADE)?;
    let spread_node = section.require("spread", "0.5")?;
    let spread = read::quantity(spread_node, Quantity::Number)?;
    if !(0.0..1.0).contains(&spread) {
        let problem = format!("the spread factor {} is impossible", written(spread_node));
        let expected = "expected a factor of the card's spread, from 0 to less than 1";
        return Err(spread_node.place.error(problem, expected));
    }
    Ok(Grade { spread, cost: not_negative(section.require("cost", "100")?, "a cost")? })
}

fn not_negative(node: &Node, what: &str) -> Result<f64> {
    let value = read::quantity(node, Quantity::Number)?;
    if value >= 0.0 {
        return Ok(value);
    }
    let problem = format!("{what} of {} is impossible", written(node));
    Err(node.place.error(problem, "expected a number that is not negative"))
}

/// `[trade]`.
pub(super) fn trade(node: Option<&Node>) -> Result<TradePlan> {
    let mut plan = TradePlan { samples: DEFAULT_TRADE_SAMPLES };
    let Some(node) = node else { return Ok(plan) };
    let entries = read::table(node, "{ samples = 20_000 }")?;
    let section = Section::new("[trade]", &node.place, entries, keys::TRADE)?;
    if let Some(node) = section.get("samples") {
        plan.samples = samples(node, true)?;
    }
    Ok(plan)
}

/// A number of samples from which a proportion can be told.
fn samples(node: &Node, or_none: bool) -> Result<u64> {
    let count = read::integer(node, 0, sampling::MAX_SAMPLES, "20_000")?;
    if count >= 100 || count == 0 && or_none {
        return Ok(count);
    }
    let none = if or_none { "0 (no trade) or " } else { "" };
    let expected = format!("expected {none}at least 100");
    Err(node
        .place
        .error(format!("{count} samples are too few to estimate a probability"), expected))
}

/// `[tighten]`; without design variables, the nominal viscosity may move.
pub(super) fn tighten(node: Option<&Node>, design: &Design<f64>) -> Result<TightenPlan> {
    let target = Target::whole(Parameter::FluidNominalViscosity);
    let nominal = design.at(target);
    let usual = DesignRange {
        target,
        lower: (1.0 - DEFAULT_MOVE) * nominal,
        upper: (1.0 + DEFAULT_MOVE) * nominal,
    };
    let mut plan =
        TightenPlan { target: None, samples: DEFAULT_TIGHTEN_SAMPLES, design: vec![usual] };
    let Some(node) = node else { return Ok(plan) };
    let entries = read::table(node, "{ target = 0.01 }")?;
    let section = Section::new("[tighten]", &node.place, entries, keys::TIGHTEN)?;
    if let Some(node) = section.get("target") {
        plan.target = Some(read::open_share(node, "target", "0.01")?);
    }
    if let Some(node) = section.get("samples") {
        plan.samples = samples(node, false)?;
    }
    if let Some(node) = section.get("design") {
        plan.design = design_ranges(node, design)?;
    }
    Ok(plan)
}

fn design_ranges(node: &Node, design: &Design<f64>) -> Result<Vec<DesignRange>> {
    let example = "[\"90000 cSt\", \"140000 cSt\"]";
    let mut ranges = Vec::new();
    let mut mistakes = Mistakes::default();
    let entries = design_entries(node, &mut mistakes);
    mistakes.none_or(Some(()))?;
    for entry in entries {
        check_surface(entry.target, design, &entry.key)?;
        let parameter = entry.target.parameter;
        if parameter == Parameter::BrakeRotors {
            let expected = "expected a continuous parameter; the number of rotors is an integer";
            return Err(entry.key.place.error("brake.rotors cannot be varied", expected));
        }
        let ends = match &entry.node.value {
            Value::Array(items) if items.len() == 2 => items,
            other => {
                let problem = format!("this is {}", other.described());
                let expected = format!("expected a range of two values, such as {example}");
                return Err(entry.node.place.error(problem, expected));
            }
        };
        let end = |node: &Node| {
            let value = read::quantity(node, parameter.info().quantity)?;
            if parameter.info().admits(value) {
                return Ok(value);
            }
            let problem = format!("{} = {} is impossible", entry.target.path(), written(node));
            Err(node.place.error(problem, possible_range(parameter)))
        };
        let (lower, upper) = (end(&ends[0])?, end(&ends[1])?);
        if lower >= upper {
            let problem = format!("the range of {} is empty", entry.target.path());
            let expected = format!("expected the smaller value first, such as {example}");
            return Err(entry.node.place.error(problem, expected));
        }
        ranges.push(DesignRange { target: entry.target, lower, upper });
    }
    ranges.sort_by_key(|range| range.target);
    Ok(ranges)
}
