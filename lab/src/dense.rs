//! Linear algebra of small dense matrices, for the 4 × 4 sample (50 unknowns).

/// A square matrix, row by row.
#[derive(Clone, Debug)]
pub(super) struct Matrix {
    n: usize,
    rows: Vec<f64>,
}

impl Matrix {
    pub(super) fn zeros(n: usize) -> Self {
        Self { n, rows: vec![0.0; n * n] }
    }

    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        self.rows[row * self.n + column]
    }

    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row * self.n + column] += value;
    }

    /// Adds `factor` · v vᵀ.
    pub(super) fn add_outer(&mut self, factor: f64, v: &[f64]) {
        for (row, a) in v.iter().enumerate() {
            for (column, b) in v.iter().enumerate() {
                self.add(row, column, factor * a * b);
            }
        }
    }

    /// Adds `value` to every diagonal entry.
    pub(super) fn add_diagonal(&mut self, value: f64) {
        for k in 0..self.n {
            self.add(k, k, value);
        }
    }

    /// Gershgorin's bound on the greatest eigenvalue: the greatest row sum of magnitudes.
    pub(super) fn greatest_row_sum(&self) -> f64 {
        self.rows
            .chunks_exact(self.n)
            .map(|row| row.iter().map(|a| a.abs()).sum())
            .fold(0.0, f64::max)
    }

    /// Returns `true` if the symmetric matrix has a Cholesky factor, that is, if it is positive definite.
    pub(super) fn has_cholesky_factor(mut self) -> bool {
        let n = self.n;
        for j in 0..n {
            let (above, row_j) = self.rows.split_at_mut(j * n);
            let row_j = &mut row_j[..n];
            for i in 0..j {
                let row_i = &above[i * n..(i + 1) * n];
                let dot: f64 = (0..i).map(|k| row_i[k] * row_j[k]).sum();
                row_j[i] = (row_j[i] - dot) / row_i[i];
            }
            let pivot = row_j[j] - (0..j).map(|k| row_j[k] * row_j[k]).sum::<f64>();
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            row_j[j] = pivot.sqrt();
        }
        true
    }

    /// Smallest eigenvalue of the symmetric matrix, to rounding: tridiagonalisation by Householder
    /// reflections, then bisection with Sturm's count of negative pivots (G. H. Golub and C. F. Van Loan,
    /// *Matrix Computations*, 4th ed., 2013, sections 8.3.1 and 8.4.1).
    pub(super) fn least_eigenvalue(mut self) -> f64 {
        let bound = self.greatest_row_sum();
        let n = self.n;
        let (mut diagonal, mut off_diagonal) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..n {
            diagonal[k] = self.get(k, k);
            if k + 1 == n {
                break;
            }
            // The reflection eliminates row k beyond the first entry right of the diagonal.
            let mut v: Vec<f64> = (k + 1..n).map(|column| self.get(k, column)).collect();
            let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            off_diagonal[k] = length;
            v[0] += length.copysign(v[0]);
            let squared: f64 = v.iter().map(|v| v * v).sum();
            if squared <= 0.0 {
                continue;
            }
            let factor = 2.0 / squared;
            let mut image: Vec<f64> = (k + 1..n)
                .map(|row| {
                    let row = &self.rows[row * n + k + 1..(row + 1) * n];
                    factor * row.iter().zip(&v).map(|(a, v)| a * v).sum::<f64>()
                })
                .collect();
            let overlap: f64 = image.iter().zip(&v).map(|(p, v)| p * v).sum();
            for (p, v) in image.iter_mut().zip(&v) {
                *p -= 0.5 * factor * overlap * v;
            }
            for (i, (v_i, p_i)) in v.iter().zip(&image).enumerate() {
                let start = (k + 1 + i) * n + k + 1;
                for ((a, v_j), p_j) in
                    self.rows[start..start + v.len()].iter_mut().zip(&v).zip(&image)
                {
                    *a -= v_i * p_j + p_i * v_j;
                }
            }
        }
        let has_eigenvalue_below = |shift: f64| {
            let mut pivot = diagonal[0] - shift;
            for k in 1..n {
                if pivot < 0.0 {
                    return true;
                }
                pivot = diagonal[k]
                    - shift
                    - off_diagonal[k - 1] * off_diagonal[k - 1] / pivot.max(1e-300);
            }
            pivot < 0.0
        };
        let (mut below, mut above) = (-bound, bound);
        while above - below > 1e-14 * bound {
            let middle = 0.5 * (below + above);
            if has_eigenvalue_below(middle) { above = middle } else { below = middle }
        }
        0.5 * (below + above)
    }

    /// Solves A x = b by Gaussian elimination with row pivoting; `None` if A is singular.
    pub(super) fn solve(mut self, mut b: Vec<f64>) -> Option<Vec<f64>> {
        let n = self.n;
        for k in 0..n {
            let pivot =
                (k..n).max_by(|&i, &j| self.get(i, k).abs().total_cmp(&self.get(j, k).abs()))?;
            if self.get(pivot, k).abs() <= 0.0 {
                return None;
            }
            if pivot != k {
                for column in 0..n {
                    self.rows.swap(pivot * n + column, k * n + column);
                }
                b.swap(pivot, k);
            }
            for i in k + 1..n {
                let factor = self.get(i, k) / self.get(k, k);
                if factor != 0.0 {
                    for column in k..n {
                        self.rows[i * n + column] -= factor * self.rows[k * n + column];
                    }
                    b[i] -= factor * b[k];
                }
            }
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|column| self.get(k, column) * b[column]).sum();
            b[k] = (b[k] - known) / self.get(k, k);
        }
        b.iter().all(|x| x.is_finite()).then_some(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(shift: f64) -> Matrix {
        // The second difference on 6 points: eigenvalues 2 − 2 cos(kπ/7).
        let mut a = Matrix::zeros(6);
        for k in 0..6 {
            a.add(k, k, 2.0 + shift);
            if k > 0 {
                a.add(k, k - 1, -1.0);
                a.add(k - 1, k, -1.0);
            }
        }
        a
    }

    #[test]
    fn the_solution_satisfies_the_equations() {
        let a = example(-1.3); // indefinite
        let b: Vec<f64> = (0..6).map(|k| f64::from(k * k) - 4.0).collect();
        let x = a.clone().solve(b.clone()).unwrap();
        for row in 0..6 {
            let product: f64 = (0..6).map(|column| a.get(row, column) * x[column]).sum();
            assert!((product - b[row]).abs() < 1e-12);
        }
        assert!(Matrix::zeros(3).solve(vec![1.0; 3]).is_none());
    }

    #[test]
    fn least_eigenvalue_is_that_of_known_matrices() {
        let known = 2.0 - 2.0 * (std::f64::consts::PI / 7.0).cos();
        for shift in [0.0, -1.0, 3.0] {
            assert!((example(shift).least_eigenvalue() - known - shift).abs() < 1e-13);
        }
        // A full matrix with known eigenvectors: a reflected diagonal matrix.
        let values = [4.0, -0.25, 7.0, 1.5, 0.0, 9.0];
        let v: Vec<f64> = (0..6).map(|k| 0.3 + (1.7 * f64::from(k)).sin()).collect();
        let squared: f64 = v.iter().map(|v| v * v).sum();
        let reflection =
            |i: usize, k: usize| f64::from(u8::from(i == k)) - 2.0 * v[i] * v[k] / squared;
        let mut full = Matrix::zeros(6);
        for row in 0..6 {
            for column in 0..6 {
                let sum = |k: usize| reflection(row, k) * values[k] * reflection(k, column);
                full.add(row, column, (0..6).map(sum).sum());
            }
        }
        assert!((full.least_eigenvalue() + 0.25).abs() < 1e-13);
        assert!(Matrix::zeros(3).least_eigenvalue().abs() < 1e-300);
    }

    #[test]
    fn a_shift_by_the_least_eigenvalue_separates_definite_from_indefinite() {
        let least = 2.0 - 2.0 * (std::f64::consts::PI / 7.0).cos();
        assert!(example(-least + 1e-9).has_cholesky_factor());
        assert!(!example(-least - 1e-9).has_cholesky_factor());
    }
}
