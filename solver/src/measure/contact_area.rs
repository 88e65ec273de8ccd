//! The contact area between the nodes.
//!
//! A grid resolves the contact's edge to a spacing, the forces on the nodes resolve more: the force on a node at the edge is the
//! pressure there times the part of the node's area in contact. How far a node belongs to the inside of the contact is a number
//! between 0 and 1 that follows from the forces, so that the area changes without jumps with the scene.

use crate::mesh::part::Part;
use glam::{DMat2, DVec2, dvec2};

/// Columns and rows to either side from which the pressure at the contact's edge is extrapolated.
const REACH: isize = 4;
/// Pressure \[local pressure\] from which a node counts as wholly in contact.
const TOUCHING: f64 = 0.2;
/// Weight of the nodes inside below which the pressure at the edge is not known.
const FEW: f64 = 0.1;
/// Sum of squared distances \[grid spacings²\] that damps the slopes of a fit: nodes in one line determine no plane.
const DAMPING: f64 = 0.01;
/// Bounds of the extrapolated pressure: standard deviations from the mean, and the least fraction of the mean.
const DEVIATIONS: f64 = 5.0;
const LEAST_OF_MEAN: f64 = 0.3;

/// Normal forces \[kPa·mm²\] and deformed areas \[mm²\] of the nodes of a part.
pub(super) struct Contacted<'a> {
    pub(super) part: Part,
    pub(super) nodes_per_side: usize,
    pub(super) force: &'a [f64],
    pub(super) area: &'a [f64],
}

impl Contacted<'_> {
    /// The area in contact \[mm²\].
    pub(super) fn total(&self) -> f64 {
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
        let n = self.nodes_per_side as isize;
        let of = |(own, node): (usize, usize)| {
            let (column, row) = (node as isize % n, node as isize / n);
            let range = |k: isize| (k - reach).max(0)..(k + reach + 1).min(n);
            let mut around =
                range(row).flat_map(|j| range(column).map(move |i| (i, j))).map(|(i, j)| {
                    let index = self.part.index_at(i as usize, j as usize);
                    (index, dvec2((i - column) as f64, (j - row) as f64))
                });
            value(own, &mut around)
        };
        self.part.nodes().enumerate().map(of).collect()
    }
}

/// The pressure at a node by a weighted linear fit of the pressures around \[kPa\], and how far the fit counts; `None` without
/// weights.
fn at_edge(around: impl Iterator<Item = (f64, DVec2, f64)>) -> Option<(f64, f64)> {
    let (mut weight, mut place, mut mean, mut squares) = (0.0, DVec2::ZERO, 0.0, 0.0);
    let (mut products, mut with_pressure) = (DMat2::ZERO, DVec2::ZERO);
    for (w, at, pressure) in around {
        weight += w;
        place += w * at;
        mean += w * pressure;
        squares += w * pressure * pressure;
        products += DMat2::from_cols(w * at.x * at, w * at.y * at);
        with_pressure += w * pressure * at;
    }
    if weight <= 0.0 {
        return None;
    }
    (place, mean) = (place / weight, mean / weight);
    products -= weight * DMat2::from_cols(place.x * place, place.y * place);
    with_pressure -= weight * mean * place;
    let slope = (products + DMat2::from_diagonal(DVec2::splat(DAMPING))).inverse() * with_pressure;
    let room = DEVIATIONS * (squares / weight - mean * mean).max(0.0).sqrt();
    let found =
        (mean - slope.dot(place)).clamp((mean - room).max(LEAST_OF_MEAN * mean), mean + room);
    Some((found, weight * weight / (weight * weight + FEW * FEW)))
}

/// 0 up to 0, 1 from 1 on, a smooth way between.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
