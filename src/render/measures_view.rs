//! Whether other measures agree, and the local derivatives, in a reader's words.

use super::figures_of_speech::count;
use super::trade_view::name_of;
use crate::descent::OutcomeQuantity;
use crate::findings::MeasuresFinding;
use crate::findings::measures::local::LocalFinding;
use crate::findings::measures::ranking::RankingFinding;
use crate::units::{display, number};
use serde::Serialize;

/// Factors with less effect than this share of the largest are left out of the table of derivatives.
const NEGLIGIBLE: f64 = 0.01;

/// The measures, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Measures {
    pub none: Option<String>,
    pub ranking: Option<Ranking>,
    pub local: Option<Local>,
}

/// Ranks by every measure.
#[derive(Debug, Serialize)]
pub(super) struct Ranking {
    pub about: String,
    pub measures: Vec<&'static str>,
    pub rows: Vec<Row>,
}

/// What a step of each input does.
#[derive(Debug, Serialize)]
pub(super) struct Local {
    pub about: String,
    pub outcomes: Vec<String>,
    pub rows: Vec<Row>,
}

/// A row of cells.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    pub name: String,
    pub cells: Vec<String>,
}

pub(super) fn measures(finding: &MeasuresFinding) -> Measures {
    Measures {
        none: finding.none.clone(),
        ranking: finding.ranking.as_ref().map(|found| ranking(finding, found)),
        local: local(&finding.local),
    }
}

fn ranking(finding: &MeasuresFinding, found: &RankingFinding) -> Ranking {
    let output = finding.outputs.iter().find(|output| output.name == found.output);
    let samples = |index: &str| {
        let column = output.and_then(|o| o.indices.iter().find(|column| column.index == index));
        count(column.map_or(0, |column| column.samples as u64))
    };
    let first =
        found.rows.iter().max_by_key(|row| row.ranks.iter().filter(|rank| **rank == 1).count());
    let agreement = first.map_or(String::new(), |row| {
        let all = found.agree_on_first == found.measures.len();
        let how_many = if all { "All".to_owned() } else { format!("{} of", found.agree_on_first) };
        format!(
            "{how_many} {} measures put {} first",
            found.measures.len(),
            name_of(&row.factor, row.inputs)
        )
    });
    let concordance = found.concordance.map_or(String::new(), |w| {
        format!(
            "; Kendall's concordance of the rankings is {} (1: identical, 0: unrelated)",
            number(w, 2)
        )
    });
    let about = format!(
        "Ranks of the factors for {} by every measure. {agreement}{concordance}. In parentheses: not significantly different from zero. \
         S₁ is the first-order index, slope the derivative at the means. \
         The measures reuse the first samples of the run: first order by ranks and regressions {}, Borgonovo's δ and \
         PAWN {}, HSIC {} (permutation test); Morris' screening has {} trajectories of its own. A group is represented by the \
         sum of its members' scores, in SRRC by the spread of its part of the linear model, in PRCC by the multiple \
         partial correlation, for Morris and derivatives by the root of the sum of their squares. Borgonovo's δ has a \
         lower confidence bound only. \
         Every index of every limited outcome and breach, target and conditional ones among them, with its interval or why it has none, \
         is in `sensitivity.parquet` and `findings.json`.",
        found.title,
        samples("first_order"),
        samples("borgonovo_delta"),
        samples("hsic"),
        samples("morris_mu_star"),
    );
    let rows = found.rows.iter().map(|row| Row {
        name: name_of(&row.factor, row.inputs),
        cells: row
            .ranks
            .iter()
            .zip(&row.distinct)
            .map(|(rank, distinct)| match distinct {
                Some(false) => format!("({rank})"),
                _ => rank.to_string(),
            })
            .collect(),
    });
    Ranking { about, measures: found.measures.clone(), rows: rows.collect() }
}

fn local(finding: &LocalFinding) -> Option<Local> {
    let quantity = |name: &str| OutcomeQuantity::from_name(name);
    let unit = |name: &str| {
        let of = quantity(name).map(|q| display(q.quantity().of_difference()));
        of.map_or((1.0, ""), |unit| (unit.scale, unit.symbol))
    };
    // An effect of a step is small or not against the largest on the same outcome.
    let effect = |o: usize, k: usize| {
        finding.outcomes[o].nominal[k].map_or(0.0, |slope| (slope * finding.targets[k].step).abs())
    };
    let share = |k: usize| {
        let of = |o: usize| {
            let all = (0..finding.targets.len()).map(|k| effect(o, k)).fold(0.0, f64::max);
            if all > 0.0 { effect(o, k) / all } else { 0.0 }
        };
        (0..finding.outcomes.len()).map(of).fold(0.0, f64::max)
    };
    let shown: Vec<usize> = (0..finding.targets.len()).filter(|&k| share(k) > NEGLIGIBLE).collect();
    if shown.is_empty() {
        return None;
    }
    let title = |name: &'static str| {
        let title = quantity(name).map_or(name, OutcomeQuantity::title);
        match unit(name).1 {
            "" => title.to_owned(),
            symbol => format!("{title}, {symbol}"),
        }
    };
    let cell = |o: usize, k: usize| {
        let outcome = &finding.outcomes[o];
        outcome.nominal[k].map_or("–".to_owned(), |slope| {
            let text = number(slope * finding.targets[k].step * unit(outcome.name).0, 3);
            if slope > 0.0 { format!("+{text}") } else { text.replace('-', "−") }
        })
    };
    let rows = shown.iter().map(|&k| {
        let target = &finding.targets[k];
        let name = format!("{}: {}", name_of(&target.path, target.inputs), target.step_text);
        Row { name, cells: (0..finding.outcomes.len()).map(|o| cell(o, k)).collect() }
    });
    let omitted = finding.targets.len() - shown.len();
    let left = match omitted {
        0 => String::new(),
        some => format!(
            " Left out: {some} with less than a hundredth of the largest effect on every outcome."
        ),
    };
    Some(Local {
        about: format!(
            "What a small step of one input does to the nominal descent: derivative times step, by differentiating \
             the integrator (no sampling error). Derivatives per SI unit, there and with every input at its mean, are in \
             `findings.json`.{left}"
        ),
        outcomes: finding.outcomes.iter().map(|outcome| title(outcome.name)).collect(),
        rows: rows.collect(),
    })
}
