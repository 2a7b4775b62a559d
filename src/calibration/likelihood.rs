//! What a calibration sees of the world: how well parameters explain data, and nothing of brakes.

use crate::error::Result;
use crate::numerics::columns::Columns;

/// Data that can be asked how likely it is at points of independent standard-normal space.
///
/// The prior of the parameters is this space's own standard-normal law: whoever implements the trait maps a point
/// to the parameters that it stands for.
pub trait LogLikelihood {
    /// Number of standard-normal coordinates.
    fn dimension(&self) -> usize;

    /// ln of the likelihood at every point of `z` (rows = points), into `out`, one entry a point. Where the data
    /// is impossible, or the model cannot be computed, −∞ or not a number.
    ///
    /// A row must depend on its own point only, not on its neighbours in the batch.
    ///
    /// # Errors
    /// Only where nothing can be evaluated at all.
    fn ln_likelihood(&self, z: &Columns, out: &mut [f64]) -> Result<()>;
}

/// Residuals that are independent and standard normal at the truth, and how they change.
#[derive(Debug, Clone, Default)]
pub struct Whitened {
    /// The residuals.
    pub residuals: Vec<f64>,
    /// For each coordinate, the derivatives of the residuals.
    pub jacobian: Vec<Vec<f64>>,
}

/// A likelihood with a least-squares form in some of its coordinates, the others held.
pub trait LeastSquares: LogLikelihood {
    /// The coordinates in which the likelihood is a sum of squares: the first so many. The others are of the noise.
    fn squared_dimension(&self) -> usize;

    /// Whitened residuals at a point, with their derivatives by the first [`LeastSquares::squared_dimension`]
    /// coordinates if `slopes`; nothing where the model cannot be computed.
    ///
    /// # Errors
    /// Those of the model as a whole.
    fn whitened(&self, z: &[f64], slopes: bool) -> Result<Option<Whitened>>;
}
