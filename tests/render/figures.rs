//! The figures as SVG documents.

use crate::sample::{independent, replicated};
use reeldown::descent::Model;
use reeldown::findings::paper_runs;
use reeldown::physics::Design;
use reeldown::render::{Figure, figures, paper_figures};
use std::collections::BTreeSet;

/// Panics unless every tag is closed in order, and returns the text content.
fn well_formed(figure: &Figure) -> String {
    let mut open: Vec<String> = Vec::new();
    let mut text = String::new();
    for part in figure.svg.split('<').skip(1) {
        let (tag, after) =
            part.split_once('>').unwrap_or_else(|| panic!("{}: {part}", figure.name));
        if tag.starts_with('!') || tag.starts_with('?') {
            continue;
        }
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(closed), "{}", figure.name);
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap().to_owned());
        }
        text += after;
        text.push('\n');
    }
    assert!(open.is_empty(), "{}: {open:?}", figure.name);
    text
}

/// Panics unless a figure is well formed, scales, has a name, and shows numbers only.
pub fn assert_complete(figure: &Figure) {
    let text = well_formed(figure);
    assert!(text.contains(&figure.title), "{}", figure.name);
    assert!(figure.svg.contains("viewBox=\"0 0 520 ") && figure.svg.contains("role=\"img\""));
    for number in ["NaN", "inf"] {
        let numbers = figure.svg.replace("informa", "");
        assert!(!numbers.contains(number), "{} in {}", number, figure.name);
    }
    assert!(!figure.caption.is_empty() && !figure.alternative.is_empty());
}

fn paper() -> Vec<Figure> {
    paper_figures(&paper_runs(&Design::baseline(), Model::QuasiSteady).unwrap())
}

#[test]
fn property_figures_are_well_formed_scale_and_have_a_name() {
    let run = figures(&independent().findings);
    let other = figures(&replicated().findings);
    assert_eq!(run.all().count(), 19);
    for figure in run.all().chain(other.all()).chain(&paper()) {
        assert_complete(figure);
    }
    let names: BTreeSet<&str> = run.all().map(|figure| figure.name.as_str()).collect();
    assert_eq!(names.len(), run.all().count());
}

#[test]
fn property_axes_name_the_paper_s_units_and_limits_are_labelled() {
    let run = figures(&independent().findings);
    for (name, texts) in [
        ("histogram-time", ["reel-down time (s)", "limit 210 s"]),
        ("tail-time", ["reel-down time (s)", "limit 210 s"]),
        ("histogram-final_velocity", ["final separation velocity (ft/s)", "samples"]),
        ("histogram-peak_fluid_temperature", ["peak fluid temperature (°F)", "samples"]),
        ("fan-temperature", ["fluid temperature (°F)", "limit 450 °F"]),
        ("fan-velocity", ["separation velocity (ft/s)", "limit 2.5 ft/s at the end of the line"]),
        ("fan-line", ["time since release (s)", "line paid out (ft)"]),
        ("convergence", ["probability of any breach", "allowed 1 %"]),
    ] {
        let figure = run.all().find(|figure| figure.name == name).unwrap();
        for text in texts {
            assert!(figure.svg.contains(text), "{name} lacks {text}");
        }
    }
}

#[test]
fn property_the_same_findings_give_the_same_bytes() {
    let findings = &independent().findings;
    assert_eq!(figures(findings), figures(findings));
    assert_eq!(paper(), paper());
}

#[test]
fn published_the_paper_s_figures_show_what_it_says_of_them() {
    let runs = paper_runs(&Design::baseline(), Model::QuasiSteady).unwrap();
    let samples = &runs.descent.samples;
    // "the torque on the brake is monotonically decreasing with time"
    assert!(samples.windows(2).all(|pair| pair[1].torque_nm <= pair[0].torque_nm));
    // Reel speed, power and rollout velocity rise and then fall; fluid temperature rises.
    for reading in [2, 3, 4] {
        let values: Vec<f64> = samples.iter().map(|s| s.observation[reading]).collect();
        let top = values.iter().copied().fold(0.0, f64::max);
        assert!(values[0] < top && *values.last().unwrap() < top, "reading {reading}");
    }
    assert!(samples.windows(2).all(|pair| pair[1].temperatures_k[0] >= pair[0].temperatures_k[0]));
    let names: Vec<String> = paper_figures(&runs).into_iter().map(|figure| figure.name).collect();
    assert_eq!(names.len(), 6);
}
