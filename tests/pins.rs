//! Pins: nothing is solved twice, undo leaves pins alone, files with pins, invalid pins.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::measure::{Outcome, Status};
use implant_preview::scene::pins::{MAX_PINS, pins_from_json, pins_json};
use implant_preview::scene::{Document, Layer, Letter, PinnedScene, Scene, Side, Springs};
use implant_preview::session::{Command, CommandError, Session};
use implant_preview::solve::Progress;
use serde_json::{Value, json};
use std::sync::Arc;

#[path = "pins/files.rs"]
mod files;

fn small() -> Scene {
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 33;
    scene
}

fn settled(scene: Scene) -> Session {
    let mut session = Session::new(scene).unwrap();
    settle(&mut session);
    session
}

fn small_sheet() -> Scene {
    Scene { solver: small().solver, ..Scene::sheet() }
}

/// Adipose alone, too much stretched for the paper's springs.
fn unstable() -> Scene {
    Scene { springs: Springs::Nikolaev, layers: vec![Layer::paper_adipose()], ..small_sheet() }
}

fn settle(session: &mut Session) {
    while session.advance(&mut || true) == Progress::Working {}
}

fn settle_pins(session: &mut Session) {
    while session.advance_pins(&mut || true) == Progress::Working {}
}

fn edit(session: &mut Session, change: impl FnOnce(&mut Scene)) {
    let mut scene = session.scene().clone();
    change(&mut scene);
    session.apply(Command::Edit { scene: Box::new(scene), gesture: 1 }).unwrap();
}

fn insertion(insertion: f64) -> impl Fn(&mut Scene) {
    move |scene| scene.insertion = insertion
}

fn pin(session: &mut Session) {
    session.apply(Command::Pin).unwrap();
}

fn open(session: &mut Session, letter: Letter) {
    session.apply(Command::OpenPin(letter)).unwrap();
}

fn letters(session: &Session) -> Vec<Letter> {
    session.pins().iter().map(implant_preview::session::Pin::letter).collect()
}

/// Solves started, and work done.
fn solved(session: &Session) -> (u64, f64) {
    (session.counters().solves, session.counters().work_units)
}

#[test]
fn a_pin_without_a_side_has_that_of_the_plan_and_none_in_a_file() {
    let mut session = settled(small());
    pin(&mut session);
    let of_pin = |session: &Session| session.pins()[0].scene().side;
    // A first choice, its correction, and back.
    for side in [Some(Side::Left), Some(Side::Right), None, Some(Side::Left)] {
        edit(&mut session, |scene| scene.side = side);
        assert_eq!(of_pin(&session), side);
    }
    let plan = session.scene().clone();
    assert!(session.pins()[0].scene().is_same_plan(&plan), "a second pin of this plan");
    open(&mut session, Letter::A);
    assert_eq!(session.scene().side, Some(Side::Left));
    session.apply(Command::Undo).unwrap();
    assert_eq!((session.scene().side, of_pin(&session)), (None, None));
    let kept = session.pinned_scenes();
    assert_eq!(kept[0].scene.side, None);
    let mut next = Session::new(plan).unwrap();
    next.set_pins(kept).unwrap();
    assert_eq!(of_pin(&next), Some(Side::Left));
}

#[test]
fn a_pin_of_its_own_side_keeps_it_and_brings_it_back() {
    let mut session = settled(Scene { side: Some(Side::Left), ..small() });
    pin(&mut session);
    edit(&mut session, |scene| scene.side = Some(Side::Right));
    assert_eq!(session.pins()[0].scene().side, Some(Side::Left));
    open(&mut session, Letter::A);
    assert_eq!(session.scene().side, Some(Side::Left));
}

#[test]
fn a_pin_of_a_solved_scene_is_the_same_solution_without_any_work() {
    let mut session = settled(small());
    let (solution, before) = (Arc::clone(session.solution()), session.counters());
    pin(&mut session);
    settle_pins(&mut session);
    let [only] = session.pins() else { panic!("one pin") };
    assert!(Arc::ptr_eq(only.solution().unwrap(), &solution));
    assert_eq!((only.letter(), only.outcome()), (Letter::A, session.outcome()));
    let mut after = session.counters();
    assert_eq!(after.shared, before.shared + 1);
    after.shared = before.shared;
    assert_eq!(after, before);
    assert!(!session.can_undo());
}

