//! A plan of shards: one small file that any machine can take a part of a run from, and that says when all parts
//! are there.

use super::parentage;
use crate::error::{Error, Result};
use crate::store::{OutcomesReader, Parentage, write_text};
use crate::study::{Study, sha256};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The layout of plans that this version reads and writes.
const FORMAT: u64 = 1;
/// Bytes that a plan may have: texts of study and cards, and their digests.
const LONGEST: u64 = 64 << 20;
/// Footer entry of a shard: the digest of its plan.
const PLAN: &str = "plan_digest";
/// Footer entry of a shard: which it is.
const SHARD: &str = "shard";
/// The version that makes, reads and merges.
const VERSION: &str = env!("CARGO_PKG_VERSION");
const HELP: &str = "expected a plan that `reeldown plan` has written";

/// A plan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan {
    format: u64,
    /// The command that gives the same results on one machine.
    pub command: String,
    /// The study's short name.
    pub name: String,
    /// Number of samples.
    pub samples: u64,
    /// Number of shards.
    pub shards: u64,
    /// What the footer of the whole table says of its parents.
    parentage: BTreeMap<String, String>,
    /// SHA-256 of the plan, taken without this entry's value.
    digest: String,
}

/// A shard as it is found.
#[derive(Debug)]
pub(super) enum Shard {
    /// It is there, and every row group matches its checksum.
    Done(Box<OutcomesReader>),
    /// It is not, and why in a few words.
    Missing(String),
}

impl Plan {
    /// The plan of a study's samples.
    ///
    /// # Errors
    /// If there are not that many samples, or the plan cannot be written as text.
    pub fn new(study: &Study, name: &str, command: String, shards: u64) -> Result<Self> {
        let samples = study.sampling.samples;
        if !(1..=samples).contains(&shards) {
            return Err(Error::argument(format!(
                "--shards {shards}: expected a whole number from 1 to the number of samples, {samples}"
            )));
        }
        let parentage = parentage::of(study).0;
        let (name, digest) = (name.to_owned(), String::new());
        let mut plan = Plan { format: FORMAT, command, name, samples, shards, parentage, digest };
        plan.digest = plan.digest()?;
        Ok(plan)
    }

    fn digest(&self) -> Result<String> {
        Ok(sha256(Plan { digest: String::new(), ..self.clone() }.text()?.as_bytes()))
    }

    /// The plan as text.
    ///
    /// # Errors
    /// None that a plan has shown.
    pub fn text(&self) -> Result<String> {
        let text = serde_json::to_string_pretty(self);
        let text = text.map_err(|why| Error::argument(format!("no plan can be written: {why}")))?;
        Ok(text + "\n")
    }

    /// Reads a plan, and makes its study.
    ///
    /// # Errors
    /// If it cannot be read, was changed, or is of another version.
    pub fn read(path: &Path) -> Result<(Self, Study)> {
        let fail = |reason: String| Error::file(path, "read", reason, HELP);
        let there = std::fs::metadata(path).map_err(|why| fail(why.to_string()))?;
        if !there.is_file() || there.len() > LONGEST {
            return Err(fail("it is not a regular file of at most 64 MiB".to_owned()));
        }
        let bytes = std::fs::read(path).map_err(|why| fail(why.to_string()))?;
        let plan: Plan = serde_json::from_slice(&bytes).map_err(|why| fail(why.to_string()))?;
        if plan.format != FORMAT || plan.digest()? != plan.digest {
            return Err(fail(
                "it was changed after it was made, or is of another version".to_owned(),
            ));
        }
        let study = parentage::study(path, &plan.parentage())?;
        let same = study.sampling.samples == plan.samples
            && (1..=plan.samples).contains(&plan.shards)
            && parentage::of(&study) == plan.parentage();
        if !same {
            return Err(fail("the study made of its texts is another one".to_owned()));
        }
        Ok((plan, study))
    }

