//! Truth: analytic cases, published figures, independent tools.

mod paper_statements;
mod reference_descents;
