//! The paper's sample: a square of unit cells with a free border, under either spring law.
//!
//! A cell is 1 mm wide and the layer 1 mm thick; a force in mN per border edge equals a stress in kPa.
//! Contents: energy, forces, Hessian, stability. Loads and protocols: [`super::tension`].

use super::dense::Matrix;
use glam::{DMat2, DVec2};
use implant_preview_core::curve::Curve;
use implant_preview_core::springs::{Springs, paper, paper::Spring};

/// Side of a cell \[mm\].
pub const CELL_MM: f64 = 1.0;
/// Thickness of the layer \[mm\].
pub const THICKNESS_MM: f64 = 1.0;
/// Threshold of instability: a shape is unstable if the smallest eigenvalue of the Hessian, without rigid
/// motions, lies below minus this fraction of the small-strain edge stiffness `Ef′(0)·h`.
pub const STABILITY_THRESHOLD: f64 = 1e-3;

/// A square sample of `cells` × `cells` cells. Node (i, j) has the index `j·(cells+1) + i`.
#[derive(Clone, Debug)]
pub struct Sample {
    cells: usize,
    curve: Curve,
    poisson_ratio: f64,
    rest: Vec<DVec2>,
    /// Springs of the paper's law: nodes, kind, Sq \[mm²\].
    bars: Vec<([usize; 2], Spring, f64)>,
    /// Triangles of the coupled law.
    triangles: Vec<Triangle>,
}

/// Two edges and a diagonal of a cell.
#[derive(Clone, Debug)]
struct Triangle {
    nodes: [usize; 3],
    /// Shape function gradients ∇N \[1/mm\].
    gradients: [DVec2; 3],
    /// Half the rest area (each cell is split along both diagonals) times thickness \[mm³\].
    volume: f64,
}

impl Sample {
    /// Creates a sample of `cells` × `cells` cells of the given law and material.
    #[must_use]
    pub fn new(cells: usize, springs: Springs, curve: &Curve, poisson_ratio: f64) -> Self {
        let side = cells + 1;
        let rest = (0..side * side)
            .map(|k| CELL_MM * DVec2::new((k % side) as f64, (k / side) as f64))
            .collect();
        let mut sample = Self {
            cells,
            curve: curve.clone(),
            poisson_ratio,
            rest,
            bars: Vec::new(),
            triangles: Vec::new(),
        };
        match springs {
            Springs::Nikolaev => sample.add_bars(),
            Springs::Coupled => sample.add_triangles(),
        }
        sample
    }

    /// Adds the six springs of every cell, each with Sq = L/2·h; springs on shared edges are summed.
    fn add_bars(&mut self) {
        let n = self.cells;
        let width = 0.5 * CELL_MM * THICKNESS_MM;
        for j in 0..=n {
            let cells = if j == 0 || j == n { 1.0 } else { 2.0 };
            for i in 0..n {
                self.bars.push((
                    [self.node(i, j), self.node(i + 1, j)],
                    Spring::Edge,
                    cells * width,
                ));
                self.bars.push((
                    [self.node(j, i), self.node(j, i + 1)],
                    Spring::Edge,
                    cells * width,
                ));
            }
        }
        for j in 0..n {
            for i in 0..n {
                let [a, b, c, d] = self.corners(i, j);
                self.bars.push(([a, c], Spring::Diagonal, width));
                self.bars.push(([b, d], Spring::Diagonal, width));
            }
        }
    }

    /// Adds four triangles of half weight per cell: every cell is split along both diagonals.
    fn add_triangles(&mut self) {
        for j in 0..self.cells {
            for i in 0..self.cells {
                let [a, b, c, d] = self.corners(i, j);
                for nodes in [[a, b, c], [a, c, d], [a, b, d], [b, c, d]] {
                    let [p, q, r] = nodes.map(|node| self.rest[node]);
                    let twice_area = (q - p).perp_dot(r - p);
                    let gradients = [r - q, p - r, q - p].map(|edge| edge.perp() / twice_area);
                    let volume = 0.5 * 0.5 * twice_area * THICKNESS_MM;
                    self.triangles.push(Triangle { nodes, gradients, volume });
                }
            }
        }
    }

    fn node(&self, i: usize, j: usize) -> usize {
        j * (self.cells + 1) + i
    }

    /// Corners of cell (i, j), counter-clockwise.
    fn corners(&self, i: usize, j: usize) -> [usize; 4] {
        [self.node(i, j), self.node(i + 1, j), self.node(i + 1, j + 1), self.node(i, j + 1)]
    }

