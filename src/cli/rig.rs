//! `reeldown rig`: the horizontal rig, its modes compared, and tests planned on it.

use super::descend::{outcome_json, outcome_table, write_trace};
use super::figure_files::{write_figures, write_report_figures};
use super::output::{say_error, say_notes};
use super::rig_arguments::{RigArguments, option};
use super::{Ending, done};
use crate::descent::driven::Drive;
use crate::descent::{Outcome, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::findings::rig::{self, Equipment, PlanOptions, RigRun};
use crate::physics::Parameter;
use crate::render::{
    Figure, Mark, page, rig_comparison_markdown, rig_comparison_terminal, rig_figures,
    rig_mode_figures, rig_plan_markdown, rig_plan_terminal, table,
};
use crate::store::{Contents, PARQUET, ResultDirectory};
use crate::study::measured_run::Acceptance;
use crate::study::{Limit, MeasuredRun, Study};
use crate::units::{Quantity, System, engineering, format_engineering};
use serde::Serialize;
use serde_json::{Value, json};

/// Runs, compares or plans.
pub(super) fn rig(arguments: &RigArguments) -> Result<Ending> {
    let study = arguments.study.load(&[])?;
    study.design.validate()?;
    let equipment = arguments.equipment(&study.design)?;
    let levels = levels(arguments)?;
    if arguments.compare || arguments.plan.is_some() {
        say_notes(&study);
    }
    if let Some(runs) = arguments.plan {
        return plan(arguments, &study, usize::from(runs), equipment);
    }
    if arguments.compare {
        return compare(arguments, &study, levels.map(|level| level.map(|(_, v)| v)), &equipment);
    }
    single(arguments, &study, levels, equipment.proof_load_n)
}

/// The levels that were given, by mode.
fn levels(arguments: &RigArguments) -> Result<[Option<(Drive, f64)>; 3]> {
    let given = [
        (Drive::Force, "--force", &arguments.force, Quantity::Force),
        (Drive::Speed, "--speed", &arguments.speed, Quantity::Speed),
        (Drive::Power, "--power", &arguments.power, Quantity::Power),
    ];
    let mut levels = [None; 3];
    for (place, (drive, name, text, quantity)) in levels.iter_mut().zip(given) {
        if let Some(text) = text {
            *place = Some((drive, option(name, text, quantity)?));
        }
    }
    Ok(levels)
}

fn single(
    arguments: &RigArguments,
    study: &Study,
    levels: [Option<(Drive, f64)>; 3],
    proof_load_n: f64,
) -> Result<Ending> {
    let mut record = None;
    let (title, run) = match (&arguments.recorded, levels.iter().flatten().collect::<Vec<_>>()) {
        (Some(path), _) => {
            let longest_step =
                if arguments.gaps { f64::INFINITY } else { Acceptance::default().longest_step };
            let measured = MeasuredRun::load(path, Acceptance { longest_step }, PARQUET)?;
            if let Some(note) = measured.note() {
                say_error(&format!("note: {note}"));
            }
            let drive = arguments.by.map_or(measured.preferred_drive(), Drive::from);
            let run = rig::recorded(&study.design, &measured, drive)?;
            let title = format!("driven by the {} recorded in {}", drive.name(), path.display());
            record = Some(measured);
            (title, run)
        }
        (None, given) => match given.as_slice() {
            [(drive, level), ..] => {
                let quantity = match drive {
                    Drive::Force => Quantity::Force,
                    Drive::Speed => Quantity::Speed,
                    Drive::Power => Quantity::Power,
                };
                let held = engineering(*level, quantity);
                let run = rig::held(&study.design, *drive, *level)?;
                (format!("constant {} of {held}", drive.name()), run)
            }
            [] => return Err(Error::argument("no load given")),
        },
    };
    if let Some(path) = &arguments.trace {
        write_trace(path, "horizontal rig, quasi-steady", &run.samples)?;
    }
    let limits = rig_limits(study);
    if let Some(directory) = &arguments.figures {
        let hottest = limits.first().map(|limit| limit.value);
        write_figures(directory, &rig_figures(&run, record.as_ref(), proof_load_n, hottest))?;
    }
    if arguments.json {
        let mut object = outcome_json(&run.outcome);
        object.insert("energy_j".to_owned(), json!(run.energy_j()));
        object.insert("departure_from_linear".to_owned(), json!(run.departure_from_linear()));
        let peak = run.outcome.get(OutcomeQuantity::PeakTension);
        object.insert("load_over_proof".to_owned(), json!(peak / proof_load_n));
        if let Some(record) = &record {
            object.insert("record_digest".to_owned(), json!(record.digest));
            object.insert("residuals".to_owned(), json!(run.residuals));
        }
        return done(&format!("{:#}", Value::Object(object)));
    }
    // A pull is held against the fluid's limit; the others are the flight's.
    let mut rigged = study.clone();
    rigged.limits = limits;
    let mut text = format!("{}: horizontal rig, {title}, quasi-steady model\n\n", study.title);
    text += &outcome_table(&rigged, &Outcome { deployed: true, ..run.outcome });
    if !run.outcome.deployed {
        let out = run.samples.last().map_or(0.0, |sample| sample.line_m);
        let length = study.design.get(Parameter::ReelLineLength);
        let end = if record.is_some() { "record ends" } else { "run was given up after 1800 s," };
        text += &format!(
            "\nThe {end} before the line does: {} of {} are out.\n",
            format_engineering(out, Quantity::Length, System::UsCustomary, 6),
            format_engineering(length, Quantity::Length, System::UsCustomary, 6)
        );
    }
    text += &in_words(&run, proof_load_n);
    for (what, path) in [("course of the run", &arguments.trace), ("figures", &arguments.figures)] {
        if let Some(path) = path {
            text += &format!("\n{what}: {}\n", path.display());
        }
    }
    done(&text)
}

/// The limits of a study that mean something on the rig: the fluid's.
fn rig_limits(study: &Study) -> Vec<Limit> {
    let of_fluid = |limit: &&Limit| limit.outcome == OutcomeQuantity::PeakFluidTemperature;
    study.limits.iter().filter(of_fluid).cloned().collect()
}

/// Energy, load, linearity and residuals of a run.
fn in_words(run: &RigRun, proof_load_n: f64) -> String {
    let peak = run.outcome.get(OutcomeQuantity::PeakTension);
    let over = if peak > proof_load_n { ": EXCEEDED" } else { "" };
    let mut text = format!(
        "\nenergy: {:.4} MJ\npeak load: {:.1} % of the proof load {}{over}\n",
        run.energy_j() * 1e-6,
        100.0 * peak / proof_load_n,
        engineering(proof_load_n, Quantity::Force)
    );
    if let Some(departure) = run.departure_from_linear() {
        text += &format!(
            "fluid temperature strays from a straight line by {:.1} % of its rise, after the first tenth of \
             the run\n",
            100.0 * departure
        );
    }
    if run.residuals.is_empty() {
        return text;
    }
    let rows = run.residuals.iter().map(|residual| {
        let shown = |value| format_engineering(value, residual.quantity(), System::UsCustomary, 4);
        [
            residual.channel.to_owned(),
            if residual.drives { "drives".to_owned() } else { shown(residual.mean) },
            if residual.drives { String::new() } else { shown(residual.root_mean_square) },
            residual.readings.to_string(),
        ]
    });
    let header = ["predicted − measured", "mean", "root mean square", "readings"];
    text + &format!("\n{}\n", table(&header, 1..4, rows, None))
}

fn compare(
    arguments: &RigArguments,
    study: &Study,
    levels: [Option<f64>; 3],
    equipment: &Equipment,
) -> Result<Ending> {
    let found = rig::compare(study, equipment, levels)?;
    if let Some(directory) = &arguments.figures {
        write_figures(directory, &rig_mode_figures(&found))?;
    }
    let figures = rig_mode_figures(&found);
    let report = || rig_comparison_markdown(&found, &figures);
    write_report(arguments, study, &as_json(&found)?, report, &figures)?;
    if arguments.json {
        return done(&as_json(&found)?);
    }
    let mut text = rig_comparison_terminal(&found);
    if let Some(directory) = &arguments.figures {
        text += &format!("\nfigures: {}\n", directory.display());
    }
    done(&(text + &where_report_is(arguments)))
}

fn plan(
    arguments: &RigArguments,
    study: &Study,
    runs: usize,
    equipment: Equipment,
) -> Result<Ending> {
    let starts_k = match &arguments.starts {
        Some(starts) => starts
            .split(',')
            .map(|text| option("--starts", text.trim(), Quantity::Temperature))
            .collect::<Result<Vec<f64>>>()?,
        None => vec![study.design.get(Parameter::InitialTemperature)],
    };
    if starts_k.len() > 8 {
        return Err(Error::argument("--starts: at most eight temperatures can be planned with"));
    }
    let options = PlanOptions { runs, starts_k, equipment };
    let found = rig::plan(study, &options)?;
    write_report(arguments, study, &as_json(&found)?, || rig_plan_markdown(&found), &[])?;
    if arguments.json {
        return done(&as_json(&found)?);
    }
    done(&(rig_plan_terminal(&found) + &where_report_is(arguments)))
}

/// The report's files, in the directory that was named.
const FILES: [&str; 3] = ["report.html", "report.md", "rig.json"];

/// Writes the report of a comparison or a plan, if a directory was named for it.
fn write_report(
    arguments: &RigArguments,
    study: &Study,
    json: &str,
    report: impl Fn() -> String,
    figures: &[Figure],
) -> Result<()> {
    let Some(path) = &arguments.out else { return Ok(()) };
    let contents =
        Contents { kind: "rig", study: &study.title, files: &FILES, force: arguments.overwrite };
    let directory = ResultDirectory::open(path, contents)?;
    let report = report();
    write_report_figures(&directory, figures)?;
    directory.write_text(FILES[0], &page("Horizontal rig", Mark::None, &report, figures)?)?;
    directory.write_text(FILES[1], &report)?;
    directory.write_text(FILES[2], &format!("{json}\n"))?;
    directory.finish()
}

fn where_report_is(arguments: &RigArguments) -> String {
    arguments.out.as_ref().map_or(String::new(), |directory| {
        format!("\nreport: {}\n", directory.join(FILES[0]).display())
    })
}

fn as_json(finding: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(finding)
        .map_err(|reason| Error::argument(format!("the result cannot be written: {reason}")))
}
