//! A sweep of the design space as text: for a terminal, and as Markdown.

use super::figures::Figure;
use super::figures_of_speech::{count, maybe, probability, probability_interval, value};
use super::markdown;
use super::tables::table;
use crate::findings::design_value::Unresolved;
use crate::findings::known::GoAnswer;
use crate::findings::sweep::{CellFinding, PathFinding, SweepFinding};
use crate::findings::sweep_best::BestFinding;
use crate::units::{Quantity, number};

/// Most rows of a table on a terminal.
const SHOWN_ROWS: usize = 25;

/// A sweep for a terminal.
pub fn sweep_terminal(sweep: &SweepFinding) -> String {
    let mut text = format!("{}: {}\n\n", sweep.title, heading(sweep));
    for line in meanings(sweep) {
        text += &format!("{}\n", super::terminal::wrapped(&line.replace('`', "")));
    }
    let (header, rows) = rows(sweep);
    let header: Vec<String> = header.iter().map(|words| in_two_lines(words)).collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let left_out = rows.len() > SHOWN_ROWS;
    let kept = shown(rows.len());
    let rows: Vec<Vec<String>> = kept.into_iter().map(|k| rows[k].clone()).collect();
    text += &format!("\n{}\n", table(&header, 0..header.len(), rows, None));
    if left_out {
        text += "(every few; all are in the report)\n";
    }
    for line in statements(sweep) {
        text += &format!("\n{}\n", super::terminal::wrapped(&line.replace('`', "")));
    }
    text
}

/// A sweep as Markdown; its figures are files in the directory `figures` beside it.
pub fn sweep_markdown(sweep: &SweepFinding, figures: &[Figure]) -> String {
    let mut text = format!("# {}: {}\n\n", markdown::inline(&sweep.title), heading(sweep));
    for line in statements(sweep) {
        text += &format!("{line}\n\n");
    }
    text += "## What was swept\n\n";
    for line in meanings(sweep) {
        text += &format!("- {line}\n");
    }
    text += "\n## The design space\n\n";
    for figure in figures {
        text += &format!("### {}\n\n", figure.title);
        text += &figure.markdown();
    }
    text += match sweep.paths.len() {
        1 => "## Value by value\n\n",
        _ => "## The best value, and what meets the requirement\n\n",
    };
    let (header, rows) = rows(sweep);
    text += &format!("| {} |\n|{}\n", header.join(" | "), " ---: |".repeat(header.len()));
    for row in rows {
        text += &markdown::row(&row);
    }
    text +=
        "\nThe table of every cell is `sweep.parquet`, and everything here is in `sweep.json`.\n";
    text += "\n## Method and caveats\n\n";
    for line in &sweep.method {
        text += &format!("- {line}\n");
    }
    let reproduction = &sweep.reproduction;
    text += &format!(
        "\n## To reproduce\n\n```\n{}\n```\n\nreeldown {}, seed {}, digest of the resolved study `{}`.\n",
        reproduction.command, reproduction.version, reproduction.seed, reproduction.study_digest
    );
    text
}

/// Places of the rows that a terminal shows, the ends among them.
fn shown(rows: usize) -> Vec<usize> {
    let step = rows.saturating_sub(1).div_ceil(SHOWN_ROWS).max(1);
    let mut kept: Vec<usize> = (0..rows).step_by(step).collect();
    if let Some(last) = rows.checked_sub(1)
        && kept.last() != Some(&last)
    {
        kept.push(last);
    }
    kept
}

fn heading(sweep: &SweepFinding) -> String {
    let names: Vec<&str> = sweep.paths.iter().map(|path| path.path.as_str()).collect();
    let cells = count(sweep.cells.len() as u64);
    match sweep.samples {
        Some(samples) => {
            format!("{} over {cells} settings, {} samples each", names.join(" × "), count(samples))
        }
        None => format!("{} over {cells} settings, nominal", names.join(" × ")),
    }
}

fn meanings(sweep: &SweepFinding) -> Vec<String> {
    let line = |path: &PathFinding| {
        let ends = match path.values[..] {
            [first, .., last] => {
                format!("{} … {}", value(first, path.quantity), value(last, path.quantity))
            }
            _ => String::new(),
        };
        format!(
            "`{}` {ends} in {} values ({} in the study): {}.",
            path.path,
            path.values.len(),
            value(path.present, path.quantity),
            if sweep.samples.is_some() { path.statement.as_str() } else { "nominal values" }
        )
    };
    sweep.paths.iter().map(line).collect()
}

