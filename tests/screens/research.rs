//! The switch "Research": what a surgeon never needs is in sight with the switch alone, or while it is in use.

use super::*;
use egui_kittest::kittest::By;

/// The opening plan with its own accuracy.
fn opening(scene: &mut Scene) {
    *scene = Scene::opening();
}

/// Accessible names and painted texts of a screen.
fn words(harness: &Harness<'static, App>) -> Vec<String> {
    let everything = By::new().predicate(|_| true).recursive(true);
    let named = harness.query_all(everything).flat_map(|node| {
        let node = node.accesskit_node();
        [node.label(), node.value()].into_iter().flatten()
    });
    named.chain(painted_texts(harness)).collect()
}

/// Is a control or a text in sight?
fn has(harness: &Harness<'static, App>, label: &str) -> bool {
    words(harness).iter().any(|words| words == label)
}

/// The names for research on the first screen.
const FIRST: [&str; 7] = [
    "Let the width follow",
    "Let the volume follow",
    "Let the projection follow",
    "Half sphere",
    "standard model, normal accuracy",
    "Advanced",
    "Nikolaev 2013",
];

#[test]
fn what_research_needs_is_behind_its_switch() {
    let mut harness = app(WIDE, opening);
    let folds = ["Tissue", "Details"];
    folds.iter().for_each(|fold| unfold(&mut harness, fold));
    let in_details = ["Force, vertical", "Pull at the pocket's edge", "Greatest stress, skin"];
    let range = ["Across", "Upwards", "Points", "Upwards, to"];
    let shapes = ["Tissue as OBJ", "Tissue as PLY"];
    let commands = ["Save numbers (JSON)…", "Save profile (CSV)…", "Half sphere of 11 cm"];
    let check = |harness: &mut Harness<'static, App>, is_on: bool| {
        for label in FIRST.iter().chain(&in_details) {
            assert_eq!(has(harness, label), is_on, "{label}");
        }
        let has_sentence = words(harness).iter().any(|words| words.starts_with("225 ml, 12 cm: "));
        assert_eq!(has_sentence, is_on);
        press(harness, "File");
        for label in commands {
            assert_eq!(has(harness, label), is_on, "{label}");
        }
        press(harness, "Save shape (3-D)");
        for label in shapes {
            assert_eq!(has(harness, label), is_on, "{label}");
        }
        assert!(has(harness, "Tissue as STL") && has(harness, "Tissue as GLB"));
        harness.key_press(egui::Key::Escape);
        harness.run();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
        harness.run();
        for label in commands.iter().chain(&["Grid", "Skin area 3", "Stress of the skin 4"]) {
            assert_eq!(has(harness, label), is_on, "{label}");
        }
        harness.key_press(egui::Key::Escape);
        harness.run();
        press(harness, "Range of implants");
        harness.run();
        for label in range {
            assert_eq!(has(harness, label), is_on, "{label}");
        }
        press(harness, "Picture");
        harness.run();
    };
    check(&mut harness, false);
    for is_on in [true, false] {
        press(&mut harness, "View");
        harness.get_by_role_and_label(Role::CheckBox, "Research").click();
        harness.run();
        if is_on {
            unfold(&mut harness, "Advanced");
            check(&mut harness, is_on);
        }
    }
    assert!(FIRST.iter().all(|label| !has(&harness, label)));
}

#[test]
fn what_differs_from_its_default_stays_in_sight() {
    let mut harness = app(WIDE, |scene| {
        opening(scene);
        scene.solver.nodes_per_side = 33;
    });
    for label in ["33 nodes per side", "Advanced"] {
        assert!(has(&harness, label), "{label}");
    }
    unfold(&mut harness, "Advanced");
    assert!(has(&harness, "Fast") && !has(&harness, "Tissue model"));
    press(&mut harness, "Normal");
    settle(&mut harness);
    assert!(!has(&harness, "Advanced"));
    // A half sphere by its projection.
    type_into(&mut harness, "Projection (cm)", "6");
    assert!(has(&harness, "Half sphere"));
}

#[test]
fn the_switch_is_kept_and_a_file_does_not_change_it() {
    let mut harness = app(DESKTOP, opening);
    assert_eq!(harness.state_mut().take_research_to_store(), None);
    press(&mut harness, "View");
    harness.get_by_role_and_label(Role::CheckBox, "Research").click();
    harness.run();
    let kept = harness.state_mut().take_research_to_store();
    assert_eq!(harness.state_mut().take_research_to_store(), None);
    let mut next = app(DESKTOP, opening);
    next.state_mut().restore_research(kept.as_deref());
    next.run();
    assert!(has(&next, "Let the width follow"));
    next.state_mut().open(flat_plan().to_json()).unwrap();
    settle(&mut next);
    assert!(has(&next, "Let the width follow"));
}

#[test]
fn the_last_two_sizes_stay_without_locks() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let sizes = |harness: &Harness<'static, App>| -> [f64; 3] {
        let size = harness.state().session().scene().implant.size().unwrap();
        [0.1 * size.base_width_mm(), size.volume_ml(), size.projection_cm()]
    };
    let typed = [("Volume (ml)", 350.0, 1), ("Projection (cm)", 4.5, 2), ("Width (cm)", 12.5, 0)];
    let mut last: Option<usize> = None;
    for (field, value, place) in typed {
        let before = sizes(&harness);
        type_into(&mut harness, field, &value.to_string());
        let after = sizes(&harness);
        assert!((after[place] - value).abs() < 1e-6, "{field}: {after:?}");
        if let Some(last) = last {
            assert!((after[last] - before[last]).abs() < 1e-6, "{field}: {before:?} {after:?}");
        }
        last = Some(place);
    }
    harness.get_by_label("Volume follows width and projection.");
}

/// Controls and texts of a screen: what has a name, and what is painted.
fn count(harness: &Harness<'static, App>) -> [usize; 2] {
    let everything = By::new().predicate(|_| true).recursive(true);
    let is_control = |role: Role| {
        [
            Role::Button,
            Role::CheckBox,
            Role::ComboBox,
            Role::Slider,
            Role::SpinButton,
            Role::TextInput,
            Role::DisclosureTriangle,
            Role::Link,
        ]
        .contains(&role)
    };
    let controls = harness.query_all(everything).filter(|n| is_control(n.accesskit_node().role()));
    [controls.count(), painted_texts(harness).len()]
}

#[test]
fn the_first_screen_has_fewer_controls_and_texts_than_with_research() {
    let mut harness = app(DESKTOP, opening);
    let [controls, texts] = count(&harness);
    harness.state_mut().restore_research(Some("on"));
    harness.run();
    let [more_controls, more_texts] = count(&harness);
    println!("{controls} controls, {texts} texts; {more_controls}, {more_texts} with research");
    assert!(controls + 5 < more_controls && texts < more_texts);
    assert!(controls <= 55, "{controls} controls");
}
