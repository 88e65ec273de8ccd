//! A body around the tissue, drawn with the computed skin: her own surface, or the built-in torso, which is no patient's shape. No part of
//! the model.
//!
//! The built-in torso of a plan with another chest has its bare chest under the plan's wall at the pocket's centre, and each of its vertices within the patch moves as the computed skin
//! over the same place of the plane; the other side is the mirror image, or has a plan of its own. Each vertex of a fitted surface moves with the columns at its own
//! depth, as in [`implant_preview_core::body::deform`].

use crate::camera::{Ball, Ray};
use crate::color::{self, Rgb};
use crate::mesh::{Mesh, NO_VALUE, Vertex, vertex};
use crate::pick;
use glam::{DMat3, DVec3, Vec3};
use implant_preview_core::body::deform::{Columns, Moves, Weights};
use implant_preview_core::body::fit::{BodyFit, Settings};
use implant_preview_core::body::frame::Frame;
use implant_preview_core::body::grid::smooth_step;
use implant_preview_core::body::marks::Marks;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::body::torso;
use implant_preview_core::measure::{Field, Fields};
use implant_preview_core::mesh::Rest;
use implant_preview_core::scene::{self, FittedTorso};
use implant_preview_core::solve::Problem;
use std::sync::Arc;

/// Distance from the fitted skin within which a vertex is skin of the breast's side, not of flank or arm, and its end \[mm\].
const NEAR_MM: [f64; 2] = [15.0, 30.0];
/// The second coordinate on the net of a vertex without net, less the part of the colour of a quantity in its colour, 0 to 1; the first
/// is the distance from the nipple \[mm\].
const NO_NET: f32 = -1.0;
/// Distance from the nipple of a vertex without an areola to draw \[mm\].
const NO_NIPPLE: f32 = 1e6;
/// Width at the patch's border over which the colour of a quantity becomes that of the skin \[mm\].
const FADE_MM: f64 = 25.0;
/// Share of a column's height between which the colour of the skin comes to show \[-\]: where the body leaves the fitted skin, at the flank, a narrower range
/// would be ragged from vertex to vertex.
const SKIN_SHARE: [f64; 2] = [0.6, 0.9];
/// The share of a vertex beyond the patch; means over neighbours that even the shares.
const UNKNOWN: f32 = -1.0;
const EVENINGS: usize = 4;
/// The part of the built-in torso's extent that a camera shows \[-\].
const SHOWN: f32 = 0.52;
/// The radius that a camera shows over the distance from notch to navel \[-\]: that of the built-in torso.
const SHOWN_OF_TRUNK: f32 = 0.78;

/// A body in the coordinates of a plan, upright.
#[derive(Debug)]
pub struct Torso {
    /// The body before.
    before: Arc<Mesh>,
    /// Its normals before they are softened.
    normals: Vec<Vec3>,
    /// Vertices that may move.
    points: Vec<Point>,
    /// Does each point move with the skin over its place, whatever its depth?
    is_skin: bool,
    /// Are both sides alike, so that one plan moves both?
    is_alike: bool,
    /// From the coordinates of each side's frame to those of the picture.
    turns: Vec<DMat3>,
    /// From the coordinates of the surface to those of the picture.
    frame: Frame,
    /// Middle \[mm\], and half of the extent.
    middle: Vec3,
    radius_mm: f32,
    /// Angle of the front about the axis towards the head \[radians\].
    azimuth: f32,
}

/// A vertex that may move.
#[derive(Clone, Copy, Debug)]
struct Point {
    vertex: u32,
    /// Its side in `turns`.
    side: usize,
    /// Its place in the side's frame \[mm\].
    place: DVec3,
    /// The part of the displacement that it takes \[-\].
    share: f64,
    /// Is its side's pocket the nearest one? It takes the colour of a quantity from that side.
    is_nearest: bool,
}

