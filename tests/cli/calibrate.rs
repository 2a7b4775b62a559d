//! `reeldown calibrate` on the shipped campaign, and `run` on the card that it writes.

use crate::program::{Place, reeldown};

const CAMPAIGN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/distributions/calibrated/campaign/");

fn run(name: &str) -> String {
    format!("{CAMPAIGN}{name}.csv")
}

#[test]
fn property_the_shipped_campaign_gives_a_card_that_run_can_use() {
    let place = Place::new("calibrate");
    let out = place.path().join("out").display().to_string();
    let (force, power, held) = (run("constant_force"), run("constant_power"), run("hold_out"));
    let common = ["--data", &force, "--data", &power, "--hold-out", &held, "--out", &out, "--json"];
    let small = ["--particles", "400", "--replicates", "4"];
    // A title with a line end must stay a title.
    let title = ["--set", "title=\"two\\nlines = 1\""];
    let arguments: Vec<&str> =
        ["calibrate"].into_iter().chain(common).chain(small).chain(title).collect();
    let finding = reeldown(&arguments).ended_with(0).json();
    assert_eq!(finding["accepted"], true);
    assert_eq!(finding["runs"].as_array().map(Vec::len), Some(3));
    let named = |name: &str| {
        let all = finding["parameters"].as_array().expect("parameters");
        all.iter().find(|p| p["name"] == name).expect("the parameter").clone()
    };
    // The truth is 1.07 and 770 W/K (tests/calibration/campaign.rs): within four posterior standard deviations.
    for (name, truth) in [("fluid.shear_factor", 1.07), ("thermal.fluid_rotor_conductance", 770.0)]
    {
        let posterior = named(name)["posterior"].clone();
        let (mean, sd) =
            (posterior[0].as_f64().expect("a mean"), posterior[1].as_f64().expect("an sd"));
        assert!((mean - truth).abs() < 4.0 * sd, "{name}: {mean} ± {sd}");
    }
    assert_eq!(named("brake.gap (each of 14)")["prior_dominated"], true);
    for file in
        ["report.md", "report.html", "findings.json", "posterior.parquet", "figures/shrinkage.svg"]
    {
        assert!(place.path().join("out").join(file).is_file(), "{file}");
    }
    // The runs say that they were made up, and so does all that comes of them.
    assert!(finding["runs"].as_array().expect("runs").iter().all(|run| run["synthetic"] == true));
    let text = |file: &str| String::from_utf8(place.bytes(&format!("out/{file}"))).expect("text");
    for file in ["report.md", "calibrated.toml", "calibrated_laws.toml"] {
        assert!(text(file).contains("synthetic"), "{file}");
    }
    // The same bytes again, on one thread.
    let card = std::fs::read(place.path().join("out/calibrated.toml")).expect("the card");
    let one: Vec<&str> = arguments.iter().copied().chain(["--threads", "1"]).collect();
    reeldown(&one).ended_with(0);
    assert!(std::fs::read(place.path().join("out/calibrated.toml")).expect("the card") == card);
    for card in ["calibrated.toml", "calibrated_laws.toml"] {
        let habe = concat!(env!("CARGO_MANIFEST_DIR"), "/distributions/habe.toml");
        let set = format!("card=[\"{habe}\", \"{out}/{card}\"]");
        let checked = reeldown(&["check", "--set", &set, "--json"]).ended_with(0).json();
        let inputs = checked["inputs"].as_array().expect("inputs");
        let shear = inputs.iter().find(|i| i["path"] == "fluid.shear_factor").expect("the input");
        let mean = shear["uncertain"]["mean"].as_f64().expect("a mean");
        // The nominal descent is of the brake that was measured.
        assert_eq!(shear["value"], shear["uncertain"]["mean"], "{card}");
        let posterior = named("fluid.shear_factor")["posterior"][0].as_f64().expect("a mean");
        assert!((mean - posterior).abs() < 1e-3, "{card}: {mean} {posterior}");
    }
}

#[test]
fn property_a_mistaken_unit_is_refused_with_its_name() {
    let place = Place::new("calibrate-unit");
    let text = std::fs::read_to_string(run("constant_force")).expect("the shipped run");
    let wrong = place.path().join("wrong.csv");
    std::fs::write(&wrong, text.replacen("force [lbf]", "force [N]", 1)).expect("a file");
    let wrong = wrong.display().to_string();
    let answer = reeldown(&["calibrate", "--data", &wrong]).ended_with(1);
    assert!(
        answer.err.contains("header that says lbf") && answer.err.contains("--accept"),
        "{}",
        answer.err
    );
}

