//! Frames of an app in a window: those until its rest, and the texts of the last one.

use eframe::egui;
use egui_kittest::Harness;
use implant_preview::app::App;

/// Runs until no repaint is requested and no solve is running.
pub(crate) fn settle(harness: &mut Harness<'static, App>) {
    for _ in 0..400 {
        harness.step();
        if !harness.state().session().is_working() {
            break;
        }
    }
    harness.run();
    assert!(!harness.state().session().is_working());
}

/// Texts of the last frame, those that are painted only included.
pub(crate) fn painted_texts(harness: &Harness<'static, App>) -> Vec<String> {
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) => Some(text.galley.text().to_owned()),
        _ => None,
    });
    texts.collect()
}

/// Visible texts of the last frame that are cut at their sides.
pub(crate) fn cut_texts(harness: &Harness<'static, App>) -> Vec<String> {
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) => Some((text.visual_bounding_rect(), shape.clip_rect, text)),
        _ => None,
    });
    texts
        .filter(|(rect, clip, _)| clip.y_range().intersects(rect.y_range()))
        .filter(|(rect, clip, _)| {
            rect.left() < clip.left() - 1.0 || rect.right() > clip.right() + 1.0
        })
        .map(|(_, _, text)| text.galley.text().to_owned())
        .collect()
}
