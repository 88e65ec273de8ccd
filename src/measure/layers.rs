//! The layers of one scene, as measuring needs them: tables of their law, and their stresses.

use super::deformation::{Deformation, gradient, hat_gradients, is_square, square_edges};
use crate::curve::Curve;
use crate::sheet::{CellKind, Sheet};
use crate::solve::{Problem, Solver};
use crate::springs::Material;
use crate::springs::coupled::{CoupledLaw, biot_stress, equivalent_strain};
use glam::DVec3;

/// Bins of the equivalent strain in the search for the most stressed node.
const BINS: usize = 256;

/// The layers that the shapes of a scene share; made once for the same layers.
#[derive(Debug)]
pub struct Layers {
    materials: Vec<Material>,
}

/// How strongly a layer is loaded.
pub(super) struct Load {
    /// Greatest principal nominal (Biot) stress \[kPa\].
    pub(super) max_stress: f64,
    /// Does a strain lie beyond the data of the layer's curve?
    pub(super) is_beyond_data: bool,
}

impl Layers {
    /// The layers of a problem.
    #[must_use]
    pub fn new(problem: &Problem) -> Self {
        Self { materials: problem.materials.clone() }
    }

    /// Has the problem these layers?
    #[must_use]
    pub fn are_of(&self, problem: &Problem) -> bool {
        self.materials == problem.materials
    }

    /// From the skin inwards.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Greatest principal nominal (Biot) stress of a layer at a node \[kPa\]; zero for a layer that
    /// is not there.
    #[must_use]
    pub fn stress(&self, layer: usize, deformation: &Deformation, node: usize) -> f64 {
        self.materials
            .get(layer)
            .map_or(0.0, |m| biot_stress(&m.curve, m.poisson_ratio, deformation.principal(node))[0])
    }

    /// For each layer the first one of the same Poisson ratio: those share ē and λ₃.
    pub(super) fn first_alike(&self) -> impl Iterator<Item = usize> + '_ {
        let nu = |k: usize| self.materials[k].poisson_ratio.to_bits();
        (0..self.materials.len()).map(move |k| (0..k).find(|&j| nu(j) == nu(k)).unwrap_or(k))
    }

    /// The load of every layer.
    pub(super) fn loads(&self, deformation: &Deformation) -> Vec<Load> {
        let mut sorted: Vec<SortedStrains> = Vec::with_capacity(self.materials.len());
        let mut loads = Vec::with_capacity(self.materials.len());
        for (k, first) in self.first_alike().enumerate() {
            let Material { curve, poisson_ratio, .. } = &self.materials[k];
            sorted.push(if first == k {
                SortedStrains::new(deformation, *poisson_ratio)
            } else {
                SortedStrains::default()
            });
            let stress = |node| self.stress(k, deformation, node);
            loads.push(Load {
                max_stress: sorted[first].max_stress(curve, stress),
                is_beyond_data: curve.is_beyond_data(sorted[first].greatest),
            });
        }
        loads
    }

    /// Spring forces \[kPa·mm²\] on the nodes where `wanted`, shape (nodes_per_side², ); on other
    /// nodes they may be incomplete.
    ///
    /// Coupled springs in closed form from the metric of each triangle. The paper's springs have
    /// none: their sum is the solver's.
    pub(super) fn forces(&self, solver: &Solver, wanted: &[bool]) -> Vec<DVec3> {
        let Some(law) = solver.coupled_law() else { return solver.forces() };
        coupled_forces(&solver.problem().sheet, law, &solver.balanced(), wanted)
    }
}

