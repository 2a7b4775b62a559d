//! A calibration as text: for a terminal, as Markdown, and as cards.

use super::figures::Figure;
use super::figures_of_speech::probability;
use super::markdown;
use super::tables::table;
use crate::findings::calibration::{
    CalibrationFinding, LawFinding, ParameterFinding, RiskFinding, about_one,
};
use crate::units::number;

/// Inputs shown on a terminal.
const DIGITS: usize = 4;

/// The calibration for a terminal.
pub fn calibration_terminal(finding: &CalibrationFinding) -> String {
    let mut text = format!("{}: calibration by {} runs\n", finding.title, calibrated(finding));
    for line in &finding.statements {
        text += &format!("\n{}\n", super::terminal::wrapped(line));
    }
    for suspicion in &finding.suspicions {
        text += &format!(
            "\n{}\n",
            super::terminal::wrapped(&format!("look at: {}", about_one(suspicion)))
        );
    }
    let rows = finding.parameters.iter().map(parameter_row);
    text += &format!("\n{}\n", table(&PARAMETER_HEADER, 1..4, rows, None));
    let rows = check_rows(finding);
    text += &format!("\n{}\n", table(&CHECK_HEADER, 2..6, rows, None));
    if finding.risk.is_some() {
        text += &format!("\n{}\n", table(&RISK_HEADER, 1..4, risk_rows(finding), None));
    }
    if finding.next.is_some() {
        text += &format!("\n{}\n", table(&NEXT_HEADER, 2..4, next_rows(finding), None));
    }
    text
}

const PARAMETER_HEADER: [&str; 4] =
    ["parameter (SI)", "prior", "posterior", "prior variance reduced by"];
const CHECK_HEADER: [&str; 6] =
    ["run", "channel", "in the 90 % band", "independent", "residual rms", "band ±"];
const RISK_HEADER: [&str; 4] = ["P(breach)", "5 % of brakes below", "all", "95 % of brakes below"];
const NEXT_HEADER: [&str; 4] = ["next measurement", "how", "band expected", "width left"];

fn calibrated(finding: &CalibrationFinding) -> usize {
    finding.runs.iter().filter(|run| !run.held_out).count()
}

fn spread((mean, sd): (f64, f64), unit: &str) -> String {
    let text = format!("{} ± {}", number(mean, DIGITS), number(sd, 2));
    if unit.is_empty() { text } else { format!("{text} {unit}") }
}

fn parameter_row(parameter: &ParameterFinding) -> [String; 4] {
    let learned = match parameter.prior_dominated {
        true => "not identified".to_owned(),
        false => format!("{:.0} %", 100.0 * parameter.learned),
    };
    [
        parameter.name.clone(),
        spread(parameter.prior, parameter.unit),
        spread(parameter.posterior, parameter.unit),
        learned,
    ]
}

fn check_rows(finding: &CalibrationFinding) -> Vec<[String; 6]> {
    let row = |check: &crate::findings::calibration::CheckFinding| {
        let held = if check.held_out { " (held out)" } else { "" };
        let unit = si_unit(check.channel);
        [
            format!("{}{held}", short(&check.run)),
            check.channel.to_owned(),
            probability(check.coverage),
            format!("{:.0} of {}", check.independent, check.course.len()),
            format!("{} {unit}", number(check.residual_rms, 3)),
            format!("{} {unit}", number(check.half_width, 3)),
        ]
    };
    finding.checks.iter().map(row).collect()
}

/// Unit of a channel's differences, SI.
fn si_unit(channel: &str) -> &'static str {
    match channel {
        "force" => "N",
        "speed" => "m/s",
        "line" => "m",
        _ => "K",
    }
}

