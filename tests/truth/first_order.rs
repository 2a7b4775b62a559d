//! First- and second-order methods against SciPy and mpmath on every published problem.

use super::benchmarks::{self, Benchmark, Function};
use reeldown::error::Result;
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::reliability::design_point::SearchOptions;
use reeldown::reliability::event::Event;
use reeldown::reliability::form::form;
use reeldown::reliability::limit_state::LimitState;
use reeldown::reliability::sorm::{SormOptions, sorm};
use reeldown::reliability::system::system_form;
use serde_json::Value;

/// The references of a problem, one a limit.
fn references(benchmark: &Benchmark) -> Vec<Value> {
    let text = include_str!("references/first_order.json");
    let all: Value = serde_json::from_str(text).expect("the reference file is JSON");
    all["problems"][benchmark.id].as_array().cloned().unwrap_or_default()
}

fn named(id: &str) -> Benchmark {
    benchmarks::all().into_iter().find(|benchmark| benchmark.id == id).expect("a known problem")
}

#[test]
fn reference_form_of_every_problem_by_scipy() {
    let mut compared = 0;
    for benchmark in benchmarks::all() {
        for (limit, reference) in references(&benchmark).iter().enumerate() {
            let (estimate, found) =
                form(&benchmark.limits, limit, &SearchOptions::seeded(0)).unwrap();
            let beta = found.points.first().map(|point| point.reliability_index);
            let truth = reference["reliability_index"].as_f64().unwrap();
            // The search stops 1e-3 of the point's length off the normal through the origin: the distance
            // read off the plane there is off by half the square of that, times the curvature; ten times
            // that for curvatures of up to 20.
            let off = (beta.unwrap() / truth - 1.0).abs();
            assert!(off < 1e-5, "{} limit {limit}: {beta:?} for {truth}", benchmark.id);
            // dΦ(−β)/Φ(−β) is at most (β + 1/β) dβ.
            let ratio = estimate.probability.unwrap() / reference["form"].as_f64().unwrap();
            assert!((ratio - 1.0).abs() < 1e-5 * (truth * truth + 1.0), "{} {limit}", benchmark.id);
            compared += 1;
        }
    }
    assert_eq!(compared, 26, "limits of the 17 problems that have a nearest point");
}

