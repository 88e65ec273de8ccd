//! Drags, drafts and undo.

use super::*;

#[test]
fn a_drag_displays_a_draft_within_a_thousandth_and_then_the_final_shape() {
    for start in both() {
        let mut scene = start.clone();
        scene.solver.nodes_per_side = 129;
        scene.solver.tolerance = 1e-5;
        let mut session = Session::new(scene).unwrap();
        settle(&mut session);
        edit(&mut session, 1, |scene| scene.insertion = 0.9);
        if session.has_coarser_grid() {
            assert_eq!(session.advance(&mut || false), Progress::Working);
            assert_eq!(session.coarser_nodes_per_side(), Some(65));
        }
        // Without a pause, a slice ends at the draft.
        assert_eq!(session.advance(&mut || false), Progress::Working);
        assert_eq!(session.solver().displayed(), Displayed::Draft);
        assert!(session.is_working());
        let draft = session.shape().to_vec();
        let measured = session.outcome().unwrap();
        assert!((measured.projection_mm.unwrap() - 0.9 * 55.0).abs() < 0.055);
        assert!(measured.solver.estimated_position_error.unwrap() <= 1e-3);
        assert_eq!(session.advance(&mut || false), Progress::Done);
        assert_eq!(session.outcome().unwrap().status, Status::Converged);
        let moved = draft.iter().zip(session.shape()).map(|(a, b)| a.distance(*b));
        let moved = moved.fold(0.0, f64::max) / 55.0;
        assert!(moved > 0.0 && moved < 1e-3, "{moved:.1e}");
    }
}

#[test]
fn a_drag_of_layered_tissue_shows_the_results_of_a_coarser_grid_and_ends_on_its_own() {
    let mut scene = Scene::opening();
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (129, 1e-3);
    let mut session = Session::new(scene.clone()).unwrap();
    settle(&mut session);
    assert_eq!(
        (session.coarser_nodes_per_side(), session.counters().coarse_work_units),
        (None, 0.0)
    );
    let exact = |scene: &Scene| {
        let mut other = Session::new(scene.clone()).unwrap();
        settle(&mut other);
        other
    };
    for step in 1..=4 {
        edit(&mut session, 1, |scene| scene.implant.projection_mm += 0.3);
        let edited = work(&mut session, |session| {
            assert!(session.is_on_coarser_grid() && !session.is_outcome_present());
            assert_eq!(session.problem().sheet().nodes_per_side(), 129);
            assert_eq!(session.advance(&mut || false), Progress::Working);
        });
        // Not a step on the grid of 129 nodes; the first edit has no solution to continue from.
        assert_eq!((edited.work_units, edited.measurements, edited.previews), (0.0, 1, 1));
        let most = if step == 1 { 60.0 } else { 35.0 };
        assert!(edited.coarse_work_units < most, "{step}: {}", edited.coarse_work_units);
        assert_eq!(session.displayed(), Displayed::Coarse { nodes_per_side: 65 });
        assert!(session.is_outcome_present() && session.result().is_none());
        let coarse = session.outcome().unwrap();
        assert_eq!(coarse.solver.nodes_per_side, 65);
        assert!(coarse.solver.estimated_discretisation_error.unwrap() < 0.01);
        assert!(coarse.warnings.iter().all(|warning| !warning.contains("rounded")));
    }
    let coarse = session.outcome().unwrap().clone();
    settle(&mut session);
    let (own, other) = (session.outcome().unwrap(), exact(session.scene()));
    assert_eq!((session.coarser_nodes_per_side(), own.solver.nodes_per_side), (None, 129));
    assert_eq!(session.shape(), other.shape());
    let of = |outcome: &Outcome| outcome.strain.as_ref().unwrap().max_principal;
    let ratio = of(&coarse) / of(own);
    assert!((0.97..1.03).contains(&ratio), "{ratio}");
}

#[test]
fn a_scene_without_an_answer_on_the_coarser_grid_is_solved_on_its_own() {
    let mut session = Session::new(Scene::opening()).unwrap();
    settle(&mut session);
    edit(&mut session, 1, |scene| {
        scene.implant.projection_mm = 75.0;
        scene.implant.base_radius_mm = 30.0;
    });
    assert_eq!(session.advance(&mut || false), Progress::Working);
    assert_eq!((session.coarser_nodes_per_side(), session.is_on_coarser_grid()), (None, false));
    assert!(session.is_working());
    // The next plan with an answer shows its coarser grid again.
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.advance(&mut || false), Progress::Working);
    assert_eq!(session.coarser_nodes_per_side(), Some(65));
}

#[test]
fn a_short_slice_displays_the_solution_of_a_coarser_grid() {
    // The patch of layered tissue has fewer nodes over the dome.
    for (start, (slice, bound)) in both().into_iter().zip([(30, 0.15), (40, 0.05)]) {
        let mut scene = start;
        scene.solver.nodes_per_side = 129;
        let mut session = Session::new(scene).unwrap();
        let mut pieces = 0;
        let mut pause = || {
            pieces += 1;
            pieces == slice
        };
        assert_eq!(session.advance(&mut pause), Progress::Working);
        let Displayed::Coarse { nodes_per_side } = session.solver().displayed() else {
            panic!("{:?}", session.solver().displayed())
        };
        assert!((17..129).contains(&nodes_per_side), "{nodes_per_side}");
        assert_eq!(session.counters().previews, 1);
        let coarse = session.shape().to_vec();
        settle(&mut session);
        let moved = coarse.iter().zip(session.shape()).map(|(a, b)| a.distance(*b));
        let moved = moved.fold(0.0, f64::max) / 55.0;
        assert!(moved < bound, "{moved:.1e}");
    }
}

#[test]
fn a_cancelled_gesture_leaves_no_step() {
    let mut session = Session::new(small()).unwrap();
    edit(&mut session, 1, |scene| scene.insertion = 0.8);
    let kept = session.scene().clone();
    for k in 1..=3 {
        edit(&mut session, 2, |scene| scene.insertion = 0.1 * f64::from(k));
    }
    // Another gesture is not the last one.
    session.apply(Command::CancelGesture(1)).unwrap();
    assert_ne!(session.scene(), &kept);
    session.apply(Command::CancelGesture(2)).unwrap();
    session.apply(Command::CancelGesture(2)).unwrap();
    assert_eq!(session.scene(), &kept);
    assert!(session.can_undo() && !session.can_redo());
    // An edit to an equal scene is no step, and cancelling takes none back.
    edit(&mut session, 3, |_| {});
    session.apply(Command::CancelGesture(3)).unwrap();
    assert_eq!(session.scene(), &kept);
}

#[test]
fn a_gesture_is_one_step_of_undo() {
    let mut session = Session::new(small()).unwrap();
    for k in 1..=5 {
        edit(&mut session, 1, |scene| scene.insertion = 1.0 - 0.1 * f64::from(k));
    }
    edit(&mut session, 2, |scene| scene.layers.push(Layer::adipose()));
    assert_eq!(session.scene().layers.len(), 3);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.scene().layers.len(), 2);
    assert!((session.scene().insertion - 0.5).abs() < 1e-12);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.scene(), &small());
    assert!(!session.can_undo() && session.can_redo());
    session.apply(Command::Redo).unwrap();
    session.apply(Command::Redo).unwrap();
    assert_eq!(session.scene().layers.len(), 3);
    assert!(!session.can_redo());
}
