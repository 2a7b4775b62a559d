//! Studies and cards: what is read, what is refused and how it is said.

mod corpus;
mod measured_runs;
mod mutations;
mod overrides;
mod parquet_files;
mod schema;
mod shipped;
mod sources;
mod together;
mod units;
