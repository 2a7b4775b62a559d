//! The most likely way to breach in plain words: what is out of the ordinary, how rare each part of it
//! is, and what the flight would be like.

use super::rare::DesignPointInput;
use crate::descent::{Outcome, OutcomeQuantity};
use crate::physics::{Parameter, Target};
use crate::study::{Nature, Study};
use crate::units::{System, format_engineering, number};

/// Inputs named in the story.
const TOLD: usize = 6;
/// Least share of the distance of an input that is named.
const LEAST_TOLD: f64 = 0.02;

/// The story of a design point at `distance` standard deviations, with the flight there and the nominal
/// one where they could be computed. Where the medians breach it is the nearest way *not* to, and is called that.
pub(super) fn story(
    study: &Study,
    inputs: &[DesignPointInput],
    distance: f64,
    medians_breach: bool,
    flight: Option<&Outcome>,
    nominal: Option<&Outcome>,
) -> String {
    let told: Vec<&DesignPointInput> =
        inputs.iter().take(TOLD).filter(|input| input.importance >= LEAST_TOLD).collect();
    let parts: Vec<String> = told.iter().filter_map(|input| part(study, input)).collect();
    let point = match medians_breach {
        false => "The most likely way to breach",
        true => {
            "The medians breach: with every input at its median the limit is exceeded, and no unusual values are \
             needed. The nearest way to keep it"
        }
    };
    let mut text = format!(
        "{point} lies {} standard deviations from the medians: {}.",
        number(distance.abs(), 3),
        parts.join("; ")
    );
    if let [_, _, ..] = told[..] {
        let rarest = told.iter().min_by(|a, b| a.beyond.total_cmp(&b.beyond));
        if let Some(rarest) = rarest {
            text += &format!(
                " The rarest of these alone has {}; it takes them together.",
                one_in(rarest.beyond, nature_of(study, &rarest.path))
            );
        }
    }
    if let Some(flight) = flight {
        text += &format!(" {}", flight_in_words(flight, nominal));
    }
    text
}

/// One input: what it means, its value beside its median, how rare, and its share of the distance.
fn part(study: &Study, input: &DesignPointInput) -> Option<String> {
    let known = study.inputs.iter().find(|known| known.target.path() == input.path)?;
    let quantity = known.target.parameter.info().quantity;
    let shown = |value: f64| format_engineering(value, quantity, System::UsCustomary, 4);
    let high = input.percentile > 0.5;
    Some(format!(
        "{} ({} {}, median {}; as {} or {} has {}; {} of the distance)",
        cause(known.target, high),
        input.path,
        shown(input.value),
        shown(input.median),
        if high { "high" } else { "low" },
        if high { "higher" } else { "lower" },
        one_in(input.beyond, known.nature),
        format_args!("{} %", number(100.0 * input.importance, 2))
    ))
}

fn nature_of(study: &Study, path: &str) -> Nature {
    let input = study.inputs.iter().find(|input| input.target.path() == path);
    input.map_or(Nature::Varies, |input| input.nature)
}

/// How rare: an input that varies changes from flight to flight, one that is not known is the same in every flight of a brake.
fn one_in(share: f64, nature: Nature) -> String {
    let of = match nature {
        Nature::Varies => "flight",
        Nature::Unknown => "brake",
    };
    if share > 0.0 {
        format!("one {of} in {}", number(share.recip(), 2))
    } else {
        format!("no {of}")
    }
}

fn flight_in_words(flight: &Outcome, nominal: Option<&Outcome>) -> String {
    let shown = |outcome: &Outcome, of: OutcomeQuantity| {
        format_engineering(outcome.get(of), of.quantity(), System::UsCustomary, 4)
    };
    let beside = |of: OutcomeQuantity| {
        nominal.map_or(String::new(), |nominal| format!(" (nominal {})", shown(nominal, of)))
    };
    let at = |of: OutcomeQuantity| format!("{}{}", shown(flight, of), beside(of));
    let end = if flight.deployed {
        format!("reels down in {}", at(OutcomeQuantity::Time))
    } else {
        "does not reel down within the time limit".to_owned()
    };
    format!(
        "That flight {end}, its fluid peaks at {} and it ends at {}.",
        at(OutcomeQuantity::PeakFluidTemperature),
        at(OutcomeQuantity::FinalVelocity)
    )
}

/// What a high or a low value of an input means on the rig.
fn cause(target: Target, high: bool) -> String {
    let pick =
        |upper: &'static str, lower: &'static str| if high { upper } else { lower }.to_owned();
    match target.parameter {
        Parameter::InitialTemperature => pick("hot start", "cold start"),
        Parameter::FluidShearFactor
        | Parameter::FluidLotFactor
        | Parameter::FluidNominalViscosity
        | Parameter::FluidViscosityCoefficient => pick("thick fluid", "thin fluid"),
        Parameter::FluidViscosityTemperature => {
            pick("fluid that thins more with heat", "fluid that thins less with heat")
        }
        Parameter::FluidAveragingOffset => pick(
            "viscosity set by hotter fluid than the average",
            "viscosity set by cooler fluid than the average",
        ),
        Parameter::ThermalFluidCapacity => {
            pick("large heat capacity of the fluid", "small heat capacity of the fluid")
        }
        Parameter::ThermalRotorCapacity => {
            pick("large heat capacity of the rotors", "small heat capacity of the rotors")
        }
        Parameter::ThermalHousingCapacity => {
            pick("large heat capacity of the housing", "small heat capacity of the housing")
        }
        Parameter::ThermalFluidRotorConductance => {
            pick("good heat path from fluid to rotors", "poor heat path from fluid to rotors")
        }
        Parameter::ThermalFluidHousingConductance => {
            pick("good heat path from fluid to housing", "poor heat path from fluid to housing")
        }
        Parameter::ThermalRotorHousingConductance => {
            pick("good heat path from rotors to housing", "poor heat path from rotors to housing")
        }
        Parameter::BrakeGap => match target.surface {
            Some(k) => format!("{} gap at surface {}", if high { "wide" } else { "narrow" }, k + 1),
            None => pick("wide gaps", "narrow gaps"),
        },
        Parameter::PayloadWeight => pick("heavy payload", "light payload"),
        other => format!("{} {}", if high { "high" } else { "low" }, other.info().description),
    }
}
