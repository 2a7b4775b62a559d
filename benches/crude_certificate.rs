//! The certificate behind the rare-event methods: crude Monte Carlo over the study of
//! `tests/fixtures/habe/` at two nominal viscosities, no table written.
//!
//! `cargo bench --bench crude_certificate -- [SAMPLES]` (default 10^8: about five minutes on two cores)
//! prints the counts as rows of the table in `reports/certificates/crude.md`.

use reeldown::campaign::{self, Progress};
use reeldown::reliability::breach_counts::BreachCounts;
use std::time::Instant;

#[path = "../tests/fixtures/habe.rs"]
mod habe;

fn main() {
    let wanted = std::env::args().skip(1).find_map(|argument| argument.parse::<u64>().ok());
    let samples = wanted.unwrap_or(100_000_000);
    println!("| viscosity | samples | limit | breaches | faults | probability | 95 % interval |");
    println!("| --- | ---: | --- | ---: | ---: | ---: | --- |");
    for viscosity in ["125000 cSt", "100000 cSt"] {
        let set = [
            format!("fluid.nominal_viscosity=\"{viscosity}\""),
            format!("sampling.samples={samples}"),
            // Not the seed of the published study: these samples are others.
            "sampling.seed=20261122".to_owned(),
        ];
        let study = habe::pinned(&set.each_ref().map(String::as_str));
        let mut counts = BreachCounts::new(study.limits.len()).expect("few limits");
        let begun = Instant::now();
        let mut sink = |table: reeldown::outcomes::OutcomeTable| {
            let margins: Vec<Vec<f64>> = study
                .limits
                .iter()
                .map(|limit| {
                    table.outcome(limit.outcome).iter().map(|&v| limit.margin_of(v)).collect()
                })
                .collect();
            let columns: Vec<&[f64]> = margins.iter().map(Vec::as_slice).collect();
            counts.push_margins(&columns)
        };
        campaign::run(&study, 0..samples, &Progress::default(), &mut sink).expect("a valid run");
        let seconds = begun.elapsed().as_secs_f64();
        for (i, limit) in study.limits.iter().enumerate() {
            let Some(seen) = counts.constraint(i) else { continue };
            let Some(earned) = seen.interval(0.95).ok() else { continue };
            let interval = earned.interval().map_or(String::new(), |interval| {
                format!("{:.3e} … {:.3e}", interval.lower, interval.upper)
            });
            println!(
                "| {viscosity} | {samples} | {} | {} | {} | {:.4e} | {interval} |",
                limit.name(),
                seen.breaches,
                seen.faults,
                seen.breaches as f64 / samples as f64,
            );
        }
        eprintln!("{viscosity}: {seconds:.0} s, {:.0} descents/s", samples as f64 / seconds);
    }
}
