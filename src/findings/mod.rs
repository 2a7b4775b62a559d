//! Everything a report says, computed once, as one tree that serialises: what the Markdown shows, the
//! JSON holds. Numbers are SI; the renderer chooses units.

pub mod calibrated;
pub mod calibration;
pub mod compare;
mod compare_findings;
mod compare_studies;
mod demonstration;
pub mod derivatives;
pub mod design_value;
mod drivers;
pub mod epistemic;
mod exact;
mod figures;
mod inputs;
pub mod known;
mod limits;
mod margins;
pub mod measures;
mod model_form;
mod numerical;
pub mod paper;
mod percent;
mod probabilities;
mod rare;
pub mod rig;
mod sequence;
pub mod shapley;
mod story;
pub mod sweep;
pub mod sweep_best;
mod this_brake;
pub mod tighten;
pub mod trade;

use crate::campaign::calibrated::CalibratedOutcomes;
use crate::campaign::epistemic::EpistemicOutcomes;
use crate::campaign::exact::ExactOutcomes;
use crate::campaign::given_sample::GivenSample;
use crate::campaign::known::KnownOutcomes;
use crate::campaign::model_form::ModelFormOutcomes;
use crate::campaign::screening::{ScreeningOutcomes, Slopes};
use crate::campaign::shapley::ShapleyOutcomes;
use crate::campaign::trade::TradeOutcomes;
use crate::campaign::{self, PickFreezeOutcomes, RareEvent, Record, Verification};
use crate::descent::{Fault, Outcome, OutcomeQuantity};
use crate::error::Result;
use crate::reliability::adaptive::Stop;
use crate::study::{RequirementOf, Study};
use serde::Serialize;
use std::collections::BTreeMap;

pub use calibrated::{CalibratedEvent, CalibratedFinding, MovedInput};
pub use demonstration::{Decision, VerdictFinding, VerdictWord};
pub use drivers::{DriverOutput, DriversFinding, FactorFinding, PairFinding};
pub use epistemic::{EpistemicEvent, EpistemicFinding, ProbabilityBox, UnknownShare};
pub use exact::{ExactFinding, ExactValue};
pub use figures::{
    Checkpoint, ConstantTemperature, Convergence, Distribution, Exceedance, Fan, FanBand,
    FigureData, Interaction, InteractionInput, PaperRuns, paper_runs,
};
pub use inputs::{CorrelationFinding, InputFinding};
pub use known::KnownFinding;
pub use limits::LimitFinding;
pub use margins::{MarginFinding, MarginQuantile};
pub use measures::MeasuresFinding;
pub use model_form::{FormFinding, ModelFormFinding};
pub use numerical::{NumericalFinding, NumericalLimit};
pub use probabilities::{EventKind, ProbabilityFinding};
pub use rare::{DesignPointFinding, DesignPointInput, RareFinding, rare_findings};
pub use sequence::StoppingFinding;
pub use shapley::{ShapleyFinding, ShapleyOutput};
pub use trade::TradeFinding;

/// Confidence of the two-sided intervals.
pub const CONFIDENCE: f64 = 0.95;

/// The whole answer to a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Findings {
    /// Layout of this tree; a reader checks it before anything else.
    pub format: u32,
    /// The study's title.
    pub title: String,
    /// The verdict, first.
    pub verdict: VerdictFinding,
    /// Why the sampling ended where it did, if that was decided while sampling.
    pub stopping: Option<StoppingFinding>,
    /// The limits, and where each comes from.
    pub limits: Vec<LimitFinding>,
    /// Each limit, any limit, each pair.
    pub probabilities: Vec<ProbabilityFinding>,
    /// Events too rare for the samples, by several methods.
    pub rare: Vec<RareFinding>,
    /// The same samples by the other thermal model.
    pub model_form: ModelFormFinding,
    /// What margin is left, by limit.
    pub margins: Vec<MarginFinding>,
    /// The spread of every outcome.
    pub outcomes: Vec<OutcomeFinding>,
    /// The nominal descent.
    pub nominal: NominalFinding,
    /// What drives the outcomes and the breaches.
    pub drivers: DriversFinding,
    /// Every factor's fair share of the variance.
    pub shapley: ShapleyFinding,
    /// Every other measure of what drives the outcomes and the breaches.
    pub measures: MeasuresFinding,
    /// What buying down a tolerance is worth.
    pub trade: TradeFinding,
    /// What becomes known when, and what that settles.
    pub known: KnownFinding,
    /// What a calibration changed, if a card of the study is a calibrated one.
    pub calibrated: Option<CalibratedFinding>,
    /// What varies from flight to flight, and what is not known.
    pub epistemic: EpistemicFinding,
    /// Samples that did not deploy or could not be computed.
    pub exceptions: ExceptionFinding,
    /// What is uncertain.
    pub inputs: Vec<InputFinding>,
    /// What is taken as exact, and what that does.
    pub exact: ExactFinding,
    /// How what is uncertain depends on each other, beside what is drawn together from rows of a file.
    pub correlations: Vec<CorrelationFinding>,
    /// The numbers behind the figures.
    pub figures: FigureData,
    /// What the integrator's own error could have done.
    pub numerical: NumericalFinding,
    /// How the numbers were obtained, and what they do not say.
    pub method: MethodFinding,
    /// What it takes to have the same numbers again.
    pub reproduction: ReproductionFinding,
}

