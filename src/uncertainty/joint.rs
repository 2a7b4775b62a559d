//! All uncertain inputs together.

use super::correlation::Copula;
use super::joint_sample::JointSample;
use super::marginal::Marginal;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;

/// The joint law of the inputs: their marginals and, where they depend on each other, a Gaussian copula or
/// a sample of whose rows they are drawn together.
///
/// Input `j` has coordinate `j` of a point. Of inputs that are drawn together the first one's coordinate picks the
/// row and the others' are not read: a group is one coordinate, and every other input keeps its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    marginals: Vec<Marginal>,
    copula: Option<Copula>,
    samples: Vec<JointSample>,
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
            _ => Ok(Joint {
                marginals,
                copula: copula.filter(|copula| !copula.is_independent()),
                samples: Vec::new(),
            }),
        }
    }

    /// The joint law of independent `marginals`.
    pub fn independent(marginals: Vec<Marginal>) -> Self {
        Joint { marginals, copula: None, samples: Vec::new() }
    }

    /// The joint law with the inputs of `samples` drawn together; their marginals stay as descriptions.
    ///
    /// # Errors
    /// If a sample names an input that is not there, that another sample has, or that is correlated.
    pub fn with_samples(mut self, samples: Vec<JointSample>) -> Result<Self> {
        let mut inputs: Vec<usize> =
            samples.iter().flat_map(|sample| sample.inputs().iter().copied()).collect();
        inputs.sort_unstable();
        if inputs.windows(2).any(|pair| pair[0] == pair[1])
            || inputs.last().is_some_and(|last| *last >= self.dimension())
        {
            return Err(Error::argument("an input belongs to one joint sample at most"));
        }
        if let Some(copula) = &self.copula {
            let correlated = |&j: &usize| {
                (0..copula.dimension()).any(|k| k != j && copula.normal_correlation(j, k) != 0.0)
            };
            if let Some(j) = inputs.iter().find(|j| correlated(j)) {
                return Err(Error::argument(format!(
                    "input {} is drawn from a joint sample and cannot be correlated as well",
                    j + 1
                )));
            }
        }
        self.samples = samples;
        Ok(self)
    }

    /// The samples of whose rows inputs are drawn together.
    pub fn samples(&self) -> &[JointSample] {
        &self.samples
    }

    /// The sample from which input `j` is drawn, if it is drawn together with others.
    pub fn sample_of(&self, j: usize) -> Option<&JointSample> {
        self.samples.iter().find(|sample| sample.inputs().contains(&j))
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

    /// Whether no input depends on another by a copula; inputs drawn together are one factor of their own.
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
            x.reshape(u.rows(), self.dimension());
            for (j, marginal) in self.alone() {
                marginal.quantile_column(u.column(j), x.column_mut(j));
            }
            self.fill_from_uniform(u, x);
            return;
        }
        let mut z = Columns::new(u.rows(), self.dimension());
        for j in 0..self.dimension() {
            normal::quantile_column(u.column(j), z.column_mut(j));
        }
        self.from_standard_normal(&z, x);
        // The row is picked by the uniform itself, so that it is the same with and without a copula.
        self.fill_from_uniform(u, x);
    }

    /// The inputs that are not drawn together with others.
    fn alone(&self) -> impl Iterator<Item = (usize, &Marginal)> {
        self.marginals.iter().enumerate().filter(|(j, _)| self.sample_of(*j).is_none())
    }

    /// Writes the inputs that are drawn together, at points `u` of the open unit cube.
    pub fn fill_from_uniform(&self, u: &Columns, x: &mut Columns) {
        for sample in &self.samples {
            let coordinate = u.column(sample.coordinate());
            sample.fill(x, |k| sample.row_at_uniform(coordinate[k]));
        }
    }

    /// Writes the inputs that are drawn together, at points `z` of standard normal space.
    pub fn fill_from_standard_normal(&self, z: &Columns, x: &mut Columns) {
        for sample in &self.samples {
            let coordinate = z.column(sample.coordinate());
            sample.fill(x, |k| sample.row_at_standard_normal(coordinate[k]));
        }
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
        x.reshape(z.rows(), self.dimension());
        for (j, marginal) in self.alone() {
            marginal.from_standard_normal_column(z.column(j), x.column_mut(j));
        }
        self.fill_from_standard_normal(z, x);
    }

    /// The point of independent standard normal space that stands for the inputs' values `x`.
    ///
    /// Infinite or NaN where a value lies outside its marginal's support. Of inputs drawn together the first
    /// has the value of the nearest row and the others zero.
    pub fn to_standard_normal(&self, x: &[f64]) -> Vec<f64> {
        let mut z = vec![0.0; self.dimension()];
        for (j, marginal) in self.alone() {
            z[j] = x.get(j).map_or(f64::NAN, |&x| marginal.to_standard_normal(x));
        }
        for sample in &self.samples {
            let values: Vec<f64> =
                sample.inputs().iter().map(|&j| x.get(j).copied().unwrap_or(f64::NAN)).collect();
            z[sample.coordinate()] = sample.standard_normal_of(&values);
        }
        match &self.copula {
            Some(copula) => copula.decorrelate(&z),
            None => z,
        }
    }
}
