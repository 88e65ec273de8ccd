//! `scan`: the scene of a body's surface and a surgeon's marks.

use super::measures::BodyMeasures;
use super::output::{self, File};
use super::{ExitStatus, InputError, file, in_range};
use crate::body::fit::{self, Settings};
use crate::body::frame::Frame;
use crate::body::marks::{Marks, Side};
use crate::body::mound::mound;
use crate::body::quality::Quality;
use crate::body::read::{self, Read, Unit};
use crate::scene::read::{json, utf8};
use crate::scene::{COVER_MM, Scene};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Greatest length of a file of marks \[bytes\].
const MAX_MARKS: usize = 100_000;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Surface of the body: PLY, STL, OBJ or GLB; `-` is standard input.
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// The marks: a JSON object of points `[x, y, z]` in the coordinates and the unit of the mesh: `sternal_notch`, `navel`, `nipple_left`, `nipple_right`,
    /// of the side `fold_…`, `upper_…`, `medial_…`, `lateral_…`, optionally `implant_centre_…` (`…` is `left` or `right`, the patient's).
    #[arg(long, value_name = "MARKS.json")]
    marks: PathBuf,
    /// The patient's side.
    #[arg(long, value_enum, value_name = "left|right")]
    side: SideName,
    /// Thickness of the tissue beside the breast in mm, half a pinch: 6 to 30.
    #[arg(long, default_value = "10", value_name = "MM", value_parser = cover, allow_negative_numbers = true)]
    cover: f64,
    /// Unit of mesh and marks; `auto`: by the extent of the mesh.
    #[arg(long, value_enum, default_value_t = UnitName::Auto, value_name = "auto|mm|cm|m")]
    unit: UnitName,
    /// Keeps the surface in the scene, reduced to 12 000 vertices (up to 300 kB).
    #[arg(long)]
    keep_surface: bool,
    /// Output file for the scene; `-` is standard output.
    #[arg(long, default_value = output::STANDARD, value_name = "SCENE.json")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum SideName {
    Left,
    Right,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum UnitName {
    Auto,
    Mm,
    Cm,
    M,
}

fn cover(text: &str) -> Result<f64, String> {
    in_range(text, COVER_MM.0, COVER_MM.1)
}

/// The line of figures.
#[derive(Serialize)]
struct Figures {
    no_skin_percent: f64,
    data_percent: f64,
    radius_across_mm: Option<f64>,
    radius_along_mm: Option<f64>,
    footprint_ml: f64,
    thickness_mm: [f64; 3],
    measures: Option<BodyMeasures>,
    warnings: Vec<String>,
}

impl Figures {
    fn of(quality: &Quality, measures: Option<BodyMeasures>, notes: Vec<String>) -> Self {
        let rounded = |value: f64| (100.0 * value).round() / 100.0;
        // A flat chest has no radius.
        let radius = |value: f64| (value.abs() < 1e6).then(|| rounded(value));
        Self {
            no_skin_percent: rounded(quality.no_skin_percent),
            data_percent: rounded(quality.data_percent),
            radius_across_mm: radius(quality.radius_across_mm),
            radius_along_mm: radius(quality.radius_along_mm),
            footprint_ml: rounded(quality.footprint_ml),
            thickness_mm: quality.thickness_mm.map(rounded),
            measures,
            warnings: quality.warnings().into_iter().chain(notes).collect(),
        }
    }
}

/// The surface of a file; of a unit, or of the one that its extent suggests.
pub(super) fn surface(path: &Path, unit: Option<Unit>) -> Result<Read, InputError> {
    let bytes = file::read(path, read::MAX_BYTES)?;
    let mut found = read::read(&bytes, &path.to_string_lossy())
        .map_err(|error| output::input_error(path, error))?;
    if let Some(unit) = unit {
        found.set_unit(unit);
    }
    Ok(found)
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let Arguments { mesh, marks: marks_path, cover, out, .. } = arguments;
    output::check_path(out)?;
    for input in [mesh, marks_path] {
        if output::is_input(out, input) {
            return Err(output::input_error(out, "is an input, too"));
        }
    }
    if output::is_standard(mesh) && output::is_standard(marks_path) {
        let line = "standard input: named for mesh and marks; allowed: one of them";
        return Err(InputError(line.to_owned()));
    }
    let side = match arguments.side {
        SideName::Left => Side::Left,
        SideName::Right => Side::Right,
    };
    let given = match arguments.unit {
        UnitName::Auto => None,
        UnitName::Mm => Some(Unit::Mm),
        UnitName::Cm => Some(Unit::Cm),
        UnitName::M => Some(Unit::M),
    };
    let text = file::read(marks_path, MAX_MARKS)?;
    let in_marks = |error: &dyn std::fmt::Display| output::input_error(marks_path, error);
    if text.len() > MAX_MARKS {
        return Err(in_marks(&format!("is longer than {MAX_MARKS} bytes")));
    }
    let text = utf8(&text).map_err(|error| in_marks(&error))?;
    let marks: Marks = json(text, "marks").map_err(|error| in_marks(&error))?;
    let Read { surface, unit, cleaned, .. } = surface(mesh, given)?;
    let marks = marks.scaled(unit.factor());
    let settings = Settings { cover_mm: *cover, ..Settings::default() };
    let fitted = fit::fit(&surface, &marks, side, &settings).map_err(|error| match error {
        fit::FitError::Marks(error) => in_marks(&error),
        error => output::input_error(mesh, error),
    })?;
    let scene = Scene::of_body(&fitted, (&marks, side), *cover, unit).and_then(|mut scene| {
        if arguments.keep_surface {
            scene.keep_surface(&surface)?;
        }
        Ok(scene)
    });
    let scene = scene.map_err(|error| {
        output::input_error(mesh, format!("the fitted body carries no scene: {error}"))
    })?;
    let mut notes = cleaned.notes();
    if given.is_none() && unit != Unit::Mm {
        notes.push(format!(
            "The lengths of the file are read as {}: notch to nipple is {:.1} cm.",
            unit.name(),
            0.1 * marks.notch_nipple(side)
        ));
    }
    let error = |error: serde_json::Error| InputError(error.to_string());
    let measures = Frame::of_body(&marks).ok().map(|frame| {
        BodyMeasures::of(&surface, (&marks, &frame), (side, mound(&fitted, &marks, side)))
    });
    let figures = Figures::of(&fitted.quality, measures, notes);
    let figures = serde_json::to_string(&figures).map_err(error)?;
    let json = serde_json::to_string(&scene).map_err(error)?;
    output::write_all(&[File::new(out, json + "\n")])?;
    output::line(&figures);
    Ok(ExitStatus::Converged)
}
