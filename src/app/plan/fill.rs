//! What fills an implant: gel, saline, or nothing that yields, in a list.

use super::{Device, named};
use crate::app::texts::{fixed, tr};
use crate::app::widgets::{self, set_accessible_name};
use crate::scene::{Fill, Gel, Scene};
use eframe::egui::{self, Ui};

/// A choice: its word in forms, its fill (`None`: rigid), its name and what it means.
type FillChoice = (&'static str, Option<Fill>, &'static str, &'static str);

pub(super) const CHOICES: [FillChoice; 5] = [
    (
        "form_stable",
        Some(Fill::FormStable),
        "form-stable gel",
        "Highly cohesive gel, about twice as stiff as cohesive gel: it flattens least under tight skin.",
    ),
    (
        "cohesive",
        Some(Fill::Cohesive),
        "cohesive gel",
        "The usual silicone gel. In the body the implant is lower and wider than in the catalogue, and presses less.",
    ),
    (
        "soft",
        Some(Fill::Soft),
        "soft gel",
        "Soft gel, half as stiff as cohesive gel, its shell included.",
    ),
    (
        "saline",
        Some(Fill::Saline),
        "saline",
        "A fluid in a shell: under tight skin it flattens most.",
    ),
    (
        "rigid",
        None,
        "rigid",
        "As if the implant kept the shape of the catalogue. Pressure and projection are then the highest.",
    ),
];

/// The word of the present choice; `None` of a gel by its numbers.
pub(super) fn choice(scene: &Scene) -> Option<&'static str> {
    let is_present = |fill| scene.implant.fill == fill;
    CHOICES.iter().find(|(_, fill, ..)| is_present(*fill)).map(|(word, ..)| *word)
}

/// The fill of a scene's implant in a few words.
pub(crate) fn fill_in_words(scene: &Scene) -> String {
    let is_present = |fill| scene.implant.fill == fill;
    let found = CHOICES.iter().find(|(_, fill, ..)| is_present(*fill));
    match (found, scene.implant.fill) {
        (Some((_, _, name, _)), _) => tr(name).to_owned(),
        (None, fill) => {
            let gel = fill.map(Fill::gel);
            let of = |value: fn(Gel) -> f64, decimals| {
                gel.map_or_else(String::new, |gel| fixed(value(gel), decimals))
            };
            tr!(
                "gel of {modulus} kPa, shell of {shell} kPa·mm",
                modulus = of(|gel| gel.modulus_kpa, 1),
                shell = of(|gel| gel.shell_kpa_mm, 0)
            )
        }
    }
}

/// Shows the choice in a row; nothing for an expander.
pub(crate) fn show(ui: &mut Ui, scene: &mut Scene) {
    if Device::of(ui.ctx()) == Device::Expander {
        return;
    }
    named(ui, tr("Filled with"), |ui| {
        let present = choice(scene);
        let list = widgets::list(ui, "fill").width(150.0);
        let list = list.selected_text(fill_in_words(scene)).truncate();
        let response = list.show_ui(ui, |ui| {
            for (word, fill, name, tooltip) in CHOICES {
                let item = widgets::choice(ui, present == Some(word), tr(name));
                if item.on_hover_text(tr(tooltip)).clicked() {
                    scene.implant.fill = fill;
                }
            }
        });
        let response = response.response;
        set_accessible_name(&response, egui::Role::ComboBox, tr("Filled with"));
        response.on_hover_text(tr(
            "How far the implant yields under the tissue. Its volume stays; height and width in the body stand in the details, \
             beside those of the catalogue.",
        ));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fill_has_a_choice_and_words_and_a_gel_of_its_own_has_its_numbers() {
        let mut scene = Scene::opening();
        assert_eq!(choice(&scene), Some("rigid"));
        for (name, fill) in Fill::NAMED {
            scene.implant.fill = Some(fill);
            assert_eq!((choice(&scene), scene.validate()), (Some(name), Ok(())));
        }
        scene.implant.fill = None;
        assert_eq!((choice(&scene), &*fill_in_words(&scene)), (Some("rigid"), "rigid"));
        scene.implant.fill = Some(Fill::Gel(Gel { modulus_kpa: 9.0, shell_kpa_mm: 450.0 }));
        assert_eq!(choice(&scene), None);
        assert_eq!(fill_in_words(&scene), "gel of 9.0 kPa, shell of 450 kPa·mm");
    }
}
