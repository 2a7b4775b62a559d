//! What the paper says of the horizontal rig's three modes.

use super::{Course, FT, LBF, Statement, Verdict, fahrenheit, turn};
use crate::descent::driven::Drive;
use crate::descent::reference::Sample;
use crate::findings::rig::plan::top_level;
use crate::findings::rig::{Comparison, ModeFinding, RigRun, WARM_UP};
use crate::physics::Parameter;
use crate::study::Study;

/// Nothing beyond rounding.
const EXACT: f64 = 1e-9;
/// Share of the proof load from which on it counts as reached.
const PROOF_NEARLY: f64 = 0.9;
/// How far from a straight line still counts as on it, K.
const ON_THE_LINE_K: f64 = 1.0;

/// Its statements.
pub(super) fn statements(study: &Study, modes: &Comparison, flown: &RigRun) -> Vec<Statement> {
    let mode = |name: &str| modes.modes.iter().find(|mode| mode.mode == name);
    let (Some(force), Some(speed), Some(power)) = (mode("force"), mode("speed"), mode("power"))
    else {
        return Vec::new();
    };
    let velocity = |run: &RigRun| Course::new(&run.samples, |s| s.observation[4] / FT);
    let pull = |run: &RigRun| Course::new(&run.samples, |s| s.observation[1] / LBF);
    let (force_found, force_agrees) = velocity(&force.run).up_and_down("ft/s");
    let ratio = |s: &Sample| s.observation[3] / s.observation[4];
    let first_ratio = force.run.samples.first().map_or(f64::NAN, ratio);
    let proportional =
        force.run.samples.iter().all(|s| (ratio(s) / first_ratio - 1.0).abs() < EXACT);

    let speed_pull = pull(&speed.run);
    let negated: Vec<f64> = speed_pull.values.iter().map(|v| -v).collect();
    let lowest = turn(&negated);
    let length_m = study.design.get(Parameter::ReelLineLength);
    let middle = lowest.map(|k| speed.run.samples[k].line_m / length_m);
    let least = lowest.map_or(f64::NAN, |k| speed_pull.values[k]);
    let rise = speed_pull.last() / least;

    let (power_found, power_agrees) = velocity(&power.run).up_and_down("ft/s");
    let power_pull = pull(&power.run);
    let pull_turn = turn(&power_pull.values.iter().map(|v| -v).collect::<Vec<_>>());
    let end_over_proof = speed_pull.last() * LBF / modes.proof_load_n;
    let steady = share_near_least(&speed_pull.values, least);

    // "Low enough to avoid damaging loads": no more than the flight's own greatest load.
    let flight_load = flown.peak(|s| s.observation[1]).0;
    let [_, mean_speed, _] = modes.flight_means;
    let careful =
        top_level(study, &study.design, Drive::Speed, mean_speed, flight_load).map(|(v, run)| {
            let peak = fahrenheit(run.peak(|s| s.temperatures_k[0]).0);
            (v / FT, run.energy_j() / flown.energy_j(), peak)
        });
    let flight_peak = fahrenheit(modes.flight_peak_fluid_k);
    let start_f = fahrenheit(study.design.get(Parameter::InitialTemperature));
    vec![
        Statement {
            place: "rig, force",
            says: "with constant force the speed runs as in flight (Fig. 9), and power is proportional to it",
            found: format!(
                "speed {force_found}; power over speed {}",
                if proportional { "is constant to rounding" } else { "varies" }
            ),
            verdict: Verdict::of(force_agrees && proportional),
            remark: None,
        },
        Statement {
            place: "rig, force",
            says: "constant force reaches the flight's energy and the fluid's operating temperature",
            found: format!(
                "{:.0} % of the flight's energy; fluid {:.0} °F against {flight_peak:.0} °F",
                100.0 * force.energy_over_flight,
                fahrenheit(force.peak_fluid_k)
            ),
            verdict: Verdict::of((0.8..1.25).contains(&force.energy_over_flight)
                && fahrenheit(force.peak_fluid_k) > 0.9 * flight_peak),
            remark: None,
        },
        Statement {
            place: "rig, speed",
            says: "with constant speed the force starts high, falls to a shallow minimum near mid-line and rises again",
            found: format!(
                "{:.0} lbf at first, least {least:.0} lbf at {:.0} % of the line, {:.0} lbf at the end ({rise:.2} \
                 times the least)",
                speed_pull.first(),
                100.0 * middle.unwrap_or(f64::NAN),
                speed_pull.last()
            ),
            verdict: Verdict::of(
                middle.is_some_and(|m| (0.3..0.7).contains(&m))
                    && speed_pull.first() > 1.2 * least
                    && rise > 1.0,
            ),
            remark: None,
        },
        Statement {
            place: "rig, speed",
            says: "the rise towards the end is dramatic, and ends in the proof load",
            found: format!(
                "{:.0} lbf at the end: {:.0} % of the proof load, which the start takes ({:.0} lbf)",
                speed_pull.last(),
                100.0 * end_over_proof,
                speed_pull.first()
            ),
            verdict: Verdict::of(end_over_proof > PROOF_NEARLY),
            remark: Some(format!(
                "not reproduced: at one speed the pull goes as viscosity over the radius squared, and the cold fluid of \
                 the start pulls harder than the small radius of the end; a proof load is taken as reached from {:.0} % \
                 of it on",
                100.0 * PROOF_NEARLY
            )),
        },
        Statement {
            place: "rig, speed",
            says: "for a considerable part of the run the load is nearly constant",
            found: format!(
                "within a tenth of its least for {:.0} % of the run's time",
                100.0 * steady
            ),
            verdict: Verdict::of(steady >= 0.5),
            remark: Some("\"considerable\" is taken as half, \"nearly\" as a tenth".to_owned()),
        },
        Statement {
            place: "rig, speed",
            says: "a speed low enough to spare the line leads to a small increase of the fluid's temperature",
            found: careful.map_or("no speed keeps the flight's load".to_owned(), |(_, _, peak)| {
                format!(
                    "{:.0} °F, {:.0} % of the flight's {:.0} °F",
                    peak - start_f,
                    100.0 * (peak - start_f) / (flight_peak - start_f),
                    flight_peak - start_f
                )
            }),
            verdict: Verdict::of(
                careful.is_some_and(|(_, _, peak)| peak - start_f < 0.5 * (flight_peak - start_f)),
            ),
            remark: Some(
                "not reproduced as written: a pull of the whole line turns most of the flight's energy into heat; \
                 \"small\" is taken as less than half the flight's increase"
                    .to_owned(),
            ),
        },
        Statement {
            place: "rig, speed",
            says: "a speed low enough to spare the line keeps energy and temperature below the flight's",
            found: careful.map_or("no speed keeps the flight's load".to_owned(), |(v, share, peak)| {
                format!(
                    "at {v:.2} ft/s, which pulls no harder than the flight does, {:.0} % of its energy and {peak:.0} \
                     °F against {flight_peak:.0} °F",
                    100.0 * share
                )
            }),
            verdict: Verdict::of(careful.is_some_and(|(_, share, peak)| share < 1.0 && peak < flight_peak)),
            remark: Some(format!(
                "it depends on the load that is allowed, which the paper does not give: up to {:.0} lbf, {:.2} ft/s \
                 reach {:.0} % and {:.0} °F",
                modes.proof_load_n / LBF,
                speed.level / FT,
                100.0 * speed.energy_over_flight,
                fahrenheit(speed.peak_fluid_k)
            )),
        },
        Statement {
            place: "rig, power",
            says: "with constant power speed rises, then falls; force falls, then rises",
            found: format!(
                "speed {power_found}; force {:.0} lbf at first, {} lbf at the least, {:.0} lbf at the end",
                power_pull.first(),
                pull_turn.map_or("–".to_owned(), |k| format!("{:.0}", power_pull.values[k])),
                power_pull.last()
            ),
            verdict: Verdict::of(power_agrees && pull_turn.is_some()),
            remark: None,
        },
        most_linear(force, speed, power),
    ]
}

