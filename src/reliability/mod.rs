//! The sciences of breach probability: what counts of breaches show, and how to find rare breaches.
//!
//! Nothing here has heard of brakes. Counts, sorted margins and limit states come in; estimates with
//! the intervals that they earned, or the reason why there is none, go out.

// What counts and sorted margins show.
pub mod allocation;
pub mod binomial_tails;
pub mod breach_counts;
pub mod cheaper_plans;
pub mod demonstration;
pub mod jackknife;
pub mod nested;
pub mod normal_tolerance;
pub mod paired;
pub mod probability;
pub mod quantiles;
pub mod replicates;
pub mod unpaired;

// Limit states in standard-normal space and the methods that walk them.
pub mod adaptive;
pub mod agreement;
pub mod confidence_sequence;
pub mod cross_entropy;
pub mod crossings;
pub mod crude;
pub mod design_point;
mod design_search;
pub mod directional;
pub mod draws;
pub mod estimate;
pub mod event;
pub mod form;
pub mod importance;
pub mod limit_state;
pub mod line;
mod line_groups;
mod line_root;
pub mod linearisation;
pub mod log_replicates;
pub mod mises_fisher_nakagami;
pub mod multinormal;
pub mod quasi_newton;
mod searched_lines;
pub mod sorm;
pub mod subset;
pub mod system;
pub mod vectors;
pub mod weighted;
