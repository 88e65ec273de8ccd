//! The left side: what the surgeon chooses. Each function edits a copy of the scene; the app turns
//! what changed into a command.

use super::curve_editor;
use super::notice::{Notice, Offer};
use super::stability;
use super::theme::{SPACE, SPACE_SMALL};
use super::widgets::{Control, Kind, button_if, choice, group, set_accessible_name};
use crate::scene::{Implant, Layer, Scene, Springs, limits};
use crate::session::Session;
use eframe::egui::{self, RichText, Ui};

/// The rail of the implant's position goes so far to both sides \[mm\].
const SHIFT_MM: f64 = 60.0;

/// Implant and pocket. Gives what the user must know of a value that does not fit.
pub(super) fn implant(ui: &mut Ui, scene: &mut Scene, is_hemisphere: &mut bool) -> Option<Notice> {
    let usual = Scene::default();
    let mut notice = None;
    group(ui, "Implant", |ui| {
        let Implant { base_radius_mm: radius, projection_mm: projection, .. } = &mut scene.implant;
        let (least, most) = limits::BASE_RADIUS_MM;
        Control {
            label: "Base radius",
            unit: "mm",
            kind: Kind::Length,
            range: least..=most,
            reset: usual.implant.base_radius_mm,
            tooltip: "Half of the implant's width. Round implants are 78–180 mm across.",
            ..Control::default()
        }
        .show(ui, radius);
        ui.checkbox(is_hemisphere, "Hemisphere (projection = base radius)").on_hover_text(
            "The highest dome over a base: the paper's bound, under which the covered area doubles.",
        );
        let (least, most) = limits::PROJECTION_MM;
        ui.add_enabled_ui(!*is_hemisphere, |ui| {
            Control {
                label: "Projection",
                unit: "mm",
                kind: Kind::Length,
                range: least..=most,
                reset: *radius,
                tooltip: "Height of the implant above its base. Round implants: 20–75 mm, \
                          0.39–1.07 of the base radius.",
                ..Control::default()
            }
            .show(ui, projection);
        });
        for (label, axis, side) in [
            ("Position across", 0, "patient's left or right"),
            ("Position along", 1, "head or feet"),
        ] {
            notice = position(ui, scene, axis, label, side).or(notice.take());
        }
    });
    let [x, y] = scene.implant.center_mm;
    let least = (scene.implant.base_radius_mm + x.hypot(y)).min(limits::POCKET_RADIUS_MAX_MM);
    group(ui, "Pocket", |ui| {
        Control {
            label: "Pocket radius",
            unit: "mm",
            kind: Kind::Length,
            range: limits::BASE_RADIUS_MM.0..=limits::POCKET_RADIUS_MAX_MM,
            allowed: Some(least..=limits::POCKET_RADIUS_MAX_MM),
            limit_reason: &format!(
                "the implant where it lies needs {:.1} mm; at most {:.0} mm",
                least,
                limits::POCKET_RADIUS_MAX_MM
            ),
            reset: (least + 15.0).min(limits::POCKET_RADIUS_MAX_MM),
            tooltip: "The dissected disc under the tissue. Outside of it the tissue stays on the \
                      chest wall. At least as wide as the implant where it lies.",
            ..Control::default()
        }
        .show(ui, &mut scene.pocket_radius_mm);
    });
    notice
}

