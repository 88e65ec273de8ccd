//! A long solve: its progress, its clock, a pin that waits for it, its end by Cancel.

use super::*;

/// A plan that takes some ten seconds.
fn long(scene: &Scene) -> Scene {
    let mut long = scene.clone();
    long.set_springs(Springs::Nikolaev);
    long.solver.nodes_per_side = 513;
    long
}

/// Opens a plan and draws frames until its progress is shown.
fn open(harness: &mut Harness<'static, App>, scene: &Scene) {
    harness.state_mut().open(scene.to_json()).unwrap();
    wait_until(harness, "the progress", |harness| {
        harness.query_by_role_and_label(Role::Button, "Cancel").map(drop)
    });
}

#[test]
fn a_long_solve_shows_its_progress_and_can_be_cancelled() {
    let mut harness = app(WIDE, |_| {});
    let before = harness.state().session().scene().clone();
    let long = long(&before);
    focus_picture(&mut harness);
    open(&mut harness, &long);
    harness.get_by_role_and_label(Role::ProgressIndicator, "Progress of the solve");
    // Keys still act on the picture.
    assert!(harness.get_by_role_and_label(Role::Canvas, "3-D view").is_focused());
    // The previous figures are removed.
    harness.step();
    assert_eq!(harness.query_all_by_label("longer, at most").count(), 1);
    assert_eq!(harness.query_all_by_label("usual").count(), 0);
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &before);
    assert!(harness.state().outcome().is_some() && harness.state().session().can_redo());
    // Without a previous valid scene the solve stops and can be continued.
    let app = App::new(&egui::Context::default(), None, long.clone(), beside_window).unwrap();
    let mut harness = window(WIDE, 1, app);
    open(&mut harness, &long);
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    (0..3).for_each(|_| harness.step());
    assert!(!harness.state().session().is_working());
    assert_eq!(harness.state().outcome(), None);
    assert!(harness.state().summary().starts_with("Stopped"));
    harness.get_by_role_and_label(Role::Button, "Continue computing").click();
    (0..3).for_each(|_| harness.step());
    assert!(harness.state().session().is_working());
}

#[test]
fn the_clock_of_a_solve_starts_again_with_an_edit() {
    let mut harness = app(WIDE, |_| {});
    let long = long(harness.state().session().scene());
    open(&mut harness, &long);
    wait_until(&mut harness, "a second", |harness| text_with(harness, "Computing for 1 s"));
    harness.state_mut().set_plan("pinch_cm", "2.5").unwrap();
    harness.step();
    // The progress stays in sight, from its start.
    text_with(&harness, "Computing for 0 s").unwrap();
    harness.get_by_role_and_label(Role::Button, "Cancel");
}

#[test]
fn a_plan_pinned_during_its_solve_waits_for_its_numbers_and_an_edit_keeps_it() {
    let mut harness = app(WIDE, |_| {});
    let quick = harness.state().session().scene().clone();
    let plan = long(&quick);
    open(&mut harness, &plan);
    let pin_b = |harness: &mut Harness<'static, App>| {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
        harness.run_steps(3);
        harness.event(egui::Event::Text("pin this".to_owned()));
        harness.step();
        harness.key_press(egui::Key::Enter);
        harness.run_steps(3);
    };
    for by_key in [false, true] {
        if by_key {
            pin_b(&mut harness);
        } else {
            harness.get_by_role_and_label(Role::Button, "Pin as A").click();
            harness.run_steps(3);
        }
        assert_eq!(pins(&harness), ["A "]);
        harness.get_by_label("The plan is pinned; its numbers come once it is solved.");
        harness.get_by_label("A is being computed");
        if !by_key {
            harness.get_by_role_and_label(Role::Button, "Remove A").click();
            harness.run_steps(3);
        }
    }
    // Another plan is solved first, then the pinned one.
    harness.state_mut().open(quick.to_json()).unwrap();
    wait_until(&mut harness, "the plan", |harness| harness.state().outcome());
    let session = harness.state().session();
    assert_eq!((session.scene(), session.pins()[0].scene()), (&quick, &plan));
    assert!(session.is_solving_pins());
}

#[test]
fn cancel_ends_the_solve_of_the_pinned_plan_too_and_says_so() {
    let mut harness = app(WIDE, |_| {});
    let long = long(harness.state().session().scene());
    open(&mut harness, &long);
    harness.get_by_role_and_label(Role::Button, "Pin as A").click();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    settle(&mut harness);
    assert_eq!(pins(&harness), Vec::<String>::new());
    assert!(!harness.state().session().is_solving_pins());
    harness.get_by_label_contains("Pin A of the cancelled plan is removed.");
}
