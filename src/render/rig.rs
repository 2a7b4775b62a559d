//! The rig in words, on a terminal or as Markdown: the three modes as test options, and the plan of tests.

use super::figures::Figure;
use super::figures_of_speech::{probability, value};
use super::tables::Medium;
use crate::findings::rig::{Band, Candidate, Combination, Comparison, Instruments, PlanFinding};
use crate::units::{Quantity, number};

/// The quantity that a mode holds.
fn held(mode: &str) -> Quantity {
    match mode {
        "force" => Quantity::Force,
        "speed" => Quantity::Speed,
        _ => Quantity::Power,
    }
}

fn share(x: f64) -> String {
    format!("{} %", number(100.0 * x, 3))
}

fn energy(joule: f64) -> String {
    format!("{} MJ", number(joule * 1e-6, 4))
}

/// The instruments in a sentence.
fn instruments(i: &Instruments) -> String {
    let nodes = ["fluid", "rotors", "housing"];
    let there: Vec<&str> =
        nodes.iter().zip(i.thermometers).filter(|(_, there)| *there).map(|(n, _)| *n).collect();
    let thermometers = if there.is_empty() {
        "no thermometers".to_owned()
    } else {
        format!(
            "thermometers in {} (random {}, systematic {})",
            there.join(" and "),
            value(i.temperature_noise_k, Quantity::TemperatureDifference),
            value(i.temperature_offset_k, Quantity::TemperatureDifference)
        )
    };
    format!(
        "a reading every {} s of force (random {}, systematic {}) and speed (random {}, systematic {}), {thermometers}",
        number(i.every_s, 4),
        value(i.force_noise_n, Quantity::Force),
        share(i.force_gain),
        value(i.speed_noise_m_per_s, Quantity::Speed),
        share(i.speed_gain),
    )
}

/// What of load and instruments nobody stated.
fn assumed(assumed: &[String]) -> String {
    match assumed {
        [] => String::new(),
        some => format!("Assumed, as no option states it: {}.", some.join("; ")),
    }
}

/// Rows of what remains of each parameter's standard deviation, one column a case.
fn remaining_rows(parameters: &[(String, usize)], cases: &[&[f64]]) -> Vec<Vec<String>> {
    let named = parameters.iter().enumerate().map(|(k, (name, members))| {
        let name = if *members > 1 { format!("{name} (×{members}, each)") } else { name.clone() };
        let shares = cases.iter().map(|case| case.get(k).map_or("–".to_owned(), |x| share(*x)));
        [name].into_iter().chain(shares).collect()
    });
    named.collect()
}

/// The three modes compared, for a terminal.
pub fn rig_comparison_terminal(comparison: &Comparison) -> String {
    rig_comparison(comparison, Medium::Terminal)
}

/// The three modes compared, as Markdown; `figures` are files in the directory `figures` beside it.
pub fn rig_comparison_markdown(comparison: &Comparison, figures: &[Figure]) -> String {
    let mut text = rig_comparison(comparison, Medium::Markdown);
    text += "## Course of the runs\n\n";
    for figure in figures {
        text += &figure.markdown();
    }
    text
}

