//! Curves through measured points: checks, monotone cubic interpolation.

use super::{
    CurveError, MAX_POINTS, MAX_STRAIN, MIN_SLOPE, MIN_WIDTH, SLOPE, STRESS_SCALE, Shape, number,
};

pub(super) fn check_points(points: &[[f64; 2]]) -> Result<(), CurveError> {
    if !(2..=MAX_POINTS).contains(&points.len()) {
        return Err(CurveError::Count {
            field: "points",
            count: points.len(),
            allowed: "2 to 100000",
        });
    }
    let invalid =
        |index: usize, problem: String| Err(CurveError::Entry { field: "points", index, problem });
    for (index, &[strain, stress]) in points.iter().enumerate() {
        let given = || format!("is [{}, {}]", number(strain), number(stress));
        if !(strain.is_finite() && stress.is_finite()) {
            return invalid(index, format!("{}; allowed: finite numbers", given()));
        }
        if index == 0 {
            if strain != 0.0 || stress != 0.0 {
                return invalid(index, format!("{}; the first point must be [0, 0]", given()));
            }
            continue;
        }
        let [before, stress_before] = points[index - 1];
        let after = || format!("{} after [{}, {}]", given(), number(before), number(stress_before));
        if strain <= before || stress <= stress_before {
            return invalid(index, format!("{}; strain and stress must both increase", after()));
        }
        if strain > MAX_STRAIN || stress > STRESS_SCALE.1 {
            return invalid(
                index,
                format!("{}; allowed: strain to {MAX_STRAIN}, stress to 1e7 kPa", given()),
            );
        }
        let step = strain - before;
        if step < MIN_WIDTH {
            return invalid(index, format!("{}; allowed: strains 1e-9 apart or more", after()));
        }
        let slope = (stress - stress_before) / step;
        if !(MIN_SLOPE..=SLOPE.1).contains(&slope) {
            return invalid(
                index,
                format!("{}: slope {slope:e}; allowed: 1e-9 to 1e9 kPa", after()),
            );
        }
    }
    Ok(())
}

/// Cubic Hermite piece with the given rise over `length` and the given end slopes, in powers of x.
pub(super) fn hermite(length: f64, rise: f64, start_slope: f64, end_slope: f64) -> Shape {
    let secant = rise / length;
    Shape::Polynomial(vec![
        start_slope,
        (3.0 * secant - 2.0 * start_slope - end_slope) / length,
        (start_slope + end_slope - 2.0 * secant) / (length * length),
    ])
}

/// Slopes of the monotone piecewise cubic through increasing data
/// (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5(2), 1984: weighted harmonic means).
pub(super) fn monotone_slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let n = points.len();
    let width: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
    let secant: Vec<f64> =
        points.windows(2).zip(&width).map(|(p, w)| (p[1][1] - p[0][1]) / w).collect();
    if n == 2 {
        return vec![secant[0]; 2];
    }
    let mut slopes = vec![0.0; n];
    for k in 1..n - 1 {
        let (w0, w1) = (width[k - 1], width[k]);
        let weights = (2.0 * w1 + w0, w1 + 2.0 * w0);
        slopes[k] = (weights.0 + weights.1) / (weights.0 / secant[k - 1] + weights.1 / secant[k]);
    }
    // Three-point end formula, bounded by three secants against overshoot and from below for a positive
    // stiffness at rest.
    let end = |w: [f64; 2], s: [f64; 2]| {
        (((2.0 * w[0] + w[1]) * s[0] - w[0] * s[1]) / (w[0] + w[1])).clamp(1e-3 * s[0], 3.0 * s[0])
    };
    slopes[0] = end([width[0], width[1]], [secant[0], secant[1]]);
    slopes[n - 1] = end([width[n - 2], width[n - 3]], [secant[n - 2], secant[n - 3]]);
    slopes
}
