//! `simulate`: solves scenes and writes their results.

use super::output::{self, File};
use super::{ExitStatus, InputError, input};
use crate::export::{Format, Solid, profile};
use crate::measure::{Outcome, Selection, Status, surfaces};
use crate::platform::runner::Threads;
use crate::scene::{CheckedScene, read};
use crate::simulate::{Simulation, Simulator};
use crate::solve::Options;
use crate::study::Runner;
use std::cell::RefCell;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Scene files, JSON or JSON lines; `-` is standard input.
    #[arg(required = true, value_name = "SCENE.json")]
    scenes: Vec<PathBuf>,
    /// Output file for the result; `-` is standard output. Several scenes give JSON lines.
    #[arg(long, default_value = output::STANDARD, value_name = "R.json")]
    out: PathBuf,
    /// Output file for the deformed tissue as a closed surface: .stl, .obj, .ply or .glb (one scene only).
    #[arg(long, value_name = "M.stl|.obj|.ply|.glb")]
    mesh: Option<PathBuf>,
    /// Output file for the profile as a table (one scene only); `-` is standard output.
    #[arg(long, value_name = "P.csv")]
    profile: Option<PathBuf>,
    /// Fields of the result by their paths, with commas between, as `contact_force_n,strain.max_principal`; `schema` and
    /// `status` are always written. Other fields are not computed. Default: all fields.
    #[arg(long, value_name = "FIELDS", value_delimiter = ',')]
    fields: Option<Vec<String>>,
    /// Leaves the profiles out of the result.
    #[arg(long)]
    no_profile: bool,
}

thread_local! {
    /// Keeps the grids and tables that the scenes of a thread share.
    static SIMULATOR: RefCell<Simulator> = RefCell::default();
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, InputError> {
    let format = arguments.mesh.as_deref().map(mesh_format).transpose()?;
    check_paths(arguments)?;
    let mut scenes = Vec::new();
    for path in &arguments.scenes {
        scenes.extend(read_scenes(path)?);
    }
    if scenes.len() != 1 && (arguments.mesh.is_some() || arguments.profile.is_some()) {
        let count = scenes.len();
        return Err(InputError(format!(
            "--mesh and --profile: {count} scenes; allowed: one scene"
        )));
    }
    let wanted = Wanted {
        surface: format.is_some(),
        is_single: scenes.len() == 1,
        written: selection(arguments)?,
        // A table of the profile is written from the result.
        measured: match &arguments.profile {
            Some(_) => Selection::all(),
            None => selection(arguments)?,
        },
    };
    let runner = Threads::new(move |scene| solve(&scene, &wanted));
    // The hook has reported the panic.
    let solved = runner.run_all(scenes).unwrap_or_else(|panic| resume_unwind(Box::new(panic)));
    let solved = solved.into_iter().collect::<Result<Vec<_>, _>>()?;
    let all_converged = solved.iter().all(|scene| scene.status == Status::Converged);
    output::write_all(&outputs(arguments, format, solved))?;
    Ok(if all_converged { ExitStatus::Converged } else { ExitStatus::NotConverged })
}

/// The format of a mesh file, by its extension.
fn mesh_format(path: &Path) -> Result<Format, InputError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    Format::of_extension(&extension).ok_or_else(|| {
        output::input_error(
            path,
            "--mesh: unknown format; allowed: a file name ending in .stl, .obj, .ply or .glb",
        )
    })
}

/// Checks that all outputs are different files, and none of them an input.
fn check_paths(arguments: &Arguments) -> Result<(), InputError> {
    let outputs: Vec<&Path> =
        [Some(&arguments.out), arguments.mesh.as_ref(), arguments.profile.as_ref()]
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
        let is_input = |scene: &PathBuf| {
            let same_file =
                |a: &Path, b: &Path| Some(a.canonicalize().ok()? == b.canonicalize().ok()?);
            same_file(scene, path) == Some(true)
        };
        if !output::is_standard(path) && arguments.scenes.iter().any(is_input) {
            return Err(output::input_error(path, "is an input scene; allowed: another file"));
        }
    }
    Ok(())
}

/// Reads the scenes of a file: one scene, or one scene per line.
fn read_scenes(path: &Path) -> Result<Vec<CheckedScene>, InputError> {
    let bytes = input::read(path, read::MAX_LINES_BYTES)?;
    // JSON lines by the extension; `read` also detects them by the first line.
    let is_lines = path.extension().is_some_and(|e| e == "jsonl" || e == "ndjson");
    let format = if is_lines { read::Format::JsonLines } else { read::Format::Json };
    read::scenes(&bytes, format).map_err(|error| output::input_error(path, error))
}

/// Result of a scene as JSON text; for a single scene also the content of the other outputs.
struct Solved {
    json: String,
    status: Status,
    outcome: Option<Outcome>,
    surface: Option<Solid>,
}

/// What a solve returns.
struct Wanted {
    surface: bool,
    /// Is the scene the only one?
    is_single: bool,
    /// Fields of the JSON text.
    written: Selection,
    /// Fields that are computed.
    measured: Selection,
}

/// The fields that the result contains.
fn selection(arguments: &Arguments) -> Result<Selection, InputError> {
    let selection = match &arguments.fields {
        None => Selection::all(),
        Some(paths) => {
            Selection::of(paths).map_err(|error| InputError(format!("--fields: {error}")))?
        }
    };
    if arguments.no_profile && selection.names_a_profile() {
        let line = "--no-profile: --fields names a profile; allowed: one of the two";
        return Err(InputError(line.to_owned()));
    }
    Ok(if arguments.no_profile { selection.without_profile() } else { selection })
}

fn solve(scene: &CheckedScene, wanted: &Wanted) -> Result<Solved, InputError> {
    let &Wanted { surface, is_single, ref written, ref measured } = wanted;
    let start = Instant::now();
    let clock = || start.elapsed().as_secs_f64() * 1000.0;
    let Simulation { outcome, solution } = SIMULATOR.with_borrow_mut(|simulator| {
        simulator.run(scene, Options::default(), measured, Some(&clock))
    });
    let status = outcome.status;
    let has_shape = status != Status::Unstable;
    let surface = (surface && has_shape).then(|| Solid::tissue(&surfaces(&solution)));
    let json = if is_single {
        serde_json::to_string_pretty(&written.of_outcome(&outcome))
    } else {
        serde_json::to_string(&written.of_outcome(&outcome))
    };
    let json = json.map_err(|error| InputError(format!("result: {error}")))? + "\n";
    Ok(Solved { json, status, outcome: is_single.then_some(outcome), surface })
}

/// The output files of this run. A scene without a stable shape has no mesh.
fn outputs(arguments: &Arguments, format: Option<Format>, solved: Vec<Solved>) -> Vec<File> {
    let (mut text, mut files) = (String::new(), Vec::new());
    for Solved { json, outcome, surface, .. } in solved {
        text += &json;
        let Some(outcome) = outcome else { continue };
        if let (Some(path), Some(format)) = (&arguments.mesh, format) {
            match &surface {
                Some(surface) => files.push(File::new(path, format.encode(surface))),
                None => output::warn(&format!(
                    "{}: not written: {}",
                    path.display(),
                    outcome
                        .warnings
                        .first()
                        .map_or("the scene has no stable shape", String::as_str)
                )),
            }
        }
        if let Some(path) = &arguments.profile {
            files.push(File::new(path, profile(&outcome)));
        }
    }
    files.insert(0, File::new(&arguments.out, text));
    files
}
