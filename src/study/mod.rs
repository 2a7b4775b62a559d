//! The study: what is to be found out, checked and in SI. There is no file access after it.
//!
//! A study file names a design, limits, a requirement and a sampling plan; its card says what is
//! uncertain. [`Study::load`] reads both; everything between the bytes and the [`Study`] is a pure
//! function of the texts, and every mistake in them is a [`crate::error::Diagnostic`].

mod assemble;
mod card;
mod columns;
mod correlation;
mod digest;
mod document;
mod empirical;
mod epistemic;
mod files;
mod inputs;
mod law;
mod laws;
mod load;
pub mod measured_run;
mod mistakes;
mod over;
mod overrides;
mod pairs;
mod place;
mod read;
mod resolved;
pub mod schema;
mod sections;
mod tighten;
mod together;
mod until;
mod values;
mod vocabulary;

use crate::descent::outcome::TIME_LIMIT_S;
use crate::descent::{Model, Outcome, OutcomeQuantity};
use crate::physics::design::{Design, Target};
use crate::sampling;
use crate::uncertainty::{Joint, Marginal, Measure, Readings};

pub use assemble::assemble;
pub use digest::sha256;
pub use epistemic::{EpistemicPlan, Nature};
pub use files::{Files, NamedText, NumberColumn, SampleColumn, SampleFile};
pub use load::{EMBEDDED_CARD, EMBEDDED_STUDY, Parquet, read_bytes, read_sample};
pub use measured_run::MeasuredRun;
pub use over::{MOST_CELLS, Over, design_path, option_error};
pub use overrides::Override;
pub use resolved::{ResolvedCorrelation, ResolvedParameter, UncertainLaw};
pub use tighten::{DesignRange, Grade, TightenPlan, TighteningCost, TradePlan};
pub use until::StoppingPlan;

/// A study, resolved: every value in SI, every name known.
#[derive(Debug, Clone)]
pub struct Study {
    /// What the study is called.
    pub title: String,
    /// The equations to integrate.
    pub model: Model,
    /// The nominal design, SI.
    pub design: Design<f64>,
    /// What is uncertain, in the order of [`Target`], in which values are to be set; input `k` is
    /// coordinate `k` of a sample.
    pub inputs: Vec<Input>,
    /// The joint distribution of the inputs, in the same order.
    pub joint: Joint,
    /// The statements that the joint distribution's dependence was made from.
    pub correlations: Vec<Correlation>,
    /// The files from whose rows several inputs are drawn together.
    pub drawn_together: Vec<DrawnTogether>,
    /// What a descent must not breach, in the order of [`OutcomeQuantity`], upper limit first. Unless empty, an upper
    /// limit on the time is among them, stated or implied.
    pub limits: Vec<Limit>,
    /// What the verdict is held against.
    pub requirement: Option<Requirement>,
    /// How the inputs are sampled.
    pub sampling: SamplingPlan,
    /// How accurately a descent is integrated.
    pub numerics: Numerics,
    /// How the sensitivity indices are estimated.
    pub sensitivity: SensitivityPlan,
    /// How small probabilities are estimated.
    pub reliability: ReliabilityPlan,
    /// How the tolerance trade is computed.
    pub trade: TradePlan,
    /// What a plan of tightenings is to reach, and by which means.
    pub tighten: TightenPlan,
    /// What the first calibrated card among later ones was made from.
    pub calibrated_from: Option<String>,
    /// The study under the cards before that one: what was believed before the calibration.
    pub prior: Option<Box<Study>>,
    /// How what varies is told apart from what is not known.
    pub epistemic: EpistemicPlan,
    /// The design values that were stated, as written, in the order of [`Target`].
    pub stated: Vec<Stated>,
    /// What a reader should know about how the study was understood.
    pub notes: Vec<String>,
    /// The study file's name, or what it is called when it is embedded.
    pub origin: String,
    /// The study file's text.
    pub study_text: String,
    /// Name and text of every card, in the order in which they are merged.
    pub card_texts: Vec<(String, String)>,
    /// The `--set` statements and their like that were applied, as typed.
    pub overrides: Vec<String>,
}

/// One uncertain input: where its value goes and how it is distributed.
#[derive(Debug, Clone)]
pub struct Input {
    /// Where the value goes.
    pub target: Target,
    /// Its distribution, SI.
    pub marginal: Marginal,
    /// The readings that the distribution predicts from, if it is made of some.
    pub readings: Option<Readings>,
    /// When its value becomes known.
    pub known: Known,
    /// Whether it varies from flight to flight or is fixed and not known.
    pub nature: Nature,
    /// Where the distribution comes from.
    pub source: String,
    /// The factor to which it belongs in grouped sensitivities; the gaps of one statement share one.
    pub group: Option<String>,
    /// What it costs to narrow its spread; the gaps of one statement are bought together, once.
    pub cost: TighteningCost,
    /// Whether the law's mean is the design's nominal value: it goes where that goes.
    pub about_nominal: bool,
    /// The law as written, for a person.
    pub law_text: String,
    /// The law in SI with exact numbers, for the digest.
    pub law_canonical: String,
}

