//! A field for one number: the typed number is stored exactly, or rejected with a reason.

use super::quantity::{self, Kind};
use super::theme;
use super::{STEP_KEYS, arrow_keys, describe_range, field_frame, key_steps, set_value_requests};
use crate::app::texts::localized;
use eframe::egui::{self, Id, Key, Response, Ui};
use egui::accesskit::ActionData;
use egui::text::CCursorRange;
use std::ops::RangeInclusive;

/// A field for a number that is typed, or stepped by the arrow keys.
pub(crate) struct NumberField<'a> {
    /// Name for screen readers and tests.
    pub(crate) name: &'a str,
    pub(crate) kind: Kind,
    /// Allowed values.
    pub(crate) allowed: RangeInclusive<f64>,
    /// Reason of the limits; empty: the message contains the limit.
    pub(crate) limit_reason: &'a str,
    /// Minimum number of decimals shown.
    pub(crate) decimals: usize,
    /// Maximum number of decimals shown.
    pub(crate) most_decimals: usize,
    /// Step of the arrow keys.
    pub(crate) step: f64,
    /// Width \[points\].
    pub(crate) width: f32,
    /// Is the stored value invalid in its context?
    pub(crate) is_invalid: bool,
}

impl Default for NumberField<'_> {
    fn default() -> Self {
        Self {
            name: "",
            kind: Kind::Plain,
            allowed: f64::MIN..=f64::MAX,
            limit_reason: "",
            decimals: 1,
            most_decimals: 6,
            step: 1.0,
            width: 62.0,
            is_invalid: false,
        }
    }
}

/// Response of a number field.
pub(crate) struct FieldResponse {
    pub(crate) response: Response,
    /// Has the value changed?
    pub(crate) is_changed: bool,
    /// Reason why the text of the field was rejected.
    pub(crate) rejection: Option<String>,
    /// A number outside the allowed range, typed in this frame.
    pub(crate) out_of_range: Option<f64>,
}

/// Text being edited, or rejected.
#[derive(Clone)]
struct Edit {
    text: String,
    /// The value before the edit.
    base_value: f64,
    rejection: Option<String>,
}

/// Memory key of the number field with the keyboard focus.
pub(super) fn focus_key() -> Id {
    Id::unique("number field with the focus")
}

/// Drops what is typed in the number field with the focus: it belongs to another plan.
pub(crate) fn drop_typed_number(ctx: &egui::Context) {
    ctx.data_mut(|data| {
        if let Some(id) = data.get_temp::<Id>(focus_key()) {
            data.remove::<Edit>(id);
        }
    });
}

