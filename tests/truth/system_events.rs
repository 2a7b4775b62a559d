//! Events of several limits by every method: any limit, each pair, all of them.

use super::benchmarks::Function;
use reeldown::numerics::special::normal;
use reeldown::reliability::cross_entropy::{CrossEntropyOptions, cross_entropy};
use reeldown::reliability::crude::{CrudeOptions, crude_monte_carlo};
use reeldown::reliability::design_point::SearchOptions;
use reeldown::reliability::directional::{DirectionalOptions, directional_sampling};
use reeldown::reliability::estimate::{Estimate, Method};
use reeldown::reliability::event::Event;
use reeldown::reliability::importance::{ImportanceOptions, importance_sampling};
use reeldown::reliability::line::{LineOptions, line_sampling};
use reeldown::reliability::subset::{SubsetOptions, subset_simulation};
use reeldown::reliability::system::system_form;

/// Distances of three planes along axes of their own.
const DISTANCES: [f64; 3] = [1.5, 2.0, 2.5];

/// Independent limits: the third in units a thousand times as large, as seconds beside kelvin.
fn planes() -> Function {
    Function {
        dimension: 4,
        limits: 3,
        margins: |z, margins| {
            margins.push(DISTANCES[0] - z[0]);
            margins.push(DISTANCES[1] + z[1]);
            margins.push(1000.0 * (DISTANCES[2] - z[2]));
        },
    }
}

fn events() -> [(Event, f64); 5] {
    let p = DISTANCES.map(normal::survival);
    [
        (Event::Any, 1.0 - p.iter().map(|p| 1.0 - p).product::<f64>()),
        (Event::Both(0, 1), p[0] * p[1]),
        (Event::Both(0, 2), p[0] * p[2]),
        (Event::Both(1, 2), p[1] * p[2]),
        (Event::All, p[0] * p[1] * p[2]),
    ]
}

fn answers(event: Event, seed: u64) -> Vec<Estimate> {
    let state = &planes();
    let search = SearchOptions::seeded(seed);
    let importance = ImportanceOptions::seeded(seed);
    let line = LineOptions::seeded(seed);
    vec![
        crude_monte_carlo(state, event, &CrudeOptions::seeded(seed)).unwrap(),
        importance_sampling(state, event, &importance).unwrap().0,
        subset_simulation(state, event, &SubsetOptions::seeded(seed)).unwrap(),
        line_sampling(state, event, &line).unwrap(),
        directional_sampling(state, event, &DirectionalOptions::seeded(seed)).unwrap(),
        cross_entropy(state, event, &CrossEntropyOptions::seeded(seed)).unwrap(),
        system_form(state, event, &search).unwrap().0,
    ]
}

#[test]
fn analytic_any_pairs_and_all_of_independent_limits_by_every_method() {
    for (event, truth) in events() {
        for estimate in answers(event, 1993) {
            let name = format!("{} of {event:?}", estimate.method.name());
            let p = estimate.probability.unwrap_or_else(|| panic!("{name}: {estimate:?}"));
            if estimate.method == Method::SystemForm {
                // Exact for planes; a joint point is converged to 1e-5 in distance, a union's integral
                // to its own error.
                assert!((p / truth - 1.0).abs() < 1e-3, "{name}: {p} for {truth}");
                continue;
            }
            let error = estimate.standard_error.unwrap();
            match estimate.interval.interval() {
                // Forty answers within 4.5 standard errors: a chance of 3e-4 to be wrong once.
                Some(_) if estimate.method != Method::CrudeMonteCarlo => {
                    assert!((p - truth).abs() < 4.5 * error, "{name}: {p} ± {error} for {truth}");
                }
                // Exact, so never wrong, whatever it saw; twice as wide as a slip of the seed needs.
                Some(interval) => assert!(
                    interval.lower / 2.0 < truth && truth < 2.0 * interval.upper,
                    "{name}: {interval:?} for {truth}"
                ),
                // Few directions of four dimensions see a corner: the method says so.
                None => {
                    assert_eq!(
                        estimate.method,
                        Method::DirectionalSampling,
                        "{name}: {estimate:?}"
                    );
                    assert!(estimate.interval.why_none().is_some());
                }
            }
        }
    }
}
