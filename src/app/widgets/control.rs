//! A slider or a stepper: label and unit, rail or buttons, number field, and the reason of a rejection.

use super::number_field::NumberField;
use super::quantity::{self, Kind};
use super::rail::Rail;
use super::set_accessible_name;
use super::theme;
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::scene::Field;
use crate::scene::field::Scale;
use eframe::egui::{self, Response, RichText, Sense, Ui, vec2};
use std::ops::RangeInclusive;

/// Widths of label, number field and unit in a row \[points\].
const LABEL_WIDTH: f32 = 68.0;
const FIELD_WIDTH: f32 = 52.0;
const UNIT_WIDTH: f32 = 20.0;

/// A slider with label, unit, number field, tooltip, and reset by double-click.
pub(crate) struct Control<'a> {
    pub(crate) label: &'a str,
    /// Unit after the label.
    pub(crate) unit: &'a str,
    /// Kind of the number, which determines the accepted units.
    pub(crate) kind: Kind,
    /// Range of the rail.
    pub(crate) range: RangeInclusive<f64>,
    /// Allowed values; `None`: the range of the rail.
    pub(crate) allowed: Option<RangeInclusive<f64>>,
    /// Reason of the limit, shown for a value outside of it; empty: the message contains the limit.
    pub(crate) limit_reason: String,
    pub(crate) reset: f64,
    /// Minimum number of decimals shown.
    pub(crate) decimals: usize,
    /// Maximum number of decimals shown; a derived value needs no more.
    pub(crate) most_decimals: usize,
    /// Rounding step of dragging and keys; 0: three significant digits.
    pub(crate) step: f64,
    pub(crate) logarithmic: bool,
    /// Values above which the rail is marked as high, as more than high, and as without an answer.
    pub(crate) marks: [Option<f64>; 3],
    pub(crate) tooltip: &'a str,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self {
            label: "",
            unit: "",
            kind: Kind::Plain,
            range: 0.0..=1.0,
            allowed: None,
            limit_reason: String::new(),
            reset: 0.0,
            decimals: 1,
            most_decimals: 6,
            step: 0.5,
            logarithmic: false,
            marks: [None; 3],
            tooltip: "",
        }
    }
}

impl Control<'_> {
    /// The control of a number of the scene, within the limits of every scene.
    pub(crate) fn of(field: Field) -> Self {
        let (Scale { unit, factor, step, decimals }, (least, most)) = (field.scale, field.limits);
        let shown = |value: f64| quantity::significant(factor * value);
        Self {
            label: tr(field.label),
            unit: tr(unit),
            kind: Kind::of_unit(unit),
            range: shown(least)..=shown(most),
            decimals,
            step,
            tooltip: tr(field.help),
            ..Self::default()
        }
    }

    /// The control with a rail over other values than the allowed ones.
    pub(crate) fn with_rail(self, range: RangeInclusive<f64>) -> Self {
        Self { allowed: Some(self.range), range, ..self }
    }
}

/// Response of a control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ControlResponse {
    /// Has the value changed?
    pub(crate) is_changed: bool,
    /// A value outside the allowed range, requested in this frame.
    pub(crate) out_of_range: Option<f64>,
}

