//! Calibration against answers that are known.

mod campaign;
mod consistency;
#[path = "../fixtures/habe.rs"]
mod habe;
mod linear;
mod noise;
mod planning;
mod repetitions;
mod screening;
mod truth;
