//! The answer: cards, sentence, summary, limits.

use super::gated::gated;
use super::*;

/// Visible texts of the last frame that end in "…" for want of room.
fn shortened_texts(harness: &Harness<'static, App>) -> Vec<String> {
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) if text.galley.elided => Some(text.galley.text().to_owned()),
        _ => None,
    });
    texts.collect()
}

#[test]
fn the_texts_of_the_cards_are_whole_with_and_without_sampled_patients() {
    for size in [DESKTOP, egui::vec2(1280.0, 800.0), egui::vec2(1024.0, 768.0), PHONE] {
        // A pressure whose range ends above 100 mmHg has the longest words.
        let mut harness = app(size, |scene| *scene = flat_plan());
        harness.state_mut().set_plan("skin", "tight").unwrap();
        if size == PHONE {
            press(&mut harness, "More");
        }
        wait_for_practice(&mut harness);
        for _ in 0..2 {
            let shortened = shortened_texts(&harness);
            let is_disclaimer = |text: &&String| text.starts_with("Not a medical device");
            assert!(shortened.iter().all(|text| is_disclaimer(&text)), "{size}: {shortened:?}");
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size}");
            wait_for_studies(&mut harness);
        }
        assert!(text_with(&harness, " of 10 patients").is_some(), "{size}");
        assert!(text_with(&harness, "over the implant's highest point").is_none(), "{size}");
    }
}

#[test]
fn the_first_plan_is_a_usual_one_with_every_card_computed() {
    let mut harness = researching(DESKTOP, |scene| *scene = Scene::first_plan());
    let scene = harness.state().session().scene().clone();
    assert_eq!((scene.implant.base_radius_mm, scene.pocket_radius_mm), (60.0, 70.0));
    let value = |harness: &Harness<'static, App>, name: &'static str| {
        harness.get_by_role_and_label(Role::SpinButton, name).value().unwrap()
    };
    for (field, text) in [
        ("Width (cm)", "12.0"),
        ("Volume (ml)", "225"),
        ("Projection (cm)", "3.0"),
        ("Pinch (cm)", "2.0"),
        ("Margin (cm)", "1.0"),
    ] {
        assert_eq!(value(&harness, field), text, "{field}");
    }
    harness.get_by_label("Cover 10 mm (6–17): skin 1.5 + fat 8.5");
    wait_for_practice(&mut harness);
    // A cover that is not thin has no level.
    assert_eq!(harness.query_all_by_label("usual").count(), 1);
    harness.get_by_label("below practice");
    harness.get_by_label("not thin");
    harness.get_by_label_contains("225 ml, 12 cm: below practice. Stretch 15 %, cover 8.");
    harness.get_by_label_contains("practice's 300 ml: 21 %");
    harness.get_by_label("Practice takes 300 ml");
    harness.get_by_label("standard model, normal accuracy");
    // The hint is gone after the first edit.
    let hint = "Change width, volume or pinch · drag the picture to turn it";
    harness.get_by_label(hint);
    type_into(&mut harness, "Width (cm)", "12,5");
    assert_eq!(harness.query_all_by_label(hint).count(), 0);
    harness.get_by_role_and_label(Role::Button, "Start over").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &scene);
}

