//! Measures of her body before and after, of the plan and of pins: computed when they are first shown, once for each body and for each
//! shape. A plan on the torso that a tape has shaped is measured on that torso.

use crate::body::before_after::{Before, Row};
use crate::body::deform::deform_sides;
use crate::body::fit::Settings;
use crate::body::frame::Frame;
use crate::body::marks::{Marks, Side};
use crate::body::read::Unit;
use crate::body::surface::Surface;
use crate::measure::Status;
use crate::scene::{Scene, Shaped};
use crate::session::{OtherSide, Pin, Session};
use crate::solve::Solution;
use glam::{DMat3, DVec3};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, Weak};

/// Number of shapes whose measures are kept: plan, other side and pins.
const MOST: usize = 6;

/// What is known of her body.
#[derive(Default)]
pub(crate) struct Measured {
    known: RefCell<Known>,
    /// The surface of the last torso by a tape.
    torso: RefCell<Option<(Arc<Shaped>, Arc<Surface>)>>,
}

#[derive(Default)]
struct Known {
    /// Her body on the sides that were measured; all have one surface and one set of marks.
    bodies: Vec<Body>,
    /// The rows of shapes on this body, the oldest first.
    shapes: Vec<Shape>,
    /// The last rows of a plan on this body, of the left and of the right side.
    last: [Option<Rc<[Row]>>; 2],
}

/// A body before.
struct Body {
    surface: Arc<Surface>,
    marks: Marks,
    cover_mm: f64,
    side: Side,
    /// `None` for marks at one place.
    before: Option<Rc<Before>>,
}

/// The rows of a side; its own shape is the first one.
struct Shape {
    side: Side,
    of: Vec<Weak<Solution>>,
    rows: Rc<[Row]>,
}

/// A body, and where a plan lies on it.
struct Place {
    surface: Arc<Surface>,
    marks: Marks,
    cover_mm: f64,
    frame: Frame,
}

/// The side of a plan.
fn side_of(scene: &Scene) -> Side {
    if scene.is_right() { Side::Right } else { Side::Left }
}

/// Her body's surface.
fn surface(session: &Session) -> Option<&Arc<Surface>> {
    Some(session.scene().placement.as_ref()?.surface.as_ref()?.surface())
}

/// The other side's shape, if it is converged.
fn of_other(other: &OtherSide) -> Option<&Arc<Solution>> {
    other.outcome().filter(|outcome| outcome.status == Status::Converged)?;
    Some(other.fields()?.solution())
}

/// The image of a frame in the midplane of the built-in torso, x = 0.
fn mirrored(frame: Frame) -> Frame {
    let hand = DVec3::new(-1.0, 1.0, 1.0);
    Frame { origin: hand * frame.origin, axes: DMat3::from_diagonal(hand) * frame.axes }
}

/// The surfaces of her body before and after, of both sides where each has a plan, and the unit of her scan; `None` without her body.
pub(crate) fn surfaces(session: &Session) -> Option<([Surface; 2], Unit)> {
    let placement = session.scene().placement.as_deref()?;
    let before = surface(session)?;
    let mut sides = vec![(placement.frame(), &**session.solution())];
    let other = session.other_side();
    sides.extend(
        other.and_then(|other| {
            Some((other.scene().placement.as_ref()?.frame(), &**of_other(other)?))
        }),
    );
    Some(([Surface::clone(before), deform_sides(before, &sides)], placement.unit.into()))
}

impl Measured {
    /// The measures of the plan before and after; `None` without a body or a converged result. During a solve those of the last result
    /// that was shown.
    pub(crate) fn of_plan(&self, session: &Session) -> Option<Rc<[Row]>> {
        let scene = session.scene();
        let place = self.place(session, scene)?;
        if session.is_working() {
            return self.last(&place, scene);
        }
        session.result().filter(|outcome| outcome.status == Status::Converged)?;
        let other = self.beside(session, &place);
        self.rows(&place, scene, session.solution(), other)
    }

