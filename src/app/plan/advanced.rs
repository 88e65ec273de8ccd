//! The folded parts of the plan. Tissue: insertion, fat, layers and curves. Advanced: accuracy, numbers without code of their own, tissue model, patch and attachment,
//! springs.

use super::device::Device;
use super::{fat, fill, pocket, posture, when};
use crate::app::answer::stability;
use crate::app::curve_editor;
use crate::app::frame::research;
use crate::app::plan::{Hand, chip, chips, plain};
use crate::app::texts::{self, tr};
use crate::app::widgets::theme::{SPACE, SPACE_SMALL};
use crate::app::widgets::{Control, button_if, choice, group, labelled_box, set_accessible_name};
use crate::scene::{Body, Field, Layer, Scene, Springs, TissueModel, limits};
use crate::session::Session;
use eframe::egui::{self, RichText, Ui};

/// Names of the accuracies, with their nodes per side and tolerance \[fraction of the base radius\].
const ACCURACIES: [(&str, usize, f64); 3] =
    [("Fast", 65, 1e-3), ("Normal", 129, 1e-4), ("Fine", 257, 1e-4)];

/// Shows the fold of the tissue, closed at first: what `add` shows, the implant's fill, fat, skin at rest, plane and fluid of the pocket, time and posture, layers
/// with their curves. Returns the layer whose points are to
/// be edited.
pub(crate) fn tissue(
    ui: &mut Ui,
    scene: &mut Scene,
    hand: Hand,
    add: impl FnOnce(&mut Ui, &mut Scene),
) -> Option<usize> {
    let title = match scene.insertion {
        whole if whole >= 1.0 => tr("Tissue").to_owned(),
        part => tr!("Tissue ({percent:.0} % in place)", percent = 100.0 * part),
    };
    let header = egui::CollapsingHeader::new(title).id_salt("tissue");
    let fold = header.show_unindented(ui, |ui| {
        add(ui, scene);
        // A phone has them under implant and pocket.
        if hand == Hand::Mouse {
            fill::show(ui, scene);
        }
        fat::show(ui, scene, hand);
        if hand == Hand::Mouse {
            pocket::plane(ui, scene, hand);
            pocket::fluid(ui, scene, hand);
        }
        when::show(ui, scene, hand);
        posture::show(ui, scene, hand);
        layers(ui, scene)
    });
    set_accessible_name(&fold.header_response, egui::Role::DisclosureTriangle, tr("Tissue"));
    fold.body_returned.flatten()
}

/// Shows the fold of accuracy, plain numbers and model, closed at first: without "Research" only what differs from its default, and no fold
/// without such a difference.
pub(crate) fn show(ui: &mut Ui, scene: &mut Scene, session: &Session, hand: Hand) {
    let is_on = research::is_on(ui.ctx());
    let [has_accuracy, has_model] =
        [!has_usual_accuracy(scene), !is_standard(scene)].map(|differs| is_on || differs);
    let mut numbers = Field::PLAIN.to_vec();
    numbers.retain(|number| is_on || number.is_stated(scene));
    if numbers.is_empty() && !(has_accuracy || has_model) {
        return;
    }
    let header = egui::CollapsingHeader::new(tr("Advanced")).id_salt("advanced");
    header.show_unindented(ui, |ui| {
        if has_accuracy {
            accuracy(ui, scene, hand);
        }
        for number in numbers {
            plain_number(ui, scene, number);
        }
        if has_model {
            method(ui, scene, session);
        }
    });
}

/// Is the model the usual one: skin on solid layers, standard law, patch and attachment of every plan?
fn is_standard(scene: &Scene) -> bool {
    let usual = Body::around(scene.pocket_radius_mm, TissueModel::Layered);
    let Body { patch_radius_mm, attachment, .. } = scene.body;
    let body = Body { patch_radius_mm, attachment, ..usual };
    scene.springs == Springs::Coupled && scene.is_layered() && body == usual
}

/// Is the accuracy that of the opening plan?
pub(crate) fn has_usual_accuracy(scene: &Scene) -> bool {
    accuracy_name(scene) == Some(tr(ACCURACIES[1].0))
}

/// The name of a scene's accuracy; `None` for other numbers.
pub(crate) fn accuracy_name(scene: &Scene) -> Option<&'static str> {
    let is_present = |nodes: usize, tolerance: f64| {
        let solver = &scene.solver;
        solver.nodes_per_side == nodes && (solver.tolerance / tolerance - 1.0).abs() < 1e-9
    };
    let name = |&(name, nodes, tolerance)| is_present(nodes, tolerance).then_some(tr(name));
    ACCURACIES.iter().find_map(name)
}

