//! The toolbar: files, history, examples, the report; the window "Help"; the words "Not a medical device".

use super::action::{Action, Purpose, Task};
use super::commands::{COMMANDS, Keyed, entry_of, item, menu_item, why_not};
use super::files;
use super::messages::Notice;
use super::shared::Shared;
use crate::app::answer::measured;
use crate::app::picture::view_menu::view_menu;
use crate::app::texts::tr;
use crate::app::widgets::theme;
use crate::app::widgets::{button_if, fit_fingers, menu};
use crate::body::write::write;
use crate::contact::Dome;
use crate::export::{Body, Format, Solid};
use crate::measure::{Field, surfaces};
use crate::mesh::Chest;
use crate::solve::Solution;
use crate::view::color::linear_of_strain;
use eframe::egui::os::OperatingSystem;
use eframe::egui::{self, Color32, FontId, RichText, Role, TextStyle, Ui, WidgetInfo};
use glam::DVec2;

/// Arrangement of the screen, by its width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    Wide,
    Narrow,
}

/// The row of buttons over the whole window.
pub(crate) fn show(ui: &mut Ui, layout: Layout, shared: &Shared, actions: &mut Vec<Action>) {
    // Rows for fingers need no space around them.
    let space = if layout == Layout::Wide { theme::SPACE_SMALL } else { 0.0 };
    ui.add_space(space);
    ui.horizontal(|ui| {
        if layout == Layout::Wide {
            ui.label(RichText::new(tr("Implant preview")).strong());
            ui.separator();
        } else {
            fit_fingers(ui);
            fit_in_row(ui);
        }
        let button = &mut ui.visuals_mut().widgets.inactive;
        (button.weak_bg_fill, button.bg_stroke) = (Color32::TRANSPARENT, egui::Stroke::NONE);
        file_menu(ui, shared, actions);
        if layout == Layout::Wide {
            view_menu(ui, false, shared, actions);
        }
        for (name, enabled, task) in [
            (tr("Undo"), shared.session.can_undo(), Task::Undo),
            (tr("Redo"), shared.session.can_redo(), Task::Redo),
        ] {
            if button_if(ui, enabled, name, name, "") {
                actions.push(Action::Run(task));
            }
        }
        item(ui, shared, Task::StartOver, actions);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            report_button(ui, shared, actions);
            if ui.button(tr("Help")).clicked() {
                actions.push(Action::Run(Task::Help));
            }
            if layout == Layout::Wide {
                disclaimer(ui, layout);
            }
        });
    });
    ui.add_space(space);
}

fn file_menu(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    menu(ui, tr("File"), |ui| {
        for task in [
            Task::OpenPlan,
            Task::OpenTable,
            Task::SavePlan,
            Task::SaveNumbers,
            Task::SaveTable,
            Task::TakeHome(Purpose::File),
            Task::TakeHome(Purpose::Clipboard),
            Task::TakeHome(Purpose::Report),
        ] {
            menu_item(ui, shared, task, actions);
            if task == Task::SavePlan && shared.has_surface() {
                menu_item(ui, shared, Task::KeepSurface, actions);
            }
        }
        if shared.page_address.is_some() {
            menu_item(ui, shared, Task::CopyLink, actions);
        }
        ui.add_enabled_ui(shared.has_shape(), |ui| shape_menu(ui, shared, actions));
        menu_item(ui, shared, Task::SaveProfile, actions);
        ui.separator();
        ui.label(RichText::new(tr("Examples")).small().weak());
        menu_item(ui, shared, Task::UsualImplant, actions);
        menu_item(ui, shared, Task::HalfSphere, actions);
    });
}

/// The report, the one button of its kind.
fn report_button(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let task = Task::TakeHome(Purpose::Report);
    let (entry, why_not) = (entry_of(task), why_not(shared, task));
    let visuals = ui.visuals();
    let palette = theme::palette(visuals);
    let text = RichText::new(tr("Report")).color(palette.on_accent);
    let button = egui::Button::new(text).fill(palette.accent);
    let response = ui.add_enabled(why_not.is_none(), button);
    let response = response.on_disabled_hover_text(why_not.unwrap_or_default());
    if response.clicked() {
        actions.push(Action::Run(task));
    }
    response.on_hover_text(tr(entry.tooltip));
}

