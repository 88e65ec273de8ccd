//! The command line: `simulate`, `scan`, `map`, `bands`, `times`, `schema`, `curve`, `tension`, `charts`, `stability`, `bench`, `validate` and `stress`.
//! Native only.
//!
//! Exit codes: 0 success; 1 internal error, or standard output is closed; 2 bad input (one line on standard error: file, field, allowed
//! values; no file is written, of lines those of the other scenes); 3 no converged solution (the result is written with its
//! status); 130 a signal (what was ready is written).
//!
//! Files are written under a temporary name and renamed, so that no reader meets an incomplete file; lines are written at their
//! place, each at once.

mod bench;
mod cell;
mod charts;
mod curve;
mod file;
mod input;
mod measures;
mod output;
mod parquet;
mod rows;
mod scan;
mod schema;
mod simulate;
mod stability;
mod standard;
mod stream;
mod stress;
mod studies;
mod tension;
mod times;
mod utf16;
mod validate;

use clap::{Parser, Subcommand};
use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;

/// Next action of `main`.
#[derive(Debug)]
pub enum Next {
    /// Open the window: no command was given.
    OpenApp,
    /// Exit with the code of a command.
    Exit(ExitCode),
}

/// Preview how skin and adipose tissue stretch over an implant. Without a command, the app opens.
#[derive(Parser)]
#[command(name = "implant-preview", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Solve scenes and write their results.
    Simulate(simulate::Arguments),
    /// Fit the surface of a body and a surgeon's marks, and write the scene of a breast; standard error has a JSON line of figures.
    Scan(scan::Arguments),
    /// Solve a scene over a grid of one or two of its numbers and write table, JSON and chart.
    Map(studies::MapArguments),
    /// Solve a scene over what is not known about a person and write percentiles and importance.
    Bands(studies::BandsArguments),
    /// Solve a scene on the table, a week and six months after the operation, and write its figures with their ranges.
    Times(times::Arguments),
    /// Write the JSON Schema of a format.
    Schema(schema::Arguments),
    /// Read a raw tensile test and write its curve; standard error has what was recognised, left out and converted.
    Curve(curve::Arguments),
    /// Simulate the paper's tension test on a square sample and write a table.
    Tension(tension::Arguments),
    /// Draw the paper's charts 1 to 4 for both spring laws.
    Charts(output::OutputFolder),
    /// Map the stability of a uniformly stretched sheet over strain and Poisson ratio.
    Stability(output::OutputFolder),
    /// Measure run time against error for the solvers and the reference methods.
    Bench(bench::Arguments),
    /// Measure the errors of all nodes against references.
    Validate(validate::Arguments),
    /// Solve random scenes and check every result against invariants.
    Stress(stress::Arguments),
}

/// Status of a command with valid input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ExitStatus {
    Converged,
    NotConverged,
    /// A scene ended in a defect of the program; the others have their lines.
    Defect,
    /// A signal has ended the run.
    Interrupted,
}

/// Bad input or an output that cannot be written: one line, exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct InputError(String);

/// Parses a number within a range, ends included.
fn in_range<T>(text: &str, least: T, most: T) -> Result<T, String>
where
    T: FromStr + PartialOrd + Display,
{
    let value = text.parse().ok().filter(|value| (&least..=&most).contains(&value));
    value.ok_or_else(|| format!("allowed: {least} to {most}"))
}

const DEFECT: u8 = 1;
const BAD_INPUT: u8 = 2;
const NOT_CONVERGED: u8 = 3;
/// As of a process that SIGINT ends.
const INTERRUPTED: u8 = 130;

/// Runs the command of this process, if there is one.
#[must_use]
pub fn run() -> Next {
    stream::limit_pool();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return Next::Exit(report_usage(&error)),
    };
    let Some(command) = arguments.command else {
        if cfg!(feature = "app") {
            return Next::OpenApp;
        }
        output::error("no command given, and this build has no window; see --help");
        return Next::Exit(ExitCode::from(BAD_INPUT));
    };
    Next::Exit(exit_code(catch_panic(|| match command {
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Scan(arguments) => scan::run(&arguments),
        Command::Map(arguments) => studies::map(&arguments),
        Command::Bands(arguments) => studies::bands(&arguments),
        Command::Times(arguments) => times::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Curve(arguments) => curve::run(&arguments),
        Command::Tension(arguments) => tension::run(&arguments),
        Command::Charts(folder) => charts::run(&folder),
        Command::Stability(folder) => stability::run(&folder),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Stress(arguments) => stress::run(&arguments),
    })))
}

/// Catches panics and reports them in one line.
fn catch_panic(
    command: impl FnOnce() -> Result<ExitStatus, InputError>,
) -> Option<Result<ExitStatus, InputError>> {
    report_panics("; no file was written");
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(command)).ok();
    drop(std::panic::take_hook());
    outcome
}

/// Reports panics in one line with this end; those while a damaged file is read are errors of the file.
fn report_panics(end: &'static str) {
    std::panic::set_hook(Box::new(move |panic| {
        if !parquet::is_reading() {
            let location = panic.location().map(ToString::to_string).unwrap_or_default();
            output::error(&format!("internal error at {location}{end}"));
        }
    }));
}

fn exit_code(outcome: Option<Result<ExitStatus, InputError>>) -> ExitCode {
    match outcome {
        Some(Ok(ExitStatus::Converged)) => ExitCode::SUCCESS,
        Some(Ok(ExitStatus::NotConverged)) => ExitCode::from(NOT_CONVERGED),
        Some(Ok(ExitStatus::Interrupted)) => ExitCode::from(INTERRUPTED),
        Some(Ok(ExitStatus::Defect)) | None => ExitCode::from(DEFECT),
        Some(Err(error)) => {
            output::error(&error.to_string());
            ExitCode::from(if error.0 == output::CLOSED { DEFECT } else { BAD_INPUT })
        }
    }
}

/// Prints help and version unchanged, and an invalid argument in one line.
fn report_usage(error: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind;
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        if let Err(closed) = output::check_open(Path::new(output::STANDARD)) {
            return exit_code(Some(Err(closed)));
        }
        // A closed pipe is not an error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    let text = error.to_string();
    let lines: Vec<&str> =
        text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    output::error(lines.join(" ").trim_start_matches("error: "));
    ExitCode::from(BAD_INPUT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_defect_does_not_end_like_a_solve_that_has_not_converged() {
        let hook = std::panic::take_hook();
        let outcome = catch_panic(|| panic!("a defect"));
        std::panic::set_hook(hook);
        assert!(outcome.is_none());
        let code = |outcome| format!("{:?}", exit_code(outcome));
        assert_eq!(code(None), format!("{:?}", ExitCode::from(1)));
        assert_ne!(code(None), code(Some(Ok(ExitStatus::NotConverged))));
    }
}
