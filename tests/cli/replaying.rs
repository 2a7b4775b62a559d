//! One sample of a run again, from its Parquet file alone.

use super::determinism::run;
use super::program::{Answer, Place, reeldown};
use reeldown::store::{OutcomesReader, OutcomesWriter};
use reeldown::study::Study;
use serde_json::Value;
use std::path::Path;

fn replay(path: &str, index: u64, arguments: &[&str]) -> Answer {
    reeldown(&[&["replay", path, "--index", &index.to_string()], arguments].concat())
}

#[test]
fn property_any_sample_comes_out_the_same_again() {
    let place = Place::new("replay");
    run(&place, "run", &["--samples", "3000", "--set", "brake.gap.sd=0.002 in"]).ended_with(3);
    let path = place.at("run/outcomes.parquet");
    for index in [0, 1, 1023, 1024, 2999] {
        let answer = replay(&path, index, &[]).ended_with(0);
        let said = format!("sample {index}, the same bits as its row");
        assert!(answer.out.contains(&said), "{}", answer.out);
        let object = replay(&path, index, &["--json"]).ended_with(0).json();
        assert_eq!(object["sample"], index);
        // The numbers of the file, read by the library with the columns of the embedded study.
        let study = Study::load(None, &[]).expect("the embedded study");
        let reader = OutcomesReader::open(Path::new(&path)).expect("a table");
        let table = reader.read(&study, index, 1).expect("a row");
        for (j, input) in study.inputs.iter().enumerate() {
            let column = input.target.column();
            assert_eq!(object[&column].as_f64(), Some(table.inputs.get(0, j)), "{column}");
        }
        let outcome = table.result(0).expect("no fault");
        for quantity in reeldown::descent::OutcomeQuantity::ALL {
            let column = quantity.column();
            assert_eq!(object[&column].as_f64(), Some(outcome.get(quantity)), "{column}");
        }
    }
}

#[test]
fn property_a_replay_needs_no_study_file() {
    let place = Place::new("moved");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = "title = \"moved\"\ncard = \"card.toml\"\n[limits]\ntime = { max = \"210 s\" }\n";
    let study = place.write("moved.toml", study);
    run(&place, "run", &[&study, "--samples", "50"]).ended_with(0);
    std::fs::remove_file(&study).expect("it is there");
    std::fs::remove_file(place.at("card.toml")).expect("it is there");
    let trace = place.at("trace.parquet");
    replay(&place.at("run/outcomes.parquet"), 49, &["--trace", &trace]).ended_with(0);
    assert!(Path::new(&trace).exists());
    replay(&place.at("run/outcomes.parquet"), 50, &[]).ended_with(1);
}

#[test]
fn property_an_index_beyond_the_run_is_refused() {
    let place = Place::new("index");
    run(&place, "run", &["--samples", "20"]);
    let answer = replay(&place.at("run/outcomes.parquet"), 20, &[]).ended_with(1);
    assert!(answer.err.contains("holds samples 0 to 19"), "{}", answer.err);
}

/// Where the eight bytes of a number stand in a file.
fn find(bytes: &[u8], number: f64) -> usize {
    let pattern = number.to_le_bytes();
    bytes.windows(8).position(|window| window == pattern).expect("the number is in the file")
}

#[test]
fn regression_a_changed_row_is_found_out() {
    let place = Place::new("tampered");
    run(&place, "run", &["--samples", "40"]);
    let path = place.at("run/outcomes.parquet");
    let time = replay(&path, 17, &["--json"]).ended_with(0).json()["time_s"].as_f64();
    let time = time.expect("a number");
    let mut bytes = place.bytes("run/outcomes.parquet");
    let at = find(&bytes, time);
    bytes[at..at + 8].copy_from_slice(&199.0f64.to_le_bytes());
    place.write("run/outcomes.parquet", &bytes);
    // Any row: it is the row group that is not to be believed.
    let says = "row group 0 (rows 0 to 39) is damaged";
    for index in [17, 16] {
        let answer = replay(&path, index, &[]).ended_with(1);
        assert!(answer.err.contains(says), "{}", answer.err);
    }
    for arguments in [&["--samples", "80", "--resume"][..], &["--samples", "40", "--resume"]] {
        let answer = run(&place, "run", arguments).ended_with(1);
        assert!(answer.err.contains(says), "{}", answer.err);
    }
    assert_eq!(place.bytes("run/outcomes.parquet"), bytes, "it is left to be looked at");
    let out = place.at("run");
    let answer = reeldown(&["compare", &out, &out]).ended_with(1);
    assert!(answer.err.contains(says), "{}", answer.err);
}

