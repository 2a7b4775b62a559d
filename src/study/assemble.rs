//! From the texts of a study and its cards to the [`Study`]: pure, so that it can be fuzzed.

use super::card::{self, Card};
use super::document::{self, Node, Value};
use super::files::{Files, NamedText};
use super::overrides::{Destination, Override, in_place_of, put};
use super::place::Text;
use super::together::{self, Together};
use super::values::parameter_path;
use super::{
    DrawnTogether, Input, Stated, Study, correlation, epistemic, inputs, pairs, read, sections,
    tighten,
};
use crate::descent::Model;
use crate::error::{Error, Result};
use crate::physics::design::{Design, Target};
use crate::physics::parameters::Parameter;
use crate::uncertainty::JointSample;
use crate::units::number;
use std::sync::Arc;

/// Makes the study that a text, its cards and some overrides describe.
///
/// Reads nothing but what `files` gives it. Of several mistakes the first is reported, in the order:
/// the study's TOML, its keys, design, limits, plans, cards, inputs, correlations.
///
/// # Errors
/// A [`crate::error::Diagnostic`] for every mistake in a text.
pub fn assemble(study: &NamedText, overrides: &[Override], files: &mut dyn Files) -> Result<Study> {
    assemble_with(study, overrides, files, None)
}

/// As [`assemble`], with these cards in place of those that the study names.
fn assemble_with(
    study: &NamedText,
    overrides: &[Override],
    files: &mut dyn Files,
    given: Option<&[NamedText]>,
) -> Result<Study> {
    let text = Arc::new(Text { origin: study.origin.clone(), text: study.text.clone() });
    let mut document = document::parse(&text)?;
    let (design_overrides, card_overrides) = apply(overrides, &mut document)?;
    let top = read::table(&document, "title = \"…\"")?;
    sections::check_top(top)?;
    let find = |name: &str| top.iter().find(|(key, _)| key.name == name).map(|(_, node)| node);
    let missing = |name: &str, expected: &str| {
        // The whole text would be underlined; its start is enough.
        super::place::Place::new(&text, 0..0)
            .error(format!("the study lacks the key `{name}`"), format!("expected {expected}"))
    };
    let title_node = find("title").ok_or_else(|| missing("title", "title = \"…\""))?;
    let title = read::string(title_node, "the study's title")?.trim().to_owned();
    let model = match find("model") {
        Some(node) => read::choice(node, "model", &Model::ALL.map(Model::name), Model::from_name)?,
        None => Model::Dynamic,
    };
    let design_entries = match find("design") {
        Some(node) => sections::design_entries(node)?,
        None => Vec::new(),
    };
    let (design, stated) = sections::design([design_entries, design_overrides])?;
    let limits = find("limits").map_or(Ok(Vec::new()), sections::limits)?;
    let requirement = find("requirement").map(sections::requirement).transpose()?;
    let sampling = sections::sampling(find("sampling"), !limits.is_empty(), requirement)?;
    let numerics = sections::numerics(find("numerics"))?;
    let mut sensitivity = sections::sensitivity(find("sensitivity"))?;
    let reliability = sections::reliability(find("reliability"))?;
    let trade = tighten::trade(find("trade"))?;
    let tighten = tighten::tighten(find("tighten"), &design)?;
    let epistemic = epistemic::epistemic(find("epistemic"))?;
    if let (Some(node), true) = (find("requirement"), limits.is_empty()) {
        let expected = "expected at least one limit, such as [limits] time = { max = \"210 s\" }";
        return Err(node.place.error("a requirement without limits says nothing", expected));
    }
    let card_node = find("card")
        .ok_or_else(|| missing("card", "card = \"…\": the file that says what is uncertain"))?;
    let card_texts = match given {
        Some(texts) => texts.to_vec(),
        None => card_texts(card_node, overrides, files)?,
    };
    let mut cards = Vec::new();
    for card in &card_texts {
        let text = Arc::new(Text { origin: card.origin.clone(), text: card.text.clone() });
        let mut card = card::read_card(&document::parse(&text)?)?;
        let stated = |target| card.statements.iter().any(|statement| statement.target == target);
        card.together = together::read(&card.joints, &stated, files)?;
        cards.push(card);
    }
    let calibrated = cards.iter().skip(1).position(|card| card.calibrated_from.is_some());
    let calibrated_from =
        calibrated.and_then(|k| cards.get(k + 1)).and_then(|card| card.calibrated_from.clone());
    let prior_cards = calibrated.and_then(|k| card_texts.get(..=k));
    // What the cards before it say may not be a study of its own: there is then no prior to tell of.
    let prior = prior_cards
        .and_then(|cards| assemble_with(study, overrides, files, Some(cards)).ok().map(Box::new));
    let mut card = card::merge(cards);
    for (statement, path, key) in card_overrides {
        if let Some(target) = parameter_path(&path) {
            card::put(&mut card, target, &statement.path, &key, &statement.value);
        }
    }
    let inputs = study_inputs(&card, card_node, &design, files)?;
    check_dimension(&sampling, inputs.len(), find("sampling").unwrap_or(card_node))?;
    if let Some(node) = find("sensitivity").and_then(|node| read::entry(node, "pairs")) {
        sensitivity.pairs = pairs::pairs(node, &inputs)?;
    }
    let (drawn_together, samples) = drawn_together(&inputs, &card.together)?;
    let (joint, correlations) = correlation::joint(&inputs, samples, &card.correlations)?;
    let mut notes = notes(&design, &inputs, &stated);
    notes.extend(card.together.iter().filter_map(unused));
    notes.extend(epistemic::shared_readings(&inputs));
    Ok(Study {
        title,
        model,
        design,
        inputs,
        joint,
        correlations,
        drawn_together,
        limits,
        requirement,
        sampling,
        numerics,
        sensitivity,
        reliability,
        trade,
        tighten,
        calibrated_from,
        prior,
        epistemic,
        stated,
        notes,
        origin: study.origin.clone(),
        study_text: study.text.clone(),
        card_texts: card_texts.into_iter().map(|card| (card.origin, card.text)).collect(),
        overrides: overrides.iter().map(|statement| statement.text().to_owned()).collect(),
    })
}

