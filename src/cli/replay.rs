//! `reeldown replay`: one sample of a run again, bit for bit.

use super::arguments::ReplayArguments;
use super::{Ending, descend, done, parentage};
use crate::campaign::{self, Ensemble, Progress};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::outcomes::OutcomeTable;
use crate::store::OutcomesReader;
use crate::study::Study;
use crate::units::engineering;
use serde_json::{Map, Value, json};

/// Computes one sample again, compares it with its row, and shows it.
pub(super) fn replay(arguments: &ReplayArguments) -> Result<Ending> {
    let path = &arguments.outcomes;
    let reader = OutcomesReader::open(path)?;
    let study = parentage::study(path, reader.parentage())?;
    let last = (reader.first() + reader.rows()).saturating_sub(1);
    if reader.rows() == 0 || !(reader.first()..=last).contains(&arguments.index) {
        return Err(Error::argument(format!(
            "there is no sample {}: {} holds samples {} to {last}",
            arguments.index,
            path.display(),
            reader.first()
        )));
    }
    let recorded = reader.read(&study, arguments.index, 1)?;
    let again = compute(&study, arguments.index)?;
    if !same_bits((&recorded, 0), (&again, 0)) {
        let reason = format!("sample {} computed again differs from its row", arguments.index);
        let help = "the file was changed, or this build computes other bits: please report it";
        return Err(Error::file(path, "replay", reason, help));
    }
    if let Some(trace) = &arguments.trace {
        let design = Ensemble::new(&study).design_of(&again.inputs.row(0));
        descend::integrate(&design, study.model, Some(trace))?;
    }
    if arguments.json {
        return done(&format!("{:#}", Value::Object(object(&study, arguments.index, &again))));
    }
    let mut text =
        format!("{}: sample {}, the same bits as its row\n\n", study.title, arguments.index);
    for (input, value) in study.inputs.iter().zip(again.inputs.row(0)) {
        let quantity = input.target.parameter.info().quantity;
        text += &format!("{:42} {}\n", input.target.path(), engineering(value, quantity));
    }
    text.push('\n');
    text += &match again.result(0) {
        Ok(outcome) => descend::outcome_table(&study, &outcome),
        Err(fault) => format!("fault: {}\n", fault.name()),
    };
    done(&text)
}

/// One sample of a study.
pub(super) fn compute(study: &Study, index: u64) -> Result<OutcomeTable> {
    let sampler = campaign::sampler(study)?;
    let ensemble = Ensemble::new(study);
    let mut point = Columns::new(1, ensemble.dimension());
    sampler.fill(index, &mut point)?;
    Ok(ensemble.at_uniform(&point, &Progress::default()))
}

/// Whether a row of one table and a row of another hold the same bits; NaN is NaN.
pub(super) fn same_bits(a: (&OutcomeTable, usize), b: (&OutcomeTable, usize)) -> bool {
    let bits = |(table, k): (&OutcomeTable, usize)| -> Vec<u64> {
        let numbers = table.inputs.row(k).into_iter().chain(table.outcomes.row(k));
        numbers.map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() }).collect()
    };
    let rest = |(table, k): (&OutcomeTable, usize)| (table.deployed[k], table.faults[k]);
    bits(a) == bits(b) && rest(a) == rest(b)
}

fn object(study: &Study, index: u64, table: &OutcomeTable) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert("sample".to_owned(), json!(index));
    for (input, value) in study.inputs.iter().zip(table.inputs.row(0)) {
        object.insert(input.target.column(), json!(value));
    }
    match table.result(0) {
        Ok(outcome) => {
            object.extend(descend::outcome_json(&outcome));
            for limit in &study.limits {
                object.insert(limit.margin_column(), json!(limit.margin(&outcome)));
            }
        }
        Err(fault) => {
            object.insert("fault".to_owned(), json!(fault.name()));
        }
    }
    object
}
