//! The largest volume that stays usual, and the marks on the rail of the volume.

use super::*;

/// Starts of the marks on the rail of the volume \[points\].
fn volume_marks(model: TissueModel) -> Vec<f32> {
    let mut harness = app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.set_tissue_model(model);
    });
    let rail = harness.get_by_role_and_label(Role::Slider, "Volume (ml)").rect();
    let marks = |harness: &Harness<'static, App>| -> Vec<f32> {
        let lines = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
            egui::Shape::LineSegment { points, stroke } => Some((*points, stroke.width)),
            _ => None,
        });
        let is_mark = |points: &[egui::Pos2; 2], width: f32| {
            (width - 3.0).abs() < 1e-3 && points.iter().all(|point| rail.contains(*point))
        };
        lines
            .filter(|(points, width)| is_mark(points, *width))
            .map(|(points, _)| points[0].x)
            .collect()
    };
    harness.hover_at(rail.center());
    wait_until(&mut harness, "a mark", |harness| {
        Some(marks(harness)).filter(|marks| !marks.is_empty())
    })
}

#[test]
fn the_largest_volume_that_stays_usual_is_known_without_an_edit_and_is_taken_by_a_press() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        let below = if size == PHONE { "Projection (cm)" } else { "Pinch (cm)" };
        let place = |harness: &Harness<'static, App>| {
            harness.get_by_role_and_label(Role::SpinButton, below).rect()
        };
        let before = place(&harness);
        let words = largest_usual(&mut harness);
        assert_eq!(place(&harness), before, "{size}: the plan moves");
        assert!(harness.state().summary().contains(&words), "{words}");
        // On a phone the line may be scrolled out of sight.
        harness.get_by_label(&words).focus();
        harness.run();
        harness.key_press(egui::Key::Enter);
        settle(&mut harness);
        let volume = harness.state().outcome().unwrap().implant_volume_ml;
        assert!((volume - volume_of(&words)).abs() < 1e-6, "{words}: {volume}");
        // The volume alone changes; one step of the history.
        assert_eq!(harness.state().session().scene().implant.base_radius_mm, 60.0);
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
        assert!(!harness.state().session().can_undo());
        // An expander is not compared with practice, and the sentence has its reason.
        press(&mut harness, "expander");
        harness.run();
        let words = wait_until(&mut harness, "the largest volume", |harness| {
            text_with(harness, " stays usual on 12 cm; ")
        });
        assert!(words.starts_with("Filled at once, up to "), "{words}");
        assert!(words.ends_with(" on 13 cm (no practice for expanders)."), "{words}");
    }
}

#[test]
fn the_largest_volume_that_stays_usual_is_that_of_single_solves() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    press(&mut harness, "tight");
    settle(&mut harness);
    let words = largest_usual(&mut harness);
    let largest = volume_of(&words);
    let practice = |plan: &Scene| {
        let practice = Practice::new(plan, &PracticeTable::default()).unwrap();
        let strain = |scene: &Scene| simulate(scene).unwrap().strain.unwrap().max_principal;
        practice.scenes().each_ref().map(strain)[2]
    };
    let is_usual = |width: f64, volume: f64| {
        let mut scene = harness.state().session().scene().clone();
        scene.solver.nodes_per_side = 65;
        scene.pocket_radius_mm += 0.5 * width - scene.implant.base_radius_mm;
        scene.implant.base_radius_mm = 0.5 * width;
        let size = Size::of_width_and_volume(width, volume).unwrap();
        scene.implant.projection_mm = size.projection_mm();
        let outcome = simulate(&scene).unwrap();
        let strain = outcome.strain.unwrap().max_principal;
        let is_above = strain > practice(&scene);
        let is_thin = outcome.cover_mm.is_some_and(|cover| bands::cover(cover.least).is_some());
        !is_thin
            && !is_above
            && bands::pressure_band(outcome.contact_pressure_mmhg.unwrap().max) == 0
    };
    assert!(is_usual(120.0, largest - 10.0) && !is_usual(120.0, largest + 15.0), "{words}");
    // At the next width, with the same margin of the pocket.
    let wider = words.rsplit_once("; ").unwrap().1.strip_suffix(" ml on 13 cm.").unwrap();
    let wider: f64 = wider.parse().unwrap();
    assert!(is_usual(130.0, wider - 10.0) && !is_usual(130.0, wider + 15.0), "{words}");
}

#[test]
fn the_rail_of_the_volume_marks_where_the_words_change() {
    // Skin on fat has no answer beyond a volume; a sheet is high, then very high from smaller volumes on.
    let (layered, sheet) = (volume_marks(TissueModel::Layered), volume_marks(TissueModel::Sheet));
    assert!(
        sheet.len() >= 2 && sheet[0] < sheet[1] && sheet[0] < layered[0],
        "{layered:?}, {sheet:?}"
    );
}
