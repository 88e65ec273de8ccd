//! `bench`: run time against error of all methods, as a table and a chart.

use super::output::{self, File, OutputFolder};
use super::{ExitStatus, InputError};
use crate::experiment::charts::work_precision::draw;
use crate::experiment::work_precision::{Case, Plan, Study, axisymmetric};
use std::path::Path;
use std::time::Instant;

#[derive(clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    folder: OutputFolder,
    /// Only one scene on coarse grids: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let folder = arguments.folder.create()?;
    let plan = if arguments.quick { Plan::quick() } else { Plan::full() };
    let mut study = Study::new(plan, Some(axisymmetric));
    let start = Instant::now();
    let mut clock = || 1e3 * start.elapsed().as_secs_f64();
    let error = |error| output::input_error(Path::new("bench"), error);
    while study.advance(&mut clock).map_err(error)? {}
    let picture =
        draw(study.rows(), Case::Default).map_err(|error| output::input_error(folder, error))?;
    output::write_all(&[
        File::new(&folder.join("work_precision.csv"), study.csv()),
        File::new(&folder.join("work_precision.svg"), picture),
    ])?;
    Ok(ExitStatus::Converged)
}