/// A column's header, broken at the first space beyond its middle, or else the last before it, if it is long: the
/// columns are narrow.
fn in_two_lines(words: &str) -> String {
    let (before, beyond) = words.split_at(words.len() / 2);
    let at = beyond.find(' ').map(|at| before.len() + at).or_else(|| before.rfind(' '));
    match at {
        Some(at) if words.len() > 16 => format!("{}\n{}", &words[..at], &words[at + 1..]),
        _ => words.to_owned(),
    }
}

/// The table: value by value of one path, or the best value for each value of the other.
fn rows(sweep: &SweepFinding) -> (Vec<String>, Vec<Vec<String>>) {
    match &sweep.paths[..] {
        [path] => single(sweep, path),
        _ => best_rows(sweep),
    }
}

fn single(sweep: &SweepFinding, path: &PathFinding) -> (Vec<String>, Vec<Vec<String>>) {
    let mut header = vec![path.path.clone()];
    for limit in &sweep.limits {
        header.push(limit.name.clone());
        header.push("margin".to_owned());
    }
    if sweep.samples.is_some() {
        header.extend(["P(any breach)", "95 % interval"].map(str::to_owned));
        if sweep.required.is_some() {
            header.push("requirement".to_owned());
        }
    }
    let row = |cell: &CellFinding| {
        let mut row = vec![value(cell.values[0], path.quantity)];
        for (limit, margin) in sweep.limits.iter().zip(&cell.margins) {
            let quantity = limit.quantity.quantity();
            row.push(maybe(cell.outcomes.get(&limit.quantity.column()).copied(), quantity));
            let text = maybe(*margin, quantity.of_difference());
            row.push(if margin.is_some_and(|m| m < 0.0) { format!("{text} BREACH") } else { text });
        }
        if let Some(any) = &cell.any {
            row.push(any.value.map_or("–".to_owned(), probability));
            row.push(probability_interval(&any.interval));
            if sweep.required.is_some() {
                row.push(words(cell.answer).to_owned());
            }
        }
        row
    };
    (header, sweep.cells.iter().map(row).collect())
}

fn words(answer: GoAnswer) -> &'static str {
    match answer {
        GoAnswer::Go => "met",
        GoAnswer::NoGo => "not met",
        GoAnswer::Undecided => "undecided",
        GoAnswer::NoRequirement => "–",
    }
}

/// The paths of which one is chosen and the other given.
fn roles(sweep: &SweepFinding) -> Option<(&PathFinding, Option<&PathFinding>)> {
    let chosen = sweep.paths.get(sweep.choice)?;
    let given = (sweep.paths.len() == 2).then(|| &sweep.paths[1 - sweep.choice]);
    Some((chosen, given))
}

fn best_rows(sweep: &SweepFinding) -> (Vec<String>, Vec<Vec<String>>) {
    let Some((chosen, Some(given))) = roles(sweep) else { return (Vec::new(), Vec::new()) };
    let mut header = vec![given.path.clone()];
    let sampled = sweep.samples.is_some();
    if sampled {
        header.push(format!("best {}", chosen.path));
        header.extend(["95 % interval", "P(any breach) there"].map(str::to_owned));
        if sweep.required.is_some() {
            header.push("requirement met".to_owned());
        }
    } else {
        header.push(format!("largest-margin {}", chosen.path));
        header.push("smallest margin".to_owned());
    }
    header.push("nominal descent keeps limits".to_owned());
    let range = |range: Option<(f64, f64)>| match range {
        Some((a, b)) if a == b => format!("at {}", value(a, chosen.quantity)),
        Some((a, b)) => format!("{} … {}", bare(a, chosen.quantity), value(b, chosen.quantity)),
        None => "nowhere".to_owned(),
    };
    let row = |best: &BestFinding| {
        let mut row = vec![maybe(best.given, given.quantity)];
        if sampled {
            row.push(maybe(best.best.value, chosen.quantity));
            row.push(interval(best, chosen.quantity));
            let there = best.probability.as_ref();
            row.push(there.map_or("–".to_owned(), |p| {
                let share = p.value.map_or("–".to_owned(), probability);
                format!("{share} ({})", probability_interval(&p.interval))
            }));
            if sweep.required.is_some() {
                row.push(range(best.met));
            }
        } else {
            row.push(best.nominal.map_or("–".to_owned(), |(v, _)| value(v, chosen.quantity)));
            row.push(best.nominal.map_or("–".to_owned(), |(_, margin)| share(margin)));
        }
        row.push(range(best.feasible));
        row
    };
    (header, sweep.best.iter().map(row).collect())
}

