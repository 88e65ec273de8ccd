//! Long runs: threads, signals, and progress on a terminal.

use super::{InputError, in_range, output};
use crate::study::Finished;
use crate::study::many::{Many, ManySettings};
use std::env::var_os;
use std::ffi::OsString;
use std::io::{IsTerminal, Write, stderr};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The threads of a long run.
#[derive(clap::Args)]
pub(super) struct ThreadCount {
    /// Number of threads, 1 to 1024. Default: the cores; under a scheduler (Slurm, GNU parallel, OMP_NUM_THREADS) those of the
    /// task.
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,
}

const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    in_range(text, NonZeroUsize::MIN, NonZeroUsize::new(MOST_THREADS).unwrap_or(NonZeroUsize::MIN))
}

impl ThreadCount {
    pub(super) fn get(&self) -> NonZeroUsize {
        self.threads.unwrap_or_else(default_threads)
    }

    pub(super) fn settings(&self) -> ManySettings {
        ManySettings::new(self.get())
    }
}

/// The threads of a scheduler's task, but no more than the cores that this process may use; else these cores.
fn default_threads() -> NonZeroUsize {
    let is_task = ["SLURM_JOB_ID", "PARALLEL_SEQ"].iter().any(|name| var_os(name).is_some());
    let variables = ["SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"];
    let values = variables.iter().filter_map(|name| Some((*name, var_os(name)?)));
    let (threads, notes) = of_task(values, is_task, cores());
    notes.iter().for_each(|note| output::warn(note));
    threads
}

fn cores() -> NonZeroUsize {
    std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// The number of threads by the first variable that has one, and a sentence on each that has none.
fn of_task<'a>(
    values: impl Iterator<Item = (&'a str, OsString)>,
    is_task: bool,
    cores: NonZeroUsize,
) -> (NonZeroUsize, Vec<String>) {
    let mut notes = Vec::new();
    for (name, value) in values {
        let text = value.to_string_lossy();
        match first_number(&text) {
            Some(number) => return (number.min(cores), notes),
            None if text.trim().is_empty() => {}
            None => notes.push(format!(
                "{name} is {:?}, which is ignored; allowed: 1 to {MOST_THREADS}",
                text.chars().take(40).collect::<String>()
            )),
        }
    }
    (if is_task { NonZeroUsize::MIN } else { cores }, notes)
}

/// The first number of a list, as of OpenMP's levels; a number of any length is one.
fn first_number(text: &str) -> Option<NonZeroUsize> {
    let first = text.split(',').next()?.trim();
    let is_number = !first.is_empty() && first.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| first.parse().unwrap_or(usize::MAX)).and_then(NonZeroUsize::new)
}

/// Limits the threads that the charts' pool takes from its own variable to the cores.
pub(super) fn limit_pool() {
    let wanted = var_os("RAYON_NUM_THREADS").and_then(|text| first_number(&text.to_string_lossy()));
    if wanted.is_some_and(|wanted| wanted > cores()) {
        // A pool that is there already has its threads.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(cores().get()).build_global();
    }
}

/// How a run has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// All jobs are done.
    Done,
    /// The reader of the output has closed the pipe.
    Closed,
    /// A signal has ended the run.
    Signal,
}

/// Passes the results on until the last one, a break or a signal: SIGINT, SIGTERM or SIGHUP ends the run between two results, a
/// second one at once.
///
/// # Errors
/// The first error of `receive`; or if the system starts no thread.
pub(super) fn run<T: Send + 'static>(
    many: std::io::Result<Many<T>>,
    mut receive: impl FnMut(Finished<T>) -> Result<ControlFlow<()>, InputError>,
) -> Result<End, InputError> {
    let many = many.map_err(no_threads)?;
    let signal = Signal::default();
    signal.calls(many.canceller());
    for finished in many {
        if receive(finished)?.is_break() {
            return Ok(End::Closed);
        }
    }
    Ok(if signal.has_come() { End::Signal } else { End::Done })
}

