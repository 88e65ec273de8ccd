//! The patient of a scene: derived values, values set by hand, refusals.

use super::*;

fn read(scene: &Value) -> Scene {
    Scene::from_json(&scene.to_string()).unwrap()
}

fn error_of(scene: &Value) -> String {
    Scene::from_json(&scene.to_string()).unwrap_err().to_string()
}

fn with_patient(patient: &Value) -> Value {
    json!({ "implant": { "base_radius_mm": 60, "projection_mm": 40 }, "patient": patient })
}

/// The paths of the derived fields, and of those set by hand.
fn origins(scene: &Scene) -> (Vec<String>, Vec<String>) {
    let (by_hand, derived): (Vec<_>, Vec<_>) =
        scene.patient_values().into_iter().partition(|value| value.set_by_hand);
    let paths = |values: Vec<PatientValue>| values.into_iter().map(|value| value.field).collect();
    (paths(derived), paths(by_hand))
}

const SKIN: &str = "layers[0].thickness_mm";
const FAT: &str = "layers[1].thickness_mm";
const SCALE: &str = "layers[0].curve.strain_scale";

#[test]
fn absent_fields_are_derived_from_the_patient_and_listed() {
    let scene =
        read(&with_patient(&json!({ "base_width_mm": 120, "pinch_mm": 30, "skin_pull_mm": 30 })));
    assert_eq!((scene.layers[0].thickness_mm, scene.layers[1].thickness_mm), (1.5, 13.5));
    assert_eq!(scene.layers[0].curve.strain_scale, pull_strain_scale(30.0, 120.0, 0.0));
    assert_eq!(scene.patient.as_ref().unwrap().derived, [SKIN, FAT, SCALE]);
    assert_eq!(origins(&scene), (vec![SKIN.into(), FAT.into(), SCALE.into()], vec![]));
    // What is written is read back to the last bit.
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    // Without measurements nothing is derived.
    let none = read(&with_patient(&json!({})));
    assert_eq!((none.layers[1].thickness_mm, none.layers[0].curve.strain_scale), (10.0, 1.0));
    assert_eq!(origins(&none), (vec![], vec![]));
    assert_eq!(Scene::from_json(&none.to_json()).unwrap(), none);
    // A lax skin has the default scale, which is not written but listed.
    let lax = read(&with_patient(&json!({ "skin_class": "lax" })));
    assert_eq!(origins(&lax), (vec![SCALE.into()], vec![]));
    assert!(!lax.to_json().contains("strain_scale\":"));
    assert_eq!(Scene::from_json(&lax.to_json()).unwrap(), lax);
}

#[test]
fn a_number_of_the_file_stays_and_counts_as_set_by_hand() {
    let mut file = with_patient(&json!({ "pinch_mm": 20, "skin_class": "normal" }));
    file["layers"] = json!([{ "curve": { "kind": "skin", "strain_scale": 0.6 } },
        { "tissue": "adipose", "thickness_mm": 30, "curve": { "kind": "adipose" } }]);
    let scene = read(&file);
    assert_eq!((scene.layers[1].thickness_mm, scene.layers[0].curve.strain_scale), (30.0, 0.6));
    assert_eq!(origins(&scene), (vec![SKIN.into()], vec![FAT.into(), SCALE.into()]));
    // 0.6 lies within the range of the class, 30 mm does not lie within the range of the pinch.
    assert_eq!(
        scene.patient_warnings(),
        [
            "layers[1].thickness_mm is 30, set by hand; the measurement (pinch 20 mm) gives 8.5, 6.19 to 11.5 within one \
          standard deviation."
        ]
    );
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    // A scale of 1 set by hand stays although it is not written.
    file["layers"][0]["curve"]["strain_scale"] = json!(1);
    let scene = read(&file);
    assert_eq!(scene.layers[0].curve.strain_scale, 1.0);
    let again = Scene::from_json(&scene.to_json()).unwrap();
    assert_eq!((&again, origins(&again).1.len()), (&scene, 2));
}

