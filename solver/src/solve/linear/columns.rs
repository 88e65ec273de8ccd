//! Block-tridiagonal systems of columns of nodes in f64, by elimination from the skin inwards, so that contact
//! concerns the last block alone.

use glam::{DMat3, DVec3};

/// Least eigenvalue of an eliminated block, relative to the node's own block: a block that is not positive has no
/// minimum.
const LEAST_EIGENVALUE: f64 = 1e-3;

/// The columns of a grid; arrays of shape (layers, nodes).
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns {
    /// Blocks D of the nodes, then S⁻¹ with Sₖ = Dₖ − Eₖ Sₖ₊₁⁻¹ Eₖᵀ.
    pub(crate) diagonal: Vec<Vec<DMat3>>,
    /// Blocks E of a node and the node above, then G = Sₖ₊₁⁻¹ Eₖᵀ.
    pub(crate) above: Vec<Vec<DMat3>>,
}

impl Columns {
    pub(crate) fn new(nodes: usize, layers: usize) -> Self {
        let zeros = |layers: usize| vec![vec![DMat3::ZERO; nodes]; layers];
        Self { diagonal: zeros(layers), above: zeros(layers - 1) }
    }

    pub(crate) fn clear(&mut self) {
        self.diagonal.iter_mut().chain(&mut self.above).for_each(|blocks| blocks.fill(DMat3::ZERO));
    }

    /// Eliminates a column; returns the block of the inner face, the nodes above being free to follow, and its inverse.
    pub(crate) fn eliminate(&mut self, k: usize) -> [DMat3; 2] {
        let mut schur = self.diagonal[self.diagonal.len() - 1][k];
        for layer in (0..self.diagonal.len()).rev() {
            let own = self.diagonal[layer][k];
            let (block, inverse) = positive_inverse(schur, trace(&own));
            self.diagonal[layer][k] = inverse;
            if layer == 0 {
                return [block, inverse];
            }
            let e = self.above[layer - 1][k];
            let g = inverse * e.transpose();
            self.above[layer - 1][k] = g;
            schur = self.diagonal[layer - 1][k] - e * g;
        }
        [schur; 2]
    }

    /// Sets `z` to the solution for `r` at a column, `inner` being the inverse block of the inner face.
    #[inline]
    pub(crate) fn solve(&self, k: usize, inner: &DMat3, r: &[Vec<DVec3>], z: &mut [Vec<DVec3>]) {
        let top = r.len() - 1;
        // S⁻¹ of the reduced right-hand sides; E S⁻¹ r is Gᵀ r.
        let mut reduced = r[top][k];
        for layer in (1..=top).rev() {
            z[layer][k] = self.diagonal[layer][k] * reduced;
            reduced = r[layer - 1][k] - self.above[layer - 1][k].transpose() * reduced;
        }
        z[0][k] = *inner * reduced;
        for layer in 0..top {
            let step = self.above[layer][k] * z[layer][k];
            z[layer + 1][k] -= step;
        }
    }
}

fn trace(m: &DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}

/// A symmetric block, raised until it is positive, and its inverse; `scale` is the trace of a block of its size.
fn positive_inverse(block: DMat3, scale: f64) -> (DMat3, DMat3) {
    if !(scale > 0.0 && scale.is_finite() && block.is_finite()) {
        return (DMat3::ZERO, DMat3::ZERO);
    }
    let least = LEAST_EIGENVALUE * scale;
    let shifted = |shift: f64| block + DMat3::from_diagonal(DVec3::splat(shift));
    let mut raised = block;
    let mut shift = 0.0;
    // Is block − least·I positive?
    while !is_positive(&(raised - DMat3::from_diagonal(DVec3::splat(least)))) {
        shift = if shift > 0.0 { 2.0 * shift } else { least };
        raised = shifted(shift);
    }
    (raised, raised.inverse())
}

fn is_positive(m: &DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.x_axis.y * m.x_axis.y;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_solved_exactly() {
        let number = |k: usize| ((k * 7919 % 101) as f64 / 101.0) - 0.5;
        let block = |k: usize| {
            let column = |c: usize| DVec3::new(number(k + c), number(k + 3 * c), number(k + 5 * c));
            DMat3::from_cols(column(1), column(2), column(3))
        };
        let layers = 4;
        let mut columns = Columns::new(1, layers);
        for layer in 0..layers {
            let part = block(10 * layer);
            columns.diagonal[layer][0] =
                part * part.transpose() + DMat3::from_diagonal(DVec3::splat(2.0));
            if layer + 1 < layers {
                columns.above[layer][0] = block(7 * layer + 3);
            }
        }
        let before = columns.clone();
        let [_, inner] = columns.eliminate(0);
        let r: Vec<Vec<DVec3>> =
            (0..layers).map(|k| vec![DVec3::new(number(k), number(2 * k), 1.0)]).collect();
        let mut z = vec![vec![DVec3::ZERO]; layers];
        columns.solve(0, &inner, &r, &mut z);
        for layer in 0..layers {
            let mut sum = before.diagonal[layer][0] * z[layer][0];
            if layer + 1 < layers {
                sum += before.above[layer][0] * z[layer + 1][0];
            }
            if layer > 0 {
                sum += before.above[layer - 1][0].transpose() * z[layer - 1][0];
            }
            assert!((sum - r[layer][0]).length() < 1e-12);
        }
    }
}
