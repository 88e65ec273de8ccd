//! Pins from one start of the app to the next: the platform stores a text.

use crate::app::App;
use crate::app::messages::Notice;
use crate::scene::pins::{pins_from_json, pins_json};
use web_time::{Duration, Instant};

/// Delay between a change of the pins and its text for the storage; changes in between are stored once.
const DELAY: Duration = Duration::from_millis(400);

/// What of the pins is stored.
#[derive(Debug, Default)]
pub(in crate::app) struct Keep {
    /// The session's revision of the stored pins.
    revision: u64,
    /// When the present pins are to be stored.
    due: Option<Instant>,
    has_failed: bool,
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
                    Some(Notice::caution(format!("The kept pins were not read: {error}")));
            }
        }
    }

    /// The pins as text for the storage, once after each change: after a short delay, or at once if the app
    /// `is_closing`.
    pub fn take_pins_to_store(&mut self, is_closing: bool) -> Option<String> {
        let is_due = self.keep.due.is_some_and(|due| is_closing || Instant::now() >= due);
        is_due.then(|| {
            self.keep.due = None;
            pins_json(&self.session.pinned_scenes())
        })
    }

    /// Reports once that the storage does not work, in a private window for example.
    pub fn report_storage_failure(&mut self) {
        if !self.keep.has_failed {
            self.keep.has_failed = true;
            self.notify(
                "Pins cannot be kept here for the next start; a saved scene contains them.",
            );
            self.request_frame();
        }
    }

    /// Notes a change of the pins, in every frame.
    pub(in crate::app) fn note_pins(&mut self) {
        let revision = self.session.pins_revision();
        if revision != self.keep.revision {
            self.keep.revision = revision;
            self.keep.due = Some(Instant::now() + DELAY);
            // At rest the app draws nothing: a frame after the delay.
            self.ctx.request_repaint_after(DELAY + Duration::from_millis(20));
        }
    }
}