impl Control<'_> {
    /// Shows the control; the label stands above the rail.
    pub(crate) fn show(self, ui: &mut Ui, value: &mut f64) -> ControlResponse {
        let label = self.label(ui, &self.name());
        let rail = |ui: &Ui| (ui.available_width() - FIELD_WIDTH - 26.0).max(60.0);
        self.line(ui, value, label, |ui, line, value| {
            line.rail(ui, value, rail(ui));
            line.field(ui, value);
        })
    }

    /// Shows the control in one row: label, rail, number field, unit, and what `trailing` adds in the given width
    /// \[points\].
    pub(crate) fn row(
        self,
        ui: &mut Ui,
        value: &mut f64,
        (width, trailing): (f32, impl FnOnce(&mut Ui)),
    ) -> ControlResponse {
        let height = ui.spacing().interact_size.y;
        self.in_row(ui, value, height, |ui, line, value| {
            let space = ui.spacing().item_spacing.x;
            let others = FIELD_WIDTH + UNIT_WIDTH + 3.0 * space + 10.0 + width;
            let rail = ui.available_width() - others;
            // A rail of a few points would be of no use.
            if rail >= 40.0 {
                line.rail(ui, value, rail);
            }
            line.field(ui, value);
            line.unit(ui);
            trailing(ui);
        })
    }

    /// Shows the control in one row for fingers: label, minus, number field, plus, unit, and what `trailing` adds.
    pub(crate) fn stepper(
        self,
        ui: &mut Ui,
        value: &mut f64,
        trailing: impl FnOnce(&mut Ui),
    ) -> ControlResponse {
        self.in_row(ui, value, theme::TOUCH - 4.0, |ui, line, value| {
            line.step_button(ui, value, "−", tr("Less"), -1.0);
            line.field(ui, value);
            line.step_button(ui, value, "+", tr("More"), 1.0);
            line.unit(ui);
            trailing(ui);
        })
    }

    /// Shows label and number field without a rail, with buttons for fingers.
    pub(crate) fn number(self, ui: &mut Ui, value: &mut f64, is_finger: bool) -> ControlResponse {
        let label = self.label(ui, self.label);
        self.line(ui, value, label, |ui, line, value| {
            if is_finger {
                line.step_button(ui, value, "−", tr("Less"), -1.0);
            }
            line.field(ui, value);
            if is_finger {
                line.step_button(ui, value, "+", tr("More"), 1.0);
            }
            line.unit(ui);
        })
    }

    /// Shows a row of a height \[points\] with the label at its start.
    fn in_row(
        self,
        ui: &mut Ui,
        value: &mut f64,
        height: f32,
        add: impl FnOnce(&mut Ui, &mut Line<'_, '_>, &mut f64),
    ) -> ControlResponse {
        let row = ui.horizontal(|ui| {
            let size = vec2(LABEL_WIDTH, height);
            let layout = egui::Layout::left_to_right(egui::Align::Center);
            let label = ui
                .allocate_ui_with_layout(size, layout, |ui| {
                    ui.set_min_width(LABEL_WIDTH);
                    self.label(ui, self.label)
                })
                .inner;
            let mut line = Line::new(&self);
            add(ui, &mut line, value);
            (label, line.change, line.rejection)
        });
        let (label, change, rejection) = row.inner;
        self.finish(ui, value, &label, (change, rejection))
    }

    fn line(
        self,
        ui: &mut Ui,
        value: &mut f64,
        label: Response,
        add: impl FnOnce(&mut Ui, &mut Line<'_, '_>, &mut f64),
    ) -> ControlResponse {
        let done = ui.horizontal(|ui| {
            let mut line = Line::new(&self);
            add(ui, &mut line, value);
            (line.change, line.rejection)
        });
        self.finish(ui, value, &label, done.inner)
    }

    /// The allowed values.
    pub(crate) fn allowed(&self) -> RangeInclusive<f64> {
        self.allowed.clone().unwrap_or_else(|| self.range.clone())
    }

    /// Parses a typed value.
    ///
    /// # Errors
    /// Returns one line with what is wrong and what is allowed.
    pub(crate) fn parse(&self, text: &str) -> Result<f64, String> {
        quantity::parse_within(text, self.kind, &self.allowed(), &self.limit_reason)
    }

    /// A value as the number field shows it.
    pub(crate) fn shown(&self, value: f64) -> String {
        quantity::format_at_most(value, self.decimals, self.most_decimals)
    }

    /// Name with the unit, for screen readers and tests.
    fn name(&self) -> String {
        match self.unit {
            "" => self.label.to_owned(),
            unit => format!("{} ({unit})", self.label),
        }
    }

    fn tooltip(&self) -> String {
        tr!(
            "{tooltip}\nDouble-click the name to reset to {value}.",
            tooltip = self.tooltip,
            value = quantity::format_at_most(self.reset, 0, self.most_decimals)
        )
    }

    fn label(&self, ui: &mut Ui, text: &str) -> Response {
        let label = ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
        // Skipped by the Tab key.
        label.interact(Sense::CLICK).on_hover_text(Device::of(ui.ctx()).words(&self.tooltip()))
    }

    /// Shows a rejection and resets the value after a double-click on the label.
    fn finish(
        &self,
        ui: &mut Ui,
        value: &mut f64,
        label: &Response,
        (mut change, rejection): (ControlResponse, Option<String>),
    ) -> ControlResponse {
        if let Some(rejection) = rejection {
            let shown = quantity::format_at_most(*value, self.decimals, self.most_decimals);
            let counting = format!("{shown} {}", self.unit);
            let words =
                tr!("{rejection}; {counting} counts", rejection, counting = counting.trim_end());
            rejection_label(ui, &words);
        }
        if label.double_clicked() && value.to_bits() != self.reset.to_bits() {
            *value = self.reset;
            change.is_changed = true;
        }
        change
    }
}