/// Which mode has the most nearly linear rise of temperature: the paper does not say how it measured that, and three
/// measures are computed.
fn most_linear(force: &ModeFinding, speed: &ModeFinding, power: &ModeFinding) -> Statement {
    let modes = [force, speed, power];
    let departure = |from: f64| {
        modes.map(|mode| mode.run.departure_from_linear_after(from).unwrap_or(f64::NAN))
    };
    let (whole, warm) = (departure(0.0), departure(WARM_UP));
    let period = modes.map(|mode| mode.run.longest_linear_rise_s(ON_THE_LINE_K));
    let wins = [
        whole[2] < whole[0] && whole[2] < whole[1],
        warm[2] < warm[0] && warm[2] < warm[1],
        period[2] > period[0] && period[2] > period[1],
    ];
    let percent = |d: [f64; 3]| d.map(|x| format!("{:.1}", 100.0 * x)).join(", ");
    Statement {
        place: "rig, power",
        says: "constant power has the longest period of nearly linear temperature rise",
        found: format!(
            "constant force, speed, power: within {ON_THE_LINE_K} K of a straight line for {} s at the longest; straying \
             from it by {} % of the rise after the first tenth of the run, by {} % over the whole",
            period.map(|s| format!("{s:.0}")).join(", "),
            percent(warm),
            percent(whole)
        ),
        verdict: match wins {
            [true, true, true] => Verdict::Pass,
            [false, false, false] => Verdict::Fail,
            _ => Verdict::Undecided,
        },
        remark: Some(
            "the paper does not say how it measured this, and the answer depends on it: the three measures do not name \
             the same mode"
                .to_owned(),
        )
        .filter(|_| wins.contains(&true) && wins.contains(&false)),
    }
}

/// Share of the moments at which a pull is within a tenth of its least.
fn share_near_least(pull: &[f64], least: f64) -> f64 {
    let near = pull.iter().filter(|pull| **pull <= 1.1 * least).count();
    near as f64 / pull.len().max(1) as f64
}
