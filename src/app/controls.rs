//! The left panel: the inputs. Each function edits a copy of the scene; the app turns the difference
//! into a command.

use super::curve_editor;
use super::messages::{Notice, Offer};
use super::stability;
use super::theme::{SPACE, SPACE_SMALL};
use super::widgets::{Control, Kind, button_if, choice, group, labelled_box};
use crate::scene::{Body, Implant, Layer, Scene, Springs, TissueModel, limits};
use crate::session::Session;
use eframe::egui::{self, RichText, Ui};

/// Range of the position sliders, to both sides \[mm\].
const SHIFT_MM: f64 = 60.0;

/// Shows implant and pocket. Returns a notice about a position that does not fit the pocket.
pub(super) fn implant(ui: &mut Ui, scene: &mut Scene, is_hemisphere: &mut bool) -> Option<Notice> {
    let mut notice = None;
    group(ui, "Implant", |ui| {
        dome(ui, &mut scene.implant, is_hemisphere);
        for (label, axis, side) in [
            ("Position across", 0, "patient's left or right"),
            ("Position along", 1, "head or feet"),
        ] {
            notice = position(ui, scene, axis, label, side).or(notice.take());
        }
    });
    group(ui, "Pocket", |ui| pocket(ui, scene));
    notice
}

/// Base radius and projection of the implant.
fn dome(ui: &mut Ui, implant: &mut Implant, is_hemisphere: &mut bool) {
    let usual = Scene::default().implant.base_radius_mm;
    Control {
        tooltip: "Half the width of the implant. Round implants are 78–180 mm wide.",
        ..length(limits::BASE_RADIUS_MM, "Base radius", usual)
    }
    .show(ui, &mut implant.base_radius_mm);
    ui.checkbox(is_hemisphere, "Hemisphere (projection = base radius)")
        .on_hover_text("The shape of the paper: the implant doubles the area that it covers.");
    ui.add_enabled_ui(!*is_hemisphere, |ui| {
        Control {
            tooltip: "Height of the implant above its base. Round implants: 20–75 mm, or 0.39–1.07 of \
                      the base radius.",
            ..length(limits::PROJECTION_MM, "Projection", implant.base_radius_mm)
        }
        .show(ui, &mut implant.projection_mm);
    });
}

fn pocket(ui: &mut Ui, scene: &mut Scene) {
    let [x, y] = scene.implant.center_mm;
    let most = limits::POCKET_RADIUS_MAX_MM;
    let least = (scene.implant.base_radius_mm + x.hypot(y)).min(most);
    let mut radius_mm = scene.pocket_radius_mm;
    Control {
        allowed: Some(least..=most),
        limit_reason: &format!(
            "at least {least:.1} mm for this implant at this position; at most {most:.0} mm"
        ),
        tooltip: "Radius of the dissected pocket under the tissue. Outside the pocket the tissue stays \
                  attached to the chest wall. The pocket must contain the implant.",
        ..length((limits::BASE_RADIUS_MM.0, most), "Pocket radius", (least + 15.0).min(most))
    }
    .show(ui, &mut radius_mm);
    scene.set_pocket_radius(radius_mm);
}

/// A control of a length \[mm\].
fn length((least, most): (f64, f64), label: &str, reset: f64) -> Control<'_> {
    Control {
        label,
        unit: "mm",
        kind: Kind::Length,
        range: least..=most,
        reset,
        ..Control::default()
    }
}

/// Position of the implant along one axis. The pocket keeps its radius, because a larger pocket would
/// reduce the strain. A notice about a position outside the pocket offers a larger pocket.
fn position(
    ui: &mut Ui,
    scene: &mut Scene,
    axis: usize,
    label: &str,
    side: &str,
) -> Option<Notice> {
    let (room, other) = (scene.room_mm(), scene.implant.center_mm[1 - axis]);
    let most = (room * room - other * other).max(0.0).sqrt();
    let reason = format!("at most {} mm in this pocket", floor_to_tenth(most));
    // The position of a scene file may exceed the rail, or the pocket's rim by rounding.
    let reach = most.max(scene.implant.center_mm[axis].abs());
    let change = Control {
        allowed: Some(-reach..=reach),
        limit_reason: &reason,
        tooltip: &format!("Offset of the implant from the pocket's centre towards the {side}."),
        ..length((-SHIFT_MM, SHIFT_MM), label, 0.0)
    }
    .show(ui, &mut scene.implant.center_mm[axis]);
    let requested = change.out_of_range?;
    let offer = larger_pocket(scene, axis, requested);
    Some(Notice { offer, ..Notice::caution(format!("{label}: {reason}.")) })
}

