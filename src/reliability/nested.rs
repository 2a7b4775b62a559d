//! The probability of a breach as a function of what is not known: nested sampling.
//!
//! Coordinates of the unit cube are of two kinds. Some stand for constants that are not known, e; the others vary, v, from
//! flight to flight. P(e) = P(breach | e) is then itself uncertain, and its law is what this finds: an outer
//! sample of e, and for each an inner one of v in two halves. Both halves see the same e and nothing else in common, so that
//! the products of their shares are unbiased for the square of P(e), and how much their own scatter distorts
//! anything else shows in how the halves differ from their mean.
//!
//! A half integrates over v instead of counting wherever it can: its points lie on lines, along which the margins are
//! interpolated (see `inner`).

mod estimates;
mod inner;
mod shares;

pub use estimates::{Band, band, central, untold};
pub use inner::NestedEvent;
pub use shares::{ShareSample, Shares, share_sample, shares};

use super::draws::open_uniform;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, stream};
use inner::Inner;
use rand::Rng;

/// A system some of whose coordinates stand for what is not known.
pub trait NestedState {
    /// Number of coordinates.
    fn dimension(&self) -> usize;

    /// Places of the coordinates that stand for what is not known, ascending.
    fn unknown(&self) -> &[usize];

    /// Whether the margins are continuous in coordinate `j`, so that they may be interpolated along it.
    fn is_continuous(&self, _j: usize) -> bool {
        true
    }

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
    inner: Inner,
    margins: Columns,
}

/// Conditional probabilities of an event, one a set, by either half; NaN where a half could not be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Halves {
    /// By the first half.
    pub first: Vec<f64>,
    /// By the second half.
    pub second: Vec<f64>,
    /// Smallest probability that the two halves of a set resolve together.
    pub resolution: f64,
}

impl Halves {
    /// The conditional probabilities that the event does not happen.
    pub fn complement(self) -> Self {
        let not = |shares: Vec<f64>| shares.into_iter().map(|share| 1.0 - share).collect();
        Halves { first: not(self.first), second: not(self.second), ..self }
    }

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
    let inner = Inner::new(state, half)?;
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
            let points = inner.points(side, seed, Purpose::Varying, index);
            blocks.push(&unknown, inner.varying(), &points)?;
        }
    }
    blocks.finish()?;
    Ok(NestedSample { sets, inner, margins })
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

    /// Whether a half integrates along lines; if not it counts.
    pub fn integrates(&self) -> bool {
        self.inner.integrates()
    }

    /// The conditional probabilities of an event.
    pub fn halves(&self, event: NestedEvent) -> Halves {
        let half = self.inner.size();
        let share = |set: usize, side: usize| {
            let start = (2 * set + side) * half;
            self.inner.share(&self.margins, start, side, event)
        };
        Halves {
            first: (0..self.sets).map(|set| share(set, 0)).collect(),
            second: (0..self.sets).map(|set| share(set, 1)).collect(),
            resolution: self.inner.resolution(),
        }
    }

    /// The share of what varies for which each point of a set stands, half after half.
    pub fn weights(&self) -> Vec<f64> {
        (0..2).flat_map(|side| self.inner.weights(side)).map(|weight| 0.5 * weight).collect()
    }
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
