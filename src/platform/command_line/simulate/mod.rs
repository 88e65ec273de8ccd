//! `simulate`: solves scenes and writes their results.

mod body;
mod done;
mod form;
mod key;
mod lines;
mod table;

use super::input::Source;
use super::output::{self, File};
use super::stream::ThreadCount;
use super::{ExitStatus, InputError, in_range};
use crate::export::{Format, Solid, profile};
use crate::measure::{Column, Selected, Selection, Status, meridians, surfaces};
use crate::scene::{CheckedScene, read};
use crate::simulate::{Simulation, Simulator};
use crate::solve::{Options, Solution};
use form::LineFormat;
use serde::Serialize;
use serde_json::value::RawValue;
use std::path::{Path, PathBuf};
use std::time::Instant;
use table::Table;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Scene files: JSON, a scene or several one behind the other, or JSON lines; `-` is standard input.
    #[arg(required_unless_present = "table", value_name = "SCENE.json")]
    scenes: Vec<PathBuf>,
    /// A scene in which the rows of `--table` replace values.
    #[arg(long, requires = "table", value_name = "SCENE.json")]
    template: Option<PathBuf>,
    /// Instead of scenes: a table (CSV, or Parquet by its name `….parquet`), a scene a row. The columns are numbers of a scene, as `implant.base_radius_mm`,
    /// `layers[0].thickness_mm`, `volume_ml`, or paths of other values in the template; `id` names the row; `-` is standard input.
    #[arg(
        long,
        requires = "template",
        conflicts_with = "scenes",
        value_name = "TABLE.csv|.parquet"
    )]
    table: Option<PathBuf>,
    /// Output file for the result; `-` is standard output. Several scenes give JSON lines.
    #[arg(long, default_value = output::STANDARD, value_name = "R.json")]
    out: PathBuf,
    /// Output file for the shape (one scene only): .stl, .obj, .ply: the deformed tissue as one closed body in mm; .glb: implant, skin
    /// and the tissue under it, each a closed body, in m.
    #[arg(long, value_name = "M.stl|.obj|.ply|.glb")]
    mesh: Option<PathBuf>,
    /// Surface of the body that the scene was made of by `scan` (one scene only): PLY, STL, OBJ or GLB. Written to `--after`.
    #[arg(long, requires = "after", value_name = "MESH")]
    body: Option<PathBuf>,
    /// Output file for the surface of `--body` over the implant: its own vertices in their order, in its own axes and unit (GLB: in m).
    #[arg(long, requires = "body", value_name = "AFTER.ply|.stl|.obj|.glb")]
    after: Option<PathBuf>,
    /// Output file for the profiles as a table, with surface and direction (one scene only); `-` is standard output.
    #[arg(long, value_name = "P.csv")]
    profile: Option<PathBuf>,
    /// Fields of the result by their paths, with commas between, as `contact_force_n,strain.max_principal`; `schema` and
    /// `status` are always written. Other fields are not computed. Default: all fields.
    #[arg(long, value_name = "FIELDS", value_delimiter = ',')]
    fields: Option<Vec<String>>,
    /// `csv`: a table with a row a scene: `id`, `scene_hash`, `status`, the fields of `--fields`, `error`. `parquet`: the same table, written
    /// in groups of 10 000 rows and readable after the end of the run, by a signal too.
    #[arg(long, value_enum, default_value_t = OutputFormat::Json, value_name = "json|csv|parquet")]
    format: OutputFormat,
    /// Leaves the profiles out of the result.
    #[arg(long)]
    no_profile: bool,
    /// Reads one scene per line, also of a single or no line, and writes a line for each.
    #[arg(long)]
    lines: bool,
    /// Lines of an earlier run, a file of `--out`: scenes that have a line there, by `id` or else by content, are skipped. The
    /// same file as `--out` is continued.
    #[arg(long, value_name = "OUT.jsonl")]
    skip_done: Option<PathBuf>,
    /// Greatest time of a solve in ms, 1 to 1e9; beyond, the result is `not_converged` with a warning.
    #[arg(long, value_name = "N", value_parser = most_ms)]
    most_ms: Option<f64>,
    /// Writes each line as soon as it is ready; default: in the order of the input.
    #[arg(long)]
    unordered: bool,
    #[command(flatten)]
    threads: ThreadCount,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum OutputFormat {
    Json,
    Csv,
    Parquet,
}

