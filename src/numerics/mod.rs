//! Numerical tools that know nothing of brakes or of probability.

pub mod columns;
pub mod dual;
pub mod elementary;
pub mod gauss_lobatto;
pub mod interval;
pub mod lanes;
pub mod real;
pub mod special;
pub mod words;
