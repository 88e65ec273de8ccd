//! The second derivative of the body's energy in f64, cell by cell, without an assembled matrix.
//!
//! Of a cell, with D = ∂²/∂F² at its points (without `bend` of [`Curvature`]), B the map from modes to the gradient at a
//! point, and vectors t of all modes:
//!
//! H = Σ Bᵀ D B + diag(variation) + Σ c·t tᵀ.
//!
//! * One point: D with `volumetric`, t = α·½∂g/∂modes + β·∂J/∂modes, c = `bend`.
//! * Four points: D of a quarter of the changes of shape at each point and of the common pressure; t of each point with
//!   c = `bend`/4, and t = ∂J̄/∂modes with c the mean of `volumetric`.

use super::attachment::PAIRS;
use super::border::BorderCell;
use super::cell;
use super::deformed::{Deformed, Matrix, StressSlopes, combined, nominal_stress, stress_slopes};
use super::exact::{CellShape, Element, Exact, Place};
use super::modes::{Modes, modes, on_faces};
use super::sides::{Oblique, Sides};
use super::stiffness::CORNERS;
use super::variation::Variation;
use crate::mesh::stencil::outer;
use crate::mesh::vec3::{add, dot, scale};
use crate::springs::solids::{Curvature, SolidLaw, Volume, of_law};
use glam::{DMat3, DVec3};

/// The second derivative at one shape.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tangent {
    cells: Vec<Cell>,
    points: Vec<Point>,
    /// c and t.
    vectors: Vec<(f64, Modes<f64>)>,
    /// Corners of attached cells and the integrals of the attachment \[kPa·mm\].
    attached: Vec<([usize; 4], [f64; 10])>,
    squared_forces: f64,
}

#[derive(Clone, Debug)]
struct Cell {
    cell: BorderCell,
    layer: usize,
    shape: CellShape,
    /// What varies inside, times the stiffness.
    variation: Variation<f64>,
    /// Ends of this cell's points and vectors in the lists.
    ends: [usize; 2],
}

/// A point of a cell on \[−½, ½\]³.
#[derive(Clone, Debug)]
struct Point {
    at: [f64; 3],
    slopes: StressSlopes,
}

impl Tangent {
    pub(crate) fn clear(&mut self) {
        self.cells.clear();
        self.points.clear();
        self.vectors.clear();
        self.squared_forces = 0.0;
    }

    /// Sum of the squared forces of all cells \[(kPa·mm²)²\].
    pub(crate) fn squared_forces(&self) -> f64 {
        self.squared_forces
    }

    /// Adds the attachment, which no shape changes.
    pub(crate) fn attach(&mut self, exact: &Exact) {
        self.attached.clear();
        exact.attached(|corners, integrals| self.attached.push((corners, integrals)));
    }

    /// Adds the cells at these places, for the positions `x` \[mm\].
    pub(crate) fn linearize(&mut self, exact: &Exact, places: &[Place], x: &[Vec<DVec3>]) {
        let spacing = exact.sheet().spacing_mm();
        exact.each(places, x, |element| {
            let Element { law, modes, shape, .. } = &element;
            let stress = nominal_stress(law, shape.sides.gradient(modes.linear));
            let squares = dot(stress[0], stress[0]) + dot(stress[1], stress[1]);
            self.squared_forces += squares * (shape.volume * spacing).powi(2);
            let variation = match element.parity {
                None => self.one_point(&element),
                Some(parity) => {
                    self.four_points(&element, parity);
                    Variation::default()
                }
            };
            self.cells.push(Cell {
                cell: element.cell,
                layer: element.layer,
                shape: element.shape,
                variation,
                ends: [self.points.len(), self.vectors.len()],
            });
        });
    }

    /// Adds the point and the vector of a cell; returns what varies inside.
    fn one_point(&mut self, element: &Element) -> Variation<f64> {
        let Element { law, modes, shape: CellShape { sides, variation, .. }, .. } = element;
        let columns = sides.gradient(modes.linear);
        let deformed = Deformed::new(columns);
        let shape = deformed.isochoric();
        let g = shape.g + variation.mean_square(modes);
        let Curvature { shear, pressure, along: [alpha, beta], bend, volumetric, .. } =
            of_law!(law, law => law.curvature(g, deformed.volume(), 0.0));
        let linear = sides.stress(deformed.stress(&shape, alpha, beta));
        self.vectors.push((bend, Modes { linear, ..variation.weighted(alpha).slopes(modes) }));
        let slopes = stress_slopes(columns, shear, pressure, volumetric);
        self.points.push(Point { at: [0.0; 3], slopes });
        variation.weighted(shear)
    }

