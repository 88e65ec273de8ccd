//! Studies: many scenes solved for one question.
//!
//! A study emits jobs and receives their cases ([`Job`], [`Case`]); a [`Runner`] computes the jobs, on threads or in
//! workers of a page. [`Cases`] holds the cases by content, so that no scene is solved twice.
//!
//! `quantity` (the figures of a result) | `job` (scenes in, cases out) | `cache` (cases by content) | `runner` (the trait of
//! all runners) | `many` (jobs on threads, for as long as jobs come) | `job_threads` (the jobs of a study on them) | `queue` (the scenes of a study on their way), `one_by_one` (of a study that asks for one at a time) | `parameter` (the numbers of a scene that a map varies) | `template` (a scene for each row of a table) |
//! `axis` | `map` | `map_border` (points without an answer, solved in full) | `map_check` (points on a finer grid) |
//! `map_file` (its table and JSON) | `map_levels` (limits and contour lines) | `map_options` (choices) | `map_sample` (points that are solved, values between), `map_column` (of one quantity) | `surface` (a smooth function of scattered values) | `map_values` (between and beside the points) | `contour` (lines of equal value) |
//! `sequence` (random numbers of the samples) | `importance` (Sobol indices from rows), `expansion` (from a polynomial of the samples), `fits` (of all quantities) | `percentile` | `unknown` (about a person) |
//! `bands` | `bands_importance` (of the unknowns for them) | `bands_report` (in a file) | `schema` (of the formats) | `same_words` (warnings of many scenes) | `samples` (two scenes sample by sample) | `section_band` (of the skin's section) | `no_answer` (why a plan has
//! none) | `nearest` (the nearest plan with an answer) | `each` (all of a list) | `first_usual` (the first of a list that stays usual) |
//! `practice` (the stretch that practice's volumes give) | `times` (a plan on the table, after a week, after six months) | `usual_range` (the largest volume that stays usual, over sampled patients).
//!
//! Uses `scene`, `simulate` and all to their left; no clock, and threads in `many` only. Used by `platform` and `app`.

mod axis;
mod bands;
mod bands_importance;
mod bands_report;
mod cache;
pub mod contour;
mod each;
mod expansion;
mod first_usual;
mod fits;
mod importance;
mod job;
mod job_threads;
pub mod many;
mod map;
mod map_border;
mod map_check;
mod map_column;
mod map_file;
mod map_levels;
mod map_options;
mod map_practice;
mod map_sample;
mod map_values;
mod nearest;
mod no_answer;
mod one_by_one;
mod parameter;
mod percentile;
mod practice;
mod quantity;
mod queue;
pub mod runner;
mod same_words;
mod samples;
mod schema;
mod section_band;
mod sequence;
mod surface;
mod template;
mod times;
mod unknown;
mod usual_range;

pub use axis::{Axis, MAX_POINTS, MapError};
pub use bands::{Bands, BandsError, BandsSettings, NOTES, SAMPLES};
pub use bands_report::{BANDS_SCHEMA, Band, BandsReport, ProfileBand, Scenario, UnknownReport};
pub use cache::{Cases, Key, MAX_CASES};
pub use each::Each;
pub use first_usual::FirstUsual;
pub use importance::{Index, MIN_ROWS, Row, index};
pub use job::{Case, Evaluator, Job, Profile, evaluate};
pub use job_threads::JobThreads;
pub use map::{CHECK, Map, MapSettings, PointStatus};
pub use map_check::{Difference, MapCheck};
pub use map_file::{AxisFile, CheckFile, ContourFile, MAP_SCHEMA, MapFile, PointFile};
pub use map_options::MapOptions;
pub use map_practice::{JudgedMap, MapPractice};
pub use map_sample::Source;
pub use nearest::{INSERTION_STEP, Nearest, NearestPlan, Search, VOLUME_STEP_ML};
pub use no_answer::{NoAnswer, implant_in_words, name_in_words, size_in_words, volume_and_width};
pub use parameter::{Parameter, ParameterError, with_values};
pub use percentile::percentiles;
pub use practice::{NoPractice, Practice, breast_width_mm, has_same_practice, practice_volume};
pub use quantity::{Quantity, Values};
pub use runner::{Finished, JobPanic, Runner};
pub use samples::{LEAST_ANSWERS, Samples};
pub use schema::SchemaOf;
pub use section_band::SectionBand;
pub use sequence::{MAX_SAMPLES, normal_quantile, quantile, unit_sample};
pub use template::{Template, TemplateError};
pub use times::{AtTime, TIMES_SCHEMA, Times, TimesFile};
pub use unknown::{Unknown, has_same_patients};
pub use usual_range::{PATIENTS, USUAL_STEP_ML, UsualRange, UsualVolumes};

use std::collections::HashMap;

/// A study as a state machine without threads and clocks.
pub trait Study {
    /// The next job and its index, counted from 0; `None` if no scene is left to start. Scenes whose cases are stored enter no
    /// job; a job without scenes only limits the time of a call.
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)>;

    /// Takes the cases of a job, in any order of the jobs, and stores them. An empty list marks a job that failed.
    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases);

    /// Numbers of solved scenes and of all scenes; equal at the end.
    fn progress(&self) -> (usize, usize);

    /// Are all scenes solved?
    fn is_done(&self) -> bool {
        let (done, all) = self.progress();
        done == all
    }
}

/// Runs a study to its end with a runner that waits.
///
/// # Errors
/// The first panic of a job. The jobs that were submitted before stay with the runner.
pub fn run(
    study: &mut dyn Study,
    store: &mut Cases,
    runner: &mut dyn Runner<Job = Job, Done = Vec<Case>>,
) -> Result<(), JobPanic> {
    // Index of the study's job by the runner's index.
    let mut running = HashMap::new();
    loop {
        while running.len() < 2 * runner.workers()
            && let Some((index, job)) = study.next_job(store)
        {
            running.insert(runner.submit(job), index);
        }
        let Some(Finished { index, result }) = runner.next() else { return Ok(()) };
        if let Some(job) = running.remove(&index) {
            study.receive(job, result?, store);
        }
    }
}

/// The opening patient with a flat chest and an implant of 12 cm and 300 ml.
#[cfg(test)]
fn flat_plan() -> crate::scene::Scene {
    let flat = crate::scene::Scene { chest: None, ..crate::scene::Scene::opening() };
    with_values(&flat, &[(Parameter::Volume, 300.0)]).unwrap()
}
