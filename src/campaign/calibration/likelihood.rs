//! The likelihood of rig runs: a point of standard-normal space becomes a brake, a start and a noise; the brake is
//! driven by each record, and the readings are compared with what it predicts.
//!
//! Coordinates: first the inputs of the card, in their order and through its joint law, correlations and all; then each
//! run's initial temperature; then, channel by channel, what is not known of the noise: sensor error, discrepancy,
//! correlation time.

use super::channel::Channel;
use super::plan::{ChannelNoise, PlannedRun, Positive, SensorError};
use crate::calibration::noise::{Noise, NoiseColumns, add_ln_density, drawn_errors, whiten};
use crate::calibration::{LeastSquares, LogLikelihood, Whitened};
use crate::descent::driven::{Prediction, Record, Settings, differentiate, predict_with};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::dual::Dual;
use crate::numerics::lanes::InstructionSet;
use crate::numerics::real::Real;
use crate::physics::{Coefficients, Design, Parameter, Target};
use crate::streams::Stream;
use crate::study::Study;
use crate::uncertainty::Joint;
use rayon::prelude::*;

/// Points that one thread takes at a time.
const BATCH: usize = 64;
/// Directions of one differentiated pass.
const DIRECTIONS: usize = 8;
/// Half width of the differences that differentiate the card's joint law.
const DIFFERENCE: f64 = 1e-4;

/// Rig runs, as a function of brake, start and noise.
#[derive(Debug, Clone)]
pub struct RigLikelihood<'a> {
    design: &'a Design,
    joint: &'a Joint,
    targets: Vec<Target>,
    runs: Vec<PlannedRun>,
    noise: Vec<ChannelNoise>,
    settings: Settings,
}

/// A coordinate's place in a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// Input of the card.
    Input(usize),
    /// Initial temperature of a run.
    Initial(usize),
    /// Sensor error of the channel at a place in the list of noises.
    Sensor(usize),
    /// Standard deviation of its discrepancy.
    Discrepancy(usize),
    /// Correlation time of its discrepancy.
    CorrelationTime(usize),
}

impl<'a> RigLikelihood<'a> {
    /// The likelihood of runs under a study's card.
    pub fn new(study: &'a Study, runs: Vec<PlannedRun>, noise: Vec<ChannelNoise>) -> Self {
        RigLikelihood {
            design: &study.design,
            joint: &study.joint,
            targets: study.inputs.iter().map(|input| input.target).collect(),
            runs,
            noise,
            settings: Settings::default(),
        }
    }

    /// The runs.
    pub fn runs(&self) -> &[PlannedRun] {
        &self.runs
    }

    /// The noises.
    pub fn noise(&self) -> &[ChannelNoise] {
        &self.noise
    }

