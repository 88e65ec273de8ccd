//! A symmetric 9-point stencil of 3×3 blocks on a square grid: the Hessian of a sheet.

use glam::{DMat3, DVec3};

/// Blocks H(k, k + offset) for the node itself and half of its neighbours; the other half are transposes.
/// Every array has shape (n², ), row-major.
#[derive(Clone, Debug)]
pub(crate) struct BlockStencil9 {
    pub(crate) n: usize,
    pub(crate) diagonal: Vec<DMat3>,
    /// Offsets in the order of [`OFFSETS`].
    pub(crate) upper: [Vec<DMat3>; 4],
}

/// (columns, rows) to the neighbours whose blocks are stored.
pub(crate) const OFFSETS: [(isize, isize); 4] = [(1, 0), (0, 1), (1, 1), (-1, 1)];

impl BlockStencil9 {
    pub(crate) fn new(n: usize) -> Self {
        let zeros = || vec![DMat3::ZERO; n * n];
        Self { n, diagonal: zeros(), upper: [zeros(), zeros(), zeros(), zeros()] }
    }

    pub(crate) fn clear(&mut self) {
        self.diagonal.fill(DMat3::ZERO);
        self.upper.iter_mut().for_each(|blocks| blocks.fill(DMat3::ZERO));
    }

    /// The offsets of [`OFFSETS`] as distances in the flat arrays.
    pub(crate) fn strides(n: usize) -> [usize; 4] {
        [1, n, n + 1, n - 1]
    }

    /// Σ over the eight neighbours j of H(k, j) v(j), for a node k inside the grid.
    #[inline]
    pub(crate) fn off_diagonal(&self, k: usize, v: &[DVec3]) -> DVec3 {
        let n = self.n;
        let [east, north, north_east, north_west] = &self.upper;
        let south_west = k - n - 1;
        east[k] * v[k + 1]
            + transposed(&east[k - 1], v[k - 1])
            + north[k] * v[k + n]
            + transposed(&north[k - n], v[k - n])
            + north_east[k] * v[k + n + 1]
            + transposed(&north_east[south_west], v[south_west])
            + north_west[k] * v[k + n - 1]
            + transposed(&north_west[k - n + 1], v[k - n + 1])
    }

    /// The row of H v at a node inside the grid.
    #[inline]
    pub(crate) fn row(&self, k: usize, v: &[DVec3]) -> DVec3 {
        self.diagonal[k] * v[k] + self.off_diagonal(k, v)
    }
}

#[inline]
fn transposed(m: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(m.x_axis.dot(v), m.y_axis.dot(v), m.z_axis.dot(v))
}

/// a ⊗ b.
#[inline]
pub(crate) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