/// Position of the implant along one axis. The pocket stays as it is: a larger one would lessen the
/// strain. What does not fit is said, with a larger pocket as an offer.
fn position(
    ui: &mut Ui,
    scene: &mut Scene,
    axis: usize,
    label: &str,
    side: &str,
) -> Option<Notice> {
    let (room, other) = (scene.room_mm(), scene.implant.center_mm[1 - axis]);
    let most = (room * room - other * other).max(0.0).sqrt();
    let words = format!("{} mm is the most in this pocket", floor_to_tenth(most));
    let change = Control {
        label,
        unit: "mm",
        kind: Kind::Length,
        range: -SHIFT_MM..=SHIFT_MM,
        // A file may have it at the rim, rounding included, or farther out than the rail goes.
        allowed: Some({
            let most = most.max(scene.implant.center_mm[axis].abs());
            -most..=most
        }),
        limit_reason: &words,
        tooltip: &format!("Offset of the implant in its pocket towards the {side}."),
        ..Control::default()
    }
    .show(ui, &mut scene.implant.center_mm[axis]);
    let out_of_range = change.out_of_range?;
    let reach = scene.implant.base_radius_mm + out_of_range.hypot(other);
    // Half millimetres, and a pocket that holds the requested position.
    let pocket_radius_mm = (2.0 * reach).ceil() / 2.0;
    let offer = (pocket_radius_mm <= limits::POCKET_RADIUS_MAX_MM).then(|| {
        let mut scene = scene.clone();
        scene.pocket_radius_mm = pocket_radius_mm;
        scene.implant.center_mm[axis] = out_of_range;
        let label = format!("Enlarge the pocket to a radius of {pocket_radius_mm} mm");
        Offer { label, scene: Box::new(scene) }
    });
    Some(Notice { offer, ..Notice::caution(format!("{label}: {words}.")) })
}

/// A tenth of a millimetre is the finest that is said, rounded so that it still fits.
fn floor_to_tenth(mm: f64) -> f64 {
    (10.0 * mm + 1e-6).floor() / 10.0
}

/// The layers, from the skin inwards.
pub(super) fn layers(ui: &mut Ui, scene: &mut Scene) {
    let mut action = None;
    let count = scene.layers.len();
    for (k, layer) in scene.layers.iter_mut().enumerate() {
        let title = format!("Layer {}: {}", k + 1, layer.tissue);
        let header = egui::CollapsingHeader::new(RichText::new(title).strong())
            .id_salt(("layer", k))
            .default_open(k < 2);
        header.show_unindented(ui, |ui| {
            ui.push_id(k, |ui| one_layer(ui, layer));
            ui.horizontal(|ui| {
                let named = |text: &str| format!("{text} layer {}", k + 1);
                for (text, name, tooltip, is_able, what) in [
                    ("Up", "Move up", "Move this layer towards the skin", k > 0, Action::Up(k)),
                    (
                        "Down",
                        "Move down",
                        "Move this layer inwards",
                        k + 1 < count,
                        Action::Up(k + 1),
                    ),
                    ("Remove", "Remove", "Remove this layer", count > 1, Action::Remove(k)),
                ] {
                    if button_if(ui, is_able, text, &named(name), tooltip) {
                        action = Some(what);
                    }
                }
            });
            ui.add_space(SPACE);
        });
    }
    ui.horizontal_wrapped(|ui| {
        let room = count < limits::LAYERS.1;
        for (name, make) in
            [("Add skin", Layer::skin as fn() -> Layer), ("Add adipose", Layer::adipose)]
        {
            if button_if(ui, room, name, name, "Added innermost; up to 8 layers") {
                action = Some(Action::Add(make()));
            }
        }
    });
    match action {
        Some(Action::Up(k)) => scene.layers.swap(k - 1, k),
        Some(Action::Remove(k)) => {
            scene.layers.remove(k);
        }
        Some(Action::Add(layer)) => scene.layers.push(layer),
        None => {}
    }
}

enum Action {
    /// Exchange with the layer above.
    Up(usize),
    Remove(usize),
    Add(Layer),
}

