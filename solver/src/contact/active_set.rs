//! The contact conditions of Newton's method: reactions, unconstrained directions, constrained steps.
//!
//! n is the dome's unit normal at a node, w the wall's.

use super::{Dome, Wall};
use crate::mesh::stencil::outer;
use glam::{DMat3, DVec3};

/// No constraint is active.
pub(crate) const FREE: u8 = 0;
/// The dome presses on the node.
pub(crate) const ON_DOME: u8 = 1;
/// The wall presses on the node; dome and wall may do so together.
pub(crate) const ON_WALL: u8 = 2;

/// 1 − (n·w)² below which dome and wall count as parallel.
pub(crate) const LEAST_SPREAD: f64 = 1e-12;

/// A node beside dome and wall.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Constraint {
    /// The dome's unit normal.
    pub(crate) normal: DVec3,
    /// Distance from the dome \[mm\], to first order.
    pub(crate) gap: f64,
    /// Length of the gauge's gradient \[1/mm\].
    steepness: f64,
    /// The wall's unit normal.
    pub(crate) wall_normal: DVec3,
    /// Distance from the wall \[mm\].
    pub(crate) height: f64,
}

/// The reactions of dome and wall to the force on a node.
pub(crate) struct Reaction {
    /// [`FREE`], or [`ON_DOME`] and [`ON_WALL`].
    pub(crate) active: u8,
    /// The dome's force per gradient of the gauge, zero unless the dome presses.
    pub(crate) per_gradient: f64,
    /// The wall's force, zero unless the wall presses.
    pub(crate) by_wall: f64,
}

impl Constraint {
    /// The constraint of a node at `x` with a contact offset, as a gauge.
    pub(crate) fn new(dome: &Dome, wall: &Wall, x: DVec3, offset: f64) -> Self {
        let gradient = dome.gauge_gradient(x);
        let steepness = gradient.length();
        Self {
            normal: gradient / steepness,
            gap: (dome.gauge(x) - offset) / steepness,
            steepness,
            wall_normal: wall.normal(x),
            height: wall.gap(x),
        }
    }

    /// The reactions to a force of dome and wall within a distance of `touch` \[mm\].
    pub(crate) fn reaction(&self, force: DVec3, touch: f64) -> Reaction {
        let mut pressing = -force.dot(self.normal);
        let mut by_wall_force = -force.dot(self.wall_normal);
        let (by_dome, by_wall) = (self.gap <= touch, self.height <= touch);
        let mut is_on_dome = by_dome && pressing >= 0.0;
        let mut is_on_wall = by_wall && by_wall_force >= 0.0;
        if by_dome
            && by_wall
            && let Some([dome, wall]) = self.both(force)
        {
            (pressing, is_on_dome) = (dome, dome >= 0.0);
            (by_wall_force, is_on_wall) = (wall, wall >= 0.0);
        }
        Reaction {
            active: if is_on_dome { ON_DOME } else { FREE }
                | if is_on_wall { ON_WALL } else { FREE },
            per_gradient: if is_on_dome { pressing / self.steepness } else { 0.0 },
            by_wall: if is_on_wall { by_wall_force } else { 0.0 },
        }
    }

    /// The reactions of dome and wall together, if both press: force + d n + w w is then tangential to both.
    fn both(&self, force: DVec3) -> Option<[f64; 2]> {
        let cosine = self.normal.dot(self.wall_normal);
        let (f, w) = (force.dot(self.normal), force.dot(self.wall_normal));
        let spread = 1.0 - cosine * cosine;
        let reactions = [(cosine * w - f) / spread, (cosine * f - w) / spread];
        (spread > LEAST_SPREAD && reactions.iter().all(|r| *r >= 0.0)).then_some(reactions)
    }

    /// The projector onto the unconstrained directions.
    pub(crate) fn projector(&self, active: u8) -> DMat3 {
        match active {
            FREE => DMat3::IDENTITY,
            ON_DOME => DMat3::IDENTITY - outer(self.normal, self.normal),
            ON_WALL => DMat3::IDENTITY - outer(self.wall_normal, self.wall_normal),
            _ => {
                let t = self.edge();
                outer(t, t)
            }
        }
    }

    /// Along the curve where dome and wall meet.
    fn edge(&self) -> DVec3 {
        self.normal.cross(self.wall_normal).normalize_or(DVec3::X)
    }

    /// The shortest step onto both constraints: n·d = −gap and w·d = −height.
    fn corner_step(&self) -> DVec3 {
        let cosine = self.normal.dot(self.wall_normal);
        let across = self.normal - self.wall_normal * cosine;
        let length = across.length_squared();
        let factor =
            if length > LEAST_SPREAD { (-self.gap + cosine * self.height) / length } else { 0.0 };
        across * factor - self.wall_normal * self.height
    }

    /// The step `d` moved onto the active constraints.
    pub(crate) fn onto(&self, active: u8, d: DVec3) -> DVec3 {
        match active {
            FREE => d,
            ON_DOME => d - self.normal * (self.gap + self.normal.dot(d)),
            ON_WALL => d - self.wall_normal * (self.height + self.wall_normal.dot(d)),
            _ => self.corner_step() + self.edge() * self.edge().dot(d),
        }
    }

    /// The inverse of a block in the unconstrained directions.
    pub(crate) fn constrained_inverse(&self, active: u8, inverse: DMat3, block: &DMat3) -> DMat3 {
        match active {
            FREE => inverse,
            ON_DOME => without(inverse, self.normal),
            ON_WALL => without(inverse, self.wall_normal),
            _ => {
                let t = self.edge();
                let stiffness = t.dot(*block * t);
                outer(t, t) * if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 }
            }
        }
    }

    /// The step of a node that minimises ½d·Hd − rhs·d under n·d ≥ −gap and w·d ≥ −height, and its active
    /// constraints. `block` is H.
    #[inline]
    pub(crate) fn step(&self, rhs: DVec3, block: &DMat3, inverse: &DMat3) -> (DVec3, u8) {
        let Self { normal, gap, wall_normal, height, .. } = *self;
        let d = *inverse * rhs;
        let passes_dome = |d: DVec3| normal.dot(d) < -gap;
        let passes_wall = |d: DVec3| wall_normal.dot(d) < -height;
        if !passes_dome(d) && !passes_wall(d) {
            return (d, FREE);
        }
        // One constraint, or both if one is not sufficient.
        let s = *inverse * normal;
        let on_dome = d + s * ((-gap - normal.dot(d)) / normal.dot(s));
        let t = *inverse * wall_normal;
        let on_wall = d + t * ((-height - wall_normal.dot(d)) / wall_normal.dot(t));
        if passes_dome(d) && wall_normal.dot(on_dome) >= -height - ROUNDING_MM {
            (on_dome, ON_DOME)
        } else if passes_wall(d) && normal.dot(on_wall) >= -gap - ROUNDING_MM {
            (on_wall, ON_WALL)
        } else {
            let along = self.edge();
            let corner = self.corner_step();
            let stiffness = along.dot(*block * along);
            let move_along =
                if stiffness > 0.0 { along.dot(rhs - *block * corner) / stiffness } else { 0.0 };
            (corner + along * move_along, ON_DOME | ON_WALL)
        }
    }
}

/// Tolerated violation of a constraint \[mm\].
const ROUNDING_MM: f64 = 1e-12;

/// The inverse of a block restricted to the plane across `normal`.
fn without(inverse: DMat3, normal: DVec3) -> DMat3 {
    let s = inverse * normal;
    inverse - outer(s, s) * (1.0 / normal.dot(s))
}
