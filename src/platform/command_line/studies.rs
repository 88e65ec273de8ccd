//! `map` and `bands`: studies of one scene on all threads.

use super::output::{self, File, OutputFolder};
use super::stream::{self, Signal, ThreadCount};
use super::{ExitStatus, InputError, file, in_range};
use crate::export::number;
use crate::scene::read::{self, Format};
use crate::scene::{Field, MAX_SCENE_BYTES, Scene, limits};
use crate::study::{
    Axis, Bands, BandsSettings, Cases, Evaluator, JobThreads, Map, MapSettings, NOTES, PointStatus,
    Quantity, SAMPLES, Study, Unknown, run as run_study,
};
use implant_preview_charts::scene_map;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};

/// Arguments of `map`.
#[derive(clap::Args)]
pub(super) struct MapArguments {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// Number along x: FIELD=FROM:TO:COUNT, as base_width_mm=90:140:20.
    #[arg(long, value_name = "FIELD=FROM:TO:COUNT", value_parser = axis)]
    x: Option<Axis>,
    /// Number along y; without --y a curve. Without --x and --y: base width and projection, 20 by 20.
    #[arg(long, value_name = "FIELD=FROM:TO:COUNT", value_parser = axis, requires = "x")]
    y: Option<Axis>,
    /// Quantity of the contour lines and of the chart.
    #[arg(long, value_name = "QUANTITY", default_value = "greatest_strain", value_parser = quantity)]
    show: Quantity,
    /// Nodes per side of the points.
    #[arg(long, value_name = "N", default_value_t = MapSettings::default().nodes_per_side, value_parser = nodes, allow_negative_numbers = true)]
    nodes: usize,
    /// Solve every point; without --all up to 70, and the others are interpolated.
    #[arg(long)]
    all: bool,
    /// Leave out the comparison of 9 points with 129 nodes per side.
    #[arg(long)]
    no_check: bool,
    /// Solve points without an answer beside points with one as `simulate` does, at most 100: seconds each.
    #[arg(long)]
    full_border: bool,
    #[command(flatten)]
    threads: ThreadCount,
    #[command(flatten)]
    folder: OutputFolder,
}

/// Arguments of `bands`.
#[derive(clap::Args)]
pub(super) struct BandsArguments {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// Number of samples, 16 to 16384.
    #[arg(long, value_name = "N", value_parser = samples, allow_negative_numbers = true)]
    samples: Option<usize>,
    /// Seed; equal seeds give equal samples on every machine.
    #[arg(long, value_name = "S", value_parser = seed, allow_negative_numbers = true)]
    seed: Option<u32>,
    /// Rows of the importance, 0 (no importance) or 16 to the number of samples.
    #[arg(long, value_name = "N", value_parser = rows, allow_negative_numbers = true)]
    importance: Option<usize>,
    /// Nodes per side of the samples; default: 65 of a sheet, 33 of layered tissue.
    #[arg(long, value_name = "N", value_parser = nodes, allow_negative_numbers = true)]
    nodes: Option<usize>,
    /// An unknown that does not vary; may be given several times.
    #[arg(long, value_name = "NAME", value_parser = unknown)]
    without: Vec<Unknown>,
    /// File with choices: samples, seed, importance_rows, grid, unknowns. Options of the command line replace its fields.
    #[arg(long, value_name = "CHOICES.json")]
    settings: Option<PathBuf>,
    #[command(flatten)]
    threads: ThreadCount,
    /// Output file; `-` is standard output.
    #[arg(long, value_name = "B.json", default_value = output::STANDARD)]
    out: PathBuf,
}

fn axis(text: &str) -> Result<Axis, String> {
    Axis::parse(text).map_err(|error| error.to_string())
}

fn quantity(text: &str) -> Result<Quantity, String> {
    Quantity::of_name(text)
}

fn unknown(text: &str) -> Result<Unknown, String> {
    Unknown::of_name(text)
}

