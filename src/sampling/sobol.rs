//! Sobol' points with nested uniform (Owen) scrambling, random access and Gray-code stepping.
//!
//! Two randomisations, one after the other, in every coordinate of every replicate:
//!
//! 1. a random lower triangular binary matrix with a unit diagonal and a digital shift (J. Matoušek,
//!    J. Complexity 14, 1998). It is folded into the direction numbers and costs nothing a point. Any
//!    two points then have exactly the joint law of Owen's scrambling, so that means are unbiased and
//!    variances are those of nested uniform scrambling (Owen, ACM TOMACS 13, 2003) by proof;
//! 2. a keyed hash in which a digit is changed by the digits before it only (S. Laine, T. Karras,
//!    Computer Graphics Forum 30, 2011), here on 64-bit words with all constants drawn from the key. It
//!    breaks the linear structure that three and more points of step 1 still share, which nested uniform
//!    scrambling has not either. It maps pairs that agree in exactly k digits onto such pairs, one to
//!    one, so what step 1 guarantees survives it.
//!
//! Words are kept with the leading digit in bit 0, because carries run upwards; they are turned round
//! at the end. 64 digits are scrambled and the leading 53 used.

use rand::Rng;

use super::joe_kuo::{Directions, INDEX_BITS, directions};
use super::unit_interval;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, Stream, keyed};

/// Stream numbers of the scrambles.
const SCRAMBLE_STREAMS: u64 = 2 << 56;

/// Point `index` of the Sobol' sequence as published, unscrambled, in Gray-code order: in [0, 1).
///
/// The order is that of I. A. Antonov and V. M. Saleev (1979), in which point 0 is the origin and each
/// 2^m points from a multiple of 2^m on are the same set as in the original order.
///
/// # Errors
/// More coordinates than there are direction numbers, or an index of 2⁵³ and more.
pub fn unscrambled(index: u64, dimension: usize) -> Result<Vec<f64>> {
    if index >> INDEX_BITS != 0 {
        return Err(Error::argument(format!("Sobol' point {index} is beyond the last, 2^53 - 1")));
    }
    let fraction = |v: &Directions| {
        let mut word = 0;
        for_each_set_bit(gray(index), |i| word ^= v[i]);
        (word >> 11) as f64 / (1u64 << 53) as f64
    };
    Ok(directions(dimension)?.iter().map(fraction).collect())
}

/// Independently scrambled Sobol' sequences, interleaved.
#[derive(Debug, Clone)]
pub(super) struct ScrambledSobol {
    replicates: usize,
    coordinates: Vec<Coordinate>,
}

/// One coordinate in every replicate.
#[derive(Debug, Clone)]
struct Coordinate {
    /// Direction number i of replicate r, reversed and multiplied by its matrix, at `i * replicates + r`.
    directions: Vec<u64>,
    shifts: Vec<u64>,
    hashes: Vec<NestedHash>,
}

impl ScrambledSobol {
    /// `replicates` sequences of points of `dimension` coordinates.
    ///
    /// # Errors
    /// More coordinates than there are direction numbers.
    pub(super) fn new(
        dimension: usize,
        replicates: u32,
        seed: u64,
        purpose: Purpose,
    ) -> Result<Self> {
        let mut keys = keyed(seed, purpose);
        let replicates = replicates as usize;
        let mut coordinates = Vec::with_capacity(dimension);
        for (j, raw) in directions(dimension)?.iter().enumerate() {
            let mut coordinate = Coordinate {
                directions: vec![0; INDEX_BITS * replicates],
                shifts: Vec::with_capacity(replicates),
                hashes: Vec::with_capacity(replicates),
            };
            for r in 0..replicates {
                keys.set_stream(SCRAMBLE_STREAMS | (r as u64) << 32 | j as u64);
                let matrix = random_lower_triangle(&mut keys);
                for (i, v) in raw.iter().enumerate() {
                    let mut product = 0;
                    for_each_set_bit(v.reverse_bits(), |digit| product ^= matrix[digit]);
                    coordinate.directions[i * replicates + r] = product;
                }
                coordinate.shifts.push(keys.next_u64());
                coordinate.hashes.push(NestedHash::new(&mut keys));
            }
            coordinates.push(coordinate);
        }
        Ok(ScrambledSobol { replicates, coordinates })
    }

