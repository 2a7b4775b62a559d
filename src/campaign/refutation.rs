//! Refuting plans of tightenings by counting: the points that breached under plans before come first, and
//! counting ends as soon as there are more breaches than the aim allows.
//!
//! That is exact: more points can only add breaches. A plan that misses its aim is refuted by a few hundred
//! points instead of all of them.

use super::common_numbers::{CommonSample, Event};
use super::tighten::change;
use super::{Progress, in_parallel};
use crate::error::Result;
use crate::sensitivity::pick_freeze::Factor;
use crate::study::DesignRange;

/// Settings of a design value over its whole range.
const COARSE: usize = 13;
/// Settings within two coarse steps of the plan in hand, each side.
const FINE: usize = 12;
/// Points that are counted first.
const FIRST: usize = 256;
/// Descents that a proof may take: half a minute of two cores at most.
pub(super) const MOST_DESCENTS: u64 = 20_000_000;

/// The points of a sample for one setting of the design values, those first that are likeliest to breach.
struct Setting {
    design: Vec<f64>,
    order: Vec<u32>,
}

/// The settings of the design values at which plans are looked at.
pub(super) struct Refutation<'s, 'a> {
    sample: &'s CommonSample<'a>,
    factors: &'s [Factor],
    allowed: u64,
    settings: Vec<Setting>,
}

impl<'s, 'a> Refutation<'s, 'a> {
    /// Settings about the design values of a plan in hand, whose probability must not exceed `aim`.
    ///
    /// # Errors
    /// If a law cannot be stretched so.
    pub(super) fn new(
        sample: &'s CommonSample<'a>,
        factors: &'s [Factor],
        plan: (&[f64], &[f64]),
        aim: f64,
        progress: &Progress,
    ) -> Result<Self> {
        let (spreads, design) = plan;
        let order: Vec<u32> = (0..sample.rows() as u32).collect();
        let designs = designs(&sample.study().tighten.design, design);
        let settings = designs.into_iter().map(|design| Setting { design, order: order.clone() });
        let allowed = (aim * sample.rows() as f64).floor() as u64;
        let mut refutation = Refutation { sample, factors, allowed, settings: settings.collect() };
        // What breaches as things are, and before that what breaches under the plan in hand.
        for spreads in [vec![1.0; factors.len()], spreads.to_vec()] {
            refutation.sorted_by(&spreads, progress)?;
        }
        Ok(refutation)
    }

    /// Settings that are looked at.
    pub(super) fn settings(&self) -> usize {
        self.settings.len()
    }

    /// Puts first, at every setting, the points that breach at these spreads.
    fn sorted_by(&mut self, spreads: &[f64], progress: &Progress) -> Result<()> {
        let study = self.sample.study();
        for setting in &mut self.settings {
            let change = change(study, self.factors, spreads, &setting.design)?;
            let breaches = self.sample.changed(&change, progress)?;
            let breached = |row: &u32| breaches.happened(Event::Any, *row as usize) != Some(false);
            let (first, then): (Vec<u32>, Vec<u32>) =
                setting.order.iter().partition(|row| breached(row));
            setting.order = [first, then].concat();
        }
        Ok(())
    }

    /// The design values, of those looked at, at which these spreads reach the aim; `None` if they do at none.
    ///
    /// # Errors
    /// If a law cannot be stretched so.
    pub(super) fn reached(
        &mut self,
        spreads: &[f64],
        progress: &Progress,
    ) -> Result<Option<Vec<f64>>> {
        let (sample, factors, allowed) = (self.sample, self.factors, self.allowed);
        let counted = in_parallel(&self.settings, |setting| -> Result<(bool, usize, Vec<u32>)> {
            let change = change(sample.study(), factors, spreads, &setting.design)?;
            let mut breached: Vec<u32> = Vec::new();
            let (mut at, mut size) = (0, FIRST);
            while at < setting.order.len() && breached.len() as u64 <= allowed {
                let rows = &setting.order[at..(at + size).min(setting.order.len())];
                let breaches = sample.rows_of(rows).changed(&change, progress)?;
                let happened = |k: &usize| breaches.happened(Event::Any, *k) != Some(false);
                breached.extend((0..rows.len()).filter(happened).map(|k| rows[k]));
                at += rows.len();
                size *= 2;
            }
            Ok((breached.len() as u64 <= allowed, at, breached))
        });
        let mut found = None;
        for (setting, counted) in self.settings.iter_mut().zip(counted) {
            let (reached, looked_at, breached) = counted?;
            if reached && found.is_none() {
                found = Some(setting.design.clone());
            }
            to_the_front(&mut setting.order[..looked_at], &breached);
        }
        Ok(found)
    }
}

/// Moves some of the rows before the others, both in their order. They are in it in this order.
fn to_the_front(rows: &mut [u32], first: &[u32]) {
    let mut wanted = first.iter().peekable();
    let others: Vec<u32> = rows
        .iter()
        .copied()
        .filter(|row| {
            let is = wanted.peek() == Some(&row);
            if is {
                wanted.next();
            }
            !is
        })
        .collect();
    let moved = first.iter().copied().chain(others);
    rows.iter_mut().zip(moved).for_each(|(row, moved)| *row = moved);
}

/// The plan's own design values, then each of them alone over its range and close about the plan's.
fn designs(ranges: &[DesignRange], plan: &[f64]) -> Vec<Vec<f64>> {
    let mut designs = vec![plan.to_vec()];
    for (d, range) in ranges.iter().enumerate() {
        let step = (range.upper - range.lower) / (COARSE - 1) as f64;
        let close = (1..=FINE).map(|k| 2.0 * step * k as f64 / FINE as f64);
        let close = close.flat_map(|off| [plan[d] - off, plan[d] + off]);
        let whole = (0..COARSE).map(|k| range.lower + step * k as f64);
        let inside = |value: &f64| (range.lower..=range.upper).contains(value);
        for value in close.chain(whole).filter(inside) {
            let mut design = plan.to_vec();
            design[d] = value;
            designs.push(design);
        }
    }
    designs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_rows_move_to_the_front_and_none_is_lost() {
        let mut rows = [5, 3, 9, 1, 7];
        to_the_front(&mut rows, &[3, 7]);
        assert_eq!(rows, [3, 7, 5, 9, 1]);
        to_the_front(&mut rows, &[]);
        assert_eq!(rows, [3, 7, 5, 9, 1]);
    }
}
