//! The volume between the inner face and the wall over the pocket, as a sum over the nodes.
//!
//! V = Σ ϖ a h: a is a node's area over the plane, ¼ of the product of the diagonals of its neighbours' rhombus; h its height over the
//! wall; ϖ the part of its surroundings at rest inside of the pocket.

use crate::number::Real;

/// Weight of a node in sums over the pocket: the part of the node's surroundings inside of the pocket, to second order. The node's distance beyond the pocket's
/// edge and the spacing are in one unit.
pub(crate) fn pocket_weight(beyond: f64, spacing: f64) -> f64 {
    (0.5 - beyond / spacing).clamp(0.0, 1.0)
}

/// Area of a node over the plane, `place` giving the places of the nodes of rows of `pitch` nodes.
#[inline(always)]
pub(crate) fn area<R: Real>(node: usize, pitch: usize, place: impl Fn(usize) -> [R; 2]) -> R {
    let [east, west] = [place(node + 1), place(node - 1)];
    let [north, south] = [place(node + pitch), place(node - pitch)];
    let across = [east[0] - west[0], east[1] - west[1]];
    let along = [north[0] - south[0], north[1] - south[1]];
    R::splat(0.25) * (across[0] * along[1] - along[0] * across[1])
}

/// Derivative of V by the place of a node through its neighbours' areas; `height` gives ϖh. The derivative by its height is ϖa, and over a
/// slope of the wall −ϖa∇w is to be added.
#[inline(always)]
pub(crate) fn gradient<R: Real>(
    node: usize,
    pitch: usize,
    place: impl Fn(usize) -> [R; 2],
    height: impl Fn(usize) -> R,
) -> [R; 2] {
    let [north, south] = [node + pitch, node - pitch];
    let [ne, nw, se, sw] = [place(north + 1), place(north - 1), place(south + 1), place(south - 1)];
    let [east, west] = [height(node + 1), height(node - 1)];
    let [north, south] = [height(north), height(south)];
    let turned = |axis: usize| {
        west * (nw[axis] - sw[axis]) - east * (ne[axis] - se[axis]) - south * (se[axis] - sw[axis])
            + north * (ne[axis] - nw[axis])
    };
    let quarter = R::splat(0.25);
    [quarter * turned(1), -(quarter * turned(0))]
}
