//! Energy, forces and Hessian of a sheet: sums over its triangles.
//!
//! A triangle's deformation gradient is F = Σ x ⊗ ∇φ, its principal stretches λ and directions N
//! (at rest), u = F N/λ (deformed). Coupled springs: P = Σ T u ⊗ N, and the second derivative has
//! closed-form modes (stretch, shear, twist, out of plane; cf. B. Smith et al., "Analytic
//! eigensystems for isotropic distortion energies", ACM TOG 38(1), 2019), so that negative
//! stiffness can be left out of the Hessian mode by mode. Forces are exact.

use super::law::{PaperLaw, SheetLaw};
use super::triangle::{Principal, Rest, sums};
use crate::mesh::Surface;
use crate::mesh::part::Part;
use crate::mesh::stencil::{BlockStencil9, outer};
use crate::springs::coupled::CoupledLaw;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Fraction of the tangential stiffness w₁₁ + w₂₂ that the out-of-plane stiffness of [`Stiffness::Positive`] is kept
/// above \[-\]: a flat sheet without tension still needs an inverse.
const MIN_OUT_OF_PLANE_STIFFNESS: f64 = 1e-7;
/// Fraction of a spring's |slope| + |tension| that its stiffness in [`Stiffness::Positive`] is kept above, along and
/// across \[-\].
const MIN_SPRING_STIFFNESS: f64 = 1e-6;

/// Which second derivative to assemble.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stiffness {
    /// The true Hessian.
    True,
    /// Without its negative modes, triangle by triangle: positive semidefinite.
    Positive,
}

/// Sums over the sheet, or over the rows of cells so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Strain energy \[kPa·mm³\].
    pub energy: f64,
    /// Sum of the squared forces that triangles exert on their nodes \[(kPa·mm²)²\].
    squared_forces: f64,
    /// Is a spring outside of the domain of its law?
    pub(crate) outside_law: bool,
}

impl Totals {
    /// Root of the sum of the squared forces of all triangles \[kPa·mm²\]: the scale of residuals.
    pub fn force_scale(&self) -> f64 {
        self.squared_forces.sqrt()
    }
}

/// Corner pairs whose blocks a cell adds: (from, to, which array: 4 = diagonal, else upper).
const PAIRS: [(usize, usize, usize); 10] = [
    (0, 0, 4),
    (1, 1, 4),
    (2, 2, 4),
    (3, 3, 4),
    (0, 1, 0),
    (3, 2, 0),
    (0, 3, 1),
    (1, 2, 1),
    (0, 2, 2),
    (1, 3, 3),
];

/// For corners a, b: the place in [`PAIRS`], and whether the pair stands there as (b, a).
const PLACE: [[(usize, bool); 4]; 4] = [
    [(0, false), (4, false), (8, false), (6, false)],
    [(4, true), (1, false), (7, false), (9, false)],
    [(8, true), (7, true), (2, false), (5, true)],
    [(6, true), (9, true), (5, false), (3, false)],
];

/// Strain energy of a shape \[kPa·mm³\].
pub fn energy(surface: Surface, law: &SheetLaw, x: &[DVec3]) -> f64 {
    let mut sum = 0.0;
    for (nodes, weight) in surface.sheet().triangles() {
        let triangle = Rest::new(surface, nodes, weight);
        let x = nodes.map(|k| x[k]);
        sum += match law {
            SheetLaw::Coupled(law) => {
                let [a, b] = Principal::stretches(Principal::columns(&triangle, x));
                triangle.area * law.energy([a - 1.0, b - 1.0])
            }
            SheetLaw::Paper(law) => springs(&triangle, x)
                .iter()
                .map(|s| s.width * s.rest_length * s.table(law).integral_from_zero(s.strain()))
                .sum(),
        };
    }
    sum
}

