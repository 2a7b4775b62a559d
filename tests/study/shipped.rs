//! What the shipped study and card mean, and what good texts are read as.

use super::sources::{card_alone, shipped, study_with};
use reeldown::descent::{Model, Outcome, OutcomeQuantity};
use reeldown::physics::design::{Design, Target};
use reeldown::physics::parameters::Parameter;
use reeldown::study::{Grade, Known, LimitKind, Study, TighteningCost};
use reeldown::uncertainty::{Law, Marginal};

const INCH: f64 = 0.0254;
const POUND: f64 = 4.448_221_615_260_5;

#[test]
fn published_the_embedded_study_is_the_papers_case() {
    let study = Study::load(None, &[]).expect("the embedded study is good");
    assert_eq!(study.title, "HABE reel-down, launch day");
    assert_eq!(study.model, Model::Dynamic);
    assert_eq!(study.design, Design::baseline());
    let limits: Vec<(OutcomeQuantity, LimitKind, f64)> =
        study.limits.iter().map(|limit| (limit.outcome, limit.kind, limit.value)).collect();
    let max = LimitKind::Max;
    assert_eq!(
        limits,
        [
            (OutcomeQuantity::Time, max, 210.0),
            (OutcomeQuantity::FinalVelocity, max, 2.5 * 0.3048),
            (OutcomeQuantity::PeakFluidTemperature, max, (450.0 + 459.67) / 1.8),
        ]
    );
    let requirement = study.requirement.expect("a requirement");
    assert_eq!((requirement.reliability, requirement.confidence), (0.99, 0.90));
    assert_eq!((study.sampling.samples, study.sampling.seed), (100_000, 1993));
    assert_eq!(study.sampling.replicates, 1);
    assert!(study.notes.is_empty(), "{:?}", study.notes);
    // The design question of the paper: which nominal viscosity?
    let [range] = &study.tighten.design[..] else { panic!("one design value moves") };
    assert_eq!(range.target.path(), "fluid.nominal_viscosity");
    assert!(range.lower < 0.103 && 0.125 < range.upper);
}

#[test]
fn published_the_card_is_the_table_of_what_is_uncertain() {
    let study = Study::load(None, &[]).expect("the embedded study is good");
    assert_eq!(study.inputs.len(), 28);
    assert!(study.joint.is_independent());
    let gap = Marginal::new(
        Law::normal(0.062 * INCH, 0.003 * INCH).expect("a law"),
        Some(0.053 * INCH),
        Some(0.071 * INCH),
    )
    .expect("a marginal");
    let gaps = study.inputs.iter().filter(|i| i.target.parameter == Parameter::BrakeGap);
    for (surface, input) in gaps.enumerate() {
        assert_eq!(input.target, Target::gap(surface));
        assert_eq!(input.marginal, gap);
        assert_eq!(input.known, Known::AtBuild);
        assert_eq!(input.group.as_deref(), Some("brake.gap"));
    }
    let lognormal =
        |median, cv| Marginal::untruncated(Law::lognormal_median_cv(median, cv).expect("a law"));
    let of = |parameter| {
        let target = Target::whole(parameter);
        let input = study.inputs.iter().find(|input| input.target == target);
        input.unwrap_or_else(|| panic!("{} is uncertain", target.path())).marginal.clone()
    };
    assert_eq!(of(Parameter::FluidShearFactor), lognormal(1.0, 0.08));
    assert_eq!(of(Parameter::ThermalFluidCapacity), lognormal(3990.0, 0.08));
    assert_eq!(of(Parameter::ThermalRotorCapacity), lognormal(21_100.0, 0.08));
    assert_eq!(of(Parameter::ThermalHousingCapacity), lognormal(14_600.0, 0.08));
    assert_eq!(of(Parameter::ThermalFluidRotorConductance), lognormal(680.0, 0.15));
    assert_eq!(of(Parameter::ThermalFluidHousingConductance), lognormal(47.5, 0.15));
    assert_eq!(of(Parameter::ThermalRotorHousingConductance), lognormal(9.5, 0.15));
    let normal = |mean, sd| Law::normal(mean, sd).expect("a law");
    assert_eq!(of(Parameter::FluidAveragingOffset), Marginal::untruncated(normal(0.0, 0.1)));
    // What the paper's design chose or took, to the tolerances of the trades.
    for (parameter, mean, sd) in [
        (Parameter::BrakeOuterRadius, 8.5 * INCH, 0.2e-3),
        (Parameter::FluidViscosityTemperature, 1740.0, 8.0),
        (Parameter::ReelFullRadius, 11.0 * INCH, 0.04 * INCH),
        (Parameter::PayloadWeight, 6000.0 * POUND, 30.0 * POUND),
    ] {
        assert_eq!(of(parameter), Marginal::untruncated(normal(mean, sd)), "{parameter:?}");
    }
    let lot = Marginal::new(normal(1.0, 0.025), Some(0.95), Some(1.05)).expect("a marginal");
    assert_eq!(of(Parameter::FluidLotFactor), lot);
    let kelvin = |fahrenheit: f64| (fahrenheit + 459.67) / 1.8;
    let start =
        Marginal::new(normal(kelvin(60.0), 10.0 / 1.8), Some(kelvin(0.0)), Some(kelvin(100.0)));
    assert_eq!(of(Parameter::InitialTemperature), start.expect("a marginal"));
}

