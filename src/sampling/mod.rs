//! Designs of experiment: where in the unit cube the samples lie.
//!
//! A [`Sampler`] gives point `k` of its design as a pure function of `(seed, purpose, k)`: any chunk,
//! in any order, on any thread, has the same bits. Coordinates are uniforms in the open interval
//! (0, 1) on the 53-bit grid.
//!
//! Latin hypercube, Sobol' and Halton designs are randomised and replicated: sample `k` is point
//! `k / R` of replicate `k mod R`, and every replicate is randomised independently, because only the
//! scatter of independent replicates is an honest error of such a design (A. B. Owen, *Randomly
//! permuted (t,m,s)-nets and (t,s)-sequences*, 1995). The replicates are interleaved so that a longer
//! Sobol' or Halton run has the shorter one as its first rows.

mod halton;
mod joe_kuo;
mod latin_hypercube;
mod monte_carlo;
mod sobol;
mod unit_interval;

use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::streams::Purpose;

pub use halton::unscrambled as unscrambled_halton;
pub use sobol::unscrambled as unscrambled_sobol;

/// The replicates of a randomised quasi-Monte Carlo or Latin hypercube design unless told otherwise.
pub const DEFAULT_REPLICATES: u32 = 16;

/// The most replicates that a design can have: each costs memory for its randomisation.
pub const MAX_REPLICATES: u32 = 256;

/// The most samples that a design can have.
pub const MAX_SAMPLES: u64 = 1 << 50;

/// The way in which the samples are spread over the unit cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Design {
    /// Independent points.
    MonteCarlo,
    /// One point in each of n equal slices of every coordinate.
    LatinHypercube,
    /// Sobol' sequence, Owen-scrambled.
    Sobol,
    /// Halton sequence, scrambled.
    Halton,
}

impl Design {
    /// Every design, in the order of the documentation.
    pub const ALL: [Design; 4] =
        [Design::MonteCarlo, Design::LatinHypercube, Design::Sobol, Design::Halton];

    /// The design of that name in a study file; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Design::ALL.into_iter().find(|design| design.name() == name)
    }

    /// The design's name in a study file.
    pub fn name(self) -> &'static str {
        match self {
            Design::MonteCarlo => "monte-carlo",
            Design::LatinHypercube => "latin-hypercube",
            Design::Sobol => "sobol",
            Design::Halton => "halton",
        }
    }

    /// Whether the design's error is the scatter of independent replicates.
    pub fn is_replicated(self) -> bool {
        self != Design::MonteCarlo
    }

    /// Whether a longer run has the shorter one as its first rows.
    pub fn is_extensible(self) -> bool {
        self != Design::LatinHypercube
    }

    /// The most coordinates that a point of this design can have.
    pub fn max_dimension(self) -> usize {
        match self {
            Design::MonteCarlo | Design::LatinHypercube => 4096,
            Design::Sobol => joe_kuo::MAX_DIMENSION,
            Design::Halton => halton::MAX_DIMENSION,
        }
    }
}

/// A design of experiment of known size: point `k` on demand.
#[derive(Debug, Clone)]
pub struct Sampler {
    design: Design,
    dimension: usize,
    samples: u64,
    replicates: u32,
    points: Points,
}

/// The randomised points behind each design.
#[derive(Debug, Clone)]
enum Points {
    MonteCarlo(monte_carlo::Blocks),
    LatinHypercube(latin_hypercube::LatinHypercube),
    Sobol(sobol::ScrambledSobol),
    Halton(halton::ScrambledHalton),
}

impl Sampler {
    /// A design of `samples` points of `dimension` coordinates in `replicates` replicates.
    ///
    /// Plain Monte Carlo has no replicates: it ignores the argument and says one.
    ///
    /// # Errors
    /// No coordinate or no sample; more coordinates, samples or replicates than the design has;
    /// samples that the replicates cannot share equally (the message says the next number that works).
    pub fn new(
        design: Design,
        dimension: usize,
        samples: u64,
        replicates: u32,
        seed: u64,
        purpose: Purpose,
    ) -> Result<Self> {
        let replicates = if design.is_replicated() { replicates } else { 1 };
        check(design, dimension, samples, replicates)?;
        let points_per_replicate = samples / u64::from(replicates);
        let points = match design {
            Design::MonteCarlo => Points::MonteCarlo(monte_carlo::Blocks::new(seed, purpose, 0)),
            Design::LatinHypercube => Points::LatinHypercube(latin_hypercube::LatinHypercube::new(
                dimension,
                points_per_replicate,
                replicates,
                seed,
                purpose,
            )),
            Design::Sobol => {
                Points::Sobol(sobol::ScrambledSobol::new(dimension, replicates, seed, purpose)?)
            }
            Design::Halton => {
                Points::Halton(halton::ScrambledHalton::new(dimension, replicates, seed, purpose))
            }
        };
        Ok(Sampler { design, dimension, samples, replicates, points })
    }

