//! The marginal distribution that a card's statement makes.
//!
//! This file and `correlation` alone know how `crate::uncertainty` is called.

use super::card::Statement;
use super::document::{Key, Node, Table, Value};
use super::empirical::{listed, observed};
use super::files::Files;
use super::laws::{Kind, LAWS, LawInfo, NOMINAL, keys_of, kind_of, law_keys};
use super::mistakes::all;
use super::read;
use super::values::{check_possible, written};
use crate::error::{Error, Result};
use crate::physics::design::Target;
use crate::physics::parameters::{Parameter, ParameterInfo};
use crate::uncertainty::{Law, Marginal, Readings};
use crate::units::{self, Quantity, number};

/// What a statement's law became.
pub(super) struct Understood {
    pub marginal: Marginal,
    /// As written.
    pub text: String,
    /// In SI with exact numbers.
    pub canonical: String,
    /// The readings that the law was made from.
    pub readings: Option<Readings>,
    /// Whether its mean is the design's nominal value, whatever that is.
    pub about_nominal: bool,
}

/// One value of a law with where it was written.
struct Given<'n> {
    key: &'static str,
    value: f64,
    node: &'n Node,
}

/// The marginal distribution of a statement about an input whose nominal value, SI, is `nominal`.
///
/// # Errors
/// A diagnostic: unknown law or key, keys missing or too many, an impossible number, no probability
/// between the ends of a truncation.
pub(super) fn understand(
    statement: &Statement,
    nominal: f64,
    files: &mut dyn Files,
) -> Result<Understood> {
    let entries = read::table(&statement.node, "law = \"normal\"")?;
    let any = |name: &str| entries.iter().find(|(key, _)| key.name == name).map(|(_, node)| node);
    let names: Vec<&str> = LAWS.iter().map(|info| info.name).collect();
    let Some(law_node) = any("law") else {
        let problem = format!("{} lacks the key `law`", statement.target.path());
        return Err(statement
            .key
            .place
            .error(problem, "expected law = \"normal\", or another law"));
    };
    let find = |name: &str| LAWS.iter().find(|info| info.name == name);
    let info = read::choice(law_node, "law", &names, find)?;
    check_keys(statement, entries, info)?;
    let form = choose_form(entries, info, law_node)?;
    let parameter = statement.target.parameter.info();
    let reader = Reader { parameter, info, entries, nominal };
    let mut canonical = info.name.to_owned();
    let mut readings = None;
    let (law, error_place) = if info.name == "empirical" {
        let (values, node) = observed(parameter, &|key| reader.entry(key), files)?;
        canonical.push_str(&format!(" values={}", super::digest::of_numbers(&values)));
        (Law::empirical(values, None), node)
    } else if form.contains(&"readings") {
        let (values, node) = reader.readings()?;
        let given = reader.given(form)?;
        canonical.push_str(&format!(" readings={}", super::digest::of_numbers(&values)));
        for Given { key, value, .. } in &given {
            canonical.push_str(&format!(" {key}={value:e}"));
        }
        let known = given.first().map(|given| given.value);
        let found = Readings::new(&values, known, info.name == "lognormal");
        let law = found.as_ref().map(Readings::predictive).map_err(Clone::clone);
        readings = found.ok();
        (law, node)
    } else {
        let given = reader.given(form)?;
        for Given { key, value, .. } in &given {
            canonical.push_str(&format!(" {key}={value:e}"));
        }
        (reader.construct(form, &given), law_node)
    };
    let law = law.map_err(|error| at(error_place, error, info))?;
    let (low, high) = reader.truncation()?;
    for (name, end) in [("truncation_lower", &low), ("truncation_upper", &high)] {
        if let Some((value, _)) = end {
            canonical.push_str(&format!(" {name}={value:e}"));
        }
    }
    let value = |end: &End<'_>| end.map(|(value, _)| value);
    let end_place = high.or(low).map_or(law_node, |(_, node)| node);
    let marginal = Marginal::new(law, value(&low), value(&high)).map_err(|_| {
        let expected = "expected bounds between which the law has positive probability";
        end_place.place.error("the truncated distribution has zero probability", expected)
    })?;
    let text = reader.text(form, readings.as_ref());
    let about_nominal = reader.entry("mean").is_some_and(is_nominal);
    Ok(Understood { marginal, text, canonical, readings, about_nominal })
}

