//! Points of the tissue that move with the tissue, and lengths between two of them: straight, along the skin, at rest.

use crate::body::Body;
use glam::{DVec2, Vec2, Vec3};
use implant_preview_core::mesh::Sheet;

/// Three nodes of a triangle with their weights, which sum to 1.
pub type Nodes = [(usize, f32); 3];

/// A point of the tissue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position at rest, from the pocket's centre \[mm\].
    pub rest: Vec2,
    /// Depth \[levels of the body\]: 0 on the skin.
    pub depth: f32,
}

impl Place {
    /// The point of three nodes at a depth.
    #[must_use]
    pub fn new(nodes: &Nodes, depth: f32, sheet: &Sheet) -> Self {
        let rest =
            |&(k, w): &(usize, f32)| sheet.rest().get(k).map_or(Vec2::ZERO, |p| p.as_vec2() * w);
        Self { rest: nodes.iter().map(rest).sum(), depth }
    }

    /// The point's triangle in a sheet; `None` beyond the sheet.
    #[must_use]
    pub fn nodes(&self, sheet: &Sheet) -> Option<Nodes> {
        let n = sheet.nodes_per_side();
        let half = (n / 2) as f64;
        let rest = self.rest.as_dvec2();
        let at = rest / sheet.spacing_mm() + DVec2::splat(half);
        let near = |v: f64| {
            let cell = v.floor().clamp(0.0, (n - 2) as f64) as usize;
            cell.saturating_sub(1)..=(cell + 1).min(n - 2)
        };
        // Nodes on the circle are moved by less than a cell.
        let cells = near(at.y).flat_map(|j| near(at.x).map(move |i| (i, j)));
        let triangles = cells.flat_map(|(i, j)| sheet.cell_triangles(i, j));
        let weighed = triangles.filter_map(|(corners, _)| {
            let weights = weights(corners.map(|k| sheet.rest()[k]), rest)?;
            let least = weights.into_iter().fold(f64::INFINITY, f64::min);
            Some((least, std::array::from_fn(|k| (corners[k], weights[k] as f32))))
        });
        let best = weighed.max_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(least, _)| *least > -1e-3).map(|(_, nodes)| nodes)
    }

    /// The point in the deformed tissue \[mm\].
    #[must_use]
    pub fn position(&self, sheet: &Sheet, body: &Body) -> Option<Vec3> {
        let nodes = self.nodes(sheet).filter(|_| body.nodes_per_side == sheet.nodes_per_side())?;
        let last = body.levels.len().checked_sub(1)?;
        let depth = self.depth.clamp(0.0, last as f32);
        let above = (depth.floor() as usize).min(last);
        let below = (above + 1).min(last);
        let on = |level: usize| {
            nodes
                .iter()
                .map(|&(k, w)| body.levels[level].get(k).map(|p| *p * w))
                .sum::<Option<Vec3>>()
        };
        Some(on(above)?.lerp(on(below)?, depth - above as f32))
    }
}

/// Barycentric weights of a point; `None` in a triangle without area.
fn weights([a, b, c]: [DVec2; 3], p: DVec2) -> Option<[f64; 3]> {
    let area = (b - a).perp_dot(c - a);
    let of = |q: DVec2, r: DVec2| (q - p).perp_dot(r - p) / area;
    (area.abs() > 0.0).then(|| [of(b, c), of(c, a), of(a, b)])
}

/// The column of the sheet nearest to a point, and the point's depth there \[levels\].
#[must_use]
pub fn nearest_column(body: &Body, point: Vec3) -> Option<(usize, f32)> {
    let mut nearest: Option<(f32, usize, f32)> = None;
    for (level, pair) in body.levels.windows(2).enumerate() {
        let columns = pair[0].iter().zip(&pair[1]).take(body.node_columns).enumerate();
        for (column, (outer, inner)) in columns {
            let along = *inner - *outer;
            let length = along.length_squared();
            let fraction = if length > 0.0 { (point - *outer).dot(along) / length } else { 0.0 };
            let fraction = fraction.clamp(0.0, 1.0);
            let distance = (point - (*outer + along * fraction)).length_squared();
            if nearest.is_none_or(|(least, ..)| distance < least) {
                nearest = Some((distance, column, level as f32 + fraction));
            }
        }
    }
    nearest.map(|(_, column, depth)| (column, depth))
}

/// A line on the skin between two points, without an order of its parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinLine {
    /// Parts of the line \[mm\].
    pub parts: Vec<[Vec3; 2]>,
    /// Length of all parts \[mm\].
    pub length_mm: f32,
}

/// The section of a surface by the vertical plane through two of its points, between the points: near the shortest line
/// on the surface, and never shorter.
#[must_use]
pub fn along_skin(points: &[Vec3], triangles: &[[u32; 3]], [a, b]: [Vec3; 2]) -> SkinLine {
    let across = (b - a).truncate();
    let length = across.length();
    if length < 1e-4 {
        return SkinLine { parts: vec![[a, b]], length_mm: (b - a).length() };
    }
    let along = across / length;
    let place = |p: Vec3| along.dot((p - a).truncate());
    let side = |p: Vec3| along.perp_dot((p - a).truncate());
    let mut line = SkinLine::default();
    for triangle in triangles {
        let corners = triangle.map(|k| points[k as usize]);
        let sides = corners.map(side);
        // Corners on the plane count as in front: an edge in the plane belongs to one triangle.
        let is_front = sides.map(|s| s >= 0.0);
        let crossings = (0..3).filter_map(|k| {
            let next = (k + 1) % 3;
            (is_front[k] != is_front[next])
                .then(|| corners[k].lerp(corners[next], sides[k] / (sides[k] - sides[next])))
        });
        let ends: Vec<Vec3> = crossings.collect();
        if let [p, q] = ends[..]
            && let Some(part) = between([p, q], [place(p), place(q)], length)
        {
            line.length_mm += part[0].distance(part[1]);
            line.parts.push(part);
        }
    }
    line
}

