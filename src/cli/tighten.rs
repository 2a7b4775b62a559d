//! `reeldown tighten`: which tolerances to buy.

use super::arguments::TightenArguments;
use super::command_line::CommandLine;
use super::output::{say, say_error, say_notes};
use super::watch::{carry_out, interruptible};
use super::{Ending, done};
use crate::campaign;
use crate::error::{Error, Result};
use crate::findings::known::GoAnswer;
use crate::findings::tighten::{TightenFinding, tighten as findings};
use crate::render::{self, Mark};
use crate::store::{Contents, ResultDirectory};

/// The findings as one tree.
const FINDINGS: &str = "tighten.json";
/// The report.
const REPORT: &str = "tighten.md";
/// The report as a page.
const PAGE: &str = "tighten.html";
/// Descents that a search takes, about: what the progress bar goes by.
const EVALUATIONS: u64 = 250;

/// Finds, confirms and shows a plan.
pub(super) fn tighten(arguments: &TightenArguments) -> Result<Ending> {
    let target = arguments.target.iter().map(|p| ("--target", format!("tighten.target={p}")));
    let moves = moves(&arguments.moves)?.map(|statement| ("--move", statement));
    let study = arguments.study.load(&target.chain(moves).collect::<Vec<_>>())?;
    study.design.validate()?;
    let contents = Contents {
        kind: "tighten",
        study: &study.title,
        files: &[FINDINGS, REPORT, PAGE],
        force: arguments.force,
    };
    let directory = arguments.out.as_ref().map(|path| ResultDirectory::open(path, contents));
    let directory = directory.transpose()?;
    say_notes(&study);
    let progress = interruptible()?;
    let found = carry_out(&progress, arguments.threads.asked(), |progress| {
        progress.begin("searching", EVALUATIONS * study.tighten.samples);
        campaign::tighten::tighten(&study, None, progress)
    })?;
    let Some(found) = found else {
        say_error("stopped before a plan was found");
        return Ok(Ending::Interrupted);
    };
    let finding = findings(&study, &found, command(arguments))?;
    let json = render::json(&finding)?;
    if let Some(directory) = directory {
        directory.write_text(FINDINGS, &json)?;
        let report = render::tighten_markdown(&finding);
        let mark = match finding.answer {
            GoAnswer::Go => Mark::Met,
            GoAnswer::NoGo => Mark::NotMet,
            GoAnswer::Undecided | GoAnswer::NoRequirement => Mark::Undecided,
        };
        directory.write_text(PAGE, &render::page("Plan of tolerances", mark, &report, &[])?)?;
        directory.write_text(REPORT, &report)?;
        directory.finish()?;
    }
    if arguments.json {
        done(json.trim_end())?;
    } else {
        say(&render::tighten_terminal(&finding))?;
    }
    Ok(ending(&finding))
}

/// The design values that may move, as a statement about the study.
fn moves(given: &[String]) -> Result<Option<String>> {
    if given.is_empty() {
        return Ok(None);
    }
    if given.iter().any(|text| text == "none") {
        return match given.len() {
            1 => Ok(Some("tighten.design={}".to_owned())),
            _ => {
                Err(Error::argument("--move none holds every design value: give nothing beside it"))
            }
        };
    }
    let ranges = given.iter().map(|text| {
        let parts = text.split_once('=').and_then(|(path, range)| Some((path, range.split_once("..")?)));
        let Some((path, (least, most))) = parts else {
            return Err(Error::argument(format!(
                "--move {text}: expected PATH=LEAST..MOST, such as fluid.nominal_viscosity=\"90000 cSt..140000 cSt\", \
                 or none"
            )));
        };
        let (path, mut least, most) = (path.trim(), least.trim().to_owned(), most.trim());
        // One unit serves both ends.
        let unit = most.trim_start_matches(|c: char| c.is_ascii_digit() || "+-._eE".contains(c)).trim();
        if least.ends_with(|c: char| c.is_ascii_digit()) && !unit.is_empty() {
            least = format!("{least} {unit}");
        }
        Ok(format!("{path:?} = [{least:?}, {most:?}]"))
    });
    let ranges = ranges.collect::<Result<Vec<_>>>()?;
    Ok(Some(format!("tighten.design={{ {} }}", ranges.join(", "))))
}

fn ending(finding: &TightenFinding) -> Ending {
    match finding.answer {
        GoAnswer::Go => Ending::Done,
        GoAnswer::NoGo => Ending::NotMet,
        GoAnswer::Undecided | GoAnswer::NoRequirement => Ending::Undecided,
    }
}

/// The command that gives the same numbers.
fn command(arguments: &TightenArguments) -> String {
    let TightenArguments { study, target, moves, .. } = arguments;
    let command = CommandLine::new("tighten", study).option("--target", target);
    command.option("--move", moves).set(study).line()
}
