//! What varies from flight to flight and what is not known, told apart by nested descents.

use super::analysis::{Absent, Analysis, Found, Run};
use super::trade::trade_factors;
use super::{Ensemble, Progress};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use crate::reliability::nested::{
    NestedSample, NestedState, ShareSample, nested_sample, share_sample,
};
use crate::sensitivity::pick_freeze::Factor;
use crate::study::{Input, Limit, Nature, Study};
use crate::uncertainty::{Copula, Marginal, Measure, Statement};

/// Rows of the shares for each set of the band, and descents of each for those of a set.
const SHARE_ROWS: f64 = 0.5;
const SHARE_INNER: u64 = 8;
/// Fewest rows of the shares.
const FEWEST_ROWS: u64 = 40;

/// The nested descents of a study.
#[derive(Debug, Clone)]
pub struct EpistemicOutcomes {
    /// What is not known, by factor.
    pub factors: Vec<Factor>,
    /// Names of the factors that vary.
    pub varying: Vec<String>,
    /// Descents with each set.
    pub inner: u64,
    /// Sets of values of what is not known, with descents over what varies.
    pub sample: NestedSample,
    /// The pick-freeze sample of the shares, or why there is none.
    pub shares: std::result::Result<ShareSample, String>,
    /// Rows of the shares, and descents with each point of a row.
    pub share_size: (usize, usize),
}

impl Analysis<'_> for EpistemicOutcomes {
    const NAME: &'static str = "what is not known";

    /// Something must vary, and something must be unknown.
    fn cost(study: &Study) -> Found<u64> {
        let plan = study.epistemic;
        Absent::unless_asked("epistemic.outer", plan.outer)?;
        Absent::unless_limited(study)?;
        let unwatched = Progress::default();
        let state = NestedDescents::new(study, &unwatched)?;
        if state.unknown.is_empty() {
            return Err(Absent::NothingUnknown);
        }
        if state.unknown.len() == state.dimension() {
            return Err(Absent::NothingVaries);
        }
        let (rows, inner) = share_size(study);
        let factors = trade_factors(study).len();
        Ok(plan.outer * plan.inner + (rows * inner * (4 + factors)) as u64)
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        run_epistemic(run.study, run.progress)
    }
}

fn share_size(study: &Study) -> (usize, usize) {
    let plan = study.epistemic;
    let rows = ((plan.outer as f64 * SHARE_ROWS) as u64).max(FEWEST_ROWS);
    (rows as usize, (plan.inner / SHARE_INNER).max(4) as usize)
}

/// Computes the nested descents of a study. `None` if `progress` asks for a stop.
///
/// # Errors
/// If the copula of its inputs cannot be conditioned.
pub fn run_epistemic(study: &Study, progress: &Progress) -> Result<Option<EpistemicOutcomes>> {
    let plan = study.epistemic;
    let state = NestedDescents::new(study, progress)?;
    let seed = study.sampling.seed;
    let half = (plan.inner / 2) as usize;
    let sample = nested_sample(&state, plan.outer as usize, half, seed)?;
    if progress.stopping() {
        return Ok(None);
    }
    let (factors, varying) = state.factors();
    let share_size = share_size(study);
    let shares = match state.correlated_factors(&factors) {
        true => {
            Err("unknown inputs are correlated, so a share of the band belongs to several at once"
                .to_owned())
        }
        false => {
            let columns: Vec<Vec<usize>> = factors.iter().map(|f| f.columns.clone()).collect();
            Ok(share_sample(&state, &columns, share_size.0, share_size.1, seed)?)
        }
    };
    if progress.stopping() {
        return Ok(None);
    }
    Ok(Some(EpistemicOutcomes { factors, varying, inner: plan.inner, sample, shares, share_size }))
}

/// Inputs of one set of readings, whose mean and deviation are not known.
#[derive(Debug, Clone)]
struct Read {
    inputs: Vec<usize>,
    /// Coordinates of the deviation and of the mean.
    coordinates: (usize, usize),
}