#[test]
fn published_every_limit_of_the_shipped_studies_states_its_source() {
    let calibrated = include_str!("../../reports/calibrated/study.toml");
    let of_embedded = Study::load(None, &[]).expect("the embedded study is good").limits;
    for (outcome, begins) in [
        (OutcomeQuantity::Time, "paper: "),
        (OutcomeQuantity::PeakFluidTemperature, "paper: "),
        // The paper states no value: this one is invented, and a reader of the report must see that.
        (OutcomeQuantity::FinalVelocity, "assumed: "),
    ] {
        let limit = of_embedded.iter().find(|limit| limit.outcome == outcome).expect("a limit");
        assert!(limit.source_text().starts_with(begins), "{}", limit.source_text());
        assert!(calibrated.contains(limit.source_text()), "{}", limit.source_text());
    }
}

#[test]
fn property_tolerances_can_be_bought_and_the_weather_and_the_model_s_error_cannot() {
    let study = Study::load(None, &[]).expect("the embedded study is good");
    for input in &study.inputs {
        let nobody_sells = ["initial.temperature", "fluid.averaging_offset"];
        let expected = match nobody_sells.contains(&input.target.path().as_str()) {
            true => TighteningCost::None,
            false => TighteningCost::PerHalving(1.0),
        };
        assert_eq!(input.cost, expected, "{}", input.target.path());
    }
}

/// The mean and the standard deviation of an input's law, SI.
fn law(study: &Study, target: Target) -> (f64, f64) {
    let input = study.inputs.iter().find(|input| input.target == target).expect("uncertain");
    (input.marginal.mean(), input.marginal.sd())
}

#[test]
fn property_a_law_about_the_nominal_value_goes_where_the_design_goes() {
    let weight = Target::whole(Parameter::PayloadWeight);
    let moved = shipped(&["payload.weight=5500 lbf"]).expect("a study");
    assert_eq!(law(&moved, weight), (5500.0 * POUND, 30.0 * POUND));
    // Nothing is to be said of a law that goes along, and it is the law with that mean written out.
    assert!(moved.notes.is_empty(), "{:?}", moved.notes);
    let written = shipped(&["payload.weight=5500 lbf", "payload.weight.mean=5500 lbf"]);
    assert_eq!(moved.digest(), written.expect("a study").digest());
    assert_ne!(moved.digest(), shipped(&[]).expect("a study").digest());
    // A law with a mean of its own stays, and says so.
    let own = shipped(&["payload.weight=5500 lbf", "payload.weight.mean=6000 lbf"]);
    let own = own.expect("a study");
    assert_eq!(law(&own, weight), (6000.0 * POUND, 30.0 * POUND));
    assert!(own.notes.iter().any(|note| note.starts_with("payload.weight = 5500 lbf")));
    // A surface with a gap of its own has its law about that.
    let gap = "[brake.gap]\nlaw = \"normal\"\nmean = \"nominal\"\ncv = \"5 %\"\neach_surface = true\n\
               known = \"at build\"\nsource = \"x\"\n";
    let text = "title = \"x\"\ncard = \"card.toml\"\n[design]\n\"brake.gap[3]\" = \"0.07 in\"\n";
    let study = study_with(text, gap, &[]).expect("a study");
    assert_eq!(law(&study, Target::gap(2)), (0.07 * INCH, 0.05 * (0.07 * INCH)));
    assert_eq!(law(&study, Target::gap(3)), (0.062 * INCH, 0.05 * (0.062 * INCH)));
    // The mean alone can be so written.
    let wrong = shipped(&["payload.weight.sd=nominal"]).expect_err("no spread").to_string();
    assert!(wrong.contains("expected a force"), "{wrong}");
}