#[test]
fn a_list_of_derived_fields_decides() {
    // With a list nothing is derived: the default thickness of 10 mm counts as set by hand.
    let scene = read(&with_patient(&json!({ "pinch_mm": 30, "derived": [SKIN, FAT] })));
    assert_eq!((scene.layers[0].thickness_mm, scene.layers[1].thickness_mm), (1.5, 10.0));
    assert_eq!(origins(&scene), (vec![SKIN.into()], vec![FAT.into()]));
    // A listed field with another number in the file keeps this number and leaves the list.
    let mut file = with_patient(&json!({ "pinch_mm": 30, "derived": [SKIN, FAT] }));
    file["layers"] = json!([{}, { "tissue": "adipose", "thickness_mm": 12 }]);
    let scene = read(&file);
    assert_eq!(scene.layers[1].thickness_mm, 12.0);
    assert_eq!(scene.patient.as_ref().unwrap().derived, [SKIN]);
    // A path that no measurement determines is dropped; an unknown path is an error.
    let scene = read(&with_patient(&json!({ "derived": ["layers[7].thickness_mm", SCALE] })));
    assert!(scene.patient.unwrap().derived.is_empty());
    for path in ["layers[8].thickness_mm", "insertion", "", "layers[0].curve"] {
        let error = error_of(&with_patient(&json!({ "derived": [FAT, path] })));
        assert_eq!(
            error,
            format!(
                "patient.derived[1] is {path}; allowed: layers[k].thickness_mm, layers[0].curve.strain_scale"
            )
        );
    }
}

#[test]
fn invalid_and_inconsistent_patients_are_rejected_in_one_line() {
    for (patient, wanted) in [
        (json!({ "pinch_mm": 2 }), "patient.pinch_mm: the pinch is 2 mm; allowed: 4 to 120 mm"),
        (
            json!({ "base_width_mm": 1e308 }),
            "patient.base_width_mm: the base width is 1e308 mm; allowed: 60 to 240 mm",
        ),
        (
            json!({ "skin_pull_mm": 0, "base_width_mm": 120 }),
            "patient.skin_pull_mm: the pull of the skin is 0 mm; allowed: 5 to 80 mm",
        ),
        (
            json!({ "skin_pull_mm": 30 }),
            "patient.skin_pull_mm: skin_pull_mm is given without base_width_mm; allowed: both, or skin_class",
        ),
        (
            json!({ "skin_pull_mm": 30, "skin_class": "lax", "base_width_mm": 120 }),
            "patient.skin_class: skin_pull_mm and skin_class are both given; allowed: one of them",
        ),
        (
            json!({ "skin_pull_mm": 10, "base_width_mm": 120 }),
            "patient.skin_pull_mm: skin pull 10 mm, base width 120 mm gives a strain scale of 0.0479; allowed: 0.05 to 20",
        ),
    ] {
        assert_eq!(error_of(&with_patient(&patient)), wanted);
    }
    for (patient, wanted) in [
        (json!({ "skin_class": "loose" }), "patient.skin_class: unknown variant `loose`"),
        (json!({ "pinch_mm": "20" }), "patient.pinch_mm: invalid type: string"),
        (
            json!({ "pinch_mm": null }),
            "patient.pinch_mm is null; allowed: 4 to 120 mm, or leave it out",
        ),
        (
            json!({ "fold_stretched_mm": 29 }),
            "patient.fold_stretched_mm: the nipple–fold distance is 29 mm; allowed: 30 to 200 mm",
        ),
        (json!({ "envelope_fill": "full" }), "patient.envelope_fill: unknown variant `full`"),
        (json!({ "pinch": 20 }), "patient.pinch: unknown field `pinch`"),
        (json!([20]), "patient: invalid type: sequence, expected one JSON object"),
        (json!({ "derived": vec![FAT; 17] }), "patient.derived: "),
        (json!({ "derived": "all" }), "patient.derived: invalid type: string"),
    ] {
        let error = error_of(&with_patient(&patient));
        assert!(error.starts_with(wanted), "{error}\nwanted: {wanted}");
        assert!(!error.contains('\n'));
    }
}

