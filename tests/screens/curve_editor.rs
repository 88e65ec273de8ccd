//! The points of a measured curve: typed, pasted, dropped as a tensile test.

use super::*;

#[test]
fn the_last_point_of_a_measured_curve_can_be_entered() {
    let mut harness = unfolded(|scene| {
        scene.layers[0].curve = CurveSpec::Points {
            points: vec![[0.0, 0.0], [0.4, 100.0], [1.0, 500.0]],
            interpolation: Interpolation::Line,
        }
        .into();
    });
    let points = |harness: &Harness<'static, App>| match &harness.state().session().scene().layers
        [0]
    .curve
    .spec
    {
        CurveSpec::Points { points, .. } => points.clone(),
        other => panic!("{other:?}"),
    };
    harness.get_by_role_and_label(Role::Button, "Edit points").click();
    harness.run();
    let apply = |harness: &mut Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Button, "Apply the curve").click();
        settle(harness);
    };
    type_into(&mut harness, "Strain of point 3", "0,5");
    // The layer takes the points on request only.
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [1.0, 500.0]]);
    type_into(&mut harness, "Stress of point 3", "220");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]);
    // Points out of order are reported; nothing is stored or clamped.
    type_into(&mut harness, "Stress of point 3", "90");
    harness.get_by_label_contains("must be greater than that of point 2 (100 kPa)");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]);
    // The points of such a table can be corrected in any sequence.
    type_into(&mut harness, "Stress of point 2", "50");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 50.0], [0.5, 90.0]]);
    harness.get_by_label("percent").click();
    harness.run();
    type_into(&mut harness, "Strain of point 2", "30");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.3, 50.0], [0.5, 90.0]]);
    // Escape closes the window without a draft; Undo takes the last curve back.
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert!(harness.query_by_label("Apply the curve").is_none());
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 50.0], [0.5, 90.0]]);
}

#[test]
fn entered_points_are_those_that_the_plan_uses() {
    let mut harness = unfolded(|scene| {
        *scene = flat_plan();
        let points = vec![[0.0, 0.0], [0.4, 50.0], [1.0, 250.0]];
        let spec = CurveSpec::Points { points, interpolation: Interpolation::Line };
        scene.layers[0].curve = ScaledCurve { spec, strain_scale: 0.5, stress_scale: 2.0 };
    });
    harness.get_by_role_and_label(Role::Button, "Edit points").click();
    harness.run();
    let value = |harness: &Harness<'static, App>, name: &'static str| {
        harness.get_by_role_and_label(Role::SpinButton, name).value().unwrap()
    };
    // The scales are multiplied in; without a change there is nothing to take.
    assert_eq!(value(&harness, "Strain of point 2"), "0.20");
    assert_eq!(value(&harness, "Stress of point 3"), "500.0");
    type_into(&mut harness, "Stress of point 3", "220");
    harness.get_by_role_and_label(Role::Button, "Apply the curve").click();
    settle(&mut harness);
    let curve =
        |harness: &Harness<'static, App>| harness.state().session().scene().layers[0].curve.clone();
    assert_eq!((curve(&harness).strain_scale, curve(&harness).stress_scale), (1.0, 1.0));
    let stress = |harness: &Harness<'static, App>, strain| {
        Curve::scaled(&curve(harness)).unwrap().stress(strain)
    };
    assert!((stress(&harness, 0.5) - 220.0).abs() < 1e-9);
    // The class of the skin does not bend what was measured.
    harness.key_press(egui::Key::Escape);
    harness.run();
    press(&mut harness, "lax");
    settle(&mut harness);
    assert!((stress(&harness, 0.5) - 220.0).abs() < 1e-9);
    harness.get_by_label_contains("The pull of the skin has no effect");
}

/// The app with the points of a measured skin open in their window.
fn with_points_open() -> Harness<'static, App> {
    let mut harness = unfolded(|scene| {
        scene.layers[0].curve = CurveSpec::Points {
            points: vec![[0.0, 0.0], [1.0, 500.0]],
            interpolation: Interpolation::Line,
        }
        .into();
    });
    harness.get_by_role_and_label(Role::Button, "Edit points").click();
    harness.run();
    harness
}

/// Applies the points of the window; the points of the plan.
fn applied(harness: &mut Harness<'static, App>) -> Vec<[f64; 2]> {
    harness.get_by_role_and_label(Role::Button, "Apply the curve").click();
    settle(harness);
    match &harness.state().session().scene().layers[0].curve.spec {
        CurveSpec::Points { points, .. } => points.clone(),
        _ => panic!("no points"),
    }
}

