//! Figures and the HTML report, from a small run of the default study.

mod figures;
#[path = "../fixtures/habe.rs"]
mod habe;
mod html;
mod limits;
mod measures;
mod numbers;
mod read_back;
mod sample;
mod sweep;