fn coupled_forces(sheet: &Sheet, law: &CoupledLaw, x: &[DVec3], wanted: &[bool]) -> Vec<DVec3> {
    let mut forces = vec![DVec3::ZERO; sheet.len()];
    let cells = sheet.nodes_per_side() - 1;
    let spacing = sheet.spacing_mm();
    for j in 0..cells {
        for i in 0..cells {
            let corners = sheet.corners(i, j);
            if sheet.cell(i, j) == CellKind::Outside || !corners.iter().any(|&k| wanted[k]) {
                continue;
            }
            if !is_square(sheet, corners) {
                for (triangle, weight) in sheet.cell_triangles(i, j) {
                    let (gradients, twice) = hat_gradients(triangle.map(|k| sheet.rest()[k]));
                    let [p1, p2] = tensions(law, gradient(triangle.map(|k| x[k]), gradients));
                    // −∂W/∂x = −A·P ∇φ.
                    let [a, b] = gradients.map(|g| (p1 * g.x + p2 * g.y) * (-0.5 * twice * weight));
                    forces[triangle[0]] -= a + b;
                    forces[triangle[1]] += a;
                    forces[triangle[2]] += b;
                }
                continue;
            }
            let [bottom, top, left, right] = square_edges(corners.map(|k| x[k]), 1.0 / spacing);
            let [along0, across0] = tensions(law, [top, right]);
            let [along1, across1] = tensions(law, [top, left]);
            let [along2, across2] = tensions(law, [bottom, left]);
            let [along3, across3] = tensions(law, [bottom, right]);
            // Each edge pulls its two ends together; A/h of a triangle of half weight is h/4.
            let quarter = 0.25 * spacing;
            let (bottom, top) = ((along2 + along3) * quarter, (along0 + along1) * quarter);
            let (left, right) = ((across1 + across2) * quarter, (across0 + across3) * quarter);
            forces[corners[0]] += bottom + left;
            forces[corners[1]] += right - bottom;
            forces[corners[2]] -= top + right;
            forces[corners[3]] += top - left;
        }
    }
    forces
}

/// Columns of the first Piola–Kirchhoff tension P = F S \[kPa·mm\].
#[inline]
fn tensions(law: &CoupledLaw, [f1, f2]: [DVec3; 2]) -> [DVec3; 2] {
    let metric = [f1.length_squared(), f2.length_squared(), f1.dot(f2)];
    let [s11, s22, s12] = law.second_piola_kirchhoff(metric);
    [f1 * s11 + f2 * s12, f1 * s12 + f2 * s22]
}

/// The sheet's nodes in bins of equal width of the equivalent strain ē, for the layers of one
/// Poisson ratio.
///
/// The greatest principal stress of a node is Ef(ē) times a factor of the strains' direction,
/// (ε₁ + νε₂)/((1−ν²)ē), and Ef increases. The greatest factor in a bin thus bounds the stress of its
/// nodes from above, and the greatest one from below: few bins have to be looked into.
#[derive(Default)]
struct SortedStrains {
    /// Greatest equivalent strain \[-\].
    greatest: f64,
    /// Greatest factor of each bin that has nodes; −∞ in others. Shape ([`BINS`], ).
    factors: Vec<f64>,
    /// Where the nodes of each bin start, and where the last ones end. Shape (BINS + 1, ).
    starts: Vec<usize>,
    nodes: Vec<u32>,
}

impl SortedStrains {
    fn new(deformation: &Deformation, poisson_ratio: f64) -> Self {
        let mut strains = Vec::with_capacity(deformation.len());
        let plane = 1.0 - poisson_ratio * poisson_ratio;
        let mut greatest = 0.0_f64;
        for k in deformation.inside() {
            let strain = deformation.principal(k);
            let equivalent = equivalent_strain(strain, poisson_ratio);
            greatest = greatest.max(equivalent);
            let pull = strain[0] + poisson_ratio * strain[1];
            let factor = if equivalent > 0.0 { pull / (plane * equivalent) } else { 0.0 };
            strains.push((k as u32, equivalent, factor));
        }
        let per_strain = if greatest > 0.0 { BINS as f64 / greatest } else { 0.0 };
        let bin = |equivalent: f64| ((equivalent * per_strain) as usize).min(BINS - 1);
        let (mut factors, mut starts) = (vec![f64::NEG_INFINITY; BINS], vec![0; BINS + 1]);
        for &(_, equivalent, factor) in &strains {
            let bin = bin(equivalent);
            factors[bin] = factors[bin].max(factor);
            starts[bin + 1] += 1;
        }
        for bin in 0..BINS {
            starts[bin + 1] += starts[bin];
        }
        let (mut next, mut nodes) = (starts.clone(), vec![0; strains.len()]);
        for (node, equivalent, _) in strains {
            let place = &mut next[bin(equivalent)];
            nodes[*place] = node;
            *place += 1;
        }
        Self { greatest, factors, starts, nodes }
    }

