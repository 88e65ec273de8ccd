//! Scenes one after the other on threads: a line of the result, or of an error, for each, written at once.

use super::super::input::{Content, Source, Text, Texts};
use super::super::output::{self, LineFile};
use super::super::parquet::ParquetFile;
use super::super::stream::{self, End, Progress};
use super::super::{ExitStatus, InputError, report_panics};
use super::done::{Done, Found};
use super::form::{LineFormat, Place};
use super::key::Key;
use super::table::Table;
use super::{Arguments, Clock, OutputFormat};
use crate::measure::{Outcome, Status};
use crate::scene::{CheckedScene, SceneError, read};
use crate::simulate::Simulator;
use crate::solve::Options;
use crate::study::many::{Many, ManySettings};
use crate::study::runner::twice;
use crate::table::RawRow;
use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// What a thread keeps from scene to scene.
#[derive(Default)]
struct Worker {
    simulator: Simulator,
    scene: Option<CheckedScene>,
}

/// What all scenes of a run share.
struct Run {
    format: LineFormat,
    /// Of scenes from a table.
    table: Option<Table>,
    most_ms: Option<f64>,
    done: Mutex<Done>,
    /// Number of scenes whose `id` an earlier run has with other content.
    changed: Arc<AtomicU64>,
    /// Names of the files, where the run has several.
    names: Vec<String>,
}

/// Where the lines go.
enum Results {
    Lines(LineFile),
    Parquet(Box<ParquetFile>),
}

impl Results {
    fn new(file: LineFile, form: OutputFormat, format: &LineFormat) -> Result<Self, InputError> {
        let Some(header) = format.header().filter(|_| form == OutputFormat::Parquet) else {
            return Ok(Self::Lines(file));
        };
        Ok(Self::Parquet(Box::new(ParquetFile::new(file, header, format.kinds())?)))
    }

    /// Writes the header of a table; a Parquet file has its own.
    fn begin(&mut self, header: &str) -> Result<ControlFlow<()>, InputError> {
        match self {
            Self::Lines(file) => file.write(header.as_bytes()),
            Self::Parquet(_) => Ok(ControlFlow::Continue(())),
        }
    }

    fn write(&mut self, line: &str) -> Result<ControlFlow<()>, InputError> {
        match self {
            Self::Lines(file) => file.write(line.as_bytes()),
            Self::Parquet(file) => file.write(line).map(ControlFlow::Continue),
        }
    }

    fn finish(self) -> Result<(), InputError> {
        match self {
            Self::Lines(_) => Ok(()),
            Self::Parquet(file) => file.finish(),
        }
    }
}

/// The line of a scene.
enum Answer {
    Result(String, Status),
    /// Of an invalid scene.
    Error(String),
    /// Of a scene that ended in a defect of the program.
    Defect(String),
    /// An earlier run has the line.
    Done,
}

impl Run {
    fn answer(&self, worker: &mut Worker, text: Text) -> Answer {
        let Text { source, line, content } = text;
        let (key, scene) = self.scene(content, worker.scene.as_ref());
        match self.done.lock().unwrap_or_else(PoisonError::into_inner).take(&key) {
            Found::Line => return Answer::Done,
            Found::Changed => _ = self.changed.fetch_add(1, Ordering::Relaxed),
            Found::Nothing => {}
        }
        let place = Place { file: self.names.get(source).map(String::as_str), line };
        match scene.map(|scene| self.outcome(worker, scene)) {
            Ok(Ok(outcome)) => Answer::Result(self.format.result(&key, &outcome), outcome.status),
            Ok(Err(defect)) => {
                let error = format!("internal error: {defect}");
                Answer::Defect(self.format.error(&key, place, &error))
            }
            Err(error) => Answer::Error(self.format.error(&key, place, &error)),
        }
    }

    /// The scene of a text and what it is known by.
    fn scene(
        &self,
        content: Result<Content, String>,
        earlier: Option<&CheckedScene>,
    ) -> (Key, Result<CheckedScene, String>) {
        let in_words = |error: SceneError| error.to_string();
        match (content, &self.table) {
            (Err(error), _) => (Key::of(""), Err(error)),
            (Ok(Content::Row(row, decimals)), Some(table)) => {
                let (key, scene) = table.scene(&row, decimals);
                let like = |scene| CheckedScene::like(scene, earlier).map_err(in_words);
                (key, scene.and_then(like))
            }
            (Ok(Content::Json(bytes) | Content::Row(RawRow { bytes, .. }, _)), _) => {
                let scene = read::utf8(&bytes)
                    .and_then(|text| CheckedScene::from_json_after(text, earlier));
                let key = Key::of(&String::from_utf8_lossy(&bytes));
                (key, scene.map_err(|error| with_cause(error.to_string(), &bytes)))
            }
        }
    }

