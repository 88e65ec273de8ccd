//! Scenes and results as they are read and written.

use super::*;

#[test]
fn results_add_cover_layers_skin_area_and_traction() {
    let outcome = simulate(&papers_fat(65)).unwrap();
    let cover = outcome.cover_mm.unwrap();
    // 6.1 mm of fat and skin of 1.5 mm, stretched 1.21-fold both ways.
    assert!((cover.apex - 7.2).abs() < 0.1 && cover.least <= cover.apex + 1e-3, "{cover:?}");
    let skin = outcome.skin_area.unwrap();
    assert!((skin.pocket_after_cm2 / skin.pocket_before_cm2 - 1.2454).abs() < 5e-3, "{skin:?}");
    let gained = skin.patch_after_cm2 - skin.patch_before_cm2;
    assert!(gained > skin.pocket_after_cm2 - skin.pocket_before_cm2, "{skin:?}");
    assert!((outcome.area_after_cm2.unwrap() - skin.pocket_after_cm2).abs() < 1e-9);
    let fat = &outcome.layers[1];
    // 6.1 mm at the apex, a little less beside it.
    assert!((fat.thickness_mm.unwrap().least - 6.0).abs() < 0.15, "{fat:?}");
    assert!(fat.max_stretch.unwrap() > 1.2);
    let traction = outcome.attachment_traction_kpa.unwrap();
    let at = traction.at_mm[0].hypot(traction.at_mm[1]);
    assert!(traction.max > 0.1 && (70.0..85.0).contains(&at), "{traction:?}");
    assert_eq!((outcome.profile.len(), outcome.profile_skin.len()), (41, 41));
    assert!((outcome.profile[40].s_mm - 70.0).abs() < 1e-9);
    assert!((outcome.profile_skin[40].s_mm - 130.0).abs() < 1e-9);
    assert_eq!(outcome.contact_angle_deg, None);
}

#[test]
fn a_scene_of_either_tissue_model_is_read_as_it_is_written() {
    let sheet = r#"{ "tissue_model": "sheet", "implant": { "base_radius_mm": 50 } }"#;
    let sheet = Scene::from_json(sheet).unwrap();
    let mut layered = sheet.clone();
    layered.set_tissue_model(TissueModel::Layered);
    for scene in [sheet, layered] {
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    }
}

