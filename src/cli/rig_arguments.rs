//! The options of `reeldown rig`.

use super::arguments::StudyArguments;
use crate::descent::driven::Drive;
use crate::error::{Diagnostic, Error, Result};
use crate::findings::rig::{Equipment, Stated};
use crate::physics::Design;
use crate::units::{self, Quantity};
use clap::error::ErrorKind;
use clap::{Args, Command, ValueEnum};
use std::path::PathBuf;

/// What of a record drives the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DrivenBy {
    /// The recorded force; speed is predicted
    Force,
    /// The recorded speed; force is predicted
    Speed,
}

impl From<DrivenBy> for Drive {
    fn from(by: DrivenBy) -> Drive {
        match by {
            DrivenBy::Force => Drive::Force,
            DrivenBy::Speed => Drive::Speed,
        }
    }
}

/// A node that has a thermometer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Thermometer {
    /// Fluid
    Fluid,
    /// Rotors and stators
    Rotor,
    /// Housing
    Housing,
    /// None at all
    None,
}

#[derive(Debug, Args)]
pub(super) struct RigArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// The truck holds a force: "6000 lbf". With --compare, that mode's level
    #[arg(long, value_name = "FORCE")]
    pub force: Option<String>,
    /// The truck holds a speed: "2.5 ft/s". With --compare, that mode's level
    #[arg(long, value_name = "SPEED")]
    pub speed: Option<String>,
    /// The truck holds a power: "20 kW". With --compare, that mode's level
    #[arg(long, value_name = "POWER")]
    pub power: Option<String>,
    /// Drive the rig by a measured run: CSV with a header such as
    /// "time [s], force [lbf], speed [ft/s], fluid [°F]", or Parquet in SI
    #[arg(long, value_name = "FILE", conflicts_with_all = ["force", "speed", "power", "compare", "plan"])]
    pub recorded: Option<PathBuf>,
    /// Which recorded column drives [default: force, if there is one]
    #[arg(long, value_enum, requires = "recorded", value_name = "COLUMN")]
    pub by: Option<DrivenBy>,
    /// Take a record with gaps as it is, linear across them
    #[arg(long, requires = "recorded")]
    pub gaps: bool,
    /// Compare constant force, speed and power as options for a test
    #[arg(long, conflicts_with = "plan")]
    pub compare: bool,
    /// Find the best combinations of up to this many runs (1 to 4)
    #[arg(long, value_name = "RUNS", num_args = 0..=1, default_missing_value = "4",
          value_parser = clap::value_parser!(u8).range(1..=4),
          conflicts_with_all = ["force", "speed", "power"])]
    pub plan: Option<u8>,
    /// Load that no planned or compared run may exceed [default: 1.5 times the payload's weight]
    #[arg(long, value_name = "FORCE")]
    pub proof_load: Option<String>,
    /// Temperatures that a planned run can be started at, separated by commas [default: the study's initial temperature]
    #[arg(long, value_name = "TEMPERATURES")]
    pub starts: Option<String>,
    #[command(flatten)]
    pub instruments: InstrumentArguments,
    /// Write the course of the run to a Parquet file
    #[arg(long, value_name = "FILE.parquet", conflicts_with_all = ["compare", "plan"])]
    pub trace: Option<PathBuf>,
    /// Draw figures into a directory, as SVG
    #[arg(long, value_name = "DIR", conflicts_with = "plan")]
    pub figures: Option<PathBuf>,
    /// Directory for report.html, report.md, rig.json and the figures of --compare or --plan
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the directory even if it holds something else than earlier results of this study
    #[arg(long, requires = "out")]
    pub overwrite: bool,
    /// Print the result as one JSON object in SI, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

