//! The fat of the plan as a choice: the range of the measurements, or the fat of the paper.

use crate::app::frame::research;
use crate::app::plan::{Hand, chip, chips};
use crate::app::texts::tr;
use crate::app::widgets::{group, remark};
use crate::curve::{CurveSpec, Fat};
use crate::scene::{Layer, Scene};
use eframe::egui::Ui;

/// A choice: its name, its curve (`None`: that of the paper) and what it means.
type FatChoice = (&'static str, Option<Fat>, &'static str);

const CHOICES: [FatChoice; 4] = [
    (
        "Soft",
        Some(Fat::Low),
        "Fat that yields easily: 1.5 kPa at rest, the low end of tests of human fat (Alkhouli et al. 2013, Sims et al. \
         2010). It keeps its volume.",
    ),
    (
        "Usual",
        Some(Fat::Mid),
        "Fat as tests of human fat found it on average: 2 kPa at rest, four times as stiff at 30 % stretch (Alkhouli et al. \
         2013). It keeps its volume.",
    ),
    (
        "Firm",
        Some(Fat::High),
        "Fat that resists: 4 kPa at rest, the high end of tests of human fat (Alkhouli et al. 2013; elastography and \
         breast fat in vivo 2–4 kPa). It keeps its volume.",
    ),
    (
        "Nikolaev 2013",
        None,
        "The fat of the paper, to compare with it: it gives way when stretched far, which no slow test of fat has shown, \
         and loses some volume (Poisson ratio 0.45).",
    ),
];

/// A layer with the fat of a choice in its place: all but the thickness.
fn layer(fat: Option<Fat>, present: &Layer) -> Layer {
    let usual = match fat {
        Some(variant) => Layer { curve: CurveSpec::Fat { variant }.into(), ..Layer::adipose() },
        None => Layer::paper_adipose(),
    };
    Layer { thickness_mm: present.thickness_mm, ..usual }
}

/// Has a layer the fat of a choice?
fn is_of(present: &Layer, fat: Option<Fat>) -> bool {
    *present == layer(fat, present)
}

/// The layers of fat: those named adipose below the skin.
fn layers(scene: &mut Scene) -> impl Iterator<Item = &mut Layer> {
    scene.layers.iter_mut().skip(1).filter(|layer| layer.tissue == Layer::adipose().tissue)
}

/// Shows the choice; nothing without a layer of fat.
pub(crate) fn show(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if layers(scene).next().is_none() {
        return;
    }
    group(ui, tr("Fat"), |ui| {
        chips(ui, |ui| {
            for (name, fat, tooltip) in CHOICES {
                let is_chosen = layers(scene).all(|layer| is_of(layer, fat));
                if fat.is_none() && !is_chosen && !research::is_on(ui.ctx()) {
                    continue;
                }
                if chip(ui, hand, is_chosen, tr(name), tr(tooltip)) {
                    choose(scene, fat);
                }
            }
        });
        remark(ui, tr("Soft to firm: what tests of human fat found"));
    });
}

/// Gives the layers of fat that of a choice; thicknesses stay.
fn choose(scene: &mut Scene, fat: Option<Fat>) {
    layers(scene).for_each(|present| *present = layer(fat, present));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_sets_all_layers_of_fat_below_the_skin_and_no_other() {
        let mut scene = Scene::opening();
        let muscle = Layer { tissue: "muscle".to_owned(), ..Layer::adipose() };
        scene.layers.extend([Layer::adipose(), muscle.clone()]);
        let before = scene.clone();
        let chosen = |scene: &mut Scene| -> Vec<&str> {
            let of = |(name, fat, _): FatChoice| {
                layers(scene).all(|layer| is_of(layer, fat)).then_some(name)
            };
            CHOICES.into_iter().filter_map(of).collect()
        };
        assert_eq!(chosen(&mut scene), ["Usual"]);
        for (name, fat, _) in CHOICES {
            choose(&mut scene, fat);
            assert_eq!(chosen(&mut scene), [name]);
            assert_eq!((&scene.layers[0], &scene.layers[3]), (&before.layers[0], &muscle));
            let thicknesses =
                |scene: &Scene| scene.layers.iter().map(|l| l.thickness_mm).sum::<f64>();
            assert!((thicknesses(&scene) - thicknesses(&before)).abs() < 1e-12);
        }
        choose(&mut scene, Some(Fat::Mid));
        assert_eq!(scene, before);
        scene.layers[1].curve.stress_scale = 2.0;
        assert_eq!(chosen(&mut scene), [""; 0]);
        // Layers of different fat.
        scene.layers[1] = Layer::paper_adipose();
        assert_eq!(chosen(&mut scene), [""; 0]);
    }
}
