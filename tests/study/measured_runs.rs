//! Measured runs: what is read, and what is said about files that cannot be.

use reeldown::descent::driven::Drive;
use reeldown::store::{Field, PARQUET, write_table};
use reeldown::study::measured_run::{Acceptance, MeasuredRun};
use std::sync::atomic::{AtomicUsize, Ordering};

const LBF: f64 = 4.4482216152605;

fn read(text: &str) -> Result<MeasuredRun, String> {
    MeasuredRun::from_csv("run.csv", text, Acceptance::default()).map_err(|e| e.to_string())
}

#[test]
fn property_columns_units_comments_and_quotes() {
    let text = "\u{feff}# pulled by truck 2\n\n \"Fluid [°F]\" , time [min], force[kN],line [ft]\r\n\
                60,0,26.5,0\n# a remark\n61.8, 0.5 ,25,\"4.5\"\n";
    let run = read(text).unwrap();
    assert_eq!(run.time_s, [0.0, 30.0]);
    assert_eq!(run.force_n.as_deref(), Some(&[26500.0, 25000.0][..]));
    assert_eq!(run.line_m.as_deref(), Some(&[0.0, 4.5 * 0.3048][..]));
    let fluid = run.fluid_k.as_ref().unwrap();
    assert!((fluid[1] - fluid[0] - 1.0).abs() < 1e-9 && run.speed_m_per_s.is_none());
    assert_eq!(run.preferred_drive(), Drive::Force);
    assert_eq!(run.record(Drive::Force).unwrap().values(), [26500.0, 25000.0]);
    assert!(run.record(Drive::Speed).unwrap_err().to_string().contains("`speed`"));
    // The digest is that of the numbers, not of how they are written.
    let other = "time [s],force [N],line [ft],fluid [°F]\n0,26500,0,60\n30,25e3,4.5,61.8\n";
    assert_eq!(read(other).unwrap().digest, run.digest);
    assert_ne!(read(&other.replace("61.8", "61.9")).unwrap().digest, run.digest);
}

