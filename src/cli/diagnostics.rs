//! Errors as a person reads them: the line, the place in it, what was expected, what to do.

use crate::error::{Diagnostic, Error};
use crate::render::Style;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

/// Errors shown at most.
const MOST_SHOWN: usize = 20;

/// One error, or several, as text.
pub(super) fn render(error: &Error, style: Style) -> String {
    let renderer = match style {
        Style::Plain => Renderer::plain(),
        Style::Colour => Renderer::styled(),
    };
    match error {
        Error::Input(diagnostic) => renderer.render(&[in_text(diagnostic)]),
        Error::File { help, .. } => {
            let message = first_part(error, help);
            let mut group = Group::with_title(Level::ERROR.primary_title(message));
            if !help.is_empty() {
                group = group.element(Level::HELP.message(help.as_str()));
            }
            renderer.render(&[group])
        }
        Error::Several(errors) => {
            let shown = errors.iter().take(MOST_SHOWN).map(|error| render(error, style));
            let more = match errors.len().saturating_sub(MOST_SHOWN) {
                0 => format!("{} mistakes", errors.len()),
                more => format!("{} mistakes, {more} of them not shown", errors.len()),
            };
            let count = renderer.render(&[Group::with_title(Level::ERROR.primary_title(more))]);
            shown.chain([count]).collect::<Vec<_>>().join("\n\n")
        }
        Error::Argument(message) => {
            renderer.render(&[Group::with_title(Level::ERROR.primary_title(message.as_str()))])
        }
    }
}

/// The message without its help, which is shown below it.
fn first_part(error: &Error, help: &str) -> String {
    let whole = error.to_string();
    whole.strip_suffix(help).map_or(whole.clone(), |part| part.trim_end_matches("; ").to_owned())
}

fn in_text(diagnostic: &Diagnostic) -> Group<'_> {
    let snippet =
        Snippet::source(diagnostic.text.as_str()).path(diagnostic.origin.as_str()).annotation(
            AnnotationKind::Primary
                .span(diagnostic.span.clone())
                .label(diagnostic.expected.as_str()),
        );
    let mut group = Level::ERROR.primary_title(diagnostic.problem.as_str()).element(snippet);
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    group
}