    /// Where the inputs' values go.
    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// What each coordinate is.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        let inputs = (0..self.targets.len()).map(Coordinate::Input);
        let initial = (0..self.runs.len()).map(Coordinate::Initial);
        let mut all: Vec<Coordinate> = inputs.chain(initial).collect();
        for (k, noise) in self.noise.iter().enumerate() {
            if let SensorError::Estimated(_) = noise.sensor {
                all.push(Coordinate::Sensor(k));
            }
            if noise.discrepancy.is_some() {
                all.extend([Coordinate::Discrepancy(k), Coordinate::CorrelationTime(k)]);
            }
        }
        all
    }

    /// The values of the inputs at points (rows), SI.
    pub fn inputs(&self, z: &Columns) -> Columns {
        let mut inputs = Columns::default();
        let mut own = Columns::new(z.rows(), self.targets.len());
        for j in 0..self.targets.len() {
            own.column_mut(j).copy_from_slice(z.column(j));
        }
        self.joint.from_standard_normal(&own, &mut inputs);
        inputs
    }

    /// Initial temperature of a run at a point, K.
    pub fn initial_k(&self, run: usize, z: &[f64]) -> f64 {
        let law = self.runs[run].initial;
        law.mean_k + law.sd_k * z[self.targets.len() + run]
    }

    /// The noise of a channel at a point.
    pub fn noise_at(&self, channel: Channel, z: &[f64]) -> Noise {
        let of = |k: usize| self.noises_at(k, std::slice::from_ref(&z));
        let k = self.noise.iter().position(|noise| noise.channel == channel);
        k.map_or(Noise { sensor_sd: 0.0, discrepancy_sd: 0.0, correlation_time_s: 1.0 }, |k| {
            let [sensor, discrepancy, time] = of(k);
            Noise {
                sensor_sd: sensor[0],
                discrepancy_sd: discrepancy[0],
                correlation_time_s: time[0],
            }
        })
    }

    /// Sensor error, discrepancy and correlation time of noise `k` at points.
    fn noises_at(&self, k: usize, points: &[&[f64]]) -> [Vec<f64>; 3] {
        let coordinates = self.coordinates();
        let place = |wanted: Coordinate| coordinates.iter().position(|c| *c == wanted);
        let column = |law: Positive, wanted: Coordinate| -> Vec<f64> {
            let at = place(wanted);
            points.iter().map(|z| law.at(at.map_or(0.0, |at| z[at]))).collect()
        };
        let sensor = match self.noise[k].sensor {
            SensorError::Stated(sd) => vec![sd; points.len()],
            SensorError::Estimated(law) => column(law, Coordinate::Sensor(k)),
        };
        match self.noise[k].discrepancy {
            Some((sd, time)) => [
                sensor,
                column(sd, Coordinate::Discrepancy(k)),
                column(time, Coordinate::CorrelationTime(k)),
            ],
            None => [sensor, vec![0.0; points.len()], vec![1.0; points.len()]],
        }
    }

    /// The coefficients of a draw of the inputs; nothing if it is impossible.
    pub fn coefficients(&self, inputs: &[f64]) -> Option<Coefficients<f64>> {
        let mut design = self.design.clone();
        for (&target, &value) in self.targets.iter().zip(inputs) {
            design.set(target, value);
        }
        design.is_possible().then(|| Coefficients::new(&design))
    }

    /// Predictions of a record by brakes (SI inputs, one row each) that start at these temperatures; none where a
    /// brake is impossible.
    pub fn predict(
        &self,
        record: &Record,
        inputs: &Columns,
        initial_k: &[f64],
    ) -> Vec<Option<Prediction>> {
        let rows: Vec<usize> = (0..inputs.rows()).collect();
        let parts: Vec<Vec<Option<Prediction>>> = rows
            .par_chunks(BATCH)
            .map(|rows| {
                let brakes: Vec<Option<Coefficients<f64>>> = rows
                    .iter()
                    .map(|&k| {
                        let mut brake = self.coefficients(&inputs.row(k))?;
                        brake.initial_temperature_k = initial_k[k];
                        Some(brake)
                    })
                    .collect();
                let there: Vec<Coefficients<f64>> = brakes.iter().flatten().copied().collect();
                let mut predictions = Vec::new();
                let set = InstructionSet::best();
                predict_with(set, record, &self.settings, &there, &mut predictions);
                let mut predictions = predictions.into_iter();
                brakes.iter().map(|brake| brake.as_ref().and_then(|_| predictions.next())).collect()
            })
            .collect();
        parts.into_iter().flatten().collect()
    }

    /// ln likelihood of some points.
    fn batch(&self, z: &Columns, rows: std::ops::Range<usize>) -> Vec<f64> {
        let set = InstructionSet::best();
        let mut part = Columns::new(rows.len(), z.columns());
        for j in 0..z.columns() {
            part.column_mut(j).copy_from_slice(&z.column(j)[rows.clone()]);
        }
        let inputs = self.inputs(&part);
        let mut values = vec![f64::NEG_INFINITY; rows.len()];
        let brakes: Vec<(usize, Coefficients<f64>)> =
            (0..rows.len()).filter_map(|k| Some((k, self.coefficients(&inputs.row(k))?))).collect();
        let points: Vec<Vec<f64>> = brakes.iter().map(|(k, _)| part.row(*k)).collect();
        let points: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
        let noises: Vec<[Vec<f64>; 3]> =
            (0..self.noise.len()).map(|k| self.noises_at(k, &points)).collect();
        let mut sums = vec![0.0; brakes.len()];
        let mut predictions = Vec::new();
        let mut batch: Vec<Coefficients<f64>> = brakes.iter().map(|(_, brake)| *brake).collect();
        for (run, planned) in self.runs.iter().enumerate() {
            for (brake, point) in batch.iter_mut().zip(&points) {
                brake.initial_temperature_k = self.initial_k(run, point);
            }
            predict_with(set, &planned.record, &self.settings, &batch, &mut predictions);
            for (channel, series) in &planned.channels {
                let Some(k) = self.noise.iter().position(|noise| noise.channel == *channel) else {
                    continue;
                };
                let [sensor_sd, discrepancy_sd, correlation_time_s] = &noises[k];
                let noise = NoiseColumns { sensor_sd, discrepancy_sd, correlation_time_s };
                let predicted = |moment: usize, point: usize| {
                    channel.predicted(&predictions[point].readings[moment])
                };
                add_ln_density(set, series, noise, predicted, &mut sums);
            }
        }
        for ((k, _), sum) in brakes.iter().zip(sums) {
            values[*k] = sum;
        }
        values
    }

    /// The derivatives of the inputs' values by the coordinates of the card, `[input][coordinate]`.
    pub fn input_slopes(&self, z: &[f64]) -> Vec<Vec<f64>> {
        let n = self.targets.len();
        let mut rows = Columns::new(2 * n, n);
        for k in 0..2 * n {
            for (j, &value) in z.iter().take(n).enumerate() {
                rows.set(k, j, value);
            }
            let side = if k % 2 == 0 { DIFFERENCE } else { -DIFFERENCE };
            rows.set(k, k / 2, z[k / 2] + side);
        }
        let inputs = self.inputs(&rows);
        (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| (inputs.get(2 * j, i) - inputs.get(2 * j + 1, i)) / (2.0 * DIFFERENCE))
                    .collect()
            })
            .collect()
    }

    /// Predictions of a channel at every moment of a record, and their derivatives by every input and then by the
    /// initial temperature: `[channel][moment]` and `[channel][input][moment]`. Nothing where the brake is impossible.
    pub fn slopes(
        &self,
        record: &Record,
        inputs: &[f64],
        initial_k: f64,
        channels: &[Channel],
    ) -> Option<Slopes> {
        self.coefficients(inputs)?;
        let n = self.targets.len();
        let thinning = self.design_of(inputs).get(Parameter::FluidCrossTimeConstant) > 0.0;
        let base = self.design_of(inputs).map(<Dual<DIRECTIONS> as Real>::constant);
        let moments = record.times_s().len();
        let mut slopes = Slopes {
            values: vec![vec![0.0; moments]; channels.len()],
            derivatives: vec![vec![vec![0.0; moments]; n + 1]; channels.len()],
        };
        for first in (0..=n).step_by(DIRECTIONS) {
            let mut design = base.clone();
            let last = (first + DIRECTIONS).min(n + 1);
            let varied = self.targets.iter().zip(inputs).skip(first).take(DIRECTIONS);
            for (direction, (&target, &value)) in varied.enumerate() {
                design.set(target, Dual::variable(value, direction));
            }
            let mut brake = Coefficients::with_shear_thinning(&design, thinning);
            brake.initial_temperature_k = if n < last {
                Dual::variable(initial_k, n - first)
            } else {
                Real::constant(initial_k)
            };
            let prediction = differentiate(record, &self.settings, &brake);
            for (c, channel) in channels.iter().enumerate() {
                for (moment, reading) in prediction.readings.iter().enumerate() {
                    let dual = channel.predicted(reading);
                    slopes.values[c][moment] = dual.value;
                    for j in first..last {
                        slopes.derivatives[c][j][moment] = dual.slopes[j - first];
                    }
                }
            }
        }
        let finite = slopes.values.iter().flatten().all(|value| value.is_finite());
        finite.then_some(slopes)
    }

    fn design_of(&self, inputs: &[f64]) -> Design {
        let mut design = self.design.clone();
        for (&target, &value) in self.targets.iter().zip(inputs) {
            design.set(target, value);
        }
        design
    }

    /// The same runs with readings drawn anew at a point: predictions, a draw of each discrepancy, and of each
    /// sensor's error. Nothing where the brake is impossible.
    pub fn redrawn(&self, z: &[f64], stream: &mut Stream) -> Option<Self> {
        let inputs = self.inputs(&Columns::from_rows(&[z]));
        let mut again = self.clone();
        for (run, planned) in again.runs.iter_mut().enumerate() {
            let initial_k = self.initial_k(run, z);
            let predicted = self.predict(&planned.record, &inputs, &[initial_k]);
            let predicted = predicted.into_iter().next().flatten()?;
            for (channel, series) in &mut planned.channels {
                let noise = self.noise_at(*channel, z);
                let errors = drawn_errors(series, &noise, stream);
                for (reading, error) in series.readings.iter_mut().zip(errors) {
                    reading.value = channel.predicted(&predicted.readings[reading.moment]) + error;
                }
            }
        }
        Some(again)
    }
}

