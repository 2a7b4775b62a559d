//! What the paper says of its figures, held against this program's numbers: one statement a row, each with what
//! was found and whether it agrees, computed from the data.
//!
//! Source: G. Jumper, *Improved Viscous Brake Design Using Simulation*. What it says is told in our words.

mod assumptions;
mod rig;

use super::figures::{PaperRuns, paper_runs};
use super::rig::{Comparison, Equipment, RigRun, compare, flight};
use crate::descent::reference::{Sample, trajectory};
use crate::descent::{Model, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::physics::{Coefficients, Design, Parameter, Target};
use crate::study::Study;
use crate::units::number;
use serde::Serialize;

/// Starting temperatures of figure 10, °F: those between which the paper wants the brake to work.
pub const STARTS_F: [f64; 5] = [0.0, 40.0, 60.0, 80.0, 100.0];
/// The paper's time of the whole run, s, and how far a number that is said so roundly may be off.
const ABOUT_S: (f64, f64) = (200.0, 5.0);
/// Pound-force, N.
const LBF: f64 = 4.448_221_615_260_5;
/// Foot, m.
const FT: f64 = 0.3048;
/// Accuracy and longest step of the runs of figure 10.
const FAMILY: (f64, f64) = (1e-7, 1.0);

/// One statement of the paper.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    /// Where it stands: "Fig. 5", "§ rig".
    pub place: &'static str,
    /// What it says, in our words.
    pub says: &'static str,
    /// What is found here.
    pub found: String,
    /// What that comes to.
    pub verdict: Verdict,
    /// Why it may not agree, or how far the agreement goes.
    pub remark: Option<String>,
}

/// What a statement comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It is so here.
    Pass,
    /// It is not.
    Fail,
    /// It is so by one reading of the words and not by another.
    Undecided,
    /// It could not have come out otherwise, so that agreement says nothing.
    NoTest,
}

impl Verdict {
    /// That of a statement that can be decided.
    pub fn of(agrees: bool) -> Self {
        if agrees { Verdict::Pass } else { Verdict::Fail }
    }
}

/// The paper's figures and statements.
#[derive(Debug, Clone, Serialize)]
pub struct PaperFinding {
    /// The statements, in the paper's order.
    pub statements: Vec<Statement>,
    /// Starting temperature (°F), time (s) and whether every limit is kept, for each run of figure 10.
    pub starts: Vec<(f64, f64, bool)>,
    /// The runs of figures 4 to 9.
    #[serde(skip)]
    pub runs: PaperRuns,
    /// The runs of figure 10.
    #[serde(skip)]
    pub family: Vec<(f64, Vec<Sample>)>,
    /// The rig's modes.
    pub modes: Comparison,
}

fn fahrenheit(kelvin: f64) -> f64 {
    kelvin * 1.8 - 459.67
}

fn rises(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] < pair[1])
}

fn falls(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] > pair[1])
}

/// The place of the turn of a sequence that rises and then falls.
fn turn(values: &[f64]) -> Option<usize> {
    let top = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?.0;
    let inside = top > 0 && top + 1 < values.len();
    (inside && rises(&values[..=top]) && falls(&values[top..])).then_some(top)
}

/// A course along the run, told as the paper tells it.
struct Course {
    values: Vec<f64>,
    times: Vec<f64>,
}

impl Course {
    fn new(samples: &[Sample], read: impl Fn(&Sample) -> f64) -> Self {
        Course {
            values: samples.iter().map(read).collect(),
            times: samples.iter().map(|s| s.time_s).collect(),
        }
    }

    fn first(&self) -> f64 {
        self.values.first().copied().unwrap_or(f64::NAN)
    }

    fn last(&self) -> f64 {
        self.values.last().copied().unwrap_or(f64::NAN)
    }

    /// Whether it rises and then falls, in words.
    fn up_and_down(&self, unit: &str) -> (String, bool) {
        match turn(&self.values) {
            Some(k) => (
                format!(
                    "rises from {} to {} {unit} after {:.0} s, then falls to {}",
                    number(self.first(), 3),
                    number(self.values[k], 3),
                    self.times[k],
                    number(self.last(), 3)
                ),
                true,
            ),
            None => (
                format!(
                    "goes from {} to {} {unit}, not up and then down",
                    number(self.first(), 3),
                    number(self.last(), 3)
                ),
                false,
            ),
        }
    }
}

