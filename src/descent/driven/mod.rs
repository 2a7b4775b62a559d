//! The horizontal rig driven by a recorded history: the truck test as it was measured, predicted.
//!
//! A force history predicts the speed, a speed history the force; the line paid out and the three
//! temperatures follow. Recorded values are linear between their times. The model is the quasi-steady one
//! (paper (8), (15), (16), (17); the equations are [`crate::physics::quasi_steady`]'s, the only copy).
//!
//! # Accuracy
//! Order four with steps of at most [`Settings::longest_step_s`]. Worst relative errors found against SciPy's
//! DOP853 on wobbling records (`tests/truth/driven_runs.rs`): with steps of 1 s 4e-6 in predicted speeds and
//! temperatures, 2.5e-5 in the predicted force of a cold run (one newton); with steps of 0.25 s 2e-8 and 8e-8. The
//! quasi-steady rig is not stiff: its fastest time is the fluid's, C1/(K12 + K13) = 5.5 s; speeds far above the
//! paper's shorten it (the brake then heats the fluid by tens of kelvin a second) and want shorter steps.
//!
//! # The end of the line
//! A prediction has a reading at every time of its record. Where the line has run out
//! ([`Prediction::line_out_s`], of the prediction, not of the record) the readings are those of a line that goes
//! on and, a little later, of a reel that keeps its radius: a calibration can compare them with the record, the
//! comparison stays finite and has derivatives. Use [`Prediction::readings_on_the_line`] to see only what happened.
//!
//! # Speed
//! `cargo bench --bench driven_runs`: about 10 µs a member for a run of 200 s read every second, with AVX2 or
//! AVX-512, on a shared core; members go side by side, twice a register's lanes at a time. A record that is
//! read more often costs more: it has a step an interval.

mod course;
mod dispatch;
mod record;

use super::outcome::Fault;
use super::vector::InstructionSet;
use crate::numerics::dual::Dual;
use crate::numerics::real::Real;
use crate::physics::Coefficients;
pub use record::{Correction, Drive, Record};

/// How a run is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// No step is longer, s; an interval of the record that is, is cut in equal parts.
    pub longest_step_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { longest_step_s: 1.0 }
    }
}

impl Settings {
    /// Steps in an interval of the record: at least one, and no more than can be afforded.
    fn steps(&self, interval_s: f64) -> usize {
        const MOST: f64 = 1e4;
        // An interval that is longer by rounding only is not worth another step.
        (interval_s / self.longest_step_s * (1.0 - 1e-9)).ceil().clamp(1.0, MOST) as usize
    }
}

/// What the instruments would show at one moment, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading<R> {
    /// Line paid out, m.
    pub line_m: R,
    /// Pull on the line, N.
    pub force_n: R,
    /// Speed of the line, m/s.
    pub speed_m_per_s: R,
    /// Temperatures of fluid, rotors, housing, K.
    pub temperatures_k: [R; 3],
}

/// A run as predicted from the history that drove it.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction<R = f64> {
    /// A reading at each time of the record.
    pub readings: Vec<Reading<R>>,
    /// When the line ran out, s; `None` if it lasted.
    pub line_out_s: Option<R>,
    /// Why the readings are not to be used, if they are not.
    pub fault: Option<Fault>,
}

impl<R: Real> Prediction<R> {
    /// A prediction that waits to be filled: reuse it for many.
    pub fn new() -> Self {
        Prediction { readings: Vec::new(), line_out_s: None, fault: None }
    }

    /// The readings up to the end of the line.
    pub fn readings_on_the_line(&self, record: &Record, value: impl Fn(R) -> f64) -> &[Reading<R>] {
        let Some(end) = self.line_out_s.map(value) else { return &self.readings };
        let count = record.times_s().partition_point(|&time| time <= end);
        &self.readings[..count.min(self.readings.len())]
    }

    /// Finds the end of the line and what cannot be used.
    fn conclude(&mut self, record: &Record, length_m: R, value: impl Fn(R) -> f64) {
        self.line_out_s = end_of_line(record.times_s(), &self.readings, length_m, &value);
        let finite = |reading: &Reading<R>| {
            let [a, b, c] = reading.temperatures_k;
            [reading.line_m, reading.force_n, reading.speed_m_per_s, a, b, c]
                .into_iter()
                .all(|entry| value(entry).is_finite())
        };
        // A value that stopped being finite stays so to the end.
        let sound = self.readings.last().is_none_or(finite);
        self.fault = (!sound).then_some(Fault::NotFinite);
    }
}