/// Energy and nodal forces −∂E/∂x \[kPa·mm²\] of every node, clamped ones included.
pub fn forces(surface: Surface, law: &SheetLaw, x: &[DVec3], forces: &mut [DVec3]) -> Totals {
    forces.fill(DVec3::ZERO);
    let mut totals = Totals::default();
    let rows = 0..surface.sheet().nodes_per_side() - 1;
    accumulate(surface, law, x, rows, forces, None, &mut totals);
    totals
}

/// The sums that [`linearize_rows`] adds to.
pub(crate) struct Sums<'a> {
    pub forces: &'a mut [DVec3],
    pub(crate) hessian: &'a mut BlockStencil9,
    pub(crate) totals: &'a mut Totals,
}

/// Adds rows of cells to the forces, the Hessian of the energy and the totals; all are zero before the first row.
pub(crate) fn linearize_rows(
    surface: Surface,
    law: &SheetLaw,
    x: &[DVec3],
    rows: Range<usize>,
    stiffness: Stiffness,
    Sums { forces, hessian, totals }: Sums,
) {
    accumulate(surface, law, x, rows, forces, Some((stiffness, hessian)), totals);
}

/// Spring forces \[kPa·mm²\] on the nodes of a part where `wanted`; on other nodes they may be incomplete. `wanted` and
/// the forces are arrays over the part. Coupled springs in closed form, from the metric of each triangle.
pub(crate) fn forces_at(
    surface: Surface,
    law: &SheetLaw,
    x: &[DVec3],
    part: Part,
    wanted: &[bool],
) -> Vec<DVec3> {
    let SheetLaw::Coupled(law) = law else {
        let mut all = vec![DVec3::ZERO; surface.sheet().len()];
        forces(surface, law, x, &mut all);
        return part.nodes().map(|k| all[k]).collect();
    };
    let is_wanted = |i: usize, j: usize| {
        let around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        around.iter().any(|&(i, j)| wanted[part.index_at(i, j)])
    };
    // Each edge pulls its two ends together; A/h of a triangle of half weight is h/4.
    let quarter = 0.25 * surface.sheet().spacing_mm();
    let square = |[bottom, top, left, right]: [DVec3; 4]| {
        let pulls = [[top, right], [top, left], [bottom, left], [bottom, right]];
        let [[along0, across0], [along1, across1], [along2, across2], [along3, across3]] =
            pulls.map(|columns| tensions(law, columns));
        let (bottom, top) = ((along2 + along3) * quarter, (along0 + along1) * quarter);
        let (left, right) = ((across1 + across2) * quarter, (across0 + across3) * quarter);
        [bottom + left, right - bottom, -(top + right), top - left]
    };
    sums(surface, x, part, is_wanted, |rest, x| triangle_forces(law, rest, x), square)
}

/// Forces of a triangle on its nodes, −∂W/∂x = −A·P ∇φ.
#[inline]
fn triangle_forces(law: &CoupledLaw, rest: &Rest, x: [DVec3; 3]) -> [DVec3; 3] {
    let [p1, p2] = tensions(law, Principal::columns(rest, x));
    rest.gradients.map(|g| (p1 * g.x + p2 * g.y) * -rest.area)
}

/// Columns of the first Piola–Kirchhoff tension P = F S \[kPa·mm\].
#[inline(always)]
fn tensions(law: &CoupledLaw, [f1, f2]: [DVec3; 2]) -> [DVec3; 2] {
    let metric = [f1.length_squared(), f2.length_squared(), f1.dot(f2)];
    let [s11, s22, s12] = law.second_piola_kirchhoff(metric);
    [f1 * s11 + f2 * s12, f1 * s12 + f2 * s22]
}

