//! The figures of a sweep, from small ones of the default study.

use crate::figures::assert_complete;
use reeldown::campaign::Progress;
use reeldown::campaign::sweep::{Grid, SweptPath, run_sweep};
use reeldown::findings::known::GoAnswer;
use reeldown::findings::sweep::{SweepFinding, sweep};
use reeldown::render::{sweep_figures, sweep_markdown, sweep_terminal};
use reeldown::study::Over;

fn finding(overs: &[&str], samples: Option<u64>) -> SweepFinding {
    let study = crate::habe::pinned(&[]);
    let path = |text: &&str| SweptPath::of(&study, &Over::parse("--over", text).unwrap());
    let grid = Grid { paths: overs.iter().map(path).collect() };
    let progress = Progress::default();
    let cells = run_sweep(&study, &grid, samples, &progress).unwrap().unwrap();
    let command = "reeldown sweep".to_owned();
    sweep(&study, &grid, &cells, samples, command, &progress).unwrap().unwrap()
}

const VISCOSITY: &str = "fluid.nominal_viscosity=80000cSt..160000cSt:5";
const TEMPERATURE: &str = "initial.temperature=0°F..100°F:4";

#[test]
fn property_sweeps_are_drawn_whole_and_said_in_words() {
    for (overs, samples, figures) in [
        (&[VISCOSITY][..], Some(100), 6),
        (&[TEMPERATURE], None, 5),
        (&[VISCOSITY, TEMPERATURE], Some(100), 3),
        // The launch temperature is given and the viscosity chosen, whichever is named first.
        (&[TEMPERATURE, VISCOSITY], Some(100), 3),
        (&[VISCOSITY, TEMPERATURE], None, 1),
    ] {
        let finding = finding(overs, samples);
        let drawn = sweep_figures(&finding);
        assert_eq!(drawn.len(), figures, "{overs:?}");
        for figure in &drawn {
            assert_complete(figure);
        }
        let text = sweep_terminal(&finding) + &sweep_markdown(&finding, &drawn);
        for word in ["NaN", "None", "Some(", "inf "] {
            assert!(!text.contains(word), "{word} in\n{text}");
        }
    }
}

#[test]
fn property_the_order_of_the_paths_does_not_change_what_is_best() {
    let one = finding(&[VISCOSITY, TEMPERATURE], Some(200));
    let other = finding(&[TEMPERATURE, VISCOSITY], Some(200));
    assert_eq!((one.choice, other.choice), (0, 1));
    assert_eq!(one.best, other.best);
}

#[test]
fn analytic_the_chosen_value_trades_one_limit_for_another() {
    let finding = finding(&["fluid.nominal_viscosity=80000cSt..160000cSt:9"], Some(2000));
    // A thicker fluid is slower: the time limit gains breaches and the velocity limit loses them, row by
    // row of the same points, so neither is a matter of luck.
    let shares = |k: usize| finding.cells.iter().map(move |cell| cell.counts[k].breaches);
    let (time, velocity): (Vec<u64>, Vec<u64>) = (shares(1).collect(), shares(2).collect());
    assert!(time.is_sorted(), "{time:?}");
    assert!(velocity.is_sorted_by(|a, b| a >= b), "{velocity:?}");
    // The least of their sum lies between the ends, with an interval.
    let best = &finding.best[0].best;
    let interval = best.interval.interval().unwrap();
    assert!(interval.lower > 0.09 && interval.upper < 0.115, "{best:?}");
}

/// The published sweep's two warmest rows, whose best cells 200 000 independent descents each put at 1.284 ± 0.025 % and
/// 0.692 ± 0.019 %. The points that chose the cells say 1.009 % (0.83 … 1.21) and 0.4818 % (0.361 … 0.630).
#[test]
fn published_what_was_found_by_looking_is_estimated_anew() {
    let overs =
        ["fluid.nominal_viscosity=80000cSt..160000cSt:33", "initial.temperature=80°F..100°F:2"];
    let finding = finding(&overs, Some(11_000));
    for (row, right, error) in [(0, 0.01284, 0.00025), (1, 0.00692, 0.00019)] {
        let probability = finding.best[row].probability.as_ref().unwrap();
        let interval = probability.interval.interval().unwrap();
        // 95 % intervals, and the reference's standard error.
        assert!(
            interval.lower < right + error && right - error < interval.upper,
            "{probability:?}"
        );
        assert!(interval.width() < 0.002, "{probability:?}");
        let value = finding.best[row].best.value.unwrap();
        let searched = finding
            .cells
            .iter()
            .filter(|cell| Some(cell.values[1]) == finding.best[row].given)
            .min_by(|a, b| (a.values[0] - value).abs().total_cmp(&(b.values[0] - value).abs()))
            .unwrap();
        assert_eq!(searched.confirmed.as_ref(), Some(probability));
        let old = searched.any.as_ref().unwrap().interval.interval().unwrap();
        assert!(old.upper < right, "the search's own points: {old:?}");
    }
    // A cell is called demonstrated by the fresh points alone.
    let limit = finding.required.unwrap().0;
    for cell in &finding.cells {
        let counts = cell.confirmed_counts.as_ref();
        if cell.answer == GoAnswer::Go {
            let counts = counts.expect("every cell that is called demonstrated is estimated anew");
            assert!(counts.estimate().unwrap() < limit, "{counts:?}");
        }
    }
    assert!(finding.method.iter().any(|line| line.contains("err together")));
}
