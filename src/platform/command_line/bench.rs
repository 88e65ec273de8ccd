//! `bench`: run time against error of all methods, as a table and a chart.

use super::output::{self, File};
use super::{Answer, Refused};
use crate::experiment::charts::work_precision::draw;
use crate::experiment::work_precision::{Case, Plan, Study, axisymmetric};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The folder for `work_precision.csv` and `.svg`; made if it is missing.
    #[arg(long, value_name = "D")]
    out_dir: PathBuf,
    /// One scene on coarse grids: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<Answer, Refused> {
    let folder = &arguments.out_dir;
    output::make_folder(folder)?;
    let plan = if arguments.quick { Plan::quick() } else { Plan::full() };
    let mut study = Study::new(plan, Some(axisymmetric));
    let start = Instant::now();
    let mut clock = || 1e3 * start.elapsed().as_secs_f64();
    let refuse = |error| output::refuse(Path::new("bench"), error);
    while study.advance(&mut clock).map_err(refuse)? {}
    let picture =
        draw(study.rows(), Case::Default).map_err(|error| output::refuse(folder, error))?;
    output::write_all(&[
        File::new(&folder.join("work_precision.csv"), study.csv()),
        File::new(&folder.join("work_precision.svg"), picture),
    ])?;
    Ok(Answer::Converged)
}
