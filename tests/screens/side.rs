//! A right breast: the numbers of a left one, its pictures mirrored, the pointer and the keys as one looks at the patient.

use super::{DESKTOP, PHONE, app, flat_plan, press, settle};
use eframe::egui::accesskit::Toggled;
use eframe::egui::{Key, Pos2, Rect, Role, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use implant_preview::app::App;
use implant_preview::scene::Side;

type Screen = Harness<'static, App>;

/// A plan off centre of a side.
fn of(side: Side) -> Screen {
    let mut harness = app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.solver.nodes_per_side = 33;
        (scene.side, scene.implant.center_mm) = (Some(side), [6.0, -3.0]);
    });
    harness.remove_cursor();
    harness.run();
    harness
}

fn rect(harness: &Screen, name: &str) -> Rect {
    harness.get_by_role_and_label(Role::Canvas, name).rect()
}

/// The points of lines and meshes within an area, in their order.
fn points(harness: &Screen, area: Rect) -> Vec<Pos2> {
    let shapes = harness
        .output()
        .shapes
        .iter()
        .filter(|shape| area.expand(1.0).contains_rect(shape.clip_rect));
    let of = |shape: &Shape| match shape {
        Shape::Path(path) => path.points.clone(),
        Shape::Mesh(mesh) => mesh.vertices.iter().map(|vertex| vertex.pos).collect(),
        _ => Vec::new(),
    };
    shapes.flat_map(|shape| of(&shape.shape)).collect()
}

/// The picture's camera mirrors: `the_words_of_the_directions_stand_at_the_edges_of_the_picture_on_every_plan`.
#[test]
fn the_cross_section_of_a_right_breast_is_the_mirror_image_and_its_numbers_are_those_of_the_left() {
    let (left, right) = (of(Side::Left), of(Side::Right));
    let area = rect(&left, "Cross-section");
    let [a, b] = [&left, &right].map(|harness| points(harness, area));
    assert_eq!(a.len(), b.len());
    // The ground stays; so does a point on the axis.
    let stays = |(a, b): &(Pos2, Pos2)| a.distance(*b) < 0.01;
    let pairs: Vec<(Pos2, Pos2)> = a.into_iter().zip(b).filter(|pair| !stays(pair)).collect();
    assert!(pairs.len() > 300, "{} points", pairs.len());
    // The legend stands beside the cross-section: its axis is not in the middle.
    let axis = pairs[0].0.x + pairs[0].1.x;
    for (a, b) in pairs {
        assert!((a.x + b.x - axis).abs() < 0.01 && (a.y - b.y).abs() < 0.01, "{a:?} {b:?}");
    }
    let result = |harness: &Screen| {
        let mut result = harness.state().session().result().unwrap().clone();
        result.solver.time_ms = None;
        result
    };
    assert_eq!(result(&left), result(&right), "the numbers to the last bit");
}

#[test]
fn the_button_of_the_cross_section_has_the_order_of_the_drawing() {
    for (side, name, other) in [
        (Side::Left, "midline to side", "side to midline"),
        (Side::Right, "side to midline", "midline to side"),
    ] {
        let harness = of(side);
        harness.get_by_role_and_label(Role::Button, name);
        assert!(harness.query_by_label(other).is_none(), "{side:?}");
    }
}

#[test]
fn the_side_is_a_choice_of_the_first_screen() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        let is_chosen = |harness: &Screen, side: &str| {
            let chip = harness.get_by_role_and_label(Role::Button, side);
            assert!(harness.ctx.content_rect().contains_rect(chip.rect()), "{size}: {side}");
            chip.accesskit_node().toggled() == Some(Toggled::True)
        };
        assert!(!["left", "right", "both alike"].iter().any(|side| is_chosen(&harness, side)));
        press(&mut harness, "right");
        assert!(is_chosen(&harness, "right") && !is_chosen(&harness, "left"));
        assert!(harness.state().session().scene().is_right());
    }
}

#[test]
fn a_change_of_the_side_starts_no_solve_and_is_in_link_and_pin() {
    let mut harness = of(Side::Left);
    let solves = harness.state().session().counters().solves;
    press(&mut harness, "Pin as A");
    press(&mut harness, "right");
    settle(&mut harness);
    let session = harness.state().session();
    assert!(session.scene().is_right() && session.scene().visit.is_none());
    assert_eq!(session.counters().solves, solves);
    assert!(session.shared_document_json().contains("\"side\": \"right\""));
    // A left and a right breast are two plans.
    press(&mut harness, "Pin as B");
    let sides: Vec<bool> =
        harness.state().session().pins().iter().map(|pin| pin.scene().is_right()).collect();
    assert_eq!(sides, [false, true]);
    press(&mut harness, "Undo");
    assert!(!harness.state().session().scene().is_right());
}

#[test]
#[allow(clippy::float_cmp, reason = "steps of whole millimetres")]
fn the_pad_and_its_keys_go_as_one_looks_at_the_patient() {
    for (side, hand) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
        let mut harness = of(side);
        let centre = |harness: &Screen| harness.state().session().scene().implant.center_mm;
        for name in ["Position of the implant", "Move the implant"] {
            let [x, y] = centre(&harness);
            let role = if name == "Move the implant" { Role::Button } else { Role::Canvas };
            if role == Role::Button {
                harness.hover_at(rect(&harness, "3-D view").center());
                harness.run();
            }
            harness.get_by_role_and_label(role, name).focus();
            harness.run();
            harness.key_press(Key::ArrowRight);
            settle(&mut harness);
            assert_eq!(centre(&harness), [x + hand, y], "{name}, {side:?}");
        }
        let [x, _] = centre(&harness);
        let pad = rect(&harness, "Position of the implant");
        harness.drag_at(pad.center());
        harness.step();
        for travel in [12.0, 24.0] {
            harness.hover_at(pad.center() + vec2(travel, 0.0));
            harness.step();
        }
        harness.drop_at(pad.center() + vec2(24.0, 0.0));
        settle(&mut harness);
        assert!(hand * (centre(&harness)[0] - x) > 1.0, "{side:?}: {:?}", centre(&harness));
    }
}
