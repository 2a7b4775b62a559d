//! The trade of tolerances: derivatives, curves, plans, and what becomes known when.

mod beliefs;
mod curves;
mod derivatives;
mod exact;
#[path = "../fixtures/habe.rs"]
mod habe;
mod known;
mod plans;
mod rig_plans;
mod shapley;
