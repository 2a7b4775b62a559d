//! Prior and posterior, side by side.

use crate::calibration::posterior::mean_variance;
use crate::campaign::calibration::predictive::quantile;
use crate::campaign::calibration::{Calibration, Coordinate, SensorError, is_hardware, risk};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::elementary::exp;
use crate::physics::{Coefficients, Parameter};
use crate::study::Study;
use serde::Serialize;

/// Share of its prior variance that a parameter must lose to count as learned.
pub const LEARNED: f64 = 0.2;

/// One parameter before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterFinding {
    /// Path, or what it is.
    pub name: String,
    /// How many inputs it stands for: gaps of one statement are one row, of their means.
    pub inputs: usize,
    /// Unit, SI.
    pub unit: &'static str,
    /// Mean and standard deviation before, SI.
    pub prior: (f64, f64),
    /// Mean and standard deviation after, SI.
    pub posterior: (f64, f64),
    /// 5 %, 50 % and 95 % quantiles after, SI.
    pub quantiles: [f64; 3],
    /// Share of the prior's variance that the data has taken away, in standard-normal space; of a value made of several
    /// inputs, in its own.
    pub learned: f64,
    /// Whether what is said of it is still the card's.
    pub prior_dominated: bool,
}

fn summary(
    name: String,
    (inputs, unit): (usize, &'static str),
    prior: (f64, f64),
    values: &[f64],
    learned: Option<f64>,
) -> ParameterFinding {
    let (mean, variance) = mean_variance(values);
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let learned = learned.unwrap_or(1.0 - variance / (prior.1 * prior.1));
    ParameterFinding {
        name,
        inputs,
        unit,
        prior,
        posterior: (mean, variance.sqrt()),
        quantiles: [0.05, 0.5, 0.95].map(|p| quantile(&sorted, p)),
        learned,
        prior_dominated: learned < LEARNED,
    }
}

fn variance_in_normal_space(found: &Calibration<'_>, j: usize) -> f64 {
    let column: Vec<f64> = found.draws.iter().map(|draw| draw[j]).collect();
    mean_variance(&column).1
}

/// The card's hardware inputs with the brake's strength, and everything else that was sampled.
///
/// # Errors
/// If the study has too many inputs for a design.
pub(super) fn parameters(
    study: &Study,
    found: &Calibration<'_>,
) -> Result<(Vec<ParameterFinding>, Vec<ParameterFinding>)> {
    let mut rows = vec![strength(study, found)?];
    let hardware: Vec<usize> = (0..study.inputs.len())
        .filter(|&j| is_hardware(study.inputs[j].target.parameter))
        .collect();
    let mut seen: Vec<&str> = Vec::new();
    for &j in &hardware {
        let input = &study.inputs[j];
        let members: Vec<usize> = match &input.group {
            Some(group) if input.target.parameter == Parameter::BrakeGap => {
                if seen.contains(&group.as_str()) {
                    continue;
                }
                seen.push(group);
                let same = |&k: &usize| study.inputs[k].group.as_deref() == Some(group);
                hardware.iter().copied().filter(same).collect()
            }
            _ => vec![j],
        };
        let info = input.target.parameter.info();
        let unit = info.quantity.si_unit();
        let name = match members.len() {
            1 => input.target.path(),
            many => format!("{} (each of {many})", info.path),
        };
        // Gaps of one statement are exchangeable: pooled, they describe any of them.
        let values: Vec<f64> =
            members.iter().flat_map(|&k| found.inputs.column(k).iter().copied()).collect();
        let spread: f64 = members.iter().map(|&k| variance_in_normal_space(found, k)).sum();
        let learned = 1.0 - spread / members.len() as f64;
        let prior = input.marginal.moments();
        rows.push(summary(name, (members.len(), unit), prior, &values, Some(learned)));
    }
    Ok((rows, nuisances(found)))
}

/// Torque per reel speed and thickening of the fluid, relative to the nominal design: what viscosity, shear factor and all
/// gaps act through.
fn strength(study: &Study, found: &Calibration<'_>) -> Result<ParameterFinding> {
    let of = |design: &crate::physics::Design| Coefficients::new(design).fluid.torque_per_speed_nms;
    let nominal = of(&study.design);
    let values = |inputs: &Columns| -> Vec<f64> {
        (0..inputs.rows())
            .map(|k| {
                let mut design = study.design.clone();
                for (j, input) in study.inputs.iter().enumerate() {
                    design.set(input.target, inputs.get(k, j));
                }
                of(&design) / nominal
            })
            .collect()
    };
    let before = mean_variance(&values(&risk::prior_brakes(study, risk::BRAKES)?));
    let prior = (before.0, before.1.sqrt());
    let name = "brake strength (torque per speed, over the nominal)".to_owned();
    Ok(summary(name, (1, ""), prior, &values(&found.inputs), None))
}

fn nuisances(found: &Calibration<'_>) -> Vec<ParameterFinding> {
    let likelihood = &found.likelihood;
    let lognormal = |law: crate::campaign::calibration::Positive| {
        let variance = law.log_sd * law.log_sd;
        let mean = law.median * exp(0.5 * variance);
        (mean, mean * (exp(variance) - 1.0).sqrt())
    };
    let mut rows = Vec::new();
    for (j, coordinate) in likelihood.coordinates().into_iter().enumerate() {
        let column = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            found.draws.iter().map(|draw| of(draw[j])).collect()
        };
        let learned = Some(1.0 - variance_in_normal_space(found, j));
        rows.push(match coordinate {
            Coordinate::Input(_) => continue,
            Coordinate::Initial(run) => {
                let run = &likelihood.runs()[run];
                let law = run.initial;
                let values = column(&|z| law.mean_k + law.sd_k * z);
                let name = format!("initial temperature of {}", run.name);
                summary(name, (1, "K"), (law.mean_k, law.sd_k), &values, learned)
            }
            Coordinate::Gain(k) => {
                let error = likelihood.systematic()[k];
                let name =
                    format!("{}: gain of the instrument, truth over reading", error.channel.name());
                let values = column(&|z| 1.0 + error.gain * z);
                summary(name, (1, ""), (1.0, error.gain), &values, learned)
            }
            Coordinate::Offset(k) => {
                let error = likelihood.systematic()[k];
                let unit = error.channel.quantity().of_difference().si_unit();
                let name = format!(
                    "{}: offset of the instrument, truth less reading",
                    error.channel.name()
                );
                let values = column(&|z| error.offset * z);
                summary(name, (1, unit), (0.0, error.offset), &values, learned)
            }
            Coordinate::Sensor(k) | Coordinate::Discrepancy(k) | Coordinate::CorrelationTime(k) => {
                let noise = &likelihood.noise()[k];
                let unit = noise.channel.quantity().of_difference().si_unit();
                let channel = noise.channel.name();
                let (law, name, unit) = match (coordinate, noise.sensor, noise.discrepancy) {
                    (Coordinate::Sensor(_), SensorError::Estimated(law), _) => {
                        (law, format!("{channel}: sensor error"), unit)
                    }
                    (Coordinate::Discrepancy(_), _, Some((law, _))) => {
                        (law, format!("{channel}: discrepancy of the model"), unit)
                    }
                    (Coordinate::CorrelationTime(_), _, Some((_, law))) => {
                        (law, format!("{channel}: correlation time of the discrepancy"), "s")
                    }
                    _ => continue,
                };
                summary(name, (1, unit), lognormal(law), &column(&|z| law.at(z)), learned)
            }
        });
    }
    rows
}
