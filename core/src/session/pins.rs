//! Pins: up to four solved scenes beside the current scene, for comparison.
//!
//! A pin shares solution and result with every scene of the same physics: the pin of a solved scene copies nothing, the
//! current scene shows the solution of a pin without a solve, and pins of a file are solved once each, after the current
//! scene, by [`Session::advance_pins`].

use super::counters::work_of;
use super::other_side::{OTHER, OtherSide, Solved};
use super::{CommandError, Session};
use crate::measure::{Fields, Outcome, Status};
use crate::scene::pins::{MAX_PINS, check_name, document_json};
use crate::scene::{CheckedScene, Letter, PinnedScene, Scene, SceneError, Side};
use crate::simulate;
use crate::solve::{Options, Progress, Solution, Solver};
use std::rc::Rc;
use std::sync::Arc;

/// A pinned scene, with its result once it is solved.
#[derive(Debug)]
pub struct Pin {
    pinned: PinnedScene,
    /// Has the scene a side of its own? Without one it has that of the current scene.
    has_side: bool,
    solved: Option<Solved>,
    /// The same of the other side's plan, where the scene has one.
    other_solved: Option<Solved>,
    /// Number of the pin, different for every pin of a session.
    number: u64,
}

/// What the number of a pin's other side has beside the pin's.
const OF_OTHER: u64 = 1 << 63;

/// The solve of a pin, of its other side or of the other side.
pub(super) struct PinSolve {
    pub(super) number: u64,
    solver: Solver,
}

impl Pin {
    /// The letter.
    #[must_use]
    pub fn letter(&self) -> Letter {
        self.pinned.letter
    }

    /// The user's name; may be empty.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.pinned.name
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.pinned.scene
    }

    /// The result; `None` until the scene is solved.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.solved.as_ref().map(|solved| &solved.outcome)
    }

    /// The solution with its fields; `None` until the scene is solved.
    #[must_use]
    pub fn fields(&self) -> Option<&Rc<Fields>> {
        self.solved.as_ref().map(|solved| &solved.fields)
    }

    /// The solution; `None` until the scene is solved.
    #[must_use]
    pub fn solution(&self) -> Option<&Arc<Solution>> {
        self.fields().map(|fields| fields.solution())
    }

    /// The shape of the other side's plan; `None` until it is solved and without such a plan.
    #[must_use]
    pub fn other_fields(&self) -> Option<&Rc<Fields>> {
        let solved = self.other_solved.as_ref();
        solved.filter(|solved| solved.has_shape()).map(|solved| &solved.fields)
    }

    /// Its scenes: its own, that of the other side, with their results.
    fn scenes(&self) -> impl Iterator<Item = (&Scene, Option<&Solved>)> {
        let other = self.scene().other_side.as_deref();
        let other = other.map(|other| (other, self.other_solved.as_ref()));
        [(self.scene(), self.solved.as_ref())].into_iter().chain(other)
    }

    /// Number of the pin, different for every pin of a session.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Its number and, where it has one, that of its other side.
    fn numbers(&self) -> impl Iterator<Item = u64> {
        let other = self.scene().other_side.is_some();
        [self.number].into_iter().chain(other.then_some(self.number | OF_OTHER))
    }

    /// Does the pin have a converged shape?
    #[must_use]
    pub fn has_shape(&self) -> bool {
        self.outcome().is_some_and(|outcome| outcome.status == Status::Converged)
    }
}

impl Session {
    /// The pins in the order of their letters.
    #[must_use]
    pub fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// Number of changes of the pins' scenes, letters and names.
    #[must_use]
    pub fn pins_revision(&self) -> u64 {
        self.pins_revision
    }

    /// The letter of the next pin; `None` if all letters are taken.
    #[must_use]
    pub fn free_letter(&self) -> Option<Letter> {
        Letter::ALL.into_iter().find(|&letter| self.pin(letter).is_none())
    }

    /// Scenes, letters and names of the pins as they were pinned, for a file.
    #[must_use]
    pub fn pinned_scenes(&self) -> Vec<PinnedScene> {
        let as_pinned = |pin: &Pin| {
            let mut pinned = pin.pinned.clone();
            pinned.scene.side = pinned.scene.side.filter(|_| pin.has_side);
            pinned
        };
        self.pins.iter().map(as_pinned).collect()
    }

