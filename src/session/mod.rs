//! One user's work: the scene on the table, its undo history, and the shape being solved for it.
//!
//! The app and the page send [`Command`]s; one place ([`Session::apply`]) carries them out, and a
//! refused one changes nothing. [`Session::advance`] does a slice of solving.
//!
//! Uses everything to its left. Used by `experiment`, `view`, `app` and `platform`.

use crate::measure::{Field, Fields, Outcome, Status};
use crate::scene::{CheckedScene, Scene, SceneError};
use crate::simulate;
use crate::solve::{Displayed, Invalid, Options, Problem, Progress, Solution, Solver};
use crate::springs::Springs;
use crate::springs::stability::Limits;
use glam::DVec3;
use serde::Serialize;
use std::cell::{Cell, OnceCell};
use std::rc::Rc;
use std::sync::Arc;

/// Undo steps kept.
const HISTORY: usize = 100;

/// What a user may ask for.
#[derive(Clone, Debug)]
pub enum Command {
    /// Put a scene on the table. Edits of one gesture (a slider being dragged) are one undo step.
    Edit {
        /// The whole new scene.
        scene: Box<Scene>,
        /// Edits with the same gesture number, one after the other, are merged in the history.
        gesture: u64,
    },
    /// Open a scene file's text.
    Open(String),
    /// Take the last step back.
    Undo,
    /// Do it again.
    Redo,
}

/// The position error within which a moving control is answered \[share of the base radius\].
const DRAFT_TOLERANCE: f64 = 1e-3;

/// Work done so far: what was skipped is not counted. For `stats()` and tests.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counters {
    /// Solves started.
    pub solves: u64,
    /// Calls of [`Session::advance`] that did solver work.
    pub slices: u64,
    /// Force evaluations, in work units of the finest grid.
    pub work_units: f64,
    /// Times the results were measured.
    pub measurements: u64,
    /// Solutions taken from the solver, to be measured or displayed.
    pub solutions: u64,
    /// Solutions whose deformation was recovered at the nodes: the basis of results and fields.
    pub recoveries: u64,
    /// Nodal fields computed to be drawn in colour.
    pub fields: u64,
    /// Times that the spring law's tables were made.
    pub tables: u64,
    /// Times that the solver's nested grids were made.
    pub grids: u64,
    /// Scenes taken back because their shape was not sound.
    pub taken_back: u64,
    /// Stacks of layers that were asked at which strains the paper's springs lose their stability.
    pub stability_limits: u64,
    /// Shapes shown before they had converged: drafts and those of coarser grids.
    pub previews: u64,
}

/// A result as it is saved: nothing in it depends on what is open.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// The result.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// The scene that it is of.
    pub scene: Scene,
    /// Version of the program that computed it.
    pub program_version: &'static str,
    /// When it was saved: date and time, UTC, as in RFC 3339.
    pub date: String,
}

/// The scene, its history and its shape.
pub struct Session {
    scene: Scene,
    undo: Vec<Scene>,
    redo: Vec<Scene>,
    last_gesture: Option<u64>,
    solver: Solver,
    working: bool,
    revision: u64,
    fields: OnceCell<Rc<Fields>>,
    /// Of the present layers under the paper's springs.
    stability_limits: OnceCell<Limits>,
    outcome: Option<Outcome>,
    /// Is [`Self::outcome`] that of the present scene, if only of a draft?
    is_outcome_present: bool,
    is_measured: bool,
    is_stopped: bool,
    /// The last scene with a valid solution.
    valid: Scene,
    taken_back: Option<Invalid>,
    counters: Cell<Counters>,
}