/// A file's name without its directories.
fn short(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

fn risk_rows(finding: &CalibrationFinding) -> Vec<[String; 4]> {
    let Some((before, after)) = &finding.risk else { return Vec::new() };
    let any = |name: &str, risk: &RiskFinding| {
        [
            format!("any limit, {name}"),
            probability(risk.band[0]),
            probability(risk.probability),
            probability(risk.band[2]),
        ]
    };
    let mut rows = vec![any("before", before), any("after", after)];
    for ((limit, was), (_, is)) in before.limits.iter().zip(&after.limits) {
        let blank = String::new;
        rows.push([format!("{limit}, before"), blank(), probability(*was), blank()]);
        rows.push([format!("{limit}, after"), blank(), probability(*is), blank()]);
    }
    rows
}

fn next_rows(finding: &CalibrationFinding) -> Vec<[String; 4]> {
    let Some(next) = &finding.next else { return Vec::new() };
    let band = |band: [f64; 2]| format!("{} … {}", probability(band[0]), probability(band[1]));
    let none = ["none".to_owned(), String::new(), band(next.band), probability(1.0)];
    let tests = next.tests.iter().map(|test| {
        [test.name.clone(), test.detail.clone(), band(test.band), probability(test.width_left)]
    });
    std::iter::once(none).chain(tests).collect()
}

fn markdown_table<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let mut text = format!("| {} |\n|{}\n", header.join(" | "), " --- |".repeat(N));
    for row in rows {
        text += &markdown::row(&row);
    }
    text
}

/// The calibration as Markdown; its figures are files in the directory `figures` beside it.
pub fn calibration_markdown(finding: &CalibrationFinding, figures: &[Figure]) -> String {
    let mut text = format!("# {}: calibration\n\n", markdown::inline(&finding.title));
    for line in &finding.statements {
        text += &format!("- {line}\n");
    }
    text += "\n## Rig runs\n\n";
    let runs = finding.runs.iter().map(|run| {
        [
            short(&run.name).to_owned(),
            match (run.held_out, run.synthetic) {
                (true, false) => "held out".to_owned(),
                (true, true) => "held out; synthetic".to_owned(),
                (false, false) => "calibrated with".to_owned(),
                (false, true) => "calibrated with; synthetic".to_owned(),
            },
            run.drive.to_owned(),
            run.predicted.join(", "),
            run.moments.to_string(),
            format!("`{}`", run.sha256),
        ]
    });
    text += &markdown_table(["run", "use", "driven by", "predicted", "readings", "SHA-256"], runs);
    if finding.suspicions.is_empty() {
        text += "\nNothing about the readings is suspicious: no gaps, outliers, stuck sensors or mistaken units.\n";
    }
    for suspicion in &finding.suspicions {
        text += &format!("\n- Look at {}.\n", about_one(suspicion));
    }
    text += "\n## What the data identify\n\nMean ± standard deviation, SI. \
             The gaps act on the rig only through the sum of their reciprocals, and through it only together with the \
             viscosity: the brake's strength is what a run measures, and each gap stays near its prior.\n\n";
    text += &markdown_table(PARAMETER_HEADER, finding.parameters.iter().map(parameter_row));
    text += &figures_named(figures, |name| name == "shrinkage");
    text += "\nNuisance parameters: initial states, sensor errors, and the model discrepancy, an Ornstein–Uhlenbeck process of each \
             channel.\n\n";
    text += &markdown_table(
        ["", "prior", "posterior", "prior variance reduced by"],
        finding.nuisances.iter().map(parameter_row),
    );
    text += "\n## Posterior predictive checks\n\nThe share of the readings inside the 90 % band of what the posterior \
             predicts of them; neighbours within the discrepancy's correlation time count as one.\n\n";
    text += &markdown_table(CHECK_HEADER, check_rows(finding));
    text += &figures_named(figures, |name| name.starts_with("residuals"));
    if finding.risk.is_some() {
        text += "\n## What it does to the probability of a breach\n\nOver brakes drawn from prior and posterior, each with the \
                 same flights; the band is over brakes, what is not known, and each value within it is over flights, what \
                 varies. `reeldown run` with the calibrated card gives the full account.\n\n";
        text += &markdown_table(RISK_HEADER, risk_rows(finding));
    }
    if let Some(next) = &finding.next {
        text += &format!(
            "\n## What to measure next\n\nExpected band on P(any breach) after each measurement, linearised at the \
             posterior mean (probit of P linear in the inputs, which explains {} of its variance; errors as found in the runs). \
             In a linear model the width after a measurement does not depend on its reading.\n\n",
            probability(next.linear)
        );
        text += &markdown_table(NEXT_HEADER, next_rows(finding));
    }
    text += "\n## Do the data agree?\n\nEach run against what the others expect of it (leave one out), the posterior against the \
             card, and each channel's errors against independence (Ljung and Box). Of calibrations whose every \
             assumption holds about one in ten is doubted.\n\n";
    let tests = finding.consistency.iter().map(|test| {
        [
            test.channel.map_or(short(&test.of).to_owned(), |channel| {
                format!("{}, {channel}", short(&test.of))
            }),
            test.against.to_owned(),
            format!("{:.1} ({})", test.test.statistic, test.test.degrees),
            number(test.test.p, 2),
            number(test.least, 2),
        ]
    });
    let header = ["", "against", "chi-squared (degrees of freedom)", "p", "in doubt below"];
    text += &markdown_table(header, tests);
    text += &format!("\n## Sampling\n\n{}", sampling(finding));
    let reproduction = &finding.reproduction;
    text += &format!(
        "\n## To reproduce\n\n```\n{}\n```\n\nreeldown {}, seed {}, digest of the resolved study `{}`.\n",
        reproduction.command, reproduction.version, reproduction.seed, reproduction.study_digest
    );
    text
}

