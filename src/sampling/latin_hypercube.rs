//! Latin hypercube designs with random access and no table of n entries.
//!
//! In every coordinate of a replicate of n points each of the n equal slices holds exactly one point
//! (M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21, 1979). Which one is told by a keyed
//! permutation of 0 … n − 1: a few rounds of addition, odd multiplication and exclusive-or of the high
//! half into the low, all bijections of b-bit words, walked along its cycle until it is below n, then
//! rotated by a uniform offset, which makes every point's slice exactly uniform whatever the rounds do.
//! Where in its slice a point lies is an independent uniform.

use rand::Rng;

use super::monte_carlo::Blocks;
use super::unit_interval::Strata;
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, Stream, keyed};

/// Rounds of the permutation: with five, all 120 permutations of 5 are equally frequent in a test.
const ROUNDS: usize = 5;

/// Stream numbers of the permutations.
const PERMUTATION_STREAMS: u64 = 1 << 56;

/// Stream numbers of the places within slices.
const PLACE_STREAMS: u64 = 4 << 56;

/// Independent Latin hypercubes, interleaved.
#[derive(Debug, Clone)]
pub(super) struct LatinHypercube {
    replicates: u64,
    strata: Strata,
    within: Blocks,
    /// Permutation of coordinate j in replicate r at `j * replicates + r`.
    permutations: Vec<Permutation>,
}

impl LatinHypercube {
    /// `replicates` hypercubes of `points` points each.
    pub(super) fn new(
        dimension: usize,
        points: u64,
        replicates: u32,
        seed: u64,
        purpose: Purpose,
    ) -> Self {
        let mut keys = keyed(seed, purpose);
        let mut permutations = Vec::with_capacity(dimension * replicates as usize);
        for j in 0..dimension as u64 {
            for r in 0..u64::from(replicates) {
                keys.set_stream(PERMUTATION_STREAMS | r << 32 | j);
                permutations.push(Permutation::new(points, &mut keys));
            }
        }
        LatinHypercube {
            replicates: u64::from(replicates),
            strata: Strata::new(points),
            within: Blocks::new(seed, purpose, PLACE_STREAMS),
            permutations,
        }
    }

    /// Fills every row of `out` with the samples from `first` on.
    pub(super) fn fill(&self, first: u64, out: &mut Columns) {
        self.within.fill(first, out);
        let replicates = self.replicates as usize;
        for (j, permutations) in self.permutations.chunks_exact(replicates).enumerate() {
            let mut point = first / self.replicates;
            let mut replicate = (first % self.replicates) as usize;
            for value in out.column_mut(j) {
                let slice = permutations[replicate].image(point);
                *value = self.strata.place(slice as i64 as f64, *value);
                replicate += 1;
                if replicate == replicates {
                    replicate = 0;
                    point += 1;
                }
            }
        }
    }
}

/// A keyed permutation of 0 … n − 1 with random access.
#[derive(Debug, Clone)]
struct Permutation {
    n: u64,
    mask: u64,
    half: u32,
    rounds: [(u64, u64); ROUNDS],
    offset: u64,
}

impl Permutation {
    /// A permutation of 0 … n − 1, n ≥ 1, keyed by the next words of `keys`.
    fn new(n: u64, keys: &mut Stream) -> Self {
        let bits = n.next_power_of_two().trailing_zeros().max(1);
        let rounds = [(); ROUNDS].map(|()| (keys.next_u64(), keys.next_u64() | 1));
        // The high half of a 128-bit product: uniform on 0 … n − 1 to within n/2⁶⁴ ≤ 2⁻¹⁴.
        let offset = ((u128::from(keys.next_u64()) * u128::from(n)) >> 64) as u64;
        Permutation { n, mask: (1 << bits) - 1, half: bits.div_ceil(2), rounds, offset }
    }

    /// Where `i` < n goes.
    #[inline]
    fn image(&self, i: u64) -> u64 {
        let mut x = i;
        loop {
            for &(addend, factor) in &self.rounds {
                x = x.wrapping_add(addend).wrapping_mul(factor) & self.mask;
                x ^= x >> self.half;
            }
            if x < self.n {
                break;
            }
        }
        let rotated = x + self.offset;
        if rotated < self.n { rotated } else { rotated - self.n }
    }
}
