//! The rules.

use super::source::{Token, paths, tokens, without_comments_and_texts, without_unit_tests};

/// The floors, lowest first. Modules of one floor are listed together.
const FLOORS: [&[&str]; 10] = [
    &["units", "streams", "numerics", "error"],
    &["physics", "uncertainty", "sampling"],
    &["descent"],
    &["outcomes", "reliability", "sensitivity", "calibration"],
    &["study"],
    &["campaign"],
    &["findings"],
    &["analysis"],
    &["render", "store"],
    &["cli", "main"],
];

/// Floors whose modules are one body and may import each other. On the others, neighbours do not.
const SHARED_FLOORS: [usize; 2] = [0, 9];

/// Words with one home: what it is, the words, the modules (or the file) where they may stand.
const HOMES: [(&str, &[&str], &[&str]); 6] = [
    ("polars", &["polars"], &["store"]),
    ("rayon", &["rayon"], &["campaign"]),
    (
        "the command line",
        &["clap", "clap_complete", "clap_mangen", "indicatif", "ctrlc", "signal_hook"],
        &["cli"],
    ),
    (
        "printing",
        &["println", "print", "eprintln", "eprint", "dbg", "stdout", "stderr"],
        &["cli", "main"],
    ),
    (
        "making a random generator",
        &[
            "SeedableRng",
            "from_seed",
            "seed_from_u64",
            "from_rng",
            "from_os_rng",
            "try_from_os_rng",
            "thread_rng",
            "ThreadRng",
            "OsRng",
            "SysRng",
            "StdRng",
            "SmallRng",
            "ChaCha8Rng",
            "ChaCha12Rng",
            "ChaCha20Rng",
            "getrandom",
        ],
        &["src/streams.rs"],
    ),
    // Wall time and hosts go to the provenance, which the command line writes.
    ("the time of day", &["Instant", "SystemTime"], &["cli"]),
];

/// Functions whose last bit the platform decides. `sqrt`, `abs`, `mul_add`, `floor` are exact.
const PLATFORM_FUNCTIONS: [&str; 28] = [
    "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "powi", "cbrt",
    "hypot", "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh",
    "tanh", "asinh", "acosh", "atanh", "gamma", "ln_gamma",
];

/// Unfinished work, and ways around the compiler's and the test harness's advice.
const UNFINISHED: [&str; 2] = ["todo", "unimplemented"];

/// A longer file has more than one subject.
const LONGEST_FILE: usize = 650;

/// Everything that a file of `src/` or `tests/` says against the rules, one line each.
pub fn violations(path: &str, text: &str) -> Vec<String> {
    let code = without_comments_and_texts(text);
    let shipped = without_unit_tests(&code);
    let mut out = Vec::new();
    let mut say = |line: usize, what: String| out.push(format!("{path}:{line}: {what}"));

    let lines = text.lines().count();
    if lines > LONGEST_FILE {
        say(lines, format!("{lines} lines; a file has at most {LONGEST_FILE} and one subject"));
    }
    let all = tokens(&code);
    for (line, what) in unfinished(&all) {
        say(line, what);
    }
    let Some(module) = module(path) else { return out };

    let Some(floor) = floor(module) else {
        say(1, format!("`{module}` stands on no floor: give it one in {}", file!()));
        return out;
    };
    for (line, other) in imports(path, &all) {
        let Some(below) = self::floor(&other) else { continue };
        if other == module || below < floor || (below == floor && SHARED_FLOORS.contains(&floor)) {
            continue;
        }
        let way = if below == floor { "sideways" } else { "up" };
        say(line, format!("`{module}` (floor {floor}) imports {way}: `{other}` (floor {below})"));
    }
    for (what, words, homes) in HOMES {
        if homes.contains(&module) || homes.contains(&path) {
            continue;
        }
        for token in all.iter().filter(|token| words.contains(&token.text)) {
            say(token.line, format!("{what} (`{}`) belongs in {}", token.text, homes.join(", ")));
        }
    }
    let shipped = tokens(&shipped);
    for (line, what) in platform_functions(module, &shipped) {
        say(line, what);
    }
    for token in shipped.iter().filter(|token| ["HashMap", "HashSet"].contains(&token.text)) {
        say(token.line, format!("`{}` has no order of its own: take a BTree one", token.text));
    }
    out
}

