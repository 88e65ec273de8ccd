//! `times`: a scene on the table, a week and six months after the operation.

use super::output::{self, File};
use super::stream::ThreadCount;
use super::studies::{self, Solver};
use super::{ExitStatus, InputError};
use crate::clinical::When;
use crate::study::{Quantity, Times};
use std::path::PathBuf;

/// Arguments of `times`.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    #[command(flatten)]
    threads: ThreadCount,
    /// Output file; `-` is standard output.
    #[arg(long, value_name = "T.json", default_value = output::STANDARD)]
    out: PathBuf,
}

/// Writes the times as JSON.
pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    output::check_path(&arguments.out)?;
    let scene = studies::scene(&arguments.scene)?;
    let mut times = Times::new(&scene).map_err(|error| InputError(error.to_owned()))?;
    let mut solver = Solver::new(&arguments.threads)?;
    solver.solve(&mut times);
    let json = serde_json::to_string_pretty(&times.file())
        .map_err(|error| InputError(format!("times: {error}")))?;
    output::write_all(&[File::new(&arguments.out, json + "\n")])?;
    for when in When::ALL {
        let left_out = times.left_out(when);
        if left_out > 0 {
            output::warn(&format!(
                "{}: {left_out} of 2 deviations have no answer; the ranges leave them out.",
                when.words()
            ));
        }
    }
    let has_values = When::ALL.iter().all(|when| times.value(*when, Quantity::ForceN).is_some());
    Ok(solver.status(&times, has_values))
}
