//! The probability of a breach as a function of what is not known: nested sampling.
//!
//! Coordinates of the unit cube are of two kinds. Some stand for constants that are not known, e; the others vary, v, from
//! flight to flight. P(e) = P(breach | e) is then itself uncertain, and its law is what this finds: an outer
//! sample of e, and for each an inner one of v in two halves, each half a Latin hypercube of its own. Both halves see the same e
//! and are otherwise independent, so that the products of their shares are unbiased for the square of P(e), and how
//! much their own scatter distorts anything else shows in how the halves differ from their mean.

mod estimates;
mod shares;

pub use estimates::{Band, band, central, untold};
pub use shares::{ShareSample, Shares, share_sample, shares};

use super::draws::open_uniform;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, stream};
use rand::Rng;

/// A system some of whose coordinates stand for what is not known.
pub trait NestedState {
    /// Number of coordinates.
    fn dimension(&self) -> usize;

    /// Places of the coordinates that stand for what is not known, ascending.
    fn unknown(&self) -> &[usize];

    /// Number of limits: columns of the margins.
    fn limits(&self) -> usize;

    /// Margins at points of the open unit cube (rows), into `margins`, which arrives with one row a point and one
    /// column a limit: negative is a breach, NaN a point that could not be evaluated. A row depends on its own
    /// point only.
    ///
    /// # Errors
    /// Only where nothing can be evaluated at all.
    fn margins(&self, u: &Columns, margins: &mut Columns) -> Result<()>;
}

/// Independent sections of the sets, from which errors are read.
pub const SECTIONS: usize = 20;

/// Points evaluated at a time.
const BATCH: usize = 16_384;

/// Margins of nested points: set after set, half after half.
#[derive(Debug, Clone)]
pub struct NestedSample {
    sets: usize,
    half: usize,
    margins: Columns,
}

/// Conditional probabilities of an event, one a set, by either half; NaN where a half could not be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Halves {
    /// By the first half.
    pub first: Vec<f64>,
    /// By the second half.
    pub second: Vec<f64>,
    /// Points in a half.
    pub points: usize,
}

impl Halves {
    /// The halves of the sets that have both.
    fn complete(&self) -> impl Iterator<Item = (f64, f64)> {
        self.between(0..self.first.len())
    }

    /// Those of one section.
    fn section(&self, section: usize) -> impl Iterator<Item = (f64, f64)> {
        let size = self.first.len() / SECTIONS;
        self.between(section * size..(section + 1) * size)
    }

    fn between(&self, sets: std::ops::Range<usize>) -> impl Iterator<Item = (f64, f64)> {
        let pairs = self.first[sets.clone()].iter().zip(&self.second[sets]);
        pairs.map(|(a, b)| (*a, *b)).filter(|(a, b)| a.is_finite() && b.is_finite())
    }
}

/// A nested sample of `sets` sets with `2 half` points each. The sets are [`SECTIONS`] Latin hypercubes of e, one after
/// another, each a pure function of the seed, its number and its size.
///
/// # Errors
/// If the sections cannot share the sets equally, there is no point, or the system fails.
pub fn nested_sample(
    state: &dyn NestedState,
    sets: usize,
    half: usize,
    seed: u64,
) -> Result<NestedSample> {
    if sets == 0 || !sets.is_multiple_of(SECTIONS) || half == 0 {
        return Err(Error::argument(format!(
            "a nested sample needs a multiple of {SECTIONS} sets and a point in each half"
        )));
    }
    let section = sets / SECTIONS;
    let varying = varying(state);
    let mut margins = Columns::new(sets * 2 * half, state.limits());
    let mut blocks = Blocks::new(state, &mut margins);
    let mut outer = Columns::default();
    for set in 0..sets {
        if set % section == 0 {
            let index = (set / section) as u64;
            outer = hypercube(state.unknown().len(), section, seed, Purpose::Unknown, index);
        }
        let unknown = outer.row(set % section);
        for side in 0..2 {
            let index = (2 * set + side) as u64;
            let inner = hypercube(varying.len(), half, seed, Purpose::Varying, index);
            blocks.push(&unknown, &varying, &inner)?;
        }
    }
    blocks.finish()?;
    Ok(NestedSample { sets, half, margins })
}

impl NestedSample {
    /// Number of sets.
    pub fn sets(&self) -> usize {
        self.sets
    }

    /// Points in all.
    pub fn points(&self) -> usize {
        self.margins.rows()
    }

    /// All margins, point by point.
    pub fn margins(&self) -> &Columns {
        &self.margins
    }