fn sampling(finding: &CalibrationFinding) -> String {
    let d = &finding.diagnosis;
    let rows = [
        ["R-hat, the largest".to_owned(), format!("{:.4}", d.worst_r_hat)],
        ["effective draws".to_owned(), format!("{:.0} of {}", d.effective, finding.draws)],
        ["ln evidence".to_owned(), format!("{:.2} ± {:.2}", d.ln_evidence, d.ln_evidence_error)],
        ["different particles".to_owned(), probability(d.unique)],
        [
            "memory of the particles before the last moves".to_owned(),
            format!("{:.2}", d.remembered),
        ],
        ["likelihoods computed".to_owned(), d.evaluations.to_string()],
        ["proposals that could not be computed".to_owned(), d.impossible.to_string()],
        [
            "best fit (Levenberg–Marquardt)".to_owned(),
            format!(
                "ln likelihood {:.2}, {} steps, {}",
                finding.best_fit.ln_likelihood,
                finding.best_fit.steps,
                if finding.best_fit.converged { "converged" } else { "not converged" }
            ),
        ],
    ];
    markdown_table(["", ""], rows)
}

fn figures_named(figures: &[Figure], wanted: impl Fn(&str) -> bool) -> String {
    let mut text = String::new();
    for figure in figures.iter().filter(|figure| wanted(&figure.name)) {
        text += &format!("\n{}", figure.markdown().trim_end());
        text.push('\n');
    }
    text
}

/// What a card says of itself: comments at its head.
fn head(finding: &CalibrationFinding, what: &str) -> String {
    let reproduction = &finding.reproduction;
    let mut lines = vec![
        what.to_owned(),
        String::new(),
        format!("Made by: {}", reproduction.command),
        format!(
            "reeldown {}, seed {}, digest of the resolved study {}",
            reproduction.version, reproduction.seed, reproduction.study_digest
        ),
    ];
    for (name, digest) in &reproduction.files {
        lines.push(format!("prior: {name}, SHA-256 {digest}"));
    }
    for run in finding.runs.iter().filter(|run| !run.held_out) {
        let made_up = if run.synthetic { " (synthetic: made up, not measured)" } else { "" };
        lines.push(format!("data: {}{made_up}, SHA-256 {}", run.name, run.sha256));
    }
    lines.extend(finding.doubts.iter().map(|doubt| format!("DOUBTED: {doubt}")));
    lines.push(String::new());
    let use_it = "It holds the brake and its fluid only: name it after the card that it was made from, whose other laws stay.";
    lines.push(use_it.to_owned());
    lines.push("  card = [\"<the prior card>\", \"<this card>\"]".to_owned());
    // A comment ends with its line: a line end in a name would begin a statement.
    let comment = |line: String| -> String {
        let line: String = line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        format!("# {line}").trim_end().to_owned() + "\n"
    };
    lines.into_iter().map(comment).collect()
}

