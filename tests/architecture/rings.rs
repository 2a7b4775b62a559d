//! Rings of files: files that import each other in a loop, so that none can be read, or tested, without
//! all the others.

use super::source::{Token, paths, tokens, without_comments_and_texts, without_unit_tests};
use std::collections::{BTreeMap, BTreeSet};

type Module = Vec<String>;

/// The rings among files, `(path, text)` each: the modules of each ring, sorted, as `study/law`.
///
/// A file imports another if it names a path into it, in a `use` or elsewhere, outside its unit tests. What it
/// takes from the modules above it does not count: a folder's `mod.rs` lists what is in it.
pub fn rings(files: &[(String, String)]) -> Vec<Vec<String>> {
    let modules: BTreeMap<Module, &str> =
        files.iter().filter_map(|(path, text)| Some((module(path)?, text.as_str()))).collect();
    let imports: BTreeMap<&Module, BTreeSet<&Module>> =
        modules.iter().map(|(module, text)| (module, imports(module, text, &modules))).collect();
    let reached: BTreeMap<&Module, BTreeSet<&Module>> =
        imports.keys().map(|module| (*module, reachable(module, &imports))).collect();
    let mut found: BTreeSet<Vec<String>> = BTreeSet::new();
    for (module, reach) in &reached {
        let mut ring: Vec<String> = reach
            .iter()
            .filter(|other| reached.get(*other).is_some_and(|back| back.contains(module)))
            .map(|member| member.join("/"))
            .collect();
        ring.sort();
        if ring.len() > 1 {
            found.insert(ring);
        }
    }
    found.into_iter().collect()
}

/// The path of a file's module below the crate; `src/study/mod.rs` and `src/study.rs` are both `study`.
fn module(path: &str) -> Option<Module> {
    let inside = path.strip_prefix("src/")?.strip_suffix(".rs")?;
    let mut parts: Module = inside.split('/').map(str::to_owned).collect();
    if parts.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        parts.pop();
    }
    Some(parts)
}

fn imports<'m>(
    module: &Module,
    text: &str,
    modules: &'m BTreeMap<Module, &str>,
) -> BTreeSet<&'m Module> {
    let code = without_unit_tests(&without_comments_and_texts(text));
    let tokens = tokens(&code);
    let children = children(&tokens);
    let mut roots = vec!["crate", "reeldown", "super", "self"];
    roots.extend(&children);
    let mut found = BTreeSet::new();
    for (path, _) in paths(&tokens, &roots) {
        let supers = path.iter().take_while(|part| *part == "super").count();
        let (base, rest) = match path[0].as_str() {
            "crate" | "reeldown" => (&[][..], &path[1..]),
            "self" => (&module[..], &path[1..]),
            "super" => (&module[..module.len().saturating_sub(supers)], &path[supers..]),
            _ => (&module[..], &path[..]),
        };
        let full = [base, rest].concat();
        // The longest part that is a module; what follows is an item in it.
        let named = (1..=full.len())
            .rev()
            .find_map(|length| modules.get_key_value(&full[..length]).map(|(named, _)| named));
        found.extend(named.filter(|named| !module.starts_with(named)));
    }
    found
}

/// The modules that a file declares, whose names begin paths in it.
fn children<'t>(tokens: &[Token<'t>]) -> Vec<&'t str> {
    tokens
        .windows(3)
        .filter(|three| three[0].text == "mod" && three[2].text == ";")
        .map(|three| three[1].text)
        .collect()
}

fn reachable<'m>(
    from: &'m Module,
    imports: &BTreeMap<&'m Module, BTreeSet<&'m Module>>,
) -> BTreeSet<&'m Module> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for &next in imports.get(module).into_iter().flatten() {
            if reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::rings;

    fn of(files: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<(String, String)> =
            files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
        rings(&files).iter().map(|ring| ring.join(" ")).collect()
    }

    #[test]
    fn property_files_that_import_each_other_are_a_ring() {
        let ring = [
            ("src/study/mod.rs", "mod a; mod b; mod c; mod d;"),
            ("src/study/a.rs", "use super::b::{self, X};"),
            ("src/study/b.rs", "fn f() { crate::study::c::g() }"),
            ("src/study/c.rs", "use super::{d::Y, a::{Z as W}};"),
            ("src/study/d.rs", "use super::Study;"),
        ];
        assert_eq!(of(&ring), ["study/a study/b study/c"]);
        assert!(of(&ring[..3]).is_empty(), "a chain is no ring");
    }

    #[test]
    fn property_every_ring_is_found_once_and_across_folders() {
        let two = [
            ("src/a/mod.rs", "mod x; mod y; pub use x::X;"),
            ("src/a/x.rs", "use super::y::Y;"),
            ("src/a/y.rs", "use super::x::X;"),
            ("src/b.rs", "use crate::c::deep::D;"),
            ("src/c/mod.rs", "pub mod deep;"),
            ("src/c/deep.rs", "use super::super::b::B;"),
        ];
        assert_eq!(of(&two), ["a/x a/y", "b c/deep"]);
        // By the names of its own modules a file reaches into them.
        let below = [
            ("src/a.rs", "use crate::c::C;"),
            ("src/c/mod.rs", "mod deep; pub fn f() { deep::g() }"),
            ("src/c/deep.rs", "use crate::a::A;"),
        ];
        assert_eq!(of(&below), ["a c c/deep"]);
    }

    #[test]
    fn property_parents_unit_tests_comments_and_texts_make_no_ring() {
        let none = [
            ("src/a/mod.rs", "mod x; mod y; use x::X; pub struct A;"),
            ("src/a/x.rs", "use super::A; // use super::y::Y;\nlet s = \"super::y::Y\";"),
            ("src/a/y.rs", "use super::x::X;"),
        ];
        assert!(of(&none).is_empty());
        let tested = "use super::A;\n#[cfg(test)]\nmod tests { use super::super::y::Y; }";
        assert!(of(&[none[0], ("src/a/x.rs", tested), none[2]]).is_empty());
    }
}
