//! The keys of studies and cards: the one list that parsing, the JSON Schema and suggestions share.

/// A key, for the parser and for the schema.
pub(super) struct KeyInfo {
    /// The key.
    pub name: &'static str,
    /// What it means, in one line.
    pub description: &'static str,
}

const fn key(name: &'static str, description: &'static str) -> KeyInfo {
    KeyInfo { name, description }
}

/// Keys at the top of a study.
pub(super) static STUDY: &[KeyInfo] = &[
    key("title", "what the study is called"),
    key(
        "card",
        "the card that says what is uncertain, relative to this file; of a list, later cards win",
    ),
    key("model", "the equations that are integrated"),
    key("design", "nominal values that differ from the baseline, by dotted path"),
    key("limits", "what a descent must not breach: outcome = { max = …, min = …, source = … }"),
    key("requirement", "what the verdict is held against"),
    key("sampling", "how the inputs are sampled"),
    key("numerics", "how accurately a descent is integrated"),
    key("sensitivity", "how the sensitivity indices are estimated"),
    key("reliability", "how small probabilities are estimated"),
    key("trade", "how the trade of tolerances is computed"),
    key("tighten", "what a plan of tightenings is to reach, and by which means"),
    key("epistemic", "how aleatory and epistemic uncertainty are separated"),
];

/// Keys of `[epistemic]`.
pub(super) static EPISTEMIC: &[KeyInfo] = &[
    key("outer", "sets of values of what is not known; 0 leaves the analysis out"),
    key("inner", "descents with each set, over what varies; an even number"),
];

/// Keys of `[requirement]`.
pub(super) static REQUIREMENT: &[KeyInfo] = &[
    key("reliability", "smallest acceptable probability that no limit is breached"),
    key("confidence", "confidence with which the reliability must be demonstrated"),
    key(
        "of",
        "what the reliability is required of: the average over all possible brakes (the default), or this brake, whose own \
         reliability must be that large with probability `confidence` over the epistemic inputs",
    ),
];

/// Keys of `[sampling]`.
pub(super) static SAMPLING: &[KeyInfo] = &[
    key("design", "the design of experiment"),
    key("samples", "number of descents in all, over all replicates"),
    key("seed", "seed of every random stream"),
    key("replicates", "independent replicates of a randomised design; the error is read from them"),
    key("until", "what ends the sampling, in place of samples; design \"monte-carlo\" only"),
];

/// Keys of `until`.
pub(super) static UNTIL: &[KeyInfo] = &[
    key(
        "relative_error",
        "farthest reach of the interval of any breach, as a share of its estimate",
    ),
    key("decided", "true: the requirement is shown to be met or missed"),
    key("confidence", "confidence of the intervals at every look; the requirement's if left out"),
    key("budget", "number of descents after which sampling ends in any case"),
];

/// Keys of `[numerics]`.
pub(super) static NUMERICS: &[KeyInfo] = &[key(
    "tolerance",
    "relative error asked of the outcomes of a descent; 1e-6, of the detailed models 1e-4, unless stated",
)];

/// Keys of `[sensitivity]`.
pub(super) static SENSITIVITY: &[KeyInfo] = &[
    key("base_samples", "rows of each block of the pick-freeze design; 0 leaves the indices out"),
    key("bootstrap", "bootstrap resamples behind each interval"),
    key("pairs", "pairs of inputs or groups whose second-order index is asked for"),
];

/// Keys of `[reliability]`.
pub(super) static RELIABILITY: &[KeyInfo] = &[key(
    "methods",
    "the methods that estimate small probabilities, besides the samples themselves",
)];

/// Keys of `[trade]`.
pub(super) static TRADE: &[KeyInfo] =
    &[key("samples", "samples behind each point of a trade curve; 0 leaves the trade out")];

/// Keys of `[tighten]`.
pub(super) static TIGHTEN: &[KeyInfo] = &[
    key("target", "largest acceptable probability of any breach; without one, the requirement's"),
    key("samples", "samples on which a plan is searched for"),
    key("design", "design values that may move: path = [smallest, largest]"),
];

/// Keys of a grade.
pub(super) static GRADE: &[KeyInfo] =
    &[key("spread", "spread as a factor of the card's"), key("cost", "what the grade costs")];

/// Keys of one limit.
pub(super) static LIMIT: &[KeyInfo] = &[
    key("max", "the outcome may be at most this"),
    key("min", "the outcome must be at least this"),
    key("source", "where the limit comes from; a limit that is assumed says so"),
];

/// Keys at the top of a card that are not parameters.
pub(super) static CARD: &[KeyInfo] = &[
    key("title", "what the card is called"),
    key("description", "what the card is about"),
    key("correlation", "dependence between two inputs, as a Gaussian copula"),
    key(
        "calibrated_from",
        "what a calibrated card was made from; a run then tells what it changed of the cards before it",
    ),
    key(
        "joint",
        "inputs that are drawn together from the rows of a file, such as a posterior sample",
    ),
];

/// Keys of a joint sample.
pub(super) static JOINT: &[KeyInfo] = &[
    key("file", "CSV or Parquet file of equally likely rows, relative to the card"),
    key(
        "columns",
        "the column of each input, by dotted path; without it, every column named by a dotted path",
    ),
    key("sha256", "SHA-256 of the file, which is refused if it is another"),
    key("known", "when the values become known"),
    key(
        "nature",
        "\"varies\" from flight to flight, or \"unknown\": fixed for this brake, but not known",
    ),
    key("source", "where the sample comes from"),
    key("group", "what the sample is called as one factor of sensitivities"),
    key(
        "cost",
        "what tightening costs: a number for each halving of the spread, a list of grades, or \"none\"",
    ),
];

/// Keys of an input that do not belong to its law.
pub(super) static INPUT: &[KeyInfo] = &[
    key("law", "the law of the distribution"),
    key("known", "when the value becomes known"),
    key(
        "nature",
        "\"varies\" from flight to flight, or \"unknown\": fixed for this brake, but not known",
    ),
    key("source", "where the distribution comes from"),
    key("group", "the factor to which the input belongs in grouped sensitivities"),
    key(
        "cost",
        "what tightening costs: a number for each halving of the spread, a list of grades, or \"none\"",
    ),
    key("each_surface", "one independent input per working surface (brake.gap only)"),
    key("lower", "lower end: the law's own bound, or where it is truncated"),
    key("upper", "upper end: the law's own bound, or where it is truncated"),
    key("truncation_lower", "where a law that has its own lower bound is truncated"),
    key("truncation_upper", "where a law that has its own upper bound is truncated"),
];

/// Keys of a correlation.
pub(super) static CORRELATION: &[KeyInfo] = &[
    key("between", "the two inputs, by dotted path"),
    key("normal", "correlation of the copula's normal variables"),
    key("spearman", "Spearman's rank correlation"),
    key("kendall", "Kendall's rank correlation"),
    key("source", "where the coefficient comes from"),
];
