//! Measures of a body from its surface and marks, as a tape has them.
//!
//! Distances along the skin are lengths of a section: of the plane through both points and the mean of the normals there.
//! Not computed: distances under stretch, the shape after months.

use crate::frame::Frame;
use crate::marks::{BreastMarks, Marks, Side};
use crate::surface::Surface;
use glam::DVec3;
use std::collections::HashMap;

/// Reach of the mean normal at a mark \[mm\].
const NEAR_MM: f64 = 8.0;
/// Greatest distance of a mark from a section through it \[mm\].
const OFF_MM: f64 = 12.0;

/// Measures of a breast \[mm\]; along the skin `None` where the section does not lead from one mark to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BreastMeasures {
    /// From the notch to the nipple, straight.
    pub notch_nipple_mm: f64,
    /// From the notch to the nipple along the skin.
    pub notch_nipple_skin_mm: Option<f64>,
    /// From the nipple to the fold along the skin, at rest.
    pub nipple_fold_mm: Option<f64>,
    /// From the nipple to the plane between the sides.
    pub nipple_midline_mm: f64,
    /// From the medial to the lateral mark, straight.
    pub base_width_mm: f64,
}

/// Measures of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// The breasts that have marks, the left one first.
    pub breasts: [Option<BreastMeasures>; 2],
    /// Between the nipples, straight \[mm\].
    pub nipple_nipple_mm: f64,
    /// Between the medial marks, straight \[mm\].
    pub between_breasts_mm: Option<f64>,
    /// The left nipple above the right one along the body \[mm\].
    pub nipple_height_mm: f64,
}

impl Measures {
    /// The left breast less the right one; a length along the skin where both have one. `None` without both.
    #[must_use]
    pub fn left_less_right(&self) -> Option<BreastMeasures> {
        let [Some(left), Some(right)] = self.breasts else { return None };
        let less = |of: fn(&BreastMeasures) -> Option<f64>| Some(of(&left)? - of(&right)?);
        Some(BreastMeasures {
            notch_nipple_mm: left.notch_nipple_mm - right.notch_nipple_mm,
            notch_nipple_skin_mm: less(|breast| breast.notch_nipple_skin_mm),
            nipple_fold_mm: less(|breast| breast.nipple_fold_mm),
            nipple_midline_mm: left.nipple_midline_mm - right.nipple_midline_mm,
            base_width_mm: left.base_width_mm - right.base_width_mm,
        })
    }
}

/// Measures a body in a frame, that of its marks before an operation ([`Frame::of_body`]).
#[must_use]
pub fn measures(surface: &Surface, marks: &Marks, frame: &Frame) -> Measures {
    let breast = |side: Side, breast: &BreastMarks| {
        let nipple = marks.nipple(side);
        BreastMeasures {
            notch_nipple_mm: marks.notch_nipple(side),
            notch_nipple_skin_mm: along_skin(surface, marks.sternal_notch, nipple),
            nipple_fold_mm: along_skin(surface, nipple, breast.fold),
            nipple_midline_mm: frame.local(nipple).x.abs(),
            base_width_mm: breast.medial.distance(breast.lateral),
        }
    };
    let [left, right] = [Side::Left, Side::Right]
        .map(|side| marks.breasts[side as usize].as_ref().map(|found| breast(side, found)));
    let medial = marks.breasts.map(|found| found.map(|found| found.medial));
    let between_breasts_mm = match medial {
        [Some(left), Some(right)] => Some(left.distance(right)),
        _ => None,
    };
    Measures {
        breasts: [left, right],
        nipple_nipple_mm: marks.nipples[0].distance(marks.nipples[1]),
        between_breasts_mm,
        nipple_height_mm: (marks.nipples[0] - marks.nipples[1]).dot(frame.axes.y_axis),
    }
}

/// Length along the skin between two points near it \[mm\].
#[must_use]
pub fn along_skin(surface: &Surface, from: DVec3, to: DVec3) -> Option<f64> {
    let mut normals = [DVec3::ZERO; 2];
    for triangle in &surface.triangles {
        let [a, b, c] = surface.corners(*triangle);
        let middle = (a + b + c) / 3.0;
        for (normal, end) in normals.iter_mut().zip([from, to]) {
            if middle.distance_squared(end) < NEAR_MM * NEAR_MM || [a, b, c].contains(&end) {
                *normal += (b - a).cross(c - a);
            }
        }
    }
    let mean = normals[0].normalize_or_zero() + normals[1].normalize_or_zero();
    let plane = (to - from).cross(mean).try_normalize()?;
    Section::new(surface, from, plane).length(from, to)
}

/// An edge of a triangle by its vertices, the lower one first.
type Edge = (u32, u32);

/// The section of a surface by a plane: segments between sides of triangles.
struct Section {
    /// The sides that a segment joins, and the points on them.
    segments: Vec<([Edge; 2], [DVec3; 2])>,
    /// The segments that end on a side.
    ends: HashMap<Edge, Vec<usize>>,
}

