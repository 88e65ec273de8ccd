//! The step between the scan of a body and its plan: unit, side, cover, the surgeon's marks on the drawn body.
//!
//! `points` (the marks and their history) | `panel` (the controls). Uses `picture`, `widgets`, `texts`. Used by `frame`.

mod panel;
mod points;

use crate::app::picture::viewport::{Dot, Touched};
use crate::app::texts::{shown, tr};
use crate::body::fit::{BodyFit, Settings, fit};
use crate::body::frame::Frame;
use crate::body::marks::{Marks, Side};
use crate::body::read::{Read, Unit};
use crate::body::surface::Surface;
use crate::clinical::Measurements;
use crate::scene::{self, COVER_MM, Scene};
use crate::view::torso::Torso;
use glam::{DMat3, DVec3};
pub(crate) use panel::Choice;
use points::Points;
use std::rc::Rc;

/// A scan whose marks are being set.
pub(crate) struct Scan {
    /// Name of the file.
    name: String,
    read: Read,
    side: Side,
    /// Pinch of the plan \[mm\]: twice the cover of the wall.
    pinch_mm: f64,
    points: Points,
    /// The mark that the next click sets, or that was touched last.
    chosen: usize,
    /// Axes of the drawn body: across, head, front.
    axes: DMat3,
    drawn: Rc<Torso>,
    /// The fit of the marks as they are, or why there is none; `None` until it is made.
    fitted: Option<Result<Box<BodyFit>, String>>,
}

/// The body of a surface as it is drawn before it is fitted.
fn drawn(read: &Read, axes: DMat3) -> Rc<Torso> {
    let origin = read.surface.bounds().map_or(DVec3::ZERO, |[least, most]| 0.5 * (least + most));
    Rc::new(Torso::of_surface(&read.surface, Frame { origin, axes }, axes.z_axis, None))
}

impl Scan {
    /// The scan of a file for a plan, with the marks that its shape suggests; without them y of the file is to the head, z to the front.
    pub(crate) fn new(name: String, read: Read, proposed: Option<Marks>, plan: &Scene) -> Self {
        let side = if plan.is_right() { Side::Right } else { Side::Left };
        let (least, most) = COVER_MM;
        let pinch_mm = plan.measured().pinch_mm.unwrap_or(2.0 * plan.tissue_mm());
        let axes = proposed.and_then(|marks| marks.axes().ok());
        let axes = axes
            .map_or(DMat3::IDENTITY, |axes| DMat3::from_cols(axes.across, axes.head, axes.front));
        let drawn = drawn(&read, axes);
        Self {
            name,
            read,
            side,
            pinch_mm: pinch_mm.clamp(2.0 * least, 2.0 * most),
            points: proposed.map_or_else(Points::default, |marks| Points::of(&marks)),
            chosen: 0,
            axes,
            drawn,
            fitted: None,
        }
    }

    /// The surface of the scan.
    pub(crate) fn surface(&self) -> &Surface {
        &self.read.surface
    }

    /// The drawn body.
    pub(crate) fn drawn(&self) -> &Rc<Torso> {
        &self.drawn
    }

    /// The marks that are set, as dots of the picture.
    pub(crate) fn dots(&self) -> Vec<Dot> {
        let dot = |mark: usize| {
            let at = self.points.get(mark, self.side)?;
            let at = self.drawn.frame().local(at).as_vec3();
            let (name, label) = points::name(mark, self.side);
            Some(Dot { at, name, label, is_chosen: mark == self.chosen })
        };
        self.points.listed(self.side).filter_map(dot).collect()
    }

