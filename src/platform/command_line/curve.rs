//! `curve`: the stress–strain curve of a raw tensile test.

use super::output::{self, File};
use super::{ExitStatus, InputError, file};
use crate::table;
use crate::tensile::{self, Given, StrainUnit, StressUnit};
use std::path::PathBuf;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// A table of any locale with a strain and a stress in each row, or JSON with points; `-` is standard input.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Unit of the stresses; default: that of the header or the cells, else by the size of the numbers.
    #[arg(long, value_name = "kpa|mpa|pa", value_parser = StressUnit::of_name)]
    unit: Option<StressUnit>,
    /// Unit of the strains; default: as of the stresses.
    #[arg(long, value_name = "fraction|percent", value_parser = StrainUnit::of_name)]
    strain: Option<StrainUnit>,
    /// Output file for the curve as a scene has it; `-` is standard output.
    #[arg(long, default_value = output::STANDARD, value_name = "C.json")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let Arguments { file, unit, strain, out } = arguments;
    output::check_path(out)?;
    if output::is_input(out, file) {
        return Err(output::input_error(out, "is an input, too"));
    }
    let bytes = file::read(file, table::MAX_BYTES)?;
    let found = tensile::read(&bytes, Given { strain: *strain, stress: *unit })
        .map_err(|error| output::input_error(file, error))?;
    let json =
        serde_json::to_string(&found.spec()).map_err(|error| InputError(error.to_string()))?;
    output::write_all(&[File::new(out, json + "\n")])?;
    if let Some(form) = found.form {
        output::warn(&format!("Table: {form}."));
    }
    found.notes.iter().for_each(|note| output::warn(note));
    output::warn(&found.summary());
    Ok(ExitStatus::Converged)
}
