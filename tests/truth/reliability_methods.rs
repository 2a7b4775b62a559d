//! Reliability methods against published problems with certified probabilities.

use super::benchmarks::coverage::{CSV_HEADER, Coverage, METHODS, Trial, answer};
use super::benchmarks::{self, Benchmark, Function};
use reeldown::error::Result;
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::reliability::agreement::agreement;
use reeldown::reliability::cross_entropy::{CrossEntropyOptions, cross_entropy};
use reeldown::reliability::crude::{CrudeOptions, crude_monte_carlo};
use reeldown::reliability::design_point::{SearchOptions, Unconverged, design_points};
use reeldown::reliability::directional::{DirectionalOptions, directional_sampling};
use reeldown::reliability::estimate::Method;
use reeldown::reliability::event::Event;
use reeldown::reliability::form::form;
use reeldown::reliability::importance::{ImportanceOptions, importance_sampling};
use reeldown::reliability::limit_state::LimitState;
use reeldown::reliability::line::{LineOptions, line_sampling};
use reeldown::reliability::subset::{SubsetOptions, subset_simulation};
use reeldown::reliability::system::system_form;

/// The problem of this identifier.
fn named(id: &str) -> Benchmark {
    benchmarks::all().into_iter().find(|benchmark| benchmark.id == id).expect("a known problem")
}

/// A system hidden behind the single margin of its event, as the collections publish it.
struct AsOneMargin<'a>(&'a Benchmark);

impl LimitState for AsOneMargin<'_> {
    fn dimension(&self) -> usize {
        self.0.limits.dimension
    }

    fn limits(&self) -> usize {
        1
    }

    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()> {
        let mut all = Columns::new(z.rows(), self.0.limits.limits);
        self.0.limits.margins(z, &mut all)?;
        for k in 0..z.rows() {
            margins.set(k, 0, self.0.event.margin(all.row(k).into_iter()));
        }
        Ok(())
    }
}

fn first_order(id: &str) -> f64 {
    let benchmark = named(id);
    form(&benchmark.limits, 0, &SearchOptions::seeded(0)).unwrap().0.probability.unwrap()
}

#[test]
fn analytic_form_of_a_plane_is_exact() {
    // The search stops within 1e-5 of the plane and reads β off the plane itself: rounding remains.
    for (id, probability) in [("RP107", normal::cdf(-5.0)), ("RMINUSS", 0.0786496035251426)] {
        assert!((first_order(id) / probability - 1.0).abs() < 1e-12, "{id}");
    }
    let benchmark = named("RP107");
    let found =
        design_points(&benchmark.limits, Event::Limit(0), &SearchOptions::seeded(0)).unwrap();
    assert_eq!(found.points.len(), 1);
    assert!(found.points[0].importance.iter().all(|a2| (a2 - 0.1).abs() < 1e-9));
}

#[test]
fn published_form_values_of_the_collections() {
    // uqtestfuns' tables: RP22 6.2097e-3; damped oscillator 2.19e-2 and 3.91e-6; their last digit, and
    // half a per cent for the oscillators, whose tables were made with a tolerance of that size.
    assert!((first_order("RP22") - 6.2097e-3).abs() < 5e-8);
    assert!((first_order("DAMPED_15_0") / 2.19e-2 - 1.0).abs() < 5e-3);
    assert!((first_order("DAMPED_27_5") / 3.91e-6 - 1.0).abs() < 1e-2);
}

#[test]
fn published_trap_form_is_far_too_high_on_the_damped_oscillator() {
    for (id, least, most) in [("DAMPED_15_0", 4.5, 4.7), ("DAMPED_27_5", 10.0, 10.6)] {
        let ratio = first_order(id) / named(id).probability;
        assert!(least < ratio && ratio < most, "{id}: {ratio}");
    }
}

