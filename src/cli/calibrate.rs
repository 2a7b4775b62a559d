//! `reeldown calibrate`: rig runs in, a posterior card out.

use super::calibrate_arguments::CalibrateArguments;
use super::command_line::CommandLine;
use super::figure_files::write_report_figures;
use super::output::{say, say_error, say_notes};
use super::watch::{carry_out, interruptible};
use super::{Ending, done};
use crate::campaign::calibration::duplicates::refuse_twice;
use crate::campaign::calibration::{self, Calibration, Channel, Options, is_hardware};
use crate::descent::driven::Drive;
use crate::error::{Error, Result};
use crate::findings::calibration::{self as findings, CalibrationFinding};
use crate::render::{self, Mark};
use crate::store::{Contents, Field, PARQUET, ResultDirectory, write_table};
use crate::study::measured_run::Acceptance;
use crate::study::{MeasuredRun, Study, sha256};
use crate::units;
use std::path::PathBuf;

/// The findings as one tree.
const FINDINGS: &str = "findings.json";
/// The report.
const REPORT: &str = "report.md";
/// The report as a page.
const PAGE: &str = "report.html";
/// The joint sample.
const POSTERIOR: &str = "posterior.parquet";
/// The card that draws from it.
const CARD: &str = "calibrated.toml";
/// The card of laws.
const LAWS: &str = "calibrated_laws.toml";

/// Calibrates a study's card and writes report, sample and cards.
pub(super) fn calibrate(arguments: &CalibrateArguments) -> Result<Ending> {
    let seed = arguments.seed.iter().map(|seed| ("--seed", format!("sampling.seed={seed}")));
    let study = arguments.study.load(&seed.collect::<Vec<_>>())?;
    study.design.validate()?;
    let options = options(arguments, &study)?;
    let directory = arguments.out.clone().unwrap_or_else(|| {
        PathBuf::from("runs").join(format!("{}-calibrated", arguments.study.name()))
    });
    let contents = Contents {
        kind: "calibrate",
        study: &study.title,
        files: &[FINDINGS, REPORT, PAGE, POSTERIOR, CARD, LAWS],
        force: arguments.force,
    };
    let directory = ResultDirectory::open(&directory, contents)?;
    say_notes(&study);
    let mut acceptance = Acceptance::default();
    if arguments.gaps {
        acceptance.longest_step = f64::INFINITY;
    }
    let runs = load(&arguments.data, acceptance)?;
    let held_out = load(&arguments.hold_out, acceptance)?;
    let mut all: Vec<&MeasuredRun> = runs.iter().map(|(run, _)| run).collect();
    let calibrated = all.clone();
    let unseen: Vec<&MeasuredRun> = held_out.iter().map(|(run, _)| run).collect();
    all.extend(&unseen);
    refuse_twice(&calibrated, &unseen)?;
    if !arguments.accept {
        let screened = calibration::screen(&study, &all, &options)?;
        if let Some(why) = findings::refusal(&findings::suspicions(&screened)) {
            return Err(Error::argument(format!(
                "{why}. correct the run, or use --accept to calibrate with it unchanged"
            )));
        }
    }
    let progress = interruptible()?;
    let found = carry_out(&progress, arguments.threads.asked(), |progress| {
        progress.begin("calibrating", calibration::about(&options, &calibrated));
        calibration::calibrate(&study, &calibrated, &unseen, &options, progress)
    })?;
    let Some(found) = found else {
        say_error("stopped before the posterior was found: nothing is written");
        return Ok(Ending::Interrupted);
    };
    let files: Vec<String> =
        runs.iter().chain(&held_out).map(|(_, digest)| digest.clone()).collect();
    let finding = findings::calibration(&study, &found, &all, &files, command(arguments))?;
    let json = serde_json::to_string_pretty(&finding)
        .map_err(|reason| Error::argument(format!("the findings cannot be written: {reason}")))?;
    let figures = render::calibration_figures(&finding);
    directory.write_text(FINDINGS, &format!("{json}\n"))?;
    write_report_figures(&directory, &figures)?;
    let report = render::calibration_markdown(&finding, &figures);
    let mark = if finding.accepted { Mark::Met } else { Mark::Undecided };
    directory
        .write_text(PAGE, &render::page("Calibration to rig runs", mark, &report, &figures)?)?;
    directory.write_text(REPORT, &report)?;
    let written = finding.accepted || finding.converged && arguments.accept;
    if written {
        write_cards(&directory, &study, &found, &finding)?;
    }
    let place = directory.path().to_owned();
    directory.finish()?;
    if arguments.json {
        done(&json)?;
    } else {
        say(&render::calibration_terminal(&finding))?;
    }
    if written && !arguments.json {
        say(&format!("\nthe card: {}", place.join(CARD).display()))?;
    }
    if finding.accepted {
        return Ok(Ending::Done);
    }
    if !written {
        let way = match finding.converged {
            true => " (--accept writes it nonetheless)",
            false => "",
        };
        say_error(&format!("no card is written{way}; the report is in {}", place.display()));
    }
    Ok(Ending::Undecided)
}

