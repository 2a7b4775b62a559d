//! The laws that a card can name, and the keys that each takes.

/// The mean of a law that goes with the design's value.
pub(super) const NOMINAL: &str = "nominal";

/// What a law's key takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A value of the input's quantity.
    Point,
    /// A positive spread of the input's quantity; a temperature's is a difference.
    Spread,
    /// A positive pure number.
    Positive,
    /// A list of values of the input's quantity.
    Values,
    /// The name of a file of values.
    File,
    /// The name of a column in it.
    Column,
}

/// A key of a law.
pub(super) struct Term {
    pub key: &'static str,
    pub kind: Kind,
    pub description: &'static str,
}

/// A law, as a card writes it.
pub(super) struct LawInfo {
    pub name: &'static str,
    pub description: &'static str,
    /// The sets of keys that define it, each complete in itself.
    pub forms: &'static [&'static [&'static str]],
    /// Keys that may be added to any of them.
    pub optional: &'static [&'static str],
    /// Whether `lower` and `upper` are the law's own bounds; else they truncate it.
    pub bounded: bool,
}

const fn term(key: &'static str, kind: Kind, description: &'static str) -> Term {
    Term { key, kind, description }
}

/// Every key that some law takes.
pub(super) static TERMS: &[Term] = &[
    term("mean", Kind::Point, "mean; \"nominal\" is the design's value, wherever that goes"),
    term("median", Kind::Point, "median"),
    term("mode", Kind::Point, "most likely value"),
    term(
        "location",
        Kind::Point,
        "location; for weibull, gamma and exponential the lower end, 0 if absent",
    ),
    term("lower", Kind::Point, "lower end"),
    term("upper", Kind::Point, "upper end"),
    term("sd", Kind::Spread, "standard deviation"),
    term("scale", Kind::Spread, "scale"),
    term("cv", Kind::Positive, "standard deviation over the mean: \"8 %\""),
    term("log_sd", Kind::Positive, "standard deviation of the natural logarithm"),
    term("shape", Kind::Positive, "shape"),
    term("alpha", Kind::Positive, "first shape of the beta law"),
    term("beta", Kind::Positive, "second shape of the beta law"),
    term("values", Kind::Values, "observed values"),
    term("file", Kind::File, "file of observed values, relative to the card"),
    term("column", Kind::Column, "column of the file"),
    term(
        "readings",
        Kind::Values,
        "a few measured values, in place of the law's numbers: the law is then what they predict",
    ),
];

const fn law(
    name: &'static str,
    description: &'static str,
    forms: &'static [&'static [&'static str]],
    optional: &'static [&'static str],
    bounded: bool,
) -> LawInfo {
    LawInfo { name, description, forms, optional, bounded }
}

/// Every law.
pub(super) static LAWS: &[LawInfo] = &[
    law(
        "normal",
        "normal (Gaussian)",
        &[&["mean", "sd"], &["mean", "cv"], &["readings"], &["readings", "sd"]],
        &[],
        false,
    ),
    law(
        "lognormal",
        "the logarithm is normal",
        &[
            &["median", "cv"],
            &["median", "log_sd"],
            &["mean", "sd"],
            &["mean", "cv"],
            &["readings"],
            &["readings", "log_sd"],
        ],
        &[],
        false,
    ),
    law("uniform", "equally likely between its ends", &[&["lower", "upper"]], &[], true),
    law("triangular", "triangle over its ends", &[&["lower", "mode", "upper"]], &[], true),
    law("beta", "beta between its ends", &[&["alpha", "beta", "lower", "upper"]], &[], true),
    law("pert", "PERT: a smooth triangle", &[&["lower", "mode", "upper"]], &[], true),
    law("weibull", "Weibull of minima", &[&["shape", "scale"]], &["location"], false),
    law("gumbel", "Gumbel of maxima", &[&["mean", "sd"], &["location", "scale"]], &[], false),
    law(
        "gumbel-minimum",
        "Gumbel of minima",
        &[&["mean", "sd"], &["location", "scale"]],
        &[],
        false,
    ),
    law("gamma", "gamma", &[&["shape", "scale"], &["mean", "sd"]], &["location"], false),
    law("exponential", "exponential", &[&["mean"]], &["location"], false),
    law("empirical", "observed values", &[&["values"], &["file", "column"]], &[], false),
];

/// The keys of laws.
pub(super) fn law_keys() -> impl Iterator<Item = &'static str> {
    TERMS.iter().map(|term| term.key)
}

/// The keys that a law takes.
pub(super) fn keys_of(info: &LawInfo) -> Vec<&'static str> {
    let mut keys: Vec<&'static str> = Vec::new();
    for &key in info.forms.iter().copied().flatten().chain(info.optional) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys
}

/// What a law's key takes.
pub(super) fn kind_of(key: &str) -> Kind {
    TERMS.iter().find(|term| term.key == key).map_or(Kind::Point, |term| term.kind)
}