/// The spread of one outcome over the samples, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutcomeFinding {
    /// Name in study files.
    pub name: &'static str,
    /// Parquet column, with the unit.
    pub column: String,
    /// Samples behind the numbers.
    pub samples: u64,
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation.
    pub standard_deviation: Option<f64>,
    /// Smallest value.
    pub smallest: Option<f64>,
    /// Largest value.
    pub largest: Option<f64>,
}

/// The nominal descent: every input at its nominal value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NominalFinding {
    /// Whether the line ran out; `None` if the descent could not be computed.
    pub deployed: Option<bool>,
    /// Outcomes by column name, SI.
    pub outcomes: BTreeMap<String, f64>,
    /// Names of the limits that it breaches.
    pub breaches: Vec<String>,
    /// Why it could not be computed.
    pub fault: Option<&'static str>,
}

/// Samples that are counted and shown apart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExceptionFinding {
    /// Samples that had not deployed at the time limit of a descent.
    pub not_deployed: u64,
    /// Samples that could not be computed.
    pub faulted: u64,
    /// Faults by kind.
    pub faults: Vec<(&'static str, u64)>,
    /// The first faulted samples: index and kind.
    pub first_faulted: Vec<(u64, &'static str)>,
}

/// How the numbers were obtained.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodFinding {
    /// The model of the motion.
    pub model: &'static str,
    /// The design of experiment in words.
    pub design: String,
    /// Descents in the main design.
    pub samples: u64,
    /// Independent replicates of the design.
    pub replicates: u32,
    /// Relative accuracy asked of the integrator.
    pub tolerance: f64,
    /// What a reader must know before leaning on a number.
    pub caveats: Vec<String>,
}

/// What it takes to have the same numbers again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReproductionFinding {
    /// Version of this program.
    pub version: &'static str,
    /// Seed of every stream.
    pub seed: u64,
    /// SHA-256 of the resolved study.
    pub study_digest: String,
    /// Name and SHA-256 of the study file and each card.
    pub files: Vec<(String, String)>,
    /// The command.
    pub command: String,
}

/// What the findings are made from.
#[derive(Debug)]
pub struct Evidence<'a> {
    /// The study.
    pub study: &'a Study,
    /// Its samples.
    pub record: &'a Record,
    /// Why its sampling ended, if that was decided while sampling.
    pub stop: Option<Stop>,
    /// The events that the samples saw too rarely.
    pub rare: Vec<RareEvent>,
    /// Its nominal descent.
    pub nominal: std::result::Result<Outcome, Fault>,
    /// Samples of it computed again by the plain integrator.
    pub verification: Verification,
    /// Its pick-freeze design, or why there is none.
    pub pick_freeze: std::result::Result<PickFreezeOutcomes, String>,
    /// Its walks of the Shapley effects, or why there are none.
    pub shapley: std::result::Result<ShapleyOutcomes, String>,
    /// Its first samples read again, and those that breach, or why they were not.
    pub given: std::result::Result<GivenSample, String>,
    /// Its screening, or why there is none.
    pub screening: std::result::Result<ScreeningOutcomes, String>,
    /// Derivatives of its outcomes.
    pub slopes: Slopes,
    /// Its trade of tolerances, or why there is none.
    pub trade: std::result::Result<TradeOutcomes<'a>, String>,
    /// What becomes known when, or why that is not told.
    pub known: std::result::Result<KnownOutcomes, String>,
    /// The study under the cards of the prior, if a card of it is a calibrated one.
    pub calibrated: Option<CalibratedOutcomes>,
    /// Its exact values moved a little, or why they were not.
    pub exact: std::result::Result<ExactOutcomes, String>,
    /// Its nested descents, or why there are none.
    pub epistemic: std::result::Result<EpistemicOutcomes, String>,
    /// Its first samples by the other thermal model too, or why they were not flown.
    pub model_form: std::result::Result<ModelFormOutcomes, String>,
    /// The command that was given, to be given again.
    pub command: String,
}

