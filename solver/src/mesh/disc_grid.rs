//! The sheet: a square grid of nodes on the patch's disc, its border fitted to the circle.
//!
//! Nodes with |r − a| < h/2 move radially onto the circle in the reference shape and are clamped;
//! nodes farther out do not belong to the sheet. Where one corner of a cell is outside, the
//! opposite triangle has full weight. This border is second-order accurate; a staircase
//! (fixing every node outside) is first-order.

use glam::DVec2;

/// The kind of a grid node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// Inside of the patch: unknown position.
    Free,
    /// On the border of the patch: clamped at its rest position.
    Clamped,
    /// Not part of the sheet.
    Outside,
}

/// The part of a grid cell that belongs to the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// All four corners: four triangles of half weight, two for each diagonal.
    Whole,
    /// One corner is outside: the triangle opposite to it, at full weight. The number is the
    /// corner's index in [`Sheet::corners`].
    WithoutCorner(u8),
    /// Not part of the sheet.
    Outside,
}

/// The triangles of a whole cell, as indices of [`Sheet::corners`]; the k-th triangle has no corner k.
/// Each triangle is counter-clockwise and starts at its right angle.
pub const CELL_TRIANGLES: [[usize; 3]; 4] = [[2, 3, 1], [3, 0, 2], [0, 1, 3], [1, 2, 0]];

/// A square grid over the patch's disc. Flat arrays in row-major order, row j along y.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    nodes_per_side: usize,
    radius_mm: f64,
    /// Rest positions \[mm\], shape (nodes_per_side², ).
    rest: Vec<DVec2>,
    /// Shape (nodes_per_side², ).
    kinds: Vec<NodeKind>,
    /// Shape ((nodes_per_side − 1)², ).
    cells: Vec<CellKind>,
    /// For each row the half-open range of columns that belong to the sheet.
    row_spans: Vec<(usize, usize)>,
    /// For each row the half-open range of columns with free nodes.
    free_spans: Vec<(usize, usize)>,
}

/// Rounds to the nearest m·2ᵏ + 1 with 8 ≤ m ≤ 15: halving the cells of each grid ends at 8 to 15 cells a side.
#[must_use]
pub fn rounded_nodes_per_side(asked: usize) -> usize {
    let cells = asked.max(9) - 1;
    let halvings = cells.ilog2() - 3;
    let unit = 1usize << halvings;
    // Up to m = 16, which is m = 8 of the next size.
    (cells + unit / 2) / unit * unit + 1
}

/// Nodes a side of the next coarser grid, with half the cells a side; `None` below 17 nodes and where half the number
/// of cells is odd.
pub(crate) fn coarser_nodes_per_side(nodes_per_side: usize) -> Option<usize> {
    let cells = nodes_per_side - 1;
    (cells >= 16 && cells.is_multiple_of(4)).then_some(cells / 2 + 1)
}

/// Half-open range of columns of row j within `margin` half spacings beyond the circle, the circle's own nodes excluded;
/// by integers, without rounding.
fn span(nodes_per_side: usize, row: usize, margin: i64) -> (usize, usize) {
    let (half, n) = ((nodes_per_side / 2) as i64, nodes_per_side);
    let (across, reach) = (row as i64 - half, 2 * half + margin);
    // No node has the distance half ± ½ itself: its square is no integer.
    let square = reach * reach - 4 * across * across;
    if square < 0 {
        return (n / 2, n / 2);
    }
    let most = (square / 4).isqrt().min(half) as usize;
    (n / 2 - most, n / 2 + most + 1)
}

