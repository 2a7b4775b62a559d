//! What the paper wishes, fears and neglects, held against numbers.

use super::{FAMILY, FT, LBF, Statement, Verdict, cannot, fahrenheit};
use crate::descent::outcome::TIME_LIMIT_S;
use crate::descent::reference::{Sample, descend};
use crate::descent::{Model, Outcome, OutcomeQuantity};
use crate::error::Result;
use crate::findings::rig::RigRun;
use crate::numerics::elementary::pow;
use crate::physics::{Coefficients, Design, Parameter, Target};
use crate::study::Study;
use crate::units::number;

/// Ends of the starting temperatures that the paper wishes for, °F.
const WISHED_F: [f64; 2] = [0.0, 100.0];
/// Viscosities tried: this factor either way, in so many steps each way.
const FACTOR: f64 = 10.0;
const STEPS: i32 = 20;
/// Halvings that place the end of a range.
const HALVINGS: usize = 14;
/// Square metres per second of a centistokes.
const CST: f64 = 1e-6;
/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;
/// Free convection and radiation of a warm body in air, W/(m² K): handbooks give 5 to 15.
const AIR_W_PER_M2_K: f64 = 15.0;
/// Density (kg/m³) and tensile strength (Pa) of aramid yarn: DuPont, *Kevlar Aramid Fiber Technical Guide*, Kevlar 29.
const ARAMID: (f64, f64) = (1440.0, 2.92e9);
/// Breaking load of the line over the proof load: assumed, generous for a line's mass.
const SAFETY: f64 = 5.0;
/// Share below which something counts as negligible.
const NEGLIGIBLE: f64 = 0.05;

/// A fluid of some viscosity, from some start.
struct Fluids<'a> {
    study: &'a Study,
    nominal: f64,
}

impl Fluids<'_> {
    fn outcome(&self, start_k: f64, viscosity: f64) -> Result<Outcome> {
        let mut design = self.study.design.clone();
        design.set(Target::whole(Parameter::InitialTemperature), start_k);
        design.set(Target::whole(Parameter::FluidNominalViscosity), viscosity);
        descend(&Coefficients::new(&design), Model::QuasiSteady, FAMILY.0).map_err(cannot)
    }

    /// Names of the limits that are breached.
    fn breached(&self, outcome: &Outcome) -> Vec<String> {
        let limits = self.study.limits.iter();
        limits.filter(|limit| limit.margin(outcome) < 0.0).map(|limit| limit.name()).collect()
    }

    /// The least and the greatest viscosity tried for which something holds, m²/s, and whether each is a true end: one
    /// beyond which it does not.
    fn range(
        &self,
        start_k: f64,
        holds: &dyn Fn(&Outcome) -> bool,
    ) -> Result<Option<[(f64, bool); 2]>> {
        let at = |step: i32| self.nominal * pow(FACTOR, f64::from(step) / f64::from(STEPS));
        let mut there = Vec::new();
        for step in -STEPS..=STEPS {
            if holds(&self.outcome(start_k, at(step))?) {
                there.push(step);
            }
        }
        let (Some(&first), Some(&last)) = (there.first(), there.last()) else { return Ok(None) };
        let end = |inside: i32, outside: i32| -> Result<(f64, bool)> {
            if outside.abs() > STEPS {
                return Ok((at(inside), false));
            }
            let (mut inside, mut outside) = (at(inside), at(outside));
            for _ in 0..HALVINGS {
                let middle = (inside * outside).sqrt();
                match holds(&self.outcome(start_k, middle)?) {
                    true => inside = middle,
                    false => outside = middle,
                }
            }
            Ok((inside, true))
        };
        Ok(Some([end(first, first - 1)?, end(last, last + 1)?]))
    }
}

fn cst(viscosity: f64) -> String {
    format!("{} cSt", number(viscosity / CST, 3))
}

/// What is wished and feared of the fluid's viscosity.
///
/// # Errors
/// If a descent cannot be computed.
pub(super) fn fluids(study: &Study) -> Result<Vec<Statement>> {
    let nominal = study.design.get(Parameter::FluidNominalViscosity);
    let fluids = Fluids { study, nominal };
    let start_k = study.design.get(Parameter::InitialTemperature);
    let mut statements = vec![both_ends(&fluids)?];
    let hottest = study
        .limits
        .iter()
        .find(|limit| limit.outcome == OutcomeQuantity::PeakFluidTemperature)
        .cloned();
    if let Some(limit) = hottest {
        let hot = fluids.range(start_k, &|outcome| limit.margin(outcome) < 0.0)?;
        let found = match hot {
            Some([_, (most, _)]) => {
                let thin = fluids.outcome(start_k, most)?;
                format!(
                    "below {} the fluid passes {}; the line is out in {:.0} s there, up to {:.1} ft/s",
                    cst(most),
                    limit.text,
                    thin.get(OutcomeQuantity::Time),
                    thin.get(OutcomeQuantity::PeakVelocity) / FT
                )
            }
            None => {
                let least = fluids.outcome(start_k, nominal / FACTOR)?;
                format!(
                    "not down to {}, where the fluid reaches {:.0} °F and the line {:.0} ft/s",
                    cst(nominal / FACTOR),
                    fahrenheit(least.get(OutcomeQuantity::PeakFluidTemperature)),
                    least.get(OutcomeQuantity::PeakVelocity) / FT
                )
            }
        };
        statements.push(Statement {
            place: "background",
            says: "too thin a fluid could run away thermally",
            found,
            verdict: Verdict::of(hot.is_some()),
            remark: Some(
                "a runaway is taken as a fluid beyond its limit; what the payload's descent has to give bounds it"
                    .to_owned(),
            ),
        });
    }
    let whole = fluids.range(start_k, &|outcome| !outcome.deployed)?;
    let late = fluids.range(start_k, &|outcome| {
        let times = study.limits.iter().filter(|limit| limit.outcome == OutcomeQuantity::Time);
        times.clone().any(|limit| limit.margin(outcome) < 0.0)
    })?;
    let from = |range: Option<[(f64, bool); 2]>| range.map(|[(least, _), _]| cst(least));
    statements.push(Statement {
        place: "background",
        says: "too thick a fluid takes too long",
        found: format!(
            "{}; {}",
            from(late).map_or("no viscosity tried breaches a limit on time".to_owned(), |v| {
                format!("the limit on time is breached from {v} on")
            }),
            from(whole).map_or("the line always comes out".to_owned(), |v| {
                format!("from {v} on the line is not out within {TIME_LIMIT_S:.0} s, if ever")
            })
        ),
        verdict: Verdict::of(late.is_some()),
        remark: None,
    });
    Ok(statements)
}

