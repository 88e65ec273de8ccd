//! What a picture shows: the displayed shape of a session, its last answer, or the shape of a pin.

use implant_preview_core::measure::Fields;
use implant_preview_core::scene::Scene;
use implant_preview_core::session::{Answer, OtherSide, Pin, Session};
use implant_preview_core::solve::{Displayed, Problem};
use std::rc::Rc;

/// A scene with its shape; by default a shape at rest, of a finished solve.
pub trait Subject {
    /// The scene.
    fn scene(&self) -> &Scene;
    /// The problem of the shape, which may be that of the previous scene.
    fn problem(&self) -> &Problem {
        self.fields().solution().problem()
    }
    /// The fields of the shape; the session copies a new shape at the first use.
    fn fields(&self) -> &Rc<Fields>;
    /// Another shape on the same grid and the part of the way to it \[-\], 0 to 1: the picture shows the shape in between.
    fn toward(&self) -> Option<(&Rc<Fields>, f32)> {
        None
    }
    /// The other side's plan, where it has one of its own: its shape, without which that side is drawn at rest. `None`: one plan for both sides.
    fn other_side(&self) -> Option<Option<&Rc<Fields>>> {
        self.scene().other_side.is_some().then_some(None)
    }
    /// Number that changes with the shape.
    fn revision(&self) -> u64;
    /// Is a solve running whose shape is neither a draft nor final?
    fn is_unsettled(&self) -> bool {
        false
    }
    /// Is a solve running?
    fn is_working(&self) -> bool {
        false
    }
    /// Is there no shape: none yet, or has the solve ended without a stable one?
    fn has_no_shape(&self) -> bool {
        false
    }
}

impl Subject for Session {
    fn scene(&self) -> &Scene {
        self.scene()
    }

    fn problem(&self) -> &Problem {
        self.displayed_problem().unwrap_or_else(|| self.problem())
    }

    fn fields(&self) -> &Rc<Fields> {
        self.fields()
    }

    fn other_side(&self) -> Option<Option<&Rc<Fields>>> {
        self.other_side().map(OtherSide::fields)
    }

    fn revision(&self) -> u64 {
        self.revision()
    }

    fn is_unsettled(&self) -> bool {
        let is_solution = self.coarser_nodes_per_side().is_some();
        self.is_working() && !is_solution && self.displayed() != Displayed::Draft
    }

    fn is_working(&self) -> bool {
        self.is_working()
    }

    fn has_no_shape(&self) -> bool {
        self.has_no_shape() || self.displayed_problem().is_none()
    }
}

/// The last scene of a session with an answer.
#[derive(Clone, Copy, Debug)]
pub struct LastAnswer<'a> {
    answer: &'a Answer,
    revision: u64,
}

impl<'a> LastAnswer<'a> {
    /// The last answer of a session, if the present scene has none.
    #[must_use]
    pub fn of(session: &'a Session) -> Option<Self> {
        let answer = session.last_answer().filter(|_| session.has_no_shape())?;
        Some(Self { answer, revision: session.revision() })
    }
}

impl Subject for LastAnswer<'_> {
    fn scene(&self) -> &Scene {
        &self.answer.scene
    }

    fn fields(&self) -> &Rc<Fields> {
        &self.answer.fields
    }

    fn revision(&self) -> u64 {
        self.revision
    }
}

/// The shape of a pin.
#[derive(Clone, Copy, Debug)]
pub struct PinnedShape<'a> {
    /// The pin.
    pub pin: &'a Pin,
    fields: &'a Rc<Fields>,
}

impl<'a> PinnedShape<'a> {
    /// The shape of a pin; `None` without a converged result.
    #[must_use]
    pub fn of(pin: &'a Pin) -> Option<Self> {
        pin.fields().filter(|_| pin.has_shape()).map(|fields| Self { pin, fields })
    }
}

impl Subject for PinnedShape<'_> {
    fn scene(&self) -> &Scene {
        self.pin.scene()
    }

    fn fields(&self) -> &Rc<Fields> {
        self.fields
    }

    fn other_side(&self) -> Option<Option<&Rc<Fields>>> {
        self.scene().other_side.is_some().then(|| self.pin.other_fields())
    }

    fn revision(&self) -> u64 {
        self.pin.number()
    }
}

/// A shape between two shapes of one plan at different insertions.
#[derive(Clone, Copy, Debug)]
pub struct Between<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The shape before.
    pub from: &'a Rc<Fields>,
    /// The shape after.
    pub to: &'a Rc<Fields>,
    /// Part of the way from the one to the other \[-\], 0 to 1.
    pub part: f32,
    /// Number of this shape, different from those of a session.
    pub revision: u64,
}

impl Subject for Between<'_> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn fields(&self) -> &Rc<Fields> {
        self.from
    }

    fn toward(&self) -> Option<(&Rc<Fields>, f32)> {
        Some((self.to, self.part))
    }

    fn revision(&self) -> u64 {
        self.revision
    }
}
