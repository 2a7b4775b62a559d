//! The sections of a study file, one function each.

use super::document::{Key, Node, Value};
use super::mistakes::{Mistakes, all};
use super::read::{self, Section};
use super::until;
use super::values::{check_surface, parameter_path, possible_range, written};
use super::vocabulary as keys;
use super::{
    Limit, LimitKind, Numerics, RareMethod, ReliabilityPlan, Requirement, RequirementOf,
    SamplingPlan, SensitivityPlan, Stated,
};
use crate::descent::outcome::TIME_LIMIT_S;
use crate::descent::vector::{TOLERANCES, default_tolerance};
use crate::descent::{Model, OutcomeQuantity};
use crate::error::Result;
use crate::physics::design::{Design, Target};
use crate::physics::parameters::{PARAMETERS, Parameter};
use crate::sampling;
use crate::units::Quantity;
use crate::units::spelling::nearest;
use std::sync::Arc;

/// Descents of a study that does not say how many.
const DEFAULT_SAMPLES: u64 = 100_000;
/// Seed of a study that does not name one.
const DEFAULT_SEED: u64 = 1993;
const DEFAULT_SENSITIVITY: SensitivityPlan =
    SensitivityPlan { base_samples: 4096, bootstrap: 1000, pairs: Vec::new() };

/// One value of `[design]`.
#[derive(Debug, Clone)]
pub(super) struct DesignEntry {
    pub target: Target,
    pub node: Node,
    pub key: Key,
}

/// The leaves of `[design]`, by dotted path, whether it is written with dots, quotes or tables.
///
/// What is none is left out and kept among the mistakes.
pub(super) fn design_entries(node: &Node, mistakes: &mut Mistakes) -> Vec<DesignEntry> {
    let mut entries: Vec<DesignEntry> = Vec::new();
    let mut pending = vec![(String::new(), node)];
    while let Some((prefix, node)) = pending.pop() {
        let table = mistakes.keep(read::table(node, "\"brake.gap\" = \"0.062 in\""));
        for (key, child) in table.into_iter().flatten() {
            let path =
                if prefix.is_empty() { key.name.clone() } else { format!("{prefix}.{}", key.name) };
            if let (Value::Table(_), None) = (&child.value, parameter_path(&path)) {
                pending.push((path, child));
                continue;
            }
            let Some(entry) = mistakes.keep(design_entry(&path, key, child)) else { continue };
            if entries.iter().any(|other| other.target == entry.target) {
                let problem = format!("{path} is given twice");
                let error = key.place.error(problem, "expected each design key once");
                mistakes.keep(Err::<(), _>(error));
            }
            entries.push(entry);
        }
    }
    entries
}

/// One leaf of `[design]`, or of an override.
pub(super) fn design_entry(path: &str, key: &Key, node: &Node) -> Result<DesignEntry> {
    let Some(target) = parameter_path(path) else {
        let paths: Vec<&str> = PARAMETERS.iter().map(|info| info.path).collect();
        let key = Key { name: path.to_owned(), place: key.place.clone() };
        return Err(match nearest(path, paths.iter().copied()) {
            None => key.place.error(
                format!("unknown design key `{path}`"),
                "expected a dotted path, such as brake.gap or initial.temperature",
            ),
            Some(near) => key.place.error_with(
                format!("unknown design key `{path}`"),
                "expected a dotted path, such as brake.gap or initial.temperature",
                Some(format!("did you mean `{near}`?")),
            ),
        });
    };
    if let Value::Table(_) = node.value {
        let problem = format!("`{path}` is given a table");
        let help = "laws of uncertain inputs belong in the card".to_owned();
        let expected =
            format!("expected a value, such as \"{}\"", target.parameter.info().baseline_text);
        return Err(node.place.error_with(problem, expected, Some(help)));
    }
    Ok(DesignEntry { target, node: node.clone(), key: key.clone() })
}