/// The wish for every start from 0 °F to 100 °F.
fn both_ends(fluids: &Fluids<'_>) -> Result<Statement> {
    let kept = |outcome: &Outcome| outcome.deployed && fluids.breached(outcome).is_empty();
    let mut told = Vec::new();
    let mut ranges = Vec::new();
    for start_f in WISHED_F {
        let start_k = (start_f + 459.67) / 1.8;
        let range = fluids.range(start_k, &kept)?;
        told.push(match range {
            None => format!("from {start_f:.0} °F no viscosity tried keeps every limit"),
            Some([least, most]) => {
                let mut ends = Vec::new();
                for (word, (viscosity, true_end), beyond) in
                    [("at least", least, 0.99), ("at most", most, 1.01)]
                {
                    if true_end {
                        let outcome = fluids.outcome(start_k, beyond * viscosity)?;
                        let why = fluids.breached(&outcome).join(", ");
                        ends.push(format!("{word} {} ({why})", cst(viscosity)));
                    }
                }
                let ends =
                    if ends.is_empty() { "any viscosity".to_owned() } else { ends.join(" and ") };
                format!("from {start_f:.0} °F the limits need {ends}")
            }
        });
        ranges.push(range);
    }
    let together = match ranges.as_slice() {
        [Some([a, b]), Some([c, d])] => a.0.max(c.0) <= b.0.min(d.0),
        _ => false,
    };
    Ok(Statement {
        place: "requirement",
        says: "a desired capability: every constraint kept from starts of 0 °F to 100 °F",
        found: format!(
            "{}: {}",
            told.join("; "),
            match together {
                true => "one fluid does for both",
                false => "no fluid of this design does for both, nominally",
            }
        ),
        verdict: Verdict::of(together),
        remark: Some(
            "the paper wishes this and does not claim it; its own limits are on time and fluid temperature, that on the \
             final velocity, which it leaves open, is this study's"
                .to_owned(),
        ),
    })
}

/// What the paper neglects.
pub(super) fn neglected(design: &Design, flown: &RigRun, proof_load_n: f64) -> Vec<Statement> {
    let radius_m = design.get(Parameter::BrakeOuterRadius);
    // A cylinder as long as it is wide.
    let area_m2 = 6.0 * std::f64::consts::PI * radius_m * radius_m;
    let air_k = design.get(Parameter::ThermalAirTemperature);
    let warmer = |s: &Sample| (s.temperatures_k[2] - air_k).max(0.0);
    let kelvin_seconds: f64 = flown
        .samples
        .windows(2)
        .map(|p| 0.5 * (p[1].time_s - p[0].time_s) * (warmer(&p[0]) + warmer(&p[1])))
        .sum();
    let air = AIR_W_PER_M2_K * area_m2 * kelvin_seconds / flown.energy_j();

    let length_m = design.get(Parameter::ReelLineLength);
    let extracted_kg_per_m = design.get(Parameter::PayloadExtractedWeight) / GRAVITY / length_m;
    let momentum = flown
        .samples
        .iter()
        .map(|s| extracted_kg_per_m * s.observation[4] * s.observation[4] / s.observation[1])
        .fold(0.0, f64::max);

    let line_kg = SAFETY * proof_load_n * length_m * ARAMID.0 / ARAMID.1;
    let line = line_kg * GRAVITY / design.get(Parameter::PayloadWeight);
    let share = |x: f64| format!("{} %", number(100.0 * x, 2));
    vec![
        Statement {
            place: "theory",
            says: "the force that accelerates the extracted balloon and parachute is negligible",
            found: format!("at most {} of the line's tension", share(momentum)),
            verdict: Verdict::of(momentum < NEGLIGIBLE),
            remark: None,
        },
        Statement {
            place: "theory",
            says: "the mass of the lines is negligible",
            found: format!("{line_kg:.0} kg, {} of the payload's weight", share(line)),
            verdict: Verdict::of(line < NEGLIGIBLE),
            remark: Some(format!(
                "for aramid lines that break at {SAFETY} times the proof load of {:.0} lbf, both assumed",
                proof_load_n / LBF
            )),
        },
        Statement {
            place: "theory",
            says: "in so short a time little heat passes to the surrounding air",
            found: format!("{} of the energy", share(air)),
            verdict: Verdict::of(air < NEGLIGIBLE),
            remark: Some(format!(
                "for a housing as a cylinder of the discs' radius, as long as it is wide, losing {AIR_W_PER_M2_K} W/(m² K), \
                 both assumed"
            )),
        },
    ]
}