/// The parts of a control in one line, and what they changed.
struct Line<'c, 'a> {
    control: &'c Control<'a>,
    name: String,
    change: ControlResponse,
    rejection: Option<String>,
}

impl<'c, 'a> Line<'c, 'a> {
    fn new(control: &'c Control<'a>) -> Self {
        Self { control, name: control.name(), change: ControlResponse::default(), rejection: None }
    }

    fn allowed(&self) -> RangeInclusive<f64> {
        self.control.allowed()
    }

    fn rail(&mut self, ui: &mut Ui, value: &mut f64, width: f32) {
        let rail = Rail {
            name: &self.name,
            range: self.control.range.clone(),
            allowed: self.allowed(),
            step: self.control.step,
            logarithmic: self.control.logarithmic,
            marks: self.control.marks,
            width,
        };
        let moved = rail.show(ui, value);
        moved.response.on_hover_text(Device::of(ui.ctx()).words(&self.control.tooltip()));
        self.change.is_changed |= moved.is_changed;
        self.change.out_of_range = self.change.out_of_range.or(moved.out_of_range);
    }

    fn field(&mut self, ui: &mut Ui, value: &mut f64) {
        let control = self.control;
        let field = NumberField {
            name: &self.name,
            kind: control.kind,
            allowed: self.allowed(),
            limit_reason: &control.limit_reason,
            decimals: control.decimals,
            most_decimals: control.most_decimals,
            step: if control.step > 0.0 { control.step } else { 0.1 },
            width: FIELD_WIDTH,
            is_invalid: false,
        };
        let typed = field.show(ui, value);
        self.change.is_changed |= typed.is_changed;
        self.change.out_of_range = self.change.out_of_range.or(typed.out_of_range);
        self.rejection = typed.rejection;
    }

    /// A button of a finger's size that steps the value.
    fn step_button(&mut self, ui: &mut Ui, value: &mut f64, text: &str, name: &str, steps: f64) {
        let button = ui.add_sized([theme::TOUCH, theme::TOUCH - 4.0], egui::Button::new(text));
        set_accessible_name(&button, egui::Role::Button, &format!("{name} {}", self.control.label));
        if button.clicked() {
            let allowed = self.allowed();
            let moved = quantity::stepped(*value, self.control.step, steps);
            *value = quantity::significant(moved).max(*allowed.start()).min(*allowed.end());
            self.change.is_changed = true;
        }
    }

    fn unit(&self, ui: &mut Ui) {
        let size = vec2(UNIT_WIDTH, ui.spacing().interact_size.y);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_width(UNIT_WIDTH);
            ui.label(RichText::new(self.control.unit).color(ui.visuals().weak_text_color()));
        });
    }
}

/// Shows why an entry was rejected.
pub(crate) fn rejection_label(ui: &mut Ui, reason: &str) {
    let color = theme::palette(ui.visuals()).bad;
    let words = RichText::new(tr!("Not accepted: {reason}", reason)).color(color);
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
