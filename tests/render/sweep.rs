//! The figures of a sweep, from small ones of the default study.

use crate::figures::assert_complete;
use reeldown::campaign::Progress;
use reeldown::campaign::sweep::{Grid, SweptPath, run_sweep};
use reeldown::findings::sweep::{SweepFinding, sweep};
use reeldown::render::{sweep_figures, sweep_markdown, sweep_terminal};
use reeldown::study::{Over, Study};

fn finding(overs: &[&str], samples: Option<u64>) -> SweepFinding {
    let study = Study::load(None, &[]).unwrap();
    let path = |text: &&str| SweptPath::of(&study, &Over::parse("--over", text).unwrap());
    let grid = Grid { paths: overs.iter().map(path).collect() };
    let cells = run_sweep(&study, &grid, samples, &Progress::default()).unwrap().unwrap();
    sweep(&study, &grid, &cells, samples, "reeldown sweep".to_owned()).unwrap()
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