impl<R: Real> Default for Prediction<R> {
    fn default() -> Self {
        Self::new()
    }
}

/// Predicts a run for each member of a batch, side by side with the machine's best instruction set.
///
/// `predictions` is made as long as the batch; what it holds is overwritten and its memory used again. A
/// member's bits depend on its own coefficients, the record and the settings alone.
pub fn predict(
    record: &Record,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    predictions: &mut Vec<Prediction>,
) {
    predict_with(InstructionSet::best(), record, settings, batch, predictions);
}

/// [`predict`] with an instruction set of the caller's choice; the bits are the same with every one.
pub fn predict_with(
    set: InstructionSet,
    record: &Record,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    predictions: &mut Vec<Prediction>,
) {
    predict_corrected(set, record, settings, batch, &[], predictions);
}

/// [`predict_with`], each member with its own correction of what the record says was applied; members beyond the
/// end of `corrections` take the record as it is.
pub fn predict_corrected(
    set: InstructionSet,
    record: &Record,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    corrections: &[Correction],
    predictions: &mut Vec<Prediction>,
) {
    predictions.resize_with(batch.len(), Prediction::new);
    dispatch::dispatch(set, record, settings, batch, corrections, predictions);
    for (prediction, c) in predictions.iter_mut().zip(batch) {
        prediction.conclude(record, c.reel.line_length_m, |value| value);
    }
}

/// Predicts one run with the derivatives of every reading, and of the end of the line, along `N` directions
/// of its coefficients ([`Coefficients::with_shear_thinning`] of a design with dual numbers).
pub fn differentiate<const N: usize>(
    record: &Record,
    settings: &Settings,
    coefficients: &Coefficients<Dual<N>>,
) -> Prediction<Dual<N>> {
    differentiate_corrected(record, settings, coefficients, Correction::none())
}

/// [`differentiate`] with a correction of what the record says was applied.
pub fn differentiate_corrected<const N: usize>(
    record: &Record,
    settings: &Settings,
    coefficients: &Coefficients<Dual<N>>,
    correction: Correction<Dual<N>>,
) -> Prediction<Dual<N>> {
    let mut prediction = Prediction::new();
    let keep = |_, reading| prediction.readings.push(reading);
    course::course(record, settings, coefficients, correction, keep);
    prediction.conclude(record, coefficients.reel.line_length_m, |dual| dual.value);
    prediction
}

/// When the line ran out: on the cubic through line and speed at the two readings about it, by bisection and
/// a last step of Newton's, which carries the derivatives.
fn end_of_line<R: Real>(
    times_s: &[f64],
    readings: &[Reading<R>],
    length_m: R,
    value: &impl Fn(R) -> f64,
) -> Option<R> {
    const BISECTIONS: usize = 40;
    let length = value(length_m);
    let k = readings.partition_point(|reading| value(reading.line_m) < length);
    let after = readings.get(k)?;
    let before = readings.get(k.checked_sub(1)?)?;
    let (start, h) = (times_s[k - 1], times_s[k] - times_s[k - 1]);
    let number = R::constant;
    // Line and speed at a share of the interval.
    let at = |s: f64| {
        let (s2, s3) = (s * s, s * s * s);
        let terms = [
            (before.line_m, 2.0 * s3 - 3.0 * s2 + 1.0, 6.0 * s2 - 6.0 * s),
            (after.line_m, 3.0 * s2 - 2.0 * s3, 6.0 * s - 6.0 * s2),
            (before.speed_m_per_s, h * (s3 - 2.0 * s2 + s), h * (3.0 * s2 - 4.0 * s + 1.0)),
            (after.speed_m_per_s, h * (s3 - s2), h * (3.0 * s2 - 2.0 * s)),
        ];
        let sum = |weight: fn(&(R, f64, f64)) -> f64| {
            terms.iter().fold(number(0.0), |sum, term| term.0.mul_add(number(weight(term)), sum))
        };
        (sum(|term| term.1), sum(|term| term.2) / number(h))
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if value(at(middle).0) < length { low = middle } else { high = middle }
    }
    let (line, speed) = at(high);
    Some(number(high.mul_add(h, start)) + (length_m - line) / speed)
}