#[test]
fn opening_a_pin_solves_nothing_and_is_one_step_of_the_history() {
    let mut session = settled(small());
    pin(&mut session);
    let pinned = Arc::clone(session.solution());
    edit(&mut session, insertion(0.6));
    settle(&mut session);
    assert!(!Arc::ptr_eq(session.solution(), &pinned));
    let before = solved(&session);
    open(&mut session, Letter::A);
    assert!(!session.is_working());
    assert_eq!(session.advance(&mut || false), Progress::Done);
    assert!(Arc::ptr_eq(session.solution(), &pinned));
    assert_eq!((session.scene(), solved(&session)), (&small(), before));
    assert!(std::ptr::eq(session.problem(), pinned.problem()));
    assert_eq!(session.result(), session.pins()[0].outcome());
    // Back to the scene without a pin: solved again; then to the pin: not solved.
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert_eq!((session.scene().insertion, session.counters().solves), (0.6, before.0 + 1));
    session.apply(Command::Redo).unwrap();
    assert!(!session.is_working());
    // An edit back to the pinned scene reads the pin too.
    edit(&mut session, insertion(0.7));
    edit(&mut session, insertion(1.0));
    assert!(!session.is_working() && Arc::ptr_eq(session.solution(), &pinned));
}

#[test]
fn an_edit_after_an_opened_pin_has_the_shape_of_a_new_session() {
    let mut session = settled(small());
    pin(&mut session);
    edit(&mut session, |scene| scene.implant.base_radius_mm = 50.0);
    settle(&mut session);
    open(&mut session, Letter::A);
    edit(&mut session, insertion(0.8));
    settle(&mut session);
    let fresh = settled(Scene { insertion: 0.8, ..small() });
    let allowed = 2.0 * fresh.scene().solver.tolerance * fresh.scene().implant.base_radius_mm;
    for (a, b) in session.shape().iter().zip(fresh.shape()) {
        assert!((*a - *b).length() < allowed, "{a} {b}");
    }
    assert_eq!(session.result().unwrap().status, Status::Converged);
}

#[test]
fn an_opened_pin_of_other_names_has_its_own_names_and_patient() {
    let mut session = settled(small());
    pin(&mut session);
    edit(&mut session, |scene| "capsule".clone_into(&mut scene.layers[1].tissue));
    pin(&mut session);
    let solution = |k: usize| session.pins()[k].solution().unwrap();
    assert!(Arc::ptr_eq(solution(0), solution(1)));
    let tissue = |outcome: &Outcome| outcome.layers[1].tissue.clone();
    let of = |k: usize| tissue(session.pins()[k].outcome().unwrap());
    assert_eq!([of(0), of(1)], ["adipose", "capsule"]);
    edit(&mut session, insertion(0.5));
    settle(&mut session);
    let before = solved(&session);
    open(&mut session, Letter::A);
    assert_eq!(tissue(session.result().unwrap()), "adipose");
    open(&mut session, Letter::B);
    assert_eq!((tissue(session.result().unwrap()), solved(&session)), ("capsule".into(), before));
}

#[test]
fn a_pin_during_a_solve_takes_its_result() {
    let mut session = Session::new(small()).unwrap();
    session.advance(&mut || true);
    assert!(session.is_working());
    pin(&mut session);
    assert!(session.pins()[0].outcome().is_none());
    // The scene comes first.
    assert_eq!(session.advance_pins(&mut || false), Progress::Done);
    settle(&mut session);
    assert!(session.pins()[0].has_shape());
    settle_pins(&mut session);
    assert_eq!(session.counters().solves, 1);
    assert!(Arc::ptr_eq(session.pins()[0].solution().unwrap(), session.solution()));
}

#[test]
fn a_pin_of_an_abandoned_solve_is_solved_once_after_the_scene() {
    let mut session = Session::new(small()).unwrap();
    session.advance(&mut || true);
    pin(&mut session);
    edit(&mut session, insertion(0.5));
    settle(&mut session);
    assert!(session.pins()[0].outcome().is_none());
    assert_eq!(session.advance_pins(&mut || true), Progress::Working);
    settle_pins(&mut session);
    assert_eq!(session.counters().solves, 3);
    let expected = settled(small());
    let heights = [&session.pins()[0].outcome(), &expected.outcome()]
        .map(|outcome| outcome.unwrap().skin_projection_mm.unwrap());
    assert!((heights[0] - heights[1]).abs() < 0.02, "{heights:?}");
    let before = solved(&session);
    open(&mut session, Letter::A);
    settle(&mut session);
    settle_pins(&mut session);
    assert_eq!(solved(&session), before);
}