    /// The result of a scene. A scene that panics is solved once more from scratch; the error is that of the second panic.
    fn outcome(&self, worker: &mut Worker, scene: CheckedScene) -> Result<Outcome, String> {
        let scene = worker.scene.insert(scene);
        twice(&mut worker.simulator, |simulator| {
            simulator.most_ms = self.most_ms;
            let (clock, selection) = (Clock::start(), &self.format.selection);
            simulator.run(scene, Options::default(), selection, Some(&|| clock.ms())).outcome
        })
    }
}

/// The error of a line, with its cause where a carriage return alone parts scenes.
fn with_cause(error: String, line: &[u8]) -> String {
    let is_parted = line
        .trim_ascii()
        .split(|byte| *byte == b'\r')
        .skip(1)
        .any(|part| part.trim_ascii().starts_with(b"{"));
    if is_parted && error.contains("trailing characters") {
        return "a carriage return alone ends no line; allowed: lines that end with a line feed"
            .to_owned();
    }
    error
}

/// Solves the scenes of the sources and writes a line for each.
pub(super) fn run(
    arguments: &Arguments,
    format: LineFormat,
    table: Option<Table>,
    sources: Vec<Source>,
) -> Result<ExitStatus, InputError> {
    let Arguments { out, skip_done, most_ms, unordered, threads, .. } = arguments;
    let done = skip_done.as_deref().map(|path| Done::read(path, &format)).transpose()?;
    // A run that goes on keeps its lines.
    let goes_on = skip_done.as_ref().is_some_and(|done| output::is_same_file(done, out));
    let keep = done.as_ref().filter(|_| goes_on && out.exists()).map(|done| done.whole_bytes);
    let mut file = Results::new(LineFile::open(out, keep)?, arguments.format, &format)?;
    if let Some(header) = format.header().filter(|_| keep.unwrap_or_default() == 0)
        && file.begin(header)?.is_break()
    {
        return Ok(ExitStatus::Converged);
    }
    let names = match &sources[..] {
        [_] => Vec::new(),
        sources => sources.iter().map(|source| source.path().display().to_string()).collect(),
    };
    let done = Mutex::new(done.unwrap_or_default());
    let empty_rows = sources.iter().find_map(Source::empty_rows);
    let changed = Arc::new(AtomicU64::new(0));
    let run = Run { format, table, most_ms: *most_ms, done, changed: Arc::clone(&changed), names };
    let (texts, bytes, all_bytes) = Texts::new(sources);
    report_panics("");
    let work = move |worker: &mut Worker, text| run.answer(worker, text);
    let settings = ManySettings { in_order: !unordered, ..threads.settings() };
    let mut progress = Progress::new();
    let mut counts = Counts::default();
    let end = stream::run(Many::new(texts, settings, work), |finished| {
        let part = all_bytes.map(|all| bytes.load(Ordering::Relaxed) as f64 / all as f64);
        progress.count(part);
        // The hook has reported the panic.
        let answer = finished.result.unwrap_or_else(|panic| resume_unwind(Box::new(panic)));
        match counts.add(answer) {
            Some(line) => file.write(&line),
            None => Ok(ControlFlow::Continue(())),
        }
    })?;
    drop(progress);
    file.finish()?;
    match empty_rows.map_or(0, |rows| rows.load(Ordering::Relaxed)) {
        0 => {}
        1 => output::warn("1 empty row of the table is left out"),
        rows => output::warn(&format!("{rows} empty rows of the table are left out")),
    }
    if counts.skipped > 0 {
        output::warn(&format!("--skip-done: {} scenes have a line already", counts.skipped));
    }
    let changed = changed.load(Ordering::Relaxed);
    if changed > 0 {
        output::warn(&format!(
            "--skip-done: {changed} scenes with a line of their id are other scenes now and are solved; of an id the last line counts"
        ));
    }
    if end == End::Signal {
        stream::warn_of_signal(&format!("{} lines are whole", counts.written));
        return Ok(ExitStatus::Interrupted);
    }
    counts.status()
}

/// How the scenes of a run ended.
#[derive(Default)]
struct Counts {
    written: u64,
    errors: u64,
    defects: u64,
    not_converged: u64,
    skipped: u64,
}

impl Counts {
    /// Counts an answer; returns its line, none of a scene that has one already.
    fn add(&mut self, answer: Answer) -> Option<String> {
        let line = match answer {
            Answer::Result(line, status) => {
                self.not_converged += u64::from(status != Status::Converged);
                line
            }
            Answer::Error(line) => {
                self.errors += 1;
                line
            }
            Answer::Defect(line) => {
                self.defects += 1;
                line
            }
            Answer::Done => {
                self.skipped += 1;
                return None;
            }
        };
        self.written += 1;
        Some(line)
    }

    fn status(&self) -> Result<ExitStatus, InputError> {
        let Self { written, errors, defects, not_converged, .. } = self;
        if *defects > 0 {
            return Ok(ExitStatus::Defect);
        }
        if *errors > 0 {
            let line =
                format!("{errors} of {written} lines of the output are errors of invalid scenes");
            return Err(InputError(line));
        }
        Ok(match not_converged {
            0 => ExitStatus::Converged,
            _ => ExitStatus::NotConverged,
        })
    }
}
