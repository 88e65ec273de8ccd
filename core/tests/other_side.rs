//! Plans of their own for both sides: in files, in the session, solved once each.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]
#![allow(clippy::float_cmp, reason = "numbers of a file hold to the last bit")]

use glam::DVec3;
use implant_preview_core::body::before_after::{Before, Row};
use implant_preview_core::body::fit::{Settings, fit};
use implant_preview_core::body::marks::{self, Marks};
use implant_preview_core::body::read::Unit;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::body::torso::{Torso, builtin};
use implant_preview_core::clinical::{Measurements, SkinClass};
use implant_preview_core::measure::Fields;
use implant_preview_core::scene::{CheckedScene, ChestShape, Document, Scene, Side};
use implant_preview_core::session::{Command, Session};
use implant_preview_core::simulate::run;
use implant_preview_core::solve::{Options, Progress};
use serde_json::{Value, json};
use std::rc::Rc;
use std::sync::Arc;

/// The opening plan on a small grid, with plans of their own: 225 ml on the left, less on the right.
fn scene() -> Scene {
    let mut scene = Scene::opening();
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (17, 1e-2);
    scene.add_other_side().unwrap();
    let other = scene.other_side.as_mut().unwrap();
    other.implant.projection_mm -= 5.0;
    other.pocket_radius_mm += 2.0;
    scene
}

fn solve(session: &mut Session) {
    while session.advance(&mut || false) == Progress::Working {}
    while session.advance_pins(&mut || false) == Progress::Working {}
}

fn edit(session: &mut Session, gesture: u64, edit: impl FnOnce(&mut Scene)) {
    let mut scene = session.scene().clone();
    edit(&mut scene);
    session.apply(Command::Edit { scene: Box::new(scene), gesture }).unwrap();
}

#[test]
fn a_file_has_what_differs_and_is_read_as_it_was() {
    let scene = scene();
    let written: Value = serde_json::from_str(&scene.to_json()).unwrap();
    let names: Vec<_> = written["other_side"].as_object().unwrap().keys().cloned().collect();
    assert_eq!(names, ["implant", "pocket_radius_mm"]);
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    // One plan for both sides is written as before.
    let mut alike = scene.clone();
    alike.set_side(Some(Side::Both));
    assert!(!alike.to_json().contains("other_side"));
    // A pin and a link keep both sides.
    let link = Scene::from_json(&scene.without_visit().to_json()).unwrap();
    assert_eq!(link, scene);
    // Of a pinch of its own the thickness follows.
    let read = |other: Value| {
        let file = json!({ "implant": { "base_radius_mm": 60.0 }, "side": "right", "patient": { "pinch_mm": 20.0 }, "other_side": other });
        Scene::from_json(&file.to_string()).map_err(|error| error.to_string())
    };
    let thick =
        read(json!({ "implant": { "base_radius_mm": 55.0 }, "patient": { "pinch_mm": 40.0 } }));
    let thick = thick.unwrap();
    let other = thick.other_side.as_deref().unwrap();
    assert_eq!((thick.side, other.side), (Some(Side::Right), Some(Side::Left)));
    assert!(
        other.tissue_mm() > 1.8 * thick.tissue_mm()
            && other.pocket_radius_mm == thick.pocket_radius_mm
    );
    assert_eq!(Scene::from_json(&thick.to_json()).unwrap(), thick);
    for (other, expected) in [
        (json!({ "pocket_radius_mm": 70 }), "other_side: missing field `implant`"),
        (
            json!({ "implant": { "base_radius_mm": 5 } }),
            "other_side.implant.base_radius_mm is 5; allowed",
        ),
        (
            json!({ "implant": { "base_radius_mm": 60 }, "side": "left" }),
            "other_side.side is given; allowed",
        ),
        (
            json!({ "implant": { "base_radius_mm": 60 }, "visit": {} }),
            "other_side.visit is given; allowed",
        ),
        (
            json!({ "implant": { "base_radius_mm": 60 }, "width": 1 }),
            "other_side.width: unknown field",
        ),
        (json!(null), "other_side"),
    ] {
        let error = read(other).unwrap_err();
        assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
    }
    let both = scene.to_json().replacen("\"left\"", "\"both\"", 1);
    let error = Scene::from_json(&both).unwrap_err().to_string();
    assert_eq!(error, "side is both; allowed: left or right beside other_side");
}

