//! `schema`: the JSON Schema of a format.

use super::output::{self, File};
use super::{ExitStatus, InputError};
use crate::study::SchemaOf;
use std::path::PathBuf;

/// Arguments of `schema`.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The format: scene, result, map, map-options, bands, bands-options or times.
    #[arg(long, value_name = "FORMAT", default_value = "scene", value_parser = SchemaOf::of_name)]
    of: SchemaOf,
    /// Output file; `-` is standard output.
    #[arg(long, value_name = "S.json", default_value = output::STANDARD)]
    out: PathBuf,
}

/// Writes a schema.
pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    output::check_path(&arguments.out)?;
    output::write_all(&[File::new(&arguments.out, arguments.of.json() + "\n")])?;
    Ok(ExitStatus::Converged)
}