/// How the vertices of a body move with the columns of a tissue at rest.
#[derive(Debug)]
pub struct Attached {
    rest: Rest,
    /// The side whose vertices these are; `None`: one tissue for all sides.
    of_side: Option<usize>,
    /// Vertices that move.
    moved: Vec<Moved>,
    turned: Around,
    softened: Around,
}

/// Vertices whose normals, or softened normals, change, and the triangles around them.
#[derive(Debug)]
struct Around {
    vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// A vertex that moves.
#[derive(Clone, Copy, Debug)]
struct Moved {
    vertex: u32,
    /// Its side in `turns`.
    side: usize,
    weights: Weights,
    /// The part of the displacement, and of the colour of a quantity, that it takes \[-\].
    share: f64,
    part: f32,
}

impl Torso {
    /// The built-in torso of a plan that has another chest, moved with the skin over each place; `None` if no chest is found under its
    /// breast, which no built-in torso has.
    #[must_use]
    pub fn new() -> Option<Self> {
        let fitted = scene::Torso::default().fitted(Settings::default().cover_mm).ok()?;
        let mut torso = Self::of_torso(&fitted);
        torso.is_skin = true;
        let BodyFit { grid, skin_mm, .. } = &fitted.fit;
        for point in &mut torso.points {
            let over = point.place.truncate();
            let apart = (point.place.z - grid.value(skin_mm, over)).abs();
            point.share = smooth_step((NEAR_MM[1] - apart) / (NEAR_MM[1] - NEAR_MM[0]));
        }
        let reach = Settings::default().patch_radius_mm;
        let is_near = |point: &Point| point.place.truncate().length() < reach && point.share > 0.0;
        torso.points.retain(is_near);
        torso.find_nearest();
        Some(torso)
    }

    /// The built-in torso as a plan has it for its chest: both halves are mirror images, and each vertex moves with the column at its depth.
    #[must_use]
    pub fn of_torso(fitted: &FittedTorso) -> Self {
        let torso::Torso { surface, marks } = &fitted.shaped.torso;
        let own = &fitted.fit.frame;
        let frame = upright(own, DVec3::Y);
        let mut torso = Self::of_surface(surface, frame, DVec3::Z, Some(&marks.nipples));
        let hands = [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0)];
        for (side, hand) in hands.into_iter().enumerate() {
            let of = |(k, at): (usize, &DVec3)| Point {
                vertex: k as u32,
                side,
                place: own.local(*at * hand),
                share: 1.0,
                is_nearest: true,
            };
            torso.points.extend(surface.positions.iter().enumerate().map(of));
            torso.turns.push(frame.axes.transpose() * DMat3::from_diagonal(hand) * own.axes);
        }
        torso.is_alike = true;
        torso.find_nearest();
        torso
    }

    /// A surface with its fitted frame, that of the other side where it has a plan of its own, and its marks.
    #[must_use]
    pub fn of_body(surface: &Surface, frames: &[Frame], marks: &Marks) -> Option<Self> {
        let fitted = frames.first()?;
        let axes = marks.axes().ok()?;
        let frame = upright(fitted, axes.head);
        let nipples = Some(&marks.nipples).filter(|_| surface.colors.is_none());
        let mut torso = Self::of_surface(surface, frame, axes.front, nipples);
        for (side, fitted) in frames.iter().enumerate() {
            let of = |(k, at): (usize, &DVec3)| Point {
                vertex: k as u32,
                side,
                place: fitted.local(*at),
                share: 1.0,
                is_nearest: true,
            };
            torso.points.extend(surface.positions.iter().enumerate().map(of));
            torso.turns.push(frame.axes.transpose() * fitted.axes);
        }
        torso.find_nearest();
        let [notch, navel] = [marks.sternal_notch, marks.navel].map(|at| frame.local(at).as_vec3());
        // The trunk of a whole body.
        torso.radius_mm = torso.radius_mm.min(SHOWN_OF_TRUNK * notch.distance(navel));
        torso.middle = notch.lerp(navel, 0.5);
        Some(torso)
    }

