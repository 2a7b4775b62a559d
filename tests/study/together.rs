//! Inputs that are drawn together from the rows of a file.

use super::sources::{card_alone, study_with};
use reeldown::physics::Target;
use reeldown::physics::parameters::Parameter;
use reeldown::study::{Input, Study};

const POSTERIOR: &str =
    "[[joint]]\nfile = \"posterior.csv\"\nknown = \"never\"\nsource = \"test\"\n";

const SHEAR: &str = "[fluid.shear_factor]\nlaw = \"lognormal\"\nmedian = 1\ncv = \"8 %\"\n\
                     known = \"never\"\nsource = \"test\"\n";

/// The shipped card and then this one.
fn after_the_shipped(card: &str) -> Study {
    let study = "title = \"HABE\"\ncard = [\"habe.toml\", \"card.toml\"]\n";
    study_with(study, card, &[]).expect("a study")
}

fn input<'s>(study: &'s Study, path: &str) -> &'s Input {
    study.inputs.iter().find(|input| input.target.path() == path).expect(path)
}

fn drawn(study: &Study) -> Vec<Vec<String>> {
    let paths = |places: &[usize]| places.iter().map(|&j| study.inputs[j].target.path()).collect();
    study.drawn_together.iter().map(|together| paths(&together.inputs)).collect()
}

#[test]
fn property_a_later_joint_sample_takes_the_place_of_earlier_laws() {
    let study = after_the_shipped(POSTERIOR);
    assert_eq!(drawn(&study), [["fluid.shear_factor", "thermal.fluid_capacity"]]);
    let shear = input(&study, "fluid.shear_factor");
    assert_eq!(
        shear.law_text,
        "drawn together with another input from the 4 rows of posterior.csv"
    );
    assert_eq!(shear.group.as_deref(), Some("joint sample of 2 parameters (posterior.csv)"));
    // Kilojoules of the header in SI.
    let capacity = input(&study, "thermal.fluid_capacity");
    assert_eq!(capacity.marginal.support(), (3900.0, 4200.0));
    assert_eq!(study.joint.samples().len(), 1);
    assert!(
        study.notes.iter().any(|note| note.contains("log_posterior, note")),
        "{:?}",
        study.notes
    );
    let names: Vec<String> = study.file_digests().into_iter().map(|(name, _)| name).collect();
    assert_eq!(names.last().map(String::as_str), Some("posterior.csv"));
}

#[test]
fn property_a_later_law_takes_an_input_out_of_a_joint_sample() {
    let cards = [("a.toml", POSTERIOR), ("b.toml", SHEAR)];
    let study = super::sources::with_cards("card = [\"a.toml\", \"b.toml\"]", &cards).unwrap();
    assert_eq!(drawn(&study), [["thermal.fluid_capacity"]]);
    assert_eq!(input(&study, "fluid.shear_factor").marginal.law().family(), "lognormal");
    // The other order: the sample is drawn from.
    let study = super::sources::with_cards("card = [\"b.toml\", \"a.toml\"]", &cards).unwrap();
    assert_eq!(drawn(&study), [["fluid.shear_factor", "thermal.fluid_capacity"]]);
}

#[test]
fn property_single_gaps_may_be_drawn_together_beside_the_others() {
    let gaps = "[[joint]]\nfile = \"gaps.csv\"\nknown = \"at build\"\nsource = \"test\"\n";
    let study = after_the_shipped(gaps);
    assert_eq!(drawn(&study), [["brake.gap[1]", "brake.gap[2]"]]);
    let gap = |k: usize| study.inputs.iter().filter(|i| i.target == Target::gap(k)).count();
    assert!((0..14).all(|k| gap(k) == 1));
    let first = input(&study, "brake.gap[1]").marginal.support();
    assert_eq!(first, (0.061 * 0.0254, 0.064 * 0.0254));
}

#[test]
fn property_the_digest_knows_the_rows_and_nothing_else_of_the_file() {
    let digest = |card: &str| card_alone(card).expect("a study").digest();
    let named = "[[joint]]\nfile = \"posterior.csv\"\ncolumns = { \"fluid.shear_factor\" = \
                 \"fluid.shear_factor\", \"thermal.fluid_capacity\" = \"thermal.fluid_capacity\" }\n\
                 known = \"never\"\nsource = \"other words\"\n\
                 group = \"joint sample of 2 parameters (posterior.csv)\"\n";
    assert_eq!(digest(POSTERIOR), digest(named));
    let swapped = named.replace("\"fluid.shear_factor\" =", "\"fluid.viscosity_coefficient\" =");
    assert_ne!(digest(POSTERIOR), digest(&swapped));
    // The same two marginals, but not drawn together.
    let apart = "[[joint]]\nfile = \"posterior.csv\"\ncolumns = { \"fluid.shear_factor\" = \
                 \"fluid.shear_factor\" }\nknown = \"never\"\nsource = \"test\"\ngroup = \"a\"\n\
                 [[joint]]\nfile = \"posterior.csv\"\ncolumns = { \"thermal.fluid_capacity\" = \
                 \"thermal.fluid_capacity\" }\nknown = \"never\"\nsource = \"test\"\ngroup = \"a\"\n";
    let together = POSTERIOR.replace("source", "group = \"a\"\nsource");
    assert_ne!(digest(&together), digest(apart));
}

#[test]
fn property_the_accepted_card_is_understood() {
    let study = card_alone(include_str!("accepted/card_joint.toml")).expect("a study");
    assert_eq!(
        drawn(&study),
        [["fluid.shear_factor", "thermal.fluid_capacity"], ["brake.gap[1]", "brake.gap[2]"]]
    );
    let parameter = Parameter::from_path("fluid.shear_factor").expect("a parameter");
    assert!(study.inputs.iter().any(|input| input.target == Target::whole(parameter)));
}

#[test]
fn property_a_calibrated_card_after_others_has_a_prior() {
    let calibrated = format!("calibrated_from = \"four runs\"\n{POSTERIOR}");
    let study = after_the_shipped(&calibrated);
    assert_eq!(study.calibrated_from.as_deref(), Some("four runs"));
    let prior = study.prior.as_deref().expect("a prior");
    assert!(prior.drawn_together.is_empty() && prior.prior.is_none());
    assert_eq!(prior.inputs.len(), study.inputs.len());
    assert_eq!(prior.digest(), after_the_shipped("title = \"nothing\"\n").digest());
    // Alone, or without the key, nothing is told apart.
    assert!(card_alone(&calibrated).expect("a study").prior.is_none());
    assert!(after_the_shipped(POSTERIOR).prior.is_none());
}
