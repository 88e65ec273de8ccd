//! `stress`: robustness runs over random scenes and sessions.

use super::output::{self, File, STANDARD};
use super::{ExitStatus, InputError, in_range};
use crate::experiment::robustness::{Case, Summary, run as run_case};
use crate::scene::limits;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Number of random scenes; every tenth has a session of random edits.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = cases, allow_negative_numbers = true)]
    cases: u64,
    /// Seed; equal seeds give equal scenes on every machine.
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Maximum nodes per side, 17 to 513.
    #[arg(long, value_name = "N", default_value_t = MOST_NODES, value_parser = most_nodes, allow_negative_numbers = true)]
    most_nodes: usize,
    /// Output file for the summary (JSON); `-` is standard output.
    #[arg(long, value_name = "F", default_value = STANDARD)]
    out: PathBuf,
}

const MOST_NODES: usize = 513;
const MOST_CASES: u64 = 1_000_000_000;

fn cases(text: &str) -> Result<u64, String> {
    in_range(text, 1, MOST_CASES)
}

fn seed(text: &str) -> Result<u64, String> {
    in_range(text, 0, u64::MAX)
}

fn most_nodes(text: &str) -> Result<usize, String> {
    in_range(text, limits::NODES_PER_SIDE.0, MOST_NODES)
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let &Arguments { cases, seed, most_nodes, ref out } = arguments;
    output::check_path(out)?;
    let cases: Vec<Case> =
        (0..cases).into_par_iter().map(|case| run_case(seed, case, most_nodes)).collect();
    let summary = Summary::new(seed, &cases);
    let text = serde_json::to_string_pretty(&summary)
        .map_err(|error| output::input_error(Path::new("stress"), error))?;
    output::write_all(&[File::new(out, text + "\n")])?;
    Ok(if summary.failures.is_empty() { ExitStatus::Converged } else { ExitStatus::NotConverged })
}
