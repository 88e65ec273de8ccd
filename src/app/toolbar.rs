//! The toolbar: files, history, examples, theme; the window "Help"; the words "Not a medical device".

use super::messages::Notice;
use super::report::Purpose;
use super::widgets::button_if;
use super::{App, plan, theme};
use crate::export::{self, Format, Solid};
use crate::measure::surfaces;
use crate::scene::Scene;
use crate::session::Command;
use crate::solve::Solution;
use eframe::egui::{self, RichText, Role, Ui, WidgetInfo};

/// Arrangement of the screen, by its width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    Wide,
    Narrow,
}

impl App {
    pub(super) fn toolbar(&mut self, ui: &mut Ui, layout: Layout) {
        ui.add_space(theme::SPACE_SMALL);
        ui.horizontal(|ui| {
            if layout == Layout::Wide {
                ui.label(RichText::new("Implant preview").strong());
                ui.separator();
            } else {
                // Six buttons in 320 points.
                let spacing = ui.spacing_mut();
                spacing.item_spacing.x = theme::SPACE_SMALL;
                spacing.button_padding.x = theme::SPACE_SMALL + 2.0;
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
            let tooltip = "Open the opening plan; Undo restores the present one";
            if ui.button("Start over").on_hover_text(tooltip).clicked() {
                self.open_example(Scene::opening());
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Help").clicked() {
                    self.show_help = !self.show_help;
                }
                theme_menu(ui);
                if layout == Layout::Wide {
                    disclaimer(ui, layout);
                }
            });
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        ui.menu_button("File", |ui| {
            let ctx = ui.ctx().clone();
            if ui.button("Open plan…").clicked() {
                self.files.open(&ctx);
                ui.close();
            }
            if ui.button("Save plan…").clicked() {
                self.save_scene(&ctx);
                ui.close();
            }
            // The result of another scene is never saved.
            let has_result = self.session.result().is_some();
            let save = ui.add_enabled(has_result, egui::Button::new("Save numbers (JSON)…"));
            if save.on_disabled_hover_text(NO_RESULT).clicked() {
                self.save_result(&ctx);
                ui.close();
            }
            let save = ui.add_enabled(has_result, egui::Button::new("Save numbers (CSV)…"));
            let save = save.on_disabled_hover_text(NO_RESULT).on_hover_text(
                "All results of plan and pins, with percentiles where bands are on, for a spreadsheet",
            );
            if save.clicked() {
                self.save_numbers(&ctx);
                ui.close();
            }
            for (name, tooltip, purpose) in [
                ("Save picture (PNG)…", PICTURE, Purpose::File),
                ("Copy picture", PICTURE, Purpose::Clipboard),
                (
                    "Save report (HTML)…",
                    "One or two pages with pictures, plan, numbers, pins and limits; prints on paper",
                    Purpose::Report,
                ),
            ] {
                let save = ui.add_enabled(has_result, egui::Button::new(name));
                let save = save.on_disabled_hover_text(NO_RESULT).on_hover_text(tooltip);
                if save.clicked() {
                    self.take_home(&ctx, purpose);
                    ui.close();
                }
            }
            if let Some(address) = self.page_address.clone()
                && ui.button("Copy link").on_hover_text(LINK).clicked()
            {
                self.copy_link(&ctx, &address);
                ui.close();
            }
            let has_shape = has_result && !self.session.has_no_shape();
            ui.add_enabled_ui(has_shape, |ui| self.shape_menu(ui, &ctx));
            if ui.add_enabled(has_shape, egui::Button::new("Save profile (CSV)…")).clicked()
                && let Some(outcome) = self.session.result()
            {
                self.files.save(&ctx, "profile.csv", export::profile(outcome));
                ui.close();
            }
            ui.separator();
            ui.label(RichText::new("Examples").small().weak());
            for (name, tooltip, scene) in [
                (
                    "Usual implant",
                    "12 cm, 300 ml, pinch 2 cm, normal skin",
                    Scene::opening as fn() -> Scene,
                ),
                (
                    "Half sphere of 11 cm",
                    "The scene of the defaults of a file: much projection, lax skin, cover 11.5 mm",
                    Scene::default,
                ),
            ] {
                let button = ui.button(name);
                if button
                    .on_hover_text(format!("{tooltip}. Undo restores the present plan"))
                    .clicked()
                {
                    self.open_example(scene());
                    ui.close();
                }
            }
        });
    }

    /// Meshes of the shape in place, for other programs and printers.
    fn shape_menu(&mut self, ui: &mut Ui, ctx: &egui::Context) {
        ui.menu_button("Save shape (3-D)", |ui| {
            ui.small("Closed meshes in mm; GLB in m");
            egui::Grid::new("shapes").show(ui, |ui| {
                for (name, solid) in SOLIDS {
                    let name = self.plan.device.words(name);
                    ui.label(&name);
                    for format in Format::ALL {
                        let extension = format.extension();
                        let button = ui.button(extension.to_uppercase());
                        let label = format!("{name} as {}", extension.to_uppercase());
                        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
                        if button.clicked() {
                            let file = format!("{}.{extension}", name.to_lowercase());
                            let solid = solid(self.session.solution());
                            if solid.vertices.is_empty() {
                                self.notice =
                                    Some(Notice::error(self.plan.device.words(NOT_INSERTED)));
                            } else {
                                self.files.save(ctx, &file, format.encode(&solid));
                            }
                            ui.close();
                        }
                    }
                    ui.end_row();
                }
            });
        });
    }

    fn open_example(&mut self, scene: Scene) {
        self.gesture += 1;
        self.execute(Command::Edit { scene: Box::new(scene), gesture: self.gesture });
        self.plan = plan::Choices::default();
    }

    pub(super) fn help_window(&mut self, ctx: &egui::Context) {
        if self.show_help && ctx.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.show_help = false;
        }
        egui::Window::new("Help")
            .open(&mut self.show_help)
            .collapsible(false)
            .resizable(false)
            .default_width(440.0)
            .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .show(ctx, |ui| {
                ui.label(RichText::new("A preview, not a medical device.").strong());
                ui.label(
                    "The program computes how skin and fat stretch over an implant, from stress–strain curves, \
                     in equilibrium and without friction. It does not model a patient's anatomy, healing or \
                     blood supply. Do not base a decision on it alone.",
                );
                ui.label(
                    "How wrong it is: a pinch gives the cover within a factor 1.3, a skin class the stretch \
                     within a factor 2 (1 standard deviation); the computation itself is within 0.5 %.",
                );
                ui.label("All computation runs on this machine; no data leaves it.");
                ui.separator();
                egui::Grid::new("keys").num_columns(2).spacing([2.0 * theme::SPACE, 2.0]).show(ui, |ui| {
                    for (keys, effect) in KEYS {
                        ui.label(RichText::new(keys).strong());
                        ui.label(effect);
                        ui.end_row();
                    }
                });
                ui.separator();
                ui.small(
                    "Based on S. N. Nikolaev, Non-linear mass-spring system for large soft tissue \
                     deformations modeling, Sci. Tech. J. ITMO 5(87), 2013, 88–94.",
                );
                ui.small(format!("Version {}", env!("CARGO_PKG_VERSION")));
            });
    }
}

