//! Measures of her body before and after, of the plan and of pins: computed when they are first shown, once for each body and for each
//! shape.

use crate::body::before_after::{Before, Row};
use crate::body::deform::deform_sides;
use crate::body::frame::Frame;
use crate::body::marks::{Marks, Side};
use crate::body::read::Unit;
use crate::body::surface::Surface;
use crate::measure::{Outcome, Status};
use crate::scene::Scene;
use crate::session::{Pin, Session};
use crate::solve::Solution;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, Weak};

/// Number of shapes whose measures are kept: plan, other side and pins.
const MOST: usize = 6;

/// What is known of her body.
#[derive(Default)]
pub(crate) struct Measured(RefCell<Known>);

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

/// The side of a plan.
fn side_of(scene: &Scene) -> Side {
    if scene.is_right() { Side::Right } else { Side::Left }
}

/// Her body's surface.
fn surface(session: &Session) -> Option<&Arc<Surface>> {
    Some(session.scene().placement.as_ref()?.surface.as_ref()?.surface())
}

/// The other side's result and shape, in its place on the body.
fn of_other(session: &Session) -> Option<(&Outcome, (Frame, &Arc<Solution>))> {
    let other = session.other_side()?;
    let outcome = other.outcome().filter(|outcome| outcome.status == Status::Converged)?;
    Some((outcome, (other.scene().placement.as_ref()?.frame(), other.fields()?.solution())))
}

/// The surfaces of her body before and after, of both sides where each has a plan, and the unit of her scan; `None` without her body.
pub(crate) fn surfaces(session: &Session) -> Option<([Surface; 2], Unit)> {
    let placement = session.scene().placement.as_deref()?;
    let before = surface(session)?;
    let mut sides = vec![(placement.frame(), &**session.solution())];
    sides.extend(of_other(session).map(|(_, (frame, solution))| (frame, &**solution)));
    Some(([Surface::clone(before), deform_sides(before, &sides)], placement.unit.into()))
}

impl Measured {
    /// The measures of the plan before and after; `None` without her body or a converged result. During a solve those of the last result
    /// that was shown.
    pub(crate) fn of_plan(&self, session: &Session) -> Option<Rc<[Row]>> {
        let scene = session.scene();
        if session.is_working() {
            self.before(scene, surface(session)?)?;
            return self.0.borrow().last[side_of(scene) as usize].clone();
        }
        let outcome = session.result().filter(|outcome| outcome.status == Status::Converged)?;
        let own = (scene.placement.as_ref()?.frame(), session.solution());
        let other = of_other(session).map(|(_, shape)| shape);
        self.rows(session, (scene, outcome), own, other)
    }

    /// The measures of the other side's plan, as [`Self::of_plan`]; `None` for one plan.
    pub(crate) fn of_other_side(&self, session: &Session) -> Option<Rc<[Row]>> {
        let scene = session.other_side()?.scene();
        let is_converged =
            session.result().is_some_and(|outcome| outcome.status == Status::Converged);
        let own = of_other(session).filter(|_| is_converged);
        let Some((outcome, own)) = own else {
            self.before(scene, surface(session)?)?;
            return self.0.borrow().last[side_of(scene) as usize].clone();
        };
        let other = (session.scene().placement.as_ref()?.frame(), session.solution());
        self.rows(session, (scene, outcome), own, Some(other))
    }

    /// The measures of a pin on the wall of the plan before and after; of a pin with a plan for each side those of its own side alone.
    pub(crate) fn of_pin(&self, session: &Session, pin: &Pin) -> Option<Rc<[Row]>> {
        // A pin has no body of its own.
        let is_on_body = pin.has_shape() && pin.scene().is_on_wall_of(session.scene());
        let (outcome, solution) = pin.outcome().zip(pin.solution()).filter(|_| is_on_body)?;
        let own = (session.scene().placement.as_ref()?.frame(), solution);
        self.rows(session, (session.scene(), outcome), own, None)
    }

    /// The body of a side before.
    fn before(&self, scene: &Scene, surface: &Arc<Surface>) -> Option<Rc<Before>> {
        let (side, placement) = (side_of(scene), scene.placement.as_deref()?);
        let (marks, cover_mm) = (placement.marks, placement.cover_mm);
        let known = &mut *self.0.borrow_mut();
        let is_same = |body: &Body| {
            Arc::ptr_eq(&body.surface, surface)
                && (&body.marks, body.cover_mm.to_bits()) == (&marks, cover_mm.to_bits())
        };
        if !known.bodies.iter().all(is_same) {
            *known = Known::default();
        }
        if let Some(body) = known.bodies.iter().find(|body| body.side == side) {
            return body.before.clone();
        }
        let before = Before::new(Arc::clone(surface), &marks, side, cover_mm).ok().map(Rc::new);
        let surface = Arc::clone(surface);
        known.bodies.push(Body { surface, marks, cover_mm, side, before: before.clone() });
        before
    }

    /// The rows of a side's shape on the body of a session, beside that of the other side.
    fn rows(
        &self,
        session: &Session,
        (scene, outcome): (&Scene, &Outcome),
        own: (Frame, &Arc<Solution>),
        other: Option<(Frame, &Arc<Solution>)>,
    ) -> Option<Rc<[Row]>> {
        let (side, before) = (side_of(scene), self.before(scene, surface(session)?)?);
        let known = &mut *self.0.borrow_mut();
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
                let volume_ml = outcome.implant_volume_ml;
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
