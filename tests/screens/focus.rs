//! The keyboard focus in a page: through every control with a ring that is seen, and out of the app at both ends.

use super::*;
use egui::FocusDirection;

/// Is a ring in the colour of text drawn around the control with the focus, or within a large one, with its left side in sight?
fn has_ring(harness: &Harness<'static, App>) -> bool {
    let (_, [left, ..]) = harness.state().focused().unwrap();
    let colour = harness.ctx.global_style().visuals.text_color();
    let is_ring = |rect: &egui::epaint::RectShape| {
        let is_at = |shift: f32| (rect.rect.left() - left - shift).abs() < 0.5;
        rect.stroke.color == colour && rect.stroke.width == 2.0 && (is_at(-3.0) || is_at(2.0))
    };
    let screen = harness.ctx.content_rect();
    harness.output().shapes.iter().any(|shape| match &shape.shape {
        egui::Shape::Rect(rect) if is_ring(rect) => {
            let seen = rect.rect.intersect(screen).intersect(shape.clip_rect);
            seen.left() == rect.rect.left().max(0.0) && seen.height() >= 4.0
        }
        _ => false,
    })
}

/// Enters the app and goes through it by the Tab key until the focus leaves it; the names of the controls.
fn walk(harness: &mut Harness<'static, App>, direction: FocusDirection) -> Vec<String> {
    let is_forwards = direction == FocusDirection::Next;
    let modifiers = if is_forwards { egui::Modifiers::NONE } else { egui::Modifiers::SHIFT };
    harness.state_mut().enter(direction);
    harness.run();
    let mut names: Vec<String> = Vec::new();
    while names.len() < 150 {
        let Some((name, _)) = harness.state().focused() else {
            panic!("the focus is lost after {:?}", names.last())
        };
        assert!(!name.is_empty(), "a control has no name, after {:?}", names.last());
        assert!(has_ring(harness), "no ring is seen around {name}");
        names.push(name);
        harness.key_press_modifiers(modifiers, egui::Key::Tab);
        harness.run();
        if let Some(exit) = harness.state_mut().take_focus_exit() {
            assert_eq!(exit, direction);
            return names;
        }
    }
    panic!("no way out: {names:?}");
}

#[test]
fn the_tab_key_leaves_the_app_of_a_page_at_both_ends_after_every_control() {
    let mut harness = researching(egui::vec2(1000.0, 700.0), |scene| *scene = flat_plan());
    harness.state_mut().enable_page_navigation();
    // The sentence with the largest volume is a button.
    wait_for_studies(&mut harness);
    let there = walk(&mut harness, FocusDirection::Next);
    let mut back = walk(&mut harness, FocusDirection::Previous);
    back.reverse();
    assert_eq!(there, back);
    for name in [
        "File",
        "Undo",
        "View",
        "Start over",
        "Help",
        "Width (cm)",
        "Volume (ml)",
        "Projection (cm)",
        "Let the volume follow",
        "Half sphere",
        "Pinch (cm)",
        "very lax",
        "Margin (cm)",
        "Position of the implant",
        "To the side (cm)",
        "Tissue",
        "Advanced",
        "Where limits come from",
        "Details",
        "Front",
        "Stretch",
        "3-D view",
    ] {
        assert!(there.iter().any(|other| other == name), "{name} is not among {there:?}");
    }
    assert_eq!([&*there[0], there.last().unwrap()], ["File", "Before | after"]);
    // Sliders are two stops: the handle and the number.
    assert_eq!(there.iter().filter(|name| *name == "Width (cm)").count(), 2);
}

#[test]
fn the_tab_key_leaves_the_app_of_a_page_behind_every_tab_of_a_phone() {
    let mut harness = app(PHONE, |scene| *scene = flat_plan());
    harness.state_mut().enable_page_navigation();
    wait_for_studies(&mut harness);
    let mut names = Vec::new();
    for tab in ["Implant", "Patient", "Pocket", "More"] {
        press(&mut harness, tab);
        names.extend(walk(&mut harness, FocusDirection::Next));
    }
    for name in ["Volume (ml)", "More Volume", "Pinch (cm)", "Margin (cm)", "Details", "3-D view"] {
        assert!(names.iter().any(|other| other == name), "{name} is not among {names:?}");
    }
}

#[test]
fn the_tab_key_goes_through_all_controls_and_back() {
    let mut harness = unfolded(|_| {});
    // The sentence with the largest volume is a button.
    wait_for_studies(&mut harness);
    let mut ways = Vec::new();
    for modifiers in [egui::Modifiers::NONE, egui::Modifiers::SHIFT] {
        let mut seen = Vec::new();
        for _ in 0..200 {
            harness.key_press_modifiers(modifiers, egui::Key::Tab);
            harness.run();
            let focused = harness.ctx.memory(egui::Memory::focused);
            assert!(focused.is_some(), "the focus is lost after {} controls", seen.len());
            if seen.first() == focused.as_ref() {
                break;
            }
            assert!(!focused.is_some_and(|id| seen.contains(&id)), "a circle after {}", seen.len());
            seen.extend(focused);
        }
        ways.push(seen);
    }
    // All sliders with their fields, buttons, boxes and folds, equal in both directions.
    assert!(ways[0].len() > 45, "{} controls", ways[0].len());
    let sorted = |ids: &[egui::Id]| ids.iter().copied().collect::<std::collections::HashSet<_>>();
    assert_eq!(sorted(&ways[0]), sorted(&ways[1]));
}

#[test]
fn a_control_focused_by_a_key_is_scrolled_into_view() {
    for size in [egui::vec2(1000.0, 500.0), egui::vec2(1000.0, 700.0), PHONE] {
        for is_page in [false, true] {
            let mut harness = app(size, |_| {});
            if is_page {
                harness.state_mut().enable_page_navigation();
            }
            for _ in 0..40 {
                harness.key_press(egui::Key::Tab);
                harness.run();
                let Some(id) = harness.ctx.memory(egui::Memory::focused) else { break };
                let response = harness.ctx.read_response(id).unwrap();
                let seen = response.rect.intersect(response.interact_rect);
                let rect = response.rect;
                assert!(
                    seen.height() > 0.9 * rect.height(),
                    "{size} {is_page}: {seen:?} of {rect:?}"
                );
                assert!(rect.bottom() <= size.y, "{size} {is_page}: {rect:?}");
            }
        }
    }
}

#[test]
fn escape_and_a_choice_return_the_focus() {
    let mut harness = unfolded(|_| {});
    let about = |harness: &Harness<'static, App>| {
        harness.query_all_by_label("A preview, not a medical device.").count()
    };
    let button = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Button, "Help").is_focused()
    };
    harness.get_by_role_and_label(Role::Button, "Help").focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(about(&harness), 1);
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!((about(&harness), button(&harness)), (0, true));
    harness.step();
    assert_eq!(harness.state().focused().unwrap().0, "Help");
    // Open a box and choose an entry.
    harness.get_by_role_and_label(Role::ComboBox, "Resolution").focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    harness.key_press(egui::Key::Tab);
    harness.run();
    harness.key_press(egui::Key::Enter);
    settle(&mut harness);
    for _ in 0..3 {
        harness.step();
    }
    assert!(harness.get_by_role_and_label(Role::ComboBox, "Resolution").is_focused());
}
