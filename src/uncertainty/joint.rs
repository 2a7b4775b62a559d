//! All uncertain inputs together.

use super::correlation::Copula;
use super::marginal::Marginal;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;

/// The joint law of the inputs: their marginals and, where they depend on each other, a Gaussian copula.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    marginals: Vec<Marginal>,
    copula: Option<Copula>,
}

impl Joint {
    /// The joint law of `marginals` with their dependence.
    ///
    /// # Errors
    /// If the copula has another number of inputs.
    pub fn new(marginals: Vec<Marginal>, copula: Option<Copula>) -> Result<Self> {
        match &copula {
            Some(copula) if copula.dimension() != marginals.len() => Err(Error::argument(format!(
                "a copula of {} inputs cannot join {} marginals",
                copula.dimension(),
                marginals.len()
            ))),
            _ => Ok(Joint { marginals, copula: copula.filter(|copula| !copula.is_independent()) }),
        }
    }

    /// The joint law of independent `marginals`.
    pub fn independent(marginals: Vec<Marginal>) -> Self {
        Joint { marginals, copula: None }
    }

    /// The marginals, in the order of the coordinates.
    pub fn marginals(&self) -> &[Marginal] {
        &self.marginals
    }

    /// The dependence; none where the inputs are independent.
    pub fn copula(&self) -> Option<&Copula> {
        self.copula.as_ref()
    }

    /// Number of inputs.
    pub fn dimension(&self) -> usize {
        self.marginals.len()
    }

    /// Whether no input depends on another.
    pub fn is_independent(&self) -> bool {
        self.copula.is_none()
    }

    /// Values of the inputs at points `u` of the open unit cube, one row a point; `x` takes `u`'s rows.
    ///
    /// Row k depends on row k alone, whatever the batch. Without a copula coordinate j goes through
    /// marginal j's quantile; with one, through the standard normal space.
    ///
    /// # Panics
    /// If `u` has fewer columns than there are inputs: a mistake of the caller's.
    pub fn from_uniform(&self, u: &Columns, x: &mut Columns) {
        if self.copula.is_none() {
            x.reset(u.rows(), self.dimension());
            for (j, marginal) in self.marginals.iter().enumerate() {
                marginal.quantile_column(u.column(j), x.column_mut(j));
            }
            return;
        }
        let mut z = Columns::new(u.rows(), self.dimension());
        for j in 0..self.dimension() {
            normal::quantile_column(u.column(j), z.column_mut(j));
        }
        self.from_standard_normal(&z, x);
    }

    /// Values of the inputs at points `z` of independent standard normal space, one row a point.
    ///
    /// # Panics
    /// As [`Joint::from_uniform`].
    pub fn from_standard_normal(&self, z: &Columns, x: &mut Columns) {
        let mut correlated = Columns::default();
        let z = match &self.copula {
            Some(copula) => {
                copula.correlate(z, &mut correlated);
                &correlated
            }
            None => z,
        };
        x.reset(z.rows(), self.dimension());
        for (j, marginal) in self.marginals.iter().enumerate() {
            marginal.from_standard_normal_column(z.column(j), x.column_mut(j));
        }
    }

    /// The point of independent standard normal space that stands for the inputs' values `x`.
    ///
    /// Infinite or NaN where a value lies outside its marginal's support.
    pub fn to_standard_normal(&self, x: &[f64]) -> Vec<f64> {
        let z: Vec<f64> = self
            .marginals
            .iter()
            .zip(x)
            .map(|(marginal, &x)| marginal.to_standard_normal(x))
            .collect();
        match &self.copula {
            Some(copula) => copula.decorrelate(&z),
            None => z,
        }
    }
}
