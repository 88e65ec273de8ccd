//! The explicit Runge–Kutta pair 5(4) of Dormand and Prince with step size control (J. R. Dormand,
//! P. J. Prince, J. Comp. Appl. Math. 6, 1980; E. Hairer, S. P. Nørsett, G. Wanner, "Solving Ordinary
//! Differential Equations I", II.4–5).

/// Greatest number of steps of an integration.
const MAX_STEPS: usize = 20_000;

const NODES: [f64; 6] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const STAGES: [[f64; 6]; 6] = [
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Fifth-order weights (the last row of [`STAGES`]) minus the fourth-order weights.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Step size control.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps<const N: usize> {
    /// Local error tolerance, relative to `scale` \[-\].
    pub(super) tolerance: f64,
    /// Magnitude of each variable.
    pub(super) scale: [f64; N],
    /// Greatest step size.
    pub(super) longest: f64,
}

/// Integrates y′ = f(t, y) from `from.0` to `to` > `from.0`; returns the final y, or `None` if the steps
/// become too short or too many.
///
/// `visit` receives t, y and y′ at the start and after every step; the value `false` ends the integration.
pub(super) fn integrate<const N: usize>(
    f: impl Fn(f64, &[f64; N]) -> [f64; N],
    from: (f64, [f64; N]),
    to: f64,
    steps: &Steps<N>,
    mut visit: impl FnMut(f64, &[f64; N], &[f64; N]) -> bool,
) -> Option<[f64; N]> {
    let (mut t, mut y) = from;
    let mut k = [[0.0; N]; 7];
    k[0] = f(t, &y);
    if !visit(t, &y, &k[0]) {
        return Some(y);
    }
    let shortest = 1e-15 * (to - t).max(1e-3 * to.abs());
    let mut step = steps.longest.min(to - t);
    for _ in 0..MAX_STEPS {
        if to - t <= shortest {
            return Some(y);
        }
        step = step.min(to - t);
        let mut end = y;
        for (stage, (node, row)) in NODES.iter().zip(&STAGES).enumerate() {
            for i in 0..N {
                let sum: f64 = (0..=stage).map(|j| row[j] * k[j][i]).sum();
                end[i] = y[i] + step * sum;
            }
            k[stage + 1] = f(t + node * step, &end);
        }
        // A NaN counts as an infinite error.
        let mut error = 0.0_f64;
        for i in 0..N {
            let local: f64 = (0..7).map(|j| ERROR[j] * k[j][i]).sum();
            let relative = (step * local / steps.scale[i]).abs() / steps.tolerance;
            error = if relative.is_nan() { f64::INFINITY } else { error.max(relative) };
        }
        if error <= 1.0 || step <= shortest {
            if !error.is_finite() {
                return None;
            }
            t += step;
            y = end;
            k[0] = k[6];
            if !visit(t, &y, &k[0]) {
                return Some(y);
            }
        }
        step *= (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.1, 5.0);
        step = step.clamp(shortest, steps.longest);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_within_the_tolerance_on_a_circle_and_across_a_kink() {
        let steps = Steps { tolerance: 1e-12, scale: [1.0; 2], longest: 0.5 };
        let turn = |_: f64, y: &[f64; 2]| [y[1], -y[0]];
        let end = integrate(turn, (0.0, [0.0, 1.0]), 2.0, &steps, |_, _, _| true).unwrap();
        assert!((end[0] - 2.0_f64.sin()).abs() < 1e-10 && (end[1] - 2.0_f64.cos()).abs() < 1e-10);
        let jump = |t: f64, _: &[f64; 2]| [if t < 0.7 { 1.0 } else { 3.0 }, 0.0];
        let end = integrate(jump, (0.0, [0.0; 2]), 2.0, &steps, |_, _, _| true).unwrap();
        assert!((end[0] - 4.6).abs() < 1e-10, "{}", end[0]);
    }

    #[test]
    fn a_pole_ends_the_integration() {
        let steps = Steps { tolerance: 1e-9, scale: [1.0], longest: 0.5 };
        let end = integrate(|_, y| [y[0] * y[0]], (0.0, [1.0]), 2.0, &steps, |_, _, _| true);
        assert!(end.is_none() || end.is_some_and(|y| !y[0].is_finite() || y[0] > 1e6));
    }
}
