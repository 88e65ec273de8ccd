//! Plans of their own for both sides: the plan of the other side beside a scene.
//!
//! Implant with its reference, pocket with its new fold, pinch, base of the breast and thickness belong to a side, and with a scan its wall, thickness from place to place and
//! frame. All else belongs to the patient and is equal on both sides.

use super::{
    Body, CheckedScene, Field, Placement, Scene, SceneError, SceneFile, Side, out_of_range, problem,
};
use crate::body::fit::{Settings, fit};
use crate::body::frame::Frame;
use crate::body::marks;
use crate::clinical::Measurements;
use serde_json::{Map, Value};

/// What the other side of a file must have.
const IMPLANT: &str = "implant";

impl Side {
    /// The other side of the body.
    #[must_use]
    pub fn other(self) -> Self {
        if self == Self::Right { Self::Left } else { Self::Right }
    }
}

impl Scene {
    /// Gives the other side a plan of its own, at first equal to this one; with a scan on the wall of that side, fitted to the marks of its breast.
    /// A scene that has one stays as it is; one without a side, or of both, becomes that of the left side.
    ///
    /// # Errors
    /// A scan without its surface or without marks of the other breast, or whose other side carries no tissue.
    pub fn add_other_side(&mut self) -> Result<(), SceneError> {
        if self.other_side.is_some() {
            return Ok(());
        }
        let mut other = self.clone();
        if let Some(placement) = &self.placement {
            let fitted = self.fitted_on_other_side(placement, self)?;
            (other.chest_grid, other.thickness_field) = (fitted.chest_grid, fitted.thickness_field);
            other.placement = fitted.placement;
        }
        let mut scene = self.clone();
        scene.side = Some(if self.is_right() { Side::Right } else { Side::Left });
        scene.other_side = Some(Box::new(scene.beside(other)));
        scene.validate()?;
        *self = scene;
        Ok(())
    }

    /// Fits another body, which this scene has, under the plan of the other side: implant and pocket stay, thickness and pinch are those of this scene.
    ///
    /// # Errors
    /// As [`Self::add_other_side`].
    pub fn refit_other_side(&mut self) -> Result<(), SceneError> {
        let (Some(own), Some(placement)) = (&self.other_side, &self.placement) else {
            return Ok(());
        };
        let fitted = self.fitted_on_other_side(placement, own)?;
        let mut other = Self {
            chest_grid: fitted.chest_grid,
            thickness_field: fitted.thickness_field,
            placement: fitted.placement,
            layers: self.layers.clone(),
            patient: self.patient.clone(),
            ..(**own).clone()
        };
        other.implant.center_mm = [0.0; 2];
        let mut scene = self.clone();
        scene.other_side = Some(Box::new(scene.beside(other)));
        scene.validate()?;
        *self = scene;
        Ok(())
    }

    /// The scene of the body's fit on the other side, for a plan of that side.
    fn fitted_on_other_side(&self, placement: &Placement, plan: &Self) -> Result<Self, SceneError> {
        let wrong = |words: &str| problem("body", words);
        let kept = placement.surface.as_ref().ok_or_else(|| wrong("the plan has no surface"))?;
        let side = if self.is_right() { marks::Side::Left } else { marks::Side::Right };
        let settings = Settings {
            cover_mm: placement.cover_mm,
            patch_radius_mm: plan.body.patch_radius_mm,
            pocket_radius_mm: plan.pocket_radius_mm,
            base_radius_mm: plan.implant.base_radius_mm,
            ..Settings::default()
        };
        let found = fit(kept.surface(), &placement.marks, side, &settings);
        let found = found.map_err(|error| wrong(&error.to_string()))?;
        let of = (&placement.marks, side);
        let mut fitted = Self::of_body(&found, of, placement.cover_mm, placement.unit.into())?;
        if let Some(own) = &mut fitted.placement {
            own.proposed_marks.clone_from(&placement.proposed_marks);
        }
        Ok(fitted)
    }

    /// A scene of the other side with what belongs to its side, and all else of this scene.
    fn beside(&self, own: Self) -> Self {
        let mut layers = self.layers.clone();
        if layers.len() == own.layers.len() {
            for (layer, own) in layers.iter_mut().zip(&own.layers) {
                layer.thickness_mm = own.thickness_mm;
            }
        }
        let measured = own.measured();
        let mut patient = self.patient.clone();
        if let Some(patient) = &mut patient {
            let Measurements { skin_pull_mm, skin_class, base_width_mm, .. } = patient.measured;
            let base_width_mm = measured.base_width_mm.or(base_width_mm);
            patient.measured = Measurements { skin_pull_mm, skin_class, base_width_mm, ..measured };
            // A listed number that is not the derived one was set by hand.
            let derived = own.patient.into_iter().flat_map(|own| own.derived);
            let derived: Vec<_> = derived.filter(|path| !patient.derived.contains(path)).collect();
            patient.derived.extend(derived);
        }
        let mut placement = own.placement.filter(|_| self.placement.is_some());
        if let (Some(placement), Some(all)) = (&mut placement, &self.placement) {
            **placement = Placement {
                unit: all.unit,
                cover_mm: all.cover_mm,
                marks: all.marks,
                proposed_marks: all.proposed_marks.clone(),
                surface: None,
                ..(**placement).clone()
            };
        }
        Self {
            implant: own.implant,
            implant_reference: own.implant_reference,
            pocket_radius_mm: own.pocket_radius_mm,
            body: Body {
                patch_radius_mm: own.body.patch_radius_mm,
                pocket_lowered_mm: own.body.pocket_lowered_mm,
                ..self.body
            },
            chest_grid: as_here(own.chest_grid, &self.chest_grid),
            thickness_field: as_here(own.thickness_field, &self.thickness_field),
            layers,
            patient,
            placement,
            side: Some(self.side.unwrap_or(Side::Left).other()),
            visit: None,
            other_side: None,
            chest: self.chest,
            torso: self.torso,
            insertion: self.insertion,
            springs: self.springs,
            solver: self.solver,
        }
    }

