//! The tissue of the plan: layers, its model, its law, the springs of the paper.

use super::*;
use implant_preview::clinical::SkinClass;
use implant_preview::scene::Plane;

#[test]
fn layers_are_added_exchanged_and_removed() {
    let mut harness = unfolded(|_| {});
    let tissues = |harness: &Harness<'static, App>| -> Vec<String> {
        harness.state().session().scene().layers.iter().map(|l| l.tissue.clone()).collect()
    };
    harness.get_by_role_and_label(Role::Button, "Move inward layer 1").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["adipose", "skin"]);
    harness.get_by_role_and_label(Role::Button, "Add fat").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["adipose", "skin", "adipose"]);
    harness.get_by_role_and_label(Role::Button, "Remove layer 1").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["skin", "adipose"]);
    assert_eq!(harness.state().outcome().unwrap().layers.len(), 2);
}

#[test]
fn the_tissue_model_is_chosen_and_layered_tissue_adds_its_controls_and_readings() {
    let mut harness = unfolded(|_| {});
    let choose = |harness: &mut Harness<'static, App>, model: &'static str| {
        harness.get_by_role_and_label(Role::ComboBox, "Tissue model").click();
        harness.run();
        harness.get_by_label(model).click();
        settle(harness);
    };
    assert!(harness.state().session().scene().is_layered());
    let layered = force(&harness);
    choose(&mut harness, "One sheet");
    assert!(harness.query_by_label("Cover over the apex").is_none());
    let sheet = force(&harness);
    // A sheet is nearly twice as stiff.
    assert!(layered < 0.6 * sheet, "{layered} of {sheet}");
    choose(&mut harness, "Skin on solid layers");
    assert!(harness.state().session().scene().is_layered());
    assert!((force(&harness) - layered).abs() < 1e-9);
    for name in ["Cover over the apex", "Least cover", "Pull at the pocket's edge"] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
    let stiffness = "Attachment stiffness (kPa/mm)";
    for name in ["Computed radius (mm)", stiffness, "Attachment ramp (mm)"] {
        assert!(harness.query_by_role_and_label(Role::Slider, name).is_some(), "{name}");
    }
    type_into(&mut harness, stiffness, "5");
    let attachment = harness.state().session().scene().body.attachment;
    assert!((attachment.stiffness_kpa_per_mm - 5.0).abs() < 1e-12);
    choose(&mut harness, "One sheet");
    assert!((force(&harness) - sheet).abs() < 1e-9);
    assert!(harness.query_by_role_and_label(Role::Slider, stiffness).is_none());
}

#[test]
fn the_papers_springs_are_chosen_with_their_tissue_model_in_one_step() {
    let mut harness = unfolded(|_| {});
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let before = scene(&harness);
    harness.get_by_role_and_label(Role::ComboBox, "Law of the tissue").click();
    harness.run();
    harness.get_by_label("Nikolaev 2013, in one sheet").click();
    settle(&mut harness);
    assert_eq!((scene(&harness).springs, scene(&harness).is_layered()), (Springs::Nikolaev, false));
    // The other model has the coupled springs.
    harness.get_by_role_and_label(Role::ComboBox, "Tissue model").click();
    harness.run();
    harness.get_by_label("Skin on solid layers").click();
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    for is_layered in [false, true] {
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
        assert_eq!(scene(&harness).is_layered(), is_layered);
    }
    assert!(!harness.state().session().can_undo());
}

#[test]
fn the_computed_radius_follows_the_pocket_until_set() {
    let mut harness = unfolded(|_| {});
    let patch =
        |harness: &Harness<'static, App>| harness.state().session().scene().body.patch_radius_mm;
    type_into(&mut harness, "Margin (cm)", "2.5");
    assert!((patch(&harness) - 140.0).abs() < 1e-9);
    type_into(&mut harness, "Computed radius (mm)", "120");
    type_into(&mut harness, "Margin (cm)", "15 mm");
    assert!((patch(&harness) - 120.0).abs() < 1e-9);
}

