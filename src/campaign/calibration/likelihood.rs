//! The likelihood of rig runs: a point of standard-normal space becomes a brake, a start and a noise; the brake is
//! driven by each record, and the readings are compared with what it predicts.
//!
//! Coordinates: first the inputs of the card, in their order and through its joint law, correlations and all; then each
//! run's initial temperature; then the gains and offsets of the instruments, the same in every run; then, channel by
//! channel, what is not known of the noise: sensor error, discrepancy, correlation time.
//!
//! One scaling is beyond any rig: force, brake constant, heat capacities and conductances all multiplied by one factor
//! give the same speeds and temperatures, so the brake is never known better than the load cell.

use super::channel::Channel;
use super::plan::{
    ChannelNoise, InitialTemperature, Options, PlannedRun, Positive, SensorError, Systematic,
};
use crate::calibration::noise::{Noise, NoiseColumns, add_ln_density, drawn_errors, whiten};
use crate::calibration::{LeastSquares, LogLikelihood, Whitened};
use crate::campaign::Progress;
use crate::descent::driven::{
    Correction, Prediction, Record, Settings, differentiate_corrected, predict_corrected,
};
use crate::error::{Error, Result};
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
    systematic: Vec<Systematic>,
    noise: Vec<ChannelNoise>,
    settings: Settings,
    progress: Option<&'a Progress>,
}

/// Moments of a record that are about the work of one descent.
const MOMENTS: usize = 50;

/// The work of a likelihood of runs with so many moments, in descents.
pub(super) fn work(moments: usize) -> usize {
    moments / MOMENTS + 1
}

/// A coordinate's place in a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// Input of the card.
    Input(usize),
    /// Initial temperature of a run.
    Initial(usize),
    /// Gain of the instrument at a place in the list of systematic errors.
    Gain(usize),
    /// Its offset.
    Offset(usize),
    /// Sensor error of the channel at a place in the list of noises.
    Sensor(usize),
    /// Standard deviation of its discrepancy.
    Discrepancy(usize),
    /// Correlation time of its discrepancy.
    CorrelationTime(usize),
}

impl<'a> RigLikelihood<'a> {
    /// The likelihood of runs under a study's card.
    pub fn new(
        study: &'a Study,
        runs: Vec<PlannedRun>,
        systematic: Vec<Systematic>,
        noise: Vec<ChannelNoise>,
    ) -> Self {
        RigLikelihood {
            design: &study.design,
            joint: &study.joint,
            targets: study.inputs.iter().map(|input| input.target).collect(),
            runs,
            systematic,
            noise,
            settings: Settings::default(),
            progress: None,
        }
    }

    /// The likelihood of runs with the systematic errors and the noise that the options say, the rest from the runs.
    pub fn of_runs(study: &'a Study, runs: Vec<PlannedRun>, options: &Options) -> Self {
        let systematic = super::plan::systematic(&runs, options);
        let noise = super::plan::noise(&runs, options);
        Self::new(study, runs, systematic, noise)
    }

    /// The same, counted by `progress` and stopped by it.
    pub fn watched(self, progress: &'a Progress) -> Self {
        RigLikelihood { progress: Some(progress), ..self }
    }

    /// The same of other runs, with every law as it is.
    pub fn with_runs(&self, runs: Vec<PlannedRun>) -> Self {
        RigLikelihood { runs, ..self.clone() }
    }

    /// The same with other noise.
    pub fn with_noise(self, noise: Vec<ChannelNoise>) -> Self {
        RigLikelihood { noise, ..self }
    }

    /// The instruments' systematic errors.
    pub fn systematic(&self) -> &[Systematic] {
        &self.systematic
    }

    /// How the readings of a channel are corrected at a point.
    pub fn correction(&self, channel: Channel, z: &[f64]) -> Correction {
        let mut place = self.targets.len() + self.runs.len();
        for error in &self.systematic {
            let mut next = |sd: f64| {
                if sd == 0.0 {
                    return 0.0;
                }
                place += 1;
                sd * z.get(place - 1).copied().unwrap_or(0.0)
            };
            let (gain, offset) = (next(error.gain), next(error.offset));
            if error.channel == channel {
                return channel.correction(gain, offset);
            }
        }
        Correction::none()
    }

