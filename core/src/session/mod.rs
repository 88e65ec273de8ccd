//! Document state: current scene, undo history, running solve, pinned scenes.
//!
//! The app and the page send [`Command`]s; [`Session::apply`] executes a command, and a rejected command changes
//! nothing. [`Session::advance`] runs a slice of the solve, [`Session::advance_pins`] of the solve of a pinned scene.
//!
//! Uses all modules to its left. Used by the lab, `view`, `app` and `platform`.

mod coarse;
mod command;
mod counters;
mod other_side;
mod pace;
mod pins;
mod reading;
mod record;

use crate::measure::{Fields, Outcome};
use crate::scene::pins::document_json;
use crate::scene::{CheckedScene, Document, Scene, SceneError};
use crate::simulate;
use crate::solve::{Displayed, Invalid, Options, Progress, Solver, Verdict};
use crate::springs::stability::Limits;
use coarse::Coarse;
pub use command::{Command, CommandError};
pub use counters::Counters;
pub use other_side::OtherSide;
use other_side::Solved;
pub use pins::Pin;
use pins::PinSolve;
pub use record::{Answer, Record};
use std::cell::{Cell, OnceCell};
use std::rc::Rc;

/// Undo steps kept.
const HISTORY: usize = 100;

/// Position error of a draft during the drag of a control \[base radius\].
const DRAFT_TOLERANCE: f64 = 1e-3;

/// The solve of the current scene.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// The solver computes the scene.
    Solving(Shown),
    /// The solver has ended; its solution is measured, or is to be measured.
    Done { is_measured: bool },
    /// The current solution is that of a pin; the solver still has its previous problem.
    Held,
    /// The user has cancelled the solve; there is no shape.
    Stopped,
}

/// The display of a running solve.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shown {
    /// No shape yet.
    Nothing,
    /// The shape of the previous scene or of a coarse grid, or a measured draft.
    Shape,
    /// A draft that is to be measured.
    NewDraft,
}

/// A result with its scene.
struct Measured {
    outcome: Outcome,
    /// The scene if that is a previous one; `None`: the current scene, draft included.
    previous: Option<Scene>,
}

/// The current scene, its history and its solve; the pinned scenes.
pub struct Session {
    scene: Scene,
    undo: Vec<Scene>,
    redo: Vec<Scene>,
    last_gesture: Option<u64>,
    solver: Solver,
    coarse: Coarse,
    state: State,
    revision: u64,
    /// The fields of the displayed shape: the previous shape until the solver has a shape of the current scene.
    fields: OnceCell<Rc<Fields>>,
    /// The last scene with an answer, with its fields; absent if nothing displayed its shape.
    last_answer: Option<Answer>,
    /// Stability limits of the current layers under the paper's springs.
    stability_limits: OnceCell<Limits>,
    measured: Option<Measured>,
    /// The last scene with a valid solution.
    valid: Scene,
    /// A plan that was opened since.
    opened: Option<Scene>,
    reverted: Option<Invalid>,
    counters: Cell<Counters>,
    /// In the order of their letters.
    pins: Vec<Pin>,
    pins_added: u64,
    pins_revision: u64,
    pin_solve: Option<PinSolve>,
    /// The plan of the other side, where it has one of its own.
    other_side: Option<OtherSide>,
}