    /// Writes the plan, unless it is there already.
    ///
    /// # Errors
    /// If another plan is there and is not to be replaced, or it cannot be written.
    pub fn write(&self, path: &Path, force: bool) -> Result<()> {
        let text = self.text()?;
        match std::fs::read(path) {
            Ok(there) if there == text.as_bytes() => Ok(()),
            Ok(_) if !force => {
                let help = "name another directory with --out, or say --force: shards of another plan are computed anew";
                Err(Error::file(path, "write", "another plan is there", help))
            }
            _ => write_text(path, &text),
        }
    }

    fn parentage(&self) -> Parentage {
        Parentage(self.parentage.clone())
    }

    /// Samples of shard `k`.
    pub fn range(&self, k: u64) -> Range<u64> {
        // In 128 bits nothing overflows.
        let start =
            |k: u64| (u128::from(self.samples) * u128::from(k) / u128::from(self.shards)) as u64;
        start(k)..start(k + 1)
    }

    /// Where shard `k` of a plan in a directory is.
    pub fn shard_path(&self, plan: &Path, k: u64) -> PathBuf {
        plan.with_file_name(format!("shard-{k:05}-of-{:05}.parquet", self.shards))
    }

    /// What the footer of shard `k` says.
    pub fn shard_parentage(&self, k: u64) -> Parentage {
        let own = [
            (crate::store::FIRST_SAMPLE, self.range(k).start.to_string()),
            (PLAN, self.digest.clone()),
            (SHARD, format!("{k} of {}", self.shards)),
        ];
        let own = own.into_iter().map(|(key, value)| (key.to_owned(), value));
        Parentage(self.parentage.clone().into_iter().chain(own).collect())
    }

    /// Looks for shard `k` of a plan, and reads all of it.
    pub fn shard(&self, plan: &Path, k: u64) -> Shard {
        let path = self.shard_path(plan, k);
        if !path.exists() {
            return Shard::Missing("it is not there".to_owned());
        }
        let reader = match OutcomesReader::open(&path) {
            Ok(reader) => reader,
            Err(error) => return Shard::Missing(error.to_string()),
        };
        let range = self.range(k);
        let right = *reader.parentage() == self.shard_parentage(k)
            && (reader.first(), reader.first().saturating_add(reader.rows()))
                == (range.start, range.end);
        if !right {
            let version = reader.parentage().0.get("version").filter(|&v| v != VERSION);
            let other =
                version.map(|v| format!("it was made by reeldown {v}, and this is {VERSION}"));
            return Shard::Missing(other.unwrap_or_else(|| "it is of another plan".to_owned()));
        }
        match reader.verify() {
            Ok(()) => Shard::Done(Box::new(reader)),
            Err(error) => Shard::Missing(error.to_string()),
        }
    }
}

/// Numbers in ascending order as engines write array indices: `3,7-9`.
pub(super) fn compact(numbers: &[u64]) -> String {
    let mut ranges: Vec<(u64, u64)> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let text = |&(first, last): &(u64, u64)| match first == last {
        true => first.to_string(),
        false => format!("{first}-{last}"),
    };
    ranges.iter().map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_array_indices_are_compact() {
        for (numbers, text) in
            [(&[][..], ""), (&[3], "3"), (&[3, 7, 8, 9], "3,7-9"), (&[0, 1, 4, 6, 7], "0-1,4,6-7")]
        {
            assert_eq!(compact(numbers), text);
        }
    }

    #[test]
    fn property_shards_follow_each_other_without_a_gap_and_differ_by_one() {
        for (samples, shards) in [(7, 3), (100_000, 64), (u64::MAX, 1000), (5, 5), (9, 1)] {
            let plan = Plan {
                format: FORMAT,
                command: String::new(),
                name: String::new(),
                samples,
                shards,
                parentage: BTreeMap::new(),
                digest: String::new(),
            };
            let mut next = 0;
            for k in 0..shards {
                let range = plan.range(k);
                assert_eq!(range.start, next);
                assert!((samples / shards..=samples / shards + 1).contains(&(range.end - next)));
                next = range.end;
            }
            assert_eq!(next, samples);
        }
    }
}