/// A study's descents as a system of unknown and varying coordinates: one for every input, then two for each set of
/// readings about whose unknown mean an input varies.
#[derive(Debug)]
struct NestedDescents<'a> {
    study: &'a Study,
    ensemble: Ensemble<'a>,
    progress: &'a Progress,
    unknown: Vec<usize>,
    read: Vec<Read>,
    /// The copula in an order in which every unknown input comes before every varying one, and that order: given the
    /// first, the others follow their law.
    copula: Option<(Copula, Vec<usize>)>,
}

impl<'a> NestedDescents<'a> {
    fn new(study: &'a Study, progress: &'a Progress) -> Result<Self> {
        let inputs = study.inputs.len();
        let is_unknown = |j: &usize| study.inputs[*j].nature == Nature::Unknown;
        let mut unknown: Vec<usize> = (0..inputs).filter(is_unknown).collect();
        let mut read: Vec<Read> = Vec::new();
        for (j, input) in study.inputs.iter().enumerate() {
            if input.nature == Nature::Unknown || input.readings.is_none() {
                continue;
            }
            // The inputs of one statement share its readings.
            let shares = |other: &Input| {
                other.group.is_some()
                    && other.group == input.group
                    && other.readings == input.readings
            };
            match read.iter_mut().find(|read| shares(&study.inputs[read.inputs[0]])) {
                Some(found) => found.inputs.push(j),
                None => {
                    let at = inputs + 2 * read.len();
                    read.push(Read { inputs: vec![j], coordinates: (at, at + 1) });
                }
            }
        }
        unknown.extend(inputs..inputs + 2 * read.len());
        let copula = match study.joint.copula() {
            None => None,
            Some(copula) => Some(unknown_first(copula, study)?),
        };
        let ensemble = Ensemble::new(study);
        Ok(NestedDescents { study, ensemble, progress, unknown, read, copula })
    }

    /// What is not known, by factor, and the names of what varies.
    fn factors(&self) -> (Vec<Factor>, Vec<String>) {
        let (mut unknown, mut varying) = (Vec::new(), Vec::new());
        for factor in trade_factors(self.study) {
            let (not_known, varies): (Vec<usize>, Vec<usize>) =
                factor.columns.iter().partition(|j| self.unknown.contains(j));
            if !varies.is_empty() {
                varying.push(factor.name.clone());
            }
            if !not_known.is_empty() {
                unknown.push(Factor { name: factor.name, columns: not_known });
            }
        }
        for read in &self.read {
            let first = &self.study.inputs[read.inputs[0]];
            let name = match read.inputs.len() {
                1 => first.target.path(),
                _ => first.group.clone().unwrap_or_default(),
            };
            let (sd, mean) = read.coordinates;
            unknown.push(Factor { name: format!("{name}: mean and sd"), columns: vec![sd, mean] });
        }
        (unknown, varying)
    }

    /// Whether unknown inputs of different factors are correlated.
    fn correlated_factors(&self, factors: &[Factor]) -> bool {
        let Some(copula) = self.study.joint.copula() else { return false };
        let member = |j: usize| factors.iter().position(|factor| factor.columns.contains(&j));
        let inputs = 0..self.study.inputs.len();
        inputs.clone().any(|i| {
            inputs.clone().any(|j| {
                i != j
                    && copula.normal_correlation(i, j) != 0.0
                    && matches!((member(i), member(j)), (Some(a), Some(b)) if a != b)
            })
        })
    }

