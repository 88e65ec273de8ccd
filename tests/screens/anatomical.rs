//! An anatomical implant in the plan: its shape, height and apex, the words about it, a phone.

use super::*;

/// The flat plan on the coarsest grid.
fn coarse(scene: &mut Scene) {
    *scene = flat_plan();
    scene.solver.nodes_per_side = 17;
    scene.solver.tolerance = 1e-3;
}

fn implant(harness: &Harness<'static, App>) -> implant_preview::scene::Implant {
    harness.state().session().scene().implant
}

fn choose(harness: &mut Harness<'static, App>, shape: &'static str) {
    press(harness, shape);
    settle(harness);
}

#[test]
fn the_fullness_moves_the_volume_and_any_two_sizes_give_the_third_with_it() {
    let mut harness = unfolded(coarse);
    let size = |harness: &Harness<'static, App>| implant(harness).size().unwrap();
    let before = size(&harness);
    type_into(&mut harness, "Fullness", "0,75");
    let full = size(&harness);
    assert_eq!(implant(&harness).fullness, Some(0.75));
    let (width, projection) = (full.base_width_mm(), full.projection_mm());
    assert!(
        (width - before.base_width_mm()).abs() + (projection - before.projection_mm()).abs() < 1e-9
    );
    assert!((full.volume_ml() / before.volume_ml() - 0.75 * 1.5).abs() < 1e-9);
    type_into(&mut harness, "Volume (ml)", "300");
    let other = size(&harness);
    assert!((other.fullness() - 0.75).abs() < 1e-9 && (other.volume_ml() - 300.0).abs() < 1e-9);
    assert!((other.base_width_mm() - width).abs() < 1e-9 && other.projection_mm() < projection);
    // Out of its limits.
    type_into(&mut harness, "Fullness", "0,9");
    assert_eq!(implant(&harness).fullness, Some(0.75));
    // An expander's shell is half of an ellipsoid at every fill.
    choose(&mut harness, "expander");
    assert_eq!(implant(&harness).fullness, None);
    assert!((size(&harness).volume_ml() - 300.0).abs() < 1e-9);
    assert_eq!(harness.query_all_by_label("Fullness").count(), 0);
}

#[test]
fn an_anatomical_implant_has_a_height_and_an_apex_and_a_round_one_loses_both() {
    let mut harness = app(DESKTOP, coarse);
    let fields = ["Height (cm)", "Apex lower (cm)"];
    let volume =
        |harness: &Harness<'static, App>| implant(harness).size().unwrap().volume_ml().round();
    let (before, ml) = (implant(&harness), volume(&harness));
    choose(&mut harness, "anatomical");
    for field in fields {
        harness.get_by_role_and_label(Role::Slider, field);
    }
    let shape = |harness: &Harness<'static, App>| {
        let implant = implant(harness);
        (implant.base_height_mm, implant.apex_shift_mm)
    };
    assert_eq!((shape(&harness), volume(&harness)), ((Some(108.0), 11.0), ml));
    type_into(&mut harness, "Height (cm)", "13,5");
    type_into(&mut harness, "Apex lower (cm)", "2");
    assert_eq!((shape(&harness), volume(&harness)), ((Some(135.0), 20.0), ml));
    // Beyond the base, beyond twice the width.
    type_into(&mut harness, "Apex lower (cm)", "5");
    type_into(&mut harness, "Height (cm)", "24,1");
    assert_eq!(shape(&harness), (Some(135.0), 20.0));
    // A wider base keeps its proportions.
    type_into(&mut harness, "Width (cm)", "11");
    let (height, way) = shape(&harness);
    assert!((height.unwrap() - 123.75).abs() < 1e-9 && (way - 55.0 / 3.0).abs() < 1e-9);
    // A height equal to the width keeps its row.
    type_into(&mut harness, "Height (cm)", "11");
    harness.get_by_role_and_label(Role::Slider, "Height (cm)");
    choose(&mut harness, "round");
    assert_eq!((shape(&harness), volume(&harness)), ((None, 0.0), ml));
    assert!(fields.iter().all(|field| harness.query_all_by_label(field).count() == 0));
    choose(&mut harness, "anatomical");
    choose(&mut harness, "expander");
    assert!(implant(&harness).is_round() && volume(&harness) == ml);
    assert!(before.is_round());
}

#[test]
fn headline_and_summary_name_the_height() {
    let mut harness = researching(DESKTOP, coarse);
    choose(&mut harness, "anatomical");
    let summary = harness.state().summary();
    assert!(summary.starts_with("300 ml implant, 12 × 10.8 cm wide and high."), "{summary}");
    let texts = painted_texts(&harness);
    assert!(texts.iter().any(|text| text.contains("300 ml, 12 × 10.8 cm: ")), "{texts:?}");
}

#[test]
fn an_anatomical_implant_fits_on_a_phone() {
    let mut harness = app(PHONE, coarse);
    choose(&mut harness, "anatomical");
    for field in ["Height (cm)", "Apex lower (cm)"] {
        let at = harness.get_by_role_and_label(Role::SpinButton, field).rect();
        assert!(at.left() >= 0.0 && at.right() <= PHONE.x, "{field}: {at:?}");
    }
    for chip in ["round", "anatomical", "expander"] {
        let at = harness.get_by_role_and_label(Role::Button, chip).rect();
        assert!(at.left() >= 0.0 && at.right() <= PHONE.x, "{chip}: {at:?}");
    }
    assert_eq!(cut_texts(&harness), Vec::<String>::new());
}