fn options(arguments: &CalibrateArguments, study: &Study) -> Result<Options> {
    let mut options = Options::seeded(study.sampling.seed);
    if let Some(particles) = arguments.particles {
        options.plan.particles = particles as usize;
    }
    if let Some(replicates) = arguments.replicates {
        options.plan.replicates = replicates;
    }
    options.drive = match arguments.drive.as_deref() {
        None => None,
        Some("force") => Some(Drive::Force),
        Some("speed") => Some(Drive::Speed),
        Some(other) => {
            return Err(Error::argument(format!(
                "--drive {other}: a measured run is driven by its force or its speed"
            )));
        }
    };
    options.degrees_of_freedom = arguments.heavy_tails;
    options.discrepancy = match arguments.discrepancy.as_deref() {
        None => options.discrepancy,
        Some("none") => None,
        Some(share) => {
            Some(at_least("--discrepancy", share, units::Quantity::Number, Least::Positive)?)
        }
    };
    let sd = |option: &str, statements: &[String], example: &str, of: QuantityOf, least| {
        channel_values((option, example), statements, of, least)
    };
    let difference = |channel: Channel| channel.quantity().of_difference();
    let share = |_| units::Quantity::Number;
    options.sensor_sd = sd(
        "--sensor-sd",
        &arguments.sensor_sd,
        "speed=\"0.02 ft/s\"",
        difference,
        Least::Positive,
    )?;
    options.gain_sd = sd("--gain-sd", &arguments.gain_sd, "force=\"1 %\"", share, Least::Zero)?;
    options.offset_sd =
        sd("--offset-sd", &arguments.offset_sd, "fluid=\"2 °F\"", difference, Least::Zero)?;
    Ok(options)
}

/// The quantity of a channel's value.
type QuantityOf = fn(Channel) -> units::Quantity;

/// The smallest value that an option takes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Least {
    /// Anything above zero.
    Positive,
    /// Zero, for none.
    Zero,
}

/// Values stated for channels, such as speed="0.02 ft/s"; `option` with an example of what to write.
fn channel_values(
    (option, example): (&str, &str),
    statements: &[String],
    quantity: QuantityOf,
    least: Least,
) -> Result<Vec<(Channel, f64)>> {
    let mut values: Vec<(Channel, f64)> = Vec::new();
    for statement in statements {
        let wrong =
            |why: String| Error::argument(format!("{option} {statement}: {why}; write {example}"));
        let (name, value) = statement
            .split_once('=')
            .ok_or_else(|| wrong("expected a channel and its standard deviation".to_owned()))?;
        let channel = Channel::from_name(name.trim()).ok_or_else(|| {
            let names = Channel::ALL.map(Channel::name).join(", ");
            wrong(format!("there is no channel {}, only {names}", name.trim()))
        })?;
        if values.iter().any(|(other, _)| *other == channel) {
            return Err(wrong(format!("{} is stated twice", channel.name())));
        }
        let text = value.trim().trim_matches('"');
        values.push((channel, at_least(option, text, quantity(channel), least)?));
    }
    Ok(values)
}