#[test]
fn the_summary_describes_the_answer() {
    let (mut harness, gate) = gated(flat_plan());
    settle(&mut harness);
    // Before its end no study is passed off as done: one result arrives a frame.
    let studies = [
        ("Comparing with practice…", " The comparison with practice is still being computed."),
        ("Computing the largest volume…", " The largest volume is still being computed."),
        ("Computing the ranges…", " The ranges over patients are still being computed."),
        ("Up to date", " Up to date."),
    ];
    let mut seen = vec![];
    wait_until(&mut harness, "the end", |harness| {
        let summary = harness.state().summary();
        let at = studies.iter().position(|(status, _)| harness.query_by_label(status).is_some());
        let at = at.unwrap_or_else(|| panic!("no status: {summary}"));
        for (study, (_, words)) in studies.iter().enumerate() {
            assert_eq!(summary.contains(words), study == at, "{}: {summary}", studies[at].0);
        }
        if seen.last() != Some(&at) {
            seen.push(at);
        }
        gate.pass(1);
        (at == 3).then_some(())
    });
    assert_eq!(seen, [0, 1, 2, 3]);
    assert!(
        text_with(&harness, " patients, ").is_some() || text_with(&harness, " of 10 ").is_some()
    );
    let summary = harness.state().summary();
    assert!(summary.starts_with("300 ml implant, 12 cm wide. Skin stretch "), "{summary}");
    for words in [" percent, as practice.", ", at rest 10.0 mm.", " mmHg, usual.", " Up to date."] {
        assert!(summary.contains(words), "{summary}");
    }
    let stats = harness.state().stats();
    assert!(stats.converged && stats.frames > 0 && stats.solves == 1 && stats.work_units > 0.0);
}

#[test]
fn the_sentence_of_the_answer_has_size_and_figures_of_one_plan() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let sentence = |harness: &Harness<'static, App>| {
        let found = harness.get_by_label_contains(" ml, 12 cm: ");
        found.accesskit_node().label().or(found.accesskit_node().value()).unwrap()
    };
    wait_for_practice(&mut harness);
    let before = sentence(&harness);
    assert!(before.starts_with("300 ml, 12 cm: as practice. Stretch 14 %"), "{before}");
    harness.state_mut().set_plan("volume_ml", "400").unwrap();
    // Frame by frame, a draft included.
    let mut sentences = Vec::new();
    while harness.state().session().is_working() || sentences.len() < 3 {
        harness.step();
        sentences.push(sentence(&harness));
    }
    settle(&mut harness);
    let last = sentence(&harness);
    assert!(last.starts_with("400 ml, 12 cm: ") && last.contains("Stretch "), "{last}");
    for words in &sentences {
        let is_updating = words.ends_with("updating…");
        let is_old_figure = words.contains("Stretch 14 %");
        let is_old_size = words.starts_with("300 ml");
        assert!(is_updating || is_old_figure == is_old_size, "{words}");
    }
    assert!(!last.contains("Stretch 14 %"), "{last}");
}

#[test]
fn the_state_of_the_solve_is_unobtrusive_and_limits_are_stated() {
    let mut harness = unfolded(|scene| {
        scene.set_tissue_model(TissueModel::Sheet);
        scene.insertion = 0.5;
    });
    solved_status(&harness);
    let mut scene = harness.state().session().scene().clone();
    // Far beyond the failure strain of skin.
    scene.insertion = 1.0;
    scene.implant.base_radius_mm = 70.0;
    scene.implant.projection_mm = 120.0;
    scene.layers[0].curve = CurveSpec::Points {
        points: vec![[0.0, 0.0], [0.3, 60.0]],
        interpolation: Interpolation::Line,
    }
    .into();
    harness.state_mut().open(scene.to_json()).unwrap();
    settle(&mut harness);
    solved_status(&harness);
    harness.get_by_label("beyond");
    for source in [
        "skin tore at 54 ± 17 % (mean of 56 samples of excised back skin; Ní Annaidh and others, ",
        "Standing alone stretches the skin of the breast by up to 60 % in places (39 women; Norris",
        "(Tebbetts and Adams, Plast Reconstr Surg 116, 2005)",
        "30–60 mmHg were measured right after clinical filling of expanders.",
    ] {
        harness.get_by_label_contains(source);
    }
    // Warnings stand between the cards and the numbers.
    let warning =
        harness.get_by_label_contains("The stress–strain curve of skin was extrapolated").rect();
    let numbers = harness.get_by_label("Height of the breast mound").rect();
    assert!(
        (warning.left() - numbers.left()).abs() < 40.0 && warning.bottom() <= numbers.top() + 1.0
    );
}
