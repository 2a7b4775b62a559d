//! The HTML report as a text; `browser.py` beside this looks at it in a browser.

use crate::sample::{independent, replicated};
use reeldown::render::{figures, html};
use std::collections::BTreeSet;

fn page(sample: &reeldown::analysis::Results) -> String {
    html(&sample.findings, &figures(&sample.findings)).unwrap()
}

#[test]
fn property_the_report_asks_for_nothing_from_outside() {
    for sample in [independent(), replicated()] {
        let page = page(sample).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for forbidden in ["http:", "https:", "//cdn", "src=", "@import", "url(h", "fetch("] {
            assert!(!page.contains(forbidden), "{forbidden}");
        }
        assert!(page.contains("default-src 'none'"));
    }
}

#[test]
fn property_the_verdict_comes_first_and_every_figure_is_there() {
    let sample = independent();
    let page = page(sample);
    let verdict = page.find("id=\"verdict\"").unwrap();
    assert!(verdict < page.find("<nav").unwrap() && verdict < page.find("<main").unwrap());
    for figure in figures(&sample.findings).all() {
        assert!(page.contains(&figure.svg), "{}", figure.name);
    }
    // The template engine escapes a solidus as well.
    let text = page.replace("&#x2f;", "/");
    for probability in &sample.findings.probabilities {
        assert!(text.contains(&probability.title));
    }
}

#[test]
fn property_identifiers_are_unique_and_contents_lead_somewhere() {
    for sample in [independent(), replicated()] {
        let page = page(sample);
        let values = |attribute: &str| -> Vec<String> {
            page.split(attribute)
                .skip(1)
                .filter_map(|rest| rest.split('"').next().map(str::to_owned))
                .collect()
        };
        let ids = values(" id=\"");
        let unique: BTreeSet<&String> = ids.iter().collect();
        assert_eq!(unique.len(), ids.len());
        for target in values("href=\"#") {
            assert!(unique.contains(&target), "{target}");
        }
    }
}

#[test]
fn property_headings_do_not_skip_a_level() {
    let page = page(independent());
    let levels: Vec<u32> = page
        .split("<h")
        .skip(1)
        .filter_map(|rest| rest.chars().next().and_then(|c| c.to_digit(10)))
        .collect();
    assert_eq!(levels.first(), Some(&1));
    assert_eq!(levels.iter().filter(|level| **level == 1).count(), 1);
    assert!(levels.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{levels:?}");
}