    /// Fills every row of `out` with the points `first`, `first + 1`, …: uniforms in (0, 1).
    ///
    /// # Errors
    /// `out` has another number of columns than the design, or rows beyond the last sample.
    pub fn fill(&self, first: u64, out: &mut Columns) -> Result<()> {
        if out.columns() != self.dimension {
            return Err(Error::argument(format!(
                "a table of {} columns cannot hold points of {} coordinates",
                out.columns(),
                self.dimension
            )));
        }
        if first.checked_add(out.rows() as u64).is_none_or(|end| end > self.samples) {
            return Err(Error::argument(format!(
                "{} points from point {first} on are beyond the design's {} samples",
                out.rows(),
                self.samples
            )));
        }
        match &self.points {
            Points::MonteCarlo(points) => points.fill(first, out),
            Points::LatinHypercube(points) => points.fill(first, out),
            Points::Sobol(points) => points.fill(first, out),
            Points::Halton(points) => points.fill(first, out),
        }
        Ok(())
    }

    /// The design.
    pub fn design(&self) -> Design {
        self.design
    }

    /// Coordinates of a point.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Points in all replicates together.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Independently randomised replicates; one for plain Monte Carlo.
    pub fn replicates(&self) -> u32 {
        self.replicates
    }

    /// Points in each replicate.
    pub fn points_per_replicate(&self) -> u64 {
        self.samples / u64::from(self.replicates)
    }

    /// The replicate to which sample `k` belongs.
    pub fn replicate_of(&self, k: u64) -> u32 {
        // The remainder is below a u32, so nothing is cut off.
        (k % u64::from(self.replicates)) as u32
    }

    /// Whether a longer run has this one as its first rows.
    pub fn extensible(&self) -> bool {
        self.design.is_extensible()
    }

    /// The design in plain English, for a report.
    pub fn describe(&self) -> String {
        let shape = format!("{} samples of {} inputs", self.samples, self.dimension);
        let shared = format!(
            "{} independent replicates of {}",
            self.replicates,
            self.points_per_replicate()
        );
        match self.design {
            Design::MonteCarlo => {
                format!("plain Monte Carlo: {shape}, every sample independent of the rest")
            }
            Design::LatinHypercube => format!("Latin hypercube: {shape} in {shared} points"),
            Design::Sobol => format!(
                "Sobol' sequence (Joe and Kuo's direction numbers, Owen-scrambled): {shape} in {shared} points"
            ),
            Design::Halton => {
                format!("Halton sequence (digits randomly scrambled): {shape} in {shared} points")
            }
        }
    }

    /// What would make the design serve better, if anything.
    ///
    /// A lone replicate earns no error; a scrambled Sobol' sequence is balanced only at powers of two.
    pub fn advice(&self) -> Option<String> {
        if !self.design.is_replicated() {
            return None;
        }
        if self.replicates == 1 {
            return Some(format!(
                "one replicate of a {} design has no error estimate: use {DEFAULT_REPLICATES} replicates",
                self.design.name()
            ));
        }
        let points = self.points_per_replicate();
        if self.design != Design::Sobol || points.is_power_of_two() {
            return None;
        }
        let above = points.next_power_of_two();
        let replicates = u64::from(self.replicates);
        Some(format!(
            "{points} points in each of {replicates} replicates is not a power of two, where a Sobol' \
             sequence is balanced: {} or {} samples give more for their cost",
            above / 2 * replicates,
            above * replicates
        ))
    }
}

/// Refuses a design that cannot be made.
fn check(design: Design, dimension: usize, samples: u64, replicates: u32) -> Result<()> {
    let name = design.name();
    if dimension == 0 || samples == 0 || replicates == 0 {
        return Err(Error::argument(format!(
            "a {name} design needs at least one input, one sample and one replicate, \
             not {dimension}, {samples} and {replicates}"
        )));
    }
    if dimension > design.max_dimension() {
        return Err(Error::argument(format!(
            "a {name} design has at most {} inputs, not {dimension}: use monte-carlo, \
             or make fewer inputs uncertain",
            design.max_dimension()
        )));
    }
    if samples > MAX_SAMPLES {
        return Err(Error::argument(format!(
            "a design has at most {MAX_SAMPLES} samples, not {samples}"
        )));
    }
    if replicates > MAX_REPLICATES {
        return Err(Error::argument(format!(
            "a {name} design has at most {MAX_REPLICATES} replicates, not {replicates}"
        )));
    }
    let shares = u64::from(replicates);
    if !samples.is_multiple_of(shares) {
        return Err(Error::argument(format!(
            "{samples} samples cannot be shared equally by {replicates} replicates of a {name} design: \
             use {} samples",
            samples.next_multiple_of(shares)
        )));
    }
    Ok(())
}
