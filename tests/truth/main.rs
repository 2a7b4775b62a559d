//! Truth: analytic cases, published figures, independent tools.

mod breach_probability;
mod paper_statements;
mod reference_descents;
