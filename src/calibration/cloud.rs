//! What a cloud of particles has in common with what it was: how far it has moved, how many are different.

use crate::numerics::columns::Columns;

/// The largest correlation, over coordinates, of the particles before and after.
pub(super) fn correlation(before: &Columns, after: &Columns) -> f64 {
    let mut largest = 0.0_f64;
    for j in 0..before.columns() {
        let (a, b) = (before.column(j), after.column(j));
        let n = a.len() as f64;
        let (mean_a, mean_b) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (a, b) in a.iter().zip(b) {
            ab += (a - mean_a) * (b - mean_b);
            aa += (a - mean_a) * (a - mean_a);
            bb += (b - mean_b) * (b - mean_b);
        }
        largest = largest.max(ab / (aa * bb).sqrt());
    }
    largest
}

/// Number of different rows.
pub(super) fn different(z: &Columns) -> usize {
    let mut rows: Vec<Vec<u64>> =
        (0..z.rows()).map(|k| z.row(k).iter().map(|value| value.to_bits()).collect()).collect();
    rows.sort_unstable();
    rows.dedup();
    rows.len()
}