    /// Fills every row of `out` with the samples from `first` on.
    pub(super) fn fill(&self, first: u64, out: &mut Columns) {
        let replicates = self.replicates as u64;
        let mut words = vec![0; self.replicates];
        for (j, coordinate) in self.coordinates.iter().enumerate() {
            let mut point = first / replicates;
            let mut start = (first % replicates) as usize;
            coordinate.jump(point, &mut words);
            let mut rest = out.column_mut(j);
            while !rest.is_empty() {
                let count = (self.replicates - start).min(rest.len());
                let (now, later) = rest.split_at_mut(count);
                let inputs = words[start..].iter().zip(&coordinate.hashes[start..]);
                for (value, (&word, hash)) in now.iter_mut().zip(inputs) {
                    *value = unit_interval::from_word(hash.apply(word).reverse_bits());
                }
                rest = later;
                start = 0;
                point += 1;
                coordinate.step(point, &mut words);
            }
        }
    }
}

impl Coordinate {
    /// Sets `words` to point `index` of every replicate.
    fn jump(&self, index: u64, words: &mut [u64]) {
        words.copy_from_slice(&self.shifts);
        for_each_set_bit(gray(index), |i| self.toggle(i, words));
    }

    /// Moves `words` from point `index − 1` to point `index` ≥ 1.
    #[inline]
    fn step(&self, index: u64, words: &mut [u64]) {
        self.toggle(index.trailing_zeros() as usize, words);
    }

    #[inline]
    fn toggle(&self, i: usize, words: &mut [u64]) {
        let row = i * words.len();
        // The one direction beyond the last belongs to the step after the last point of all.
        if let Some(directions) = self.directions.get(row..row + words.len()) {
            for (word, direction) in words.iter_mut().zip(directions) {
                *word ^= direction;
            }
        }
    }
}

/// A keyed bijection of words in which bit i of the result depends on bits 0 … i only.
#[derive(Debug, Clone, Copy)]
struct NestedHash {
    even: [u64; 3],
    odd: u64,
    addend: u64,
}

impl NestedHash {
    fn new(keys: &mut Stream) -> Self {
        NestedHash {
            even: [(); 3].map(|()| keys.next_u64() & !1),
            odd: keys.next_u64() | 1,
            addend: keys.next_u64(),
        }
    }

    #[inline]
    fn apply(&self, word: u64) -> u64 {
        let mut x = word;
        x ^= x.wrapping_mul(self.even[0]);
        x = x.wrapping_add(self.addend);
        x ^= x.wrapping_mul(self.even[1]);
        x = x.wrapping_mul(self.odd);
        x ^= x.wrapping_mul(self.even[2]);
        x
    }
}

/// Columns of a random lower triangular matrix with a unit diagonal; digit i is bit i.
fn random_lower_triangle(keys: &mut Stream) -> [u64; 64] {
    let mut columns = [0; 64];
    for (i, column) in columns.iter_mut().enumerate() {
        *column = (keys.next_u64() | 1) << i;
    }
    columns
}

/// The Gray code: neighbours differ in the bit that counts the trailing zeros of the larger.
fn gray(index: u64) -> u64 {
    index ^ (index >> 1)
}

/// Calls `with` with the position of each set bit, lowest first.
#[inline]
fn for_each_set_bit(mut word: u64, mut with: impl FnMut(usize)) {
    while word != 0 {
        with(word.trailing_zeros() as usize);
        word &= word - 1;
    }
}
