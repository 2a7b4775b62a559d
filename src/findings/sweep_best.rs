//! The best value of a swept path, with its uncertainty, and the range that meets the requirement.

use super::design_value::{Unresolved, best_value};
use super::known::GoAnswer;
use super::sweep::CellFinding;
use crate::campaign::sweep::{Cell, GROUPS, Grid, Meaning, Sampled};
use crate::numerics::interval::{Earned, Estimate};
use serde::Serialize;

/// The best value of the chosen path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestFinding {
    /// Value of the other path.
    pub given: Option<f64>,
    /// The value at which P(any breach) is least.
    pub best: Estimate,
    /// Why that has no interval; `None` also where there is no such value.
    #[serde(skip)]
    pub unresolved: Option<Unresolved>,
    /// P(any breach) at the nearest setting, at points that the search has not seen.
    pub probability: Option<Estimate>,
    /// Ends of the settings at which the requirement is demonstrated, at points that the search has not seen.
    pub met: Option<(f64, f64)>,
    /// Ends of the settings at which it is not refuted.
    pub open: Option<(f64, f64)>,
    /// The setting with the largest smallest relative margin of the nominal descent, and that margin.
    pub nominal: Option<(f64, f64)>,
    /// Ends of the settings whose nominal descent keeps every limit, interpolated.
    pub feasible: Option<(f64, f64)>,
}

/// The path that is chosen: the first, unless it alone is one whose value is given to whoever chooses.
pub(super) fn choice(grid: &Grid) -> usize {
    match &grid.paths[..] {
        [first, second] if first.meaning == Meaning::Held && second.meaning != Meaning::Held => 1,
        _ => 0,
    }
}

/// Places of the cells along the chosen path, for every value of the other.
pub(super) fn lines(grid: &Grid, choice: usize) -> Vec<Vec<usize>> {
    let counts: Vec<usize> = grid.paths.iter().map(|path| path.values.len()).collect();
    match counts[..] {
        [rows, columns] if choice == 0 => {
            (0..columns).map(|c| (0..rows).map(|r| r * columns + c).collect()).collect()
        }
        [rows, columns] => {
            (0..rows).map(|r| (0..columns).map(|c| r * columns + c).collect()).collect()
        }
        _ => vec![(0..counts.iter().product()).collect()],
    }
}

/// The longest run of settings that hold, by its ends.
fn longest_run(line: &[usize], holds: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
    let mut longest: Option<(usize, usize)> = None;
    let mut start = None;
    for (k, &cell) in line.iter().enumerate() {
        start = if holds(cell) { start.or(Some(k)) } else { None };
        if let Some(start) = start
            && longest.is_none_or(|(a, b)| k - start > b - a)
        {
            longest = Some((start, k));
        }
    }
    longest
}

/// The setting of one line of cells with the least P(any breach).
#[derive(Debug, Clone)]
pub(super) struct Searched {
    best: Estimate,
    unresolved: Option<Unresolved>,
    /// The cell nearest to it.
    pub at: Option<usize>,
}

impl Searched {
    fn nothing(why: &str) -> Self {
        Searched { best: Estimate::none(why), unresolved: None, at: None }
    }
}

/// The setting of one line of cells with the least P(any breach), and the cell nearest to it.
pub(super) fn searched(xs: &[f64], line: &[usize], cells: &[Cell]) -> Searched {
    let sampled: Option<Vec<&Sampled>> =
        line.iter().map(|&cell| cells[cell].sampled.as_ref()).collect();
    let found = match sampled {
        Some(sampled) => least(xs, &sampled),
        None => Searched::nothing("no samples were asked for"),
    };
    Searched { at: found.at.map(|at| line[at]), ..found }
}

/// The best value of one line of cells, of which those found by looking have been estimated anew; what was found is
/// [`searched`]'s.
pub(super) fn best(
    grid: &Grid,
    choice: usize,
    line: &[usize],
    cells: &[CellFinding],
    Searched { best, unresolved, at }: Searched,
) -> BestFinding {
    let xs = &grid.paths[choice].values;
    let ends = |run: Option<(usize, usize)>| run.map(|(a, b)| (xs[a], xs[b]));
    let given = (grid.paths.len() == 2).then(|| cells[line[0]].values[1 - choice]);
    let smallest_margin = |k: usize| {
        let cell = &cells[line[k]];
        cell.relative_margins[cell.limiting?]
    };
    let margins: Vec<f64> =
        (0..line.len()).map(|k| smallest_margin(k).unwrap_or(f64::NEG_INFINITY)).collect();
    let roomiest = (0..line.len()).max_by(|&a, &b| margins[a].total_cmp(&margins[b]));
    BestFinding {
        given,
        best,
        unresolved,
        probability: at.and_then(|at| cells[at].confirmed.clone()),
        met: ends(longest_run(line, |cell| cells[cell].answer == GoAnswer::Go)),
        open: ends(longest_run(line, |cell| {
            matches!(cells[cell].answer, GoAnswer::Go | GoAnswer::Undecided)
        })),
        nominal: roomiest.filter(|&k| margins[k].is_finite()).map(|k| (xs[k], margins[k])),
        feasible: feasible(xs, &margins),
    }
}

/// The ends of the longest stretch with a margin of at least zero, interpolated between settings.
fn feasible(xs: &[f64], margins: &[f64]) -> Option<(f64, f64)> {
    let places: Vec<usize> = (0..xs.len()).collect();
    let (a, b) = longest_run(&places, |k| margins[k] >= 0.0)?;
    let crossing = |inside: usize, outside: Option<usize>| match outside {
        Some(k) if k < xs.len() && margins[k].is_finite() => {
            xs[inside] + (xs[k] - xs[inside]) * margins[inside] / (margins[inside] - margins[k])
        }
        _ => xs[inside],
    };
    Some((crossing(a, a.checked_sub(1)), crossing(b, Some(b + 1))))
}

