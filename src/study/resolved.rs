//! Every resolved value of a study with where it comes from, for `reeldown check`.

use super::{Known, Nature, Study};
use crate::physics::design::Target;
use crate::physics::parameters::{PARAMETERS, Parameter};
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
    /// How many independent inputs follow it: the surfaces that share a statement.
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
        let source = match stated.or_else(inherited) {
            Some(stated) => format!("{}: {}", stated.origin, stated.text),
            None => info.source.to_owned(),
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
            text: engineering(value, info.quantity),
            source,
            uncertain,
        }
    }
}

/// The value as its reader expects it: the one temperature difference, `B`, belongs to a law in K.
fn engineering(value: f64, quantity: Quantity) -> String {
    match quantity {
        Quantity::TemperatureDifference => {
            units::format_engineering(value, quantity, units::System::Si, 6)
        }
        _ => units::engineering(value, quantity),
    }
}