#[test]
fn springs_without_a_stable_shape_are_reported_and_coupled_springs_offered() {
    let mut harness = app(WIDE, |scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.layers = vec![implant_preview::scene::Layer::paper_adipose()];
    });
    assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
    assert!(harness.get_all_by_label("No answer").count() > 0);
    harness.get_by_role_and_label(Role::Button, "Use the standard model").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
}

#[test]
fn the_papers_springs_are_marked_before_the_solve() {
    // The first frame of a fine grid is drawn before the solve ends.
    let mut scene = Scene { springs: Springs::Nikolaev, ..Scene::sheet() };
    scene.solver.nodes_per_side = 1025;
    let app = App::new(&egui::Context::default(), None, scene, beside_window).unwrap();
    let mut harness = window(WIDE, 1, app);
    harness.get_by_label("Advanced").click();
    (0..8).for_each(|_| harness.step());
    assert!(harness.state().session().is_working(), "solved already: the test shows nothing");
    harness.get_by_label("The 2013 model breaks down, first at 23 % stretch");
    harness.get_by_label("Uniaxial stretch: unstable at 23–42 %");
    harness.get_by_label("Equibiaxial stretch: unstable at 33–41 %");
    harness.get_by_role_and_label(Role::Button, "Use the standard model").click();
    for _ in 0..4 {
        harness.step();
    }
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.query_all_by_label_contains("breaks down").count(), 0);
}

#[test]
fn the_mark_of_the_papers_springs_is_computed_once_per_stack_of_layers() {
    let mut harness = unfolded(|scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.layers[1] = implant_preview::scene::Layer::paper_adipose();
    });
    let asked =
        |harness: &Harness<'static, App>| harness.state().session().counters().stability_limits;
    assert_eq!(asked(&harness), 1);
    focus_picture(&mut harness);
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert_eq!(asked(&harness), 1);
    harness.get_by_role_and_label(Role::Button, "Remove layer 1").click();
    settle(&mut harness);
    assert_eq!(asked(&harness), 2);
    harness.get_by_label("Uniaxial stretch: unstable from 11 %");
}

#[test]
fn layers_that_stay_stable_under_the_papers_springs_are_reported() {
    let harness = unfolded(|scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.insertion = 0.2;
        scene.layers.truncate(1);
        scene.layers[0].poisson_ratio = 0.3;
    });
    harness.get_by_label_contains("stable at all strains up to 100 %");
    let offers = harness.query_all_by_label("Use the standard model");
    assert_eq!(offers.count(), 0);
}

#[test]
fn fluid_beside_the_implant_is_limited_by_a_chip_and_a_number_and_freed_again() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    unfold(&mut harness, "Details");
    press(&mut harness, "Pin as A");
    let result = |harness: &Harness<'static, App>| {
        let outcome = harness.state().outcome().unwrap();
        (outcome.void_ml.unwrap(), outcome.contact_force_n.unwrap())
    };
    let (free, force) = result(&harness);
    assert!(free > 15.0 && harness.query_by_label("Suction of the void").is_none(), "{free}");
    assert!(harness.query_by_role_and_label(Role::SpinButton, "Fluid (ml)").is_none());
    press(&mut harness, "Limited");
    let (limited, greater) = result(&harness);
    assert!((limited - 10.0).abs() < 0.1 && greater > force, "{limited} {greater} {force}");
    assert!(harness.query_by_label("Suction of the void").is_some());
    let differs = "Fluid in the pocket: this plan 10 ml at most; A not limited";
    assert!(text_with(&harness, differs).is_some());
    type_into(&mut harness, "Fluid (ml)", "12");
    assert_eq!(harness.state().session().scene().body.pocket_void_ml, Some(12.0));
    let (wider, less) = result(&harness);
    assert!((wider - 12.0).abs() < 0.12 && less < greater, "{wider} {less} {greater}");
    // Not a matter of another model.
    unfold(&mut harness, "Advanced");
    assert!(harness.query_by_role_and_label(Role::ComboBox, "Resolution").is_some());
    assert!(harness.query_by_role_and_label(Role::ComboBox, "Tissue model").is_none());
    press(&mut harness, "Not limited");
    assert_eq!(harness.state().session().scene().body.pocket_void_ml, None);
    assert!((result(&harness).1 - force).abs() < 1e-9);
}