/// Meshes of the shape in place, for other programs and printers.
fn shape_menu(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let device = shared.choices.device;
    ui.menu_button(tr("Save shape (3-D)"), |ui| {
        ui.small(tr("Closed surfaces in mm; GLB in m"));
        egui::Grid::new("shapes").show(ui, |ui| {
            for (name, about, file, formats, bodies) in SHAPES {
                let name = device.words(tr(name));
                ui.label(&name);
                let is_shown = |format: &&Format| {
                    shared.research || matches!(format, Format::Stl | Format::Glb)
                };
                for format in formats.iter().filter(is_shown) {
                    let extension = format.extension();
                    if format_button(ui, *format, &name, &device.words(tr(about))) {
                        let session = &shared.session;
                        let mut bodies = bodies(session.solution());
                        if *format == Format::Glb {
                            bodies = with_stretch(bodies, shared);
                        }
                        if session.scene().is_right() {
                            bodies = bodies.into_iter().map(Solid::mirrored).collect();
                        }
                        actions.push(if bodies.iter().any(|solid| solid.vertices.is_empty()) {
                            Action::Notify(Notice::error(device.words(tr(NOT_INSERTED))))
                        } else {
                            let scene = session.scene();
                            let file = files::name_with_size(scene, device, file, extension);
                            Action::Save(file, format.encode(&bodies))
                        });
                        ui.close();
                    }
                }
                ui.end_row();
            }
            if shared.has_surface() {
                body_rows(ui, shared, actions);
            }
        });
    });
}

/// The button of a shape in a format; returns whether it was clicked.
fn format_button(ui: &mut Ui, format: Format, name: &str, about: &str) -> bool {
    let extension = format.extension().to_uppercase();
    let button = ui.button(&extension);
    let label = tr!("{name} as {extension}", name, extension);
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    button.on_hover_text(about).clicked()
}

/// Her body before and after, in rows of the grid of shapes.
fn body_rows(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let (scene, device) = (shared.session.scene(), shared.choices.device);
    for (k, (name, about)) in BODIES.into_iter().enumerate() {
        ui.label(tr(name));
        for format in Format::ALL {
            if !format_button(ui, format, tr(name), tr(about)) {
                continue;
            }
            ui.close();
            let Some((bodies, unit)) = measured::surfaces(&shared.session) else { continue };
            let extension = format.extension();
            let file = match k {
                0 => files::name_with_patient(scene, "body-before", extension),
                _ => files::name_with_size(scene, device, "body-after", extension),
            };
            actions.push(Action::Save(file, write(&bodies[k], unit, format)));
        }
        ui.end_row();
    }
}

/// The window "Help".
pub(crate) fn help(ctx: &egui::Context, is_open: &mut bool) {
    if *is_open && ctx.input(|input| input.key_pressed(egui::Key::Escape)) {
        *is_open = false;
    }
    egui::Window::new(tr("Help"))
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .default_width(440.0)
        .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ctx, |ui| {
            ui.label(RichText::new(tr("A preview, not a medical device.")).strong());
            ui.label(
                tr("The program computes how skin and fat stretch over an implant, from stress–strain curves, \
                 in equilibrium and without friction. It does not model a patient's anatomy, healing or \
                 blood supply. Do not base a decision on it alone."),
            );
            ui.label(
                tr("How wrong it is: a pinch gives the cover within a factor 1.3, a skin class the stretch \
                 within a factor 2 (1 standard deviation); the computation itself is within 0.5 %."),
            );
            ui.label(tr("All computation runs on this machine; no data leaves it."));
            ui.separator();
            egui::Grid::new("keys").num_columns(2).spacing([2.0 * theme::SPACE, 2.0]).show(ui, |ui| {
                let fixed = KEYS.map(|(keys, effect)| (tr(keys).to_owned(), tr(effect).to_owned()));
                for (keys, effect) in fixed.into_iter().chain(command_keys(ui.ctx().os())) {
                    ui.label(RichText::new(keys).strong());
                    ui.label(effect);
                    ui.end_row();
                }
            });
            ui.separator();
            ui.small(
                tr("Based on S. N. Nikolaev, Non-linear mass-spring system for large soft tissue \
                 deformations modeling, Sci. Tech. J. ITMO 5(87), 2013, 88–94."),
            );
            ui.small(tr!("Version {version}", version = env!("CARGO_PKG_VERSION")));
        });
}

/// Least size of a word in a narrow row, of its usual size \[-\].
const LEAST_SIZE: f32 = 0.5;

/// Space and text of the six buttons of a row of 320 points. Long words are smaller.
fn fit_in_row(ui: &mut Ui) {
    const BUTTONS: [&str; 6] = ["File", "Undo", "Redo", "Start over", "Help", "Report"];
    let space = theme::SPACE_SMALL;
    let font = TextStyle::Button.resolve(ui.style());
    let width = |name: &str| {
        let galley = ui.painter().layout_no_wrap(tr(name).to_owned(), font.clone(), Color32::WHITE);
        galley.size().x
    };
    let text: f32 = BUTTONS.map(width).iter().sum();
    let room = |padding: f32| ui.available_width() - 12.0 * padding - 5.0 * space;
    let is_tight = text > room(space + 2.0);
    // A row without room for words is cut.
    let size = font.size * (room(space) / text).clamp(LEAST_SIZE, 1.0);
    let spacing = ui.spacing_mut();
    spacing.item_spacing.x = space;
    spacing.button_padding.x = if is_tight { space } else { space + 2.0 };
    if is_tight {
        let small = FontId { size, ..font };
        ui.style_mut().override_font_id = Some(small);
    }
}

