//! Texts that this program wrote into a file and reads again: names of methods, of models, of what a number is. They
//! are few, and a program has them as `&'static str`; read again, each is kept once.

use serde::de::{Deserialize, Deserializer, Error};
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// A text of the program.
pub type Word = &'static str;

/// A file with more different words, or a longer one, is not of this program.
const MOST: usize = 4096;
const LONGEST: usize = 1000;

static KEPT: Mutex<BTreeSet<Word>> = Mutex::new(BTreeSet::new());

/// The word of a text; none if it cannot be one of the program's.
fn word(text: &str) -> Option<Word> {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(word) = kept.get(text) {
        return Some(word);
    }
    if kept.len() >= MOST || text.len() > LONGEST {
        return None;
    }
    let word: Word = Box::leak(text.to_owned().into_boxed_str());
    kept.insert(word);
    Some(word)
}

fn checked<E: Error>(text: &str) -> Result<Word, E> {
    word(text).ok_or_else(|| E::custom("this is no word of the program"))
}

/// Reads a word.
///
/// # Errors
/// If there is none.
pub fn one<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Word, D::Error> {
    checked(&String::deserialize(deserializer)?)
}

/// Reads a word or null.
///
/// # Errors
/// If there is neither.
pub fn maybe<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Word>, D::Error> {
    Option::<String>::deserialize(deserializer)?.map(|text| checked(&text)).transpose()
}

/// Reads a list of words.
///
/// # Errors
/// If there is none.
pub fn list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Word>, D::Error> {
    Vec::<String>::deserialize(deserializer)?.iter().map(|text| checked(text)).collect()
}

/// Reads a list of words, each with something.
///
/// # Errors
/// If there is none.
pub fn with<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<(Word, T)>, D::Error> {
    let pairs = Vec::<(String, T)>::deserialize(deserializer)?;
    pairs.into_iter().map(|(text, of)| Ok((checked(&text)?, of))).collect()
}

/// Reads a list of something, each with a word.
///
/// # Errors
/// If there is none.
pub fn of<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<(T, Word)>, D::Error> {
    let pairs = Vec::<(T, String)>::deserialize(deserializer)?;
    pairs.into_iter().map(|(of, text)| Ok((of, checked(&text)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_word_is_kept_once_and_a_long_text_is_none() {
        let (first, again) = (word("Clopper-Pearson, read"), word("Clopper-Pearson, read"));
        assert!(std::ptr::eq(first.unwrap(), again.unwrap()));
        assert_eq!(word(&"x".repeat(LONGEST + 1)), None);
    }
}