impl Section {
    fn new(surface: &Surface, through: DVec3, normal: DVec3) -> Self {
        let welded = surface.weld();
        let height = |k: u32| {
            let height = (surface.positions[k as usize] - through).dot(normal);
            // A vertex on the plane counts as above: no section runs through it.
            if height == 0.0 { f64::MIN_POSITIVE } else { height }
        };
        let mut found = Self { segments: Vec::new(), ends: HashMap::new() };
        for triangle in &surface.triangles {
            let corners = triangle.map(|k| welded[k as usize]);
            let heights = corners.map(height);
            let mut cuts = [((0, 0), DVec3::ZERO); 2];
            let mut count = 0;
            for k in 0..3 {
                let (a, b) = (k, (k + 1) % 3);
                if (heights[a] > 0.0) != (heights[b] > 0.0) && count < 2 {
                    let [p, q] = [corners[a], corners[b]].map(|k| surface.positions[k as usize]);
                    let share = heights[a] / (heights[a] - heights[b]);
                    let side = (corners[a].min(corners[b]), corners[a].max(corners[b]));
                    cuts[count] = (side, p.lerp(q, share));
                    count += 1;
                }
            }
            if count == 2 {
                let index = found.segments.len();
                for (side, _) in cuts {
                    found.ends.entry(side).or_default().push(index);
                }
                found.segments.push((cuts.map(|cut| cut.0), cuts.map(|cut| cut.1)));
            }
        }
        found
    }

    /// Length of the shorter way along the section between the points nearest to two ends \[mm\].
    fn length(&self, from: DVec3, to: DVec3) -> Option<f64> {
        let (start, start_off) = self.nearest(from)?;
        let (end, end_off) = self.nearest(to)?;
        if start_off.max(end_off) > OFF_MM {
            return None;
        }
        if start == end {
            return Some(from.distance(to));
        }
        let ways = [0, 1].into_iter().filter_map(|way| self.walk((start, from), (end, to), way));
        ways.min_by(f64::total_cmp)
    }

    /// The nearest segment and its distance \[mm\].
    fn nearest(&self, point: DVec3) -> Option<(usize, f64)> {
        let off = |points: &[DVec3; 2]| point.distance(on_segment(points, point));
        let all = self.segments.iter().enumerate().map(|(k, (_, points))| (k, off(points)));
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Length from a point on one segment to a point on another one, leaving the first over one of its ends.
    fn walk(&self, start: (usize, DVec3), end: (usize, DVec3), way: usize) -> Option<f64> {
        let (mut at, mut way) = (start.0, way);
        let (_, points) = &self.segments[at];
        let mut length = on_segment(points, start.1).distance(points[way]);
        for _ in 0..self.segments.len() {
            let side = self.segments[at].0[way];
            at = *self.ends.get(&side)?.iter().find(|next| **next != at)?;
            let (sides, points) = &self.segments[at];
            let entry = usize::from(sides[1] == side);
            if at == end.0 {
                return Some(length + points[entry].distance(on_segment(points, end.1)));
            }
            way = 1 - entry;
            length += points[0].distance(points[1]);
        }
        None
    }
}

/// The point of a segment that is nearest to a point.
fn on_segment([a, b]: &[DVec3; 2], point: DVec3) -> DVec3 {
    let way = *b - *a;
    let share = (point - *a).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
    a.lerp(*b, share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A sphere of 100 mm.
    fn sphere(rings: usize) -> Surface {
        let mut surface = Surface::default();
        let around = 2 * rings;
        for i in 0..=rings {
            let (sin, cos) = (PI * i as f64 / rings as f64).sin_cos();
            for k in 0..around {
                let (y, x) = (TAU * k as f64 / around as f64).sin_cos();
                surface.positions.push(DVec3::new(sin * x, sin * y, cos) * 100.0);
            }
        }
        let node = |i: usize, k: usize| (i * around + k % around) as u32;
        for (i, k) in (0..rings).flat_map(|i| (0..around).map(move |k| (i, k))) {
            let [a, b, c, d] = [node(i, k), node(i + 1, k), node(i + 1, k + 1), node(i, k + 1)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
        surface
    }

    #[test]
    fn lengths_along_a_sphere_are_those_of_great_circles() {
        let surface = sphere(90);
        let from = DVec3::new(0.3, -0.5, 0.6).normalize() * 100.0;
        for to in [[0.7, 0.2, 0.5], [-0.4, 0.3, 0.8], [0.31, -0.49, 0.6]] {
            let to = DVec3::from(to).normalize() * 100.0;
            let exact = 100.0 * from.angle_between(to);
            let found = along_skin(&surface, from, to).unwrap();
            assert!((found - exact).abs() < 2e-3 * exact.max(10.0), "{found} {exact}");
        }
        // Off the skin there is no way.
        assert_eq!(along_skin(&surface, from, DVec3::ZERO), None);
    }
}
