//! From the texts of a study and its cards to the [`Study`]: pure, so that it can be fuzzed.

use super::card;
use super::document::{self, Node, Value};
use super::files::{Files, NamedText};
use super::mistakes::Mistakes;
use super::overrides::{Destination, Override, in_place_of, put};
use super::place::Text;
use super::together::{self, Together};
use super::values::parameter_path;
use super::vocabulary::STUDY;
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
/// Reads nothing but what `files` gives it. All mistakes are reported, in the order: the study's keys,
/// design, limits, plans, cards, inputs, correlations; of each value, input and plan the first.
///
/// # Errors
/// A [`crate::error::Diagnostic`] for a mistake in a text; for several, [`Error::Several`].
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
    let mut mistakes = Mistakes::default();
    mistakes.keep(read::known_keys(top, "", STUDY));
    let find = |name: &str| top.iter().find(|(key, _)| key.name == name).map(|(_, node)| node);
    let missing = |name: &str, expected: &str| {
        // The whole text would be underlined; its start is enough.
        super::place::Place::new(&text, 0..0)
            .error(format!("the study lacks the key `{name}`"), format!("expected {expected}"))
    };
    let title = find("title").ok_or_else(|| missing("title", "title = \"…\"")).and_then(|node| {
        read::string(node, "the study's title").map(|title| title.trim().to_owned())
    });
    let title = mistakes.keep(title);
    let model = mistakes.keep(find("model").map_or(Ok(Model::Dynamic), |node| {
        read::choice(node, "model", &Model::ALL.map(Model::name), Model::from_name)
    }));
    let entries = find("design").map(|node| sections::design_entries(node, &mut mistakes));
    let design = sections::design([entries.unwrap_or_default(), design_overrides]);
    let design = mistakes.keep(design);
    let limits = mistakes.keep(find("limits").map_or(Ok(Vec::new()), sections::limits));
    let unlimited = limits.as_ref().is_some_and(Vec::is_empty);
    let requirement = mistakes.keep(find("requirement").map(sections::requirement).transpose());
    if let (Some(node), true) = (find("requirement"), unlimited) {
        let expected = "expected at least one limit, such as [limits] time = { max = \"210 s\" }";
        let error = node.place.error("a requirement needs at least one limit", expected);
        mistakes.keep(Err::<(), _>(error));
    }
    // What a section says of another is not judged where that one is wrong.
    let sampling = requirement.and_then(|requirement| {
        mistakes.keep(sections::sampling(find("sampling"), !unlimited, requirement))
    });
    let numerics = mistakes.keep(sections::numerics(find("numerics"), model.unwrap_or_default()));
    let sensitivity = mistakes.keep(sections::sensitivity(find("sensitivity")));
    let reliability = mistakes.keep(sections::reliability(find("reliability")));
    let trade = mistakes.keep(tighten::trade(find("trade")));
    let tighten = design
        .as_ref()
        .and_then(|(design, _)| mistakes.keep(tighten::tighten(find("tighten"), design)));
    let epistemic = mistakes.keep(epistemic::epistemic(find("epistemic")));
    let card_node = find("card")
        .ok_or_else(|| missing("card", "card = \"…\": the file that says what is uncertain"));
    let Some(card_node) = mistakes.keep(card_node) else { return mistakes.none_or(None) };
    let card_texts = match given {
        Some(texts) => Ok(texts.to_vec()),
        None => card_texts(card_node, overrides, files),
    };
    let Some(card_texts) = mistakes.keep(card_texts) else { return mistakes.none_or(None) };
    let before = mistakes.count();
    let mut cards = Vec::new();
    for card in &card_texts {
        let text = Arc::new(Text { origin: card.origin.clone(), text: card.text.clone() });
        let Some(document) = mistakes.keep(document::parse(&text)) else { continue };
        let mut card = card::read_card(&document, &mut mistakes);
        let stated = |target| card.statements.iter().any(|statement| statement.target == target);
        let together = mistakes.keep(together::read(&card.joints, &stated, files));
        card.together = together.unwrap_or_default();
        cards.push(card);
    }
    let calibrated = cards.iter().skip(1).position(|card| card.calibrated_from.is_some());
    let calibrated_from =
        calibrated.and_then(|k| cards.get(k + 1)).and_then(|card| card.calibrated_from.clone());
    let prior_cards = calibrated.and_then(|k| card_texts.get(..=k));
    // What the cards before it say may not be a study of its own: there is then no prior to tell of.
    let prior = prior_cards
        .and_then(|cards| assemble_with(study, overrides, files, Some(cards)).ok().map(Box::new));
    let whole = mistakes.count() == before;
    let mut card = card::merge(cards);
    for (statement, path, key) in card_overrides {
        if let Some(target) = parameter_path(&path) {
            card::put(&mut card, target, &statement.path, &key, &statement.value);
        }
    }
    let inputs = match &design {
        Some((design, _)) => mistakes.keep(inputs::inputs(&card, design, files)),
        None => None,
    };
    // A card that could not be read lacks inputs, of which nothing can then be said.
    let inputs = inputs.filter(|_| whole).and_then(|inputs| match inputs.is_empty() {
        false => Some(inputs),
        true => {
            let expected = "expected at least one input, such as [initial.temperature]";
            let problem = "the card defines no uncertain input";
            mistakes.keep(Err(card_node.place.error(problem, expected)))
        }
    });
    let (
        Some(title),
        Some(model),
        Some((mut design, stated)),
        Some(limits),
        Some(requirement),
        Some(sampling),
        Some(numerics),
        Some(mut sensitivity),
        Some(reliability),
        Some(trade),
        Some(tighten),
        Some(epistemic),
        Some(inputs),
    ) = (
        title,
        model,
        design,
        limits,
        requirement,
        sampling,
        numerics,
        sensitivity,
        reliability,
        trade,
        tighten,
        epistemic,
        inputs,
    )
    else {
        return mistakes.none_or(None);
    };
    let place = find("sampling").unwrap_or(card_node);
    mistakes.keep(check_dimension(&sampling, inputs.len(), place));
    if let Some(node) = find("sensitivity").and_then(|node| read::entry(node, "pairs")) {
        sensitivity.pairs = mistakes.keep(pairs::pairs(node, &inputs)).unwrap_or_default();
    }
    let joint = drawn_together(&inputs, &card.together).and_then(|(drawn_together, samples)| {
        let (joint, correlations) = correlation::joint(&inputs, samples, &card.correlations)?;
        Ok((drawn_together, joint, correlations))
    });
    let joint = mistakes.keep(joint);
    let (drawn_together, joint, correlations) = mistakes.none_or(joint)?;
    let moved =
        prior.as_ref().map_or(0, |prior| to_the_posterior(&mut design, &inputs, prior, &stated));
    let mut notes = notes(&design, &inputs, &stated);
    notes.extend(card.together.iter().filter_map(unused));
    notes.extend(epistemic::shared_readings(&inputs));
    if let Some(limit) = limits.iter().find(|limit| limit.implied) {
        notes.push(format!(
            "no upper limit on time is stated: a descent that has not deployed after {}, beyond which none is followed, \
             counts as a breach",
            limit.text
        ));
    }
    if moved > 0 {
        notes.push(format!(
            "{moved} calibrated inputs have their posterior means as nominal values: the card before them had others"
        ));
    }
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

/// Sets the nominal value of every input whose law a calibration changed to that law's mean, unless the study states
/// one; how many. The nominal descent is then of the brake that was measured, not of the one that was designed.
fn to_the_posterior(
    design: &mut Design<f64>,
    inputs: &[Input],
    prior: &Study,
    stated: &[Stated],
) -> usize {
    let kept = |target: Target| {
        let before = prior.inputs.iter().find(|input| input.target == target);
        let same = |before: &Input, now: &Input| before.law_canonical == now.law_canonical;
        let whole = Target::whole(target.parameter);
        let is_stated = stated.iter().any(|s| s.target == target || s.target == whole);
        move |now: &Input| is_stated || before.is_some_and(|before| same(before, now))
    };
    let mut moved = design.clone();
    let mut count = 0;
    for input in inputs {
        let mean = input.marginal.mean();
        if mean.is_finite() && !kept(input.target)(input) {
            moved.set(input.target, mean);
            count += 1;
        }
    }
    if moved.validate().is_err() {
        return 0;
    }
    *design = moved;
    count
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
        let name = read::string(node, "the name of a card")?;
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
        if let (Some(stated), false) = (stated.iter().rev().find(covers), input.about_nominal) {
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