/// The setting with the least P(any breach) and the place of the computed one nearest to it.
fn least(xs: &[f64], sampled: &[&Sampled]) -> Searched {
    let worst: Vec<u64> = sampled.iter().map(|cell| cell.any.most_breaches()).collect();
    let samples = sampled.first().map_or(0, |cell| cell.any.samples);
    let Some(smallest) = worst.iter().copied().min() else {
        return Searched::nothing("there is no setting");
    };
    if smallest == samples {
        return Searched::nothing("every sample breaches a limit at every setting");
    }
    let places: Vec<usize> = (0..xs.len()).collect();
    let Some((a, b)) = longest_run(&places, |k| worst[k] == smallest) else {
        return Searched::nothing("there is no setting");
    };
    let middle = a + (b - a) / 2;
    if b > a {
        let (unresolved, what) = match smallest {
            0 => (Unresolved::NoBreach, "no breach was seen"),
            _ => (Unresolved::NoClearMinimum, "P is the same"),
        };
        let interval = Earned::none(format!("{what} from the setting {} to {} (SI)", xs[a], xs[b]));
        let value = Some(0.5 * (xs[a] + xs[b]));
        let best = Estimate { value, standard_error: None, interval };
        return Searched { best, unresolved: Some(unresolved), at: Some(middle) };
    }
    // The parabola is asked where P is of the order of its least value, five settings at least.
    let near = |k: usize| 2 * worst[k] <= 3 * smallest + 10;
    let (mut from, mut to) = (middle, middle);
    while from > 0 && near(from - 1) {
        from -= 1;
    }
    while to + 1 < xs.len() && near(to + 1) {
        to += 1;
    }
    from = from.min(middle.saturating_sub(2));
    to = to.max((middle + 2).min(xs.len() - 1));
    let shares = |left_out: Option<usize>| -> Vec<f64> {
        let kept = |cell: &&Sampled| {
            let groups = (0..GROUPS).filter(|g| left_out != Some(*g)).map(|g| cell.groups[g]);
            let (breaches, samples) =
                groups.fold((0, 0), |(m, n), g| (m + g.most_breaches(), n + g.samples));
            (breaches as f64 + 0.5) / (samples as f64 + 1.0)
        };
        sampled[from..=to].iter().map(kept).collect()
    };
    let (mut best, unresolved) = best_value(&xs[from..=to], &shares, (xs[0], xs[xs.len() - 1]));
    if let (Some(wide), Earned::Interval(interval)) = (best.value, &mut best.interval) {
        // What a parabola is not shows in how far that through the nearest three settings differs.
        let three = (middle - from).saturating_sub(1)..=(middle - from + 1).min(to - from);
        let narrow = |left_out: Option<usize>| shares(left_out)[three.clone()].to_vec();
        let settings = &xs[from..=to][three.clone()];
        let other = best_value(settings, &narrow, (xs[0], xs[xs.len() - 1])).0.value;
        let apart = other.map_or(0.0, |other| (other - wide).abs());
        interval.lower -= apart;
        interval.upper += apart;
        interval.method = "parabola through ln P, delete-a-group jackknife, and its own misfit";
    }
    let at = best.value.and_then(|value| {
        places.into_iter().min_by(|&a, &b| (xs[a] - value).abs().total_cmp(&(xs[b] - value).abs()))
    });
    Searched { best, unresolved, at }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elementary::exp;
    use crate::reliability::probability::Proportion;

    #[test]
    fn analytic_the_least_point_of_a_parabola_is_found_and_ends_have_no_interval() {
        // ln P is a parabola about 103, the same counts in every group.
        let cells = |centre: f64| -> Vec<Sampled> {
            let part = |x: f64| {
                let share = 0.01 * exp((x - centre) * (x - centre) / 400.0);
                Proportion { breaches: (share * 1e6) as u64, faults: 0, samples: 1_000_000 }
            };
            let cell = |k: usize| {
                let group = part(80.0 + 5.0 * k as f64);
                let any = Proportion {
                    breaches: 20 * group.breaches,
                    faults: 0,
                    samples: 20 * group.samples,
                };
                Sampled {
                    any,
                    limits: Vec::new(),
                    groups: vec![group; GROUPS],
                    quantiles: Vec::new(),
                }
            };
            (0..9).map(cell).collect()
        };
        let xs: Vec<f64> = (0..9).map(|k| 80.0 + 5.0 * k as f64).collect();
        let found = |centre: f64| {
            let cells = cells(centre);
            least(&xs, &cells.iter().collect::<Vec<_>>())
        };
        let inside = found(103.0);
        assert!((inside.best.value.unwrap() - 103.0).abs() < 0.01, "{inside:?}");
        assert_eq!((inside.at, inside.unresolved), (Some(5), None));
        let end = found(60.0);
        assert_eq!((end.best.value, end.at), (Some(80.0), Some(0)));
        assert_eq!(end.unresolved, Some(Unresolved::EndOfRange));
    }

    #[test]
    fn analytic_runs_and_crossings_of_a_margin() {
        let margins = [-1.0, 1.0, 2.0, 1.0, -3.0, 0.5];
        let xs = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(feasible(&xs, &margins), Some((0.5, 3.25)));
        assert_eq!(feasible(&xs, &[1.0; 6]), Some((0.0, 5.0)));
        assert_eq!(feasible(&xs, &[-1.0; 6]), None);
    }
}
