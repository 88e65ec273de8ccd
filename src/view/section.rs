//! The section cut: the removed part of the tissue and the cut faces.
//!
//! Cut faces are exact: every prism of a layer (a sheet triangle with thickness) is split into
//! three tetrahedra and cut by the plane into convex polygons in no particular order.

use crate::view::body::Body;
use glam::{Vec2, Vec3};

/// Shape of the removed part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Opening {
    /// Nothing is removed.
    Closed,
    /// A quarter is removed.
    #[default]
    Wedge,
    /// One half is removed.
    Half,
}

/// The cut: vertical planes through an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Shape of the removed part.
    pub opening: Opening,
    /// Direction of the middle of the removed part \[radians\], from +x counter-clockwise.
    pub angle: f32,
    /// The axis on the wall \[mm\].
    pub axis: Vec2,
}

/// A triangle of a cut face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapTriangle {
    /// Corners \[mm\], counter-clockwise seen from the removed part.
    pub corners: [Vec3; 3],
    /// Index of the layer, from the skin inwards.
    pub layer: usize,
    /// Unit normal, pointing into the removed part.
    pub normal: Vec3,
}

/// One plane of the cut: points with `normal · (p − axis) = 0` and, with `along`, `along · (p − axis) ≥ 0`.
#[derive(Clone, Copy, Debug)]
struct Face {
    axis: Vec3,
    normal: Vec3,
    along: Option<Vec3>,
}

impl Section {
    /// The normals of the two planes (equal normals for a half): points in front of both planes are removed. `None`
    /// if closed.
    #[must_use]
    pub fn planes(&self) -> Option<[Vec3; 2]> {
        let direction = |angle: f32| Vec3::new(angle.cos(), angle.sin(), 0.0);
        match self.opening {
            Opening::Closed => None,
            Opening::Wedge => {
                let quarter = std::f32::consts::FRAC_PI_4;
                Some([direction(self.angle - quarter), direction(self.angle + quarter)])
            }
            Opening::Half => Some([direction(self.angle); 2]),
        }
    }

    /// Is a point in the removed part?
    #[must_use]
    pub fn removes(&self, point: Vec3) -> bool {
        let from_axis = point - self.axis.extend(0.0);
        self.planes().is_some_and(|planes| planes.iter().all(|n| n.dot(from_axis) > 0.0))
    }

    /// The cut faces through every layer from `first_layer` inwards.
    #[must_use]
    pub fn caps(&self, body: &Body, first_layer: usize) -> Vec<CapTriangle> {
        let mut caps = Vec::new();
        let axis = self.axis.extend(0.0);
        match (self.opening, self.planes()) {
            (_, None) => {}
            (Opening::Half, Some([normal, _])) => {
                cut(body, first_layer, Face { axis, normal, along: None }, &mut caps);
            }
            (_, Some([a, b])) => {
                cut(body, first_layer, Face { axis, normal: a, along: Some(b) }, &mut caps);
                cut(body, first_layer, Face { axis, normal: b, along: Some(a) }, &mut caps);
            }
        }
        caps
    }
}

fn cut(body: &Body, first_layer: usize, face: Face, caps: &mut Vec<CapTriangle>) {
    let (Some(outer), Some(inner)) = (body.levels.get(first_layer), body.levels.last()) else {
        return;
    };
    // If all points of the columns of a triangle lie on one side, no layer is cut.
    let side = |p: Vec3| face.normal.dot(p - face.axis);
    let is_shown = |p: Vec3| face.along.is_none_or(|along| along.dot(p - face.axis) >= 0.0);
    let mut columns: Vec<Side> = outer.iter().map(|p| Side::of(side(*p))).collect();
    for level in &body.levels[first_layer + 1..] {
        for (column, p) in columns.iter_mut().zip(level) {
            if *column != Side::of(side(*p)) {
                *column = Side::Both;
            }
        }
    }
    for &triangle in &body.triangles {
        let [a, b, c] = triangle.map(|c| columns[c as usize]);
        if a == b && b == c && a != Side::Both {
            continue;
        }
        if !triangle.iter().any(|&c| is_shown(outer[c as usize]) || is_shown(inner[c as usize])) {
            continue;
        }
        let mut columns = triangle.map(|c| c as usize);
        columns.sort_unstable();
        for layer in first_layer..body.layers() {
            let top = columns.map(|c| body.levels[layer][c]);
            let low = columns.map(|c| body.levels[layer + 1][c]);
            cut_prism(top, low, layer, face, caps);
        }
    }
}

/// Side of a plane on which a column lies.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Front,
    Back,
    Both,
}

impl Side {
    fn of(distance: f32) -> Self {
        if distance < 0.0 { Self::Back } else { Self::Front }
    }
}