fn seed(text: &str) -> Result<u32, String> {
    in_range(text, 0, u32::MAX)
}

fn nodes(text: &str) -> Result<usize, String> {
    in_range(text, limits::NODES_PER_SIDE.0, limits::NODES_PER_SIDE.1)
}

fn samples(text: &str) -> Result<usize, String> {
    in_range(text, SAMPLES.0, SAMPLES.1)
}

/// Rows of the importance; the study compares the number with that of the samples.
fn rows(text: &str) -> Result<usize, String> {
    in_range(text, 0, SAMPLES.1)
}

/// The default map: base width and projection, 20 by 20, over the typical round implants.
fn default_axes() -> Vec<Axis> {
    use crate::clinical::limits::{TYPICAL_PROJECTION_MM, TYPICAL_WIDTH_MM};
    use crate::study::Parameter;
    let axis = |field, (from, to)| Axis { field, from, to, count: 20 };
    vec![
        axis(Parameter::BaseWidth, TYPICAL_WIDTH_MM),
        axis(Parameter::of(Field::Projection), TYPICAL_PROJECTION_MM),
    ]
}

pub(super) fn scene(path: &Path) -> Result<Scene, InputError> {
    let bytes = file::read(path, MAX_SCENE_BYTES)?;
    let scenes =
        read::scenes(&bytes, Format::Json).map_err(|error| output::input_error(path, error))?;
    let count = scenes.len();
    let mut scenes = scenes.into_iter();
    match (scenes.next(), scenes.next()) {
        (Some(scene), None) => Ok(scene.into_scene()),
        _ => Err(output::input_error(path, format!("{count} scenes; allowed: one scene"))),
    }
}

/// Solves studies one after the other, until the end or a signal.
pub(super) struct Solver {
    runner: JobThreads<Box<dyn FnMut() -> bool>>,
    store: Cases,
    signal: Signal,
}

impl Solver {
    /// A solver of studies; a solver of scenes for each thread goes from job to job.
    pub(super) fn new(threads: &ThreadCount) -> Result<Self, InputError> {
        let signal = Signal::default();
        let flag = signal.clone();
        let is_ended: Box<dyn FnMut() -> bool> = Box::new(move || flag.has_come());
        let work = Evaluator::evaluate_guarded;
        let runner = JobThreads::new(threads.get(), work, is_ended).map_err(stream::no_threads)?;
        signal.calls(runner.canceller());
        Ok(Self { runner, store: Cases::default(), signal })
    }

    pub(super) fn solve(&mut self, study: &mut dyn Study) {
        // The hook has reported the panic.
        run_study(study, &mut self.store, &mut self.runner)
            .unwrap_or_else(|panic| resume_unwind(Box::new(panic)));
    }

    /// The status of a run with or without values, unless a signal has ended the run.
    pub(super) fn status(&self, study: &dyn Study, has_values: bool) -> ExitStatus {
        if self.signal.has_come() {
            let (done, all) = study.progress();
            stream::warn_of_signal(&format!("{done} of {all} scenes are in the output"));
            return ExitStatus::Interrupted;
        }
        if has_values { ExitStatus::Converged } else { ExitStatus::NotConverged }
    }
}

