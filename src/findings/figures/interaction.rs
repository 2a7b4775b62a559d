//! Where in the plane of the two strongest inputs a breach happens.

use crate::campaign::common_numbers::CommonSample;
use crate::campaign::{self, Record};
use crate::error::Result;
use crate::findings::drivers::{DriverOutput, DriversFinding};
use crate::findings::named::Output;
use crate::sensitivity::pick_freeze::Factor;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// Samples shown: the first of the run.
const SHOWN: u64 = 2000;
/// Breaches wanted among them; if there are fewer, later ones of the run are added.
const WANTED: usize = 100;

/// A thinned sample in the plane of two inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interaction {
    /// The output whose drivers were ranked, in words.
    pub output: String,
    /// The strongest input.
    pub x: InteractionInput,
    /// The next.
    pub y: InteractionInput,
    /// Which samples of the run are shown, by their index: their values are the rows of the table of samples.
    pub samples: Samples,
    /// Whether each sample breached any limit.
    #[serde(skip)]
    pub breached: Vec<bool>,
    /// How many of them, the last ones, are breaches of later samples, added because they are rare.
    pub added: usize,
}

/// Which samples are shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// All of the first so many that could be computed.
    pub first: usize,
    /// Breaches among the later ones.
    pub and: Vec<usize>,
    /// How many of the first ones breached.
    pub breached: usize,
}

/// One input of each sample shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InteractionInput {
    /// Path, or name of the statement whose inputs are averaged.
    pub path: String,
    /// How many inputs are averaged.
    pub inputs: usize,
    /// Values, SI: too many for a tree of findings.
    #[serde(skip)]
    pub values: Vec<f64>,
}

/// The sample, or why there is none.
pub(super) fn interaction(
    study: &Study,
    record: &Record,
    drivers: &DriversFinding,
) -> Result<std::result::Result<Interaction, String>> {
    if let Some(why) = &drivers.none {
        return Ok(Err(format!("no inputs are ranked: {why}")));
    }
    if study.limits.is_empty() {
        return Ok(Err("the study states no limit".to_owned()));
    }
    let mut factors = campaign::factors(study);
    // The mean of different quantities has no meaning.
    factors.retain(|factor| {
        let parameter = |&j: &usize| study.inputs[j].target.parameter;
        factor.columns.windows(2).all(|pair| parameter(&pair[0]) == parameter(&pair[1]))
    });
    let Some((output, [first, second])) = strongest(study, drivers, &factors) else {
        return Ok(Err("no two inputs have a sensitivity index".to_owned()));
    };
    let columns_of = |name: &str| factors.iter().find(|factor| factor.name == name);
    let (Some(x), Some(y)) = (columns_of(first), columns_of(second)) else {
        return Ok(Err("no two inputs have a sensitivity index".to_owned()));
    };
    let total = record.margins(0).len();
    let breached = |k: usize| (0..study.limits.len()).any(|i| record.margins(i)[k] < 0.0);
    let known = |k: usize| (0..study.limits.len()).all(|i| !record.margins(i)[k].is_nan());
    let shown = total.min(SHOWN as usize);
    let mut chosen: Vec<usize> = (0..shown).filter(|&k| breached(k) || known(k)).collect();
    let seen = chosen.iter().filter(|&&k| breached(k)).count();
    let missing = WANTED.saturating_sub(seen);
    let rest: Vec<usize> = (shown..total).filter(|&k| breached(k)).take(missing).collect();
    let added = rest.len();
    let samples = Samples { first: shown, breached: seen, and: rest.clone() };
    chosen.extend(rest);
    let sample = CommonSample::of_rows(study, &chosen)?;
    let draws = sample.inputs();
    let input = |name: &str, columns: &[usize]| InteractionInput {
        path: name.to_owned(),
        inputs: columns.len(),
        values: (0..chosen.len())
            .map(|k| columns.iter().map(|&j| draws.get(k, j)).sum::<f64>() / columns.len() as f64)
            .collect(),
    };
    Ok(Ok(Interaction {
        output: output.title.clone(),
        samples,
        x: input(first, &x.columns),
        y: input(second, &y.columns),
        breached: chosen.iter().map(|&k| breached(k)).collect(),
        added,
    }))
}

/// The first output with two ranked factors: any breach, then the limited outcomes; with the two.
fn strongest<'a>(
    study: &Study,
    drivers: &'a DriversFinding,
    factors: &[Factor],
) -> Option<(&'a DriverOutput, [&'a str; 2])> {
    let limited = study.limits.iter().map(|limit| Output::Outcome(limit.outcome));
    std::iter::once(Output::AnyBreach).chain(limited).find_map(|name| {
        let ranks = |o: &&DriverOutput| o.name == name && o.too_few.is_none();
        let output = drivers.outputs.iter().find(ranks)?;
        let mut factors: Vec<(f64, &str)> = output
            .factors
            .iter()
            .filter(|factor| !factor.grouped)
            .filter(|factor| factors.iter().any(|shown| shown.name == factor.name.name))
            .filter_map(|factor| Some((factor.indices.total.value?, factor.name.name.as_str())))
            .collect();
        factors.sort_by(|a, b| b.0.total_cmp(&a.0));
        match factors.as_slice() {
            [(_, first), (_, second), ..] => Some((output, [*first, *second])),
            _ => None,
        }
    })
}
