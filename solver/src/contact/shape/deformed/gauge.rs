//! The gauge of a body that yields: that of the body at the source of a point.

use super::super::traits::Gauge;
use super::map::{Map, Modes};
use crate::mesh::vec3::{Block, add, dot, sub};
use crate::number::Real;

/// Steps of Newton's method along a direction.
const STEPS_ALONG: usize = 4;

/// The gauge of a deformed shape, in any unit of length.
#[derive(Clone, Debug)]
pub(crate) struct DeformedGauge<R, G> {
    pub(super) rest: G,
    pub(super) map: Map<R>,
}

impl<R: Real, G: Gauge<R>> DeformedGauge<R, G> {
    /// Derivatives of the length at a fixed position by the numbers of the deformation.
    #[inline(never)]
    pub(crate) fn variation(&self, at: [R; 3]) -> Modes<R> {
        let source = self.map.source(at);
        let (_, gradient) = self.rest.length(source.place);
        self.map.variation(&source, gradient)
    }

    /// The way of a point of the body from another deformation to this one.
    #[inline(never)]
    pub(crate) fn way_after(&self, before: &Self, at: [R; 3]) -> [R; 3] {
        sub(self.map.image(before.map.source(at).place), at)
    }
}

impl<R: Real, G: Gauge<R>> Gauge<R> for DeformedGauge<R, G> {
    #[inline(never)]
    fn length_squared(&self, at: [R; 3]) -> R {
        self.rest.length_squared(self.map.source(at).place)
    }

    #[inline(never)]
    fn length(&self, at: [R; 3]) -> (R, [R; 3]) {
        let source = self.map.source(at);
        let (length, gradient) = self.rest.length(source.place);
        (length, self.map.pulled(&source, gradient))
    }

    #[inline(never)]
    fn curvature(&self, at: [R; 3], _: R, _: [R; 3], least: f64) -> Block<R> {
        let source = self.map.source(at);
        let (length, gradient) = self.rest.length(source.place);
        let own = self.rest.curvature(source.place, length, gradient, least);
        self.map.bent(&source, own, gradient)
    }

    #[inline(never)]
    fn distance_along(&self, at: [R; 3], direction: [R; 3], length: R) -> R {
        let mut factor = R::splat(0.0);
        let mut most = R::splat(0.0);
        for step in 0..STEPS_ALONG {
            let to = [0, 1, 2].map(|axis| at[axis] + direction[axis] * factor);
            let (found, gradient) = self.length(to);
            let slope = dot(gradient, direction);
            if step == 0 {
                most = R::splat(1.0) / slope.max(R::splat(1e-20));
            }
            let over = R::splat(0.5) * (found - length) * (found + length);
            let change = over / (found * slope).max(R::splat(1e-20));
            factor = factor - change.max(-most).min(most);
        }
        factor
    }

    /// The image of the way of the source.
    #[inline(never)]
    fn way_to(&self, at: [R; 3], length: R, to: R) -> [R; 3] {
        let source = self.map.source(at).place;
        let way = self.rest.way_to(source, length, to);
        sub(self.map.image(add(source, way)), at)
    }
}