#[test]
fn property_margins_are_negative_beyond_the_limit() {
    let study = shipped(&["limits.time.min=1 min"]).expect("a study");
    let mut outcome = Outcome { deployed: true, values: [0.0; 10] };
    outcome.values[OutcomeQuantity::Time as usize] = 215.0;
    let margins: Vec<(String, f64)> =
        study.limits.iter().take(2).map(|limit| (limit.name(), limit.margin(&outcome))).collect();
    assert_eq!(margins, [("time".to_owned(), -5.0), ("time_min".to_owned(), 155.0)]);
    assert_eq!(study.limits[0].margin_column(), "time_margin_s");
    // A descent that did not deploy carries the time limit of a descent.
    outcome.deployed = false;
    outcome.values[OutcomeQuantity::Time as usize] = reeldown::descent::outcome::TIME_LIMIT_S;
    assert!(study.limits[0].margin(&outcome) < 0.0);
}

#[test]
fn property_every_spelling_of_a_study_is_read() {
    let study = study_with(include_str!("accepted/study_full.toml"), "", &[]).expect("a study");
    assert_eq!(study.model, Model::QuasiSteady);
    assert_eq!(study.design.surfaces(), 6);
    assert_eq!(study.design.gaps()[5], 0.065 * INCH);
    assert_eq!(study.design.gaps()[0], 0.062 * INCH);
    assert_eq!(study.design.get(Parameter::BalloonFreeLift), 0.06);
    assert_eq!(study.design.get(Parameter::BalloonMass), 2200.0 * 0.453_592_37);
    assert_eq!(study.limits.len(), 11);
    assert_eq!(study.requirement.map(|requirement| requirement.reliability), Some(0.9973));
    assert_eq!(study.inputs.len(), 6 + 9);
    assert_eq!((study.trade.samples, study.tighten.samples), (5000, 10_000));
    assert_eq!(study.tighten.target, Some(0.01));
    let ranges: Vec<(String, f64, f64)> =
        study.tighten.design.iter().map(|r| (r.target.path(), r.lower, r.upper)).collect();
    let lift = ("balloon.free_lift".to_owned(), 0.04, 0.07);
    assert_eq!(ranges[1], lift);
    // cSt are 1e-6 m²/s; one rounding each.
    assert!((ranges[0].1 / 0.09 - 1.0).abs() < 1e-15 && (ranges[0].2 / 0.14 - 1.0).abs() < 1e-15);
    assert!(
        study.notes.iter().any(|note| note.contains("initial.temperature")),
        "{:?}",
        study.notes
    );
    assert!(study.validate().is_ok());
}

