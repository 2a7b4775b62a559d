//! The pick-freeze design of the Sobol' indices: blocks of points that share coordinates.
//!
//! Two independent samples A and B of the inputs; then for each factor j the block AⱼB: A with the
//! columns of factor j taken from B (Saltelli et al., Comput. Phys. Commun. 181 (2010) 259). AⱼB shares
//! all but j with A, which shows the total index, and j alone with B, which shows the first-order one.

use crate::error::{Error, Result};
use crate::numerics::columns::Columns;

/// Inputs that move together and get one index: a single input, or a group such as all the gaps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Factor {
    /// What the report calls it.
    pub name: String,
    /// The columns of its inputs.
    pub columns: Vec<usize>,
}

/// Which points a pick-freeze design evaluates.
///
/// Block 0 is A, block 1 is B, block 2 + j is A with factor j from B, and after the factors come the
/// pairs: A with the columns of both factors from B.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    base_samples: usize,
    inputs: usize,
    factors: Vec<Factor>,
    pairs: Vec<(usize, usize)>,
}

impl Plan {
    /// A plan over `inputs` inputs with `base_samples` rows a block.
    ///
    /// # Errors
    /// If there are fewer than two rows, no factor, or a factor is empty, names a column that is not
    /// there, or names one twice. Factors may overlap: a group beside its members.
    pub fn new(base_samples: usize, inputs: usize, factors: Vec<Factor>) -> Result<Self> {
        if base_samples < 2 || factors.is_empty() {
            return Err(Error::argument(
                "a pick-freeze design needs two rows and one factor at least",
            ));
        }
        for factor in &factors {
            let mut columns = factor.columns.clone();
            columns.sort_unstable();
            columns.dedup();
            let known = columns.last().is_some_and(|last| *last < inputs);
            if !known || columns.len() != factor.columns.len() {
                return Err(Error::argument(format!(
                    "factor \"{}\" must name between one and {inputs} different columns below {inputs}, not {:?}",
                    factor.name, factor.columns
                )));
            }
        }
        Ok(Plan { base_samples, inputs, factors, pairs: Vec::new() })
    }

    /// The plan with a second-order index for each of these pairs of factors, one more block a pair.
    ///
    /// # Errors
    /// If a pair names a factor that is not there, or two that share a column.
    pub fn with_pairs(mut self, pairs: &[(usize, usize)]) -> Result<Self> {
        for &(i, j) in pairs {
            let (Some(one), Some(other)) = (self.factors.get(i), self.factors.get(j)) else {
                return Err(Error::argument(format!("there is no pair of factors {i} and {j}")));
            };
            if one.columns.iter().any(|column| other.columns.contains(column)) {
                return Err(Error::argument(format!(
                    "factors \"{}\" and \"{}\" share an input, so they have no interaction",
                    one.name, other.name
                )));
            }
        }
        self.pairs = pairs.to_vec();
        Ok(self)
    }

    /// Rows of each block, N.
    pub fn base_samples(&self) -> usize {
        self.base_samples
    }