    /// The scene of a pin for the present patient: visit, body and measured base of the breast are hers.
    pub(super) fn opened(&self, pin: &Pin) -> Scene {
        let now = &self.scene;
        let placement = now.placement.clone().filter(|_| pin.scene().is_on_wall_of(now));
        let mut scene = Scene { visit: now.visit.clone(), placement, ..pin.scene().clone() };
        if let (Some(other), Some(now)) = (&mut scene.other_side, &now.other_side) {
            other.placement = now.placement.clone().filter(|_| other.is_on_wall_of(now));
        }
        if let (Some(patient), Some(now)) = (&mut scene.patient, &now.patient) {
            let base = patient.base_now(now);
            patient.measured.base_width_mm = base.or(patient.measured.base_width_mm);
        }
        scene
    }

    /// [`Self::document_json`] without the surface of a body.
    #[must_use]
    pub fn document_json_without_surface(&self) -> String {
        document_json(&self.scene.without_surface(), &self.pinned_scenes())
    }

    /// The pin of a letter.
    #[must_use]
    pub fn pin(&self, letter: Letter) -> Option<&Pin> {
        self.pins.iter().find(|pin| pin.letter() == letter)
    }

    /// Pins the current scene. During its solve the pin has no result yet.
    pub(super) fn pin_scene(&mut self) -> Result<(), CommandError> {
        if let Some(pin) = self.pins.iter().find(|pin| pin.scene().is_same_plan(&self.scene)) {
            return Err(CommandError::Pinned(pin.letter()));
        }
        let is_converged = || self.result().is_some_and(|o| o.status == Status::Converged);
        if !self.is_working() && (self.is_stopped() || !is_converged()) {
            return Err(CommandError::NoResult);
        }
        let letter = self.free_letter().ok_or(CommandError::Full)?;
        let (name, scene) = (String::new(), self.scene.clone());
        self.add_pin(PinnedScene { letter, name, scene });
        self.pins_revision += 1;
        self.share_solutions();
        Ok(())
    }

    /// Removes a pin with its solution.
    pub(super) fn unpin(&mut self, letter: Letter) -> Result<(), CommandError> {
        let k = self.place(letter)?;
        let pin = self.pins.remove(k);
        self.pins_revision += 1;
        let solved = pin.solved.iter().chain(&pin.other_solved);
        solved.for_each(|solved| self.drop_fields(&solved.fields));
        self.pin_solve.take_if(|solve| solve.number & !OF_OTHER == pin.number);
        Ok(())
    }

    /// Changes the name of a pin.
    pub(super) fn rename_pin(&mut self, letter: Letter, name: String) -> Result<(), CommandError> {
        let k = self.place(letter)?;
        check_name("name", &name)?;
        if self.pins[k].pinned.name != name {
            self.pins[k].pinned.name = name;
            self.pins_revision += 1;
        }
        Ok(())
    }

    /// Replaces all pins, those of a file for example. Solutions at hand are shared; [`Self::advance_pins`] computes
    /// the others.
    ///
    /// # Errors
    /// The first invalid scene or name, or more pins than letters; the pins are then unchanged.
    pub fn set_pins(&mut self, pinned: Vec<PinnedScene>) -> Result<(), CommandError> {
        if pinned.len() > MAX_PINS {
            return Err(CommandError::Full);
        }
        for (k, pin) in pinned.iter().enumerate() {
            check_name(&format!("pins[{k}].name"), &pin.name)?;
            let at_pin = |source| SceneError::Pin { pin: k, source: Box::new(source) };
            pin.scene.validate().map_err(at_pin)?;
            if pinned[..k].iter().any(|other| other.letter == pin.letter) {
                return Err(CommandError::Pinned(pin.letter));
            }
        }
        if self.pinned_scenes() == pinned {
            return Ok(());
        }
        let before = std::mem::take(&mut self.pins);
        self.pin_solve = None;
        pinned.into_iter().for_each(|pin| self.add_pin(pin));
        // Scenes of the previous pins may be among the new ones.
        let all = before.iter().flat_map(Pin::scenes);
        let solved: Vec<(&Scene, &Solved)> =
            all.filter_map(|(scene, solved)| Some((scene, solved?))).collect();
        let of = |wanted: &Scene| {
            let same = solved.iter().find(|(scene, _)| scene.same_physics(wanted));
            same.map(|(scene, solved)| solved.relabelled(scene, wanted))
        };
        for pin in &mut self.pins {
            let other = pin.scene().other_side.as_deref();
            (pin.solved, pin.other_solved) = (of(pin.scene()), other.and_then(of));
        }
        let mut fields: Vec<Rc<Fields>> = Vec::new();
        for (_, solved) in solved {
            if !fields.iter().any(|own| Rc::ptr_eq(own, &solved.fields)) {
                fields.push(Rc::clone(&solved.fields));
            }
        }
        fields.iter().for_each(|fields| self.drop_fields(fields));
        self.pins_revision += 1;
        self.share_solutions();
        Ok(())
    }

