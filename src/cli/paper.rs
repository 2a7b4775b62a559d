//! `reeldown paper`: the paper's figures and statements, held against a design.

use super::arguments::PaperArguments;
use super::command_line::CommandLine;
use super::figure_files::write_report_figures;
use super::{Ending, done};
use crate::error::{Error, Result};
use crate::findings::paper::{PaperFinding, Verdict, paper as findings};
use crate::physics::Parameter;
use crate::render::{Mark, page as render_page, paper_count, paper_page, table};
use crate::store::{Contents, ResultDirectory};
use crate::study::Study;
use crate::units::engineering;

/// Draws the figures, writes the page, says what agrees.
pub(super) fn paper(arguments: &PaperArguments) -> Result<Ending> {
    let study = arguments.study.load(&[])?;
    study.design.validate()?;
    let contents = Contents {
        kind: "paper",
        study: &study.title,
        files: &["report.md", "report.html", "paper.json"],
        force: arguments.force,
    };
    let directory = arguments.out.as_ref().map(|path| ResultDirectory::open(path, contents));
    let directory = directory.transpose()?;
    let finding = findings(&study)?;
    if let Some(directory) = directory {
        let page = paper_page(&finding, &design(&study), &command(arguments));
        write_report_figures(&directory, &page.figures)?;
        let html =
            render_page("The paper and the program", Mark::None, &page.markdown, &page.figures)?;
        directory.write_text("report.html", &html)?;
        directory.write_text("report.md", &page.markdown)?;
        directory.write_text("paper.json", &format!("{}\n", json(&finding)?))?;
        directory.finish()?;
    }
    if arguments.json {
        return done(&json(&finding)?);
    }
    let rows = finding.statements.iter().map(|statement| {
        [
            match statement.verdict {
                Verdict::Pass => "pass",
                Verdict::Fail => "FAIL",
                Verdict::Undecided => "undecided",
                Verdict::NoTest => "no test",
            }
            .to_owned(),
            statement.place.to_owned(),
            statement.says.to_owned(),
            statement.found.clone(),
        ]
    });
    let mut text = format!(
        "{}\n\n{}\n",
        paper_count(&finding.statements),
        table(&["", "where", "the paper says", "here"], 0..0, rows, Some(118))
    );
    text +=
        &format!("\nBy the {} model, but for the dynamic curve of Fig. 4.\n", finding.modes.model);
    for statement in finding.statements.iter().filter(|s| s.verdict != Verdict::Pass) {
        if let Some(remark) = &statement.remark {
            text += &format!("\n{}: {remark}.\n", statement.place);
        }
    }
    if let Some(directory) = &arguments.out {
        text += &format!("\nreport: {}\n", directory.join("report.html").display());
    }
    done(&text)
}

fn json(finding: &PaperFinding) -> Result<String> {
    serde_json::to_string_pretty(finding)
        .map_err(|reason| Error::argument(format!("the findings cannot be written: {reason}")))
}

/// The design in a sentence.
fn design(study: &Study) -> String {
    let shown =
        |parameter: Parameter| engineering(study.design.get(parameter), parameter.info().quantity);
    format!(
        "the design of \"{}\": {} of line, fluid of {}, start at {}.",
        study.title,
        shown(Parameter::ReelLineLength),
        shown(Parameter::FluidNominalViscosity),
        shown(Parameter::InitialTemperature)
    )
}

/// The command that writes the same page.
fn command(arguments: &PaperArguments) -> String {
    let study = &arguments.study;
    CommandLine::new("paper", study).set(study).flag("--out DIR", true).line()
}
