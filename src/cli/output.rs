//! Standard output and standard error.

use crate::error::{Error, Result};
use crate::render::Style;
use crate::study::Study;
use std::io::{self, ErrorKind, IsTerminal, Write};

/// Prints a text and a line end to standard output. A reader who has gone away is not an error.
///
/// # Errors
/// If standard output cannot be written to.
pub(super) fn say(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    let written = writeln!(out, "{}", text.trim_end_matches('\n')).and_then(|()| out.flush());
    match written {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            Err(Error::file("standard output", "write to", reason, ""))
        }
        _ => Ok(()),
    }
}

/// Prints a text and a line end to standard error.
pub(super) fn say_error(text: &str) {
    // Where standard error is gone too there is nobody to tell.
    let _ = writeln!(io::stderr().lock(), "{}", text.trim_end_matches('\n'));
}

/// Says on standard error what a reader should know about how a study was understood.
pub(super) fn say_notes(study: &Study) {
    for note in &study.notes {
        say_error(&format!("note: {note}"));
    }
}

/// Colour on a terminal, unless `NO_COLOR` is set to something.
fn style(terminal: bool) -> Style {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if terminal && !refused { Style::Colour } else { Style::Plain }
}

/// How to write to standard output.
pub(super) fn stdout_style() -> Style {
    style(io::stdout().is_terminal())
}

/// How to write to standard error.
pub(super) fn stderr_style() -> Style {
    style(io::stderr().is_terminal())
}