fn most_ms(text: &str) -> Result<f64, String> {
    in_range(text, 1.0, 1e9)
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let mesh = arguments.mesh.as_deref().map(|path| format_of(path, "--mesh")).transpose()?;
    check_paths(arguments)?;
    let format = line_format(arguments)?;
    let wants_one =
        arguments.mesh.is_some() || arguments.profile.is_some() || arguments.after.is_some();
    let mut sources = Vec::new();
    for path in &arguments.scenes {
        // JSON lines by the extension, else by the first lines.
        let is_named = path.extension().is_some_and(|e| e == "jsonl" || e == "ndjson");
        let is_lines = arguments.lines || is_named && !wants_one;
        sources.push(Source::open(path, is_lines.then_some(true))?);
    }
    let is_table = arguments.format != OutputFormat::Json;
    let is_stream =
        arguments.lines || is_table || arguments.skip_done.is_some() || arguments.unordered;
    if let [source] = &mut sources[..]
        && source.is_one()
        && !is_stream
    {
        let scene = checked(source)?;
        let outputs = solve(arguments, mesh, &scene, &format.selection)?;
        output::write_all(&outputs.0)?;
        return Ok(outputs.1);
    }
    if wants_one {
        let line = "--mesh, --profile and --after: at least 2 scenes, lines or a table; allowed: one scene";
        return Err(InputError(line.to_owned()));
    }
    for source in &mut sources {
        if source.is_lines() && source.is_empty && !arguments.lines {
            let line = "file is empty; allowed: one scene per line";
            return Err(output::input_error(source.path(), line));
        }
        if source.is_one() && source.is_file() {
            checked(source)?;
        }
    }
    let table = match (&arguments.template, &arguments.table) {
        (Some(template), Some(path)) => {
            sources.push(Source::of_table(path)?);
            sources.last_mut().map(|source| Table::read(template, source)).transpose()?
        }
        _ => None,
    };
    lines::run(arguments, format, table, sources)
}

/// The scene of a file of one scene.
fn checked(source: &mut Source) -> Result<(CheckedScene, Option<Box<RawValue>>), InputError> {
    let bytes = source.whole()?;
    let scene = read::utf8(&bytes)
        .and_then(|text| Ok((CheckedScene::from_json(text)?, key::Key::of(text).id())));
    scene.map_err(|error| output::input_error(source.path(), error))
}

/// The format of a mesh file of an option, by its extension.
fn format_of(path: &Path, option: &str) -> Result<Format, InputError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    Format::of_extension(&extension).ok_or_else(|| {
        let allowed = "allowed: a file name ending in .stl, .obj, .ply or .glb";
        output::input_error(path, format!("{option}: unknown format; {allowed}"))
    })
}

/// Checks that all outputs are different files, and none of them an input.
fn check_paths(arguments: &Arguments) -> Result<(), InputError> {
    let outputs: Vec<&Path> = [
        Some(&arguments.out),
        arguments.mesh.as_ref(),
        arguments.profile.as_ref(),
        arguments.after.as_ref(),
    ]
    .into_iter()
    .flatten()
    .map(PathBuf::as_path)
    .collect();
    for (k, path) in outputs.iter().enumerate() {
        output::check_path(path)?;
        if outputs[..k].iter().any(|other| output::is_same_file(other, path)) {
            let name = if output::is_standard(path) {
                "standard output".to_owned()
            } else {
                path.display().to_string()
            };
            return Err(InputError(format!(
                "{name}: named for two outputs; allowed: one output per file"
            )));
        }
        let mut inputs = arguments.scenes.iter().chain(&arguments.template).chain(&arguments.table);
        if inputs.any(|input| output::is_input(path, input)) {
            return Err(output::input_error(path, "is an input scene; allowed: another file"));
        }
        if arguments.body.iter().any(|body| output::is_input(path, body)) {
            return Err(output::input_error(
                path,
                "is the surface of --body; allowed: another file",
            ));
        }
    }
    Ok(())
}

