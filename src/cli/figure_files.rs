//! Figures as files: SVG always, PNG beside them for who asks with `--png`.

use crate::error::Result;
use crate::render::{self, Figure};
use crate::store::{ResultDirectory, write_bytes};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the command line said; set once, before any command writes.
static PNG: AtomicBool = AtomicBool::new(false);

/// Asks for PNG as well.
pub(super) fn ask_for_png(wanted: bool) {
    PNG.store(wanted, Ordering::Relaxed);
}

/// Writes figures into a directory that the user named for them.
///
/// # Errors
/// If a file cannot be written, or a PNG cannot be drawn.
pub(super) fn write_figures<'a>(
    directory: &Path,
    figures: impl IntoIterator<Item = &'a Figure>,
) -> Result<()> {
    each_file(figures, |name, bytes| write_bytes(&directory.join(name), bytes))
}

/// Writes the figures of a report beside it.
///
/// # Errors
/// If a file cannot be written, or a PNG cannot be drawn.
pub(super) fn write_report_figures<'a>(
    directory: &ResultDirectory,
    figures: impl IntoIterator<Item = &'a Figure>,
) -> Result<()> {
    each_file(figures, |name, bytes| directory.write_bytes(&format!("figures/{name}"), bytes))
}

fn each_file<'a>(
    figures: impl IntoIterator<Item = &'a Figure>,
    write: impl Fn(&str, &[u8]) -> Result<()>,
) -> Result<()> {
    for figure in figures {
        write(&figure.file_name(), figure.svg.as_bytes())?;
        if PNG.load(Ordering::Relaxed) {
            write(&format!("{}.png", figure.name), &render::png(&figure.svg)?)?;
        }
    }
    Ok(())
}
