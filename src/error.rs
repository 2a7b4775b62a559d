//! What can go wrong before a study runs, said once and well.
//!
//! An [`Error`] means that the study cannot be run at all. A sample that could not be computed is a
//! fault (`crate::descent::Fault`), and a breached limit is an answer; neither is an error.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The result of anything that can fail with an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Why a study could not be run.
#[derive(Debug, Clone, PartialEq)]
pub enum Error {
    /// Something in a text that a person wrote: a study, a card, a value on the command line.
    Input(Box<Diagnostic>),
    /// A file or directory that could not be read or written.
    File {
        /// The file or directory.
        path: PathBuf,
        /// What was being done to it, as a verb: "read", "write", "rename".
        doing: &'static str,
        /// The reason, as the system gave it.
        reason: String,
        /// What to do about it.
        help: String,
    },
    /// An argument that a numerical routine cannot use.
    Argument(String),
    /// Several of them, two at least, in the order in which they were found.
    Several(Vec<Error>),
}

/// One mistake in one text: where it is, what was expected, what to do.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// The text's name: a file name, or the command-line option that carried it.
    pub origin: String,
    /// The whole text.
    pub text: String,
    /// The bytes of `text` that are wrong.
    pub span: Range<usize>,
    /// What is wrong, in one sentence.
    pub problem: String,
    /// What was expected at the span.
    pub expected: String,
    /// What to do, where there is something to say: the nearest known key, an example.
    pub help: Option<String>,
}

impl Diagnostic {
    /// Line and column of the span's start, both counted from 1, the column in characters.
    pub fn position(&self) -> (usize, usize) {
        let mut start = self.span.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &self.text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }
}

impl Error {
    /// An error of the file system, with the system's reason.
    pub fn file(
        path: impl AsRef<Path>,
        doing: &'static str,
        reason: impl fmt::Display,
        help: impl Into<String>,
    ) -> Self {
        Error::File {
            path: path.as_ref().to_owned(),
            doing,
            reason: reason.to_string(),
            help: help.into(),
        }
    }

    /// The name of the text that is wrong.
    fn origin(&self) -> Option<&str> {
        match self {
            Error::Input(diagnostic) => Some(&diagnostic.origin),
            _ => None,
        }
    }

    /// Several errors as one, those of a text in its order; one of them stays itself.
    pub fn several(errors: Vec<Error>) -> Self {
        let mut flat: Vec<Error> = Vec::new();
        for error in errors {
            match error {
                Error::Several(inner) => flat.extend(inner),
                one => flat.push(one),
            }
        }
        // A reader goes through a text from its start; texts stay in the order in which they were read.
        let origins: Vec<String> =
            flat.iter().filter_map(Error::origin).map(str::to_owned).collect();
        flat.sort_by_key(|error| match error {
            Error::Input(d) => (origins.iter().position(|o| *o == d.origin), d.span.start),
            _ => (None, 0),
        });
        match flat.len() {
            1 => flat.swap_remove(0),
            _ => Error::Several(flat),
        }
    }

    /// An error about an argument.
    pub fn argument(message: impl Into<String>) -> Self {
        Error::Argument(message.into())
    }
}

impl From<Diagnostic> for Error {
    fn from(diagnostic: Diagnostic) -> Self {
        Error::Input(Box::new(diagnostic))
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Input(d) => {
                let (line, column) = d.position();
                write!(f, "{}:{line}:{column}: {}: {}", d.origin, d.problem, d.expected)?;
                match &d.help {
                    Some(help) => write!(f, "; {help}"),
                    None => Ok(()),
                }
            }
            Error::File { path, doing, reason, help } => {
                write!(f, "cannot {doing} {}: {reason}", path.display())?;
                if help.is_empty() { Ok(()) } else { write!(f, "; {help}") }
            }
            Error::Argument(message) => f.write_str(message),
            Error::Several(errors) => {
                for (k, error) in errors.iter().enumerate() {
                    let end = if k + 1 < errors.len() { "\n" } else { "" };
                    write!(f, "{error}{end}")?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for Error {}
