//! What descents look like over the run: quantile bands of trajectories.

use crate::campaign::{self, Ensemble, in_parallel};
use crate::descent::reference::{Sample, Trajectory, trajectory};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::physics::{Coefficients, Design, Parameter};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// Trajectories behind the bands: the first samples of the run.
const TRAJECTORIES: u64 = 300;
/// Places along the abscissa.
const STATIONS: usize = 121;
/// Fine enough for a drawing.
const TOLERANCE: f64 = 1e-4;
/// Fine enough to interpolate in, s.
const LONGEST_STEP_S: f64 = 2.0;
/// The levels of the quantiles.
const LEVELS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// Quantile bands of trajectories, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fan {
    /// Trajectories that could be computed.
    pub trajectories: usize,
    /// Those of them that had not run out their line at the time limit of a descent.
    pub not_deployed: usize,
    /// Line paid out over time; a descent that has ended keeps its whole line out.
    pub line_over_time: FanBand,
    /// Fluid temperature over line paid out.
    pub fluid_temperature_over_line: FanBand,
    /// Separation velocity over line paid out.
    pub velocity_over_line: FanBand,
}

/// Quantiles of one reading over the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FanBand {
    /// Time (s) or line paid out (m).
    pub abscissa: Vec<f64>,
    /// The quantiles at each place, at levels 5, 25, 50, 75 and 95 %; `None` where no descent came.
    pub quantiles: Vec<Option<[f64; 5]>>,
    /// The nominal descent.
    pub nominal: Vec<Option<f64>>,
}

/// The bands of a study's first samples.
pub(super) fn fan(study: &Study) -> Result<Fan> {
    let ensemble = Ensemble::new(study);
    let sampler = campaign::sampler(study)?;
    let rows = TRAJECTORIES.min(sampler.samples()) as usize;
    let mut points = Columns::new(rows, ensemble.dimension());
    let mut draws = Columns::new(rows, ensemble.dimension());
    sampler.fill(0, &mut points)?;
    study.joint.from_uniform(&points, &mut draws);
    let designs: Vec<Design> = (0..rows)
        .map(|k| {
            let draw: Vec<f64> = (0..draws.columns()).map(|j| draws.get(k, j)).collect();
            ensemble.design_of(&draw)
        })
        .collect();
    let computed: Vec<Trajectory> =
        in_parallel(&designs, |design| course(study, design)).into_iter().flatten().collect();
    let nominal = course(study, &study.design);
    let length_m = study.design.get(Parameter::ReelLineLength);
    let mut ends: Vec<f64> =
        computed.iter().filter_map(|t| t.samples.last()).map(|sample| sample.time_s).collect();
    ends.sort_by(f64::total_cmp);
    let longest_s = match ends.len() {
        0 => 1.0,
        n => ends[(n - 1) * 99 / 100],
    };
    let line = |s: &Sample| s.line_m;
    let time = |s: &Sample| s.time_s;
    let band = |end: f64, hold: bool, at: fn(&Sample) -> f64, read: &dyn Fn(&Sample) -> f64| {
        let abscissa: Vec<f64> =
            (0..STATIONS).map(|k| end * k as f64 / (STATIONS - 1) as f64).collect();
        let paths: Vec<Vec<Option<f64>>> =
            computed.iter().map(|t| readings(&t.samples, &abscissa, hold, at, read)).collect();
        let quantiles = (0..STATIONS)
            .map(|k| quantiles(paths.iter().filter_map(|path| path[k]).collect()))
            .collect();
        let nominal = nominal
            .as_ref()
            .map_or(vec![None; STATIONS], |t| readings(&t.samples, &abscissa, hold, at, read));
        FanBand { abscissa, quantiles, nominal }
    };
    Ok(Fan {
        trajectories: computed.len(),
        not_deployed: computed.iter().filter(|t| !t.outcome.deployed).count(),
        line_over_time: band(longest_s, true, time, &line),
        fluid_temperature_over_line: band(length_m, false, line, &|s| s.temperatures_k[0]),
        velocity_over_line: band(length_m, false, line, &|s| s.observation[4]),
    })
}

fn course(study: &Study, design: &Design) -> Option<Trajectory> {
    if !design.is_possible() {
        return None;
    }
    trajectory(&Coefficients::new(design), study.model, TOLERANCE, LONGEST_STEP_S).ok()
}

/// A reading at each place, between the two samples about it; beyond the last sample it is held or absent.
fn readings(
    samples: &[Sample],
    abscissa: &[f64],
    hold: bool,
    at: fn(&Sample) -> f64,
    read: &dyn Fn(&Sample) -> f64,
) -> Vec<Option<f64>> {
    abscissa
        .iter()
        .map(|&x| {
            // The end of the line is placed to the tolerance, not exactly.
            let slack = TOLERANCE * x.abs();
            let k = samples.partition_point(|sample| at(sample) < x);
            match (k.checked_sub(1).and_then(|k| samples.get(k)), samples.get(k)) {
                (_, Some(after)) if at(after) == x => Some(read(after)),
                (Some(before), Some(after)) => {
                    let share = (x - at(before)) / (at(after) - at(before));
                    Some(read(before) + share * (read(after) - read(before)))
                }
                (Some(last), None) if hold || x - at(last) <= slack => Some(read(last)),
                _ => None,
            }
        })
        .collect()
}

/// Quantiles between order statistics (Hyndman and Fan's definition 7).
fn quantiles(mut values: Vec<f64>) -> Option<[f64; 5]> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some(LEVELS.map(|level| {
        let place = level * last as f64;
        let k = place as usize;
        let next = values[(k + 1).min(last)];
        values[k] + (place - k as f64) * (next - values[k])
    }))
}

#[cfg(test)]
mod tests {
    use super::quantiles;

    #[test]
    fn analytic_quantiles_of_evenly_spaced_values_are_evenly_spaced() {
        let values = (0..=100).rev().map(f64::from).collect();
        assert_eq!(quantiles(values), Some([5.0, 25.0, 50.0, 75.0, 95.0]));
        assert_eq!(quantiles(vec![]), None);
    }
}