    /// Rest positions \[mm\], one per node.
    #[must_use]
    pub fn rest(&self) -> &[DVec2] {
        &self.rest
    }

    /// The curve of the material.
    #[must_use]
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The Poisson ratio ν of the material \[-\].
    #[must_use]
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// The small-strain stiffness Ef′(0)·h of an edge between two cells \[kPa·mm\].
    #[must_use]
    pub fn edge_stiffness(&self) -> f64 {
        self.curve.small_strain_modulus() * THICKNESS_MM
    }

    /// Dead loads \[mN\] of the homogeneous nominal stress P \[kPa\]: every border edge of a cell applies
    /// half of P·N·L·h to each of the edge's two nodes. P = σ x⊗x is the paper's loading: equal forces on
    /// both nodes of each border cell, twice the force on nodes of two cells.
    #[must_use]
    pub fn border_loads(&self, stress: DMat2) -> Vec<DVec2> {
        let mut loads = vec![DVec2::ZERO; self.rest.len()];
        let n = self.cells;
        let half_section = 0.5 * CELL_MM * THICKNESS_MM;
        for k in 0..n {
            for (nodes, normal) in [
                ([self.node(n, k), self.node(n, k + 1)], DVec2::X),
                ([self.node(0, k), self.node(0, k + 1)], DVec2::NEG_X),
                ([self.node(k, n), self.node(k + 1, n)], DVec2::Y),
                ([self.node(k, 0), self.node(k + 1, 0)], DVec2::NEG_Y),
            ] {
                for node in nodes {
                    loads[node] += half_section * (stress * normal);
                }
            }
        }
        loads
    }

    /// Strain energy \[mN·mm\] of a shape.
    #[must_use]
    pub fn energy(&self, x: &[DVec2]) -> f64 {
        let bars: f64 = self
            .bars
            .iter()
            .map(|&(nodes, spring, width)| {
                let (rest, strain, _) = self.bar(nodes, x);
                width * rest * paper::energy(spring, &self.curve, self.poisson_ratio, strain)
            })
            .sum();
        let triangles: f64 = self
            .triangles
            .iter()
            .map(|triangle| {
                let strain = strain_and_rotation(triangle.deformation(x)).0;
                triangle.volume * self.curve.energy(self.equivalent(strain))
            })
            .sum();
        bars + triangles
    }

    /// Forces \[mN\] of the springs on the nodes of a shape: minus the gradient of the energy.
    #[must_use]
    pub fn forces(&self, x: &[DVec2]) -> Vec<DVec2> {
        let mut forces = vec![DVec2::ZERO; x.len()];
        self.add_forces(x, &mut forces);
        forces
    }

    /// Adds the forces of the springs \[mN\] to `forces`.
    pub fn add_forces(&self, x: &[DVec2], forces: &mut [DVec2]) {
        for &(nodes, spring, width) in &self.bars {
            let (_, strain, direction) = self.bar(nodes, x);
            let tension = paper::tension(spring, &self.curve, self.poisson_ratio, strain);
            forces[nodes[0]] += width * tension * direction;
            forces[nodes[1]] -= width * tension * direction;
        }
        for triangle in &self.triangles {
            let force = self.triangle_forces(triangle, triangle.nodes.map(|node| x[node]));
            for (node, force) in triangle.nodes.into_iter().zip(force) {
                forces[node] += force;
            }
        }
    }

    /// Rest length \[mm\], strain \[-\] and direction of a spring.
    fn bar(&self, [a, b]: [usize; 2], x: &[DVec2]) -> (f64, f64, DVec2) {
        let rest = self.rest[a].distance(self.rest[b]);
        let edge = x[b] - x[a];
        let length = edge.length();
        (rest, length / rest - 1.0, edge / length)
    }

    /// Equivalent strain ē of a Biot strain tensor in the coupled law \[-\].
    fn equivalent(&self, strain: DMat2) -> f64 {
        let nu = self.poisson_ratio;
        let squares = strain.x_axis.length_squared() + strain.y_axis.length_squared();
        let trace = strain.x_axis.x + strain.y_axis.y;
        (((1.0 - nu) * squares + nu * trace * trace) / (1.0 - nu * nu)).max(0.0).sqrt()
    }

