//! What changed between two runs, as text: for a terminal, and as Markdown.

use super::figures_of_speech::{bare, count, probability, probability_interval, value};
use super::markdown;
use super::tables::table;
use crate::analysis::compare::{ChangeFinding, CompareFinding, DriverChange, EventChange};
use crate::findings::VerdictWord;
use crate::numerics::interval::Estimate;
use crate::units::{Quantity, number};

/// A heading with a table under it.
struct Section {
    title: &'static str,
    header: Vec<&'static str>,
    rows: Vec<Vec<String>>,
    below: Vec<String>,
}

/// Shares of flights whose margins a terminal shows.
const SHOWN_SHARES: [f64; 2] = [0.5, 0.99];

/// The comparison for a terminal.
pub fn compare_terminal(finding: &CompareFinding) -> String {
    let mut shown = finding.clone();
    shown.margins.retain(|margin| SHOWN_SHARES.contains(&margin.share));
    let mut text = format!("{}\n", super::terminal::wrapped(&headline(finding)));
    for section in sections(&shown) {
        if !section.rows.is_empty() {
            let columns = section.header.len();
            let rows = section.rows.iter().cloned();
            text += &format!("\n{}\n", table(&section.header, 1..columns, rows, None));
        } else if section.header[0] == "changed" {
            text += &format!("\n{}\n", NOTHING);
        }
        for line in &section.below {
            text += &format!("{}\n", super::terminal::wrapped(line));
        }
    }
    text
}

/// The comparison as Markdown.
pub fn compare_markdown(finding: &CompareFinding) -> String {
    let [before, after] = &finding.runs;
    let mut text = format!("# What changed from `{}` to `{}`\n\n", before.name, after.name);
    text += &format!("{}\n", headline(finding));
    for section in sections(finding) {
        text += &format!("\n## {}\n\n", section.title);
        if section.rows.is_empty() {
            text += match section.header[0] {
                "changed" => NOTHING,
                _ => "Nothing to compare.",
            };
            text += "\n";
        } else {
            text += &format!("| {} |\n", section.header.join(" | "));
            text += &format!("| --- |{}\n", " ---: |".repeat(section.header.len() - 1));
            for row in &section.rows {
                text += &markdown::row(row);
            }
        }
        for line in &section.below {
            text += &format!("\n{line}\n");
        }
    }
    text += "\n## The runs\n\n| run | title | verdict | samples | digest of the study |\n";
    text += "| --- | --- | --- | ---: | --- |\n";
    for run in &finding.runs {
        let verdict = run.verdict.name().to_owned();
        let samples = count(run.samples);
        let digest = run.study_digest.get(..16).unwrap_or(&run.study_digest);
        let name = format!("`{}`", run.name);
        text +=
            &markdown::row(&[name, run.title.clone(), verdict, samples, format!("`{digest}…`")]);
    }
    text
}

const NOTHING: &str = "The two studies state the same.";

/// The verdicts and the change of P(any breach).
fn headline(finding: &CompareFinding) -> String {
    let [before, after] = &finding.runs;
    let words = |verdict: VerdictWord| verdict.name().to_uppercase();
    let verdict = if before.verdict == after.verdict {
        format!("Verdict: {} in both runs.", words(before.verdict))
    } else {
        format!("Verdict: {}, then {}.", words(before.verdict), words(after.verdict))
    };
    let Some(any) = finding.probabilities.first() else { return verdict };
    let (Some(p), Some(q)) = (any.before.value, any.after.value) else { return verdict };
    let changed = match any.difference.interval.interval() {
        Some(i) if i.upper < 0.0 => "fell",
        Some(i) if i.lower > 0.0 => "rose",
        Some(_) => "is not shown to have changed",
        None => "went",
    };
    format!(
        "{verdict} P(any breach) {changed} from {} to {}: {} percentage points.",
        probability(p),
        probability(q),
        points(&any.difference)
    )
}

/// A difference of probabilities in percentage points with its interval.
fn points(difference: &Estimate) -> String {
    let Some(value) = difference.value else { return "unknown".to_owned() };
    let sign = |x: f64| {
        let text = number(100.0 * x.abs(), 3);
        match text.as_str() {
            "0" => text,
            _ if x < 0.0 => format!("−{text}"),
            _ => format!("+{text}"),
        }
    };
    match difference.interval.interval() {
        Some(i) => format!("{} ({} … {})", sign(value), sign(i.lower), sign(i.upper)),
        None => format!("{} (no interval)", sign(value)),
    }
}

