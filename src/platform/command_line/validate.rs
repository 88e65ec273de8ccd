//! `validate`: errors of all nodes against references, the model against measurements, and verification.

use super::output::{self, File, OutputFolder};
use super::{ExitStatus, InputError};
use implant_preview_lab::accuracy::{csv, markdown, measure};
use implant_preview_lab::charts::measurement::draw;
use implant_preview_lab::work_precision::Case;
use implant_preview_lab::{measurements, opening_plan, verification};
use std::path::Path;

#[derive(clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    folder: OutputFolder,
    /// Only centred domes on grids of 33 nodes per side, measurements on 33, verification up to 65: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
}

const SHEET_GRIDS: [usize; 4] = [33, 65, 129, 257];
const LAYERED_GRIDS: [usize; 3] = [33, 65, 129];
const OFF_CENTRE_GRIDS: [usize; 3] = [33, 65, 129];

/// Nodes per side of the scenes that are compared with measurements, and with `--quick`.
const MEASUREMENT_GRID: (usize, usize) = (65, 33);

/// Writes `errors`, `verification`, `opening-plan` and `measurements` as CSV, Markdown or JSON, and a chart for each measurement.
pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let folder = arguments.folder.create()?;
    let count = |all: usize| if arguments.quick { 1 } else { all };
    let mut plan: Vec<(Case, bool, usize)> = Vec::new();
    let mut add = |cases: &[Case], is_off_centre: bool, grids: &[usize]| {
        for &case in cases {
            plan.extend(grids[..count(grids.len())].iter().map(|n| (case, is_off_centre, *n)));
        }
    };
    add(&Case::ALL, false, &SHEET_GRIDS);
    if !arguments.quick {
        add(&Case::ALL, true, &OFF_CENTRE_GRIDS);
    }
    add(&Case::LAYERED, false, &LAYERED_GRIDS);
    add(&Case::BODY, false, &LAYERED_GRIDS);
    let mut rows = Vec::new();
    let mut is_complete = true;
    for (case, is_off_centre, nodes) in plan {
        let row = measure(case, is_off_centre, nodes)
            .map_err(|error| output::input_error(Path::new("validate"), error))?;
        is_complete &= row.is_some();
        rows.extend(row);
    }
    let mut files = vec![
        File::new(&folder.join("errors.csv"), csv(&rows)),
        File::new(&folder.join("errors.md"), markdown(&rows)),
    ];
    files.extend(measurement_files(folder, arguments.quick)?);
    let parts =
        opening_plan::parts().map_err(|error| output::input_error(Path::new("validate"), error))?;
    files.push(File::new(&folder.join("opening-plan.md"), opening_plan::markdown(&parts)));
    let checks = verification::all(arguments.quick)
        .map_err(|error| output::input_error(Path::new("validate"), error))?;
    is_complete &= checks.iter().all(verification::Check::is_passed);
    files.push(File::new(&folder.join("verification.csv"), verification::csv(&checks)));
    files.push(File::new(&folder.join("verification.md"), verification::markdown(&checks)));
    output::write_all(&files)?;
    Ok(if is_complete { ExitStatus::Converged } else { ExitStatus::NotConverged })
}

/// The comparisons with measurements: a table and a chart each, and all of them as Markdown and JSON.
fn measurement_files(folder: &Path, is_quick: bool) -> Result<Vec<File>, InputError> {
    let refused = |error: &dyn std::fmt::Display| output::input_error(Path::new("validate"), error);
    let (nodes, quick_nodes) = MEASUREMENT_GRID;
    let comparisons = measurements::all(if is_quick { quick_nodes } else { nodes })
        .map_err(|error| refused(&error))?;
    let mut files = Vec::new();
    for comparison in &comparisons {
        let path = |ending: &str| folder.join(format!("measurement-{}.{ending}", comparison.name));
        files.push(File::new(&path("csv"), comparison.csv()));
        files.push(File::new(&path("svg"), draw(comparison).map_err(|error| refused(&error))?));
    }
    let text: Vec<String> = comparisons.iter().map(measurements::Comparison::markdown).collect();
    files.push(File::new(&folder.join("measurements.md"), text.join("\n")));
    files.push(File::new(&folder.join("measurements.json"), measurements::json(&comparisons)));
    Ok(files)
}
