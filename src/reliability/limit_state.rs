//! What the reliability methods see of the world: margins of points, and nothing of brakes.

use crate::error::Result;
use crate::numerics::columns::Columns;

/// A system that can be asked for its margins at points of the independent standard-normal space.
///
/// A margin is negative where its limit is breached and NaN where the point could not be evaluated
/// (a fault: it could be a breach or not, and every method says what that does to its answer).
/// Everything else about a margin's scale is free: methods that need one take it at the origin.
pub trait LimitState {
    /// Number of standard-normal coordinates.
    fn dimension(&self) -> usize;

    /// Number of limits: columns of the margins.
    fn limits(&self) -> usize;

    /// Margins of every point of `z` (rows = points, columns = coordinates), into `margins` (one row
    /// a point, one column a limit), which arrives with that shape.
    ///
    /// A row must depend on its own point only, not on its neighbours in the batch.
    ///
    /// # Errors
    /// Only where nothing can be evaluated at all; one bad point is a NaN.
    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()>;

    /// Gradient of the margin of `limit` at one point, where the system knows it.
    fn gradient(&self, _z: &[f64], _limit: usize) -> Option<Vec<f64>> {
        None
    }
}
