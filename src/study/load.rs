//! Reading studies: the only place where the study floor touches a file.

use super::assemble::assemble;
use super::digest::of_bytes;
use super::empirical;
use super::files::{Files, NamedText, NumberColumn, SampleColumn, SampleFile};
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
        Study::load_with(path, overrides, Parquet { table: refuse_table })
    }

    /// [`Study::load`] with a reader of Parquet files, for the data of empirical laws and joint samples.
    ///
    /// # Errors
    /// As [`Study::load`].
    pub fn load_with(
        path: Option<&Path>,
        overrides: &[Override],
        parquet: Parquet,
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

impl Study {
    /// Makes a study of its text and that of the one card that it names. No file is read.
    ///
    /// # Errors
    /// A [`crate::error::Diagnostic`] for every mistake in either text.
    pub fn from_texts(study: &str, card: &str) -> Result<Study> {
        let study = NamedText { origin: "study".to_owned(), text: study.to_owned() };
        assemble(&study, &[], &mut OneCard { text: card })
    }
}

/// A card that is a text already.
struct OneCard<'a> {
    text: &'a str,
}

impl Files for OneCard<'_> {
    fn card(&mut self, name: &str, _: bool) -> std::result::Result<NamedText, String> {
        Ok(NamedText { origin: name.to_owned(), text: self.text.to_owned() })
    }

    fn sample(&mut self, _: &str, _: &str) -> std::result::Result<SampleFile, String> {
        Err("a study that is made of texts reads no file".to_owned())
    }
}

/// The file system, seen from a study file.
struct Disk {
    directory: PathBuf,
    embedded: bool,
    parquet: Parquet,
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

    fn sample(&mut self, card: &str, name: &str) -> std::result::Result<SampleFile, String> {
        read_sample(card, name, self.parquet)
    }
}

/// What reads Parquet files; a failure is its reason, in a few words. Only a higher floor knows Parquet, so
/// it hands the reader in.
#[derive(Debug, Clone, Copy)]
pub struct Parquet {
    /// All columns of a file's bytes, in their order.
    pub table: fn(&[u8]) -> std::result::Result<Vec<NumberColumn>, String>,
}

const NO_PARQUET: &str = "Parquet is not read here: export the column as CSV";

/// The reader where there is none.
fn refuse_table(_: &[u8]) -> std::result::Result<Vec<NumberColumn>, String> {
    Err(NO_PARQUET.to_owned())
}

/// Where the file `name` of the card called `card` is: beside the card, or in the working directory for an
/// embedded one.
fn beside(card: &str, name: &str) -> PathBuf {
    let directory = Path::new(card).parent().filter(|_| !card.ends_with(" (embedded)"));
    directory.unwrap_or(Path::new("")).join(name)
}

/// Whether a file is read as Parquet: by its ending, or, whatever that is, by its first and last bytes.
pub(super) fn is_parquet(path: &Path, bytes: &[u8]) -> bool {
    const MAGIC: &[u8] = b"PAR1";
    let by_ending = path.extension().is_some_and(|ending| {
        ["parquet", "parq", "pq"].iter().any(|known| ending.eq_ignore_ascii_case(known))
    });
    by_ending || bytes.starts_with(MAGIC) && bytes.ends_with(MAGIC)
}

/// A column in which nothing may be missing.
fn complete((name, values): NumberColumn) -> SampleColumn {
    let finite = |(row, value): (usize, Option<f64>)| match value {
        Some(value) if value.is_finite() => Ok(value),
        Some(value) => Err(format!("row {} is {value}, not a finite number", row + 1)),
        None => Err(format!("row {} is null", row + 1)),
    };
    let values = values.and_then(|values| values.into_iter().enumerate().map(finite).collect());
    match values {
        Ok(values) if Vec::is_empty(&values) => (name, Err("it holds no numbers".to_owned())),
        values => (name, values),
    }
}

/// The columns of the CSV or Parquet file `name` that the card called `card` names: found relative to
/// the card, or to the working directory for an embedded one.
///
/// # Errors
/// Why the file cannot be read, in a few words.
pub fn read_sample(
    card: &str,
    name: &str,
    parquet: Parquet,
) -> std::result::Result<SampleFile, String> {
    let path = beside(card, name);
    let bytes = read_bytes(&path)?;
    let sha256 = of_bytes(&bytes);
    let mut columns = match is_parquet(&path, &bytes) {
        true => (parquet.table)(&bytes)?.into_iter().map(complete).collect(),
        false => empirical::table(&as_text(bytes)?),
    };
    empirical::refuse_repeated(&mut columns);
    Ok(SampleFile { sha256, columns })
}

/// The text of a file, or why there is none.
pub(super) fn read_text(path: &Path) -> std::result::Result<String, String> {
    as_text(read_bytes(path)?)
}

/// The bytes of a file, or why there are none. A pipe is refused, and so is a device: either may never end.
///
/// # Errors
/// Why the file cannot be read, in a few words.
pub fn read_bytes(path: &Path) -> std::result::Result<Vec<u8>, String> {
    let reason = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => "no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    };
    let about = std::fs::metadata(path).map_err(reason)?;
    if about.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if !about.is_file() {
        return Err("it is a pipe or a device, not a file".to_owned());
    }
    std::fs::read(path).map_err(reason)
}

pub(super) fn as_text(bytes: Vec<u8>) -> std::result::Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        format!("it is not UTF-8 text from byte {valid} on")
    })
}