#[test]
fn what_the_practice_table_alone_needs_changes_no_other_value() {
    let known = json!({ "pinch_mm": 20, "skin_class": "normal" });
    let mut more = known.clone();
    more["fold_stretched_mm"] = json!(97.5);
    more["envelope_fill"] = json!("much");
    let (scene, same) = (read(&with_patient(&more)), read(&with_patient(&known)));
    let measured = scene.patient.as_ref().unwrap().measured;
    assert_eq!(measured.fold_stretched_mm, Some(97.5));
    assert!(scene.same_physics(&same) && same.patient.unwrap().measured.envelope_fill.is_none());
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    // 300 ml for 12 cm, 30 ml for the distance, 30 ml less for the full envelope.
    let volume = PracticeTable::default().volume(120.0, &measured).unwrap();
    assert_eq!((volume.corrections.len(), volume.volume_ml()), (2, 300.0));
}

#[test]
fn a_patient_is_applied_and_values_set_by_hand_stay() {
    let mut scene = Scene::default();
    let pinch = |mm: f64| Measurements { pinch_mm: Some(mm), ..Measurements::default() };
    // The first patient determines everything.
    scene.layers[1].thickness_mm = 25.0;
    scene.apply_patient(pinch(20.0)).unwrap();
    assert_eq!(scene.layers[1].thickness_mm, 8.5);
    assert_eq!(origins(&scene), (vec![SKIN.into(), FAT.into()], vec![]));
    // A change of the measurement changes what is derived and adds what it determines.
    let lax = Measurements { skin_class: Some(SkinClass::VeryLax), ..pinch(30.0) };
    scene.apply_patient(lax).unwrap();
    assert_eq!((scene.layers[1].thickness_mm, scene.layers[0].curve.strain_scale), (13.5, 1.7));
    // A value set by hand stays, also after the next measurement.
    scene.layers[1].thickness_mm = 12.0;
    assert_eq!(origins(&scene), (vec![SKIN.into(), SCALE.into()], vec![FAT.into()]));
    scene.apply_patient(pinch(40.0)).unwrap();
    assert_eq!(scene.layers[1].thickness_mm, 12.0);
    assert_eq!(origins(&scene), (vec![SKIN.into()], vec![FAT.into()]));
    // The scale of the class that is no longer given stays in the scene.
    assert_eq!(scene.layers[0].curve.strain_scale, 1.7);
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    // A scale of 1, set by hand after the derivation, is not written and stays 1.
    scene.apply_patient(lax).unwrap();
    scene.layers[0].curve.strain_scale = 1.0;
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap().layers, scene.layers);
    // An error changes nothing.
    let before = scene.clone();
    let error = scene.apply_patient(pinch(1.0)).unwrap_err().to_string();
    assert_eq!(error, "patient.pinch_mm: the pinch is 1 mm; allowed: 4 to 120 mm");
    assert_eq!(scene, before);
    // Without its patient the scene starts again.
    scene.patient = None;
    scene.apply_patient(pinch(40.0)).unwrap();
    assert_eq!(scene.layers[1].thickness_mm, 18.5);
    assert!(scene.same_physics(&Scene { patient: None, ..scene.clone() }));
}

