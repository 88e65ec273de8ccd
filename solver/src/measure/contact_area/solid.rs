//! The area in contact of solid tissue.
//!
//! The pressure of solid tissue falls to zero at the contact's edge, with the root of the distance, and the gap beyond opens with the power 3/2 of the
//! distance (K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 4 and 5): the power 2/3 of the gap, the *opening*, is linear in the distance, and zero
//! at the edge. A linear fit of the openings around a node parts the node's area in two. Of second order in the spacing: a circle of a radius of r spacings
//! has 3/r² too little area, and a void that closes at the pocket's edge, where the openings grow by less, as much too much.

use super::{Contacted, Plane};
use glam::DVec2;

/// Columns and rows to either side whose openings locate the edge.
const REACH: isize = 2;
/// Power of the gap that is linear in the distance from the edge.
const POWER: f64 = 2.0 / 3.0;
/// Opening with half of the greatest weight \[mean opening around\]: a node that has just left the contact has none, so that the fit changes without jumps.
const HALF_WEIGHT: f64 = 0.3;
/// Least ratio of an edge's slopes along columns and rows; the area in contact changes by a fraction of it.
const LEAST_RATIO: f64 = 1e-4;

impl Contacted<'_> {
    /// The area of solid tissue in contact \[mm²\], from the gap \[mm\] beside a node of the grid; `None` for fixed nodes.
    pub(in super::super) fn of_solid(&self, gap: impl Fn(usize) -> Option<f64>) -> f64 {
        let opening = |(node, force): (usize, &f64)| {
            let gap = if *force > 0.0 { None } else { gap(node) };
            gap.map(|gap| gap.max(0.0).powf(POWER))
        };
        let openings: Vec<Option<f64>> = self.part.nodes().zip(self.force).map(opening).collect();
        let is_touching = |k: usize| self.force[k] > 0.0;
        let of_node = |(own, node): (usize, usize)| {
            let is_at_edge = self.around(node, 1).any(|(k, _)| is_touching(k) != is_touching(own));
            let free = || self.around(node, REACH).filter_map(|(k, at)| Some((at, openings[k]?)));
            let whole = if is_touching(own) { 1.0 } else { 0.0 };
            let share = is_at_edge.then(|| part_inside(free)).flatten().unwrap_or(whole);
            share * self.area[own] * self.part.multiplicity(node)
        };
        self.part.nodes().enumerate().map(of_node).sum()
    }
}

/// The part of the area around a node on the contact's side of the edge, from openings and their distances; `None` without an opening.
fn part_inside<I: Iterator<Item = (DVec2, f64)>>(free: impl Fn() -> I) -> Option<f64> {
    let (count, sum) =
        free().fold((0.0, 0.0), |(count, sum), (_, opening)| (count + 1.0, sum + opening));
    let half = HALF_WEIGHT * sum / count;
    let weighted = free().map(|(at, opening)| (opening / (opening + half), at, opening));
    Plane::of(weighted).map(|edge| below_zero(edge.at_node, edge.slope))
}

/// The part of the unit square about the origin where height + slope · place is below zero.
fn below_zero(height: f64, slope: DVec2) -> f64 {
    let slope = slope.abs();
    let steep = slope.max_element();
    if steep <= 0.0 {
        return if height < 0.0 { 1.0 } else { 0.0 };
    }
    let flat = slope.min_element().max(LEAST_RATIO * steep);
    // The triangle below zero about the lowest corner, less what of it lies beyond the square.
    let triangle = |t: f64| t.max(0.0).powi(2);
    let t = 0.5 * (steep + flat) - height;
    let twice = triangle(t) - triangle(t - steep) - triangle(t - flat) + triangle(t - steep - flat);
    (twice / (2.0 * steep * flat)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::part::Part;
    use glam::dvec2;
    use std::f64::consts::PI;

    /// By counting: 400 × 400 places of the square.
    #[test]
    fn a_line_parts_the_area_around_a_node() {
        for (height, slope) in [
            (0.0, dvec2(1.0, 0.0)),
            (0.2, dvec2(-1.0, 0.3)),
            (-0.1, dvec2(0.2, 0.9)),
            (0.6, dvec2(0.5, -0.5)),
            (-0.49, dvec2(0.7, 0.7)),
            (1.0, dvec2(0.7, 0.7)),
            (-1.0, dvec2(0.7, 0.1)),
        ] {
            let places = (0..400).flat_map(|i| (0..400).map(move |j| [i, j]));
            let at = |k: i32| (f64::from(k) + 0.5) / 400.0 - 0.5;
            let below = places.filter(|[i, j]| height + slope.dot(dvec2(at(*i), at(*j))) < 0.0);
            let counted = below.count() as f64 / 160_000.0;
            assert!((below_zero(height, slope) - counted).abs() < 3e-3, "{height} {slope}");
        }
    }

    /// A round contact whose gap opens with the distance's power 3/2, moved between the nodes: the circle's area to second order, without jumps.
    #[test]
    fn the_area_of_a_round_contact_is_that_of_its_circle() {
        let n = 49;
        let part = Part::whole(n);
        let area = vec![1.0; part.len()];
        for radius in [5.0, 9.0, 16.0] {
            let errors: Vec<f64> = (0..41)
                .map(|step| {
                    let centre = dvec2(24.0, 24.0) + 0.025 * f64::from(step) * dvec2(1.0, 0.6);
                    let beyond = |node: usize| {
                        dvec2((node % n) as f64, (node / n) as f64).distance(centre) - radius
                    };
                    let force: Vec<f64> =
                        part.nodes().map(|k| (-beyond(k)).max(0.0).sqrt()).collect();
                    let contact = Contacted { part, nodes_per_side: n, force: &force, area: &area };
                    let found = contact.of_solid(|node| Some(beyond(node).max(0.0).powf(1.5)));
                    found / (PI * radius * radius) - 1.0
                })
                .collect();
            for error in &errors {
                assert!(error.abs() < 3.6 / (radius * radius), "{radius}: {error:.4}");
            }
            for three in errors.windows(3) {
                let from_middle = 0.5 * (three[0] + three[2]) - three[1];
                assert!(from_middle.abs() < 2e-4, "{radius}: {from_middle:.1e}");
            }
        }
    }
}
