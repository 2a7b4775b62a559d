//! What is kept of a run on disk: Parquet tables, and files that are whole or not there.
//!
//! The only place that says polars.

mod atomic;
mod checksums;
mod column_file;
mod directory;
mod footer;
mod journal;
mod outcomes_file;
mod parquet;
mod reader;

pub use atomic::{AtomicFile, refuse_obstacle, write_bytes, write_text};
pub use column_file::{PARQUET, read_number_column};
pub use directory::{Contents, ResultDirectory, refuse_unfinished, verify_listed};
pub use journal::UnfinishedTable;
pub use outcomes_file::{FIRST_SAMPLE, OutcomesReader, OutcomesWriter, Parentage};
pub use parquet::{Field, write_table};