type CardOverride<'o> = (&'o Override, String, String);

/// Puts the overrides of the study file's own keys into its tree; gives back the others.
fn apply<'o>(
    overrides: &'o [Override],
    document: &mut Node,
) -> Result<(Vec<sections::DesignEntry>, Vec<CardOverride<'o>>)> {
    let mut design: Vec<sections::DesignEntry> = Vec::new();
    let mut card = Vec::new();
    for statement in overrides {
        match statement.destination()? {
            Destination::Design => {
                let (path, value) = (&statement.path, &statement.value);
                let entry = sections::design_entry(&path.name, path, value)?;
                // Of two statements on one command line the last wins.
                design.retain(|other| other.target != entry.target);
                design.push(entry);
            }
            Destination::Study(keys) => {
                if let Value::Table(entries) = &mut document.value {
                    let keys = in_place_of(entries, keys);
                    put(entries, &keys, &statement.path, &statement.value)?;
                }
            }
            Destination::Card { path, key } => card.push((statement, path, key)),
        }
    }
    Ok((design, card))
}

fn card_texts(
    node: &Node,
    overrides: &[Override],
    files: &mut dyn Files,
) -> Result<Vec<NamedText>> {
    let single = std::slice::from_ref(node);
    let names: &[Node] = match &node.value {
        Value::Array(items) if items.is_empty() => {
            let expected = "expected the name of a card, or several";
            return Err(node.place.error("the list of cards is empty", expected));
        }
        Value::Array(items) => items,
        _ => single,
    };
    let mut texts: Vec<NamedText> = Vec::new();
    for node in names {
        let name =
            read::string(node, "the name of a card, such as \"../../distributions/habe.toml\"")?;
        let by_option =
            overrides.iter().any(|one| Arc::ptr_eq(&one.path.place.text, &node.place.text));
        let card = files.card(name, by_option).map_err(|reason| {
            let base = if by_option { "the working directory" } else { "the study file" };
            let problem = format!("cannot read the card {name}: {reason}");
            node.place.error(problem, format!("expected a card file, relative to {base}"))
        })?;
        if texts.iter().any(|other| other.origin == card.origin) {
            let problem = format!("the card {name} is named twice");
            return Err(node.place.error(problem, "expected each card once"));
        }
        texts.push(card);
    }
    Ok(texts)
}

fn study_inputs(
    card: &Card,
    card_node: &Node,
    design: &Design<f64>,
    files: &mut dyn Files,
) -> Result<Vec<Input>> {
    let mut columns = |card: &str, name: &str, column: &str| files.column(card, name, column);
    let inputs = inputs::inputs(card, design, &mut columns)?;
    if inputs.is_empty() {
        let expected = "expected at least one input, such as [initial.temperature]";
        return Err(card_node.place.error("the card makes nothing uncertain", expected));
    }
    Ok(inputs)
}

