//! A scan of a body: opened, marked by clicks, keys or a file, used as one step, cancelled, taken back.

use super::window::plan_on_a_body;
use super::{
    DESKTOP, PHONE, WIDE, app, cut_texts, flat_plan, painted_texts, press, settle, unfold,
};
use eframe::egui::{self, Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use implant_preview::app::App;
use implant_preview::body::read::{Format, Unit};
use implant_preview::body::surface::Surface;
use implant_preview::body::{torso, write};
use implant_preview::scene::{LengthUnit, Scene, Side};
use std::sync::Arc;

type Screen = Harness<'static, App>;

/// A file of bytes dropped on the window.
#[derive(Debug)]
struct File(&'static str, Vec<u8>);

impl egui::DroppedFile for File {
    fn path(&self) -> &std::path::Path {
        std::path::Path::new(self.0)
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Ok(self.1.clone())
    }
}

fn scan(unit: Unit) -> File {
    File("her.ply", write::write(&torso::builtin().surface, unit, Format::Ply))
}

/// A plate: no breasts.
fn bare() -> File {
    let mut surface = Surface::default();
    for (i, j) in (0..51_u32).flat_map(|j| (0..41).map(move |i| (i, j))) {
        let [x, y] = [f64::from(i) * 10.0 - 200.0, f64::from(j) * 10.0];
        surface.positions.push([x, y, 0.0].into());
        if i > 0 && j > 0 {
            let k = j * 41 + i;
            surface.triangles.extend([[k - 42, k - 41, k], [k - 42, k, k - 1]]);
        }
    }
    File("bare.ply", write::write(&surface, Unit::Mm, Format::Ply))
}

/// The marks of the scan as a file.
fn marks(unit: Unit) -> File {
    let marks = torso::builtin().marks.scaled(1.0 / unit.factor());
    File("marks.json", serde_json::to_vec(&marks).unwrap())
}

/// Drops a file and waits until a text is shown.
fn drop_file(harness: &mut Screen, file: File, until: &str) {
    harness.input_mut().dropped_files.push(Arc::new(file));
    for _ in 0..400 {
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
        if harness.query_all_by_label_contains(until).next().is_some() {
            harness.run();
            return;
        }
    }
    panic!("{until}: {:#?}", painted_texts(harness));
}

fn screen(size: egui::Vec2) -> Screen {
    app(size, |scene| *scene = flat_plan())
}

fn button<'a>(harness: &'a Screen, name: &'a str) -> egui_kittest::Node<'a> {
    harness.get_by_role_and_label(Role::Button, name)
}

fn scene(harness: &Screen) -> Scene {
    harness.state().session().scene().clone()
}

#[test]
fn a_scan_with_its_marks_becomes_the_body_of_the_plan_in_one_step() {
    for size in [DESKTOP, PHONE] {
        let mut harness = screen(size);
        let before = scene(&harness);
        // Both at once: the marks are read first.
        drop_file(&mut harness, marks(Unit::M), "open its scan");
        drop_file(&mut harness, scan(Unit::M), "Scan her.ply");
        assert!(button(&harness, "m").accesskit_node().toggled().is_some());
        harness.get_by_label_contains("Notch to nipple is 20.6 cm");
        let words = harness.get_by_label_contains("Drag a dot");
        for name in ["Use these marks", "Cancel", "Undo mark"] {
            let (rect, least) =
                (button(&harness, name).rect(), if size == PHONE { 44.0 } else { 0.0 });
            assert!(harness.ctx.content_rect().contains_rect(rect), "{name}: {rect}");
            assert!(rect.height() >= least, "{name}: {rect}");
        }
        assert!(words.rect().right() <= size.x);
        assert_eq!(scene(&harness), before, "nothing changes before the marks are used");
        button(&harness, "Use these marks").click();
        harness.run();
        settle(&mut harness);
        let after = scene(&harness);
        let placement = after.placement.clone().expect("the plan has a place on the body");
        assert_eq!((placement.unit, after.side), (LengthUnit::M, Some(Side::Left)));
        assert_eq!(placement.cover_mm, 10.0);
        assert!(after.chest_grid.is_some() && after.thickness_field.is_some());
        // The implant and the measurements of the plan stay.
        assert_eq!(after.implant, before.implant);
        assert_eq!(after.measured(), before.measured());
        assert!(harness.state().session().result().is_some(), "the plan is solved");
        harness.get_by_label_contains("The plan has her body.");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut harness);
        assert_eq!(scene(&harness), before, "one step of the history");
        // Opened without her surface, the plan says whose body is drawn; her tissue carries a wider implant.
        let file = File("plan.json", after.without_surface().to_json().into_bytes());
        drop_file(&mut harness, file, "the picture is that of a usual torso");
        harness.state_mut().set_plan("width_cm", "14,5").unwrap();
        assert_eq!(scene(&harness).implant.base_radius_mm, 72.5);
        assert_eq!(scene(&harness).body.patch_radius_mm, after.body.patch_radius_mm);
    }
}

#[test]
fn a_scan_under_plans_of_both_sides_leaves_each_implant_in_its_breast() {
    let mut harness = app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.add_other_side().unwrap();
        scene.implant.projection_mm += 3.0;
    });
    let before = scene(&harness);
    assert_eq!(before.side, Some(Side::Left));
    drop_file(&mut harness, marks(Unit::M), "open its scan");
    drop_file(&mut harness, scan(Unit::M), "Scan her.ply");
    harness.query_all_by_role_and_label(Role::Button, "right").last().unwrap().click();
    harness.run();
    button(&harness, "Use these marks").click();
    harness.run();
    settle(&mut harness);
    let after = scene(&harness);
    let other = after.other_side.as_deref().unwrap();
    assert_eq!((after.side, other.side), (Some(Side::Right), Some(Side::Left)));
    assert_eq!(other.implant, before.implant);
    assert_eq!(after.implant, before.other_side.as_deref().unwrap().implant);
    // Both are on her body, each at its own place.
    assert_eq!(after.frames().len(), 2);
    assert_ne!(after.frames()[0], after.frames()[1]);
    assert!(other.chest_grid.is_some() && other.chest_grid != after.chest_grid);
    assert!(harness.state().session().other_side().unwrap().outcome().is_some());
}

