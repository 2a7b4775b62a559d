//! Figures as pixels, for those who ask: slides and mail programs that show no SVG.
//!
//! `resvg` (Apache-2.0 or MIT, kept) draws the SVG that [`super::figures`] makes, with a sans-serif font of the
//! machine: pixels may differ from machine to machine where the SVG does not, so PNG is never part of
//! what a study promises to reproduce.

use crate::error::{Error, Result};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;
use std::sync::OnceLock;

/// Pixels per unit of the SVG: twice, for sharp print at the width of a column.
const SCALE: f32 = 2.0;

/// A figure's SVG as a PNG file, white where it is transparent.
///
/// # Errors
/// If the machine has no font, or the text is no SVG.
pub fn png(svg: &str) -> Result<Vec<u8>> {
    let options = options();
    if options.fontdb.is_empty() {
        return Err(Error::argument(
            "no font was found on this machine, and a figure's labels need one: install a sans-serif font \
             (Debian: fonts-dejavu-core), or take the SVG",
        ));
    }
    let why = |reason: &dyn std::fmt::Display| {
        Error::argument(format!("a figure cannot be drawn as PNG: {reason}"))
    };
    let tree = Tree::from_str(svg, options).map_err(|reason| why(&reason))?;
    let (width, height) = (tree.size().width() * SCALE, tree.size().height() * SCALE);
    let mut pixels = Pixmap::new(width.ceil() as u32, height.ceil() as u32)
        .ok_or_else(|| why(&"it has no size"))?;
    pixels.fill(resvg::tiny_skia::Color::WHITE);
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|reason| why(&reason))
}

/// The machine's fonts are read once.
fn options() -> &'static Options<'static> {
    static OPTIONS: OnceLock<Options<'static>> = OnceLock::new();
    OPTIONS.get_or_init(|| {
        let mut options = Options::default();
        Arc::make_mut(&mut options.fontdb).load_system_fonts();
        options
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_figure_becomes_a_png_of_twice_its_size_or_says_why_not() {
        let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='30' height='20'>\
                   <rect width='30' height='20' fill='red'/></svg>";
        match png(svg) {
            Ok(bytes) => {
                assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
                assert_eq!(u32::from_be_bytes([bytes[16], bytes[17], bytes[18], bytes[19]]), 60);
            }
            Err(reason) => assert!(reason.to_string().contains("no font"), "{reason}"),
        }
        assert!(png("not a figure").is_err());
    }
}
