//! Where contact ends between two nodes: contact offsets.
//!
//! Only nodes touch the dome, and the contact's edge seldom passes through one: the sheet leaves the dome
//! between the last node that touches and the next one. Extended inwards, the free sheet lies ½κδ² above the
//! dome at the last node, δ its distance from the edge, κ the curvature with which the gap opens. Held at this
//! contact offset, the last node supports the free sheet exactly: the error of the contact's edge falls from up
//! to κh²/8 to the discretisation error of a smooth solution (the jump correction of immersed interface
//! methods: R. J. LeVeque and Z. Li, SIAM J. Numer. Anal. 31, 1994).
//!
//! Contact offsets are computed once, from the converged node-wise contact solution, so that the result is path
//! independent.

/// Offsets below this fraction of the tolerance are neglected, and count as error \[-\].
const LEAST_FRACTION: f64 = 0.2;
/// Greatest offsets \[base radius\] up to which offsets are applied whole, and from which on not at all: the
/// grid does not resolve there how the gap opens.
const TRUSTED: (f64, f64) = (5e-4, 1e-3);
/// Error of the node-wise solution, as a fraction of the greatest offset, up to which the active set is clear
/// \[-\]. Fixed by `free-node-counted-as-active`.
const CLEAR_FRACTION: f64 = 0.03;

/// Is the error of the node-wise solution so small that the active set is clear? One node more or less changes
/// the offsets around it by as much as they are. Both in the same unit.
pub(crate) fn is_clear(error: f64, greatest: f64) -> bool {
    error <= CLEAR_FRACTION * greatest
}

/// The fraction of all offsets to apply, given the greatest one; zero where they are negligible. All relative to
/// the base radius.
pub(crate) fn fraction(greatest: f64, tolerance: f64) -> f64 {
    if neglected(greatest) > LEAST_FRACTION * tolerance { trusted(greatest) } else { 0.0 }
}

/// The error where [`fraction`] is zero because offsets are negligible.
pub(crate) fn neglected(greatest: f64) -> f64 {
    trusted(greatest) * greatest
}

fn trusted(greatest: f64) -> f64 {
    ((TRUSTED.1 - greatest) / (TRUSTED.1 - TRUSTED.0)).clamp(0.0, 1.0)
}

/// The eight directions of the grid.
const DIRECTIONS: [(isize, isize); 8] =
    [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];

/// The contact offset of an active node, in the unit of the gaps; negative where contact ends before the node,
/// so that the sheet itself stands off the dome there by as much.
///
/// `gap` returns the gap of the node so many columns and rows away if that node is free and not active. The
/// offset is zero if no direction has two such nodes.
pub(crate) fn offset(gap: impl Fn(isize, isize) -> Option<f64>) -> f64 {
    let (mut offset, mut sharpest) = (0.0_f64, 0.0);
    for (i, j) in DIRECTIONS {
        let (Some(next), Some(second)) = (gap(i, j), gap(2 * i, 2 * j)) else { continue };
        // The gap along this direction is slope·s + bend·s²/2, s in grid steps. Offset by
        // slope²/(2 bend), it would be zero at its minimum: there contact ends.
        let bend = second - 2.0 * next;
        let slope = next - 0.5 * bend;
        let curvature = bend / (i * i + j * j) as f64;
        if curvature > sharpest {
            sharpest = curvature;
            // Farther off than half a step the neighbour would touch, or this node would not.
            offset = (slope * slope / (2.0 * bend)).min(bend / 8.0).copysign(-slope);
        }
    }
    offset
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_is_the_free_sheets_extension() {
        // The gap ½κ(s − δ)² in front of an active node at 0, too low by the node's offset.
        for edge in [-0.4, -0.1, 0.0, 0.3] {
            let curvature = 0.02;
            let exact = 0.5 * curvature * edge * edge;
            let gap = |i: isize, _: isize| {
                (i > 0).then(|| 0.5 * curvature * (i as f64 - edge).powi(2) - exact)
            };
            assert!((offset(gap).abs() - exact).abs() < 1e-12);
            assert_eq!(offset(gap) < 0.0, edge < 0.0);
        }
    }

    #[test]
    fn no_node_inside_the_contact_is_offset() {
        assert!(offset(|_, _| None).abs() <= 0.0);
    }
}
