//! Everything a report says of a run, computed once, as one tree that serialises: what the Markdown shows, the
//! JSON holds. Numbers are SI; the renderer chooses units.

use super::Options;
use super::list::Analyses;
use super::sampling::Sampling;
use crate::campaign;
use crate::campaign::analysis::if_any;
use crate::campaign::screening::slopes;
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::findings::{
    self, CalibratedFinding, CorrelationFinding, DriversFinding, EpistemicFinding, ExactFinding,
    ExceptionFinding, FigureData, InputFinding, KnownFinding, LimitFinding, MarginFinding,
    MeasuresFinding, MethodFinding, ModelFormFinding, NominalFinding, NumericalFinding,
    OutcomeFinding, ProbabilityFinding, RareFinding, ReproductionFinding, ShapleyFinding,
    StoppingFinding, TradeFinding, VerdictFinding, calibrated, demonstration, drivers, epistemic,
    exact, figures, inputs, known, limits, margins, measures, model_form, numerical, probabilities,
    rare_findings, sequence, shapley, this_brake, trade,
};
use crate::study::{RequirementOf, Study};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The layout of the tree that this version writes and reads.
const FORMAT: u32 = 1;

/// The whole answer to a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// Why no findings can be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unreadable {
    /// It is no JSON, and why.
    NotJson(String),
    /// Another version wrote it.
    OtherVersion(String),
    /// It lacks something, or has something else in its place.
    NotFindings(String),
}

impl Findings {
    /// Reads the findings of a run of this version, the text of its `findings.json`. What that does not hold (the values
    /// behind a scatter of samples) is empty.
    ///
    /// # Errors
    /// If it is something else.
    pub fn read(json: &[u8]) -> std::result::Result<Self, Unreadable> {
        let tree: Value =
            serde_json::from_slice(json).map_err(|why| Unreadable::NotJson(why.to_string()))?;
        let version = tree["reproduction"]["version"].as_str().unwrap_or("an unknown version");
        if tree["format"] != FORMAT || version != env!("CARGO_PKG_VERSION") {
            return Err(Unreadable::OtherVersion(version.to_owned()));
        }
        serde_json::from_value(tree).map_err(|why| Unreadable::NotFindings(why.to_string()))
    }
}

/// Computes the findings.
///
/// # Errors
/// If the study's numbers are such that a statistic refuses them (a confidence of 1, say).
pub fn gather(
    study: &Study,
    sampling: &Sampling,
    analyses: &Analyses<'_>,
    options: &Options,
) -> Result<Findings> {
    let record = &sampling.record;
    let nominal = campaign::nominal(study);
    let verification = campaign::verify(study, record)?;
    // What was drawn, which may be less than the budget.
    let mut drawn = study.clone();
    drawn.sampling.samples = record.counts().samples();
    let sampler = campaign::sampler(&drawn)?;
    let mut numerical = numerical::numerical(study, record, &verification);
    let probabilities = probabilities::probabilities(study, record)?;
    let verdict = demonstration::verdict(study, record, &probabilities)?;
    let verdict = numerical::heed(study, record, &verification, &mut numerical, verdict)?;
    let drivers = drivers::drivers(study, &analyses.pick_freeze)?;
    let shapley = shapley::shapley(study, &analyses.shapley)?;
    let epistemic = epistemic::epistemic(study, &analyses.epistemic)?;
    let mut verdict = this_brake::two_statements(study, verdict, &epistemic);
    // Numbers that cannot be trusted decide nothing of this brake either.
    let of_brake = study.requirement.is_some_and(|stated| stated.of == RequirementOf::Brake);
    if of_brake && numerical.withdrawn.is_some() {
        verdict = numerical::heed(study, record, &verification, &mut numerical, verdict)?;
    }
    let rare = if_any(&analyses.rare)?.map_or(&[][..], |found| &found[..]);
    Ok(Findings {
        format: FORMAT,
        title: study.title.clone(),
        verdict,
        stopping: sequence::stopping(study, record.counts().samples(), sampling.stop),
        limits: limits::limits(study),
        probabilities,
        rare: rare_findings(study, rare, nominal.as_ref().ok()),
        model_form: model_form::model_form(study, &analyses.model_form)?,
        margins: margins::margins(study, record)?,
        outcomes: OutcomeQuantity::ALL.map(|quantity| findings::outcome(record, quantity)).to_vec(),
        nominal: findings::nominal(study, &nominal),
        figures: figures::figures(study, record, &drivers)?,
        measures: measures::measures(
            study,
            &analyses.given,
            &analyses.screening,
            &slopes(study),
            &drivers,
            &shapley,
        )?,
        drivers,
        shapley,
        trade: trade::trade(study, &analyses.trade)?,
        known: known::known(study, &analyses.known)?,
        calibrated: calibrated::calibrated(study, if_any(&analyses.calibrated)?, &epistemic)?,
        epistemic,
        exceptions: findings::exceptions(record),
        inputs: inputs::inputs(study),
        exact: exact::exact(study, &analyses.exact)?,
        correlations: inputs::correlations(study),
        numerical,
        method: MethodFinding {
            model: study.model.name(),
            design: sampler.describe() + &inputs::dependence(study),
            samples: record.counts().samples(),
            replicates: sampler.replicates(),
            tolerance: study.numerics.tolerance,
            caveats: findings::caveats(study, sampler.advice()),
        },
        reproduction: ReproductionFinding {
            version: env!("CARGO_PKG_VERSION"),
            seed: study.sampling.seed,
            study_digest: study.digest(),
            files: study.file_digests(),
            command: options
                .command
                .clone()
                .unwrap_or_else(|| "reeldown::analysis::run".to_owned()),
        },
    })
}
