//! Studies beside the app: a runner of the platform computes their jobs, the cases of all studies are stored once.
//!
//! Each panel with a study has a [`Driver`]. The driver submits the study's jobs, a few at a time, and passes the cases
//! to the study. A frame spends [`SLICE`] on all drivers at most, so a study of any size delays no frame.

use crate::app::texts::tr;
use crate::measure::Status;
use crate::session::Session;
use crate::study::{Case, Cases, Finished, Job, Runner, Study};
use eframe::egui::{self, mutex::Mutex};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use web_time::{Duration, Instant};

/// A runner of the jobs of studies: threads natively, workers on the page.
pub type JobRunner = dyn Runner<Job = Job, Done = Vec<Case>>;

/// Requests a frame; a runner calls this function after each job.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Time limit of all drivers in a frame; a step that has begun is finished.
const SLICE: Duration = Duration::from_millis(2);
/// Greatest number of submitted jobs of a study per worker: one runs, one is ready.
const JOBS_PER_WORKER: usize = 2;

/// What all studies share: the runner, the solved cases, the finished jobs that no driver has taken yet.
pub(crate) struct Studies {
    runner: Box<JobRunner>,
    /// The context of the last frame, which changes after the loss of the graphics.
    ctx: Arc<Mutex<egui::Context>>,
    store: Cases,
    /// Number of the session's solutions whose results are stored.
    shared: u64,
    finished: Vec<Finished<Vec<Case>>>,
    /// The jobs that the runner has not finished.
    unfinished: BTreeSet<usize>,
    /// Do new jobs wait, so that the app's own solve has the processor?
    is_held: bool,
    /// Time that the drivers have spent in this frame.
    spent: Duration,
}

impl Studies {
    pub(crate) fn new(ctx: &egui::Context, create: impl FnOnce(Wake) -> Box<JobRunner>) -> Self {
        let ctx = Arc::new(Mutex::new(ctx.clone()));
        let woken = Arc::clone(&ctx);
        let wake = Arc::new(move || {
            let ctx = woken.lock().clone();
            ctx.request_repaint();
        });
        Self {
            runner: create(wake),
            ctx,
            store: Cases::default(),
            shared: 0,
            finished: Vec::new(),
            unfinished: BTreeSet::new(),
            is_held: false,
            spent: Duration::ZERO,
        }
    }

    /// Reads the finished jobs, once a frame, before the drivers. `is_held`: the drivers of this frame submit no job.
    pub(crate) fn poll(&mut self, ctx: &egui::Context, is_held: bool) {
        self.ctx.lock().clone_from(ctx);
        self.is_held = is_held;
        self.spent = Duration::ZERO;
        while let Some(finished) = self.runner.poll() {
            self.unfinished.remove(&finished.index);
            self.finished.push(finished);
        }
    }

    /// Number of jobs that the runner has not finished.
    pub(crate) fn jobs(&self) -> usize {
        self.unfinished.len()
    }

    fn submit(&mut self, job: Job) -> usize {
        let index = self.runner.submit(job);
        self.unfinished.insert(index);
        index
    }

    /// Stores the results of the present scene and of the pins after each solve of the session: a study with an equal scene,
    /// grid and tolerance included, takes them.
    pub(crate) fn share(&mut self, session: &Session) {
        let solutions = session.counters().solutions;
        if session.is_working() || self.shared == solutions {
            return;
        }
        self.shared = solutions;
        let present = session.result().map(|outcome| (session.scene(), outcome));
        let pins = session.pins().iter().filter_map(|pin| Some((pin.scene(), pin.outcome()?)));
        for (scene, outcome) in present.into_iter().chain(pins) {
            if outcome.status == Status::Converged {
                self.store.share(scene, Case::of(outcome, scene));
            }
        }
    }

    /// Requests a frame: a driver goes on without a finished job.
    pub(crate) fn request_frame(&self) {
        self.ctx.lock().request_repaint();
    }

