//! Digests: of the resolved study, which fixes every number of a run, and of its raw texts.

use super::{Input, LimitKind, RareMethod, RequirementOf, Study, TighteningCost};
use crate::reliability::adaptive::Until;
use sha2::{Digest, Sha256};
use std::fmt::Write;

impl Study {
    /// SHA-256, in hexadecimal, of the resolved study: everything that can change a number of its
    /// run, in SI with exact digits, and nothing else (no comment, title, source, or spelling of a unit).
    pub fn digest(&self) -> String {
        of_text(&self.canonical_text())
    }

    /// Name and SHA-256 of each raw text: the study file, then its cards, then files of joint samples.
    pub fn file_digests(&self) -> Vec<(String, String)> {
        let study = (self.origin.clone(), of_text(&self.study_text));
        let cards = self.card_texts.iter().map(|(name, text)| (name.clone(), of_text(text)));
        let samples = self.drawn_together.iter().map(|t| (t.file.clone(), t.sha256.clone()));
        std::iter::once(study).chain(cards).chain(samples).collect()
    }

    /// The text of which [`Study::digest`] is the digest: one statement a line, numbers exact.
    pub fn canonical_text(&self) -> String {
        let mut lines = vec!["reeldown study 1".to_owned(), format!("model {}", self.model.name())];
        for info in &crate::physics::parameters::PARAMETERS {
            lines.push(format!("design {} {:e}", info.path, self.design.get(info.parameter)));
        }
        for (surface, gap) in self.design.gaps().iter().enumerate() {
            lines.push(format!("design brake.gap[{}] {gap:e}", surface + 1));
        }
        for input in &self.inputs {
            lines.push(format!(
                "input {} {} known={:?} group={:?}",
                input.target.path(),
                input.law_canonical,
                input.known.name(),
                input.group.as_deref().unwrap_or("")
            ));
            lines.push(format!("nature {} {}", input.target.path(), input.nature.name()));
            if let Some(cost) = cost_text(input) {
                lines.push(format!("cost {} {cost}", input.target.path()));
            }
        }
        for correlation in &self.correlations {
            let (a, b) = correlation.between;
            let (name, value) = (correlation.measure.name(), correlation.measure.value());
            lines.push(format!("correlation {a} {b} {name} {value:e}"));
        }
        for together in &self.drawn_together {
            lines.push(format!("together {:?} rows={}", together.inputs, together.rows));
        }
        for limit in &self.limits {
            let kind = match limit.kind {
                LimitKind::Max => "max",
                LimitKind::Min => "min",
            };
            lines.push(format!("limit {} {kind} {:e}", limit.outcome.name(), limit.value));
        }
        if let Some(requirement) = self.requirement {
            let (reliability, confidence) = (requirement.reliability, requirement.confidence);
            // The default leaves the digests of earlier studies as they were.
            let of = match requirement.of {
                RequirementOf::Average => "",
                RequirementOf::Brake => " of=brake",
            };
            lines.push(format!("requirement {reliability:e} {confidence:e}{of}"));
        }
        let plan = self.sampling;
        lines.push(format!(
            "sampling {} samples={} seed={} replicates={}",
            plan.design.name(),
            plan.samples,
            plan.seed,
            plan.replicates
        ));
        if let Some(stopping) = plan.stopping {
            let until = match stopping.until {
                Until::RelativeError(error) => format!("relative_error={error:e}"),
                Until::Decided { allowed } => format!("decided={allowed:e}"),
            };
            lines.push(format!("until {until} confidence={:e}", stopping.confidence));
        }
        lines.push(format!("numerics tolerance={:e}", self.numerics.tolerance));
        let plan = &self.sensitivity;
        lines.push(format!(
            "sensitivity base_samples={} bootstrap={}",
            plan.base_samples, plan.bootstrap
        ));
        lines.extend(
            plan.pairs.iter().map(|(one, other)| format!("sensitivity pair {one} {other}")),
        );
        let methods = self.reliability.methods.as_deref();
        let names = |methods: &[RareMethod]| methods.iter().map(|method| method.name()).collect();
        let names: Vec<&str> = methods.map_or(vec!["default"], names);
        lines.push(format!("reliability {}", names.join(",")));
        lines.push(format!("trade samples={}", self.trade.samples));
        let plan = &self.tighten;
        let target = plan.target.map_or("requirement".to_owned(), |target| format!("{target:e}"));
        lines.push(format!("tighten target={target} samples={}", plan.samples));
        for range in &plan.design {
            let path = range.target.path();
            lines.push(format!("tighten design {path} {:e} {:e}", range.lower, range.upper));
        }
        let plan = self.epistemic;
        lines.push(format!("epistemic outer={} inner={}", plan.outer, plan.inner));
        lines.push(String::new());
        lines.join("\n")
    }
}

/// The cost of an input if it is not the usual one.
fn cost_text(input: &Input) -> Option<String> {
    match &input.cost {
        cost if *cost == TighteningCost::usual(input.target.parameter, input.known) => None,
        TighteningCost::None => Some("none".to_owned()),
        TighteningCost::PerHalving(cost) => Some(format!("halving={cost:e}")),
        TighteningCost::Grades(grades) => {
            let grades = grades.iter().map(|grade| format!("{:e}:{:e}", grade.spread, grade.cost));
            Some(grades.collect::<Vec<_>>().join(","))
        }
    }
}

/// SHA-256 of a text, in hexadecimal.
pub(super) fn of_text(text: &str) -> String {
    of_bytes(text.as_bytes())
}

/// SHA-256 of bytes, in hexadecimal.
pub(super) fn of_bytes(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// SHA-256 of a file's bytes, in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    of_bytes(bytes)
}

/// SHA-256 of numbers, bit for bit and in their order, in hexadecimal.
pub(super) fn of_numbers(numbers: &[f64]) -> String {
    let mut hasher = Sha256::new();
    for number in numbers {
        hasher.update(number.to_bits().to_le_bytes());
    }
    hexadecimal(&hasher.finalize())
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_digest_of_abc() {
        // FIPS 180-4, example "abc".
        assert_eq!(
            of_text("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
