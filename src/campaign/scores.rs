//! The sums that the score-function derivatives are made from, over all samples of a run, whose draws are
//! computed again.

use super::common_numbers::{Breaches, Event};
use super::trade::Parameter;
use super::{in_parallel, sampler};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::elementary::{exp, ln};
use crate::sensitivity::pick_freeze::Factor;
use crate::sensitivity::score_sums::ScoreSums;
use crate::study::Study;
use crate::uncertainty::{Law, Marginal};

/// Samples in a piece of the score sums.
const PIECE: u64 = 4096;

/// Sums behind the derivatives of one factor's parameter.
#[derive(Debug, Clone)]
pub struct FactorScores {
    /// Which factor.
    pub factor: usize,
    /// Which parameter.
    pub parameter: Parameter,
    /// One a limit, then one of any limit; or why there are none.
    pub sums: std::result::Result<Vec<ScoreSums>, String>,
}

/// Why a law's score does not give the derivative, if so.
fn without_score(study: &Study, columns: &[usize]) -> Option<String> {
    if !study.joint.is_independent() {
        return Some(
            "the inputs are correlated: see the difference by common random numbers".into(),
        );
    }
    if columns.iter().any(|&j| study.joint.sample_of(j).is_some()) {
        return Some("rows of a joint sample have no density".into());
    }
    let predicted = |&j: &usize| matches!(study.inputs[j].marginal.law(), Law::Student { .. });
    if columns.iter().any(predicted) {
        return Some("the law is what readings predict, which has no parameter of its own".into());
    }
    let ended = |&j: &usize| {
        let law = study.inputs[j].marginal.law();
        !matches!(law, Law::Normal { .. } | Law::Lognormal { .. } | Law::Gumbel { .. })
    };
    columns.iter().any(ended).then(|| {
        "the law has an end of its own that moves with its parameter, which a score cannot see"
            .into()
    })
}

/// The score sums of every factor over the first `samples` samples of the design, whose draws are computed
/// again and whose breaches `breaches` gives, from a sample on so many.
pub(super) fn scores(
    study: &Study,
    samples: u64,
    breaches: impl Fn(usize, usize) -> Breaches + Sync + Send,
    factors: &[Factor],
) -> Result<Vec<FactorScores>> {
    let sampler = sampler(study)?;
    let events: Vec<Event> =
        (0..study.limits.len()).map(Event::Limit).chain([Event::Any]).collect();
    let parameters = [Parameter::Spread, Parameter::Mean];
    let reasons: Vec<Option<String>> =
        factors.iter().map(|factor| without_score(study, &factor.columns)).collect();
    let pieces: Vec<u64> = (0..samples).step_by(PIECE as usize).collect();
    let sums = in_parallel(&pieces, |&first| -> Result<Vec<ScoreSums>> {
        let rows = (samples - first).min(PIECE) as usize;
        let mut uniforms = Columns::new(rows, study.inputs.len());
        sampler.fill(first, &mut uniforms)?;
        let mut inputs = Columns::default();
        study.joint.from_uniform(&uniforms, &mut inputs);
        let breaches = breaches(first as usize, rows);
        let mut sums = vec![ScoreSums::default(); factors.len() * 2 * events.len()];
        let mut places = sums.chunks_mut(events.len());
        for (factor, reason) in factors.iter().zip(&reasons) {
            for parameter in parameters {
                let Some(place) = places.next() else { continue };
                if reason.is_some() {
                    continue;
                }
                let scales: Vec<Scorer> = factor
                    .columns
                    .iter()
                    .map(|&j| Scorer::new(&study.inputs[j].marginal, parameter))
                    .collect();
                for k in 0..rows {
                    // A common parameter of independent inputs: the scores add up.
                    let members = factor.columns.iter().zip(&scales);
                    let score = members.map(|(&j, s)| s.score(inputs.get(k, j))).sum();
                    for (sum, &event) in place.iter_mut().zip(&events) {
                        sum.push(breaches.happened(event, k), score);
                    }
                }
            }
        }
        Ok(sums)
    });
    let mut total = vec![ScoreSums::default(); factors.len() * 2 * events.len()];
    for piece in sums {
        total.iter_mut().zip(&piece?).for_each(|(total, piece)| total.add(piece));
    }
    let mut places = total.chunks(events.len());
    let mut found = Vec::with_capacity(2 * factors.len());
    for (factor, reason) in reasons.iter().enumerate() {
        for parameter in parameters {
            let sums = places.next().unwrap_or_default().to_vec();
            let sums = reason.clone().map_or(Ok(sums), Err);
            found.push(FactorScores { factor, parameter, sums });
        }
    }
    Ok(found)
}

/// The score of a marginal as a polynomial of its standardised value, where it is one; the truncation's
/// share is found once instead of at every sample.
enum Scorer<'a> {
    /// Score at two values tells a straight line in z, at three a parabola.
    Parabola {
        marginal: &'a Marginal,
        a: f64,
        b: f64,
        c: f64,
    },
    Direct(&'a Marginal, Parameter),
}

impl<'a> Scorer<'a> {
    fn new(marginal: &'a Marginal, parameter: Parameter) -> Self {
        let direct = |x: f64| match parameter {
            Parameter::Mean => marginal.score_mean(x),
            Parameter::Spread => marginal.score_spread(x),
        };
        let at = |z: f64| -> f64 {
            match *marginal.law() {
                Law::Lognormal { log_mean, log_sd } => direct(exp(log_mean + log_sd * z)),
                _ => direct(marginal.law().mean() + marginal.law().sd() * z),
            }
        };
        match marginal.law() {
            Law::Normal { .. } | Law::Lognormal { .. } => {
                let (low, mid, high) = (at(-1.0), at(0.0), at(1.0));
                let a = 0.5 * (low + high) - mid;
                Scorer::Parabola { marginal, a, b: 0.5 * (high - low), c: mid }
            }
            _ => Scorer::Direct(marginal, parameter),
        }
    }

    fn score(&self, x: f64) -> f64 {
        match self {
            Scorer::Parabola { marginal, a, b, c } => {
                let z = match *marginal.law() {
                    Law::Lognormal { log_mean, log_sd } => (ln(x) - log_mean) / log_sd,
                    ref law => (x - law.mean()) / law.sd(),
                };
                (a * z + b) * z + c
            }
            Scorer::Direct(marginal, Parameter::Mean) => marginal.score_mean(x),
            Scorer::Direct(marginal, Parameter::Spread) => marginal.score_spread(x),
        }
    }
}
