//! What the data contradict: each other, the card, the noise that was found.

use super::AgreementFinding;
use crate::campaign::calibration::consistency::{PRIOR_LEVEL, RUN_LEVEL, WHITE_LEVEL};
use crate::campaign::calibration::{Calibration, Coordinate};
use crate::study::Study;
use crate::units::number;

/// The tests, and a sentence for each that fails.
pub(super) fn agreement(
    study: &Study,
    found: &Calibration<'_>,
) -> (Vec<AgreementFinding>, Vec<String>) {
    let (mut tests, mut doubts) = (Vec::new(), Vec::new());
    let mut add = |finding: AgreementFinding, doubt: String| {
        let test = finding.test;
        if test.p < finding.least {
            let p = number(test.p, 2);
            doubts.push(format!(
                "{doubt} (chi-squared {:.1} of {}, p {p})",
                test.statistic, test.degrees
            ));
        }
        tests.push(finding);
    };
    let consistency = &found.consistency;
    // So many chances of a false alarm share one level.
    let share = |level: f64, count: usize| level / count.max(1) as f64;
    let runs = &consistency.runs;
    for run in runs {
        let (against, doubt) = match run.held_out {
            true => ("the runs calibrated with", "is not what the runs calibrated with predict"),
            false => ("the other runs", "is not of the brake that the other runs are of"),
        };
        let doubt = format!(
            "{} {doubt}: another brake, another fluid, or an instrument that has moved",
            run.name
        );
        let (of, least) = (run.name.clone(), share(RUN_LEVEL, runs.len()));
        add(AgreementFinding { of, channel: None, against, test: run.test, least }, doubt);
    }
    let farthest = consistency.farthest.map_or(String::new(), |(coordinate, deviations)| {
        format!(
            "; farthest moved is {}, by {:.1} of its standard deviations",
            name(study, found, coordinate),
            deviations.abs()
        )
    });
    let doubt = format!("the posterior is not where the card says that the brake is{farthest}");
    let card = AgreementFinding {
        of: "posterior".to_owned(),
        channel: None,
        against: "the card",
        test: consistency.prior,
        least: PRIOR_LEVEL,
    };
    add(card, doubt);
    let white = &consistency.white;
    for channel in white {
        let name = channel.channel.name();
        let doubt = format!(
            "the errors of {name} in {} follow each other: the noise is not what it is taken for",
            channel.run
        );
        let finding = AgreementFinding {
            of: channel.run.clone(),
            channel: Some(name),
            against: "independent errors",
            test: channel.test,
            least: share(WHITE_LEVEL, white.len()),
        };
        add(finding, doubt);
    }
    for (channel, deviations) in &consistency.strays {
        doubts.push(format!(
            "the model strays from the {} by more than it was allowed ({:.1} prior standard deviations of the discrepancy's \
             logarithm): it does not describe these runs",
            channel.name(),
            deviations
        ));
    }
    (tests, doubts)
}

fn name(study: &Study, found: &Calibration<'_>, coordinate: Coordinate) -> String {
    let instrument = |k: usize| found.likelihood.systematic()[k].channel.name();
    match coordinate {
        Coordinate::Input(j) => study.inputs[j].target.path(),
        Coordinate::Gain(k) => format!("the gain of the {} instrument", instrument(k)),
        Coordinate::Offset(k) => format!("the offset of the {} instrument", instrument(k)),
        other => format!("{other:?}"),
    }
}