/// Cuts the prism of a layer between two triangles.
fn cut_prism(
    top: [Vec3; 3],
    low: [Vec3; 3],
    layer: usize,
    face: Face,
    caps: &mut Vec<CapTriangle>,
) {
    let is_behind = |p: &&Vec3| face.normal.dot(**p - face.axis) < 0.0;
    let behind = top.iter().chain(&low).filter(is_behind).count();
    if behind == 0 || behind == 6 {
        return;
    }
    // Diagonals run from the column of lower index below to the column of higher index above: adjacent prisms have
    // equal diagonals.
    for tetrahedron in [
        [low[0], low[1], low[2], top[2]],
        [low[0], low[1], top[1], top[2]],
        [low[0], top[0], top[1], top[2]],
    ] {
        let polygon = slice(tetrahedron, face);
        let polygon = match face.along {
            Some(along) => keep_front(&polygon, along, face.axis),
            None => polygon,
        };
        fan(&polygon, layer, face.normal, caps);
    }
}

/// The intersection of the plane and a tetrahedron: a convex polygon of 0, 3 or 4 corners, in order.
fn slice(corners: [Vec3; 4], face: Face) -> Vec<Vec3> {
    let side = corners.map(|p| face.normal.dot(p - face.axis));
    let (front, back): (Vec<usize>, Vec<usize>) = (0..4).partition(|&k| side[k] >= 0.0);
    let crossing = |a: usize, b: usize| corners[a].lerp(corners[b], side[a] / (side[a] - side[b]));
    match (&front[..], &back[..]) {
        ([a], others) | (others, [a]) if others.len() == 3 => {
            others.iter().map(|&b| crossing(*a, b)).collect()
        }
        ([a, b], [c, d]) => {
            vec![crossing(*a, *c), crossing(*a, *d), crossing(*b, *d), crossing(*b, *c)]
        }
        _ => Vec::new(),
    }
}

/// The part of a convex polygon with `along · (p − axis) ≥ 0`.
fn keep_front(polygon: &[Vec3], along: Vec3, axis: Vec3) -> Vec<Vec3> {
    let side = |p: Vec3| along.dot(p - axis);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (at_a, at_b) = (side(a), side(b));
        if at_a >= 0.0 {
            kept.push(a);
        }
        if (at_a >= 0.0) != (at_b >= 0.0) {
            kept.push(a.lerp(b, at_a / (at_a - at_b)));
        }
    }
    kept
}

fn fan(polygon: &[Vec3], layer: usize, normal: Vec3, caps: &mut Vec<CapTriangle>) {
    for k in 2..polygon.len() {
        let mut corners = [polygon[0], polygon[k - 1], polygon[k]];
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(normal);
        if area < 0.0 {
            corners.swap(1, 2);
        }
        caps.push(CapTriangle { corners, layer, normal });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::body::tests::both;

    fn area(caps: &[CapTriangle], layer: usize) -> f32 {
        caps.iter()
            .filter(|c| c.layer == layer)
            .map(|c| {
                0.5 * (c.corners[1] - c.corners[0]).cross(c.corners[2] - c.corners[0]).length()
            })
            .sum()
    }

    #[test]
    fn a_closed_body_has_no_caps_and_a_cut_removes_points_in_front() {
        for (_, body) in both() {
            let mut section = Section { opening: Opening::Closed, angle: 0.3, axis: Vec2::ZERO };
            assert!(section.caps(&body, 0).is_empty());
            assert!(!section.removes(Vec3::new(30.0, 10.0, 20.0)));
            section.opening = Opening::Wedge;
            assert!(section.removes(Vec3::new(30.0, 10.0, 20.0)));
            assert!(!section.removes(Vec3::new(-30.0, 10.0, 20.0)));
            section.opening = Opening::Half;
            assert!(section.removes(Vec3::new(1.0, 30.0, 20.0)));
        }
    }

    #[test]
    fn cut_faces_lie_in_their_plane_with_an_area_independent_of_the_angle() {
        for (_, body) in both() {
            let faces = |opening, angle| {
                let section = Section { opening, angle, axis: Vec2::ZERO };
                let caps = section.caps(&body, 0);
                for cap in &caps {
                    for corner in cap.corners {
                        assert!(cap.normal.dot(corner).abs() < 1e-3);
                    }
                }
                [0, 1].map(|layer| area(&caps, layer))
            };
            let half = faces(Opening::Half, 0.0);
            let turned = faces(Opening::Half, 0.4);
            let wedge = faces(Opening::Wedge, 0.0);
            for layer in 0..2 {
                assert!(half[layer] > 100.0);
                assert!((turned[layer] / half[layer] - 1.0).abs() < 0.02, "{half:?} {turned:?}");
                assert!((wedge[layer] / half[layer] - 1.0).abs() < 0.02, "{half:?} {wedge:?}");
            }
        }
    }
}