#[test]
fn marks_are_clicked_moved_by_keys_and_taken_back() {
    let mut harness = screen(DESKTOP);
    drop_file(&mut harness, bare(), "Scan bare.ply");
    button(&harness, "Turn the body");
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    // In the midline above the breasts, then below them.
    for (name, part) in [("Sternal notch", 0.2), ("Navel", 0.75)] {
        harness.get_by_label_contains(&format!("Click on her body: {name}"));
        let at = egui::pos2(picture.center().x + 3.0, picture.top() + part * picture.height());
        harness.drag_at(at);
        harness.run();
        harness.drop_at(at);
        harness.run();
    }
    harness.get_by_label_contains("Click on her body: Left nipple");
    let place = |harness: &Screen, name: &str| button(harness, name).rect().center();
    let notch = place(&harness, "Sternal notch");
    button(&harness, "Sternal notch").focus();
    harness.run();
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
    harness.run();
    let moved = place(&harness, "Sternal notch");
    assert!(moved.y > notch.y + 5.0 && (moved.x - notch.x).abs() < 1.0, "{notch} {moved}");
    for _ in 0..10 {
        harness.key_press(Key::ArrowUp);
        harness.run();
    }
    let back = place(&harness, "Sternal notch");
    assert!(back.distance(notch) < 0.1 * moved.distance(notch), "{notch} {moved} {back}");
    for _ in 0..11 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run();
    }
    assert_eq!(place(&harness, "Sternal notch"), notch);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Button, "Navel").is_none());
    harness.get_by_label_contains("Click on her body: Navel");
    button(&harness, "Cancel").click();
    harness.run();
    assert!(harness.query_by_label_contains("bare.ply").is_none());
    assert_eq!(scene(&harness), flat_plan());
}