/// The design that the entries state, and the statements; a later layer wins over an earlier one.
pub(super) fn design(layers: [Vec<DesignEntry>; 2]) -> Result<(Design<f64>, Vec<Stated>)> {
    let mut design = Design::baseline();
    let mut stated: Vec<(Stated, Node)> = Vec::new();
    let rotors = Target::whole(Parameter::BrakeRotors);
    // The number of rotors first: it says how many gaps there are.
    let chosen = layers.iter().rev().flatten().find(|entry| entry.target == rotors);
    if let Some(entry) = chosen {
        let value = possible(entry)?;
        if value.fract() != 0.0 {
            let problem = format!("the number of rotors must be an integer, not {value}");
            return Err(entry.node.place.error(problem, "expected a whole number, such as 7"));
        }
        design.set_rotors(value as usize);
        stated.push((statement(entry, value), entry.node.clone()));
    }
    let mut mistakes = Mistakes::default();
    for mut layer in layers {
        layer.sort_by_key(|entry| entry.target);
        for entry in layer.iter().filter(|entry| entry.target != rotors) {
            let value =
                check_surface(entry.target, &design, &entry.key).and_then(|()| possible(entry));
            let Some(value) = mistakes.keep(value) else { continue };
            design.set(entry.target, value);
            // The gap as a whole replaces what an earlier layer said of single gaps.
            stated.retain(|(other, _)| {
                other.target != entry.target
                    && !(entry.target.surface.is_none()
                        && other.target.parameter == entry.target.parameter)
            });
            stated.push((statement(entry, value), entry.node.clone()));
        }
    }
    stated.sort_by_key(|(stated, _)| stated.target);
    mistakes.none_or(Some(()))?;
    check_relations(&design, &stated)?;
    Ok((design, stated.into_iter().map(|(stated, _)| stated).collect()))
}

fn statement(entry: &DesignEntry, value: f64) -> Stated {
    Stated {
        target: entry.target,
        value,
        text: written(&entry.node),
        origin: entry.node.place.text.origin.clone(),
    }
}

fn possible(entry: &DesignEntry) -> Result<f64> {
    let info = entry.target.parameter.info();
    let value = read::quantity(&entry.node, info.quantity)?;
    if info.admits(value) {
        return Ok(value);
    }
    let problem = format!("{} = {} is impossible", entry.target.path(), written(&entry.node));
    Err(entry.node.place.error(problem, possible_range(entry.target.parameter)))
}

/// Pairs of which the first must be the smaller.
const ORDERED: [(Parameter, Parameter); 3] = [
    (Parameter::BrakeInnerRadius, Parameter::BrakeOuterRadius),
    (Parameter::ReelEmptyRadius, Parameter::ReelFullRadius),
    (Parameter::PayloadExtractedWeight, Parameter::PayloadWeight),
];

fn check_relations(design: &Design<f64>, stated: &[(Stated, Node)]) -> Result<()> {
    for (small, large) in ORDERED {
        if design.get(small) < design.get(large) {
            continue;
        }
        let find = |parameter| stated.iter().find(|(s, _)| s.target == Target::whole(parameter));
        let text = |parameter: Parameter| {
            find(parameter)
                .map_or(parameter.info().baseline_text, |(s, _)| s.text.as_str())
                .to_owned()
        };
        // The baseline fits itself, so one of the two was stated.
        let Some((_, node)) = find(small).or_else(|| find(large)) else { continue };
        let (small_text, large_text) = (text(small), text(large));
        let problem = format!("{} is inconsistent with {}", small.info().path, large.info().path);
        let expected = format!(
            "expected {} = {small_text} to be less than {} = {large_text}",
            small.info().path,
            large.info().path
        );
        return Err(node.place.error(problem, expected));
    }
    Ok(())
}

/// `[limits]`.
pub(super) fn limits(node: &Node) -> Result<Vec<Limit>> {
    let example = "{ max = \"210 s\" }";
    let entries = read::table(node, &format!("time = {example}"))?;
    let limits = all(entries.iter().map(|(key, value)| limit(key, value, example)))?;
    let mut limits: Vec<Limit> = limits.into_iter().flatten().collect();
    let upper_on_time =
        |limit: &Limit| limit.outcome == OutcomeQuantity::Time && limit.kind == LimitKind::Max;
    if !limits.is_empty() && !limits.iter().any(upper_on_time) {
        limits.push(Limit::deployment());
    }
    limits.sort_by_key(|limit| (limit.outcome, limit.kind));
    Ok(limits)
}

