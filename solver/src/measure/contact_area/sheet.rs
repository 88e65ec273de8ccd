//! The area in contact of a sheet.
//!
//! The pressure of a sheet jumps to zero at the contact's edge: the force on a node at the edge is the pressure there times the part of the
//! node's area in contact. How far a node belongs to the inside of the contact is a number between 0 and 1 that follows from the forces, so
//! that the area changes without jumps with the scene.

use super::{Contacted, Plane};
use glam::DVec2;

/// Columns and rows to either side from which the pressure at the contact's edge is extrapolated.
const REACH: isize = 4;
/// Pressure \[local pressure\] from which a node counts as wholly in contact.
const TOUCHING: f64 = 0.2;
/// Weight of the nodes inside below which the pressure at the edge is not known.
const FEW: f64 = 0.1;
/// Bounds of the extrapolated pressure: standard deviations from the mean, and the least fraction of the mean.
const DEVIATIONS: f64 = 5.0;
const LEAST_OF_MEAN: f64 = 0.3;

impl Contacted<'_> {
    /// The area of a sheet in contact \[mm²\].
    pub(in super::super) fn of_sheet(&self) -> f64 {
        // A node beyond the sheet has no area.
        let of_node = |(force, area): (&f64, &f64)| if *force > 0.0 { force / area } else { 0.0 };
        let pressure: Vec<f64> = self.force.iter().zip(self.area).map(of_node).collect();
        let touching = self.of_box(2, |own, around| {
            let (sum, squares) = around.fold((0.0, 0.0), |(sum, squares), (k, _)| {
                (sum + pressure[k], squares + pressure[k] * pressure[k])
            });
            // The mean of the pressures around, weighted by themselves.
            if sum > 0.0 { smooth_step(pressure[own] * sum / (TOUCHING * squares)) } else { 0.0 }
        });
        let inner =
            |of: &[f64]| self.of_box(1, |_, around| around.map(|(k, _)| of[k]).fold(1.0, f64::min));
        // A node at the edge disturbs the forces on its neighbours: two rings of nodes are left out, of a small contact one.
        let one_ring = inner(&touching);
        let two_rings = inner(&one_ring);
        let most = two_rings.iter().copied().fold(0.0, f64::max);
        let inside: Vec<f64> = one_ring
            .iter()
            .zip(two_rings)
            .map(|(one, two)| most * two + (1.0 - most) * one)
            .collect();
        let areas = self.of_box(REACH, |own, around| {
            let (area, force) = (self.area[own], self.force[own]);
            if force <= 0.0 || inside[own] >= 1.0 {
                return if force > 0.0 { area } else { 0.0 };
            }
            let found = at_edge(around.map(|(k, at)| (inside[k], at, pressure[k])));
            let whole = touching[own] * area;
            let share = found
                .map_or(whole, |(at_edge, trust)| trust * force / at_edge + (1.0 - trust) * whole);
            inside[own] * area + (1.0 - inside[own]) * share
        });
        self.part.nodes().zip(areas).map(|(node, area)| self.part.multiplicity(node) * area).sum()
    }

    /// A value of each node from the nodes within columns and rows to either side: their indices and distances.
    fn of_box(
        &self,
        reach: isize,
        value: impl Fn(usize, &mut dyn Iterator<Item = (usize, DVec2)>) -> f64,
    ) -> Vec<f64> {
        let of = |(own, node): (usize, usize)| value(own, &mut self.around(node, reach));
        self.part.nodes().enumerate().map(of).collect()
    }
}

/// The pressure at a node by a weighted linear fit of the pressures around \[kPa\], and how far the fit counts; `None` without
/// weights.
fn at_edge(around: impl Iterator<Item = (f64, DVec2, f64)>) -> Option<(f64, f64)> {
    let Plane { weight, mean, deviation, at_node, .. } = Plane::of(around)?;
    let room = DEVIATIONS * deviation;
    let found = at_node.clamp((mean - room).max(LEAST_OF_MEAN * mean), mean + room);
    Some((found, weight * weight / (weight * weight + FEW * FEW)))
}

/// 0 up to 0, 1 from 1 on, a smooth way between.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
