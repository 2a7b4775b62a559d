//! The page that puts each of the paper's figures beside what the paper says of it.

use super::figures::{Figure, paper_figures, rig_mode_figures, starting_temperature_figure};
use super::figures_of_speech::value;
use super::page::anchor;
use crate::findings::paper::{PaperFinding, Statement, Verdict};
use crate::units::Quantity;

/// The page and the figures beside it.
#[derive(Debug, Clone)]
pub struct PaperPage {
    /// Markdown; figures are linked in the directory `figures`.
    pub markdown: String,
    /// The figures.
    pub figures: Vec<Figure>,
}

/// What a statement comes to.
fn verdict(statement: &Statement) -> &'static str {
    match statement.verdict {
        Verdict::Pass => "pass",
        Verdict::Fail => "**FAIL**",
        Verdict::Undecided => "undecided",
        Verdict::NoTest => "no test",
    }
}

/// How many statements came to what.
pub fn paper_count(statements: &[Statement]) -> String {
    let count = |verdict| statements.iter().filter(|s| s.verdict == verdict).count();
    let fail = count(Verdict::Fail);
    let mut text = format!(
        "{} of the paper's {} statements agree, {fail} {}",
        count(Verdict::Pass),
        statements.len(),
        if fail == 1 { "does not" } else { "do not" },
    );
    for (count, what) in [
        (count(Verdict::Undecided), "undecided"),
        (count(Verdict::NoTest), "no test (nothing else could have come out)"),
    ] {
        if count > 0 {
            text += &format!(", {count} {} {what}", if count == 1 { "is" } else { "are" });
        }
    }
    text
}

/// The page of a finding; `design` says what was computed, `command` makes it again.
pub fn paper_page(finding: &PaperFinding, design: &str, command: &str) -> PaperPage {
    let figures: Vec<Figure> = paper_figures(&finding.runs)
        .into_iter()
        .chain(starting_temperature_figure(&finding.family))
        .chain(rig_mode_figures(&finding.modes))
        .collect();
    let statements = &finding.statements;
    let mut text = format!(
        "# The paper's figures, drawn again\n\n\
         G. Jumper, *Improved Viscous Brake Design Using Simulation*, describes a brake that reels a payload \
         down 500 ft below a balloon, and shows the course of a run in Figures 4 to 10 and, in words, that of a \
         test on the ground in three modes. Does this program show the same?\n\n\
         **{}.**\n\n",
        paper_count(statements)
    );
    text +=
        "| where | the paper says (in our words) | here | verdict |\n| --- | --- | --- | --- |\n";
    for statement in statements {
        text += &format!(
            "| {} | {} | {} | {} |\n",
            link(statement, &figures),
            statement.says,
            statement.found,
            verdict(statement)
        );
    }
    for statement in statements.iter().filter(|s| s.verdict != Verdict::Pass) {
        let remark = statement.remark.as_deref().unwrap_or("no reason is known");
        text += &format!("\n**{}, {}:** {remark}.\n", statement.place, statement.says);
    }
    text += "\nPassed with a reservation:\n\n";
    for statement in statements.iter().filter(|s| s.verdict == Verdict::Pass) {
        if let Some(remark) = &statement.remark {
            text += &format!("- **{}**, {}: {remark}.\n", statement.place, statement.says);
        }
    }
    text += &format!(
        "\nWhat was computed: {design} Curves are the quasi-steady solution, as the paper's are, but for the \
         dynamic one in Fig. 4. The paper's own curves are not at hand as numbers: each verdict is on what its \
         text says, and is computed from the data, not judged by eye.\n"
    );
    for figure in figures.iter().filter(|figure| figure.name.starts_with("figure-")) {
        let place = place(figure);
        text += &section(figure, statements.iter().filter(|s| s.place == place));
    }
    text += &format!(
        "\n## The horizontal rig\n\nThree ways to pull the line with a truck, by the {} model. Each is held at the flight's mean \
         or, where the load or the fluid's temperature would exceed what is allowed, at the greatest level that \
         keeps the proof load of {} (assumed; the paper gives none) and the fluid's limit.\n\n",
        finding.modes.model,
        value(finding.modes.proof_load_n, Quantity::Force)
    );
    text += &told(statements.iter().filter(|s| s.place.starts_with("rig")));
    for figure in figures.iter().filter(|figure| figure.name.starts_with("rig-")) {
        text += &format!("\n### {}\n\n{}\n", figure.title, figure.markdown().trim_end());
    }
    text += &format!("\n## Made by\n\n```\n{command}\n```\n");
    PaperPage { markdown: text, figures }
}

/// The place in the paper that a figure redraws: "Fig. 5" of `figure-5-torque`.
fn place(figure: &Figure) -> String {
    let number = figure.name.split('-').nth(1).unwrap_or("");
    format!("Fig. {number}")
}

/// A statement's place as a link to its figure's heading on the page.
fn link(statement: &Statement, figures: &[Figure]) -> String {
    let found = figures
        .iter()
        .find(|figure| figure.name.starts_with("figure-") && place(figure) == statement.place);
    match found {
        Some(figure) => format!("[{}](#{})", statement.place, anchor(&figure.title)),
        None if statement.place.starts_with("rig") => {
            format!("[{}](#the-horizontal-rig)", statement.place)
        }
        None => statement.place.to_owned(),
    }
}

/// Statements as a list with their verdicts and remarks.
fn told<'a>(statements: impl Iterator<Item = &'a Statement>) -> String {
    let mut text = String::new();
    for statement in statements {
        text += &format!(
            "- **The paper:** {}. **Here:** {}. Verdict: {}.\n",
            statement.says,
            statement.found,
            verdict(statement)
        );
    }
    text
}

fn section<'a>(figure: &Figure, statements: impl Iterator<Item = &'a Statement>) -> String {
    format!("\n## {}\n\n{}\n\n{}", figure.title, figure.markdown().trim_end(), told(statements))
}
