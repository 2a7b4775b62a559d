//! What two runs' findings say of margins and drivers, side by side.

use super::{DriverChange, FinishedRun, MarginChange};
use crate::findings::{DriverOutput, FactorFinding, Output};

/// Drivers listed.
const DRIVERS: usize = 6;

/// The margins that shares of flights keep, by the limits of both runs.
pub(super) fn margins(
    before: &FinishedRun,
    after: &FinishedRun,
    both: &[(usize, usize)],
) -> Vec<MarginChange> {
    let list = |run: &FinishedRun, limit: &str| -> Vec<(f64, Option<f64>)> {
        let found = run.findings.margins.iter().find(|margin| margin.limit == limit);
        let quantiles = found.into_iter().flat_map(|margin| &margin.quantiles);
        quantiles.map(|quantile| (quantile.share, quantile.margin)).collect()
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
    let ranks =
        |output: &&DriverOutput| output.name == Output::AnyBreach && output.too_few.is_none();
    let any = run.findings.drivers.outputs.iter().find(ranks);
    let index = |factor: &FactorFinding| {
        let total = &factor.indices.total;
        let interval = total.interval.interval().map(|ends| (ends.lower, ends.upper));
        Some((factor.name.to_string(), (total.value?, interval)))
    };
    let alone = any.into_iter().flat_map(|output| &output.factors).filter(|factor| !factor.grouped);
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