/// The sum of some columns with these weights.
pub(super) fn combined(columns: &[Vec<f64>], weights: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, weight) in columns.iter().zip(weights) {
        for (sum, value) in sum.iter_mut().zip(column) {
            *sum += weight * value;
        }
    }
    sum
}

/// Predictions and their derivatives; see [`RigLikelihood::slopes`].
#[derive(Debug, Clone)]
pub struct Slopes {
    /// `[channel][moment]`.
    pub values: Vec<Vec<f64>>,
    /// `[channel][input, then initial temperature][moment]`.
    pub derivatives: Vec<Vec<Vec<f64>>>,
}

impl LogLikelihood for RigLikelihood<'_> {
    fn dimension(&self) -> usize {
        self.coordinates().len()
    }

    fn ln_likelihood(&self, z: &Columns, out: &mut [f64]) -> Result<()> {
        let starts: Vec<usize> = (0..z.rows()).step_by(BATCH).collect();
        let parts: Vec<Vec<f64>> = starts
            .par_iter()
            .map(|&start| self.batch(z, start..(start + BATCH).min(z.rows())))
            .collect();
        for (out, value) in out.iter_mut().zip(parts.into_iter().flatten()) {
            *out = value;
        }
        Ok(())
    }
}

impl LeastSquares for RigLikelihood<'_> {
    fn squared_dimension(&self) -> usize {
        self.targets.len() + self.runs.len()
    }

    fn whitened(&self, z: &[f64], _: bool) -> Result<Option<Whitened>> {
        let n = self.targets.len();
        let d = self.squared_dimension();
        let inputs = self.inputs(&Columns::from_rows(&[z])).row(0);
        let by_input = self.input_slopes(z);
        let mut whitened = Whitened { residuals: Vec::new(), jacobian: vec![Vec::new(); d] };
        for (run, planned) in self.runs.iter().enumerate() {
            let channels: Vec<Channel> = planned.channels.iter().map(|(c, _)| *c).collect();
            let initial_k = self.initial_k(run, z);
            let Some(slopes) = self.slopes(&planned.record, &inputs, initial_k, &channels) else {
                return Ok(None);
            };
            for (c, (channel, series)) in planned.channels.iter().enumerate() {
                let noise = self.noise_at(*channel, z);
                let readings = &series.readings;
                let residuals =
                    readings.iter().map(|r| r.value - slopes.values[c][r.moment]).collect();
                let mut columns: Vec<Vec<f64>> = vec![residuals];
                for derivative in &slopes.derivatives[c] {
                    columns.push(readings.iter().map(|r| -derivative[r.moment]).collect());
                }
                whiten(series, &noise, &mut columns);
                let count = columns[0].len();
                whitened.residuals.append(&mut columns[0]);
                for (j, jacobian) in whitened.jacobian.iter_mut().enumerate() {
                    if j < n {
                        jacobian
                            .extend(combined(&columns[1..=n], by_input.iter().map(|row| row[j])));
                    } else if j == n + run {
                        jacobian.extend(columns[1 + n].iter().map(|x| x * planned.initial.sd_k));
                    } else {
                        jacobian.resize(jacobian.len() + count, 0.0);
                    }
                }
            }
        }
        Ok(Some(whitened))
    }
}