impl RigArguments {
    /// Refuses what clap cannot tell by itself: no pull at all, and several where only one can be held.
    ///
    /// # Errors
    /// A usage error.
    pub fn consistent(&self) -> std::result::Result<(), clap::Error> {
        let rig = || RigArguments::augment_args(Command::new("reeldown rig"));
        let usage = |kind, text: &str| Err(rig().error(kind, text));
        let held = [&self.force, &self.speed, &self.power].into_iter().flatten().count();
        if held > 1 && !self.compare {
            let text = "a truck holds one of --force, --speed and --power; --compare takes several";
            return usage(ErrorKind::ArgumentConflict, text);
        }
        if held == 0 && self.recorded.is_none() && !self.compare && self.plan.is_none() {
            let text = "what pulls? give one of --force \"6000 lbf\", --speed \"2.5 ft/s\", --power \"20 kW\", \
                        --recorded FILE.csv, or --compare, or --plan";
            return usage(ErrorKind::MissingRequiredArgument, text);
        }
        if self.out.is_some() && !self.compare && self.plan.is_none() {
            let text =
                "--out writes the report of --compare or --plan; one run has --figures and --trace";
            return usage(ErrorKind::ArgumentConflict, text);
        }
        let thermometers = &self.instruments.thermometers;
        if thermometers.contains(&Thermometer::None) && thermometers.len() > 1 {
            let text = "--thermometers: none goes with no other node";
            return usage(ErrorKind::ArgumentConflict, text);
        }
        Ok(())
    }
}

/// What the instruments read, and how well, for --compare and --plan.
#[derive(Debug, Args)]
#[command(next_help_heading = "Instruments, for --compare and --plan")]
pub(super) struct InstrumentArguments {
    /// Time between readings [default: 1 s]
    #[arg(long, value_name = "TIME")]
    pub every: Option<String>,
    /// Random error of a force reading, standard deviation [default: 1/120 of the payload's weight]
    #[arg(long, value_name = "FORCE")]
    pub force_error: Option<String>,
    /// Systematic error of the load cell, as a share [default: 1 %]
    #[arg(long, value_name = "SHARE")]
    pub force_gain: Option<String>,
    /// Random error of a speed reading, standard deviation [default: 2 % of the flight's mean speed]
    #[arg(long, value_name = "SPEED")]
    pub speed_error: Option<String>,
    /// Systematic error of the speedometer, as a share [default: 1 %]
    #[arg(long, value_name = "SHARE")]
    pub speed_gain: Option<String>,
    /// Random error of a temperature reading, standard deviation [default: 2 °F]
    #[arg(long, value_name = "TEMPERATURE")]
    pub temperature_error: Option<String>,
    /// Systematic error of each thermometer [default: 2 °F]
    #[arg(long, value_name = "TEMPERATURE")]
    pub temperature_offset: Option<String>,
    /// Nodes that have a thermometer [default: fluid,housing]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NODES")]
    pub thermometers: Vec<Thermometer>,
}

impl RigArguments {
    /// Proof load and instruments for the tests of a design: what is stated, and the rest assumed.
    ///
    /// # Errors
    /// A value without sense, at its option; a flight that cannot be computed.
    pub fn equipment(&self, design: &Design) -> Result<Equipment> {
        let given = |name: &str, text: &Option<String>, quantity| {
            text.as_deref().map(|text| option(name, text, quantity)).transpose()
        };
        let own = &self.instruments;
        let difference = Quantity::TemperatureDifference;
        let has = |node| own.thermometers.contains(&node);
        let nodes = [Thermometer::Fluid, Thermometer::Rotor, Thermometer::Housing];
        let stated = Stated {
            proof_load_n: given("--proof-load", &self.proof_load, Quantity::Force)?,
            every_s: given("--every", &own.every, Quantity::Time)?,
            force_noise_n: given("--force-error", &own.force_error, Quantity::Force)?,
            force_gain: given("--force-gain", &own.force_gain, Quantity::Number)?,
            speed_noise_m_per_s: given("--speed-error", &own.speed_error, Quantity::Speed)?,
            speed_gain: given("--speed-gain", &own.speed_gain, Quantity::Number)?,
            temperature_noise_k: given("--temperature-error", &own.temperature_error, difference)?,
            temperature_offset_k: given(
                "--temperature-offset",
                &own.temperature_offset,
                difference,
            )?,
            thermometers: (!own.thermometers.is_empty()).then(|| nodes.map(has)),
        };
        Equipment::stated(design, &stated)
    }
}

/// The value of an option with its unit, SI.
///
/// # Errors
/// A diagnostic at the option.
pub(super) fn option(name: &str, text: &str, quantity: Quantity) -> Result<f64> {
    units::parse(text, quantity).map_err(|error| {
        Error::from(Diagnostic {
            origin: name.to_owned(),
            text: text.to_owned(),
            span: error.span,
            problem: error.problem,
            expected: error.expected,
            help: error.help,
        })
    })
}
