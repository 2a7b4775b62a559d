//! Sums over the rows of a pick-freeze design, and the indices as functions of them.
//!
//! a, b are the outcomes of blocks A and B and w those of a further block. The outcomes are centred
//! first, so that differences of means of squares lose no digits.

use super::bootstrap::{Resampling, UnitSums};

/// Which column of the sums holds what, for each block beyond A and B.
pub(crate) struct Layout {
    /// Rows in which A and B are known.
    shared: Vec<bool>,
    /// One a block beyond A and B.
    pub(crate) places: Vec<Place>,
    columns: usize,
    /// Rows of a block.
    pub(crate) rows: usize,
}

/// Sums of one block: six of a and b over its rows, shared with others where the rows are the same,
/// and four of its own.
pub(crate) struct Place {
    common: usize,
    own: usize,
    /// Rows in which a, b and w are known.
    pub(crate) rows: usize,
}

/// Columns of the sums of a and b: count, a, b, a², b², ab.
const COMMON: usize = 6;
/// Columns of a block's own sums: w, w², bw, (a − w)².
const OWN: usize = 4;

impl Layout {
    pub(crate) fn of(blocks: &[&[f64]]) -> Self {
        let known = |row: usize| blocks[0][row].is_finite() && blocks[1][row].is_finite();
        let shared: Vec<bool> = (0..blocks[0].len()).map(known).collect();
        let shared_rows = shared.iter().filter(|known| **known).count();
        let mut columns = COMMON;
        let mut places = Vec::with_capacity(blocks.len() - 2);
        for block in &blocks[2..] {
            let missing =
                shared.iter().zip(*block).filter(|(known, w)| **known && !w.is_finite()).count();
            let common = if missing == 0 { 0 } else { columns };
            columns += if missing == 0 { 0 } else { COMMON };
            places.push(Place { common, own: columns, rows: shared_rows - missing });
            columns += OWN;
        }
        Layout { shared, places, columns, rows: blocks[0].len() }
    }

    pub(crate) fn unit_sums(
        &self,
        blocks: &[&[f64]],
        centre: f64,
        resampling: &Resampling,
    ) -> UnitSums {
        let mut units = resampling.unit_sums(self.columns);
        for (row, _) in self.shared.iter().enumerate().filter(|(_, known)| **known) {
            let (a, b) = (blocks[0][row] - centre, blocks[1][row] - centre);
            let of_both = [1.0, a, b, a * a, b * b, a * b];
            let sums = units.unit_mut(resampling.unit_of(row));
            add(&mut sums[..COMMON], &of_both);
            for (place, block) in self.places.iter().zip(&blocks[2..]) {
                let w = block[row] - centre;
                if !w.is_finite() {
                    continue;
                }
                if place.common != 0 {
                    add(&mut sums[place.common..place.common + COMMON], &of_both);
                }
                add(&mut sums[place.own..place.own + OWN], &[w, w * w, b * w, (a - w) * (a - w)]);
            }
        }
        units
    }
}

fn add(sums: &mut [f64], values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}

/// Means over the rows of one block.
pub(crate) struct Moments {
    a: f64,
    b: f64,
    w: f64,
    aa: f64,
    bb: f64,
    ab: f64,
    ww: f64,
    bw: f64,
    step: f64,
}

impl Moments {
    pub(crate) fn new(sums: &[f64], place: &Place) -> Self {
        let (common, own) =
            (&sums[place.common..place.common + COMMON], &sums[place.own..place.own + OWN]);
        let n = common[0];
        Moments {
            a: common[1] / n,
            b: common[2] / n,
            aa: common[3] / n,
            bb: common[4] / n,
            ab: common[5] / n,
            w: own[0] / n,
            ww: own[1] / n,
            bw: own[2] / n,
            step: own[3] / n,
        }
    }

    /// Variance over A and B together.
    fn variance(&self) -> f64 {
        let mean = (self.a + self.b) / 2.0;
        positive((self.aa + self.bb) / 2.0 - mean * mean)
    }

    pub(crate) fn first(&self) -> f64 {
        let spread = positive(self.bb - self.b * self.b) * positive(self.ww - self.w * self.w);
        (self.bw - self.b * self.w) / spread.sqrt()
    }

    pub(crate) fn first_janon(&self) -> f64 {
        let mean = (self.b + self.w) / 2.0;
        (self.bw - mean * mean) / positive((self.bb + self.ww) / 2.0 - mean * mean)
    }

    pub(crate) fn first_saltelli(&self) -> f64 {
        (self.bw - self.ab) / self.variance()
    }

    pub(crate) fn total(&self) -> f64 {
        self.step / 2.0 / self.variance()
    }

    pub(crate) fn total_martinez(&self) -> f64 {
        let aw = (self.aa + self.ww - self.step) / 2.0;
        let spread = positive(self.aa - self.a * self.a) * positive(self.ww - self.w * self.w);
        1.0 - (aw - self.a * self.w) / spread.sqrt()
    }
}

/// A variance, or NaN if there is none to divide by.
fn positive(variance: f64) -> f64 {
    if variance > 0.0 { variance } else { f64::NAN }
}
