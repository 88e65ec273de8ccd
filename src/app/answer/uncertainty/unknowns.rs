//! What is not known: each unknown switched on or off, with its spread.

use crate::app::texts::tr;
use crate::app::widgets::theme::SPACE_SMALL;
use crate::app::widgets::{
    Kind, NumberField, button_if, quantity::significant, rejection_label, remark,
};
use crate::clinical::spread::Distribution;
use crate::scene::Scene;
use crate::study::{BandsSettings, SAMPLES, Unknown};
use eframe::egui::{RichText, Ui};
use std::collections::BTreeMap;

/// Greatest geometric standard deviation \[-\].
const MOST_GSD: f64 = 10.0;

/// The user's choices of unknowns and samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choices {
    samples: usize,
    seed: u32,
    unknowns: BTreeMap<Unknown, Choice>,
}

/// The choice of one unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Choice {
    is_off: bool,
    /// An edited distribution with the one between people that it replaces: of another kind of plan (with a measured pull,
    /// say) it has no meaning.
    edited: Option<(Distribution, Distribution)>,
}

impl Choice {
    /// The distribution in place of the one between people.
    fn distribution(self, usual: Distribution) -> Distribution {
        self.edited.filter(|(of, _)| *of == usual).map_or(usual, |(_, edited)| edited)
    }
}

impl Default for Choices {
    fn default() -> Self {
        let BandsSettings { samples, seed, .. } = BandsSettings::default();
        Self { samples, seed, unknowns: BTreeMap::new() }
    }
}

impl Choices {
    /// The usual choices but for the number of samples.
    #[cfg(test)]
    pub(super) fn of_samples(samples: usize) -> Self {
        Self { samples, ..Self::default() }
    }

    /// The settings of the study for a scene.
    pub(super) fn settings(&self, scene: &Scene) -> BandsSettings {
        let entry = |(unknown, choice): (&Unknown, &Choice)| {
            let usual = unknown.spread(scene)?.distribution;
            let distribution = choice.distribution(usual);
            let is_usual = !choice.is_off && distribution == usual;
            (!is_usual).then(|| (*unknown, (!choice.is_off).then_some(distribution)))
        };
        let usual = BandsSettings::default();
        BandsSettings {
            samples: self.samples,
            seed: self.seed,
            // Few samples have few rows.
            importance_rows: usual.importance_rows.min(self.samples),
            unknowns: self.unknowns.iter().filter_map(entry).collect(),
            ..usual
        }
    }

    /// Shows the unknowns of a scene, samples and seed.
    pub(super) fn show(&mut self, ui: &mut Ui, scene: &Scene) {
        for unknown in Unknown::ALL {
            if let Some(spread) = unknown.spread(scene) {
                let choice = self.unknowns.entry(unknown).or_default();
                row(ui, unknown, choice, spread.distribution);
            }
        }
        ui.add_space(SPACE_SMALL);
        let (least, most) = SAMPLES;
        let mut samples = self.samples as f64;
        if whole(
            ui,
            tr("Sampled patients"),
            tr("more are slower"),
            &mut samples,
            (least as f64, most as f64),
        ) {
            self.samples = samples as usize;
        }
        let mut seed = f64::from(self.seed);
        let tip = tr("equal numbers give equal patients");
        if whole(ui, tr("Seed"), tip, &mut seed, (0.0, f64::from(u32::MAX))) {
            self.seed = seed as u32;
        }
        let is_usual = self.settings(scene) == Self::default().settings(scene);
        let reset = tr("Back to the usual spread");
        if button_if(ui, !is_usual, reset, reset, "") {
            *self = Self::default();
        }
    }
}

/// A field for a whole number; returns whether the number has changed.
fn whole(ui: &mut Ui, name: &str, about: &str, value: &mut f64, (least, most): (f64, f64)) -> bool {
    let field = NumberField { name, allowed: least..=most, decimals: 0, ..NumberField::default() };
    let typed = ui.horizontal(|ui| {
        let typed = field.show(ui, value);
        ui.label(name);
        remark(ui, about);
        typed
    });
    if let Some(rejection) = &typed.inner.rejection {
        rejection_label(ui, rejection);
    }
    *value = value.round();
    typed.inner.is_changed
}

/// Shows an unknown: its switch, and the numbers of its distribution.
fn row(ui: &mut Ui, unknown: Unknown, choice: &mut Choice, usual: Distribution) {
    let words = words(unknown);
    let mut is_on = !choice.is_off;
    if ui.checkbox(&mut is_on, words.name).on_hover_text(words.tooltip).changed() {
        choice.is_off = !is_on;
    }
    if !is_on {
        return;
    }
    let mut distribution = choice.distribution(usual);
    let mut rejections = Vec::new();
    ui.horizontal(|ui| {
        ui.add_space(3.0 * SPACE_SMALL);
        for (between, part, value, allowed) in parts(unknown, &words, &mut distribution) {
            ui.label(RichText::new(between).small().weak());
            rejections.extend(number(ui, &words, part, value, allowed));
        }
        ui.label(RichText::new(tr(words.unit)).small().weak());
    });
    for rejection in rejections {
        rejection_label(ui, &rejection);
    }
    if distribution != choice.distribution(usual) {
        choice.edited = Some((usual, distribution));
    }
}