/// When the value of an uncertain input becomes known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Known {
    /// Once the brake is built and measured.
    AtBuild,
    /// On the day of the flight.
    OnTheDay,
    /// Never before the flight is over.
    Never,
}

impl Known {
    /// All, in the order of time.
    pub const ALL: [Known; 3] = [Known::AtBuild, Known::OnTheDay, Known::Never];

    /// The name in cards.
    pub fn name(self) -> &'static str {
        match self {
            Known::AtBuild => "at build",
            Known::OnTheDay => "on the day",
            Known::Never => "never",
        }
    }

    /// The member of a name.
    pub fn from_name(name: &str) -> Option<Known> {
        Self::ALL.into_iter().find(|known| known.name() == name)
    }
}

/// A statement of dependence between two inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Places of the two inputs in [`Study::inputs`], the smaller first.
    pub between: (usize, usize),
    /// The coefficient as stated, −1 … 1, with its kind.
    pub measure: Measure,
    /// Where it comes from.
    pub source: String,
}

/// Inputs that are drawn together from the rows of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrawnTogether {
    /// What the sample is called as one factor.
    pub name: String,
    /// The file as the card names it.
    pub file: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// Number of rows, each equally likely.
    pub rows: usize,
    /// Places of the inputs in [`Study::inputs`], ascending.
    pub inputs: Vec<usize>,
}

/// Which side of a limit is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LimitKind {
    /// The outcome may be at most the value.
    Max,
    /// The outcome must be at least the value.
    Min,
}

impl LimitKind {
    /// Both kinds.
    pub const ALL: [LimitKind; 2] = [LimitKind::Max, LimitKind::Min];

    /// The key in study files.
    pub fn name(self) -> &'static str {
        match self {
            LimitKind::Max => "max",
            LimitKind::Min => "min",
        }
    }
}

impl Study {
    /// Places of the limits that the study states: how far one stays from the end of what is followed is no margin.
    pub(crate) fn stated_limits(&self) -> Vec<usize> {
        (0..self.limits.len()).filter(|&i| !self.limits[i].implied).collect()
    }
}

/// A limit on an outcome.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The outcome quantity that is limited.
    pub outcome: OutcomeQuantity,
    /// Which side is allowed.
    pub kind: LimitKind,
    /// The limit, SI.
    pub value: f64,
    /// The limit as written.
    pub text: String,
    /// Where it comes from, if the study states that.
    pub source: Option<String>,
    /// Whether the study does not state it: a line that does not run out is a breach whatever else is limited.
    pub implied: bool,
}

/// What is said of a limit whose source the study does not state.
pub(crate) const NO_SOURCE: &str = "no source stated";

/// Share of the time limit of a descent that is left below it, so that a descent that was stopped there breaches:
/// far below what the integrators resolve, far above the rounding of the time.
const ROUNDING: f64 = 1e-9;

impl Limit {
    /// The limit of a study that states none on the time: the line runs out while a descent is followed.
    pub(crate) fn deployment() -> Limit {
        Limit {
            outcome: OutcomeQuantity::Time,
            kind: LimitKind::Max,
            value: TIME_LIMIT_S * (1.0 - ROUNDING),
            text: format!("{TIME_LIMIT_S} s"),
            source: Some("the longest simulated time: no descent is followed beyond it".to_owned()),
            implied: true,
        }
    }

    /// Where the limit comes from, or that the study does not state it.
    pub fn source_text(&self) -> &str {
        self.source.as_deref().unwrap_or(NO_SOURCE)
    }

    /// Whether a margin (SI) of this limit is that of a descent that had not deployed when it was no longer followed.
    pub fn is_of_no_deployment(&self, margin: f64) -> bool {
        self.outcome == OutcomeQuantity::Time
            && self.kind == LimitKind::Max
            && self.value - margin >= TIME_LIMIT_S * (1.0 - 0.5 * ROUNDING)
    }

    /// The margin of an outcome's value, SI: negative is a breach. `max − value` or `value − min`.
    pub fn margin_of(&self, value: f64) -> f64 {
        match self.kind {
            LimitKind::Max => self.value - value,
            LimitKind::Min => value - self.value,
        }
    }

    /// The margin of a descent, SI: negative is a breach.
    ///
    /// A descent that did not deploy carries the time limit of a descent as its time, and an upper limit on time lies
    /// below that: it is breached. A study that limits anything limits the time from above ([`Limit::implied`]).
    pub fn margin(&self, outcome: &Outcome) -> f64 {
        self.margin_of(outcome.get(self.outcome))
    }

