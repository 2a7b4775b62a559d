//! The Parquet files in other people's readers: pyarrow, pandas and DuckDB.

use super::determinism::run;
use super::program::{Place, reeldown};
use std::process::Command;

/// The variable that names a Python interpreter with pyarrow, pandas and DuckDB.
const PYTHON: &str = "REELDOWN_PYTHON";

#[test]
fn reference_pyarrow_pandas_and_duckdb_read_what_was_written() {
    let Some(python) = std::env::var_os(PYTHON) else {
        println!(
            "skipped: set {PYTHON} to a Python with the packages pyarrow, pandas and duckdb \
             (.ci/run makes one)"
        );
        return;
    };
    let place = Place::new("readers");
    // 70 001 rows: two row groups, the second cut short.
    run(&place, "run", &["--samples", super::determinism::SHORTER]).ended_with(3);
    let trace = place.at("trace.parquet");
    reeldown(&["descend", "--trace", &trace]).ended_with(0);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cli/read_parquet.py");
    let output = Command::new(python)
        .arg(script)
        .args([&place.at("run"), &trace])
        .output()
        .expect("the interpreter runs");
    let [out, err] =
        [output.stdout, output.stderr].map(|b| String::from_utf8_lossy(&b).into_owned());
    assert!(output.status.success(), "{out}{err}");
    println!("{out}");
}
