//! The state of the skin as two choices: its tension at rest, and the time after the operation.

use crate::app::plan::{Hand, chip, chips};
use crate::app::texts::{fixed, tr};
use crate::app::widgets::{group, remark};
use crate::clinical::When;
use crate::scene::{Scene, SkinState};
use eframe::egui::Ui;

/// Natural tensions that the choice sets \[N/m\]: the first under which a measured pull has a strain scale.
const TENSIONS: [f64; 4] = [20.0, 15.0, 10.0, 5.0];

/// The skin before the operation: the words of a choice, and their names on chips.
pub(super) const AT_REST: [(&str, &str); 2] =
    [("without_tension", "Without tension"), ("under_tension", "Under tension")];
pub(super) const ABOUT_TENSION: &str = "20 N/m before the operation, or as much as the measured pull leaves: an assumption, no measurement of \
                 breast skin was found. The pull then counts under this tension.";

/// A time: its word in a form, its name and what it means.
pub(super) const TIMES: [(When, &str, &str, &str); 3] = [
    (
        When::OnTheTable,
        "on_the_table",
        "On the table",
        "Within the hour: nothing has relaxed or grown.",
    ),
    (
        When::Week,
        "week",
        "A week",
        "Half of the tension that the implant adds to the skin has relaxed, and 30 % of the skin's stretch has become growth: estimates, ± 10 and 20 points.",
    ),
    (
        When::SixMonths,
        "six_months",
        "Six months",
        "Half of the tension that the implant adds to the skin has relaxed, and 80 % of the skin's stretch has become growth: estimates, ± 10 and 20 points. \
         The fold is about 14 mm lower (14 women, Eder et al. 2011), which no picture shows.",
    ),
];

/// A natural tension and those of the choice below it, the greatest first \[N/m\].
pub(super) fn tensions_up_to(most: f64) -> impl Iterator<Item = f64> {
    let lower = TENSIONS.into_iter().chain([0.0]).filter(move |tension| *tension < most);
    std::iter::once(most).chain(lower)
}

/// Has the skin a tension at rest?
pub(super) fn is_tense(scene: &Scene) -> bool {
    scene.body.skin_state.natural_tension_n_per_m > 0.0
}

/// Gives the skin at rest the first tension that it may have, or none.
pub(super) fn set_tense(scene: &mut Scene, is_tense: bool) {
    // Without a tension every pull has a strain scale.
    let mut tensions = tensions_up_to(if is_tense { TENSIONS[0] } else { 0.0 });
    tensions.any(|tension| scene.set_natural_tension(tension).is_ok());
}

/// Shows the choices; nothing for a sheet.
pub(crate) fn show(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if !scene.is_layered() {
        return;
    }
    group(ui, tr("Skin at rest"), |ui| {
        let abouts = ["As if the skin were slack before the operation.", ABOUT_TENSION];
        chips(ui, |ui| {
            for (k, ((_, name), about)) in AT_REST.into_iter().zip(abouts).enumerate() {
                if chip(ui, hand, is_tense(scene) == (k == 1), tr(name), tr(about)) {
                    set_tense(scene, k == 1);
                }
            }
        });
        let tension = scene.body.skin_state.natural_tension_n_per_m;
        if tension > 0.0 {
            remark(ui, tr!("{tension} N/m before the operation", tension = fixed(tension, 0)));
        }
    });
    group(ui, tr("Time after the operation"), |ui| {
        let present = scene.when();
        chips(ui, |ui| {
            for (when, _, name, about) in TIMES {
                if chip(ui, hand, present == Some(when), tr(name), tr(about)) {
                    *scene = scene.at(when);
                }
            }
        });
    });
}

/// The name of a time.
pub(crate) fn name(when: When) -> &'static str {
    let found = TIMES.iter().find(|(time, ..)| *time == when);
    tr(found.map_or("", |(_, _, name, _)| name))
}

/// What of the skin's tension is left and how much of its stretch has grown, in words.
fn numbers(SkinState { relaxed, grown, .. }: SkinState) -> String {
    tr!(
        "{relaxed:.0} % of the tension left, {grown:.0} % grown",
        relaxed = 100.0 * relaxed,
        grown = 100.0 * grown
    )
}

/// The time of a plan within a sentence; `None` of skin without a state, whose plan is that on the table.
pub(crate) fn in_words(scene: &Scene) -> Option<String> {
    let state = scene.body.skin_state;
    has_state(scene).then(|| match scene.when() {
        Some(when) => tr(when.words()).to_owned(),
        None => numbers(state),
    })
}

/// Has the skin of a plan a tension at rest, or a time after the table?
pub(crate) fn has_state(scene: &Scene) -> bool {
    scene.is_layered() && scene.body.skin_state != SkinState::default()
}

/// The tension of the skin at rest in words.
pub(crate) fn tension_in_words(scene: &Scene) -> String {
    match scene.body.skin_state.natural_tension_n_per_m {
        tension if tension > 0.0 => format!("{} N/m", fixed(tension, 0)),
        _ => tr("without tension").to_owned(),
    }
}

/// The time after the operation in words, as a value.
pub(crate) fn time_in_words(scene: &Scene) -> String {
    scene.when().map_or_else(|| numbers(scene.body.skin_state), |when| name(when).to_owned())
}

/// The state of the skin in words, of skin that has one.
pub(super) fn rows(scene: &Scene) -> [Option<(&'static str, String)>; 2] {
    let is_later = scene.when() != Some(When::OnTheTable);
    [
        is_tense(scene).then(|| (tr("Skin at rest"), tension_in_words(scene))),
        is_later.then(|| (tr("Time after the operation"), time_in_words(scene))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_has_its_state_in_words_once_it_has_one() {
        let mut scene = Scene::opening();
        assert_eq!((rows(&scene), in_words(&scene)), ([None, None], None));
        scene.set_natural_tension(20.0).unwrap();
        assert_eq!(in_words(&scene).as_deref(), Some("on the table"));
        scene = scene.at(When::SixMonths);
        let [rest, time] = rows(&scene).map(|row| row.unwrap().1);
        assert_eq!([&*rest, &*time], ["20 N/m", "Six months"]);
        assert_eq!(in_words(&scene).as_deref(), Some("after six months"));
        scene.body.skin_state.grown = 0.5;
        assert_eq!(rows(&scene)[1].as_ref().unwrap().1, "50 % of the tension left, 50 % grown");
    }
}