fn rig_comparison(comparison: &Comparison, medium: Medium) -> String {
    let modes = &comparison.modes;
    let header: Vec<String> = [String::new()]
        .into_iter()
        .chain(modes.iter().map(|mode| format!("constant {}", mode.mode)))
        .chain(["flight".to_owned()])
        .collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    type Read<'a> = &'a dyn Fn(&crate::findings::rig::ModeFinding) -> String;
    let row = |name: &str, read: Read<'_>, flight: String| -> Vec<String> {
        [name.to_owned()].into_iter().chain(modes.iter().map(read)).chain([flight]).collect()
    };
    let none = || "–".to_owned();
    let [force, speed, power] = comparison.flight_means;
    let means = [
        value(force, Quantity::Force),
        value(speed, Quantity::Speed),
        value(power, Quantity::Power),
    ];
    let rows = vec![
        row(
            "held",
            &|m| format!("{}{}", value(m.level, held(m.mode)), if m.reduced { " (*)" } else { "" }),
            none(),
        ),
        row("duration", &|m| value(m.duration_s, Quantity::Time), none()),
        row("peak load", &|m| value(m.peak_force_n, Quantity::Force), none()),
        row(
            "  after",
            &|m| m.peak_force_time_s.map_or("constant".to_owned(), |s| value(s, Quantity::Time)),
            none(),
        ),
        row("  of the proof load", &|m| share(m.load_over_proof), none()),
        row("energy", &|m| energy(m.energy_j), energy(comparison.flight_energy_j)),
        row("  of the flight's", &|m| share(m.energy_over_flight), none()),
        row(
            "peak fluid temperature",
            &|m| value(m.peak_fluid_k, Quantity::Temperature),
            value(comparison.flight_peak_fluid_k, Quantity::Temperature),
        ),
        row(
            "departure from linear rise",
            &|m| m.departure_from_linear.map_or_else(none, share),
            none(),
        ),
    ];
    let mut text = medium.title(&format!(
        "The rig's modes as test options, proof load {}",
        value(comparison.proof_load_n, Quantity::Force)
    ));
    text += &medium.line(&format!(
        "Flight and runs by the {} model, without accelerations.",
        comparison.model
    ));
    text += &medium.table(&header, 1..header.len(), rows, None);
    text += &medium.paragraph(&format!("flight, on the mean over its time: {}", means.join(", ")));
    if modes.iter().any(|mode| mode.reduced) {
        text += &medium.line(
            "(*) the greatest within proof load and the fluid's limit: the flight's mean is not",
        );
    }
    let cases: Vec<&[f64]> = modes.iter().map(|mode| mode.remaining.as_slice()).collect();
    let mut header: Vec<&str> = header;
    header.pop();
    header[0] = "standard deviation left of";
    text += &medium.heading("Calibration value of one run: what is left of each uncertainty");
    let rows = remaining_rows(&comparison.parameters, &cases);
    text += &medium.table(&header, 1..header.len(), rows, None);
    text += &medium.paragraph(&format!("Instruments: {}.", instruments(&comparison.instruments)));
    text + &medium.line(&assumed(&comparison.assumed))
}

fn run_name(candidate: &Candidate) -> String {
    format!(
        "{} {} from {}",
        candidate.mode,
        value(candidate.level, held(candidate.mode)),
        value(candidate.start_k, Quantity::Temperature)
    )
}

fn runs_name(plan: &PlanFinding, combination: &Combination) -> String {
    let mut names: Vec<(String, usize)> = Vec::new();
    for candidate in combination.runs.iter().filter_map(|&k| plan.candidates.get(k)) {
        let name = run_name(candidate);
        match names.iter_mut().find(|(other, _)| *other == name) {
            Some((_, count)) => *count += 1,
            None => names.push((name, 1)),
        }
    }
    let names: Vec<String> = names
        .into_iter()
        .map(|(name, count)| if count > 1 { format!("{count} × {name}") } else { name })
        .collect();
    names.join(" + ")
}

/// A band's ends, width and standard deviation.
fn band(band: &Band) -> [String; 3] {
    [
        format!("{} … {}", share(band.lower), share(band.upper)),
        share(band.upper - band.lower),
        share(band.standard_deviation),
    ]
}

/// What a truck or a crew may not be able to do of what is planned.
fn practice(plan: &PlanFinding) -> Vec<String> {
    let mut lines = Vec::new();
    let width = |c: &Combination| share(c.band.upper - c.band.lower);
    let simpler: Vec<String> = plan
        .without_power
        .iter()
        .zip(&plan.best)
        .filter_map(|(simple, best)| Some((simple, best.first()?)))
        .filter(|(simple, best)| best.runs != simple.runs)
        .map(|(simple, best)| {
            format!("{} ({} wide, not {})", runs_name(plan, simple), width(simple), width(best))
        })
        .collect();
    if !simpler.is_empty() {
        lines.push(format!(
            "At constant power the driver has to change force and speed all the time. The best plans without it: {}.",
            simpler.join("; ")
        ));
    }
    if plan.candidates.iter().any(|run| (run.start_k - plan.start_k).abs() > 0.1) {
        lines.push(format!(
            "Runs that do not start at {} need the brake cooled or heated to that temperature, all of it.",
            value(plan.start_k, Quantity::Temperature)
        ));
    }
    lines
}

