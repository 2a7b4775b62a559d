//! `reeldown sweep`: the design space along one or two paths.

use super::arguments::SweepArguments;
use super::command_line::CommandLine;
use super::figure_files::write_report_figures;
use super::output::{say, say_error, say_notes};
use super::watch::{carry_out, interruptible};
use super::{Ending, done, parentage};
use crate::campaign::sweep::{Grid, Meaning, SweptPath, check, run_sweep, usual_samples};
use crate::error::{Error, Result};
use crate::findings::sweep::{SweepFinding, sweep as findings};
use crate::render::{self, Mark};
use crate::store::{Contents, Field, ResultDirectory, write_table};
use crate::study::{Over, Study, design_path, option_error};
use std::path::{Path, PathBuf};

/// The long table.
const TABLE: &str = "sweep.parquet";
/// The findings as one tree.
const FINDINGS: &str = "sweep.json";
/// The report.
const REPORT: &str = "report.md";
/// The report as a page.
const PAGE: &str = "report.html";
/// Samples that a cell may have.
const SAMPLES: std::ops::RangeInclusive<u64> = 20..=200_000;

/// Sweeps, writes and shows.
pub(super) fn sweep(arguments: &SweepArguments) -> Result<Ending> {
    let seed = arguments.seed.iter().map(|seed| ("--seed", format!("sampling.seed={seed}")));
    let study = arguments.study.load(&seed.collect::<Vec<_>>())?;
    study.design.validate()?;
    let grid = grid(arguments, &study)?;
    check(&study, &grid)?;
    let samples = samples(arguments, &study, &grid)?;
    let directory = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-sweep", arguments.study.name())));
    let contents = Contents {
        kind: "sweep",
        study: &study.title,
        files: &[TABLE, FINDINGS, REPORT, PAGE],
        force: arguments.force,
    };
    let directory = ResultDirectory::open(&directory, contents)?;
    say_notes(&study);
    let progress = interruptible()?;
    let finding = carry_out(&progress, arguments.threads.asked(), |progress| {
        progress.begin("sweeping", samples.unwrap_or(0) * grid.cells().len() as u64);
        match run_sweep(&study, &grid, samples, progress)? {
            Some(cells) => findings(&study, &grid, &cells, samples, command(arguments), progress),
            None => Ok(None),
        }
    })?;
    let Some(finding) = finding else {
        say_error("stopped before the sweep was complete; nothing was written");
        return Ok(Ending::Interrupted);
    };
    let json = serde_json::to_string_pretty(&finding)
        .map_err(|reason| Error::argument(format!("the sweep cannot be written: {reason}")))?;
    let report = directory.path().join(PAGE);
    write(directory, &study, &finding, &json)?;
    if arguments.json {
        return done(&json);
    }
    say(&format!("{}\nreport: {}", render::sweep_terminal(&finding), report.display()))?;
    Ok(Ending::Done)
}

/// The grid that was asked for, with what its values mean.
fn grid(arguments: &SweepArguments, study: &Study) -> Result<Grid> {
    let overs = arguments
        .over
        .iter()
        .map(|text| Over::parse("--over", text))
        .collect::<Result<Vec<_>>>()?;
    Over::check_together(&overs, study)?;
    let mut paths: Vec<SweptPath> = overs.iter().map(|over| SweptPath::of(study, over)).collect();
    let wishes = [("--hold", &arguments.hold, Meaning::Held)].into_iter().chain([(
        "--centre",
        &arguments.centre,
        Meaning::Centred,
    )]);
    for (option, names, meaning) in wishes {
        for name in names {
            let target = design_path(option, name)?;
            let Some(path) = paths.iter_mut().find(|path| path.target == target) else {
                let expected = "expected the path of an --over";
                return Err(option_error(option, name, "this path is not swept", expected));
            };
            if path.meaning == Meaning::Design {
                let problem =
                    "the card says nothing of this path, so its values are exact as they are";
                return Err(option_error(option, name, problem, "expected an uncertain path"));
            }
            path.meaning = meaning;
        }
    }
    if let Some(name) = arguments.hold.iter().find(|name| arguments.centre.contains(name)) {
        let problem = "a path cannot be held and centred at once";
        return Err(option_error("--hold", name, problem, "expected one of the two"));
    }
    Ok(Grid { paths })
}

/// Samples of each cell, or none.
fn samples(arguments: &SweepArguments, study: &Study, grid: &Grid) -> Result<Option<u64>> {
    if arguments.nominal {
        return Ok(None);
    }
    let missing = match (study.inputs.is_empty(), study.limits.is_empty()) {
        (true, _) => Some("nothing is uncertain in this study"),
        (false, true) => Some("the study states no limit that could be breached"),
        (false, false) => None,
    };
    if let Some(missing) = missing {
        return Err(Error::argument(format!(
            "{missing}, so there are no probabilities: add --nominal for the outcomes alone"
        )));
    }
    let Some(text) = &arguments.samples else {
        return Ok(Some(usual_samples(grid.cells().len() as u64)));
    };
    match text.replace('_', "").parse::<u64>() {
        Ok(samples) if SAMPLES.contains(&samples) => Ok(Some(samples)),
        _ => {
            let expected = format!(
                "expected a whole number from {} to {}; for more at one setting use `reeldown run --set`",
                SAMPLES.start(),
                SAMPLES.end()
            );
            Err(option_error(
                "--samples",
                text,
                "this is not a number of samples a cell",
                &expected,
            ))
        }
    }
}