#[test]
fn invalid_fields_of_layered_tissue_are_refused_in_one_line() {
    let refused = |fields: &str| {
        let scene = format!(r#"{{ "implant": {{ "base_radius_mm": 55 }}, {fields} }}"#);
        let error = Scene::from_json(&scene).unwrap_err().to_string();
        assert!(error.lines().count() == 1 && error.len() < 250, "{error}");
        error
    };
    assert!(refused(r#""springs": "nikolaev""#).contains("springs"));
    assert!(
        refused(r#""patch_radius_mm": 75"#)
            .contains("patch_radius_mm is 75; allowed: 90 to 260 mm")
    );
    assert!(refused(r#""attachment": { "stiffness_kpa_per_mm": 0 }"#).contains("0.1 to 50 kPa/mm"));
    assert!(refused(r#""attachment": { "ramp_mm": 41 }"#).contains("1 to 40 mm"));
    assert!(refused(r#""attachment": { "width": 1 }"#).contains("unknown field"));
    assert!(refused(r#""attachment": [2, 10]"#).contains("one JSON object"));
    assert!(refused(r#""tissue_model": "jelly""#).contains("layered"));
    assert!(refused(r#""solver": { "cells_through": 9 }"#).contains("1 to 8"));
    assert!(refused(r#""solver": { "cells_through": "many" }"#).contains("auto"));
}

#[test]
fn a_scene_without_schema_is_layered_tissue() {
    let least = r#"{ "implant": { "base_radius_mm": 55 } }"#;
    let scene = Scene::from_json(least).unwrap();
    assert_eq!(scene, Scene::default());
    let fat = &scene.layers[1];
    assert_eq!(fat.curve.spec, CurveSpec::Fat { variant: Fat::Mid });
    assert!((fat.poisson_ratio - 0.49).abs() < 1e-12);
    let body = scene.body;
    assert_eq!(body.tissue_model, TissueModel::Layered);
    assert!((body.patch_radius_mm - 130.0).abs() < 1e-12);
    assert!((body.attachment.stiffness_kpa_per_mm - 2.0).abs() < 1e-12);
    assert!((body.attachment.ramp_mm - 10.0).abs() < 1e-12);
    assert_eq!(scene.solver.cells_through.unwrap_or_default(), CellsThrough::Auto);
    let with_schema =
        r#"{ "schema": "implant-preview/scene/1", "implant": { "base_radius_mm": 55 } }"#;
    assert_eq!(Scene::from_json(with_schema).unwrap(), scene);
    let sheet = r#"{ "tissue_model": "sheet", "implant": { "base_radius_mm": 55 } }"#;
    let mut sheet = Scene::from_json(sheet).unwrap();
    assert_eq!((sheet.is_layered(), &sheet.layers), (false, &scene.layers));
    // The paper's sheet has its own fat.
    sheet.layers[1] = Layer::paper_adipose();
    assert_eq!(sheet, Scene::sheet());
}

#[test]
fn the_papers_springs_belong_to_a_sheet() {
    let with = |field: &str| {
        Scene::from_json(&format!(
            r#"{{ "implant": {{ "base_radius_mm": 55 }}, "springs": "nikolaev"{field} }}"#
        ))
    };
    let refused = "springs is nikolaev; allowed: coupled in layered tissue, the default; \
                   nikolaev with tissue_model sheet";
    for field in ["", r#", "tissue_model": "layered""#] {
        assert_eq!(with(field).unwrap_err().to_string(), refused);
    }
    assert_eq!(with(r#", "tissue_model": "sheet""#).unwrap().springs, Springs::Nikolaev);
    // A change of the springs or of the model keeps the scene valid.
    let mut scene = Scene::default();
    scene.set_springs(Springs::Nikolaev);
    assert!(!scene.is_layered() && scene.springs == Springs::Nikolaev);
    assert_eq!(scene.validate(), Ok(()));
    scene.set_springs(Springs::Coupled);
    assert!(!scene.is_layered());
    scene.set_springs(Springs::Nikolaev);
    scene.set_tissue_model(TissueModel::Layered);
    assert_eq!(scene, Scene::default());
}

#[test]
fn a_sheet_ignores_patch_attachment_and_cells() {
    let sheet = |fields: &str| {
        Scene::from_json(&format!(
            r#"{{ "tissue_model": "sheet",
                  "implant": {{ "base_radius_mm": 55 }}, {fields} }}"#
        ))
    };
    let mut scene = sheet(
        r#""patch_radius_mm": 70, "attachment": { "stiffness_kpa_per_mm": 0, "ramp_mm": 90 },
           "solver": { "cells_through": 20 }"#,
    )
    .unwrap();
    assert!(scene.same_physics(&sheet(r#""insertion": 1"#).unwrap()));
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    for (fields, wanted) in [
        (r#""patch_radius_mm": -1"#, "patch_radius_mm is -1; allowed: 0 mm or more"),
        (r#""attachment": { "ramp_mm": -1 }"#, "attachment.ramp_mm is -1; allowed: 0 mm or more"),
        (
            r#""attachment": { "stiffness_kpa_per_mm": -1 }"#,
            "attachment.stiffness_kpa_per_mm is -1; allowed: 0 kPa/mm or more",
        ),
    ] {
        assert_eq!(sheet(fields).unwrap_err().to_string(), wanted);
    }
    assert!(sheet(r#""patch_radius_mm": "wide""#).is_err());
    // The change to layered tissue moves the values into their limits.
    scene.set_tissue_model(TissueModel::Layered);
    assert_eq!(scene.validate(), Ok(()));
    let body = scene.body;
    assert_eq!((body.patch_radius_mm, body.attachment.ramp_mm), (90.0, 40.0));
    assert_eq!(scene.solver.cells_through, Some(CellsThrough::Count(8)));
    scene.solver.cells_through = Some(CellsThrough::Count(0));
    let error = scene.validate().unwrap_err().to_string();
    assert_eq!(error, "solver.cells_through is 0; allowed: \"auto\" or 1 to 8");
}

#[test]
fn a_record_of_layered_tissue_restores_its_solution() {
    let checked = CheckedScene::new(papers_fat(33)).unwrap();
    let simulation = run(&checked, Options::default(), None);
    let json = serde_json::to_string(&simulation.solution.record()).unwrap();
    let record = serde_json::from_str(&json).unwrap();
    let restored = implant_preview::solve::Solution::restore(checked.problem(), record).unwrap();
    assert_eq!(restored.faces(), simulation.solution.faces());
    assert_eq!(restored.faces().len(), 3);
    assert_eq!(restored.reactions().force, simulation.solution.reactions().force);
}
