//! Plans of tightenings for the HABE study.

use super::curves::study;
use reeldown::campaign::Progress;
use reeldown::campaign::common_numbers::Event;
use reeldown::campaign::tighten::{purchases, tighten};
use reeldown::campaign::trade::trade_factors;
use reeldown::reliability::allocation::Purchase;
use reeldown::reliability::demonstration::Verdict;
use reeldown::study::TighteningCost;

#[test]
fn property_a_plan_is_demonstrated_by_points_that_it_was_not_made_on() {
    let study = study(&["tighten.samples=4000", "initial.temperature.cost=1"]);
    let found = tighten(&study, Some(0.03), &Progress::default()).expect("an answer");
    let found = found.expect("not stopped");
    let plan = found.search.plan.as_ref().expect("a plan exists");
    assert!(plan.cost > 0.0 && plan.probability <= found.aim);
    let demonstration = &found.confirmation.demonstration;
    assert_eq!(demonstration.verdict, Verdict::Met, "{demonstration:?}");
    assert!(demonstration.requirement.confidence > 0.9);
    assert!(demonstration.counts.samples >= 60_000);
    // The gaps are bought as one.
    assert_eq!(found.factors.len(), 10);
}

#[test]
fn property_what_cannot_be_bought_stands_in_the_way() {
    // Nothing but the averaging offset can be bought, and the design cannot move: P stays at four in ten.
    let mut study = study(&["tighten.samples=2000"]);
    for input in &mut study.inputs {
        input.cost = match input.target.path().as_str() {
            "fluid.averaging_offset" => TighteningCost::PerHalving(1.0),
            _ => TighteningCost::None,
        };
    }
    study.tighten.design.clear();
    let found = tighten(&study, Some(0.01), &Progress::default()).expect("an answer");
    let found = found.expect("not stopped");
    assert!(found.search.plan.is_none());
    assert_eq!(found.confirmation.demonstration.verdict, Verdict::NotMet);
    let (left, causes) = found.residual.expect("a residual");
    assert!(left.count(Event::Any).breaches > 600);
    assert_eq!(causes.len(), 10);
}

#[test]
fn property_groups_are_bought_once_and_grades_are_kept() {
    let study = study(&[]);
    let factors = trade_factors(&study);
    let costs = purchases(&study, &factors).expect("costs");
    for (factor, cost) in factors.iter().zip(&costs) {
        let expected = match factor.name.as_str() {
            "initial.temperature" | "fluid.averaging_offset" => Purchase::Nothing,
            _ => Purchase::PerHalving(1.0),
        };
        assert_eq!(*cost, expected, "{}", factor.name);
    }
}