    /// Inputs, d: columns of a point.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// The factors, in the order of their blocks.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The pairs of factors that have a second-order index, in the order of their blocks.
    pub fn pairs(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// Blocks: two, one a factor, one a pair.
    pub fn blocks(&self) -> usize {
        2 + self.factors.len() + self.pairs.len()
    }

    /// Points to evaluate: blocks times rows.
    pub fn points(&self) -> u64 {
        self.blocks() as u64 * self.base_samples as u64
    }

    /// Columns of the sample that both A and B are cut from, 2d: A is the first half, B the second.
    pub fn base_columns(&self) -> usize {
        2 * self.inputs
    }

    /// Row and block of point `k`, row by row: a longer design begins with the shorter one.
    pub fn row_and_block(&self, k: u64) -> (u64, usize) {
        let blocks = self.blocks() as u64;
        (k / blocks, (k % blocks) as usize)
    }

    /// Writes the points of one block: `base` has 2d columns and any range of the rows, `points` becomes
    /// as many rows with d columns.
    ///
    /// # Errors
    /// If there is no such block, or `base` has another number of columns.
    pub fn fill_block(&self, block: usize, base: &Columns, points: &mut Columns) -> Result<()> {
        if block >= self.blocks() || base.columns() != self.base_columns() {
            return Err(Error::argument(format!(
                "block {block} of {} from {} columns instead of {}",
                self.blocks(),
                base.columns(),
                self.base_columns()
            )));
        }
        points.reset(base.rows(), self.inputs);
        for column in 0..self.inputs {
            let source =
                if self.takes_from_b(block, column) { self.inputs + column } else { column };
            points.column_mut(column).copy_from_slice(base.column(source));
        }
        Ok(())
    }

    /// Whether a column of a block is taken from B.
    fn takes_from_b(&self, block: usize, column: usize) -> bool {
        let moves = |factor: usize| self.factors[factor].columns.contains(&column);
        match block {
            0 => false,
            1 => true,
            _ if block - 2 < self.factors.len() => moves(block - 2),
            _ => {
                let (i, j) = self.pairs[block - 2 - self.factors.len()];
                moves(i) || moves(j)
            }
        }
    }
}

/// Refuses correlated inputs, naming the pairs: with them, a column of B set among those of A is a
/// point that the joint law may never draw, and the variance has no unique decomposition.
///
/// # Errors
/// If there is a correlated pair.
pub fn require_independent(correlated: &[(&str, &str)]) -> Result<()> {
    if correlated.is_empty() {
        return Ok(());
    }
    let named: Vec<String> =
        correlated.iter().take(3).map(|(a, b)| format!("{a} with {b}")).collect();
    let more = if correlated.len() > 3 { ", …" } else { "" };
    Err(Error::argument(format!(
        "Sobol' indices by pick-freeze need independent inputs, and these are correlated: {}{more}; make each \
         correlated set one factor with its own design, or use an index that serves correlated inputs (Shapley \
         effects, Borgonovo's delta)",
        named.join(", ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(name: &str, columns: &[usize]) -> Factor {
        Factor { name: name.into(), columns: columns.to_vec() }
    }

    #[test]
    fn property_blocks_take_their_columns_from_a_and_b() {
        let factors = vec![factor("x", &[0]), factor("yz", &[1, 2])];
        let plan = Plan::new(2, 3, factors).unwrap().with_pairs(&[(0, 1)]).unwrap();
        assert_eq!((plan.blocks(), plan.points(), plan.row_and_block(7)), (5, 10, (1, 2)));
        let base = Columns::from_rows(&[
            [1.0, 2.0, 3.0, 10.0, 20.0, 30.0],
            [4.0, 5.0, 6.0, 40.0, 50.0, 60.0],
        ]);
        let mut points = Columns::default();
        let expected = [
            [1.0, 2.0, 3.0],
            [10.0, 20.0, 30.0],
            [10.0, 2.0, 3.0],
            [1.0, 20.0, 30.0],
            [10.0, 20.0, 30.0],
        ];
        for (block, row) in expected.iter().enumerate() {
            plan.fill_block(block, &base, &mut points).unwrap();
            assert_eq!(points.row(0), row);
            assert_eq!(points.rows(), 2);
        }
        assert!(plan.fill_block(5, &base, &mut points).is_err());
        assert!(plan.fill_block(0, &Columns::new(2, 3), &mut points).is_err());
    }

    #[test]
    fn property_impossible_plans_are_refused() {
        assert!(Plan::new(1, 1, vec![factor("x", &[0])]).is_err());
        assert!(Plan::new(8, 1, vec![]).is_err());
        assert!(Plan::new(8, 1, vec![factor("x", &[1])]).is_err());
        assert!(Plan::new(8, 2, vec![factor("x", &[1, 1])]).is_err());
        assert!(Plan::new(8, 2, vec![factor("x", &[])]).is_err());
        let plan = Plan::new(8, 2, vec![factor("x", &[0]), factor("all", &[0, 1])]).unwrap();
        assert!(plan.clone().with_pairs(&[(0, 1)]).is_err());
        assert!(plan.with_pairs(&[(0, 2)]).is_err());
        let error = require_independent(&[("fluid.density", "brake.gap")]).unwrap_err();
        assert!(error.to_string().contains("fluid.density with brake.gap"));
        assert!(require_independent(&[]).is_ok());
    }
}