/// A number of a distribution: the word before it, its name, the number, its allowed range.
type Part<'a> = (&'static str, &'static str, &'a mut f64, (f64, f64));

/// The numbers of a distribution.
fn parts<'a>(unknown: Unknown, words: &Words, distribution: &'a mut Distribution) -> [Part<'a>; 2] {
    let center = unknown.allowed();
    match distribution {
        Distribution::LogNormal { median, gsd } => {
            [("", "median", median, center), (tr("× or ÷"), "spread factor", gsd, (1.0, MOST_GSD))]
        }
        Distribution::Normal { mean, sd } => {
            [("", "mean", mean, center), ("±", "standard deviation", sd, (0.0, words.most_sd))]
        }
        Distribution::Uniform { least, most } => {
            let (allowed_least, allowed_most) = ((center.0, *most), (*least, center.1));
            [("", "least", least, allowed_least), ("to", "most", most, allowed_most)]
        }
    }
}

/// Shows the field of a number; returns the reason of a rejection.
fn number(
    ui: &mut Ui,
    words: &Words,
    part: &str,
    value: &mut f64,
    (least, most): (f64, f64),
) -> Option<String> {
    // A factor has the unit of no distribution.
    let (kind, factor) =
        if part == "spread factor" { (Kind::Plain, 1.0) } else { (words.kind, words.factor) };
    let shown = |value: f64| significant(factor * value);
    let mut typed = shown(*value);
    let field = NumberField {
        name: &format!("{}: {}", words.name, tr(part)),
        kind,
        allowed: shown(least)..=shown(most),
        decimals: 1,
        step: if factor > 1.0 { 1.0 } else { 0.1 },
        width: 46.0,
        ..NumberField::default()
    };
    let response = field.show(ui, &mut typed);
    if response.is_changed {
        *value = significant(typed / factor).clamp(least, most);
    }
    response.rejection
}

/// How an unknown is shown.
pub(super) struct Words {
    pub(super) name: &'static str,
    tooltip: &'static str,
    /// Unit of the numbers, or how they act on the plan.
    unit: &'static str,
    kind: Kind,
    /// From the distribution to the displayed number.
    factor: f64,
    most_sd: f64,
}

/// How a clinic measures an unknown; `None` of one that it cannot measure.
pub(super) fn measurement(unknown: Unknown) -> Option<&'static str> {
    match unknown {
        Unknown::SkinStrainScale => Some(tr("the pull of the skin (Skin feels, pull…)")),
        Unknown::CoverThickness => Some(tr("the pinch, or the fat by ultrasound")),
        Unknown::SkinThickness => Some(tr("the thickness of the skin, by ultrasound")),
        Unknown::ChestRadius => Some(tr("the curvature of the chest")),
        Unknown::FillModulus => Some(tr("the fill, by its maker")),
        _ => None,
    }
}