    /// The same for what drives a record.
    pub fn drive_correction(&self, record: &Record, z: &[f64]) -> Correction {
        Channel::of_drive(record.drive())
            .map_or_else(Correction::none, |channel| self.correction(channel, z))
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
        all.extend(self.systematic_coordinates());
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

    fn systematic_coordinates(&self) -> Vec<Coordinate> {
        let of = |(k, error): (usize, &Systematic)| {
            let gain = (error.gain != 0.0).then_some(Coordinate::Gain(k));
            let offset = (error.offset != 0.0).then_some(Coordinate::Offset(k));
            gain.into_iter().chain(offset)
        };
        self.systematic.iter().enumerate().flat_map(of).collect()
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

    /// Predictions of a record by brakes (SI inputs, one row each) that start at these temperatures, the record
    /// corrected for each; none where a brake is impossible. They are of what is true: see [`RigLikelihood::correction`].
    pub fn predict(
        &self,
        record: &Record,
        inputs: &Columns,
        initial_k: &[f64],
        corrections: &[Correction],
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
                let corrected: Vec<Correction> = rows
                    .iter()
                    .zip(&brakes)
                    .filter(|(_, brake)| brake.is_some())
                    .map(|(&k, _)| corrections.get(k).copied().unwrap_or_else(Correction::none))
                    .collect();
                let mut predictions = Vec::new();
                let set = InstructionSet::best();
                let settings = &self.settings;
                predict_corrected(set, record, settings, &there, &corrected, &mut predictions);
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
            let record = &planned.record;
            let applied: Vec<Correction> =
                points.iter().map(|point| self.drive_correction(record, point)).collect();
            predict_corrected(set, record, &self.settings, &batch, &applied, &mut predictions);
            for (channel, series) in &planned.channels {
                let Some(k) = self.noise.iter().position(|noise| noise.channel == *channel) else {
                    continue;
                };
                let [sensor_sd, discrepancy_sd, correlation_time_s] = &noises[k];
                let noise = NoiseColumns { sensor_sd, discrepancy_sd, correlation_time_s };
                let read: Vec<Correction> =
                    points.iter().map(|point| self.correction(*channel, point)).collect();
                let predicted = |moment: usize, point: usize| {
                    read[point].reading(channel.predicted(&predictions[point].readings[moment]))
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

    /// What a record's instruments should read at a point, and how that changes with the point. Nothing where the
    /// brake is impossible.
    pub fn slopes(
        &self,
        record: &Record,
        z: &[f64],
        initial: InitialTemperature,
        channels: &[Channel],
    ) -> Option<Slopes> {
        let inputs = self.inputs(&Columns::from_rows(&[z])).row(0);
        self.coefficients(&inputs)?;
        let n = self.targets.len();
        let thinning = self.design_of(&inputs).get(Parameter::FluidCrossTimeConstant) > 0.0;
        let base = self.design_of(&inputs).map(<Dual<DIRECTIONS> as Real>::constant);
        let moments = record.times_s().len();
        let drive = self.drive_correction(record, z);
        let mut values = vec![vec![0.0; moments]; channels.len()];
        // By every input, the initial temperature, the drive's gain and its offset.
        let all = n + 3;
        let mut by = vec![vec![vec![0.0; moments]; all]; channels.len()];
        for first in (0..all).step_by(DIRECTIONS) {
            let mut design = base.clone();
            let last = (first + DIRECTIONS).min(all);
            let number = |value: f64, place: usize| match (first..last).contains(&place) {
                true => Dual::variable(value, place - first),
                false => Real::constant(value),
            };
            for (j, (&target, &value)) in self.targets.iter().zip(&inputs).enumerate() {
                design.set(target, number(value, j));
            }
            let mut brake = Coefficients::with_shear_thinning(&design, thinning);
            brake.initial_temperature_k = number(initial.mean_k, n);
            let applied =
                Correction { gain: number(drive.gain, n + 1), offset: number(drive.offset, n + 2) };
            let prediction = differentiate_corrected(record, &self.settings, &brake, applied);
            for (c, channel) in channels.iter().enumerate() {
                for (moment, reading) in prediction.readings.iter().enumerate() {
                    let dual: Dual<DIRECTIONS> = channel.predicted(reading);
                    values[c][moment] = dual.value;
                    for (column, slope) in by[c][first..last].iter_mut().zip(dual.slopes) {
                        column[moment] = slope;
                    }
                }
            }
        }
        if !values.iter().flatten().all(|value| value.is_finite()) {
            return None;
        }
        let by_input = self.input_slopes(z);
        let systematic = self.systematic_coordinates();
        let mut derivatives = Vec::with_capacity(channels.len());
        for (c, &channel) in channels.iter().enumerate() {
            let own = self.correction(channel, z);
            let by = &mut by[c];
            let read: Vec<f64> = values[c].iter().map(|&truth| own.reading(truth)).collect();
            by.iter_mut().flatten().for_each(|slope| *slope /= own.gain);
            let mut columns: Vec<Vec<f64>> =
                (0..n).map(|j| combined(&by[..n], by_input.iter().map(|row| row[j]))).collect();
            columns.push(by[n].iter().map(|slope| slope * initial.sd_k).collect());
            for coordinate in &systematic {
                let (k, gain) = match *coordinate {
                    Coordinate::Gain(k) => (k, true),
                    Coordinate::Offset(k) => (k, false),
                    _ => continue,
                };
                let error = self.systematic[k];
                // Correction = (1 + gain, offset − gain · zero).
                let (sd, by_gain, by_offset) = match gain {
                    true => (error.gain, 1.0, -error.channel.zero()),
                    false => (error.offset, 0.0, 1.0),
                };
                let drives = Channel::of_drive(record.drive()) == Some(error.channel);
                let column = (0..moments).map(|moment| {
                    let mut slope = 0.0;
                    if drives {
                        slope += by_gain * by[n + 1][moment] + by_offset * by[n + 2][moment];
                    }
                    if error.channel == channel {
                        slope -= (by_gain * read[moment] + by_offset) / own.gain;
                    }
                    sd * slope
                });
                columns.push(column.collect());
            }
            values[c] = read;
            derivatives.push(columns);
        }
        Some(Slopes { values, derivatives })
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
            let applied = [self.drive_correction(&planned.record, z)];
            let predicted = self.predict(&planned.record, &inputs, &[initial_k], &applied);
            let predicted = predicted.into_iter().next().flatten()?;
            for (channel, series) in &mut planned.channels {
                let noise = self.noise_at(*channel, z);
                let read = self.correction(*channel, z);
                let errors = drawn_errors(series, &noise, stream);
                for (reading, error) in series.readings.iter_mut().zip(errors) {
                    let truth = channel.predicted(&predicted.readings[reading.moment]);
                    reading.value = read.reading(truth) + error;
                }
            }
        }
        Some(again)
    }
}

/// The sum of some columns with these weights.
fn combined(columns: &[Vec<f64>], weights: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, weight) in columns.iter().zip(weights) {
        for (sum, value) in sum.iter_mut().zip(column) {
            *sum += weight * value;
        }
    }
    sum
}

/// Predicted readings and their derivatives; see [`RigLikelihood::slopes`].
#[derive(Debug, Clone)]
pub struct Slopes {
    /// `[channel][moment]`.
    pub values: Vec<Vec<f64>>,
    /// `[channel][coordinate][moment]`: the card's coordinates, the initial temperature's, then the systematic errors'.
    pub derivatives: Vec<Vec<Vec<f64>>>,
}

impl LogLikelihood for RigLikelihood<'_> {
    fn dimension(&self) -> usize {
        self.coordinates().len()
    }

    fn ln_likelihood(&self, z: &Columns, out: &mut [f64]) -> Result<()> {
        if let Some(progress) = self.progress {
            if progress.stopping() {
                return Err(Error::argument("stopped before the posterior was found"));
            }
            let moments = self.runs.iter().map(|run| run.record.times_s().len()).sum();
            progress.advance(z.rows() * work(moments));
        }
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
        self.targets.len() + self.runs.len() + self.systematic_coordinates().len()
    }

    fn whitened(&self, z: &[f64], _: bool) -> Result<Option<Whitened>> {
        let (n, runs) = (self.targets.len(), self.runs.len());
        let d = self.squared_dimension();
        let mut whitened = Whitened { residuals: Vec::new(), jacobian: vec![Vec::new(); d] };
        for (run, planned) in self.runs.iter().enumerate() {
            let channels: Vec<Channel> = planned.channels.iter().map(|(c, _)| *c).collect();
            let initial = InitialTemperature { mean_k: self.initial_k(run, z), ..planned.initial };
            let Some(slopes) = self.slopes(&planned.record, z, initial, &channels) else {
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
                let mut columns = columns.into_iter();
                let mut residuals = columns.next().unwrap_or_default();
                let count = residuals.len();
                whitened.residuals.append(&mut residuals);
                for (place, mut column) in columns.enumerate() {
                    let j = match place {
                        input if input < n => input,
                        initial if initial == n => n + run,
                        systematic => systematic - 1 + runs,
                    };
                    whitened.jacobian[j].append(&mut column);
                }
                for other in (0..runs).filter(|&other| other != run) {
                    let jacobian = &mut whitened.jacobian[n + other];
                    jacobian.resize(jacobian.len() + count, 0.0);
                }
            }
        }
        Ok(Some(whitened))
    }
}