/// The error of a system that starts no thread.
pub(super) fn no_threads(error: std::io::Error) -> InputError {
    InputError(format!("--threads: {error}"))
}

/// SIGINT, SIGTERM or SIGHUP: the first one ends a run that keeps what it has, a second one the process at once.
#[derive(Clone, Default)]
pub(super) struct Signal(Arc<AtomicBool>);

impl Signal {
    /// Calls a function at the first signal. Once in a process.
    pub(super) fn calls(&self, end: impl Fn() + Send + 'static) {
        let flag = Arc::clone(&self.0);
        let on_signal = move || {
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(super::INTERRUPTED.into());
            }
            end();
        };
        // Without a handler a signal ends the process as any other.
        let _ = ctrlc::set_handler(on_signal);
    }

    pub(super) fn has_come(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// Progress on standard error, where that is a terminal.
pub(super) struct Progress {
    is_shown: bool,
    start: Instant,
    last: Instant,
    done: u64,
}

const BETWEEN: Duration = Duration::from_millis(500);

impl Progress {
    pub(super) fn new() -> Self {
        let now = Instant::now();
        Self { is_shown: stderr().is_terminal(), start: now, last: now, done: 0 }
    }

    /// Counts a scene; `part` of the input is read, if its length is known.
    pub(super) fn count(&mut self, part: Option<f64>) {
        self.done += 1;
        if !self.is_shown || self.last.elapsed() < BETWEEN {
            return;
        }
        self.last = Instant::now();
        let seconds = self.start.elapsed().as_secs_f64();
        let left = part.filter(|part| *part > 0.0).map(|part| seconds * (1.0 - part) / part);
        let left = left.map(|left| format!(", {}", in_words(left))).unwrap_or_default();
        let rate = self.done as f64 / seconds;
        // A terminal that is gone ends no run.
        let _ = write!(stderr(), "\r\x1b[K{} scenes, {rate:.1} a second{left}", self.done);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.is_shown && self.last > self.start {
            let _ = write!(stderr(), "\r\x1b[K");
        }
    }
}

/// A time left \[s\] in words.
fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s left"),
        s if s < 5400.0 => format!("{:.0} min left", s / 60.0),
        s => format!("{:.1} h left", s / 3600.0),
    }
}

/// Reports that a signal has ended a run, and what is kept.
pub(super) fn warn_of_signal(kept: &str) {
    output::warn(&format!("ended by a signal; {kept}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_gives_no_more_threads_than_cores_and_an_unreadable_one_a_sentence() {
        let cores = NonZeroUsize::new(8).unwrap();
        let of = |values: &[(&'static str, &str)], is_task| {
            let values = values.iter().map(|(name, value)| (*name, OsString::from(value)));
            let (threads, notes) = of_task(values, is_task, cores);
            (threads.get(), notes.len())
        };
        for (value, wanted) in [
            ("2", (2, 0)),
            ("2,1", (2, 0)),
            (" 3 , 1", (3, 0)),
            ("9", (8, 0)),
            ("200000", (8, 0)),
            ("99999999999999999999999", (8, 0)),
            ("", (8, 0)),
            ("many", (8, 1)),
            ("0", (8, 1)),
            ("-1", (8, 1)),
            ("2.5", (8, 1)),
        ] {
            for name in ["SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"] {
                assert_eq!(of(&[(name, value)], false), wanted, "{value}");
            }
        }
        let [slurm, open_mp] = ["SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"];
        assert_eq!(of(&[], false), (8, 0));
        assert_eq!(of(&[], true), (1, 0));
        assert_eq!(of(&[(slurm, "3"), (open_mp, "4")], true), (3, 0));
        assert_eq!(of(&[(slurm, "x"), (open_mp, "4")], true), (4, 1));
        assert_eq!(of(&[(open_mp, "y")], true), (1, 1));
        let (_, notes) = of_task([(open_mp, OsString::from("many"))].into_iter(), false, cores);
        let line = "OMP_NUM_THREADS is \"many\", which is ignored; allowed: 1 to 1024";
        assert_eq!(notes, [line]);
    }
}
