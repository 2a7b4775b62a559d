//! From integers to uniforms in the open interval (0, 1) on the 53-bit grid.

/// The grid's spacing.
const STEP: f64 = 1.0 / (1u64 << 53) as f64;

/// The uniform made of the leading 53 bits of `word`: a multiple of 2⁻⁵³, with 0 replaced by 2⁻⁵⁴.
#[inline]
pub(super) fn from_word(word: u64) -> f64 {
    ((word >> 11) as f64 * STEP).max(0.5 * STEP)
}

/// `n` equal strata of the unit interval, each as a place for points strictly inside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strata {
    count: f64,
    places: f64,
    place_width: f64,
}

impl Strata {
    /// The most strata whose inside the grid resolves.
    pub(super) const MAX_COUNT: u64 = 1 << 50;

    /// Strata `0 … n − 1`, for `n` from 1 to [`Strata::MAX_COUNT`].
    pub(super) fn new(n: u64) -> Self {
        let bits = n.next_power_of_two().trailing_zeros();
        let places = (1u64 << (50 - bits.min(50))) as f64;
        Strata { count: n as f64, places, place_width: 1.0 / places }
    }

    /// The grid point at the fraction `within` (in [0, 1]) of stratum `s`, a whole number, strictly inside it.
    ///
    /// A stratum is cut into 2^q places, q = 50 − ⌈log₂ n⌉, and the point is a place's middle. Then
    /// s + (place + ½) 2^−q has at most 51 bits and is exact, and it is at least 2^−(q+1) from the
    /// stratum's ends, which after the division by n is at least 2⁻⁵¹: the rounding of the quotient
    /// (2⁻⁵⁴) and the cut to the grid (2⁻⁵³) together cannot leave the stratum.
    #[inline]
    pub(super) fn place(&self, s: f64, within: f64) -> f64 {
        let place = truncated(within * self.places).min(self.places - 1.0) + 0.5;
        let uniform = (s + place * self.place_width) / self.count;
        truncated(uniform * (1u64 << 53) as f64) * STEP
    }
}

/// `x` without its fraction, for 0 ≤ x < 2⁶³: without SSE4.1 `f64::floor` is a call.
#[inline]
fn truncated(x: f64) -> f64 {
    x as i64 as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_every_word_is_strictly_inside_the_unit_interval() {
        for word in [0, 1, 2047, 2048, u64::MAX, u64::MAX - 2047, 1 << 63] {
            let u = from_word(word);
            assert!(u > 0.0 && u < 1.0, "{word}");
        }
        assert_eq!(from_word(0), 0.5f64.powi(54));
        assert_eq!(from_word(2048), 0.5f64.powi(53));
        assert_eq!(from_word(u64::MAX), 1.0 - 0.5f64.powi(53));
    }

    #[test]
    fn property_a_place_is_on_the_grid_and_strictly_inside_its_stratum() {
        let counts =
            [1, 2, 3, 7, 1000, 6250, (1 << 20) - 1, (1 << 32) + 15, (1 << 49) + 1, 1 << 50];
        for n in counts {
            let strata = Strata::new(n);
            for s in [0, 1, 2, n / 3, n / 2, n.saturating_sub(2), n - 1] {
                let s = s.min(n - 1);
                for within in [0.0, 0.5f64.powi(54), 0.1, 0.5, 1.0 - 0.5f64.powi(53), 1.0] {
                    let scaled = strata.place(s as f64, within) * (1u64 << 53) as f64;
                    assert_eq!(scaled, scaled.trunc());
                    // Exact: s/n < g/2⁵³ < (s + 1)/n in integers.
                    let g = scaled as u128 * u128::from(n);
                    assert!(g > u128::from(s) << 53 && g < u128::from(s + 1) << 53, "{s} of {n}");
                }
            }
        }
    }
}