    /// A surface that does not move, in a frame, with areolas about the nipples.
    #[must_use]
    pub fn of_surface(
        surface: &Surface,
        frame: Frame,
        front: DVec3,
        nipples: Option<&[DVec3; 2]>,
    ) -> Self {
        // Seams of a texture have one normal.
        let welded = surface.weld();
        let indices: Vec<u32> =
            surface.triangles.as_flattened().iter().map(|k| welded[*k as usize]).collect();
        let plain = color::tissue("skin", 0);
        let color = |k: usize| -> Rgb {
            let own = surface.colors.as_ref().and_then(|colors| colors.get(k));
            own.map_or(plain, |own| own.map(|part| f32::from(part) / 255.0))
        };
        let of = |(k, at): (usize, &DVec3)| {
            let away = |nipples: &[DVec3; 2]| {
                let [left, right] = nipples.map(|nipple| nipple.distance(*at) as f32);
                left.min(right)
            };
            let grid = [nipples.map_or(NO_NIPPLE, away), NO_NET];
            vertex(frame.local(*at).as_vec3(), Vec3::Z, grid, NO_VALUE, color(k))
        };
        let mut rest: Vec<Vertex> = surface.positions.iter().enumerate().map(of).collect();
        let triangles = indices.as_chunks::<3>().0;
        let mut normals = vec![Vec3::Z; rest.len()];
        turn(&mut normals, &rest, triangles, 0..rest.len());
        soften(&mut rest, &normals, triangles, 0..normals.len());
        let (least, most) = indices
            .iter()
            .map(|k| position(&rest[*k as usize]))
            .fold((Vec3::MAX, Vec3::MIN), |(least, most), at| (least.min(at), most.max(at)));
        let front = frame.axes.transpose() * front;
        Self {
            before: Arc::new(Mesh { vertices: rest, indices: Arc::new(indices) }),
            normals,
            points: Vec::new(),
            is_skin: false,
            is_alike: false,
            turns: Vec::new(),
            frame,
            middle: 0.5 * (least + most),
            radius_mm: SHOWN * (most - least).truncate().max_element(),
            azimuth: front.x.atan2(front.z) as f32,
        }
    }

    /// Finds for each vertex the side whose pocket is the nearest one.
    fn find_nearest(&mut self) {
        let mut nearest = vec![f64::INFINITY; self.before.vertices.len()];
        let far = |point: &Point| point.place.truncate().length();
        for point in &self.points {
            let least = &mut nearest[point.vertex as usize];
            *least = least.min(far(point));
        }
        for point in &mut self.points {
            point.is_nearest = far(point) <= nearest[point.vertex as usize];
        }
    }

    /// What a camera shows, its middle, and the angle of the front about the axis towards the head \[radians\].
    #[must_use]
    pub fn seen(&self) -> (Ball, Vec3, f32) {
        (Ball::from(self.radius_mm), self.middle, self.azimuth)
    }

    /// The frame of the picture in the coordinates of the surface.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The first point on the body before that a ray meets, in the coordinates of the picture \[mm\].
    #[must_use]
    pub fn picked(&self, ray: &Ray) -> Option<Vec3> {
        let corners = self.before.indices.as_chunks::<3>().0.iter();
        let corners = corners.map(|t| t.map(|k| position(&self.before.vertices[k as usize])));
        let distances = corners.filter_map(|corners| pick::ray_triangle(ray, corners));
        let nearest = distances.map(|(distance, _)| distance).min_by(f32::total_cmp)?;
        Some(ray.origin + ray.direction * nearest)
    }

