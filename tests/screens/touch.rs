//! A finger on sliders and on the picture.

use super::*;

/// A touch of one finger: start and path, in quick frames.
fn swipe(harness: &mut Harness<'static, App>, from: egui::Pos2, travel: egui::Vec2) {
    swipe_within(harness, from, travel, 10);
}

/// A touch of one finger whose path takes so many frames.
fn swipe_within(
    harness: &mut Harness<'static, App>,
    from: egui::Pos2,
    travel: egui::Vec2,
    frames: usize,
) {
    let touch = |phase, pos| egui::Event::Touch {
        device_id: egui::TouchDeviceId(0),
        id: egui::TouchId(1),
        phase,
        pos,
        force: None,
    };
    let press = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    // The page sends the events of a mouse with every touch.
    let events = &mut harness.input_mut().events;
    events.extend([press(from, true), touch(egui::TouchPhase::Start, from)]);
    // A tap is down and up within a frame.
    let is_tap = travel == egui::Vec2::ZERO;
    harness.step();
    if !is_tap {
        harness.step();
    }
    for k in 1..=if is_tap { 0 } else { 10 } {
        let at = from + travel * (k as f32 / 10.0);
        let events = &mut harness.input_mut().events;
        events.extend([egui::Event::PointerMoved(at), touch(egui::TouchPhase::Move, at)]);
        if k * frames / 10 > (k - 1) * frames / 10 {
            harness.step();
        }
    }
    let at = from + travel;
    let events = &mut harness.input_mut().events;
    events.extend([press(at, false), egui::Event::PointerGone, touch(egui::TouchPhase::End, at)]);
    settle(harness);
}

#[test]
fn a_swipe_across_a_slider_scrolls_and_one_along_it_moves_the_handle() {
    let mut harness = app(PHONE, |_| {});
    let insertion = |harness: &Harness<'static, App>| harness.state().session().scene().insertion;
    let slider = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Slider, "In place (%)").rect()
    };
    open_push(&mut harness);
    // The Tab key scrolls the slider into view; a slider with the focus behaves equally.
    harness.get_by_role_and_label(Role::Button, "Show insertion").focus();
    harness.run();
    harness.key_press(egui::Key::Tab);
    (0..8).for_each(|_| harness.step());
    let away_from_the_handle =
        |at: egui::Rect| at.left_center() + egui::vec2(0.3 * at.width(), 0.0);
    let at = slider(&harness);
    assert!(at.bottom() < PHONE.y - 20.0, "{at:?}");
    swipe(&mut harness, away_from_the_handle(at), egui::vec2(3.0, 50.0));
    assert_eq!(insertion(&harness), 1.0, "a swipe across the slider moved it");
    let moved = slider(&harness).center().y - at.center().y;
    assert!(moved > 20.0, "the panel was scrolled by {moved}");
    swipe(&mut harness, away_from_the_handle(at), egui::vec2(3.0, -90.0));
    (0..8).for_each(|_| harness.step());
    // A tap beside the handle does not move the handle.
    let at = slider(&harness);
    swipe(&mut harness, away_from_the_handle(at), egui::Vec2::ZERO);
    assert_eq!(insertion(&harness), 1.0, "a tap beside the handle moved it");
    swipe(&mut harness, away_from_the_handle(at), egui::vec2(-40.0, 2.0));
    assert!(
        insertion(&harness) < 0.9,
        "a swipe along the slider left it at {}",
        insertion(&harness)
    );
}

#[test]
fn a_swipe_along_a_slider_moves_the_handle_as_far_in_slow_frames() {
    let travelled = |frames: usize| {
        let mut harness = app(PHONE, |_| {});
        open_push(&mut harness);
        harness.get_by_role_and_label(Role::Button, "Show insertion").focus();
        harness.run();
        harness.key_press(egui::Key::Tab);
        (0..8).for_each(|_| harness.step());
        let at = harness.get_by_role_and_label(Role::Slider, "In place (%)").rect();
        let from = at.left_center() + egui::vec2(0.5 * at.width(), 0.0);
        swipe_within(&mut harness, from, egui::vec2(-40.0, 2.0), frames);
        1.0 - harness.state().session().scene().insertion
    };
    let quick = travelled(10);
    assert!(quick > 0.1, "{quick}");
    for frames in [1, 2, 5] {
        let slow = travelled(frames);
        assert!((slow - quick).abs() < 1e-9, "{frames} frames: {slow} {quick}");
    }
}

#[test]
fn a_tap_on_the_picture_shows_values_until_the_next() {
    let mut harness = app(PHONE, |_| {});
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    let boxes = |harness: &Harness<'static, App>| {
        let is_box = |text: &&String| {
            text.starts_with("Skin stretch ") && text.contains(", area ")
                || text.starts_with("Outside ")
        };
        painted_texts(harness).iter().filter(is_box).count()
    };
    assert_eq!(boxes(&harness), 0);
    let at = picture.left_center() + egui::vec2(0.35 * picture.width(), 0.0);
    swipe(&mut harness, at, egui::Vec2::ZERO);
    harness.step();
    assert_eq!(boxes(&harness), 1);
    // A second tap at the same position hides the values.
    swipe(&mut harness, at, egui::Vec2::ZERO);
    harness.step();
    assert_eq!(boxes(&harness), 0);
}

/// Least height of a row for a finger \[points\].
const FINGER: f32 = 44.0;

/// The controls of a role with their places.
fn sizes_of(harness: &Harness<'static, App>, role: Role) -> Vec<(String, egui::Rect)> {
    let nodes = harness.query_all_by_role(role);
    let sizes = nodes.map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect()));
    sizes.collect()
}

#[test]
fn rows_of_menus_and_lists_have_the_size_of_a_finger_on_a_phone() {
    for size in [PHONE, egui::vec2(PHONE.y, PHONE.x)] {
        for (menu, further, last) in
            [("File", "Save shape (3-D)", "Usual implant"), ("View", "Colours", "Commands…")]
        {
            let mut harness = app(size, |_| {});
            let before = sizes_of(&harness, Role::Button);
            press(&mut harness, menu);
            harness.run_steps(4);
            // An upright phone has room for all rows, and for the menu in the menu; on a turned one they scroll.
            if size == PHONE {
                let is_whole = |shape: &egui::epaint::ClippedShape| match &shape.shape {
                    egui::Shape::Text(text) if text.galley.text() == last => {
                        shape.clip_rect.contains_rect(text.visual_bounding_rect())
                    }
                    _ => false,
                };
                assert!(harness.output().shapes.iter().any(is_whole), "{last}");
                press(&mut harness, further);
                harness.run_steps(4);
            }
            let tall = |(_, rect): &(String, egui::Rect)| rect.height() >= FINGER;
            let mut added = sizes_of(&harness, Role::Button);
            added.retain(|button| !before.contains(button));
            assert!(added.len() > 5, "{added:?}");
            let ticks = sizes_of(&harness, Role::CheckBox);
            assert!(added.iter().chain(&ticks).all(tall), "{added:?} {ticks:?}");
            assert!(cut_texts(&harness).is_empty(), "{:?}", cut_texts(&harness));
        }
    }
}
