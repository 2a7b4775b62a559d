//! Small runs of the default study, computed once for all tests.

use reeldown::analysis::{self, Options, Results};
use reeldown::campaign::Progress;
use std::sync::OnceLock;

fn run(settings: &[&str]) -> Results {
    let quick = ["trade.samples=0", "reliability.methods=[]"];
    let settings = settings.iter().chain(&quick);
    let study = crate::habe::pinned(&settings.copied().collect::<Vec<_>>());
    let command = Some("reeldown run".to_owned());
    let options = Options { command, ..Options::default() };
    analysis::run(&study, &options, &Progress::default()).unwrap().expect("a whole run")
}

/// Independent samples, with sensitivity indices.
pub fn independent() -> &'static Results {
    static SAMPLE: OnceLock<Results> = OnceLock::new();
    SAMPLE.get_or_init(|| run(&["sampling.samples=600", "sensitivity.base_samples=64"]))
}

/// A replicated design without sensitivity indices.
pub fn replicated() -> &'static Results {
    static SAMPLE: OnceLock<Results> = OnceLock::new();
    SAMPLE.get_or_init(|| {
        run(&[
            "sampling.design=latin-hypercube",
            "sampling.samples=400",
            "sampling.replicates=4",
            "sensitivity.base_samples=0",
        ])
    })
}
