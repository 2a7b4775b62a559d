//! What the program says of itself: schemas, completions, the manual page.

use super::arguments::{Arguments, SchemaKind};
use super::{Ending, done};
use crate::error::{Error, Result};
use crate::study::schema;
use clap::CommandFactory;

/// Prints a JSON Schema.
pub(super) fn schema(kind: SchemaKind) -> Result<Ending> {
    let schema = match kind {
        SchemaKind::Study => schema::study(),
        SchemaKind::Card => schema::card(),
    };
    done(&format!("{schema:#}"))
}

/// Prints a completion script.
pub(super) fn completions(shell: clap_complete::Shell) -> Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "reeldown", &mut script);
    done(&String::from_utf8_lossy(&script))
}

/// Prints the manual page, the commands' pages after the program's.
pub(super) fn man() -> Result<Ending> {
    let mut command = Arguments::command();
    command.build();
    let mut page = Vec::new();
    let fail = |reason| Error::file("standard output", "write to", reason, "");
    clap_mangen::Man::new(command.clone()).render(&mut page).map_err(fail)?;
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        clap_mangen::Man::new(sub.clone()).render(&mut page).map_err(fail)?;
    }
    done(&String::from_utf8_lossy(&page))
}
