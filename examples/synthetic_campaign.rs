//! Makes up the example campaign of rig runs from a known truth.
//!
//! `cargo run --release --example synthetic_campaign` writes `distributions/calibrated/campaign/*.csv`, the same bytes
//! every time: three runs to calibrate with and one to hold out, and `truth.toml` with what is really so. `--seed S`
//! makes another campaign, `--out DIR` writes it elsewhere.

#[path = "../tests/calibration/campaign.rs"]
mod campaign;

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    match write() {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("synthetic_campaign: {why}");
            ExitCode::FAILURE
        }
    }
}

fn write() -> Result<(), String> {
    let mut out = PathBuf::from("distributions/calibrated/campaign");
    let mut seed = campaign::SEED;
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        match word.as_str() {
            "--seed" => seed = value.parse().map_err(|_| format!("{value}: a number"))?,
            "--out" => out = PathBuf::from(value),
            _ => return Err(format!("{word}: --seed S or --out DIR")),
        }
    }
    std::fs::create_dir_all(&out).map_err(|why| why.to_string())?;
    let runs = campaign::runs(seed).map_err(|why| why.to_string())?;
    for (name, text) in runs.into_iter().chain([("truth.toml", truth_text())]) {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|why| format!("{}: {why}", path.display()))?;
    }
    Ok(())
}

/// The truth as a table of design values, for a person and for `--set`.
fn truth_text() -> String {
    let mut text = "# What is true of the brake of this made-up campaign (examples/synthetic_campaign.rs).\n\n[design]\n"
        .to_owned();
    for (parameter, _, written) in campaign::TRUTH {
        text += &format!("\"{}\" = \"{written}\"\n", parameter.info().path);
    }
    for (surface, gap) in campaign::GAPS.iter().enumerate() {
        text += &format!("\"brake.gap[{}]\" = \"{:.4} in\"\n", surface + 1, gap * 1e-3);
    }
    text
}