impl Session {
    /// A session on a valid scene; nothing is solved yet.
    ///
    /// # Errors
    /// If the scene is out of its limits.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let options = Options { draft_tolerance: Some(DRAFT_TOLERANCE), ..Options::default() };
        let checked = CheckedScene::new(scene)?;
        let solver = Solver::with_options(checked.problem(), options);
        let scene = checked.into_scene();
        Ok(Self {
            valid: scene.clone(),
            taken_back: None,
            scene,
            undo: Vec::new(),
            redo: Vec::new(),
            last_gesture: None,
            solver,
            working: true,
            revision: 1,
            fields: OnceCell::new(),
            stability_limits: OnceCell::new(),
            outcome: None,
            is_outcome_present: false,
            is_measured: true,
            is_stopped: false,
            counters: Cell::new(Counters { solves: 1, ..Counters::default() }),
        })
    }

    /// The scene on the table.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Carries out a command.
    ///
    /// # Errors
    /// One line that names the field; nothing has changed then.
    pub fn apply(&mut self, command: Command) -> Result<(), SceneError> {
        match command {
            Command::Edit { scene, gesture } => {
                let merge = self.last_gesture == Some(gesture);
                self.replace(CheckedScene::new(*scene)?, merge)?;
                self.last_gesture = Some(gesture);
            }
            Command::Open(json) => {
                self.replace(CheckedScene::from_json(&json)?, false)?;
                self.last_gesture = None;
            }
            Command::Undo => {
                if let Some(scene) = self.undo.pop() {
                    let before = self.show(CheckedScene::new(scene)?);
                    self.redo.push(before);
                    self.last_gesture = None;
                }
            }
            Command::Redo => {
                if let Some(scene) = self.redo.pop() {
                    let before = self.show(CheckedScene::new(scene)?);
                    self.undo.push(before);
                    self.last_gesture = None;
                }
            }
        }
        Ok(())
    }

    /// Can [`Command::Undo`] do something?
    #[must_use]
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Can [`Command::Redo`] do something?
    #[must_use]
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    fn replace(&mut self, scene: CheckedScene, merge: bool) -> Result<(), SceneError> {
        if *scene.scene() == self.scene {
            return Ok(());
        }
        let before = self.show(scene);
        if !merge {
            if self.undo.len() == HISTORY {
                self.undo.remove(0);
            }
            self.undo.push(before);
        }
        self.redo.clear();
        Ok(())
    }

    /// Replaces the current scene; returns the one before. Only a change of the physics starts a solve.
    fn show(&mut self, checked: CheckedScene) -> Scene {
        if checked.scene().same_physics(&self.scene) {
            let before = std::mem::replace(&mut self.scene, checked.into_scene());
            if let Some(outcome) = &mut self.outcome {
                for (outcome, layer) in outcome.layers.iter_mut().zip(&self.scene.layers) {
                    outcome.tissue.clone_from(&layer.tissue);
                }
            }
            return before;
        }
        let problem = checked.problem();
        if problem.materials != self.solver.problem().materials {
            self.stability_limits.take();
        }
        self.solver.restart(problem);
        self.reshaped();
        self.working = true;
        self.is_stopped = false;
        self.is_outcome_present = false;
        self.count(|c| c.solves += 1);
        std::mem::replace(&mut self.scene, checked.into_scene())
    }

    /// Does a slice of solving, until `pause` says so or the solve ends; asks `pause` between
    /// steps of at most a few milliseconds. Returns whether there is more to do.
    ///
    /// A slice also ends when the shape is within 0.1 % of the base radius for the first time, so that
    /// it can be shown and measured while a control is moving; the next one goes on from there.
    pub fn advance(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        let progress = self.solve(pause);
        self.conclude();
        progress
    }

    /// The solving of [`Self::advance`], to be followed by [`Self::conclude`].
    pub fn solve(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        if !self.working {
            return Progress::Done;
        }
        let (work, revision) = (self.solver.work_units(), self.solver.revision());
        let progress = self.solver.advance(pause);
        let work = self.solver.work_units() - work;
        let has_moved = self.solver.revision() != revision;
        self.working = progress == Progress::Working;
        self.count(|c| {
            c.slices += 1;
            c.work_units += work;
            c.previews += u64::from(has_moved && progress == Progress::Working);
        });
        if !self.working {
            match self.solver.invalid() {
                Some(reason @ (Invalid::NotFinite | Invalid::Inverted)) if self.take_back() => {
                    self.taken_back = Some(reason);
                    self.count(|c| c.taken_back += 1);
                    return Progress::Working;
                }
                Some(_) => {}
                None => self.valid.clone_from(&self.scene),
            }
        }
        if has_moved || !self.working {
            self.reshaped();
            self.is_measured = self.working && self.solver.displayed() != Displayed::Draft;
        }
        progress
    }

    /// Goes back to the last scene with a sound shape, which is solved anew; the scene that had none can
    /// be had by [`Command::Redo`]. False if there is no other scene to go back to.
    fn take_back(&mut self) -> bool {
        if self.valid == self.scene {
            return false;
        }
        let Ok(valid) = CheckedScene::new(self.valid.clone()) else { return false };
        let faulty = self.show(valid);
        self.undo.pop_if(|scene| *scene == self.scene);
        self.redo.push(faulty);
        self.last_gesture = None;
        true
    }

    /// Gives up the solve under way. Goes back to the last scene with a sound shape, which is solved anew
    /// ([`Command::Redo`] tries the other one again); without such a scene the solve stops, and there is
    /// no result until [`Self::go_on`].
    pub fn cancel(&mut self) {
        if self.working && !self.take_back() {
            self.working = false;
            self.is_stopped = true;
            self.outcome = None;
            self.reshaped();
        }
    }

    /// Was the solve of the present scene stopped?
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Goes on with a solve that was stopped.
    pub fn go_on(&mut self) {
        self.working |= self.is_stopped;
        self.is_stopped = false;
    }

    /// Why the last scene was taken back, once after it was.
    pub fn taken_back(&mut self) -> Option<Invalid> {
        self.taken_back.take()
    }

    /// Measures a new shape that is worth it: a draft or the end of a solve.
    pub fn conclude(&mut self) {
        if !self.is_measured {
            self.is_measured = true;
            self.outcome = Some(simulate::measure(&self.scene, self.fields()));
            self.is_outcome_present = true;
            self.count(|c| c.measurements += 1);
        }
    }

    /// Drops the solution displayed so far.
    fn reshaped(&mut self) {
        self.revision += 1;
        if let Some(fields) = self.fields.take() {
            let (recoveries, computed) = work_of(&fields);
            self.count(|c| {
                c.recoveries += recoveries;
                c.fields += computed;
            });
        }
    }

    /// Is there solving left to do?
    #[must_use]
    pub fn is_working(&self) -> bool {
        self.working
    }

    /// The problem being solved: grid, patch, obstacle, layers.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        self.solver.problem()
    }

    /// Why the last shape of the present solve was invalid.
    #[must_use]
    pub fn invalid(&self) -> Option<Invalid> {
        self.solver.invalid()
    }

    /// Which shape is displayed.
    #[must_use]
    pub fn displayed(&self) -> Displayed {
        self.solver.displayed()
    }

    /// Fraction of the present solve that is done, 0 to 1.
    #[must_use]
    pub fn fraction_done(&self) -> f64 {
        self.solver.fraction_done()
    }

    /// The solver, for tests.
    #[must_use]
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// The solution to display; taken from the solver once for each shape, when it is first read.
    #[must_use]
    pub fn solution(&self) -> &Arc<Solution> {
        self.fields().solution()
    }

    /// Positions of the displayed solution's inner face \[mm\], shape (nodes_per_side², ); nodes outside the
    /// pocket lie on the wall.
    #[must_use]
    pub fn shape(&self) -> &[DVec3] {
        self.solution().inner()
    }

    /// Changes whenever [`Self::shape`] does.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The fields of [`Self::solution`].
    #[must_use]
    pub fn fields(&self) -> &Rc<Fields> {
        self.fields.get_or_init(|| {
            self.count(|c| c.solutions += 1);
            Rc::new(Fields::new(Arc::new(self.solver.solution())))
        })
    }

    /// Values of a field at the nodes of the displayed solution, shape (nodes_per_side², ), zero outside
    /// the sheet; computed when they are first read.
    #[must_use]
    pub fn values(&self, field: Field) -> &[f32] {
        self.fields().values(field)
    }

    /// At which strains an evenly stretched sheet of the present layers has no stable shape under the
    /// paper's springs; `None` while others are chosen. Found when first asked for, before and without
    /// solving.
    #[must_use]
    pub fn stability_limits(&self) -> Option<&Limits> {
        (self.scene.springs == Springs::Nikolaev).then(|| {
            self.stability_limits.get_or_init(|| {
                self.count(|c| c.stability_limits += 1);
                Limits::new(Springs::Nikolaev, &self.solver.problem().materials)
            })
        })
    }

    /// The greatest principal strain of the last result \[-\], if it has a shape.
    #[must_use]
    pub fn greatest_strain(&self) -> Option<f64> {
        let strain = self.outcome.as_ref()?.strain.as_ref()?;
        Some(strain.max_principal.max(0.0))
    }

    fn count(&self, add: impl FnOnce(&mut Counters)) {
        let mut counters = self.counters.get();
        add(&mut counters);
        self.counters.set(counters);
    }

    /// The last result; `None` before the first. While [`Self::is_working`], it belongs to the scene
    /// before or, where [`Self::is_outcome_present`], to a draft of this one.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// Is [`Self::outcome`] that of the present scene, if only of a draft of its shape?
    #[must_use]
    pub fn is_outcome_present(&self) -> bool {
        self.is_outcome_present && self.outcome.is_some()
    }

    /// The result of the present scene; `None` until its solve has ended.
    #[must_use]
    pub fn result(&self) -> Option<&Outcome> {
        self.outcome.as_ref().filter(|_| !self.working)
    }

    /// Has the solve ended without a stable shape, or was it stopped? Then [`Self::shape`] is not one to
    /// be shown.
    #[must_use]
    pub fn has_no_shape(&self) -> bool {
        self.is_stopped || self.result().is_some_and(|outcome| outcome.status == Status::Unstable)
    }

    /// Work done so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let mut counters = self.counters.get();
        counters.tables = self.solver.tables_built();
        counters.grids = self.solver.grids_built();
        if let Some(fields) = self.fields.get() {
            let (recoveries, computed) = work_of(fields);
            counters.recoveries += recoveries;
            counters.fields += computed;
        }
        counters
    }
}