#[test]
fn property_bad_options_say_what_was_expected() {
    let data = run("constant_force");
    for (arguments, said) in [
        (vec!["--sensor-sd", "sped=1 ft/s"], "only force, speed"),
        (vec!["--sensor-sd", "speed=1 lbf"], "--sensor-sd"),
        (vec!["--gain-sd", "force=-1 %"], "not negative"),
        (vec!["--gain-sd", "force=1 %", "--gain-sd", "force=2 %"], "stated twice"),
        (vec!["--offset-sd", "fluid=1 ft/s"], "--offset-sd"),
        (vec!["--discrepancy", "-1 %"], "positive"),
        (vec!["--drive", "power"], "force or its speed"),
        (vec!["--data", &data], "counts once"),
        (vec!["--hold-out", &data], "is no test of the calibration"),
        (vec!["--sensor-sd", "speed=1e-9 ft/s"], "is rounded to 0.001 ft/s"),
        (vec!["--set", "card=[]"], "list of cards is empty"),
    ] {
        let all: Vec<&str> =
            ["calibrate", "--data", &data].into_iter().chain(arguments.clone()).collect();
        let answer = reeldown(&all).ended_with(1);
        assert!(answer.err.contains(said), "{arguments:?}: {}", answer.err);
    }
}

/// A load cell that reads 3 % low and a thermometer that reads 5 K high: taken as exact they give another brake, surely;
/// stated as they are, the band over brakes is wide enough for it.
#[test]
fn property_instruments_that_err_widen_the_posterior_by_what_is_stated_of_them() {
    let place = Place::new("calibrate-instruments");
    let out = place.path().join("out").display().to_string();
    let (force, power) = (run("constant_force"), run("constant_power"));
    let finding = |stated: &[&str]| {
        let arguments = [
            &["calibrate", "--data", &force, "--data", &power, "--out", &out, "--json"][..],
            &["--particles", "400", "--replicates", "2"][..],
            stated,
        ]
        .concat();
        reeldown(&arguments).json()
    };
    let sd = |finding: &serde_json::Value, list: &str, name: &str| {
        let all = finding[list].as_array().expect("parameters");
        let found = all.iter().find(|p| p["name"].as_str().is_some_and(|n| n.starts_with(name)));
        found.map(|p| p["posterior"][1].as_f64().expect("a standard deviation"))
    };
    let strength = "brake strength";
    let exact: Vec<String> = ["force", "speed", "fluid", "housing"]
        .iter()
        .flat_map(|channel| {
            let quantity = if ["force", "speed"].contains(channel) { "gain" } else { "offset" };
            let zero = if quantity == "gain" { "0" } else { "0 K" };
            [format!("--{quantity}-sd"), format!("{channel}={zero}")]
        })
        .collect();
    let exact: Vec<&str> = exact.iter().map(String::as_str).collect();
    let exact = finding(&exact);
    let wide = finding(&["--gain-sd", "force=3 %", "--gain-sd", "speed=0"]);
    assert!(sd(&exact, "nuisances", "force: gain").is_none());
    // What a rig cannot tell apart from the brake's strength stays as it was stated, and widens the strength by it.
    let gain = sd(&wide, "nuisances", "force: gain").expect("a gain");
    assert!((0.015..0.035).contains(&gain), "{gain}");
    let sds = [&exact, &wide].map(|f| sd(f, "parameters", strength).expect("the strength"));
    assert!(sds[1] * sds[1] > sds[0] * sds[0] + 0.25 * gain * gain, "{sds:?} {gain}");
}

/// The second run's brake pays its line out 15 % faster: two brakes, whatever the sampler says.
#[test]
fn property_runs_of_two_brakes_are_doubted_and_give_no_card() {
    let place = Place::new("calibrate-two-brakes");
    let out = place.path().join("out").display().to_string();
    let text = std::fs::read_to_string(run("constant_power")).expect("the shipped run");
    let mut faster = String::new();
    for line in text.lines() {
        let mut fields: Vec<String> = line.split(", ").map(str::to_owned).collect();
        for place in [2, 3] {
            if let Some(number) = fields.get(place).and_then(|field| field.parse::<f64>().ok()) {
                fields[place] = format!("{:.3}", 1.15 * number);
            }
        }
        faster += &format!("{}\n", fields.join(", "));
    }
    let other = place.path().join("other.csv");
    std::fs::write(&other, faster).expect("a file");
    let (force, other) = (run("constant_force"), other.display().to_string());
    let small = ["--particles", "400", "--replicates", "4", "--json"];
    let base = ["calibrate", "--data", &force, "--data", &other, "--out", &out];
    let finding = reeldown(&[&base[..], &small[..]].concat()).ended_with(4).json();
    assert_eq!(finding["accepted"], false);
    let doubts = finding["doubts"].as_array().expect("doubts");
    let doubted = |what: &str| doubts.iter().any(|d| d.as_str().is_some_and(|d| d.contains(what)));
    assert!(doubted("is not of the brake that the other runs are of"), "{doubts:?}");
    let headline = finding["statements"][0].as_str().expect("a headline");
    assert!(headline.contains("in doubt"), "{headline}");
    assert!(!place.path().join("out/calibrated.toml").exists());
}