#[test]
fn measurements_without_effect_are_warnings() {
    let mut scene = Scene::default();
    scene.layers[1].tissue = "fat".to_owned();
    scene.layers[0].curve.spec = implant_preview::curve::CurveSpec::Linear { modulus_kpa: 50.0 };
    let measured = Measurements {
        base_width_mm: Some(100.0),
        pinch_mm: Some(20.0),
        skin_pull_mm: Some(30.0),
        ..Measurements::default()
    };
    scene.apply_patient(measured).unwrap();
    assert_eq!(origins(&scene), (vec![SKIN.into()], vec![]));
    let warnings = scene.patient_warnings();
    assert_eq!(warnings.len(), 3, "{warnings:#?}");
    assert!(warnings[0].contains("no layer named adipose"));
    assert!(warnings[1].contains("not the skin preset"));
    assert_eq!(
        warnings[2],
        "The implant's base of 11 cm is wider than the breast's base of 10 cm."
    );
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
}

#[test]
fn the_schema_contains_patient_and_scales() {
    let schema: Value = serde_json::from_str(&scene::schema()).unwrap();
    let patient = &schema["$defs"]["Patient"]["properties"];
    for field in [
        "base_width_mm",
        "pinch_mm",
        "skin_pull_mm",
        "skin_class",
        "fold_stretched_mm",
        "envelope_fill",
        "derived",
    ] {
        assert!(patient[field].is_object(), "{field}: {schema:#}");
    }
    let kinds = schema["$defs"]["Curve"]["oneOf"].as_array().unwrap();
    assert_eq!(kinds.len(), 8);
    for kind in kinds {
        assert_eq!(kind["properties"]["strain_scale"]["maximum"], 20.0);
        assert_eq!(kind["properties"]["stress_scale"]["minimum"], 0.05);
        assert_eq!(kind["additionalProperties"], false);
    }
}

#[test]
fn results_list_the_values_of_the_patient() {
    let mut file = with_patient(&json!({ "pinch_mm": 20, "skin_class": "tight" }));
    file["solver"] = json!({ "nodes_per_side": 33 });
    let outcome = simulate(&read(&file)).unwrap();
    let json = serde_json::to_value(&outcome).unwrap();
    assert_eq!(
        json["patient_values"][2],
        json!({ "field": SCALE, "value": 0.25, "set_by_hand": false, "measured": "skin class tight",
            "derived": 0.25, "range": [0.125, 0.5] })
    );
    // Tight skin is stretched beyond its data, which end at a quarter of the preset's strain.
    let greatest = outcome.strain.as_ref().unwrap().max_principal;
    assert_eq!(outcome.layers[0].beyond_curve_data, greatest > 0.25, "{greatest}");
    let mut lax = file.clone();
    lax["patient"]["skin_class"] = json!("lax");
    let lax = simulate(&read(&lax)).unwrap();
    assert!(lax.contact_force_n < outcome.contact_force_n);
    let none = simulate(&read(&json!({ "implant": { "base_radius_mm": 60, "projection_mm": 40 },
        "solver": { "nodes_per_side": 33 } })))
    .unwrap();
    assert!(serde_json::to_value(&none).unwrap().get("patient_values").is_none());
}

#[test]
fn the_opening_plan_is_usual_and_all_its_tissue_is_derived() {
    let scene = Scene::opening();
    assert_eq!(scene.validate(), Ok(()));
    assert_eq!(Scene::from_json(&scene.to_json()).as_ref(), Ok(&scene));
    let implant = scene.implant;
    let size =
        Size::of_width_and_projection(2.0 * implant.base_radius_mm, implant.projection_mm).unwrap();
    assert!((size.base_width_mm() - 120.0).abs() < 1e-9 && (size.volume_ml() - 225.0).abs() < 1e-9);
    assert!(size.is_typical());
    assert_eq!(scene.chest, Some(ChestShape::USUAL));
    assert!((scene.room_mm() - 10.0).abs() < 1e-12);
    let values = scene.patient_values();
    let derived: Vec<f64> = values.iter().map(|value| value.value).collect();
    assert_eq!(derived, [1.5, 8.5, 0.5]);
    assert!(values.iter().all(|value| !value.set_by_hand));
    // The defaults of files are not those of the app.
    assert_eq!(Scene::from_json(r#"{"implant":{"base_radius_mm":55}}"#), Ok(Scene::default()));
}