    /// The measures of the other side's plan, as [`Self::of_plan`]; `None` for one plan.
    pub(crate) fn of_other_side(&self, session: &Session) -> Option<Rc<[Row]>> {
        let scene = session.other_side()?.scene();
        let place = self.place(session, scene)?;
        let is_converged =
            session.result().is_some_and(|outcome| outcome.status == Status::Converged);
        let Some(own) = session.other_side().and_then(of_other).filter(|_| is_converged) else {
            return self.last(&place, scene);
        };
        let other = (self.place(session, session.scene())?.frame, session.solution());
        self.rows(&place, scene, own, Some(other))
    }

    /// The measures of a pin on the wall of the plan before and after; of a pin with a plan for each side those of its own side alone.
    pub(crate) fn of_pin(&self, session: &Session, pin: &Pin) -> Option<Rc<[Row]>> {
        // A pin has no body of its own.
        let scene = session.scene();
        let is_on_body = pin.has_shape() && pin.scene().is_on_body_of(scene);
        let solution = pin.solution().filter(|_| is_on_body && pin.outcome().is_some())?;
        let place = self.place(session, scene)?;
        let other = scene.torso.map(|_| (mirrored(place.frame), solution));
        self.rows(&place, scene, solution, other)
    }

    /// Where a scene of a session lies on her body, or on the torso that a tape has shaped; `None` without either.
    fn place(&self, session: &Session, scene: &Scene) -> Option<Place> {
        if let Some(placement) = scene.placement.as_deref() {
            let surface = Arc::clone(surface(session)?);
            let (marks, cover_mm) = (placement.marks, placement.cover_mm);
            return Some(Place { surface, marks, cover_mm, frame: placement.frame() });
        }
        let fitted = scene.fitted_torso()?.ok()?;
        let torso = &fitted.shaped.torso;
        let mut kept = self.torso.borrow_mut();
        let is_kept = kept.as_ref().is_some_and(|(of, _)| Arc::ptr_eq(of, &fitted.shaped));
        if !is_kept {
            *kept = Some((Arc::clone(&fitted.shaped), Arc::new(torso.surface.clone())));
        }
        let frame = if scene.is_right() { mirrored(fitted.fit.frame) } else { fitted.fit.frame };
        Some(Place {
            surface: Arc::clone(&kept.as_ref()?.1),
            marks: torso.marks,
            // The bare chest is the same under any.
            cover_mm: Settings::default().cover_mm,
            frame,
        })
    }

