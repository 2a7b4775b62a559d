//! Measures how often each reliability method's 95 % interval holds the truth, on every published
//! problem, and writes the certificate.
//!
//! `cargo run --release --example coverage_certificate -- --seeds 1000` writes
//! `reports/certificates/coverage.md` and `coverage.csv`: seeds 0, 1, …, the same table every time, whatever
//! the number of threads. Both are written anew after every pair. A row that `coverage.csv` holds already
//! with as many seeds is kept, so a run that was stopped goes on where it was; to measure a pair again,
//! delete its row. What changes a method is developed on other seeds (`--first-seed 1000000 --out DIR`).

#[path = "../tests/truth/benchmarks/mod.rs"]
mod benchmarks;

use benchmarks::Benchmark;
use benchmarks::coverage::{CSV_HEADER, Coverage, METHODS, Trial};
use rayon::prelude::*;
use reeldown::reliability::estimate::Method;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

struct Arguments {
    seeds: u64,
    first_seed: u64,
    out: PathBuf,
    /// Only pairs whose "method problem" contains one of these.
    only: Vec<String>,
}

fn arguments() -> Result<Arguments, String> {
    let out = PathBuf::from("reports/certificates");
    let mut found = Arguments { seeds: 1000, first_seed: 0, out, only: Vec::new() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        let number = || value.parse().map_err(|_| format!("{word} {value}: a whole number"));
        match word.as_str() {
            "--seeds" => found.seeds = number()?,
            "--first-seed" => found.first_seed = number()?,
            "--out" => found.out = PathBuf::from(value),
            "--only" => found.only.extend(value.split(',').map(str::to_owned)),
            _ => {
                return Err(format!(
                    "{word}: --seeds N, --first-seed N, --out DIR or --only NAME,NAME"
                ));
            }
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
    std::fs::create_dir_all(&arguments.out).map_err(|why| why.to_string())?;
    let all = benchmarks::all();
    let pairs: Vec<(Method, &Benchmark)> =
        METHODS.into_iter().flat_map(|method| all.iter().map(move |b| (method, b))).collect();
    let mut rows = kept(arguments, &pairs)?;
    for (k, &(method, benchmark)) in pairs.iter().enumerate() {
        let name = format!("{} {}", method.name(), benchmark.id);
        let asked = arguments.only.is_empty() || arguments.only.iter().any(|o| name.contains(o));
        if rows[k].is_some() || !asked {
            continue;
        }
        let begun = Instant::now();
        let seeds = arguments.first_seed..arguments.first_seed + arguments.seeds;
        let trials: Vec<Trial> =
            seeds.into_par_iter().map(|seed| Trial::run(method, benchmark, seed, 1.0)).collect();
        let row = Coverage::of(method, benchmark, &trials);
        let took = begun.elapsed().as_secs_f64();
        eprintln!(
            "{} of {}, {took:.0} s: {} {}",
            k + 1,
            pairs.len(),
            method.name(),
            row.markdown()
        );
        rows[k] = Some(row);
        write(arguments, &rows)?;
    }
    write(arguments, &rows)
}

/// The rows of an earlier run with as many seeds, at the places of their pairs.
fn kept(
    arguments: &Arguments,
    pairs: &[(Method, &Benchmark)],
) -> Result<Vec<Option<Coverage>>, String> {
    let path = arguments.out.join("coverage.csv");
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(why) if why.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(why) => return Err(format!("{}: {why}", path.display())),
    };
    let same_run =
        |row: &Coverage| row.seeds == arguments.seeds && row.first_seed == arguments.first_seed;
    let find = |&(method, benchmark): &(Method, &Benchmark)| {
        let own = text.lines().find_map(|line| Coverage::from_csv(method, benchmark, line));
        own.filter(same_run)
    };
    Ok(pairs.iter().map(find).collect())
}

fn write(arguments: &Arguments, rows: &[Option<Coverage>]) -> Result<(), String> {
    let rows: Vec<&Coverage> = rows.iter().flatten().collect();
    for (file, text) in [("coverage.md", markdown(&rows, arguments)), ("coverage.csv", csv(&rows))]
    {
        let path = arguments.out.join(file);
        std::fs::write(&path, text).map_err(|why| format!("{}: {why}", path.display()))?;
    }
    Ok(())
}

fn markdown(rows: &[&Coverage], arguments: &Arguments) -> String {
    let (first, seeds) = (arguments.first_seed, arguments.seeds);
    let unfit = rows.iter().filter(|row| row.unfit()).count();
    let holds = |row: &&&Coverage| !row.unfit() && row.share().is_some_and(|(s, _)| s >= 0.93);
    let holding = rows.iter().filter(holds).count();
    let mut text = format!(
        "# Coverage certificate\n\n\
        How often the 95 % interval of each method holds the certified probability, over the {seeds} seeds \
        from {first} with default options. \"Stated\" counts the seeds in which the method's self-checks let \
        it state an interval at all; coverage is among those, with its Monte Carlo standard error. The \
        bar is 93 %.\n\n\
        Of {} pairs of a method and a problem, {holding} hold at least 93 %, {unfit} are unfit and say so at \
        run time (no interval in more than nine seeds of ten), {} fall below.\n\n\
        Made by `cargo run --release --example coverage_certificate -- --seeds {seeds}`; version {}. \
        {}\n",
        rows.len(),
        rows.len() - holding - unfit,
        env!("CARGO_PKG_VERSION"),
        HOW_DEVELOPED
    );
    for method in METHODS {
        let own: Vec<&&Coverage> = rows.iter().filter(|row| row.method == method).collect();
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

const HOW_DEVELOPED: &str = "The methods' intervals were developed on seeds from 1 000 000 up, never on these. \
    A seed gives every problem the same random numbers, so rows of one method are not independent of each \
    other.";

fn csv(rows: &[&Coverage]) -> String {
    let mut text = format!("{CSV_HEADER}\n");
    for row in rows {
        text.push_str(&row.csv());
        text.push('\n');
    }
    text
}
