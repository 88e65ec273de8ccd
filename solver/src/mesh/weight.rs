//! A change of the tissue's weight, as from one posture to another, on the nodes at rest.

use super::{NodeKind, Rest};
use glam::DVec3;

/// Signs of the natural coordinates of a cell's corners on a face.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// A change of the tissue's weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weight {
    /// Per volume \[kPa/mm\].
    pub per_volume: DVec3,
    /// Thickness of the skin, which has no cells \[mm\].
    pub skin_mm: f64,
}

impl Weight {
    /// Is there no change?
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.per_volume.abs().max_element() <= 0.0
    }

    /// Is the change its own image mirrored along x, along y?
    pub(super) fn mirrored(&self) -> [bool; 2] {
        [self.per_volume.x, self.per_volume.y].map(|part| part.abs() <= 0.0)
    }
}

impl Rest {
    /// The change of the weight on the nodes of all layers \[kPa·mm²\]: an eighth of a cell's on each of its corners, a quarter of the skin's
    /// over it. Cells across the patch's border count as whole ones. Empty without a change.
    pub(crate) fn change_of_weight(&self) -> Vec<Vec<DVec3>> {
        let Weight { per_volume, skin_mm } = self.weight();
        if self.weight().is_none() {
            return Vec::new();
        }
        let sheet = self.sheet();
        let n = sheet.nodes_per_side();
        let mut weight = vec![vec![DVec3::ZERO; sheet.len()]; self.layers()];
        let top = self.layers() - 1;
        for (i, j) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (i, j))) {
            let corners = sheet.corners(i, j);
            if corners.iter().all(|&k| sheet.kinds()[k] != NodeKind::Free) {
                continue;
            }
            for layer in 0..top {
                let share = per_volume * (0.125 * self.volume(corners, layer));
                for (face, k) in
                    [layer, layer + 1].into_iter().flat_map(|l| corners.map(|k| (l, k)))
                {
                    weight[face][k] += share;
                }
            }
            let area = self.area_of_face(top, corners);
            for k in corners {
                weight[top][k] += per_volume * (0.25 * area * skin_mm);
            }
        }
        weight
    }

    /// Volume of a trilinear cell of a layer \[mm³\]: the determinant of its gradient at the four points of the plane in its middle.
    fn volume(&self, corners: [usize; 4], layer: usize) -> f64 {
        let [inner, outer] = [layer, layer + 1].map(|l| corners.map(|k| self.node(l, k)));
        let point = 1.0 / 3.0_f64.sqrt();
        let at = |[x, y]: [f64; 2]| {
            let (mut across, mut along, mut up) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
            for (c, [sx, sy]) in CORNERS.into_iter().enumerate() {
                let (middle, height) = (0.5 * (inner[c] + outer[c]), outer[c] - inner[c]);
                across += middle * (0.25 * sx * (1.0 + sy * y));
                along += middle * (0.25 * sy * (1.0 + sx * x));
                up += height * (0.25 * (1.0 + sx * x) * (1.0 + sy * y));
            }
            across.cross(along).dot(up)
        };
        CORNERS.into_iter().map(|[x, y]| at([x * point, y * point])).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Chest, Sheet};

    /// A shell of a cylinder about y: (R + t)² − R² of its sector, less the caps that the patch leaves out.
    #[test]
    fn the_weight_is_that_of_the_volume() {
        let solids = [6.0, 14.0];
        let of = |chest: Chest, skin_mm: f64| {
            let rest = Rest::layered(Sheet::new(65, 100.0), &solids, 4).over(chest);
            let per_volume = DVec3::new(0.0, -1.0, 0.5);
            let weight = rest.weighed(Weight { per_volume, skin_mm }).change_of_weight();
            weight.into_iter().flatten().sum::<DVec3>()
        };
        let flat = of(Chest::Flat, 0.0);
        // The cells cover the disc and, across its border, at most a ring of a cell's diagonal.
        let disc = std::f64::consts::PI * 100.0_f64.powi(2) * 20.0;
        assert!(-flat.y >= disc && -flat.y <= disc * 1.1, "{flat}");
        assert!((flat.z + 0.5 * flat.y).abs() <= 1e-9 * disc && flat.x.abs() <= 1e-9 * disc);
        let with_skin = of(Chest::Flat, 2.0);
        assert!((with_skin.y / flat.y - 1.1).abs() < 1e-12);
        let inner = of(Chest::Curved { across_mm: 150.0, along_mm: f64::INFINITY }, 0.0);
        assert!(inner.y / flat.y > 1.05 && inner.y / flat.y < 1.12, "{inner} {flat}");
    }
}
