//! How far apart two words are, to guess which one was meant.

/// The number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into
/// `b`, letter case apart (optimal string alignment distance).
pub fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().flat_map(char::to_lowercase).collect();
    let b: Vec<char> = b.chars().flat_map(char::to_lowercase).collect();
    let mut before = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let substitution = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = substitution.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

/// The candidate nearest to `word`, if one is near enough to have been meant; the first of equals.
///
/// Near is a small edit distance; else the same words in another order or with some left out; else
/// the start of a candidate, or a candidate with something behind it.
pub fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let length = word.chars().count();
    // A word longer than any key is not a misspelling, and the distance costs its length.
    if length > 80 {
        return None;
    }
    let candidates: Vec<&'c str> = candidates.into_iter().collect();
    let allowed = (length / 3).clamp(1, 6);
    let by_spelling = candidates
        .iter()
        .map(|&candidate| (edit_distance(word, candidate), candidate))
        .filter(|&(distance, candidate)| {
            distance <= allowed && distance < candidate.chars().count().max(length)
        })
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate);
    let by_words = || {
        let wanted = words(word);
        candidates
            .iter()
            .copied()
            .filter(|candidate| {
                let held = words(candidate);
                wanted.iter().all(|word| word.chars().count() >= 3 && held.contains(word))
            })
            .min_by_key(|candidate| words(candidate).len())
            .filter(|_| !wanted.is_empty())
    };
    let by_start = || {
        candidates.iter().copied().find(|candidate| {
            length >= 3 && candidate.starts_with(word)
                || candidate.chars().count() >= 3 && word.starts_with(candidate)
        })
    };
    by_spelling.or_else(by_words).or_else(by_start)
}

/// The words of a dotted path or a name.
fn words(name: &str) -> Vec<String> {
    name.split(|character: char| !character.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_distances_of_known_pairs() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("brake.gpa", "brake.gap"), 1);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("CST", "cSt"), 0);
    }

    #[test]
    fn property_only_a_near_word_is_suggested() {
        let keys = ["samples", "seed", "design"];
        assert_eq!(nearest("sampels", keys), Some("samples"));
        assert_eq!(nearest("viscosity", keys), None);
        let paths = ["fluid.density", "fluid.nominal_viscosity", "peak_fluid_temperature", "max"];
        assert_eq!(nearest("fluid.viscosity_nominal", paths), Some("fluid.nominal_viscosity"));
        assert_eq!(nearest("peak_temperature", paths), Some("peak_fluid_temperature"));
        assert_eq!(nearest("maximum", paths), Some("max"));
        assert_eq!(nearest("", keys), None);
        assert_eq!(nearest(&"x".repeat(1000), keys), None);
    }
}