#[test]
fn a_pin_opened_during_its_own_solve_is_solved_to_the_end_once() {
    let mut session = settled(small());
    let other = PinnedScene {
        letter: Letter::C,
        name: String::new(),
        scene: Scene { insertion: 0.5, ..small() },
    };
    session.set_pins(vec![other.clone()]).unwrap();
    assert_eq!(session.advance_pins(&mut || true), Progress::Working);
    open(&mut session, Letter::C);
    assert!(session.is_working());
    settle(&mut session);
    assert!(Arc::ptr_eq(session.pins()[0].solution().unwrap(), session.solution()));
    let before = solved(&session);
    settle_pins(&mut session);
    assert_eq!(solved(&session), before);
    // Removed during its solve: no more work.
    session
        .set_pins(vec![PinnedScene { scene: Scene { insertion: 0.4, ..small() }, ..other }])
        .unwrap();
    assert_eq!(session.advance_pins(&mut || true), Progress::Working);
    session.apply(Command::Unpin(Letter::C)).unwrap();
    assert_eq!(session.advance_pins(&mut || true), Progress::Done);
}

#[test]
fn undo_leaves_pins_alone() {
    let mut session = settled(small());
    edit(&mut session, insertion(0.5));
    settle(&mut session);
    pin(&mut session);
    session.apply(Command::Rename(Letter::A, "half".to_owned())).unwrap();
    session.apply(Command::Undo).unwrap();
    assert_eq!((session.scene(), session.pins()[0].name()), (&small(), "half"));
    session.apply(Command::Redo).unwrap();
    session.apply(Command::Unpin(Letter::A)).unwrap();
    session.apply(Command::Undo).unwrap();
    assert!(session.pins().is_empty());
}

#[test]
fn a_removed_pin_frees_its_solution_and_its_letter() {
    let mut session = settled(small());
    pin(&mut session);
    edit(&mut session, insertion(0.5));
    settle(&mut session);
    pin(&mut session);
    assert_eq!(letters(&session), [Letter::A, Letter::B]);
    let solution = Arc::downgrade(session.pins()[0].solution().unwrap());
    let revision = session.pins_revision();
    session.apply(Command::Unpin(Letter::A)).unwrap();
    assert!(solution.upgrade().is_none());
    assert_ne!(session.pins_revision(), revision);
    assert_eq!((letters(&session), session.free_letter()), (vec![Letter::B], Some(Letter::A)));
    edit(&mut session, insertion(0.6));
    settle(&mut session);
    pin(&mut session);
    assert_eq!(letters(&session), [Letter::A, Letter::B]);
}

#[test]
fn counters_of_fields_count_every_solution_once() {
    let mut session = settled(small());
    let recoveries = session.counters().recoveries;
    pin(&mut session);
    edit(&mut session, insertion(0.5));
    settle(&mut session);
    // A draft and the end of the second solve.
    let both = session.counters().recoveries;
    assert!(both > recoveries);
    open(&mut session, Letter::A);
    assert_eq!(session.counters().recoveries, both);
    session.apply(Command::Unpin(Letter::A)).unwrap();
    assert_eq!(session.counters().recoveries, both);
    edit(&mut session, insertion(0.4));
    assert_eq!(session.counters().recoveries, both);
}

#[test]
fn a_rejected_command_names_its_reason_and_changes_nothing() {
    let mut session = settled(small());
    for k in 0..MAX_PINS {
        edit(&mut session, insertion(1.0 - 0.1 * k as f64));
        settle(&mut session);
        pin(&mut session);
    }
    let before = session.pinned_scenes();
    let again = session.apply(Command::Pin).unwrap_err();
    assert_eq!(again, CommandError::Pinned(Letter::D));
    edit(&mut session, insertion(0.2));
    settle(&mut session);
    assert_eq!(session.apply(Command::Pin), Err(CommandError::Full));
    let long = "x".repeat(101);
    for (name, wanted) in [(long.as_str(), "101 bytes"), ("two\nlines", "line breaks")] {
        let error = session.apply(Command::Rename(Letter::B, name.to_owned())).unwrap_err();
        let error = error.to_string();
        assert!(error.contains(wanted) && error.lines().count() == 1, "{error}");
    }
    assert_eq!(session.pinned_scenes(), before);
    session.apply(Command::Unpin(Letter::B)).unwrap();
    for command in [
        Command::Unpin(Letter::B),
        Command::OpenPin(Letter::B),
        Command::Rename(Letter::B, String::new()),
    ] {
        assert_eq!(session.apply(command), Err(CommandError::NoPin(Letter::B)));
    }
}

#[test]
fn a_scene_without_a_converged_result_is_not_pinned() {
    let mut session = settled(unstable());
    assert_eq!(session.result().unwrap().status, Status::Unstable);
    assert_eq!(session.apply(Command::Pin), Err(CommandError::NoResult));
    let mut session = Session::new(small()).unwrap();
    session.cancel();
    assert_eq!(session.apply(Command::Pin), Err(CommandError::NoResult));
}
