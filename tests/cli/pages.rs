//! The pages of the commands whose reports are composed as Markdown: the same words, tables and figures.

use super::program::{Place, reeldown};

/// Headings, cells and pictures of a Markdown report.
fn parts(markdown: &str) -> (Vec<String>, usize, usize) {
    let headings = markdown.lines().filter_map(|line| line.strip_prefix("## ")).map(plain);
    let rows = markdown.lines().filter(|line| line.starts_with('|') && !line.starts_with("| --"));
    let rows = rows.filter(|line| !line.starts_with("|--") && !line.starts_with("| ---"));
    let pictures = markdown.lines().filter(|line| line.starts_with("![")).count();
    (headings.collect(), rows.count(), pictures)
}

fn plain(text: &str) -> String {
    text.replace('`', "")
}

#[track_caller]
fn says_the_same(place: &Place, markdown: &str, page: &str) {
    let text = |name: &str| String::from_utf8(place.bytes(name)).expect("UTF-8");
    let (markdown, page) = (text(markdown), text(page));
    let (headings, rows, pictures) = parts(&markdown);
    let words = page
        .replace("<code>", "")
        .replace("</code>", "")
        .replace('\u{a0}', " ")
        .replace("&quot;", "\"");
    for heading in &headings {
        assert!(words.contains(&format!(">{heading}</h2>")), "no heading {heading}");
    }
    assert_eq!(page.matches("<tr>").count(), rows, "rows of tables");
    assert_eq!(page.matches("<figure>").count(), pictures, "figures");
    assert!(page.contains("id=\"verdict\">\n<"), "an answer at the head");
    for outside in ["src=\"http", "href=\"http", "url(http"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn property_every_command_writes_the_page_of_its_report() {
    let place = Place::new("pages");
    let over = "fluid.nominal_viscosity=90000cSt..130000cSt:3";
    reeldown(&["sweep", "--over", over, "--samples", "200", "--out", &place.at("sweep")])
        .ended_with(0);
    says_the_same(&place, "sweep/report.md", "sweep/report.html");
    reeldown(&["paper", "--out", &place.at("paper")]).ended_with(0);
    says_the_same(&place, "paper/report.md", "paper/report.html");
    reeldown(&["rig", "--compare", "--out", &place.at("rig")]).ended_with(0);
    says_the_same(&place, "rig/report.md", "rig/report.html");
    reeldown(&["rig", "--plan", "1", "--out", &place.at("plan")]).ended_with(0);
    says_the_same(&place, "plan/report.md", "plan/report.html");
    let few = ["--set", "tighten.samples=400"];
    let mut tighten = vec!["tighten", "--target", "0.3"];
    tighten.extend(few);
    let out = place.at("tighten");
    tighten.extend(["--out", &out]);
    reeldown(&tighten).ended_with(0);
    says_the_same(&place, "tighten/tighten.md", "tighten/tighten.html");
    for (name, seed) in [("a", "1"), ("b", "2")] {
        let out = place.at(name);
        reeldown(&["run", "--samples", "400", "--seed", seed, "--quiet", "--out", &out])
            .ended_with(3);
    }
    let (markdown, page) = (place.at("compare.md"), place.at("compare.html"));
    let (a, b) = (place.at("a"), place.at("b"));
    reeldown(&["compare", &a, &b, "--markdown", &markdown, "--html", &page]).ended_with(0);
    says_the_same(&place, "compare.md", "compare.html");
}