/// A numerical routine's complaint, shown where its argument was written.
fn at(node: &Node, error: Error, info: &LawInfo) -> Error {
    match error {
        Error::Argument(message) => {
            node.place.error(message, format!("expected valid parameters of the law {}", info.name))
        }
        other => other,
    }
}

fn check_keys(statement: &Statement, entries: &Table, info: &LawInfo) -> Result<()> {
    let mut names = keys_of(info);
    let ends =
        if info.bounded { ["truncation_lower", "truncation_upper"] } else { ["lower", "upper"] };
    names.extend(ends);
    names.extend(["law", "known", "nature", "source", "group", "cost"]);
    let is_gap = statement.target == Target::whole(Parameter::BrakeGap);
    for (key, _) in entries {
        let name = key.name.as_str();
        // Where it does not belong, `each_surface` has a message of its own.
        if names.contains(&name) || name == "each_surface" {
            continue;
        }
        if law_keys().any(|other| other == name) || name.starts_with("truncation_") {
            let problem = format!("`{name}` is not a parameter of the law {}", info.name);
            let own: Vec<&str> = keys_of(info).into_iter().chain(ends).collect();
            return Err(key.place.error(problem, read::one_of(&own, '`')));
        }
        if is_gap {
            names.push("each_surface");
        }
        let section = format!(" of an input with the law {}", info.name);
        return Err(read::unknown_key(key, &section, &names));
    }
    Ok(())
}

/// The form whose keys are all given, and no other's.
fn choose_form(
    entries: &Table,
    info: &LawInfo,
    law_node: &Node,
) -> Result<&'static [&'static str]> {
    let defining = |key: &str| info.forms.iter().any(|form| form.contains(&key));
    let is_optional = |key: &str| info.optional.contains(&key);
    let given: Vec<&Key> = entries
        .iter()
        .map(|(key, _)| key)
        .filter(|key| defining(&key.name) && !is_optional(&key.name))
        .collect();
    let fits = |form: &&[&str]| {
        form.len() == given.len() && given.iter().all(|key| form.contains(&key.name.as_str()))
    };
    if let Some(form) = info.forms.iter().find(|form| fits(form)) {
        return Ok(form);
    }
    let forms: Vec<String> = info.forms.iter().map(|form| with_commas(form)).collect();
    let expected = format!("expected {}", forms.join("; or "));
    // The form that could still be completed names what is missing.
    let completable =
        info.forms.iter().find(|form| given.iter().all(|key| form.contains(&key.name.as_str())));
    match (completable, given.last()) {
        (Some(form), _) => {
            let missing: Vec<&str> = form
                .iter()
                .copied()
                .filter(|name| !given.iter().any(|key| key.name == *name))
                .collect();
            let problem = format!("the law {} lacks {}", info.name, with_commas(&missing));
            Err(law_node.place.error(problem, expected))
        }
        (None, Some(key)) => {
            let others: Vec<&str> = given
                .iter()
                .map(|other| other.name.as_str())
                .filter(|name| *name != key.name)
                .collect();
            let problem = format!(
                "the law {} cannot take `{}` with {}",
                info.name,
                key.name,
                with_commas(&others)
            );
            Err(key.place.error(problem, expected))
        }
        (None, None) => Err(law_node.place.error("the law has no numbers", expected)),
    }
}

fn with_commas(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// An end of a truncation, if there is one, with where it was written.
type End<'n> = Option<(f64, &'n Node)>;

struct Reader<'n> {
    parameter: &'static ParameterInfo,
    info: &'static LawInfo,
    entries: &'n Table,
    nominal: f64,
}

/// Whether a value is written as the design's.
fn is_nominal(node: &Node) -> bool {
    matches!(&node.value, Value::String(text) if text.trim() == NOMINAL)
}

