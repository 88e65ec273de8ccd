//! A plan without an answer: what it means in words, and the nearest plan with an answer as a button. The choice of the fat
//! and the plot of its curve.

use super::*;
use implant_preview::curve::Fat;

const TITLE: &str = "No answer";
const LOOKING: &str = "Searching for the nearest plan with an answer…";
const FATS: [&str; 4] = ["Soft", "Usual", "Firm", "Nikolaev 2013"];

/// The flat plan with very tight skin over the paper's fat, which has no shape.
fn without_answer(scene: &mut Scene) {
    *scene = flat_plan();
    let size = Size::of_width_and_volume(120.0, 350.0).unwrap();
    scene.implant.projection_mm = size.projection_mm();
    scene.layers[1].curve = CurveSpec::Adipose {}.into();
    scene.layers[1].poisson_ratio = 0.45;
    scene.layers[0].curve.strain_scale = 0.15;
}

/// Runs frames until the search of the nearest plan has ended.
fn wait(harness: &mut Harness<'static, App>) {
    harness.step();
    wait_until(harness, "the end of the search", |harness| {
        harness.query_by_label(LOOKING).is_none().then_some(())
    });
    harness.run();
}

/// The button of the nearest plan by volume, and its volume \[ml\].
fn offer(harness: &Harness<'static, App>) -> (String, f64) {
    let buttons = harness.query_all_by(|node| {
        node.role() == Role::Button && node.label().is_some_and(|label| label.starts_with("Use "))
    });
    let labels: Vec<String> =
        buttons.filter_map(|button| button.accesskit_node().label()).collect();
    let found = labels.iter().find_map(|label| {
        let volume = label.strip_prefix("Use ")?.strip_suffix(" ml")?.parse().ok()?;
        Some((label.clone(), volume))
    });
    found.unwrap_or_else(|| panic!("no button among {labels:?}"))
}

#[test]
fn a_plan_without_an_answer_offers_the_nearest_plan_with_one() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, without_answer);
        let before = harness.state().session().scene().clone();
        assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
        assert!(harness.get_all_by_label(TITLE).count() > 0, "{size}");
        let words =
            "The skin is too tight for 350 ml on 12 cm, and fat this soft gives way under it.";
        assert!(harness.get_all_by_label(words).count() > 0, "{size}");
        assert!(harness.state().summary().contains(words));
        // The reason of the solver is folded; the cards without figures are gone.
        assert!(harness.query_by_label_contains("The solver found no shape").is_none());
        assert_eq!(harness.query_all_by_label("longer, at most").count(), 0);
        wait(&mut harness);
        harness.get_by_label("The nearest plans with an answer:");
        let (button, volume) = offer(&harness);
        assert!((100.0..350.0).contains(&volume), "{button}");
        assert!(harness.state().summary().contains(&button));
        harness.get_by_role_and_label(Role::Button, &button).click();
        settle(&mut harness);
        let outcome = harness.state().outcome().unwrap();
        assert_eq!(outcome.status, Status::Converged);
        assert!((outcome.implant_volume_ml - volume).abs() < 1e-6);
        assert_eq!(harness.query_all_by_label(TITLE).count(), 0);
        let after = harness.state().session().scene().clone();
        assert_eq!(after.implant.base_radius_mm, before.implant.base_radius_mm);
        // One step of the history.
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
        assert_eq!(harness.state().session().scene(), &before);
        assert!(!harness.state().session().can_undo());
    }
}

#[test]
fn a_plan_without_an_answer_offers_the_largest_that_stays_usual_first() {
    let mut harness = researching(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.implant.projection_mm = 119.0;
    });
    assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
    let beyond = "Beyond the sizes sold: the highest profile on 12 cm has 484 ml.";
    assert!(harness.query_all_by_label(beyond).count() > 0);
    const WORDS: &str = " ml, the most within practice's stretch";
    // Without any input, after the search of the nearest plans.
    wait_until(&mut harness, "the largest volume", |harness| text_with(harness, WORDS));
    assert!(harness.query_by_label(LOOKING).is_none());
    harness.run();
    let button = harness.get_by_label_contains(WORDS);
    let label = button.accesskit_node().label().unwrap();
    let volume: f64 =
        label.strip_prefix("Use ").unwrap().strip_suffix(WORDS).unwrap().parse().unwrap();
    // Before the nearest plan with an answer, which is larger and under more pressure.
    let (nearest, nearest_volume) = offer(&harness);
    let nearest = harness.get_by_role_and_label(Role::Button, &nearest).rect();
    let place = |rect: egui::Rect| (rect.top(), rect.left());
    assert!(place(button.rect()) < place(nearest) && volume < nearest_volume, "{label}");
    button.click();
    settle(&mut harness);
    let outcome = harness.state().outcome().unwrap();
    assert!((outcome.implant_volume_ml - volume).abs() < 1e-6);
    wait_for_practice(&mut harness);
    harness.get_by_label_contains(" ml, 12 cm: as practice. ");
}

