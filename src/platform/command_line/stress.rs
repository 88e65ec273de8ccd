//! `stress`: robustness runs over random scenes and sessions.

use super::output::{self, File, LineFile, STANDARD};
use super::stream::{self, End, Progress, ThreadCount};
use super::{ExitStatus, InputError, in_range, report_panics};
use crate::scene::{Field, TissueModel, limits};
use crate::study::many::Many;
use implant_preview_lab::robustness::clinical::{Clinical, ClinicalCase, ClinicalSummary};
use implant_preview_lab::robustness::{
    Case, LayeredSummary, Population, Summary, panicked, run_of,
};
use serde::Serialize;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

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
    /// The tissue model of the random scenes.
    #[arg(long, value_name = "M", default_value = "sheet", value_parser = tissue_model)]
    tissue_model: TissueModel,
    /// Random patients under round implants instead, each solved once: the clinical population.
    #[arg(long, conflicts_with_all = ["tissue_model", "most_nodes"])]
    clinical: bool,
    /// Clinical population: nodes per side.
    #[arg(long, value_name = "N", default_value_t = 65, value_parser = most_nodes, allow_negative_numbers = true, requires = "clinical")]
    nodes: usize,
    /// Clinical population: Poisson ratio of the fat, 0 to 0.5.
    #[arg(long, value_name = "NU", default_value_t = 0.49, value_parser = poisson_ratio, allow_negative_numbers = true, requires = "clinical")]
    fat_poisson_ratio: f64,
    /// Clinical population: rate of an exponential, 0.001 to 100, in place of the curve `fat`.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_negative_numbers = true, requires = "clinical")]
    fat_rate: Option<f64>,
    /// Layered tissue and clinical population: every scene has a curved chest, half of them an implant that is anatomical or off
    /// centre, half of them a mound of thickness, half of them an implant of another fullness.
    #[arg(long)]
    chest: bool,
    /// Clinical population: every scene has the usual chest with bumps as a grid, a mound of thickness off centre, and in half of the
    /// scenes an anatomical implant; 150 to 500 ml.
    #[arg(long, requires = "clinical", conflicts_with = "chest")]
    terrain: bool,
    /// Clinical population: the skin of every patient has a natural tension.
    #[arg(long, requires = "clinical")]
    skin_tension: bool,
    /// Clinical population: the skin has grown by any part of its stretch under the implant, too.
    #[arg(long, requires = "skin_tension")]
    skin_growth: bool,
    /// Clinical population: every implant has one of the fills, or is rigid.
    #[arg(long, requires = "clinical")]
    fill: bool,
    /// Clinical population: every pocket is above, partly or wholly below the muscle, 6 to 12 mm of 3 to 30 kPa.
    #[arg(long, requires = "clinical")]
    plane: bool,
    /// Clinical population: every pocket has a new fold up to 20 mm below the old one.
    #[arg(long, requires = "clinical")]
    fold: bool,
    /// Clinical population: half of the pockets limit the void to a volume of up to 30 ml.
    #[arg(long, requires = "clinical")]
    pocket_void: bool,
    /// Clinical population: every patient is lying, standing, or without weight.
    #[arg(long, requires = "clinical")]
    posture: bool,
    /// Clinical population: solves every converged case again, to measure its error.
    #[arg(long, requires = "clinical")]
    measure_errors: bool,
    /// Output file for all cases, one a line (JSON lines).
    #[arg(long, value_name = "F")]
    lines: Option<PathBuf>,
    #[command(flatten)]
    threads: ThreadCount,
    /// Output file for the summary (JSON); `-` is standard output.
    #[arg(long, value_name = "F", default_value = STANDARD)]
    out: PathBuf,
}

/// The error of `--chest` for sheets.
pub(super) const CHEST_OF_SHEET: &str =
    "--chest: sheets are flat; allowed: with --tissue-model layered";

const MOST_NODES: usize = 513;
const MOST_CASES: u64 = 1_000_000_000;

/// The tissue model of this name in a scene.
pub(super) fn tissue_model(text: &str) -> Result<TissueModel, String> {
    let name = serde_json::Value::from(text);
    serde_json::from_value(name).map_err(|_| "allowed: sheet, layered".to_owned())
}

fn cases(text: &str) -> Result<u64, String> {
    in_range(text, 1, MOST_CASES)
}

fn seed(text: &str) -> Result<u64, String> {
    in_range(text, 0, u64::MAX)
}

fn most_nodes(text: &str) -> Result<usize, String> {
    in_range(text, limits::NODES_PER_SIDE.0, MOST_NODES)
}

fn poisson_ratio(text: &str) -> Result<f64, String> {
    in_range(text, Field::PoissonRatio.limits.0, Field::PoissonRatio.limits.1)
}

