//! Findings that are read again.

use crate::sample::{independent, replicated};
use reeldown::analysis::{Findings, Results, Unreadable};
use reeldown::render::json;

#[test]
fn property_findings_that_are_read_again_are_written_the_same() {
    let samples: [&Results; 2] = [independent(), replicated()];
    for sample in samples {
        let text = json(&sample.findings).unwrap();
        let read = Findings::read(text.as_bytes()).unwrap();
        let again = json(&read).unwrap();
        let differs = text.lines().zip(again.lines()).find(|(one, other)| one != other);
        assert_eq!(differs, None);
        assert_eq!(text.len(), again.len());
        assert_eq!(read.verdict, sample.findings.verdict);
        assert_eq!(read.probabilities, sample.findings.probabilities);
    }
}

#[test]
fn property_what_is_not_findings_is_refused_with_its_reason() {
    let text = json(&independent().findings).unwrap();
    let read = |text: &str| Findings::read(text.as_bytes()).unwrap_err();
    assert!(matches!(read("hello"), Unreadable::NotJson(_)));
    assert_eq!(read("{}"), Unreadable::OtherVersion("an unknown version".to_owned()));
    let version = format!("\"version\": {:?}", env!("CARGO_PKG_VERSION"));
    let other = text.replace(&version, "\"version\": \"0.0.1\"");
    assert_eq!(read(&other), Unreadable::OtherVersion("0.0.1".to_owned()));
    let unknown = text.replace("\"breach.any\"", "\"breaking.any\"");
    let Unreadable::NotFindings(why) = read(&unknown) else { panic!("it was read") };
    assert!(why.contains("breaking.any is no output"), "{why}");
}
