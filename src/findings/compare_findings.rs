//! What two runs' findings say of margins and drivers, side by side.

use super::compare::{DriverChange, FinishedRun, MarginChange};
use serde_json::Value;

/// Drivers listed.
const DRIVERS: usize = 6;

/// The margins that shares of flights keep, by the limits of both runs.
pub(super) fn margins(
    before: &FinishedRun,
    after: &FinishedRun,
    both: &[(usize, usize)],
) -> Vec<MarginChange> {
    let list = |run: &FinishedRun, limit: &str| -> Vec<(f64, Option<f64>)> {
        let all = run.findings["margins"].as_array();
        let found = all.into_iter().flatten().find(|margin| margin["limit"] == limit);
        let quantiles = found.and_then(|margin| margin["quantiles"].as_array());
        let row = |q: &Value| Some((q["share"].as_f64()?, q["margin"].as_f64()));
        quantiles.into_iter().flatten().filter_map(row).collect()
    };
    let mut changes = Vec::new();
    for &(i, _) in both {
        let limit = &before.study.limits[i];
        let other = list(after, &limit.name());
        for (share, margin) in list(before, &limit.name()) {
            if let Some((_, then)) = other.iter().find(|(s, _)| *s == share) {
                changes.push(MarginChange {
                    limit: limit.name(),
                    quantity: limit.outcome,
                    share,
                    before: margin,
                    after: *then,
                });
            }
        }
    }
    changes
}

type Index = (f64, Option<(f64, f64)>);

/// The total indices of "any breach", factors that belong to a group left out.
fn indices(run: &FinishedRun) -> Vec<(String, Index)> {
    let outputs = run.findings["drivers"]["outputs"].as_array();
    let ranks = |output: &&Value| output["name"] == "breach.any" && output["too_few"].is_null();
    let any = outputs.into_iter().flatten().find(ranks);
    let factors = any.and_then(|output| output["factors"].as_array());
    let index = |factor: &Value| {
        let total = &factor["total"];
        let ends = &total["interval"];
        let interval = ends["lower"].as_f64().zip(ends["upper"].as_f64());
        Some((factor["name"].as_str()?.to_owned(), (total["value"].as_f64()?, interval)))
    };
    let alone = factors.into_iter().flatten().filter(|factor| factor["grouped"] != true);
    alone.filter_map(index).collect()
}

/// The strongest drivers of "any breach" in either run.
pub(super) fn drivers(before: &FinishedRun, after: &FinishedRun) -> Vec<DriverChange> {
    let (first, second) = (indices(before), indices(after));
    let find = |list: &[(String, Index)], name: &str| {
        list.iter().find(|(factor, _)| factor == name).map(|(_, index)| *index)
    };
    let mut names: Vec<&String> = first.iter().chain(&second).map(|(name, _)| name).collect();
    names.sort();
    names.dedup();
    let mut changes: Vec<DriverChange> = names
        .into_iter()
        .map(|name| DriverChange {
            factor: name.clone(),
            before: find(&first, name),
            after: find(&second, name),
        })
        .collect();
    let largest = |change: &DriverChange| {
        let of = |index: &Option<Index>| index.map_or(f64::NEG_INFINITY, |(value, _)| value);
        of(&change.before).max(of(&change.after))
    };
    changes.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
    changes.truncate(DRIVERS);
    changes
}
