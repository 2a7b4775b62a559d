//! The program from end to end: what is typed, printed, written, and the code it ends with.

mod acceptance;
mod artefacts;
mod calibrate;
mod checksums;
mod comparing;
mod dependence;
mod determinism;
mod directories;
mod disk;
mod doors;
mod errors;
mod few_breaches;
mod inspection;
mod interruption;
mod listed;
mod notes;
mod program;
mod published;
mod readers;
mod replaying;
mod rig;
mod shards;
mod sweeping;
mod tighten;
mod together;
mod verdicts;