    fn triangle_forces(&self, triangle: &Triangle, x: [DVec2; 3]) -> [DVec2; 3] {
        let nu = self.poisson_ratio;
        let (strain, rotation) = strain_and_rotation(triangle.deformation_of(x));
        let trace = strain.x_axis.x + strain.y_axis.y;
        let modulus = self.curve.secant(self.equivalent(strain)) / (1.0 - nu * nu);
        let biot = modulus * ((1.0 - nu) * strain + DMat2::from_diagonal(DVec2::splat(nu * trace)));
        let nominal = triangle.volume * (rotation * biot);
        triangle.gradients.map(|gradient| -(nominal * gradient))
    }

    /// Returns `true` if a shape is outside of the law's domain: a spring outside of the paper's domain, an
    /// inverted triangle, or a position that is not a number.
    #[must_use]
    pub fn is_outside_domain(&self, x: &[DVec2]) -> bool {
        let bar_outside = |&(nodes, spring, _): &([usize; 2], Spring, f64)| {
            let strain = self.bar(nodes, x).1;
            strain.is_nan() || paper::is_outside_domain(spring, self.poisson_ratio, strain)
        };
        let is_inverted = |triangle: &Triangle| {
            let area = triangle.deformation(x).determinant();
            area.is_nan() || area <= 0.0
        };
        self.bars.iter().any(bar_outside) || self.triangles.iter().any(is_inverted)
    }

    /// The Hessian of the energy \[kPa·mm\], shape (2·nodes)², x before y per node.
    ///
    /// Exact for the paper's springs; for the triangles by central differences of their forces
    /// (relative error about 1e-9).
    pub(super) fn hessian(&self, x: &[DVec2]) -> Matrix {
        let mut matrix = Matrix::zeros(2 * x.len());
        for &(nodes, spring, width) in &self.bars {
            let (rest, strain, direction) = self.bar(nodes, x);
            let nu = self.poisson_ratio;
            let along = width * paper::slope(spring, &self.curve, nu, strain) / rest;
            let across =
                width * paper::tension(spring, &self.curve, nu, strain) / (rest * (1.0 + strain));
            let d = [direction.x, direction.y];
            for row in 0..2 {
                for column in 0..2 {
                    let unit = if row == column { across } else { 0.0 };
                    let value = (along - across) * d[row] * d[column] + unit;
                    for (a, b, sign) in [(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0), (1, 0, -1.0)] {
                        matrix.add(2 * nodes[a] + row, 2 * nodes[b] + column, sign * value);
                    }
                }
            }
        }
        for triangle in &self.triangles {
            self.add_triangle_hessian(triangle, x, &mut matrix);
        }
        matrix
    }

    fn add_triangle_hessian(&self, triangle: &Triangle, x: &[DVec2], matrix: &mut Matrix) {
        const STEP_MM: f64 = 1e-6;
        let now = triangle.nodes.map(|node| x[node]);
        for moved in 0..6 {
            let shifted = |step: f64| {
                let mut x = now;
                x[moved / 2][moved % 2] += step;
                self.triangle_forces(triangle, x)
            };
            let (forward, back) = (shifted(STEP_MM), shifted(-STEP_MM));
            for other in 0..6 {
                let (node, axis) = (other / 2, other % 2);
                let value = (back[node][axis] - forward[node][axis]) / (2.0 * STEP_MM);
                let (row, column) =
                    (2 * triangle.nodes[node] + axis, 2 * triangle.nodes[moved / 2] + moved % 2);
                // Half on each side of the diagonal: difference quotients are not exactly symmetric.
                matrix.add(row, column, 0.5 * value);
                matrix.add(column, row, 0.5 * value);
            }
        }
    }

    /// Returns `true` if the shape is stable: no eigenvalue of the Hessian without rigid motions lies below
    /// −[`STABILITY_THRESHOLD`] times the small-strain edge stiffness.
    #[must_use]
    pub fn is_stable(&self, x: &[DVec2]) -> bool {
        if self.is_outside_domain(x) {
            return false;
        }
        let mut matrix = self.hessian_without_rigid_motions(x);
        matrix.add_diagonal(STABILITY_THRESHOLD * self.edge_stiffness());
        matrix.has_cholesky_factor()
    }

    /// Smallest eigenvalue of the Hessian without rigid motions, relative to the small-strain edge
    /// stiffness \[-\]; for shapes inside the law's domain.
    #[must_use]
    pub fn least_eigenvalue(&self, x: &[DVec2]) -> f64 {
        self.hessian_without_rigid_motions(x).least_eigenvalue() / self.edge_stiffness()
    }

