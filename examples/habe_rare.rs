//! P(fluid above 450 °F) and the study's other limits by every method, at two nominal viscosities, beside
//! crude Monte Carlo over 10⁸ descents, with what the methods cost and the most likely way to breach.
//!
//! `cargo run --release --example habe_rare` writes `reports/certificates/habe_rare.md`: the study of `tests/fixtures/habe/`
//! with `fluid.nominal_viscosity` and `reliability.methods` set, the same page every time.

use reeldown::analysis::Sampling;
use reeldown::campaign::{self, Progress};
use reeldown::error::{Error, Result};
use reeldown::findings::{self, RareFinding};
use reeldown::reliability::agreement::agreement;
use reeldown::reliability::crude::from_counts;
use reeldown::reliability::estimate::Estimate;
use reeldown::reliability::event::Event;
use reeldown::reliability::probability::Proportion;
use reeldown::study::{Override, Study};
use reeldown::units::number;

const VISCOSITIES: [&str; 2] = ["125000 cSt", "100000 cSt"];
const METHODS: &str = r#"["form", "sorm", "importance-sampling", "subset-simulation", "line-sampling", "directional-sampling", "cross-entropy"]"#;
/// The crude certificate of 10⁸ descents at each viscosity.
const CRUDE: &str = include_str!("../reports/certificates/crude.md");
const PAGE: &str = "reports/certificates/habe_rare.md";

fn main() -> std::process::ExitCode {
    match page().and_then(|text| {
        std::fs::write(PAGE, text).map_err(|why| Error::argument(format!("{PAGE}: {why}")))
    }) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("habe_rare: {why}");
            std::process::ExitCode::FAILURE
        }
    }
}

fn page() -> Result<String> {
    let mut text = format!(
        "# How likely is it that the fluid gets too hot?\n\n\
        The study `tests/fixtures/habe/study.toml` at two nominal viscosities, every limit, every pair of \
        limits and any limit, by every method. Made by `cargo run --release --example habe_rare`, version {}; \
        the same numbers come from `reeldown run tests/fixtures/habe/study.toml --set 'fluid.nominal_viscosity=\"100000 cSt\"' --set \
        'reliability.methods={METHODS}'`. The rows of crude Monte Carlo over 10⁸ descents are those of \
        [crude.md](crude.md), another seed; a pair has none there. \"Descents\" holds searches and pilots.\n\n\
        A method without an interval says why below its table.\n",
        env!("CARGO_PKG_VERSION")
    );
    for viscosity in VISCOSITIES {
        text.push_str(&format!("\n## {viscosity}\n"));
        let study = study(viscosity)?;
        for finding in rare(&study)? {
            eprintln!("{viscosity}: {}", finding.title);
            text.push_str(&section(viscosity, &finding)?);
        }
    }
    Ok(text)
}

fn study(viscosity: &str) -> Result<Study> {
    let set = [
        format!("fluid.nominal_viscosity=\"{viscosity}\""),
        format!("reliability.methods={METHODS}"),
    ];
    let overrides = set
        .iter()
        .map(|statement| Override::parse("--set", statement))
        .collect::<std::result::Result<Vec<Override>, _>>();
    let refused = |why: &dyn std::fmt::Debug| Error::argument(format!("{why:?}"));
    let overrides = overrides.map_err(|why| refused(&why))?;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/habe/study.toml");
    Study::load(Some(path.as_ref()), &overrides).map_err(|why| refused(&why))
}

/// What the report of such a run says of rare breaches.
fn rare(study: &Study) -> Result<Vec<RareFinding>> {
    let progress = Progress::default();
    let record = Sampling::of(study, &progress)?.record;
    let events = campaign::rare_events(study, &record, &progress)?;
    Ok(findings::rare_findings(study, &events, campaign::nominal(study).as_ref().ok()))
}

fn section(viscosity: &str, finding: &RareFinding) -> Result<String> {
    let mut text = format!(
        "\n### {}\n\n| method | probability | 95 % interval | relative standard error | descents |\n\
        | --- | ---: | ---: | ---: | ---: |\n",
        finding.title
    );
    let crude = match &finding.limits[..] {
        [limit] => crude(viscosity, limit),
        _ => None,
    };
    let event = finding.estimates.first().map_or(Event::Any, |estimate| estimate.event);
    let mut all = finding.estimates.clone();
    if let Some(seen) = crude {
        let large = from_counts(event, seen, 0.95)?;
        text.push_str(&row("crude Monte Carlo, another 10⁸", &large));
        all.push(large);
    }
    for estimate in &finding.estimates {
        text.push_str(&row(estimate.method.name(), estimate));
    }
    text.push('\n');
    for sentence in &finding.without_interval {
        text.push_str(&format!("{sentence}\n"));
    }
    text.push_str(&format!("{}\n", finding.agreement_statement));
    if crude.is_some() {
        text.push_str(match agreement(&all, 0.01)?.agrees {
            Some(true) => "So they do with the 10⁸ descents of the crude run.\n",
            _ => "THEY DO NOT AGREE WITH THE 10⁸ DESCENTS OF THE CRUDE RUN.\n",
        });
    }
    if let Some(point) = &finding.design_point {
        text.push_str(&format!("\n{}\n", point.statement));
    }
    Ok(text)
}

fn row(method: &str, estimate: &Estimate) -> String {
    let shown = |p: f64| number(p, 4);
    let relative = match estimate.relative_standard_error() {
        Some(error) => format!("{} %", number(100.0 * error, 2)),
        None => "–".to_owned(),
    };
    format!(
        "| {method} | {} | {} | {relative} | {} |\n",
        estimate.probability.map_or("none".to_owned(), shown),
        estimate.interval.interval().map_or("none".to_owned(), |i| format!(
            "{} … {}",
            shown(i.lower),
            shown(i.upper)
        )),
        estimate.evaluations
    )
}

/// The counts of a limit in the crude certificate.
fn crude(viscosity: &str, limit: &str) -> Option<Proportion> {
    CRUDE.lines().find_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        match cells[..] {
            [_, of, samples, named, breaches, faults, ..] if of == viscosity && named == limit => {
                let count = |cell: &str| cell.parse::<u64>().ok();
                Proportion::new(count(breaches)?, count(faults)?, count(samples)?).ok()
            }
            _ => None,
        }
    })
}