#[test]
fn a_pasted_table_becomes_the_curve_of_its_layer() {
    let mut harness = with_points_open();
    let paste = |harness: &mut Harness<'static, App>, text: &str| {
        harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read").focus();
        harness.run();
        harness.event(egui::Event::Paste(text.to_owned()));
        harness.run();
        harness.get_by_role_and_label(Role::Button, "Use the table").click();
        harness.run();
    };
    paste(&mut harness, "strain stress\nx 3\n");
    harness.get_by_label_contains("no row has two numbers; allowed: a strain and a stress in each row. The points are unchanged.");
    harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read").focus();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run();
    paste(&mut harness, "strain;stress (kPa)\n0,1;2,5\n45 %;0,12 MPa\n");
    assert_eq!(applied(&mut harness), [[0.0, 0.0], [0.1, 2.5], [0.45, 120.0]]);
}

#[test]
fn the_clipboard_is_read_by_a_button_and_a_bad_line_leaves_the_others() {
    let mut harness = with_points_open();
    // Nothing in the clipboard: the field has the focus, and the window says how to paste.
    harness.get_by_role_and_label(Role::Button, "Paste table").click();
    harness.run();
    harness.get_by_label_contains("paste the table into this field");
    let field = harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read");
    assert!(field.is_focused());
    harness.get_by_role_and_label(Role::Button, "Paste table").click();
    harness.step();
    harness.step();
    harness.event(egui::Event::Paste("0,1;2,5\nx;3\n45 %;0,12 MPa\n".to_owned()));
    harness.run();
    assert!(harness.query_by_label_contains("paste the table into this field").is_none());
    harness.get_by_label_contains("left out: 1; the first: line 2.");
    let text = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read").value().unwrap()
    };
    assert_eq!(text(&harness), "0,1;2,5\nx;3\n45 %;0,12 MPa\n");
    assert_eq!(applied(&mut harness), [[0.0, 0.0], [0.1, 2.5], [0.45, 120.0]]);
}

#[test]
fn a_dropped_tensile_test_becomes_a_curve_in_the_unit_that_is_chosen() {
    let mut harness = with_points_open();
    // 60 kPa a strain of 1 and an offset, in MPa; the unloading behind.
    let row = |k: u32| format!("{};{}\n", 0.5 * f64::from(k), 0.01 + 0.0003 * f64::from(k));
    let loading: String = (0..=80).map(row).collect();
    let unloading: String = (0..80).rev().map(row).collect();
    let text = format!("ε;σ\n{loading}{unloading}").replace('.', ",");
    let file = Dropped { path: "test.csv".into(), text };
    harness.input_mut().dropped_files.push(std::sync::Arc::new(file));
    wait_until(&mut harness, "the notice", |harness| text_with(harness, "test.csv was read"));
    for sentence in [
        "Strain: “ε”, in percent, guessed by the size of the numbers.",
        "Stress: “σ”, in MPa, guessed by the size of the numbers.",
        "The loading is 81 of 161 rows; the other rows are unloading, cycles or rest.",
        "Stress at the start, subtracted: 10 kPa.",
        "2 points fit 80 samples; root mean square of the distances: 0 kPa, 0 % of the greatest stress.",
    ] {
        harness.get_by_label(sentence);
    }
    // The window stays on a low screen, too.
    harness.set_size(egui::vec2(1000.0, 520.0));
    harness.run();
    let button = harness.get_by_role_and_label(Role::Button, "Apply the curve").rect();
    assert!(button.bottom() < 520.0 && button.top() > 0.0, "{button:?}");
    harness.set_size(DESKTOP);
    harness.run();
    harness.get_by_role_and_label(Role::ComboBox, "Stress in").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "kPa").click();
    harness.run();
    harness.get_by_label("Stress: “σ”, in kPa, as asked.");
    harness.get_by_label_contains("more than 30 times softer than every preset");
    let points = applied(&mut harness);
    assert_eq!(points.len(), 2, "{points:?}");
    assert!((points[1][0] - 0.4).abs() < 1e-9 && (points[1][1] - 0.024).abs() < 1e-9, "{points:?}");
}

#[test]
fn choosing_measured_points_moves_no_point_of_a_preset() {
    let mut harness = unfolded(|_| {});
    harness
        .get_all_by_role_and_label(Role::ComboBox, "Stress–strain curve")
        .next()
        .unwrap()
        .click();
    harness.run();
    harness.get_by_label("Measured points").click();
    settle(&mut harness);
    (0..5).for_each(|_| harness.step());
    let CurveSpec::Points { points, .. } = &harness.state().session().scene().layers[0].curve.spec
    else {
        panic!("no points")
    };
    let skin = Curve::new(&CurveSpec::Skin {}).unwrap();
    // The points include every strain where the preset changes its form.
    assert_eq!(points.len(), 7);
    for [strain, stress] in points {
        assert_eq!(stress.to_bits(), skin.stress(*strain).to_bits(), "at {strain}");
    }
}
