//! Contact of four neighbouring nodes at a time, in f32.
//!
//! Displacements from `rest` are in spacings of a grid; coordinates count from the grid's centre. A length is the dome's gauge plus one: one on the surface.

use super::shape::{Draped, Near, Shape, ShapeGauge};
use super::{Modes, Obstacle, TOUCH_F32, wall};
use crate::mesh::height_field::HeightField;
use crate::mesh::vec3::{Block, Vec3, add, dot, sub, times};
use wide::f32x4;

/// The greatest move of a node in one step \[grid spacings, along each axis\].
pub(crate) const MAX_STEP: f32 = 0.5;

/// Gauge plus one up to which a node follows an implant that yields in part \[-\].
const FOLLOWING: f32 = 1.3;

/// A dome and a wall in spacings of a grid, about the grid's centre.
#[derive(Clone, Debug)]
pub(crate) struct LaneObstacle {
    dome: Draped<f32x4, ShapeGauge<f32x4>>,
    wall: HeightField<f32x4>,
}

/// The contact condition of four nodes.
#[derive(Clone, Copy)]
pub(crate) struct Touch {
    /// Gauge plus one at which each node touches.
    pub(crate) length: f32x4,
    /// Nodes that are active on the finer grid, as a mask: these keep their gauge.
    pub(crate) active: f32x4,
}

impl LaneObstacle {
    /// Of an obstacle in grid spacings.
    pub(crate) fn new(Obstacle { dome, wall }: &Obstacle) -> Self {
        Self { dome: dome.draped(), wall: wall.0.heights() }
    }

    /// Replaces the implant's shape in its place; returns the gauge before.
    pub(crate) fn reshape(&mut self, shape: &Shape) -> ShapeGauge<f32x4> {
        self.dome.reshape(shape)
    }

    /// Derivatives of the gauge of four nodes by the numbers of the implant's deformation, the reactions per gradient to a force on
    /// them, and the squared length of the gradient. A node beside the surface, as after mixing, has the reaction that is left when its
    /// own compliance closes the gap; none if it is negative.
    pub(crate) fn work(
        &self,
        nodes: &Near<f32x4>,
        height: f32x4,
        force: Vec3,
        compliance: Block,
        touching: f32x4,
    ) -> (Modes<f32x4>, f32x4, f32x4) {
        let g = nodes.gradient;
        let force = if self.wall.is_flat() {
            force
        } else {
            wall::unsupported(Some(&nodes.ground), height, force, |normal| normal)
        };
        let square = dot(g, g);
        let gap = (nodes.length - touching).fast_max(f32x4::ZERO);
        let yielding = dot(g, times(compliance, g));
        let pressing = -dot(force, g) / square - gap / yielding.fast_max(f32x4::splat(1e-30));
        let is_movable = compliance[0].simd_gt(f32x4::ZERO);
        let pressing = is_movable.bitselect(pressing.fast_max(f32x4::ZERO), f32x4::ZERO);
        (self.dome.variation(nodes), pressing, square)
    }

    /// The displacements of nodes that follow the implant from its shape before: wholly on its surface, less and less up to a distance.
    pub(crate) fn following(&self, before: &ShapeGauge<f32x4>, rest: Vec3, at: Vec3) -> Vec3 {
        let near = self.nodes(rest, at);
        let share = (f32x4::splat(FOLLOWING) - near.length) * (1.0 / (FOLLOWING - 1.0));
        let share = share.fast_max(f32x4::ZERO).fast_min(f32x4::ONE);
        let way = self.dome.way_after(before, &near);
        [0, 1, 2].map(|a| at[a] + way[a] * share)
    }

    /// Four nodes at their positions at rest and displacements.
    #[inline(always)]
    pub(crate) fn nodes(&self, rest: Vec3, u: Vec3) -> Near<f32x4> {
        self.dome.near(add(rest, u))
    }

    /// The move from the end of a way along the gradient at its start to the given gauge plus one, at most [`MAX_STEP`].
    #[inline(always)]
    fn along_gradient(&self, near: &Near<f32x4>, way: Vec3, length: f32x4) -> Vec3 {
        let (position, gradient) = (self.dome.moved(near, way), near.gradient);
        let factor = self.dome.distance_along(near, position, gradient, length);
        let most = f32x4::splat(MAX_STEP);
        gradient.map(|g| (g * factor).fast_max(-most).fast_min(most))
    }