fn source(finding: &CalibrationFinding) -> String {
    format!(
        "posterior of {} {}rig runs, reeldown calibrate {}",
        calibrated(finding),
        if made_up(finding) { "synthetic " } else { "" },
        finding.reproduction.version
    )
}

/// Whether any run that was calibrated with was made up.
fn made_up(finding: &CalibrationFinding) -> bool {
    finding.runs.iter().any(|run| run.synthetic && !run.held_out)
}

/// What makes a card a calibrated one: `run` then tells what it changed.
fn parents(finding: &CalibrationFinding) -> String {
    let runs: Vec<String> = finding
        .runs
        .iter()
        .filter(|run| !run.held_out)
        .map(|run| {
            let made_up = if run.synthetic { "synthetic, " } else { "" };
            format!("{} ({made_up}SHA-256 {})", short(&run.name), run.sha256)
        })
        .collect();
    format!("calibrated_from = {}\n", quoted(&runs.join(", ")))
}

/// The card that draws from the joint sample `file`, whose SHA-256 is given.
pub fn calibrated_card(finding: &CalibrationFinding, file: &str, sha256: &str) -> String {
    let mut text =
        head(finding, "The posterior of a calibration, drawn together from its joint sample.");
    text += &format!(
        "\ntitle = {}\n{}\n[[joint]]\nfile = {}\nsha256 = \"{sha256}\"\nknown = \"never\"\nnature = \"unknown\"\ngroup = \"calibrated brake\"\nsource = {}\n",
        quoted(&format!("{}, calibrated", finding.title)),
        parents(finding),
        quoted(file),
        quoted(&source(finding))
    );
    text
}

/// The card of laws and rank correlations.
pub fn calibrated_laws(finding: &CalibrationFinding) -> String {
    let mut text = head(
        finding,
        "The posterior of a calibration as laws and rank correlations: an approximation of its joint sample.",
    );
    let title = quoted(&format!("{}, calibrated (laws)", finding.title));
    text += &format!("\ntitle = {title}\n{}", parents(finding));
    for law in &finding.laws {
        text += &law_text(law, &source(finding));
    }
    for correlation in &finding.correlations {
        text += &format!(
            "\n[[correlation]]\nbetween = [{}, {}]\nspearman = {}\nsource = {}\n",
            quoted(&correlation.between.0),
            quoted(&correlation.between.1),
            number(correlation.spearman, 6),
            quoted(&source(finding))
        );
    }
    text
}

fn law_text(law: &LawFinding, source: &str) -> String {
    let mut text = match law.path.split_once('[') {
        Some((parameter, surface)) => {
            format!("\n[{parameter}.\"{}\"]\n", surface.trim_end_matches(']'))
        }
        None => format!("\n[{}]\n", law.path),
    };
    text += &format!("law = \"{}\"\n", law.law);
    for (key, value) in &law.numbers {
        let unit = if *key == "log_sd" { "" } else { law.unit };
        let value = number(*value, 9);
        text += &match unit.is_empty() {
            true => format!("{key} = {value}\n"),
            false => format!("{key} = \"{value} {unit}\"\n"),
        };
    }
    if law.each_surface {
        text += "each_surface = true\n";
    }
    text + &format!(
        "known = \"{}\"\nnature = \"unknown\"\nsource = {}\n",
        law.known,
        quoted(source)
    )
}

/// A TOML string, whatever is in it.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
