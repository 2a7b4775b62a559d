//! What a file's footer says of its parents, and the study that can be made of it again.

use crate::error::{Error, Result};
use crate::sampling::Design;
use crate::store::{PARQUET, Parentage};
use crate::study::{
    EpistemicPlan, Files, NamedText, Nature, Override, SampleFile, Study, assemble,
};
use std::collections::{BTreeMap, VecDeque};
use std::path::Path;

/// The entries of a run's files. The texts of study and cards are among them, so that a sample can be
/// computed again from the file alone.
pub(super) fn of(study: &Study) -> Parentage {
    let texts = serde_json::json!({
        "origin": study.origin,
        "study": study.study_text,
        "cards": study.card_texts,
        "overrides": study.overrides,
    });
    let units: BTreeMap<String, &str> = study
        .inputs
        .iter()
        .map(|i| (i.target.column(), i.target.parameter.info().quantity.si_unit()))
        .chain(
            crate::descent::OutcomeQuantity::ALL
                .iter()
                .map(|outcome| (outcome.column(), outcome.quantity().si_unit())),
        )
        .chain(study.limits.iter().map(|limit| {
            (limit.margin_column(), limit.outcome.quantity().of_difference().si_unit())
        }))
        .collect();
    let entries = [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("title", study.title.clone()),
        ("seed", study.sampling.seed.to_string()),
        ("samples", study.sampling.samples.to_string()),
        ("study_digest", study.digest()),
        ("row_digest", row_digest(study)),
        ("file_digests", serde_json::json!(study.file_digests()).to_string()),
        ("texts", texts.to_string()),
        ("units", serde_json::json!(units).to_string()),
    ];
    Parentage(entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}

/// The digest of everything that fixes a row of the table: the resolved study without its requirement,
/// its stopping rule, its sensitivity, reliability, trade, tightening and epistemic plans, what its inputs cost, when
/// they are known, how they are grouped and what is unknown, and, for a design whose longer run begins with the
/// shorter, without its number of samples.
pub(super) fn row_digest(study: &Study) -> String {
    let mut rows = study.clone();
    rows.requirement = None;
    rows.sensitivity.base_samples = 0;
    rows.sensitivity.bootstrap = 0;
    rows.sensitivity.pairs.clear();
    rows.reliability = Default::default();
    rows.trade.samples = 0;
    rows.tighten.target = None;
    rows.tighten.samples = 0;
    rows.tighten.design.clear();
    rows.epistemic = EpistemicPlan { outer: 0, inner: 0 };
    for input in &mut rows.inputs {
        // When it becomes known, and with what it is looked at, moves no sample.
        input.known = crate::study::Known::Never;
        input.cost = crate::study::TighteningCost::usual(input.target.parameter, input.known);
        input.group = None;
        input.nature = Nature::Unknown;
    }
    rows.sampling.stopping = None;
    if rows.sampling.design != Design::LatinHypercube {
        rows.sampling.samples = 0;
    }
    rows.digest()
}

/// The study of a file, from its footer alone (and the data files of empirical laws and joint samples, if it has any).
///
/// # Errors
/// If the footer is of another version, or the study made of it is not the one it names.
pub(super) fn study(path: &Path, parentage: &Parentage) -> Result<Study> {
    let fail = |reason: String| {
        Error::file(
            path,
            "reconstruct the study of",
            reason,
            "use the version of reeldown and the data files that made it",
        )
    };
    let entry = |key: &str| {
        parentage.0.get(key).ok_or_else(|| fail(format!("its footer lacks the entry `{key}`")))
    };
    let version = entry("version")?;
    if version != env!("CARGO_PKG_VERSION") {
        return Err(fail(format!(
            "it was made by reeldown {version}, and this is {}",
            env!("CARGO_PKG_VERSION")
        )));
    }
    let texts: serde_json::Value = serde_json::from_str(entry("texts")?)
        .map_err(|reason| fail(format!("its footer cannot be read: {reason}")))?;
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let named =
        |value: &serde_json::Value| NamedText { origin: text(&value[0]), text: text(&value[1]) };
    let list = |key: &str| texts[key].as_array().cloned().unwrap_or_default();
    let mut files = Recorded { cards: list("cards").iter().map(named).collect() };
    let overrides = list("overrides")
        .iter()
        .map(|statement| Override::parse("--set", &text(statement)))
        .collect::<Result<Vec<_>>>()?;
    let main = NamedText { origin: text(&texts["origin"]), text: text(&texts["study"]) };
    let study = assemble(&main, &overrides, &mut files)?;
    if study.digest() != *entry("study_digest")? {
        return Err(fail("the study made of its footer is another one".to_owned()));
    }
    Ok(study)
}

/// Cards out of a footer, in the order in which they were asked for.
struct Recorded {
    cards: VecDeque<NamedText>,
}

impl Files for Recorded {
    fn card(&mut self, _: &str, _: bool) -> std::result::Result<NamedText, String> {
        self.cards.pop_front().ok_or_else(|| "the footer lacks it".to_owned())
    }

    fn sample(&mut self, card: &str, name: &str) -> std::result::Result<SampleFile, String> {
        crate::study::read_sample(card, name, PARQUET)
    }
}
