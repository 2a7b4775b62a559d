//! `reeldown`: Monte Carlo uncertainty and reliability analysis of viscous-brake reel-downs.
//!
//! See `ARCHITECTURE.md` for the floors and what may import what.
//!
//! A study is a text that says what is asked, a card one that says what is uncertain:
//!
//! ```
//! use reeldown::analysis::{Options, run};
//! use reeldown::campaign::Progress;
//! use reeldown::findings::VerdictWord;
//! use reeldown::study::Study;
//!
//! let study = r#"
//!     title = "a reel-down within 210 s"
//!     card = "one-batch"
//!     model = "quasi-steady"
//!     limits.time = { max = "210 s" }
//!     requirement = { reliability = 0.95, confidence = 0.90 }
//!     sampling.samples = 2000
//!     sensitivity.base_samples = 0
//!     trade.samples = 0
//! "#;
//! let card = r#"
//!     title = "one batch of brakes"
//!     [brake.gap]
//!     law = "normal"
//!     mean = "0.062 in"
//!     sd = "0.001 in"
//!     known = "at build"
//!     source = "twelve brakes, measured"
//! "#;
//! let study = Study::from_texts(study, card)?;
//! let results = run(&study, &Options::default(), &Progress::default())?;
//! let findings = results.expect("nobody asked it to stop").findings;
//! assert_eq!(findings.verdict.word, VerdictWord::Met);
//!
//! let any = findings.probabilities.last().expect("one event");
//! let interval = any.interval.interval().expect("samples are independent");
//! println!("{}: between {} and {}", any.title, interval.lower, interval.upper);
//! # Ok::<(), reeldown::error::Error>(())
//! ```

#![warn(missing_docs)]

pub mod analysis;
pub mod calibration;
pub mod campaign;
pub mod cli;
pub mod descent;
pub mod error;
pub mod findings;
pub mod numerics;
pub mod outcomes;
pub mod physics;
pub mod reliability;
pub mod render;
pub mod sampling;
pub mod sensitivity;
pub mod store;
pub mod streams;
pub mod study;
pub mod uncertainty;
pub mod units;