    /// The name of the limit in tables: `time` for an upper limit, `time_min` for a lower one.
    pub fn name(&self) -> String {
        match self.kind {
            LimitKind::Max => self.outcome.name().to_owned(),
            LimitKind::Min => format!("{}_min", self.outcome.name()),
        }
    }

    /// The Parquet column of the margin: `time_margin_s`.
    pub fn margin_column(&self) -> String {
        let suffix = self.outcome.quantity().column_suffix();
        format!("{}_margin{suffix}", self.name())
    }
}

/// Whose reliability is required, where something about the brake is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequirementOf {
    /// The average over all brakes that the epistemic inputs allow, and over what varies.
    Average,
    /// The one brake that is built: its own reliability, which is not known, must be large enough with a probability of
    /// `confidence` over the epistemic inputs.
    Brake,
}

impl RequirementOf {
    /// Both.
    pub const ALL: [RequirementOf; 2] = [RequirementOf::Average, RequirementOf::Brake];

    /// The name in study files.
    pub fn name(self) -> &'static str {
        match self {
            RequirementOf::Average => "average",
            RequirementOf::Brake => "brake",
        }
    }

    /// The member of a name.
    pub fn from_name(name: &str) -> Option<RequirementOf> {
        Self::ALL.into_iter().find(|of| of.name() == name)
    }
}

/// What the verdict is held against: reliability `R` demonstrated at confidence `C`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// Smallest acceptable probability that no limit is breached, in (0, 1).
    pub reliability: f64,
    /// Confidence with which it must be demonstrated, in (0, 1).
    pub confidence: f64,
    /// Whose reliability it is.
    pub of: RequirementOf,
}

/// How the inputs are sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SamplingPlan {
    /// The design of experiment.
    pub design: sampling::Design,
    /// Number of descents in all, over all replicates; the most of them if `stopping` may end them sooner.
    pub samples: u64,
    /// Seed of every random stream.
    pub seed: u64,
    /// Number of independent replicates; 1 for plain Monte Carlo, else it divides `samples`.
    pub replicates: u32,
    /// When sampling ends before `samples`, if it may.
    pub stopping: Option<StoppingPlan>,
}

/// How accurately a descent is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numerics {
    /// Relative error asked of the outcomes.
    pub tolerance: f64,
}

/// How the sensitivity indices are estimated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SensitivityPlan {
    /// Rows of each block of the pick-freeze design; 0 leaves the indices out.
    pub base_samples: u64,
    /// Number of bootstrap resamples behind each interval.
    pub bootstrap: u32,
    /// Pairs of inputs, by path or group, whose second-order index is asked for.
    pub pairs: Vec<(String, String)>,
}

/// A method that estimates small probabilities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RareMethod {
    /// The samples themselves.
    Crude,
    /// The first-order reliability method.
    Form,
    /// The second-order one.
    Sorm,
    /// Importance sampling around design points.
    ImportanceSampling,
    /// Subset simulation.
    SubsetSimulation,
    /// Line sampling.
    LineSampling,
    /// Directional sampling.
    DirectionalSampling,
    /// Cross-entropy importance sampling.
    CrossEntropy,
}

impl RareMethod {
    /// All, in the order in which they are listed.
    pub const ALL: [RareMethod; 8] = [
        RareMethod::Crude,
        RareMethod::Form,
        RareMethod::Sorm,
        RareMethod::ImportanceSampling,
        RareMethod::SubsetSimulation,
        RareMethod::LineSampling,
        RareMethod::DirectionalSampling,
        RareMethod::CrossEntropy,
    ];

    /// The name in study files.
    pub fn name(self) -> &'static str {
        match self {
            RareMethod::Crude => "crude",
            RareMethod::Form => "form",
            RareMethod::Sorm => "sorm",
            RareMethod::ImportanceSampling => "importance-sampling",
            RareMethod::SubsetSimulation => "subset-simulation",
            RareMethod::LineSampling => "line-sampling",
            RareMethod::DirectionalSampling => "directional-sampling",
            RareMethod::CrossEntropy => "cross-entropy",
        }
    }

    /// The member of a name.
    pub fn from_name(name: &str) -> Option<RareMethod> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// How small probabilities are estimated.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReliabilityPlan {
    /// The methods to run, besides the samples themselves; `None` leaves the choice to the program.
    pub methods: Option<Vec<RareMethod>>,
}

/// A design value that the study states.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Where the value goes.
    pub target: Target,
    /// The value, SI.
    pub value: f64,
    /// The value as written.
    pub text: String,
    /// The text that states it: the study file, or the option.
    pub origin: String,
}