    /// Points with a margin that is not known.
    pub fn faults(&self) -> u64 {
        let unknown =
            |k: usize| (0..self.margins.columns()).any(|i| self.margins.get(k, i).is_nan());
        (0..self.points()).filter(|&k| unknown(k)).count() as u64
    }

    /// The conditional probabilities of an event, which says of a point whether it happens there or, with
    /// `None`, that this is not known; such points are left out.
    pub fn halves(&self, event: impl Fn(&Columns, usize) -> Option<bool>) -> Halves {
        let share = |set: usize, side: usize| {
            let start = (2 * set + side) * self.half;
            share(start..start + self.half, |k| event(&self.margins, k))
        };
        Halves {
            first: (0..self.sets).map(|set| share(set, 0)).collect(),
            second: (0..self.sets).map(|set| share(set, 1)).collect(),
            points: self.half,
        }
    }

    /// The conditional probabilities that limit `limit`'s margin is below `margin`.
    pub fn below(&self, limit: usize, margin: f64) -> Halves {
        self.halves(|margins, k| {
            let value = margins.get(k, limit);
            (!value.is_nan()).then_some(value < margin)
        })
    }
}

/// Whether any limit is breached at a point.
pub fn any_breach(margins: &Columns, k: usize) -> Option<bool> {
    let each = (0..margins.columns()).map(|i| margins.get(k, i));
    let mut unknown = false;
    for margin in each {
        if margin < 0.0 {
            return Some(true);
        }
        unknown |= margin.is_nan();
    }
    (!unknown).then_some(false)
}

/// The share of points where an event happens among those where this is known; NaN if there are none.
fn share(points: std::ops::Range<usize>, event: impl Fn(usize) -> Option<bool>) -> f64 {
    let (mut happened, mut known) = (0.0, 0.0);
    for yes in points.filter_map(event) {
        known += 1.0;
        happened += f64::from(u8::from(yes));
    }
    happened / known
}

/// Places of the coordinates that vary.
fn varying(state: &dyn NestedState) -> Vec<usize> {
    (0..state.dimension()).filter(|j| !state.unknown().contains(j)).collect()
}

/// A Latin hypercube of `points` points: rows × `dimension`.
fn hypercube(dimension: usize, points: usize, seed: u64, purpose: Purpose, index: u64) -> Columns {
    let mut random = stream(seed, purpose, index);
    let mut table = Columns::new(points, dimension);
    for j in 0..dimension {
        let column = table.column_mut(j);
        for (k, value) in column.iter_mut().enumerate() {
            let inside = (k as f64 + open_uniform(&mut random)) / points as f64;
            *value = inside.min(1.0 - f64::EPSILON / 2.0);
        }
        // Fisher and Yates' shuffle; the bias of a remainder of 2⁶⁴ is far below what any sample shows.
        for k in (1..points).rev() {
            let other = (random.next_u64() % (k as u64 + 1)) as usize;
            column.swap(k, other);
        }
    }
    table
}

/// Points of several sets, gathered into batches and evaluated.
struct Blocks<'s> {
    state: &'s dyn NestedState,
    margins: &'s mut Columns,
    done: usize,
    rows: Vec<Vec<f64>>,
}

impl<'s> Blocks<'s> {
    fn new(state: &'s dyn NestedState, margins: &'s mut Columns) -> Self {
        Blocks { state, margins, done: 0, rows: Vec::with_capacity(BATCH) }
    }

    /// Adds the points of one set and half.
    fn push(&mut self, unknown: &[f64], varying: &[usize], inner: &Columns) -> Result<()> {
        for k in 0..inner.rows() {
            let mut point = vec![0.5; self.state.dimension()];
            for (&j, &u) in self.state.unknown().iter().zip(unknown) {
                point[j] = u;
            }
            for (m, &j) in varying.iter().enumerate() {
                point[j] = inner.get(k, m);
            }
            self.rows.push(point);
        }
        if self.rows.len() >= BATCH { self.finish() } else { Ok(()) }
    }

    /// Evaluates what is gathered.
    fn finish(&mut self) -> Result<()> {
        let points = Columns::from_rows(&self.rows);
        if points.rows() == 0 {
            return Ok(());
        }
        let mut margins = Columns::new(points.rows(), self.state.limits());
        self.state.margins(&points, &mut margins)?;
        for i in 0..self.state.limits() {
            let into = &mut self.margins.column_mut(i)[self.done..self.done + points.rows()];
            into.copy_from_slice(margins.column(i));
        }
        self.done += points.rows();
        self.rows.clear();
        Ok(())
    }
}
