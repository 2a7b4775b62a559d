//! A plan of tightenings as text: for a terminal, and as Markdown.

use super::figures_of_speech::{count, probability, probability_interval, value};
use super::markdown;
use super::tables::table;
use crate::findings::tighten::{DesignChange, PlanFinding, PurchaseFinding, TightenFinding};
use crate::numerics::interval::Estimate;
use crate::physics::parameters::Parameter;
use crate::units::{Quantity, number};

/// Factors named as residual causes.
const SHOWN_CAUSES: usize = 3;

/// The plan for a terminal.
pub fn tighten_terminal(finding: &TightenFinding) -> String {
    let mut text = format!("{}: tightening to {}\n\n", finding.title, probability(finding.target));
    text += &format!("{}\n\n", super::terminal::wrapped(&finding.statement));
    text += &format!("{}\n\n", table(&STEP_HEADER, 1..3, step_rows(finding), None));
    let rows = plan_rows(&finding.plan);
    if !rows.is_empty() {
        let plan =
            if finding.residual.is_some() { "everything that can be bought" } else { "the plan" };
        text += &format!("{}\n", table(&[plan, "now", "then", "cost"], 1..4, rows, None));
    }
    for line in lines(finding) {
        text += &format!("\n{}\n", super::terminal::wrapped(&line));
    }
    text
}

/// The plan as Markdown.
pub fn tighten_markdown(finding: &TightenFinding) -> String {
    let title = markdown::inline(&finding.title);
    let mut text = format!("# {title}: tightening to {}\n\n", probability(finding.target));
    text += &format!("{}\n\n## The plan\n\n", finding.statement);
    text += "| what | now | then | cost |\n| --- | ---: | ---: | ---: |\n";
    for row in plan_rows(&finding.plan) {
        text += &markdown::row(&row);
    }
    text += "\n## The way there\n\n| step | cost | P(any breach) |\n| --- | ---: | ---: |\n";
    for row in step_rows(finding) {
        text += &markdown::row(&row);
    }
    text += "\n";
    for line in lines(finding) {
        text += &format!("- {line}\n");
    }
    let reproduction = &finding.reproduction;
    text += &format!(
        "\n## To reproduce\n\n```\n{}\n```\n\nreeldown {}, seed {}, digest of the resolved study `{}`.\n",
        reproduction.command, reproduction.version, reproduction.seed, reproduction.study_digest
    );
    text
}

const STEP_HEADER: [&str; 3] = ["step", "cost in all", "P(any breach)"];

fn step_rows(finding: &TightenFinding) -> Vec<[String; 3]> {
    let mut rows = Vec::new();
    let mut before: Option<&PlanFinding> = None;
    for (k, step) in finding.steps.iter().enumerate() {
        let what = match before {
            None => "present design".to_owned(),
            Some(before) => step_words(before, step, k + 1 == finding.steps.len()),
        };
        rows.push([what, number(step.cost, 3), probability(step.probability)]);
        before = Some(step);
    }
    rows
}

fn step_words(before: &PlanFinding, step: &PlanFinding, last: bool) -> String {
    let factor_before = |name: &str| {
        before.purchases.iter().find(|p| p.factor == name).map_or(1.0, |p| p.spread_factor)
    };
    let narrower: Vec<String> = step
        .purchases
        .iter()
        .filter(|p| p.spread_factor < factor_before(&p.factor))
        .map(|p| format!("{} × {}", p.factor, number(p.spread_factor, 2)))
        .collect();
    let given_back = before.purchases.iter().any(|p| {
        step.purchases.iter().find(|q| q.factor == p.factor).map_or(1.0, |q| q.spread_factor)
            > p.spread_factor
    });
    let moved: Vec<String> = before
        .design
        .iter()
        .zip(&step.design)
        .filter(|(a, b)| a.after != b.after)
        .map(|(_, b)| format!("{} = {}", b.path, shown(b.after, &b.path)))
        .collect();
    if last && given_back {
        return "after local refinement: the plan".to_owned();
    }
    let words: Vec<String> = narrower.into_iter().chain(moved).collect();
    if words.is_empty() { "after local refinement".to_owned() } else { words.join(", ") }
}

fn quantity_of(path: &str) -> Quantity {
    let parameter = path.split('[').next().and_then(Parameter::from_path);
    parameter.map_or(Quantity::Number, |parameter| parameter.info().quantity)
}

fn shown(si: f64, path: &str) -> String {
    value(si, quantity_of(path))
}

fn plan_rows(plan: &PlanFinding) -> Vec<[String; 4]> {
    let design = plan.design.iter().filter(|change| change.before != change.after).map(design_row);
    design.chain(plan.purchases.iter().map(purchase_row)).collect()
}

fn design_row(change: &DesignChange) -> [String; 4] {
    let text = |si| shown(si, &change.path);
    [change.path.clone(), text(change.before), text(change.after), "0".to_owned()]
}

fn purchase_row(purchase: &PurchaseFinding) -> [String; 4] {
    let spread = |si: f64| match purchase.relative {
        true => format!("{} %", number(100.0 * si, 3)),
        false => {
            let quantity = quantity_of(&purchase.factor).of_difference();
            format!("sd {}", value(si, quantity))
        }
    };
    let many = match purchase.inputs {
        1 => String::new(),
        many => format!(", {many} as one"),
    };
    [
        format!("{}{many}: spread × {}", purchase.factor, number(purchase.spread_factor, 3)),
        spread(purchase.spread.0),
        spread(purchase.spread.1),
        number(purchase.cost, 3),
    ]
}

fn estimate(estimate: &Estimate) -> String {
    let value = estimate.value.map_or("–".to_owned(), probability);
    format!("{value} ({})", probability_interval(&estimate.interval))
}

fn lines(finding: &TightenFinding) -> Vec<String> {
    let limits: Vec<String> = finding
        .confirmed_limits
        .iter()
        .map(|(name, p)| format!("{name} {}", estimate(p)))
        .collect();
    let mut lines = vec![format!("In the confirming run, by limit: {}.", limits.join("; "))];
    if finding.design_alone.design.iter().any(|change| change.before != change.after) {
        let design = finding.design_alone.design.iter();
        let values: Vec<String> =
            design.map(|c| format!("{} = {}", c.path, shown(c.after, &c.path))).collect();
        lines.push(format!(
            "With no tightening the best design is {}: P(any breach) {}, against {} now.",
            values.join(", "),
            probability(finding.design_alone.probability),
            estimate(&finding.present)
        ));
    }
    if let Some(residual) = &finding.residual {
        let causes: Vec<String> = residual
            .causes
            .iter()
            .take(SHOWN_CAUSES)
            .map(|(name, p)| format!("{name} → {}", estimate(p)))
            .collect();
        lines.push(format!(
            "With everything bought P(any breach) is {}. If one factor more had no spread at all: {}.",
            estimate(&residual.probability),
            causes.join("; ")
        ));
    }
    lines.extend(finding.proof.as_ref().map(|proof| proof.statement.clone()));
    lines.push(format!(
        "Searched on {} samples with common random numbers ({} plans, {} descents in all). A spread can be bought \
         unless its card says cost = \"none\"; those of the weather, known on the day, and of the model's own error only if \
         the card gives them a cost.",
        count(finding.samples),
        count(finding.evaluations),
        count(finding.descents)
    ));
    lines
}