#[test]
fn published_trap_form_is_low_on_the_four_branches() {
    // 2.33e-4, ten times low, is the plane of the farther branch, where a single search can end.
    let benchmark = named("FOURBRANCH");
    let found = design_points(&benchmark.limits, Event::Any, &SearchOptions::seeded(0)).unwrap();
    let far = found.nearest(2).unwrap().reliability_index;
    assert!((far - 3.5).abs() < 1e-9);
    assert!((normal::survival(far) - 2.33e-4).abs() < 5e-7);
    // Even the nearest of all design points is low by 1.6.
    let near = normal::survival(found.points[0].reliability_index);
    let ratio = near / benchmark.probability;
    assert!(0.60 < ratio && ratio < 0.61, "{ratio}");
}

#[test]
fn published_trap_form_says_nearly_certain_on_the_shell() {
    // The origin breaches and is 4.5 from the limit; the true probability is 3.8e-4.
    assert!(first_order("RP63") > 0.999_99);
}

#[test]
fn property_an_unconverged_search_reports_no_number() {
    let flat = Function { dimension: 3, limits: 1, margins: |_, margins| margins.push(1.0) };
    let (estimate, found) = form(&flat, 0, &SearchOptions::seeded(0)).unwrap();
    assert_eq!(estimate.probability, None);
    assert!(found.unconverged.iter().all(|(_, why)| *why == Unconverged::Flat));
    let jump = Function {
        dimension: 2,
        limits: 1,
        margins: |z, margins| margins.push(if z[0] > 2.0 { -1.0 } else { 1.0 + 0.01 * z[1] }),
    };
    assert_eq!(form(&jump, 0, &SearchOptions::seeded(0)).unwrap().0.probability, None);
    let faulty = Function { dimension: 2, limits: 1, margins: |_, margins| margins.push(f64::NAN) };
    let (estimate, found) = form(&faulty, 0, &SearchOptions::seeded(0)).unwrap();
    assert_eq!(estimate.probability, None);
    assert!(estimate.faults > 0);
    assert!(found.unconverged.iter().all(|(_, why)| *why == Unconverged::Fault));
}

#[test]
fn analytic_system_form_of_two_planes() {
    // RP33 is two planes at distance 3 with α·α = 1/√3: the union is exact, up to quadrature and search.
    let benchmark = named("RP33");
    let (estimate, _) =
        system_form(&benchmark.limits, Event::Any, &SearchOptions::seeded(0)).unwrap();
    let ratio = estimate.probability.unwrap() / benchmark.probability;
    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
    let (both, _) =
        system_form(&benchmark.limits, Event::Both(0, 1), &SearchOptions::seeded(0)).unwrap();
    let exact = 2.0 * normal::survival(3.0) - benchmark.probability;
    // The joint design point is converged to 1e-5 in distance only.
    assert!((both.probability.unwrap() / exact - 1.0).abs() < 1e-3);
}

/// Ten recorded seeds of a method on a problem with a share of its default effort: every estimate with an interval within
/// five of its standard errors of the truth (a chance of 6e-7 each for a normal error), at least
/// 7 of 10 intervals stated and holding it (fewer has a chance of 1e-3 at 95 %; the certificate measures coverage
/// itself).
fn holds(method: Method, benchmark: &Benchmark, effort: f64) {
    let mut held = 0;
    for seed in 0..10 {
        let estimate = answer(method, benchmark, seed, effort);
        let (p, error) = (estimate.probability.unwrap(), estimate.standard_error.unwrap());
        // A withdrawn interval does not hold anything.
        let Some(interval) = estimate.interval.interval() else { continue };
        // The interval of a plane is wider than its error, which is nothing but the root's tolerance.
        let error = error.max((interval.upper - interval.lower) / 4.0);
        let off = (p - benchmark.probability).abs() / error;
        assert!(off < 5.0, "{} seed {seed}: {p} is {off} standard errors off", benchmark.id);
        let slack = benchmark.relative_error * benchmark.probability;
        let truth = benchmark.probability;
        held += usize::from(interval.lower <= truth + slack && truth - slack <= interval.upper);
    }
    assert!(held >= 7, "{}: {held} of 10 intervals hold the truth", benchmark.id);
}