#[test]
fn reference_sorm_of_every_smooth_problem_by_mpmath() {
    // Steps so small that the formulas and the curvatures are judged, not the default steps: second
    // differences with h = 0.002 are off by h²/12 of the fourth derivative over the second, 2e-6 for
    // RP53's sin(2.5 x), and by rounding of 1e-14/h² = 2e-9 (with h = 0.01 DAMPED_27_5 was off by 1.5e-3);
    // gradients with h = 1e-3 and a search to 1e-6 of the
    // point's length move the point by less. A formula takes half of each curvature's error.
    let search = SearchOptions {
        angle_tolerance: 1e-6,
        distance_tolerance: 1e-8,
        difference_step: 1e-3,
        ..SearchOptions::seeded(0)
    };
    let options = SormOptions { search, difference_step: 2e-3 };
    let mut compared = 0;
    for benchmark in benchmarks::all().iter().filter(|benchmark| benchmark.id != "RP110") {
        for (limit, reference) in references(benchmark).iter().enumerate() {
            let (second, _) = sorm(&benchmark.limits, limit, &options).unwrap();
            for (estimate, key) in [
                (&second.breitung, "breitung"),
                (&second.hohenbichler_rackwitz, "hohenbichler_rackwitz"),
            ] {
                let truth = reference[key].as_f64().unwrap();
                let ratio = estimate.probability.unwrap() / truth;
                assert!((ratio - 1.0).abs() < 1e-3, "{} {limit} {key}: {ratio}", benchmark.id);
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 48);
}

#[test]
fn analytic_sorm_of_a_parabola() {
    // RP22 and the branch of FOURBRANCH are 2.5 − s + 0.2 t² and 3 − s + 0.2 t²: κ = 0.4, exact under
    // second differences. Formulas by hand; 1e-6 is the rounding of differences with a step of 0.05.
    let benchmark = named("RP22");
    let (second, _) = sorm(&benchmark.limits, 0, &SormOptions::seeded(0)).unwrap();
    assert!((second.curvatures[0] - 0.4).abs() < 1e-6);
    let tail = normal::survival(2.5);
    let breitung = tail / (1.0 + 2.5 * 0.4_f64).sqrt();
    let factor = normal::density(2.5) / tail;
    let refined = tail / (1.0 + factor * 0.4).sqrt();
    assert!((second.breitung.probability.unwrap() / breitung - 1.0).abs() < 1e-6);
    assert!((second.hohenbichler_rackwitz.probability.unwrap() / refined - 1.0).abs() < 1e-6);
    // Each correction is nearer to the truth than the last.
    let off = |p: f64| (p / benchmark.probability - 1.0).abs();
    assert!(off(refined) < off(breitung) && off(breitung) < off(tail));
}

#[test]
fn analytic_sorm_of_a_hundred_dimensions() {
    // A paraboloid with κ_i = i/200: 99 curvatures at once, as analytic as one.
    let bowl = Function {
        dimension: 100,
        limits: 1,
        margins: |z, margins| {
            let bend = |(i, x): (usize, &f64)| i as f64 / 400.0 * x * x;
            margins.push(4.0 - z[0] + z.iter().enumerate().map(bend).sum::<f64>());
        },
    };
    // β read off a plane at angle φ from the point is off by β φ²/2: nothing at 1e-6.
    let search = SearchOptions { angle_tolerance: 1e-6, ..SearchOptions::seeded(0) };
    let options = SormOptions { search, ..SormOptions::seeded(0) };
    let (second, _) = sorm(&bowl, 0, &options).unwrap();
    for (i, kappa) in second.curvatures.iter().enumerate() {
        assert!((kappa - (i + 1) as f64 / 200.0).abs() < 1e-6);
    }
    let product: f64 = (1..100).map(|i| 1.0 + 4.0 * f64::from(i) / 200.0).product();
    let breitung = normal::survival(4.0) / product.sqrt();
    assert!((second.breitung.probability.unwrap() / breitung - 1.0).abs() < 1e-5);
}

#[test]
fn property_sorm_without_a_value_reports_no_number() {
    // The shell of RP63 curves around the origin.
    let benchmark = named("RP63");
    let search = SearchOptions { directions: 0, ..SearchOptions::seeded(0) };
    let options = SormOptions { search, ..SormOptions::seeded(0) };
    let (second, _) = sorm(&benchmark.limits, 0, &options).unwrap();
    assert_eq!(second.breitung.probability, None);
}

#[test]
fn published_trap_sorm_sees_one_of_the_four_branches() {
    // Waarts (2000), as tabled by uqtestfuns: SORM 8.740315e-4, two and a half times low on the system.
    // The branch's own probability is 8.788e-4 (quadrature), 0.55 % above; Hohenbichler and Rackwitz'
    // factor, asymptotic, is 1.0 % above that: 1.6 % together.
    let benchmark = named("FOURBRANCH");
    let (second, _) = sorm(&benchmark.limits, 0, &SormOptions::seeded(0)).unwrap();
    let refined = second.hohenbichler_rackwitz.probability.unwrap();
    assert!((refined / 8.740_315e-4 - 1.0).abs() < 0.016, "{refined}");
    assert!(refined < benchmark.probability / 2.4);
    // System FORM joins all four planes: Φ(−3) twice and Φ(−3.5) twice, nearly disjoint.
    let (system, _) =
        system_form(&benchmark.limits, Event::Any, &SearchOptions::seeded(0)).unwrap();
    let planes = 2.0 * (normal::survival(3.0) + normal::survival(3.5));
    let ratio = system.probability.unwrap() / planes;
    assert!((0.98..=1.0).contains(&ratio), "{ratio}");
}

/// A plane at distance 3 whose margin cannot be evaluated within 0.2 of its design point.
struct HoleAtThePoint;

impl LimitState for HoleAtThePoint {
    fn dimension(&self) -> usize {
        2
    }

    fn limits(&self) -> usize {
        1
    }

    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()> {
        for k in 0..z.rows() {
            let (x, y) = (z.get(k, 0) - 3.0, z.get(k, 1));
            let hole = x * x + y * y < 0.04;
            margins.set(k, 0, if hole { f64::NAN } else { -x });
        }
        Ok(())
    }
}

#[test]
fn property_a_fault_at_the_design_point_leaves_no_number() {
    let state = &HoleAtThePoint;
    let (first, _) = form(state, 0, &SearchOptions::seeded(0)).unwrap();
    let (second, _) = sorm(state, 0, &SormOptions::seeded(0)).unwrap();
    let (system, _) = system_form(state, Event::Any, &SearchOptions::seeded(0)).unwrap();
    for estimate in [first, second.breitung, second.hohenbichler_rackwitz, system] {
        assert_eq!(estimate.probability, None, "{estimate:?}");
        assert!(estimate.faults > 0 && estimate.interval.why_none().is_some());
    }
}