fn accumulate(
    surface: Surface,
    law: &SheetLaw,
    x: &[DVec3],
    rows: Range<usize>,
    forces: &mut [DVec3],
    mut hessian: Option<(Stiffness, &mut BlockStencil9)>,
    totals: &mut Totals,
) {
    let sheet = surface.sheet();
    for j in rows {
        let (first, last) = sheet.cell_span(j);
        for i in first..last {
            let (triangles, weight) = sheet.local_triangles(i, j);
            if triangles.is_empty() {
                continue;
            }
            let corners = sheet.corners(i, j);
            let mut blocks = [DMat3::ZERO; 10];
            for local in triangles {
                let nodes = local.map(|c| corners[c]);
                let mut triangle = Triangle {
                    rest: Rest::new(surface, nodes, weight),
                    x: nodes.map(|k| x[k]),
                    forces: [DVec3::ZERO; 3],
                    blocks: hessian.as_ref().map(|(kind, _)| (*kind, local, &mut blocks)),
                };
                match law {
                    SheetLaw::Coupled(law) => totals.energy += triangle.add_coupled(law),
                    SheetLaw::Paper(law) => {
                        let (energy, outside) = triangle.add_paper(law);
                        totals.energy += energy;
                        totals.outside_law |= outside;
                    }
                }
                for (k, force) in nodes.into_iter().zip(triangle.forces) {
                    forces[k] += force;
                    totals.squared_forces += force.length_squared();
                }
            }
            if let Some((_, hessian)) = &mut hessian {
                for ((from, _, array), block) in PAIRS.iter().zip(&blocks) {
                    let k = corners[*from];
                    match hessian.upper.get_mut(*array) {
                        Some(upper) => upper[k] += *block,
                        None => hessian.diagonal[k] += *block,
                    }
                }
            }
        }
    }
}

/// A triangle being added up.
struct Triangle<'a> {
    rest: Rest,
    x: [DVec3; 3],
    forces: [DVec3; 3],
    /// Which Hessian, the triangle's corners in its cell, the cell's blocks.
    blocks: Option<(Stiffness, &'a [usize; 3], &'a mut [DMat3; 10])>,
}

