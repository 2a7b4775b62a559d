//! The published studies in `reports/habe/` and `reports/calibrated/` and the reports beside them are of this version.
//!
//! To publish anew: `cargo run --release -- run reports/habe/study.toml --out runs/published-habe`, and copy
//! from `runs/published-habe/` what is published in `reports/habe/`; likewise `reports/calibrated/`, by way of
//! `runs/published-calibrated/`: a directory belongs to one study.

use super::program::{Answer, Place, program};
use std::path::{Path, PathBuf};

/// Every file below a directory, relative to it.
fn files_below(directory: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![directory.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(&next).expect("a directory") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.push(path.strip_prefix(directory).expect("below it").to_owned());
            }
        }
    }
    found.sort();
    found
}

#[test]
fn regression_the_published_report_is_what_this_version_writes() {
    is_what_this_version_writes("habe");
}

#[test]
fn regression_the_published_report_of_the_calibrated_brake_is_what_this_version_writes() {
    is_what_this_version_writes("calibrated");
}

fn is_what_this_version_writes(name: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let published = root.join("reports").join(name);
    let place = Place::new(&format!("published-{name}"));
    let out = place.at("run");
    let study = format!("reports/{name}/study.toml");
    let arguments = ["run", &study, "--quiet", "--out", &out];
    let run = program().args(arguments).current_dir(root).output().expect("the program starts");
    Answer::of(run).ended_with(3);
    let files = files_below(&published);
    let reports: Vec<&PathBuf> =
        files.iter().filter(|file| file.as_path() != Path::new("study.toml")).collect();
    assert!(
        reports.iter().any(|file| file.as_path() == Path::new("report.md")),
        "no report is published in reports/{name}/"
    );
    for file in reports {
        let written = std::fs::read(place.path().join("run").join(file))
            .unwrap_or_else(|why| panic!("a run does not write {}: {why}", file.display()));
        let kept = std::fs::read(published.join(file)).expect("a published file");
        assert!(
            written == kept,
            "reports/{name}/{} is not what this version writes: see the head of this file",
            file.display()
        );
    }
}
