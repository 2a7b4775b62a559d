//! Every resolved value of a study with where it comes from, for `reeldown check`.

use super::{Correlation, Known, Nature, Study};
use crate::physics::design::Target;
use crate::physics::parameters::{PARAMETERS, Parameter};
use crate::uncertainty::Measure;
use crate::units::{self, Quantity};

/// One value of the design, resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedParameter {
    /// Where it goes.
    pub target: Target,
    /// Dotted path.
    pub path: String,
    /// Letter in the equations.
    pub symbol: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Kind of quantity.
    pub quantity: Quantity,
    /// Nominal value, SI.
    pub value: f64,
    /// Nominal value as an engineer reads it: "450 °F (505.372 K)".
    pub text: String,
    /// Where the nominal value comes from: the source of the baseline, the study file, an option.
    pub source: String,
    /// The law it follows, if it is uncertain.
    pub uncertain: Option<UncertainLaw>,
}

/// The law of an uncertain parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainLaw {
    /// The law as written.
    pub law: String,
    /// Mean, SI.
    pub mean: f64,
    /// Standard deviation, SI.
    pub sd: f64,
    /// Where the law comes from.
    pub source: String,
    /// When the value becomes known.
    pub known: Known,
    /// Whether it varies from flight to flight or is fixed and not known.
    pub nature: Nature,
    /// The factor of grouped sensitivities.
    pub group: Option<String>,
    /// How many inputs follow it: the surfaces that share a statement.
    pub inputs: usize,
}

impl Study {
    /// Every parameter in the order of [`PARAMETERS`]; a gap of its own follows the gap as a whole.
    ///
    /// The gaps of one statement are one row; a surface with a value or a law of its own has a row.
    pub fn resolved(&self) -> Vec<ResolvedParameter> {
        let mut rows = Vec::new();
        for info in &PARAMETERS {
            rows.push(self.row(Target::whole(info.parameter)));
            if info.parameter == Parameter::BrakeGap {
                let own = |surface: &usize| {
                    let target = Target::gap(*surface);
                    let stated = self.stated.iter().any(|stated| stated.target == target);
                    let law = self.inputs.iter().any(|input| {
                        input.target == target && input.group.as_deref() != Some(info.path)
                    });
                    stated || law
                };
                let surfaces = (0..self.design.surfaces()).filter(own);
                rows.extend(surfaces.map(|surface| self.row(Target::gap(surface))));
            }
        }
        rows
    }

    fn row(&self, target: Target) -> ResolvedParameter {
        let info = target.parameter.info();
        let value = self.design.at(target);
        let stated = self.stated.iter().find(|stated| stated.target == target);
        let whole = Target::whole(target.parameter);
        let inherited = || self.stated.iter().find(|stated| stated.target == whole);
        let own = self.inputs.iter().find(|input| input.target == target);
        let measured = own.filter(|own| {
            !own.about_nominal && self.prior.is_some() && own.marginal.mean() == value
        });
        let source = match (stated.or_else(inherited), measured) {
            (Some(stated), _) => format!("{}: {}", stated.origin, stated.text),
            (None, Some(own)) => format!("mean of its law: {}", own.source),
            (None, None) => info.source.to_owned(),
        };
        let members: Vec<_> = self
            .inputs
            .iter()
            .filter(|input| {
                let shared = input.group.as_deref() == Some(info.path);
                input.target == target
                    || target == whole && shared && input.target.parameter == target.parameter
            })
            .collect();
        let uncertain = members.first().map(|input| UncertainLaw {
            law: input.law_text.clone(),
            mean: input.marginal.mean(),
            sd: input.marginal.sd(),
            source: input.source.clone(),
            known: input.known,
            nature: input.nature,
            group: input.group.clone(),
            inputs: members.len(),
        });
        ResolvedParameter {
            target,
            path: target.path(),
            symbol: info.symbol,
            description: info.description,
            quantity: info.quantity,
            value,
            text: units::engineering(value, info.quantity),
            source,
            uncertain,
        }
    }
}

/// A statement of dependence, for a person.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedCorrelation {
    /// Paths of the two inputs; both `brake.gap` where one statement is about pairs of surfaces.
    pub between: (String, String),
    /// How many pairs of inputs it is about.
    pub pairs: usize,
    /// The coefficient as stated, −1 … 1, with its kind; a Gaussian copula has the dependence.
    pub measure: Measure,
    /// Where it comes from.
    pub source: String,
}

impl ResolvedCorrelation {
    /// The inputs in words.
    pub fn inputs(&self) -> String {
        let (a, b) = &self.between;
        match self.pairs {
            1 => format!("{a} and {b}"),
            pairs => format!("{pairs} pairs of surfaces of {a}"),
        }
    }
}

impl Study {
    /// The correlations of the inputs; like ones of pairs of surfaces are one.
    pub fn resolved_correlations(&self) -> Vec<ResolvedCorrelation> {
        let target = |j: usize| self.inputs.get(j).map(|input| input.target);
        let is_gap = |j| target(j).is_some_and(|of| of.parameter == Parameter::BrakeGap);
        let mut found: Vec<ResolvedCorrelation> = Vec::new();
        for (k, one) in self.correlations.iter().enumerate() {
            let like = |(_, other): &(usize, &Correlation)| {
                let same = (other.measure, &other.source) == (one.measure, &one.source);
                same && [one, other].iter().all(|c| is_gap(c.between.0) && is_gap(c.between.1))
            };
            let likes = || self.correlations.iter().enumerate().filter(like);
            let pairs = likes().count().max(1);
            if likes().next().is_some_and(|(first, _)| first < k) {
                continue;
            }
            let path = |j| match target(j) {
                Some(of) if pairs > 1 => of.parameter.info().path.to_owned(),
                of => of.map_or(String::new(), |of| of.path()),
            };
            found.push(ResolvedCorrelation {
                between: (path(one.between.0), path(one.between.1)),
                pairs,
                measure: one.measure,
                source: one.source.clone(),
            });
        }
        found
    }
}
