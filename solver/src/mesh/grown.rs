//! The growth of a membrane: by what its triangles without stress have become larger.

use super::Sheet;
use glam::{DMat2, DVec2};
use std::sync::Arc;

/// Numbers of the symmetric tensor Γ of a triangle: xx, xy, yy \[-\].
pub(crate) type Tensor = [f32; 3];

const IDENTITY: Tensor = [1.0, 0.0, 1.0];

/// A symmetric stretch Γ a triangle in the plane of the grid, from the triangle at rest to the triangle that has grown. The rest metric
/// is that of the grown triangle, released by the natural stretch.
#[derive(Clone, Debug)]
pub struct Grown {
    cells_per_side: usize,
    /// Of the triangles of each cell by the corner at their right angle, shape (cells_per_side², 4).
    tensors: Arc<[[Tensor; 4]]>,
}

impl PartialEq for Grown {
    fn eq(&self, other: &Self) -> bool {
        self.is_same(other) || self.tensors == other.tensors
    }
}

impl Grown {
    /// Triangles that have not grown.
    pub(crate) fn none(cells_per_side: usize) -> Self {
        let cells = cells_per_side * cells_per_side;
        Self { cells_per_side, tensors: std::iter::repeat_n([IDENTITY; 4], cells).collect() }
    }

    /// Sets the tensor of each triangle of a sheet of this size.
    pub(crate) fn set(&mut self, sheet: &Sheet, of: impl Fn([usize; 3]) -> Tensor) {
        let cells_per_side = self.cells_per_side;
        let mut tensors = self.tensors.to_vec();
        for j in 0..cells_per_side {
            let (from, to) = sheet.cell_span(j);
            for (nodes, _) in (from..to).flat_map(|i| sheet.cell_triangles(i, j)) {
                let (cell, corner) = Self::place(cells_per_side, nodes);
                tensors[cell][corner] = of(nodes);
            }
        }
        self.tensors = tensors.into();
    }

    /// The numbers of all triangles, xx, xy, yy of one after the other.
    pub(crate) fn numbers(&self) -> Vec<f32> {
        self.tensors.iter().flatten().flatten().copied().collect()
    }

    /// Of [`Self::numbers`]; `None` for another number of triangles.
    pub(crate) fn of_numbers(cells_per_side: usize, numbers: &[f32]) -> Option<Self> {
        let (tensors, rest) = numbers.as_chunks::<3>();
        let (cells, left) = tensors.as_chunks::<4>();
        let is_whole = rest.is_empty() && left.is_empty();
        (is_whole && cells.len() == cells_per_side * cells_per_side)
            .then(|| Self { cells_per_side, tensors: cells.into() })
    }

    /// Greatest difference of a number from that of the field before, or from no growth \[-\].
    pub(crate) fn greatest_difference(&self, before: Option<&Self>) -> f64 {
        let mut greatest = 0.0_f32;
        for (k, cell) in self.tensors.iter().enumerate() {
            let other = before.map_or(&[IDENTITY; 4], |before| &before.tensors[k]);
            for (a, b) in cell.iter().flatten().zip(other.iter().flatten()) {
                greatest = greatest.max((a - b).abs());
            }
        }
        f64::from(greatest)
    }

    /// Are both the same data?
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.tensors, &other.tensors)
    }

    /// Cell and corner at the right angle of a triangle of [`Sheet::cell_triangles`].
    pub(crate) fn place(cells_per_side: usize, [a, b, c]: [usize; 3]) -> (usize, usize) {
        let n = cells_per_side + 1;
        let low = a.min(b).min(c).min(b + c - a);
        let corner = match a - low {
            0 => 0,
            1 => 1,
            above if above == n => 3,
            _ => 2,
        };
        (low / n * cells_per_side + low % n, corner)
    }

    /// The numbers of a triangle of nodes.
    pub(crate) fn tensor(&self, nodes: [usize; 3]) -> Tensor {
        let (cell, corner) = Self::place(self.cells_per_side, nodes);
        self.tensors[cell][corner]
    }

    /// The same vector of the triangle that has grown, of a vector of the triangle at rest.
    pub(crate) fn grown(&self, nodes: [usize; 3], vector: DVec2) -> DVec2 {
        let [xx, xy, yy] = self.tensor(nodes).map(f64::from);
        DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy)) * vector
    }

    /// On the grid with this number of nodes a side, which divides the cells: means over the fine triangles.
    pub(crate) fn restricted(&self, nodes_per_side: usize) -> Self {
        let mut all = self.clone();
        while all.cells_per_side + 1 > nodes_per_side {
            all = all.coarser();
        }
        all
    }

    fn coarser(&self) -> Self {
        let (fine, n) = (self.cells_per_side, self.cells_per_side / 2);
        let cell = |k: usize| {
            let low = 2 * (k / n) * fine + 2 * (k % n);
            let of_corner = [low, low + 1, low + fine + 1, low + fine].map(|k| &self.tensors[k]);
            // A triangle has the whole cell at its right angle, and half of the two next to it.
            [0, 1, 2, 3].map(|corner| {
                let beside = [(corner + 1) % 4, (corner + 3) % 4];
                [0, 1, 2].map(|p| {
                    let whole: f32 = of_corner[corner].iter().map(|tensor| tensor[p]).sum();
                    let halves: f32 = beside.iter().map(|&k| of_corner[k][corner][p]).sum();
                    0.125 * whole + 0.25 * halves
                })
            })
        };
        Self { cells_per_side: n, tensors: (0..n * n).map(cell).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Sheet;

    /// A field of the places of the triangles' middles.
    fn linear(sheet: &Sheet) -> Grown {
        let n = sheet.nodes_per_side();
        let mut grown = Grown::none(n - 1);
        grown.set(sheet, |nodes| {
            let place = |k: usize| DVec2::new((k % n) as f64, (k / n) as f64);
            let middle = nodes.map(place).iter().sum::<DVec2>() / (3 * (n - 1)) as f64;
            [middle.x, middle.y, middle.x - middle.y].map(|value| value as f32)
        });
        grown
    }

    #[test]
    fn each_triangle_has_a_place_of_its_own_and_coarse_ones_the_mean_of_theirs() {
        let (fine, coarse) = (Sheet::new(17, 60.0), Sheet::new(9, 60.0));
        let (field, expected) = (linear(&fine).restricted(9), linear(&coarse));
        let mut found = std::collections::BTreeSet::new();
        // Within, where the fine cells are whole.
        for (i, j) in (2..6).flat_map(|j| (2..6).map(move |i| (i, j))) {
            for (nodes, _) in coarse.cell_triangles(i, j) {
                found.insert(Grown::place(8, nodes));
                let [one, other] = [&field, &expected].map(|of| of.tensor(nodes));
                assert!((0..3).all(|p| (one[p] - other[p]).abs() < 1e-6), "{one:?} {other:?}");
            }
        }
        assert_eq!(found.len(), 4 * 16);
        let again = Grown::of_numbers(8, &expected.numbers()).unwrap();
        assert_eq!(again, expected);
        assert_eq!(Grown::of_numbers(7, &expected.numbers()), None);
    }
}
