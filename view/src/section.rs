//! The section cut: the removed part of the tissue and the cut faces.
//!
//! Cut faces are exact: every prism of a slab (a triangle of the grid with thickness) is split into
//! three tetrahedra and cut by the plane into convex polygons in no particular order.

use crate::body::Body;
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

/// A point of a cut face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position \[mm\].
    pub position: Vec3,
    /// Place at rest \[cells\]: along the cut from the middle of the grid, and inwards from the outermost cells' outer face.
    /// The second is negative where the tissue has no cells.
    pub net: Vec2,
    /// Depth at rest below the outer surface \[mm\].
    pub depth_mm: f32,
}

impl Corner {
    fn lerp(self, other: Self, fraction: f32) -> Self {
        Self {
            position: self.position.lerp(other.position, fraction),
            net: self.net.lerp(other.net, fraction),
            depth_mm: self.depth_mm + (other.depth_mm - self.depth_mm) * fraction,
        }
    }
}

/// A triangle of a cut face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapTriangle {
    /// Corners, counter-clockwise seen from the removed part.
    pub corners: [Corner; 3],
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

impl Face {
    /// Distance in front of the plane \[mm\].
    fn side(&self, p: Vec3) -> f32 {
        self.normal.dot(p - self.axis)
    }
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

    /// The cut faces through all of the tissue.
    #[must_use]
    pub fn caps(&self, body: &Body) -> Vec<CapTriangle> {
        let mut caps = Vec::new();
        let axis = self.axis.extend(0.0);
        match (self.opening, self.planes()) {
            (_, None) => {}
            (Opening::Half, Some([normal, _])) => {
                cut(body, Face { axis, normal, along: None }, &mut caps);
            }
            (_, Some([a, b])) => {
                cut(body, Face { axis, normal: a, along: Some(b) }, &mut caps);
                cut(body, Face { axis, normal: b, along: Some(a) }, &mut caps);
            }
        }
        caps
    }
}

fn cut(body: &Body, face: Face, caps: &mut Vec<CapTriangle>) {
    let (Some(outer), Some(inner)) = (body.levels.first(), body.levels.last()) else {
        return;
    };
    // If all points of the columns of a triangle lie on one side, no slab is cut.
    let is_shown = |p: Vec3| face.along.is_none_or(|along| along.dot(p - face.axis) >= 0.0);
    let mut columns: Vec<Side> = outer.iter().map(|p| Side::of(face.side(*p))).collect();
    for level in &body.levels[1..] {
        for (column, p) in columns.iter_mut().zip(level) {
            if *column != Side::of(face.side(*p)) {
                *column = Side::Both;
            }
        }
    }
    let depths = depths_mm(body);
    let first_cells = body.slabs.iter().take_while(|slab| !slab.has_cells).count();
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
        let along = columns.map(|c| body.cells_along(c, face.normal));
        for (k, slab) in body.slabs.iter().enumerate() {
            let corners = |level: usize| {
                std::array::from_fn(|corner| Corner {
                    position: body.levels[level][columns[corner]],
                    net: match along[corner] {
                        Some(u) if slab.has_cells => Vec2::new(u, (level - first_cells) as f32),
                        _ => NO_NET,
                    },
                    depth_mm: depths[level],
                })
            };
            cut_prism(corners(k), corners(k + 1), slab.layer, face, caps);
        }
    }
}

/// Depths at rest of the levels below the outer surface \[mm\].
fn depths_mm(body: &Body) -> Vec<f32> {
    let mut depth = 0.0;
    let below = body.slabs.iter().map(|slab| {
        depth += slab.height_mm;
        depth
    });
    std::iter::once(0.0).chain(below).collect()
}

/// Place of a corner without cells.
const NO_NET: Vec2 = Vec2::new(0.0, -1.0e3);

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

