//! `reeldown explain`: what an input or an outcome is, and what a study makes of it.

use super::arguments::ExplainArguments;
use super::{Ending, done};
use crate::descent::OutcomeQuantity;
use crate::error::{Error, Result};
use crate::render::table;
use crate::study::{ResolvedParameter, Study};
use crate::units::{engineering, spelling::nearest};

/// Explains one input or outcome, or lists all of them.
pub(super) fn explain(arguments: &ExplainArguments) -> Result<Ending> {
    let study = arguments.study()?;
    let rows = study.resolved();
    let Some(name) = &arguments.name else { return done(&list(&rows)) };
    if let Some(row) = rows.iter().find(|row| row.path == *name) {
        return done(&input(row));
    }
    if let Some(outcome) = OutcomeQuantity::from_name(name) {
        return done(&explained(outcome, &study));
    }
    let paths = rows.iter().map(|row| row.path.as_str());
    let help = match nearest(name, paths.chain(OutcomeQuantity::ALL.map(OutcomeQuantity::name))) {
        Some(near) => format!("did you mean `reeldown explain {near}`?"),
        None => "`reeldown explain` lists them".to_owned(),
    };
    Err(Error::argument(format!("there is no input and no outcome called {name}; {help}")))
}

fn list(rows: &[ResolvedParameter]) -> String {
    let inputs = rows
        .iter()
        .map(|row| [row.path.clone(), row.symbol.to_owned(), row.description.to_owned()]);
    let outcomes = OutcomeQuantity::ALL
        .map(|outcome| [outcome.name(), "", outcome.title()].map(str::to_owned));
    format!(
        "{}\n\n{}",
        table(&["input", "symbol", "what it is"], 0..0, inputs, None),
        table(&["outcome", "", "what it is"], 0..0, outcomes, None)
    )
}

/// A column of names and what is said of each.
fn lines(title: &str, entries: &[(&str, String)]) -> String {
    let width = entries.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut text = format!("{title}\n");
    for (name, said) in entries {
        text += &format!("\n  {name:width$}  {said}");
    }
    text
}

fn input(row: &ResolvedParameter) -> String {
    let info = row.target.parameter.info();
    let unit = match info.quantity.si_unit() {
        "" => "none".to_owned(),
        unit => format!("{unit}, written as in \"{}\"", info.baseline_text),
    };
    let end = |si: f64| match si.is_finite() {
        true => engineering(si, info.quantity),
        false => "∞".to_owned(),
    };
    let ends = if info.open { " (ends excluded)" } else { "" };
    let mut entries = vec![
        ("what it is", format!("{}, {} in the equations", row.description, row.symbol)),
        ("unit", unit),
        ("possible", format!("{} … {}{ends}", end(info.lower), end(info.upper))),
        ("HABE brake", format!("{}; source: {}", info.baseline_text, info.source)),
        ("this study", format!("{}; source: {}", row.text, row.source)),
    ];
    match &row.uncertain {
        None => entries.push(("law", "none: taken as exact".to_owned())),
        Some(law) => {
            let many = match law.inputs {
                1 => String::new(),
                many => format!(", {many} independent inputs"),
            };
            entries.push(("law", format!("{}{many}", law.law)));
            entries.push(("source of law", law.source.clone()));
            let nature = law.nature.name();
            entries.push(("nature", format!("{nature}; becomes known: {}", law.known.name())));
        }
    }
    lines(&row.path, &entries)
}

fn explained(outcome: OutcomeQuantity, study: &Study) -> String {
    let mut entries = vec![
        ("what it is", outcome.title().to_owned()),
        ("unit", outcome.quantity().si_unit().to_owned()),
        ("column", outcome.column()),
    ];
    for limit in study.limits.iter().filter(|l| l.outcome == outcome && !l.implied) {
        entries.push(("limit", format!("{} {}", limit.kind.name(), limit.text)));
    }
    lines(outcome.name(), &entries)
}