    fn place(&self, letter: Letter) -> Result<usize, CommandError> {
        let place = self.pins.iter().position(|pin| pin.letter() == letter);
        place.ok_or(CommandError::NoPin(letter))
    }

    /// Adds a pin. A pin has no visit and no body: pins are kept in the browser and compared with other plans.
    fn add_pin(&mut self, mut pinned: PinnedScene) {
        self.pins_added += 1;
        pinned.scene = pinned.scene.without_visit();
        let has_side = pinned.scene.side.is_some();
        pinned.scene.side = pinned.scene.side.or(self.scene.side);
        let at = self.pins.partition_point(|pin| pin.letter() < pinned.letter);
        let (number, [solved, other_solved]) = (self.pins_added, [None, None]);
        self.pins.insert(at, Pin { pinned, has_side, solved, other_solved, number });
    }

    /// Sets the side of the pins that have none of their own.
    pub(super) fn set_side_of_pins(&mut self, side: Option<Side>) {
        for pin in self.pins.iter_mut().filter(|pin| !pin.has_side) {
            if pin.pinned.scene.side != side {
                pin.pinned.scene.side = side;
                self.pins_revision += 1;
            }
        }
    }

    /// The solution of a pin or of the other side with the physics of a scene.
    pub(super) fn held(&self, scene: &Scene) -> Option<Solved> {
        let pins = self.pins.iter().flat_map(Pin::scenes);
        let of_other = self.other_side.iter().map(|other| (other.scene(), other.solved()));
        let all = pins.chain(of_other).filter_map(|(of, solved)| Some((of, solved?)));
        let same = |(of, solved): &(&Scene, &Solved)| solved.has_shape() && of.same_physics(scene);
        let (of, solved) = all.into_iter().find(same)?;
        Some(solved.relabelled(of, scene))
    }

    /// Gives the other side and the pins without a solution the solutions of scenes with the same physics.
    pub(super) fn share_solutions(&mut self) {
        let pins = self.pins.iter().flat_map(Pin::numbers);
        for number in pins.chain([OTHER]).collect::<Vec<u64>>() {
            let Some((scene, None)) = self.beside(number) else { continue };
            if let Some(solved) = self.at_hand(scene) {
                self.count(|c| c.shared += 1);
                self.set_solved(number, solved);
                self.pin_solve.take_if(|solve| solve.number == number);
            }
        }
    }

    /// The solution of the current scene, of a pin or of the other side for a scene of the same physics.
    pub(super) fn at_hand(&self, scene: &Scene) -> Option<Solved> {
        let is_current = self.scene.same_physics(scene) && !self.is_stopped();
        match self.result().filter(|_| is_current) {
            Some(outcome) => {
                let (outcome, fields) = (outcome.clone(), Rc::clone(self.fields()));
                Some(Solved { outcome, fields }.relabelled(&self.scene, scene))
            }
            None => self.held(scene),
        }
    }

    /// The scene of a pin, of its other side or of the other side by its number, with its solution.
    fn beside(&self, number: u64) -> Option<(&Scene, Option<&Solved>)> {
        if number == OTHER {
            return self.other_side.as_ref().map(|other| (other.scene(), other.solved()));
        }
        let pin = self.pins.iter().find(|pin| pin.number == number & !OF_OTHER)?;
        pin.scenes().nth(usize::from(number & OF_OTHER != 0))
    }