/// The limits of one outcome.
fn limit(key: &Key, value: &Node, example: &str) -> Result<Vec<Limit>> {
    let names = OutcomeQuantity::ALL.map(OutcomeQuantity::name);
    let mut limits = Vec::new();
    let Some(outcome) = OutcomeQuantity::from_name(&key.name) else {
        let help = nearest(&key.name, names).map(|near| format!("did you mean `{near}`?"));
        let problem = format!("unknown outcome `{}` in [limits]", key.name);
        return Err(key.place.error_with(problem, read::one_of(&names, '`'), help));
    };
    let section = Section::new("a limit", &value.place, read::table(value, example)?, keys::LIMIT)?;
    let source = section.get("source").map(|node| {
        read::string(node, "where the limit comes from").map(|text| (text.trim().to_owned(), node))
    });
    let source = source.transpose()?;
    // A value that an option puts in place of the file's does not come from where the file's did.
    let is_of = |source: &Node, limit: &Node| {
        Arc::ptr_eq(&source.place.text, &limit.place.text)
            || !Arc::ptr_eq(&source.place.text, &value.place.text)
    };
    let mut sides = [None, None];
    for (side, kind) in sides.iter_mut().zip(LimitKind::ALL) {
        if let Some(node) = section.get(kind.name()) {
            let value = limit_value(outcome, kind, node)?;
            *side = Some((value, node));
            let source = source
                .as_ref()
                .filter(|(_, stated)| is_of(stated, node))
                .map(|(text, _)| text.clone());
            limits.push(Limit {
                outcome,
                kind,
                value,
                text: written(node),
                source,
                implied: false,
            });
        }
    }
    match sides {
        [Some((max, _)), Some((min, node))] if min >= max => {
            let problem = format!("no {} can satisfy both limits", outcome.title());
            return Err(node.place.error(problem, "expected min to be less than max"));
        }
        [None, None] => {
            let problem = format!("the limit on {} is empty", key.name);
            return Err(value.place.error(problem, format!("expected {example}, or min, or both")));
        }
        _ => {}
    }
    Ok(limits)
}

fn limit_value(outcome: OutcomeQuantity, kind: LimitKind, node: &Node) -> Result<f64> {
    let value = read::quantity(node, outcome.quantity())?;
    let impossible = |expected: String| {
        Err(node.place.error(format!("the limit {} is impossible", written(node)), expected))
    };
    if outcome.quantity() == Quantity::Temperature && value <= 0.0 {
        return impossible("expected a temperature above absolute zero".to_owned());
    }
    if value < 0.0 {
        return impossible(format!(
            "expected {} that is not negative",
            outcome.quantity().described()
        ));
    }
    if outcome == OutcomeQuantity::Time && kind == LimitKind::Max && value >= TIME_LIMIT_S {
        return impossible(format!(
            "expected less than {TIME_LIMIT_S} s, the longest simulated time; a slower descent counts as not deployed"
        ));
    }
    Ok(value)
}

/// `[requirement]`.
pub(super) fn requirement(node: &Node) -> Result<Requirement> {
    let entries = read::table(node, "{ reliability = 0.99, confidence = 0.90 }")?;
    let section = Section::new("[requirement]", &node.place, entries, keys::REQUIREMENT)?;
    let share = |name: &str, example: &str| {
        read::open_share(section.require(name, example)?, name, example)
    };
    Ok(Requirement {
        reliability: share("reliability", "0.99")?,
        confidence: share("confidence", "0.90")?,
        of: match section.get("of") {
            None => RequirementOf::Average,
            Some(node) => {
                let names = RequirementOf::ALL.map(RequirementOf::name);
                read::choice(node, "requirement of", &names, RequirementOf::from_name)?
            }
        },
    })
}

