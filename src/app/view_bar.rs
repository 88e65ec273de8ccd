//! The controls of the picture, on the picture: standard views, cut, grid, colours.

use super::action::{Action, Task};
use super::commands::{entry_of, is_hidden, is_on, item};
use super::shared::Shared;
use super::texts::{self, tr};
use super::theme;
use super::toolbar::{Layout, view_menu};
use super::viewport::Options;
use super::widgets::{Kind, NumberField, choice, set_accessible_name};
use crate::view::camera::View;
use crate::view::color::Quantity;
use eframe::egui::{self, Rect, Ui, UiBuilder};

/// How the tissue is cut open: cut; in half. The names are those of the commands.
const CUTS: [(bool, bool); 3] = [(false, false), (true, false), (true, true)];

/// The colours without "Research".
const OFTEN: [Quantity; 4] =
    [Quantity::Tissue, Quantity::Strain, Quantity::Cover, Quantity::Pressure];

/// Shows the controls over the top of the picture's area. Returns their height \[points\].
pub(super) fn show(
    ui: &mut Ui,
    area: Rect,
    layout: Layout,
    shared: &Shared,
    actions: &mut Vec<Action>,
) -> f32 {
    let inner = area.shrink(theme::SPACE);
    let mut bar = ui.new_child(UiBuilder::new().id_salt("view bar").max_rect(inner));
    let ui = &mut bar;
    let row = ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = theme::SPACE_SMALL;
        ui.spacing_mut().button_padding.x = 6.0;
        for view in [View::Front, View::Side, View::Top, View::All] {
            item(ui, shared, Task::Look(view), actions);
        }
        cut_box(ui, layout, shared, actions);
        for switch in [Task::Grid, Task::Areola] {
            if is_hidden(shared, switch) {
                continue;
            }
            let (entry, is_on) = (entry_of(switch), is_on(shared, switch) == Some(true));
            let button = egui::Button::selectable(is_on, tr(entry.name)).frame_when_inactive(true);
            if ui.add(button).on_hover_text(tr(entry.tooltip)).clicked() {
                actions.push(Action::Run(switch));
            }
        }
        quantity_box(ui, shared, actions);
        if layout == Layout::Narrow {
            item(ui, shared, Task::ShowRange(true), actions);
            view_menu(ui, layout, shared, actions);
        }
    });
    row.response.rect.bottom() - area.top()
}

fn cut_box(ui: &mut Ui, layout: Layout, shared: &Shared, actions: &mut Vec<Action>) {
    let options = &shared.options;
    let present = (options.section, options.section && options.half);
    let name = |(section, half): (bool, bool)| tr(entry_of(Task::Cut(section, half)).name);
    let response = egui::ComboBox::from_id_salt("cut")
        .width(if layout == Layout::Wide { 104.0 } else { 96.0 })
        .selected_text(name(present))
        .show_ui(ui, |ui| {
            for cut in CUTS {
                if choice(ui, cut == present, name(cut)).clicked() {
                    actions.push(Action::Run(Task::Cut(cut.0, cut.1)));
                }
            }
        })
        .response;
    set_accessible_name(&response, egui::Role::ComboBox, tr("Cut"));
    response.on_hover_text(tr("Cut the tissue open to show its layers"));
    let usual = Options::default().section_azimuth_deg;
    let is_turned = options.section_azimuth_deg.to_bits() != usual.to_bits();
    if layout == Layout::Narrow || !(shared.research || is_turned) {
        return;
    }
    // Always present, so that nothing moves; without a cut the direction waits for one.
    ui.add_enabled_ui(options.section, |ui| {
        cut_direction(ui, options.section_azimuth_deg, actions);
    });
}

/// The field of the cut's direction \[°\].
fn cut_direction(ui: &mut Ui, degrees: f32, actions: &mut Vec<Action>) {
    ui.label(tr("at"));
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
}

fn quantity_box(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let scene = shared.session.scene();
    let layers = &scene.layers;
    let is_layered = scene.is_layered();
    let tissue = |k: usize| layers.get(k).map_or(tr("layer"), |layer| texts::tissue(&layer.tissue));
    let name = |quantity: Quantity| match quantity {
        Quantity::Tissue => tr("Natural colours").to_owned(),
        Quantity::Strain => tr("Skin stretch").to_owned(),
        Quantity::AreaStretch => tr("Skin area").to_owned(),
        Quantity::Stress(k) => tr!("Stress, {tissue}", tissue = tissue(k)),
        Quantity::Pressure => tr("Pressure").to_owned(),
        Quantity::LayerStrain(k) => tr!("Stretch, {tissue}", tissue = tissue(k)),
        Quantity::Thickness(k) => tr!("Thickness, {tissue}", tissue = tissue(k)),
        Quantity::Cover => shared.choices.device.words(tr("Cover over the implant")),
        Quantity::Traction => tr("Pull at the pocket's edge").to_owned(),
        Quantity::Wrinkles => tr("Wrinkles of the skin").to_owned(),
    };
    let mut choices = vec![Quantity::Tissue, Quantity::Strain];
    if is_layered {
        choices.extend((1..layers.len()).map(Quantity::LayerStrain));
        choices.push(Quantity::Cover);
        choices.extend((0..layers.len()).map(Quantity::Thickness));
        choices.push(Quantity::Traction);
    }
    if Quantity::Wrinkles.is_of(scene) {
        choices.push(Quantity::Wrinkles);
    }
    choices.extend([Quantity::AreaStretch, Quantity::Pressure]);
    choices.extend((0..layers.len()).map(Quantity::Stress));
    // A layer or the tissue model may be gone.
    let mut present = shared.options.quantity;
    if !choices.contains(&present) {
        present = Quantity::Strain;
        actions.push(Action::ColourBy(present));
    }
    let response = egui::ComboBox::from_id_salt("quantity")
        .width(124.0)
        // All quantities at once, without a scroll bar.
        .height(480.0)
        .truncate()
        .selected_text(name(present))
        .show_ui(ui, |ui| {
            let is_shown = |quantity: &Quantity| {
                shared.research || *quantity == present || OFTEN.contains(quantity)
            };
            for quantity in choices.into_iter().filter(is_shown) {
                if choice(ui, present == quantity, name(quantity)).clicked() {
                    actions.push(Action::ColourBy(quantity));
                }
            }
        })
        .response;
    set_accessible_name(&response, egui::Role::ComboBox, tr("Colour by"));
    response.on_hover_text(tr("Quantity shown by the colours (keys 1–5)"));
}