/// A table whose checksums hold, of rows that are not the study's: another build may have written it.
#[test]
fn property_rows_that_come_out_otherwise_are_not_believed() {
    let place = Place::new("untrusted");
    run(&place, "run", &["--samples", "400"]);
    let path = place.at("run/outcomes.parquet");
    let study = Study::load(None, &[]).expect("the embedded study");
    let reader = OutcomesReader::open(Path::new(&path)).expect("a table");
    let table = reader.read(&study, 0, 400).expect("its rows");
    let write = |changed: std::ops::Range<usize>| {
        let mut table = table.clone();
        for row in changed {
            let time = &mut table.outcomes.column_mut(0)[row];
            *time = f64::from_bits(time.to_bits() + 1);
        }
        let writer = OutcomesWriter::create(Path::new(&path), &study, reader.parentage());
        let mut writer = writer.expect("a writable place");
        writer.write(&[table]).expect("space");
        writer.finish().expect("space");
    };
    // The last row is always computed again; of a table that is wrong throughout, others are found as well.
    for changed in [399..400, 0..399] {
        write(changed);
        let answer = run(&place, "run", &["--samples", "800", "--resume"]).ended_with(1);
        assert!(answer.err.contains("computed again differs from its row"), "{}", answer.err);
    }
    let answer = replay(&path, 17, &[]).ended_with(1);
    assert!(answer.err.contains("sample 17 computed again differs"), "{}", answer.err);
    replay(&path, 399, &[]).ended_with(0);
    write(0..0);
    run(&place, "run", &["--samples", "800", "--resume"]).ended_with(3);
}

#[test]
fn property_what_is_not_a_run_is_refused_with_what_was_expected() {
    let place = Place::new("foreign");
    place.write("text.parquet", "time_s\n201.0\n");
    place.write("empty.parquet", "");
    place.write("magic.parquet", "PAR1\0\0\0\0PAR1");
    reeldown(&["descend", "--trace", &place.at("trace.parquet")]).ended_with(0);
    run(&place, "run", &["--samples", "20"]);
    let sensitivity = "run/sensitivity.parquet";
    let files =
        ["text.parquet", "empty.parquet", "magic.parquet", "trace.parquet", sensitivity, "", "no"];
    for name in files {
        let answer = replay(&place.at(name), 0, &[]).ended_with(1);
        let begins = ["error: cannot re"];
        assert!(begins.iter().any(|b| answer.err.starts_with(b)), "{name}: {}", answer.err);
        assert!(answer.err.contains("= help: "), "{name}: {}", answer.err);
        assert_eq!(answer.out, "");
    }
}

#[test]
fn property_a_damaged_file_is_an_error_and_never_a_panic() {
    let place = Place::new("damaged");
    run(&place, "run", &["--samples", "30"]);
    let whole = place.bytes("run/outcomes.parquet");
    // A linear congruential walk over the file: cut it, or flip one bit, footer twice as often.
    let footer = u32::from_le_bytes(whole[whole.len() - 8..][..4].try_into().expect("four bytes"));
    let mut walk = 1993u64;
    let mut below = |end: usize| {
        walk = walk.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (walk >> 33) as usize % end
    };
    for trial in 0..120 {
        let mut bytes = whole.clone();
        match trial % 4 {
            0 => bytes.truncate(below(whole.len())),
            1 => bytes[below(whole.len())] ^= 1 << below(8),
            _ => bytes[whole.len() - 9 - below(footer as usize)] ^= 1 << below(8),
        }
        let path = place.write("damaged.parquet", &bytes);
        let answer = replay(&path, below(30) as u64, &[]);
        assert!([0, 1].contains(&answer.code), "trial {trial}: {} {}", answer.code, answer.err);
        assert_eq!(answer.code == 1, answer.err.starts_with("error: "), "{}", answer.err);
    }
}

#[test]
fn property_a_replayed_trace_is_of_the_sample() {
    let place = Place::new("traced");
    run(&place, "run", &["--samples", "20"]);
    let trace = place.at("sample.parquet");
    let arguments = ["--json", "--trace", &trace];
    let object = replay(&place.at("run/outcomes.parquet"), 11, &arguments).ended_with(0).json();
    let times = reeldown::store::read_number_column(Path::new(&trace), "time_s").expect("times");
    let end = *times.last().expect("a trace");
    let time = object["time_s"].as_f64().expect("a number");
    // The trace is of the plain integrator at 1e-10; the row, of the study's at its 1e-6.
    assert!((end / time - 1.0).abs() < 1e-5, "{end} {time}");
    assert_eq!(object["fault"], Value::Null);
}