#[test]
fn a_plan_beyond_the_sizes_sold_says_so_during_its_solve() {
    const WORDS: &str = "Beyond the sizes sold: the highest profile on 12 cm has 484 ml.";
    let mut harness = app(DESKTOP, |_| {});
    let plan = |ratio: f64| {
        let mut scene = Scene::opening();
        scene.implant.projection_mm = ratio * scene.implant.base_radius_mm;
        scene
    };
    let beyond = plan(1.3);
    let mut named = beyond.clone();
    named.implant_reference = "A size of a shelf".to_owned();
    for (scene, is_said) in [(beyond, true), (plan(1.0), false), (named, false)] {
        harness.state_mut().open(scene.to_json()).unwrap();
        harness.step();
        assert!(harness.state().session().is_working());
        assert_eq!(harness.query_by_label(WORDS).is_some(), is_said, "{scene:?}");
        assert_eq!(harness.state().summary().contains(WORDS), is_said);
    }
    settle(&mut harness);
    assert!(harness.query_by_label(WORDS).is_none());
}

#[test]
fn a_plan_without_an_answer_offers_a_wider_base_of_the_same_volume() {
    let mut harness = app(DESKTOP, without_answer);
    let before = harness.state().session().scene().clone();
    let volume = harness.state().outcome().unwrap().implant_volume_ml;
    assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
    wait(&mut harness);
    let button = harness.get_by(|node| {
        node.role() == Role::Button
            && node.label().is_some_and(|label| label.starts_with("Widen to "))
    });
    let label = button.accesskit_node().label().unwrap();
    let width: f64 = label["Widen to ".len()..].strip_suffix(" cm").unwrap().parse().unwrap();
    assert!(harness.state().summary().contains(&label));
    button.click();
    settle(&mut harness);
    let outcome = harness.state().outcome().unwrap();
    assert_eq!(outcome.status, Status::Converged);
    assert!((outcome.implant_volume_ml - volume).abs() < 1e-6);
    let after = harness.state().session().scene();
    assert!((after.implant.base_radius_mm - 5.0 * width).abs() < 1e-9);
    let margin = |scene: &Scene| scene.pocket_radius_mm - scene.implant.base_radius_mm;
    assert!((margin(after) - margin(&before)).abs() < 1e-9);
}

#[test]
fn the_picture_of_the_last_answer_stays_with_its_size() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| {
            without_answer(scene);
            scene.implant.projection_mm = 13.0;
        });
        let before = harness.state().session().scene().clone();
        assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
        let json = |projection: f64| {
            let mut scene = before.clone();
            scene.implant.projection_mm = projection;
            serde_json::to_string(&scene).unwrap()
        };
        harness.state_mut().open(json(50.0)).unwrap();
        settle(&mut harness);
        assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
        let line = "The picture is of the last plan with an answer: 98 ml on 12 cm.";
        let words = harness.get_by_label(line).rect();
        let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        assert!(picture.contains_rect(words));
        // The box covers little of the picture.
        let titles: Vec<egui::Rect> =
            harness.get_all_by_label(TITLE).map(|title| title.rect()).collect();
        let title = titles.iter().find(|title| picture.contains_rect(**title)).unwrap();
        assert!(title.top() > picture.top() + 0.4 * picture.height(), "{title:?} {picture:?}");
        // A plan without an answer is no last answer.
        harness.state_mut().open(json(52.0)).unwrap();
        settle(&mut harness);
        assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
        harness.get_by_label(line);
        // Back in one step, or any other plan.
        if size == DESKTOP {
            wait(&mut harness);
            harness.get_by_role_and_label(Role::Button, "Back to 98 ml on 12 cm").click();
            settle(&mut harness);
            assert_eq!(harness.state().session().scene(), &before);
            assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
        }
        harness.state_mut().open(json(14.0)).unwrap();
        settle(&mut harness);
        assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
        assert!(harness.query_by_label_contains("last plan with an answer").is_none());
    }
}

#[test]
fn the_technical_reason_is_folded() {
    let mut harness = app(WIDE, without_answer);
    wait(&mut harness);
    unfold(&mut harness, "Technical details");
    harness.get_by_label_contains("The solver found no shape");
}

