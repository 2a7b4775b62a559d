//! Laws, special functions and dependence against SciPy, mpmath and published tables.

mod copula;
mod families;
mod joint_sample;
mod properties;
mod published;
mod reference;
mod special;
