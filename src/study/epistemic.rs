//! What varies from flight to flight, and what is fixed but not known.

use super::document::Node;
use super::read::{self, Section};
use super::vocabulary::EPISTEMIC;
use super::{Input, Known};
use crate::error::Result;
use crate::reliability::nested::SECTIONS;

/// Whether an input changes from flight to flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Nature {
    /// It is drawn anew for every flight (aleatory).
    Varies,
    /// It is the same in every flight of this brake, and not known (epistemic).
    Unknown,
}

impl Nature {
    /// Both.
    pub const ALL: [Nature; 2] = [Nature::Varies, Nature::Unknown];

    /// The name in cards.
    pub fn name(self) -> &'static str {
        match self {
            Nature::Varies => "varies",
            Nature::Unknown => "unknown",
        }
    }

    /// The member of a name.
    pub fn from_name(name: &str) -> Option<Nature> {
        Self::ALL.into_iter().find(|nature| nature.name() == name)
    }

    /// What a card that does not say is taken to mean: what is known on the day alone varies from day to day,
    /// and so does what readings scatter about; everything else is a constant of the brake.
    pub(super) fn default_of(known: Known, of_readings: bool) -> Nature {
        if known == Known::OnTheDay || of_readings { Nature::Varies } else { Nature::Unknown }
    }
}

/// How what varies is told apart from what is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EpistemicPlan {
    /// Sets of values of what is not known; 0 leaves the analysis out.
    pub outer: u64,
    /// Descents with each set, in two halves.
    pub inner: u64,
}

const DEFAULT: EpistemicPlan = EpistemicPlan { outer: 1200, inner: 128 };

/// Fewest sets from which quantiles are read, and most; their sections are of equal size.
const OUTER: (u64, u64) = (200, 1_000_000);
/// Fewest and most descents with each set.
const INNER: (u64, u64) = (4, 1_000_000);

/// The plan of `[epistemic]`.
pub(super) fn epistemic(node: Option<&Node>) -> Result<EpistemicPlan> {
    let Some(node) = node else { return Ok(DEFAULT) };
    let entries = read::table(node, "{ outer = 1200, inner = 128 }")?;
    let section = Section::new("[epistemic]", &node.place, entries, EPISTEMIC)?;
    let mut plan = DEFAULT;
    if let Some(node) = section.get("outer") {
        plan.outer = read::integer(node, 0, OUTER.1, "1200")?;
        if plan.outer != 0 && plan.outer < OUTER.0 {
            let problem = format!("outer = {} is too few", plan.outer);
            return Err(node
                .place
                .error(problem, format!("expected 0 (off), or at least {}", OUTER.0)));
        }
        if !plan.outer.is_multiple_of(SECTIONS as u64) {
            let problem = format!("outer = {} is not a multiple of {SECTIONS}", plan.outer);
            let expected = format!("expected a multiple of {SECTIONS}, such as 1200");
            return Err(node.place.error(problem, expected));
        }
    }
    if let Some(node) = section.get("inner") {
        plan.inner = read::integer(node, INNER.0, INNER.1, "128")?;
        if !plan.inner.is_multiple_of(2) {
            let problem = format!("inner must be even, not {}", plan.inner);
            return Err(node.place.error(problem, "expected an even number, such as 128"));
        }
    }
    Ok(plan)
}

/// What must be said of inputs whose readings are shared.
pub(super) fn shared_readings(inputs: &[Input]) -> Option<String> {
    let same = |a: &&Input, b: &Input| {
        a.readings.is_some() && a.readings == b.readings && a.group == b.group && a.group.is_some()
    };
    let input = inputs.iter().enumerate().find_map(|(k, input)| {
        inputs.iter().skip(k + 1).any(|other| same(&input, other)).then_some(input)
    })?;
    let group = input.group.as_deref().unwrap_or_default();
    Some(format!(
        "{group}: several inputs follow one set of readings; the samples draw each by itself, and only the analysis of what is \
         not known gives them one mean and one deviation"
    ))
}

/// Whether an input varies or is unknown.
pub(super) fn nature(node: &Node) -> Result<Nature> {
    read::choice(node, "nature", &Nature::ALL.map(Nature::name), Nature::from_name)
}
