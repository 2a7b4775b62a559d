//! `[sampling] until`: when sampling ends before its budget.

use super::document::Node;
use super::read::{self, Section};
use super::vocabulary as keys;
use super::{Requirement, RequirementOf, SamplingPlan};
use crate::error::Result;
use crate::reliability::adaptive::Until;
use crate::sampling;

/// When sampling ends, and how sure that is. The budget is the plan's number of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoppingPlan {
    /// What ends the sampling.
    pub until: Until,
    /// Confidence with which all intervals hold at every look, in (0, 1).
    pub confidence: f64,
}

/// An example for diagnostics.
pub(super) const EXAMPLE: &str = "{ relative_error = 0.05, budget = 10_000_000 }";

/// Reads `until` into a plan whose design is known, and with it the plan's number of samples.
pub(super) fn until(
    node: &Node,
    samples: Option<&Node>,
    has_limits: bool,
    requirement: Option<Requirement>,
    plan: &mut SamplingPlan,
) -> Result<()> {
    let section = Section::new("until", &node.place, read::table(node, EXAMPLE)?, keys::UNTIL)?;
    if plan.design != sampling::Design::MonteCarlo {
        let problem = format!("`until` cannot be used with the design \"{}\"", plan.design.name());
        let help =
            "its points are dependent; sequential confidence intervals need independent samples";
        let expected = "expected the design \"monte-carlo\"";
        return Err(node.place.error_with(problem, expected, Some(help.to_owned())));
    }
    if let Some(samples) = samples {
        let help = "the maximum number of samples is the budget of `until`";
        let expected = "expected samples or until, not both";
        return Err(samples.place.error_with(
            "`samples` and `until` are both given",
            expected,
            Some(help.to_owned()),
        ));
    }
    if !has_limits {
        let expected = "expected at least one limit, such as [limits] time = { max = \"210 s\" }";
        return Err(node.place.error("`until` needs at least one limit", expected));
    }
    let until = rule(node, &section, requirement)?;
    let confidence = match (section.get("confidence"), requirement) {
        (Some(node), _) => read::open_share(node, "confidence", "0.9")?,
        (None, Some(requirement)) => requirement.confidence,
        (None, None) => {
            let problem = "`until` lacks the key `confidence`";
            let help =
                "it may be omitted in a study with a requirement, whose confidence is then used";
            return Err(node.place.error_with(
                problem,
                "expected confidence = 0.9",
                Some(help.to_owned()),
            ));
        }
    };
    if let (Until::Decided { .. }, Some(requirement), Some(stated)) =
        (until, requirement, section.get("confidence"))
        && confidence < requirement.confidence
    {
        let problem = format!("confidence {confidence} is below the requirement's");
        let expected =
            format!("expected at least the requirement's confidence, {}", requirement.confidence);
        return Err(stated.place.error(problem, expected));
    }
    let budget = section.require("budget", "10_000_000")?;
    plan.samples = read::integer(budget, 1, sampling::MAX_SAMPLES, "10_000_000")?;
    plan.stopping = Some(StoppingPlan { until, confidence });
    Ok(())
}

/// The one rule that is stated.
fn rule(node: &Node, section: &Section, requirement: Option<Requirement>) -> Result<Until> {
    let expected = "expected relative_error = 0.05 or decided = true";
    match (section.get("relative_error"), section.get("decided")) {
        (None, None) => Err(node.place.error("`until` has no stopping rule", expected)),
        (Some(_), Some(second)) => {
            Err(second.place.error("`until` has two stopping rules", expected))
        }
        (Some(node), None) => {
            Ok(Until::RelativeError(read::open_share(node, "relative_error", "0.05")?))
        }
        (None, Some(node)) => match (read::boolean(node)?, requirement) {
            (false, _) => {
                Err(node.place.error("`decided = false` is not a stopping rule", expected))
            }
            (true, None) => Err(node.place.error(
                "`decided` needs a requirement",
                "expected a section [requirement], or relative_error = 0.05",
            )),
            (true, Some(stated)) if stated.of == RequirementOf::Brake => Err(node.place.error(
                "`decided` decides of the average over brakes, and the requirement is of this brake",
                "expected relative_error = 0.05, or [requirement] of = \"average\"",
            )),
            (true, Some(stated)) => Ok(Until::Decided { allowed: 1.0 - stated.reliability }),
        },
    }
}