#[test]
fn each_side_is_solved_once_and_keeps_its_shape_when_the_sides_are_exchanged() {
    let mut opening = Scene::opening();
    (opening.solver.nodes_per_side, opening.solver.tolerance) = (17, 1e-2);
    let mut session = Session::new(opening).unwrap();
    solve(&mut session);
    assert!(session.other_side().is_none());
    // Equal plans share their solution.
    edit(&mut session, 1, |scene| scene.add_other_side().unwrap());
    solve(&mut session);
    assert_eq!(session.counters().solves, 1);
    let left = session.solution().clone();
    let other = |session: &Session| session.other_side().unwrap().fields().unwrap().clone();
    assert!(Arc::ptr_eq(other(&session).solution(), &left));
    // The right side alone is edited.
    edit(&mut session, 2, |scene| scene.set_side(Some(Side::Right)));
    assert!(session.scene().is_right() && !session.is_working());
    edit(&mut session, 3, |scene| scene.implant.projection_mm += 6.0);
    solve(&mut session);
    assert_eq!(session.counters().solves, 2);
    assert!(Arc::ptr_eq(other(&session).solution(), &left));
    let right = session.solution().clone();
    let [outcome, of_other] =
        [session.result().unwrap(), session.other_side().unwrap().outcome().unwrap()];
    assert!(outcome.implant_volume_ml > 1.1 * of_other.implant_volume_ml);
    // Exchanged, each side has its shape without a solve.
    edit(&mut session, 4, |scene| scene.set_side(Some(Side::Left)));
    solve(&mut session);
    assert!(Arc::ptr_eq(session.solution(), &left));
    assert!(Arc::ptr_eq(other(&session).solution(), &right));
    assert_eq!(session.counters().solves, 2);
    // The skin is that of both sides.
    edit(&mut session, 5, |scene| {
        let measured = Measurements { skin_class: Some(SkinClass::Lax), ..scene.measured() };
        scene.apply_patient(measured).unwrap();
    });
    let of_other = session.other_side().unwrap();
    assert_eq!(of_other.scene().measured().skin_class, Some(SkinClass::Lax));
    assert_eq!(of_other.scene().layers[0].curve, session.scene().layers[0].curve);
    assert!(of_other.outcome().is_none() && of_other.fields().is_some());
    solve(&mut session);
    assert_eq!(session.counters().solves, 4);
    // The pinch is one side's.
    edit(&mut session, 6, |scene| {
        scene.apply_patient(Measurements { pinch_mm: Some(30.0), ..scene.measured() }).unwrap();
    });
    let scene = session.scene();
    let of_other = session.other_side().unwrap().scene();
    assert!(scene.tissue_mm() > 1.4 * of_other.tissue_mm());
    assert_eq!(of_other.measured().pinch_mm, Some(20.0));
    solve(&mut session);
    assert_eq!(session.counters().solves, 5);
    // A file has both, the history too.
    let document = Document::from_json(&session.document_json()).unwrap();
    assert_eq!(document.scene.scene(), session.scene());
    let now = session.scene().clone();
    for _ in 0..6 {
        session.apply(Command::Undo).unwrap();
    }
    assert!(session.scene().other_side.is_none() && session.other_side().is_none());
    for _ in 0..6 {
        session.apply(Command::Redo).unwrap();
    }
    assert_eq!(session.scene(), &now);
    solve(&mut session);
    assert!(session.other_side().unwrap().outcome().is_some());
    // One plan for both sides again.
    edit(&mut session, 7, |scene| scene.set_side(Some(Side::Both)));
    assert!(session.other_side().is_none() && !session.is_working());
}

/// The shape before stays while the side is solved again, but not on another body, whose skin it would tear.
#[test]
fn a_side_has_no_shape_of_another_body() {
    let mut session = Session::new(scene()).unwrap();
    solve(&mut session);
    edit(&mut session, 1, |scene| {
        let measured = Measurements { skin_class: Some(SkinClass::Lax), ..scene.measured() };
        scene.apply_patient(measured).unwrap();
    });
    assert!(session.other_side().unwrap().fields().is_some());
    edit(&mut session, 2, |scene| scene.set_chest(Some(ChestShape::ROUND)));
    assert!(session.other_side().unwrap().fields().is_none());
    solve(&mut session);
    let other = session.other_side().unwrap();
    assert!(other.outcome().is_some() && other.fields().is_some());
}

/// The shape of a pin's other side is that of the plan it was made of; of a file's pin it is solved once.
#[test]
fn a_pin_has_the_shapes_of_both_sides() {
    let mut session = Session::new(scene()).unwrap();
    solve(&mut session);
    session.apply(Command::Pin).unwrap();
    let solves = session.counters().solves;
    let other = session.other_side().unwrap().fields().unwrap();
    assert!(Rc::ptr_eq(session.pins()[0].other_fields().unwrap(), other));
    edit(&mut session, 1, |scene| scene.other_side.as_mut().unwrap().pocket_radius_mm += 3.0);
    solve(&mut session);
    assert_eq!(session.counters().solves, solves + 1);
    let pinned = Rc::clone(session.pins()[0].other_fields().unwrap());
    let now = session.other_side().unwrap().fields().unwrap();
    assert!(!Rc::ptr_eq(&pinned, now));
    // Opened again, the pin gives both shapes back; alone in a file it is solved for both sides.
    let pins = session.pinned_scenes();
    let mut alone = Session::new(Scene::opening()).unwrap();
    alone.set_pins(pins).unwrap();
    let before = alone.counters().solves;
    solve(&mut alone);
    assert_eq!(alone.counters().solves, before + 2);
    let height = |fields: &Rc<Fields>| {
        let inner = fields.solution().inner().iter().map(|p| p.z);
        inner.fold(0.0, f64::max)
    };
    let found = height(alone.pins()[0].other_fields().unwrap());
    assert!((found - height(&pinned)).abs() < 1e-9, "{found}");
}

