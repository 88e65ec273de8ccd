//! Sizes of a maker on the chart.

use super::*;

/// Unfolds the shelf and gives a table to its field; the preview opens.
fn paste_table(harness: &mut Harness<'static, App>, text: &str) {
    if harness.query_all_by_role_and_label(Role::Button, "Paste table").count() == 0 {
        harness.get_by_label("Sizes in stock").focus();
        harness.run_steps(2);
        harness.key_press(egui::Key::Enter);
        harness.run_steps(12);
    }
    if harness.query_all_by_label("Table of sizes").count() == 0 {
        harness.get_by_role_and_label(Role::Button, "Paste table").click();
        harness.run_steps(3);
    }
    harness.get_by_label("Table of sizes").focus();
    harness.run_steps(2);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run_steps(2);
    harness.event(egui::Event::Paste(text.to_owned()));
    // The page scrolls to the cursor.
    harness.run_steps(40);
    harness.get_by_role_and_label(Role::Button, "Use this table").click();
    harness.run_steps(4);
}

/// Presses the button of a preview.
fn take_sizes(harness: &mut Harness<'static, App>, count: usize) {
    harness.get_by_role_and_label(Role::Button, &format!("Take {count} sizes")).click();
    harness.run_steps(4);
}

#[test]
fn a_click_on_a_size_of_the_shelf_takes_exactly_that_size() {
    let mut harness = range_of(layered(), DESKTOP);
    paste_table(&mut harness, "name;width_cm;volume_ml\nFlat;12,3;\"3");
    harness.get_by_label_contains(
        "The table was not read; the sizes in stock are unchanged. line 2: a quotation mark is not closed",
    );
    paste_table(
        &mut harness,
        "name;width_cm;volume_ml;projection_mm\nRound;12,3;310;\nHigh;11;;44,7\nFar;18;600;",
    );
    take_sizes(&mut harness, 3);
    harness.get_by_label("Sizes in stock: 3");
    let round = Size::of_width_and_volume(123.0, 310.0).unwrap();
    let rect = harness.get_by_role_and_label(Role::Canvas, CHART).rect();
    let at = egui::pos2(
        rect.left() + rect.width() * 23.0 / 40.0,
        rect.bottom() - rect.height() * (round.projection_mm() as f32 - 20.0) / 40.0,
    );
    harness.hover_at(at);
    harness.run_steps(2);
    assert!(words(&harness).starts_with("Round · 310 cc: width 12.3 cm"), "{}", words(&harness));
    click(&mut harness, at);
    let implant = harness.state().session().scene().implant;
    assert_eq!((implant.base_radius_mm, implant.projection_mm), (61.5, round.projection_mm()));
    assert!((implant.size().unwrap().volume_ml() - 310.0).abs() < 1e-9);
    harness.get_by_label("Round · 310 cc");
    // Wider sizes than the breast do not count, and the narrower one is too high.
    wait_for(&mut harness, "No size in stock up to 12 cm has practice's stretch or less.");
    // The list takes a size too; the shelf is kept for the next start.
    harness.get_by_role_and_label(Role::Button, "Take High").click();
    harness.run_steps(2);
    settle(&mut harness);
    let implant = harness.state().session().scene().implant;
    assert_eq!((implant.base_radius_mm, implant.projection_mm), (55.0, 44.7));
    harness.get_by_role_and_label(Role::Button, "Remove Far · 600 cc").click();
    harness.run_steps(3);
    let kept = harness.state_mut().take_shelf_to_store(true).unwrap();
    let mut next = range_of(sheet(), DESKTOP);
    next.state_mut().restore_shelf(&kept);
    next.run_steps(3);
    next.get_by_label("Sizes in stock: 2");
    assert_eq!(next.state_mut().take_shelf_to_store(true), None);
}

