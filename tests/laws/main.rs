//! Laws, special functions and dependence against SciPy, mpmath and published tables.

mod copula;
mod families;
mod joint_sample;
mod listed;
mod properties;
mod published;
mod readings;
mod reference;
mod special;
