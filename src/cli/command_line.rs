//! Commands as a person would type them.

use super::arguments::SampledStudy;

/// The command that computes a study on this machine.
pub(super) fn run_of(sampled: &SampledStudy) -> String {
    let mut words = vec!["reeldown".to_owned(), "run".to_owned()];
    if let Some(study) = &sampled.study.study {
        words.push(quoted(&study.display().to_string()));
    }
    for (option, value) in [("--samples", &sampled.samples), ("--seed", &sampled.seed)] {
        words.extend(value.iter().map(|value| format!("{option} {}", quoted(value))));
    }
    words.extend(sampled.study.set.iter().map(|s| format!("--set {}", quoted(s))));
    words.join(" ")
}

/// A word of a command line, quoted if the shell would take it apart.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
