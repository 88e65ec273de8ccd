//! `tension`: the paper's tension test as a table.

use super::output::{self, File};
use super::{ExitStatus, InputError, file, in_range};
use crate::curve::{Curve, CurveSpec, Fat};
use crate::export::{number, quoted};
use crate::scene::read;
use crate::springs::Springs;
use clap::ValueEnum;
use implant_preview_lab::tension::{
    Protocol, Report, Row, Status, Test, run as run_tension, springs_name,
};
use std::path::{Path, PathBuf};

/// Header of the table.
pub(super) const COLUMNS: &str = "springs,curve,poisson_ratio,load_kpa,strain,strain_expected,transverse_strain,poisson_measured,status\n";

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The spring law.
    #[arg(long, default_value = "coupled")]
    springs: SpringsArgument,
    /// `skin`, `fat`, `adipose` (that of the paper), or a file with a curve as in a scene.
    #[arg(long, default_value = "skin", value_name = "skin|fat|adipose|FILE.json")]
    curve: String,
    /// Poisson ratio, 0 to 0.5.
    #[arg(long, default_value_t = 0.3, value_parser = poisson_ratio, allow_negative_numbers = true)]
    poisson: f64,
    /// Cells per side of the sample, 1 to 16.
    #[arg(long, default_value_t = 4, value_parser = cells, allow_negative_numbers = true)]
    cells: u8,
    /// Angle between load and grid [degrees], -360 to 360.
    #[arg(long, default_value_t = 0.0, value_parser = angle, allow_negative_numbers = true)]
    angle: f64,
    /// `paper`: 15 000 damped iterations per load; `equilibrium`: Newton's method.
    #[arg(long, default_value = "equilibrium")]
    protocol: ProtocolArgument,
    /// Output file for the table; `-` is standard output.
    #[arg(long, default_value = output::STANDARD, value_name = "T.csv")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum SpringsArgument {
    Coupled,
    Nikolaev,
}

#[derive(Clone, Copy, ValueEnum)]
enum ProtocolArgument {
    Paper,
    Equilibrium,
}

fn poisson_ratio(text: &str) -> Result<f64, String> {
    in_range(text, 0.0, 0.5)
}

fn cells(text: &str) -> Result<u8, String> {
    in_range(text, 1, 16)
}

fn angle(text: &str) -> Result<f64, String> {
    in_range(text, -360.0, 360.0)
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    output::check_path(&arguments.out)?;
    let test = Test {
        springs: match arguments.springs {
            SpringsArgument::Coupled => Springs::Coupled,
            SpringsArgument::Nikolaev => Springs::Nikolaev,
        },
        curve: read_curve(&arguments.curve)?,
        poisson_ratio: arguments.poisson,
        cells: usize::from(arguments.cells),
        angle: arguments.angle.to_radians(),
        protocol: match arguments.protocol {
            ProtocolArgument::Paper => Protocol::Paper,
            ProtocolArgument::Equilibrium => Protocol::Equilibrium,
        },
    };
    let report = run_tension(&test);
    let table = COLUMNS.to_owned() + &table_rows(&test, &arguments.curve, &report);
    output::write_all(&[File::new(&arguments.out, table)])?;
    if let Some(strain) = report.stability_lost_at {
        output::warn(&format!("stability is lost at strain {}", number(strain)));
    }
    let converged = report.rows.iter().any(|row| row.status == Status::Converged);
    Ok(if converged { ExitStatus::Converged } else { ExitStatus::NotConverged })
}

fn read_curve(name: &str) -> Result<Curve, InputError> {
    let preset = match name {
        "skin" => CurveSpec::Skin {},
        "fat" => CurveSpec::Fat { variant: Fat::default() },
        "adipose" => CurveSpec::Adipose {},
        _ => {
            let path = Path::new(name);
            let bytes = file::read(path, read::MAX_SCENE_BYTES).map_err(|error| {
                InputError(format!("{error}; allowed: skin, fat, adipose or a curve file"))
            })?;
            return read::curve(&bytes).map_err(|error| output::input_error(path, error));
        }
    };
    Curve::new(&preset).map_err(|error| output::input_error(Path::new(name), error))
}

/// The rows of a report below [`COLUMNS`]; rows without a stable shape contain no measured values.
pub(super) fn table_rows(test: &Test, curve: &str, report: &Report) -> String {
    let springs = springs_name(test.springs);
    let line = |row: &Row| {
        let [strain, across, poisson] = match row.measured {
            Some(m) => [m.strain, m.transverse_strain, m.poisson_ratio()].map(number),
            None => Default::default(),
        };
        format!(
            "{springs},{},{},{},{strain},{},{across},{poisson},{}\n",
            quoted(curve),
            number(test.poisson_ratio),
            number(row.load_kpa),
            number(row.strain_expected),
            match row.status {
                Status::Converged => "converged",
                Status::NotConverged => "not_converged",
                Status::Unstable => "unstable",
            }
        )
    };
    report.rows.iter().map(line).collect()
}
