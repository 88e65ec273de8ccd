//! Validity of a solution: finite, not penetrated, not inverted.

use super::problem::Tissue;
use crate::contact::Dome;
use crate::mesh::{CellKind, Chest, Sheet};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Why a solution is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Invalid {
    /// A position is not finite.
    NotFinite,
    /// The dome protrudes between nodes: the grid is too coarse for the dome, or tissue whose stress barely
    /// rises with strain slides off the dome's tip.
    Penetrated,
    /// Part of the sheet is inverted: the outer side faces the implant.
    Inverted,
    /// No shape was found: the iteration ended before the finest grid, or in a shape that is invalid.
    NotFound,
}

/// Tolerated depth of a cell's midpoint in the dome \[half axes; base radius as a distance\]: of a sheet the depth of a
/// sphere's chord of 0.6 radii. Of layered tissue, whose skin does not follow the inner face, that of a chord of 0.9 radii: fat that
/// tight skin squeezes off the apex spreads its cells of 33 nodes per side to twice and three times their width.
const MAX_CHORD_DEPTH: [f64; 2] = [0.05, 0.1];
/// Tolerated height of the dome's tip above the highest node \[lesser half axis, base radius\]: a tip
/// between nodes 0.6 radii apart is 0.09 radii above the nodes. Fixed by `sheet-sliding-off-needle`.
const MAX_TIP_HEIGHT: (f64, f64) = (0.1, 0.01);
/// Height of a cap that may lie between nodes \[base radius\]. Fixed by `penetration-between-nodes`.
const MIN_CAP_HEIGHT: f64 = 1e-3;
/// Cosine between a cell's normal and the line of sight below which the cell is inverted \[-\].
const MAX_FACING_AWAY: f64 = 0.3;
/// Depth of the viewpoint below the pocket's centre \[patch radius\]: a sheet stretched over a dome is star-shaped
/// about the viewpoint.
pub const VIEWPOINT_DEPTH: f64 = 0.05;

fn viewpoint(sheet: &Sheet) -> DVec3 {
    DVec3::new(0.0, 0.0, -VIEWPOINT_DEPTH * sheet.radius_mm())
}

/// Is a face with this normal inverted, seen along a line of sight from the viewpoint?
fn is_inverted(normal: DVec3, sight: DVec3) -> bool {
    let cosine = normal.dot(sight);
    cosine < 0.0
        && cosine * cosine
            > MAX_FACING_AWAY * MAX_FACING_AWAY * normal.length_squared() * sight.length_squared()
}

/// Is a triangle inverted? A finer test than [`invalid`], for compressive springs: the corner of a cell can be
/// inverted although the cell is not. Fixed by `inverted-cell-corner`.
pub(crate) fn has_inverted_triangle(sheet: &Sheet, x: &[DVec3]) -> bool {
    let viewpoint = viewpoint(sheet);
    sheet.triangles().any(|(nodes, _)| {
        let [a, b, c] = nodes.map(|k| x[k]);
        is_inverted((b - a).cross(c - a), (a + b + c) / 3.0 - viewpoint)
    })
}

