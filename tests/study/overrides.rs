//! `--set` statements.

use super::sources::shipped;
use reeldown::descent::Model;
use reeldown::error::Error;
use reeldown::physics::design::Target;
use reeldown::physics::parameters::Parameter;
use reeldown::reliability::adaptive::Until;

#[test]
fn property_an_override_reaches_every_part_of_a_study() {
    let study = shipped(&[
        "initial.temperature=\"0 °F\"",
        "fluid.nominal_viscosity = 30000 cSt",
        "reel.inertia=31 kg·m²",
        "brake.gap=0.065 in",
        "brake.gap[2]=0.066 in",
        "model=quasi-steady",
        "title=another",
        "sampling.samples=1e6",
        "sampling.seed=7",
        "limits.time.max=200 s",
        "limits.peak_tension={max=\"40 kN\"}",
        "requirement.reliability=99.9 %",
        "brake.gap.sd=0.004 in",
        "initial.temperature.upper=\"90 °F\"",
        "reliability.methods=[\"form\"]",
    ])
    .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.design.get(Parameter::InitialTemperature), 459.67 / 1.8);
    assert_eq!(study.design.get(Parameter::FluidNominalViscosity), 0.03);
    assert_eq!(study.design.get(Parameter::ReelInertia), 31.0);
    assert_eq!(study.design.gaps()[0], 0.065 * 0.0254);
    assert_eq!(study.design.gaps()[1], 0.066 * 0.0254);
    assert_eq!(study.model, Model::QuasiSteady);
    assert_eq!(study.title, "another");
    assert_eq!((study.sampling.samples, study.sampling.seed), (1_000_000, 7));
    assert_eq!(study.limits[0].value, 200.0);
    assert_eq!(study.limits.len(), 4);
    assert_eq!(study.requirement.map(|requirement| requirement.reliability), Some(0.999));
    let gap = study.inputs.iter().find(|input| input.target == Target::gap(0)).expect("a gap");
    assert!(gap.law_text.contains("sd 0.004 in"));
    let temperature = study.inputs.last().expect("inputs");
    assert_eq!(temperature.marginal.upper(), Some((90.0 + 459.67) / 1.8));
    // The nominal value moved; the samples still follow the card, and the study says so.
    let about = |path: &str| {
        study.notes.iter().any(|note| note.starts_with(path) && note.contains("nominal"))
    };
    assert!(about("initial.temperature =") && about("brake.gap ="), "{:?}", study.notes);
    assert_eq!(study.overrides.len(), 15);
}

#[test]
fn property_a_limit_that_an_option_moves_does_not_come_from_where_the_file_says() {
    let source = |overrides: &[&str]| {
        let study = shipped(overrides).unwrap_or_else(|error| panic!("{error}"));
        study.limits[0].source.clone()
    };
    assert!(source(&[]).is_some_and(|source| source.starts_with("paper")));
    assert_eq!(source(&["limits.time.max=200 s"]), None);
    let own = Some("my own".to_owned());
    assert_eq!(source(&["limits.time.source=my own"]), own);
    assert_eq!(source(&["limits.time.max=200 s", "limits.time.source=my own"]), own);
    assert_eq!(source(&["limits.time={max=\"200 s\", source=\"my own\"}"]), own);
    // The other side of the limit is still the file's.
    let study = shipped(&["limits.time.min=60 s"]).expect("a study");
    let sources: Vec<bool> = study.limits.iter().take(2).map(|l| l.source.is_some()).collect();
    assert_eq!(sources, [true, false]);
}

#[test]
fn property_fewer_rotors_have_fewer_uncertain_gaps() {
    assert_eq!(shipped(&["brake.rotors=2"]).expect("a study").inputs.len(), 4 + 14);
}

#[test]
fn property_the_last_of_two_overrides_wins() {
    let study = shipped(&["brake.gap=0.07 in", "brake.gap=0.06 in"]).expect("a study");
    assert_eq!(study.design.get(Parameter::BrakeGap), 0.06 * 0.0254);
}

