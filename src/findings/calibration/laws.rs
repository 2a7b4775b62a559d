//! The posterior as laws and rank correlations: for who cannot draw from a joint sample, and as the prior of a further
//! calibration.

use crate::calibration::posterior::mean_variance;
use crate::campaign::calibration::{Calibration, is_hardware};
use crate::error::Result;
use crate::numerics::elementary::{exp, ln};
use crate::physics::Parameter;
use crate::study::Study;
use crate::uncertainty::{Copula, Law, Marginal, Measure, Statement};
use serde::Serialize;

/// Smallest rank correlation that is written down: below it the draws cannot tell it from none.
const LEAST: f64 = 0.05;
/// Rounds of matching the moments of a truncated law.
const ROUNDS: usize = 60;

/// A law fitted to the posterior of one input, or of the gaps of one statement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawFinding {
    /// Path.
    pub path: String,
    /// Whether it holds for each surface.
    pub each_surface: bool,
    /// Family, as a card writes it.
    pub law: &'static str,
    /// Keys and values, SI.
    pub numbers: Vec<(&'static str, f64)>,
    /// Unit of the values that have one, SI.
    pub unit: &'static str,
    /// When its value becomes known.
    pub known: &'static str,
}

/// A rank correlation of the posterior.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CorrelationFinding {
    /// Paths.
    pub between: (String, String),
    /// Spearman's coefficient.
    pub spearman: f64,
}

/// Laws and correlations of the calibrated inputs.
///
/// # Errors
/// If a law refuses the draws' moments.
pub(super) fn laws(
    study: &Study,
    found: &Calibration<'_>,
) -> Result<(Vec<LawFinding>, Vec<CorrelationFinding>)> {
    let hardware: Vec<usize> = (0..study.inputs.len())
        .filter(|&j| is_hardware(study.inputs[j].target.parameter))
        .collect();
    // Gaps of one statement are exchangeable, before and after: one law, and one correlation with each other input.
    let class = |j: usize| -> usize {
        let input = &study.inputs[j];
        match (&input.group, input.target.parameter) {
            (Some(group), Parameter::BrakeGap) if input.target.surface.is_some() => hardware
                .iter()
                .copied()
                .find(|&k| study.inputs[k].group.as_ref() == Some(group))
                .unwrap_or(j),
            _ => j,
        }
    };
    let classes: Vec<usize> = hardware.iter().copied().filter(|&j| class(j) == j).collect();
    let members =
        |c: usize| -> Vec<usize> { hardware.iter().copied().filter(|&j| class(j) == c).collect() };
    let mut laws = Vec::new();
    for &c in &classes {
        let all = members(c);
        let values: Vec<f64> =
            all.iter().flat_map(|&j| found.inputs.column(j).iter().copied()).collect();
        let input = &study.inputs[c];
        let info = input.target.parameter.info();
        let each_surface = all.len() > 1 && all.len() == study.design.surfaces();
        let (law, numbers) = fitted(&input.marginal, &values)?;
        let law_of = |path: String, each_surface| LawFinding {
            path,
            each_surface,
            law,
            numbers: numbers.clone(),
            unit: info.quantity.si_unit(),
            known: input.known.name(),
        };
        match each_surface {
            true => laws.push(law_of(info.path.to_owned(), true)),
            false => laws.extend(all.iter().map(|&j| law_of(study.inputs[j].target.path(), false))),
        }
    }
    let ranks: Vec<Vec<f64>> = hardware.iter().map(|&j| ranks(found.inputs.column(j))).collect();
    let rank_of = |j: usize| &ranks[hardware.iter().position(|&k| k == j).unwrap_or(0)];
    let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
    for (a, &first) in classes.iter().enumerate() {
        for &second in &classes[a..] {
            let mut own = Vec::new();
            for i in members(first) {
                for j in members(second) {
                    if i < j {
                        own.push((i, j, correlation(rank_of(i), rank_of(j))));
                    }
                }
            }
            let mean = own.iter().map(|pair| pair.2).sum::<f64>() / own.len().max(1) as f64;
            if mean.abs() >= LEAST {
                pairs.extend(own.into_iter().map(|(i, j, _)| (i, j, mean)));
            }
        }
    }
    consistent(study.inputs.len(), &mut pairs);
    let path = |j: usize| study.inputs[j].target.path();
    let correlations = pairs
        .into_iter()
        .map(|(i, j, spearman)| CorrelationFinding { between: (path(i), path(j)), spearman })
        .collect();
    Ok((laws, correlations))
}

/// Leaving out the smallest correlations can leave a matrix that no law has: then all shrink until one has it.
fn consistent(inputs: usize, pairs: &mut [(usize, usize, f64)]) {
    for _ in 0..40 {
        // To the digits that a card writes.
        for pair in pairs.iter_mut() {
            pair.2 = (pair.2 * 1e4).round() * 1e-4;
        }
        let statements: Vec<Statement> = pairs
            .iter()
            .map(|&(first, second, spearman)| Statement {
                first,
                second,
                measure: Measure::Spearman(spearman),
            })
            .collect();
        if Copula::new(inputs, &statements).is_ok() {
            return;
        }
        pairs.iter_mut().for_each(|pair| pair.2 *= 0.97);
    }
}

/// The prior's family with the draws' moments; normal between the prior's ends where the prior's family has no such form.
fn fitted(prior: &Marginal, values: &[f64]) -> Result<(&'static str, Vec<(&'static str, f64)>)> {
    let (low, high) = prior.support();
    let ends = |numbers: &mut Vec<(&'static str, f64)>| {
        numbers.extend(low.is_finite().then_some(("lower", low)));
        numbers.extend(high.is_finite().then_some(("upper", high)));
    };
    if let Law::Lognormal { .. } = prior.law() {
        let logs: Vec<f64> = values.iter().map(|&value| ln(value)).collect();
        let (mean, variance) = mean_variance(&logs);
        let mut numbers = vec![("median", exp(mean)), ("log_sd", variance.sqrt())];
        if prior.lower().is_some() || prior.upper().is_some() {
            numbers.extend(prior.lower().map(|end| ("lower", end)));
            numbers.extend(prior.upper().map(|end| ("upper", end)));
        }
        return Ok(("lognormal", numbers));
    }
    let (mean, variance) = mean_variance(values);
    let (wanted_mean, wanted_sd) = (mean, variance.sqrt());
    let (mut mean, mut sd) = (wanted_mean, wanted_sd);
    if low.is_finite() || high.is_finite() {
        let widest =
            if low.is_finite() && high.is_finite() { 3.0 * (high - low) } else { f64::MAX };
        let end = |x: f64| x.is_finite().then_some(x);
        for _ in 0..ROUNDS {
            let law = Marginal::new(Law::normal(mean, sd)?, end(low), end(high))?;
            let (got_mean, got_sd) = law.moments();
            mean += wanted_mean - got_mean;
            sd = (sd * wanted_sd / got_sd).min(widest);
        }
    }
    let mut numbers = vec![("mean", mean), ("sd", sd)];
    ends(&mut numbers);
    Ok(("normal", numbers))
}

/// Ranks from 0; ties in the order of their places.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k] = rank as f64;
    }
    ranks
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let ((mean_a, var_a), (mean_b, var_b)) = (mean_variance(a), mean_variance(b));
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum();
    sum / (a.len() as f64 - 1.0) / (var_a * var_b).sqrt()
}