    /// Adds the points and the vectors of a cell.
    fn four_points(&mut self, element: &Element, parity: f64) {
        let Element { law, modes, shape: CellShape { sides, .. }, .. } = element;
        let (points, volume) = cell::deformed_points(modes, sides, parity);
        let volume = Volume::new(volume);
        let shapes = points.map(|(point, _)| point.isochoric());
        let curvatures =
            of_law!(law, law => shapes.map(|shape| law.curvature(shape.g, volume, 0.0)));
        let pressure = 0.25 * mean(curvatures.map(|curvature| curvature.pressure));
        let mut volume_slope = Modes::default();
        for (point, at) in &points {
            volume_slope = sum(&volume_slope, &to_modes(point.cofactors, *at, sides, 0.25));
        }
        for (k, (point, at)) in points.iter().enumerate() {
            let Curvature { shear, along: [alpha, beta], bend, .. } = curvatures[k];
            let shape = to_modes(point.stress(&shapes[k], alpha, 0.0), *at, sides, 1.0);
            self.vectors.push((0.25 * bend, sum(&shape, &volume_slope.weighted(beta))));
            let slopes = stress_slopes(point.columns, 0.25 * shear, pressure, 0.0);
            self.points.push(Point { at: *at, slopes });
        }
        let volumetric = mean(curvatures.map(|curvature| curvature.volumetric));
        self.vectors.push((volumetric, volume_slope));
    }

    /// Adds H v to `out`, both of every node.
    pub(crate) fn add_product(&self, v: &[Vec<DVec3>], out: &mut [Vec<DVec3>]) {
        let (mut point, mut vector) = (0, 0);
        for Cell { cell, layer, shape, variation, ends } in &self.cells {
            let CellShape { sides, volume, .. } = shape;
            let faces = [*layer, layer + 1].map(|l| cell.gather(|k| v[l][k]));
            let modes = shape.removed(modes(&faces[0], &faces[1]));
            let mut force = variation.slopes(&modes);
            for Point { at, slopes } in &self.points[point..ends[0]] {
                let stress = slopes.product(from_modes(&modes, *at, sides));
                force = sum(&force, &to_modes(stress, *at, sides, 1.0));
            }
            for (c, t) in &self.vectors[vector..ends[1]] {
                force = sum(&force, &t.weighted(c * product(t, &modes)));
            }
            [point, vector] = *ends;
            let force = shape.handed_back(force).weighted(*volume);
            for (face, l) in on_faces(&force).iter().zip([*layer, layer + 1]) {
                cell.spread(face, |k, pull| out[l][k] += pull);
            }
        }
        for (corners, integrals) in &self.attached {
            for (value, [a, b]) in integrals.iter().zip(PAIRS) {
                let (a, b) = (corners[a], corners[b]);
                out[0][a] += v[0][b] * *value;
                if a != b {
                    out[0][b] += v[0][a] * *value;
                }
            }
        }
    }

    /// Adds the blocks of each node, and of each node and the node above, as (layer, node, block); the attachment's as the sum of
    /// its row, an upper bound.
    pub(crate) fn visit_blocks(
        &self,
        mut diagonal: impl FnMut(usize, usize, DMat3),
        mut above: impl FnMut(usize, usize, DMat3),
    ) {
        let (mut point, mut vector) = (0, 0);
        for Cell { cell, layer, shape, variation, ends } in &self.cells {
            let (points, vectors) = (&self.points[point..ends[0]], &self.vectors[vector..ends[1]]);
            [point, vector] = *ends;
            let own = variation.in_plane / 4.0 + variation.through / 2.0 + variation.d;
            let pair = variation.in_plane / 4.0 - variation.through / 2.0 - variation.d;
            for (corner, &k) in cell.corners.iter().enumerate() {
                if cell.missing == Some(corner) {
                    continue;
                }
                let [sx, sy] = CORNERS[corner].map(|bit| if bit == 1 { 1.0 } else { -1.0 });
                let [low, high] = [-1.0, 1.0].map(|sz| NodeModes::new([sx, sy, sz], shape));
                let block = |[a, b]: [NodeModes; 2], variation: f64| {
                    let mut block = DMat3::from_diagonal(DVec3::splat(variation));
                    for Point { at, slopes } in points {
                        block += slopes.block([a, b].map(|node| node.gradient(*at, &shape.sides)));
                    }
                    for (c, t) in vectors {
                        let [a, b] = [a, b].map(|node| node.along(t));
                        block += outer(a, b) * *c;
                    }
                    block * shape.volume
                };
                diagonal(*layer, k, block([low, low], own));
                diagonal(layer + 1, k, block([high, high], own));
                above(*layer, k, block([low, high], pair));
            }
        }
        for (corners, integrals) in &self.attached {
            for (value, [a, b]) in integrals.iter().zip(PAIRS) {
                let block = DMat3::from_diagonal(DVec3::splat(*value));
                diagonal(0, corners[a], block);
                if a != b {
                    diagonal(0, corners[b], block);
                }
            }
        }
    }
}