/// Every figure and statement of the paper, from a study's design.
///
/// # Errors
/// If a run cannot be computed.
pub fn paper(study: &Study) -> Result<PaperFinding> {
    let design = &study.design;
    let runs = paper_runs(design, Model::QuasiSteady).map_err(cannot)?;
    let family: Vec<(f64, Vec<Sample>)> = STARTS_F
        .into_iter()
        .map(|start| Ok((start, started(design, start)?)))
        .collect::<Result<_>>()?;
    let equipment = Equipment::assumed(design)?;
    let modes = compare(study, &equipment, [None; 3])?;
    let flown = flight(design)?;
    let mut statements = assumptions::fluids(study)?;
    statements.extend(assumptions::neglected(design, &flown, equipment.proof_load_n));
    statements.extend(flight_statements(study, &runs, &flown)?);
    let starts = starts(study, &family);
    statements.push(starting_temperatures(&starts));
    statements.extend(rig::statements(study, &modes, &flown));
    Ok(PaperFinding { statements, starts, runs, family, modes })
}

fn cannot(fault: crate::descent::Fault) -> Error {
    Error::argument(format!("a run of the paper cannot be computed: {}", fault.name()))
}

fn started(design: &Design, start_f: f64) -> Result<Vec<Sample>> {
    let mut design = design.clone();
    design.set(Target::whole(Parameter::InitialTemperature), (start_f + 459.67) / 1.8);
    let c = Coefficients::new(&design);
    let run = trajectory(&c, Model::QuasiSteady, FAMILY.0, FAMILY.1).map_err(cannot)?;
    Ok(run.samples)
}

/// Figures 4 to 9.
fn flight_statements(study: &Study, runs: &PaperRuns, flown: &RigRun) -> Result<Vec<Statement>> {
    let get = |quantity| flown.outcome.get(quantity);
    let time = get(OutcomeQuantity::Time);
    let breached: Vec<String> = study
        .limits
        .iter()
        .filter(|limit| limit.margin(&flown.outcome) < 0.0)
        .map(|limit| limit.name())
        .collect();
    let samples = &runs.descent.samples;
    let torque = Course::new(samples, |s| s.torque_nm / (LBF * FT));
    let reel = Course::new(samples, |s| s.observation[2] * 60.0 / std::f64::consts::TAU);
    let power = Course::new(samples, |s| s.observation[3] * 1e-3);
    let fluid = Course::new(samples, |s| fahrenheit(s.temperatures_k[0]));
    let velocity = Course::new(samples, |s| s.observation[4] / FT);
    let (reel_found, reel_agrees) = reel.up_and_down("rpm");
    let (power_found, power_agrees) = power.up_and_down("kW");
    let (velocity_found, velocity_agrees) = velocity.up_and_down("ft/s");
    let hottest = fluid.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut statements = vec![Statement {
        place: "design case",
        says: "from 60 °F with 125 000 cSt the 500 ft are out in 200 s, with fluid temperature, time and \
               final velocity inside their constraints",
        found: format!(
            "{time:.2} s; fluid at most {hottest:.1} °F; {:.2} ft/s at the end; limits breached: {}",
            velocity.last(),
            if breached.is_empty() { "none".to_owned() } else { breached.join(", ") }
        ),
        verdict: match (time - ABOUT_S.0).abs() <= ABOUT_S.1 && breached.is_empty() {
            true => Verdict::NoTest,
            false => Verdict::Fail,
        },
        remark: Some(
            "the paper prints no geometry: radii, gap and weights were reconstructed so that this comes out, \
             so it is no test; the rest is"
                .to_owned(),
        ),
    }];
    statements.extend(constant_temperature(study, runs)?);
    statements.extend([
        Statement {
            place: "Fig. 5",
            says: "brake torque falls monotonically, as weight and reel radius do",
            found: format!(
                "falls from {:.0} to {:.0} lbf·ft, {}",
                torque.first(),
                torque.last(),
                if falls(&torque.values) { "at every moment" } else { "but not at every moment" }
            ),
            verdict: Verdict::of(falls(&torque.values)),
            remark: None,
        },
        Statement {
            place: "Fig. 6",
            says: "reel speed increases as the fluid thins, until the falling torque slows it down",
            found: reel_found,
            verdict: Verdict::of(reel_agrees),
            remark: None,
        },
        Statement {
            place: "Fig. 7",
            says: "the power heats the fluid and grows with the velocity",
            found: power_found,
            verdict: Verdict::of(power_agrees),
            remark: None,
        },
        Statement {
            place: "Fig. 8",
            says: "fluid temperature increases along the run and stays below 450 °F",
            found: format!(
                "rises from {:.1} to {:.1} °F{}",
                fluid.first(),
                fluid.last(),
                if rises(&fluid.values) { ", at every moment" } else { ", but not throughout" }
            ),
            verdict: Verdict::of(rises(&fluid.values) && hottest <= 450.0),
            remark: None,
        },
        Statement {
            place: "Fig. 9",
            says: "rollout velocity grows at first; the smaller radius and torque bring it down again at the \
                   end",
            found: velocity_found,
            verdict: Verdict::of(velocity_agrees),
            remark: None,
        },
    ]);
    Ok(statements)
}