/// The words of an unknown, a table.
pub(super) fn words(unknown: Unknown) -> Words {
    let of_plan = Words {
        name: "",
        tooltip: "",
        unit: "× the plan",
        kind: Kind::Plain,
        factor: 1.0,
        most_sd: 10.0,
    };
    match unknown {
        Unknown::SkinThickness => Words {
            name: tr("Thickness of the skin"),
            tooltip: tr("Thickness of the skin of the breast; it replaces the plan's"),
            unit: "mm",
            kind: Kind::Length,
            ..of_plan
        },
        Unknown::SkinStressScale => Words {
            name: tr("Stiffness of the skin"),
            tooltip: tr("All stresses of the skin, as a factor on the plan's"),
            ..of_plan
        },
        Unknown::SkinStrainScale => Words {
            name: tr("Laxity of the skin"),
            tooltip: tr(
                "How far the skin stretches before it stiffens: with a class or a pull a factor \
                      on the plan's, without them the scale itself",
            ),
            unit: "",
            ..of_plan
        },
        Unknown::FatModulus => Words {
            name: tr("Stiffness of the fat"),
            tooltip: tr("Initial modulus of the fat; it replaces the plan's"),
            unit: "kPa",
            kind: Kind::Stress,
            ..of_plan
        },
        Unknown::CoverThickness => Words {
            name: tr("Thickness of the fat"),
            tooltip: tr(
                "The pinch gives the cover within a factor 1.3; a factor on the plan's layers below the skin",
            ),
            ..of_plan
        },
        Unknown::PocketRadius => Words {
            name: tr("Margin of the pocket"),
            tooltip: tr("Difference of the pocket's radius from the plan"),
            unit: "mm, added",
            kind: Kind::Length,
            most_sd: 50.0,
            ..of_plan
        },
        Unknown::ChestRadius => Words {
            name: tr("Radius of the chest"),
            tooltip: tr(
                "Difference of the chest's radius of curvature from the plan: chests of people differ by 15 mm",
            ),
            unit: "mm, added",
            kind: Kind::Length,
            most_sd: 50.0,
            ..of_plan
        },
        Unknown::Projection => Words {
            name: tr("Projection in the body"),
            tooltip: tr("Difference of the implant's projection in the body from the catalogue"),
            unit: "%, added",
            kind: Kind::Percent,
            factor: 100.0,
            most_sd: 0.5,
        },
        Unknown::PoissonRatio => Words {
            name: tr("Poisson ratio"),
            tooltip: tr(
                "Poisson ratio of the skin and of all layers but fat as measured; 0.5: the volume of the tissue \
                      stays. It replaces the plan's",
            ),
            unit: "",
            kind: Kind::Fraction,
            ..of_plan
        },
        Unknown::FatStressScale => Words {
            name: tr("Stiffness of the fat"),
            tooltip: tr("All stresses of the fat, as a factor on the plan's"),
            ..of_plan
        },
        Unknown::NaturalTension => Words {
            name: tr("Tension of the skin"),
            tooltip: tr("Tension of the skin at rest, as a factor on the plan's"),
            ..of_plan
        },
        Unknown::Grown => Words {
            name: tr("Growth of the skin"),
            tooltip: tr("Difference of the skin's growth from the plan"),
            unit: "%, added",
            kind: Kind::Percent,
            factor: 100.0,
            most_sd: 1.0,
        },
        Unknown::FillModulus => Words {
            name: tr("Stiffness of the implant"),
            tooltip: tr("Moduli of gel and shell, as a factor on the plan's"),
            ..of_plan
        },
        Unknown::MuscleModulus => Words {
            name: tr("Stiffness of the muscle"),
            tooltip: tr("Initial modulus of the muscle at rest; it replaces the plan's"),
            unit: "kPa",
            kind: Kind::Stress,
            ..of_plan
        },
        Unknown::FatPoissonRatio => Words {
            name: tr("Poisson ratio of the fat"),
            tooltip: tr(
                "Poisson ratio of the fat; 0.5: the volume of the fat stays. It replaces the plan's",
            ),
            unit: "",
            kind: Kind::Fraction,
            ..of_plan
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Bands;

    #[test]
    fn untouched_choices_are_the_settings_of_the_study() {
        let scene = Scene::default();
        assert_eq!(Choices::default().settings(&scene), BandsSettings::default());
        for unknown in Unknown::ALL {
            let Some(spread) = unknown.spread(&scene) else { continue };
            let mut distribution = spread.distribution;
            for (_, _, value, (least, most)) in parts(unknown, &words(unknown), &mut distribution) {
                assert!((least..=most).contains(value), "{unknown:?}");
            }
        }
    }

    #[test]
    fn every_allowed_number_is_accepted_by_the_study() {
        let scene = Scene::opening();
        let mut choices = Choices::default();
        for is_least in [true, false] {
            for unknown in Unknown::ALL {
                let Some(spread) = unknown.spread(&scene) else { continue };
                let mut edited = spread.distribution;
                for (_, _, value, (least, most)) in parts(unknown, &words(unknown), &mut edited) {
                    *value = if is_least { least } else { most };
                }
                let edited = Some((spread.distribution, edited));
                choices.unknowns.insert(unknown, Choice { is_off: false, edited });
            }
            let settings = choices.settings(&scene);
            assert!(settings.unknowns.len() >= 7);
            assert_eq!(Bands::new(&scene, settings).err(), None);
        }
    }

    #[test]
    fn an_edit_belongs_to_its_own_kind_of_plan() {
        let (measured, mut unmeasured) = (Scene::opening(), Scene::opening());
        unmeasured.patient = None;
        unmeasured.layers[0].curve.strain_scale = 1.0;
        let usual = |scene: &Scene| Unknown::SkinStrainScale.spread(scene).unwrap().distribution;
        assert_ne!(usual(&measured), usual(&unmeasured));
        let edited = Distribution::LogNormal { median: 1.2, gsd: 1.5 };
        let mut choices = Choices::default();
        let choice = Choice { is_off: false, edited: Some((usual(&measured), edited)) };
        choices.unknowns.insert(Unknown::SkinStrainScale, choice);
        let of = |scene: &Scene| choices.settings(scene).unknowns.into_values().collect::<Vec<_>>();
        assert_eq!(of(&measured), [Some(edited)]);
        assert_eq!(of(&unmeasured), []);
    }
}
