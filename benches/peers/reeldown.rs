//! The members that the peers are measured on, with this program's results and speed on them, as one JSON
//! object: `cargo bench --bench peers -- FILE`. Called by `peers.py`, which says what it is for.

use std::time::Instant;

use reeldown::descent::vector::{Settings, descend, instruction_set};
use reeldown::descent::{Fault, Model, reference};
use reeldown::physics::GRAVITY;
use serde_json::json;

#[path = "../../tests/truth/vector_members.rs"]
mod members;

const MEMBERS: usize = 128;
/// Copies of the members in the timed batch, so that it fills the lanes as an ensemble does.
const COPIES: usize = 8;
const TURNS: usize = 40;

fn main() {
    let batch = members::default_study(MEMBERS);
    // A member that thins with shear would need another right-hand side in every peer.
    assert!(members::stress(1).len() == 1 && batch.iter().all(|c| !c.fluid.shear_thinning));
    let exact: Vec<_> = batch
        .iter()
        .map(|c| reference::descend(c, Model::Dynamic, 1e-10).expect("the members are possible"))
        .collect();
    let many: Vec<_> = (0..COPIES).flat_map(|_| batch.iter().copied()).collect();
    let mut ours = Vec::new();
    for tolerance in [1e-4, 1e-5, 1e-6] {
        let settings = Settings { tolerance };
        let mut out = vec![Err(Fault::NotFinite); many.len()];
        let mut best = f64::INFINITY;
        for _ in 0..TURNS {
            let start = Instant::now();
            descend(Model::Dynamic, &settings, &many, &mut out);
            best = best.min(start.elapsed().as_secs_f64());
        }
        let error = out.iter().zip(&exact).fold(0.0f64, |worst, (got, want)| {
            let got = got.as_ref().expect("the members can be integrated");
            // Time, final velocity, final fluid temperature: what every peer can report.
            [0, 1, 7]
                .iter()
                .fold(worst, |worst, &n| worst.max((got.values[n] / want.values[n] - 1.0).abs()))
        });
        ours.push(json!({
            "tolerance": tolerance,
            "error": error,
            "descents_per_s": many.len() as f64 / best,
        }));
    }
    let rows: Vec<_> = batch
        .iter()
        .map(|c| {
            let heat = &c.thermal;
            json!([
                c.reel.line_length_m,
                c.reel.full_radius_squared_m2,
                c.reel.squared_radius_slope_m,
                c.reel.inertia_kg_m2,
                c.fluid.torque_per_speed_nms,
                c.fluid.viscosity_temperature_k,
                c.fluid.averaging_offset,
                heat.fluid_capacity_j_per_k,
                heat.rotor_capacity_j_per_k,
                heat.housing_capacity_j_per_k,
                heat.fluid_rotor_w_per_k,
                heat.fluid_housing_w_per_k,
                heat.rotor_housing_w_per_k,
                c.payload.weight_n,
                c.payload.extraction_n_per_m,
                c.balloon.moving_mass_kg,
                c.balloon.net_lift_n,
                c.balloon.drag_factor_kg_per_m,
                c.balloon.rise_speed_m_per_s,
                c.initial_temperature_k,
                GRAVITY,
            ])
        })
        .collect();
    let truth: Vec<_> = exact.iter().map(|o| [o.values[0], o.values[1], o.values[7]]).collect();
    let all = json!({
        "instruction_set": instruction_set(),
        "coefficients": rows,
        "exact": truth,
        "reeldown": ours,
    });
    match std::env::args().skip(1).find(|argument| !argument.starts_with("--")) {
        Some(path) => std::fs::write(path, all.to_string()).expect("the file can be written"),
        None => println!("{all}"),
    }
}
