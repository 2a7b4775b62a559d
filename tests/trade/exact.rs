//! What the default study takes as exact.

use reeldown::campaign::Progress;
use reeldown::campaign::common_numbers::{Breaches, Event};
use reeldown::campaign::exact::run_exact;
use reeldown::study::{Override, Study};

#[test]
fn property_no_exact_value_of_the_default_study_outweighs_its_card() {
    let model = Override::parse("--set", "model=quasi-steady").expect("an override");
    let study = Study::load(None, &[model]).expect("the embedded study");
    let found = run_exact(&study, &Progress::default()).expect("an answer").expect("limits");
    let share = |breaches: &Breaches| breaches.count(Event::Any).estimate().expect("an estimate");
    let moved = |breaches: &Breaches| (share(breaches) - share(&found.base)).abs();
    let (strongest, most) = found
        .inputs
        .iter()
        .map(|(name, breaches)| (name.as_str(), moved(breaches)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .expect("inputs");
    assert_eq!(strongest, "fluid.viscosity_temperature");
    for value in &found.values {
        let path = value.target.path();
        let Some((_, breaches)) = &value.moved else { continue };
        assert!(moved(breaches) < most, "{path}: {} against {most}", moved(breaches));
        // The lot's law is the nominal viscosity's: neither is exact.
        let covered = ["fluid.nominal_viscosity", "fluid.lot_factor", "payload.weight"];
        assert!(!covered.contains(&path.as_str()), "{path}");
    }
}
