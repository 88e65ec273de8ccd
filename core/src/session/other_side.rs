//! The plan of the other side beside the current scene, solved after it.
//!
//! Nothing is solved twice: a side with the physics of the current scene, of a pin or of the side before shares the solution, and sides that are exchanged
//! keep theirs.

use super::Session;
use crate::measure::{Fields, Outcome, Status};
use crate::scene::Scene;
use crate::simulate;
use std::rc::Rc;

/// Number of the other side's plan in place of a pin's, which are greater.
pub(super) const OTHER: u64 = 0;

/// Result and solution of a scene.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    pub(super) outcome: Outcome,
    pub(super) fields: Rc<Fields>,
}

impl Solved {
    pub(super) fn has_shape(&self) -> bool {
        self.outcome.status == Status::Converged
    }

    /// The same solution for a scene of the same physics.
    pub(super) fn relabelled(&self, of: &Scene, scene: &Scene) -> Self {
        let mut solved = self.clone();
        simulate::relabel(&mut solved.outcome, of, scene);
        solved
    }
}

/// The plan of the other side, with its result once it is solved.
#[derive(Debug)]
pub struct OtherSide {
    scene: Scene,
    solved: Option<Solved>,
    /// The fields of its last shape.
    fields: Option<Rc<Fields>>,
}

impl OtherSide {
    /// The plan of a scene's other side.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let scene = scene.other_side.as_deref()?.clone();
        Some(Self { scene, solved: None, fields: None })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(super) fn solved(&self) -> Option<&Solved> {
        self.solved.as_ref()
    }

    /// The result; `None` until the scene is solved.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.solved.as_ref().map(|solved| &solved.outcome)
    }

    /// The last shape of the side with its fields: during a solve that before.
    #[must_use]
    pub fn fields(&self) -> Option<&Rc<Fields>> {
        self.fields.as_ref()
    }
}

impl Session {
    /// The plan of the other side, where it has one of its own.
    #[must_use]
    pub fn other_side(&self) -> Option<&OtherSide> {
        self.other_side.as_ref()
    }

    /// Sets the plan of the other side before `next` becomes the current scene.
    pub(super) fn update_other_side(&mut self, next: &Scene) {
        let Some(mut other) = OtherSide::of(next) else {
            if let Some(before) = self.other_side.take().and_then(|before| before.fields) {
                self.drop_fields(&before);
            }
            return;
        };
        let before = self.other_side.as_ref();
        // An unstable side is not solved again either.
        let same = before.filter(|before| before.scene.same_physics(&other.scene));
        let kept =
            same.and_then(|before| Some(before.solved()?.relabelled(&before.scene, &other.scene)));
        let solved = kept.or_else(|| self.at_hand(&other.scene));
        let is_exchanged = self.scene.other_side.is_some() && self.scene.side == other.scene.side;
        other.fields = if is_exchanged {
            let is_shown = self.is_shape_known() && !self.has_no_shape();
            is_shown.then(|| Rc::clone(self.fields()))
        } else {
            // A shape on another body would tear the skin of this one.
            let is_on_body = |before: &&OtherSide| before.scene.has_body_of(&other.scene);
            before.filter(is_on_body).and_then(|before| before.fields.clone())
        };
        let is_other_problem = same.is_none();
        let before = self.other_side.replace(other).and_then(|before| before.fields);
        if is_other_problem {
            self.pin_solve.take_if(|solve| solve.number == OTHER);
        }
        if let Some(solved) = solved {
            self.set_other_side_solved(solved);
        }
        if let Some(before) = before {
            self.drop_fields(&before);
        }
    }

    pub(super) fn set_other_side_solved(&mut self, solved: Solved) {
        let Some(other) = &mut self.other_side else { return };
        let is_shape = solved.outcome.status != Status::Unstable;
        let fields = is_shape.then(|| Rc::clone(&solved.fields));
        let before = std::mem::replace(&mut other.fields, fields);
        other.solved = Some(solved);
        if let Some(before) = before {
            self.drop_fields(&before);
        }
    }
}
