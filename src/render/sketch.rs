//! The end of a run on a terminal: a line for every limited outcome, drawn in blocks, and the verdict in
//! one line. Nothing is wider than 80 columns.

use super::figures_of_speech::probability;
use crate::analysis::Findings;
use crate::descent::OutcomeQuantity;
use crate::findings::{Decision, Distribution, EventKind, VerdictWord};
use crate::units::{Quantity, display, number};

/// Most columns of blocks.
const COLUMNS: usize = 20;
const BLOCKS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
const LIMIT: char = '┃';

/// A line for every limited outcome.
pub(super) fn sketches(findings: &Findings) -> String {
    let lines: Vec<Line> =
        findings.figures.distributions.iter().filter_map(|d| line(findings, d)).collect();
    let widest = |read: fn(&Line) -> &String| {
        lines.iter().map(|line| read(line).chars().count()).max().unwrap_or(0)
    };
    let (title, low) = (widest(|l| &l.title), widest(|l| &l.low));
    let (blocks, high) = (widest(|l| &l.blocks), widest(|l| &l.high));
    let mut text = String::new();
    for l in &lines {
        let line = format!(
            "{:<title$}  {:>low$} {:<blocks$} {:<high$}  {}",
            l.title, l.low, l.blocks, l.high, l.beyond
        );
        text += &format!("{}\n", line.trim_end());
    }
    text
}

struct Line {
    title: String,
    low: String,
    blocks: String,
    high: String,
    beyond: String,
}

fn line(findings: &Findings, distribution: &Distribution) -> Option<Line> {
    let quantity = OutcomeQuantity::from_name(distribution.outcome)?;
    let unit = display(quantity.quantity());
    let shown = |si: f64| number(unit.shown(si), 3);
    // A limit beyond what is drawn is an end of the line, apart from the blocks.
    let limit = distribution.limit_value;
    let first = distribution.edges.first()?.min(limit);
    let last = distribution.edges.last()?.max(limit);
    let found = findings
        .probabilities
        .iter()
        .find(|p| p.kind == EventKind::Limit && p.limits.first() == Some(&distribution.limit))?;
    let beyond = match (found.counts.breaches, found.probability) {
        (0, _) => "no breach".to_owned(),
        (_, Some(p)) => format!("{} beyond", share(p)),
        (_, None) => String::new(),
    };
    Some(Line {
        title: quantity.title().to_owned(),
        low: shown(first),
        blocks: blocks(distribution),
        high: with_unit(shown(last), quantity.quantity()),
        beyond,
    })
}

fn with_unit(text: String, quantity: Quantity) -> String {
    let symbol = display(quantity).symbol;
    if symbol.is_empty() { text } else { format!("{text} {symbol}") }
}

/// A probability to three digits, so that the line keeps its length.
fn share(p: f64) -> String {
    match p {
        0.0 => "0".to_owned(),
        p if p < 1e-5 => format!("{p:.1e}"),
        p => format!("{} %", number(100.0 * p, 3)),
    }
}

/// The histogram in blocks, bins taken together from the limit on, with the limit between them.
fn blocks(distribution: &Distribution) -> String {
    let counts = &distribution.counts;
    let group = counts.len().div_ceil(COLUMNS).max(1);
    // The limit is an edge of the bins or lies outside.
    let at = distribution.edges.partition_point(|&edge| edge < distribution.limit_value);
    let split = at.min(counts.len());
    let (clean, rest) = counts.split_at(split);
    let sum = |part: &[u64]| part.iter().sum::<u64>();
    let mut before: Vec<u64> = clean.rchunks(group).map(sum).collect();
    before.reverse();
    let after: Vec<u64> = rest.chunks(group).map(sum).collect();
    let highest = before.iter().chain(&after).copied().max().unwrap_or(0).max(1);
    let block = |count: &u64| match *count {
        0 => ' ',
        count => BLOCKS[((count - 1) * BLOCKS.len() as u64 / highest).min(7) as usize],
    };
    let (before, after): (String, String) =
        (before.iter().map(block).collect(), after.iter().map(block).collect());
    // Apart, where the limit lies beyond what is drawn.
    match (before.is_empty(), after.is_empty()) {
        (true, _) if at == 0 => format!("{LIMIT} {after}"),
        (_, true) => format!("{before} {LIMIT}"),
        _ => format!("{before}{LIMIT}{after}"),
    }
}

/// The verdict in one line.
pub(super) fn verdict(findings: &Findings) -> String {
    let word = match findings.verdict.word {
        VerdictWord::Met => "MET",
        VerdictWord::NotMet => "NOT MET",
        VerdictWord::Undecided => "UNDECIDED",
        VerdictWord::NoRequirement => "NO REQUIREMENT",
    };
    if let Some(Decision::Brake { allowed, probability: belief, required }) =
        &findings.verdict.decision
    {
        let value = belief.value.map_or("unknown".to_owned(), share);
        return format!(
            "{word}: this brake has P(any breach) of at most {} with probability {value}, required {}",
            probability(*allowed),
            probability(*required)
        );
    }
    let any = findings.probabilities.iter().find(|p| p.kind == EventKind::Any);
    let Some((any, p)) = any.and_then(|any| Some((any, any.probability?))) else {
        return word.to_owned();
    };
    let interval = any
        .interval
        .interval()
        .map_or(String::new(), |i| format!(" ({} … {})", share(i.lower), share(i.upper)));
    let allowed = findings.verdict.reliability.map_or(String::new(), |reliability| {
        format!(", allowed {}", probability(1.0 - reliability))
    });
    format!("{word}: P(any breach) {}{interval}{allowed}", share(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distribution(counts: &[u64], limit_value: f64) -> Distribution {
        Distribution {
            limit: "time".to_owned(),
            outcome: "time",
            limit_text: String::new(),
            limit_value,
            upper: true,
            samples: counts.iter().sum(),
            faults: 0,
            edges: (0..=counts.len()).map(|k| k as f64).collect(),
            counts: counts.to_vec(),
            outside: (0, 0),
            exceedance: Vec::new(),
            simultaneous_half_width: None,
            why_no_interval: None,
        }
    }

    #[test]
    fn analytic_the_limit_stands_between_the_bins_it_parts() {
        let counts = [1, 4, 8, 4, 0, 1];
        assert_eq!(blocks(&distribution(&counts, 3.0)), "▁▄█┃▄ ▁");
        assert_eq!(blocks(&distribution(&counts, 60.0)), "▁▄█▄ ▁ ┃");
        assert_eq!(blocks(&distribution(&counts, -5.0)), "┃ ▁▄█▄ ▁");
    }

    #[test]
    fn property_bins_are_taken_together_on_either_side_of_the_limit() {
        let counts = vec![5; 50];
        let drawn = blocks(&distribution(&counts, 31.0));
        let sides: Vec<usize> = drawn.split(LIMIT).map(|side| side.chars().count()).collect();
        assert_eq!(sides, [11, 7], "31 and 19 bins by three: {drawn}");
        assert!(drawn.chars().count() <= COLUMNS + 2);
    }
}
