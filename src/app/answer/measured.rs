//! Measures of her body before and after, of the plan and of pins: computed when they are first shown, once for each body and for each
//! shape.

use crate::body::before_after::{Before, Row};
use crate::body::deform::deform;
use crate::body::frame::Frame;
use crate::body::marks::Side;
use crate::body::read::Unit;
use crate::body::surface::Surface;
use crate::measure::{Outcome, Status};
use crate::scene::{Placement, Scene};
use crate::session::{Pin, Session};
use crate::solve::Solution;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, Weak};

/// Number of shapes whose measures are kept: plan and pins.
const MOST: usize = 5;

/// What is known of her body.
#[derive(Default)]
pub(crate) struct Measured(RefCell<Known>);

#[derive(Default)]
struct Known {
    body: Option<Body>,
    /// The rows of shapes on this body, the oldest first.
    shapes: Vec<(Weak<Solution>, Rc<[Row]>)>,
    /// The last rows of a plan on this body.
    last: Option<Rc<[Row]>>,
}

/// A body with the place of its scene.
struct Body {
    placement: Placement,
    side: Side,
    /// The body before; `None` for marks at one place.
    before: Option<Rc<Before>>,
}

/// The surfaces of her body before and after, and the unit of her scan; `None` without her body.
pub(crate) fn surfaces(session: &Session) -> Option<([Surface; 2], Unit)> {
    let placement = session.scene().placement.as_deref()?;
    let before = placement.surface.as_ref()?.surface();
    let after = deform(before, &placement.frame(), session.solution());
    Some(([Surface::clone(before), after], placement.unit.into()))
}

impl Measured {
    /// The measures of the plan before and after; `None` without her body or a converged result. During a solve those of the last result
    /// that was shown.
    pub(crate) fn of_plan(&self, session: &Session) -> Option<Rc<[Row]>> {
        if session.is_working() {
            self.before(session.scene())?;
            return self.0.borrow().last.clone();
        }
        let outcome = session.result().filter(|outcome| outcome.status == Status::Converged)?;
        let rows = self.rows(session.scene(), outcome, session.solution());
        self.0.borrow_mut().last.clone_from(&rows);
        rows
    }

    /// The measures of a pin on the wall of the plan before and after.
    pub(crate) fn of_pin(&self, session: &Session, pin: &Pin) -> Option<Rc<[Row]>> {
        // A pin has no body of its own.
        let is_on_body = pin.has_shape() && pin.scene().is_on_wall_of(session.scene());
        let (outcome, solution) = pin.outcome().zip(pin.solution())?;
        is_on_body.then(|| self.rows(session.scene(), outcome, solution)).flatten()
    }

    /// The body of a plan before, and the place of the plan on it.
    fn before(&self, scene: &Scene) -> Option<(Rc<Before>, Frame)> {
        let placement = scene.placement.as_deref()?;
        let side = if scene.is_right() { Side::Right } else { Side::Left };
        let known = &mut *self.0.borrow_mut();
        let is_same = |body: &&Body| body.side == side && body.placement == *placement;
        let before = match known.body.as_ref().filter(is_same) {
            Some(body) => body.before.clone(),
            None => {
                let surface = Arc::clone(placement.surface.as_ref()?.surface());
                let (marks, cover_mm) = (&placement.marks, placement.cover_mm);
                let before = Before::new(surface, marks, side, cover_mm).ok().map(Rc::new);
                (known.shapes, known.last) = Default::default();
                let placement = placement.clone();
                known.body = Some(Body { placement, side, before: before.clone() });
                before
            }
        };
        Some((before?, placement.frame()))
    }

    /// The rows of a shape on the body of a plan.
    fn rows(
        &self,
        scene: &Scene,
        outcome: &Outcome,
        solution: &Arc<Solution>,
    ) -> Option<Rc<[Row]>> {
        let (before, place) = self.before(scene)?;
        let known = &mut *self.0.borrow_mut();
        // The address of a shape that is gone belongs to no other one while it is kept here.
        let is_of = |(of, _): &&(Weak<Solution>, Rc<[Row]>)| of.as_ptr() == Arc::as_ptr(solution);
        if let Some((_, rows)) = known.shapes.iter().find(is_of) {
            return Some(Rc::clone(rows));
        }
        let (after, marks) = before.after(&place, solution);
        let rows: Rc<[Row]> = before.rows((&after, &marks), outcome.implant_volume_ml).into();
        if known.shapes.len() == MOST {
            known.shapes.remove(0);
        }
        known.shapes.push((Arc::downgrade(solution), Rc::clone(&rows)));
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