impl Sheet {
    /// A sheet on the disc of the given radius \[mm\] with an odd number of nodes a side, at least 5.
    ///
    /// # Panics
    /// If `nodes_per_side` is even or below 5.
    #[must_use]
    pub fn new(nodes_per_side: usize, radius_mm: f64) -> Self {
        assert!(nodes_per_side >= 5 && nodes_per_side % 2 == 1, "an odd grid of 5 or more nodes");
        let n = nodes_per_side;
        let half = (n / 2) as f64;
        let spacing = radius_mm / half;
        let (row_spans, free_spans) =
            (0..n).map(|j| [1, -1].map(|margin| span(n, j, margin))).map(|[a, b]| (a, b)).unzip();
        let mut sheet = Self {
            nodes_per_side,
            radius_mm,
            rest: Vec::with_capacity(n * n),
            kinds: vec![NodeKind::Outside; n * n],
            cells: vec![CellKind::Outside; (n - 1) * (n - 1)],
            row_spans,
            free_spans,
        };
        for j in 0..n {
            // Relative to the centre: the grid is symmetric to the last bit.
            let at = |i: usize| DVec2::new(i as f64 - half, j as f64 - half) * spacing;
            sheet.rest.extend((0..n).map(at));
            let ((from, to), (first, last)) = (sheet.row_spans[j], sheet.free_spans[j]);
            let row = j * n..(j + 1) * n;
            let (rest, kinds) = (&mut sheet.rest[row.clone()], &mut sheet.kinds[row]);
            kinds[first..last].fill(NodeKind::Free);
            for i in (from..first.min(to)).chain(last.max(from)..to) {
                kinds[i] = NodeKind::Clamped;
                rest[i] *= radius_mm / rest[i].length();
            }
        }
        for j in 0..n - 1 {
            let ((a, b), (c, d)) = (sheet.row_spans[j], sheet.row_spans[j + 1]);
            let (from, to) = sheet.cell_span(j);
            let whole = a.max(c)..b.min(d).saturating_sub(1);
            for i in from..to {
                sheet.cells[j * (n - 1) + i] =
                    if whole.contains(&i) { CellKind::Whole } else { sheet.classify(i, j) };
            }
        }
        sheet
    }

    fn classify(&self, i: usize, j: usize) -> CellKind {
        let corners = self.corners(i, j);
        let outside = |k: &usize| self.kinds[*k] == NodeKind::Outside;
        match corners.iter().filter(|k| outside(k)).count() {
            0 => CellKind::Whole,
            1 => {
                let corner = corners.iter().position(outside).unwrap_or(0);
                // Three nodes on the circle may enclose a sliver outside of the sheet's polygon.
                if self.rest_area(CELL_TRIANGLES[corner].map(|c| corners[c])) > 0.0 {
                    CellKind::WithoutCorner(corner as u8)
                } else {
                    CellKind::Outside
                }
            }
            _ => CellKind::Outside,
        }
    }

    /// Nodes a side of the square grid.
    #[must_use]
    pub fn nodes_per_side(&self) -> usize {
        self.nodes_per_side
    }

    /// Number of grid nodes, outside nodes included: the length of every nodal array.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Always false: a sheet has nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Radius of the grid's disc \[mm\].
    #[must_use]
    pub fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Grid spacing h \[mm\].
    #[must_use]
    pub fn spacing_mm(&self) -> f64 {
        2.0 * self.radius_mm / (self.nodes_per_side - 1) as f64
    }

    /// Rest positions \[mm\], row-major.
    #[must_use]
    pub fn rest(&self) -> &[DVec2] {
        &self.rest
    }

    /// The kind of each node, row-major.
    #[must_use]
    pub fn kinds(&self) -> &[NodeKind] {
        &self.kinds
    }

    /// Number of free nodes.
    #[must_use]
    pub fn free_nodes(&self) -> usize {
        self.kinds.iter().filter(|k| **k == NodeKind::Free).count()
    }

    /// For each row the half-open range of columns that belong to the sheet.
    #[must_use]
    pub fn row_spans(&self) -> &[(usize, usize)] {
        &self.row_spans
    }

    /// For each row the half-open range of columns with free nodes; empty ranges are in the middle of the row.
    pub(crate) fn free_spans(&self) -> &[(usize, usize)] {
        &self.free_spans
    }

    /// The four corner nodes of cell (i, j), counter-clockwise from the least x and y.
    #[must_use]
    pub fn corners(&self, i: usize, j: usize) -> [usize; 4] {
        let low = j * self.nodes_per_side + i;
        let high = low + self.nodes_per_side;
        [low, low + 1, high + 1, high]
    }

    /// The part of cell (i, j) that belongs to the sheet.
    #[must_use]
    pub fn cell(&self, i: usize, j: usize) -> CellKind {
        self.cells[j * (self.nodes_per_side - 1) + i]
    }