    fn cancel(&mut self, index: usize) {
        self.runner.cancel(index);
        self.unfinished.remove(&index);
        self.finished.retain(|finished| finished.index != index);
    }

    /// Removes a finished job with an index of `running`.
    fn take(&mut self, running: &BTreeMap<usize, usize>) -> Option<Finished<Vec<Case>>> {
        let place = self.finished.iter().position(|done| running.contains_key(&done.index))?;
        Some(self.finished.remove(place))
    }
}

/// Runs one study at a time through the shared runner.
pub(crate) struct Driver<S> {
    study: Option<S>,
    /// The study's index of a job by the runner's index.
    running: BTreeMap<usize, usize>,
    /// Number of scenes that a job has not solved, and the first error.
    failed: usize,
    failure: Option<String>,
}

impl<S> Default for Driver<S> {
    fn default() -> Self {
        Self { study: None, running: BTreeMap::new(), failed: 0, failure: None }
    }
}

impl<S: Study> Driver<S> {
    /// Starts a study in place of the present one, whose jobs are cancelled.
    pub(crate) fn start(&mut self, study: S, studies: &mut Studies) {
        self.cancel(studies);
        self.study = Some(study);
    }

    /// The study, once no job of it is left.
    pub(crate) fn finished(&self) -> Option<&S> {
        self.study().filter(|_| !self.is_running())
    }

    /// A study that is not started: for tests of what is read from it.
    #[cfg(test)]
    pub(crate) fn set(&mut self, study: S) {
        self.study = Some(study);
    }

    /// Cancels the jobs of the study and removes the study. Solved cases stay stored.
    pub(crate) fn cancel(&mut self, studies: &mut Studies) {
        for index in std::mem::take(self).running.into_keys() {
            studies.cancel(index);
        }
    }

    /// Passes finished jobs to the study and submits further jobs; once a frame, after [`Studies::poll`]. Returns whether
    /// the study has received cases.
    pub(crate) fn advance(&mut self, studies: &mut Studies) -> bool {
        let start = Instant::now();
        let Some(study) = &mut self.study else { return false };
        let before = study.progress();
        let most = JOBS_PER_WORKER * studies.runner.workers().max(1);
        let mut is_late = false;
        loop {
            if studies.spent + start.elapsed() >= SLICE {
                is_late = true;
                break;
            }
            if let Some(Finished { index, result }) = studies.take(&self.running) {
                let Some(job) = self.running.remove(&index) else { continue };
                let cases = result.unwrap_or_else(|panic| {
                    self.failure.get_or_insert_with(|| panic.to_string());
                    self.failed += 1;
                    Vec::new()
                });
                // A scene out of its limits enters no job: an error is that of the job.
                for error in cases.iter().filter_map(|case| case.error.as_ref()) {
                    self.failure.get_or_insert_with(|| error.clone());
                    self.failed += 1;
                }
                study.receive(job, cases, &mut studies.store);
            } else if studies.is_held || self.running.len() >= most {
                break;
            } else {
                match study.next_job(&mut studies.store) {
                    Some((job, Job { scenes, .. })) if scenes.is_empty() => {
                        study.receive(job, Vec::new(), &mut studies.store);
                    }
                    Some((job, scenes)) => {
                        self.running.insert(studies.submit(scenes), job);
                    }
                    None => break,
                }
            }
        }
        studies.spent += start.elapsed();
        if is_late {
            studies.request_frame();
        }
        study.progress() != before
    }

    /// The present study, running or done.
    pub(crate) fn study(&self) -> Option<&S> {
        self.study.as_ref()
    }

    /// The present study, for changes that leave its jobs as they are.
    pub(crate) fn study_mut(&mut self) -> Option<&mut S> {
        self.study.as_mut()
    }