fn rate(text: &str) -> Result<f64, String> {
    in_range(text, 1e-3, 100.0)
}

/// Solves random patients.
fn run_clinical(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let &Arguments { seed, nodes, fat_poisson_ratio, fat_rate, measure_errors, .. } = arguments;
    let clinical = Clinical {
        fat_poisson_ratio,
        fat_rate,
        has_chest: arguments.chest,
        has_terrain: arguments.terrain,
        has_tension: arguments.skin_tension,
        has_growth: arguments.skin_growth,
        has_fill: arguments.fill,
        has_plane: arguments.plane,
        has_fold: arguments.fold,
        has_void: arguments.pocket_void,
        has_posture: arguments.posture,
        nodes_per_side: nodes,
        measures_errors: measure_errors,
    };
    let run = move |case: u64| {
        let start = Instant::now();
        let clock = || 1e3 * start.elapsed().as_secs_f64();
        clinical.run(seed, case, Some(&clock))
    };
    let (cases, end): (Vec<ClinicalCase>, End) = run_all(arguments, run)?;
    let summary = ClinicalSummary::new(seed, clinical, &cases);
    write(arguments, json(&summary, true)?, end, cases.len(), !summary.all_converged())
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let &Arguments { seed, most_nodes, tissue_model, ref lines, ref out, .. } = arguments;
    output::check_path(out)?;
    if let Some(lines) = lines {
        output::check_path(lines)?;
    }
    if arguments.clinical {
        return run_clinical(arguments);
    }
    let is_layered = tissue_model == TissueModel::Layered;
    if arguments.chest && !is_layered {
        return Err(InputError(CHEST_OF_SHEET.to_owned()));
    }
    report_panics("; the case counts as failed");
    let has_chest = arguments.chest;
    let run = move |case: u64| {
        let population =
            if is_layered { Population::of_layered(case, has_chest) } else { Population::Sheet };
        let start = Instant::now();
        let clock = || 1e3 * start.elapsed().as_secs_f64();
        let clock: Option<&dyn Fn() -> f64> = if is_layered { Some(&clock) } else { None };
        let of_case = || run_of(population, seed, case, most_nodes, clock);
        // A defect in one case ends this case only.
        catch_unwind(AssertUnwindSafe(of_case))
            .unwrap_or_else(|_| panicked(population, seed, case, most_nodes))
    };
    let (cases, end): (Vec<Case>, End) = run_all(arguments, run)?;
    let (summary, has_failures) = if is_layered {
        let summary = LayeredSummary::new(seed, &cases);
        (json(&summary, true)?, !summary.failures.is_empty())
    } else {
        let summary = Summary::new(seed, &cases);
        (json(&summary, true)?, !summary.failures.is_empty())
    };
    write(arguments, summary, end, cases.len(), has_failures)
}

/// Runs the cases on threads; if wanted, each is written in a line at once.
fn run_all<T: Serialize + Send + 'static>(
    arguments: &Arguments,
    run: impl Fn(u64) -> T + Send + Sync + 'static,
) -> Result<(Vec<T>, End), InputError> {
    let Arguments { cases: count, lines, threads, .. } = arguments;
    let open = |path: &PathBuf| LineFile::open(path, None);
    let mut lines = lines.as_ref().map(open).transpose()?;
    let (mut cases, mut progress) = (Vec::new(), Progress::new());
    let many = Many::new(0..*count, threads.settings(), move |(): &mut (), case| run(case));
    let end = stream::run(many, |finished| {
        // The hook has reported the panic.
        let case = finished.result.unwrap_or_else(|panic| resume_unwind(Box::new(panic)));
        if let Some(lines) = &mut lines
            && lines.write((json(&case, false)? + "\n").as_bytes())?.is_break()
        {
            return Ok(ControlFlow::Break(()));
        }
        cases.push(case);
        progress.count(Some(cases.len() as f64 / *count as f64));
        Ok(ControlFlow::Continue(()))
    })?;
    Ok((cases, end))
}

/// Writes the summary of the cases, of those before a signal too.
fn write(
    arguments: &Arguments,
    summary: String,
    end: End,
    cases: usize,
    has_failures: bool,
) -> Result<ExitStatus, InputError> {
    output::write_all(&[File::new(&arguments.out, summary + "\n")])?;
    if end == End::Signal {
        stream::warn_of_signal(&format!("{cases} lines are whole"));
        return Ok(ExitStatus::Interrupted);
    }
    Ok(if has_failures { ExitStatus::NotConverged } else { ExitStatus::Converged })
}

fn json<T: Serialize>(value: &T, is_pretty: bool) -> Result<String, InputError> {
    let text =
        if is_pretty { serde_json::to_string_pretty(value) } else { serde_json::to_string(value) };
    text.map_err(|error| output::input_error(Path::new("stress"), error))
}