impl Triangle<'_> {
    fn add_coupled(&mut self, law: &CoupledLaw) -> f64 {
        let area = self.rest.area;
        let columns = Principal::columns(&self.rest, self.x);
        let Some((kind, local, blocks)) = &mut self.blocks else {
            self.forces = triangle_forces(law, &self.rest, self.x);
            return area * law.energy(Principal::stretches(columns).map(|l| l - 1.0));
        };
        let principal = Principal::new(columns);
        let [l1, l2] = principal.stretch;
        let strain = [l1 - 1.0, l2 - 1.0];
        let [n1, n2] = principal.rest;
        let [u1, u2] = principal.deformed;
        let along = self.rest.gradients.map(|g| (g.dot(n1), g.dot(n2)));
        let response = law.response(strain);
        let [t1, t2] = response.tension;
        for (force, (p, q)) in self.forces.iter_mut().zip(along) {
            *force = (u1 * (t1 * p) + u2 * (t2 * q)) * -area;
        }
        let [w11, w12, w22] = response.stiffness.map(|w| w * area);
        let mut twist = (t1 + t2) / (l1 + l2) * area;
        let mut out = [t1 / l1.max(1e-9) * area, t2 / l2.max(1e-9) * area];
        if *kind == Stiffness::Positive {
            twist = twist.max(0.0);
            let least = MIN_OUT_OF_PLANE_STIFFNESS * (w11 + w22);
            out = out.map(|o| o.max(least));
        }
        let shear = response.shear * area;
        let (same, cross) = (0.5 * (shear + twist), 0.5 * (shear - twist));
        let modes = [outer(u1, u1), outer(u1, u2), outer(u2, u1), outer(u2, u2)];
        let normal = u1.cross(u2);
        let normal = outer(normal, normal);
        let block = |a: usize, b: usize| {
            let ((pa, qa), (pb, qb)) = (along[a], along[b]);
            let (pp, qq) = (pa * pb, qa * qb);
            modes[0] * (w11 * pp + same * qq)
                + modes[1] * (w12 * pa * qb + cross * qa * pb)
                + modes[2] * (w12 * qa * pb + cross * pa * qb)
                + modes[3] * (w22 * qq + same * pp)
                + normal * (out[0] * pp + out[1] * qq)
        };
        // The gradients of the three nodes sum to zero, and so do the rows of blocks.
        let (b11, b12, b22) = (block(1, 1), block(1, 2), block(2, 2));
        let (b10, b20) = (-(b11 + b12), -(b12.transpose() + b22));
        place(blocks, local[1], local[1], &b11);
        place(blocks, local[1], local[2], &b12);
        place(blocks, local[2], local[2], &b22);
        place(blocks, local[1], local[0], &b10);
        place(blocks, local[2], local[0], &b20);
        place(blocks, local[0], local[0], &-(b10 + b20));
        area * response.energy
    }

    fn add_paper(&mut self, law: &PaperLaw) -> (f64, bool) {
        let (mut energy, mut outside) = (0.0, false);
        for s in springs(&self.rest, self.x) {
            let strain = s.strain();
            let table = s.table(law);
            outside |= strain > table.end();
            let (tension, slope) = table.value_and_slope(strain);
            energy += s.width * s.rest_length * table.integral_from_zero(strain);
            let length = s.vector.length().max(1e-12);
            let direction = s.vector / length;
            let force = direction * (tension * s.width);
            self.forces[s.ends.0] += force;
            self.forces[s.ends.1] -= force;
            if let Some((kind, local, blocks)) = &mut self.blocks {
                let mut along = slope * s.width / s.rest_length;
                let mut across = tension * s.width / length;
                if *kind == Stiffness::Positive {
                    let stiffness = slope.abs() + tension.abs();
                    let least = MIN_SPRING_STIFFNESS * stiffness * s.width / s.rest_length;
                    (along, across) = (along.max(least), across.max(least));
                }
                let block =
                    outer(direction, direction) * (along - across) + DMat3::IDENTITY * across;
                let (a, b) = (local[s.ends.0], local[s.ends.1]);
                place(blocks, a, a, &block);
                place(blocks, b, b, &block);
                place(blocks, a, b, &-block);
            }
        }
        (energy, outside)
    }
}

#[inline]
fn place(blocks: &mut [DMat3; 10], a: usize, b: usize, block: &DMat3) {
    let (place, swapped) = PLACE[a][b];
    blocks[place] += if swapped { block.transpose() } else { *block };
}

/// One spring's share in a triangle.
struct SpringShare {
    /// Places of its ends in the triangle.
    ends: (usize, usize),
    is_diagonal: bool,
    /// From the first end to the second, deformed \[mm\].
    vector: DVec3,
    rest_length: f64,
    /// The width it stands for \[mm\].
    width: f64,
}

impl SpringShare {
    fn strain(&self) -> f64 {
        self.vector.length() / self.rest_length - 1.0
    }

    fn table<'a>(&self, law: &'a PaperLaw) -> &'a crate::springs::table::Table {
        if self.is_diagonal { &law.diagonal } else { &law.edge }
    }
}

/// The two edges and the diagonal of a triangle, the right angle at its first node.
///
/// Widths: in a square cell L/2 for every spring (the paper); with the triangle's area A, an edge
/// of length l has A/l and the diagonal √2·A/l, which is the same there and fits the border.
fn springs(rest: &Rest, x: [DVec3; 3]) -> [SpringShare; 3] {
    [(0, 1, false), (0, 2, false), (1, 2, true)].map(|(a, b, is_diagonal)| {
        let rest_length = rest.corners[a].distance(rest.corners[b]);
        let share = if is_diagonal { std::f64::consts::SQRT_2 } else { 1.0 };
        SpringShare {
            ends: (a, b),
            is_diagonal,
            vector: x[b] - x[a],
            rest_length,
            width: share * rest.area / rest_length,
        }
    })
}

#[cfg(test)]
mod tests;
