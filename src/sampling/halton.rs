//! Halton points with nested digit scrambling, random access and digit-by-digit stepping.
//!
//! Coordinate j is the radical inverse of the point's index in the j-th prime p (J. H. Halton, Numer.
//! Math. 2, 1960). Digit m of it, d, becomes h_m d + g (mod p): h_m ≠ 0 is drawn for the position, g
//! for the node, that is, for the digits before m. Every digit is so permuted in a way that depends on
//! the digits before it, as in A. B. Owen's nested uniform scrambling (1995), and two points have the
//! joint law of his: uniform before the digit in which they part, uniform on unequal pairs there,
//! independent after it.
//!
//! The node is named by the index cut to its first m − 1 digits, a number x, and g is digit m of a
//! keyed hash of x read as a fraction in base p. Past the last digit of the index that is not 0 all
//! nodes have the same name, so the rest of the coordinate is the rest of one hash, and a point costs
//! as many hashes as its index has digits. (A random matrix and shift modulo p would be cheaper and has
//! the same variance, but a distribution of errors with such tails, rare replicates in which whole
//! strata move as one, that a scatter of 16 replicates says nothing of it.)

use rand::Rng;

use super::unit_interval::{self, Strata};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, Stream, keyed};

/// The most coordinates: the 1024th prime is 8161. Long before, from some 30 coordinates on, the
/// points of practical runs are little better than random ones.
pub(super) const MAX_DIMENSION: usize = 1024;

/// Stream numbers of the scrambles.
const SCRAMBLE_STREAMS: u64 = 3 << 56;

/// Point `index` of the Halton sequence as published, unscrambled: in [0, 1), point 0 the origin.
///
/// # Errors
/// More coordinates than are supported, or an index of 2⁵⁰ and more.
pub fn unscrambled(index: u64, dimension: usize) -> Result<Vec<f64>> {
    if dimension > MAX_DIMENSION || index >= 1 << 50 {
        return Err(Error::argument(format!(
            "Halton points have at most {MAX_DIMENSION} coordinates and indices below 2^50, \
             not {dimension} and {index}"
        )));
    }
    let inverse = |prime: u64| {
        let (mut rest, mut reversed, mut scale) = (index, 0u64, 1u64);
        while rest != 0 {
            reversed = reversed * prime + rest % prime;
            scale *= prime;
            rest /= prime;
        }
        reversed as f64 / scale as f64
    };
    Ok(primes(dimension).into_iter().map(inverse).collect())
}

/// Independently scrambled Halton sequences, interleaved.
#[derive(Debug, Clone)]
pub(super) struct ScrambledHalton {
    replicates: u64,
    bases: Vec<Base>,
    /// Scramble of coordinate j in replicate r at `j * replicates + r`.
    scrambles: Vec<Scramble>,
}

impl ScrambledHalton {
    /// `replicates` sequences of points of `dimension` coordinates.
    pub(super) fn new(dimension: usize, replicates: u32, seed: u64, purpose: Purpose) -> Self {
        let mut keys = keyed(seed, purpose);
        let bases: Vec<Base> = primes(dimension).into_iter().map(Base::new).collect();
        let mut scrambles = Vec::with_capacity(dimension * replicates as usize);
        for (j, base) in bases.iter().enumerate() {
            for r in 0..u64::from(replicates) {
                keys.set_stream(SCRAMBLE_STREAMS | r << 32 | j as u64);
                scrambles.push(Scramble::new(base, &mut keys));
            }
        }
        ScrambledHalton { replicates: u64::from(replicates), bases, scrambles }
    }

    /// Fills every row of `out` with the samples from `first` on.
    pub(super) fn fill(&self, first: u64, out: &mut Columns) {
        let replicates = self.replicates as usize;
        for (j, scrambles) in self.scrambles.chunks_exact(replicates).enumerate() {
            let base = &self.bases[j];
            let column = out.column_mut(j);
            // Row i is sample first + i; replicate r first appears in row `lag`.
            for lag in 0..replicates.min(column.len()) {
                let sample = first + lag as u64;
                let scramble = &scrambles[(sample % self.replicates) as usize];
                let mut walk = Walk::from_index(base, scramble, sample / self.replicates);
                let mut values = column[lag..].iter_mut().step_by(replicates).peekable();
                while let Some(value) = values.next() {
                    *value = walk.uniform();
                    if values.peek().is_some() {
                        walk.step();
                    }
                }
            }
        }
    }
}

/// A prime and its powers.
#[derive(Debug, Clone)]
struct Base {
    prime: u64,
    /// 1, p, p², … pᵃ, pᵃ⁺¹ with a the most digits whose strata, p^−a wide, the grid resolves.
    powers: Vec<u64>,
    strata: Strata,
}

impl Base {
    fn new(prime: u64) -> Self {
        let (mut power, mut powers) = (1, vec![1]);
        while power <= Strata::MAX_COUNT / prime {
            power *= prime;
            powers.push(power);
        }
        // Below 2⁵⁰ · 2¹³: one digit more, so that every index below 2⁵⁰ has all its digits.
        powers.push(power * prime);
        Base { prime, powers, strata: Strata::new(power) }
    }

    /// The digits that name a stratum, a.
    fn naming(&self) -> usize {
        self.powers.len() - 2
    }
}

/// The keys of one coordinate of one replicate.
#[derive(Debug, Clone)]
struct Scramble {
    /// h_m, from 1 to p − 1, one a position.
    multipliers: Vec<u64>,
    factor: u64,
    addend: u64,
}

impl Scramble {
    fn new(base: &Base, keys: &mut Stream) -> Self {
        let multipliers = (0..=base.naming()).map(|_| 1 + below(base.prime - 1, keys)).collect();
        Scramble { multipliers, factor: keys.next_u64() | 1, addend: keys.next_u64() }
    }