/// Where wide tables wrap.
const WRAP: u16 = 118;

/// A plan of tests, for a terminal.
pub fn rig_plan_terminal(plan: &PlanFinding) -> String {
    rig_plan(plan, Medium::Terminal)
}

/// A plan of tests, as Markdown.
pub fn rig_plan_markdown(plan: &PlanFinding) -> String {
    rig_plan(plan, Medium::Markdown)
}

fn rig_plan(plan: &PlanFinding, medium: Medium) -> String {
    let [now, _, deviation] = band(&plan.now);
    let most = plan.best.len();
    let mut text = medium.title(&format!(
        "Which runs on the rig are worth most? Up to {most}, {} combinations of {} candidates, proof load {}",
        plan.searched,
        plan.candidates.len(),
        value(plan.proof_load_n, Quantity::Force)
    ));
    text += &medium.paragraph(&format!(
        "Without a run P(any breach) of one brake lies within {now} (90 % credible interval, standard deviation \
         {deviation}); over all brakes it is {} by half spaces.",
        probability(plan.now.mean)
    ));
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (k, combinations) in plan.best.iter().enumerate() {
        for (rank, combination) in combinations.iter().enumerate().take(3) {
            let count = if rank == 0 { format!("{}", k + 1) } else { String::new() };
            let [ends, width, deviation] = band(&combination.band);
            rows.push(vec![count, runs_name(plan, combination), ends, width, deviation]);
        }
    }
    let header = ["runs", "the best of them", "expected 90 % interval of P", "width", "sd of P"];
    text += &medium.table(&header, 2..5, rows, Some(WRAP));
    let best: Vec<&Combination> = plan.best.iter().filter_map(|set| set.first()).collect();
    let cases: Vec<&[f64]> = best.iter().map(|c| c.remaining.as_slice()).collect();
    let counts: Vec<String> =
        (1..=best.len()).map(|n| format!("best {n} run{}", if n > 1 { "s" } else { "" })).collect();
    let header: Vec<&str> = ["standard deviation left of"]
        .into_iter()
        .chain(counts.iter().map(String::as_str))
        .collect();
    let rows = remaining_rows(&plan.parameters, &cases);
    text += &medium.table(&header, 1..header.len(), rows, None);
    let rows = plan.candidates.iter().map(|candidate| {
        let [ends, width, deviation] = band(&candidate.band);
        vec![
            run_name(candidate),
            value(candidate.duration_s, Quantity::Time),
            value(candidate.peak_force_n, Quantity::Force),
            value(candidate.peak_fluid_k, Quantity::Temperature),
            ends,
            width,
            deviation,
        ]
    });
    let header = [
        "each candidate alone",
        "duration",
        "peak load",
        "peak fluid",
        "90 % interval of P",
        "width",
        "sd",
    ];
    text += &medium.table(&header, 1..7, rows, None);
    let mut lines: Vec<String> =
        plan.refused.iter().map(|why| format!("not possible: {why}")).collect();
    lines.extend(
        plan.left_out
            .iter()
            .map(|name| format!("left out of P: {name}, whose design point was not found")),
    );
    lines.extend(practice(plan));
    lines.push(assumed(&plan.assumed));
    lines.push(format!("Instruments: {}.", instruments(&plan.instruments)));
    lines.push("The runs on the rig are by the quasi-steady model.".to_owned());
    lines.push(
        "Linear and normal about the card's medians; the model itself is taken as right. The order is that of \
         the reliability index's standard deviation."
            .to_owned(),
    );
    let blank = if medium == Medium::Terminal { "\n" } else { "" };
    text + blank + &lines.iter().map(|line| medium.line(line)).collect::<String>()
}
