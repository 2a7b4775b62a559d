//! What was typed, carried out: the only place that prints, and the only one that knows clap.

mod arguments;
mod calibrate;
mod calibrate_arguments;
mod check;
mod command_line;
mod compare;
mod descend;
mod describe;
mod diagnostics;
mod engines;
mod explain;
mod figure_files;
mod output;
mod paper;
mod parentage;
mod plan_file;
mod replay;
mod rig;
mod rig_arguments;
mod run;
mod sensitivity_table;
mod shards;
mod sweep;
mod tighten;
mod trade_tables;
mod watch;

use crate::error::{Error, Result};
use crate::units::spelling::nearest;
use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use output::{say, say_error};
use std::process::ExitCode;

/// How a command ended, as an exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Done, and the requirement, if any, is met.
    Done,
    /// The study cannot be run.
    Failed,
    /// Done, and the requirement is not met.
    NotMet,
    /// Done, and the requirement is undecided.
    Undecided,
    /// Shards of a plan are not there.
    Incomplete,
    /// A shard cannot be computed, and no second attempt would change that.
    Permanent,
    /// Stopped by Ctrl-C with what was computed kept.
    Interrupted,
    /// A shard was stopped; nothing was left of it.
    Terminated,
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> ExitCode {
        ExitCode::from(match ending {
            Ending::Done => 0,
            Ending::Failed => 1,
            Ending::NotMet => 3,
            Ending::Undecided => 4,
            Ending::Incomplete => 5,
            Ending::Permanent => 2,
            Ending::Interrupted => 130,
            Ending::Terminated => 143,
        })
    }
}

/// Reads the command line and carries it out. Usage errors exit with 2, by clap.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Some(Command::Rig(rig)) = &arguments.command
        && let Err(usage) = rig.consistent()
    {
        usage.exit();
    }
    figure_files::ask_for_png(arguments.png);
    match carry_out(arguments) {
        Ok(ending) => ending.into(),
        Err(error) => {
            say_error(&diagnostics::render(&error, output::stderr_style()));
            Ending::Failed.into()
        }
    }
}

fn carry_out(arguments: Arguments) -> Result<Ending> {
    match arguments.command {
        None => {
            misspelt_command(arguments.run.sampled.study.study.as_deref())?;
            run::run(&arguments.run)
        }
        Some(Command::Run(run)) => run::run(&run),
        Some(Command::Plan(plan)) => shards::plan(&plan),
        Some(Command::Shard(shard)) => shards::shard(&shard),
        Some(Command::Missing(missing)) => shards::missing(&missing),
        Some(Command::Merge(merge)) => run::merge(&merge),
        Some(Command::Descend(descend)) => descend::descend(&descend),
        Some(Command::Calibrate(calibrate)) => calibrate::calibrate(&calibrate),
        Some(Command::Compare(compare)) => compare::compare(&compare),
        Some(Command::Sweep(sweep)) => sweep::sweep(&sweep),
        Some(Command::Tighten(tighten)) => tighten::tighten(&tighten),
        Some(Command::Paper(paper)) => paper::paper(&paper),
        Some(Command::Rig(rig)) => rig::rig(&rig),
        Some(Command::Replay(replay)) => replay::replay(&replay),
        Some(Command::Check(check)) => check::check(&check),
        Some(Command::Explain(explain)) => explain::explain(&explain),
        Some(Command::Schema { kind }) => describe::schema(kind),
        Some(Command::Completions { shell }) => describe::completions(shell),
        Some(Command::Man) => describe::man(),
    }
}

/// A first word that is no file but nearly a command was meant as that.
fn misspelt_command(study: Option<&std::path::Path>) -> Result<()> {
    let Some(word) = study.filter(|path| !path.exists()).and_then(std::path::Path::to_str) else {
        return Ok(());
    };
    // A path or a file with an ending is a study.
    if word.contains(['/', '\\', '.']) {
        return Ok(());
    }
    let arguments = Arguments::command();
    let names: Vec<&str> = arguments.get_subcommands().map(|command| command.get_name()).collect();
    let help = match nearest(word, names.iter().copied()) {
        Some(near) => format!("did you mean `reeldown {near}`?"),
        None => format!("the commands are {}", names.join(", ")),
    };
    Err(Error::argument(format!("there is no command and no study file called {word}; {help}")))
}

/// Prints lines to standard output and says that all is well.
fn done(text: &str) -> Result<Ending> {
    say(text)?;
    Ok(Ending::Done)
}
