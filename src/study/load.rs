//! Reading studies: the only place where the study floor touches a file.

use super::assemble::{Files, NamedText, assemble};
use super::empirical;
use super::{Override, Study};
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// The study that runs when none is named; the same text as `reports/habe/study.toml`.
pub const EMBEDDED_STUDY: &str = include_str!("../../reports/habe/study.toml");

/// The card of [`EMBEDDED_STUDY`]; the same text as `distributions/habe.toml`.
pub const EMBEDDED_CARD: &str = include_str!("../../distributions/habe.toml");

/// What the embedded study calls its card.
const EMBEDDED_CARD_NAME: &str = "../../distributions/habe.toml";

impl Study {
    /// Loads a study and its cards, changed by the overrides; `None` is the embedded study.
    ///
    /// Cards are found relative to the study file, those of `--set card=…` and the CSV files of the
    /// embedded study relative to the working directory.
    ///
    /// # Errors
    /// [`Error::File`] if the study file cannot be read; a [`crate::error::Diagnostic`] for every
    /// mistake in it, a card that cannot be read included.
    pub fn load(path: Option<&Path>, overrides: &[Override]) -> Result<Study> {
        Study::load_with(path, overrides, refuse_parquet)
    }

    /// [`Study::load`] with a reader of Parquet columns, for empirical laws whose data is in such files.
    ///
    /// # Errors
    /// As [`Study::load`].
    pub fn load_with(
        path: Option<&Path>,
        overrides: &[Override],
        parquet: ParquetColumn,
    ) -> Result<Study> {
        match path {
            None => {
                let study = NamedText {
                    origin: "reports/habe/study.toml (embedded)".to_owned(),
                    text: EMBEDDED_STUDY.to_owned(),
                };
                assemble(
                    &study,
                    overrides,
                    &mut Disk { directory: PathBuf::new(), embedded: true, parquet },
                )
            }
            Some(path) => {
                let text = read_text(path).map_err(|reason| {
                    let help = "name a study file, or none for the embedded study";
                    Error::file(path, "read", reason, help)
                })?;
                let study = NamedText { origin: path.display().to_string(), text };
                let directory = path.parent().map(Path::to_owned).unwrap_or_default();
                assemble(&study, overrides, &mut Disk { directory, embedded: false, parquet })
            }
        }
    }
}

/// The file system, seen from a study file.
struct Disk {
    directory: PathBuf,
    embedded: bool,
    parquet: ParquetColumn,
}

impl Files for Disk {
    fn card(&mut self, name: &str, by_option: bool) -> std::result::Result<NamedText, String> {
        if self.embedded && name == EMBEDDED_CARD_NAME {
            return Ok(NamedText {
                origin: "distributions/habe.toml (embedded)".to_owned(),
                text: EMBEDDED_CARD.to_owned(),
            });
        }
        let path = if by_option { PathBuf::from(name) } else { self.directory.join(name) };
        let text = read_text(&path)?;
        Ok(NamedText { origin: path.display().to_string(), text })
    }

    fn column(
        &mut self,
        card: &str,
        name: &str,
        column: &str,
    ) -> std::result::Result<Vec<f64>, String> {
        read_column(card, name, column, self.parquet)
    }
}

/// Reads a column of numbers from a Parquet file; a failure is its reason, in a few words. Only a higher
/// floor knows Parquet, so it hands the reader in.
pub type ParquetColumn = fn(&Path, &str) -> std::result::Result<Vec<f64>, String>;

/// The reader where there is none.
fn refuse_parquet(_: &Path, _: &str) -> std::result::Result<Vec<f64>, String> {
    Err("Parquet is not read here: export the column as CSV".to_owned())
}

/// The numbers of a column of the CSV or Parquet file `name` that the card called `card` names: found relative to
/// the card, or to the working directory for an embedded one.
///
/// # Errors
/// Why the column cannot be read, in a few words.
pub fn read_column(
    card: &str,
    name: &str,
    column: &str,
    parquet: ParquetColumn,
) -> std::result::Result<Vec<f64>, String> {
    let directory = Path::new(card).parent().filter(|_| !card.ends_with(" (embedded)"));
    let path = directory.unwrap_or(Path::new("")).join(name);
    if path.extension().is_some_and(|ending| ending == "parquet") {
        return parquet(&path, column);
    }
    empirical::column(&read_text(&path)?, column)
}

/// The text of a file, or why there is none.
pub(super) fn read_text(path: &Path) -> std::result::Result<String, String> {
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => "no such file".to_owned(),
        std::io::ErrorKind::IsADirectory => "it is a directory".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        format!("it is not UTF-8 text from byte {valid} on")
    })
}
