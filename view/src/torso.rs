//! A body around the tissue: the built-in torso with the computed skin on both sides. No patient's shape, and no part of the model.
//!
//! The torso's bare chest lies under the plan's wall at the pocket's centre. Each vertex within the patch moves as the computed skin at the
//! same place over the plane of the frame (the column's displacement, trilinear in its cell); the other side is the mirror image.

use crate::camera::Ball;
use crate::color::{self, Rgb};
use crate::mesh::{Mesh, NO_VALUE, Vertex, vertex};
use glam::{DMat3, DVec2, DVec3, Vec3};
use implant_preview_core::body::fit::{Settings, fit};
use implant_preview_core::body::frame::Frame;
use implant_preview_core::body::grid::smooth_step;
use implant_preview_core::body::marks::Side;
use implant_preview_core::body::torso::{self, Tape};
use implant_preview_core::measure::{Field, Fields};
use std::sync::Arc;

/// Volume of the drawn breast before the operation \[ml\]: the tissue over the implant is that of the plan.
const VOLUME_ML: f64 = 130.0;
/// From the notch to the nipple of that breast on the trunk as it is stored \[mm\].
const NOTCH_NIPPLE_MM: f64 = 201.6;
/// Distance from the fitted skin within which a vertex is skin of the breast's side, not of flank or arm, and its end \[mm\].
const NEAR_MM: [f64; 2] = [15.0, 30.0];
/// The second coordinate on the net of a vertex without net, less the part of the colour of a quantity in its colour, 0 to 1; the first
/// is the distance from the nipple \[mm\].
const NO_NET: f32 = -1.0;
/// Width at the patch's border over which the colour of a quantity becomes that of the skin \[mm\].
const FADE_MM: f64 = 25.0;
/// Steps from a place over the plane to a place along the wall.
const STEPS: usize = 4;
/// The part of the torso's extent that a camera shows \[-\].
const SHOWN: f32 = 0.52;

/// The built-in torso in the coordinates of a plan.
#[derive(Debug)]
pub struct Torso {
    /// Vertices \[mm\] in the coordinates of the tissue.
    positions: Vec<DVec3>,
    indices: Arc<Vec<u32>>,
    /// Colour of the skin; distances from the nearest nipple \[mm\].
    color: Rgb,
    from_nipple: Vec<f32>,
    /// Vertices that move with the skin, on the own side, then on the other.
    moved: [Vec<Moved>; 2],
    /// From the coordinates of each side's frame to those of the picture.
    turns: [DMat3; 2],
    /// Middle \[mm\], and half of the extent.
    middle: Vec3,
    radius_mm: f32,
    /// Angle of the front about the axis towards the head \[radians\].
    azimuth: f32,
}

/// A vertex of a side.
#[derive(Clone, Copy, Debug)]
struct Moved {
    vertex: u32,
    /// Its place over the plane of the side's frame \[mm\].
    place: DVec2,
    /// The part of the skin's displacement that it takes \[-\].
    share: f64,
}