#[test]
fn property_every_law_is_read() {
    let study = card_alone(include_str!("accepted/card_laws.toml")).expect("a card");
    assert_eq!(study.inputs.len(), 14 + 17);
    assert!(study.inputs.windows(2).all(|pair| pair[0].target < pair[1].target));
    let of = |target: Target| {
        let found = study.inputs.iter().find(|input| input.target == target);
        found.unwrap_or_else(|| panic!("{} is uncertain", target.path()))
    };
    let whole = |parameter| of(Target::whole(parameter)).marginal.clone();
    let cost = |parameter| of(Target::whole(parameter)).cost.clone();
    let grade = |spread, cost| Grade { spread, cost };
    let grades = TighteningCost::Grades(vec![grade(0.5, 100.0), grade(0.2, 400.0)]);
    assert_eq!(cost(Parameter::BrakeOuterRadius), grades);
    assert_eq!(cost(Parameter::BrakeInnerRadius), TighteningCost::None);
    assert_eq!(cost(Parameter::BalloonDragArea), TighteningCost::PerHalving(1.0));
    assert_eq!(of(Target::gap(4)).cost, TighteningCost::PerHalving(250.0));
    assert_eq!(of(Target::gap(2)).group.as_deref(), Some("measured"));
    assert_eq!(of(Target::gap(3)).marginal.mean(), 0.0016);
    assert_eq!(of(Target::gap(4)).group.as_deref(), Some("brake.gap"));
    // Moments about a location, by the definitions of the laws; 1e-12 is a hundred roundings.
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
    let added = whole(Parameter::BalloonAddedMass);
    assert!(close(added.mean(), 2000.0) && close(added.sd(), 200.0));
    let drag = whole(Parameter::BalloonDragArea);
    assert!(close(drag.mean(), 500.0) && close(drag.sd(), 50.0));
    assert_eq!(drag.support().0, 450.0);
    let housing = whole(Parameter::ThermalHousingCapacity);
    assert!(close(housing.mean(), 14_600.0) && close(housing.sd(), 1000.0));
    assert_eq!(study.correlations.len(), 3);
    assert!(!study.joint.is_independent());
    let places: Vec<(usize, usize)> = study.correlations.iter().map(|c| c.between).collect();
    // Both radii come before the gaps.
    assert!(places.contains(&(2, 4)), "{places:?}");
}

#[test]
fn property_one_statement_correlates_every_two_surfaces() {
    let study = card_alone(include_str!("accepted/card_correlated_gaps.toml")).expect("a card");
    assert_eq!(study.correlations.len(), 14 * 13 / 2);
}

#[test]
fn property_the_digest_sees_numbers_and_not_their_spelling() {
    let digest = |text: &str| study_with(text, "", &[]).expect("a study").digest();
    let base = "title = \"a\"\ncard = \"habe.toml\"\n[limits]\ntime = { max = \"210 s\" }\n";
    let respelt = "# b\ncard = [\"habe.toml\"]\ntitle = \"b\"\nlimits.time.max = \"3.5 min\"\nmodel = \"dynamic\"\n";
    assert_eq!(digest(base), digest(respelt));
    let sourced = base.replace("210 s\" }", "210 s\", source = \"paper\" }");
    assert_ne!(sourced, base);
    assert_eq!(digest(base), digest(&sourced));
    for change in [
        "limits.time.max=211 s",
        "sampling.seed=7",
        "numerics.tolerance=1e-7",
        "brake.gap[3]=0.063 in",
        "model=quasi-steady",
        "brake.gap.sd=0.004 in",
        "fluid.shear_factor.known=at build",
        "requirement={reliability=0.9, confidence=0.9}",
        "sensitivity.bootstrap=100",
    ] {
        let changed = study_with(base, "", &[change]).expect(change);
        assert_ne!(changed.digest(), digest(base), "{change}");
    }
    let study = study_with(base, "", &[]).expect("a study");
    let files = study.file_digests();
    assert_eq!(files.len(), 2);
    assert!(files.iter().all(|(_, digest)| digest.len() == 64));
}

#[test]
fn property_later_cards_win_input_by_input() {
    let own = "[fluid.shear_factor]\nlaw = \"uniform\"\nlower = 0.9\nupper = 1.1\nknown = \"never\"\nsource = \"b\"\n";
    let text = "title = \"a\"\ncard = [\"habe.toml\", \"card.toml\"]\n";
    let study = study_with(text, own, &[]).expect("a study");
    assert_eq!(study.inputs.len(), 23);
    let shear = Target::whole(Parameter::FluidShearFactor);
    let input = study.inputs.iter().find(|input| input.target == shear).expect("an input");
    assert_eq!((input.marginal.support(), input.source.as_str()), ((0.9, 1.1), "b"));
}

