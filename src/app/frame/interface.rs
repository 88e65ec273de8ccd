//! The interface to platform and tests beside the frames: figures, words for screen readers, texts that are stored between starts, links,
//! language.

use super::messages::{Notice, Severity};
use super::shared::Shared;
use super::stats::Stats;
use super::{controls, link};
use crate::app::answer::compare::{DELAY, KeptPlan, is_due};
use crate::app::texts::{Language, language, set_language, shown, tr};
use crate::app::{App, answer};
use crate::clinical::{PracticeTable, Shelf};
use crate::measure::Status;
use crate::scene::Scene;
use crate::scene::pins::{pins_from_json, pins_json};
use crate::session::{Pin, Session};
use web_time::{Duration, Instant};

/// What a plan of a scan says after a reload, which keeps her wall and tissue but no picture of her.
const NO_BODY: &str = "Her body is not kept here: the picture is that of a usual torso, the numbers are hers. Open the saved plan to see her.";

/// Stored text of a switch that is on.
const ON: &str = "on";

impl App {
    /// Figures of the running app.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let Shared { session, timing, .. } = &self.shared;
        let is_converged = session.result().is_some_and(|o| o.status == Status::Converged);
        let counters = session.counters();
        let (range_done, range_all) = self.panels.range.progress();
        let (samples_done, samples_all) = self.shared.uncertainty.progress();
        Stats {
            frames: timing.frame_count,
            frame_ms_p50: timing.percentile(0.5),
            frame_ms_p95: timing.percentile(0.95),
            solve_ms: timing.solve_ms,
            solver_ms_p50: timing.slices.percentile(0.5),
            solver_ms_p95: timing.slices.percentile(0.95),
            solver_ms_max: timing.slice_max,
            converged: is_converged,
            solves: counters.solves,
            work_units: counters.work_units,
            tables: counters.tables,
            measurements: counters.measurements,
            range_done,
            range_all,
            samples_done,
            samples_all,
            jobs: self.studies.jobs(),
        }
    }

    /// The answer in a few sentences, for screen readers; before it the chosen point of the range of implants.
    #[must_use]
    pub fn summary(&self) -> String {
        let answer = answer::summary(
            &self.shared.session,
            &self.shared.practices,
            self.shared.choices.device,
            self.shared.pending(),
        ) + &self.panels.nearest.summary(&self.shared.session)
            + &answer::other_side_in_words(&self.shared.session, &self.shared.practices)
                .map_or_else(String::new, |words| format!(" {words}"))
            + &self.shares_in_words()
            + &self.shared.volume_marks.largest_in_words(&self.shared.practices)
            + &self.shared.uncertainty.summary()
            + &self.pinned();
        self.panels.range.summary().map_or(answer.clone(), |point| format!("{point} {answer}"))
    }

    /// What stands in place of [`Self::summary`] from an edit on, until the words of the edited plan rest.
    #[must_use]
    pub fn updating(&self) -> &'static str {
        answer::updating()
    }

    /// The sampled patients by the words of the cards; empty before they are solved.
    fn shares_in_words(&self) -> String {
        let Shared { session, practices, uncertainty, choices, .. } = &self.shared;
        let findings = uncertainty.of_cards(session.scene());
        answer::shares_in_words((session, practices), choices.device, findings)
    }

    /// The pins in a sentence; empty without pins.
    fn pinned(&self) -> String {
        let pin = |pin: &Pin| format!("{} {}", pin.letter(), pin.name()).trim_end().to_owned();
        let pins: Vec<String> = self.shared.session.pins().iter().map(pin).collect();
        if pins.is_empty() { String::new() } else { format!(" Pinned: {}.", pins.join(", ")) }
    }

    /// The words of the notice on the screen, for screen readers; empty without one.
    #[must_use]
    pub fn notice_in_words(&self) -> String {
        self.notice.as_ref().map_or_else(String::new, Notice::words)
    }

    /// Moves the keyboard focus to the first control of an accessible name, within the next frames; without such a control
    /// the focus stays.
    pub fn focus_control(&mut self, name: &str) {
        self.focus.mark_keyboard();
        controls::focus(&self.ctx, name);
    }

    /// Sets the address of the page without its fragment; links start with it.
    pub fn set_page_address(&mut self, address: String) {
        self.shared.page_address = Some(address);
    }

    /// Opens the plan in the fragment of an address; a fragment without a plan changes nothing. Returns whether there was one.
    pub fn open_link(&mut self, fragment: &str) -> bool {
        let Some(read) = link::plan_of(fragment) else { return false };
        let before = self.shared.session.scene().clone();
        let opened = read.and_then(|json| self.open(json).map_err(|e| e.to_string()));
        let is_changed = !before.is_same_plan(self.shared.session.scene());
        let done = tr("Opened the plan of the link. Undo brings the previous one back.").to_owned();
        let notice = self.show_opened(opened, tr("The link"), done);
        // The page of a link that was open already says nothing.
        self.notice = (is_changed || notice.severity == Severity::Error).then_some(notice);
        self.request_frame();
        true
    }

    /// Sets the language of the texts: the kept choice of [`Self::take_language_to_store`], else that of the system's locale;
    /// English for every other one.
    pub fn restore_language(&mut self, kept: Option<&str>) {
        let system = || sys_locale::get_locale().and_then(|locale| Language::of(&locale));
        set_language(kept.and_then(Language::of).or_else(system).unwrap_or(Language::English));
    }

    /// The chosen language as text for the storage, once after each choice.
    pub fn take_language_to_store(&mut self) -> Option<String> {
        let is_due = std::mem::take(&mut self.keep.is_language_due);
        is_due.then(|| language().subtag().to_owned())
    }

    /// Sets the switch "Research" from the text of [`Self::take_research_to_store`]; off without one.
    pub fn restore_research(&mut self, kept: Option<&str>) {
        self.shared.research = kept == Some(ON);
    }

    /// The switch "Research" as text for the storage, once after each change.
    pub fn take_research_to_store(&mut self) -> Option<String> {
        let is_due = std::mem::take(&mut self.keep.is_research_due);
        is_due.then(|| if self.shared.research { ON } else { "off" }.to_owned())
    }

    /// The subtag of the present language, as "es".
    #[must_use]
    pub fn language(&self) -> &'static str {
        language().subtag()
    }

    /// Restores the pins from the text of [`Self::take_pins_to_store`]. An invalid text is ignored with a notice.
    pub fn restore_pins(&mut self, text: &str) {
        let read = pins_from_json(text).map_err(|error| error.to_string());
        let restored = read
            .and_then(|pins| self.shared.session.set_pins(pins).map_err(|error| error.to_string()));
        match restored {
            Ok(()) => self.keep.revision = self.shared.session.pins_revision(),
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
            self.shared.session = Session::new(scene.clone()).map_err(|e| e.to_string())?;
            (self.shared.choices, self.shared.show_strip) = (kept.choices, kept.cross_section);
            Ok((scene, kept.choices, kept.cross_section))
        });
        match restored {
            Ok(plan) => {
                if self.shared.has_stand_in() {
                    self.notice = Some(Notice::caution(tr(NO_BODY)));
                }
                self.keep.plan = plan;
            }
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
                self.panels.range.sizes.set(shelf);
                self.keep.shelf = self.panels.range.sizes.revision;
            }
            Err(error) => {
                self.notice = Some(Notice::caution(tr!(
                    "The kept sizes in stock were not read: {error}",
                    error = shown(&error)
                )));
            }
        }
    }

    /// The shelf as text for the storage, as [`Self::take_pins_to_store`]; empty without sizes.
    pub fn take_shelf_to_store(&mut self, is_closing: bool) -> Option<String> {
        is_due(&mut self.keep.shelf_due, is_closing).then(|| self.panels.range.sizes.shelf.to_csv())
    }

    /// Restores the practice table from the text of [`Self::take_practice_table_to_store`]. An invalid text is ignored with a notice.
    pub fn restore_practice_table(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        match PracticeTable::from_csv(text) {
            Ok(table) => {
                self.shared.practices.set_table(table);
                self.keep.practice = self.shared.practices.revision();
            }
            Err(error) => {
                self.notice = Some(Notice::caution(tr!(
                    "The kept practice table was not read: {error}",
                    error = shown(&error)
                )));
            }
        }
    }

    /// The practice table as text for the storage, as [`Self::take_pins_to_store`]; empty for the built-in one.
    pub fn take_practice_table_to_store(&mut self, is_closing: bool) -> Option<String> {
        let table = self.shared.practices.table();
        let text = || if table.is_built_in() { String::new() } else { table.to_csv() };
        is_due(&mut self.keep.practice_due, is_closing).then(text)
    }

    /// The pins as text for the storage, once after each change: after a short delay, or at once if the app
    /// `is_closing`.
    pub fn take_pins_to_store(&mut self, is_closing: bool) -> Option<String> {
        is_due(&mut self.keep.pins_due, is_closing)
            .then(|| pins_json(&self.shared.session.pinned_scenes()))
    }

    /// The plan without its visit as text for the storage, as [`Self::take_pins_to_store`]. The visit is kept in the plan's
    /// file only.
    pub fn take_plan_to_store(&mut self, is_closing: bool) -> Option<String> {
        if !is_due(&mut self.keep.plan_due, is_closing) {
            return None;
        }
        let scene = serde_json::to_value(self.shared.session.scene().without_visit()).ok()?;
        let (choices, cross_section) = (self.shared.choices, self.shared.show_strip);
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
    pub(crate) fn note_changes(&mut self) {
        let due = Instant::now() + DELAY;
        let mut is_changed = false;
        let revision = self.shared.session.pins_revision();
        if revision != self.keep.revision {
            self.keep.revision = revision;
            self.keep.pins_due = Some(due);
            is_changed = true;
        }
        let (scene, choices, strip) = &self.keep.plan;
        let is_same = *choices == self.shared.choices && *strip == self.shared.show_strip;
        if !scene.is_same_plan(self.shared.session.scene()) || !is_same {
            self.keep.plan =
                (self.shared.session.scene().clone(), self.shared.choices, self.shared.show_strip);
            self.keep.plan_due = Some(due);
            is_changed = true;
        }
        let shelf = self.panels.range.sizes.revision;
        if shelf != self.keep.shelf {
            self.keep.shelf = shelf;
            self.keep.shelf_due = Some(due);
            is_changed = true;
        }
        let practice = self.shared.practices.revision();
        if practice != self.keep.practice {
            self.keep.practice = practice;
            self.keep.practice_due = Some(due);
            is_changed = true;
        }
        if is_changed {
            // At rest the app draws nothing: a frame after the delay.
            self.ctx.request_repaint_after(DELAY + Duration::from_millis(20));
        }
    }
}
