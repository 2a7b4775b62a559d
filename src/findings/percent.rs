//! Shares as a person reads them.

use crate::units::number;

/// A probability or share as a person reads it.
pub(super) fn percent(share: f64) -> String {
    if share > 0.0 && share < 1e-5 {
        return format!("{share:.2e}");
    }
    format!("{} %", number(100.0 * share, 4))
}
