//! Direction numbers of the Sobol' sequence: S. Joe and F. Y. Kuo, SIAM J. Sci. Comput. 30 (2008).

use crate::error::{Error, Result};

/// The parameters, with their authors' notice.
const TABLE: &str = include_str!("joe_kuo.txt");

/// The most coordinates for which the table has parameters.
pub(super) const MAX_DIMENSION: usize = 1024;

/// Bits of a point's index: direction numbers of a coordinate.
pub(super) const INDEX_BITS: usize = 53;

/// Direction numbers v₁ … v₅₃ of one coordinate as binary fractions: bit 63 is worth one half.
pub(super) type Directions = [u64; INDEX_BITS];

/// Direction numbers of the first `dimension` coordinates.
///
/// The first coordinate is van der Corput's; the others follow the recurrence of P. Bratley and
/// B. L. Fox (ACM TOMS 14, 1988): with the primitive polynomial x^s + a₁ x^(s−1) + … + 1,
/// v_i = a₁ v_(i−1) ⊕ … ⊕ a_(s−1) v_(i−s+1) ⊕ v_(i−s) ⊕ (v_(i−s) / 2^s).
///
/// # Errors
/// More coordinates than the table has, or a damaged table.
pub(super) fn directions(dimension: usize) -> Result<Vec<Directions>> {
    let mut all = Vec::with_capacity(dimension);
    let mut first = [0; INDEX_BITS];
    for (i, v) in first.iter_mut().enumerate() {
        *v = 1 << (63 - i);
    }
    all.push(first);
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    for line in lines.take(dimension.saturating_sub(1)) {
        let from_line = parse(line);
        all.push(from_line.ok_or_else(|| {
            Error::argument(format!("the table of Sobol' direction numbers is damaged at `{line}`"))
        })?);
    }
    if all.len() < dimension {
        return Err(Error::argument(format!(
            "Sobol' direction numbers are known for {} coordinates, not {dimension}",
            all.len()
        )));
    }
    all.truncate(dimension);
    Ok(all)
}

/// The direction numbers of one line "d s a m₁ … m_s"; `None` if it is not such a line.
fn parse(line: &str) -> Option<Directions> {
    let mut numbers = line.split_whitespace().map(|word| word.parse::<u64>().ok());
    let (_coordinate, degree, inner) = (numbers.next()??, numbers.next()??, numbers.next()??);
    let degree = usize::try_from(degree).ok().filter(|s| (1..INDEX_BITS).contains(s))?;
    let mut v = [0u64; INDEX_BITS];
    for (i, v) in v.iter_mut().take(degree).enumerate() {
        let m = numbers.next()??;
        // An odd number below 2^(i+1): otherwise the points would not be a net.
        *v = Some(m).filter(|m| m % 2 == 1 && m >> (i + 1) == 0)? << (63 - i);
    }
    if numbers.next().is_some() {
        return None;
    }
    for i in degree..INDEX_BITS {
        v[i] = v[i - degree] ^ (v[i - degree] >> degree);
        for k in 1..degree {
            if inner >> (degree - 1 - k) & 1 == 1 {
                v[i] ^= v[i - k];
            }
        }
    }
    Some(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_the_whole_table_is_read_and_goes_no_further() {
        let all = directions(MAX_DIMENSION).unwrap();
        assert_eq!(all.len(), MAX_DIMENSION);
        assert!(directions(MAX_DIMENSION + 1).is_err());
        for v in &all {
            for (i, v) in v.iter().enumerate() {
                // Upper triangular with a unit diagonal: every coordinate alone is a net.
                assert_eq!(v.trailing_zeros() as usize, 63 - i);
            }
        }
    }

    #[test]
    fn property_a_damaged_line_is_refused() {
        assert!(parse("3 2 1 1 3").is_some());
        for line in ["", "3 2 1 1", "3 2 1 1 3 5", "3 2 1 1 2", "3 2 1 1 5", "3 x 1 1 3", "3 0 1"] {
            assert!(parse(line).is_none(), "{line}");
        }
    }
}