#[test]
fn published_problems_by_crude_monte_carlo() {
    for benchmark in &benchmarks::all() {
        if benchmark.probability > 1e-3 {
            holds(Method::CrudeMonteCarlo, benchmark, 0.1);
            continue;
        }
        // Hardly a breach is seen: no standard error to go by, but the exact interval holds all the same.
        let held = (0..10).filter(|&seed| {
            let estimate = answer(Method::CrudeMonteCarlo, benchmark, seed, 0.1);
            estimate.interval.interval().is_some_and(|i| i.contains(benchmark.probability))
        });
        assert!(held.count() >= 7, "{}", benchmark.id);
    }
}

#[test]
fn published_problems_by_importance_sampling() {
    for benchmark in benchmarks::all().iter().filter(|benchmark| benchmark.id != "RP63") {
        holds(Method::ImportanceSampling, benchmark, 0.25);
    }
}

#[test]
fn published_problems_by_subset_simulation() {
    for benchmark in &benchmarks::all() {
        let effort = if benchmark.limits.dimension == 100 { 0.1 } else { 0.2 };
        holds(Method::SubsetSimulation, benchmark, effort);
    }
}

#[test]
fn published_problems_by_line_sampling() {
    // RP55's middle margins and RP63's shell are withdrawn: no line is better than another there.
    for benchmark in benchmarks::all().iter().filter(|b| !["RP55", "RP63"].contains(&b.id)) {
        holds(Method::LineSampling, benchmark, 1.0);
    }
}

#[test]
fn published_lines_hold_the_shaft_that_bends_towards_the_origin() {
    // Independent lines searched whole held RP14 in 89 of 100 seeds, scrambled ones without the wide ones in 85, both
    // from above: lines far from the design point, which hardly any sample meets, carry much of the sum.
    // 275 or fewer of 300 has a chance of 2e-3 at the 95.5 % measured, as many or more of 5e-4 at 85 %.
    let benchmark = named("RP14");
    let trials: Vec<Trial> =
        (5000..5300).map(|seed| Trial::run(Method::LineSampling, &benchmark, seed, 1.0)).collect();
    let row = Coverage::of(Method::LineSampling, &benchmark, &trials);
    assert!(row.stated >= 290 && row.held + row.seeds >= row.stated + 276, "{}", row.markdown());
    // Those that miss do so on both sides.
    assert!((row.ratio.unwrap() - 1.0).abs() < 0.003, "{}", row.markdown());
}

/// Problems that few random directions see: many dimensions, or a small corner.
const UNSEEN: [&str; 9] =
    ["RP38", "RP25", "RP8", "RP14", "DAMPED_15_0", "DAMPED_27_5", "UNDAMPED_0_45", "RP107", "RP63"];

#[test]
fn published_problems_by_directional_sampling() {
    for benchmark in benchmarks::all().iter().filter(|b| !UNSEEN.contains(&b.id)) {
        holds(Method::DirectionalSampling, benchmark, 1.0);
    }
}

#[test]
fn published_trap_directional_sampling_says_what_it_cannot_see() {
    for id in UNSEEN {
        let estimate = answer(Method::DirectionalSampling, &named(id), 1, 1.0);
        assert!(estimate.interval.why_none().is_some(), "{id}: {estimate:?}");
    }
}

#[test]
fn published_problems_by_cross_entropy() {
    for benchmark in &benchmarks::all() {
        holds(Method::CrossEntropy, benchmark, 1.0);
    }
}

#[test]
fn regression_cross_entropy_is_not_misled_by_the_kinks_of_rp110() {
    // The learning once closed off half of the region in three seeds of ten: 86 % of the intervals held, the
    // standard errors of those seeds scattered from 1.5 to 5 %. Its points are pooled now.
    let benchmark = named("RP110");
    for seed in 0..10 {
        let estimate = answer(Method::CrossEntropy, &benchmark, seed, 1.0);
        let error = estimate.relative_standard_error().unwrap();
        assert!(error < 0.02, "seed {seed}: {error}");
    }
}

