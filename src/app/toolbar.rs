//! The toolbar: files, history, coloured quantity, section, theme; and the window "About".

use super::widgets::{Kind, NumberField, button_if, choice, set_accessible_name};
use super::{App, theme};
use crate::session::Command;
use crate::view::color::Quantity;
use eframe::egui::{self, RichText, Ui};

/// Quantities of the keys 1 to 5.
pub(super) const QUANTITIES: [Quantity; 5] = [
    Quantity::Tissue,
    Quantity::Strain,
    Quantity::AreaStretch,
    Quantity::Stress(0),
    Quantity::Pressure,
];

/// Arrangement of the screen, by its width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    Wide,
    Narrow,
}

impl App {
    pub(super) fn toolbar(&mut self, ui: &mut Ui, layout: Layout) {
        ui.add_space(theme::SPACE_SMALL);
        ui.horizontal_wrapped(|ui| {
            if layout == Layout::Wide {
                ui.label(RichText::new("implant-preview").strong());
                ui.separator();
            }
            self.file_menu(ui);
            for (name, enabled, command) in [
                ("Undo", self.session.can_undo(), Command::Undo),
                ("Redo", self.session.can_redo(), Command::Redo),
            ] {
                if button_if(ui, enabled, name, name, "") {
                    self.execute(command);
                }
            }
            ui.separator();
            self.quantity_box(ui);
            ui.toggle_value(&mut self.options.section, "Section")
                .on_hover_text("Cut the tissue open to show the layers");
            if self.options.section && layout == Layout::Wide {
                ui.toggle_value(&mut self.options.half, "Half")
                    .on_hover_text("Remove half of the tissue instead of a quarter");
                let mut angle = f64::from(self.options.section_azimuth_deg);
                let field = NumberField {
                    name: "Direction of the cut",
                    kind: Kind::Angle,
                    allowed: -180.0..=180.0,
                    decimals: 0,
                    step: 5.0,
                    width: 40.0,
                    ..NumberField::default()
                };
                let typed = field.show(ui, &mut angle);
                if typed.is_changed {
                    self.options.section_azimuth_deg = angle as f32;
                }
                typed
                    .response
                    .on_hover_text("Direction of the cut in degrees; the arrow keys change it");
                ui.label("°");
            }
            ui.toggle_value(&mut self.options.net, "Net")
                .on_hover_text("Show the springs of the sheet");
            if ui.button("Fit").on_hover_text("Show everything (F)").clicked() {
                self.viewport.fit(&self.session);
            }
            ui.separator();
            theme_menu(ui);
            if ui.button("About").clicked() {
                self.show_about = !self.show_about;
            }
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        ui.menu_button("File", |ui| {
            let ctx = ui.ctx().clone();
            if ui.button("Open scene…").clicked() {
                self.files.open(&ctx);
                ui.close();
            }
            if ui.button("Save scene…").clicked() {
                self.save_scene(&ctx);
                ui.close();
            }
            // The result of another scene is never saved.
            let has_result = self.session.result().is_some();
            let save = ui.add_enabled(has_result, egui::Button::new("Save result…"));
            if save.on_disabled_hover_text("No result yet: the scene is being computed").clicked() {
                self.save_result(&ctx);
                ui.close();
            }
            if ui
                .button("Default scene")
                .on_hover_text("Open the default scene; Undo restores the present one")
                .clicked()
            {
                let scene = Box::default();
                self.gesture += 1;
                self.execute(Command::Edit { scene, gesture: self.gesture });
                ui.close();
            }
        });
    }

    fn quantity_box(&mut self, ui: &mut Ui) {
        let layers = &self.session.scene().layers;
        let is_layered = self.session.scene().is_layered();
        let tissue = |k: usize| layers.get(k).map_or("layer", |layer| &layer.tissue);
        let name = |quantity: Quantity| match quantity {
            Quantity::Tissue => "Natural colours".to_owned(),
            Quantity::Strain if is_layered => "Strain, skin".to_owned(),
            Quantity::Strain => "Strain".to_owned(),
            Quantity::AreaStretch => "Area stretch".to_owned(),
            Quantity::Stress(k) => format!("Stress, {}", tissue(k)),
            Quantity::Pressure => "Contact pressure".to_owned(),
            Quantity::LayerStrain(k) => format!("Strain, {}", tissue(k)),
            Quantity::Thickness(k) => format!("Thickness, {}", tissue(k)),
            Quantity::Cover => "Cover over the implant".to_owned(),
            Quantity::Traction => "Pull at the pocket's edge".to_owned(),
        };
        let mut choices = vec![Quantity::Tissue, Quantity::Strain];
        if is_layered {
            choices.extend((1..layers.len()).map(Quantity::LayerStrain));
            choices.push(Quantity::Cover);
            choices.extend((0..layers.len()).map(Quantity::Thickness));
            choices.push(Quantity::Traction);
        }
        choices.extend([Quantity::AreaStretch, Quantity::Pressure]);
        choices.extend((0..layers.len()).map(Quantity::Stress));
        // A layer or the tissue model may be gone.
        if !choices.contains(&self.options.quantity) {
            self.options.quantity = Quantity::Strain;
        }
        let response = egui::ComboBox::from_id_salt("quantity")
            .width(130.0)
            .selected_text(name(self.options.quantity))
            .show_ui(ui, |ui| {
                for quantity in choices {
                    let present = &mut self.options.quantity;
                    if choice(ui, *present == quantity, name(quantity)).clicked() {
                        *present = quantity;
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, "Colour by");
        response.on_hover_text("Quantity shown by the colours (keys 1–5)");
    }

    pub(super) fn about_window(&mut self, ctx: &egui::Context) {
        if self.show_about && ctx.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.show_about = false;
        }
        egui::Window::new("About")
            .open(&mut self.show_about)
            .collapsible(false)
            .resizable(false)
            .default_width(420.0)
            .show(ctx, |ui| {
                ui.label(RichText::new("A preview, not a medical device.").strong());
                ui.label(
                    "The program computes how layers of skin and adipose tissue stretch over a smooth \
                     dome, from measured stress–strain curves and Poisson ratios, in equilibrium and \
                     without friction. It does not model a patient's anatomy, healing or blood supply. \
                     Do not base a decision on it alone.",
                );
                ui.label("All computation runs on this machine; no data leaves it.");
                ui.label(
                    "Based on S. N. Nikolaev, Non-linear mass-spring system for large soft tissue \
                     deformations modeling, Sci. Tech. J. ITMO 5(87), 2013, 88–94.",
                );
                ui.label(
                    "Mouse: drag to rotate, Shift or the right button to move, wheel to zoom. Touch: one \
                     finger to rotate, two fingers to move and zoom.",
                );
                ui.separator();
                ui.label(
                    "Keys: Ctrl+Z undo · Ctrl+Shift+Z redo · Ctrl+O open · Ctrl+S save · Tab next control · \
                     Esc close. On a slider: arrows, Page Up, Page Down, Home, End. In the picture, after \
                     a click on it: [ ] or up and down arrows, insertion · Space play · F fit · 1–5 \
                     colours · Shift and arrows rotate · + − zoom.",
                );
                ui.small(format!("Version {}", env!("CARGO_PKG_VERSION")));
            });
    }
}

fn theme_menu(ui: &mut Ui) {
    ui.menu_button("Theme", |ui| {
        let mut preference = ui.ctx().options(|options| options.theme_preference);
        for (choice, name) in [
            (egui::ThemePreference::System, "System"),
            (egui::ThemePreference::Light, "Light"),
            (egui::ThemePreference::Dark, "Dark"),
        ] {
            if ui.radio_value(&mut preference, choice, name).clicked() {
                ui.ctx().set_theme(choice);
                ui.close();
            }
        }
    });
}
