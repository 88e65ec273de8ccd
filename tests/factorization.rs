//! Newton's method of layered tissue with factorised matrices, as the study in `studies/cholesky` has it.

use implant_preview::experiment::work_precision::Case;
use implant_preview::solve::{
    Factorization, LowerTriangle, Method, Options, Progress, Solver, Verdict,
};

/// Cholesky factorisation within the profile of the matrix: each row from its first entry on.
#[derive(Default)]
struct Profile {
    firsts: Vec<usize>,
    rows: Vec<Vec<f64>>,
}

impl Factorization for Profile {
    fn factorize(&mut self, matrix: &LowerTriangle) -> bool {
        let n = matrix.len();
        self.firsts = (0..n).collect();
        let entries =
            || (0..n).flat_map(|c| (matrix.starts[c]..matrix.starts[c + 1]).map(move |at| (c, at)));
        for (column, at) in entries() {
            let first = &mut self.firsts[matrix.rows[at]];
            *first = column.min(*first);
        }
        self.rows = (0..n).map(|row| vec![0.0; row + 1 - self.firsts[row]]).collect();
        for (column, at) in entries() {
            let row = matrix.rows[at];
            self.rows[row][column - self.firsts[row]] = matrix.values[at];
        }
        for i in 0..n {
            let (before, after) = self.rows.split_at_mut(i);
            let (row, first) = (&mut after[0], self.firsts[i]);
            for j in first..=i {
                let other: &[f64] = if j < i { &before[j] } else { &[] };
                let of_other = if j < i { self.firsts[j] } else { first };
                let from = first.max(of_other);
                let sum: f64 = (from..j)
                    .map(|k| {
                        row[k - first] * if j < i { other[k - of_other] } else { row[k - first] }
                    })
                    .sum();
                let value = row[j - first] - sum;
                if j < i {
                    row[j - first] = value / other[j - of_other];
                } else if value > 0.0 {
                    row[j - first] = value.sqrt();
                } else {
                    return false;
                }
            }
        }
        true
    }

    fn solve(&self, vector: &mut [f64]) {
        for i in 0..vector.len() {
            let (row, first) = (&self.rows[i], self.firsts[i]);
            let sum: f64 = (first..i).map(|k| row[k - first] * vector[k]).sum();
            vector[i] = (vector[i] - sum) / row[i - first];
        }
        for i in (0..vector.len()).rev() {
            let (row, first) = (&self.rows[i], self.firsts[i]);
            vector[i] /= row[i - first];
            for k in first..i {
                vector[k] -= row[k - first] * vector[i];
            }
        }
    }
}

/// Conjugate gradients and factorisations, of a quarter, of half and of the whole patch, end at one shape.
#[test]
fn factorised_matrices_lead_to_the_shape_of_conjugate_gradients() {
    for center_mm in [[0.0; 2], [4.0, 0.0], [4.0, 3.0]] {
        let mut scene = Case::LayeredLinear.scene(17, 1e-7);
        scene.implant.center_mm = center_mm;
        let problem = scene.problem().expect("a valid scene");
        let options = Options { method: Method::Newton, ..Options::default() };
        let factorized =
            Solver::with_factorization(problem.clone(), options, || Box::new(Profile::default()));
        let shapes = [Solver::with_options(problem, options), factorized].map(|mut solver| {
            while solver.advance(&mut || false) == Progress::Working {}
            assert_eq!(solver.verdict(), Verdict::Converged, "{center_mm:?}");
            let nodes = solver.positions().iter().chain(solver.outer().iter().flatten());
            nodes.copied().collect::<Vec<_>>()
        });
        let [a, b] = &shapes;
        let distance = a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(distance < 1e-5, "{center_mm:?}: {distance} mm");
    }
}
