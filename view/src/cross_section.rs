//! The cross-section of the drawn tissue through the pocket's centre: columns on the grid's row of y = 0, or of x = 0.

use crate::body::Body;
use glam::{DVec2, Vec2, Vec3};
use implant_preview_core::mesh::{NodeKind, Sheet};
use implant_preview_core::scene::Scene;

/// The plane of a cross-section, upright on the chest wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionPlane {
    /// y = 0: from the midline to the side.
    Across,
    /// x = 0: from the feet to the head.
    Along,
}

impl SectionPlane {
    /// The plane in which the implant of a scene shows its shape.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        if scene.implant.is_round() { Self::Across } else { Self::Along }
    }

    /// The place (x, y) in the plane at a distance from the pocket's centre \[mm\].
    #[must_use]
    pub fn place(self, distance: f64) -> DVec2 {
        match self {
            Self::Across => DVec2::new(distance, 0.0),
            Self::Along => DVec2::new(0.0, distance),
        }
    }

    /// The distance of a place (x, y) from the pocket's centre along the plane \[mm\].
    #[must_use]
    pub fn distance(self, place: DVec2) -> f64 {
        match self {
            Self::Across => place.x,
            Self::Along => place.y,
        }
    }

    /// The nodes of a sheet nearest to the plane, in the order of their distances.
    pub fn nodes(self, sheet: &Sheet) -> impl Iterator<Item = usize> + Clone + '_ {
        let n = sheet.nodes_per_side();
        let node = move |k: usize| match self {
            Self::Across => n / 2 * n + k,
            Self::Along => k * n + n / 2,
        };
        (0..n).map(node).filter(|&k| sheet.kinds()[k] != NodeKind::Outside)
    }

    /// A point (distance, z) of the plane from a point (x, y, z).
    #[must_use]
    pub fn point(self, at: Vec3) -> Vec2 {
        Vec2::new(self.distance(at.truncate().as_dvec2()) as f32, at.z)
    }
}

/// Tissue in a plane. Points are (distance from the pocket's centre, z) \[mm\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrossSection {
    /// Columns of the body, with increasing distance at rest.
    pub columns: Vec<usize>,
    /// Points of the columns, from the skin's outer surface to the inner face.
    pub levels: Vec<Vec<Vec2>>,
    /// Layer between a level and the next, counted from the skin.
    pub layers: Vec<usize>,
}

impl CrossSection {
    /// The cross-section of a body on a sheet; empty without tissue or with the sheet of another body.
    #[must_use]
    pub fn new(body: &Body, sheet: &Sheet, plane: SectionPlane) -> Self {
        let n = sheet.nodes_per_side();
        if body.is_empty() || body.nodes_per_side != n {
            return Self::default();
        }
        let columns: Vec<usize> = plane.nodes(sheet).collect();
        let points = |level: &Vec<Vec3>| columns.iter().map(|&k| plane.point(level[k])).collect();
        Self {
            levels: body.levels.iter().map(points).collect(),
            layers: body.slabs.iter().map(|slab| slab.layer).collect(),
            columns,
        }
    }

    /// The skin's outer surface; empty without tissue.
    #[must_use]
    pub fn skin(&self) -> &[Vec2] {
        self.levels.first().map_or(&[], Vec::as_slice)
    }

    /// Greatest height over the plane z = 0 \[mm\].
    #[must_use]
    pub fn height(&self) -> f32 {
        self.skin().iter().map(|p| p.y).fold(0.0, f32::max)
    }

    /// Least height over the plane z = 0, 0 or less: below 0 beside the middle of a curved chest \[mm\].
    #[must_use]
    pub fn depth(&self) -> f32 {
        self.levels.iter().flatten().map(|p| p.y).fold(0.0, f32::min)
    }

    /// The quadrilaterals of the slabs, with their layers.
    pub fn quads(&self) -> impl Iterator<Item = (usize, [Vec2; 4])> + '_ {
        self.levels.windows(2).zip(&self.layers).flat_map(|(pair, &layer)| {
            let (outer, inner) = (&pair[0], &pair[1]);
            (1..outer.len()).map(move |k| (layer, [outer[k - 1], outer[k], inner[k], inner[k - 1]]))
        })
    }

    /// The layer at a point; `None` outside of the tissue.
    #[must_use]
    pub fn layer_at(&self, point: Vec2) -> Option<usize> {
        let contains = |quad: &[Vec2; 4]| {
            let side = |k: usize| (quad[(k + 1) % 4] - quad[k]).perp_dot(point - quad[k]);
            let sides = [0, 1, 2, 3].map(side);
            sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
        };
        self.quads().find(|(_, quad)| contains(quad)).map(|(layer, _)| layer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::both;

    #[test]
    fn the_layers_lie_over_each_other_and_a_point_has_its_layer() {
        let planes = [SectionPlane::Across, SectionPlane::Along];
        for (session, body, plane) in both().iter().flat_map(|(s, b)| planes.map(|p| (s, b, p))) {
            let sheet = session.problem().sheet();
            let section = CrossSection::new(body, sheet, plane);
            assert!(section.skin().windows(2).all(|pair| pair[0].x < pair[1].x));
            assert_eq!(section.columns.len(), 33);
            assert!((section.height() - body.height()).abs() < 1e-3, "the apex is in the plane");
            let apex = |level: usize| section.levels[level][16];
            for (level, &layer) in section.layers.iter().enumerate() {
                let (outer, inner) = (apex(level), apex(level + 1));
                assert!(outer.y > inner.y);
                // Beside the border between two quadrilaterals.
                let between = 0.5 * (outer + inner) + Vec2::new(0.3, 0.0);
                assert_eq!(section.layer_at(between), Some(layer));
            }
            assert_eq!(section.layer_at(Vec2::new(0.3, section.height() + 1.0)), None);
            assert_eq!(section.layer_at(Vec2::new(0.3, 10.0)), None, "in the implant");
        }
    }

    #[test]
    fn without_tissue_nothing_is_drawn() {
        let sheet = Sheet::new(9, 50.0);
        let section = CrossSection::new(&Body::default(), &sheet, SectionPlane::Across);
        assert_eq!(section, CrossSection::default());
        assert_eq!((section.skin().len(), section.quads().count()), (0, 0));
    }
}
