//! The outcome's law within classes of one input: what given-data distances between laws are made of.

use super::given_data::{mid_ranks, ordering, part, permutation};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::streams::{Purpose, Stream, stream};
use rand::Rng;

/// Cells of the grid on which a law is held.
pub(crate) const CELLS: usize = 128;
/// Probability of each cell.
pub(crate) type Law = [f64; CELLS];

/// Fewer rows than this leave classes too small for a law.
pub(crate) const FEWEST_ROWS: usize = 200;
/// Most classes an input is cut into.
const MOST_CLASSES: usize = 48;
/// Bootstrap replicates.
const REPLICATES: usize = 100;
/// Random orders over which a noise level is averaged.
const RANDOM_ORDERS: u64 = 4;

/// The rows of one class, as the cells of their outcomes.
pub(crate) struct Class {
    /// The cell of each row.
    pub(crate) cells: Vec<u8>,
    /// The class's share of all rows.
    pub(crate) share: f64,
}

/// Rows grouped by the value of one input; each class holds the same number of rows or one more.
///
/// An input with few different values has classes that share one; their conditional laws are then
/// estimated apart and differ by chance only.
pub(crate) struct Classes {
    /// The classes in ascending order of the input.
    pub(crate) classes: Vec<Class>,
}

/// Statistics of the classes' laws with the noise of the classes taken off.
pub(crate) struct Corrected<const K: usize> {
    /// Twice the statistics less the replicates' means.
    pub(crate) values: [f64; K],
    plain: [f64; K],
    replicates: Vec<[f64; K]>,
}

/// The cell of each outcome: `score` takes a mid-rank as a probability to a place in (0, 1).
pub(crate) fn cells_of(outcome: &[f64], score: impl Fn(f64) -> f64) -> Vec<u8> {
    let count = outcome.len() as f64;
    let last = CELLS as f64 - 1.0;
    let cell = |rank: &f64| (score((rank - 0.5) / count) * CELLS as f64).clamp(0.0, last) as u8;
    mid_ranks(outcome).iter().map(cell).collect()
}

impl Classes {
    /// About the cube root of the rows, 4 to 48 classes: each class then narrows, and fills, as the
    /// sample grows.
    pub(crate) fn of(input: &[f64], cells: &[u8]) -> Self {
        Classes::along(&ordering(input), cells)
    }

    fn along(order: &[usize], cells: &[u8]) -> Self {
        let rows = order.len();
        let mut count = 4;
        while count < MOST_CLASSES && (count + 1) * (count + 1) * (count + 1) <= rows {
            count += 1;
        }
        let class = |m| {
            let cells: Vec<u8> =
                order[part(m, count, rows)].iter().map(|row| cells[*row]).collect();
            Class { share: cells.len() as f64 / rows as f64, cells }
        };
        Classes { classes: (0..count).map(class).collect() }
    }

    /// Statistics of the laws, corrected by the bootstrap: rows are drawn again within their classes,
    /// from a stream of the seed and the input's number.
    pub(crate) fn corrected<const K: usize>(
        &self,
        seed: u64,
        input: u64,
        statistics: impl Fn(&[Law]) -> [f64; K],
    ) -> Corrected<K> {
        let observed: Vec<Law> = self.classes.iter().map(Class::law).collect();
        let plain = statistics(&observed);
        let replicate = |r: u64| {
            let index = input.wrapping_mul(1 << 20).wrapping_add(r);
            let mut rng = stream(seed, Purpose::Bootstrap, index);
            let laws: Vec<Law> =
                self.classes.iter().map(|class| class.resampled(&mut rng)).collect();
            statistics(&laws)
        };
        let replicates: Vec<[f64; K]> = (0..REPLICATES as u64).map(replicate).collect();
        let mean = |k: usize| replicates.iter().map(|r| r[k]).sum::<f64>() / REPLICATES as f64;
        Corrected { values: std::array::from_fn(|k| 2.0 * plain[k] - mean(k)), plain, replicates }
    }

    /// The law of all rows.
    pub(crate) fn mixture(&self, laws: &[Law]) -> Law {
        let mut mixture = [0.0; CELLS];
        for (class, law) in self.classes.iter().zip(laws) {
            mixture.iter_mut().zip(law).for_each(|(sum, p)| *sum += class.share * p);
        }
        mixture
    }
}

/// The corrected statistics of an input without any effect, averaged over random orders of the rows.
pub(crate) fn noise_levels<const K: usize>(
    cells: &[u8],
    seed: u64,
    corrected: impl Fn(&Classes, u64) -> [f64; K],
) -> [f64; K] {
    let mut levels = [0.0; K];
    for r in 0..RANDOM_ORDERS {
        // Numbers from the top, which no input has.
        let number = u64::MAX - r;
        let classes = Classes::along(&permutation(seed, number, cells.len()), cells);
        let values = corrected(&classes, number);
        levels.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / RANDOM_ORDERS as f64);
    }
    levels
}

impl Class {
    fn law(&self) -> Law {
        let mut law = [0.0; CELLS];
        let each = 1.0 / self.cells.len() as f64;
        self.cells.iter().for_each(|cell| law[usize::from(*cell)] += each);
        law
    }

    /// The law of as many rows drawn from this class with replacement.
    fn resampled(&self, rng: &mut Stream) -> Law {
        let mut law = [0.0; CELLS];
        let count = self.cells.len();
        let each = 1.0 / count as f64;
        for _ in 0..count {
            let row = (u128::from(rng.next_u64()) * count as u128) >> 64;
            law[usize::from(self.cells[row as usize])] += each;
        }
        law
    }
}

impl<const K: usize> Corrected<K> {
    /// Statistic `k` with its basic bootstrap interval, widened at both ends by `margin` and by the bias
    /// that was taken off, of which as much again may be left, and reaching down to 0 if its lower end is
    /// within what chance alone gives.
    pub(crate) fn estimate(
        &self,
        k: usize,
        margin: f64,
        noise_level: f64,
        confidence: f64,
        method: &'static str,
    ) -> Estimate {
        let mut sorted: Vec<f64> = self.replicates.iter().map(|r| r[k]).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let count = sorted.len() as f64;
        let mean = sorted.iter().sum::<f64>() / count;
        let squares: f64 = sorted.iter().map(|r| (r - mean) * (r - mean)).sum();
        let error = (squares / (count - 1.0)).sqrt();
        let value = Some(self.values[k]);
        if error == 0.0 {
            let interval = Earned::none("every resample gave the same");
            return Estimate { value, standard_error: None, interval };
        }
        let margin = margin + (self.values[k] - self.plain[k]).abs();
        let tail = (1.0 - confidence) / 2.0;
        let quantile = |p| super::bootstrap::sorted_quantile(&sorted, p);
        let lower = 2.0 * self.plain[k] - quantile(1.0 - tail) - margin;
        let upper = 2.0 * self.plain[k] - quantile(tail) + margin;
        let lower = if lower <= noise_level { 0.0 } else { lower };
        let interval = Interval { lower, upper, confidence, method }.into();
        Estimate { value, standard_error: Some(error), interval }
    }
}

/// Why a sample of so few rows has no classes.
pub(crate) fn too_few(rows: usize) -> std::result::Result<(), String> {
    if rows >= FEWEST_ROWS {
        return Ok(());
    }
    Err(format!("{rows} rows are too few for conditional laws: {FEWEST_ROWS} at least are needed"))
}