impl Torso {
    /// The torso; `None` if no chest is found under its breast, which no built-in torso has.
    #[must_use]
    pub fn new() -> Option<Self> {
        let tape =
            Tape { breast_volume_ml: VOLUME_ML, notch_nipple_mm: NOTCH_NIPPLE_MM, ..Tape::OWN };
        let (body, _) = torso::shaped(&tape).ok()?;
        let settings = Settings::default();
        let own = fit(&body.surface, &body.marks, Side::Left, &settings).ok()?;
        // Both halves are mirror images.
        let hands = [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0)];
        let moved = hands.map(|hand| {
            let reach = settings.patch_radius_mm;
            let of = |(k, at): (usize, &DVec3)| {
                let local = own.frame.local(*at * hand);
                let place = local.truncate();
                let apart = (local.z - own.grid.value(&own.skin_mm, place)).abs();
                let share = smooth_step((NEAR_MM[1] - apart) / (NEAR_MM[1] - NEAR_MM[0]));
                let is_within = place.length() < reach && share > 0.0;
                is_within.then_some(Moved { vertex: k as u32, place, share })
            };
            body.surface.positions.iter().enumerate().filter_map(of).collect()
        });
        let frame = upright(&own.frame);
        let positions: Vec<DVec3> =
            body.surface.positions.iter().map(|at| frame.local(*at)).collect();
        let nipples = body.marks.nipples.map(|at| frame.local(at).as_vec3());
        let away = |at: &DVec3| {
            let [left, right] = nipples.map(|nipple| nipple.distance(at.as_vec3()));
            left.min(right)
        };
        let from_nipple = positions.iter().map(away).collect();
        let front = frame.axes.transpose() * DVec3::Z;
        let (least, most) = positions
            .iter()
            .fold((DVec3::MAX, DVec3::MIN), |(least, most), at| (least.min(*at), most.max(*at)));
        Some(Self {
            indices: Arc::new(body.surface.triangles.as_flattened().to_vec()),
            color: color::tissue("skin", 0),
            from_nipple,
            moved,
            turns: hands
                .map(|hand| frame.axes.transpose() * DMat3::from_diagonal(hand) * own.frame.axes),
            middle: (0.5 * (least + most)).as_vec3(),
            radius_mm: SHOWN * (most - least).truncate().max_element() as f32,
            azimuth: front.x.atan2(front.z) as f32,
            positions,
        })
    }

    /// What a camera shows, its middle, and the angle of the front about the axis towards the head \[radians\].
    #[must_use]
    pub fn seen(&self) -> (Ball, Vec3, f32) {
        (Ball::from(self.radius_mm), self.middle, self.azimuth)
    }

    /// The torso with the skin of a shape, or with a part of the way to another shape \[-\], in the colours of a field.
    #[must_use]
    pub fn mesh(
        &self,
        fields: &Fields,
        toward: Option<(&Fields, f32)>,
        field: Option<Field>,
    ) -> Mesh {
        let skin = Skin::new(fields, toward, field);
        let mut positions = self.positions.clone();
        let value = if field.is_some() { 0.0 } else { NO_VALUE };
        let mut values = vec![[value, 0.0]; positions.len()];
        let border = fields.solution().problem().sheet().radius_mm();
        for (side, moved) in self.moved.iter().enumerate() {
            for &Moved { vertex, place, share } in moved {
                let (move_mm, value) = skin.at(place);
                positions[vertex as usize] += share * (self.turns[side] * move_mm);
                // Where both patches overlap, that of the nearer pocket counts.
                let part = (share * smooth_step((border - place.length()) / FADE_MM)) as f32;
                let own = &mut values[vertex as usize];
                if let Some(value) = value.filter(|_| part > own[1]) {
                    *own = [value, part];
                }
            }
        }
        let normals = self.normals(&positions);
        let of = |k: usize| -> Vertex {
            let [value, part] = values[k];
            let grid = [self.from_nipple[k], NO_NET - part];
            vertex(positions[k].as_vec3(), normals[k], grid, value, self.color)
        };
        Mesh {
            vertices: (0..positions.len()).map(of).collect(),
            indices: Arc::clone(&self.indices),
        }
    }

    /// Area-weighted normals.
    fn normals(&self, positions: &[DVec3]) -> Vec<Vec3> {
        let mut sums = vec![DVec3::ZERO; positions.len()];
        for triangle in self.indices.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|k| positions[k as usize]);
            let normal = (b - a).cross(c - a);
            for k in triangle {
                sums[*k as usize] += normal;
            }
        }
        sums.into_iter().map(|sum| sum.normalize_or(DVec3::Z).as_vec3()).collect()
    }
}

/// The frame turned about its x until its y is the body's axis towards the head: a standing patient is upright.
fn upright(frame: &Frame) -> Frame {
    let front = frame.axes.z_axis.with_y(0.0).normalize_or(DVec3::Z);
    Frame { axes: DMat3::from_cols(DVec3::Y.cross(front), DVec3::Y, front), ..*frame }
}

/// The skin of a shape over its grid.
struct Skin<'a> {
    fields: &'a Fields,
    toward: Option<(&'a Fields, f32)>,
    field: Option<Field>,
    /// Reciprocal spacing \[1/mm\], nodes a side.
    per_spacing: f64,
    side: usize,
}

