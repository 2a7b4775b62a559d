//! Sampling until something is known: where it ends, and whether what it then says is true.

mod coverage;
mod stopping;