fn bare(si: f64, quantity: Quantity) -> String {
    super::figures_of_speech::bare(si, quantity)
}

fn share(margin: f64) -> String {
    format!("{} %", number(100.0 * margin, 3))
}

/// The interval of a best value, or in a word why there is none.
fn interval(found: &BestFinding, quantity: Quantity) -> String {
    match (found.best.interval.interval(), found.best.value) {
        (Some(i), _) => format!("{} … {}", bare(i.lower, quantity), value(i.upper, quantity)),
        (None, None) => "all breach".to_owned(),
        (None, Some(_)) => match found.unresolved {
            Some(Unresolved::EndOfRange) => "end of the range".to_owned(),
            Some(Unresolved::NoBreach) => "no failures".to_owned(),
            Some(Unresolved::NoClearMinimum) | None => "not resolved".to_owned(),
        },
    }
}

/// What the sweep says, in a few sentences.
fn statements(sweep: &SweepFinding) -> Vec<String> {
    let Some((chosen, given)) = roles(sweep) else { return Vec::new() };
    let mut lines = Vec::new();
    let kept = sweep.cells.iter().filter(|cell| {
        !cell.margins.is_empty() && cell.margins.iter().all(|m| m.is_some_and(|m| m >= 0.0))
    });
    lines.push(format!(
        "The nominal descent keeps every limit at {} of {} settings.",
        count(kept.count() as u64),
        count(sweep.cells.len() as u64)
    ));
    if let (Some((allowed, confidence)), Some(_)) = (sweep.required, sweep.samples) {
        let met = sweep.cells.iter().filter(|cell| cell.answer == GoAnswer::Go).count();
        let required = format!(
            "P(any breach) ≤ {} at {} confidence",
            probability(allowed),
            probability(confidence)
        );
        lines.push(match met {
            0 => format!("{required} is demonstrated at no setting."),
            met => format!(
                "{required} is demonstrated at {} settings, each by itself, by samples independent of the search.",
                count(met as u64)
            ),
        });
        let smallest = sweep.cells.iter().filter_map(|cell| Some((cell, cell.confirmed.as_ref()?)));
        let smallest = smallest.min_by_key(|(cell, _)| {
            cell.counts.first().map_or(u64::MAX, |any| any.most_breaches())
        });
        if let (0, Some((cell, any))) = (met, smallest) {
            let at: Vec<String> = sweep
                .paths
                .iter()
                .zip(&cell.values)
                .map(|(path, &v)| format!("`{}` = {}", path.path, value(v, path.quantity)))
                .collect();
            lines.push(format!(
                "The smallest P(any breach) found is {} ({}), at {}; re-estimated on samples independent of \
                 the search.",
                any.value.map_or("unknown".to_owned(), probability),
                probability_interval(&any.interval),
                at.join(", ")
            ));
        }
    }
    if let (None, Some(best)) = (given, sweep.best.first()) {
        lines.extend(best_sentence(sweep, chosen, best));
    }
    lines
}

fn best_sentence(sweep: &SweepFinding, chosen: &PathFinding, best: &BestFinding) -> Option<String> {
    if sweep.samples.is_none() {
        let (at, margin) = best.nominal?;
        return Some(format!(
            "The margin of the nominal descent is largest at `{}` = {}: the smallest margin there is {} of the limit.",
            chosen.path,
            value(at, chosen.quantity),
            share(margin)
        ));
    }
    let said = interval(best, chosen.quantity);
    let interval = match best.best.interval.interval() {
        Some(_) => format!("95 % interval {said}"),
        None => format!("no interval: {said}"),
    };
    let at = best.best.value?;
    let there = best.probability.as_ref().and_then(|p| p.value).map_or(String::new(), |p| {
        let interval = best.probability.as_ref().map(|p| probability_interval(&p.interval));
        format!(
            "; P there is {} ({}), re-estimated on samples independent of the search",
            probability(p),
            interval.unwrap_or_default()
        )
    });
    Some(format!(
        "P(any breach) is least at `{}` = {} ({interval}){there}.",
        chosen.path,
        value(at, chosen.quantity),
    ))
}
