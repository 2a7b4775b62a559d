//! Texts in place of files.

use reeldown::error::Result;
use reeldown::study::{
    EMBEDDED_CARD, EMBEDDED_STUDY, Files, NamedText, Override, SampleFile, Study, assemble,
};

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

    fn sample(&mut self, _: &str, name: &str) -> std::result::Result<SampleFile, String> {
        let column = |name: &str, values: [f64; 4]| (name.to_owned(), Ok(values.to_vec()));
        let columns = match name {
            "measured.csv" => vec![
                ("gap_m".to_owned(), Ok(vec![0.0015, 0.0016, 0.0017])),
                column("gap [in]", [0.061, 0.062, 0.063, 0.064]),
                column("gap", [61.0, 62.0, 63.0, 64.0]),
            ],
            "posterior.csv" => vec![
                column("fluid.shear_factor", [0.9, 1.0, 1.1, 1.05]),
                column("thermal.fluid_capacity [kJ/K]", [3.9, 4.0, 4.1, 4.2]),
                column("log_posterior", [-1.0, -2.0, -3.0, -4.0]),
                ("note".to_owned(), Err("it holds no numbers".to_owned())),
            ],
            "gaps.csv" => vec![
                column("brake.gap[1] [in]", [0.061, 0.062, 0.063, 0.064]),
                column("brake_gap_2_m", [0.00155, 0.00156, 0.00157, 0.00158]),
            ],
            "constant.csv" => vec![column("fluid.shear_factor", [1.0; 4])],
            "impossible.csv" => vec![column("fluid.shear_factor", [1.0, -1.0, 1.0, 2.0])],
            "furlongs.csv" => vec![column("brake.gap [furlong/h]", [1.0, 2.0, 3.0, 4.0])],
            "nameless.csv" => vec![column("f", [1.0, 2.0, 3.0, 4.0])],
            "rotors.csv" => vec![column("brake.rotors", [6.0, 7.0, 7.0, 8.0])],
            _ => return Err("no such file".to_owned()),
        };
        Ok(SampleFile { sha256: "ab".repeat(32), columns })
    }
}

/// A study text with the shipped card under its own name, the pinned one as `habe.toml`, and a text as `card.toml`.
pub fn study_with(study: &str, card: &str, overrides: &[&str]) -> Result<Study> {
    let study = NamedText { origin: "study.toml".to_owned(), text: study.to_owned() };
    let cards = [
        ("habe.toml", include_str!("../fixtures/habe/card.toml")),
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

/// A study with a line that names cards, and those cards.
pub fn with_cards(line: &str, cards: &[(&str, &str)]) -> Result<Study> {
    let text = format!("title = \"HABE\"\n{line}\n");
    let study = NamedText { origin: "study.toml".to_owned(), text };
    let cards = cards.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    assemble(&study, &[], &mut Memory { cards })
}
