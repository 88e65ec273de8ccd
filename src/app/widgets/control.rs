//! A row with a slider: label and unit, rail, number field, and the reason of a rejection.

use super::number_field::NumberField;
use super::quantity::{self, Kind};
use super::rail::Rail;
use crate::app::theme;
use eframe::egui::{self, RichText, Sense, Ui};
use std::ops::RangeInclusive;

/// A slider with label, unit, number field, tooltip, and reset by double-click.
pub(in crate::app) struct Control<'a> {
    pub(in crate::app) label: &'a str,
    /// Unit after the label.
    pub(in crate::app) unit: &'a str,
    /// Kind of the number, which determines the accepted units.
    pub(in crate::app) kind: Kind,
    /// Range of the rail.
    pub(in crate::app) range: RangeInclusive<f64>,
    /// Allowed values; `None`: the range of the rail.
    pub(in crate::app) allowed: Option<RangeInclusive<f64>>,
    /// Reason of the limit, shown for a value outside of it.
    pub(in crate::app) limit_reason: &'a str,
    pub(in crate::app) reset: f64,
    /// Minimum number of decimals shown.
    pub(in crate::app) decimals: usize,
    /// Rounding step of dragging and keys; 0: three significant digits.
    pub(in crate::app) step: f64,
    pub(in crate::app) logarithmic: bool,
    pub(in crate::app) tooltip: &'a str,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self {
            label: "",
            unit: "",
            kind: Kind::Plain,
            range: 0.0..=1.0,
            allowed: None,
            limit_reason: "",
            reset: 0.0,
            decimals: 1,
            step: 0.5,
            logarithmic: false,
            tooltip: "",
        }
    }
}

/// Response of a control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::app) struct ControlResponse {
    /// Has the value changed?
    pub(in crate::app) is_changed: bool,
    /// A value outside the allowed range, requested in this frame.
    pub(in crate::app) out_of_range: Option<f64>,
}

impl Control<'_> {
    pub(in crate::app) fn show(self, ui: &mut Ui, value: &mut f64) -> ControlResponse {
        let name = match self.unit {
            "" => self.label.to_owned(),
            unit => format!("{} ({unit})", self.label),
        };
        let allowed = self.allowed.unwrap_or_else(|| self.range.clone());
        let tooltip = format!(
            "{}\nDouble-click the name to reset to {}.",
            self.tooltip,
            quantity::format(self.reset, 0)
        );
        let label = ui.label(RichText::new(&name).color(ui.visuals().weak_text_color()));
        // Skipped by the Tab key.
        let label = label.interact(Sense::CLICK).on_hover_text(&tooltip);
        let (mut change, mut rejection) = (ControlResponse::default(), None);
        ui.horizontal(|ui| {
            // The field is to the right of the rail, at the same position in every row.
            let field_width = 62.0;
            let rail = Rail {
                name: &name,
                range: self.range.clone(),
                allowed: allowed.clone(),
                step: self.step,
                logarithmic: self.logarithmic,
                width: (ui.available_width() - field_width - 26.0).max(60.0),
            };
            let moved = rail.show(ui, value);
            moved.response.on_hover_text(&tooltip);
            let field = NumberField {
                name: &name,
                kind: self.kind,
                allowed,
                limit_reason: self.limit_reason,
                decimals: self.decimals,
                step: if self.step > 0.0 { self.step } else { 0.1 },
                width: field_width,
                is_invalid: false,
            };
            let typed = field.show(ui, value);
            change.is_changed = moved.is_changed || typed.is_changed;
            change.out_of_range = moved.out_of_range.or(typed.out_of_range);
            rejection = typed.rejection;
        });
        if let Some(rejection) = rejection {
            rejection_label(ui, &rejection);
        }
        if label.double_clicked() && value.to_bits() != self.reset.to_bits() {
            *value = self.reset;
            change.is_changed = true;
        }
        change
    }
}

/// Shows why an entry was rejected.
pub(in crate::app) fn rejection_label(ui: &mut Ui, reason: &str) {
    let color = theme::palette(ui.visuals()).bad;
    let words = RichText::new(format!("Not accepted: {reason}")).color(color);
    let response = ui.add(egui::Label::new(words).wrap());
    // A new reason is scrolled into view, once.
    let (key, frame) = (response.id.with(reason), ui.ctx().cumulative_frame_nr());
    let before = ui.data_mut(|data| {
        let before = data.get_temp::<u64>(key);
        data.insert_temp(key, frame);
        before
    });
    if before.is_none_or(|before| before + 1 < frame) {
        response.scroll_to_me(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_untouched_slider_keeps_its_value() {
        // Finer than the step, and outside the slider's range.
        for given in [55.3, 1.234_567, 130.0] {
            let mut value = given;
            let mut changed = false;
            egui::__run_test_ui(|ui| {
                let control =
                    Control { label: "Base radius", range: 10.0..=120.0, ..Control::default() };
                changed |= control.show(ui, &mut value).is_changed;
            });
            assert!(!changed && value.to_bits() == given.to_bits(), "{given} became {value}");
        }
    }
}