#[test]
fn an_edit_ends_the_search() {
    let mut harness = app(DESKTOP, without_answer);
    harness.step();
    type_into(&mut harness, "Volume (ml)", "100");
    assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
    for text in [TITLE, LOOKING] {
        assert_eq!(harness.query_all_by_label(text).count(), 0, "{text}");
    }
    // Another plan without an answer has a search of its own.
    type_into(&mut harness, "Volume (ml)", "355");
    assert!(harness.get_all_by_label_contains("too tight for 355 ml on 12 cm").count() > 0);
    wait(&mut harness);
    let (_, volume) = offer(&harness);
    assert!(volume < 355.0);
}

#[test]
fn a_plan_that_is_not_fully_inserted_is_inserted_less() {
    let mut harness = app(DESKTOP, |scene| {
        without_answer(scene);
        scene.implant.projection_mm = 60.0;
        scene.insertion = 0.9;
    });
    assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
    wait(&mut harness);
    let button = harness
        .query_all_by_label_contains("Insert to ")
        .filter_map(|node| node.accesskit_node().label())
        .find(|label| label.starts_with("Insert to "))
        .unwrap();
    harness.get_by_role_and_label(Role::Button, &button).click();
    settle(&mut harness);
    assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
    let percent = format!("Insert to {:.0} %", 100.0 * harness.state().session().scene().insertion);
    assert_eq!(percent, button);
}

/// The chosen fats.
fn chosen(harness: &Harness<'static, App>) -> Vec<&'static str> {
    let is_chosen = |name: &&str| {
        let chip = harness.get_by_role_and_label(Role::Button, name);
        chip.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
    };
    FATS.into_iter().filter(is_chosen).collect()
}

#[test]
fn the_fat_is_chosen_among_what_was_measured_and_the_papers() {
    let mut harness = researching(WIDE, |scene| *scene = flat_plan());
    let opening = harness.state().session().scene().clone();
    unfold(&mut harness, "Tissue");
    assert_eq!(chosen(&harness), ["Usual"]);
    for (name, curve, poisson_ratio) in [
        ("Soft", CurveSpec::Fat { variant: Fat::Low }, 0.49),
        ("Firm", CurveSpec::Fat { variant: Fat::High }, 0.49),
        ("Nikolaev 2013", CurveSpec::Adipose {}, 0.45),
    ] {
        press(&mut harness, name);
        let fat = harness.state().session().scene().layers[1].clone();
        assert_eq!((fat.curve, fat.poisson_ratio), (curve.into(), poisson_ratio));
        assert_eq!(fat.thickness_mm, opening.layers[1].thickness_mm);
        assert_eq!(chosen(&harness), [name]);
        assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
    }
    press(&mut harness, "Usual");
    assert_eq!(harness.state().session().scene(), &opening);
    // Another curve is none of the choices.
    let mut other = opening.clone();
    other.layers[1].curve = CurveSpec::Linear { modulus_kpa: 4.0 }.into();
    harness.state_mut().open(other.to_json()).unwrap();
    settle(&mut harness);
    assert_eq!(chosen(&harness), [""; 0]);
    // Without fat there is nothing to choose.
    other.layers[1].tissue = "muscle".to_owned();
    harness.state_mut().open(other.to_json()).unwrap();
    settle(&mut harness);
    for name in FATS {
        assert!(harness.query_by_role_and_label(Role::Button, name).is_none(), "{name}");
    }
}

#[test]
fn the_curve_of_the_fat_is_plotted_measured_and_extrapolated() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    let plot = |end: u32| {
        format!("Curve of fat. Solid: measured, to {end} % strain. Dashed: extrapolated.")
    };
    harness.get_by_role_and_label(Role::Image, &plot(30));
    harness.get_by_label("Solid: measured, to 30 % strain. Dashed: extrapolated.");
    // The scale of the strain applies.
    let mut scaled = harness.state().session().scene().clone();
    scaled.layers[1].curve.strain_scale = 0.5;
    harness.state_mut().open(scaled.to_json()).unwrap();
    settle(&mut harness);
    harness.get_by_role_and_label(Role::Image, &plot(15));
    // Every preset has a plot, curves with parameters have none.
    assert_eq!(harness.query_all_by_role(Role::Image).count(), 2);
    scaled.layers[1].curve = CurveSpec::Linear { modulus_kpa: 4.0 }.into();
    harness.state_mut().open(scaled.to_json()).unwrap();
    settle(&mut harness);
    assert_eq!(harness.query_all_by_role(Role::Image).count(), 1);
}
