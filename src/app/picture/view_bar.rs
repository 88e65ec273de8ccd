//! The controls of the picture, on the picture: what it is about, the standard views, on a narrow screen the menu of all else.

use super::view_menu::{VIEWS, view_menu};
use super::viewport::{Before, Options, PictureSubject};
use crate::app::frame::action::{Action, Task};
use crate::app::frame::commands::{entry_of, item};
use crate::app::frame::shared::Shared;
use crate::app::frame::toolbar::Layout;
use crate::app::texts::tr;
use crate::app::widgets::theme;
use crate::app::widgets::{Kind, NumberField, fit_fingers};
use crate::view::quantity::Quantity;
use eframe::egui::{self, Rect, Ui, UiBuilder};

/// Shows the controls over the top of the picture's area. Returns their height \[points\].
pub(crate) fn show(
    ui: &mut Ui,
    area: Rect,
    layout: Layout,
    shared: &Shared,
    actions: &mut Vec<Action>,
) -> f32 {
    // A layer or the tissue model may be gone.
    if !shared.options.quantity.is_of(shared.session.scene()) {
        actions.push(Action::ColourBy(Quantity::Strain));
    }
    let inner = area.shrink(theme::SPACE);
    let mut bar = ui.new_child(UiBuilder::new().id_salt("view bar").max_rect(inner));
    let ui = &mut bar;
    let row = ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = theme::SPACE_SMALL;
        ui.spacing_mut().button_padding.x = 6.0;
        fit_fingers(ui);
        subject_switch(ui, shared, actions);
        match layout {
            Layout::Narrow => view_menu(ui, true, shared, actions),
            Layout::Wide => {
                ui.add_space(theme::SPACE);
                for view in VIEWS {
                    item(ui, shared, Task::Look(view), actions);
                }
                before_switch(ui, shared, actions);
                cut_direction(ui, shared, actions);
            }
        }
    });
    row.response.rect.bottom() - area.top()
}

/// The switch of what the picture is about.
fn subject_switch(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let present = shared.options.subject();
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        for subject in PictureSubject::ALL {
            let (task, is_on) = (Task::Show(subject), present == Some(subject));
            let entry = entry_of(task);
            let button = egui::Button::selectable(is_on, tr(entry.name)).frame_when_inactive(true);
            let tooltip = shared.choices.device.words(tr(entry.tooltip));
            if ui.add(button).on_hover_text(tooltip).clicked() {
                actions.push(Action::Run(task));
            }
        }
    });
}

/// The switch of the body before, where a body is drawn; while it is on, that of the wipe.
fn before_switch(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    if !shared.options.has_torso() {
        return;
    }
    ui.add_space(theme::SPACE);
    let present = shared.options.before;
    let shown = if present == Before::Off { 1 } else { 2 };
    for way in [Before::Beside, Before::Wipe].into_iter().take(shown) {
        let (task, is_on) = (Task::ShowBefore(way), present == way);
        let entry = entry_of(task);
        let button = egui::Button::selectable(is_on, tr(entry.name)).frame_when_inactive(true);
        if ui.add(button).on_hover_text(tr(entry.tooltip)).clicked() {
            actions.push(Action::Run(task));
        }
    }
}

/// The field of the cut's direction \[°\], for research and for another direction than the usual one.
fn cut_direction(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let degrees = shared.options.section_azimuth_deg;
    let is_usual = degrees.to_bits() == Options::default().section_azimuth_deg.to_bits();
    if !shared.research && is_usual {
        return;
    }
    // Always present, so that nothing moves; without a cut the direction waits for one.
    ui.add_enabled_ui(shared.options.section, |ui| {
        ui.label(tr("Cut at"));
        let mut angle = f64::from(degrees);
        let field = NumberField {
            name: tr("Direction of the cut"),
            kind: Kind::Angle,
            allowed: -180.0..=180.0,
            decimals: 0,
            step: 5.0,
            width: 34.0,
            ..NumberField::default()
        };
        let typed = field.show(ui, &mut angle);
        if typed.is_changed {
            actions.push(Action::CutAt(angle as f32));
        }
        typed
            .response
            .on_hover_text(tr("Direction of the cut in degrees; the arrow keys turn the cut"));
    });
}