fn mean(values: [f64; 4]) -> f64 {
    0.25 * values.iter().sum::<f64>()
}

fn sum(a: &Modes<f64>, b: &Modes<f64>) -> Modes<f64> {
    let of = |a: &Matrix<f64>, b: &Matrix<f64>| [0, 1, 2].map(|k| add(a[k], b[k]));
    Modes { linear: of(&a.linear, &b.linear), twist: of(&a.twist, &b.twist), d: add(a.d, b.d) }
}

fn product(a: &Modes<f64>, b: &Modes<f64>) -> f64 {
    let of = |a: &Matrix<f64>, b: &Matrix<f64>| (0..3).map(|k| dot(a[k], b[k])).sum::<f64>();
    of(&a.linear, &b.linear) + of(&a.twist, &b.twist) + dot(a.d, b.d)
}

/// The displacement gradient of modes at a point.
fn from_modes(modes: &Modes<f64>, at: [f64; 3], sides: &Oblique<f64>) -> Matrix<f64> {
    let [p, q, r] = at;
    let Modes { linear: [x, y, z], twist: [xy, xz, yz], d } = *modes;
    let column = |own, a, s, b, t| add(own, add(add(scale(a, s), scale(b, t)), scale(d, s * t)));
    sides.turned([column(x, xy, q, xz, r), column(y, xy, p, yz, r), column(z, xz, p, yz, q)])
}

/// The transpose of [`from_modes`], times a factor.
fn to_modes(stress: Matrix<f64>, at: [f64; 3], sides: &Oblique<f64>, factor: f64) -> Modes<f64> {
    let ([p, q, r], [x, y, z]) = (at, sides.stress(stress.map(|column| scale(column, factor))));
    let both = |a, s, b, t| add(scale(a, s), scale(b, t));
    Modes {
        linear: [x, y, z],
        twist: [both(x, q, y, p), both(x, r, z, p), both(y, r, z, q)],
        d: add(both(x, q * r, y, p * r), scale(z, p * q)),
    }
}

/// The modes of a node's shape function, without those of its gradient in the middle of the cell.
#[derive(Clone, Copy)]
struct NodeModes {
    linear: [f64; 3],
    twist: [f64; 3],
    d: f64,
}

impl NodeModes {
    /// Of the corner of these signs.
    fn new([sx, sy, sz]: [f64; 3], CellShape { sides, skew, .. }: &CellShape) -> Self {
        let linear = [0.25 * sx, 0.25 * sy, 0.25 * sz];
        let (twist, d) = ([0.5 * sx * sy, 0.5 * sx * sz, 0.5 * sy * sz], sx * sy * sz);
        let (twist, d) = skew.map_or((twist, d), |skew| skew.removed_from(sides, linear, twist, d));
        Self { linear, twist, d }
    }

    /// The gradient at a point.
    fn gradient(&self, [p, q, r]: [f64; 3], Oblique(columns): &Oblique<f64>) -> DVec3 {
        let Self { linear: [x, y, z], twist: [xy, xz, yz], d } = *self;
        let slopes = [
            x + xy * q + xz * r + d * q * r,
            y + xy * p + yz * r + d * p * r,
            z + xz * p + yz * q + d * p * q,
        ];
        columns.map(|column| dot(slopes, column)).into()
    }

