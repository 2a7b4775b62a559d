//! Driven rig runs against the plain integrator and against SciPy's DOP853 at rtol 1e-12 on an implementation
//! of the model of its own (references/driven_runs.py), Cross thinning among them.

use super::reference_descents::design;
use reeldown::descent::driven::{
    Correction, Drive, Prediction, Reading, Record, Settings, differentiate, predict,
    predict_corrected, predict_with,
};
use reeldown::descent::reference::{REFERENCE_TOLERANCE, rig};
use reeldown::descent::vector::InstructionSet;
use reeldown::numerics::dual::Dual;
use reeldown::numerics::real::Real;
use reeldown::physics::quasi_steady::Pull;
use reeldown::physics::{Coefficients, Design, Parameter, Target};
use serde_json::Value;

const LBF: f64 = 4.4482216152605;
const FT: f64 = 0.3048;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// Record, design, and SciPy's rows: line, force, speed, temperatures.
fn cases() -> Vec<(Record, Design, Vec<Vec<f64>>)> {
    let file: Value = serde_json::from_str(include_str!("references/driven_runs.json")).unwrap();
    let case = |case: &Value| {
        let drive = if case["drive"] == "force" { Drive::Force } else { Drive::Speed };
        let mut record =
            Record::new(drive, numbers(&case["times"]), numbers(&case["values"])).unwrap();
        record.start_offsets_k = numbers(&case["offsets"]).try_into().unwrap();
        let rows = case["rows"].as_array().unwrap().iter().map(numbers).collect();
        (record, design(&case["overrides"]), rows)
    };
    file["cases"].as_array().unwrap().iter().map(case).collect()
}

fn one(record: &Record, design: &Design, longest_step_s: f64) -> Prediction {
    let mut predictions = Vec::new();
    let settings = Settings { longest_step_s };
    predict(record, &settings, &[Coefficients::new(design)], &mut predictions);
    predictions.remove(0)
}

fn entries(reading: &Reading<f64>) -> [f64; 6] {
    let [a, b, c] = reading.temperatures_k;
    [reading.line_m, reading.force_n, reading.speed_m_per_s, a, b, c]
}

/// The worst error relative to SciPy, a line below 1 m counted as 1 m.
fn worst(prediction: &Prediction, rows: &[Vec<f64>]) -> f64 {
    let mut worst = 0.0f64;
    for (reading, row) in prediction.readings.iter().zip(rows) {
        for (got, want) in entries(reading).into_iter().zip(row) {
            worst = worst.max((got - want).abs() / want.abs().max(1.0));
        }
    }
    worst
}

#[test]
fn reference_scipy_on_wobbling_records() {
    for (k, (record, design, rows)) in cases().iter().enumerate() {
        assert!(rows.len() > 100, "case {k}");
        let errors = [2.0, 1.0, 0.25].map(|step| worst(&one(record, design, step), rows));
        println!("case {k}: worst relative error at steps of 2, 1 and 0.25 s: {errors:?}");
        // One newton of the cold runs’ force: far below any instrument; a quarter of the step is 256 times as accurate.
        assert!(errors[1] <= 4e-5, "case {k}: {errors:?}");
        assert!(errors[2] <= errors[1] / 100.0, "case {k} is not of order 4: {errors:?}");
    }
}

#[test]
fn reference_plain_integrator_on_held_pulls() {
    let thinning = (Parameter::FluidCrossTimeConstant, 0.0008);
    let warm = (Parameter::InitialTemperature, 310.0);
    let cold = (Parameter::InitialTemperature, 266.0);
    let pulls = [
        (Drive::Force, 5500.0 * LBF),
        (Drive::Force, 4000.0 * LBF),
        (Drive::Speed, 2.2 * FT),
        (Drive::Power, 17e3),
    ];
    for (drive, value) in pulls {
        for change in [None, Some(thinning), Some(warm), Some(cold)] {
            let mut design = Design::baseline();
            if let Some((parameter, value)) = change {
                design.set(Target::whole(parameter), value);
            }
            let pull = match drive {
                Drive::Force => Pull::Force(value),
                Drive::Speed => Pull::Speed(value),
                Drive::Power => Pull::Power(value),
            };
            let plain = rig(&Coefficients::new(&design), pull, REFERENCE_TOLERANCE, 1e9).unwrap();
            let last = plain.samples.last().unwrap();
            let record = Record::held(drive, value, last.time_s + 3.0, 1.0).unwrap();
            let got = one(&record, &design, 1.0);
            assert_eq!(got.fault, None);
            let context = format!("{} {value} {change:?}", drive.name());
            // The end of the line lies on a cubic between two readings a second apart.
            let out = got.line_out_s.expect("the line runs out");
            let error = (out - last.time_s).abs() / last.time_s;
            println!("{context}: line out at {out} s, relative error {error:.1e}");
            assert!(error <= 1e-6, "{context}: {out} {}", last.time_s);
            // A record that ends with the line has its last reading there.
            let to_end = Record::new(
                drive,
                (0..=400).map(|k| last.time_s * f64::from(k) / 400.0).collect(),
                vec![value; 401],
            );
            let end = one(&to_end.unwrap(), &design, 0.5).readings[400];
            for (node, (got, want)) in
                end.temperatures_k.into_iter().zip(last.temperatures_k).enumerate()
            {
                assert!((got - want).abs() <= 1e-6 * want, "{context} node {node}: {got} {want}");
            }
            let (force, speed) = (last.observation[1], last.observation[4]);
            assert!((end.force_n - force).abs() <= 2e-6 * force, "{context}");
            assert!((end.speed_m_per_s - speed).abs() <= 2e-6 * speed, "{context}");
        }
    }
}