#[test]
fn property_every_parameter_is_listed_with_its_source() {
    let study = shipped(&["initial.temperature=0 °F", "brake.gap[3]=0.07 in"]).expect("a study");
    let rows = study.resolved();
    assert_eq!(rows.len(), 37 + 1);
    let row = |path: &str| rows.iter().find(|row| row.path == path).expect("a row");
    assert_eq!(row("initial.temperature").text, "0 °F (255.372 K)");
    assert_eq!(row("initial.temperature").source, "--set: 0 °F");
    assert_eq!(row("brake.gap").uncertain.as_ref().map(|law| law.inputs), Some(14));
    assert_eq!(row("brake.gap[3]").text, "0.07 in (0.001778 m)");
    assert_eq!(row("fluid.viscosity_temperature").text, "1740 K");
    assert!(row("fluid.nominal_viscosity").source.contains("study.toml"));
    assert_eq!(row("reel.inertia").source, "assumed");
}

#[test]
fn property_impossible_draws_are_foretold() {
    let card = "[fluid.density]\nlaw = \"normal\"\nmean = \"970 kg/m³\"\nsd = \"500 kg/m³\"\nknown = \"never\"\nsource = \"a\"\n";
    let study = card_alone(card).expect("a study");
    assert!(study.notes.iter().any(|note| note.contains("impossible")), "{:?}", study.notes);
}

#[test]
fn property_studies_are_read_from_files() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join("reports/habe/study.toml");
    let study = Study::load(Some(&path), &[]).expect("the published study");
    let embedded = Study::load(None, &[]).expect("the embedded study");
    assert_eq!(study.digest(), embedded.digest());
    assert_eq!(study.study_text, embedded.study_text);
    assert_eq!(study.card_texts[0].1, embedded.card_texts[0].1);
    let missing = Study::load(Some(&root.join("reports/habe/absent.toml")), &[]);
    let message = missing.expect_err("no such study").to_string();
    assert!(message.starts_with("cannot read") && message.contains("no such file"), "{message}");
}

#[test]
fn property_readings_predict_the_law() {
    let study = card_alone(include_str!("accepted/card_readings.toml")).expect("a card");
    let of = |parameter| {
        let target = Target::whole(parameter);
        study.inputs.iter().find(|input| input.target == target).expect("uncertain")
    };
    let gap = study.inputs.iter().find(|input| input.target == Target::gap(0)).expect("a gap");
    assert_eq!(gap.marginal.law().family(), "Student's t");
    assert_eq!(gap.marginal.support(), (0.053 * 0.0254, 0.071 * 0.0254));
    assert!(
        gap.law_text.starts_with("what 5 normal readings predict, mean 0.062 in ("),
        "{}",
        gap.law_text
    );
    assert_eq!(gap.readings.as_ref().map(|readings| readings.count()), Some(5));
    assert_eq!(
        of(Parameter::FluidShearFactor).marginal.law().family(),
        "Student's t of the logarithm"
    );
    // σ √(1 + 1/n) of a known σ.
    let capacity = of(Parameter::ThermalFluidCapacity).marginal.law().spread();
    assert!((capacity - 0.03 * 1.5_f64.sqrt()).abs() < 1e-15);
    let temperature = of(Parameter::InitialTemperature).marginal.clone();
    assert!((temperature.sd() - 8.0 / 1.8 * 2.0_f64.sqrt()).abs() < 1e-12);
    let other = include_str!("accepted/card_readings.toml").replace("0.98", "0.97");
    assert_ne!(study.digest(), card_alone(&other).expect("a card").digest());
}

#[test]
fn property_the_most_demanding_requirement_that_is_read_can_be_judged() {
    use reeldown::reliability::demonstration::{Requirement, minimum_samples};
    let share = 1.0 - 1e-12;
    let set = ["requirement.reliability=0.999999999999", "requirement.confidence=0.999999999999"];
    assert_eq!(
        super::sources::shipped(&set).expect("a study").requirement.map(|r| r.reliability),
        Some(share)
    );
    for failures in 0..=20 {
        assert!(minimum_samples(share, share, failures).is_ok(), "{failures}");
    }
    let counts =
        reeldown::reliability::probability::Proportion::new(0, 0, 100_000).expect("counts");
    Requirement::new(share, share).and_then(|r| r.verdict(&counts)).expect("a verdict");
}