    /// The product with a vector of all modes.
    fn along(&self, t: &Modes<f64>) -> DVec3 {
        let linear = DVec3::from(combined(t.linear, self.linear));
        linear + DVec3::from(combined(t.twist, self.twist)) + DVec3::from(t.d) * self.d
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::mesh::{Attachment, Chest, NodeKind, Pocket, Rest, Sheet};
    use crate::model::layered::LayeredLaw;
    use crate::springs::Material;
    use crate::springs::solids::SolidKind;

    /// Cells of one and of four points, at the border and inside: the product is the change of the forces, the blocks
    /// are those of the product.
    #[test]
    fn the_tangent_is_the_derivative_of_the_forces() {
        for &solid in SolidKind::ALL {
            check_tangent(Chest::Flat, solid);
            check_tangent(Chest::Curved { across_mm: 90.0, along_mm: 160.0 }, solid);
        }
    }

    fn check_tangent(chest: Chest, solid: SolidKind) {
        let material = |spec: CurveSpec, poisson_ratio: f64, thickness_mm: f64| Material {
            solid,
            ..Material::of(&spec, poisson_ratio, thickness_mm)
        };
        let materials = [
            // Nearly no skin: the skin's Hessian is tested by itself.
            material(CurveSpec::Linear { modulus_kpa: 1e-6 }, 0.4, 1e-3),
            material(CurveSpec::Exponential { scale_kpa: 2.0, rate: 3.0 }, 0.45, 20.0),
        ];
        let law = LayeredLaw::new(&materials);
        let rest = Rest::layered(Sheet::new(17, 60.0), &[20.0], 2).over(chest);
        let sheet = rest.sheet();
        let attachment = Some(Attachment::default());
        let exact =
            Exact::new(&rest, &law, Pocket { radius_mm: 30.0, lowered_mm: 6.0 }, attachment);
        let wave = |k: usize, layer: usize, phase: f64| {
            let at = 0.09 * k as f64 + layer as f64 + phase;
            DVec3::new((1.7 * at).sin(), (2.3 * at).cos(), (3.1 * at).sin())
        };
        let free = |k: usize| if sheet.kinds()[k] == NodeKind::Free { 1.0 } else { 0.0 };
        let shape = |amplitude: f64| -> Vec<Vec<DVec3>> {
            let layer = |l: usize| {
                let at = |k: usize| {
                    rest.node(l, k)
                        + (wave(k, l, 0.0) * 0.4 + wave(k, l, 0.7) * amplitude) * free(k)
                };
                (0..sheet.len()).map(at).collect()
            };
            (0..rest.layers()).map(layer).collect()
        };
        let x = shape(0.0);
        let places = exact.places();
        let mut tangent = Tangent::default();
        tangent.attach(&exact);
        tangent.linearize(&exact, &places, &x);
        let direction = |k: usize, l: usize| wave(k, l, 0.7) * free(k);
        let v: Vec<Vec<DVec3>> =
            (0..3).map(|l| (0..sheet.len()).map(|k| direction(k, l)).collect()).collect();
        let zeros = vec![vec![DVec3::ZERO; sheet.len()]; 3];
        let mut product = zeros.clone();
        tangent.add_product(&v, &mut product);
        let h = 1e-5;
        let [after, before] = [h, -h].map(|h| exact.forces(&shape(h)));
        let (mut error, mut scale) = (0.0_f64, 0.0_f64);
        for l in 0..3 {
            for k in 0..sheet.len() {
                let expected = (before[l][k] - after[l][k]) / (2.0 * h);
                error = error.max((product[l][k] - expected).length());
                scale = scale.max(expected.length());
            }
        }
        // The table of the law is piecewise linear: its slope jumps.
        assert!(error < 2e-3 * scale, "{error} {scale}");

        let at = 8 * 17 + 11;
        let (mut own, mut above) = (DMat3::ZERO, DMat3::ZERO);
        let add = |sum: &mut DMat3, layer, k, block| {
            if (layer, k) == (1, at) {
                *sum += block;
            }
        };
        tangent.visit_blocks(
            |layer, k, block| add(&mut own, layer, k, block),
            |layer, k, block| add(&mut above, layer, k, block),
        );
        for axis in 0..3 {
            for (layer, block) in [(1, own), (2, above)] {
                let (mut unit, mut row) = (zeros.clone(), zeros.clone());
                unit[layer][at][axis] = 1.0;
                tangent.add_product(&unit, &mut row);
                let difference = row[1][at] - block.col(axis);
                assert!(difference.length() < 1e-9 * own.x_axis.length(), "{difference}");
            }
        }
    }
}
