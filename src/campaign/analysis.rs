//! What an analysis is: it says what it takes, or why a study has none of it, and computes.

use super::{Progress, Record};
use crate::error::{Error, Result};
use crate::study::Study;
use std::fmt;

/// A study whose samples have been run.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// The study.
    pub study: &'a Study,
    /// What its samples have shown.
    pub record: &'a Record,
    /// Who watches, and may ask for a stop.
    pub progress: &'a Progress,
}

/// Something to find out about a study, beside what its samples show by themselves.
pub trait Analysis<'a>: Sized {
    /// What it is called while somebody waits for it.
    const NAME: &'static str;

    /// Evaluations of the model that it takes, about.
    ///
    /// # Errors
    /// Why a study has none of it.
    fn cost(study: &Study) -> Found<u64>;

    /// Computes it for a study of which [`Self::cost`] is known. `None` if `progress` asks for a stop; what was computed
    /// then is in part.
    ///
    /// # Errors
    /// What a method refuses.
    fn compute(run: Run<'a>) -> Result<Option<Self>>;
}

/// What was found, or why it was not.
pub type Found<T> = std::result::Result<T, Absent>;

/// Why a study has no results of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub enum Absent {
    /// It asks for none: this number of it is zero.
    NotAsked(&'static str),
    /// It states no limit that could be breached.
    NoLimit,
    /// No card of it is a calibrated one that follows others.
    NotCalibrated,
    /// Its inputs depend on each other.
    Correlated,
    /// Of every input of it the card says that it varies.
    NothingUnknown,
    /// Of no input of it the card says that it varies.
    NothingVaries,
    /// A method refused it.
    Refused(Error),
}

impl Absent {
    /// That a study asks for none of an analysis, if `number`, its `key`, is zero.
    pub fn unless_asked(key: &'static str, number: u64) -> Found<()> {
        if number == 0 { Err(Absent::NotAsked(key)) } else { Ok(()) }
    }

    /// That a study has no limit, if it has none.
    pub fn unless_limited(study: &Study) -> Found<()> {
        if study.limits.is_empty() { Err(Absent::NoLimit) } else { Ok(()) }
    }
}

impl fmt::Display for Absent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Absent::NotAsked(key) => return write!(f, "the study asks for none ({key} = 0)"),
            Absent::Refused(error) => return error.fmt(f),
            Absent::NoLimit => "the study states no limit",
            Absent::NotCalibrated => "no card of the study is a calibrated one that follows others",
            Absent::Correlated => {
                "Sobol' indices divide the variance among independent inputs; these are correlated, so a share of it \
                 belongs to several at once and the indices would mislead"
            }
            Absent::NothingUnknown => {
                "the card says of every input that it varies from flight to flight, and nothing is unknown"
            }
            Absent::NothingVaries => {
                "the card says of no input that it varies from flight to flight: with what is unknown, a breach is \
                 decided"
            }
        })
    }
}

impl From<Error> for Absent {
    fn from(error: Error) -> Self {
        Absent::Refused(error)
    }
}

/// Computes an analysis if a study has any of it. `None` if `progress` asks for a stop.
pub fn find<'a, A: Analysis<'a>>(run: Run<'a>) -> Option<Found<A>> {
    let cost = match A::cost(run.study) {
        Ok(cost) => cost,
        Err(why) => return Some(Err(why)),
    };
    run.progress.begin(A::NAME, cost);
    let found = A::compute(run).transpose();
    if run.progress.stopping() { None } else { Some(found?.map_err(Absent::Refused)) }
}

/// What was found, or nothing where a study has none of it.
///
/// # Errors
/// What a method refused.
pub fn if_any<T>(found: &Found<T>) -> Result<Option<&T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(Absent::Refused(error)) => Err(error.clone()),
        Err(_) => Ok(None),
    }
}
