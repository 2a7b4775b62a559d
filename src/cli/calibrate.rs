//! `reeldown calibrate`: rig runs in, a posterior card out.

use super::calibrate_arguments::CalibrateArguments;
use super::figure_files::write_report_figures;
use super::output::{say, say_error, say_notes};
use super::run::quoted;
use super::{Ending, done};
use crate::campaign::calibration::{self, Calibration, Channel, Options, is_hardware};
use crate::campaign::{self, Progress};
use crate::descent::driven::Drive;
use crate::error::{Error, Result};
use crate::findings::calibration::{self as findings, CalibrationFinding};
use crate::render;
use crate::store::{Contents, Field, ResultDirectory, read_number_columns, write_table};
use crate::study::{MeasuredRun, Study, sha256};
use crate::units;
use std::path::PathBuf;

/// The findings as one tree.
const FINDINGS: &str = "findings.json";
/// The report.
const REPORT: &str = "report.md";
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
        files: &[FINDINGS, REPORT, POSTERIOR, CARD, LAWS],
        force: arguments.force,
    };
    let directory = ResultDirectory::open(&directory, contents)?;
    say_notes(&study);
    let runs = load(&arguments.data)?;
    let held_out = load(&arguments.hold_out)?;
    let mut all: Vec<&MeasuredRun> = runs.iter().map(|(run, _)| run).collect();
    let calibrated = all.clone();
    let unseen: Vec<&MeasuredRun> = held_out.iter().map(|(run, _)| run).collect();
    all.extend(&unseen);
    if !arguments.accept {
        let screened = calibration::screen(&study, &all, &options)?;
        if let Some(why) = findings::refusal(&findings::suspicions(&screened)) {
            return Err(Error::argument(format!(
                "{why}. Correct the run, or say --accept to calibrate with it as it is"
            )));
        }
    }
    let found = campaign::with_threads(arguments.threads.asked(), || {
        calibration::calibrate(&study, &calibrated, &unseen, &options, &Progress::default())
    })??;
    let files: Vec<String> =
        runs.iter().chain(&held_out).map(|(_, digest)| digest.clone()).collect();
    let finding = findings::calibration(&study, &found, &all, &files, command(arguments))?;
    let json = serde_json::to_string_pretty(&finding)
        .map_err(|reason| Error::argument(format!("the findings cannot be written: {reason}")))?;
    let figures = render::calibration_figures(&finding);
    directory.write_text(FINDINGS, &format!("{json}\n"))?;
    write_report_figures(&directory, &figures)?;
    directory.write_text(REPORT, &render::calibration_markdown(&finding, &figures))?;
    if finding.accepted {
        write_cards(&directory, &study, &found, &finding)?;
    }
    let place = directory.path().to_owned();
    directory.finish()?;
    if arguments.json {
        done(&json)?;
    } else {
        say(&render::calibration_terminal(&finding))?;
    }
    if !finding.accepted {
        say_error(&format!("no card is written; the report is in {}", place.display()));
        return Ok(Ending::Undecided);
    }
    if !arguments.json {
        say(&format!("\nthe card: {}", place.join(CARD).display()))?;
    }
    Ok(Ending::Done)
}

fn options(arguments: &CalibrateArguments, study: &Study) -> Result<Options> {
    let mut options = Options::default();
    options.plan.seed = study.sampling.seed;
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
        Some(share) => Some(positive("--discrepancy", share, units::Quantity::Number)?),
    };
    for statement in &arguments.sensor_sd {
        let wrong = |why: String| {
            Error::argument(format!("--sensor-sd {statement}: {why}; write speed=\"0.02 ft/s\""))
        };
        let (name, value) = statement
            .split_once('=')
            .ok_or_else(|| wrong("expected a channel and its standard deviation".to_owned()))?;
        let channel = Channel::from_name(name.trim()).ok_or_else(|| {
            let names = Channel::ALL.map(Channel::name).join(", ");
            wrong(format!("there is no channel {}, only {names}", name.trim()))
        })?;
        let quantity = channel.quantity().of_difference();
        let sd = positive("--sensor-sd", value.trim().trim_matches('"'), quantity)?;
        options.sensor_sd.push((channel, sd));
    }
    Ok(options)
}

fn positive(option: &str, text: &str, quantity: units::Quantity) -> Result<f64> {
    let value = units::parse(text, quantity).map_err(|error| {
        Error::argument(format!("{option} {text}: {}, {}", error.problem, error.expected))
    })?;
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(Error::argument(format!("{option} {text}: expected a positive number"))),
    }
}

/// Runs with the SHA-256 of their files.
fn load(paths: &[PathBuf]) -> Result<Vec<(MeasuredRun, String)>> {
    let mut runs: Vec<(MeasuredRun, String)> = Vec::new();
    for path in paths {
        let run = MeasuredRun::load(path, Default::default(), read_number_columns)?;
        let bytes = std::fs::read(path).map_err(|reason| Error::file(path, "read", reason, ""))?;
        if let Some((other, _)) = runs.iter().find(|(other, _)| other.digest == run.digest) {
            return Err(Error::argument(format!(
                "{} and {} hold the same readings: each run counts once",
                other.origin, run.origin
            )));
        }
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
    let mut words = vec!["reeldown".to_owned(), "calibrate".to_owned()];
    if let Some(study) = &arguments.study.study {
        words.push(quoted(&study.display().to_string()));
    }
    let path = |path: &PathBuf| quoted(&path.display().to_string());
    words.extend(arguments.data.iter().map(|data| format!("--data {}", path(data))));
    words.extend(arguments.hold_out.iter().map(|data| format!("--hold-out {}", path(data))));
    let text = [
        ("--drive", &arguments.drive),
        ("--discrepancy", &arguments.discrepancy),
        ("--seed", &arguments.seed),
    ];
    for (option, value) in text {
        words.extend(value.iter().map(|value| format!("{option} {}", quoted(value))));
    }
    words.extend(arguments.sensor_sd.iter().map(|sd| format!("--sensor-sd {}", quoted(sd))));
    words.extend(arguments.heavy_tails.iter().map(|df| format!("--heavy-tails {df}")));
    words.extend(arguments.particles.iter().map(|n| format!("--particles {n}")));
    words.extend(arguments.replicates.iter().map(|n| format!("--replicates {n}")));
    if arguments.accept {
        words.push("--accept".to_owned());
    }
    words.extend(arguments.study.set.iter().map(|set| format!("--set {}", quoted(set))));
    words.join(" ")
}
