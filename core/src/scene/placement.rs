//! Where a scene lies on a body: unit, frame and marks; and the scene of a fitted body.

use super::kept_surface::{KeptSurface, SurfaceFile};
use super::thickness::FACTORS;
use super::{ChestGrid, HeightsGrid, Scene, SceneError, Side, ThicknessGrid, out_of_range};
use crate::body::fit::BodyFit;
use crate::body::frame::Frame;
use crate::body::marks::{self, Marks};
use crate::body::read::Unit;
use crate::body::surface::Surface;
use crate::clinical::Measurements;
use crate::curve::{given, number, present};
use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The place of a scene on a body's surface; no equilibrium depends on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "BodyPlace")]
pub struct Placement {
    /// Unit of the surface's file.
    #[serde(deserialize_with = "present")]
    pub unit: LengthUnit,
    /// Thickness of the tissue beside the breast, of which the wall was made \[mm\], 6 to 30.
    #[serde(deserialize_with = "present")]
    pub cover_mm: f64,
    /// The pocket's centre on the wall, in the surface's axes \[mm\].
    #[serde(deserialize_with = "present")]
    pub origin_mm: [f64; 3],
    /// Unit vectors of the scene in the surface's axes: x from the midline to the patient's side, y to the head, z away from the wall.
    #[serde(deserialize_with = "present")]
    pub axes: [[f64; 3]; 3],
    /// The surgeon's marks, points in the surface's axes \[mm\] by their names.
    #[serde(deserialize_with = "present")]
    #[schemars(with = "BTreeMap<String, [f64; 3]>")]
    pub marks: Marks,
    /// Names of the marks that the program proposed and nobody has checked; default: none.
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Vec::is_empty")]
    pub proposed_marks: Vec<String>,
    /// The body's surface, reduced; default: none.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<SurfaceFile>")]
    pub surface: Option<KeptSurface>,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "a unit is its own description")]
pub enum LengthUnit {
    Mm,
    Cm,
    M,
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Mm => Self::Mm,
            Unit::Cm => Self::Cm,
            Unit::M => Self::M,
        }
    }
}

impl From<LengthUnit> for Unit {
    fn from(unit: LengthUnit) -> Self {
        match unit {
            LengthUnit::Mm => Self::Mm,
            LengthUnit::Cm => Self::Cm,
            LengthUnit::M => Self::M,
        }
    }
}

/// Thickness of the tissue beside a breast \[mm\].
pub const COVER_MM: (f64, f64) = (6.0, 30.0);
/// Greatest coordinate of the origin \[mm\].
const GREATEST_MM: f64 = 1e7;
/// Greatest deviation of the axes from unit vectors at right angles \[-\].
const AXES: f64 = 1e-6;
/// Nodes of the scene's grids from their centre to the edge of the patch.
const NODES: usize = 32;
/// Decimals of heights \[mm\] and of factors.
const DECIMALS: (f64, f64) = (1e4, 1e5);

impl Placement {
    /// The frame of the scene.
    #[must_use]
    pub fn frame(&self) -> Frame {
        let [x, y, z] = self.axes.map(DVec3::from);
        Frame { origin: self.origin_mm.into(), axes: DMat3::from_cols(x, y, z) }
    }

    fn check(&self) -> Result<(), SceneError> {
        let (least, most) = COVER_MM;
        if !(least..=most).contains(&self.cover_mm) {
            let allowed = format!("{least} to {most} mm");
            return Err(out_of_range("body.cover_mm", number(self.cover_mm), &allowed));
        }
        if let Some(wrong) = self.origin_mm.iter().find(|x| x.is_nan() || x.abs() > GREATEST_MM) {
            let allowed = format!("up to {GREATEST_MM} mm");
            return Err(out_of_range("body.origin_mm", number(*wrong), &allowed));
        }
        let axes = self.frame().axes;
        let apart = axes.transpose() * axes - DMat3::IDENTITY;
        let most = apart
            .to_cols_array()
            .iter()
            .fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x.abs()) });
        if most > AXES {
            let value = format!("off by {}", number(most));
            return Err(out_of_range("body.axes", value, "unit vectors at right angles"));
        }
        let is_name = |name: &String| marks::NAMES.contains(&name.as_str());
        if let Some(wrong) = self.proposed_marks.iter().find(|name| !is_name(name)) {
            let value = format!("\"{wrong}\"");
            return Err(out_of_range("body.proposed_marks", value, "names of body.marks"));
        }
        Ok(())
    }
}