#[test]
fn property_a_group_of_one_input_is_that_input() {
    // The pair's index used to be lost without a word: a factor of one input has no group beside it.
    let card = include_str!("../fixtures/habe/card.toml");
    let study = "title = \"x\"\ncard = [\"habe.toml\", \"card.toml\"]\n[sensitivity]\n\
                 pairs = [[\"law\", \"initial.temperature\"]]\n";
    let shear = "[fluid.shear_factor]\nlaw = \"lognormal\"\nmedian = 1\ncv = \"8 %\"\n\
                 group = \"law\"\nknown = \"never\"\nsource = \"x\"\n";
    assert!(card.contains("[fluid.shear_factor]"));
    let study = super::sources::study_with(study, shear, &[]).expect("a study");
    let pair = ("fluid.shear_factor".to_owned(), "initial.temperature".to_owned());
    assert_eq!(study.sensitivity.pairs, [pair]);
}

#[test]
fn analytic_an_empirical_law_reads_its_column_in_its_unit() {
    let card = |column: &str| {
        format!(
            "[brake.gap]\nlaw = \"empirical\"\nfile = \"measured.csv\"\ncolumn = \"{column}\"\n\
                 known = \"at build\"\nsource = \"x\"\n"
        )
    };
    for (column, unit_m) in [("gap [in]", 0.0254), ("gap [mil]", 0.0254 * 1e-3 * 1e3 / 1e3)] {
        let study = card_alone(&card(column)).expect(column);
        let (low, high) = study.inputs[0].marginal.support();
        let of = if column == "gap [in]" { (0.061, 0.064) } else { (61.0, 64.0) };
        assert!((low / (of.0 * unit_m) - 1.0).abs() < 1e-15, "{column}: {low}");
        assert!((high / (of.1 * unit_m) - 1.0).abs() < 1e-15, "{column}: {high}");
    }
}

#[test]
fn property_every_bare_number_with_a_dimension_is_refused() {
    use reeldown::physics::parameters::PARAMETERS;
    use reeldown::study::Over;
    use reeldown::units::Quantity;
    let message = |error: reeldown::error::Error| error.to_string();
    for info in &PARAMETERS {
        let answers = [
            super::sources::shipped(&[&format!("{}=1", info.path)]).map(|_| ()).map_err(message),
            Over::parse("--over", &format!("{}=1..2:3", info.path)).map(|_| ()).map_err(message),
        ];
        for answer in answers {
            let bare = answer.is_err_and(|message| message.contains("has no unit"));
            assert_eq!(bare, info.quantity != Quantity::Number, "{}", info.path);
        }
    }
    for outcome in reeldown::descent::OutcomeQuantity::ALL {
        let limit = format!("limits.{}.max=400", outcome.name());
        let error = super::sources::shipped(&[&limit]).expect_err(&limit).to_string();
        assert!(error.contains("400 has no unit"), "{error}");
    }
}

#[test]
fn property_observed_values_are_read_beside_their_card() {
    let directory = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("observed");
    std::fs::create_dir_all(directory.join("cards")).expect("a directory");
    let write = |name: &str, text: &str| std::fs::write(directory.join(name), text).expect(name);
    write("study.toml", "title = \"observed\"\ncard = \"cards/card.toml\"\n");
    write(
        "cards/card.toml",
        "[brake.gap]\nlaw = \"empirical\"\nfile = \"gaps.csv\"\ncolumn = \"gap_m\"\neach_surface = true\nknown = \"at build\"\nsource = \"measured\"\n",
    );
    write("cards/gaps.csv", "surface,gap_m\n1,0.0015\n2,0.0017\n");
    let load = || Study::load(Some(&directory.join("study.toml")), &[]);
    let study = load().expect("a study");
    assert_eq!(study.inputs.len(), 14);
    // The mean of two values is one rounding from exact.
    assert!((study.inputs[0].marginal.mean() - 0.0016).abs() < 1e-18);
    write("cards/gaps.csv", "surface,gap_m\n1,0.0015\n2,-0.0017\n");
    let message = load().expect_err("an impossible gap").to_string();
    assert!(message.contains("card.toml:3:8: gaps.csv holds -0.0017"), "{message}");
    write("cards/gaps.csv", "surface,gap_m\n1,none\n");
    let message = load().expect_err("no number").to_string();
    assert!(message.contains("line 2: \"none\" is not a finite number"), "{message}");
}