#[test]
fn a_pin_keeps_both_sides() {
    let mut session = Session::new(scene()).unwrap();
    solve(&mut session);
    let before = session.scene().clone();
    session.apply(Command::Pin).unwrap();
    assert_eq!(session.pins()[0].scene(), &before);
    edit(&mut session, 1, |scene| scene.set_side(None));
    solve(&mut session);
    let letter = session.pins()[0].letter();
    session.apply(Command::OpenPin(letter)).unwrap();
    assert_eq!(session.scene(), &before);
}

/// A torso whose left breast is larger, its marks, and both as a mirror shows them.
fn torsos() -> [(Surface, Marks); 2] {
    let Torso { mut surface, mut marks } = builtin();
    let larger = |p: DVec3, nipple: DVec3| {
        let apart = p.distance_squared(nipple) / 40.0_f64.powi(2);
        p + DVec3::Z * 6.0 * (-apart).exp()
    };
    let nipple = marks.nipples[0];
    surface.positions.iter_mut().for_each(|p| *p = larger(*p, nipple));
    marks = marks.mapped(|p| larger(p, nipple));
    let mirror = DVec3::new(-1.0, 1.0, 1.0);
    let mut image = surface.clone();
    image.positions.iter_mut().for_each(|p| *p *= mirror);
    image.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let mut of_image = marks.mapped(|p| p * mirror);
    of_image.nipples.reverse();
    of_image.breasts.reverse();
    [(surface, marks), (image, of_image)]
}

/// The rows of both sides, the left one first, with an implant of a projection on each \[mm\].
fn measured((surface, marks): &(Surface, Marks), projections_mm: [f64; 2]) -> [Vec<Row>; 2] {
    let settings = Settings::default();
    let sides = [marks::Side::Left, marks::Side::Right];
    let solved: Vec<_> = sides
        .into_iter()
        .zip(projections_mm)
        .map(|(side, projection_mm)| {
            let fitted = fit(surface, marks, side, &settings).unwrap();
            let mut scene =
                Scene::of_body(&fitted, (marks, side), settings.cover_mm, Unit::Mm).unwrap();
            (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-4);
            scene.implant.projection_mm = projection_mm;
            let frame = scene.placement.as_ref().unwrap().frame();
            let volume_ml = scene.implant.size().unwrap().volume_ml();
            let checked = CheckedScene::new(scene).unwrap();
            (frame, run(&checked, Options::default(), None).solution, volume_ml)
        })
        .collect();
    let both: Vec<_> = solved.iter().map(|(frame, solution, _)| (*frame, &**solution)).collect();
    [0, 1].map(|k| {
        let surface = Arc::new(surface.clone());
        let before = Before::new(surface, marks, sides[k], settings.cover_mm).unwrap();
        let (own, all) = (before.after(&both[k..=k]), before.after(&both));
        before.rows_of_both((&own.0, &own.1), (&all.0, &all.1), solved[k].2)
    })
}

/// Sides exchanged: of the torso in a mirror, with exchanged implants, each side has the measures of the other.
#[test]
fn a_mirrored_torso_with_exchanged_plans_has_exchanged_measures() {
    let [torso, image] = torsos();
    let [left, right] = measured(&torso, [30.0, 42.0]);
    let [of_image_left, of_image_right] = measured(&image, [42.0, 30.0]);
    for (rows, of_image) in [(&left, &of_image_right), (&right, &of_image_left)] {
        for (row, image) in rows.iter().zip(of_image) {
            // What is counted from the left side changes its sign.
            let sign = if row.name == "Left nipple higher by" { -1.0 } else { 1.0 };
            let pairs =
                [(row.before, image.before), (row.after, image.after), (row.gain, image.gain)];
            for (a, b) in pairs {
                let (Some(a), Some(b)) = (a, b) else {
                    assert_eq!(a, b, "{}", row.name);
                    continue;
                };
                assert!((a - sign * b).abs() < 2e-3 * a.abs() + 1e-2, "{}: {a} {b}", row.name);
            }
        }
    }
    // What both breasts have together is one number on both sides; all else differs with the implants.
    let alike = |name: &str| {
        [
            "Nipple to nipple",
            "Between the breasts",
            "Left nipple higher by",
            "Asymmetry of the skin",
        ]
        .contains(&name)
    };
    for (left, right) in left.iter().zip(&right) {
        assert_eq!(alike(left.name), left.gain == right.gain, "{}", left.name);
    }
    let gained =
        |rows: &[Row]| rows.iter().find(|row| row.name == "Volume gained").unwrap().gain.unwrap();
    assert!(gained(&right) > gained(&left) + 60.0);
}