impl<'a> Skin<'a> {
    fn new(fields: &'a Fields, toward: Option<(&'a Fields, f32)>, field: Option<Field>) -> Self {
        let sheet = fields.solution().problem().sheet();
        let (per_spacing, side) = (1.0 / sheet.spacing_mm(), sheet.nodes_per_side());
        Self { fields, toward, field, per_spacing, side }
    }

    /// The nodes of the cell at a place along the wall, and their weights.
    fn cell(&self, along: DVec2) -> [(usize, f64); 4] {
        let most = (self.side - 1) as f64;
        let at = along * self.per_spacing + DVec2::splat(0.5 * most);
        let at = at.clamp(DVec2::ZERO, DVec2::splat(most));
        let low = at.floor().min(DVec2::splat(most - 1.0));
        let (t, k) = (at - low, low.y as usize * self.side + low.x as usize);
        [
            (k, (1.0 - t.x) * (1.0 - t.y)),
            (k + 1, t.x * (1.0 - t.y)),
            (k + self.side, (1.0 - t.x) * t.y),
            (k + self.side + 1, t.x * t.y),
        ]
    }

    /// Displacement \[mm\] and value at a place over the plane.
    fn at(&self, place: DVec2) -> (DVec3, Option<f32>) {
        let problem = self.fields.solution().problem();
        if place.length() >= problem.sheet().radius_mm() {
            return (DVec3::ZERO, None);
        }
        // The skin at rest over that place is another place along a curved wall.
        let rest = |k: usize| problem.rest.node(problem.rest.layers() - 1, k);
        let mut along = place;
        for _ in 0..STEPS {
            let above: DVec3 = self.cell(along).into_iter().map(|(k, w)| w * rest(k)).sum();
            along += place - above.truncate();
        }
        let cell = self.cell(along);
        let moved = |k: usize| {
            let here = self.top(self.fields, k);
            let to = self
                .toward
                .map_or(here, |(to, part)| here + f64::from(part) * (self.top(to, k) - here));
            to - rest(k)
        };
        let move_mm = cell.into_iter().map(|(k, w)| w * moved(k)).sum();
        let value = self.field.and_then(|field| {
            let own = self.fields.values(field);
            let to = self.toward.map(|(to, part)| (to.values(field), part));
            let value = |k: usize| {
                let here = own.get(k).copied()?;
                let there = to.and_then(|(to, part)| Some(part * (to.get(k)? - here)));
                Some(f64::from(here + there.unwrap_or(0.0)))
            };
            let parts = cell.into_iter().map(|(k, w)| Some(w * value(k)?));
            parts.sum::<Option<f64>>().map(|value| value as f32)
        });
        (move_mm, value)
    }

    /// The outermost node of a column.
    fn top(&self, fields: &Fields, node: usize) -> DVec3 {
        let solution = fields.solution();
        solution.outer().last().map_or(solution.inner()[node], |layer| layer[node])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::scene::{CheckedScene, Scene};
    use implant_preview_core::simulate::run;
    use implant_preview_core::solve::Options;

    fn fields(insertion: f64) -> Fields {
        let mut scene = Scene { insertion, ..Scene::default() };
        scene.solver.nodes_per_side = 33;
        let scene = CheckedScene::new(scene).unwrap();
        Fields::new(run(&scene, Options::default(), None).solution)
    }

    fn positions(mesh: &Mesh) -> Vec<Vec3> {
        mesh.vertices.iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect()
    }

    #[test]
    fn without_an_implant_the_torso_stays_and_with_one_both_breasts_rise_alike() {
        let torso = Torso::new().unwrap();
        let [flat, full] =
            [0.0, 1.0].map(|insertion| positions(&torso.mesh(&fields(insertion), None, None)));
        let rest: Vec<Vec3> = torso.positions.iter().map(|at| at.as_vec3()).collect();
        let greatest =
            |of: &[Vec3]| of.iter().zip(&rest).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(greatest(&flat) < 0.05, "{}", greatest(&flat));
        assert!((15.0..70.0).contains(&greatest(&full)), "{}", greatest(&full));
        // Away from the patches every vertex stays to the last bit.
        let moved: std::collections::HashSet<u32> =
            torso.moved.iter().flatten().map(|moved| moved.vertex).collect();
        for (k, (at, rest)) in full.iter().zip(&rest).enumerate() {
            assert!(moved.contains(&(k as u32)) || at == rest);
        }
        let rise = |side: usize| {
            let way = |m: &Moved| full[m.vertex as usize].distance(rest[m.vertex as usize]);
            torso.moved[side].iter().map(way).fold(0.0, f32::max)
        };
        assert!((rise(0) - rise(1)).abs() < 0.01 * rise(0), "{} {}", rise(0), rise(1));
    }

    /// The normals of neighbours across the patch's border turn by no more than those of the torso at rest, and 2°.
    #[test]
    fn the_skin_passes_the_border_of_the_patch_without_a_seam() {
        let torso = Torso::new().unwrap();
        let normals = |mesh: &Mesh| -> Vec<Vec3> {
            mesh.vertices.iter().map(|v| Vec3::new(v[3], v[4], v[5])).collect()
        };
        let rest = torso.normals(&torso.positions);
        let full = normals(&torso.mesh(&fields(1.0), None, None));
        let other: std::collections::HashSet<u32> =
            torso.moved[1].iter().map(|m| m.vertex).collect();
        let turned = torso.moved[0]
            .iter()
            .filter(|m| m.place.length() > 118.0 && m.share > 0.99 && !other.contains(&m.vertex));
        let turned: Vec<f32> = turned
            .map(|m| rest[m.vertex as usize].angle_between(full[m.vertex as usize]).to_degrees())
            .collect();
        assert!(turned.len() > 40, "{}", turned.len());
        assert!(
            turned.iter().all(|angle| *angle < 2.0),
            "{:?}",
            turned.iter().copied().fold(0.0, f32::max)
        );
    }
}
