//! Where contact ends between two nodes.
//!
//! Nodes alone touch the dome. The contact's edge seldom passes through one: between the last node
//! that touches and the next, the sheet leaves the dome at a place of its own. Seen from outside, the
//! free sheet goes on above the dome by ½κδ² at the last node, δ from the edge, κ the curvature with
//! which the gap opens. Held at this lift, the last node gives the free sheet the right support: the
//! error of the contact's edge falls from up to κh²/8 to the grid's smooth one (the jump correction of
//! immersed interface methods: R. J. LeVeque and Z. Li, SIAM J. Numer. Anal. 31, 1994).
//!
//! Lifts are found once, from the equilibrium without them: so the shape does not depend on the way to
//! it.

/// Lifts below this share of the tolerance are left out, and count as error.
const LEAST_SHARE: f64 = 0.2;
/// Greatest lifts \[share of the base radius\] up to which lifts are taken whole, and from which on not
/// at all: there the grid does not show how the gap opens.
const TRUSTED: (f64, f64) = (5e-4, 1e-3);

/// The greatest error of the shape without lifts, as a share of the greatest lift, from which on it is
/// clear which nodes touch.
const CLEAR_SHARE: f64 = 0.03;

/// Is the shape without lifts so near to its equilibrium that it is clear which nodes touch? A node more
/// or less changes the lifts around it by as much as they are. In the same unit.
pub(super) fn is_clear(error: f64, greatest: f64) -> bool {
    error <= CLEAR_SHARE * greatest
}

/// The share of all lifts to take, given the greatest of them; zero where they do not matter. All
/// relative to the base radius.
pub(super) fn share(greatest: f64, tolerance: f64) -> f64 {
    if missed(greatest) > LEAST_SHARE * tolerance { trusted(greatest) } else { 0.0 }
}

/// What is missed where [`share`] is zero because lifts do not matter: the grid's own equilibrium has
/// them as far as they are trusted.
pub(super) fn missed(greatest: f64) -> f64 {
    trusted(greatest) * greatest
}

fn trusted(greatest: f64) -> f64 {
    ((TRUSTED.1 - greatest) / (TRUSTED.1 - TRUSTED.0)).clamp(0.0, 1.0)
}

/// The eight directions of the grid.
const DIRECTIONS: [(isize, isize); 8] =
    [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];

/// The lift of a node that touches, in the unit of the gaps; negative where contact ends before the
/// node, so that the sheet itself stands off the dome there by as much.
///
/// `gap` gives the gap of the node at the given offset in columns and rows if that node is free and
/// does not touch. Zero where the next two nodes of no direction are so.
pub(super) fn lift(gap: impl Fn(isize, isize) -> Option<f64>) -> f64 {
    let (mut lift, mut sharpest) = (0.0_f64, 0.0);
    for (i, j) in DIRECTIONS {
        let (Some(next), Some(second)) = (gap(i, j), gap(2 * i, 2 * j)) else { continue };
        // The gap along this direction is slope·s + bend·s²/2, s in grid steps. Lifted by
        // slope²/(2 bend), it would be zero where it is least: there contact ends.
        let bend = second - 2.0 * next;
        let slope = next - 0.5 * bend;
        let curvature = bend / (i * i + j * j) as f64;
        if curvature > sharpest {
            sharpest = curvature;
            // Farther off than half a step the neighbour would touch, or this node would not.
            lift = (slope * slope / (2.0 * bend)).min(bend / 8.0).copysign(-slope);
        }
    }
    lift
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lift_is_the_free_sheets_extension() {
        // The gap ½κ(s − δ)² in front of a node at 0 that touches, all of it held too low by its lift.
        for edge in [-0.4, -0.1, 0.0, 0.3] {
            let curvature = 0.02;
            let exact = 0.5 * curvature * edge * edge;
            let gap = |i: isize, _: isize| {
                (i > 0).then(|| 0.5 * curvature * (i as f64 - edge).powi(2) - exact)
            };
            assert!((lift(gap).abs() - exact).abs() < 1e-12);
            assert_eq!(lift(gap) < 0.0, edge < 0.0);
        }
    }

    #[test]
    fn nothing_is_lifted_inside_the_contact() {
        assert!(lift(|_, _| None).abs() <= 0.0);
    }
}