    fn set_solved(&mut self, number: u64, solved: Solved) {
        if number == OTHER {
            self.set_other_side_solved(solved);
        } else if let Some(pin) = self.pins.iter_mut().find(|pin| pin.number == number & !OF_OTHER)
        {
            let place =
                if number & OF_OTHER == 0 { &mut pin.solved } else { &mut pin.other_solved };
            *place = Some(solved);
        }
    }

    /// Number of the next scene without a solution: of the other side, then of the pins and their other sides.
    fn unsolved(&self) -> Option<u64> {
        let pins = self.pins.iter().flat_map(Pin::numbers);
        let is_unsolved =
            |number: &u64| self.beside(*number).is_some_and(|(_, solved)| solved.is_none());
        [OTHER].into_iter().chain(pins).find(is_unsolved)
    }

    /// Runs a slice of the solve of the other side or of the next pin without a solution, after the solve of the current scene; calls
    /// `pause` every few milliseconds. Returns `Working` as long as one has no solution.
    pub fn advance_pins(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        let next = self.unsolved().filter(|_| !self.is_working());
        let Some(number) = next else { return Progress::Done };
        let Some((scene, _)) = self.beside(number) else { return Progress::Done };
        let scene = scene.clone();
        let mut solve = match self.pin_solve.take().filter(|solve| solve.number == number) {
            Some(solve) => solve,
            // The scene was checked before.
            None => match CheckedScene::new(scene.clone()) {
                Ok(scene) => {
                    self.count(|c| c.solves += 1);
                    let solver = Solver::with_options(scene.problem(), Options::default());
                    PinSolve { number, solver }
                }
                Err(_) => return Progress::Done,
            },
        };
        let work = solve.solver.work_units();
        let progress = solve.solver.advance(pause);
        let work = solve.solver.work_units() - work;
        self.count(|c| {
            c.slices += 1;
            c.work_units += work;
        });
        if progress == Progress::Working {
            self.pin_solve = Some(solve);
            return progress;
        }
        let fields = Rc::new(Fields::new(Arc::new(solve.solver.into_solution())));
        let outcome = simulate::measure(&scene, &fields);
        self.count(|c| {
            c.solutions += 1;
            c.measurements += 1;
        });
        self.set_solved(number, Solved { outcome, fields });
        self.share_solutions();
        if self.is_solving_pins() { Progress::Working } else { Progress::Done }
    }

    /// Is a pin or the other side without a solution?
    #[must_use]
    pub fn is_solving_pins(&self) -> bool {
        self.unsolved().is_some()
    }

    /// Counts the work of fields that neither a pin, nor the other side, nor the current scene uses any more.
    pub(super) fn drop_fields(&self, fields: &Rc<Fields>) {
        let is_current = self.fields.get().is_some_and(|own| Rc::ptr_eq(own, fields));
        if !is_current && !self.is_pinned(fields) {
            self.count_fields(fields);
        }
    }

    /// Does a pin or the other side share these fields?
    pub(super) fn is_pinned(&self, fields: &Rc<Fields>) -> bool {
        self.pinned_fields().any(|own| Rc::ptr_eq(own, fields))
    }

    fn pinned_fields(&self) -> impl Iterator<Item = &Rc<Fields>> {
        let of_other = self.other_side.iter().filter_map(OtherSide::fields);
        let of_pins = self.pins.iter().flat_map(Pin::scenes).filter_map(|(_, solved)| solved);
        of_pins.map(|solved| &solved.fields).chain(of_other)
    }

    /// Work of the fields in use: numbers of recovered deformations and computed fields.
    pub(super) fn work_of_fields(&self) -> (u64, u64) {
        let mut all: Vec<&Rc<Fields>> = Vec::new();
        for fields in self.fields.get().into_iter().chain(self.pinned_fields()) {
            if !all.iter().any(|own| Rc::ptr_eq(own, fields)) {
                all.push(fields);
            }
        }
        all.into_iter().map(|fields| work_of(fields)).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
    }
}
