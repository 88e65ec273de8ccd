//! Values at scattered points of the plane as a smooth function: radial basis functions with a polynomial.
//!
//! The function through the values is Σ wₖ |x − xₖ|ᵖ + polynomial with an odd p, the polyharmonic spline (Duchon, Lect. Notes Math. 571,
//! 1977, 85–100): p = 5 with a cubic polynomial is four times continuously differentiable, p = 3 with a quadratic one twice. The difference
//! of both shows where the points are too far apart. The error of leaving a point out needs no further solution (Rippa, Adv. Comput.
//! Math. 11, 1999, 193–210).

/// What a function between points is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothness {
    /// Power of the distance, odd.
    pub(super) power: i32,
    /// Degree of the polynomial.
    pub(super) degree: i32,
}

/// The function of values, and the one that the function is compared with.
pub(super) const SMOOTH: Smoothness = Smoothness { power: 5, degree: 3 };
pub(super) const LESS_SMOOTH: Smoothness = Smoothness { power: 3, degree: 2 };

/// Least pivot \[greatest entry of the column\]: the points do not determine the polynomial.
const LEAST_PIVOT: f64 = 1e-12;

/// Functions through several values at the same points.
#[derive(Debug)]
pub(super) struct Surface {
    points: Vec<[f64; 2]>,
    power: i32,
    /// Exponents of the polynomial's terms.
    terms: Vec<[i32; 2]>,
    /// Number of functions.
    count: usize,
    /// Weights of points and terms, of all functions together.
    weights: Vec<f64>,
    /// Diagonal of the inverse for the points.
    diagonal: Vec<f64>,
}

impl Surface {
    /// The functions through values, point by point; `None` if the points do not determine them. `is_plane`: else all points
    /// lie on the x axis.
    pub(super) fn through(
        points: Vec<[f64; 2]>,
        values: &[f64],
        is_plane: bool,
        Smoothness { power, degree }: Smoothness,
    ) -> Option<Self> {
        let most = |a: i32| if is_plane { degree - a } else { 0 };
        let terms: Vec<[i32; 2]> =
            (0..=degree).flat_map(|a| (0..=most(a)).map(move |b| [a, b])).collect();
        let (n, size) = (points.len(), points.len() + terms.len());
        if n < terms.len() {
            return None;
        }
        let count = values.len() / n;
        let mut surface =
            Self { points, power, terms, count, weights: Vec::new(), diagonal: Vec::new() };
        let mut matrix = vec![0.0; size * size];
        let mut row = vec![0.0; size];
        for k in 0..n {
            surface.basis(surface.points[k], &mut row);
            matrix[k * size..(k + 1) * size].copy_from_slice(&row);
            for term in n..size {
                matrix[term * size + k] = row[term];
            }
        }
        let inverse = inverse(matrix, size)?;
        surface.diagonal = (0..n).map(|k| inverse[k * size + k]).collect();
        let mut weights = vec![0.0; size * count];
        for (row, weights) in inverse.chunks_exact(size).zip(weights.chunks_exact_mut(count)) {
            for (factor, values) in row.iter().zip(values.chunks_exact(count)) {
                weights.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
            }
        }
        surface.weights = weights;
        Some(surface)
    }

    /// The functions of the points and the terms at a place.
    fn basis(&self, at: [f64; 2], basis: &mut [f64]) {
        let (of_points, of_terms) = basis.split_at_mut(self.points.len());
        for (value, point) in of_points.iter_mut().zip(&self.points) {
            *value = (at[0] - point[0]).hypot(at[1] - point[1]).powi(self.power);
        }
        for (value, [a, b]) in of_terms.iter_mut().zip(&self.terms) {
            *value = at[0].powi(*a) * at[1].powi(*b);
        }
    }

    /// The functions' values at places, place by place.
    pub(super) fn at(&self, places: impl Iterator<Item = [f64; 2]>) -> Vec<f64> {
        let mut basis = vec![0.0; self.points.len() + self.terms.len()];
        let mut values = Vec::new();
        for place in places {
            self.basis(place, &mut basis);
            let first = values.len();
            values.resize(first + self.count, 0.0);
            for (factor, weights) in basis.iter().zip(self.weights.chunks_exact(self.count)) {
                let sums = values[first..].iter_mut().zip(weights);
                sums.for_each(|(sum, weight)| *sum += factor * weight);
            }
        }
        values
    }

    /// What the function of the other points misses a function's value by, for each point.
    pub(super) fn left_out(&self, function: usize) -> impl Iterator<Item = f64> {
        let weights = self.weights.iter().skip(function).step_by(self.count);
        weights.zip(&self.diagonal).map(|(weight, diagonal)| weight / diagonal)
    }
}

