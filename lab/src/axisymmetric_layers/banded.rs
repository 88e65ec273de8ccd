//! Symmetric banded matrix with its LDLᵀ factorisation.
//!
//! Uses no other module. Used by `assembly`, `newton`.

/// Lower band of a symmetric matrix, row after row: the entry (i, j), i − w ≤ j ≤ i, is number j − i + w of row i.
#[derive(Clone, Debug)]
pub(super) struct Banded {
    size: usize,
    /// Half bandwidth w.
    width: usize,
    entries: Vec<f64>,
}

impl Banded {
    pub(super) fn zero(size: usize, width: usize) -> Self {
        Self { size, width, entries: vec![0.0; size * (width + 1)] }
    }

    pub(super) fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Adds to the entry (i, j); entries above the diagonal are left out.
    pub(super) fn add(&mut self, i: usize, j: usize, value: f64) {
        if j <= i {
            self.entries[i * (self.width + 1) + j + self.width - i] += value;
        }
    }

    pub(super) fn diagonal(&self, i: usize) -> f64 {
        self.entries[i * (self.width + 1) + self.width]
    }

    /// Replaces row and column i by those of the identity.
    pub(super) fn fix(&mut self, i: usize) {
        let w = self.width;
        self.entries[i * (w + 1)..i * (w + 1) + w].fill(0.0);
        self.entries[i * (w + 1) + w] = 1.0;
        for row in i + 1..(i + w + 1).min(self.size) {
            self.entries[row * (w + 1) + i + w - row] = 0.0;
        }
    }

    /// LDLᵀ of the matrix plus `shift` times the diagonal matrix `scale`, without pivoting; `None` unless positive
    /// definite.
    pub(super) fn factor(&self, shift: f64, scale: &[f64]) -> Option<Factor> {
        let w = self.width;
        let mut l = self.entries.clone();
        let mut pivots = vec![0.0; self.size];
        // The row in work times the pivots: L(i, k)·d(k).
        let mut scaled = vec![0.0; w];
        for i in 0..self.size {
            let (done, rest) = l.split_at_mut(i * (w + 1));
            let row = &mut rest[..=w];
            let first = i.saturating_sub(w);
            let mut pivot = row[w] + shift * scale[i];
            let original = pivot;
            for j in first..i {
                let from = first.max(j.saturating_sub(w));
                let other = &done[j * (w + 1)..(j + 1) * (w + 1)];
                let a = &scaled[from + w - i..j + w - i];
                let b = &other[from + w - j..w];
                let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                let value = row[j + w - i] - sum;
                scaled[j + w - i] = value;
                row[j + w - i] = value / pivots[j];
                pivot -= value * row[j + w - i];
            }
            if pivot.is_nan() || pivot <= 1e-13 * original.abs() {
                return None;
            }
            pivots[i] = pivot;
        }
        Some(Factor { width: w, l, pivots })
    }
}

/// LDLᵀ of a positive definite banded matrix.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    width: usize,
    l: Vec<f64>,
    pivots: Vec<f64>,
}

impl Factor {
    /// Solution of the linear system.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let (n, w) = (self.pivots.len(), self.width);
        let mut x = right.to_vec();
        for i in 0..n {
            let first = i.saturating_sub(w);
            let row = &self.l[i * (w + 1) + first + w - i..i * (w + 1) + w];
            let sum: f64 = row.iter().zip(&x[first..i]).map(|(l, x)| l * x).sum();
            x[i] -= sum;
        }
        for (x, pivot) in x.iter_mut().zip(&self.pivots) {
            *x /= pivot;
        }
        for i in (0..n).rev() {
            let first = i.saturating_sub(w);
            let value = x[i];
            let row = &self.l[i * (w + 1) + first + w - i..i * (w + 1) + w];
            for (l, x) in row.iter().zip(&mut x[first..i]) {
                *x -= l * value;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_satisfies_the_system_and_an_indefinite_matrix_is_refused() {
        let (n, w) = (40, 5);
        let entry = |i: usize, j: usize| {
            let (i, j) = (i.max(j), i.min(j));
            let value = ((7 * i + 3 * j) as f64).sin();
            if i == j { 8.0 + value } else { value }
        };
        let mut matrix = Banded::zero(n, w);
        for i in 0..n {
            for j in i.saturating_sub(w)..=i {
                matrix.add(i, j, entry(i, j));
            }
        }
        matrix.fix(17);
        let right: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let x = matrix.factor(0.0, &right).unwrap().solve(&right);
        for i in 0..n {
            let product: f64 = (i.saturating_sub(w)..(i + w + 1).min(n))
                .map(|j| match (i == 17, j == 17) {
                    (true, true) => x[j],
                    (false, false) => entry(i, j) * x[j],
                    _ => 0.0,
                })
                .sum();
            assert!((product - right[i]).abs() < 1e-13);
        }
        assert!(matrix.factor(-9.5, &vec![1.0; n]).is_none());
    }
}