    /// The Hessian plus a large stiffness of the rigid motions, which removes zero eigenvalues.
    fn hessian_without_rigid_motions(&self, x: &[DVec2]) -> Matrix {
        let mut matrix = self.hessian(x);
        for mode in rigid_modes(x) {
            matrix.add_outer(1e6 * self.edge_stiffness(), &mode);
        }
        matrix
    }
}

/// The two translations and the rotation of a shape, each of length 1, as vectors of unknowns.
pub(super) fn rigid_modes(x: &[DVec2]) -> [Vec<f64>; 3] {
    let n = x.len() as f64;
    let center = x.iter().sum::<DVec2>() / n;
    let spread = x.iter().map(|x| x.distance_squared(center)).sum::<f64>().sqrt();
    let mode = |f: &dyn Fn(DVec2) -> DVec2| x.iter().flat_map(|&x| f(x).to_array()).collect();
    [
        mode(&|_| DVec2::X / n.sqrt()),
        mode(&|_| DVec2::Y / n.sqrt()),
        mode(&|x| (x - center).perp() / spread),
    ]
}

/// Biot strain E = U − I and rotation R of a deformation F = R U, closed form in two dimensions.
fn strain_and_rotation(deformation: DMat2) -> (DMat2, DMat2) {
    // RᵀF is symmetric for the rotation R with the direction (F₁₁ + F₂₂, F₂₁ − F₁₂).
    let direction = DVec2::new(
        deformation.x_axis.x + deformation.y_axis.y,
        deformation.x_axis.y - deformation.y_axis.x,
    )
    .normalize();
    let rotation = DMat2::from_cols(direction, direction.perp());
    (rotation.transpose() * deformation - DMat2::IDENTITY, rotation)
}

impl Triangle {
    fn deformation(&self, x: &[DVec2]) -> DMat2 {
        self.deformation_of(self.nodes.map(|node| x[node]))
    }

    /// F = Σ x ⊗ ∇N.
    fn deformation_of(&self, x: [DVec2; 3]) -> DMat2 {
        let mut f = DMat2::ZERO;
        for (x, gradient) in x.into_iter().zip(self.gradients) {
            f += DMat2::from_cols(x * gradient.x, x * gradient.y);
        }
        f
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::curve::CurveSpec;
    use implant_preview_core::springs::coupled;

    #[test]
    fn hessian_is_the_derivative_of_the_forces() {
        let curve = Curve::new(&CurveSpec::Adipose {}).unwrap();
        for springs in [Springs::Nikolaev, Springs::Coupled] {
            let sample = Sample::new(2, springs, &curve, 0.3);
            let x: Vec<DVec2> = (sample.rest().iter().enumerate())
                .map(|(k, p)| {
                    let t = k as f64;
                    DVec2::new(1.3 * p.x + 0.1 * p.y, 0.9 * p.y)
                        + 0.05 * DVec2::new(t.sin(), (2.0 * t).cos())
                })
                .collect();
            let hessian = sample.hessian(&x);
            let step = 1e-6;
            for moved in 0..2 * x.len() {
                let at = |step: f64| {
                    let mut x = x.clone();
                    x[moved / 2][moved % 2] += step;
                    sample.forces(&x)
                };
                let (forward, back) = (at(step), at(-step));
                for other in 0..2 * x.len() {
                    let (node, axis) = (other / 2, other % 2);
                    let wanted = (back[node][axis] - forward[node][axis]) / (2.0 * step);
                    assert!((hessian.get(other, moved) - wanted).abs() < 1e-7, "{springs:?}");
                }
            }
        }
    }

    #[test]
    fn coupled_forces_are_the_law_of_the_springs_module() {
        // A sample in a homogeneous biaxial state: the border loads are the law's principal stresses.
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        let sample = Sample::new(3, Springs::Coupled, &curve, 0.45);
        let strain = [0.5, 0.2];
        let x: Vec<DVec2> = sample
            .rest()
            .iter()
            .map(|p| DVec2::from_angle(0.7).rotate(*p * (DVec2::ONE + DVec2::from(strain))))
            .collect();
        let stress = coupled::biot_stress(&curve, 0.45, strain);
        let loads = sample.border_loads(DMat2::from_diagonal(DVec2::from(stress)));
        for (force, load) in sample.forces(&x).iter().zip(loads) {
            let load = DVec2::from_angle(0.7).rotate(load);
            assert!((*force + load).length() < 1e-12 * stress[0]);
        }
    }
}
