//! The chest: flat, usual, round, by its radii of curvature, or a torso by what a tape measures.

use super::device::Device;
use super::{Hand, chip, chips, cm, mm, named, plain, row};
use crate::app::texts::tr;
use crate::app::widgets::quantity::format_at_most;
use crate::app::widgets::{self, Control, set_accessible_name};
use crate::scene::field::{CHEST, TORSO};
use crate::scene::{ChestShape, Field, Scene};
use eframe::egui::{self, Ui};
use std::time::Duration;

/// A choice: its word, its chest and what it means.
type ChestChoice = (&'static str, Chest, &'static str);

/// The chest of a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Chest {
    /// By radii; `None`: flat.
    Radii(Option<ChestShape>),
    /// The built-in torso.
    Torso,
}

pub(super) const CHOICES: [ChestChoice; 4] = [
    (
        "flat",
        Chest::Radii(None),
        "A flat chest wall. The skin then stretches less than over a curved one.",
    ),
    (
        "usual",
        Chest::Radii(Some(ChestShape::USUAL)),
        "Radius of curvature 14 cm across the body, straight along it: chests measured at the breasts have 12 to 16 cm.",
    ),
    (
        "round",
        Chest::Radii(Some(ChestShape::ROUND)),
        "A barrel chest: radius of curvature 12 cm across the body, 60 cm along it.",
    ),
    (
        "torso",
        Chest::Torso,
        "A torso with the breast before the operation, shaped by what a tape measures: its chest, its breast and the tissue of the pinch are computed and drawn.",
    ),
];

impl Chest {
    fn is_of(self, scene: &Scene) -> bool {
        match self {
            Self::Torso => scene.torso.is_some(),
            Self::Radii(chest) => {
                scene.torso.is_none() && scene.chest_grid.is_none() && scene.chest == chest
            }
        }
    }

    /// Gives a scene the chest; a torso keeps its numbers.
    pub(super) fn set(self, scene: &mut Scene) {
        match self {
            Self::Radii(chest) => scene.set_chest(chest),
            Self::Torso => scene.set_torso(scene.torso.unwrap_or_default()),
        }
    }
}

/// Radius along the body of a chest that is curved along at first \[mm\].
const ALONG_MM: f64 = 600.0;
/// Greatest radius on the screen \[mm\], flat to the eye.
const MOST_MM: f64 = 10_000.0;

/// The word of the present choice; `None` for radii of their own and for a grid of heights.
pub(super) fn choice(scene: &Scene) -> Option<&'static str> {
    CHOICES.iter().find(|(_, chest, _)| chest.is_of(scene)).map(|(word, ..)| *word)
}

/// The chest of a scene in a few words with its radii.
pub(crate) fn chest_in_words(scene: &Scene) -> String {
    if let Some(torso) = &scene.torso {
        let volume = format_at_most(torso.breast_volume_ml, 0, 0);
        return tr!("torso, breast of {volume} ml", volume);
    }
    let radius = |field: Field| field.value(scene, 0).map(|mm| format_at_most(cm(mm), 0, 1));
    match CHEST.map(radius) {
        [None, _] if scene.placement.is_some() => tr("hers, from the scan").to_owned(),
        [None, _] if scene.chest_grid.is_some() => tr("from a grid of heights").to_owned(),
        [None, _] => tr("flat").to_owned(),
        [Some(across), None] => tr!("radius {across} cm across", across),
        [Some(across), Some(along)] if across == along => tr!("sphere, radius {across} cm", across),
        [Some(across), Some(along)] => {
            tr!("radius {across} cm across, {along} cm along", across, along)
        }
    }
}

/// Are the radii shown in place of a choice?
fn is_own(ui: &Ui, scene: &Scene) -> bool {
    let is_open = ui.data(|data| data.get_temp(own_id()).unwrap_or(false));
    scene.chest.is_some() && (is_open || choice(scene).is_none())
}

fn own_id() -> egui::Id {
    egui::Id::unique("radii of the chest")
}

/// Shows the choice of the chest in a row; nothing for a sheet, which has none.
pub(super) fn chest(ui: &mut Ui, scene: &mut Scene) {
    if scene.is_layered() {
        named(ui, tr("Chest"), |ui| choices(ui, scene));
    }
}

/// Shows the choices in a list.
fn choices(ui: &mut Ui, scene: &mut Scene) {
    let is_own = is_own(ui, scene);
    let present = if is_own { None } else { choice(scene) };
    let name = |word: Option<&str>| match word {
        Some("flat") => tr("flat chest"),
        Some("usual") => tr("usual chest"),
        Some("round") => tr("round chest"),
        Some(_) => tr("torso by a tape…"),
        None => tr("chest by its radii…"),
    };
    let selected = match (&scene.placement, &scene.chest_grid) {
        (Some(_), _) => tr("hers, from the scan"),
        (None, Some(_)) => tr("from a grid of heights"),
        (None, None) => name(present),
    };
    let list = widgets::list(ui, "chest").width(150.0).selected_text(selected);
    let response = list
        .show_ui(ui, |ui| {
            for (word, chest, tooltip) in CHOICES {
                let item = widgets::choice(ui, present == Some(word), name(Some(word)));
                if item.on_hover_text(tr(tooltip)).clicked() {
                    chest.set(scene);
                    ui.data_mut(|data| data.insert_temp(own_id(), false));
                }
            }
            let item = widgets::choice(ui, is_own, name(None));
            if item.on_hover_text(tr("A chest by its radii of curvature")).clicked() {
                scene.set_chest(Some(scene.chest.unwrap_or(ChestShape::USUAL)));
                ui.data_mut(|data| data.insert_temp(own_id(), true));
            }
        })
        .response;
    set_accessible_name(&response, egui::Role::ComboBox, tr("Chest"));
    let words = tr!("Chest: {words}", words = chest_in_words(scene));
    let about = tr(
        "Curvature of the chest wall below the breast. Tissue that is lifted from a curved chest stretches more: \
         4 cm over a radius of 14 cm by a quarter across.",
    );
    response.on_hover_text(format!("{words}\n{about}"));
}

