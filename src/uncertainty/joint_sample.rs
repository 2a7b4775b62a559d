//! Several inputs drawn together: rows of an observed or computed joint sample, such as a posterior.

use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;

/// Sweeps of the power iteration at most; it stops when a sweep changes nothing.
const SWEEPS: usize = 2000;

/// Equally likely rows of values of several inputs.
///
/// One coordinate of a point, that of the group's first input, picks the row; the coordinates of the other
/// inputs are not read. The rows are ordered along their first principal component (of the columns
/// standardised by their standard deviations), so that the coordinate moves them in the direction in which
/// the sample spreads most and a design that covers the unit interval evenly covers the sample evenly.
/// As a function of the coordinate every input is a step function: there is no derivative.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSample {
    inputs: Vec<usize>,
    rows: Columns,
}

impl JointSample {
    /// The sample of `inputs` (their places, ascending) from one column of values for each.
    ///
    /// # Errors
    /// If there is no input, a place is named twice, the columns differ in length or hold fewer than two rows, or a value is
    /// not finite.
    pub fn new(inputs: Vec<usize>, columns: &[Vec<f64>]) -> Result<Self> {
        if inputs.is_empty() || inputs.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(Error::argument("a joint sample needs different inputs, in their order"));
        }
        let count = columns.first().map_or(0, Vec::len);
        if columns.len() != inputs.len() || columns.iter().any(|column| column.len() != count) {
            return Err(Error::argument("a joint sample needs one value of every input in a row"));
        }
        if count < 2 {
            return Err(Error::argument("a joint sample needs two rows at least"));
        }
        if columns.iter().flatten().any(|value| !value.is_finite()) {
            return Err(Error::argument("a joint sample needs finite values"));
        }
        let scores = principal_scores(columns);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| scores[a].total_cmp(&scores[b]));
        let mut rows = Columns::new(count, inputs.len());
        for (m, column) in columns.iter().enumerate() {
            for (value, &k) in rows.column_mut(m).iter_mut().zip(&order) {
                *value = column[k];
            }
        }
        Ok(JointSample { inputs, rows })
    }

    /// The places of the inputs, ascending.
    pub fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    /// The coordinate that picks the row: the first input's.
    pub fn coordinate(&self) -> usize {
        self.inputs[0]
    }

    /// The rows in their order × the inputs.
    pub fn rows(&self) -> &Columns {
        &self.rows
    }

    /// The row at the uniform `u`: the interval is cut into as many equal parts as there are rows.
    pub fn row_at_uniform(&self, u: f64) -> usize {
        let count = self.rows.rows();
        // A NaN becomes row 0, as a cast makes it.
        ((u * count as f64) as usize).min(count - 1)
    }

    /// The row at the standard normal value `z`, counted from the nearer end.
    pub fn row_at_standard_normal(&self, z: f64) -> usize {
        let from_end = self.row_at_uniform(normal::cdf(-z.abs()));
        if z > 0.0 { self.rows.rows() - 1 - from_end } else { from_end }
    }

    /// The standard normal value in the middle of the row nearest to `values`, differences being measured
    /// in the columns' ranges.
    pub fn standard_normal_of(&self, values: &[f64]) -> f64 {
        let ranges: Vec<f64> = (0..self.inputs.len())
            .map(|m| {
                let column = self.rows.column(m);
                let most = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let range = most - column.iter().copied().fold(f64::INFINITY, f64::min);
                if range > 0.0 { range } else { 1.0 }
            })
            .collect();
        let distance = |k: usize| -> f64 {
            let differences = values.iter().zip(&ranges).enumerate();
            differences.map(|(m, (x, range))| ((x - self.rows.get(k, m)) / range).abs()).sum()
        };
        let count = self.rows.rows();
        let nearest = (0..count).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        normal::quantile((nearest.unwrap_or(0) as f64 + 0.5) / count as f64)
    }

    /// Writes the inputs of every row of `x` from the rows that `row_at` names.
    pub(super) fn fill(&self, x: &mut Columns, row_at: impl Fn(usize) -> usize) {
        let picked: Vec<usize> = (0..x.rows()).map(row_at).collect();
        for (m, &j) in self.inputs.iter().enumerate() {
            let values = self.rows.column(m);
            for (x, &row) in x.column_mut(j).iter_mut().zip(&picked) {
                *x = values[row];
            }
        }
    }
}