impl NumberField<'_> {
    pub(crate) fn show(self, ui: &mut Ui, value: &mut f64) -> FieldResponse {
        let id = ui.make_persistent_id((self.name, "number"));
        let before = *value;
        let kept = ui.data(|data| data.get_temp::<Edit>(id));
        let mut edit = kept.filter(|edit| edit.base_value.to_bits() == value.to_bits());
        let mut out_of_range = None;
        if ui.memory(|memory| memory.has_focus(id)) {
            ui.data_mut(|data| data.insert_temp(focus_key(), id));
            let steps = key_steps(ui, STEP_KEYS);
            if steps != 0.0 {
                *value = self.clamped(quantity::stepped(*value, self.step, steps));
                edit = None;
            }
        }
        for request in set_value_requests(ui, id) {
            let text = match request {
                ActionData::NumericValue(number) => number.to_string(),
                ActionData::Value(text) => text.into(),
                _ => continue,
            };
            out_of_range = self.commit(value, &mut edit, &text).or(out_of_range);
        }

        let shown = self.shown(edit.as_ref(), *value);
        let mut text = shown.clone();
        let is_rejected = self.is_invalid || edit.as_ref().is_some_and(|e| e.rejection.is_some());
        let mut response = ui.add(self.text_edit(ui, id, &mut text, is_rejected));
        if response.gained_focus() {
            select_all(ui, id, &text);
        }
        if text != shown {
            // A rejected number is validated again after every key.
            let was_rejected = edit.as_ref().is_some_and(|edit| edit.rejection.is_some());
            let rejection = if was_rejected { self.parse(&text).err() } else { None };
            edit = Some(Edit { text: text.clone(), base_value: *value, rejection });
        }
        let (enter, escape) =
            ui.input(|input| (input.key_pressed(Key::Enter), input.key_pressed(Key::Escape)));
        if escape && (response.lost_focus() || response.has_focus()) {
            edit = None;
        } else if (enter && response.has_focus()) || response.lost_focus() {
            if edit.is_some() {
                out_of_range = self.commit(value, &mut edit, &text).or(out_of_range);
            }
            if enter && response.has_focus() {
                select_all(ui, id, &self.shown(edit.as_ref(), *value));
            }
        }
        // A click outside an edit selects the whole number, as the first click does.
        if response.clicked() && edit.as_ref().is_none_or(|edit| edit.rejection.is_some()) {
            select_all(ui, id, &text);
        }
        let is_changed = value.to_bits() != before.to_bits();
        let rejection = edit.as_ref().and_then(|edit| edit.rejection.clone());
        ui.data_mut(|data| match edit {
            Some(edit) => {
                data.insert_temp(id, edit);
            }
            None => data.remove::<Edit>(id),
        });
        self.describe(ui, &response, *value);
        if let Some(rejection) = &rejection {
            response = response.on_hover_text(rejection);
        } else if self.formatted(*value).len() > 7 {
            // The number is longer than the field.
            response = response.on_hover_text(localized(value.to_string()));
        }
        FieldResponse { response, is_changed, rejection, out_of_range }
    }

    /// Text of the field: the text of an edit, otherwise the value.
    fn shown(&self, edit: Option<&Edit>, value: f64) -> String {
        edit.map_or_else(|| self.formatted(value), |edit| edit.text.clone())
    }

    fn formatted(&self, value: f64) -> String {
        quantity::format_at_most(value, self.decimals, self.most_decimals)
    }

    /// The text field, with a red frame around a rejected number.
    fn text_edit<'t>(
        &self,
        ui: &Ui,
        id: Id,
        text: &'t mut String,
        is_rejected: bool,
    ) -> egui::TextEdit<'t> {
        let mut frame = field_frame(ui);
        if is_rejected {
            frame.stroke = egui::Stroke::new(2.0, theme::palette(ui.visuals()).bad);
        }
        egui::TextEdit::singleline(text)
            .id(id)
            .frame(frame)
            .font(egui::TextStyle::Monospace)
            .align(egui::Align2::RIGHT_CENTER)
            .desired_width(self.width)
            .char_limit(64)
            .event_filter(arrow_keys())
            // Enter commits the number and keeps the focus.
            .return_key(None)
    }

    /// Commits a text: stores its number, or keeps the text with the reason of its rejection. Returns a
    /// number outside the allowed range.
    fn commit(&self, value: &mut f64, edit: &mut Option<Edit>, text: &str) -> Option<f64> {
        match self.parse(text) {
            Ok(number) => {
                // The displayed text is rounded: unchanged text leaves the value unchanged.
                if text != self.formatted(*value) {
                    *value = number;
                }
                *edit = None;
                None
            }
            Err(rejection) => {
                *edit = Some(Edit {
                    text: text.to_owned(),
                    base_value: *value,
                    rejection: Some(rejection),
                });
                quantity::parse(text, self.kind).ok()
            }
        }
    }

    fn parse(&self, text: &str) -> Result<f64, String> {
        quantity::parse_within(text, self.kind, &self.allowed, self.limit_reason)
    }

    fn clamped(&self, value: f64) -> f64 {
        value.max(*self.allowed.start()).min(*self.allowed.end())
    }

    fn describe(&self, ui: &Ui, response: &Response, value: f64) {
        response.widget_info(|| egui::WidgetInfo {
            label: Some(self.name.to_owned()),
            ..egui::WidgetInfo::drag_value(response.enabled(), value)
        });
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_role(egui::accesskit::Role::SpinButton);
            node.set_label(self.name);
            node.set_numeric_value(value);
        });
        describe_range(response, &self.allowed, self.step);
    }
}

fn select_all(ui: &Ui, id: Id, text: &str) {
    let mut state = egui::TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::select_all_str(text)));
    state.store(ui.ctx(), id);
}