/// Shows the radii of a chest of its own.
pub(super) fn radii(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if !is_own(ui, scene) {
        return;
    }
    for axis in 0..CHEST.len() {
        let Some((control, mut radius)) = radius(scene, axis) else {
            continue;
        };
        if row(ui, hand, control, &mut radius, (0.0, |_: &mut Ui| {})).is_changed {
            set_radius(scene, axis, radius);
        }
    }
    chips(ui, |ui| {
        let Some(chest) = &mut scene.chest else { return };
        for (word, along, tooltip) in [
            ("straight along", None, "The chest is not curved along the body."),
            ("curved along", Some(ALONG_MM), "The chest is curved along the body too."),
        ] {
            let is_chosen = chest.radius_along_mm.is_some() == along.is_some();
            if chip(ui, hand, is_chosen, tr(word), tr(tooltip)) {
                chest.radius_along_mm = along;
            }
        }
    });
}

/// A number that a held slider has moved, in the unit of its control, before the torso is shaped by it.
#[derive(Clone, Copy)]
struct Waiting {
    number: Field,
    value: f64,
    /// Time of the last motion \[s\].
    since: f64,
}

/// Time for which a held slider rests before the torso is shaped, which takes longer than a frame \[s\].
const PAUSE_S: f64 = 0.15;

fn waiting_id() -> egui::Id {
    egui::Id::unique("waiting number of the torso")
}

fn waiting(ctx: &egui::Context) -> Option<Waiting> {
    ctx.data(|data| data.get_temp(waiting_id()))
}

/// Has a held slider moved a number that the torso does not have yet?
pub(crate) fn is_waiting(ctx: &egui::Context) -> bool {
    waiting(ctx).is_some()
}

/// Shows the numbers of the torso.
pub(super) fn torso(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    let ctx = ui.ctx().clone();
    let waiting = waiting(&ctx);
    ctx.data_mut(|data| data.remove::<Waiting>(waiting_id()));
    if scene.torso.is_none() {
        return;
    }
    let mut waiting = waiting.filter(|_| !widgets::is_press_cancelled(&ctx));
    let (now, is_held) = ctx.input(|input| (input.time, input.pointer.any_down()));
    for number in TORSO {
        let Some((control, mut value)) = plain::control(scene, number, Device::Implant) else {
            continue;
        };
        value = waiting.filter(|of| of.number == number).map_or(value, |of| of.value);
        if row(ui, hand, control, &mut value, (0.0, |_: &mut Ui| {})).is_changed {
            waiting = Some(Waiting { number, value, since: now });
        }
    }
    let Some(of @ Waiting { number, value, since }) = waiting else { return };
    let rest = PAUSE_S - (now - since);
    if is_held && rest > 0.0 {
        ctx.data_mut(|data| data.insert_temp(waiting_id(), of));
        ctx.request_repaint_after(Duration::from_secs_f64(rest));
    } else {
        plain::set(scene, number, value);
    }
}

/// The control of the radius across (0) or along the body (1), and the radius \[cm\]; `None` without one.
pub(super) fn radius(scene: &Scene, axis: usize) -> Option<(Control<'static>, f64)> {
    let field = CHEST[axis];
    let value = field.value(scene, 0)?;
    let (least, most) = field.range(scene);
    // Of the limits in a file those that a person may mean; a displayed limit is itself allowed.
    let (least, most) = (least.max(-MOST_MM).min(value), most.min(MOST_MM).max(value));
    let tenth = |mm: f64| cm((mm - 1e-6).ceil());
    let control = Control {
        range: if value < 0.0 { -40.0..=-10.0 } else { 10.0..=40.0 },
        allowed: Some(tenth(least).min(cm(value))..=cm(most)),
        limit_reason: tr("the simulated tissue reaches around a smaller radius").to_owned(),
        reset: 14.0,
        ..Control::of(field)
    };
    Some((control, cm(value)))
}

/// Sets a radius \[cm\].
pub(super) fn set_radius(scene: &mut Scene, axis: usize, radius: f64) {
    CHEST[axis].set(scene, 0, mm(radius));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choices_are_scenes_and_have_their_words() {
        let mut scene = Scene::opening();
        for (word, chest, _) in CHOICES {
            chest.set(&mut scene);
            assert_eq!((choice(&scene), scene.validate()), (Some(word), Ok(())));
        }
        assert_eq!(chest_in_words(&scene), "torso, breast of 180 ml");
        scene.set_chest(Some(ChestShape::ROUND));
        assert_eq!(chest_in_words(&scene), "radius 12 cm across, 60 cm along");
        set_radius(&mut scene, 0, 14.5);
        set_radius(&mut scene, 1, 60.0);
        assert_eq!(choice(&scene), None);
        assert_eq!(chest_in_words(&scene), "radius 14.5 cm across, 60 cm along");
        scene.chest = Some(ChestShape::USUAL);
        assert_eq!(chest_in_words(&scene), "radius 14 cm across");
        assert!(radius(&scene, 1).is_none());
        // Too small for the tissue: the least radius.
        set_radius(&mut scene, 0, 3.0);
        assert_eq!(scene.validate(), Ok(()));
        scene.chest = None;
        assert_eq!(
            (chest_in_words(&scene), radius(&scene, 0).is_none()),
            ("flat".to_owned(), true)
        );
    }
}