/// Computes the findings.
///
/// # Errors
/// If the study's numbers are such that a statistic refuses them (a confidence of 1, say).
pub fn gather(evidence: &Evidence) -> Result<Findings> {
    let Evidence { study, record, .. } = *evidence;
    // What was drawn, which may be less than the budget.
    let mut drawn = study.clone();
    drawn.sampling.samples = record.counts().samples();
    let sampler = campaign::sampler(&drawn)?;
    let mut numerical = numerical::numerical(study, record, &evidence.verification);
    let probabilities = probabilities::probabilities(study, record)?;
    let verdict = demonstration::verdict(study, record, &probabilities)?;
    let verdict = numerical::heed(study, record, &evidence.verification, &mut numerical, verdict)?;
    let drivers = drivers::drivers(study, &evidence.pick_freeze)?;
    let shapley = shapley::shapley(study, &evidence.shapley)?;
    let epistemic = epistemic::epistemic(study, &evidence.epistemic)?;
    let mut verdict = this_brake::two_statements(study, verdict, &epistemic);
    // Numbers that cannot be trusted decide nothing of this brake either.
    let of_brake = study.requirement.is_some_and(|stated| stated.of == RequirementOf::Brake);
    if of_brake && numerical.withdrawn.is_some() {
        verdict = numerical::heed(study, record, &evidence.verification, &mut numerical, verdict)?;
    }
    Ok(Findings {
        format: 1,
        title: study.title.clone(),
        verdict,
        stopping: sequence::stopping(study, record.counts().samples(), evidence.stop),
        limits: limits::limits(study),
        probabilities,
        rare: rare::rare_findings(study, &evidence.rare, evidence.nominal.as_ref().ok()),
        model_form: model_form::model_form(study, &evidence.model_form)?,
        margins: margins::margins(study, record)?,
        outcomes: OutcomeQuantity::ALL.map(|quantity| outcome(record, quantity)).to_vec(),
        nominal: nominal(study, &evidence.nominal),
        figures: figures::figures(study, record, &drivers)?,
        measures: measures::measures(
            study,
            &evidence.given,
            &evidence.screening,
            &evidence.slopes,
            &drivers,
            &shapley,
        )?,
        drivers,
        shapley,
        trade: trade::trade(study, &evidence.trade)?,
        known: known::known(study, &evidence.known)?,
        calibrated: calibrated::calibrated(study, evidence.calibrated.as_ref(), &epistemic)?,
        epistemic,
        exceptions: exceptions(record),
        inputs: inputs::inputs(study),
        exact: exact::exact(study, &evidence.exact)?,
        correlations: inputs::correlations(study),
        numerical,
        method: MethodFinding {
            model: study.model.name(),
            design: sampler.describe() + &inputs::dependence(study),
            samples: record.counts().samples(),
            replicates: sampler.replicates(),
            tolerance: study.numerics.tolerance,
            caveats: caveats(study, sampler.advice()),
        },
        reproduction: ReproductionFinding {
            version: env!("CARGO_PKG_VERSION"),
            seed: study.sampling.seed,
            study_digest: study.digest(),
            files: study.file_digests(),
            command: evidence.command.clone(),
        },
    })
}

fn outcome(record: &Record, quantity: OutcomeQuantity) -> OutcomeFinding {
    let summary = record.summary(quantity);
    let any = |value: f64| (summary.samples > 0).then_some(value);
    OutcomeFinding {
        name: quantity.name(),
        column: quantity.column(),
        samples: summary.samples,
        mean: any(summary.mean),
        standard_deviation: summary.standard_deviation(),
        smallest: any(summary.smallest),
        largest: any(summary.largest),
    }
}

fn nominal(study: &Study, nominal: &std::result::Result<Outcome, Fault>) -> NominalFinding {
    match nominal {
        Ok(outcome) => NominalFinding {
            deployed: Some(outcome.deployed),
            outcomes: OutcomeQuantity::ALL
                .into_iter()
                .map(|quantity| (quantity.column(), outcome.get(quantity)))
                .collect(),
            breaches: study
                .limits
                .iter()
                .filter(|limit| limit.margin(outcome) < 0.0)
                .map(|limit| limit.name())
                .collect(),
            fault: None,
        },
        Err(fault) => NominalFinding {
            deployed: None,
            outcomes: BTreeMap::new(),
            breaches: Vec::new(),
            fault: Some(fault.name()),
        },
    }
}

fn exceptions(record: &Record) -> ExceptionFinding {
    ExceptionFinding {
        not_deployed: record.not_deployed(),
        faulted: record.fault_counts().iter().map(|(_, count)| count).sum(),
        faults: record.fault_counts().iter().map(|(fault, count)| (fault.name(), *count)).collect(),
        first_faulted: record.faulted().iter().map(|s| (s.index, s.fault.name())).collect(),
    }
}

fn caveats(study: &Study, advice: Option<String>) -> Vec<String> {
    let mut caveats = vec![
        "The probabilities are of the model, with the laws of the card: a width that is assumed in the \
         card is assumed in every number here."
            .to_owned(),
        "The intervals hold the sampling error only, not the error of the model or of the card.".to_owned(),
    ];
    if study.sampling.design.is_replicated() {
        caveats.push(
            "The points of this design are not independent: intervals come from its replicates \
             (Korn and Graubard), and exact binomial ones of all points do not apply."
                .to_owned(),
        );
    }
    caveats.extend(study.sampling.stopping.as_ref().map(sequence::caveat));
    caveats.extend(study.notes.iter().cloned());
    caveats.extend(advice);
    caveats
}