/// The contact force of the plan \[N\].
fn force(harness: &Harness<'static, App>) -> f64 {
    harness.state().outcome().unwrap().contact_force_n.unwrap()
}

#[test]
fn a_posture_is_a_choice_in_which_the_implant_bears_more() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    press(&mut harness, "Pin as A");
    let before = force(&harness);
    press(&mut harness, "Lying");
    assert!(force(&harness) > before, "{} {before}", force(&harness));
    assert!(text_with(&harness, "Posture: this plan lying; A as measured").is_some());
    press(&mut harness, "As measured");
    assert!((force(&harness) - before).abs() < 1e-9);
}

#[test]
fn a_new_fold_is_a_number_of_the_plan_that_eases_the_tissue() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    press(&mut harness, "Pin as A");
    let before = force(&harness);
    type_into(&mut harness, "New fold lower (cm)", "1.4");
    assert_eq!(harness.state().session().scene().body.pocket_lowered_mm, 14.0);
    assert!(force(&harness) < 0.95 * before, "{} {before}", force(&harness));
    assert!(text_with(&harness, "New fold lower, cm: this plan 1.4; A 0.0").is_some());
    type_into(&mut harness, "New fold lower (cm)", "5");
    assert!(text_with(&harness, "Not accepted: at most 4 cm").is_some());
    press(&mut harness, "Undo");
    assert!((force(&harness) - before).abs() < 1e-9);
}

#[test]
fn below_the_muscle_the_card_of_the_cover_has_it_with_and_without_the_muscle() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    let without = "without the muscle ";
    let least = |harness: &Harness<'static, App>| {
        harness.state().outcome().unwrap().cover_mm.as_ref().unwrap().least
    };
    let above = least(&harness);
    assert!(text_with(&harness, without).is_none());
    press(&mut harness, "Below");
    settle(&mut harness);
    let scene = harness.state().session().scene();
    assert_eq!((scene.layers.len(), scene.body.plane), (3, Some(Plane::Below)));
    assert!(least(&harness) > above + 5.0, "{} {above}", least(&harness));
    let words = text_with(&harness, without).unwrap();
    let figure = words.trim_start_matches(without).split(' ').next().unwrap();
    // The fat and the skin are about as thick as without a muscle.
    let figure: f64 = figure.parse().unwrap();
    assert!((figure - above).abs() < 1.0, "{words} {above}");
    // In a dual plane the lower pole has none, so that the least cover is that of fat and skin.
    press(&mut harness, "III");
    settle(&mut harness);
    assert!((least(&harness) - above).abs() < 1.0, "{}", least(&harness));
    assert!(text_with(&harness, without).is_some());
    press(&mut harness, "Above");
    settle(&mut harness);
    assert_eq!(harness.state().session().scene().layers.len(), 2);
    assert!((least(&harness) - above).abs() < 1e-9);
    assert!(text_with(&harness, without).is_none());
}

#[test]
fn a_class_of_skin_and_a_tension_meet_at_what_the_skin_bears_in_either_order() {
    for order in [["Under tension", "very lax"], ["very lax", "Under tension"]] {
        let mut harness = app(WIDE, |scene| *scene = flat_plan());
        unfold(&mut harness, "Tissue");
        for button in order {
            press(&mut harness, button);
        }
        let scene = harness.state().session().scene();
        let tension = scene.body.skin_state.natural_tension_n_per_m;
        assert!((5.0..20.0).contains(&tension), "{order:?}: {tension}");
        assert_eq!(scene.measured().skin_class, Some(SkinClass::VeryLax));
        assert!(text_with(&harness, "than before the operation").is_some());
    }
}