    /// The greatest of the nodes' stresses \[kPa\] in a layer with this curve.
    fn max_stress(&self, curve: &Curve, stress: impl Fn(usize) -> f64) -> f64 {
        let edges: Vec<f64> =
            (0..=BINS).map(|k| curve.stress(self.greatest * k as f64 / BINS as f64)).collect();
        let ends = |bin: usize| [edges[bin], edges[bin + 1]].map(|e| e * self.factors[bin]);
        let used = |bin: &usize| self.factors[*bin] > f64::NEG_INFINITY;
        let least = (0..BINS)
            .filter(used)
            .map(|bin| ends(bin)[0].min(ends(bin)[1]))
            .fold(f64::MIN, f64::max);
        // Rounding may put a node into the bin beside its own.
        let least = least - 1e-9 * least.abs();
        (0..BINS)
            .filter(used)
            .filter(|&bin| ends(bin)[0].max(ends(bin)[1]) >= least)
            .flat_map(|bin| &self.nodes[self.starts[bin]..self.starts[bin + 1]])
            .map(|&node| stress(node as usize))
            .fold(f64::MIN, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Layer, Scene};
    use std::cell::Cell;

    fn solved(change: impl FnOnce(&mut Scene)) -> Solver {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 33;
        change(&mut scene);
        let mut solver = Solver::new(scene.problem().unwrap());
        solver.advance(&mut || false);
        solver
    }

    #[test]
    fn the_greatest_stress_is_found_among_few_nodes() {
        for (insertion, center) in [(1.0, 0.0), (0.4, 6.0), (0.0, 0.0)] {
            let solver = solved(|scene| {
                (scene.insertion, scene.implant.center_mm[0]) = (insertion, center);
                scene.layers.push(Layer { poisson_ratio: 0.2, ..Layer::skin() });
            });
            let layers = Layers::new(solver.problem());
            let deformation = Deformation::new(&solver.problem().sheet, solver.positions());
            for (k, load) in layers.loads(&deformation).iter().enumerate() {
                let all = deformation.inside().map(|node| layers.stress(k, &deformation, node));
                let greatest = all.fold(f64::MIN, f64::max);
                assert!((load.max_stress - greatest).abs() <= 1e-14 * greatest.abs());
            }
        }
    }

    #[test]
    fn few_nodes_are_searched_for_the_greatest_stress() {
        let solver = solved(|_| {});
        let layers = Layers::new(solver.problem());
        let deformation = Deformation::new(&solver.problem().sheet, solver.positions());
        let count = Cell::new(0);
        SortedStrains::new(&deformation, 0.45).max_stress(&layers.materials[0].curve, |node| {
            count.set(count.get() + 1);
            layers.stress(0, &deformation, node)
        });
        assert!((1..deformation.inside().count() / 8).contains(&count.get()), "{count:?}");
    }

    #[test]
    fn forces_in_closed_form_are_those_of_the_solver() {
        let solver = solved(|scene| scene.layers[0].poisson_ratio = 0.3);
        let all = vec![true; solver.positions().len()];
        let closed = Layers::new(solver.problem()).forces(&solver, &all);
        let forces = solver.forces();
        let scale = forces.iter().map(|f| f.length()).fold(0.0, f64::max);
        for (a, b) in closed.iter().zip(&forces) {
            // Both read tables of the law.
            assert!(a.distance(*b) < 1e-5 * scale, "{a} {b}");
        }
    }
}