fn check_dimension(plan: &super::SamplingPlan, inputs: usize, node: &Node) -> Result<()> {
    let most = plan.design.max_dimension();
    if inputs <= most {
        return Ok(());
    }
    let problem = format!("{inputs} inputs are too many for the design {}", plan.design.name());
    Err(node.place.error(problem, format!("expected at most {most} inputs, or \"monte-carlo\"")))
}

/// What is drawn together, with the places of the inputs, for the study and for its joint distribution.
fn drawn_together(
    inputs: &[Input],
    together: &[Together],
) -> Result<(Vec<DrawnTogether>, Vec<JointSample>)> {
    let mut drawn = Vec::with_capacity(together.len());
    let mut samples = Vec::with_capacity(together.len());
    for together in together {
        // Inputs and members are both in the order of their targets.
        let place = |target: Target| inputs.iter().position(|input| input.target == target);
        let places: Vec<usize> =
            together.members.iter().filter_map(|(target, _)| place(*target)).collect();
        let columns: Vec<Vec<f64>> =
            together.members.iter().map(|(_, values)| values.clone()).collect();
        samples.push(JointSample::new(places.clone(), &columns)?);
        drawn.push(DrawnTogether {
            name: together.group.clone(),
            file: together.file.clone(),
            sha256: together.sha256.clone(),
            rows: together.rows(),
            inputs: places,
        });
    }
    Ok((drawn, samples))
}

/// Columns named in a note at most.
const NAMED_COLUMNS: usize = 6;

fn unused(together: &Together) -> Option<String> {
    let names: Vec<&str> = together.unused.iter().take(NAMED_COLUMNS).map(String::as_str).collect();
    let more = match together.unused.len() - names.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let columns = names.join(", ");
    (!names.is_empty()).then(|| {
        format!(
            "{}: no input is drawn from its columns {columns}{more}, which are not design paths",
            together.file
        )
    })
}

/// Share of impossible draws below which nothing is said.
const NEGLIGIBLE: f64 = 1e-12;
/// A nominal value that fewer than one draw in a thousand lies beyond deserves a remark.
const REMARKABLE: f64 = 1e-3;

fn notes(design: &Design<f64>, inputs: &[Input], stated: &[Stated]) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    let mut add = |note: String| {
        // The gaps of one statement share their notes.
        if !notes.contains(&note) {
            notes.push(note);
        }
    };
    for input in inputs {
        let info = input.target.parameter.info();
        let shared = input.group.as_deref() == Some(info.path);
        let path = if shared { info.path.to_owned() } else { input.target.path() };
        let covers = |other: &&Stated| {
            let gap = input.target.parameter == Parameter::BrakeGap;
            other.target == input.target
                || gap && other.target == Target::whole(Parameter::BrakeGap)
        };
        if let Some(stated) = stated.iter().rev().find(covers) {
            add(format!(
                "{} = {} ({}) is the nominal value; samples follow the card's law: {}",
                stated.target.path(),
                stated.text,
                stated.origin,
                input.law_text
            ));
        }
        let marginal = &input.marginal;
        let impossible = marginal.cdf(info.lower) + marginal.survival(info.upper);
        if impossible > NEGLIGIBLE {
            add(format!(
                "{path}: a share {} of its draws is impossible and will be counted as faults; \
                 truncate the law ({})",
                number(impossible, 2),
                input.law_text
            ));
        }
        let nominal = design.at(input.target);
        if marginal.cdf(nominal).min(marginal.survival(nominal)) < REMARKABLE {
            add(format!(
                "{path}: the nominal value lies at the edge of the card's law or beyond ({})",
                input.law_text
            ));
        }
    }
    notes
}

impl Study {
    /// Checks what only the whole study can tell; for callers that changed the design themselves.
    ///
    /// # Errors
    /// [`Error::Argument`] naming what does not fit.
    pub fn validate(&self) -> Result<()> {
        self.design.validate()?;
        match self.inputs.iter().find(|input| {
            input.target.surface.is_some_and(|surface| surface >= self.design.surfaces())
        }) {
            Some(input) => Err(Error::argument(format!(
                "{} is uncertain, but the design has {} working surfaces",
                input.target.path(),
                self.design.surfaces()
            ))),
            None => Ok(()),
        }
    }
}