    /// Half-open range of the cells of row j that can belong to the sheet.
    pub(crate) fn cell_span(&self, j: usize) -> (usize, usize) {
        let (below, above) = (self.row_spans[j], self.row_spans[j + 1]);
        (below.0.min(above.0), below.1.max(above.1).saturating_sub(1))
    }

    /// The triangles of cell (i, j), as indices of [`Self::corners`], and their weight.
    pub(crate) fn local_triangles(&self, i: usize, j: usize) -> (&'static [[usize; 3]], f64) {
        const ALL: &[[usize; 3]] = &CELL_TRIANGLES;
        match self.cell(i, j) {
            CellKind::Whole => (ALL, 0.5),
            CellKind::WithoutCorner(k) => (&ALL[usize::from(k)..=usize::from(k)], 1.0),
            CellKind::Outside => (&[], 0.0),
        }
    }

    /// The triangles of cell (i, j) with their weights: the sum of weight times rest area is the area of the sheet.
    pub fn cell_triangles(&self, i: usize, j: usize) -> impl Iterator<Item = ([usize; 3], f64)> {
        let corners = self.corners(i, j);
        let (triangles, weight) = self.local_triangles(i, j);
        triangles.iter().map(move |local| (local.map(|c| corners[c]), weight))
    }

    /// Every triangle of the sheet with its weight.
    pub fn triangles(&self) -> impl Iterator<Item = ([usize; 3], f64)> + '_ {
        let cells = self.nodes_per_side - 1;
        (0..cells * cells).flat_map(move |c| self.cell_triangles(c % cells, c / cells))
    }

    /// Rest area of a triangle of nodes \[mm²\].
    #[must_use]
    pub fn rest_area(&self, [a, b, c]: [usize; 3]) -> f64 {
        0.5 * (self.rest[b] - self.rest[a]).perp_dot(self.rest[c] - self.rest[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_weighted_triangles_tile_the_disc_to_second_order() {
        let defect = |n| {
            let sheet = Sheet::new(n, 1.0);
            PI - sheet.triangles().map(|(t, w)| w * sheet.rest_area(t)).sum::<f64>()
        };
        let (coarse, fine) = (defect(33), defect(129));
        assert!(coarse > 0.0 && coarse < 0.03, "{coarse}");
        assert!(fine > 0.0 && fine < coarse / 8.0, "{fine} from {coarse}");
    }

    #[test]
    fn no_triangle_is_inverted_or_degenerate() {
        for n in [9, 11, 13, 17, 21, 25, 29, 33, 65, 129, 193] {
            let sheet = Sheet::new(n, 10.0);
            let whole = 0.5 * sheet.spacing_mm().powi(2);
            for (t, _) in sheet.triangles() {
                let moves = t.iter().any(|&k| sheet.kinds()[k] == NodeKind::Free);
                let area = sheet.rest_area(t);
                assert!(area > 0.0 && (!moves || area > 0.05 * whole), "{n}: {area} of {whole}");
            }
        }
    }

    #[test]
    fn free_nodes_have_all_their_neighbours_and_clamped_nodes_lie_on_the_circle() {
        let sheet = Sheet::new(65, 70.0);
        let n = 65;
        for k in 0..sheet.len() {
            match sheet.kinds()[k] {
                NodeKind::Free => {
                    for neighbour in [k - 1, k + 1, k - n, k + n] {
                        assert_ne!(sheet.kinds()[neighbour], NodeKind::Outside);
                    }
                }
                NodeKind::Clamped => assert!((sheet.rest()[k].length() - 70.0).abs() < 1e-12),
                NodeKind::Outside => {}
            }
        }
    }

    #[test]
    fn rounded_nodes_per_side_halve_exactly_on_every_grid() {
        for (asked, given) in
            [(17, 17), (33, 33), (129, 129), (130, 129), (200, 193), (950, 961), (1025, 1025)]
        {
            assert_eq!(rounded_nodes_per_side(asked), given);
        }
        for asked in 17..=1025 {
            let mut cells = rounded_nodes_per_side(asked) - 1;
            while cells > 15 {
                assert_eq!(cells % 2, 0, "{asked}");
                cells /= 2;
            }
        }
    }
}