/// The inverse of a matrix, by Gauss and Jordan with exchanged rows; `None` of a singular one.
fn inverse(mut matrix: Vec<f64>, size: usize) -> Option<Vec<f64>> {
    let mut inverse = vec![0.0; size * size];
    (0..size).for_each(|k| inverse[k * size + k] = 1.0);
    let greatest = matrix.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    for k in 0..size {
        let pivot = (k..size)
            .max_by(|a, b| matrix[a * size + k].abs().total_cmp(&matrix[b * size + k].abs()))?;
        let value = matrix[pivot * size + k];
        if value.abs() <= LEAST_PIVOT * greatest {
            return None;
        }
        for of in [&mut matrix, &mut inverse] {
            for column in 0..size {
                of.swap(k * size + column, pivot * size + column);
                of[k * size + column] /= value;
            }
        }
        let rows = [&matrix, &inverse].map(|of| of[k * size..(k + 1) * size].to_vec());
        for other in (0..size).filter(|other| *other != k) {
            let factor = matrix[other * size + k];
            if factor == 0.0 {
                continue;
            }
            for (of, row) in [&mut matrix, &mut inverse].into_iter().zip(&rows) {
                let values = of[other * size..(other + 1) * size].iter_mut().zip(row);
                values.for_each(|(value, own)| *value -= factor * own);
            }
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(count: usize) -> Vec<[f64; 2]> {
        let at = |k: usize| 2.0 * k as f64 / (count - 1) as f64 - 1.0;
        (0..count * count).map(|k| [at(k % count), at(k / count)]).collect()
    }

    #[test]
    fn polynomials_of_the_degree_are_exact_and_the_points_keep_their_values() {
        let cubic = |[x, y]: [f64; 2]| 1.0 - 2.0 * x + x * y + 0.5 * x * y * y - y * y * y;
        let other = |[x, y]: [f64; 2]| (3.0 * x).sin() * (2.0 * y).exp();
        let points = grid(5);
        let values: Vec<f64> = points.iter().flat_map(|at| [cubic(*at), other(*at)]).collect();
        let surface = Surface::through(points.clone(), &values, true, SMOOTH).unwrap();
        for (found, value) in surface.at(points.into_iter()).iter().zip(&values) {
            assert!((found - value).abs() < 1e-9, "{found} {value}");
        }
        for at in [[0.1, -0.33], [0.91, 0.77]] {
            assert!((surface.at(std::iter::once(at))[0] - cubic(at)).abs() < 1e-9);
        }
    }

    #[test]
    fn half_the_distance_between_points_has_a_small_part_of_the_error() {
        let of = |[x, y]: [f64; 2]| (1.5 * x + 0.4).sin() * (0.8 * y).exp();
        let error = |count: usize| {
            let points = grid(count);
            let values: Vec<f64> = points.iter().map(|at| of(*at)).collect();
            let surface = Surface::through(points, &values, true, SMOOTH).unwrap();
            let places = grid(23);
            let found = surface.at(places.iter().copied());
            found.iter().zip(places).map(|(found, at)| (found - of(at)).abs()).fold(0.0, f64::max)
        };
        let [coarse, fine] = [5, 9].map(error);
        assert!(coarse < 0.03 && fine < coarse / 6.0, "{coarse} {fine}");
    }

    #[test]
    fn a_point_left_out_is_missed_by_what_the_others_give() {
        let of = |[x, y]: [f64; 2]| (2.0 * x).sin() + x * (3.0 * y).cos();
        let points = grid(5);
        let values: Vec<f64> = points.iter().map(|at| of(*at)).collect();
        let surface = Surface::through(points.clone(), &values, true, SMOOTH).unwrap();
        for (k, missed) in surface.left_out(0).enumerate() {
            let (mut others, mut known) = (points.clone(), values.clone());
            let (at, value) = (others.remove(k), known.remove(k));
            let without = Surface::through(others, &known, true, SMOOTH).unwrap();
            let found = value - without.at(std::iter::once(at))[0];
            assert!((found - missed).abs() < 1e-8, "{k}: {found} {missed}");
        }
    }

    #[test]
    fn points_on_a_line_determine_a_curve_and_no_plane() {
        let points: Vec<[f64; 2]> = (0..9).map(|k| [0.25 * f64::from(k) - 1.0, 0.0]).collect();
        let values: Vec<f64> = points.iter().map(|[x, _]| x.exp()).collect();
        assert!(Surface::through(points.clone(), &values, true, LESS_SMOOTH).is_none());
        let curve = Surface::through(points, &values, false, SMOOTH).unwrap();
        assert!((curve.at(std::iter::once([0.4, 0.0]))[0] - 0.4_f64.exp()).abs() < 1e-4);
    }
}
