//! The payload section, which grows lighter as balloon and parachute are pulled out of it.

use super::design::Design;
use super::parameters::Parameter;
use crate::numerics::real::Real;

/// Payload constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payload<R> {
    /// Weight at the start `W2`, N.
    pub weight_n: R,
    /// `Wx/L`, N/m: weight extracted per length of line.
    pub extraction_n_per_m: R,
}

impl<R: Real> Payload<R> {
    /// The payload of a design.
    #[inline(always)]
    pub fn new(design: &Design<R>) -> Self {
        Payload {
            weight_n: design.get(Parameter::PayloadWeight),
            extraction_n_per_m: design.get(Parameter::PayloadExtractedWeight)
                / design.get(Parameter::ReelLineLength),
        }
    }

    /// Weight extracted after `line_m` of line `ΔW = Wx l/L`, N.
    #[inline(always)]
    pub fn extracted_n(&self, line_m: R) -> R {
        self.extraction_n_per_m * line_m
    }
}
