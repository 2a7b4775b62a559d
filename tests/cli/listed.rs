//! Laws of listed values: what a study with atoms may be asked.

use super::program::{Place, reeldown};

const STUDY: &str = "title = \"listed\"\ncard = \"card.toml\"\n[limits]\ntime = { max = \"230 s\" }\n\
    [sampling]\nsamples = 256\n[sensitivity]\nbase_samples = 0\n[trade]\nsamples = 0\n\
    [epistemic]\nouter = 0\n[reliability]\nmethods = [\"form\", \"sorm\", \"line-sampling\", \"subset-simulation\"]\n";

/// A fluid capacity by its law, and a shear factor that was observed at `values`.
fn probabilities(name: &str, values: &str) -> Vec<(String, bool, String)> {
    let place = Place::new(name);
    let card = format!(
        "[thermal.fluid_capacity]\nlaw = \"normal\"\nmean = \"4000 J/K\"\nsd = \"200 J/K\"\n\
         known = \"never\"\nsource = \"assumed\"\n\
         [fluid.shear_factor]\nlaw = \"empirical\"\nvalues = {values}\nknown = \"never\"\nsource = \"counted\"\n"
    );
    place.write("card.toml", &card);
    let study = place.write("study.toml", STUDY);
    let found = reeldown(&["run", &study, "--out", &place.at("run"), "--json"]).json();
    let estimates = found["rare"][0]["estimates"].as_array().expect("estimates").clone();
    estimates
        .iter()
        .map(|estimate| {
            let text = |key: &str| estimate[key].as_str().unwrap_or_default().to_owned();
            let diagnostics = estimate["diagnostics"].to_string();
            (text("method"), estimate["probability"].is_null(), diagnostics)
        })
        .collect()
}

#[test]
fn property_methods_that_go_by_slopes_have_no_number_where_a_value_has_a_probability_of_its_own() {
    let listed = probabilities("listed-atoms", "[0.9, 0.9, 0.9, 1.0, 1.0, 1.1]");
    let of = |found: &[(String, bool, String)], method: &str| {
        let found = found.iter().find(|(name, ..)| name.contains(method));
        found.map(|(_, none, why)| (*none, why.clone())).expect(method)
    };
    for method in ["form", "sorm", "line"] {
        let (none, why) = of(&listed, method);
        assert!(none && why.contains("fluid.shear_factor has values with a probability"), "{why}");
    }
    assert!(!of(&listed, "subset").0);
    // Values without ties are spread between their neighbours: there are slopes.
    let spread = probabilities("listed-spread", "[0.9, 0.92, 0.95, 1.0, 1.02, 1.1]");
    assert!(!of(&spread, "form").0, "{spread:?}");
}