/// Every row's score on the first principal component of the standardised columns; the component points
/// to where its largest loading is positive.
fn principal_scores(columns: &[Vec<f64>]) -> Vec<f64> {
    let count = columns.first().map_or(0, Vec::len) as f64;
    let standardised: Vec<Vec<f64>> = columns
        .iter()
        .map(|column| {
            let mean = column.iter().sum::<f64>() / count;
            let square = column.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
            let scale = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
            column.iter().map(|x| (x - mean) * scale).collect()
        })
        .collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let correlation: Vec<Vec<f64>> = standardised
        .iter()
        .map(|a| standardised.iter().map(|b| product(a, b) / count).collect())
        .collect();
    let loadings = leading_vector(&correlation);
    let mut scores = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, loading) in standardised.iter().zip(&loadings) {
        for (score, x) in scores.iter_mut().zip(column) {
            *score += loading * x;
        }
    }
    scores
}

/// The unit eigenvector of a correlation matrix's largest eigenvalue, by power iteration: additions,
/// products and square roots alone, which have the same bits everywhere.
fn leading_vector(matrix: &[Vec<f64>]) -> Vec<f64> {
    // Unequal weights: a start that no symmetry of the matrix makes orthogonal to the answer.
    let mut vector: Vec<f64> = (0..matrix.len()).map(|j| 1.0 + 0.1 * j as f64).collect();
    for _ in 0..SWEEPS {
        let mut next: Vec<f64> =
            matrix.iter().map(|row| row.iter().zip(&vector).map(|(r, v)| r * v).sum()).collect();
        let norm = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm <= 0.0 {
            break;
        }
        next.iter_mut().for_each(|x| *x /= norm);
        let moved = next.iter().zip(&vector).any(|(a, b)| (a - b).abs() > 1e-15);
        vector = next;
        if !moved {
            break;
        }
    }
    let largest =
        vector.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    if largest < 0.0 {
        vector.iter_mut().for_each(|x| *x = -*x);
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_rows_are_ordered_along_their_line() {
        // Three points on the line y = −2x and one off it.
        let columns = vec![vec![3.0, 1.0, 2.0, 2.1], vec![-6.0, -2.0, -4.0, -4.0]];
        let sample = JointSample::new(vec![1, 4], &columns).unwrap();
        let xs = sample.rows().column(0).to_vec();
        let mut ascending = xs.clone();
        ascending.sort_by(f64::total_cmp);
        let descending: Vec<f64> = ascending.iter().rev().copied().collect();
        assert!(xs == ascending || xs == descending, "{xs:?}");
        for k in 0..4 {
            let original = columns[0].iter().position(|x| *x == sample.rows().get(k, 0)).unwrap();
            assert_eq!(sample.rows().get(k, 1), columns[1][original], "rows stay whole");
        }
    }

    #[test]
    fn analytic_every_row_has_its_share_of_the_interval() {
        let sample = JointSample::new(vec![0], &[vec![5.0, 1.0, 3.0, 2.0, 4.0]]).unwrap();
        assert_eq!(sample.rows().column(0), [1.0, 2.0, 3.0, 4.0, 5.0]);
        let rows: Vec<usize> =
            [0.01, 0.19, 0.21, 0.59, 0.81, 0.999_999].map(|u| sample.row_at_uniform(u)).to_vec();
        assert_eq!(rows, [0, 0, 1, 2, 4, 4]);
        // Φ⁻¹(0.2) = −0.8416.
        let rows: Vec<usize> = [-9.0, -0.85, -0.83, 0.0, 0.83, 0.85, 9.0]
            .map(|z| sample.row_at_standard_normal(z))
            .to_vec();
        assert_eq!(rows, [0, 0, 1, 2, 3, 4, 4]);
        for k in 0..5 {
            let value = sample.rows().get(k, 0);
            let z = sample.standard_normal_of(&[value]);
            assert_eq!(sample.row_at_standard_normal(z), k);
        }
    }

    #[test]
    fn property_what_is_no_sample_is_refused() {
        assert!(JointSample::new(vec![], &[]).is_err());
        assert!(JointSample::new(vec![0], &[vec![1.0]]).is_err());
        assert!(JointSample::new(vec![1, 0], &[vec![1.0, 2.0], vec![1.0, 2.0]]).is_err());
        assert!(JointSample::new(vec![0, 1], &[vec![1.0, 2.0], vec![1.0]]).is_err());
        assert!(JointSample::new(vec![0], &[vec![1.0, f64::NAN]]).is_err());
    }
}
