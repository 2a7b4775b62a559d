//! The options of `reeldown calibrate`.

use super::arguments::{StudyArguments, Threads};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct CalibrateArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// A measured run, CSV with units in its header or Parquet in SI; once for each run
    #[arg(long, value_name = "FILE", required = true)]
    pub data: Vec<PathBuf>,
    /// A measured run that is predicted only, to check the posterior
    #[arg(long, value_name = "FILE")]
    pub hold_out: Vec<PathBuf>,
    /// What drives the predictions: force, speed [default: force where it was recorded]
    #[arg(long, value_name = "QUANTITY")]
    pub drive: Option<String>,
    /// Standard deviation of a channel's sensor, such as speed="0.02 ft/s"; estimated where not stated
    #[arg(long, value_name = "CHANNEL=VALUE")]
    pub sensor_sd: Vec<String>,
    /// Standard deviation of what a channel's readings err by in proportion, the same in every run, such as force="0.5 %";
    /// zero for none [default: 1 % of force, speed and line, none of temperatures]
    #[arg(long, value_name = "CHANNEL=SHARE", allow_hyphen_values = true)]
    pub gain_sd: Vec<String>,
    /// Standard deviation of what a channel's readings err by alike, the same in every run, such as fluid="1 °F"; zero for
    /// none [default: 2 °F of each thermometer, none of the others]
    #[arg(long, value_name = "CHANNEL=VALUE", allow_hyphen_values = true)]
    pub offset_sd: Vec<String>,
    /// What the model's discrepancy is expected to be, as a share of each channel's range; none for a
    /// model that is taken as right [default: 1 %]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    pub discrepancy: Option<String>,
    /// Noise with heavy tails, Student's t with so many degrees of freedom: outliers count less
    #[arg(long, value_name = "DF", value_parser = degrees_of_freedom)]
    pub heavy_tails: Option<f64>,
    /// Take records with gaps as they are, linear across them
    #[arg(long)]
    pub gaps: bool,
    /// Calibrate even if a unit seems wrong or the card cannot explain the readings, and write the card even if the data
    /// contradict each other
    #[arg(long)]
    pub accept: bool,
    /// Particles of each replicate [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    pub particles: Option<u32>,
    /// Independent replicates of the sampling [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100))]
    pub replicates: Option<u32>,
    /// Seed of every random stream, in place of the study's
    #[arg(long, value_name = "S")]
    pub seed: Option<String>,
    /// Directory for report, joint sample and cards [default: runs/<study>-calibrated]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the directory even if it holds something else than earlier results of this study
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub threads: Threads,
    /// Print the findings as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

/// Degrees of freedom of Student's t: more than two, for the variance to exist.
fn degrees_of_freedom(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 2.0 && value <= 1e6 => Ok(value),
        _ => Err("expected a number above 2, such as 4".to_owned()),
    }
}
