//! Notices over the picture: those of success leave by themselves, all are announced and whole after a resize.

use super::*;
use egui::accesskit::Live;

const OPENED: &str =
    "The picture is in the clipboard, as a long line that a narrow picture has to wrap.";

/// An app with a notice of success.
fn noticed() -> Harness<'static, App> {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    harness.state_mut().notify(OPENED);
    // The first frame of a box finds its size.
    harness.run_steps(2);
    harness
}

/// Runs frames for a time \[s\].
fn wait(harness: &mut Harness<'static, App>, seconds: f64) {
    let end = harness.ctx.input(|input| input.time) + seconds;
    while harness.ctx.input(|input| input.time) < end {
        harness.step();
    }
}

#[test]
fn a_notice_of_success_is_announced_and_leaves_by_itself() {
    let mut harness = noticed();
    let notice = harness.get_by_label(OPENED);
    assert_eq!(notice.accesskit_node().live(), Live::Polite);
    assert_eq!(harness.state().notice_in_words(), OPENED);
    wait(&mut harness, 4.0);
    harness.get_by_label(OPENED);
    wait(&mut harness, 12.0);
    assert!(harness.query_by_label(OPENED).is_none());
    assert_eq!(harness.state().notice_in_words(), "");
    // At rest again.
    harness.run();
}

#[test]
fn a_notice_under_the_pointer_stays() {
    let mut harness = noticed();
    harness.hover_at(harness.get_by_label(OPENED).rect().center());
    wait(&mut harness, 20.0);
    harness.get_by_label(OPENED);
}

#[test]
fn an_error_stays_until_it_is_closed() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    // A link that cannot be read.
    harness.state_mut().open_link("#plan=broken");
    harness.run_steps(2);
    let words = harness.state().notice_in_words();
    assert!(words.starts_with("Error: "), "{words}");
    wait(&mut harness, 40.0);
    let error = harness.get_by_label(&words);
    assert_eq!(error.accesskit_node().live(), Live::Assertive);
    press(&mut harness, "Close message");
    assert_eq!(harness.state().notice_in_words(), "");
}

#[test]
fn a_notice_is_whole_after_a_resize() {
    let mut harness = noticed();
    for size in [egui::vec2(1024.0, 768.0), PHONE, egui::vec2(844.0, 390.0), DESKTOP] {
        harness.state_mut().notify(OPENED);
        harness.set_size(size);
        harness.run_steps(3);
        let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        for rect in [
            harness.get_by_label(OPENED).rect(),
            harness.get_by_role_and_label(Role::Button, "Close message").rect(),
        ] {
            assert!(view.contains_rect(rect), "{size}: {rect:?} in {view:?}");
        }
        assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size}");
    }
}

#[test]
fn a_notice_covers_neither_scale_bar_nor_legend_nor_the_words_of_the_directions() {
    for size in [DESKTOP, egui::vec2(1024.0, 768.0), PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        press(&mut harness, "Stretch");
        harness.state_mut().notify(OPENED);
        harness.run_steps(3);
        let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        let notice = harness.get_by_label(OPENED).rect().expand(8.0);
        assert!(view.contains_rect(notice), "{size}: {notice} {view}");
        let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
            egui::Shape::Text(text) => Some((text.galley.text(), text.visual_bounding_rect())),
            _ => None,
        });
        let on_picture = texts.filter(|(_, rect)| view.contains_rect(*rect));
        let is_covered = |(text, rect): &(&str, egui::Rect)| {
            let is_kept = ["head", "feet", "midline", "side"].contains(text)
                || text.ends_with(" cm")
                || text.starts_with("Skin stretch [");
            is_kept && rect.intersects(notice)
        };
        let covered: Vec<_> = on_picture.filter(is_covered).collect();
        assert!(covered.is_empty(), "{size}: {covered:?} {notice}");
    }
}
