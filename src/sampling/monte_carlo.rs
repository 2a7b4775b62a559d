//! Independent uniforms with random access: point k is a pure function of (seed, purpose, k).
//!
//! A stream for every point would cost a generator's set-up and a buffer of 64 words for each, mostly
//! thrown away. Instead 32 neighbouring points share a stream, whose number is their block's, and
//! coordinate j of the block is the stream's words 64 j … 64 j + 63: exactly one buffer of the
//! generator. A whole block is then read in sequence and written column by column, a point alone costs
//! one buffer a coordinate, and a coordinate added at the end leaves the others as they were.

use rand::Rng;

use super::unit_interval;
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, keyed};

/// Points that share a stream.
const BLOCK_POINTS: u64 = 32;

/// ChaCha words (32 bits) in one uniform.
const WORDS_PER_UNIFORM: u64 = 2;

/// Independent uniforms for every (point, coordinate).
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks {
    seed: u64,
    purpose: Purpose,
    first_stream: u64,
}

impl Blocks {
    /// The uniforms of `purpose` under `seed`, from the 2⁴⁵ streams that begin at `first_stream`.
    pub(super) fn new(seed: u64, purpose: Purpose, first_stream: u64) -> Self {
        Blocks { seed, purpose, first_stream }
    }

    /// Fills every row of `out` with the points from `first` on.
    pub(super) fn fill(&self, first: u64, out: &mut Columns) {
        let mut stream = keyed(self.seed, self.purpose);
        let rows = out.rows() as u64;
        let mut row = 0;
        while row < rows {
            let point = first + row;
            let within = point % BLOCK_POINTS;
            let count = (BLOCK_POINTS - within).min(rows - row);
            stream.set_stream(self.first_stream + point / BLOCK_POINTS);
            for j in 0..out.columns() {
                if count < BLOCK_POINTS {
                    let word = (j as u64 * BLOCK_POINTS + within) * WORDS_PER_UNIFORM;
                    stream.set_word_pos(u128::from(word));
                }
                for value in &mut out.column_mut(j)[row as usize..(row + count) as usize] {
                    *value = unit_interval::from_word(stream.next_u64());
                }
            }
            row += count;
        }
    }
}