/// Deformations recovered and fields computed of one solution.
fn work_of(fields: &Fields) -> (u64, u64) {
    (u64::from(fields.solution().has_deformation()), fields.computed())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_without_a_valid_shape_is_taken_back_and_can_be_tried_again() {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 17;
        let mut session = Session::new(scene.clone()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let before = session.shape().to_vec();
        let other = Scene { insertion: 0.5, ..scene.clone() };
        for reason in [Invalid::NotFinite, Invalid::Inverted] {
            let edit = Command::Edit { scene: Box::new(other.clone()), gesture: 1 };
            session.apply(edit).unwrap();
            session.solver.end_with(reason);
            assert_eq!(session.advance(&mut || false), Progress::Working);
            assert_eq!(session.taken_back(), Some(reason));
            assert_eq!(session.taken_back(), None);
            while session.advance(&mut || false) == Progress::Working {}
            assert_eq!((session.scene(), session.shape()), (&scene, before.as_slice()));
            assert!(session.outcome().is_some_and(|o| o.projection_mm == Some(55.0)));
            assert!(!session.can_undo() && session.can_redo());
        }
        // The app goes on, with the same scene too.
        session.apply(Command::Redo).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        assert_eq!(session.scene(), &other);
        assert_eq!(session.counters().taken_back, 2);
    }

    #[test]
    fn a_first_scene_without_a_valid_shape_shows_none() {
        let scene = Scene::default();
        let mut session = Session::new(scene).unwrap();
        session.solver.end_with(Invalid::NotFinite);
        assert_eq!(session.advance(&mut || false), Progress::Done);
        let outcome = session.outcome().unwrap();
        assert_eq!((outcome.projection_mm, outcome.warnings.len()), (None, 1));
    }
}