fn at_least(option: &str, text: &str, quantity: units::Quantity, least: Least) -> Result<f64> {
    let value = units::parse(text, quantity).map_err(|error| {
        Error::argument(format!("{option} {text}: {}, {}", error.problem, error.expected))
    })?;
    let (enough, expected) = match least {
        Least::Positive => (value > 0.0, "a positive number"),
        Least::Zero => {
            (value >= 0.0, "a number that is not negative; zero for an error that is not there")
        }
    };
    match enough && value.is_finite() {
        true => Ok(value),
        false => Err(Error::argument(format!("{option} {text}: expected {expected}"))),
    }
}

/// Runs with the SHA-256 of their files.
fn load(paths: &[PathBuf], acceptance: Acceptance) -> Result<Vec<(MeasuredRun, String)>> {
    let mut runs: Vec<(MeasuredRun, String)> = Vec::new();
    for path in paths {
        let run = MeasuredRun::load(path, acceptance, PARQUET)?;
        if let Some(note) = run.note() {
            say_error(&format!("note: {note}"));
        }
        let bytes = std::fs::read(path).map_err(|reason| Error::file(path, "read", reason, ""))?;
        runs.push((run, sha256(&bytes)));
    }
    Ok(runs)
}

fn write_cards(
    directory: &ResultDirectory,
    study: &Study,
    found: &Calibration<'_>,
    finding: &CalibrationFinding,
) -> Result<()> {
    let hardware =
        study.inputs.iter().enumerate().filter(|(_, input)| is_hardware(input.target.parameter));
    let columns = hardware
        .map(|(j, input)| {
            let values = found.inputs.column(j).iter().map(|&value| Some(value)).collect();
            (input.target.column(), Field::Number(values))
        })
        .collect();
    let reproduction = &finding.reproduction;
    let data: Vec<(&str, &str)> =
        finding.runs.iter().map(|run| (run.name.as_str(), run.sha256.as_str())).collect();
    let metadata = vec![
        ("version".to_owned(), reproduction.version.to_owned()),
        ("seed".to_owned(), reproduction.seed.to_string()),
        ("study_digest".to_owned(), reproduction.study_digest.clone()),
        ("file_digests".to_owned(), serde_json::json!(reproduction.files).to_string()),
        ("data_digests".to_owned(), serde_json::json!(data).to_string()),
    ];
    let path = directory.table(POSTERIOR)?;
    write_table(&path, columns, metadata)?;
    let bytes = std::fs::read(&path).map_err(|reason| Error::file(&path, "read", reason, ""))?;
    let card = render::calibrated_card(finding, POSTERIOR, &sha256(&bytes));
    directory.write_text(CARD, &card)?;
    directory.write_text(LAWS, &render::calibrated_laws(finding))
}

/// The command that gives the same numbers.
fn command(arguments: &CalibrateArguments) -> String {
    let named = |paths: &[PathBuf]| -> Vec<String> {
        paths.iter().map(|path| path.display().to_string()).collect()
    };
    CommandLine::new("calibrate", &arguments.study)
        .option("--data", named(&arguments.data))
        .option("--hold-out", named(&arguments.hold_out))
        .option("--drive", &arguments.drive)
        .option("--discrepancy", &arguments.discrepancy)
        .option("--seed", &arguments.seed)
        .option("--sensor-sd", &arguments.sensor_sd)
        .option("--gain-sd", &arguments.gain_sd)
        .option("--offset-sd", &arguments.offset_sd)
        .option("--heavy-tails", arguments.heavy_tails)
        .option("--particles", arguments.particles)
        .option("--replicates", arguments.replicates)
        .flag("--gaps", arguments.gaps)
        .flag("--accept", arguments.accept)
        .set(&arguments.study)
        .line()
}