/// A number without code of its own.
fn plain_number(ui: &mut Ui, scene: &mut Scene, number: Field) {
    let control = plain::control(scene, number, Device::of(ui.ctx()));
    let Some((control, mut value)) = control else { return };
    if control.show(ui, &mut value).is_changed {
        plain::set(scene, number, value);
    }
}

/// Grid and tolerance, by name and by number.
fn accuracy(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    group(ui, tr("Accuracy"), |ui| {
        let present = accuracy_name(scene);
        chips(ui, |ui| {
            for (name, nodes, tolerance) in ACCURACIES {
                let tooltip = tr!(
                    "{nodes} nodes per side, {tolerance} % of the base radius",
                    nodes,
                    tolerance = 100.0 * tolerance
                );
                let name = tr(name);
                if chip(ui, hand, present == Some(name), name, &tooltip) {
                    scene.solver.nodes_per_side = nodes;
                    scene.solver.tolerance = tolerance;
                }
            }
        });
        resolution(ui, &mut scene.solver.nodes_per_side);
        tolerance(ui, scene);
    });
}

/// Shows the layers, from the skin inwards. Returns the layer whose points are to be edited.
fn layers(ui: &mut Ui, scene: &mut Scene) -> Option<usize> {
    let (mut action, mut edited) = (None, None);
    let count = scene.layers.len();
    for (k, layer) in scene.layers.iter_mut().enumerate() {
        let title =
            tr!("Layer {number}: {tissue}", number = k + 1, tissue = texts::tissue(&layer.tissue));
        let header = egui::CollapsingHeader::new(RichText::new(title).strong())
            .id_salt(("layer", k))
            .default_open(k < 2);
        header.show_unindented(ui, |ui| {
            if ui.push_id(k, |ui| one_layer(ui, layer)).inner {
                edited = Some(k);
            }
            ui.horizontal_wrapped(|ui| {
                let named = |text: &str| tr!("{text} layer {number}", text, number = k + 1);
                for (text, name, tooltip, is_able, what) in [
                    (
                        tr("Move outward"),
                        tr("Move outward"),
                        tr("Move this layer outward, towards the skin"),
                        k > 0,
                        Action::Up(k),
                    ),
                    (
                        tr("Move inward"),
                        tr("Move inward"),
                        tr("Move this layer inward, towards the pocket"),
                        k + 1 < count,
                        Action::Up(k + 1),
                    ),
                    (
                        tr("Remove"),
                        tr("Remove"),
                        tr("Remove this layer"),
                        count > 1,
                        Action::Remove(k),
                    ),
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
            [(tr("Add skin"), Layer::skin as fn() -> Layer), (tr("Add fat"), Layer::adipose)]
        {
            if button_if(ui, room, name, name, tr("Add this layer innermost; at most 8 layers")) {
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
    edited
}

enum Action {
    /// Exchanges the layer with the one outside it.
    Up(usize),
    Remove(usize),
    Add(Layer),
}

/// Shows a layer. Returns whether the points of its curve are to be edited.
fn one_layer(ui: &mut Ui, layer: &mut Layer) -> bool {
    let usual = if layer.tissue == "adipose" { Layer::adipose() } else { Layer::skin() };
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new(tr("Tissue")).color(ui.visuals().weak_text_color()));
        let mut name = texts::tissue(&layer.tissue).to_owned();
        let field = egui::TextEdit::singleline(&mut name)
            .char_limit(40)
            .desired_width(ui.available_width() - SPACE);
        let response = ui.add(field).labelled_by(label.id);
        response.widget_info(|| egui::WidgetInfo {
            label: Some(tr("Tissue").to_owned()),
            ..egui::WidgetInfo::text_edit(true, "", &name, "")
        });
        if response.changed() {
            texts::tissue_of_file(&name).clone_into(&mut layer.tissue);
        }
        response.on_hover_text(tr("Any name; “skin”, “fat” and “muscle” have their own colours"));
    });
    Control { logarithmic: true, reset: usual.thickness_mm, ..Control::of(Field::Thickness) }
        .show(ui, &mut layer.thickness_mm);
    Control { reset: usual.poisson_ratio, ..Control::of(Field::PoissonRatio) }
        .show(ui, &mut layer.poisson_ratio);
    ui.small(tr("How little the volume changes when pulled (0.5 = not at all)"));
    curve_editor::show(ui, &mut layer.curve, &layer.tissue)
}

/// Tissue model and springs.
fn method(ui: &mut Ui, scene: &mut Scene, session: &Session) {
    group(ui, tr("Model"), |ui| {
        tissue_model(ui, scene);
        if scene.is_layered() {
            attachment(ui, scene);
        }
        springs(ui, scene);
        if let Some(limits) = session.stability_limits() {
            stability::show(ui, scene, limits, session.greatest_strain());
        }
        ui.add_space(SPACE_SMALL);
    });
}

/// The choice of the tissue model.
fn tissue_model(ui: &mut Ui, scene: &mut Scene) {
    let name = |model: TissueModel| match model {
        TissueModel::Layered => tr("Skin on solid layers"),
        TissueModel::Sheet => tr("One sheet"),
    };
    let present = if scene.is_layered() { TissueModel::Layered } else { TissueModel::Sheet };
    let response = labelled_box(ui, tr("Tissue model"), name(present), |ui| {
        for model in [TissueModel::Layered, TissueModel::Sheet] {
            if choice(ui, present == model, name(model)).clicked() && present != model {
                scene.set_tissue_model(model);
            }
        }
    });
    response.on_hover_text(
        tr("Skin on solid layers: the fat thins over the dome, and the skin over the pocket draws on the \
         skin beyond the pocket. One sheet: all layers stretch alike and are held at the pocket's edge; \
         force and stretch are then too high."),
    );
}

/// Patch and attachment of layered tissue.
fn attachment(ui: &mut Ui, scene: &mut Scene) {
    let usual = Body::around(scene.pocket_radius_mm, TissueModel::Layered);
    let (least, most) = Body::patch_range(scene.pocket_reach_mm());
    let body = &mut scene.body;
    Control {
        range: least..=most,
        limit_reason: tr!("{least:.0} to {most:.0} mm around this pocket", least, most),
        reset: usual.patch_radius_mm,
        ..Control::of(Field::PatchRadius)
    }
    .show(ui, &mut body.patch_radius_mm);
    let stiffness = Control::of(Field::AttachmentStiffness);
    Control { logarithmic: true, reset: usual.attachment.stiffness_kpa_per_mm, ..stiffness }
        .show(ui, &mut body.attachment.stiffness_kpa_per_mm);
    Control { reset: usual.attachment.ramp_mm, ..Control::of(Field::AttachmentRamp) }
        .show(ui, &mut body.attachment.ramp_mm);
}

/// The choice of the springs; the paper's springs make layered tissue a sheet.
fn springs(ui: &mut Ui, scene: &mut Scene) {
    let is_layered = scene.is_layered();
    let name = |springs: Springs| match springs {
        Springs::Coupled => tr("Standard"),
        Springs::Nikolaev if is_layered => tr("Nikolaev 2013, in one sheet"),
        Springs::Nikolaev => tr("Nikolaev 2013 (to compare with the paper)"),
    };
    let present = scene.springs;
    let response = labelled_box(ui, tr("Law of the tissue"), name(present), |ui| {
        for law in [Springs::Coupled, Springs::Nikolaev] {
            if choice(ui, present == law, name(law)).clicked() {
                scene.set_springs(law);
            }
        }
    });
    response.on_hover_text(
        tr("The standard law, coupled springs, reproduces the measured curve and Poisson ratio exactly, in every direction. \
         The springs of Nikolaev 2013 are for comparison: their tissue is one sheet, and at large strains and \
         Poisson ratios they are unstable."),
    );
}

fn resolution(ui: &mut Ui, nodes_per_side: &mut usize) {
    let name = |count: usize| tr!("{count} nodes per side", count);
    let response = labelled_box(ui, tr("Resolution"), &name(*nodes_per_side), |ui| {
        for count in [33, 65, 129, 193, 257] {
            if choice(ui, *nodes_per_side == count, name(count)).clicked() {
                *nodes_per_side = count;
            }
        }
    });
    response.on_hover_text(
        tr("Finer grids take longer. A sheet of 129 nodes per side is within 0.02 % of the exact membrane; skin on \
         solid layers is within 0.5 %."),
    );
}

fn tolerance(ui: &mut Ui, scene: &mut Scene) {
    let mut percent = Field::Tolerance.shown(scene).unwrap_or_default();
    let control = Control::of(Field::Tolerance);
    // A tolerance below this one is typed.
    let rail = 1e-4..=*control.range.end();
    let control = Control { reset: 0.01, logarithmic: true, ..control.with_rail(rail) };
    let change = control.show(ui, &mut percent);
    if change.is_changed {
        Field::Tolerance.set(scene, 0, percent / 100.0);
    }
}
