//! From the statements of cards to the uncertain inputs of a study.

use super::card::{Card, Statement};
use super::digest::of_numbers;
use super::epistemic::nature;
use super::files::Files;
use super::law::understand;
use super::mistakes::Mistakes;
use super::read;
use super::together::Together;
use super::values::check_surface;
use super::{Input, Known, Nature, TighteningCost, pairs, tighten};
use crate::error::Result;
use crate::physics::design::{Design, Target};
use crate::physics::parameters::Parameter;
use crate::uncertainty::{Law, Marginal};

/// The inputs of a card for a design, in the order of [`Target`].
///
/// # Errors
/// A diagnostic: see [`understand`]; also a surface that the design does not have, and what cannot
/// be uncertain.
pub(super) fn inputs(
    card: &Card,
    design: &Design<f64>,
    files: &mut dyn Files,
) -> Result<Vec<Input>> {
    let mut inputs = Vec::new();
    let mut mistakes = Mistakes::default();
    for statement in &card.statements {
        let stated = check_surface(statement.target, design, &statement.key)
            .and_then(|()| input(statement, design.at(statement.target), &mut *files));
        let Some((template, each_surface)) = mistakes.keep(stated) else { continue };
        if !each_surface {
            inputs.push(template);
            continue;
        }
        for surface in 0..design.surfaces() {
            let target = Target::gap(surface);
            // A surface with a statement of its own keeps that.
            let drawn = card.together.iter().flat_map(|together| &together.members);
            let own = card.statements.iter().map(|other| other.target);
            if own.chain(drawn.map(|(other, _)| *other)).any(|other| other == target) {
                continue;
            }
            // A surface with a nominal gap of its own has its law about that.
            let own = match template.about_nominal {
                true => input(statement, design.at(target), &mut *files),
                false => Ok((template.clone(), true)),
            };
            inputs.extend(mistakes.keep(own).map(|(own, _)| Input { target, ..own }));
        }
    }
    for together in &card.together {
        for (target, values) in &together.members {
            let input = check_surface(*target, design, &together.key)
                .and_then(|()| member(together, *target, values));
            inputs.extend(mistakes.keep(input));
        }
    }
    inputs.sort_by_key(|input| input.target);
    mistakes.none_or(Some(inputs))
}

/// One input of those that are drawn together.
fn member(together: &Together, target: Target, values: &[f64]) -> Result<Input> {
    let law = Law::discrete(values.to_vec(), None).map_err(|_| {
        let problem = format!("{} is constant in every row", target.path());
        let expected = "expected values that differ; a constant belongs in [design]";
        together.key.place.error(problem, expected)
    })?;
    Ok(Input {
        target,
        marginal: Marginal::untruncated(law),
        readings: None,
        known: together.known,
        nature: together.nature,
        source: together.source.clone(),
        group: Some(together.group.clone()),
        cost: together.cost.clone(),
        about_nominal: false,
        law_text: together.law_text(),
        law_canonical: format!("together values={}", of_numbers(values)),
    })
}

/// One statement as an input whose nominal value is `nominal`, and whether it stands for one on each surface.
fn input(statement: &Statement, nominal: f64, files: &mut dyn Files) -> Result<(Input, bool)> {
    let Statement { target, key, node } = statement;
    if target.parameter == Parameter::BrakeRotors {
        let expected = "expected a continuous parameter; the number of rotors is an integer";
        return Err(key.place.error("brake.rotors cannot be uncertain", expected));
    }
    let entries = read::table(node, "law = \"normal\"")?;
    let find = |name: &str| entries.iter().find(|(key, _)| key.name == name);
    let require = |name: &str, expected: &str| {
        find(name).map(|(_, node)| node).ok_or_else(|| {
            let problem = format!("{} lacks the key `{name}`", target.path());
            key.place.error(problem, format!("expected {expected}"))
        })
    };
    let law = understand(statement, nominal, files)?;
    let each_surface = match find("each_surface") {
        None => false,
        Some((key, node)) => {
            if *target != Target::whole(Parameter::BrakeGap) {
                let problem = format!("{} has no working surfaces", target.path());
                return Err(key.place.error(problem, "expected each_surface in [brake.gap] only"));
            }
            read::boolean(node)?
        }
    };
    let known_names = Known::ALL.map(Known::name);
    let known_node = require("known", "known = \"at build\", \"on the day\" or \"never\"")?;
    let known = read::choice(known_node, "value of `known`", &known_names, Known::from_name)?;
    let nature = match find("nature") {
        Some((_, node)) => nature(node)?,
        None => Nature::default_of(known, law.readings.is_some()),
    };
    let source_node = require("source", "source = \"…\": where the distribution comes from")?;
    let source = read::string(source_node, "where the distribution comes from")?.trim().to_owned();
    let group = match find("group") {
        Some((_, node)) => Some(pairs::group(node, Some(*target))?),
        None => each_surface.then(|| target.path()),
    };
    let cost = find("cost").map_or_else(
        || Ok(TighteningCost::usual(target.parameter, known)),
        |(_, node)| tighten::cost(node),
    )?;
    let input = Input {
        target: *target,
        marginal: law.marginal,
        readings: law.readings,
        known,
        nature,
        source,
        group,
        cost,
        about_nominal: law.about_nominal,
        law_text: law.text,
        law_canonical: law.canonical,
    };
    Ok((input, each_surface))
}
