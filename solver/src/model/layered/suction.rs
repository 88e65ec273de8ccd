//! The suction of a void on the inner face in f64: the force −p ∂V/∂x of the volume V between the inner face over the pocket and the wall
//! (`mesh/enclosed.rs`), also on nodes in contact, so that their reaction is the contact's pressure and the suction.

use crate::mesh::enclosed::{self, pocket_weight};
use crate::mesh::height_field::HeightField;
use crate::mesh::{Chest, NodeKind, Pocket, Sheet};
use crate::number::Real;
use crate::number::dual::Dual;
use glam::{DVec2, DVec3};

/// A suction on a grid.
#[derive(Clone, Debug)]
pub(crate) struct Suction {
    kpa: f64,
    wall: HeightField<f64>,
    /// The same for derivatives in a direction.
    dual_wall: HeightField<Dual<1>>,
    /// Part of each node's surroundings in the pocket, zero of nodes that are not free; shape (n², ).
    weights: Vec<f64>,
    nodes_per_side: usize,
}

/// The parts of the nodes' surroundings in the pocket, of places at rest in spacings; zero of nodes that are not free.
pub(super) fn weights(sheet: &Sheet, pocket: Pocket) -> Vec<f64> {
    let spacing = sheet.spacing_mm();
    let weight = |(place, kind): (&DVec2, &NodeKind)| match kind {
        NodeKind::Free => pocket_weight(pocket.beyond(place.length(), place.y), spacing),
        _ => 0.0,
    };
    sheet.rest().iter().zip(sheet.kinds()).map(weight).collect()
}

impl Suction {
    /// Of a pressure \[kPa\] over a wall.
    pub(crate) fn new(kpa: f64, wall: &Chest, sheet: &Sheet, pocket: Pocket) -> Self {
        Self {
            kpa,
            wall: wall.heights(),
            dual_wall: wall.heights(),
            weights: weights(sheet, pocket),
            nodes_per_side: sheet.nodes_per_side(),
        }
    }

    /// Does a node, or a neighbour, lie over the pocket?
    fn is_near(&self, k: usize) -> bool {
        let n = self.nodes_per_side;
        let is_over = |k: usize| self.weights.get(k).is_some_and(|weight| *weight > 0.0);
        k > n && [k, k + 1, k - 1, k + n, k - n].into_iter().any(is_over)
    }

    /// ∂V/∂x of a node.
    fn gradient<R: Real>(
        &self,
        k: usize,
        wall: &HeightField<R>,
        x: impl Fn(usize) -> [R; 3],
    ) -> [R; 3] {
        let n = self.nodes_per_side;
        let place = |k: usize| {
            let [x, y, _] = x(k);
            [x, y]
        };
        let height = |k: usize| match self.weights[k] {
            0.0 => R::splat(0.0),
            weight => R::splat(weight) * (x(k)[2] - wall.at(place(k)).height),
        };
        let [across, along] = enclosed::gradient(k, n, place, height);
        let up = R::splat(self.weights[k]) * enclosed::area(k, n, place);
        let [slope_x, slope_y] = wall.at(place(k)).slope;
        [across - up * slope_x, along - up * slope_y, up]
    }

    /// p V \[kPa·mm³\].
    pub(crate) fn energy(&self, x: &[DVec3]) -> f64 {
        let n = self.nodes_per_side;
        let of = |k: usize| {
            let area: f64 = enclosed::area(k, n, |k| [x[k].x, x[k].y]);
            self.weights[k] * area * (x[k].z - self.wall.at([x[k].x, x[k].y]).height)
        };
        let nodes = (0..x.len()).filter(|&k| self.weights[k] > 0.0);
        self.kpa * nodes.map(of).sum::<f64>()
    }

    /// The force on a node \[kPa·mm²\].
    pub(crate) fn force(&self, k: usize, x: &[DVec3]) -> DVec3 {
        if !self.is_near(k) {
            return DVec3::ZERO;
        }
        DVec3::from(self.gradient(k, &self.wall, |k| x[k].to_array())) * -self.kpa
    }

    /// p ∂²V/∂x² times a direction, a node.
    pub(crate) fn product(&self, k: usize, x: &[DVec3], way: &[DVec3]) -> DVec3 {
        if !self.is_near(k) {
            return DVec3::ZERO;
        }
        let at = |k: usize| {
            let (x, way) = (x[k].to_array(), way[k].to_array());
            [0, 1, 2].map(|axis: usize| Dual { value: x[axis], slopes: [way[axis]] })
        };
        DVec3::from(self.gradient(k, &self.dual_wall, at).map(|part| part.slopes[0])) * self.kpa
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_and_their_derivatives_are_those_of_the_energy() {
        let sheet = Sheet::new(17, 80.0);
        for wall in [Chest::Flat, Chest::Curved { across_mm: 150.0, along_mm: 300.0 }] {
            let pocket = Pocket { radius_mm: 47.0, lowered_mm: 8.0 };
            let suction = Suction::new(2.5, &wall, &sheet, pocket);
            let wave = |place: &DVec2| {
                let [a, b] = [0.07 * place.x, 0.05 * place.y];
                let to = *place + DVec2::new((a + b).sin(), (a - b).cos()) * 2.0;
                to.extend(wall.height(to) + 20.0 * a.cos() * b.cos())
            };
            let x: Vec<DVec3> = sheet.rest().iter().map(wave).collect();
            let free = |k: &usize| sheet.kinds()[*k] == NodeKind::Free;
            let vector = |k: usize| {
                let t = k as f64;
                DVec3::new((1.3 * t).sin(), (2.1 * t).cos(), (0.7 * t * t).sin())
            };
            let way: Vec<DVec3> =
                (0..x.len()).map(|k| if free(&k) { vector(k) } else { DVec3::ZERO }).collect();
            let at =
                |t: f64| -> Vec<DVec3> { x.iter().zip(&way).map(|(x, d)| *x + *d * t).collect() };
            let step = 1e-4;
            let [before, after] = [at(-step), at(step)];
            let slope = (suction.energy(&after) - suction.energy(&before)) / (2.0 * step);
            let power: f64 = (0..x.len()).map(|k| suction.force(k, &x).dot(way[k])).sum();
            assert!((slope / -power - 1.0).abs() < 1e-7, "{slope} {power}");
            for k in (0..x.len()).filter(free) {
                let bend = (suction.force(k, &before) - suction.force(k, &after)) / (2.0 * step);
                let found = suction.product(k, &x, &way);
                assert!(found.distance(bend) < 1e-5 * (1.0 + bend.length()), "{found} {bend}");
            }
        }
    }
}
