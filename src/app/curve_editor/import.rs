//! A tensile test as text, pasted or of a file: what was read in it, and its units where they were guessed.

use crate::app::frame::action::{Action, Task};
use crate::app::frame::clipboard::Clipboard;
use crate::app::texts::{self, tr};
use crate::app::widgets::theme::SPACE;
use crate::app::widgets::{
    button_if, choice, labelled_box, rejection_label, remark, set_accessible_name,
};
use crate::tensile::{self, Given, StrainUnit, StressUnit, Tensile};
use eframe::egui::{self, Ui};

/// Height of the text \[points\].
const HEIGHT: f32 = 64.0;

/// The text and what was read in it.
#[derive(Default)]
pub(super) struct Import {
    /// The text of the field.
    text: String,
    /// The text that was read.
    source: String,
    given: Given,
    found: Option<Result<Tensile, String>>,
    clipboard: Clipboard,
    /// Has the clipboard no text for the page?
    is_refused: bool,
}

impl Import {
    /// Shows the ways of reading, and the units. Returns the test that was just read.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        width: f32,
        actions: &mut Vec<Action>,
    ) -> Option<&Tensile> {
        let mut is_wanted = self.ways(ui, width, actions);
        if is_wanted {
            (self.source, self.given) = (self.text.clone(), Given::default());
        }
        is_wanted |= self.units(ui);
        if is_wanted {
            self.read();
        }
        self.tensile().filter(|_| is_wanted)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// One line.
    pub(super) fn read_file(&mut self, text: String) -> Result<&Tensile, String> {
        (self.source, self.given) = (text, Given::default());
        self.read();
        self.tensile().ok_or_else(|| match &self.found {
            Some(Err(error)) => error.clone(),
            _ => String::new(),
        })
    }

    /// The test that was read.
    pub(super) fn tensile(&self) -> Option<&Tensile> {
        self.found.as_ref()?.as_ref().ok()
    }

    /// Reads the source; a text without rows that are left out leaves the field.
    fn read(&mut self) {
        let found = tensile::read(self.source.as_bytes(), self.given);
        if found.as_ref().is_ok_and(|found| found.left_out == 0) {
            self.text.clear();
        }
        self.found = Some(found.map_err(|error| texts::shown(&error.to_string())));
    }

    /// A button for a file, one for the clipboard, a field for a pasted text. Returns whether the text is to be read.
    fn ways(&mut self, ui: &mut Ui, width: f32, actions: &mut Vec<Action>) -> bool {
        let mut is_pasted = false;
        ui.horizontal(|ui| {
            let tip = tr("A tensile test: a table (CSV) with a strain and a stress in each row");
            if button_if(ui, true, tr("Open table…"), tr("Open table…"), tip) {
                actions.push(Action::Run(Task::OpenTable));
            }
            let tip = tr("Reads the table of the clipboard: a strain and a stress in each row");
            if button_if(ui, true, tr("Paste table"), tr("Paste table"), tip) {
                self.clipboard.request(ui.ctx());
            }
        });
        let hint = tr("Paste a table: a strain and a stress in each row");
        let area = egui::ScrollArea::vertical().id_salt("test").max_height(HEIGHT);
        let field = area.show(ui, |ui| {
            let field = egui::TextEdit::multiline(&mut self.text).hint_text(hint).desired_rows(3);
            ui.add(field.desired_width(width - 2.0 * SPACE))
        });
        let field = field.inner;
        set_accessible_name(&field, egui::Role::MultilineTextInput, tr("Table to read"));
        if field.changed() {
            self.is_refused = false;
        }
        match self.clipboard.poll(ui.ctx()) {
            Some(Some(text)) => {
                (self.text, self.is_refused, is_pasted) = (text, false, true);
            }
            Some(None) => {
                self.is_refused = true;
                field.request_focus();
            }
            None => {}
        }
        let tip = tr(
            "Replace the points by the curve of the table: the loading branch, smoothed by as much as it has noise",
        );
        let (is_able, name) = (!self.text.trim().is_empty(), tr("Use the table"));
        let is_wanted = button_if(ui, is_able, name, name, tip);
        if let Some(Err(reason)) = &self.found {
            rejection_label(ui, &tr!("{reason}. The points are unchanged.", reason));
        }
        if self.is_refused {
            remark(ui, tr("The clipboard gave no text: paste the table into this field (Ctrl+V)."));
        }
        is_pasted || is_wanted
    }

    /// Menus of the units that the table does not name. Returns whether a unit was chosen.
    fn units(&mut self, ui: &mut Ui) -> bool {
        let Some(guessed) = self.tensile().map(|found| found.guessed) else { return false };
        let before = self.given;
        let Given { strain, stress } = &mut self.given;
        if let Some(shown) = strain.or(guessed.strain) {
            unit(ui, tr("Strain in"), shown, StrainUnit::ALL, StrainUnit::name, strain);
        }
        if let Some(shown) = stress.or(guessed.stress) {
            unit(ui, tr("Stress in"), shown, StressUnit::ALL, StressUnit::name, stress);
        }
        self.given != before
    }

    /// Shows what was recognised, left out and converted, and the distance of the samples from the curve.
    pub(super) fn what_was_read(&self, ui: &mut Ui) {
        let Some(found) = self.tensile() else { return };
        for sentence in found.notes.iter().chain([&found.summary()]) {
            remark(ui, texts::shown(sentence));
        }
    }
}

/// A menu of units.
fn unit<T: Copy + PartialEq, const N: usize>(
    ui: &mut Ui,
    label: &str,
    shown: T,
    all: [T; N],
    name: fn(T) -> &'static str,
    given: &mut Option<T>,
) {
    labelled_box(ui, label, tr(name(shown)), |ui| {
        for unit in all {
            if choice(ui, unit == shown, tr(name(unit))).clicked() {
                *given = Some(unit);
            }
        }
    });
}
