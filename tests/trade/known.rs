//! What becomes known when.

use super::curves::study;
use reeldown::campaign::common_numbers::{Breaches, Change, CommonSample, Event};
use reeldown::campaign::known::{INNER, Second, run_known};
use reeldown::campaign::{Ensemble, Progress};
use reeldown::physics::{Parameter, Target};
use reeldown::streams::Purpose;
use reeldown::study::{Known, Override, Study};

#[test]
fn property_known_temperatures_average_to_the_probability() {
    let study = study(&["trade.samples=2000"]);
    let found = run_known(&study, &Progress::default()).expect("an answer").expect("one");
    assert_eq!(found.stages.len(), 2);
    assert_eq!((found.stages[0].known, found.stages[0].inputs), (Known::AtBuild, 14));
    assert_eq!((found.stages[1].known, found.stages[1].inputs), (Known::OnTheDay, 15));
    let mean = |stage: usize| {
        let sets = &found.stages[stage].breaches;
        sets.iter().map(|(b, _)| *b as f64).sum::<f64>() / (sets.len() * INNER) as f64
    };
    // The law of total probability, to the scatter of 100 sets; P is about 0.40.
    assert!(
        (mean(0) - 0.40).abs() < 0.05 && (mean(1) - 0.40).abs() < 0.15,
        "{} {}",
        mean(0),
        mean(1)
    );
    let [chart] = &found.charts[..] else { panic!("one input is measured on the day") };
    assert_eq!(chart.settings.len(), 21);
    // The launch temperature and the viscosity of the lot, for want of a second input measured on the day.
    let map = found.map.as_ref().expect("a map");
    let path = Target::whole(Parameter::FluidNominalViscosity);
    assert_eq!((map.input, map.beside), (chart.input, Second::Lot(path)));
    assert_eq!((map.first.len(), map.second.len(), map.breaches.len()), (11, 21, 231));
    // The middle lot is the study's, and the first points of the charts are the map's.
    assert_eq!(map.second[10], study.design.at(path));
    for (row, value) in map.first.iter().enumerate() {
        let cell = &map.breaches[row * 21 + 10];
        let (setting, breaches) = &chart.settings[2 * row];
        assert_eq!(setting, value);
        let same = breaches.counts(Event::Any, 0..map.samples as usize);
        assert_eq!(cell.count(Event::Any), same);
    }
    // A colder fluid is thicker: every descent of the same point takes longer.
    let late: Vec<u64> =
        chart.settings.iter().map(|(_, b)| b.count(Event::Limit(0)).breaches).collect();
    assert!(late.windows(2).all(|pair| pair[0] >= pair[1]), "{late:?}");
}

fn correlated() -> Study {
    let card = include_str!("../fixtures/habe/card.toml").to_owned()
        + "\n[[correlation]]\nbetween = [\"initial.temperature\", \"fluid.shear_factor\"]\nnormal = 0.9\nsource = \"test\"\n";
    struct One(String);
    impl reeldown::study::Files for One {
        fn card(&mut self, name: &str, _: bool) -> Result<reeldown::study::NamedText, String> {
            Ok(reeldown::study::NamedText { origin: name.into(), text: self.0.clone() })
        }
        fn sample(&mut self, _: &str, _: &str) -> Result<reeldown::study::SampleFile, String> {
            Err("none".into())
        }
    }
    let text =
        include_str!("../fixtures/habe/study.toml").replace("\"dynamic\"", "\"quasi-steady\"");
    let main = reeldown::study::NamedText { origin: "study.toml".into(), text };
    reeldown::study::assemble(&main, &[], &mut One(card)).expect("a study")
}

#[test]
fn analytic_a_known_value_moves_what_depends_on_it() {
    let study = correlated();
    let place = |path: &str| {
        study.inputs.iter().position(|input| input.target.path() == path).expect("an input")
    };
    let (temperature, shear) = (place("initial.temperature"), place("fluid.shear_factor"));
    let sets = CommonSample::independent(&study, 0..400, Purpose::Test).expect("a sample");
    let others = CommonSample::independent(&study, 400..800, Purpose::Test).expect("a sample");
    let mixed = sets.mixed(&[temperature], |k| k, &others).expect("draws");
    assert_eq!(mixed.column(temperature), sets.inputs().column(temperature));
    // In normal space the other follows with correlation 0.9: the residual has variance 1 − 0.81.
    let z = |column: usize, x: f64| study.inputs[column].marginal.to_standard_normal(x);
    let residual: f64 = (0..400)
        .map(|k| {
            let t = z(temperature, mixed.get(k, temperature));
            (z(shear, mixed.get(k, shear)) - 0.9 * t).powi(2)
        })
        .sum();
    // χ² with 400 degrees of freedom over 400 is within 0.3 of 1 but for 1 in 10⁵.
    assert!((residual / 400.0 / 0.19 - 1.0).abs() < 0.3, "{residual}");
    // A warm day then means a fluid that shears thicker: fewer fast descents than if they were independent.
    let change = Change { known: vec![(temperature, 295.0)], ..Change::default() };
    let given = sets.changed(&change, &Progress::default()).expect("breaches");
    assert_eq!(given.rows(), 400);
}

#[test]
fn property_a_measured_lot_has_no_tolerance_left() {
    let set = ["model=quasi-steady", "sampling.samples=20000", "trade.samples=2000"];
    let overrides = set.map(|text| Override::parse("--set", text).expect("an override"));
    let study = Study::load(None, &overrides).expect("the embedded study");
    let found = run_known(&study, &Progress::default()).expect("an answer").expect("one");
    let map = found.map.expect("a map");
    let nominal = Target::whole(Parameter::FluidNominalViscosity);
    assert_eq!(map.beside, Second::Lot(nominal));
    let place = |path: &str| {
        study.inputs.iter().position(|input| input.target.path() == path).expect("an input")
    };
    let sample = CommonSample::independent(&study, 0..map.samples, Purpose::Known);
    let sample = sample.expect("a sample");
    for (row, column) in [(3, 5), (5, 10), (8, 14)] {
        // The same draws with the two values written over theirs: the nominal viscosity of a lot that is just that.
        let mut draws = sample.inputs().clone();
        draws.column_mut(map.input).fill(map.first[row]);
        draws.column_mut(place("fluid.lot_factor")).fill(1.0);
        let mut of_lot = study.clone();
        of_lot.design.set(nominal, map.second[column]);
        let table = Ensemble::new(&of_lot).at_inputs(&draws, &Progress::default());
        let expected = Breaches::of(&of_lot, &table).count(Event::Any).breaches;
        let cell = map.breaches[row * map.second.len() + column].count(Event::Any).breaches;
        assert!(expected > 0 && expected < map.samples, "{row} {column}: {expected}");
        assert_eq!(cell, expected, "{row} {column}");
    }
}