/// Closed bodies of a solution.
type BodiesOf = fn(&Solution) -> Vec<Solid>;

/// What the shapes of the tissue are.
const IN_PLACE: &str = "As computed, over this chest";
const SKIN_IN_PLACE: &str =
    "As computed, over this chest; in GLB the skin has the colours of its stretch";

/// The shapes to save: name, what the shape is, name in files, formats.
const SHAPES: [(&str, &str, &str, &[Format], BodiesOf); 5] = [
    (
        "Implant as made",
        "With its flat base, as from the maker: for a 3-D printer",
        "implant",
        &Format::ALL,
        |solution| vec![Solid::implant(&as_made(dome(solution)))],
    ),
    (
        "Implant in place",
        "Bent to this chest, as far as it is inserted",
        "implant-in-place",
        &Format::ALL,
        |solution| vec![Solid::implant(dome(solution))],
    ),
    ("Tissue", IN_PLACE, "tissue", &Format::ALL, |solution| {
        vec![Solid::tissue(&surfaces(solution))]
    }),
    ("Skin", SKIN_IN_PLACE, "skin", &Format::ALL, |solution| {
        vec![Solid::skin(&surfaces(solution))]
    }),
    // Bodies that touch are for viewers, not for printers.
    ("All parts", SKIN_IN_PLACE, "shape", &[Format::Glb], |solution| {
        Solid::bodies(&surfaces(solution), dome(solution))
    }),
];

/// Her body before and after: name, what the shape is.
const BODIES: [(&str, &str); 2] = [
    ("Body before", "Her scan as the plan's file keeps it, in its own axes and unit; GLB in m"),
    ("Body after", "Her scan with the computed skin, in its own axes and unit; GLB in m"),
];

/// An implant beside the patient: with a flat base, whole.
fn as_made(dome: &Dome) -> Dome {
    Dome { shape: dome.shape.at_rest(), center: DVec2::ZERO, base_height: 0.0, chest: Chest::Flat }
}

/// Bodies whose skin has the colours of its stretch, those of the picture.
fn with_stretch(bodies: Vec<Solid>, shared: &Shared) -> Vec<Solid> {
    let session = &shared.session;
    let skin = shared.practices.skin(session.scene(), session.problem().skin_knee());
    let strain = session.values(Field::PrincipalStrain);
    let (surfaces, colour) =
        (surfaces(session.solution()), |node: usize| linear_of_strain(strain[node], skin));
    let coloured = |body: Solid| match body.body {
        Body::Skin => body.coloured(&surfaces, colour),
        Body::Tissue | Body::Implant | Body::Torso => body,
    };
    bodies.into_iter().map(coloured).collect()
}

fn dome(solution: &Solution) -> &Dome {
    &solution.problem().obstacle.dome
}

const NOT_INSERTED: &str = "The implant is not inserted: it has no shape above the chest wall.";

/// Keys beside those of commands and their effects, for the help.
const KEYS: [(&str, &str); 7] = [
    ("Tab, Shift+Tab", "next, previous control"),
    ("Arrows, Page Up/Down", "on a slider or number: 1 step, 10 steps"),
    ("Esc", "close, cancel a long solve, a drag, a mark on the picture"),
    ("Drag, wheel", "on the picture: turn, zoom; Shift or right button: move"),
    ("Click", "on the picture: keep the values of a point there; again: remove them"),
    ("[ ]", "on the picture: implant in place −2 %, +2 %"),
    ("1 … 5", "on the picture: colours"),
];

/// Keys and effects of the commands, but for the colours, which have one line together.
fn command_keys(system: OperatingSystem) -> impl Iterator<Item = (String, String)> {
    COMMANDS.iter().filter(|entry| !matches!(entry.task, Task::Colour(_))).filter_map(
        move |entry| {
            let keys = entry.keys(system);
            let place = if matches!(entry.keyed, Keyed::OnPicture(_)) {
                tr("on the picture: ")
            } else {
                ""
            };
            let name = tr(entry.name).trim_end_matches('…').to_lowercase();
            (!keys.is_empty()).then(|| (keys, format!("{place}{name}")))
        },
    )
}

/// The words that are always in sight.
pub(crate) fn disclaimer(ui: &mut Ui, layout: Layout) {
    let words = match layout {
        Layout::Wide => {
            tr("Not a medical device: a physical model, no patient's anatomy or healing.")
        }
        Layout::Narrow => tr("Not a medical device"),
    };
    let words = RichText::new(words).small().color(ui.visuals().weak_text_color());
    ui.add(egui::Label::new(words).wrap_mode(egui::TextWrapMode::Truncate)).on_hover_text(
        tr("A physical model of skin and fat over an implant: no patient's anatomy, no healing, no blood supply."),
    );
}
