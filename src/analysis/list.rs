//! The analyses of a run, one line each: the only place where they are listed.

use super::sampling::Sampling;
use crate::campaign::analysis::find;
use crate::campaign::calibrated::CalibratedOutcomes;
use crate::campaign::epistemic::EpistemicOutcomes;
use crate::campaign::exact::ExactOutcomes;
use crate::campaign::given_sample::GivenSample;
use crate::campaign::known::KnownOutcomes;
use crate::campaign::model_form::ModelFormOutcomes;
use crate::campaign::screening::ScreeningOutcomes;
use crate::campaign::shapley::ShapleyOutcomes;
use crate::campaign::trade::TradeOutcomes;
use crate::campaign::{Analysis, Found, PickFreezeOutcomes, Progress, RareEvent, Run};
use crate::study::Study;

/// From a list of analyses what they found, their computation in that order, and their costs.
macro_rules! analyses {
    ($($(#[$doc:meta])* $name:ident: $outcomes:ty,)*) => {
        /// What the analyses of a study found, or why they did not.
        #[derive(Debug)]
        pub struct Analyses<'a> {
            $($(#[$doc])* pub $name: Found<$outcomes>,)*
        }

        impl<'a> Analyses<'a> {
            /// Computes every analysis of a study whose samples have been run. `None` if `progress` asks for a stop.
            pub fn compute(
                study: &'a Study,
                sampling: &'a Sampling,
                progress: &'a Progress,
            ) -> Option<Self> {
                let run = Run { study, record: &sampling.record, progress };
                Some(Analyses { $($name: find::<$outcomes>(run)?,)* })
            }
        }

        /// Every analysis by name, with the descents that it takes of a study, about, or why the study has none of it.
        pub fn costs<'a>(study: &'a Study) -> Vec<(&'static str, Found<u64>)> {
            vec![$((<$outcomes as Analysis>::NAME, <$outcomes as Analysis>::cost(study)),)*]
        }
    };
}

analyses! {
    /// The pick-freeze design.
    pick_freeze: PickFreezeOutcomes,
    /// The events that the samples saw too rarely.
    rare: Vec<RareEvent>,
    /// The first samples read again, and those that breach.
    given: GivenSample,
    /// The screening.
    screening: ScreeningOutcomes,
    /// The walks of the Shapley effects.
    shapley: ShapleyOutcomes,
    /// The trade of tolerances.
    trade: TradeOutcomes<'a>,
    /// What becomes known when.
    known: KnownOutcomes,
    /// The nested descents.
    epistemic: EpistemicOutcomes,
    /// The exact values moved a little.
    exact: ExactOutcomes,
    /// The study under the cards before its calibrated one.
    calibrated: CalibratedOutcomes,
    /// The first samples by the other thermal model too.
    model_form: ModelFormOutcomes,
}