/// Chooses a view by the list of commands.
fn view(harness: &mut Screen, pose: &str) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.run();
    harness.event(egui::Event::Text(pose.to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
}

#[test]
fn a_standard_view_frames_the_scan_while_it_gets_its_marks() {
    let mut harness = screen(DESKTOP);
    drop_file(&mut harness, marks(Unit::Mm), "open its scan");
    drop_file(&mut harness, scan(Unit::Mm), "Scan her.ply");
    let notch = |harness: &Screen| button(harness, "Sternal notch").rect().center();
    let front = notch(&harness);
    for (pose, is_front) in [("Side", false), ("Front", true)] {
        view(&mut harness, pose);
        assert_eq!(notch(&harness).distance(front) < 1.0, is_front, "{pose}");
    }
}

/// From the left side her right nipple is hidden.
#[test]
fn a_mark_out_of_sight_turns_the_body_when_it_is_chosen() {
    let mut harness = screen(DESKTOP);
    drop_file(&mut harness, marks(Unit::Mm), "open its scan");
    drop_file(&mut harness, scan(Unit::Mm), "Scan her.ply");
    let notch = |harness: &Screen| button(harness, "Sternal notch").rect().center();
    let front = notch(&harness);
    view(&mut harness, "Side");
    let aside = notch(&harness);
    for (mark, place) in [("left nipple", aside), ("right nipple", front)] {
        button(&harness, mark).click();
        harness.run();
        assert!(notch(&harness).distance(place) < 1.0, "{mark}");
    }
}

/// Keys move the mark that was clicked, dragged or chosen in the list, and nothing of the plan behind.
#[test]
fn keys_move_the_mark_in_use_alone() {
    let mut harness = screen(DESKTOP);
    drop_file(&mut harness, marks(Unit::Mm), "open its scan");
    drop_file(&mut harness, scan(Unit::Mm), "Scan her.ply");
    let place = |harness: &Screen, name: &str| button(harness, name).rect().center();
    let press = |harness: &mut Screen, modifiers, key| {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
    };
    let pointed = |harness: &mut Screen, from: egui::Pos2, by: egui::Vec2| {
        harness.drag_at(from);
        harness.step();
        for part in [0.5, 1.0] {
            harness.hover_at(from + part * by);
            harness.step();
        }
        harness.drop_at(from + by);
        harness.run();
    };
    let before = place(&harness, "Right nipple");
    button(&harness, "right nipple").click();
    harness.run();
    press(&mut harness, Modifiers::SHIFT, Key::ArrowDown);
    let lower = place(&harness, "Right nipple");
    assert!(lower.y > before.y + 5.0, "{before} {lower}");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(place(&harness, "Right nipple"), before);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(place(&harness, "Right nipple"), lower);
    let notch = place(&harness, "Sternal notch");
    pointed(&mut harness, notch, egui::vec2(0.0, 30.0));
    let dragged = place(&harness, "Sternal notch");
    assert!(dragged.y > notch.y + 10.0, "{notch} {dragged}");
    press(&mut harness, Modifiers::SHIFT, Key::ArrowDown);
    assert!(place(&harness, "Sternal notch").y > dragged.y + 5.0);
    // The skin between the nipples is none of the marks.
    let skin = place(&harness, "Left nipple").lerp(place(&harness, "Right nipple"), 0.4);
    pointed(&mut harness, skin, egui::Vec2::ZERO);
    let places = ["Sternal notch", "Right nipple"].map(|name| place(&harness, name));
    press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    press(&mut harness, Modifiers::NONE, Key::OpenBracket);
    assert_eq!(["Sternal notch", "Right nipple"].map(|name| place(&harness, name)), places);
    button(&harness, "Cancel").click();
    harness.run();
    assert_eq!(scene(&harness), flat_plan());
}

#[test]
fn a_bad_file_has_one_line_and_wrong_marks_stay() {
    let mut harness = screen(DESKTOP);
    drop_file(
        &mut harness,
        File("bad.ply", b"ply\nformat ascii 1.0\n".to_vec()),
        "bad.ply cannot be read",
    );
    drop_file(&mut harness, marks(Unit::Mm), "open its scan");
    drop_file(&mut harness, scan(Unit::Mm), "Scan her.ply");
    drop_file(
        &mut harness,
        File("marks.json", b"{\"sternal_notch\": [0, 1]}".to_vec()),
        "marks.json cannot be read",
    );
    drop_file(&mut harness, marks(Unit::Mm), "Notch to nipple is 20.6 cm");
    // Another unit: the distance says so, and there is no plan.
    button(&harness, "cm").click();
    harness.run();
    harness.get_by_label_contains("Notch to nipple is 206.5 cm");
    harness.get_by_label_contains("check unit and marks");
    assert!(button(&harness, "Use these marks").accesskit_node().is_disabled());
    button(&harness, "mm").click();
    harness.run();
    assert!(!button(&harness, "Use these marks").accesskit_node().is_disabled());
}

#[test]
fn marks_are_proposed_and_the_pictures_show_her_before_and_after() {
    let mut harness = screen(DESKTOP);
    drop_file(&mut harness, scan(Unit::Mm), "The marks with a question mark");
    button(&harness, "Use these marks").click();
    harness.run();
    settle(&mut harness);
    assert!(scene(&harness).placement.is_some());
    // The plan's file holds her surface; a link, pins and a file without the tick do not.
    let text = harness.state().session().document_json();
    assert!(text.contains("\"vertices\"") && text.len() < 600_000, "{}", text.len());
    let opened = implant_preview::scene::Document::from_json(&text).unwrap();
    assert_eq!(opened.scene.scene().placement, scene(&harness).placement);
    assert!(!harness.state().session().document_json_without_surface().contains("\"vertices\""));
    press(&mut harness, "Pin as A");
    let shared = harness.state().session().shared_document_json();
    assert!(!shared.contains("sternal_notch") && shared.contains("\"pins\""));
    let pin = harness.state().session().pins().first().unwrap().scene().clone();
    assert!(pin.placement.is_none() && pin.is_same_plan(&scene(&harness)));
    let canvases =
        |harness: &Screen, name| harness.query_all_by_role_and_label(Role::Canvas, name).count();
    assert_eq!(canvases(&harness, "Before"), 0);
    button(&harness, "Before | after").click();
    harness.run();
    let [before, after] =
        ["Before", "3-D view"].map(|name| harness.get_by_role_and_label(Role::Canvas, name).rect());
    assert!(before.right() < after.left() && (before.size() - after.size()).length() < 1.0);
    for word in ["before", "after"] {
        harness.get_by_label(word);
    }
    button(&harness, "Wipe").click();
    harness.run();
    assert_eq!(canvases(&harness, "Before"), 0);
    let border = "Border between before and after";
    let place =
        |harness: &Screen| harness.get_by_role_and_label(Role::Slider, border).rect().center();
    let middle = place(&harness);
    harness.get_by_role_and_label(Role::Slider, border).focus();
    harness.run();
    harness.key_press(Key::ArrowLeft);
    harness.run();
    assert!(place(&harness).x < middle.x - 5.0);
    let to = middle - egui::vec2(150.0, 0.0);
    let from = place(&harness);
    harness.drag_at(from);
    harness.run();
    harness.hover_at(to);
    harness.run();
    harness.drop_at(to);
    harness.run();
    assert!((place(&harness).x - to.x).abs() < 8.0);
    // The words stay on their sides of the border.
    assert!(harness.get_by_label("before").rect().right() < place(&harness).x);
    button(&harness, "Inside").click();
    harness.run();
    assert!(
        harness.query_by_role_and_label(Role::Slider, border).is_none(),
        "cut tissue has no before"
    );
}

/// Number of painted texts.
fn count(harness: &Screen, text: &str) -> usize {
    painted_texts(harness).iter().filter(|painted| *painted == text).count()
}

#[test]
fn her_measures_stand_in_details_and_comparison_and_her_body_among_the_shapes() {
    let mut harness = app(WIDE, |scene| *scene = plan_on_a_body());
    let title = "Measures before | after";
    assert_eq!(count(&harness, title), 0, "folded");
    press(&mut harness, "Pin as A");
    unfold(&mut harness, title);
    assert_eq!(cut_texts(&harness), Vec::<String>::new());
    for name in ["Notch to nipple, cm", "Volume gained, ml", "Asymmetry of the skin, mm"] {
        assert_eq!(count(&harness, name), 1, "{name}");
    }
    unfold(&mut harness, "Details");
    assert_eq!((count(&harness, title), count(&harness, "Upper pole, %")), (2, 2));
    harness.get_all_by_label_contains("Not computed: lengths under stretch").next().unwrap();
    assert_eq!(cut_texts(&harness), Vec::<String>::new());
    // From notch to nipple of the built-in torso it is 20.6 cm.
    assert!(count(&harness, "20.6") >= 2, "{:?}", painted_texts(&harness));
    press(&mut harness, "File");
    press(&mut harness, "Save shape (3-D)");
    for (body, format) in ["Body before", "Body after"]
        .into_iter()
        .flat_map(|body| ["STL", "OBJ", "PLY", "GLB"].map(|format| (body, format)))
    {
        button(&harness, &format!("{body} as {format}"));
    }
    assert_eq!(cut_texts(&harness), Vec::<String>::new());
}

#[test]
fn a_plan_without_a_scan_has_no_measures_of_a_body() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    press(&mut harness, "Pin as A");
    unfold(&mut harness, "Details");
    assert_eq!(count(&harness, "Measures before | after"), 0);
    press(&mut harness, "File");
    press(&mut harness, "Save shape (3-D)");
    button(&harness, "Implant as made as STL");
    assert!(harness.query_by_label("Body after as PLY").is_none());
}
