//! The checker on small texts: what it must find, and what it must leave alone.

use super::checker::violations;
use super::source::without_comments_and_texts;

#[track_caller]
fn assert_found(path: &str, text: &str, part: &str) {
    let found = violations(path, text);
    assert!(found.iter().any(|line| line.contains(part)), "{part:?} is not among {found:?}");
}

#[track_caller]
fn assert_clean(path: &str, text: &str) {
    let found = violations(path, text);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn property_an_import_that_runs_up_is_found() {
    assert_found("src/physics/reel.rs", "use crate::study::Study;", "imports up: `study`");
    assert_found("src/outcomes.rs", "use super::campaign::Record;", "imports up: `campaign`");
    assert_found("src/study/law.rs", "use super::super::findings::X;", "up: `findings`");
    assert_found("src/units/mod.rs", "fn f() { crate::descent::g() }", "imports up: `descent`");
    assert_found("src/units/mod.rs", "use crate::{error::Error, store::{a, b}};", "up: `store`");
    assert_found("src/findings/mod.rs", "\n\nuse reeldown::cli::main;", "mod.rs:3: `findings`");
    let inside = "#[cfg(test)]\nmod tests { use crate::study::Study; }";
    assert_found("src/sampling/sobol.rs", inside, "imports up: `study`");
}

#[test]
fn property_an_import_that_runs_sideways_is_found() {
    assert_found("src/sampling/mod.rs", "use crate::uncertainty::Law;", "sideways: `uncertainty`");
    assert_found(
        "src/reliability/form.rs",
        "use crate::sensitivity::a;",
        "sideways: `sensitivity`",
    );
    assert_found("src/render/view.rs", "use crate::store::write_text;", "sideways: `store`");
}

#[test]
fn property_a_module_without_a_floor_is_found() {
    assert_found("src/helpers.rs", "", "`helpers` stands on no floor");
    assert_found("src/helpers/mod.rs", "", "`helpers` stands on no floor");
}

#[test]
fn property_imports_that_run_down_are_left_alone() {
    assert_clean(
        "src/study/law.rs",
        "use super::read;\nuse crate::uncertainty::{Law, law::A as B};",
    );
    assert_clean(
        "src/study/mod.rs",
        "use crate::study::law; use crate::{error::E, units::{a, b}};",
    );
    assert_clean("src/units/parse.rs", "use crate::numerics::elementary::exp;");
    assert_clean("src/uncertainty/law/construction.rs", "use super::super::marginal::Marginal;");
    assert_clean("src/main.rs", "fn main() { reeldown::cli::main() }");
    assert_clean("src/lib.rs", "pub mod campaign; pub mod cli;");
    assert_clean("src/outcomes.rs", "#[cfg(test)]\nmod tests { use super::*; }");
}

#[test]
fn property_words_away_from_their_home_are_found() {
    assert_found(
        "src/render/a.rs",
        "use polars::prelude::*;",
        "polars (`polars`) belongs in store",
    );
    assert_found("src/study/a.rs", "x.par_iter(); use rayon::prelude::*;", "belongs in campaign");
    assert_found("src/findings/a.rs", "use clap::Parser;", "belongs in cli");
    assert_found("src/descent/a.rs", "println!(\"{x}\");", "printing (`println`)");
    assert_found("src/descent/a.rs", "std::io::stderr().lock();", "printing (`stderr`)");
    assert_found("src/sampling/a.rs", "use rand::SeedableRng;", "random generator");
    assert_found("src/sampling/a.rs", "let r = R::seed_from_u64(1);", "src/streams.rs");
    assert_found("src/campaign/a.rs", "let begun = Instant::now();", "the time of day");
    assert_clean("src/store/a.rs", "use polars::prelude::DataFrame;");
    assert_clean("src/campaign/a.rs", "use rayon::prelude::*;");
    assert_clean("src/streams.rs", "use rand::SeedableRng;");
    assert_clean("src/cli/a.rs", "use clap::Parser; println!(); use std::time::Instant;");
}

#[test]
fn property_the_platforms_functions_are_found() {
    assert_found("src/descent/a.rs", "let y = x.exp();", "the platform's `exp`");
    assert_found("src/reliability/a.rs", "(a / b).powf(2.0)", "the platform's `powf`");
    assert_found("src/sensitivity/a.rs", "xs.iter().map(f64::ln)", "the platform's `ln`");
    assert_found("src/physics/a.rs", "fn f(x: f64) -> f64 { x.exp() }", "the platform's `exp`");
    assert_clean("src/physics/a.rs", "fn f<R: Real>(x: R) -> R { x.exp() }");
    assert_clean("src/reliability/a.rs", "exp(x) + ln(y) + x.sqrt() + elementary::sin(x)");
    assert_clean("src/reliability/a.rs", "#[cfg(test)]\nmod tests { fn f() { 2f64.exp(); } }");
    let after = "#[cfg(test)]\nmod tests { fn f() {} }\nfn g(x: f64) { x.tan(); }";
    assert_found("src/reliability/a.rs", after, "a.rs:3: the platform's `tan`");
    let import = "#[cfg(test)]\nuse a::{b, c};\nfn g(x: f64) { x.tan(); }";
    assert_found("src/reliability/a.rs", import, "a.rs:3: the platform's `tan`");
}

#[test]
fn property_unfinished_work_is_found() {
    assert_found("src/study/a.rs", "todo!()", "unfinished: `todo!`");
    assert_found("tests/laws/a.rs", "unimplemented!(\"x\")", "unfinished: `unimplemented!`");
    assert_found("tests/laws/a.rs", "#[test]\n#[ignore = \"slow\"]\nfn f() {}", "a.rs:2: a test");
    assert_found("src/study/a.rs", "#[allow(dead_code)]", "dead code");
    assert_found("src/study/a.rs", "use std::collections::HashMap;", "no order of its own");
    assert_found("src/study/a.rs", &"\n".repeat(651), "651 lines");
    assert_clean("src/study/a.rs", &"\n".repeat(650));
}

#[test]
fn property_comments_and_texts_are_no_code() {
    assert_clean("src/units/a.rs", "// use crate::study::Study;\n/* todo!() /* x.exp() */ */");
    assert_clean("src/units/a.rs", "let a = \"use crate::study; \\\" println!\";");
    assert_clean(
        "src/units/a.rs",
        "let a = r#\"crate::study::\" x.exp()\"#; let b = b\"todo!()\";",
    );
    let tricky = "let a = '\"'; let b = '\\''; fn f<'a>(x: &'a str) { crate::study::g() }";
    assert_found("src/units/a.rs", tricky, "imports up: `study`");
    assert_eq!(without_comments_and_texts("a 'é' \"é\"\nb"), "a          \nb");
}