    /// The fraction of node `x` in units of 2⁻⁶⁴.
    ///
    /// Exactly uniform for every node, being a bijection of the uniform addend. The odd factor makes
    /// nodes nearly independent in pairs; the mixing after it (the finaliser of D. Stafford's variant
    /// 13, as in SplitMix64: G. Steele, D. Lea, C. Flood, OOPSLA 2014) breaks what triples share.
    #[inline]
    fn fraction(&self, x: u64) -> u64 {
        let mut z = x.wrapping_mul(self.factor).wrapping_add(self.addend);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

/// A uniform integer below `n` < 2¹³, to within 2⁻⁵¹.
fn below(n: u64, keys: &mut Stream) -> u64 {
    whole_part(keys.next_u64(), n)
}

/// ⌊fraction · n⌋, the fraction in units of 2⁻⁶⁴. (`wrapping_mul` is the part that this leaves.)
#[inline]
fn whole_part(fraction: u64, n: u64) -> u64 {
    ((u128::from(fraction) * u128::from(n)) >> 64) as u64
}

/// One coordinate of one replicate on its way from point to point.
struct Walk<'a> {
    base: &'a Base,
    scramble: &'a Scramble,
    /// The digits of the index, lowest first, up to the last that is not 0.
    digits: Vec<Digit>,
}

/// A digit d and h d (mod p).
#[derive(Clone, Copy)]
struct Digit {
    value: u64,
    multiple: u64,
}

impl<'a> Walk<'a> {
    fn from_index(base: &'a Base, scramble: &'a Scramble, index: u64) -> Self {
        let mut digits = Vec::with_capacity(scramble.multipliers.len());
        let mut rest = index;
        for multiplier in &scramble.multipliers {
            if rest == 0 {
                break;
            }
            let value = rest % base.prime;
            digits.push(Digit { value, multiple: value * multiplier % base.prime });
            rest /= base.prime;
        }
        Walk { base, scramble, digits }
    }

    /// Moves to the next index.
    #[inline]
    fn step(&mut self) {
        let prime = self.base.prime;
        for (digit, multiplier) in self.digits.iter_mut().zip(&self.scramble.multipliers) {
            digit.value += 1;
            digit.multiple = reduced(digit.multiple + multiplier, prime);
            if digit.value < prime {
                return;
            }
            // p times the multiplier: the multiple is back at 0 by itself.
            digit.value = 0;
        }
        if let Some(&multiplier) = self.scramble.multipliers.get(self.digits.len()) {
            self.digits.push(Digit { value: 1, multiple: multiplier });
        }
    }

    /// The point's coordinate.
    #[inline]
    fn uniform(&self) -> f64 {
        let (prime, naming) = (self.base.prime, self.base.naming());
        let powers = &self.base.powers;
        let mut node = 0;
        let mut stratum = 0;
        let mut last = None;
        let mut fraction = self.scramble.fraction(0);
        for (m, (digit, power)) in self.digits.iter().zip(powers).enumerate() {
            let shift = whole_part(fraction.wrapping_mul(*power), prime);
            let scrambled = reduced(digit.multiple + shift, prime);
            if m < naming {
                stratum = stratum * prime + scrambled;
            } else {
                last = Some(scrambled);
            }
            node += digit.value * power;
            fraction = self.scramble.fraction(node);
        }
        // What of the hash of the whole index lies past its digits.
        let rest = fraction.wrapping_mul(powers[self.digits.len()]);
        let within = match last {
            Some(last) => (last as f64 + unit_interval::from_word(rest)) / prime as f64,
            None => {
                let missing = powers[naming - self.digits.len()];
                stratum = stratum * missing + whole_part(rest, missing);
                unit_interval::from_word(rest.wrapping_mul(missing))
            }
        };
        self.base.strata.place(stratum as i64 as f64, within)
    }
}

/// `sum` < 2p modulo p.
#[inline]
fn reduced(sum: u64, prime: u64) -> u64 {
    if sum >= prime { sum - prime } else { sum }
}

/// The first `count` primes.
fn primes(count: usize) -> Vec<u64> {
    let mut primes: Vec<u64> = Vec::with_capacity(count);
    let mut candidate = 2;
    while primes.len() < count {
        let mut smaller = primes.iter().take_while(|&&prime| prime * prime <= candidate);
        if smaller.all(|prime| !candidate.is_multiple_of(*prime)) {
            primes.push(candidate);
        }
        candidate += 1;
    }
    primes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_primes() {
        assert_eq!(primes(10), [2, 3, 5, 7, 11, 13, 17, 19, 23, 29]);
        assert_eq!(primes(1024).last(), Some(&8161));
    }

    #[test]
    fn property_strata_are_as_fine_as_the_grid_resolves_and_indices_have_all_their_digits() {
        for prime in primes(MAX_DIMENSION) {
            let base = Base::new(prime);
            let (strata, beyond) = (base.powers[base.naming()], base.powers[base.naming() + 1]);
            assert!(strata <= 1 << 50 && beyond > 1 << 50, "{prime}");
            assert_eq!(u128::from(prime).pow(base.naming() as u32 + 1), u128::from(beyond));
        }
    }

    #[test]
    fn property_stepping_and_jumping_meet() {
        for prime in [2, 3, 47, 8161] {
            let base = Base::new(prime);
            let scramble = Scramble::new(&base, &mut keyed(1, Purpose::Test));
            for start in [0, prime - 1, (1 << 30) - 7, (1 << 50) - 300] {
                let mut walk = Walk::from_index(&base, &scramble, start);
                for index in start..start + 290 {
                    assert_eq!(walk.uniform(), Walk::from_index(&base, &scramble, index).uniform());
                    walk.step();
                }
            }
        }
    }
}