    /// How the body moves with the tissue of a problem: that of a side (0: the plan's, 1: the other one), or of the plan alone, whose mirror image moves the
    /// other side of a built-in torso.
    #[must_use]
    pub fn attached(&self, problem: &Problem, of_side: Option<usize>) -> Attached {
        let only = if self.is_alike { of_side } else { of_side.or(Some(0)) };
        let columns = Columns::new(problem);
        let border = problem.sheet().radius_mm();
        let own = self.points.iter().filter(|point| only.is_none_or(|side| point.side == side));
        let weights = |point: &Point| match self.is_skin {
            true => columns.over(point.place.truncate()),
            false => columns.weights(point.place),
        };
        let found: Vec<(&Point, Option<Weights>)> =
            own.map(|point| (point, weights(point))).collect();
        let [low, high] = SKIN_SHARE;
        let mut on_skin = vec![UNKNOWN; self.before.vertices.len()];
        for (point, weights) in &found {
            if point.place.truncate().length() < border {
                let share = weights.as_ref().map_or(0.0, Weights::share);
                let of = &mut on_skin[point.vertex as usize];
                *of = of.max(smooth_step((share - low) / (high - low)) as f32);
            }
        }
        self.even(&mut on_skin);
        let of = |(point, weights): (&Point, Option<Weights>)| {
            let Point { vertex, side, place, share, is_nearest } = *point;
            let weights = weights?;
            // Along a curved wall the patch ends before its radius over the plane.
            let from_border = border - place.truncate().length();
            let near_border = weights.fade() * smooth_step(from_border / FADE_MM);
            let is_coloured = is_nearest || only == Some(0) && of_side.is_none();
            let part = if is_coloured { (share * near_border) as f32 } else { 0.0 };
            let part = part * on_skin[vertex as usize].max(0.0);
            Some(Moved { vertex, side, weights, share, part })
        };
        let moved: Vec<Moved> = found.into_iter().filter_map(of).collect();
        let mut is_reached = vec![false; self.before.vertices.len()];
        moved.iter().for_each(|moved| is_reached[moved.vertex as usize] = true);
        let [turned, softened] = [(); 2].map(|()| self.around(&mut is_reached));
        Attached { rest: problem.rest.clone(), of_side, moved, turned, softened }
    }

    /// Gives each known value the mean of those around it, some times: the colour ends at no edge of triangles.
    fn even(&self, values: &mut Vec<f32>) {
        for _ in 0..EVENINGS {
            let mut sums = vec![(0.0, 0.0); values.len()];
            for triangle in self.before.indices.as_chunks::<3>().0 {
                let known = || triangle.iter().filter(|k| values[**k as usize] > UNKNOWN);
                let sum: f32 = known().map(|k| values[*k as usize]).sum();
                for k in known() {
                    let (of, count) = &mut sums[*k as usize];
                    (*of, *count) = (*of + sum, *count + known().count() as f32);
                }
            }
            let mean = |(sum, count): (f32, f32)| if count > 0.0 { sum / count } else { UNKNOWN };
            *values = sums.into_iter().map(mean).collect();
        }
    }

    /// The vertices of all triangles with a reached vertex, which are reached from now on.
    fn around(&self, is_reached: &mut [bool]) -> Around {
        let triangles = self.before.indices.as_chunks::<3>().0;
        let touches = |triangle: &&[u32; 3], is: &[bool]| triangle.iter().any(|k| is[*k as usize]);
        let beside: Vec<u32> =
            triangles.iter().filter(|t| touches(t, is_reached)).flatten().copied().collect();
        beside.iter().for_each(|k| is_reached[*k as usize] = true);
        let triangles = triangles.iter().filter(|t| touches(t, is_reached)).copied().collect();
        let all = 0..self.before.vertices.len() as u32;
        Around { vertices: all.filter(|k| is_reached[*k as usize]).collect(), triangles }
    }

    /// The body before.
    #[must_use]
    pub fn before(&self) -> &Arc<Mesh> {
        &self.before
    }

