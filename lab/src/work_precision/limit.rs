//! The limit of all grids: axisymmetric references.

use crate::axisymmetric_layers::{Input, Mound};
use crate::{axisymmetric as sheet, axisymmetric_layers as layers};
use implant_preview_core::scene::Scene;
use implant_preview_core::solve::{Problem, Tissue};
use implant_preview_core::springs::Springs;
use implant_preview_core::springs::solids::SolidKind;

/// A face of the tissue; both are the sheet's only face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The inner face.
    Inner,
    /// The skin's membrane.
    Skin,
}

/// Deformed (r, z) \[mm\] of a face at the material radius s \[mm\].
pub type Profile = Box<dyn Fn(Face, f64) -> (f64, f64)>;

/// Computes the limit of all grids, if known.
pub type Reference = fn(&Scene, Option<Mound>) -> Option<Profile>;

/// Cells of the two meshes of the layered reference, along the radius and through the solids.
const MESHES: [[usize; 2]; 2] = [[144, 8], [216, 12]];
/// Weight of the difference of both meshes in the limit: over solids that all stiffen errors are of second order in the width of
/// the cells, over others of first order.
const EXTRAPOLATION: [f64; 2] = [0.8, 2.0];

/// The reference of a centred dome: of a sheet under coupled springs [`sheet`], of layered tissue [`layers`],
/// extrapolated from two meshes. A thickness field is that of `mound`, in closed form.
#[must_use]
pub fn axisymmetric(scene: &Scene, mound: Option<Mound>) -> Option<Profile> {
    let problem = scene.problem().ok()?;
    let mut even = scene.clone();
    even.thickness_field = even.thickness_field.filter(|_| mound.is_none());
    if !even.is_round() {
        return None;
    }
    match problem.tissue {
        Tissue::Layered => of_layers(scene, mound, &problem),
        Tissue::Sheet if problem.springs == Springs::Coupled => of_sheet(&problem),
        Tissue::Sheet => None,
    }
}

fn of_sheet(Problem { patch, obstacle, materials, .. }: &Problem) -> Option<Profile> {
    let solution = sheet::solve(&obstacle.dome, patch.pocket_radius_mm, materials).ok()?;
    Some(Box::new(move |_, s_mm| {
        let point = solution.point(s_mm);
        (point.r_mm, point.z_mm)
    }))
}

fn of_layers(scene: &Scene, mound: Option<Mound>, problem: &Problem) -> Option<Profile> {
    // The reference has the curve's law.
    if problem.solids().iter().any(|solid| solid.solid != SolidKind::Curve) {
        return None;
    }
    let stiffens = problem.solids().iter().all(|solid| solid.curve.stiffens());
    let weight = EXTRAPOLATION[usize::from(!stiffens)];
    let on = |cells: [usize; 2]| {
        let mut input = Input::of(scene, problem, cells)?;
        input.rest.mound = mound;
        layers::solve(&input).ok()
    };
    let [fine, finest] = [on(MESHES[0])?, on(MESHES[1])?];
    Some(Box::new(move |face, s_mm| {
        let [a, b] = [&fine, &finest].map(|solution| {
            let (inner, skin) = solution.point(s_mm);
            if face == Face::Inner { inner } else { skin }
        });
        let limit = |k: usize| b[k] + weight * (b[k] - a[k]);
        (limit(0), limit(1))
    }))
}
