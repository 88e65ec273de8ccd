//! `bench`: run time against error of multigrid and of Newton's method, as a table and a chart.

use super::output::{self, File, OutputFolder};
use super::stream::{self, Signal};
use super::stress::{CHEST_OF_SHEET, tissue_model};
use super::{ExitStatus, InputError};
use crate::scene::TissueModel;
use implant_preview_lab::charts::work_precision::draw;
use implant_preview_lab::work_precision::{Case, Plan, Study, axisymmetric};
use std::path::Path;
use std::time::Instant;

#[derive(clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    folder: OutputFolder,
    /// Only one scene on coarse grids: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// The tissue model of the scenes.
    #[arg(long, value_name = "M", default_value = "sheet", value_parser = tissue_model)]
    tissue_model: TissueModel,
    /// Layered tissue: the scenes with chests and mounds instead.
    #[arg(long)]
    chest: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let folder = arguments.folder.create()?;
    if arguments.chest && arguments.tissue_model == TissueModel::Sheet {
        return Err(InputError(CHEST_OF_SHEET.to_owned()));
    }
    let (mut plan, mut case, mut name) = match (arguments.tissue_model, arguments.quick) {
        (TissueModel::Sheet, true) => (Plan::quick(), Case::Default, "work_precision"),
        (TissueModel::Sheet, false) => (Plan::full(), Case::Default, "work_precision"),
        (TissueModel::Layered, is_quick) => {
            let plan = if is_quick { Plan::layered_quick() } else { Plan::layered() };
            (plan, Case::LayeredDefault, "work_precision_layered")
        }
    };
    if arguments.chest {
        (case, name) = (Case::BodyCurved, "work_precision_chest");
        plan.cases = if arguments.quick { vec![case] } else { Case::BODY.to_vec() };
    }
    let mut study = Study::new(plan, Some(axisymmetric));
    let start = Instant::now();
    let mut clock = || 1e3 * start.elapsed().as_secs_f64();
    let error = |error| output::input_error(Path::new("bench"), error);
    let signal = Signal::default();
    signal.calls(|| ());
    while !signal.has_come() && study.advance(&mut clock).map_err(error)? {}
    let picture = draw(study.rows(), case).map_err(|error| output::input_error(folder, error))?;
    output::write_all(&[
        File::new(&folder.join(format!("{name}.csv")), study.csv()),
        File::new(&folder.join(format!("{name}.svg")), picture),
    ])?;
    if signal.has_come() {
        stream::warn_of_signal(&format!("{} rows are in the table", study.rows().len()));
        return Ok(ExitStatus::Interrupted);
    }
    Ok(ExitStatus::Converged)
}