/// The offer of a pocket, in steps of 0.5 mm, that contains the implant at the requested position \[mm\].
fn larger_pocket(scene: &Scene, axis: usize, requested: f64) -> Option<Offer> {
    let offset = requested.hypot(scene.implant.center_mm[1 - axis]);
    let pocket_radius_mm = (2.0 * (scene.implant.base_radius_mm + offset)).ceil() / 2.0;
    (pocket_radius_mm <= limits::POCKET_RADIUS_MAX_MM).then(|| {
        let mut scene = scene.clone();
        scene.set_pocket_radius(pocket_radius_mm);
        scene.implant.center_mm[axis] = requested;
        let label = format!("Enlarge the pocket to a radius of {pocket_radius_mm} mm");
        Offer { label, scene: Box::new(scene) }
    })
}

/// A length rounded down to 0.1 mm, so that the displayed limit is itself allowed.
fn floor_to_tenth(mm: f64) -> f64 {
    (10.0 * mm + 1e-6).floor() / 10.0
}

/// Shows the layers, from the skin inwards.
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
                    (
                        "Up",
                        "Move up",
                        "Move this layer outwards, towards the skin",
                        k > 0,
                        Action::Up(k),
                    ),
                    (
                        "Down",
                        "Move down",
                        "Move this layer inwards, towards the implant",
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
            if button_if(ui, room, name, name, "Add this layer innermost; at most 8 layers") {
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
    /// Exchanges the layer with the one outside it.
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
        response.on_hover_text("Any name; “skin”, “adipose” and “muscle” have their own colours");
    });
    Control {
        step: 0.1,
        logarithmic: true,
        tooltip: "Unstretched thickness. Breast skin is about 1–3 mm thick, the adipose layer 5–40 mm.",
        ..length(limits::THICKNESS_MM, "Thickness", usual.thickness_mm)
    }
    .show(ui, &mut layer.thickness_mm);
    let (least, most) = limits::POISSON_RATIO;
    Control {
        label: "Poisson ratio",
        range: least..=most,
        reset: usual.poisson_ratio,
        decimals: 2,
        step: 0.01,
        tooltip: "Transverse contraction relative to the stretch. Soft tissue: 0.35–0.50; at 0.50 the volume \
                  is constant.",
        ..Control::default()
    }
    .show(ui, &mut layer.poisson_ratio);
    curve_editor::show(ui, &mut layer.curve.spec);
}

/// Springs, resolution and tolerance.
pub(super) fn method(ui: &mut Ui, scene: &mut Scene, session: &Session) {
    group(ui, "Method", |ui| {
        tissue_model(ui, scene);
        if scene.is_layered() {
            attachment(ui, scene);
        }
        springs(ui, scene);
        if let Some(limits) = session.stability_limits() {
            stability::show(ui, scene, limits, session.greatest_strain());
        }
        ui.add_space(SPACE_SMALL);
        resolution(ui, &mut scene.solver.nodes_per_side);
        tolerance(ui, &mut scene.solver.tolerance);
    });
}

