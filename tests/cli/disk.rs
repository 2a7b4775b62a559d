//! Places that cannot be written to: one message, nothing half-made left behind.

use super::program::{Place, program, reeldown};
use std::process::Command;

/// A small run into a directory.
fn run_into(out: &str) -> super::program::Answer {
    let set = "sensitivity.base_samples=0";
    reeldown(&["run", "--quiet", "--samples", "500", "--set", set, "--out", out])
}

#[test]
fn property_a_place_that_is_no_directory_is_an_error_with_help() {
    let place = Place::new("no-directory");
    let file = place.write("file", "");
    for out in [file.as_str(), &format!("{file}/deeper"), "/dev/null/x"] {
        let answer = run_into(out).ended_with(1);
        assert!(answer.err.starts_with("error: cannot make the directory"), "{}", answer.err);
        assert!(answer.err.contains("--out"), "{}", answer.err);
    }
    assert!(place.unfinished().is_empty());
}

/// Proc takes no directories, not even from root.
#[cfg(target_os = "linux")]
#[test]
fn property_an_unwritable_directory_is_an_error_with_help() {
    for out in ["/proc/reeldown", "/proc"] {
        let answer = run_into(out).ended_with(1);
        assert!(answer.err.starts_with("error: cannot "), "{}", answer.err);
        assert!(answer.err.contains("= help: "), "{}", answer.err);
    }
    let trace = ["descend", "--trace", "/proc/trace.parquet"];
    assert!(reeldown(&trace).ended_with(1).err.contains("cannot write /proc/trace.parquet"));
}

#[test]
fn property_a_directory_in_place_of_a_file_is_found_before_the_work() {
    let place = Place::new("obstacle");
    for name in ["outcomes.parquet", "report.md", "findings.json", "provenance.json"] {
        let directory = place.at(&format!("for-{name}"));
        std::fs::create_dir_all(format!("{directory}/{name}")).expect("a directory");
        let answer = run_into(&directory).ended_with(1);
        let said = format!("error: cannot write {directory}/{name}: it is a directory");
        assert!(answer.err.starts_with(&said), "{}", answer.err);
        let entries = std::fs::read_dir(&directory).expect("a directory").count();
        assert_eq!(entries, 1, "nothing was written beside it");
    }
    let answer = reeldown(&["descend", "--trace", &place.at("")]).ended_with(1);
    assert!(answer.err.contains("it is a directory"), "{}", answer.err);
}

/// A device is not replaced by a file: a rename onto one would do away with it.
#[cfg(unix)]
#[test]
fn property_a_device_is_not_replaced() {
    let answer = reeldown(&["descend", "--trace", "/dev/null"]).ended_with(1);
    assert!(answer.err.contains("it is not a regular file"), "{}", answer.err);
}

#[cfg(target_os = "linux")]
#[test]
fn property_standard_output_on_a_full_disk_is_an_error() {
    for arguments in [&["check"][..], &["descend", "--json"], &["man"], &["schema"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full");
        let output = program().args(arguments).stdout(full).output().expect("the program starts");
        let answer = super::program::Answer::of(output).ended_with(1);
        assert!(answer.err.contains("cannot write to standard output"), "{}", answer.err);
    }
}

/// A file system of a few pages, if this process may mount one.
struct TinyDisk {
    place: Place,
}

impl TinyDisk {
    fn mount(name: &str, kib: u32) -> Option<TinyDisk> {
        let place = Place::new(name);
        let size = format!("size={kib}k");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &size, "tmpfs"])
            .arg(place.path())
            .output()
            .is_ok_and(|output| output.status.success());
        mounted.then_some(TinyDisk { place })
    }
}

impl Drop for TinyDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.place.path()).status();
    }
}

/// Limits the size of the files that a command line may write, in blocks of 512 bytes, as a disk that
/// fills up would; the signal that comes with the limit is ignored, so that the write itself fails.
#[cfg(unix)]
fn with_file_limit(blocks: u32, arguments: &str) -> super::program::Answer {
    let binary = env!("CARGO_BIN_EXE_reeldown");
    let line = format!("trap '' XFSZ; ulimit -f {blocks}; exec {binary} {arguments}");
    let output = Command::new("sh").args(["-c", &line]).output().expect("sh runs");
    super::program::Answer::of(output)
}

#[cfg(unix)]
#[test]
fn property_a_write_that_fails_part_way_leaves_nothing_unfinished() {
    let place = Place::new("limited");
    let out = place.at("run");
    let set = "--set sensitivity.base_samples=0";
    // 64 KiB: less than the table of 2000 samples, about 600 KiB.
    let answer = with_file_limit(128, &format!("run --samples 2000 {set} --out {out}"));
    let answer = answer.ended_with(1);
    assert!(answer.err.starts_with("error: cannot write "), "{}", answer.err);
    assert!(answer.err.contains("outcomes.parquet"), "{}", answer.err);
    assert!(answer.err.contains("free some space"), "{}", answer.err);
    assert_eq!(answer.out, "");
    assert!(place.unfinished().is_empty(), "{:?}", place.unfinished());
    assert!(!place.path().join("run/outcomes.parquet").exists());
    let trace = with_file_limit(16, &format!("descend --trace {}", place.at("t.parquet")));
    assert!(trace.ended_with(1).err.contains("t.parquet"));
    assert!(place.unfinished().is_empty(), "{:?}", place.unfinished());
}

#[test]
fn property_a_full_disk_is_an_error_and_an_earlier_run_survives_it() {
    let Some(disk) = TinyDisk::mount("tiny", 6144) else {
        println!("skipped: no file system can be mounted here (it takes root)");
        return;
    };
    let place = &disk.place;
    run_into(&place.at("run")).ended_with(3);
    let before = place.bytes("run/outcomes.parquet");
    let set = "sensitivity.base_samples=0";
    let out = place.at("run");
    let answer =
        reeldown(&["run", "--samples", "60000", "--set", set, "--out", &out]).ended_with(1);
    assert!(answer.err.contains("No space left on device"), "{}", answer.err);
    assert_eq!(place.bytes("run/outcomes.parquet"), before);
    assert!(place.unfinished().is_empty(), "{:?}", place.unfinished());
}
