//! What a driven rig run costs a lane: `cargo bench --bench driven_runs`.

use reeldown::descent::driven::{Drive, Record, Settings, predict_with};
use reeldown::descent::vector::InstructionSet;
use reeldown::physics::{Coefficients, Design, Parameter, Target};
use std::hint::black_box;
use std::time::Instant;

const MEMBERS: usize = 1024;

fn main() {
    let batch: Vec<Coefficients<f64>> = (0..MEMBERS)
        .map(|k| {
            let mut design = Design::baseline();
            let factor = 0.9 + 0.2 * k as f64 / MEMBERS as f64;
            design.set(Target::whole(Parameter::FluidShearFactor), factor);
            Coefficients::new(&design)
        })
        .collect();
    println!("microseconds a member and run of 200 s, one thread, {MEMBERS} members:");
    for every_s in [1.0, 0.1] {
        for (drive, value) in [(Drive::Force, 22e3), (Drive::Speed, 0.7)] {
            let record = Record::held(drive, value, 200.0, every_s).expect("a record");
            for set in InstructionSet::ALL {
                let mut predictions = Vec::new();
                let mut best = f64::INFINITY;
                for _ in 0..5 {
                    let begun = Instant::now();
                    let settings = Settings::default();
                    predict_with(set, &record, &settings, &batch, &mut predictions);
                    best = best.min(begun.elapsed().as_secs_f64());
                    black_box(&predictions);
                }
                let each = best / MEMBERS as f64 * 1e6;
                let name = drive.name();
                println!("{name:6} read every {every_s} s, {:9} {each:8.2}", set.name());
            }
        }
    }
}