/// The choice of the tissue model.
fn tissue_model(ui: &mut Ui, scene: &mut Scene) {
    let name = |model: TissueModel| match model {
        TissueModel::Layered => "Skin on solid layers",
        TissueModel::Sheet => "One sheet",
    };
    let present = if scene.is_layered() { TissueModel::Layered } else { TissueModel::Sheet };
    let response = labelled_box(ui, "Tissue model", name(present), |ui| {
        for model in [TissueModel::Layered, TissueModel::Sheet] {
            if choice(ui, present == model, name(model)).clicked() && present != model {
                scene.set_tissue_model(model);
            }
        }
    });
    response.on_hover_text(
        "Skin on solid layers: the fat thins over the implant, and the skin over the pocket draws on the \
         skin beyond the pocket. One sheet: all layers stretch alike and are held at the pocket's edge; \
         force and strain are then too high.",
    );
}

/// Patch and attachment of layered tissue.
fn attachment(ui: &mut Ui, scene: &mut Scene) {
    let pocket = scene.pocket_radius_mm;
    let Some(body) = &mut scene.body else { return };
    let usual = Body::around(pocket, TissueModel::Layered);
    let (least, most) = Body::patch_range(pocket);
    Control {
        allowed: Some(least..=most),
        limit_reason: &format!("{least:.0} to {most:.0} mm around this pocket"),
        tooltip: "Radius of the computed tissue around the pocket's centre; the tissue is held at its edge.",
        ..length((least, most), "Computed radius", usual.patch_radius_mm)
    }
    .show(ui, &mut body.patch_radius_mm);
    let (least, most) = limits::ATTACHMENT_STIFFNESS;
    Control {
        label: "Attachment stiffness",
        unit: "kPa/mm",
        range: least..=most,
        reset: usual.attachment.stiffness_kpa_per_mm,
        decimals: 1,
        step: 0.1,
        logarithmic: true,
        tooltip: "How firmly the tissue beyond the pocket is held to the chest wall. Plausible: 1–5 kPa/mm.",
        ..Control::default()
    }
    .show(ui, &mut body.attachment.stiffness_kpa_per_mm);
    Control {
        tooltip: "Width over which the hold rises from zero at the pocket's edge.",
        ..length(limits::ATTACHMENT_RAMP_MM, "Attachment ramp", usual.attachment.ramp_mm)
    }
    .show(ui, &mut body.attachment.ramp_mm);
}

/// The choice of the springs; the paper's springs make layered tissue a sheet.
fn springs(ui: &mut Ui, scene: &mut Scene) {
    let is_layered = scene.is_layered();
    let name = |springs: Springs| match springs {
        Springs::Coupled => "Coupled (exact, isotropic)",
        Springs::Nikolaev if is_layered => "Nikolaev 2013, in one sheet",
        Springs::Nikolaev => "Nikolaev 2013, as published",
    };
    let present = scene.springs;
    let response = labelled_box(ui, "Springs", name(present), |ui| {
        for law in [Springs::Coupled, Springs::Nikolaev] {
            if choice(ui, present == law, name(law)).clicked() {
                scene.set_springs(law);
            }
        }
    });
    response.on_hover_text(
        "Coupled springs reproduce the measured curve and Poisson ratio exactly, in every direction. The \
         springs of Nikolaev 2013 are for comparison: their tissue is one sheet, and at large strains and \
         Poisson ratios they are unstable.",
    );
}

fn resolution(ui: &mut Ui, nodes_per_side: &mut usize) {
    let name = |count: usize| format!("{count} nodes per side");
    let response = labelled_box(ui, "Resolution", &name(*nodes_per_side), |ui| {
        for count in [33, 65, 129, 193, 257] {
            if choice(ui, *nodes_per_side == count, name(count)).clicked() {
                *nodes_per_side = count;
            }
        }
    });
    response.on_hover_text(
        "Finer grids take longer. A sheet of 129 nodes per side is within 0.02 % of the exact membrane; skin on \
         solid layers is within 0.5 %.",
    );
}

fn tolerance(ui: &mut Ui, tolerance: &mut f64) {
    let (least, most) = limits::TOLERANCE;
    let mut percent = 100.0 * *tolerance;
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
        tooltip: "Largest position error of a node that the solver accepts.",
        ..Control::default()
    }
    .show(ui, &mut percent);
    if change.is_changed {
        *tolerance = (percent / 100.0).clamp(least, most);
    }
}
