//! The measures beside the Sobol' indices: what the findings say of each, and the derivatives.

use crate::sample::{independent, replicated};
use reeldown::campaign;
use reeldown::descent::OutcomeQuantity;
use reeldown::physics::{Parameter, Target};
use reeldown::render;

/// Indices that cannot be negative, whose estimates can.
const NEVER_NEGATIVE: [&str; 7] = [
    "first_order",
    "target_first_order",
    "borgonovo_delta",
    "pawn",
    "hsic",
    "target_hsic",
    "conditional_hsic",
];

#[test]
fn property_every_index_has_an_interval_or_says_why_and_a_negative_one_is_explained() {
    let measures = &independent().findings.measures;
    let names: Vec<String> =
        measures.outputs.iter().map(|output| output.name.to_string()).collect();
    assert_eq!(
        names,
        [
            "time",
            "final_velocity",
            "peak_fluid_temperature",
            "breach.time",
            "breach.final_velocity",
            "breach.peak_fluid_temperature",
            "breach.any"
        ]
    );
    let mut negative = 0;
    for output in &measures.outputs {
        let wanted = if output.breach { 5 } else { 10 };
        assert_eq!(output.indices.len(), wanted, "{}", output.name);
        for column in &output.indices {
            assert_eq!(column.estimates.len(), measures.factors.len());
            for (k, estimate) in column.estimates.iter().enumerate() {
                let earned = estimate.interval.interval().is_some();
                assert!(earned || column.note(k).is_some(), "{} {k}", column.index);
                let below = estimate.value.is_some_and(|value| value < 0.0);
                if below && NEVER_NEGATIVE.contains(&column.index) {
                    negative += 1;
                    assert!(column.explanations[k].is_some(), "{} {k}", column.index);
                }
            }
            let tested = ["hsic", "target_hsic", "conditional_hsic", "conditional_distance"];
            assert_eq!(
                tested.contains(&column.index),
                !column.p_values.is_empty(),
                "{}",
                column.index
            );
        }
    }
    assert!(negative > 0, "noise alone makes some negative, and none is clipped");
    // The rare events happened to none of 600 samples: no number, and the reason.
    let rare = &measures.outputs[5].indices;
    assert!(
        rare.iter().all(|column| column.estimates.iter().all(|estimate| estimate.value.is_none()))
    );
}

#[test]
fn property_the_ranking_is_of_the_outcome_that_is_breached_most_and_is_in_the_report() {
    let sample = independent();
    let ranking = sample.findings.measures.ranking.as_ref().unwrap();
    assert_eq!(ranking.output.to_string(), "time");
    // Those of two designs of their own, and eight of the run's samples.
    assert_eq!(ranking.measures[..2], ["Sobol' total", "Shapley"]);
    assert_eq!(ranking.measures.len(), 10);
    assert_eq!(ranking.rows.len(), 10);
    for measure in 0..ranking.measures.len() {
        let mut ranks: Vec<usize> = ranking.rows.iter().map(|row| row.ranks[measure]).collect();
        ranks.sort_unstable();
        assert_eq!(ranks, (1..=10).collect::<Vec<_>>());
    }
    assert!((0.5..=1.0).contains(&ranking.concordance.unwrap()));
    let figures = render::figures(&sample.findings);
    for text in [
        render::markdown(&sample.findings, &figures).unwrap(),
        render::html(&sample.findings, &figures).unwrap(),
    ] {
        assert!(text.contains("Do other measures agree on the ranking?"));
        assert!(text.contains("What does a small step do?") && text.contains("1000 cSt"));
    }
    let none = &replicated().findings.measures;
    assert!(none.none.is_some() && none.ranking.is_none() && none.outputs.is_empty());
    assert_eq!(none.local.outcomes.len(), 3, "derivatives need no samples");
}

#[test]
fn reference_radau_the_derivatives_are_the_differences_of_the_plain_integrator() {
    let local = &independent().findings.measures.local;
    let study = crate::habe::pinned(&[]);
    let time = &local.outcomes[0];
    assert_eq!(time.name, "time");
    for (path, target, step) in [
        ("initial.temperature", Target::whole(Parameter::InitialTemperature), 0.05),
        ("fluid.nominal_viscosity", Target::whole(Parameter::FluidNominalViscosity), 1e-4),
        ("brake.gap", Target::whole(Parameter::BrakeGap), 2e-6),
    ] {
        let place = local.targets.iter().position(|target| target.path == path).unwrap();
        let at = |sign: f64| {
            let mut moved = study.clone();
            moved.design.set(target, study.design.at(target) + sign * step);
            campaign::nominal(&moved).unwrap().get(OutcomeQuantity::Time)
        };
        let difference = (at(1.0) - at(-1.0)) / (2.0 * step);
        let slope = time.nominal[place].unwrap();
        // Steps of about 1e-4 to 1e-3 of a value: h²/6 of the third derivative is below 1e-5 of the first; the kernel
        // keeps 1e-6 of the time, and its derivative a hundredfold of that at worst.
        assert!((slope / difference - 1.0).abs() < 1e-3, "{path}: {slope} {difference}");
        let mean = time.mean[place].unwrap();
        assert!((mean / slope - 1.0).abs() < 0.1, "the means are near the nominal values: {path}");
    }
}

#[test]
fn regression_what_is_taken_as_exact_moves_the_answer_as_whole_runs_with_it_set_do() {
    let findings = &independent().findings;
    let change = |path: &str| {
        let value = findings.exact.values.iter().find(|value| value.path == path).unwrap();
        (value.change.value.unwrap(), value.change.standard_error.unwrap())
    };
    // `reeldown run --samples 100000 --set` one value 1 % larger, less the 40.485 % of the study as it is.
    for (path, truth) in [
        ("fluid.viscosity_temperature", 0.1534),
        ("brake.outer_radius", 0.1298),
        ("payload.weight", -0.0708),
        ("reel.full_radius", -0.0444),
        ("fluid.nominal_viscosity", 0.0309),
    ] {
        let (value, error) = change(path);
        // Two standard errors of the runs' own difference.
        assert!((value - truth).abs() < 4.5 * error + 0.003, "{path}: {value} ± {error}, {truth}");
    }
    // What no descent feels, and what cannot be moved by a share.
    assert_eq!(change("thermal.air_temperature").0, 0.0);
    let rotors = findings.exact.values.iter().find(|value| value.path == "brake.rotors").unwrap();
    assert!(rotors.change.value.is_none());
    // Every parameter of the design is in the table or in the card; the lot's factor is the nominal viscosity's own step.
    let listed = |path: &str| {
        findings.exact.values.iter().any(|value| value.path == path)
            || findings.inputs.iter().any(|input| input.path == path)
    };
    let parameters = reeldown::physics::parameters::PARAMETERS.iter().map(|info| info.path);
    assert_eq!(parameters.filter(|path| !listed(path)).collect::<Vec<_>>(), ["fluid.lot_factor"]);
    let alert = findings.exact.alert.as_deref().unwrap();
    assert!(
        alert.contains("`fluid.viscosity_temperature`") && !alert.contains("nominal_viscosity")
    );
    let report = render::markdown(findings, &render::figures(findings)).unwrap();
    assert!(
        report.contains("## What is taken as exact") && report.contains("ALERT: taken as exact")
    );
}
