//! May a shape be shown? What no equilibrium of a sheet over a dome looks like.

use crate::implant::Dome;
use crate::sheet::{CellKind, Sheet};
use glam::DVec3;

/// What is wrong with a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A node's place is not a number.
    NotFinite,
    /// The dome sticks out between nodes: the grid is too coarse for it, or tissue whose stress hardly
    /// rises with strain gives way under its tip.
    Pierced,
    /// Part of the sheet is turned over: its skin's side faces the implant.
    InsideOut,
}

/// How deep the middle of a cell may lie in the dome \[share of the dome's half axes, and of the base radius
/// as a distance\]: chords of a sphere lie this deep where they are 0.6 radii long.
const PIERCED: f64 = 0.05;
/// How far the highest node may lie below the dome's tip \[share of its lesser half axis, of the base
/// radius\]: a tip between nodes 0.6 radii apart is 0.09 radii above them.
const SUNK: (f64, f64) = (0.1, 0.01);
/// A cap that no node touches is nothing to speak of up to this height \[share of the base radius\].
const SEEN: f64 = 1e-3;
/// How far a cell may face away from the skin's side \[cosine\].
const TURNED: f64 = 0.3;
/// The skin's side is where the sheet is seen to from this far below the pocket's centre
/// \[share of the pocket's radius\]: a sheet that is pulled over a dome has no fold from there.
const EYE: f64 = 0.05;

/// Where the sheet is seen from.
fn eye(sheet: &Sheet) -> DVec3 {
    DVec3::new(0.0, 0.0, -EYE * sheet.radius_mm())
}

/// Does a face with this normal show its other side to one who sees it along `sight`?
fn is_turned(normal: DVec3, sight: DVec3) -> bool {
    let cosine = normal.dot(sight);
    cosine < 0.0
        && cosine * cosine > TURNED * TURNED * normal.length_squared() * sight.length_squared()
}

/// Is some triangle of a shape turned over? Finer than [`fault`], for springs that may push: a corner
/// of a cell can fold while the cell as a whole does not.
pub(crate) fn has_fold(sheet: &Sheet, x: &[DVec3]) -> bool {
    let eye = eye(sheet);
    sheet.triangles().any(|(nodes, _)| {
        let [a, b, c] = nodes.map(|k| x[k]);
        is_turned((b - a).cross(c - a), (a + b + c) / 3.0 - eye)
    })
}

/// The gravest fault of a shape, if it has one. `at` gives the place \[mm\] of the node of a column and
/// row, from the column and row `first` on: a mirrored shape need be seen but once. `tolerance` is that of a
/// node's place, relative to the base radius.
pub(crate) fn fault(
    sheet: &Sheet,
    dome: &Dome,
    tolerance: f64,
    first: [usize; 2],
    at: impl Fn(usize, usize) -> DVec3,
) -> Option<Fault> {
    let n = sheet.nodes_per_side();
    let eye = eye(sheet);
    let scale = DVec3::new(dome.base_radius, dome.base_radius, dome.projection).recip();
    let origin = dome.origin();
    // The level's slope makes a distance of what is missing to the surface; towards the tip of a needle it
    // is small.
    let is_deep = |place: DVec3| {
        let length = place.length();
        let slope = (place * scale).length() / length * dome.base_radius;
        length < 1.0 && 1.0 - length > PIERCED * slope.min(1.0)
    };
    let (mut is_pierced, mut is_folded, mut highest) = (false, false, 0.0_f64);
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
                return Some(Fault::NotFinite);
            }
            is_pierced |= middle.z >= dome.base_height && is_deep((middle - origin) * scale);
            is_folded |= is_turned((c - a).cross(d - b), middle - eye);
        }
    }
    let tip = dome.apex().z;
    let (sunk, radius) = (tip - highest, dome.base_radius);
    is_pierced |= sunk > (SUNK.0 * dome.projection.min(radius)).max(SUNK.1 * radius);
    // A cap so small that it lies between the nodes.
    is_pierced |= sunk > (0.5 * tip).max(tolerance.max(SEEN) * radius);
    if is_pierced { Some(Fault::Pierced) } else { is_folded.then_some(Fault::InsideOut) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::guess;
    use glam::DVec2;

    #[test]
    fn a_shape_is_sound_until_it_is_broken_folded_or_pierced() {
        let sheet = Sheet::new(33, 70.0);
        let n = 33;
        let middle = 16 * n + 16;
        for (center, t) in [(DVec2::ZERO, 1.0), (DVec2::new(9.0, -4.0), 0.6), (DVec2::ZERO, 0.0)] {
            let dome = Dome::new(center, 55.0, 40.0, t);
            let sound = guess::tight_string(&sheet, &dome);
            let fault_of = |x: &[DVec3], first: usize| {
                fault(&sheet, &dome, 1e-4, [first; 2], |i, j| x[j * n + i])
            };
            assert_eq!(fault_of(&sound, 0), None);
            assert_eq!(fault_of(&sound, n / 2), None);
            assert!(!has_fold(&sheet, &sound));
            let mut broken = sound.clone();
            broken[middle].y = f64::NAN;
            assert_eq!(fault_of(&broken, 0), Some(Fault::NotFinite));
            assert_eq!(fault_of(&broken, n / 2), Some(Fault::NotFinite));
            // One node carried over its neighbours.
            let mut folded = sound.clone();
            folded[middle] = sound[middle + 3] + DVec3::new(0.0, 0.0, 0.5);
            assert_eq!(fault_of(&folded, 0), Some(Fault::InsideOut));
            assert!(has_fold(&sheet, &folded));
            // One corner of its cells over the diagonal, the cells not.
            let mut dented = sound.clone();
            dented[middle] = 0.45 * sound[middle] + 0.55 * sound[middle + n + 1];
            dented[middle].z += 1e-3;
            assert!(has_fold(&sheet, &dented));
            if t > 0.0 {
                let mut pierced = sound.clone();
                for k in [0, 1, n, n + 1] {
                    pierced[middle + k].z *= 0.7;
                }
                assert_eq!(fault_of(&pierced, 0), Some(Fault::Pierced));
            }
        }
    }

    #[test]
    fn a_needle_that_a_node_slipped_off_sticks_out() {
        let sheet = Sheet::new(33, 70.0);
        let n = 33;
        let dome = Dome::new(DVec2::new(0.5, 0.0), 2.0, 40.0, 1.0);
        let mut x: Vec<DVec3> = sheet.rest().iter().map(|p| p.extend(0.0)).collect();
        let fault_of = |x: &[DVec3]| fault(&sheet, &dome, 1e-4, [0; 2], |i, j| x[j * n + i]);
        x[16 * n + 16] = dome.apex();
        assert_eq!(fault_of(&x), None);
        x[16 * n + 16] = DVec3::new(-2.5, 0.0, 0.0);
        assert_eq!(fault_of(&x), Some(Fault::Pierced));
    }
}
