//! The strain scale of a pull or a class of skin that is under tension at rest.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview_core::clinical::{
    GRIP_FORCE_N, GRIP_RADIUS_MM, Measurements, SKIN_THICKNESS_MM, SkinClass, pull_strain_scale,
    strain_scale_of_class, strain_scale_of_pull,
};
use implant_preview_core::curve::{Curve, CurveSpec};
use implant_preview_core::scene::Scene;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Strain of the skin of a strain scale under a line tension \[N/m\], by Newton's method on the curve.
fn strain(skin: &Curve, scale: f64, tension: f64) -> f64 {
    let stress = tension / SKIN_THICKNESS_MM;
    let mut x = 0.2;
    for _ in 0..60 {
        let slope = (skin.stress(x + 1e-6) - skin.stress(x - 1e-6)) / 2e-6;
        x = (x - (skin.stress(x) - stress) / slope).max(0.5 * x);
    }
    scale * x
}

/// The fibres of the lifted skin, each counted from its length without tension, are as long as the lifted cone.
#[test]
fn lifted_fibres_of_the_scale_are_as_long_as_the_cone() {
    let skin = Curve::new(&CurveSpec::Skin {}).unwrap();
    for (pull, width, tension) in
        [(30.0, 120.0, 20.0), (25.0, 110.0, 8.0), (40.0, 140.0, 15.0), (35.0, 120.0, 0.0)]
    {
        let scale = pull_strain_scale(pull, width, tension);
        let span = 0.5 * width - GRIP_RADIUS_MM;
        let cone = span.hypot(pull);
        let at_rest = if tension > 0.0 { strain(&skin, scale, tension) } else { 0.0 };
        let steps = 4000;
        let lifted: f64 = (0..steps)
            .map(|k| {
                let radius = GRIP_RADIUS_MM + span * (f64::from(k) + 0.5) / f64::from(steps);
                let pulled = 1e3 * GRIP_FORCE_N * cone / (2.0 * PI * radius * pull);
                (1.0 + strain(&skin, scale, pulled)) / (1.0 + at_rest) * span / f64::from(steps)
            })
            .sum();
        assert!((lifted / cone - 1.0).abs() < 1e-5, "{pull} {width} {tension}: {lifted} {cone}");
    }
}

#[test]
fn tension_makes_the_same_pull_a_laxer_skin_and_without_it_nothing_changes() {
    let scales = [0.0, 5.0, 10.0, 20.0].map(|tension| pull_strain_scale(30.0, 120.0, tension));
    eprintln!("{scales:.3?}");
    assert!(scales.windows(2).all(|pair| pair[1] > pair[0]), "{scales:?}");
    for class in [SkinClass::Tight, SkinClass::Normal, SkinClass::Lax, SkinClass::VeryLax] {
        let [none, some] =
            [0.0, 15.0].map(|tension| strain_scale_of_class(class, tension).unwrap());
        assert_eq!(none.value.to_bits(), class.strain_scale().to_bits());
        eprintln!("{class:?} {} {}", none.value, some.value);
        assert!(some.value > none.value && some.value < 3.0 * none.value, "{class:?}");
    }
    let error = strain_scale_of_pull(30.0, 120.0, 200.0).unwrap_err().to_string();
    assert_eq!(
        error,
        "skin pull 30 mm, base width 120 mm of skin under 200 N/m gives a strain scale of more than 20; allowed: 0.05 to 20"
    );
}

#[test]
fn a_new_plan_derives_its_scale_under_its_tension_and_an_old_one_keeps_its_own() {
    let measured = Measurements {
        base_width_mm: Some(120.0),
        skin_pull_mm: Some(30.0),
        ..Measurements::default()
    };
    let mut plan = Scene::opening();
    plan.apply_patient(measured).unwrap();
    let without = plan.layers[0].curve.strain_scale;
    assert_eq!(without.to_bits(), pull_strain_scale(30.0, 120.0, 0.0).to_bits());
    let mut old: Value = serde_json::from_str(&plan.to_json()).unwrap();
    old["skin_state"] = json!({ "natural_tension_n_per_m": 20 });
    let old = Scene::from_json(&old.to_string()).unwrap();
    assert_eq!(old.layers[0].curve.strain_scale.to_bits(), without.to_bits());

    let scale = |plan: &Scene| plan.layers[0].curve.strain_scale;
    plan.set_natural_tension(20.0).unwrap();
    assert_eq!(scale(&plan).to_bits(), pull_strain_scale(30.0, 120.0, 20.0).to_bits());
    assert!(plan.set_natural_tension(100.0).is_err() && scale(&plan) < 2.0);
    let mut old = old;
    old.set_natural_tension(10.0).unwrap();
    assert_eq!(scale(&old).to_bits(), pull_strain_scale(30.0, 120.0, 10.0).to_bits());
    plan.apply_patient(Measurements { skin_pull_mm: Some(31.0), ..measured }).unwrap();
    let value = plan
        .patient_values()
        .into_iter()
        .find(|value| value.field.ends_with("strain_scale"))
        .unwrap();
    assert!(!value.set_by_hand && value.value > 1.05 * pull_strain_scale(31.0, 120.0, 0.0));
}