    /// The displacements after a step `d` under the constraints.
    ///
    /// With the gauge's gradient g and gap = length − touching, a step d of gap + g·d < 0 leads into the dome. The step
    /// under the constraint solves D d = ω (f + τ) + μg with g·d = −gap, D⁻¹ the `compliance`, and ends on the surface:
    /// the fixed points of this step are those of the contact problem. Nodes active on the finer grid keep their gauge
    /// (gap = 0); nodes without compliance stay.
    #[inline(always)]
    pub(crate) fn step(
        &self,
        rest: Vec3,
        at: Vec3,
        step: Vec3,
        compliance: Block,
        touch: Touch,
    ) -> Vec3 {
        let mut d = step;
        let near = self.nodes(rest, at);
        let Near { length, gradient: g, .. } = near;
        let touching = touch.active.bitselect(length, touch.length);
        let gap = length - touching;
        let gap_after = gap + dot(g, d);
        let is_movable = compliance[0].simd_gt(f32x4::ZERO);
        let is_active = (touch.active | gap_after.simd_lt(f32x4::ZERO)) & is_movable;
        let mut moved = add(at, d);
        if is_active.any() {
            let s = times(compliance, g);
            let multiplier = gap_after / dot(g, s).fast_max(f32x4::splat(1e-30));
            d = [0, 1, 2].map(|a| d[a] - s[a] * multiplier);
            let back = self.along_gradient(&near, d, touching);
            moved = [0, 1, 2].map(|a| is_active.bitselect(at[a] + d[a] + back[a], moved[a]));
        }
        let kept = |v: Vec3| {
            let own = times(compliance, v);
            let along_dome = times(compliance, g);
            let part = dot(g, own) / dot(g, along_dome).fast_max(f32x4::splat(1e-30));
            [0, 1, 2].map(|a| is_active.bitselect(own[a] - along_dome[a] * part, own[a]))
        };
        if self.wall.is_flat() {
            moved = wall::limited_by_plane(moved, kept);
        } else {
            let step = sub(moved, at);
            let height = rest[2] + at[2];
            moved = add(at, wall::limited(&near.ground, height, step, kept));
        }
        let above = wall::projected(&self.wall, rest, moved);
        [0, 1, 2].map(|a| is_movable.bitselect(above[a], at[a]))
    }

    /// The displacements of nodes below the wall or inside of the dome's given gauge plus one, moved onto the
    /// surface.
    #[inline(always)]
    pub(crate) fn projected(&self, rest: Vec3, at: Vec3, touching: f32x4) -> Vec3 {
        let at = wall::projected(&self.wall, rest, at);
        let near = self.nodes(rest, at);
        let is_inside = near.length.simd_lt(touching);
        let way = self.dome.way_to(&near, touching);
        add(at, way.map(|way| is_inside.bitselect(way, f32x4::ZERO)))
    }

    /// The displacements after a correction from a coarser grid: active nodes move along the dome, no node
    /// enters the dome or the wall.
    #[inline(always)]
    pub(crate) fn corrected(&self, rest: Vec3, at: Vec3, correction: Vec3, touch: Touch) -> Vec3 {
        let mut c = correction;
        let near = self.nodes(rest, at);
        let Near { length, gradient: g, .. } = near;
        let normal_part = dot(c, g) / dot(g, g);
        c = [0, 1, 2].map(|a| touch.active.bitselect(c[a] - g[a] * normal_part, c[a]));
        let touching = touch.active.bitselect(length, touch.length);
        let back = self.along_gradient(&near, c, touching);
        let is_put_back = touch.active | dot(back, g).simd_gt(f32x4::ZERO);
        let moved = [0, 1, 2].map(|a| at[a] + c[a] + is_put_back.bitselect(back[a], f32x4::ZERO));
        wall::projected(&self.wall, rest, moved)
    }

    /// The nodes that press on the dome, as a mask: they touch, and their force points inwards. A node near
    /// the surface may be free: it is active if its own step, of the given compliance, enters the dome.
    #[inline(always)]
    pub(crate) fn active(
        &self,
        nodes: &Near<f32x4>,
        height: f32x4,
        force: Vec3,
        compliance: impl FnOnce() -> Block,
        touching: f32x4,
    ) -> f32x4 {
        let Near { length, gradient: g, ref ground, .. } = *nodes;
        let zero = f32x4::ZERO;
        // A curved wall and the dome meet at an angle: the wall takes its part first.
        let force = if self.wall.is_flat() {
            force
        } else {
            wall::unsupported(Some(ground), height, force, |normal| normal)
        };
        let mut is_active =
            length.simd_lt(touching + TOUCH_F32 as f32) & dot(force, g).simd_lt(zero);
        if is_active.any() {
            let gap = (length - touching).fast_max(zero);
            is_active &= (gap + dot(g, times(compliance(), force))).simd_lt(zero);
        }
        is_active
    }

    /// The forces minus the reactions of the dome, on active nodes, and of the wall.
    #[inline(always)]
    pub(crate) fn unsupported(
        &self,
        nodes: &Near<f32x4>,
        rest: Vec3,
        at: Vec3,
        force: Vec3,
        active: f32x4,
    ) -> Vec3 {
        let g = nodes.gradient;
        let pressing = active.bitselect(dot(force, g) / dot(g, g), f32x4::ZERO);
        let force = [0, 1, 2].map(|a| force[a] - g[a] * pressing);
        let ground = Some(&nodes.ground).filter(|_| !self.wall.is_flat());
        wall::unsupported(ground, rest[2] + at[2], force, |normal| {
            let part = active.bitselect(dot(normal, g) / dot(g, g), f32x4::ZERO);
            [0, 1, 2].map(|a| normal[a] - g[a] * part)
        })
    }
}
