//! The ruler on the picture: straight, along the skin, at rest.

use super::focus_picture;
use super::hands::{choose, click, desktop, is_painted, on_skin, picture, reading};
use eframe::egui::{Key, vec2};
use egui_kittest::kittest::Queryable;

#[test]
fn the_ruler_measures_straight_along_the_skin_and_at_rest() {
    let mut harness = desktop();
    let [a, b] = [vec2(-60.0, 30.0), vec2(20.0, -2.0)].map(|by| on_skin(&harness) + by);
    focus_picture(&mut harness);
    harness.key_press(Key::R);
    harness.run();
    harness.get_by_label("Ruler: click a point of the skin");
    click(&mut harness, a);
    harness.get_by_label("Ruler: click the second point");
    click(&mut harness, b);
    let read = reading(&harness, "Ruler: Straight").unwrap();
    let number = |after: &str| -> f64 {
        let (_, rest) = read.split_once(after).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let (straight, along, rest) = (number("Straight "), number("skin "), number("rest "));
    assert!(straight > 1.0 && along >= straight && rest > 1.0 && rest < along, "{read}");
    assert!(is_painted(&harness, "Straight "));
    // No values are kept meanwhile, and the command ends the ruler.
    assert_eq!(reading(&harness, "Kept values"), None);
    choose(&mut harness, "Ruler");
    assert_eq!(reading(&harness, "Ruler: "), None);
    choose(&mut harness, "Ruler");
    assert!(reading(&harness, "Ruler: ").is_some());
    focus_picture(&mut harness);
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(reading(&harness, "Ruler: "), None);
    assert!(!is_painted(&harness, "Straight "));
}

#[test]
fn a_click_of_the_ruler_beyond_the_computed_skin_says_where_the_ruler_works() {
    const ONLY: &str = "Ruler: only on the computed skin, which Stretch colours";
    let mut harness = desktop();
    let skin = on_skin(&harness);
    let outside = (1..60).map(|k| skin + vec2(0.0, 6.0 * k as f32)).find(|at| {
        harness.hover_at(*at);
        harness.run();
        reading(&harness, "Values at the pointer").is_some_and(|read| read.contains("Outside"))
    });
    let outside = outside.unwrap();
    focus_picture(&mut harness);
    harness.key_press(Key::R);
    harness.run();
    click(&mut harness, skin);
    assert!(harness.query_by_label(ONLY).is_none());
    click(&mut harness, outside);
    harness.get_by_label(ONLY);
    harness.hover_at(outside);
    harness.run();
    assert_eq!(
        reading(&harness, "Ruler: Outside").as_deref(),
        Some("Ruler: Outside the pocket (not computed)")
    );
    // The hint stays without a pointer, as after a tap, until the next end.
    harness.remove_cursor();
    harness.run();
    harness.get_by_label(ONLY);
    click(&mut harness, skin + vec2(20.0, -2.0));
    assert!(harness.query_by_label(ONLY).is_none());
    assert!(reading(&harness, "Ruler: Straight").is_some());
}

#[test]
fn the_reading_of_the_ruler_keeps_off_that_of_the_kept_point() {
    let mut harness = desktop();
    let skin = on_skin(&harness);
    for (kept, ends) in [
        (vec2(-20.0, 10.0), [vec2(-60.0, 30.0), vec2(20.0, -2.0)]),
        (vec2(-40.0, 30.0), [vec2(-60.0, 30.0), vec2(-20.0, 20.0)]),
        (vec2(10.0, -2.0), [vec2(-30.0, 10.0), vec2(-10.0, 5.0)]),
    ] {
        click(&mut harness, skin + kept);
        focus_picture(&mut harness);
        harness.key_press(Key::R);
        harness.run();
        for end in ends {
            click(&mut harness, skin + end);
        }
        let [kept, ruler] = ["Kept values: ", "Ruler: Straight"]
            .map(|name| harness.get_by_label_contains(name).rect());
        assert!(!kept.intersects(ruler), "{kept} {ruler}");
        assert!(picture(&harness).contains_rect(ruler), "{ruler}");
        harness.key_press(Key::R);
        harness.key_press(Key::Escape);
        harness.run();
    }
}

#[test]
fn the_reading_of_the_ruler_covers_neither_of_its_ends() {
    let mut harness = desktop();
    let skin = on_skin(&harness);
    for [a, b] in [
        [vec2(-60.0, -2.0), vec2(20.0, 50.0)],
        [vec2(20.0, 50.0), vec2(-60.0, -2.0)],
        [vec2(-60.0, 30.0), vec2(20.0, -2.0)],
    ] {
        focus_picture(&mut harness);
        harness.key_press(Key::R);
        harness.run();
        for end in [a, b] {
            click(&mut harness, skin + end);
        }
        let ruler = harness.get_by_label_contains("Ruler: Straight").rect();
        for end in [a, b] {
            assert!(!ruler.expand(4.0).contains(skin + end), "{ruler} {}", skin + end);
        }
        assert!(picture(&harness).contains_rect(ruler), "{ruler}");
        harness.key_press(Key::R);
        harness.run();
    }
}