#[test]
fn a_size_of_a_maker_keeps_volume_and_name_until_an_edit_of_its_size() {
    let mut harness = range_of(layered(), DESKTOP);
    let table =
        "Reference;Width (cm);Projection (cm);Volume (cc)\nMM-240;11,5;3,9;240\nFlat;12;4;200";
    paste_table(&mut harness, table);
    harness.get_by_label_contains("Sizes whose volume no shape of the model has: 1");
    take_sizes(&mut harness, 2);
    harness.get_by_role_and_label(Role::Button, "Take MM-240 · 240 cc").click();
    harness.run_steps(2);
    settle(&mut harness);
    let scene = harness.state().session().scene().clone();
    assert_eq!((scene.implant.base_radius_mm, scene.implant.projection_mm), (57.5, 39.0));
    // π 57.5² 39: 405.1 ml; half of an ellipsoid has 270 ml.
    assert!((scene.implant.fullness() - 0.5925).abs() < 1e-3, "{}", scene.implant.fullness());
    assert!((scene.implant.size().unwrap().volume_ml() - 240.0).abs() < 1e-9);
    assert_eq!(scene.implant_reference, "MM-240 · 240 cc");
    let volume = harness.get_by_role_and_label(Role::SpinButton, "Volume (ml)").value();
    assert_eq!(volume.as_deref(), Some("240"));
    harness.get_by_label("MM-240 · 240 cc");
    let result = harness.state().session().result().unwrap();
    assert_eq!(result.implant_reference, "MM-240 · 240 cc");
    // Another volume is no longer this implant; Undo brings it back.
    harness.state_mut().set_plan("volume_ml", "250").unwrap();
    harness.run_steps(2);
    assert_eq!(harness.state().session().scene().implant_reference, "");
    harness.state_mut().set_plan("volume_ml", "240").unwrap();
    harness.run_steps(2);
    assert_eq!(harness.state().session().scene().implant_reference, "");
    for _ in 0..2 {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
        harness.run_steps(2);
    }
    assert_eq!(harness.state().session().scene(), &scene);
    // The maker's volume stays in the name where no shape has it.
    harness.get_by_role_and_label(Role::Button, "Take Flat · 200 cc").click();
    harness.run_steps(2);
    let scene = harness.state().session().scene();
    assert_eq!((scene.implant.fullness(), &*scene.implant_reference), (0.55, "Flat · 200 cc"));
}

#[test]
fn the_next_start_and_a_link_have_the_name_of_the_size() {
    let mut harness = range_of(layered(), DESKTOP);
    let table = "Reference;Width (cm);Height (cm);Projection (cm);Volume (cc)\n\
                 MM-240;11,5;;3,9;240\nAN-285;12;10,8;4,3;285";
    paste_table(&mut harness, table);
    take_sizes(&mut harness, 2);
    for name in ["MM-240 · 240 cc", "AN-285 · 285 cc"] {
        harness.get_by_role_and_label(Role::Button, &format!("Take {name}")).click();
        harness.run_steps(2);
        settle(&mut harness);
        let scene = harness.state().session().scene().clone();
        assert_eq!(scene.implant_reference, name);
        let kept = harness.state_mut().take_plan_to_store(true).unwrap();
        let mut next = range_of(layered(), DESKTOP);
        next.state_mut().restore_plan(&kept);
        next.run_steps(3);
        settle(&mut next);
        assert_eq!(next.state().session().scene(), &scene);
        next.get_by_label(name);
        let link = harness.state().session().shared_document_json();
        let mut other = range_of(layered(), DESKTOP);
        other.state_mut().open(link).unwrap();
        other.run_steps(3);
        settle(&mut other);
        assert_eq!(other.state().session().scene(), &scene);
        other.get_by_label(name);
    }
}

#[test]
fn a_table_is_looked_at_before_it_is_taken() {
    let mut harness = range_of(layered(), DESKTOP);
    let table = "Sizes 2026;;;\nKode;Bredde;Fylde;Pris\nA-1;12,5;300;9\nA-2;13;x;9\nA-3;13;350;9";
    paste_table(&mut harness, table);
    harness.get_by_label("4 rows, 4 skipped. Columns are read as:");
    harness.get_by_label("Ignored: Kode, Bredde, Fylde, Pris.");
    harness.get_by_label_contains("no column is the width; allowed: ");
    for (title, content) in [("Kode", "name"), ("Bredde", "width"), ("Fylde", "volume")] {
        harness.get_by_role_and_label(Role::ComboBox, &format!("{title} is")).click();
        harness.run_steps(4);
        harness.get_by_role_and_label(Role::Button, content).click();
        harness.run_steps(4);
    }
    harness.get_by_label("4 rows, 2 skipped. Columns are read as:");
    harness.get_by_label("Ignored: Pris.");
    harness.get_by_label("line 1: above the names of the columns");
    harness.get_by_label("line 4: the volume is \"x\"; allowed: a number, as 12.5");
    // A guessed unit is a menu.
    harness.get_by_role_and_label(Role::ComboBox, "Unit of Bredde").click();
    harness.run_steps(4);
    harness.get_by_role_and_label(Role::Button, "mm").click();
    harness.run_steps(4);
    harness
        .get_by_label_contains("line 3: the width is “12,5”; allowed: a number from 20 to 240 mm");
    harness.get_by_role_and_label(Role::ComboBox, "Unit of Bredde").click();
    harness.run_steps(4);
    harness.get_by_role_and_label(Role::Button, "cm").click();
    harness.run_steps(4);
    // Cancelling leaves the shelf as it is.
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    harness.run_steps(4);
    assert_eq!(harness.query_all_by_label_contains("Take 2 sizes").count(), 0);
    harness.get_by_label("Sizes in stock");
    paste_table(&mut harness, "Ref;Width;Volume\nA-1;12,5;300\nA-3;13;350");
    take_sizes(&mut harness, 2);
    harness.get_by_label("Sizes in stock: 2");
    harness.get_by_role_and_label(Role::Button, "Take A-3 · 350 cc");
}
