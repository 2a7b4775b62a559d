//! All mistakes of a text, so that one reading of it is enough to mend them.

use crate::error::{Error, Result};

/// The mistakes found so far.
#[derive(Default)]
pub(super) struct Mistakes(Vec<Error>);

impl Mistakes {
    /// The value, or nothing and its mistake kept.
    pub fn keep<T>(&mut self, result: Result<T>) -> Option<T> {
        result.map_err(|error| self.0.push(error)).ok()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The value if there is no mistake at all.
    ///
    /// # Errors
    /// The one mistake, or all as one.
    pub fn none_or<T>(self, value: Option<T>) -> Result<T> {
        match (value, self.0.is_empty()) {
            (Some(value), true) => Ok(value),
            _ => Err(Error::several(self.0)),
        }
    }
}

/// The values of all results, or all mistakes.
pub(super) fn all<T>(results: impl IntoIterator<Item = Result<T>>) -> Result<Vec<T>> {
    let mut mistakes = Mistakes::default();
    let values = results.into_iter().filter_map(|result| mistakes.keep(result)).collect();
    mistakes.none_or(Some(values))
}
