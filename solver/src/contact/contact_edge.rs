//! Contact edge between two nodes: contact offsets.
//!
//! Only nodes touch the dome, and the contact edge seldom passes through a node: the sheet leaves the dome
//! between the last active node and the next node. Extended inwards, the free sheet lies ½κδ² above the
//! dome at the last active node (δ the node's distance from the edge, κ the curvature of the opening gap). At this
//! contact offset the last active node supports the free sheet exactly: the error of the contact edge falls from up
//! to κh²/8 to the discretisation error of a smooth solution (the jump correction of immersed interface
//! methods: R. J. LeVeque and Z. Li, SIAM J. Numer. Anal. 31, 1994).
//!
//! Contact offsets are computed once, from the converged node-wise contact solution, so that the result is path
//! independent.

/// Fraction of the tolerance below which offsets are neglected and count as error \[-\].
const LEAST_FRACTION: f64 = 0.2;
/// Greatest offset up to which all offsets are fully applied, and greatest offset above which none is
/// \[base radius\]: such a grid does not resolve the opening gap.
const TRUSTED: (f64, f64) = (5e-4, 1e-3);
/// Error of the node-wise solution, as a fraction of the greatest offset, up to which the active set is clear
/// \[-\]. Fixed by `free-node-counted-as-active`.
const CLEAR_FRACTION: f64 = 0.03;

/// Is the error of the node-wise solution small enough for a clear active set? One active node more or less changes
/// the offsets around the node by their own size. Both arguments in the same unit.
pub(crate) fn is_clear(error: f64, greatest: f64) -> bool {
    error <= CLEAR_FRACTION * greatest
}

/// The fraction of all offsets to apply for a greatest offset; zero for negligible offsets. Lengths relative to the
/// base radius.
pub(crate) fn fraction(greatest: f64, tolerance: f64) -> f64 {
    if neglected(greatest) > LEAST_FRACTION * tolerance { trusted(greatest) } else { 0.0 }
}

/// The error of neglected offsets.
pub(crate) fn neglected(greatest: f64) -> f64 {
    trusted(greatest) * greatest
}

fn trusted(greatest: f64) -> f64 {
    ((TRUSTED.1 - greatest) / (TRUSTED.1 - TRUSTED.0)).clamp(0.0, 1.0)
}

/// The eight directions of the grid.
const DIRECTIONS: [(isize, isize); 8] =
    [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];

/// The contact offset of an active node, in the unit of the gaps; negative if contact ends before the node: the
/// sheet itself is off the dome by the offset.
///
/// `gap` returns the gap of the node at a distance in columns and rows if the node is free and inactive. The
/// offset is zero if no direction has two such nodes.
pub(crate) fn offset(gap: impl Fn(isize, isize) -> Option<f64>) -> f64 {
    let (mut offset, mut sharpest) = (0.0_f64, 0.0);
    for (i, j) in DIRECTIONS {
        let (Some(next), Some(second)) = (gap(i, j), gap(2 * i, 2 * j)) else { continue };
        // The gap along this direction is slope·s + bend·s²/2, s in grid steps. With an offset of
        // slope²/(2 bend) the minimum of the gap is zero: the contact edge.
        let bend = second - 2.0 * next;
        let slope = next - 0.5 * bend;
        let curvature = bend / (i * i + j * j) as f64;
        if curvature > sharpest {
            sharpest = curvature;
            // Beyond half a step the neighbour would be active, or this node inactive.
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
        // The gap ½κ(s − δ)² in front of an active node at 0, minus the node's offset.
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
    fn interior_nodes_of_the_contact_have_no_offset() {
        assert!(offset(|_, _| None).abs() <= 0.0);
    }
}
