//! What the 3-D view shows: a session with its options, and what is drawn over its picture.

use super::envelope::Outline;
use super::options::Options;
use super::overlay;
use crate::app::answer::practice::Practices;
use crate::scene::Scene;
use crate::session::Session;
use crate::study::SectionBand;
use crate::view::camera::Standing;
use crate::view::color::Scale;
use crate::view::quantity::{Colouring, Quantity};
use crate::view::subject::Subject;
use eframe::egui::Rect;
use std::borrow::Cow;

/// What the 3-D view shows.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    pub(crate) session: &'a Session,
    pub(crate) options: &'a Options,
    /// What the stretches are compared with.
    pub(crate) practices: &'a Practices,
    /// Band of the skin whose lines are drawn.
    pub(crate) envelope: &'a [SectionBand],
    /// Outlines of pins.
    pub(crate) outlines: &'a [Outline],
    /// Height of the controls over the top of the picture \[points\].
    pub(crate) bar: f32,
    /// On paper a pin of the same plan has no picture of its own.
    pub(crate) is_on_paper: bool,
    /// A standard pose in place of the camera's.
    pub(crate) standing: Option<Standing>,
}

impl<'a> Shown<'a> {
    /// A session with nothing over its picture.
    pub(crate) fn new(
        session: &'a Session,
        options: &'a Options,
        practices: &'a Practices,
    ) -> Self {
        Self {
            session,
            options,
            practices,
            envelope: &[],
            outlines: &[],
            bar: 0.0,
            is_on_paper: false,
            standing: None,
        }
    }

    /// The picture's part of an area, and that of the scale below a standard pose; else the scale lies on the picture.
    pub(super) fn parted(&self, area: Rect) -> [Rect; 2] {
        match self.standing {
            Some(_) => overlay::above_scale(area),
            None => [area, Rect::NOTHING],
        }
    }
}

/// The colours of a subject.
pub(super) fn colouring(
    subject: &impl Subject,
    quantity: Quantity,
    practices: &Practices,
) -> Colouring {
    let skin = practices.skin(subject.scene(), subject.problem().skin_knee());
    Colouring { quantity, skin }
}

/// The scale of a plan's legend, without words while they are not known.
pub(super) fn of_legend<'a>(
    scale: &'a Scale,
    plan: &Scene,
    practices: &Practices,
) -> Cow<'a, Scale> {
    match practices.has_words(plan) {
        true => Cow::Borrowed(scale),
        false => Cow::Owned(Scale { words: Vec::new(), ..scale.clone() }),
    }
}
