//! The part of a descent that a lane is in, which decides its clock.

/// In time, from rest.
pub const STARTING: f64 = 0.0;
/// In line length, to the end of the line.
pub const PAYING_OUT: f64 = 1.0;
/// In time again, to the time limit, because the line would not have ended before it.
pub const RUNNING_LATE: f64 = 2.0;
/// In line length for good: the line ends, by a hair, before the limit.
pub const LANDING: f64 = 3.0;
