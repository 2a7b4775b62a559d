//! What differs between two studies, in the words in which they are written.

use super::ChangeFinding;
use crate::study::{DrawnTogether, ResolvedCorrelation, StoppingPlan, Study};
use crate::units::number;

/// Every difference that a result can depend on.
pub(super) fn changes(before: &Study, after: &Study) -> Vec<ChangeFinding> {
    let mut changes = Vec::new();
    let mut add = |kind, what: &str, before: Option<String>, after: Option<String>| {
        if before != after {
            changes.push(ChangeFinding { kind, what: what.to_owned(), before, after });
        }
    };
    let model = |study: &Study| Some(study.model.name().to_owned());
    add("model", "equations of motion", model(before), model(after));
    let (first, second) = (before.resolved(), after.resolved());
    let mut paths: Vec<&str> = first.iter().chain(&second).map(|row| row.path.as_str()).collect();
    let mut seen = Vec::new();
    paths.retain(|path| {
        let new = !seen.contains(path);
        seen.push(*path);
        new
    });
    for path in &paths {
        let value = |study: &Study, rows: &[crate::study::ResolvedParameter]| {
            let row = rows.iter().find(|row| row.path == *path)?;
            // A surface without a value of its own has that of the gap.
            (study.design.at(row.target) == row.value).then(|| row.text.clone())
        };
        add("design", path, value(before, &first), value(after, &second));
    }
    for path in &paths {
        let law = |rows: &[crate::study::ResolvedParameter]| {
            let row = rows.iter().find(|row| row.path == *path)?;
            let law = row.uncertain.as_ref()?;
            let many =
                if law.inputs > 1 { format!(", {} inputs", law.inputs) } else { String::new() };
            Some(format!("{}{many}; known {}", law.law, law.known.name()))
        };
        add("law", path, law(&first), law(&second));
    }
    let correlations = |study: &Study| {
        let line = |c: &ResolvedCorrelation| {
            format!("{}: {} {}", c.inputs(), c.measure.name(), c.measure.value())
        };
        let lines: Vec<String> = study.resolved_correlations().iter().map(line).collect();
        (!lines.is_empty()).then(|| lines.join("; "))
    };
    add("correlation", "correlations", correlations(before), correlations(after));
    let samples = |study: &Study| {
        let line = |t: &DrawnTogether| {
            let digest = t.sha256.get(..12).unwrap_or(&t.sha256);
            format!("{}: {} rows of {} ({digest}…)", t.name, t.rows, t.file)
        };
        let lines: Vec<String> = study.drawn_together.iter().map(line).collect();
        (!lines.is_empty()).then(|| lines.join("; "))
    };
    add("law", "inputs drawn together", samples(before), samples(after));
    let mut limits: Vec<String> =
        before.limits.iter().chain(&after.limits).map(|limit| limit.name()).collect();
    limits.sort();
    limits.dedup();
    for name in &limits {
        let text = |study: &Study| {
            let limit = study.limits.iter().find(|limit| limit.name() == *name)?;
            Some(format!("{} {}", limit.kind.name(), limit.text))
        };
        add("limit", name, text(before), text(after));
    }
    let requirement = |study: &Study| {
        let required = study.requirement?;
        Some(format!("reliability {} at confidence {}", required.reliability, required.confidence))
    };
    add("requirement", "requirement", requirement(before), requirement(after));
    let (a, b) = (before.sampling, after.sampling);
    let mut sampling = |what, a: String, b: String| add("sampling", what, Some(a), Some(b));
    sampling("design of experiment", a.design.name().to_owned(), b.design.name().to_owned());
    sampling("samples", a.samples.to_string(), b.samples.to_string());
    sampling("seed", a.seed.to_string(), b.seed.to_string());
    sampling("replicates", a.replicates.to_string(), b.replicates.to_string());
    let rule = |plan: Option<StoppingPlan>| plan.map(|_| "sequential".to_owned());
    add("sampling", "stopping", rule(a.stopping), rule(b.stopping));
    let tolerance = |study: &Study| Some(number(study.numerics.tolerance, 3));
    add("model", "relative tolerance", tolerance(before), tolerance(after));
    changes
}