    /// Numbers of solved scenes and of all scenes of the study; both 0 without one.
    pub(crate) fn progress(&self) -> (usize, usize) {
        self.study.as_ref().map_or((0, 0), Study::progress)
    }

    /// Is a study started and not done?
    pub(crate) fn is_running(&self) -> bool {
        self.study.as_ref().is_some_and(|study| !study.is_done())
    }

    /// The failed jobs of the study in one line, with the first error; `None` without a failure.
    pub(crate) fn failure(&self) -> Option<String> {
        let first = self.failure.as_ref()?;
        Some(match self.failed {
            1 => tr!("A scene was not solved: {first}", first),
            count => {
                tr!("{count} scenes or jobs were not solved. The first: {first}", count, first)
            }
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::solve::Progress;
    use crate::study::{Axis, JobPanic, Map, MapSettings, evaluate};
    use std::cell::RefCell;
    use std::collections::VecDeque;
    use std::rc::Rc;

    /// A runner that computes a job when its result is read, in the reverse order of submission. Jobs in `broken` end in a
    /// panic.
    #[derive(Default)]
    struct Inline {
        waiting: VecDeque<(usize, Job)>,
        broken: Vec<usize>,
        log: Rc<RefCell<Log>>,
    }

    #[derive(Default)]
    pub(crate) struct Log {
        pub(crate) submitted: usize,
        pub(crate) cancelled: Vec<usize>,
    }

    impl Runner for Inline {
        type Job = Job;
        type Done = Vec<Case>;

        fn submit(&mut self, job: Job) -> usize {
            let mut log = self.log.borrow_mut();
            log.submitted += 1;
            self.waiting.push_back((log.submitted - 1, job));
            log.submitted - 1
        }

        fn cancel(&mut self, index: usize) {
            self.log.borrow_mut().cancelled.push(index);
            self.waiting.retain(|(waiting, _)| *waiting != index);
        }

        fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
            let (index, job) = self.waiting.pop_back()?;
            let result = if self.broken.contains(&index) {
                Err(JobPanic::new(index, "a defect"))
            } else {
                Ok(evaluate(&job))
            };
            Some(Finished { index, result })
        }

        fn next(&mut self) -> Option<Finished<Vec<Case>>> {
            self.poll()
        }
    }

    pub(crate) fn studies(broken: &[usize]) -> (Studies, Rc<RefCell<Log>>) {
        let runner = Inline { broken: broken.to_vec(), ..Inline::default() };
        let log = Rc::clone(&runner.log);
        (Studies::new(&egui::Context::default(), |_| Box::new(runner)), log)
    }

    /// Numbers of solved cases, and of those taken from the store.
    pub(crate) fn solved_and_reused(studies: &Studies) -> (usize, usize) {
        (studies.store.solved(), studies.store.reused())
    }

    /// A map of 41 sheets.
    fn map(from: f64) -> Map {
        let axis = Axis::parse(&format!("projection_mm={from}:{}:41", from + 10.0)).unwrap();
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        Map::new(&Scene::sheet(), &[axis], settings).unwrap()
    }

    /// Frames until the study is done.
    fn finish(driver: &mut Driver<Map>, studies: &mut Studies) {
        for _ in 0..1000 {
            studies.poll(&egui::Context::default(), false);
            driver.advance(studies);
            if !driver.is_running() {
                return;
            }
        }
        panic!("the study does not end: {:?}", driver.progress());
    }

    #[test]
    fn studies_at_the_same_time_get_their_own_cases_and_share_the_store() {
        let (mut studies, log) = studies(&[]);
        let mut drivers = [Driver::default(), Driver::default()];
        drivers[0].start(map(20.0), &mut studies);
        drivers[1].start(map(40.0), &mut studies);
        for _ in 0..1000 {
            studies.poll(&egui::Context::default(), false);
            for driver in &mut drivers {
                driver.advance(&mut studies);
                assert!(driver.running.len() <= JOBS_PER_WORKER);
            }
        }
        for (driver, from) in drivers.iter().zip([20.0, 40.0]) {
            assert_eq!((driver.progress(), driver.failure()), ((41, 41), None));
            let study = driver.study().unwrap();
            for i in [0, 7, 40] {
                let scene = map(from).scene(i, 0).unwrap();
                let alone = evaluate(&Job { scenes: vec![scene], ..Job::default() });
                assert_eq!(study.case(i, 0), alone.first());
            }
        }
        assert!(studies.finished.is_empty() && log.borrow().cancelled.is_empty());
        assert_eq!(studies.jobs(), 0);
        // An equal study solves nothing.
        let submitted = log.borrow().submitted;
        drivers[0].start(map(40.0), &mut studies);
        finish(&mut drivers[0], &mut studies);
        assert_eq!((log.borrow().submitted, studies.store.reused()), (submitted, 41));
    }

    #[test]
    fn a_study_takes_the_result_of_an_equal_scene_of_the_session() {
        let (mut studies, log) = studies(&[]);
        let map = map(20.0);
        let mut session = Session::new(map.scene(7, 0).unwrap()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        studies.share(&session);
        studies.share(&session);
        assert_eq!((studies.store.len(), studies.store.solved()), (1, 0));
        let mut driver = Driver::default();
        driver.start(map, &mut studies);
        finish(&mut driver, &mut studies);
        assert_eq!((studies.store.reused(), studies.store.solved()), (1, 40));
        let taken = driver.study().unwrap().case(7, 0).unwrap();
        let outcome = session.result().unwrap();
        assert_eq!(taken, &Case::of(outcome, session.scene()));
        assert!(log.borrow().submitted > 0);
    }

    #[test]
    fn a_new_study_cancels_the_jobs_of_the_previous_one() {
        let (mut studies, log) = studies(&[]);
        let mut driver = Driver::default();
        driver.start(map(20.0), &mut studies);
        studies.poll(&egui::Context::default(), false);
        driver.advance(&mut studies);
        let running: Vec<usize> = driver.running.keys().copied().collect();
        assert!(!running.is_empty() && studies.jobs() == running.len());
        // One job has finished, its cases are not taken yet.
        studies.poll(&egui::Context::default(), false);
        driver.start(map(40.0), &mut studies);
        assert_eq!(log.borrow().cancelled, running);
        assert_eq!(driver.progress(), (0, 41));
        finish(&mut driver, &mut studies);
        assert_eq!(
            driver.study().unwrap().case(0, 0).map(|case| case.error.is_some()),
            Some(false)
        );
        assert!(studies.finished.is_empty());
        driver.cancel(&mut studies);
        assert!(driver.study().is_none() && !driver.is_running());
    }

    #[test]
    fn held_studies_submit_nothing() {
        let (mut studies, log) = studies(&[]);
        let mut driver = Driver::default();
        driver.start(map(20.0), &mut studies);
        for _ in 0..3 {
            studies.poll(&egui::Context::default(), true);
            assert!(!driver.advance(&mut studies));
        }
        assert_eq!(log.borrow().submitted, 0);
        finish(&mut driver, &mut studies);
        assert_eq!(driver.progress(), (41, 41));
    }

    #[test]
    fn a_failed_job_is_named_in_one_line_and_the_study_ends() {
        let (mut studies, _) = studies(&[1]);
        let mut driver = Driver::default();
        driver.start(map(20.0), &mut studies);
        finish(&mut driver, &mut studies);
        let line = driver.failure().unwrap();
        assert_eq!(line, "A scene was not solved: job 1: internal error: a defect");
        // A further attempt has neither the failure nor its cases.
        driver.start(map(20.0), &mut studies);
        finish(&mut driver, &mut studies);
        assert_eq!(driver.failure(), None);
        let study = driver.study().unwrap();
        assert!((0..41).all(|i| study.case(i, 0).is_some_and(|case| case.error.is_none())));
    }
}
