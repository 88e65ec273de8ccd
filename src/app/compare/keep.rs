//! Plan, pins and shelf from one start of the app to the next: the platform stores three texts.

use crate::app::App;
use crate::app::messages::Notice;
use crate::app::plan::Choices;
use crate::app::texts::{shown, tr};
use crate::clinical::Shelf;
use crate::scene::Scene;
use crate::scene::pins::{pins_from_json, pins_json};
use crate::session::Session;
use serde::{Deserialize, Serialize};
use web_time::{Duration, Instant};

/// Delay between a change and its text for the storage; changes in between are stored once.
const DELAY: Duration = Duration::from_millis(400);

/// What of plan and pins is stored.
#[derive(Debug)]
pub(in crate::app) struct Keep {
    /// The session's revision of the stored pins.
    revision: u64,
    /// When the present pins are to be stored.
    pins_due: Option<Instant>,
    /// The stored plan with its choices and the switch of the cross-section, or that of the start, which is not stored.
    plan: (Scene, Choices, bool),
    /// When the present plan is to be stored.
    plan_due: Option<Instant>,
    /// The revision of the stored shelf.
    shelf: u64,
    /// When the present shelf is to be stored.
    shelf_due: Option<Instant>,
    has_failed: bool,
}

impl Keep {
    /// Nothing to store at the start with a scene.
    pub(in crate::app) fn new(scene: Scene) -> Self {
        let plan = (scene, Choices::default(), true);
        Self {
            revision: 0,
            pins_due: None,
            plan,
            plan_due: None,
            shelf: 0,
            shelf_due: None,
            has_failed: false,
        }
    }
}

/// A stored plan.
#[derive(Serialize, Deserialize)]
struct KeptPlan {
    scene: serde_json::Value,
    choices: Choices,
    /// Is the cross-section under the picture?
    #[serde(default = "is_shown")]
    cross_section: bool,
}

fn is_shown() -> bool {
    true
}

impl App {
    /// Restores the pins from the text of [`Self::take_pins_to_store`]. An invalid text is ignored with a notice.
    pub fn restore_pins(&mut self, text: &str) {
        let read = pins_from_json(text).map_err(|error| error.to_string());
        let restored =
            read.and_then(|pins| self.session.set_pins(pins).map_err(|error| error.to_string()));
        match restored {
            Ok(()) => self.keep.revision = self.session.pins_revision(),
            Err(error) => {
                self.notice =
                    Some(Notice::caution(tr!("The kept pins were not read: {error}", error)));
            }
        }
    }

    /// Restores the plan from the text of [`Self::take_plan_to_store`], before the first frame. An invalid text is ignored
    /// with a notice: the storage may be of another version.
    pub fn restore_plan(&mut self, text: &str) {
        let read = serde_json::from_str::<KeptPlan>(text).map_err(|error| error.to_string());
        let restored = read.and_then(|kept| {
            let scene = Scene::from_json(&kept.scene.to_string()).map_err(|e| e.to_string())?;
            self.session = Session::new(scene.clone()).map_err(|e| e.to_string())?;
            (self.plan, self.show_strip) = (kept.choices, kept.cross_section);
            Ok((scene, kept.choices, kept.cross_section))
        });
        match restored {
            Ok(plan) => self.keep.plan = plan,
            Err(error) => {
                self.notice =
                    Some(Notice::caution(tr!("The kept plan was not read: {error}", error)));
            }
        }
    }

    /// Restores the shelf from the text of [`Self::take_shelf_to_store`]. An invalid text is ignored with a notice.
    pub fn restore_shelf(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        match Shelf::from_csv(text) {
            Ok(shelf) => {
                self.range.sizes.set(shelf);
                self.keep.shelf = self.range.sizes.revision;
            }
            Err(error) => {
                self.notice = Some(Notice::caution(tr!(
                    "The kept shelf was not read: {error}",
                    error = shown(&error)
                )));
            }
        }
    }

    /// The shelf as text for the storage, as [`Self::take_pins_to_store`]; empty without sizes.
    pub fn take_shelf_to_store(&mut self, is_closing: bool) -> Option<String> {
        is_due(&mut self.keep.shelf_due, is_closing).then(|| self.range.sizes.shelf.to_csv())
    }

    /// The pins as text for the storage, once after each change: after a short delay, or at once if the app
    /// `is_closing`.
    pub fn take_pins_to_store(&mut self, is_closing: bool) -> Option<String> {
        is_due(&mut self.keep.pins_due, is_closing)
            .then(|| pins_json(&self.session.pinned_scenes()))
    }

    /// The plan without its visit as text for the storage, as [`Self::take_pins_to_store`]. The visit is kept in the plan's
    /// file only.
    pub fn take_plan_to_store(&mut self, is_closing: bool) -> Option<String> {
        if !is_due(&mut self.keep.plan_due, is_closing) {
            return None;
        }
        let scene = serde_json::to_value(self.session.scene().without_visit()).ok()?;
        let (choices, cross_section) = (self.plan, self.show_strip);
        serde_json::to_string(&KeptPlan { scene, choices, cross_section }).ok()
    }

    /// Reports once that the storage does not work, in a private window for example.
    pub fn report_storage_failure(&mut self) {
        if !self.keep.has_failed {
            self.keep.has_failed = true;
            // Words to act on: the notice stays.
            self.notice = Some(Notice::caution(tr(
                "Plan and pins cannot be kept here for the next start; a saved plan contains them.",
            )));
            self.request_frame();
        }
    }

    /// Notes a change of the plan or of the pins, in every frame.
    pub(in crate::app) fn note_changes(&mut self) {
        let due = Instant::now() + DELAY;
        let mut is_changed = false;
        let revision = self.session.pins_revision();
        if revision != self.keep.revision {
            self.keep.revision = revision;
            self.keep.pins_due = Some(due);
            is_changed = true;
        }
        let (scene, choices, strip) = &self.keep.plan;
        let is_same = *choices == self.plan && *strip == self.show_strip;
        if !scene.is_same_plan(self.session.scene()) || !is_same {
            self.keep.plan = (self.session.scene().clone(), self.plan, self.show_strip);
            self.keep.plan_due = Some(due);
            is_changed = true;
        }
        let shelf = self.range.sizes.revision;
        if shelf != self.keep.shelf {
            self.keep.shelf = shelf;
            self.keep.shelf_due = Some(due);
            is_changed = true;
        }
        if is_changed {
            // At rest the app draws nothing: a frame after the delay.
            self.ctx.request_repaint_after(DELAY + Duration::from_millis(20));
        }
    }
}

/// Is a text to be stored now? It is then stored once.
fn is_due(due: &mut Option<Instant>, is_closing: bool) -> bool {
    due.take_if(|due| is_closing || Instant::now() >= *due).is_some()
}