/// The top-level module of a file of the library or binary.
fn module(path: &str) -> Option<&str> {
    let inside = path.strip_prefix("src/")?;
    let name = inside.split_once('/').map_or(inside, |(directory, _)| directory);
    // The root only lists the modules.
    (inside != "lib.rs").then(|| name.strip_suffix(".rs").unwrap_or(name))
}

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|modules| modules.contains(&module))
}

/// How deep in the tree of modules a file is: `src/study/mod.rs` and `src/outcomes.rs` are at 1.
fn depth(path: &str) -> usize {
    let inside = path.trim_start_matches("src/").trim_end_matches(".rs");
    inside.trim_end_matches("/mod").split('/').count()
}

/// The top-level modules that a file names, by `crate::`, by the crate's name, or by `super::` out of
/// its own module.
fn imports(path: &str, tokens: &[Token<'_>]) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    for (path_in_code, line) in paths(tokens, &["crate", "reeldown", "super"]) {
        let mut rest = path_in_code.iter().map(String::as_str);
        let named = match path_in_code[0].as_str() {
            "super" => {
                let supers = path_in_code.iter().take_while(|part| *part == "super").count();
                // Of a unit test's own module one `super` more leads as far; it stays inside.
                if supers < depth(path) { None } else { rest.nth(supers) }
            }
            _ => rest.nth(1),
        };
        out.extend(named.map(|name| (line, name.to_owned())));
    }
    out
}

/// Uses of the platform's elementary functions: as methods, and as functions of `f64` and `f32`.
///
/// `numerics` is where they are replaced. In `physics` the same names are methods of the number type
/// `Real`; on a plain `f64` they would be the platform's all the same, so a file of `physics` that
/// takes them must not name `f64` at all.
fn platform_functions(module: &str, tokens: &[Token<'_>]) -> Vec<(usize, String)> {
    if module == "numerics" {
        return Vec::new();
    }
    let generic = module == "physics" && !tokens.iter().any(|token| token.text == "f64");
    let mut out = Vec::new();
    for (k, token) in tokens.iter().enumerate() {
        if !PLATFORM_FUNCTIONS.contains(&token.text) {
            continue;
        }
        let called = tokens.get(k + 1).is_some_and(|next| next.text == "(");
        let before = |n: usize| k.checked_sub(n).and_then(|at| tokens.get(at)).map(|t| t.text);
        let method = called && before(1) == Some(".") && !generic;
        let function = before(1) == Some(":")
            && before(2) == Some(":")
            && [Some("f64"), Some("f32"), Some("Float")].contains(&before(3));
        if method || function {
            let what = format!(
                "the platform's `{}` has other bits elsewhere: take numerics::elementary",
                token.text
            );
            out.push((token.line, what));
        }
    }
    out
}

fn unfinished(tokens: &[Token<'_>]) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    for (k, token) in tokens.iter().enumerate() {
        let follows = |n: usize, text: &str| tokens.get(k + n).is_some_and(|t| t.text == text);
        if UNFINISHED.contains(&token.text) && follows(1, "!") {
            out.push((token.line, format!("unfinished: `{}!`", token.text)));
        }
        if token.text == "#" && follows(1, "[") && follows(2, "ignore") {
            out.push((token.line, "a test that is ignored".to_owned()));
        }
        if ["allow", "expect"].contains(&token.text)
            && follows(1, "(")
            && ["dead_code", "unused"].iter().any(|lint| follows(2, lint))
        {
            out.push((token.line, "dead code is taken out, not allowed".to_owned()));
        }
    }
    out
}