/// The part of a segment whose places are in 0 to `length`.
fn between([p, q]: [Vec3; 2], [from, to]: [f32; 2], length: f32) -> Option<[Vec3; 2]> {
    let (least, most) = (from.min(to), from.max(to));
    if most <= 0.0 || least >= length {
        return None;
    }
    let at = |place: f32| {
        let extent = to - from;
        if extent.abs() < 1e-9 { p } else { p.lerp(q, (place - from) / extent) }
    };
    Some([at(from.clamp(0.0, length)), at(to.clamp(0.0, length))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::both;

    /// A surface over a grid of a spacing of 1 mm, from −`half` to `half`.
    fn surface(half: i32, height: impl Fn(f32, f32) -> f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let n = (2 * half + 1) as u32;
        let at = |k: u32| (k as i32 - half) as f32;
        let points = (0..n * n).map(|k| (at(k % n), at(k / n)));
        let points = points.map(|(x, y)| Vec3::new(x, y, height(x, y))).collect();
        let cells = (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| j * n + i));
        let triangles = cells.flat_map(|k| [[k, k + 1, k + n + 1], [k, k + n + 1, k + n]]);
        (points, triangles.collect())
    }

    #[test]
    fn on_a_plane_the_way_along_the_skin_is_the_straight_one() {
        let (points, triangles) = surface(20, |x, y| 0.5 * x - 0.25 * y);
        let on = |x: f32, y: f32| Vec3::new(x, y, 0.5 * x - 0.25 * y);
        for (a, b) in [
            (on(-11.3, 2.2), on(14.1, 7.9)),
            // Along edges of the grid, and along its diagonals.
            (on(-10.0, 0.0), on(10.0, 0.0)),
            (on(3.0, -10.0), on(3.0, 8.5)),
            (on(-6.0, -6.0), on(6.0, 6.0)),
        ] {
            let line = along_skin(&points, &triangles, [a, b]);
            assert!((line.length_mm - a.distance(b)).abs() < 1e-3, "{} {a} {b}", line.length_mm);
        }
        let there = along_skin(&points, &triangles, [on(1.0, 1.0), on(1.0, 1.0)]);
        assert!(there.length_mm.abs() < 1e-6);
    }

    #[test]
    fn over_a_sphere_the_way_along_the_skin_is_radius_times_angle() {
        let radius = 50.0_f32;
        let height = |x: f32, y: f32| (radius * radius - x * x - y * y).max(0.0).sqrt();
        let (points, triangles) = surface(40, height);
        for (direction, angle) in [(0.0_f32, 0.9_f32), (0.3, 1.2), (0.785, 0.5)] {
            // A great circle through the apex is a vertical section.
            let on = |angle: f32| {
                let (across, up) = (radius * angle.sin(), radius * angle.cos());
                (Vec2::from_angle(direction) * across).extend(up)
            };
            let line = along_skin(&points, &triangles, [on(-0.5 * angle), on(0.5 * angle)]);
            let arc = radius * angle;
            // Chords of 1 mm are shorter than their arcs by 1 / (24 · 50²).
            assert!((line.length_mm / arc - 1.0).abs() < 1e-3, "{} {arc}", line.length_mm);
            assert!(line.length_mm > 2.0 * radius * (0.5 * angle).sin());
        }
    }

    #[test]
    fn a_place_moves_with_the_tissue_and_is_found_on_any_grid() {
        for (session, body) in both() {
            let sheet = session.problem().sheet();
            let triangle = body.triangles[400];
            let nodes = [0, 1, 2].map(|k| (triangle[k] as usize, [0.5, 0.3, 0.2][k]));
            let place = Place::new(&nodes, 0.0, sheet);
            let at = place.position(sheet, &body).expect("the point is in the tissue");
            let expected: Vec3 = nodes.iter().map(|&(k, w)| body.levels[0][k] * w).sum();
            assert!((at - expected).length() < 1e-2, "{at} {expected}");
            let finer = Sheet::new(129, sheet.radius_mm());
            let found = place.nodes(&finer).expect("the point is in the tissue");
            let again = Place::new(&found, 0.0, &finer);
            assert!((again.rest - place.rest).length() < 1e-3);
            let beyond = Place { rest: Vec2::new(2.0 * sheet.radius_mm() as f32, 0.0), depth: 0.0 };
            assert_eq!(beyond.nodes(sheet), None);
        }
    }

    #[test]
    fn a_point_in_the_tissue_has_its_column_and_depth() {
        for (_, body) in both() {
            let column = 16 * 33 + 20;
            let (outer, inner) = (body.levels[0][column], body.levels[1][column]);
            let (found, depth) =
                nearest_column(&body, outer.lerp(inner, 0.25)).expect("the point is in the tissue");
            assert_eq!(found, column);
            assert!((depth - 0.25).abs() < 1e-3);
        }
        assert_eq!(nearest_column(&Body::default(), Vec3::ZERO), None);
    }
}
