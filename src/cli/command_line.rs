//! Commands as a person would type them.

use super::arguments::{SampledStudy, StudyArguments};

/// A command that gives the same numbers again.
#[derive(Debug, Clone)]
pub(super) struct CommandLine(String);

impl CommandLine {
    /// A command, and its study if one is named.
    pub fn new(name: &str, study: &StudyArguments) -> Self {
        let study = study.study.as_ref().map(|path| quoted(&path.display().to_string()));
        CommandLine(format!("reeldown {name}")).words(study)
    }

    /// An option with each of its values.
    pub fn option<V: ToString>(self, name: &str, values: impl IntoIterator<Item = V>) -> Self {
        self.words(values.into_iter().map(|v| format!("{name} {}", quoted(&v.to_string()))))
    }

    /// An option without a value, if it was given.
    pub fn flag(self, name: &str, given: bool) -> Self {
        self.words(given.then(|| name.to_owned()))
    }

    /// What `--set` changes.
    pub fn set(self, study: &StudyArguments) -> Self {
        self.option("--set", &study.set)
    }

    /// The command as one line.
    pub fn line(self) -> String {
        self.0
    }

    fn words(mut self, words: impl IntoIterator<Item = String>) -> Self {
        words.into_iter().for_each(|word| self.0 += &format!(" {word}"));
        self
    }
}

/// The command that computes a study on this machine.
pub(super) fn run_of(sampled: &SampledStudy) -> String {
    let command = CommandLine::new("run", &sampled.study);
    let command = command.option("--samples", &sampled.samples).option("--seed", &sampled.seed);
    command.set(&sampled.study).line()
}

/// A word of a command line, quoted if the shell would take it apart.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