#[test]
fn published_coverage_certificate_in_short() {
    // Twenty seeds at half the effort: 14 or fewer of 20 has a chance of 3e-4 at 95 % (binomial).
    for (method, id) in [
        (Method::CrudeMonteCarlo, "RP55"),
        (Method::ImportanceSampling, "RP22"),
        (Method::SubsetSimulation, "RP53"),
        (Method::LineSampling, "RP33"),
        (Method::DirectionalSampling, "RMINUSS"),
        (Method::CrossEntropy, "RP25"),
    ] {
        let benchmark = named(id);
        let trials: Vec<Trial> =
            (0..20).map(|seed| Trial::run(method, &benchmark, seed, 0.5)).collect();
        let row = Coverage::of(method, &benchmark, &trials);
        assert!(row.stated == 20 && row.held >= 15, "{}", row.markdown());
        assert_eq!(row.csv().split(',').count(), CSV_HEADER.split(',').count());
        // A certificate that goes on where it stopped reads its rows back.
        let kept = Coverage::from_csv(method, &benchmark, &row.csv()).unwrap();
        assert_eq!(kept.csv(), row.csv());
    }
}

#[test]
fn published_trap_methods_withdraw_their_interval_where_they_are_unfit() {
    // The shell has no design point to sample around; few directions of ten dimensions see β = 5.
    for (method, id) in [
        (Method::ImportanceSampling, "RP63"),
        (Method::LineSampling, "RP63"),
        (Method::DirectionalSampling, "RP107"),
        (Method::CrudeMonteCarlo, "RP107"),
    ] {
        let benchmark = named(id);
        let estimate = answer(method, &benchmark, 1, 0.2);
        match estimate.interval.interval() {
            // Crude Monte Carlo's exact interval is never wrong, only wide.
            Some(interval) => assert!(interval.contains(benchmark.probability)),
            None => assert!(estimate.interval.why_none().is_some()),
        }
        assert_eq!(estimate.interval.interval().is_some(), method == Method::CrudeMonteCarlo);
    }
}

#[test]
fn published_trap_subset_simulation_follows_the_falling_margin_of_rp110() {
    // As one margin, the walks run after x2, whose share is 2.9e-7, and never see x1, whose share is
    // 3.2e-5: the interval is narrow and a hundred times too low, and nothing in the walks shows it.
    let benchmark = named("RP110");
    let one = AsOneMargin(&benchmark);
    let event = Event::Limit(0);
    let options = SubsetOptions { samples_per_level: 200, ..SubsetOptions::seeded(0) };
    let subset = subset_simulation(&one, event, &options).unwrap();
    assert!(subset.interval.interval().unwrap().upper < 0.1 * benchmark.probability);
    // The agreement check sees it.
    let (importance, _) = importance_sampling(&one, event, &ImportanceOptions::seeded(0)).unwrap();
    assert!(importance.interval.interval().unwrap().contains(benchmark.probability));
    let check = agreement(&[importance, subset], 0.01).unwrap();
    assert_eq!(check.agrees, Some(false));
    // Limit by limit, as a union, the same walks are right.
    holds(Method::SubsetSimulation, &benchmark, 0.2);
}

#[test]
fn property_methods_agree_on_a_problem_that_suits_them() {
    let benchmark = named("RP33");
    let estimates = METHODS.map(|method| answer(method, &benchmark, 3, 0.5));
    let check = agreement(&estimates, 0.01).unwrap();
    assert_eq!((check.agrees, check.comparisons.len()), (Some(true), 15));
}

/// A limit state that evaluates its batches in pieces.
struct InPieces<'a>(&'a Function);

