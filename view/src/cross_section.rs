//! The cross-section of the drawn tissue through the pocket's centre: columns on the grid's row of y = 0.

use crate::body::Body;
use glam::Vec2;
use implant_preview_core::mesh::{NodeKind, Sheet};

/// Tissue in the plane y = 0. Points are (x, z) \[mm\], from the midline to the side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrossSection {
    /// Columns of the body, with increasing x at rest.
    pub columns: Vec<usize>,
    /// Points of the columns, from the skin's outer surface to the inner face.
    pub levels: Vec<Vec<Vec2>>,
    /// Layer between a level and the next, counted from the skin.
    pub layers: Vec<usize>,
}

impl CrossSection {
    /// The cross-section of a body on a sheet; empty without tissue or with the sheet of another body.
    #[must_use]
    pub fn new(body: &Body, sheet: &Sheet) -> Self {
        let n = sheet.nodes_per_side();
        if body.is_empty() || body.nodes_per_side != n {
            return Self::default();
        }
        let row = n / 2 * n..(n / 2 + 1) * n;
        let columns: Vec<usize> = row.filter(|&k| sheet.kinds()[k] != NodeKind::Outside).collect();
        let points = |level: &Vec<glam::Vec3>| {
            columns.iter().map(|&k| Vec2::new(level[k].x, level[k].z)).collect()
        };
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
        for (session, body) in both() {
            let sheet = session.problem().sheet();
            let section = CrossSection::new(&body, sheet);
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
        let section = CrossSection::new(&Body::default(), &sheet);
        assert_eq!(section, CrossSection::default());
        assert_eq!((section.skin().len(), section.quads().count()), (0, 0));
    }
}