impl<'n> Reader<'n> {
    fn entry(&self, name: &str) -> Option<&'n Node> {
        self.entries.iter().find(|(key, _)| key.name == name).map(|(_, node)| node)
    }

    fn number(&self, key: &'static str, node: &'n Node) -> Result<Given<'n>> {
        let quantity = self.parameter.quantity;
        let value = match kind_of(key) {
            Kind::Spread => self.spread(node)?,
            Kind::Positive => read::quantity(node, Quantity::Number)?,
            _ if key == "mean" && is_nominal(node) => self.nominal,
            _ => read::quantity(node, quantity)?,
        };
        match kind_of(key) {
            Kind::Spread | Kind::Positive if value <= 0.0 => {
                let problem = format!("{key} = {} is impossible", written(node));
                return Err(node.place.error(problem, "expected a positive number"));
            }
            Kind::Point if key != "location" => self.check_possible(key, value, node)?,
            _ => {}
        }
        Ok(Given { key, value, node })
    }

    /// The readings, and where they were written.
    fn readings(&self) -> Result<(Vec<f64>, &'n Node)> {
        match self.entry("readings") {
            Some(node) => Ok((listed(self.parameter, node)?, node)),
            // The form has been chosen by its keys.
            None => Err(Error::argument("the law has no readings")),
        }
    }

    fn spread(&self, node: &Node) -> Result<f64> {
        let quantity = self.parameter.quantity.of_difference();
        match &node.value {
            Value::String(text) if text.contains('%') && quantity != Quantity::Number => {
                let problem = "a percentage is not a standard deviation";
                let help = "a coefficient of variation is written cv = \"5 %\"".to_owned();
                let expected = format!(
                    "expected {}, such as \"{}\"",
                    quantity.described(),
                    quantity.example()
                );
                Err(node.place.error_with(problem, expected, Some(help)))
            }
            _ => read::quantity(node, quantity),
        }
    }

    fn check_possible(&self, key: &str, value: f64, node: &Node) -> Result<()> {
        check_possible(self.parameter, key, value, node)
    }

    /// The numbers of a form, in its order, and of the optional keys that are there.
    fn given(&self, form: &'static [&'static str]) -> Result<Vec<Given<'n>>> {
        let keys = form.iter().chain(self.info.optional).filter(|key| **key != "readings");
        let given = all(keys.filter_map(|key| Some(self.number(key, self.entry(key)?))))?;
        let find = |key: &str| given.iter().find(|given| given.key == key);
        let increasing = |low: &str, high: &str, strictly: bool| match (find(low), find(high)) {
            (Some(a), Some(b)) if a.value > b.value || strictly && a.value == b.value => {
                let relation = if strictly { "less than" } else { "at most" };
                let problem = format!("{low} and {high} are in the wrong order");
                let expected = format!(
                    "expected {low} = {} to be {relation} {high} = {}",
                    written(a.node),
                    written(b.node)
                );
                Err(b.node.place.error(problem, expected))
            }
            _ => Ok(()),
        };
        if self.info.bounded {
            increasing("lower", "upper", true)?;
            increasing("lower", "mode", false)?;
            increasing("mode", "upper", false)?;
        }
        if !self.info.optional.is_empty() {
            increasing("location", "mean", true)?;
        }
        for key in ["median", "mean"] {
            if let (Some(Given { value, node, .. }), true) = (find(key), self.is_positive_law())
                && *value <= 0.0
            {
                let problem = format!(
                    "{key} = {} is impossible for the law {}",
                    written(node),
                    self.info.name
                );
                return Err(node.place.error(problem, "expected a positive number"));
            }
        }
        Ok(given)
    }

    /// Whether the law's mean must be positive: it is one of positive numbers.
    fn is_positive_law(&self) -> bool {
        self.info.name == "lognormal"
            || self.entry("location").is_none() && matches!(self.info.name, "gamma" | "exponential")
    }

    fn construct(&self, form: &[&str], given: &[Given<'n>]) -> Result<Law> {
        let value =
            |key: &str| given.iter().find(|given| given.key == key).map(|given| given.value);
        // `given` holds every key of the form; a missing optional location is 0.
        let of = |key: &str| value(key).unwrap_or(0.0);
        match (self.info.name, form) {
            ("normal", ["mean", "sd"]) => Law::normal(of("mean"), of("sd")),
            ("normal", _) => {
                let node = given.iter().find(|given| given.key == "cv").map(|given| given.node);
                self.check_ratio_scale(node)?;
                Law::normal(of("mean"), of("cv") * of("mean").abs())
            }
            ("lognormal", ["median", "cv"]) => Law::lognormal_median_cv(of("median"), of("cv")),
            ("lognormal", ["median", _]) => {
                Law::lognormal_median_log_sd(of("median"), of("log_sd"))
            }
            ("lognormal", ["mean", "sd"]) => Law::lognormal_mean_sd(of("mean"), of("sd")),
            ("lognormal", _) => Law::lognormal_mean_sd(of("mean"), of("cv") * of("mean")),
            ("uniform", _) => Law::uniform(of("lower"), of("upper")),
            ("triangular", _) => Law::triangular(of("lower"), of("mode"), of("upper")),
            ("beta", _) => Law::beta(of("alpha"), of("beta"), of("lower"), of("upper")),
            ("pert", _) => Law::pert(of("lower"), of("mode"), of("upper")),
            ("weibull", _) => Law::weibull(of("shape"), of("scale"), of("location")),
            ("gumbel", ["mean", _]) => Law::gumbel_mean_sd(of("mean"), of("sd")),
            ("gumbel", _) => Law::gumbel(of("location"), of("scale")),
            ("gumbel-minimum", ["mean", _]) => Law::gumbel_minimum_mean_sd(of("mean"), of("sd")),
            ("gumbel-minimum", _) => Law::gumbel_minimum(of("location"), of("scale")),
            ("gamma", ["mean", _]) => {
                // Moments above the location: shape = (mean/sd)², scale = sd²/mean.
                let (mean, sd) = (of("mean") - of("location"), of("sd"));
                Law::gamma((mean / sd) * (mean / sd), sd * (sd / mean), of("location"))
            }
            ("gamma", _) => Law::gamma(of("shape"), of("scale"), of("location")),
            _ => Law::exponential(of("mean") - of("location"), of("location")),
        }
    }

    /// A share of a temperature is a share of the distance from absolute zero, which nobody means.
    fn check_ratio_scale(&self, node: Option<&Node>) -> Result<()> {
        match node {
            Some(node) if self.parameter.quantity == Quantity::Temperature => {
                let problem = "cv is not meaningful for a temperature, whose zero is a convention";
                Err(node.place.error(problem, "expected sd, such as sd = \"10 °F\""))
            }
            _ => Ok(()),
        }
    }

    /// The ends between which the law is truncated, with where they were written.
    fn truncation(&self) -> Result<(End<'n>, End<'n>)> {
        let (low, high) = match self.info.bounded {
            true => ("truncation_lower", "truncation_upper"),
            false => ("lower", "upper"),
        };
        let end = |name: &str| -> Result<End<'n>> {
            match self.entry(name) {
                None => Ok(None),
                Some(node) => {
                    let value = read::quantity(node, self.parameter.quantity)?;
                    self.check_possible(name, value, node)?;
                    Ok(Some((value, node)))
                }
            }
        };
        let (lower, upper) = (end(low)?, end(high)?);
        if let (Some((lower, a)), Some((upper, b))) = (lower, upper)
            && lower >= upper
        {
            let problem = format!("{low} and {high} are in the wrong order");
            let expected =
                format!("expected {low} = {} to be less than {high} = {}", written(a), written(b));
            return Err(b.place.error(problem, expected));
        }
        Ok((lower, upper))
    }

    /// The law as written: "normal, mean 0.062 in, sd 0.003 in, lower 0.053 in".
    fn text(&self, form: &[&str], readings: Option<&Readings>) -> String {
        let mut text = self.info.name.to_owned();
        if let Some(readings) = readings {
            let quantity = self.parameter.quantity;
            let centre = units::engineering(readings.centre(), quantity);
            let (kind, sd) = match readings.is_logarithmic() {
                true => ("median", format!("log_sd {}", number(readings.sd(), 3))),
                false => {
                    let sd = units::engineering(readings.sd(), quantity.of_difference());
                    ("mean", format!("sd {sd}"))
                }
            };
            let known = if readings.has_known_sd() { "known " } else { "" };
            text = format!(
                "what {} {} readings predict, {kind} {centre}, {known}{sd}",
                readings.count(),
                self.info.name
            );
        }
        let truncation: &[&str] = &["lower", "upper", "truncation_lower", "truncation_upper"];
        for key in form.iter().chain(self.info.optional).chain(truncation) {
            let listed = truncation.contains(key) && form.contains(key) && self.info.bounded;
            let repeated = listed && text.contains(&format!(", {key} "));
            if let (Some(node), false) = (self.entry(key), repeated) {
                match key {
                    &"readings" => {}
                    &"sd" | &"log_sd" if readings.is_some() => {}
                    &"values" => text.push_str(", observed values of the card"),
                    _ => text.push_str(&format!(", {key} {}", written(node))),
                }
            }
        }
        text
    }
}
