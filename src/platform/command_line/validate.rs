//! `validate`: errors of all nodes against references, as tables.

use super::output::{self, File, OutputFolder};
use super::{ExitStatus, InputError};
use crate::experiment::accuracy::{csv, markdown, measure};
use crate::experiment::work_precision::Case;
use std::path::Path;

#[derive(clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    folder: OutputFolder,
    /// Only centred domes on grids of 33 nodes per side: seconds instead of a minute.
    #[arg(long)]
    quick: bool,
}

const SHEET_GRIDS: [usize; 4] = [33, 65, 129, 257];
const LAYERED_GRIDS: [usize; 3] = [33, 65, 129];
const OFF_CENTRE_GRIDS: [usize; 3] = [33, 65, 129];

/// Writes `errors.csv` and `errors.md`.
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
    let mut rows = Vec::new();
    let mut is_complete = true;
    for (case, is_off_centre, nodes) in plan {
        let row = measure(case, is_off_centre, nodes)
            .map_err(|error| output::input_error(Path::new("validate"), error))?;
        is_complete &= row.is_some();
        rows.extend(row);
    }
    output::write_all(&[
        File::new(&folder.join("errors.csv"), csv(&rows)),
        File::new(&folder.join("errors.md"), markdown(&rows)),
    ])?;
    Ok(if is_complete { ExitStatus::Converged } else { ExitStatus::NotConverged })
}