impl LimitState for InPieces<'_> {
    fn dimension(&self) -> usize {
        self.0.dimension
    }

    fn limits(&self) -> usize {
        self.0.limits
    }

    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()> {
        for first in (0..z.rows()).step_by(7) {
            let rows: Vec<Vec<f64>> =
                (first..z.rows().min(first + 7)).map(|row| z.row(row)).collect();
            let mut piece = Columns::new(rows.len(), self.0.limits);
            self.0.margins(&Columns::from_rows(&rows), &mut piece)?;
            for (k, row) in (first..).zip(&rows).map(|(k, _)| (k, k - first)) {
                for limit in 0..self.0.limits {
                    margins.set(k, limit, piece.get(row, limit));
                }
            }
        }
        Ok(())
    }
}

#[test]
fn property_same_seed_same_bits_however_batches_are_cut() {
    let benchmark = named("RP33");
    let (whole, pieces) = (&benchmark.limits, &InPieces(&benchmark.limits));
    let event = benchmark.event;
    let options = SubsetOptions { samples_per_level: 100, seed: 9, ..SubsetOptions::seeded(0) };
    let subset = |state: &dyn LimitState| subset_simulation(state, event, &options).unwrap();
    assert_eq!(subset(whole), subset(pieces));
    let options = ImportanceOptions { samples: 1000, seed: 9, ..ImportanceOptions::seeded(0) };
    let importance = |state: &dyn LimitState| importance_sampling(state, event, &options).unwrap();
    assert_eq!(importance(whole), importance(pieces));
    assert_ne!(
        subset_simulation(whole, event, &SubsetOptions { samples_per_level: 100, ..options_of(8) }),
        subset_simulation(whole, event, &SubsetOptions { samples_per_level: 100, ..options_of(9) }),
    );
}

fn options_of(seed: u64) -> SubsetOptions {
    SubsetOptions { seed, ..SubsetOptions::seeded(0) }
}

/// A plane at distance 3 whose evaluation fails beyond it where x2 > 1.
struct PartlyFaulty;

impl LimitState for PartlyFaulty {
    fn dimension(&self) -> usize {
        2
    }

    fn limits(&self) -> usize {
        1
    }

    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()> {
        for k in 0..z.rows() {
            let margin = 3.0 - z.get(k, 0);
            let fault = margin < 0.0 && z.get(k, 1) > 1.0;
            margins.set(k, 0, if fault { f64::NAN } else { margin });
        }
        Ok(())
    }
}

#[test]
fn analytic_faults_bound_the_probability_from_both_sides() {
    let (low, high) = (normal::survival(3.0) * normal::cdf(1.0), normal::survival(3.0));
    let event = Event::Limit(0);
    let state = &PartlyFaulty;
    let estimates = [
        importance_sampling(state, event, &ImportanceOptions::seeded(0)).unwrap().0,
        subset_simulation(state, event, &SubsetOptions::seeded(0)).unwrap(),
        line_sampling(state, event, &LineOptions::seeded(0)).unwrap(),
        directional_sampling(state, event, &DirectionalOptions::seeded(0)).unwrap(),
        cross_entropy(state, event, &CrossEntropyOptions::seeded(0)).unwrap(),
        crude_monte_carlo(state, event, &CrudeOptions::seeded(0)).unwrap(),
    ];
    for estimate in estimates {
        assert!(estimate.faults > 0);
        let error = 4.5 * estimate.standard_error.unwrap();
        assert!((estimate.probability.unwrap() - low).abs() < error, "{estimate:?}");
        // The standard error is that of the smaller probability.
        let error = error * (high / low).max(1.0);
        assert!((estimate.probability_with_faults.unwrap() - high).abs() < error, "{estimate:?}");
        // One interval for both readings: from below the one to above the other.
        let interval = estimate.interval.interval().unwrap();
        assert!(interval.lower < estimate.probability.unwrap(), "{estimate:?}");
        assert!(interval.upper > estimate.probability_with_faults.unwrap(), "{estimate:?}");
    }
}
