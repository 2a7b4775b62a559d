//! Truth: analytic cases, published figures, independent tools.

mod benchmarks;
mod breach_probability;
mod detailed_descents;
mod driven_runs;
mod first_order;
#[path = "../fixtures/habe.rs"]
mod habe;
mod hard_designs;
mod lot_factor;
mod near_certainty;
mod paper_statements;
mod reference_descents;
mod reliability_methods;
mod system_events;
mod vector_descents;
mod vector_elementary;
mod vector_gradients;
mod vector_members;
mod vector_rosenbrock;