/// Cuts the prism of a slab between two triangles.
fn cut_prism(
    top: [Corner; 3],
    low: [Corner; 3],
    layer: usize,
    face: Face,
    caps: &mut Vec<CapTriangle>,
) {
    let is_behind = |p: &&Corner| face.side(p.position) < 0.0;
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
fn slice(corners: [Corner; 4], face: Face) -> Vec<Corner> {
    let side = corners.map(|p| face.side(p.position));
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
fn keep_front(polygon: &[Corner], along: Vec3, axis: Vec3) -> Vec<Corner> {
    let side = |p: Corner| along.dot(p.position - axis);
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

fn fan(polygon: &[Corner], layer: usize, normal: Vec3, caps: &mut Vec<CapTriangle>) {
    for k in 2..polygon.len() {
        let mut corners = [polygon[0], polygon[k - 1], polygon[k]];
        let [a, b, c] = corners.map(|corner| corner.position);
        let area = (b - a).cross(c - a).dot(normal);
        if area < 0.0 {
            corners.swap(1, 2);
        }
        caps.push(CapTriangle { corners, layer, normal });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::both;

    fn area(caps: &[CapTriangle], layer: usize) -> f32 {
        caps.iter()
            .filter(|c| c.layer == layer)
            .map(|c| {
                let [a, b, c] = c.corners.map(|corner| corner.position);
                0.5 * (b - a).cross(c - a).length()
            })
            .sum()
    }

    #[test]
    fn a_closed_body_has_no_caps_and_a_cut_removes_points_in_front() {
        for (_, body) in both() {
            let mut section = Section { opening: Opening::Closed, angle: 0.3, axis: Vec2::ZERO };
            assert!(section.caps(&body).is_empty());
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
                let caps = section.caps(&body);
                for cap in &caps {
                    for corner in cap.corners {
                        assert!(cap.normal.dot(corner.position).abs() < 1e-3);
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

    #[test]
    fn the_depth_on_a_cut_face_is_that_of_the_layer_at_rest() {
        for (session, body) in both() {
            let section = Section { opening: Opening::Wedge, angle: 0.4, axis: Vec2::ZERO };
            let caps = section.caps(&body);
            let mut from = 0.0;
            for (layer, thickness) in
                session.scene().layers.iter().map(|l| l.thickness_mm as f32).enumerate()
            {
                let corners = caps.iter().filter(|c| c.layer == layer).flat_map(|c| c.corners);
                let (least, most) = corners.fold((f32::MAX, f32::MIN), |(least, most), corner| {
                    (least.min(corner.depth_mm), most.max(corner.depth_mm))
                });
                assert!((least - from).abs() < 1e-3, "{layer}: {least}");
                from += thickness;
                assert!((most - from).abs() < 1e-3, "{layer}: {most}");
            }
        }
    }

    #[test]
    fn the_net_of_a_cut_face_follows_the_cells_of_layered_tissue() {
        let [(layered, body), (_, sheet)] = both();
        let section = Section { opening: Opening::Half, angle: 0.4, axis: Vec2::ZERO };
        let has_net = |corner: &&Corner| corner.net.y > -0.5;
        assert!(!section.caps(&sheet).iter().flat_map(|cap| &cap.corners).any(|c| has_net(&c)));
        let cells = layered.solution().cells().len() as f32;
        let patch = layered.problem().sheet();
        let spacing = 2.0 * patch.radius_mm() as f32 / (patch.nodes_per_side() - 1) as f32;
        let direction = Vec2::from_angle(0.4).perp();
        let caps = section.caps(&body);
        let (mut least, mut most) = (f32::MAX, f32::MIN);
        for corner in caps.iter().flat_map(|cap| &cap.corners).filter(has_net) {
            (least, most) = (least.min(corner.net.y), most.max(corner.net.y));
            // Displacements beyond the pocket are small against a cell.
            let place = direction.dot(corner.position.truncate());
            if place.abs() > 100.0 {
                assert!((corner.net.x - place / spacing).abs() < 0.25, "{corner:?}");
            }
        }
        assert_eq!((least, most), (0.0, cells), "from the skin to the inner face");
        let skin = caps.iter().filter(|cap| cap.layer == 0).flat_map(|cap| &cap.corners);
        assert_eq!(skin.filter(has_net).count(), 0);
    }
}
