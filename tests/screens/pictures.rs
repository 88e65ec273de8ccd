//! What stands on the pictures: words of the directions, the scale of the cross-section.

use super::*;
use implant_preview::scene::Side;

/// The places of the words of the directions on the picture, of those that are drawn.
fn directions(harness: &Harness<'static, App>) -> Vec<(String, egui::Pos2)> {
    let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) => {
            Some((text.galley.text(), text.visual_bounding_rect(), shape.clip_rect))
        }
        _ => None,
    });
    let words = ["head", "feet", "midline", "side"];
    texts
        .filter(|(text, ..)| words.contains(text))
        .filter(|(_, rect, clip)| view.contains_rect(*rect) && clip.contains_rect(*rect))
        .map(|(text, rect, _)| (text.to_owned(), rect.center()))
        .collect()
}

#[test]
fn the_words_of_the_directions_stand_at_the_edges_of_the_picture_on_every_plan() {
    for size in [DESKTOP, egui::vec2(1024.0, 768.0), PHONE] {
        for (shape, is_right) in [("round", false), ("anatomical", false), ("round", true)] {
            let mut harness = app(size, |scene| {
                *scene = flat_plan();
                scene.side = is_right.then_some(Side::Right);
            });
            if size == PHONE {
                press(&mut harness, "Implant");
            }
            press(&mut harness, shape);
            press(&mut harness, "Front");
            harness.run_steps(40);
            let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
            let words = directions(&harness);
            let at = |word: &str| words.iter().find(|(text, _)| text == word).map(|(_, at)| *at);
            let [head, feet] = ["head", "feet"].map(|word| at(word).unwrap());
            let [left, right] = ["midline", "side"].map(|word| at(word).unwrap());
            let [midline, side] = if is_right { [right, left] } else { [left, right] };
            let third = view.size() / 3.0;
            assert!(head.y < view.top() + third.y, "{size} {shape}: {words:?} in {view:?}");
            assert!(feet.y > view.bottom() - third.y, "{size} {shape}: {words:?} in {view:?}");
            assert!(midline.x < view.left() + third.x, "{size} {shape}: {words:?} in {view:?}");
            assert!(side.x > view.right() - third.x, "{size} {shape}: {words:?} in {view:?}");
        }
    }
}

/// Width of the cross-section's scale bar for a length \[points\].
fn bar(harness: &Harness<'static, App>) -> (String, f32) {
    let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
    let text = harness.output().shapes.iter().find_map(|shape| match &shape.shape {
        egui::Shape::Text(text) if strip.contains_rect(text.visual_bounding_rect()) => {
            let words = text.galley.text();
            (words.ends_with(" cm") || words.ends_with(" mm")).then(|| words.to_owned())
        }
        _ => None,
    });
    // The line of the bar is the longest level one in the lower left corner.
    let lines = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::LineSegment { points: [a, b], .. } => Some((*a, *b)),
        _ => None,
    });
    let level = lines.filter(|(a, b)| (a.y - b.y).abs() < 0.1 && strip.contains(*a));
    let level = level.filter(|(a, _)| (a.x - strip.left() - 16.0).abs() < 0.5);
    (text.unwrap(), level.map(|(a, b)| (b.x - a.x).abs()).fold(0.0, f32::max))
}

#[test]
fn the_cross_section_keeps_its_scale_from_plan_to_plan() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let scale = bar(&harness);
    assert!(scale.1 > 20.0, "{scale:?}");
    for volume in ["225", "400", "452", "150"] {
        type_into(&mut harness, "Volume (ml)", volume);
        assert_eq!(bar(&harness), scale, "{volume} ml");
    }
    // A plan that does not fit makes it smaller, for good.
    type_into(&mut harness, "Width (cm)", "18");
    type_into(&mut harness, "Projection (cm)", "8,5");
    let smaller = bar(&harness);
    assert_ne!(smaller, scale);
    press(&mut harness, "Start over");
    assert_eq!(bar(&harness), smaller);
}

#[test]
fn without_a_cut_its_direction_waits() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let is_able = |harness: &Harness<'static, App>| {
        let field = harness.get_by_role_and_label(Role::SpinButton, "Direction of the cut");
        !field.accesskit_node().is_disabled()
    };
    assert!(is_able(&harness));
    harness.get_by_role_and_label(Role::ComboBox, "Cut").click();
    harness.run_steps(3);
    harness.get_by_label("No cut").click();
    harness.run_steps(3);
    assert!(!is_able(&harness));
}
