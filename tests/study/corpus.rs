//! Bad studies and cards, each with the lines that it must be answered with, one a mistake.
//!
//! `study_*.toml` are studies, `card_*.toml` cards; the lines are in the `.txt` beside them. After a
//! change of wording, `REELDOWN_WRITE_CORPUS=1 cargo test --test study` writes the lines anew, to be read
//! in the diff.

use super::sources::{card_alone, study_with};
use reeldown::error::Error;
use std::path::{Path, PathBuf};

fn corpus() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/study/corpus");
    let mut files: Vec<PathBuf> = std::fs::read_dir(directory)
        .expect("the corpus is a directory")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    files
}

#[test]
fn regression_every_bad_text_has_its_message() {
    let files = corpus();
    assert!(files.len() >= 40, "{} files", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&file).expect("a text");
        let answer = match name.starts_with("card_") {
            true => card_alone(&text),
            false => study_with(&text, "", &[]),
        };
        let message = match answer {
            Ok(_) => "accepted".to_owned(),
            Err(error) => {
                let all = match &error {
                    Error::Several(all) => all.as_slice(),
                    one => std::slice::from_ref(one),
                };
                for one in all {
                    assert!(matches!(one, Error::Input(_)), "{name}: not a diagnostic: {one}");
                    assert!(!one.to_string().contains('\n'), "{name}: {one}");
                }
                error.to_string()
            }
        };
        let expected = file.with_extension("txt");
        if std::env::var_os("REELDOWN_WRITE_CORPUS").is_some() {
            std::fs::write(&expected, format!("{message}\n")).expect("the corpus is writable");
        }
        let recorded = std::fs::read_to_string(&expected).unwrap_or_default();
        if recorded.trim_end() != message {
            wrong
                .push(format!("{name}:\n  recorded {}\n  given    {message}", recorded.trim_end()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
