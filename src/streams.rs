//! Random streams keyed by what they are for: the only place where a generator is made.
//!
//! Stream `k` of a purpose is a pure function of `(seed, purpose, k)`: ChaCha8 with a key made of the
//! seed and the purpose, and the index as its stream number. Samples may therefore be drawn in any
//! order, by any number of threads, again years later, and one alone, with the same bits.

use crate::numerics::special::normal;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

/// A random stream; `rand::Rng` and `rand_distr` distributions work on it.
pub type Stream = ChaCha8Rng;

/// What a stream is for. Streams of different purposes are independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Purpose {
    /// The main design of experiment.
    Design,
    /// Scrambles and permutations of the main design.
    Scramble,
    /// The pick-freeze design of the Sobol' indices.
    PickFreeze,
    /// Bootstrap resampling.
    Bootstrap,
    /// Importance sampling.
    ImportanceSampling,
    /// Subset simulation.
    SubsetSimulation,
    /// Line sampling.
    LineSampling,
    /// Directional sampling.
    DirectionalSampling,
    /// Cross-entropy adaptive importance sampling.
    CrossEntropy,
    /// Starting points of the design-point search.
    DesignPoint,
    /// Random permutations of a test of independence.
    Permutation,
    /// A run that confirms another.
    Confirmation,
    /// Continuations of what is already known.
    Known,
    /// Random orders and points of the Shapley effects.
    Shapley,
    /// Sets of values of what is not known.
    Unknown,
    /// What varies, with each set.
    Varying,
    /// Pick-freeze sets of what is not known.
    UnknownShares,
    /// What varies, with each pick-freeze set.
    VaryingShares,
    /// Trajectories of a screening.
    Screening,
    /// Draws of a posterior.
    Calibration,
    /// Data made up from a known truth.
    Synthetic,
    /// Brakes and states of knowledge behind a plan of tests.
    Planning,
    /// Rows of an earlier table that are computed again.
    SpotCheck,
    /// Tests and benchmarks.
    Test,
}

impl Purpose {
    /// The purpose's share of the key: eight bytes that never change once published.
    fn tag(self) -> [u8; 8] {
        *match self {
            Purpose::Design => b"design  ",
            Purpose::Scramble => b"scramble",
            Purpose::PickFreeze => b"pickfrez",
            Purpose::Bootstrap => b"bootstrp",
            Purpose::ImportanceSampling => b"importnc",
            Purpose::SubsetSimulation => b"subsetsi",
            Purpose::LineSampling => b"linesamp",
            Purpose::DirectionalSampling => b"directio",
            Purpose::CrossEntropy => b"crossent",
            Purpose::DesignPoint => b"designpt",
            Purpose::Permutation => b"permutat",
            Purpose::Confirmation => b"confirmn",
            Purpose::Known => b"knownval",
            Purpose::Shapley => b"shapley ",
            Purpose::Unknown => b"unknownv",
            Purpose::Varying => b"varyingv",
            Purpose::UnknownShares => b"unknshar",
            Purpose::VaryingShares => b"varyshar",
            Purpose::Screening => b"screenng",
            Purpose::Calibration => b"calibrat",
            Purpose::Synthetic => b"syntheti",
            Purpose::Planning => b"planning",
            Purpose::SpotCheck => b"spotchek",
            Purpose::Test => b"test    ",
        }
    }
}

/// Stream number `index` of `purpose` under `seed`.
pub fn stream(seed: u64, purpose: Purpose, index: u64) -> Stream {
    let mut rng = keyed(seed, purpose);
    rng.set_stream(index);
    rng
}

/// Stream 0 of `purpose` under `seed`, to be moved with `set_stream`, which is cheaper than a new key.
pub fn keyed(seed: u64, purpose: Purpose) -> Stream {
    let mut key = [0u8; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&purpose.tag());
    key[16..24].copy_from_slice(b"reeldown");
    Stream::from_seed(key)
}

/// A uniform number in the open interval (0, 1) on the grid of 2⁻⁵³.
pub fn open_uniform(stream: &mut Stream) -> f64 {
    let k = stream.next_u64() >> 11;
    let scale = 1.0 / (1u64 << 53) as f64;
    if k == 0 { 0.5 * scale } else { k as f64 * scale }
}

/// A standard-normal number, by inversion.
pub fn standard_normal(stream: &mut Stream) -> f64 {
    normal::quantile(open_uniform(stream))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_stream_is_a_pure_function_of_its_key() {
        let draw = |seed, purpose, index| {
            let mut rng = stream(seed, purpose, index);
            (0..40).map(|_| rng.next_u64()).collect::<Vec<_>>()
        };
        let base = draw(7, Purpose::Design, 3);
        assert_eq!(base, draw(7, Purpose::Design, 3));
        assert_ne!(base, draw(8, Purpose::Design, 3));
        assert_ne!(base, draw(7, Purpose::Scramble, 3));
        assert_ne!(base, draw(7, Purpose::Design, 4));
        let mut moved = keyed(7, Purpose::Design);
        moved.next_u64();
        moved.set_stream(3);
        moved.set_word_pos(0);
        assert_eq!(base[0], moved.next_u64());
    }

    #[test]
    fn regression_published_bits_of_the_first_stream() {
        let mut rng = stream(1993, Purpose::Design, 0);
        let bits = [rng.next_u64(), rng.next_u64()];
        assert_eq!(
            bits,
            [5652316154710596717, 14630980462891636090],
            "seeded studies of earlier versions would change"
        );
    }
}