    /// The shape on the other side of a plan: that of its own plan, or on a torso, whose breasts are alike, the image of the plan's.
    fn beside<'a>(
        &self,
        session: &'a Session,
        place: &Place,
    ) -> Option<(Frame, &'a Arc<Solution>)> {
        let Some(other) = session.other_side() else {
            return session.scene().torso.map(|_| (mirrored(place.frame), session.solution()));
        };
        let solution = of_other(other)?;
        Some((self.place(session, other.scene())?.frame, solution))
    }

    /// The last rows of a side on a body.
    fn last(&self, place: &Place, scene: &Scene) -> Option<Rc<[Row]>> {
        self.before(place, side_of(scene))?;
        self.known.borrow().last[side_of(scene) as usize].clone()
    }

    /// The body of a side before.
    fn before(&self, place: &Place, side: Side) -> Option<Rc<Before>> {
        let Place { surface, marks, cover_mm, .. } = place;
        let known = &mut *self.known.borrow_mut();
        let is_same = |body: &Body| {
            Arc::ptr_eq(&body.surface, surface)
                && (&body.marks, body.cover_mm.to_bits()) == (marks, cover_mm.to_bits())
        };
        if !known.bodies.iter().all(is_same) {
            *known = Known::default();
        }
        if let Some(body) = known.bodies.iter().find(|body| body.side == side) {
            return body.before.clone();
        }
        let before = Before::new(Arc::clone(surface), marks, side, *cover_mm).ok().map(Rc::new);
        let (surface, marks, cover_mm) = (Arc::clone(surface), *marks, *cover_mm);
        known.bodies.push(Body { surface, marks, cover_mm, side, before: before.clone() });
        before
    }

    /// The rows of a side's shape in a place on a body, beside that of the other side.
    fn rows(
        &self,
        place: &Place,
        scene: &Scene,
        own: &Arc<Solution>,
        other: Option<(Frame, &Arc<Solution>)>,
    ) -> Option<Rc<[Row]>> {
        let side = side_of(scene);
        let before = self.before(place, side)?;
        let own = (place.frame, own);
        let known = &mut *self.known.borrow_mut();
        let all = || [Some(own), other].into_iter().flatten();
        // The address of a shape that is gone belongs to no other one while it is kept here.
        let is_of = |known: &&Shape| {
            let addresses = all().map(|(_, solution)| Arc::as_ptr(solution));
            known.side == side && known.of.iter().map(Weak::as_ptr).eq(addresses)
        };
        let rows = match known.shapes.iter().find(is_of) {
            Some(shape) => Rc::clone(&shape.rows),
            None => {
                let sides: Vec<_> = all().map(|(frame, solution)| (frame, &**solution)).collect();
                let (after, marks) = before.after(&sides[..1]);
                let alone = (&after, &marks);
                let volume_ml = own.1.problem().obstacle.dome.volume_over_wall() / 1000.0;
                let rows: Rc<[Row]> = match sides.len() {
                    1 => before.rows(alone, volume_ml).into(),
                    _ => {
                        let (after, marks) = before.after(&sides);
                        before.rows_of_both(alone, (&after, &marks), volume_ml).into()
                    }
                };
                if known.shapes.len() == MOST {
                    known.shapes.remove(0);
                }
                let of = all().map(|(_, solution)| Arc::downgrade(solution)).collect();
                known.shapes.push(Shape { side, of, rows: Rc::clone(&rows) });
                rows
            }
        };
        known.last[side as usize] = Some(Rc::clone(&rows));
        Some(rows)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::body::fit::{Settings, fit};
    use crate::body::torso::{Torso, builtin};
    use crate::session::Command;
    use crate::solve::Progress;

    /// The built-in torso as the body of a plan on a small grid, solved.
    pub(crate) fn solved() -> Session {
        let Torso { surface, marks } = builtin();
        let settings = Settings::default();
        let fitted = fit(&surface, &marks, Side::Left, &settings).unwrap();
        let of = (&marks, Side::Left);
        let mut scene = Scene::of_body(&fitted, of, settings.cover_mm, Unit::Cm).unwrap();
        scene.keep_surface(&surface).unwrap();
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
        let mut session = Session::new(scene).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        session
    }

    #[test]
    fn a_shape_is_measured_once_and_a_pin_of_it_with_it() {
        let (mut session, measured) = (solved(), Measured::default());
        let first = measured.of_plan(&session).unwrap();
        assert!(Rc::ptr_eq(&first, &measured.of_plan(&session).unwrap()));
        session.apply(Command::Pin).unwrap();
        let of_pin = |session: &Session| measured.of_pin(session, &session.pins()[0]);
        assert!(Rc::ptr_eq(&first, &of_pin(&session).unwrap()));
        // Another implant: the last measures stay until the solve has ended.
        let mut scene = session.scene().clone();
        scene.implant.projection_mm += 5.0;
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 1 }).unwrap();
        assert!(session.is_working());
        assert!(Rc::ptr_eq(&first, &measured.of_plan(&session).unwrap()));
        while session.advance(&mut || false) == Progress::Working {}
        let second = measured.of_plan(&session).unwrap();
        let value = |rows: &[Row], name: &str| {
            let row = rows.iter().find(|row| row.name == name).unwrap();
            (row.before, row.gain.unwrap())
        };
        for name in ["Projection", "Volume gained", "Notch to nipple"] {
            let [one, other] = [&first, &second].map(|rows| value(rows, name));
            assert!(one.0 == other.0 && one.1 < other.1 && one.1 > 0.0, "{name}");
        }
        assert!(Rc::ptr_eq(&first, &of_pin(&session).unwrap()));
        // The other side is measured anew, on the same shape; without a body nothing stays.
        let mut scene = session.scene().clone();
        scene.side = Some(crate::scene::Side::Right);
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 2 }).unwrap();
        let other = measured.of_plan(&session).unwrap();
        assert_ne!(value(&other, "Projection").0, value(&second, "Projection").0);
        let mut scene = session.scene().clone();
        scene.placement = None;
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 3 }).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        assert!(measured.of_plan(&session).is_none() && of_pin(&session).is_none());
        assert!(surfaces(&session).is_none());
    }

    /// A plan on the torso by a tape: both breasts have it, and what the tape has measured is the value before.
    #[test]
    fn a_plan_on_a_torso_by_a_tape_is_measured_on_both_breasts() {
        let mut scene = Scene::opening();
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
        let mut session = Session::new(scene.clone()).unwrap();
        let solve = |session: &mut Session| {
            while session.advance(&mut || false) == Progress::Working {}
            while session.advance_pins(&mut || false) == Progress::Working {}
        };
        solve(&mut session);
        let measured = Measured::default();
        assert!(measured.of_plan(&session).is_none());
        scene.set_torso(crate::scene::Torso::default());
        session.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: 1 }).unwrap();
        solve(&mut session);
        let rows = measured.of_plan(&session).unwrap();
        let row = |rows: &[Row], name: &str| *rows.iter().find(|row| row.name == name).unwrap();
        let tape = session.scene().fitted_torso().unwrap().unwrap().shaped.tape;
        for (name, asked, off) in [
            ("Notch to nipple", 0.1 * tape.notch_nipple_mm, 0.1),
            ("Nipple to nipple", 0.1 * tape.nipple_nipple_mm, 0.1),
            ("Width of the breast", 0.1 * tape.breast_width_mm, 0.1),
        ] {
            let Row { before, gain, .. } = row(&rows, name);
            assert!((before.unwrap() - asked).abs() < off, "{name}: {before:?} {asked}");
            assert!(gain.unwrap() > 0.0, "{name}: {gain:?}");
        }
        // Both nipples go as far to the side, and both breasts stay alike.
        let [aside, apart] = ["Nipple to midline", "Nipple to nipple"].map(|name| row(&rows, name));
        assert!((2.0 * aside.gain.unwrap() - apart.gain.unwrap()).abs() < 0.02);
        for when in [row(&rows, "Asymmetry of the skin"), row(&rows, "Left nipple higher by")] {
            assert!(
                when.before.unwrap().abs() < 0.1 && when.after.unwrap().abs() < 0.1,
                "{when:?}"
            );
        }
        let gained = row(&rows, "Volume gained").gain.unwrap();
        let volume_ml = session.result().unwrap().implant_volume_ml;
        assert!((0.9..1.5).contains(&(gained / volume_ml)), "{gained} of {volume_ml} ml");
        // A pin on it, the right side, plans of their own.
        session.apply(Command::Pin).unwrap();
        assert!(Rc::ptr_eq(&rows, &measured.of_pin(&session, &session.pins()[0]).unwrap()));
        scene.side = Some(crate::scene::Side::Right);
        session.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: 2 }).unwrap();
        solve(&mut session);
        let right = measured.of_plan(&session).unwrap();
        for (left, right) in rows.iter().zip(right.iter()) {
            let of = |row: &Row| [row.before, row.after, row.gain].map(|x| x.unwrap_or(-1.0));
            // The right breast is solved anew, both to a tolerance of 0.1 %.
            let is_near = |(a, b): (f64, f64)| (a - b).abs() < 0.05 + 2e-3 * a.abs();
            assert!(of(left).into_iter().zip(of(right)).all(is_near), "{left:?} {right:?}");
        }
        scene.add_other_side().unwrap();
        scene.other_side.as_mut().unwrap().implant.projection_mm += 8.0;
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 3 }).unwrap();
        solve(&mut session);
        let sides = [measured.of_plan(&session), measured.of_other_side(&session)];
        let [own, other] = sides.map(|rows| row(&rows.unwrap(), "Projection").gain.unwrap());
        assert!(other > 1.05 * own && own > 0.0, "{own} {other}");
        assert!(surfaces(&session).is_none());
    }

    /// Plans of their own: the measures of each side, and of both together; exchanged sides are measured no second time.
    #[test]
    fn both_sides_are_measured_beside_each_other() {
        let (mut session, measured) = (solved(), Measured::default());
        let solve = |session: &mut Session| {
            while session.advance(&mut || false) == Progress::Working {}
            while session.advance_pins(&mut || false) == Progress::Working {}
        };
        let alone = measured.of_plan(&session).unwrap();
        assert!(measured.of_other_side(&session).is_none());
        let mut scene = session.scene().clone();
        scene.add_other_side().unwrap();
        scene.other_side.as_mut().unwrap().implant.projection_mm += 8.0;
        session.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: 1 }).unwrap();
        solve(&mut session);
        let sides = [measured.of_plan(&session), measured.of_other_side(&session)];
        let [left, right] = sides.map(Option::unwrap);
        let row = |rows: &[Row], name: &str| *rows.iter().find(|row| row.name == name).unwrap();
        // The left breast is as it was alone; the larger implant gains more on the right.
        for name in ["Projection", "Volume gained", "Notch to nipple", "Upper pole"] {
            let [one, beside, other] =
                [&alone, &left, &right].map(|rows| row(rows, name).gain.unwrap());
            assert!((one - beside).abs() < 0.02 * one.abs() + 0.02, "{name}: {one} {beside}");
            assert!(name == "Upper pole" || other > 1.05 * beside, "{name}: {beside} {other}");
        }
        // What both have together is equal, and says that they differ.
        for name in ["Nipple to nipple", "Between the breasts", "Asymmetry of the skin"] {
            let [of_left, of_right] = [&left, &right].map(|rows| row(rows, name));
            assert!((of_left.after.unwrap() - of_right.after.unwrap()).abs() < 1e-9, "{name}");
        }
        let asymmetry = row(&left, "Asymmetry of the skin");
        assert!(asymmetry.before.unwrap() < 0.5 && asymmetry.after.unwrap() > 1.0, "{asymmetry:?}");
        // Both move in the exported surface.
        let ([before, after], _) = surfaces(&session).unwrap();
        let moved = |right: bool| {
            let pairs = before.positions.iter().zip(&after.positions);
            let own = pairs.filter(|(p, _)| (p.x < 0.0) == right);
            own.map(|(p, q)| p.distance(*q)).fold(0.0, f64::max)
        };
        assert!(moved(true) > moved(false) + 4.0 && moved(false) > 10.0);
        scene.exchange_sides();
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 2 }).unwrap();
        assert!(Rc::ptr_eq(&right, &measured.of_plan(&session).unwrap()));
        assert!(Rc::ptr_eq(&left, &measured.of_other_side(&session).unwrap()));
    }

    #[test]
    fn the_surfaces_are_those_of_the_scan_and_its_skin() {
        let session = solved();
        let ([before, after], unit) = surfaces(&session).unwrap();
        assert_eq!((unit, before.triangles.len()), (Unit::Cm, builtin().surface.triangles.len()));
        let moved = before.positions.iter().zip(&after.positions).map(|(p, q)| p.distance(*q));
        let most = moved.fold(0.0, f64::max);
        assert!((10.0..40.0).contains(&most), "{most}");
    }
}