    /// Gives the other side what belongs to both sides, after an edit of this one.
    pub fn align_other_side(&mut self) {
        if let Some(other) = self.other_side.take() {
            self.other_side = Some(Box::new(self.beside(*other)));
        }
    }

    /// Makes the plan of the other side this one; nothing where both sides have one plan.
    pub fn exchange_sides(&mut self) {
        let Some(mut now) = self.other_side.take() else { return };
        now.visit = self.visit.take();
        if let (Some(now), Some(own)) = (&mut now.placement, &self.placement) {
            now.surface.clone_from(&own.surface);
        }
        let before = std::mem::replace(self, *now);
        self.other_side = Some(Box::new(self.beside(before)));
    }

    /// Chooses a side: where both have plans of their own, the other one's becomes this scene; no side and both sides are one plan again.
    pub fn set_side(&mut self, side: Option<Side>) {
        match side {
            Some(Side::Left | Side::Right) if self.other_side.is_some() => {
                if self.side != side {
                    self.exchange_sides();
                }
            }
            _ => (self.side, self.other_side) = (side, None),
        }
    }

    /// The places of the scene, and of the other side's plan, on the body; none without a body.
    #[must_use]
    pub fn frames(&self) -> Vec<Frame> {
        let scenes = [Some(self), self.other_side.as_deref()].into_iter().flatten();
        scenes.filter_map(|scene| Some(scene.placement.as_ref()?.frame())).collect()
    }

    /// Checks the plan of the other side.
    pub(super) fn check_other_side(&self) -> Result<(), SceneError> {
        let Some(other) = &self.other_side else { return Ok(()) };
        if !matches!(self.side, Some(Side::Left | Side::Right)) {
            let side = self.side.map_or("not stated", Side::word).to_owned();
            return Err(out_of_range("side", side, "left or right beside other_side"));
        }
        CheckedScene::new((**other).clone()).map(drop).map_err(of_other_side)
    }

    /// The members of the other side's plan that differ from this scene, as they are written.
    pub(super) fn other_side_written(&self) -> Option<Map<String, Value>> {
        let other = self.other_side.as_deref()?;
        let members = |scene: Self| match serde_json::to_value(scene) {
            Ok(Value::Object(members)) => members,
            _ => Map::new(),
        };
        let own = members(Self { other_side: None, ..self.without_surface() });
        let mut written = members(Self { side: self.side, ..other.clone() });
        written.retain(|name, value| name == IMPLANT || own.get(name) != Some(value));
        // Not written where it is zero, which the other side may have alone.
        let lowered = Field::PocketLowered.path;
        if own.contains_key(lowered) && other.body.pocket_lowered_mm <= 0.0 {
            written.insert(lowered.to_owned(), 0.0.into());
        }
        Some(written)
    }

    /// Sets the plan of the other side from a file: what it leaves out is that of this scene.
    pub(super) fn read_other_side(&mut self, file: SceneFile) -> Result<(), SceneError> {
        let stated = [
            ("side", file.side.is_some()),
            ("visit", file.visit.is_some()),
            ("pins", file.pins.is_some()),
            ("other_side", file.other_side.is_some()),
        ];
        if let Some((name, _)) = stated.into_iter().find(|(_, is_stated)| *is_stated) {
            let allowed = "this field beside other_side only";
            return Err(of_other_side(out_of_range(name, "given".to_owned(), allowed)));
        }
        let own = file.filled_beside(Some(self)).map_err(of_other_side)?;
        self.side = self.side.or(Some(Side::Left));
        self.other_side = Some(Box::new(self.beside(own)));
        Ok(())
    }
}

/// A field of the other side where this one has it: its own, else this side's.
fn as_here<T: Clone>(own: Option<T>, here: &Option<T>) -> Option<T> {
    here.as_ref().map(|here| own.unwrap_or_else(|| here.clone()))
}

fn of_other_side(source: SceneError) -> SceneError {
    SceneError::OtherSide(Box::new(source))
}
