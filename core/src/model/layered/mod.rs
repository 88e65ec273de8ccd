//! Tissue as a body: the skin, a membrane, on layers of solid tissue; one node a layer of cells and one more in a
//! column.
//!
//! `law` (solid tissue, any law) | `curve_law` (of a tissue's curve) | `cell` (eight nodes) | `attachment` (beyond the pocket) | `lanes` (the body in four f32 lanes) |
//! `stiffness` (blocks of four cells) | `border` (cells on the patch's circle) | `exact` (the body in f64) | `tangent`
//! (second derivatives in f64).

pub(crate) mod attachment;
mod border;
mod cell;
pub mod curve_law;
pub mod exact;
pub(crate) mod lanes;
pub(crate) mod law;
mod stiffness;
pub(crate) mod tangent;

use super::columns::MAX_LAYERS;
use super::membrane::law::SheetLaw;
use crate::springs::Material;
use crate::springs::table::Table;
use curve_law::CurveLaw;

/// The greatest number of cells through the thickness.
pub(crate) const MAX_CELLS: usize = MAX_LAYERS - 1;

/// A layer of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// Index of the tissue in [`LayeredLaw::solids`].
    pub solid: usize,
    /// Height at rest \[mm\].
    pub height_mm: f64,
}

/// The laws of the layers, and the layers of cells.
#[derive(Clone, Debug)]
pub struct LayeredLaw {
    pub skin: SheetLaw,
    /// From the inner face outwards.
    pub solids: Vec<CurveLaw<f64, Table>>,
    /// From the inner face outwards.
    pub cells: Vec<Cells>,
}

impl LayeredLaw {
    /// The laws of materials from the skin inwards, with `cells_through` cells through the thickness or more: each solid has one
    /// at least. Does the skin wrinkle instead of being compressed?
    pub fn new(materials: &[Material], cells_through: usize, skin_wrinkles: bool) -> Self {
        let (skin, solids) = materials.split_at(materials.len().min(1));
        let heights: Vec<f64> = solids.iter().rev().map(|m| m.thickness_mm).collect();
        let cells = shared_out(&heights, cells_through)
            .into_iter()
            .enumerate()
            .flat_map(|(solid, count)| {
                let height_mm = heights[solid] / count as f64;
                std::iter::repeat_n(Cells { solid, height_mm }, count)
            })
            .collect();
        Self {
            skin: SheetLaw::of_skin(skin, skin_wrinkles),
            solids: solids.iter().rev().map(CurveLaw::new).collect(),
            cells,
        }
    }
}

impl LayeredLaw {
    /// Heights of the layers of nodes at rest \[mm\], the inner face's included.
    pub fn heights(&self) -> Vec<f64> {
        let mut heights = vec![0.0];
        for cells in &self.cells {
            heights.push(heights[heights.len() - 1] + cells.height_mm);
        }
        heights
    }

    /// The layer of nodes on the outer face of each solid, from the inner face outwards.
    pub(crate) fn outer_nodes(&self) -> Vec<usize> {
        let is_last =
            |k: usize| self.cells.get(k + 1).is_none_or(|next| next.solid != self.cells[k].solid);
        (0..self.cells.len()).filter(|&k| is_last(k)).map(|k| k + 1).collect()
    }
}

/// Number of cells of each solid: one, and the others where cells are highest.
fn shared_out(heights: &[f64], cells: usize) -> Vec<usize> {
    let mut counts = vec![1; heights.len()];
    for _ in heights.len()..cells.min(MAX_CELLS) {
        let highest = (0..heights.len()).max_by(|&a, &b| {
            let height = |k: usize| heights[k] / counts[k] as f64;
            height(a).total_cmp(&height(b))
        });
        if let Some(k) = highest {
            counts[k] += 1;
        }
    }
    counts
}

/// Thickness of solids up to which they have one cell, and above which those of `scene/2` have four \[mm\]: cells much flatter
/// than wide are very stiff.
const ONE_OR_FOUR_MM: (f64, f64) = (4.0, 15.0);

/// The most cells that [`balanced_cells`] chooses: eight instead of six move 15 mm of fat at 129 nodes per side by 0.02 % of the
/// base radius and cost a third more.
const MOST_BALANCED_CELLS: f64 = 6.0;

/// Cells through the thickness of the solids on a grid of a spacing \[mm\]: cells about as high as wide.
///
/// The error through the thickness is then about half of the error along the tissue, and below it up to a height of 1.4
/// spacings, whatever the patient (`solve/discretisation`).
pub(crate) fn balanced_cells(materials: &[Material], spacing_mm: f64) -> usize {
    let thickness = solid_thickness(materials);
    let least = if thickness > ONE_OR_FOUR_MM.0 { 2.0 } else { 1.0 };
    let cells = (thickness / spacing_mm).round().clamp(least, MOST_BALANCED_CELLS) as usize;
    cells.max(materials.len().saturating_sub(1)).min(MAX_CELLS)
}

/// Thickness of the solids, all layers below the first \[mm\].
fn solid_thickness(materials: &[Material]) -> f64 {
    materials.iter().skip(1).map(|m| m.thickness_mm).sum()
}

/// Cells through the thickness of the solids of `scene/2`, whatever the grid.
pub(crate) fn automatic_cells(materials: &[Material]) -> usize {
    let thickness = solid_thickness(materials);
    let (one, four) = ONE_OR_FOUR_MM;
    let cells = if thickness > four {
        4
    } else if thickness > one {
        2
    } else {
        1
    };
    cells.max(materials.len().saturating_sub(1)).min(MAX_CELLS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn automatic_cells_are_about_as_high_as_wide() {
        let tissue = |thickness_mm: f64| {
            let spec = crate::curve::CurveSpec::Linear { modulus_kpa: 5.0 };
            let curve = crate::curve::Curve::new(&spec).unwrap();
            let layer =
                |thickness_mm| Material { curve: curve.clone(), poisson_ratio: 0.49, thickness_mm };
            [layer(1.5), layer(thickness_mm)]
        };
        for (thickness_mm, spacing_mm, cells) in [
            (8.5, 4.06, 2),
            (8.5, 2.03, 4),
            (15.0, 3.9, 4),
            (15.0, 1.95, 6),
            (40.0, 4.0, 6),
            (4.5, 8.0, 2),
            (3.0, 8.0, 1),
        ] {
            let found = balanced_cells(&tissue(thickness_mm), spacing_mm);
            assert_eq!(found, cells, "{thickness_mm} mm on {spacing_mm} mm");
        }
        assert_eq!(balanced_cells(&tissue(3.0)[..1], 8.0), 1);
    }

    #[test]
    fn cells_are_shared_out_by_height() {
        assert_eq!(shared_out(&[10.0], 2), [2]);
        assert_eq!(shared_out(&[5.0, 10.0], 4), [1, 3]);
        assert_eq!(shared_out(&[1.0, 1.0, 30.0], 2), [1, 1, 1]);
        assert_eq!(shared_out(&[], 4), [0; 0]);
    }
}