    /// The body with the skin of the shapes of one or both sides, in the colours of a field, in the place of other vertices.
    #[must_use]
    pub fn mesh(&self, shapes: &[Shape<'_>], field: Option<Field>, mut room: Vec<Vertex>) -> Mesh {
        room.clone_from(&self.before.vertices);
        let vertices = &mut room;
        if field.is_some() {
            vertices.iter_mut().for_each(|vertex| vertex[8] = 0.0);
        }
        for shape in shapes {
            self.move_with(shape, field, vertices);
        }
        let mut normals = self.normals.clone();
        for Shape { attached: Attached { turned, .. }, .. } in shapes {
            let of = turned.vertices.iter().map(|k| *k as usize);
            turn(&mut normals, vertices, &turned.triangles, of);
        }
        for Shape { attached: Attached { softened, .. }, .. } in shapes {
            let of = softened.vertices.iter().map(|k| *k as usize);
            soften(vertices, &normals, &softened.triangles, of);
        }
        Mesh { vertices: room, indices: Arc::clone(&self.before.indices) }
    }

    /// Moves and colours the vertices of a side.
    fn move_with(&self, shape: &Shape<'_>, field: Option<Field>, vertices: &mut [Vertex]) {
        let Shape { attached, fields, toward } = *shape;
        let moves = Moves::new(fields.solution());
        let moves = match toward {
            Some((to, part)) => moves.toward(&Moves::new(to.solution()), part.into()),
            None => moves,
        };
        for moved in &attached.moved {
            let by = moved.share * (self.turns[moved.side] * moves.of(&moved.weights));
            // A vertex of both sides moves with both.
            let own = &mut vertices[moved.vertex as usize];
            let at = position(own) + by.as_vec3();
            own[..3].copy_from_slice(&at.to_array());
            let Some(field) = field else { continue };
            let value = |fields: &Fields| moved.weights.value(fields.values(field));
            let value = match toward {
                Some((to, part)) => {
                    value(fields).zip(value(to)).map(|(from, to)| from + part * (to - from))
                }
                None => value(fields),
            };
            if let Some(value) = value.filter(|_| moved.part > NO_NET - own[7]) {
                (own[7], own[8]) = (NO_NET - moved.part, value);
            }
        }
    }
}

/// The shape of a side, or a part of the way to another shape \[-\].
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// How the body moves with the side's tissue.
    pub attached: &'a Attached,
    /// The shape.
    pub fields: &'a Fields,
    /// The other shape, and the part.
    pub toward: Option<(&'a Fields, f32)>,
}

impl Attached {
    /// Is this how a body moves with the tissue of a problem on a side, too?
    #[must_use]
    pub fn is_of(&self, problem: &Problem, of_side: Option<usize>) -> bool {
        self.of_side == of_side && self.rest == problem.rest
    }
}

/// Place of a vertex \[mm\].
fn position(vertex: &Vertex) -> Vec3 {
    Vec3::new(vertex[0], vertex[1], vertex[2])
}

/// Sets the area-weighted unit normals of vertices from the triangles around them.
fn turn(
    normals: &mut [Vec3],
    vertices: &[Vertex],
    triangles: &[[u32; 3]],
    of: impl Iterator<Item = usize>,
) {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|k| position(&vertices[k as usize]));
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|k| sums[*k as usize] += normal);
    }
    of.for_each(|k| normals[k] = sums[k].normalize_or(Vec3::Z));
}

/// Gives vertices the mean of the normals of the triangles around them: in the crease under a breast, where triangles are as long as the crease is wide, the
/// light would show each of them as a streak.
fn soften(
    vertices: &mut [Vertex],
    normals: &[Vec3],
    triangles: &[[u32; 3]],
    of: impl Iterator<Item = usize>,
) {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for triangle in triangles {
        let normal: Vec3 = triangle.iter().map(|k| normals[*k as usize]).sum();
        triangle.iter().for_each(|k| sums[*k as usize] += normal);
    }
    for k in of {
        let normal = sums[k].normalize_or(normals[k]);
        vertices[k][3..6].copy_from_slice(&normal.to_array());
    }
}

