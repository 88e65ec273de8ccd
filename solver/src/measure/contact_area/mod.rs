//! The contact area between the nodes.
//!
//! A grid resolves the contact's edge to a spacing. What the nodes beside the edge have, forces under a sheet, gaps beside solid tissue, resolves more, and
//! makes an area that changes without jumps with the scene.
//!
//! `sheet` | `solid`

mod sheet;
mod solid;

use crate::mesh::part::Part;
use glam::{DMat2, DVec2, dvec2};

/// Sum of squared distances \[grid spacings²\] that damps the slopes of a fit: nodes in one line determine no plane.
const DAMPING: f64 = 0.01;

/// The nodes of a part: normal forces \[kPa·mm²\] and deformed areas \[mm²\].
pub(super) struct Contacted<'a> {
    pub(super) part: Part,
    pub(super) nodes_per_side: usize,
    pub(super) force: &'a [f64],
    pub(super) area: &'a [f64],
}

impl Contacted<'_> {
    /// The nodes within columns and rows to either side of a node of the grid: their indices and distances \[grid spacings\].
    fn around(&self, node: usize, reach: isize) -> impl Iterator<Item = (usize, DVec2)> {
        let (part, n) = (self.part, self.nodes_per_side as isize);
        let (column, row) = (node as isize % n, node as isize / n);
        let range = move |k: isize| (k - reach).max(0)..(k + reach + 1).min(n);
        range(row).flat_map(move |j| {
            range(column).map(move |i| {
                let index = part.index_at(i as usize, j as usize);
                (index, dvec2((i - column) as f64, (j - row) as f64))
            })
        })
    }
}

/// Weighted linear fit of values about a node.
struct Plane {
    /// Sum of the weights.
    weight: f64,
    /// Mean and standard deviation of the values.
    mean: f64,
    deviation: f64,
    /// The fitted value at the node, and its slopes \[1/grid spacing\].
    at_node: f64,
    slope: DVec2,
}

impl Plane {
    /// The fit of weights, distances \[grid spacings\] and values; `None` without weights.
    fn of(around: impl Iterator<Item = (f64, DVec2, f64)>) -> Option<Self> {
        let (mut weight, mut place, mut mean, mut squares) = (0.0, DVec2::ZERO, 0.0, 0.0);
        let (mut products, mut with_value) = (DMat2::ZERO, DVec2::ZERO);
        for (w, at, value) in around {
            weight += w;
            place += w * at;
            mean += w * value;
            squares += w * value * value;
            products += DMat2::from_cols(w * at.x * at, w * at.y * at);
            with_value += w * value * at;
        }
        if weight <= 0.0 {
            return None;
        }
        (place, mean) = (place / weight, mean / weight);
        products -= weight * DMat2::from_cols(place.x * place, place.y * place);
        with_value -= weight * mean * place;
        let slope = (products + DMat2::from_diagonal(DVec2::splat(DAMPING))).inverse() * with_value;
        let deviation = (squares / weight - mean * mean).max(0.0).sqrt();
        Some(Self { weight, mean, deviation, at_node: mean - slope.dot(place), slope })
    }
}