    /// Turns the drawn body about the axis across by a right angle.
    fn turn(&mut self) {
        self.axes *= DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y);
        self.drawn = drawn(&self.read, self.axes);
    }

    /// Takes what the user did in the picture.
    pub(crate) fn touch(&mut self, touched: Touched) {
        let place = |at: glam::Vec3| self.drawn.frame().point(at.as_dvec3());
        let is_set = |mark: &usize| self.points.get(*mark, self.side).is_some();
        let set = |k: usize| self.points.listed(self.side).filter(is_set).nth(k);
        match touched {
            Touched::Skin(at) => {
                let at = place(at);
                if self.points.get(self.chosen, self.side).is_none() {
                    self.points.set(self.chosen, self.side, at, true);
                    self.chosen = self.points.missing(self.side).unwrap_or(self.chosen);
                    self.fitted = None;
                }
            }
            Touched::Chosen(k) => {
                let mark = set(k).unwrap_or(self.chosen);
                self.choose(mark);
            }
            Touched::Moved(k, at, is_step) => {
                let (at, mark) = (place(at), set(k));
                if let Some(mark) = mark {
                    self.chosen = mark;
                    self.points.set(mark, self.side, at, is_step);
                    self.fitted = None;
                }
            }
        }
    }

    /// Chooses a mark, which is checked with that.
    fn choose(&mut self, mark: usize) {
        self.chosen = mark;
        self.points.check(mark, self.side);
    }

    /// Takes the last step of the marks back.
    pub(crate) fn undo(&mut self) {
        self.points.undo();
        self.chosen = self.points.missing(self.side).unwrap_or(self.chosen);
        self.fitted = None;
    }

    /// Takes the step of the marks again that was taken back last.
    pub(crate) fn redo(&mut self) {
        self.points.redo();
        self.fitted = None;
    }

    /// Takes the marks of a file.
    ///
    /// # Errors
    /// Returns one line that names the wrong mark.
    pub(crate) fn take_marks(&mut self, text: &str) -> Result<(), String> {
        let marks: Marks = scene::read::json(text, "marks").map_err(|error| error.to_string())?;
        self.points.set_all(&marks.scaled(self.read.unit.factor()));
        self.chosen = self.points.missing(self.side).unwrap_or(0);
        self.fitted = None;
        Ok(())
    }

    fn set_unit(&mut self, unit: Unit) {
        self.points.scale(unit.factor() / self.read.unit.factor());
        self.read.set_unit(unit);
        self.drawn = drawn(&self.read, self.axes);
        self.fitted = None;
    }

    /// Fits the body to the marks, once for all marks; nothing while one is missing.
    fn assess(&mut self, plan: &Scene) -> Option<&Result<Box<BodyFit>, String>> {
        let marks = self.points.marks(self.side)?;
        let found = self.fitted.take().unwrap_or_else(|| {
            let settings = Settings {
                cover_mm: 0.5 * self.pinch_mm,
                patch_radius_mm: plan.body.patch_radius_mm,
                pocket_radius_mm: plan.pocket_radius_mm,
                base_radius_mm: plan.implant.base_radius_mm,
                ..Settings::default()
            };
            let found = fit(&self.read.surface, &marks, self.side, &settings);
            found.map(Box::new).map_err(|error| error.to_string())
        });
        Some(self.fitted.insert(found))
    }

    /// The plan with the fitted body, and what to know about it.
    ///
    /// # Errors
    /// Returns one line: a mark is missing or wrong, or the wall carries no tissue.
    pub(crate) fn plan(&mut self, plan: &Scene) -> Result<(Scene, String), String> {
        let (side, unit, cover_mm) = (self.side, self.read.unit, 0.5 * self.pinch_mm);
        let marks = self.points.marks(side).ok_or_else(|| tr("A mark is missing.").to_owned())?;
        // With a plan for each side that of the scanned breast.
        let mut plan = plan.clone();
        let chosen = if side == Side::Left { scene::Side::Left } else { scene::Side::Right };
        if plan.other_side.is_some() && plan.side != Some(chosen) {
            plan.set_side(Some(chosen));
            self.fitted = None;
        }
        let found = match self.assess(&plan) {
            Some(Ok(found)) => &**found,
            Some(Err(error)) => return Err(shown(error)),
            None => return Err(tr("A mark is missing.").to_owned()),
        };
        let fitted = Scene::of_body(found, (&marks, side), cover_mm, unit);
        let mut fitted = fitted.map_err(|error| shown(&error.to_string()))?;
        let mut words: Vec<String> = found.quality.warnings().iter().map(|of| shown(of)).collect();
        if let Some(placement) = &mut fitted.placement {
            placement.proposed_marks = self.points.proposed();
        }
        let kept = kept(&fitted, &plan);
        if kept.is_err() {
            words.push(tr("The implant of the plan does not fit here: the usual one.").to_owned());
        }
        let mut scene = kept.unwrap_or(Scene { visit: plan.visit.clone(), ..fitted });
        if let Some(visit) = scene.visit.as_ref().filter(|visit| !visit.reference.is_empty()) {
            words.push(tr!("Still the plan of patient {reference}.", reference = visit.reference));
        }
        scene.keep_surface(&self.read.surface).map_err(|error| shown(&error.to_string()))?;
        if let Err(error) = scene.refit_other_side() {
            scene.other_side = None;
            words.push(tr!(
                "The other breast has no plan now: {error}",
                error = shown(&error.to_string())
            ));
        }
        Ok((scene, words.join(" ")))
    }
}

/// The scene of a fitted body with the implant, the pocket, the skin and the entries of a plan; an error where the body does not carry them.
fn kept(fitted: &Scene, plan: &Scene) -> Result<Scene, scene::SceneError> {
    let mut scene = Scene {
        side: fitted.side,
        chest: None,
        chest_grid: fitted.chest_grid.clone(),
        thickness_field: fitted.thickness_field.clone(),
        placement: fitted.placement.clone(),
        ..plan.clone()
    };
    scene.implant.center_mm = [0.0; 2];
    if scene.layers.len() == fitted.layers.len() {
        for (own, fitted) in scene.layers.iter_mut().zip(&fitted.layers) {
            own.thickness_mm = fitted.thickness_mm;
        }
    } else {
        scene.layers.clone_from(&fitted.layers);
        scene.set_plane(plan.body.plane);
    }
    let pinch_mm = fitted.measured().pinch_mm;
    scene.apply_patient(Measurements { pinch_mm, ..plan.measured() })?;
    scene.validate()?;
    Ok(scene)
}
