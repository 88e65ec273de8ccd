//! Scenes one after the other on threads: a line of the result, or of an error, for each, written at once.

use super::super::input::{Source, Text, Texts};
use super::super::output::{self, LineFile};
use super::super::stream::{self, End, Progress};
use super::super::{ExitStatus, InputError};
use super::done::{Done, Key};
use super::{Arguments, Clock};
use crate::measure::{Outcome, Selected, Selection, Status};
use crate::scene::{CheckedScene, read};
use crate::simulate::Simulator;
use crate::solve::Options;
use crate::study::many::{Many, ManySettings};
use crate::study::runner::panic_line;
use serde::Serialize;
use serde_json::value::RawValue;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Mutex, PoisonError};

/// What a thread keeps from scene to scene.
#[derive(Default)]
struct Worker {
    simulator: Simulator,
    scene: Option<CheckedScene>,
}

/// What all scenes of a run share.
struct Run {
    written: Selection,
    most_ms: Option<f64>,
    done: Mutex<Done>,
    /// Names of the files, where the run has several.
    names: Vec<String>,
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

#[derive(Serialize)]
struct ResultLine<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'a RawValue>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene_hash: Option<&'a str>,
    #[serde(flatten)]
    result: Selected<'a>,
}

#[derive(Serialize)]
struct ErrorLine<'a> {
    id: Option<&'a RawValue>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene_hash: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'a str>,
    line: usize,
    error: &'a str,
}

impl Run {
    fn answer(&self, worker: &mut Worker, text: Text) -> Answer {
        let Text { source, line, bytes } = text;
        let bytes = bytes.as_deref();
        let key = Key::of(&String::from_utf8_lossy(bytes.unwrap_or_default()));
        if self.done.lock().unwrap_or_else(PoisonError::into_inner).take(&key) {
            return Answer::Done;
        }
        let (id, scene_hash) = (key.id(), key.hash());
        let (id, scene_hash) = (id.as_deref(), scene_hash.as_deref());
        let error_line = |error: &str| {
            let file = self.names.get(source).map(String::as_str);
            json(&ErrorLine { id, scene_hash, file, line, error })
        };
        let scene = bytes.map_err(Clone::clone).and_then(|bytes| {
            let scene = read::utf8(bytes)
                .and_then(|text| CheckedScene::from_json_after(text, worker.scene.as_ref()));
            scene.map_err(|error| error.to_string())
        });
        match scene.map(|scene| self.outcome(worker, scene)) {
            Ok(Ok(outcome)) => {
                let result = self.written.of_outcome(&outcome);
                let line = json(&ResultLine { id, scene_hash, result });
                Answer::Result(line, outcome.status)
            }
            Ok(Err(defect)) => Answer::Defect(error_line(&format!("internal error: {defect}"))),
            Err(error) => Answer::Error(error_line(&error)),
        }
    }

    /// The result of a scene. A scene that panics is solved once more from scratch; the error is that of the second panic.
    fn outcome(&self, worker: &mut Worker, scene: CheckedScene) -> Result<Outcome, String> {
        let Worker { simulator, scene: kept } = worker;
        let scene = kept.insert(scene);
        simulator.most_ms = self.most_ms;
        let mut attempt = || {
            let clock = Clock::start();
            let run =
                || simulator.run(scene, Options::default(), &self.written, Some(&|| clock.ms()));
            catch_unwind(AssertUnwindSafe(run)).map(|simulation| simulation.outcome)
        };
        attempt().or_else(|_| attempt()).map_err(|panic| panic_line(&*panic))
    }
}

/// A value in a line.
fn json(value: &impl Serialize) -> String {
    // The values of a result have names and numbers only.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

/// Solves the scenes of the sources and writes a line for each.
pub(super) fn run(
    arguments: &Arguments,
    written: Selection,
    sources: Vec<Source>,
) -> Result<ExitStatus, InputError> {
    let Arguments { out, skip_done, most_ms, unordered, threads, .. } = arguments;
    let done = skip_done.as_deref().map(Done::read).transpose()?;
    // A run that goes on keeps its lines.
    let goes_on = skip_done.as_ref().is_some_and(|done| output::is_same_file(done, out));
    let keep = done.as_ref().filter(|_| goes_on && out.exists()).map(|done| done.whole_bytes);
    let mut file = LineFile::open(out, keep)?;
    let names = match &sources[..] {
        [_] => Vec::new(),
        sources => sources.iter().map(|source| source.path().display().to_string()).collect(),
    };
    let done = Mutex::new(done.unwrap_or_default());
    let run = Run { written, most_ms: *most_ms, done, names };
    let (texts, bytes, all_bytes) = Texts::new(sources);
    std::panic::set_hook(Box::new(|panic| {
        let location = panic.location().map(ToString::to_string).unwrap_or_default();
        output::error(&format!("internal error at {location}"));
    }));
    let work = move |worker: &mut Worker, text| run.answer(worker, text);
    let settings = ManySettings { in_order: !unordered, ..threads.settings() };
    let mut progress = Progress::new();
    let (mut written, mut errors, mut defects, mut not_converged) = (0_u64, 0_u64, 0_u64, 0_u64);
    let mut skipped = 0_u64;
    let end = stream::run(Many::new(texts, settings, work), |finished| {
        let part = all_bytes.map(|all| bytes.load(Ordering::Relaxed) as f64 / all as f64);
        progress.count(part);
        let line = match finished.result {
            Ok(Answer::Result(line, status)) => {
                not_converged += u64::from(status != Status::Converged);
                line
            }
            Ok(Answer::Error(line)) => {
                errors += 1;
                line
            }
            Ok(Answer::Defect(line)) => {
                defects += 1;
                line
            }
            Ok(Answer::Done) => {
                skipped += 1;
                return Ok(ControlFlow::Continue(()));
            }
            // The hook has reported the panic.
            Err(panic) => resume_unwind(Box::new(panic)),
        };
        written += 1;
        file.write(line.as_bytes())
    })?;
    drop(progress);
    if skipped > 0 {
        output::warn(&format!("--skip-done: {skipped} scenes have a line already"));
    }
    if end == End::Signal {
        stream::warn_of_signal(written);
        return Ok(ExitStatus::Interrupted);
    }
    if defects > 0 {
        return Ok(ExitStatus::Defect);
    }
    if errors > 0 {
        let line =
            format!("{errors} of {written} lines of the output are errors of invalid scenes");
        return Err(InputError(line));
    }
    let all_converged = not_converged == 0;
    Ok(if all_converged { ExitStatus::Converged } else { ExitStatus::NotConverged })
}