/// `[sampling]`; without it, plain Monte Carlo.
pub(super) fn sampling(
    node: Option<&Node>,
    has_limits: bool,
    requirement: Option<Requirement>,
) -> Result<SamplingPlan> {
    let mut plan = SamplingPlan {
        design: sampling::Design::MonteCarlo,
        samples: DEFAULT_SAMPLES,
        seed: DEFAULT_SEED,
        replicates: 1,
        stopping: None,
    };
    let Some(node) = node else { return Ok(plan) };
    let entries = read::table(node, "{ samples = 100_000, seed = 1993 }")?;
    let section = Section::new("[sampling]", &node.place, entries, keys::SAMPLING)?;
    if let Some(node) = section.get("design") {
        let names = sampling::Design::ALL.map(sampling::Design::name);
        plan.design = read::choice(node, "sampling design", &names, sampling::Design::from_name)?;
    }
    let plain = !plan.design.is_replicated();
    if let Some(node) = section.get("until") {
        until::until(node, section.get("samples"), has_limits, requirement, &mut plan)?;
    } else if let Some(node) = section.get("samples") {
        plan.samples = read::integer(node, 1, sampling::MAX_SAMPLES, "100_000")?;
    }
    if let Some(node) = section.get("seed") {
        plan.seed = read::integer(node, 0, u64::MAX, "1993")?;
    }
    plan.replicates = match section.get("replicates") {
        None if plain => 1,
        None => sampling::DEFAULT_REPLICATES,
        Some(node) if plain => {
            let value = read::integer(node, 1, u64::from(u32::MAX), "1")?;
            if value != 1 {
                let help = "omit replicates: plain Monte Carlo provides its own error estimate";
                let problem = format!("{value} replicates of plain Monte Carlo");
                let expected = "expected 1 for the design \"monte-carlo\"";
                return Err(node.place.error_with(problem, expected, Some(help.to_owned())));
            }
            1
        }
        // Fewer than two have no spread to read an error from.
        Some(node) => read::integer(node, 2, u64::from(sampling::MAX_REPLICATES), "16")? as u32,
    };
    let replicates = u64::from(plan.replicates);
    if !plan.samples.is_multiple_of(replicates) {
        let near = (plan.samples / replicates).max(1) * replicates;
        let place = section.get("samples").or(section.get("replicates")).unwrap_or(node);
        let problem = format!(
            "{} samples cannot be divided equally among {replicates} replicates",
            plan.samples
        );
        let expected = format!("expected a multiple of {replicates}");
        return Err(place.place.error_with(problem, expected, Some(format!("such as {near}"))));
    }
    Ok(plan)
}

/// `[numerics]`.
pub(super) fn numerics(node: Option<&Node>, model: Model) -> Result<Numerics> {
    let mut numerics = Numerics { tolerance: default_tolerance(model) };
    let Some(node) = node else { return Ok(numerics) };
    let entries = read::table(node, "{ tolerance = 1e-6 }")?;
    let section = Section::new("[numerics]", &node.place, entries, keys::NUMERICS)?;
    if let Some(node) = section.get("tolerance") {
        let value = read::quantity(node, Quantity::Number)?;
        if !TOLERANCES.contains(&value) {
            let (least, most) = (TOLERANCES.start(), TOLERANCES.end());
            let problem = format!("the tolerance {} is out of range", written(node));
            let expected = format!("expected a relative error from {least:e} to {most:e}");
            return Err(node.place.error(problem, expected));
        }
        numerics.tolerance = value;
    }
    Ok(numerics)
}

/// `[sensitivity]`, without its pairs, which need the inputs.
pub(super) fn sensitivity(node: Option<&Node>) -> Result<SensitivityPlan> {
    let mut plan = DEFAULT_SENSITIVITY;
    let Some(node) = node else { return Ok(plan) };
    let entries = read::table(node, "{ base_samples = 4096, bootstrap = 1000 }")?;
    let section = Section::new("[sensitivity]", &node.place, entries, keys::SENSITIVITY)?;
    if let Some(node) = section.get("base_samples") {
        plan.base_samples = read::integer(node, 0, 1 << 32, "4096")?;
        if plan.base_samples == 1 {
            let expected = "expected 0 (no indices) or at least 2";
            return Err(node.place.error("base_samples = 1 is too few", expected));
        }
    }
    if let Some(node) = section.get("bootstrap") {
        plan.bootstrap = read::integer(node, 100, 1_000_000, "1000")? as u32;
    }
    Ok(plan)
}

/// `[reliability]`.
pub(super) fn reliability(node: Option<&Node>) -> Result<ReliabilityPlan> {
    let Some(node) = node else { return Ok(ReliabilityPlan::default()) };
    let entries = read::table(node, "{ methods = [\"form\"] }")?;
    let section = Section::new("[reliability]", &node.place, entries, keys::RELIABILITY)?;
    let Some(node) = section.get("methods") else { return Ok(ReliabilityPlan::default()) };
    let Value::Array(items) = &node.value else {
        let problem = format!("this is {}", node.value.described());
        return Err(node.place.error(problem, "expected a list of methods, such as [\"form\"]"));
    };
    let names = RareMethod::ALL.map(RareMethod::name);
    let mut methods = Vec::new();
    for item in items {
        let method = read::choice(item, "method", &names, RareMethod::from_name)?;
        if methods.contains(&method) {
            return Err(item
                .place
                .error("this method is named twice", "expected each method once"));
        }
        methods.push(method);
    }
    Ok(ReliabilityPlan { methods: Some(methods) })
}