/// A mesh of a solution.
type MeshOf = fn(&Solution) -> Solid;

/// The meshes to save, by their names.
const SOLIDS: [(&str, MeshOf); 3] = [
    ("Tissue", |solution| Solid::tissue(&surfaces(solution))),
    ("Skin", |solution| Solid::skin(&surfaces(solution))),
    ("Implant", |solution| Solid::implant(&solution.problem().obstacle.dome)),
];

/// What is saved or copied.
const PICTURE: &str = "Picture with title, plan, answers, legend, scale and date";
const LINK: &str =
    "The whole plan as an address, without the entries for the file; no server gets it";

const NOT_INSERTED: &str = "The implant is not inserted: it has no shape above the chest wall.";

/// Why a result is not saved.
const NO_RESULT: &str = "No result yet: the plan is being computed";

/// Keys and their effects, for the help.
const KEYS: [(&str, &str); 10] = [
    ("Tab, Shift+Tab", "next, previous control"),
    ("Ctrl+Z, Ctrl+Shift+Z", "undo, redo"),
    ("Ctrl+O, Ctrl+S", "open, save the plan"),
    ("Arrows, Page Up/Down", "on a slider or number: 1 step, 10 steps"),
    ("Esc", "close, cancel a long solve"),
    ("Drag, wheel", "on the picture: turn, zoom; Shift or right button: move"),
    ("[ ]", "on the picture: implant in place −2 %, +2 %"),
    ("Space", "on the picture: show the insertion"),
    ("1 … 5", "on the picture: colours"),
    ("F", "on the picture: show everything"),
];

/// The words that are always in sight.
pub(super) fn disclaimer(ui: &mut Ui, layout: Layout) {
    let words = match layout {
        Layout::Wide => "Not a medical device: a physical model, no patient's anatomy or healing.",
        Layout::Narrow => "Not a medical device",
    };
    let words = RichText::new(words).small().color(ui.visuals().weak_text_color());
    ui.add(egui::Label::new(words).wrap_mode(egui::TextWrapMode::Truncate)).on_hover_text(
        "A physical model of skin and fat over an implant: no patient's anatomy, no healing, no blood supply.",
    );
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