/// `map`: writes `map.csv`, `map.json` and `map.svg`.
pub(super) fn map(arguments: &MapArguments) -> Result<ExitStatus, InputError> {
    let scene = scene(&arguments.scene)?;
    let mut axes: Vec<Axis> = arguments.x.into_iter().chain(arguments.y).collect();
    if axes.is_empty() {
        axes = default_axes();
    }
    let settings = MapSettings { nodes_per_side: arguments.nodes, ..MapSettings::default() };
    let mut map =
        Map::new(&scene, &axes, settings).map_err(|error| InputError(format!("map: {error}")))?;
    if !arguments.all {
        map = map.sampled();
    }
    if arguments.full_border {
        map = map.with_full_border();
    }
    let folder = arguments.folder.create()?;
    let mut solver = Solver::new(&arguments.threads)?;
    solver.solve(&mut map);
    let has_check = !arguments.no_check && map.is_done();
    let mut check = if has_check { map.check() } else { None };
    if let Some(check) = &mut check {
        solver.solve(check);
    }
    let show = arguments.show;
    let file = map.file(show, check.as_ref());
    let mut lines = file.notes.clone();
    if let Some(check) = &file.check {
        let (factor, unit) = show.display();
        let shown = check.differences.iter().find(|difference| difference.quantity == show);
        lines.extend(match shown {
            Some(found) => Some(format!(
                "{} of {} checked points converged at {} nodes per side; greatest difference of the {}: {} {unit}.",
                check.converged,
                check.points,
                check.grid.nodes_per_side,
                show.label(),
                number((found.difference * factor * 1e3).round() / 1e3)
            )),
            None => (check.converged == 0)
                .then(|| "No checked point converged on both grids.".to_owned()),
        });
    }
    let json =
        serde_json::to_string_pretty(&file).map_err(|error| InputError(format!("map: {error}")))?;
    let picture =
        scene_map::draw(&map, show).map_err(|error| InputError(format!("map: {error}")))?;
    output::write_all(&[
        File::new(&folder.join("map.csv"), map.csv()),
        File::new(&folder.join("map.json"), json + "\n"),
        File::new(&folder.join("map.svg"), picture),
    ])?;
    lines.iter().for_each(|line| output::warn(line));
    let is_converged = |(status, _): &(PointStatus, usize)| *status == PointStatus::Converged;
    let has_values = map.counts().iter().any(is_converged);
    Ok(solver.status(&map, has_values))
}

/// `bands`: writes the bands as JSON.
pub(super) fn bands(arguments: &BandsArguments) -> Result<ExitStatus, InputError> {
    output::check_path(&arguments.out)?;
    let scene = scene(&arguments.scene)?;
    let mut settings = match &arguments.settings {
        None => BandsSettings::default(),
        Some(path) => {
            let bytes = file::read(path, MAX_SCENE_BYTES)?;
            let text = std::str::from_utf8(&bytes).map_err(|error| {
                output::input_error(path, format!("{error}; allowed: JSON in UTF-8"))
            })?;
            BandsSettings::from_json(text).map_err(|error| output::input_error(path, error))?
        }
    };
    settings.samples = arguments.samples.unwrap_or(settings.samples);
    settings.seed = arguments.seed.unwrap_or(settings.seed);
    settings.importance_rows = match arguments.importance {
        Some(rows) => rows,
        // Few samples have few rows.
        None => settings.importance_rows.min(settings.samples),
    };
    if let Some(nodes_per_side) = arguments.nodes {
        let grid = settings.grid.unwrap_or_default();
        settings.grid = Some(MapSettings { nodes_per_side, ..grid });
    }
    for unknown in &arguments.without {
        settings.unknowns.insert(*unknown, None);
    }
    let mut bands =
        Bands::new(&scene, settings).map_err(|error| InputError(format!("bands: {error}")))?;
    let mut solver = Solver::new(&arguments.threads)?;
    solver.solve(&mut bands);
    let report = bands.report();
    let json = serde_json::to_string_pretty(&report)
        .map_err(|error| InputError(format!("bands: {error}")))?;
    output::write_all(&[File::new(&arguments.out, json + "\n")])?;
    for note in NOTES {
        output::warn(note);
    }
    report.remarks.iter().for_each(|line| output::warn(line));
    let converged = report.counts.get(PointStatus::Converged.word()).copied().unwrap_or(0);
    if converged < report.samples {
        output::warn(&format!("{converged} of {} samples converged.", report.samples));
    }
    Ok(solver.status(&bands, converged > 0))
}
