//! Published reliability problems with certified probabilities.
//!
//! The references were recomputed: by conditional one-dimensional integration in 30 digits (relative
//! error below 1e-10), in closed form, or by randomised quasi-Monte Carlo of a conditional integrand, with
//! the standard error given. Published values that differ are said where the problem is.
//! Sources: openturns/otbenchmark (the RP collection of TNO's reliability challenge), uqtestfuns.

pub mod components;
pub mod coverage;
pub mod dimensions;
pub mod laws;
pub mod oscillators;
pub mod systems;

use reeldown::error::Result;
use reeldown::numerics::columns::Columns;
use reeldown::reliability::event::Event;
use reeldown::reliability::limit_state::LimitState;

/// A problem with the probability of its event.
pub struct Benchmark {
    /// Identifier of the collection it is from.
    pub id: &'static str,
    /// The limits.
    pub limits: Function,
    /// The event whose probability is certified.
    pub event: Event,
    /// That probability.
    pub probability: f64,
    /// Relative error bound of `probability`, or its relative standard error times three.
    pub relative_error: f64,
}

/// A limit state from the standard-normal point to its margins.
#[derive(Clone)]
pub struct Function {
    pub dimension: usize,
    pub limits: usize,
    /// Margins of one point, appended.
    pub margins: fn(&[f64], &mut Vec<f64>),
}

impl LimitState for Function {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn limits(&self) -> usize {
        self.limits
    }

    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()> {
        let mut row = Vec::with_capacity(self.limits);
        for k in 0..z.rows() {
            row.clear();
            (self.margins)(&z.row(k), &mut row);
            for (i, &margin) in row.iter().enumerate() {
                margins.set(k, i, margin);
            }
        }
        Ok(())
    }
}

/// Every problem.
pub fn all() -> Vec<Benchmark> {
    let mut all = components::all();
    all.extend(systems::all());
    all.extend(laws::all());
    all.extend(oscillators::all());
    all.extend(dimensions::all());
    all
}

/// A component: one margin, certified to `relative_error`.
fn component(
    id: &'static str,
    dimension: usize,
    margins: fn(&[f64], &mut Vec<f64>),
    probability: f64,
    relative_error: f64,
) -> Benchmark {
    let limits = Function { dimension, limits: 1, margins };
    Benchmark { id, limits, event: Event::Limit(0), probability, relative_error }
}