fn one_layer(ui: &mut Ui, layer: &mut Layer) {
    let usual = if layer.tissue == "adipose" { Layer::adipose() } else { Layer::skin() };
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("Tissue").color(ui.visuals().weak_text_color()));
        let field = egui::TextEdit::singleline(&mut layer.tissue)
            .char_limit(40)
            .desired_width(ui.available_width() - SPACE);
        let response = ui.add(field).labelled_by(label.id);
        response.widget_info(|| egui::WidgetInfo {
            label: Some("Tissue".to_owned()),
            ..egui::WidgetInfo::text_edit(true, "", &layer.tissue, "")
        });
        response.on_hover_text("Free text; skin and adipose have their own colours");
    });
    let (least, most) = limits::THICKNESS_MM;
    Control {
        label: "Thickness",
        unit: "mm",
        kind: Kind::Length,
        range: least..=most,
        reset: usual.thickness_mm,
        step: 0.1,
        logarithmic: true,
        tooltip: "Thickness at rest. Breast skin is about 1–3 mm, the adipose layer 5–40 mm.",
        ..Control::default()
    }
    .show(ui, &mut layer.thickness_mm);
    let (least, most) = limits::POISSON_RATIO;
    Control {
        label: "Poisson ratio",
        range: least..=most,
        reset: usual.poisson_ratio,
        decimals: 2,
        step: 0.01,
        tooltip: "How much the tissue narrows when stretched. Soft tissues: 0.35–0.50; 0.50 keeps \
                  its volume.",
        ..Control::default()
    }
    .show(ui, &mut layer.poisson_ratio);
    curve_editor::show(ui, &mut layer.curve);
}

/// Spring law and resolution.
pub(super) fn method(ui: &mut Ui, scene: &mut Scene, session: &Session) {
    group(ui, "Method", |ui| {
        let label = ui.label(RichText::new("Springs").color(ui.visuals().weak_text_color()));
        let name = |springs: Springs| match springs {
            Springs::Coupled => "Coupled (exact, isotropic)",
            Springs::Nikolaev => "Nikolaev 2013, as published",
        };
        let response = egui::ComboBox::from_id_salt("springs")
            .width(ui.available_width() - SPACE)
            .selected_text(name(scene.springs))
            .show_ui(ui, |ui| {
                for springs in [Springs::Coupled, Springs::Nikolaev] {
                    if choice(ui, scene.springs == springs, name(springs)).clicked() {
                        scene.springs = springs;
                    }
                }
            })
            .response
            .labelled_by(label.id);
        set_accessible_name(&response, egui::Role::ComboBox, "Springs");
        response.on_hover_text(
            "Coupled springs meet the measured curve and Poisson ratio exactly, in every \
                 direction. The paper's springs are for comparison: with large strains and Poisson \
                 ratios they have no stable shape.",
        );
        if let Some(limits) = session.stability_limits() {
            stability::show(ui, scene, limits, session.greatest_strain());
        }
        ui.add_space(SPACE_SMALL);
        let label = ui.label(RichText::new("Resolution").color(ui.visuals().weak_text_color()));
        let nodes = &mut scene.solver.nodes_per_side;
        let response = egui::ComboBox::from_id_salt("resolution")
            .width(ui.available_width() - SPACE)
            .selected_text(format!("{nodes} nodes a side"))
            .show_ui(ui, |ui| {
                for count in [33, 65, 129, 193, 257] {
                    if choice(ui, *nodes == count, format!("{count} nodes a side")).clicked() {
                        *nodes = count;
                    }
                }
            })
            .response
            .labelled_by(label.id);
        set_accessible_name(&response, egui::Role::ComboBox, "Resolution");
        response
            .on_hover_text("Finer grids are slower; 129 is within 0.02 % of the exact membrane");
        let mut percent = scene.solver.tolerance * 100.0;
        let (least, most) = limits::TOLERANCE;
        let change = Control {
            label: "Tolerance",
            unit: "% of the base radius",
            kind: Kind::Percent,
            range: 100.0 * least.max(1e-6)..=100.0 * most,
            allowed: Some(100.0 * least..=100.0 * most),
            reset: 0.01,
            decimals: 2,
            step: 0.0,
            logarithmic: true,
            tooltip: "The greatest position error of a node that the solver may leave.",
            ..Control::default()
        }
        .show(ui, &mut percent);
        if change.is_changed {
            scene.solver.tolerance = (percent / 100.0).clamp(least, most);
        }
    });
}