/// The frame turned about its x until its y is the body's axis towards the head: a standing patient is upright.
fn upright(frame: &Frame, head: DVec3) -> Frame {
    let front = frame.axes.z_axis.reject_from_normalized(head).normalize_or(DVec3::Z);
    let across = head.cross(front) * frame.handedness();
    Frame { axes: DMat3::from_cols(across, head, front), ..*frame }
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::body::deform::deform;
    use implant_preview_core::body::fit::fit;
    use implant_preview_core::body::marks::Side;
    use implant_preview_core::body::read::Unit;
    use implant_preview_core::scene::{CheckedScene, Scene};
    use implant_preview_core::simulate::run;
    use implant_preview_core::solve::Options;
    use std::collections::HashSet;

    fn solved(mut scene: Scene, insertion: f64) -> Fields {
        scene.insertion = insertion;
        scene.solver.nodes_per_side = 33;
        let scene = CheckedScene::new(scene).unwrap();
        Fields::new(run(&scene, Options::default(), None).solution)
    }

    fn fields(insertion: f64) -> Fields {
        solved(Scene::default(), insertion)
    }

    fn positions(torso: &Torso, fields: &Fields) -> Vec<Vec3> {
        drawn(torso, fields).vertices.iter().map(position).collect()
    }

    fn drawn(torso: &Torso, fields: &Fields) -> Mesh {
        let attached = &torso.attached(fields.solution().problem(), None);
        torso.mesh(&[Shape { attached, fields, toward: None }], None, Vec::new())
    }

    #[test]
    fn without_an_implant_the_torso_stays_and_with_one_both_breasts_rise_alike() {
        let torso = Torso::new().unwrap();
        let [flat, full] = [0.0, 1.0].map(|insertion| positions(&torso, &fields(insertion)));
        let rest: Vec<Vec3> = torso.before.vertices.iter().map(position).collect();
        let greatest =
            |of: &[Vec3]| of.iter().zip(&rest).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(greatest(&flat) < 0.05, "{}", greatest(&flat));
        assert!((15.0..70.0).contains(&greatest(&full)), "{}", greatest(&full));
        // Away from the patches every vertex stays to the last bit.
        let moved: HashSet<u32> = torso.points.iter().map(|point| point.vertex).collect();
        for (k, (at, rest)) in full.iter().zip(&rest).enumerate() {
            assert!(moved.contains(&(k as u32)) || at == rest);
        }
        let rise = |side: usize| {
            let way = |p: &Point| full[p.vertex as usize].distance(rest[p.vertex as usize]);
            torso.points.iter().filter(|p| p.side == side).map(way).fold(0.0, f32::max)
        };
        assert!((rise(0) - rise(1)).abs() < 0.01 * rise(0), "{} {}", rise(0), rise(1));
    }

    /// The normals of neighbours across the patch's border turn by no more than those of the torso at rest, and 2°.
    #[test]
    fn the_skin_passes_the_border_of_the_patch_without_a_seam() {
        let torso = Torso::new().unwrap();
        let full = fields(1.0);
        let full = drawn(&torso, &full);
        let normal = |v: &Vertex| Vec3::new(v[3], v[4], v[5]);
        let of = |side| torso.points.iter().filter(move |point| point.side == side);
        let other: HashSet<u32> = of(1).map(|point| point.vertex).collect();
        let turned = of(0).filter(|p| {
            p.place.truncate().length() > 118.0 && p.share > 0.99 && !other.contains(&p.vertex)
        });
        let turn = |p: &Point| {
            let [rest, now] =
                [&torso.before.vertices, &full.vertices].map(|of| normal(&of[p.vertex as usize]));
            rest.angle_between(now).to_degrees()
        };
        let turned: Vec<f32> = turned.map(turn).collect();
        assert!(turned.len() > 40, "{}", turned.len());
        let greatest = turned.iter().copied().fold(0.0, f32::max);
        assert!(greatest < 2.0, "{greatest}");
    }

    /// Her own body: drawn as `deform` makes it, on either side.
    #[test]
    fn a_fitted_body_is_drawn_as_it_is_deformed() {
        let torso::Torso { surface, marks } = torso::builtin();
        for side in [Side::Left, Side::Right] {
            let settings = Settings::default();
            let fitted = fit(&surface, &marks, side, &settings).unwrap();
            let scene =
                Scene::of_body(&fitted, (&marks, side), settings.cover_mm, Unit::Mm).unwrap();
            let full = solved(scene, 1.0);
            let torso = Torso::of_body(&surface, &[fitted.frame], &marks).unwrap();
            let after = deform(&surface, &fitted.frame, full.solution());
            let now = positions(&torso, &full);
            let (mut apart, mut risen) = (0.0_f32, 0.0_f32);
            for (k, (at, before)) in after.positions.iter().zip(&surface.positions).enumerate() {
                apart = apart.max(now[k].distance(torso.frame.local(*at).as_vec3()));
                risen = risen.max(at.distance(*before) as f32);
                if at == before {
                    assert_eq!(now[k], position(&torso.before.vertices[k]), "to the last bit");
                }
            }
            assert!(apart < 1e-3 && risen > 15.0, "{apart} {risen}");
            // The normals are those of all triangles.
            let mesh = drawn(&torso, &full);
            let mut all = mesh.vertices.clone();
            let triangles = mesh.indices.as_chunks::<3>().0;
            let mut normals = vec![Vec3::Z; all.len()];
            turn(&mut normals, &all, triangles, 0..all.len());
            soften(&mut all, &normals, triangles, 0..normals.len());
            for (own, all) in mesh.vertices.iter().zip(&all) {
                let [own, all] = [own, all].map(|v| Vec3::new(v[3], v[4], v[5]));
                assert!(own.distance(all) < 1e-4, "{own} {all}");
            }
            let (_, middle, azimuth) = torso.seen();
            let across = middle + Vec3::new(40.0 * azimuth.cos(), 0.0, 40.0 * azimuth.sin());
            let front = Vec3::new(azimuth.sin(), 0.0, azimuth.cos());
            let ray = Ray { origin: across + 900.0 * front, direction: -front };
            let found = torso.picked(&ray).expect("the body is in front of the eye");
            assert!(found.distance(ray.origin) < 900.0, "{found}");
        }
    }

    /// The torso as a plan's chest: the left side is drawn as `deform` makes it, the right one as its image in the midplane.
    #[test]
    fn a_torso_as_a_chest_is_drawn_as_it_is_deformed_and_mirrored() {
        let mut scene = Scene::opening();
        scene.set_torso(scene::Torso::default());
        let fitted = scene.fitted_torso().unwrap().unwrap();
        let full = solved(scene, 1.0);
        let torso = Torso::of_torso(&fitted);
        let surface = &fitted.shaped.torso.surface;
        let after = deform(surface, &fitted.fit.frame, full.solution());
        let now: Vec<DVec3> =
            positions(&torso, &full).iter().map(|at| torso.frame.point(at.as_dvec3())).collect();
        let key = |at: DVec3| (at * 1e3).round().to_array().map(|x| x as i64);
        let places: std::collections::HashMap<[i64; 3], usize> =
            surface.positions.iter().enumerate().map(|(k, at)| (key(*at), k)).collect();
        let mut risen = 0.0_f64;
        for (k, before) in surface.positions.iter().enumerate() {
            // The other patch ends 6 cm beside the midline.
            if before.x > 70.0 {
                let apart = now[k].distance(after.positions[k]);
                assert!(apart < 1e-3, "{before} {apart}");
            }
            let mirror = DVec3::new(-1.0, 1.0, 1.0);
            let image = places[&key(*before * mirror)];
            assert!(now[image].distance(now[k] * mirror) < 1e-3, "{before}");
            risen = risen.max(now[k].distance(*before));
        }
        assert!(risen > 15.0, "{risen}");
    }

    /// Plans of their own: each side moves as its plan alone, on the built-in torso and on her own body.
    #[test]
    fn each_side_moves_with_its_own_plan() {
        let [small, large] = [0.4, 1.0].map(fields);
        let torso = Torso::new().unwrap();
        let of = |torso: &Torso, shapes: [(&Fields, Option<usize>); 2]| {
            let attached = shapes.map(|(of, side)| torso.attached(of.solution().problem(), side));
            let shape =
                |k: usize| Shape { attached: &attached[k], fields: shapes[k].0, toward: None };
            torso.mesh(&[shape(0), shape(1)], None, Vec::new())
        };
        let both = of(&torso, [(&small, Some(0)), (&large, Some(1))]);
        let alike = [&small, &large].map(|fields| drawn(&torso, fields));
        for side in [0, 1] {
            // Away from the other side's patch.
            let is_own = |k: &u32| torso.points.iter().all(|p| p.vertex != *k || p.side == side);
            let own: Vec<u32> = torso.points.iter().map(|p| p.vertex).filter(is_own).collect();
            assert!(own.len() > 500, "{}", own.len());
            for k in own {
                let [a, b] = [&both, &alike[side]].map(|mesh| position(&mesh.vertices[k as usize]));
                assert!(a.distance(b) < 1e-4, "{side} {a} {b}");
            }
        }
        // Where both patches overlap, a vertex has the colour of the nearer pocket's side.
        let coloured = |fields: [&Fields; 2]| {
            let attached = [0, 1].map(|k| torso.attached(fields[k].solution().problem(), Some(k)));
            let shape =
                |k: usize| Shape { attached: &attached[k], fields: fields[k], toward: None };
            torso.mesh(&[shape(0), shape(1)], Some(Field::PrincipalStrain), Vec::new()).vertices
        };
        let (mixed, of_small) = (coloured([&small, &large]), coloured([&small, &small]));
        let on_left = |k: usize| position(&torso.before.vertices[k]).x > torso.middle.x + 1.0;
        let left: Vec<usize> = (0..mixed.len()).filter(|k| on_left(*k)).collect();
        let has_small = |k: &&usize| mixed[**k][8].to_bits() == of_small[**k][8].to_bits();
        assert!(left.iter().all(|k| has_small(&k)) && left.len() > 1000, "{}", left.len());
        let differing = (0..mixed.len()).filter(|k| !has_small(&k)).count();
        assert!(differing > 500, "{differing}");
        // Of her own body a plan of one side moves that side alone.
        let torso::Torso { surface, marks } = torso::builtin();
        let settings = Settings::default();
        let fits =
            [Side::Left, Side::Right].map(|side| fit(&surface, &marks, side, &settings).unwrap());
        let frames = fits.each_ref().map(|fit| fit.frame);
        let hers = |k: usize, insertion| {
            let of = (&marks, [Side::Left, Side::Right][k]);
            solved(Scene::of_body(&fits[k], of, settings.cover_mm, Unit::Mm).unwrap(), insertion)
        };
        let (large, small) = (hers(0, 1.0), hers(1, 0.4));
        let hers = Torso::of_body(&surface, &frames, &marks).unwrap();
        let one = positions(&hers, &large);
        let both = of(&hers, [(&large, Some(0)), (&small, Some(1))]);
        let nipples = marks.nipples.map(|at| hers.frame.local(at).as_vec3());
        let rise = |at: &[Vec3], nipple: Vec3| {
            let near = hers.before.vertices.iter().map(position).zip(at);
            near.filter(|(before, _)| before.distance(nipple) < 20.0)
                .map(|(before, at)| before.distance(*at))
                .fold(0.0, f32::max)
        };
        let both: Vec<Vec3> = both.vertices.iter().map(position).collect();
        let [left, right] = nipples.map(|nipple| [rise(&one, nipple), rise(&both, nipple)]);
        assert!(left[0] > 12.0 && (left[0] - left[1]).abs() < 1.0, "{left:?}");
        assert!(right[0] < 1.0 && (3.0..0.8 * left[1]).contains(&right[1]), "{right:?}");
    }
}