impl Session {
    /// A session on a valid scene at the start of its solve.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let options = Options { draft_tolerance: Some(DRAFT_TOLERANCE), ..Options::default() };
        let checked = CheckedScene::new(scene)?;
        let solver = Solver::with_options(checked.problem(), options);
        let scene = checked.into_scene();
        let other_side = OtherSide::of(&scene);
        Ok(Self {
            valid: scene.clone(),
            opened: None,
            reverted: None,
            scene,
            undo: Vec::new(),
            redo: Vec::new(),
            last_gesture: None,
            solver,
            coarse: Coarse::default(),
            state: State::Solving(Shown::Nothing),
            revision: 1,
            fields: OnceCell::new(),
            last_answer: None,
            stability_limits: OnceCell::new(),
            measured: None,
            counters: Cell::new(Counters { solves: 1, ..Counters::default() }),
            pins: Vec::new(),
            pins_added: 0,
            pins_revision: 0,
            pin_solve: None,
            other_side,
        })
    }

    /// The current scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Executes a command.
    ///
    /// # Errors
    /// One line, for an invalid scene with its field; the session is unchanged.
    pub fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        match command {
            Command::Edit { mut scene, gesture } => {
                if scene.side == self.scene.side || scene.other_side.is_none() {
                    scene.drop_reference_of(&self.scene);
                }
                scene.align_other_side();
                let merge = self.last_gesture == Some(gesture);
                if self.replace(CheckedScene::new(*scene)?, merge) {
                    self.last_gesture = Some(gesture);
                }
            }
            Command::CancelGesture(gesture) => {
                if self.last_gesture == Some(gesture)
                    && let Some(scene) = self.undo.pop()
                {
                    self.show(CheckedScene::new(scene)?);
                    self.last_gesture = None;
                }
            }
            Command::Open(json) => {
                let Document { scene, pins } = Document::from_json(&json)?;
                if let Some(pins) = pins {
                    self.set_pins(pins)?;
                }
                self.replace(scene, false);
                self.opened = Some(self.scene.clone());
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
            Command::Pin => self.pin_scene()?,
            Command::Unpin(letter) => self.unpin(letter)?,
            Command::Rename(letter, name) => self.rename_pin(letter, name)?,
            Command::OpenPin(letter) => {
                let pin = self.pin(letter).ok_or(CommandError::NoPin(letter))?;
                self.replace(CheckedScene::new(self.opened(pin))?, false);
                self.last_gesture = None;
            }
        }
        Ok(())
    }

    /// The current scene and its pins as the JSON text of a scene file.
    #[must_use]
    pub fn document_json(&self) -> String {
        document_json(&self.scene, &self.pinned_scenes())
    }

    /// [`Self::document_json`] without the visit, for a link.
    #[must_use]
    pub fn shared_document_json(&self) -> String {
        document_json(&self.scene.without_visit(), &self.pinned_scenes())
    }

    /// Does the history contain a step for [`Command::Undo`]?
    #[must_use]
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Does the history contain a step for [`Command::Redo`]?
    #[must_use]
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    /// Replaces the current scene as a step of the history, or within the last one. Returns false for an equal scene.
    fn replace(&mut self, scene: CheckedScene, merge: bool) -> bool {
        if *scene.scene() == self.scene {
            return false;
        }
        let before = self.show(scene);
        if !merge {
            if self.undo.len() == HISTORY {
                self.undo.remove(0);
            }
            self.undo.push(before);
        }
        self.redo.clear();
        true
    }

    /// Replaces the current scene; returns the previous scene. Only a change of the physics to that of no pin starts a
    /// solve.
    fn show(&mut self, checked: CheckedScene) -> Scene {
        self.set_side_of_pins(checked.scene().side);
        let is_same = checked.scene().same_physics(&self.scene);
        let held = if is_same { None } else { self.held(checked.scene()) };
        self.update_other_side(checked.scene());
        if is_same {
            let before = std::mem::replace(&mut self.scene, checked.into_scene());
            if let Some(measured) = &mut self.measured {
                simulate::relabel(&mut measured.outcome, &before, &self.scene);
            }
            return before;
        }
        let problem = checked.problem();
        if problem.materials != self.problem().materials {
            self.stability_limits.take();
        }
        if let Some(solved) = held {
            return self.hold(checked.into_scene(), solved);
        }
        self.note_answer();
        // The previous shape is displayed, if it ever was, until the solver has another.
        let is_shown = self.is_shape_known() && self.fields.get().is_some();
        self.start_solve(&checked, problem);
        self.state = State::Solving(if is_shown { Shown::Shape } else { Shown::Nothing });
        self.count(|c| c.solves += 1);
        let before = std::mem::replace(&mut self.scene, checked.into_scene());
        if let Some(measured) = &mut self.measured {
            measured.previous.get_or_insert_with(|| before.clone());
        }
        before
    }

    /// Replaces the current scene by a scene whose solution a pin has; returns the previous scene.
    fn hold(&mut self, scene: Scene, Solved { outcome, fields }: Solved) -> Scene {
        self.reshaped();
        self.fields = OnceCell::from(fields);
        self.coarse.clear();
        self.last_answer = None;
        self.measured = Some(Measured { outcome, previous: None });
        self.state = State::Held;
        self.count(|c| c.shared += 1);
        self.valid.clone_from(&scene);
        self.opened = None;
        std::mem::replace(&mut self.scene, scene)
    }

    /// Runs a slice of the solve until `pause` returns true or the solve ends; calls `pause` every few milliseconds.
    ///
    /// A slice also ends with the first draft, an error below 0.1 % of the base radius, for display and measurement
    /// during the drag of a control; the next slice continues from the draft.
    pub fn advance(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        let progress = self.solve(pause);
        self.conclude();
        progress
    }

    /// The solver's part of [`Self::advance`], to be followed by [`Self::conclude`].
    pub fn solve(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        let State::Solving(shown) = self.state else { return Progress::Done };
        if self.coarse.waiting.is_some() {
            self.solve_coarse(pause);
            return Progress::Working;
        }
        let (work, revision) = (self.solver.work_units(), self.solver.revision());
        let progress = self.solver.advance(pause);
        let work = self.solver.work_units() - work;
        self.coarse.pace.add(work, self.solver.problem());
        let displayed = self.solver.displayed();
        // The solution of the coarser grid is a better shape than a start of the own one.
        let is_start = matches!(displayed, Displayed::Coarse { .. })
            && self.coarser_nodes_per_side().is_some();
        let has_moved = self.solver.revision() != revision && !is_start;
        self.count(|c| {
            c.slices += 1;
            c.work_units += work;
            c.previews += u64::from(has_moved && progress == Progress::Working);
        });
        if progress == Progress::Done {
            match self.solver.invalid() {
                Some(reason @ (Invalid::NotFinite | Invalid::Inverted)) if self.take_back() => {
                    self.reverted = Some(reason);
                    self.count(|c| c.reverted += 1);
                    return Progress::Working;
                }
                Some(_) => {}
                None => {
                    self.valid.clone_from(&self.scene);
                    self.opened = None;
                }
            }
        }
        if has_moved || progress == Progress::Done {
            if self.solver.displayed() == Displayed::Draft
                || self.solver.verdict() == Verdict::Converged
            {
                self.note_error();
            }
            self.coarse.clear();
            self.reshaped();
        }
        let is_draft = displayed == Displayed::Draft;
        self.state = match progress {
            Progress::Done => State::Done { is_measured: false },
            Progress::Working if !has_moved => State::Solving(shown),
            Progress::Working if is_draft => State::Solving(Shown::NewDraft),
            Progress::Working => State::Solving(Shown::Shape),
        };
        progress
    }

    /// Keeps the present solution as the last answer, before another scene.
    fn note_answer(&mut self) {
        if let Some(fields) = self.fields.get()
            && self.result().is_some()
            && !self.has_no_shape()
        {
            self.last_answer =
                Some(Answer { scene: self.scene.clone(), fields: Rc::clone(fields) });
        }
    }

    /// The last scene with an answer before the present one.
    #[must_use]
    pub fn last_answer(&self) -> Option<&Answer> {
        self.last_answer.as_ref()
    }

    /// Reverts to the last scene with a valid solution and solves that scene; [`Command::Redo`] restores the reverted
    /// scene. False if the current scene is the last valid scene.
    fn take_back(&mut self) -> bool {
        // First back to a plan that was opened since, of which the present one is an edit.
        let is_before =
            |opened: &Scene| self.undo.contains(opened) && !opened.is_same_plan(&self.scene);
        let valid = self.opened.take().filter(is_before).unwrap_or_else(|| self.valid.clone());
        // Side and visit are none of the solve's: their edits stay, unless each side has a plan of its own.
        let visit = self.scene.visit.clone();
        let side = if valid.other_side.is_some() { valid.side } else { self.scene.side };
        let valid = Scene { side, visit, ..valid };
        if valid.is_same_plan(&self.scene) {
            return false;
        }
        let Ok(valid) = CheckedScene::new(valid) else { return false };
        let faulty = self.show(valid);
        self.undo.pop_if(|scene| *scene == self.scene);
        self.redo.push(faulty);
        self.last_gesture = None;
        true
    }

    /// Cancels the running solve. Reverts to the last scene with a valid solution ([`Command::Redo`] restores the
    /// reverted scene); without such a scene the solve stops without a result until [`Self::resume`].
    pub fn cancel(&mut self) {
        if self.is_working() && !self.take_back() {
            self.state = State::Stopped;
            self.measured = None;
            if self.coarse.waiting.is_none() {
                self.coarse.clear();
            }
            self.reshaped();
        }
    }

    /// Was the solve of the current scene cancelled?
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.state == State::Stopped
    }

    /// Continues a cancelled solve.
    pub fn resume(&mut self) {
        if self.is_stopped() {
            self.state = State::Solving(Shown::Nothing);
        }
    }

    /// Why the last edit was reverted; the first call after a reversion returns the reason.
    pub fn reverted(&mut self) -> Option<Invalid> {
        self.reverted.take()
    }

    /// Measures a new draft or final solution.
    pub fn conclude(&mut self) {
        let measured = match self.state {
            State::Solving(Shown::NewDraft) => Some(State::Solving(Shown::Shape)),
            State::Done { is_measured: false } => Some(State::Done { is_measured: true }),
            _ => None,
        };
        if let Some(state) = measured {
            self.state = state;
            self.measure();
        }
        if !self.is_working() {
            self.share_solutions();
            if !self.has_no_shape() {
                self.last_answer = None;
            }
        }
    }

    /// Drops the displayed solution.
    fn reshaped(&mut self) {
        self.revision += 1;
        if let Some(fields) = self.fields.take()
            && !self.is_pinned(&fields)
        {
            self.count_fields(&fields);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edit_with_an_invalid_solution_is_reverted_and_can_be_redone() {
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
            assert_eq!(session.reverted(), Some(reason));
            assert_eq!(session.reverted(), None);
            while session.advance(&mut || false) == Progress::Working {}
            assert_eq!((session.scene(), session.shape()), (&scene, before.as_slice()));
            assert!(session.outcome().is_some_and(|o| o.projection_mm == Some(55.0)));
            assert!(!session.can_undo() && session.can_redo());
        }
        // The same scene can be solved again.
        session.apply(Command::Redo).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        assert_eq!(session.scene(), &other);
        assert_eq!(session.counters().reverted, 2);
    }

    #[test]
    fn a_first_scene_with_an_invalid_solution_has_no_shape() {
        let scene = Scene::default();
        let mut session = Session::new(scene).unwrap();
        session.solver.end_with(Invalid::NotFinite);
        assert_eq!(session.advance(&mut || false), Progress::Done);
        let outcome = session.outcome().unwrap();
        assert_eq!((outcome.projection_mm, outcome.warnings.len()), (None, 1));
    }
}
