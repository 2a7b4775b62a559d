//! What a report says of the limits themselves.

use crate::sample::independent;
use reeldown::render;

#[test]
fn property_a_report_says_where_each_limit_comes_from_or_that_it_is_not_stated() {
    let mut findings = independent().findings.clone();
    let source = findings.limits.iter().find(|l| l.limit == "final_velocity").unwrap();
    assert!(source.source.as_ref().unwrap().starts_with("assumed: "));
    findings.limits.iter_mut().find(|l| l.limit == "time").unwrap().source = None;
    let figures = render::figures(&findings);
    for text in
        [render::markdown(&findings, &figures).unwrap(), render::html(&findings, &figures).unwrap()]
    {
        let text = text.replace("&quot;", "\"").replace("&#x2f;", "/");
        let line = |begins: &str| {
            let found = text.lines().find(|line| line.contains(begins));
            found.unwrap_or_else(|| panic!("no line with {begins}")).to_owned()
        };
        assert!(line("final separation velocity at most 2.5 ft/s").contains("assumed: the paper"));
        assert!(line("reel-down time at most 210 s").contains("no source stated"));
    }
}
