//! A body around the tissue, drawn with the computed skin: her own surface, or the built-in torso, which is no patient's shape. No part of
//! the model.
//!
//! The built-in torso of a plan with another chest has its bare chest under the plan's wall at the pocket's centre, and each of its vertices within the patch moves as the computed skin
//! over the same place of the plane; the other side is the mirror image, or has a plan of its own. Each vertex of a fitted surface moves with the columns at its own
//! depth, as in [`implant_preview_core::body::deform`].

mod moving;
mod normals;
#[cfg(test)]
mod tests;

pub use moving::{Attached, Shape};

use crate::camera::{Ball, Ray};
use crate::color::{self, Rgb};
use crate::mesh::{Mesh, NO_VALUE, Vertex, vertex};
use crate::pick;
use glam::{DMat3, DVec3, Vec3};
use implant_preview_core::body::fit::{BodyFit, Settings};
use implant_preview_core::body::frame::Frame;
use implant_preview_core::body::grid::smooth_step;
use implant_preview_core::body::marks::Marks;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::body::torso;
use implant_preview_core::scene::{self, FittedTorso};
use moving::FADE_MM;
use normals::{soften, turn};
use std::sync::Arc;

/// Distance from the fitted skin within which a vertex is skin of the breast's side, not of flank or arm, and its end \[mm\].
const NEAR_MM: [f64; 2] = [15.0, 30.0];
/// The second coordinate on the net of a vertex without net, less how far it is within the colour of a quantity (0 to 1, from 0.5 on in it); the first
/// is the distance from the nipple \[mm\].
const NO_NET: f32 = -1.0;
/// Distance from the nipple of a vertex without an areola to draw \[mm\].
const NO_NIPPLE: f32 = 1e6;
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
    /// The plane at which the body ends behind: normal to the front and height of the origin over it \[mm\]; `None` for a whole body.
    end: Option<(Vec3, f32)>,
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
        let reach = Settings::default().patch_radius_mm + FADE_MM;
        let is_near = |point: &Point| point.place.truncate().length() < reach && point.share > 0.0;
        torso.points.retain(is_near);
        torso.find_nearest();
        Some(torso)
    }

    /// The built-in torso as a plan has it for its chest: both halves are mirror images, and each vertex moves with the column at its depth.
    #[must_use]
    pub fn of_torso(fitted: &FittedTorso) -> Self {
        let torso::Torso { surface: trunk, marks } = &fitted.shaped.torso;
        let surface = joined(trunk, &fitted.shaped.arms);
        let own = &fitted.fit.frame;
        let frame = upright(own, DVec3::Y);
        let mut torso = Self::of_surface(&surface, frame, DVec3::Z, Some(&marks.nipples));
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
        let low = surface.positions.iter().map(|at| at.z).fold(f64::INFINITY, f64::min);
        let front = frame.axes.transpose() * DVec3::Z;
        torso.end = Some((front.as_vec3(), (frame.origin.z - low) as f32));
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
            end: None,
        }
    }

    /// The plane at which the body ends behind: normal to the front and height of the origin over it \[mm\]; `None` for a whole body.
    #[must_use]
    pub fn end(&self) -> Option<(Vec3, f32)> {
        self.end
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

    /// The body before.
    #[must_use]
    pub fn before(&self) -> &Arc<Mesh> {
        &self.before
    }
}

/// The frame turned about its x until its y is the body's axis towards the head: a standing patient is upright.
fn upright(frame: &Frame, head: DVec3) -> Frame {
    let front = frame.axes.z_axis.reject_from_normalized(head).normalize_or(DVec3::Z);
    let across = head.cross(front) * frame.handedness();
    Frame { axes: DMat3::from_cols(across, head, front), ..*frame }
}

/// Two surfaces without colours as one, the vertices of the first one first.
fn joined(one: &Surface, other: &Surface) -> Surface {
    let first = one.positions.len() as u32;
    let others = other.triangles.iter().map(|triangle| triangle.map(|k| first + k));
    Surface {
        positions: [&one.positions[..], &other.positions].concat(),
        triangles: one.triangles.iter().copied().chain(others).collect(),
        colors: None,
    }
}

/// Place of a vertex \[mm\].
fn position(vertex: &Vertex) -> Vec3 {
    Vec3::new(vertex[0], vertex[1], vertex[2])
}
