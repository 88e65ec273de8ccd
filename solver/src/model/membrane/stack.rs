//! The layers of a deformed membrane: normals and thicknesses.

use super::deformation::{Deformation, LEAST_AREA_STRETCH, thickness_exponent};
use crate::springs::Material;
use glam::{DVec3, Vec3};

/// The layers' deformed geometry at every node.
///
/// In a sheet the layers lie along the normals; in layered tissue the faces between the layers are computed, and only the skin
/// lies along the normals of its membrane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stack {
    /// Unit normals of the deformed sheet, pointing to the skin, shape (nodes_per_side², ); straight
    /// up outside the sheet.
    pub normal: Vec<Vec3>,
    /// Deformed thickness of each layer \[mm\], from the skin inwards, shape (layers, nodes_per_side²);
    /// zero outside the sheet.
    pub thickness_mm: Vec<Vec<f32>>,
    /// Positions of the faces between the inner face and the skin \[mm\], from the inside outwards, where they are computed;
    /// shape (layers − 1, nodes_per_side²).
    pub between: Vec<Vec<Vec3>>,
}

impl Stack {
    /// The stack of layers, from the skin inwards, on a deformed sheet.
    pub(crate) fn new(materials: &[Material], deformation: &Deformation) -> Self {
        let normal = |k| deformation.normal(k).as_vec3();
        Self {
            normal: (0..deformation.part().nodes_of_grid()).map(normal).collect(),
            thickness_mm: thickness_mm(materials, deformation),
            between: Vec::new(),
        }
    }

    /// The stack of layered tissue. `faces` are the inner face and the outer face of each solid, `deformation` is that of
    /// the skin.
    pub(crate) fn layered(
        materials: &[Material],
        deformation: &Deformation,
        faces: &[&[DVec3]],
    ) -> Self {
        let mut stack = Self::new(&materials[..1], deformation);
        for pair in faces.windows(2) {
            let thickness = |k| solid_thickness_mm(deformation, pair[0][k], pair[1][k], k);
            stack.thickness_mm.insert(1, (0..pair[0].len()).map(thickness).collect());
        }
        let face = |face: &&[DVec3]| face.iter().map(|p| p.as_vec3()).collect();
        stack.between = faces[1..].iter().map(face).collect();
        stack
    }

    /// Positions of the faces: `inner`, the faces between the layers, the skin; a face that is not computed is the face below,
    /// moved along the normals by the thickness of the layer between. Shape (layers + 1, `inner.len()`).
    #[must_use]
    pub fn faces(&self, inner: Vec<Vec3>) -> Vec<Vec<Vec3>> {
        let mut faces = Vec::with_capacity(self.thickness_mm.len() + 1);
        faces.push(inner);
        faces.extend(self.between.iter().cloned());
        let layers = self.thickness_mm.len();
        for thickness in self.thickness_mm[..layers - self.between.len()].iter().rev() {
            let below = &faces[faces.len() - 1];
            faces.push(offset(below, &self.normal, thickness).collect());
        }
        faces
    }
}

/// Deformed thickness of a solid layer at a node \[mm\], between its faces' positions \[mm\]: along the skin's normal,
/// because columns of sheared tissue are longer.
pub(crate) fn solid_thickness_mm(
    deformation: &Deformation,
    inner: DVec3,
    outer: DVec3,
    node: usize,
) -> f32 {
    (outer - inner).dot(deformation.normal(node)).max(0.0) as f32
}

/// Points moved along directions by thicknesses.
pub fn offset(
    points: &[Vec3],
    directions: &[Vec3],
    thickness: &[f32],
) -> impl Iterator<Item = Vec3> {
    points.iter().zip(directions).zip(thickness).map(|((p, d), t)| *p + *d * *t)
}

/// For each layer the first layer of the same Poisson ratio, with equal ē and λ₃.
pub(crate) fn first_alike(materials: &[Material]) -> impl Iterator<Item = usize> + '_ {
    let nu = |k: usize| materials[k].poisson_ratio.to_bits();
    (0..materials.len()).map(move |k| (0..k).find(|&j| nu(j) == nu(k)).unwrap_or(k))
}

/// [`Stack::thickness_mm`] of a layer at a node of the sheet: thickness at rest times (λ₁λ₂)^(−ν/(1−ν)), in `f32` by one
/// logarithm for all layers: sufficient for drawing, and faster than powers.
pub(crate) fn thickness_at_mm(material: &Material, logarithm: f32) -> f32 {
    let exponent = thickness_exponent(material.poisson_ratio) as f32;
    material.thickness_mm as f32 * (exponent * logarithm).exp()
}

/// ln λ₁λ₂ at a node.
pub(crate) fn log_area_stretch(deformation: &Deformation, node: usize) -> f32 {
    (deformation.area_stretch(node).max(LEAST_AREA_STRETCH) as f32).ln()
}

/// [`Stack::thickness_mm`].
fn thickness_mm(materials: &[Material], deformation: &Deformation) -> Vec<Vec<f32>> {
    let part = deformation.part();
    let logarithms: Vec<(usize, f32)> =
        deformation.inside().map(|k| (part.index(k), log_area_stretch(deformation, k))).collect();
    let mut thickness_mm: Vec<Vec<f32>> = Vec::with_capacity(materials.len());
    for (k, first) in first_alike(materials).enumerate() {
        let rest = materials[k].thickness_mm;
        thickness_mm.push(if first < k {
            let ratio = (rest / materials[first].thickness_mm) as f32;
            thickness_mm[first].iter().map(|t| t * ratio).collect()
        } else {
            let mut values = vec![0.0; part.len()];
            for &(index, logarithm) in &logarithms {
                values[index] = thickness_at_mm(&materials[k], logarithm);
            }
            part.on_grid(values)
        });
    }
    thickness_mm
}