/// The command that gives the same numbers.
fn command(arguments: &SweepArguments) -> String {
    let SweepArguments { study, over, hold, centre, samples, seed, nominal, .. } = arguments;
    let command = CommandLine::new("sweep", study).option("--over", over).option("--hold", hold);
    let command = command.option("--centre", centre).option("--samples", samples);
    command.option("--seed", seed).set(study).flag("--nominal", *nominal).line()
}

fn write(
    directory: ResultDirectory,
    study: &Study,
    finding: &SweepFinding,
    json: &str,
) -> Result<()> {
    directory.write_text(FINDINGS, &format!("{json}\n"))?;
    let figures = render::sweep_figures(finding);
    write_report_figures(&directory, &figures)?;
    let report = render::sweep_markdown(finding, &figures);
    directory.write_text(PAGE, &render::page("Design space", Mark::None, &report, &figures)?)?;
    directory.write_text(REPORT, &report)?;
    write_long_table(&directory.table(TABLE)?, study, finding)?;
    directory.finish()
}

/// One row of the long table: a number of a cell.
struct Row {
    cell: usize,
    kind: &'static str,
    name: String,
    value: Option<f64>,
    interval: Option<(f64, f64)>,
    counts: Option<(u64, u64)>,
}

fn write_long_table(path: &Path, study: &Study, finding: &SweepFinding) -> Result<()> {
    let mut rows = Vec::new();
    for (k, cell) in finding.cells.iter().enumerate() {
        let mut row = |kind, name: String, value: Option<f64>| {
            rows.push(Row { cell: k, kind, name, value, interval: None, counts: None });
        };
        for (column, value) in &cell.outcomes {
            row("nominal", column.clone(), Some(*value));
        }
        for (limit, (&margin, &share)) in
            study.limits.iter().zip(cell.margins.iter().zip(&cell.relative_margins))
        {
            row("margin", limit.margin_column(), margin);
            row("relative margin", limit.name(), share);
        }
        for (limit, quantiles) in study.limits.iter().zip(&cell.quantiles) {
            for (at, share) in ["5 %", "50 %", "95 %"].into_iter().enumerate() {
                let name = format!("{} {share}", limit.outcome.column());
                row("quantile", name, quantiles.map(|q| q[at]));
            }
        }
        let names = std::iter::once("any".to_owned()).chain(study.limits.iter().map(|l| l.name()));
        for ((name, estimate), counts) in
            names.zip(cell.any.iter().chain(&cell.each)).zip(&cell.counts)
        {
            rows.push(Row {
                cell: k,
                kind: "probability",
                name,
                value: estimate.value,
                interval: estimate.interval.interval().map(|i| (i.lower, i.upper)),
                counts: Some((counts.breaches, counts.faults)),
            });
        }
        if let (Some(estimate), Some(counts)) = (&cell.confirmed, &cell.confirmed_counts) {
            rows.push(Row {
                cell: k,
                kind: "confirmed probability",
                name: "any".to_owned(),
                value: estimate.value,
                interval: estimate.interval.interval().map(|i| (i.lower, i.upper)),
                counts: Some((counts.breaches, counts.faults)),
            });
        }
    }
    let number =
        |read: &dyn Fn(&Row) -> Option<f64>| Field::Number(rows.iter().map(read).collect());
    let mut columns =
        vec![("cell".to_owned(), Field::Count(rows.iter().map(|row| row.cell as u64).collect()))];
    for (k, swept) in finding.paths.iter().enumerate() {
        let value = |row: &Row| finding.cells[row.cell].values.get(k).copied();
        columns.push((swept.column.clone(), number(&value)));
    }
    let text = |read: &dyn Fn(&Row) -> String| {
        Field::Text(rows.iter().map(|row| Some(read(row))).collect())
    };
    columns.extend([
        ("kind".to_owned(), text(&|row| row.kind.to_owned())),
        ("name".to_owned(), text(&|row| row.name.clone())),
        ("value".to_owned(), number(&|row| row.value)),
        ("lower_95".to_owned(), number(&|row| Some(row.interval?.0))),
        ("upper_95".to_owned(), number(&|row| Some(row.interval?.1))),
        ("breaches".to_owned(), number(&|row| Some(row.counts?.0 as f64))),
        ("faults".to_owned(), number(&|row| Some(row.counts?.1 as f64))),
    ]);
    let mut parents = parentage::of(study);
    parents.0.insert("command".to_owned(), finding.reproduction.command.clone());
    if let Some(samples) = finding.samples {
        parents.0.insert("samples".to_owned(), samples.to_string());
    }
    if let Some(samples) = finding.confirming_samples {
        parents.0.insert("confirming_samples".to_owned(), samples.to_string());
    }
    write_table(path, columns, parents.entries())
}
