//! Where something was written, so that a mistake can be shown there.

use crate::error::{Diagnostic, Error};
use std::ops::Range;
use std::sync::Arc;

/// A text with its name.
#[derive(Debug, PartialEq)]
pub(super) struct Text {
    pub origin: String,
    pub text: String,
}

/// A stretch of a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub text: Arc<Text>,
    pub span: Range<usize>,
}

impl Place {
    /// The stretch `span` of `text`, moved to character boundaries inside it.
    pub fn new(text: &Arc<Text>, span: Range<usize>) -> Self {
        let whole = &text.text;
        let mut start = span.start.min(whole.len());
        while !whole.is_char_boundary(start) {
            start -= 1;
        }
        let mut end = span.end.clamp(start, whole.len());
        while !whole.is_char_boundary(end) {
            end += 1;
        }
        Place { text: Arc::clone(text), span: start..end }
    }

    /// What is written there.
    pub fn written(&self) -> &str {
        self.text.text.get(self.span.clone()).unwrap_or("")
    }

    /// The mistake made here.
    pub fn error(&self, problem: impl Into<String>, expected: impl Into<String>) -> Error {
        self.error_with(problem, expected, None)
    }

    /// The mistake made here, with what to do about it.
    pub fn error_with(
        &self,
        problem: impl Into<String>,
        expected: impl Into<String>,
        help: Option<String>,
    ) -> Error {
        Error::from(Diagnostic {
            origin: self.text.origin.clone(),
            text: self.text.text.clone(),
            span: self.span.clone(),
            problem: problem.into(),
            expected: expected.into(),
            help,
        })
    }
}