/// The fields that the results contain, and the form of their lines.
fn line_format(arguments: &Arguments) -> Result<LineFormat, InputError> {
    let of = |paths: &[String]| Selection::of(paths).map_err(in_fields);
    let format = match (arguments.format, &arguments.fields) {
        (OutputFormat::Json, None) => LineFormat::json(Selection::all()),
        (OutputFormat::Json, Some(paths)) => LineFormat::json(of(paths)?),
        (OutputFormat::Csv | OutputFormat::Parquet, None) => {
            let name = if arguments.format == OutputFormat::Csv { "csv" } else { "parquet" };
            let words = "--fields is missing; allowed: the columns, as contact_force_n,strain.max_principal";
            return Err(InputError(format!("--format {name}: {words}")));
        }
        (OutputFormat::Parquet, _) if arguments.skip_done.is_some() => {
            let line =
                "--skip-done: a Parquet file is not continued; allowed: --format csv or json";
            return Err(InputError(line.to_owned()));
        }
        (OutputFormat::Csv | OutputFormat::Parquet, Some(paths)) => {
            let columns = columns(paths)?;
            let fields: Vec<String> = columns.iter().map(Column::field).collect();
            LineFormat::table(of(&fields)?, columns)
        }
    };
    if !arguments.no_profile {
        return Ok(format);
    }
    if format.selection.names_a_profile() {
        let line = "--no-profile: --fields names a profile; allowed: one of the two";
        return Err(InputError(line.to_owned()));
    }
    Ok(format.without_profile())
}

fn in_fields(error: impl std::fmt::Display) -> InputError {
    InputError(format!("--fields: {error}"))
}

/// The columns of a table of results: the status, then the fields of the paths.
fn columns(paths: &[String]) -> Result<Vec<Column>, InputError> {
    const STATUS: &str = "status";
    let others = paths.iter().map(String::as_str).filter(|path| *path != STATUS);
    let mut columns: Vec<Column> = Vec::new();
    for path in std::iter::once(STATUS).chain(others) {
        let column = Column::of(path).map_err(in_fields)?;
        if columns.contains(&column) {
            let line = format!("{path:?} is named twice; allowed: each column once");
            return Err(in_fields(line));
        }
        columns.push(column);
    }
    Ok(columns)
}

/// A clock that starts at zero.
struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn ms(&self) -> f64 {
        1e3 * self.0.elapsed().as_secs_f64()
    }
}

#[derive(Serialize)]
struct WithId<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'a RawValue>,
    #[serde(flatten)]
    result: Selected<'a>,
}

/// The bodies of a mesh file: a viewer's GLB has all of them, the other formats have the whole tissue.
fn bodies(format: Format, solution: &Solution) -> Vec<Solid> {
    let surfaces = surfaces(solution);
    match format {
        Format::Glb => Solid::bodies(&surfaces, &solution.problem().obstacle.dome),
        Format::Stl | Format::Obj | Format::Ply => vec![Solid::tissue(&surfaces)],
    }
}

/// Solves a single scene; returns the output files. A scene without a shape has no mesh.
fn solve(
    arguments: &Arguments,
    format: Option<Format>,
    (scene, id): &(CheckedScene, Option<Box<RawValue>>),
    written: &Selection,
) -> Result<(Vec<File>, ExitStatus), InputError> {
    let Arguments { out, mesh, profile: table, most_ms, .. } = arguments;
    let body = body::Body::open(arguments, scene.scene())?;
    let mut simulator = Simulator::default();
    simulator.most_ms = *most_ms;
    let clock = Clock::start();
    let Simulation { outcome, solution } =
        simulator.run(scene, Options::default(), written, Some(&|| clock.ms()));
    let result = WithId { id: id.as_deref(), result: written.of_outcome(&outcome) };
    let json = serde_json::to_string_pretty(&result);
    let json = json.map_err(|error| InputError(format!("result: {error}")))? + "\n";
    let mut files = vec![File::new(out, json)];
    let has_shape = outcome.status != Status::Unstable && solution.report().invalid.is_none();
    let not_written = |path: &Path| {
        let why = outcome.warnings.first().map_or("the scene has no stable shape", String::as_str);
        output::warn(&format!("{}: not written: {why}", path.display()));
    };
    match (mesh, format) {
        (Some(path), Some(format)) if has_shape => {
            let bodies = bodies(format, &solution);
            let mirrored = || bodies.iter().cloned().map(Solid::mirrored).collect();
            let bodies = if scene.scene().is_right() { mirrored() } else { bodies };
            files.push(File::new(path, format.encode(&bodies)));
        }
        (Some(path), _) => not_written(path),
        (None, _) => {}
    }
    match body {
        Some(body) if has_shape => {
            let (file, measures) = body.after(&solution);
            files.push(file);
            output::line(&measures);
        }
        Some(body) => not_written(body.after_path()),
        None => {}
    }
    if let Some(path) = table {
        let lines = if has_shape { meridians(&solution) } else { Vec::new() };
        files.push(File::new(path, profile(&lines)));
    }
    let is_converged = outcome.status == Status::Converged;
    Ok((files, if is_converged { ExitStatus::Converged } else { ExitStatus::NotConverged }))
}
