//! What is varied among sampled patients: switches, spreads, refusals.

use super::uncertainty::{assert_cards, band, press, sampled, settings, study_of, wait};
use super::*;
use implant_preview::clinical::spread::Distribution;
use implant_preview::study::{Band, Quantity, Unknown};

#[test]
fn unknowns_are_switched_and_their_spread_is_edited() {
    let mut harness = sampled(WIDE);
    let scene = harness.state().session().scene().clone();
    let usual = study_of(&scene, settings()).bands();

    let mut without = settings();
    without.unknowns.insert(Unknown::PocketRadius, None);
    press(&mut harness, "Margin of the pocket");
    wait(&mut harness);
    let certain = study_of(&scene, without.clone()).bands();
    assert_cards(&harness, &certain);
    let width = |bands: &[Band]| {
        let band = band(bands, Quantity::GreatestStrain);
        band.p90 - band.p10
    };
    assert!(width(&certain) < 0.8 * width(&usual), "{} {}", width(&certain), width(&usual));
    let mean = "Margin of the pocket: mean";
    assert!(harness.query_by_role_and_label(Role::SpinButton, mean).is_none());

    type_into(&mut harness, "Thickness of the skin: standard deviation", "0,5 mm");
    wait(&mut harness);
    let mut edited = without;
    let wide = Distribution::Normal { mean: 1.55, sd: 0.5 };
    edited.unknowns.insert(Unknown::SkinThickness, Some(wide));
    assert_cards(&harness, &study_of(&scene, edited).bands());

    press(&mut harness, "Back to the usual spread");
    type_into(&mut harness, "Sampled patients", "16");
    wait(&mut harness);
    assert_cards(&harness, &usual);
}

#[test]
fn bad_numbers_of_a_spread_change_nothing_and_have_a_reason() {
    let mut harness = sampled(WIDE);
    let usual = study_of(harness.state().session().scene(), settings()).bands();
    for (field, text, reason) in [
        ("Thickness of the skin: mean", "thick", "Not accepted: “thick” is not a number"),
        ("Thickness of the skin: standard deviation", "-1", "Not accepted: at least 0 mm"),
        ("Stiffness of the skin: spread factor", "0.5", "Not accepted: at least 1"),
        ("Poisson ratio: least", "0.495", "Not accepted: at most 0.49"),
        ("Sampled patients", "3", "Not accepted: at least 16"),
        ("Seed", "-1", "Not accepted: at least 0"),
    ] {
        type_into(&mut harness, field, text);
        assert!(harness.query_all_by_label_contains(reason).count() > 0, "{field}: {reason}");
        harness.key_press(egui::Key::Escape);
        harness.run();
        assert!(harness.query_all_by_label_contains(reason).count() == 0, "{field}");
    }
    wait(&mut harness);
    assert_cards(&harness, &usual);
    // Without any unknown there is nothing to sample.
    for unknown in [
        "Thickness of the skin",
        "Stiffness of the skin",
        "Laxity of the skin",
        "Stiffness of the fat",
        "Thickness of the fat",
        "Margin of the pocket",
        "Projection in the body",
        "Poisson ratio",
        "Poisson ratio of the fat",
    ] {
        // By the keyboard: the restarted study above moves the switches.
        harness.get_by_label(unknown).focus();
        harness.run();
        harness.key_press(egui::Key::Space);
        harness.run();
    }
    (0..8).for_each(|_| harness.step());
    harness.get_by_label("Not accepted: no unknown is left; allowed: one unknown or more");
}