#[test]
fn property_samples_and_until_take_each_others_place() {
    // The shipped study says samples = 100_000; its requirement, 0.99 at 0.90.
    let until = "sampling.until={decided=true, budget=5_000}";
    let plan = shipped(&[until]).expect("a study").sampling;
    let stopping = plan.stopping.expect("a rule");
    assert_eq!((plan.samples, stopping.confidence), (5000, 0.9));
    assert_eq!(stopping.until, Until::Decided { allowed: 1.0 - 0.99 });
    let plan = shipped(&[until, "sampling.samples=7000"]).expect("a study").sampling;
    assert_eq!((plan.samples, plan.stopping.is_some()), (7000, true));
    let parts = ["sampling.until.relative_error=5 %", "sampling.until.budget=1e6"];
    let plan = shipped(&parts).expect("a study").sampling;
    let stopping = plan.stopping.expect("a rule");
    assert_eq!((plan.samples, stopping.until), (1_000_000, Until::RelativeError(0.05)));
    let digests = [&[until][..], &parts, &[]].map(|set| shipped(set).expect("a study").digest());
    assert!(digests[0] != digests[1] && digests[1] != digests[2] && digests[0] != digests[2]);
    let error = shipped(&["sampling.until.buget=3"]).expect_err("a misspelling");
    assert!(error.to_string().ends_with("did you mean `sampling.until.budget`?"), "{error}");
}

#[test]
fn regression_bad_overrides_are_shown_in_the_options_text() {
    for (statement, message) in [
        (
            "brake.gap",
            "--set:1:1: there is no `=`: expected PATH=VALUE, such as initial.temperature=\"0 °F\"",
        ),
        (
            "=3",
            "--set:1:1: there is no path before the `=`: expected PATH=VALUE, such as initial.temperature=\"0 °F\"",
        ),
        (
            "brake.gap=",
            "--set:1:10: there is no value after the `=`: expected PATH=VALUE, such as initial.temperature=\"0 °F\"",
        ),
        (
            "brake.gpa=0.062 in",
            "--set:1:1: unknown path `brake.gpa`: expected a design key, a key of the study file or a key of the card; did you mean `brake.gap`?",
        ),
        (
            "brake.gap=0.062 inn",
            "--set:1:17: unknown unit `inn`: expected a length, such as \"0.062 in\"; did you mean `in`?",
        ),
        (
            "payload.weight=\"6000 lb\"",
            "--set:1:22: `lb` is a unit of a mass: expected a force, such as \"6000 lbf\"; lb is a mass; write lbf",
        ),
        (
            "brake.gap=\"0.062 in",
            "--set:1:11: this is not a TOML value: expected a number, a text, true, false, a list or a table",
        ),
        (
            "sampling.sample=3",
            "--set:1:1: unknown path `sampling.sample`: expected a design key, a key of the study file or a key of the card; did you mean `sampling.samples`?",
        ),
        (
            "sampling.samples=lots",
            "--set:1:18: this is a string: expected a whole number from 1 to 1125899906842624, such as 100_000",
        ),
        (
            "limits.tim.max=1 s",
            "--set:1:1: unknown outcome `tim` in [limits]: expected one of `time`, `final_velocity`, `peak_fluid_temperature`, `peak_tension`, `peak_reel_speed`, `peak_power`, `peak_velocity`, `final_fluid_temperature`, `final_rotor_temperature`, `final_housing_temperature`; did you mean `time`?",
        ),
        (
            "limits.time.max.x=1",
            "--set:1:1: unknown path `limits.time.max.x`: expected a design key, a key of the study file or a key of the card; did you mean `limits.time.max`?",
        ),
        (
            "brake.gap.std=1 mm",
            "--set:1:1: unknown path `brake.gap.std`: expected a design key, a key of the study file or a key of the card; did you mean `brake.gap.sd`?",
        ),
        ("brake.gap.sd=-1 mm", "--set:1:14: sd = -1 mm is impossible: expected a positive number"),
        (
            "reel.inertia.sd=1",
            "--set:1:1: reel.inertia lacks the key `law`: expected law = \"normal\", or another law",
        ),
        (
            "card=absent.toml",
            "--set:1:6: cannot read the card absent.toml: no such file: expected a card file, relative to the working directory",
        ),
    ] {
        let answer = shipped(&[statement]);
        let error = answer.err().unwrap_or_else(|| panic!("{statement} was accepted"));
        assert_eq!(error.to_string(), message, "{statement}");
        let Error::Input(diagnostic) = error else { panic!("{statement}: not a diagnostic") };
        assert_eq!(diagnostic.text, statement);
    }
}
