//! Texts in place of files.

use reeldown::error::Result;
use reeldown::study::{EMBEDDED_CARD, EMBEDDED_STUDY, Files, NamedText, Override, Study, assemble};

/// Cards and columns held in memory.
pub struct Memory {
    /// Name and text of every card.
    pub cards: Vec<(String, String)>,
}

impl Files for Memory {
    fn card(&mut self, name: &str, _by_option: bool) -> std::result::Result<NamedText, String> {
        let found = self.cards.iter().find(|(card, _)| card == name);
        let (origin, text) = found.cloned().ok_or_else(|| "no such file".to_owned())?;
        Ok(NamedText { origin, text })
    }

    fn column(&mut self, _: &str, name: &str, _: &str) -> std::result::Result<Vec<f64>, String> {
        match name {
            "measured.csv" => Ok(vec![0.0015, 0.0016, 0.0017]),
            _ => Err("no such file".to_owned()),
        }
    }
}

/// A study text with the shipped card as `habe.toml`, and a text as `card.toml`.
pub fn study_with(study: &str, card: &str, overrides: &[&str]) -> Result<Study> {
    let study = NamedText { origin: "study.toml".to_owned(), text: study.to_owned() };
    let cards = [
        ("habe.toml", EMBEDDED_CARD),
        ("../../distributions/habe.toml", EMBEDDED_CARD),
        ("card.toml", card),
    ];
    let cards = cards.map(|(name, text)| (name.to_owned(), text.to_owned())).to_vec();
    let overrides: Result<Vec<Override>> =
        overrides.iter().map(|text| Override::parse("--set", text)).collect();
    assemble(&study, &overrides?, &mut Memory { cards })
}

/// The shipped study with a card of one's own.
pub fn card_alone(card: &str) -> Result<Study> {
    study_with("title = \"HABE\"\ncard = \"card.toml\"\n", card, &[])
}

/// The shipped study, changed.
pub fn shipped(overrides: &[&str]) -> Result<Study> {
    study_with(EMBEDDED_STUDY, "", overrides)
}