/// Figure 4.
fn constant_temperature(study: &Study, runs: &PaperRuns) -> Result<[Statement; 2]> {
    let held = &runs.constant_temperature;
    let settled = runs.settling_time_s();
    let whole = held.dynamic.outcome.get(OutcomeQuantity::Time);
    let deployed = held.dynamic.outcome.deployed;
    let start_f = fahrenheit(study.design.get(Parameter::InitialTemperature));
    let (same, same_f) = same_time(&study.design)?;
    // At one temperature the time is proportional to the viscosity.
    let nominal = study.design.get(Parameter::FluidNominalViscosity) * 1e6;
    let thin = nominal * ABOUT_S.0 / held.steady.outcome.get(OutcomeQuantity::Time);
    Ok([
        Statement {
            place: "Fig. 4",
            says: "with the temperature held, the dynamic solution joins the steady one within a second",
            found: settled.map_or("does not join it".to_owned(), |s| {
                format!("within 1 % of it from {s:.2} s on")
            }),
            verdict: Verdict::of(settled.is_some_and(|s| s < 1.0)),
            remark: None,
        },
        Statement {
            place: "Fig. 4",
            says: "that run takes almost 200 s",
            found: if deployed {
                format!("held at {start_f:.0} °F it takes {whole:.0} s")
            } else {
                format!("held at {start_f:.0} °F it does not end within {whole:.0} s")
            },
            verdict: Verdict::of(
                deployed && (0.9 * ABOUT_S.0..=ABOUT_S.0 + ABOUT_S.1).contains(&whole),
            ),
            remark: Some(format!(
                "not reproduced. A fluid that is kept cold never thins, so a run that takes 200 s with heating \
                 must take longer without it: that follows from the paper's own equations, whatever the geometry. The paper gives neither the temperature nor the viscosity of its Fig. 4. This design takes \
                 {same:.0} s if its fluid is held at {same_f:.0} °F, which in the heated run it is only later, or with \
                 a fluid of {thin:.0} cSt held at {start_f:.0} °F; probably the paper's run was one of the two \
                 kinds, but which cannot be told from its text"
            )),
        },
    ])
}

/// The temperature (°F) at which the design takes the paper's time if that temperature is held, and the time.
fn same_time(design: &Design) -> Result<(f64, f64)> {
    let time = |start_f: f64| -> Result<f64> {
        let mut held = super::figures::held_temperature(design);
        held.set(Target::whole(Parameter::InitialTemperature), (start_f + 459.67) / 1.8);
        let c = Coefficients::new(&held);
        let outcome = crate::descent::reference::descend(&c, Model::QuasiSteady, FAMILY.0);
        Ok(outcome.map_err(cannot)?.get(OutcomeQuantity::Time))
    };
    let (mut low, mut high) = (0.0, 450.0);
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if time(middle)? > ABOUT_S.0 { low = middle } else { high = middle }
    }
    Ok((time(high)?, high))
}

/// Start, time and whether every limit is kept, for figure 10.
fn starts(study: &Study, family: &[(f64, Vec<Sample>)]) -> Vec<(f64, f64, bool)> {
    let row = |(start, samples): &(f64, Vec<Sample>)| {
        let last = samples.last();
        let time = last.map_or(f64::NAN, |s| s.time_s);
        let velocity = last.map_or(f64::NAN, |s| s.observation[4]);
        let hottest = samples.iter().map(|s| s.temperatures_k[0]).fold(f64::NAN, f64::max);
        let kept = study.limits.iter().all(|limit| {
            let value = match limit.outcome {
                OutcomeQuantity::Time => time,
                OutcomeQuantity::FinalVelocity => velocity,
                OutcomeQuantity::PeakFluidTemperature => hottest,
                _ => return true,
            };
            limit.margin_of(value) >= 0.0
        });
        (*start, time, kept)
    };
    family.iter().map(row).collect()
}

fn starting_temperatures(starts: &[(f64, f64, bool)]) -> Statement {
    let times: Vec<String> =
        starts.iter().map(|(start, time, _)| format!("{start:.0} °F: {time:.0} s")).collect();
    let ordered: Vec<f64> = starts.iter().map(|(_, time, _)| *time).collect();
    Statement {
        place: "Fig. 10",
        says: "the same viscosity behaves differently from other starting temperatures",
        found: times.join(", "),
        verdict: if falls(&ordered) { Verdict::NoTest } else { Verdict::Fail },
        remark: Some("any fluid that thins as it warms does, so that it is no test".to_owned()),
    }
}