#[test]
fn property_lanes_and_neighbours_change_no_bit() {
    let (record, _, _) = &cases()[0];
    let batch: Vec<Coefficients<f64>> = (0..21)
        .map(|k| {
            let mut design = Design::baseline();
            design.set(Target::whole(Parameter::FluidShearFactor), 0.8 + 0.02 * f64::from(k));
            if k % 3 == 1 {
                design.set(Target::whole(Parameter::FluidCrossTimeConstant), 0.01);
            }
            Coefficients::new(&design)
        })
        .collect();
    let settings = Settings::default();
    let mut alone = Vec::new();
    for c in &batch {
        let mut one = Vec::new();
        predict_with(InstructionSet::Portable, record, &settings, &[*c], &mut one);
        alone.append(&mut one);
    }
    for set in InstructionSet::ALL {
        let mut together = Vec::new();
        predict_with(set, record, &settings, &batch, &mut together);
        assert!(together == alone, "{}", set.name());
    }
}

#[test]
fn analytic_derivatives_agree_with_differences() {
    let targets = [
        Parameter::FluidShearFactor,
        Parameter::FluidAveragingOffset,
        Parameter::ThermalFluidCapacity,
        Parameter::ThermalFluidRotorConductance,
        Parameter::InitialTemperature,
    ]
    .map(Target::whole);
    for (record, design, _) in &cases()[..4] {
        let mut varied = design.map(Dual::<5>::constant);
        for (k, &target) in targets.iter().enumerate() {
            varied.set(target, Dual::variable(design.at(target), k));
        }
        let thins = design.get(Parameter::FluidCrossTimeConstant) > 0.0;
        let settings = Settings::default();
        let dual =
            differentiate(record, &settings, &Coefficients::with_shear_thinning(&varied, thins));
        for (k, &target) in targets.iter().enumerate() {
            let h = 1e-5 * design.at(target).abs().max(1.0);
            let moved = |sign: f64| {
                let mut design = design.clone();
                design.set(target, design.at(target) + sign * h);
                one(record, &design, 1.0)
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            for row in [10, 90, 150] {
                let Reading { line_m, force_n, speed_m_per_s, temperatures_k: [a, b, c] } =
                    dual.readings[row];
                let slopes = [line_m, force_n, speed_m_per_s, a, b, c].map(|entry| entry.slopes[k]);
                let pair = entries(&up.readings[row]).into_iter().zip(entries(&down.readings[row]));
                for (got, (up, down)) in slopes.into_iter().zip(pair) {
                    let want = (up - down) / (2.0 * h);
                    // Differences cancel ten digits of the value and leave a square of the step.
                    let tolerance = 1e-4 * want.abs() + 1e-10 * up.abs() / h;
                    assert!((got - want).abs() <= tolerance, "{}: {got} {want}", target.path());
                }
            }
            if let (Some(up), Some(down), Some(end)) =
                (up.line_out_s, down.line_out_s, dual.line_out_s)
            {
                let want = (up - down) / (2.0 * h);
                assert!((end.slopes[k] - want).abs() <= 1e-3 * want.abs() + 1e-9 / h);
            }
        }
    }
}

#[test]
fn property_predictions_stay_finite_past_the_end_of_the_line() {
    let record = Record::held(Drive::Force, 8000.0 * LBF, 600.0, 1.0).unwrap();
    let run = one(&record, &Design::baseline(), 1.0);
    assert_eq!(run.fault, None);
    let out = run.line_out_s.unwrap();
    let seen = run.readings_on_the_line(&record, |value| value);
    assert_eq!(seen.len(), out as usize + 1);
    assert!(run.readings.iter().all(|reading| reading.speed_m_per_s.is_finite()));
}

/// Gain and offset act on what was read: a corrected record is the record of the corrected readings.
#[test]
fn analytic_a_corrected_record_is_the_record_of_corrected_readings() {
    for (record, design, _) in cases() {
        let correction = Correction {
            gain: 1.013,
            offset: if record.drive() == Drive::Force { 40.0 } else { 0.01 },
        };
        let values =
            record.values().iter().map(|read| correction.gain * read + correction.offset).collect();
        let mut applied = Record::new(record.drive(), record.times_s().to_vec(), values).unwrap();
        applied.start_offsets_k = record.start_offsets_k;
        let settings = Settings::default();
        let brake = Coefficients::new(&design);
        let mut corrected = Vec::new();
        // The second member is not corrected: it must be what it is alone.
        let set = InstructionSet::best();
        predict_corrected(set, &record, &settings, &[brake; 2], &[correction], &mut corrected);
        for (prediction, record) in corrected.iter().zip([&applied, &record]) {
            let mut plain = Vec::new();
            predict(record, &settings, &[brake], &mut plain);
            for (one, other) in prediction.readings.iter().zip(&plain[0].readings) {
                for (a, b) in entries(one).into_iter().zip(entries(other)) {
                    // Rounding of the interpolation and of the correction, in the other order, over some thousand steps.
                    assert!((a - b).abs() <= 1e-11 * b.abs().max(1.0), "{a} {b}");
                }
            }
        }
    }
}
