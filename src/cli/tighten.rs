//! `reeldown tighten`: which tolerances to buy.

use super::arguments::TightenArguments;
use super::output::{say, say_error};
use super::run::quoted;
use super::watch::{Watch, stop_on_interrupt};
use super::{Ending, done};
use crate::campaign::{self, Progress};
use crate::error::Result;
use crate::findings::known::GoAnswer;
use crate::findings::tighten::{TightenFinding, tighten as findings};
use crate::render;
use crate::store::write_text;
use std::sync::Arc;

/// Descents that a search takes, about: what the progress bar goes by.
const EVALUATIONS: u64 = 250;

/// Finds, confirms and shows a plan.
pub(super) fn tighten(arguments: &TightenArguments) -> Result<Ending> {
    let target = arguments.target.iter().map(|p| ("--target", format!("tighten.target={p}")));
    let study = arguments.study.load(&target.collect::<Vec<_>>())?;
    study.design.validate()?;
    let progress = Arc::new(Progress::default());
    stop_on_interrupt(&progress)?;
    let found = campaign::with_threads(arguments.threads.map(usize::from), || {
        let about = EVALUATIONS * study.tighten.samples;
        let _watch = Watch::start(&progress, about, "searching");
        campaign::tighten::tighten(&study, None, &progress)
    })??;
    let Some(found) = found else {
        say_error("stopped before a plan was found");
        return Ok(Ending::Interrupted);
    };
    let finding = findings(&study, &found, command(arguments))?;
    let json = render::json(&finding)?;
    if let Some(directory) = &arguments.out {
        write_text(&directory.join("tighten.json"), &json)?;
        write_text(&directory.join("tighten.md"), &render::tighten_markdown(&finding))?;
    }
    if arguments.json {
        done(json.trim_end())?;
    } else {
        say(&render::tighten_terminal(&finding))?;
    }
    Ok(ending(&finding))
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
    let mut words = vec!["reeldown".to_owned(), "tighten".to_owned()];
    if let Some(study) = &arguments.study.study {
        words.push(quoted(&study.display().to_string()));
    }
    words.extend(arguments.target.iter().map(|target| format!("--target {}", quoted(target))));
    words.extend(arguments.study.set.iter().map(|set| format!("--set {}", quoted(set))));
    words.join(" ")
}
