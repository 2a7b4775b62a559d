//! Figures as files: SVG always, PNG beside them for who asks with `--png`.

use crate::error::Result;
use crate::render::{self, Figure};
use crate::store::{write_bytes, write_text};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the command line said; set once, before any command writes.
static PNG: AtomicBool = AtomicBool::new(false);

/// Asks for PNG as well.
pub(super) fn ask_for_png(wanted: bool) {
    PNG.store(wanted, Ordering::Relaxed);
}

/// Writes figures into a directory.
///
/// # Errors
/// If a file cannot be written, or a PNG cannot be drawn.
pub(super) fn write_figures<'a>(
    directory: &Path,
    figures: impl IntoIterator<Item = &'a Figure>,
) -> Result<()> {
    for figure in figures {
        write_text(&directory.join(figure.file_name()), &figure.svg)?;
        if PNG.load(Ordering::Relaxed) {
            let path = directory.join(format!("{}.png", figure.name));
            write_bytes(&path, &render::png(&figure.svg)?)?;
        }
    }
    Ok(())
}