    /// The inputs, SI, at points of the unit cube.
    fn draws(&self, u: &Columns) -> Columns {
        let inputs = self.study.inputs.len();
        let joint = &self.study.joint;
        let mut x = Columns::new(u.rows(), inputs);
        let alone = |j: &usize| joint.sample_of(*j).is_none();
        let mut positions = None;
        match &self.copula {
            None => {
                for j in (0..inputs).filter(alone) {
                    self.study.inputs[j].marginal.quantile_column(u.column(j), x.column_mut(j));
                }
            }
            Some((copula, order)) => {
                let mut z = Columns::new(u.rows(), inputs);
                for (place, &j) in order.iter().enumerate() {
                    normal::quantile_column(u.column(j), z.column_mut(place));
                }
                let mut correlated = Columns::default();
                copula.correlate(&z, &mut correlated);
                let mut own = Columns::new(u.rows(), inputs);
                for (place, &j) in order.iter().enumerate() {
                    own.column_mut(j).copy_from_slice(correlated.column(place));
                }
                for j in (0..inputs).filter(alone) {
                    let marginal = &self.study.inputs[j].marginal;
                    marginal.from_standard_normal_column(own.column(j), x.column_mut(j));
                }
                positions = Some(own);
            }
        }
        joint.fill_from_uniform(u, &mut x);
        for read in &self.read {
            for &j in &read.inputs {
                for k in 0..u.rows() {
                    let at = match &positions {
                        Some(z) => normal::cdf(z.get(k, j)),
                        None => u.get(k, j),
                    };
                    x.set(
                        k,
                        j,
                        self.reading(j, u, k, read).map_or(f64::NAN, |law| law.quantile_lower(at)),
                    );
                }
            }
        }
        x
    }

    /// The law about which input `j` varies in row `k`; none if its truncation leaves nothing of it.
    fn reading(&self, j: usize, u: &Columns, k: usize, read: &Read) -> Option<Marginal> {
        let input = &self.study.inputs[j];
        let (sd, mean) = read.coordinates;
        let law = input.readings.as_ref()?.law_at(u.get(k, sd), u.get(k, mean));
        Marginal::new(law, input.marginal.lower(), input.marginal.upper()).ok()
    }
}

/// The copula with the unknown inputs first, and the order of the inputs in it.
fn unknown_first(copula: &Copula, study: &Study) -> Result<(Copula, Vec<usize>)> {
    let mut order: Vec<usize> = (0..study.inputs.len()).collect();
    order.sort_by_key(|&j| study.inputs[j].nature != Nature::Unknown);
    let mut statements = Vec::new();
    for (second, &j) in order.iter().enumerate() {
        for (first, &i) in order.iter().take(second).enumerate() {
            let rho = copula.normal_correlation(i, j);
            if rho != 0.0 {
                statements.push(Statement { first, second, measure: Measure::Normal(rho) });
            }
        }
    }
    Ok((Copula::new(order.len(), &statements)?, order))
}

impl NestedState for NestedDescents<'_> {
    fn dimension(&self) -> usize {
        self.study.inputs.len() + 2 * self.read.len()
    }

    fn unknown(&self) -> &[usize] {
        &self.unknown
    }

    fn is_continuous(&self, j: usize) -> bool {
        let joint = &self.study.joint;
        let jumps =
            |i: usize| joint.sample_of(i).is_some() || self.study.inputs[i].marginal.has_jumps();
        let moved = |i: usize| match joint.copula() {
            Some(copula) => i == j || copula.normal_correlation(i, j) != 0.0,
            None => i == j,
        };
        (0..self.study.inputs.len()).all(|i| !(moved(i) && jumps(i)))
    }

    fn limits(&self) -> usize {
        self.study.limits.len()
    }

    fn margins(&self, u: &Columns, margins: &mut Columns) -> Result<()> {
        if self.progress.stopping() {
            return Ok(());
        }
        let table = self.ensemble.at_inputs(&self.draws(u), self.progress);
        for (i, limit) in self.study.limits.iter().enumerate() {
            let limit: &Limit = limit;
            let outcomes = table.outcome(limit.outcome);
            for (margin, &outcome) in margins.column_mut(i).iter_mut().zip(outcomes) {
                *margin = limit.margin_of(outcome);
            }
        }
        Ok(())
    }
}