#[test]
fn property_every_mistake_is_named_with_its_line() {
    let head = "time [s], force [lbf], speed [ft/s]\n";
    let good = "0,6000,1.5\n1,6000,1.5\n2,6000,1.5\n";
    let cases = [
        ("", "run.csv:1:1: the file holds no header"),
        ("time [s], force [lbf], velocity [ft/s]\n", "run.csv:1:24: unknown column `velocity`"),
        ("time [s], sped [ft/s]\n", "did you mean `speed`"),
        ("time [s], force [lbf], force [N]\n", "run.csv:1:24: column `force` is there twice"),
        ("time, force [lbf]\n", "run.csv:1:1: column `time` has no unit: expected time [min]"),
        ("time [s], force [lb]\n", "lb is a mass; write lbf"),
        ("time [s], force [bananas]\n", "unknown unit `bananas`"),
        ("force [lbf], speed [ft/s]\n", "run.csv:1:1: the header lacks the column `time`"),
        ("time [s], line [ft]\n", "the header lacks the column `force` or `speed`"),
        (head, "run.csv:1:1: the file holds 0 readings"),
        (&format!("{head}{good}3,6000\n"), "run.csv:5:1: 2 values where the header names 3"),
        (&format!("{head}{good}3,6000,\n"), "run.csv:5:8: the value of `speed` is missing"),
        (&format!("{head}{good}3,NaN,1.5\n"), "run.csv:5:3: the value of `force` is missing"),
        (&format!("{head}{good}3,x,1.5\n"), "run.csv:5:3: \"x\" is not a finite number"),
        (&format!("{head}{good}3,6000 lbf,1.5\n"), "run.csv:5:3: \"6000 lbf\" is not a finite"),
        (&format!("{head}{good}3,1e999,1.5\n"), "run.csv:5:3: \"1e999\" is not a finite number"),
        (&format!("{head}{good}3,-200,1.5\n"), "run.csv:5:3: a line cannot be pushed"),
        (&format!("{head}{good}2,6000,1.5\n"), "run.csv:5:1: the time 2 s is there twice"),
        (&format!("{head}{good}1.5,6000,1\n"), "run.csv:5:1: the time goes back from 2 s to 1.5 s"),
        (&format!("{head}{good}9,6000,1.5\n"), "run.csv:5:1: a gap of 7 s before this reading"),
        ("time [s];force [lbf]\n0;1\n", "columns are not separated by commas"),
        ("time [s], force [lbf], fluid [K]\n0,1,60\n1,1,-5\n", "run.csv:3:5: this temperature"),
    ];
    for (text, expected) in cases {
        let message = read(text).expect_err(expected);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
    let gap = format!("{head}{good}9,6000,1.5\n");
    let any = Acceptance { longest_step: f64::INFINITY };
    assert_eq!(MeasuredRun::from_csv("run.csv", &gap, any).unwrap().time_s.len(), 4);
}

/// A load cell at rest reads a little below zero, and a logger may change its rate: neither is a mistake.
#[test]
fn property_an_instrument_s_zero_and_two_logging_rates_are_no_mistakes() {
    let rest = "time [s], force [lbf], speed [ft/s]\n0,-2,0\n1,6000,1\n2,6000,1\n";
    let run = MeasuredRun::from_csv("run.csv", rest, Default::default()).unwrap();
    let force = run.force_n.as_ref().unwrap();
    assert!((force[0] + 2.0 * 4.448_221_615_260_5).abs() < 1e-12, "{}", force[0]);
    // It drives as nothing at all.
    assert_eq!(run.record(Drive::Force).unwrap().values()[0], 0.0);
    let mut rates = "time [s], force [lbf]\n".to_owned();
    let slow = (0..20).map(|k| f64::from(k) * 0.1).chain((2..40).map(f64::from));
    slow.for_each(|time| rates += &format!("{time}, 6000\n"));
    assert!(MeasuredRun::from_csv("run.csv", &rates, Default::default()).is_ok());
    // The same record with ten seconds lost in its slow part, and with two in its fast one.
    for lost in [
        "21, 6000\n22, 6000\n23, 6000\n24, 6000\n25, 6000\n",
        "0.5, 6000\n0.6, 6000\n0.7, 6000\n0.8, 6000\n0.9, 6000\n",
    ] {
        let gap = rates.replace("0.6000000000000001", "0.6").replace("0.7000000000000001", "0.7");
        assert!(gap.contains(lost), "{gap}");
        let gap = gap.replace(lost, "");
        let error = MeasuredRun::from_csv("run.csv", &gap, Default::default()).unwrap_err();
        assert!(error.to_string().contains("a gap of"), "{error}");
    }
}

#[test]
fn property_a_parquet_file_is_the_same_run() {
    let directory = std::env::temp_dir().join(format!("reeldown-measured-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let path = directory.join("run.parquet");
    let numbers = |values: &[f64]| Field::Number(values.iter().map(|&v| Some(v)).collect());
    let columns = |force: Field| {
        vec![
            ("time_s".to_owned(), numbers(&[0.0, 1.0])),
            ("tension_n".to_owned(), force),
            ("remark".to_owned(), Field::Text(vec![None, None])),
        ]
    };
    let load = || MeasuredRun::load(&path, Acceptance::default(), PARQUET);
    write_table(&path, columns(numbers(&[6000.0 * LBF, 5000.0 * LBF])), vec![]).unwrap();
    let run = load().unwrap();
    let csv = read("time [s], force [lbf]\n0,6000\n1,5000\n").unwrap();
    assert_eq!((run.digest, run.force_n), (csv.digest, csv.force_n));
    write_table(&path, columns(Field::Number(vec![Some(1.0), None])), vec![]).unwrap();
    let message = load().unwrap_err().to_string();
    assert!(message.contains("row 2 of column tension_n is missing"), "{message}");
    std::fs::write(&path, b"PAR1 nonsense").unwrap();
    assert!(load().is_err());
    std::fs::remove_file(&path).unwrap();
    let message = load().unwrap_err().to_string();
    assert!(message.contains("cannot read"), "{message}");
    std::fs::remove_dir_all(&directory).unwrap();
}

/// A run in a Parquet file under `name` with these columns beside `time_s` and `force_n`.
fn parquet(name: &str, more: Vec<(&str, Field)>) -> Result<MeasuredRun, String> {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let directory = format!("reeldown-run-{}-{call}", std::process::id());
    let directory = std::env::temp_dir().join(directory);
    std::fs::create_dir_all(&directory).unwrap();
    let path = directory.join(name);
    let numbers = |values: &[f64]| Field::Number(values.iter().map(|&v| Some(v)).collect());
    let mut columns = vec![
        ("time_s".to_owned(), numbers(&[0.0, 1.0])),
        ("force_n".to_owned(), numbers(&[6000.0, 5000.0])),
    ];
    columns.extend(more.into_iter().map(|(name, field)| (name.to_owned(), field)));
    write_table(&path, columns, vec![]).unwrap();
    let run = MeasuredRun::load(&path, Acceptance::default(), PARQUET);
    std::fs::remove_dir_all(&directory).unwrap();
    run.map_err(|error| error.to_string())
}

#[test]
fn regression_a_channel_that_is_misspelt_or_holds_no_numbers_is_not_passed_over() {
    // Issue 12: the run was calibrated without it, and P was 58.73 % in place of 76.18 %.
    let warm = || Field::Number(vec![Some(288.0), Some(290.0)]);
    let text = || Field::Text(vec![Some("288".to_owned()), Some("290".to_owned())]);
    for (column, field, expected) in [
        ("fluid_temperture_k", warm(), "did you mean `fluid_temperature_k`"),
        ("Fluid_Temperature_K", warm(), "did you mean `fluid_temperature_k`"),
        ("fluid_temperature_c", warm(), "did you mean `fluid_temperature_k`"),
        ("fluid_temperature_k", text(), "it holds text, not numbers"),
        ("fluid", warm(), "column `fluid` has no unit"),
        ("fluid [ft]", warm(), "column fluid [ft]: "),
    ] {
        let message = parquet("run.parquet", vec![(column, field)]).expect_err(column);
        assert!(message.contains(expected), "{column}: {message}");
    }
    let twice = vec![("fluid_temperature_k", warm()), ("fluid [K]", warm())];
    let message = parquet("run.parquet", twice).expect_err("twice");
    assert!(message.contains("both hold the fluid"), "{message}");
}

#[test]
fn property_other_columns_are_told_and_units_are_read() {
    let cold = Field::Number(vec![Some(14.85), Some(16.85)]);
    let remark = Field::Text(vec![None, None]);
    let more = vec![
        ("fluid [°C]", cold),
        ("remark", remark),
        ("skin_temperature_k", Field::Count(vec![1, 2])),
    ];
    // The ending may be written in capitals, or be another: the file says what it is.
    for name in ["RUN.PARQUET", "run.pq", "run.dat"] {
        let run = parquet(name, more.clone()).expect(name);
        assert_eq!(run.fluid_k, Some(vec![288.0, 290.0]));
        assert_eq!(run.unused, ["remark", "skin_temperature_k"]);
        assert!(
            run.note().is_some_and(|note| note.ends_with("not read: remark, skin_temperature_k"))
        );
    }
    assert_eq!(parquet("run.parquet", Vec::new()).unwrap().note(), None);
}
