//! Measures how often each reliability method's 95 % interval holds the truth, on every published
//! problem, and writes the certificate.
//!
//! `cargo run --release --example coverage_certificate -- --seeds 1000` writes
//! `reports/certificates/coverage.md` and `coverage.csv`. Seeds are 0, 1, …: the same table every time.

#[path = "../tests/truth/benchmarks/mod.rs"]
mod benchmarks;

use benchmarks::coverage::{CSV_HEADER, Coverage, METHODS};
use std::path::PathBuf;
use std::process::ExitCode;

struct Arguments {
    seeds: u64,
    out: PathBuf,
    /// Only methods and problems whose names contain this.
    only: String,
}

fn arguments() -> Result<Arguments, String> {
    let mut found =
        Arguments { seeds: 1000, out: PathBuf::from("reports/certificates"), only: String::new() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        match word.as_str() {
            "--seeds" => found.seeds = value.parse().map_err(|_| format!("{value}: a number"))?,
            "--out" => found.out = PathBuf::from(value),
            "--only" => found.only = value,
            _ => return Err(format!("{word}: --seeds N, --out DIR or --only NAME")),
        }
    }
    if found.seeds == 0 { Err("--seeds must be positive".to_owned()) } else { Ok(found) }
}

fn main() -> ExitCode {
    match arguments().and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("coverage_certificate: {why}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let mut rows = Vec::new();
    for method in METHODS {
        for benchmark in benchmarks::all() {
            let name = format!("{} {}", method.name(), benchmark.id);
            if name.contains(&arguments.only) {
                eprintln!("{name}");
                let row = Coverage::measure(method, &benchmark, arguments.seeds, 1.0);
                rows.push(row);
            }
        }
    }
    std::fs::create_dir_all(&arguments.out).map_err(|why| why.to_string())?;
    for (file, text) in
        [("coverage.md", markdown(&rows, arguments.seeds)), ("coverage.csv", csv(&rows))]
    {
        let path = arguments.out.join(file);
        std::fs::write(&path, text).map_err(|why| format!("{}: {why}", path.display()))?;
    }
    Ok(())
}

fn markdown(rows: &[Coverage], seeds: u64) -> String {
    let mut text = format!(
        "# Coverage certificate\n\n\
        How often the 95 % interval of each method holds the certified probability, over {seeds} seeds \
        with default options. \"Stated\" counts the seeds in which the method's self-checks let it state \
        an interval at all; coverage is among those, with its Monte Carlo standard error. Made by \
        `cargo run --release --example coverage_certificate -- --seeds {seeds}`; version {}.\n",
        env!("CARGO_PKG_VERSION")
    );
    for method in METHODS {
        let own: Vec<&Coverage> = rows.iter().filter(|row| row.method == method).collect();
        if own.is_empty() {
            continue;
        }
        text.push_str(&format!(
            "\n## {}\n\n| problem | probability | mean estimate / truth | rms relative error | \
            evaluations | stated | coverage | below / above | verdict |\n\
            | --- | --: | --: | --: | --: | --: | --: | --: | --- |\n",
            method.name()
        ));
        for row in own {
            text.push_str(&row.markdown());
            text.push('\n');
        }
    }
    text
}

fn csv(rows: &[Coverage]) -> String {
    let mut text = format!("{CSV_HEADER}\n");
    for row in rows {
        text.push_str(&row.csv());
        text.push('\n');
    }
    text
}