fn sections(finding: &CompareFinding) -> Vec<Section> {
    let mut below = vec![finding.pairing.clone()];
    below.extend(finding.notes.iter().map(|note| format!("{note}.")));
    let mut sections = vec![
        Section {
            title: "What was changed",
            header: vec!["changed", "before", "after"],
            rows: finding.changes.iter().map(change).collect(),
            below: Vec::new(),
        },
        Section {
            title: "How probable a breach is",
            header: vec!["event", "before", "after", "change, 95 %: percentage points"],
            rows: finding.probabilities.iter().map(event).collect(),
            below,
        },
    ];
    if !finding.outcomes.is_empty() {
        sections.push(Section {
            title: "What the outcomes are on average",
            header: vec!["mean", "before", "after", "change, 95 %"],
            rows: finding.outcomes.iter().map(outcome).collect(),
            below: Vec::new(),
        });
    }
    sections.push(Section {
        title: "What margin is left",
        header: vec!["margin kept", "before", "after", "change"],
        rows: finding.margins.iter().map(margin).collect(),
        below: Vec::new(),
    });
    sections.push(Section {
        title: "What drives \"any breach\"",
        header: vec!["driver of any breach, total index", "before", "after", "shown to differ"],
        rows: finding.drivers.iter().map(driver).collect(),
        below: Vec::new(),
    });
    sections
}

fn change(change: &ChangeFinding) -> Vec<String> {
    let what = match change.kind {
        "design" => change.what.clone(),
        "law" | "limit" => format!("{} of {}", change.kind, change.what),
        _ => change.what.clone(),
    };
    let text = |side: &Option<String>| side.clone().unwrap_or("–".to_owned());
    let (before, after) = match (&change.before, &change.after) {
        (Some(before), Some(after)) if change.kind == "law" => differing(before, after),
        (before, after) => (text(before), text(after)),
    };
    vec![what, before, after]
}

/// The parts in which two laws differ, if they are otherwise the same.
fn differing(before: &str, after: &str) -> (String, String) {
    let parts = |text: &str| -> Vec<String> { text.split(", ").map(str::to_owned).collect() };
    let (first, second) = (parts(before), parts(after));
    if first.len() != second.len() {
        return (before.to_owned(), after.to_owned());
    }
    let apart = || first.iter().zip(&second).filter(|(a, b)| a != b);
    let join = |parts: Vec<&str>| parts.join(", ");
    let before = join(apart().map(|(a, _)| a.as_str()).collect());
    (before, join(apart().map(|(_, b)| b.as_str()).collect()))
}

fn event(event: &EventChange) -> Vec<String> {
    let share = |estimate: &Estimate| {
        let value = estimate.value.map_or("–".to_owned(), probability);
        format!("{value} ({})", probability_interval(&estimate.interval))
    };
    vec![event.title.clone(), share(&event.before), share(&event.after), points(&event.difference)]
}

fn outcome(outcome: &crate::analysis::compare::OutcomeChange) -> Vec<String> {
    let quantity = outcome.quantity.quantity();
    let mean = |mean: Option<f64>| mean.map_or("–".to_owned(), |mean| value(mean, quantity));
    let step = quantity.of_difference();
    let change = match (outcome.difference.value, outcome.difference.interval.interval()) {
        (None, _) => "–".to_owned(),
        (Some(change), None) => format!("{} (no interval)", signed(change, step)),
        (Some(change), Some(i)) => {
            let (lower, upper) = (bare(i.lower, step), bare(i.upper, step));
            format!("{} ({} … {})", signed(change, step), minus(&lower), minus(&upper))
        }
    };
    let title = outcome.quantity.title().to_owned();
    vec![title, mean(outcome.before), mean(outcome.after), change]
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn signed(si: f64, quantity: Quantity) -> String {
    let text = minus(&value(si, quantity));
    if si > 0.0 { format!("+{text}") } else { text }
}

fn margin(change: &crate::analysis::compare::MarginChange) -> Vec<String> {
    let quantity = change.quantity.quantity().of_difference();
    let text = |side: Option<f64>| side.map_or("–".to_owned(), |m| minus(&value(m, quantity)));
    let moved = match (change.before, change.after) {
        (Some(before), Some(after)) => signed(after - before, quantity),
        _ => "–".to_owned(),
    };
    vec![
        format!("{}, {} of flights", change.quantity.title(), probability(change.share)),
        text(change.before),
        text(change.after),
        moved,
    ]
}

fn driver(change: &DriverChange) -> Vec<String> {
    let text = |side: Option<(f64, Option<(f64, f64)>)>| match side {
        Some((value, Some((lower, upper)))) => {
            format!("{value:.3} ({lower:.3} … {upper:.3})")
        }
        Some((value, None)) => format!("{value:.3}"),
        None => "–".to_owned(),
    };
    // Intervals that do not meet: a strict test, and no interval of the difference.
    let differs = match (change.before, change.after) {
        (Some((_, Some(a))), Some((_, Some(b)))) if a.1 < b.0 => "larger",
        (Some((_, Some(a))), Some((_, Some(b)))) if b.1 < a.0 => "smaller",
        (Some((_, Some(_))), Some((_, Some(_)))) => "no",
        _ => "–",
    };
    vec![change.factor.clone(), text(change.before), text(change.after), differs.to_owned()]
}
