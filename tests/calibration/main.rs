//! Calibration against answers that are known.

mod campaign;
mod consistency;
mod linear;
mod noise;
mod planning;
mod repetitions;
mod screening;
mod truth;