impl Scene {
    /// Checks the place on a body.
    pub(super) fn check_placement(&self) -> Result<(), SceneError> {
        self.placement.as_ref().map_or(Ok(()), |placement| placement.check())
    }

    /// The scene of a body that was fitted on a side: the opening plan's implant and skin, a pinch of twice the cover, and wall and
    /// thickness of the fit. `cover_mm` is that of the fit, which must be one for the pocket and the patch of the opening plan.
    ///
    /// # Errors
    /// A wall that does not carry the tissue.
    pub fn of_body(
        fit: &BodyFit,
        (marks, side): (&Marks, marks::Side),
        cover_mm: f64,
        unit: Unit,
    ) -> Result<Self, SceneError> {
        let mut scene = Self::opening();
        let pinch_mm = Some(2.0 * cover_mm);
        scene.apply_patient(Measurements { pinch_mm, ..scene.measured() })?;
        scene.side = Some(match side {
            marks::Side::Left => Side::Left,
            marks::Side::Right => Side::Right,
        });
        scene.chest = None;
        let (wall, thickness) = scene.grids_of(fit);
        (scene.chest_grid, scene.thickness_field) = (Some(wall), Some(thickness));
        let Frame { origin, axes } = fit.frame;
        scene.placement = Some(Box::new(Placement {
            unit: unit.into(),
            cover_mm,
            origin_mm: origin.to_array(),
            axes: axes.to_cols_array_2d(),
            marks: *marks,
            proposed_marks: Vec::new(),
            surface: None,
        }));
        scene.validate()?;
        Ok(scene)
    }

    /// Wall and thickness of a fit under the layers of the scene.
    pub(super) fn grids_of(&self, fit: &BodyFit) -> (ChestGrid, ThicknessGrid) {
        let (grid, side_of_grid) = (fit.grid, 2 * NODES + 1);
        let [even_mm, uneven_mm] = self.even_and_uneven_mm();
        let rounded = |value: f64, decimals: f64| (value * decimals).round() / decimals;
        let nodes = || {
            let first = grid.half.saturating_sub(NODES);
            let row = move |j: usize| (first + j) * grid.side() + first;
            (0..side_of_grid).flat_map(move |j| row(j)..row(j) + side_of_grid)
        };
        let heights = nodes().map(|node| Some(rounded(fit.wall_mm[node], DECIMALS.0)));
        let factors = nodes().map(|node| {
            let factor = (fit.thickness_mm[node] - even_mm) / uneven_mm;
            rounded(factor.clamp(FACTORS.0, FACTORS.1), DECIMALS.1)
        });
        let (spacing_mm, columns, rows) = (grid.spacing_mm, side_of_grid, side_of_grid);
        let heights_mm = heights.collect();
        let heights = HeightsGrid { spacing_mm, columns, rows, heights_mm, smooth_mm: 0.0 };
        let factors = factors.collect();
        (ChestGrid { grid: heights }, ThicknessGrid { spacing_mm, columns, rows, factors })
    }

    /// The scene without the surface of its body.
    #[must_use]
    pub fn without_surface(&self) -> Self {
        let mut scene = self.clone();
        if let Some(placement) = &mut scene.placement {
            placement.surface = None;
        }
        scene
    }

    /// Has another scene the same scanned wall and tissue on the same side?
    #[must_use]
    pub fn is_on_wall_of(&self, other: &Self) -> bool {
        self.chest_grid.is_some()
            && (self.side, &self.chest_grid, &self.thickness_field)
                == (other.side, &other.chest_grid, &other.thickness_field)
    }

    /// Does another scene lie on the same body: the same scanned wall, or the same torso by a tape?
    #[must_use]
    pub fn is_on_body_of(&self, other: &Self) -> bool {
        self.is_on_wall_of(other) || self.torso.is_some() && self.torso == other.torso
    }

    /// Keeps the surface of the scene's body in its file; a scene without a place on a body stays as it is.
    ///
    /// # Errors
    /// A surface without triangles, or beyond 65 m.
    pub fn keep_surface(&mut self, surface: &Surface) -> Result<(), SceneError> {
        let Some(placement) = &mut self.placement else { return Ok(()) };
        let kept = KeptSurface::of(surface);
        let wrong = || {
            out_of_range(
                "body.surface",
                "empty or too large".to_owned(),
                "1 triangle or more within 65 m",
            )
        };
        placement.surface = Some(kept.ok_or_else(wrong)?);
        Ok(())
    }
}