/// The gravest reason why a shape is invalid. `at` returns the position \[mm\] of the node of a column and row,
/// from `first` on: one side of a mirrored shape is enough. `tolerance` is that of positions, relative to the
/// base radius. The inner face of layered tissue, which need not be star-shaped where tight skin lifts it beside the dome, is
/// inverted only where it faces the wall, too; its cells have a test of their own. Fixed by `tests/bodies.rs` ·
/// `tight_skin_that_lifts_the_inner_face_beside_a_steep_implant_has_a_shape`.
pub(crate) fn invalid(
    (sheet, tissue): (&Sheet, Tissue),
    dome: &Dome,
    tolerance: f64,
    first: [usize; 2],
    at: impl Fn(usize, usize) -> DVec3,
) -> Option<Invalid> {
    let n = sheet.nodes_per_side();
    let viewpoint = viewpoint(sheet);
    // Heights above a curved wall instead of z: the wall becomes the plane, and what is inverted stays so.
    let (chest, dome) = (&dome.chest, dome.clone().over(Chest::Flat));
    let at = |i: usize, j: usize| chest.flattened(at(i, j));
    let is_sheet = tissue == Tissue::Sheet;
    let [of_sheet, of_layers] = MAX_CHORD_DEPTH;
    let is_deep = dome.is_deeper_than(if is_sheet { of_sheet } else { of_layers });
    let (mut is_penetrated, mut is_folded, mut highest) = (false, false, 0.0_f64);
    for j in first[1]..n - 1 {
        let (from, to) = sheet.row_spans()[j];
        for i in from.max(first[0])..to.min(n - 1) {
            if sheet.cell(i, j) != CellKind::Whole {
                continue;
            }
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            let middle = 0.25 * ((a + c) + (b + d));
            highest = highest.max(a.z);
            if !middle.is_finite() {
                return Some(Invalid::NotFinite);
            }
            is_penetrated |= is_deep(middle);
            let normal = (c - a).cross(d - b);
            is_folded |= is_inverted(normal, middle - viewpoint) && (is_sheet || normal.z < 0.0);
        }
    }
    let tip = dome.apex().z;
    let (protrusion, radius) = (tip - highest, dome.reference_length());
    let (of_axis, of_radius) = MAX_TIP_HEIGHT;
    is_penetrated |= protrusion > (of_axis * dome.shape.least_length()).max(of_radius * radius);
    // A small cap may lie between the nodes.
    is_penetrated |= protrusion > (0.5 * tip).max(tolerance.max(MIN_CAP_HEIGHT) * radius);
    if is_penetrated { Some(Invalid::Penetrated) } else { is_folded.then_some(Invalid::Inverted) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::HalfBall;
    use crate::mesh::Rest;
    use crate::solve::initial_guess;
    use glam::DVec2;

    #[test]
    fn the_initial_guess_of_an_anatomical_implant_is_valid() {
        let rest = Rest::of_sheet(Sheet::new(65, 75.0));
        for (center, t) in [(DVec2::ZERO, 1.0), (DVec2::new(4.0, -3.0), 0.7)] {
            let dome = Dome::new(center, HalfBall::round(55.0, 40.0).anatomical(65.0, 28.0), t);
            let x = initial_guess::taut_profile(&rest, &dome);
            let of = (rest.sheet(), Tissue::Sheet);
            assert_eq!(invalid(of, &dome, 1e-4, [0; 2], |i, j| x[j * 65 + i]), None);
            let highest = x.iter().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
            assert!(highest.distance(dome.apex()) < 3.0, "{highest}");
        }
    }

    #[test]
    fn shapes_that_are_not_finite_inverted_or_penetrated_are_invalid() {
        let rest = Rest::of_sheet(Sheet::new(33, 70.0));
        let (sheet, n) = (rest.sheet(), 33);
        let middle = 16 * n + 16;
        for (center, t) in [(DVec2::ZERO, 1.0), (DVec2::new(9.0, -4.0), 0.6), (DVec2::ZERO, 0.0)] {
            let dome = Dome::new(center, HalfBall::round(55.0, 40.0), t);
            let valid = initial_guess::taut_profile(&rest, &dome);
            let invalid_of = |x: &[DVec3], first: usize| {
                invalid((sheet, Tissue::Sheet), &dome, 1e-4, [first; 2], |i, j| x[j * n + i])
            };
            assert_eq!(invalid_of(&valid, 0), None);
            assert_eq!(invalid_of(&valid, n / 2), None);
            assert!(!has_inverted_triangle(sheet, &valid));
            let mut broken = valid.clone();
            broken[middle].y = f64::NAN;
            assert_eq!(invalid_of(&broken, 0), Some(Invalid::NotFinite));
            assert_eq!(invalid_of(&broken, n / 2), Some(Invalid::NotFinite));
            // One node beyond its neighbours.
            let mut folded = valid.clone();
            folded[middle] = valid[middle + 3] + DVec3::new(0.0, 0.0, 0.5);
            assert_eq!(invalid_of(&folded, 0), Some(Invalid::Inverted));
            assert!(has_inverted_triangle(sheet, &folded));
            // One corner of four cells beyond the diagonals; no cell is inverted.
            let mut dented = valid.clone();
            dented[middle] = 0.45 * valid[middle] + 0.55 * valid[middle + n + 1];
            dented[middle].z += 1e-3;
            assert!(has_inverted_triangle(sheet, &dented));
            // Two rows of nodes beyond the dome, lifted as tight skin lifts the inner face: a slope of 45° towards the dome.
            let mut sloping = valid.clone();
            for i in n / 2 - 3..=n / 2 + 3 {
                sloping[30 * n + i].z = 2.0 + sheet.spacing_mm();
                sloping[29 * n + i].z = 2.0;
            }
            assert_eq!(invalid_of(&sloping, 0), Some(Invalid::Inverted));
            let layered = |x: &[DVec3]| {
                invalid((sheet, Tissue::Layered), &dome, 1e-4, [0; 2], |i, j| x[j * n + i])
            };
            assert_eq!(layered(&sloping), None);
            assert_eq!(layered(&folded), Some(Invalid::Inverted));
            if t > 0.0 {
                let mut penetrated = valid.clone();
                for k in [0, 1, n, n + 1] {
                    penetrated[middle + k].z *= 0.7;
                }
                assert_eq!(invalid_of(&penetrated, 0), Some(Invalid::Penetrated));
                assert_eq!(layered(&penetrated), Some(Invalid::Penetrated));
                // Between the depths of both.
                for k in [0, 1, n, n + 1] {
                    penetrated[middle + k].z = valid[middle + k].z - 3.0;
                }
                assert_eq!(invalid_of(&penetrated, 0), Some(Invalid::Penetrated));
                assert_eq!(layered(&penetrated), None);
            }
        }
    }

    #[test]
    fn a_needle_without_a_node_on_its_tip_penetrates() {
        let sheet = Sheet::new(33, 70.0);
        let n = 33;
        let dome = Dome::new(DVec2::new(0.5, 0.0), HalfBall::round(2.0, 40.0), 1.0);
        let mut x: Vec<DVec3> = sheet.rest().iter().map(|p| p.extend(0.0)).collect();
        let of = (&sheet, Tissue::Sheet);
        let invalid_of = |x: &[DVec3]| invalid(of, &dome, 1e-4, [0; 2], |i, j| x[j * n + i]);
        x[16 * n + 16] = dome.apex();
        assert_eq!(invalid_of(&x), None);
        x[16 * n + 16] = DVec3::new(-2.5, 0.0, 0.0);
        assert_eq!(invalid_of(&x), Some(Invalid::Penetrated));
    }
}
