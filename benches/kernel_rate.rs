//! Descents a second of the vector integrator on one thread, over members that are read from a file.
//!
//! `cargo bench --bench kernel_rate -- MEMBERS.csv OUT_DIRECTORY MODEL:TOLERANCE…`
//!
//! The head of the file names its columns as `outcomes.parquet` does; values are SI. Each case prints one
//! JSON object and leaves time, final velocity and peak fluid temperature of every member in
//! `OUT_DIRECTORY/MODEL-TOLERANCE.f64` (little-endian rows of three), for `benches/peers/run.py`, which
//! judges their errors exactly as it judges those of the peers.

use reeldown::descent::vector::{self, Settings};
use reeldown::descent::{Fault, Model, OutcomeQuantity};
use reeldown::physics::parameters::PARAMETERS;
use reeldown::physics::{Coefficients, Design, Target};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const REPEATS: usize = 7;
/// A repeat goes over the members until this much time is gone.
const REPEAT_S: f64 = 0.25;
const WANTED: [OutcomeQuantity; 3] =
    [OutcomeQuantity::Time, OutcomeQuantity::FinalVelocity, OutcomeQuantity::PeakFluidTemperature];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [members, directory, cases @ ..] = arguments.as_slice() else {
        println!("usage: kernel_rate MEMBERS.csv OUT_DIRECTORY MODEL:TOLERANCE…");
        return;
    };
    let batch = read(members);
    for case in cases {
        let (model, tolerance) = case.split_once(':').expect("a case is MODEL:TOLERANCE");
        measure(&batch, model, tolerance, Path::new(directory));
    }
}

fn measure(batch: &[Coefficients<f64>], name: &str, text: &str, directory: &Path) {
    let model = Model::ALL.into_iter().find(|m| m.name() == name).expect("a model's name");
    let settings = Settings { tolerance: text.parse().expect("a tolerance is a number") };
    let mut results = vec![Err(Fault::NotFinite); batch.len()];
    let counts = vector::descend(model, &settings, batch, &mut results);

    let mut wall_s = Vec::new();
    let mut processor_s = Vec::new();
    for _ in 0..REPEATS {
        let (begun, busy) = (Instant::now(), processor_time_s());
        let mut rounds = 0;
        while rounds == 0 || begun.elapsed().as_secs_f64() < REPEAT_S {
            black_box(vector::descend(model, &settings, black_box(batch), &mut results));
            rounds += 1;
        }
        let descents = f64::from(rounds) * batch.len() as f64;
        wall_s.push(begun.elapsed().as_secs_f64() / descents);
        processor_s.push((processor_time_s() - busy) / descents);
    }

    let mut bytes = Vec::new();
    for result in &results {
        for quantity in WANTED {
            let value = result.map_or(f64::NAN, |outcome| outcome.get(quantity));
            bytes.extend_from_slice(&value.to_le_bytes());
        }
    }
    std::fs::write(directory.join(format!("{name}-{text}.f64")), bytes).expect("room for a file");
    println!(
        "{{\"model\": \"{name}\", \"tolerance\": {text}, \"members\": {}, \"wall_s\": {:e}, \
         \"processor_s\": {:e}, \"steps\": {:.2}, \"instruction_set\": \"{}\"}}",
        batch.len(),
        median(wall_s),
        median(processor_s),
        counts.attempts as f64 / counts.descents as f64,
        vector::instruction_set(),
    );
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Time this thread has spent on a processor, s; 0 where the system does not tell.
fn processor_time_s() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    told.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).map_or(0.0, |ns| ns * 1e-9)
}

fn read(path: &str) -> Vec<Coefficients<f64>> {
    let text = std::fs::read_to_string(path).expect("the members' file");
    let mut lines = text.lines();
    let targets: Vec<Target> =
        lines.next().expect("a head").split(',').map(|column| target(column.trim())).collect();
    lines
        .map(|line| {
            let mut design = Design::baseline();
            for (&target, value) in targets.iter().zip(line.split(',')) {
                design.set(target, value.trim().parse().expect("a number"));
            }
            Coefficients::new(&design)
        })
        .collect()
}

fn target(column: &str) -> Target {
    let surfaces = Design::<f64>::baseline().surfaces();
    let gaps = (0..surfaces).map(Target::gap);
    let whole = PARAMETERS.iter().map(|info| Target::whole(info.parameter));
    gaps.chain(whole).find(|t| t.column() == column).unwrap_or_else(|| panic!("no input {column}"))
}
