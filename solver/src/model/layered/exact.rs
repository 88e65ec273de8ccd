//! The layered body in f64: energy and forces of all nodes, from the same laws and cells as `lanes`.

use super::LayeredLaw;
use super::attachment::PAIRS;
use super::border::BorderCell;
use super::cell;
use super::deformed::Matrix;
use super::lanes::{is_in_ring, is_large};
use super::modes::{Corners, Modes, modes, on_faces};
use super::shape::Plain;
use super::sides::{self, Oblique, Sides, Skew};
use super::variation::Variation;
use crate::mesh::part::Part;
use crate::mesh::vec3::sub;
use crate::mesh::{Attachment, NodeKind, Pocket, Rest, Sheet};
use crate::model::membrane::assembly;
use crate::springs::solids::{ExactLaw, of_law};
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::ops::Range;

/// The body.
pub struct Exact<'a> {
    pub rest: &'a Rest,
    pub law: &'a LayeredLaw,
    pub pocket: Pocket,
    pub attachment: Option<Attachment>,
    /// Forces at rest on the nodes of all layers \[kPa·mm²\], which a dead load holds: those of the skin, less a change of weight. Empty
    /// where they are zero, of all layers or of one.
    pub at_rest: Cow<'a, [Vec<DVec3>]>,
}

/// The deformation in the middle of a cell.
pub struct CellState {
    /// Index of the tissue, from the inner face outwards.
    pub solid: usize,
    /// Deformation gradient.
    pub gradient: DMat3,
    /// Nominal stress \[kPa\].
    pub stress: DMat3,
    /// Equivalent logarithmic strain e \[-\].
    pub equivalent: f64,
    /// Corners of the cell in the sheet.
    pub corners: [usize; 4],
}

impl CellState {
    /// Upper bounds of [`Self::greatest_stretch_and_stress`]: √‖FᵀF‖ and ‖P‖, Frobenius norms.
    pub fn bounds(&self) -> (f64, f64) {
        let norm = |matrix: &DMat3| {
            let squares: f64 = [matrix.x_axis, matrix.y_axis, matrix.z_axis]
                .map(DVec3::length_squared)
                .iter()
                .sum();
            squares.sqrt()
        };
        let metric = self.gradient.transpose() * self.gradient;
        (norm(&metric).sqrt(), norm(&self.stress))
    }

    /// Greatest principal stretch \[-\] and greatest principal nominal (Biot) stress \[kPa\]. The law is isotropic: with a
    /// principal direction N of U, FN = λ RN and the stress is PN·RN.
    pub fn greatest_stretch_and_stress(&self) -> (f64, f64) {
        let (values, directions) = principal(self.gradient.transpose() * self.gradient);
        let (mut stretch, mut stress) = (0.0_f64, f64::MIN);
        for (value, direction) in values.into_iter().zip(directions) {
            let length = value.max(1e-12).sqrt();
            stretch = stretch.max(length);
            stress = stress.max((self.stress * direction).dot(self.gradient * direction) / length);
        }
        (stretch, stress)
    }
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn principal(mut a: DMat3) -> ([f64; 3], [DVec3; 3]) {
    let mut v = DMat3::IDENTITY;
    for _ in 0..8 {
        let mut is_diagonal = true;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let (app, aqq, apq) = (a.col(p)[p], a.col(q)[q], a.col(q)[p]);
            if apq.abs() <= 1e-12 * (app.abs() + aqq.abs()) {
                continue;
            }
            is_diagonal = false;
            let cotangent = (aqq - app) / (2.0 * apq);
            let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
            let c = 1.0 / tangent.hypot(1.0);
            let s = tangent * c;
            // Columns p and q of A and V, then the rows of A.
            for matrix in [&mut a, &mut v] {
                let (x, y) = (matrix.col(p), matrix.col(q));
                *matrix.col_mut(p) = x * c - y * s;
                *matrix.col_mut(q) = x * s + y * c;
            }
            for k in 0..3 {
                let (x, y) = (a.col(k)[p], a.col(k)[q]);
                a.col_mut(k)[p] = x * c - y * s;
                a.col_mut(k)[q] = x * s + y * c;
            }
        }
        if is_diagonal {
            break;
        }
    }
    ([a.x_axis.x, a.y_axis.y, a.z_axis.z], [v.x_axis, v.y_axis, v.z_axis])
}

/// A cell of the sheet with its shape and rule.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    cell: BorderCell,
    /// Parity of the four points in the innermost layer of cells; `None`: one point.
    parity: Option<f64>,
}

/// The rest shape of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellShape {
    pub(super) sides: Oblique<f64>,
    /// Of a cell over a curved wall.
    pub(super) skew: Option<Skew<f64>>,
    pub(super) variation: Variation<f64>,
    /// Volume over the spacing squared \[mm\].
    pub(super) volume: f64,
}

impl CellShape {
    /// The modes of a displacement without those of its gradient in the middle of the cell.
    pub(super) fn removed(&self, modes: Modes<f64>) -> Modes<f64> {
        self.skew.map_or(modes, |skew| skew.removed(self.sides.turned(modes.linear), &modes))
    }

    /// Forces on the modes of a cell, from those on its modes without skew.
    pub(super) fn handed_back(&self, forces: Modes<f64>) -> Modes<f64> {
        self.skew.map_or(forces, |skew| {
            let [x, y, z] = self.sides.stress(skew.stress(&forces));
            let linear = forces.linear;
            Modes { linear: [sub(linear[0], x), sub(linear[1], y), sub(linear[2], z)], ..forces }
        })
    }
}

/// A cell of a layer with its displacement.
pub(super) struct Element<'a> {
    pub(super) cell: BorderCell,
    pub(super) layer: usize,
    solid: usize,
    pub(super) law: &'a ExactLaw,
    pub(super) shape: CellShape,
    /// Parity of the four points; `None`: one point.
    pub(super) parity: Option<f64>,
    pub(super) modes: Modes<f64>,
}

impl<'a> Exact<'a> {
    /// The body, in balance at rest also where its skin has a natural stretch.
    #[must_use]
    pub fn new(
        rest: &'a Rest,
        law: &'a LayeredLaw,
        pocket: Pocket,
        attachment: Option<Attachment>,
    ) -> Self {
        let mut at_rest = rest.change_of_weight();
        at_rest.iter_mut().flatten().for_each(|force| *force = -*force);
        if rest.natural().is_some() {
            at_rest.resize(rest.layers(), Vec::new());
            let top = rest.layers() - 1;
            let x: Vec<DVec3> = rest.nodes(top).collect();
            let mut of_skin = vec![DVec3::ZERO; x.len()];
            assembly::forces(rest.membrane_before_growth(), &law.skin, &x, &mut of_skin);
            of_skin.iter_mut().zip(&at_rest[top]).for_each(|(skin, weight)| *skin += *weight);
            at_rest[top] = of_skin;
        }
        Self { rest, law, pocket, attachment, at_rest: at_rest.into() }
    }
}

impl Exact<'_> {
    /// The grid of columns.
    pub(super) fn sheet(&self) -> &Sheet {
        self.rest.sheet()
    }

    /// The cells of the sheet, row by row.
    pub fn places(&self) -> Vec<Place> {
        self.places_from([0; 2], |_, _| true)
    }

    /// The cells from a column and row on that are `wanted`, row by row.
    fn places_from(
        &self,
        [first, first_row]: [usize; 2],
        wanted: impl Fn(usize, usize) -> bool,
    ) -> Vec<Place> {
        let sheet = self.sheet();
        let n = sheet.nodes_per_side();
        let half = (n / 2) as f64;
        let unit = Sheet::new(n, half);
        let spacing = sheet.spacing_mm();
        let place = |i: usize, j: usize| {
            let cell = BorderCell::new(&unit, i, j)?;
            let is_regular = cell.missing.is_none()
                && cell.corners.iter().all(|&k| sheet.kinds()[k] == NodeKind::Free);
            let middle = [i, j].map(|k| (k as f64 + 0.5 - half) * spacing);
            let beyond = self.pocket.beyond(middle[0].hypot(middle[1]), middle[1]);
            let has_points = is_regular && is_in_ring(beyond, spacing);
            let sign = if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 };
            Some(Place { cell, parity: has_points.then_some(sign) })
        };
        let mut places = Vec::new();
        for j in first_row..n - 1 {
            let (from, to) = sheet.cell_span(j);
            let cells = (from.max(first)..to).filter(|&i| wanted(i, j));
            places.extend(cells.filter_map(|i| place(i, j)));
        }
        places
    }

    /// The rest shape of a cell of a layer.
    fn shape(&self, cell: &BorderCell, layer: usize) -> CellShape {
        let spacing = self.sheet().spacing_mm();
        if self.rest.is_even() {
            let height = self.rest.cells()[layer].height_mm;
            let slope = spacing / height;
            return CellShape {
                sides: Oblique::in_plane(cell.sides(), slope),
                skew: None,
                variation: Variation::new(slope),
                volume: cell.area * height,
            };
        }
        let faces = [layer, layer + 1].map(|l| cell.gather(|k| self.rest.node(l, k) / spacing));
        let (sides, skew, volume) = sides::of_rest(&modes(&faces[0], &faces[1]));
        CellShape {
            sides,
            skew: Some(skew),
            variation: Variation::of_sides(&sides),
            volume: self.rest.law_factor(layer, &cell.corners) * volume * cell.share() * spacing,
        }
    }

    /// Displacements of the corners of a face \[spacings\].
    fn face(&self, cell: &BorderCell, layer: usize, x: &[DVec3]) -> Corners<f64> {
        let per_spacing = 1.0 / self.sheet().spacing_mm();
        cell.gather(|k| (x[k] - self.rest.node(layer, k)) * per_spacing)
    }

    /// Forces −∂E/∂x \[kPa·mm²\] on all layers of nodes at the positions `x` \[mm\].
    pub fn forces(&self, x: &[Vec<DVec3>]) -> Vec<Vec<DVec3>> {
        let mut forces = vec![vec![DVec3::ZERO; self.sheet().len()]; x.len()];
        self.set_forces(&self.places(), x, &mut forces);
        forces
    }

    /// [`Self::forces`] into given vectors, for all places.
    pub(crate) fn set_forces(&self, places: &[Place], x: &[Vec<DVec3>], forces: &mut [Vec<DVec3>]) {
        forces.iter_mut().for_each(|layer| layer.fill(DVec3::ZERO));
        assembly::forces(
            self.rest.membrane(),
            &self.law.skin,
            &x[x.len() - 1],
            &mut forces[x.len() - 1],
        );
        for (forces, at_rest) in forces.iter_mut().zip(&*self.at_rest) {
            forces.iter_mut().zip(at_rest).for_each(|(force, at_rest)| *force -= *at_rest);
        }
        self.each(places, x, |element| {
            let layer = element.layer;
            for (face, l) in self.faces_forces(&element).iter().zip([layer, layer + 1]) {
                element.cell.spread(face, |k, pull| forces[l][k] -= pull);
            }
        });
        self.attached(|corners, integrals| {
            self.pull_back(&x[0], corners, integrals, &mut forces[0]);
        });
    }

    /// Forces −∂E/∂x \[kPa·mm²\] on the inner face at the nodes of a part where `wanted`; on other nodes they may be
    /// incomplete. `wanted` and the forces are arrays over the part.
    pub(crate) fn forces_on_inner(
        &self,
        x: &[&[DVec3]],
        part: Part,
        wanted: &[bool],
    ) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; self.sheet().len()];
        let is_wanted = |i: usize, j: usize| {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            corners.iter().any(|&(i, j)| wanted[part.index_at(i, j)])
        };
        let places = self.places_from(part.first_cell(), is_wanted);
        self.each_of(&places, 0..self.rest.cells().len().min(1), x, |element| {
            let [face, _] = self.faces_forces(&element);
            element.cell.spread(&face, |k, pull| forces[k] -= pull);
        });
        self.attached_from(part.first_cell(), is_wanted, |corners, integrals| {
            self.pull_back(x[0], corners, integrals, &mut forces);
        });
        let mut forces: Vec<DVec3> = part.nodes().map(|k| forces[k]).collect();
        if self.rest.cells().is_empty() {
            // The skin is the inner face.
            let of_skin =
                assembly::forces_at(self.rest.membrane(), &self.law.skin, x[0], part, wanted);
            forces.iter_mut().zip(of_skin).for_each(|(force, skin)| *force += skin);
        }
        if let Some(at_rest) = self.at_rest.first().filter(|at_rest| !at_rest.is_empty()) {
            let nodes = part.nodes().map(|k| at_rest[k]);
            forces.iter_mut().zip(nodes).for_each(|(force, at_rest)| *force -= at_rest);
        }
        forces
    }

    /// Derivatives of a cell's energy by its corners on the inner and the outer face \[kPa·mm²\].
    fn faces_forces(&self, element: &Element) -> [Corners<f64>; 2] {
        let Element { law, modes, shape, .. } = element;
        let &CellShape { sides, variation, .. } = shape;
        let force = of_law!(law, law => match element.parity {
            Some(parity) => cell::four_points(law, modes, &sides, parity, 0.0),
            None => cell::center(law, modes, &Plain { sides, variation }, 0.0),
        });
        let weight = shape.volume * self.sheet().spacing_mm();
        on_faces(&shape.handed_back(force).weighted(weight))
    }

    /// Adds the attachment's forces on the corners of a cell.
    fn pull_back(
        &self,
        x: &[DVec3],
        corners: [usize; 4],
        integrals: [f64; 10],
        forces: &mut [DVec3],
    ) {
        for (value, [a, b]) in integrals.iter().zip(PAIRS) {
            let moved = |k: usize| x[corners[k]] - self.rest.node(0, corners[k]);
            forces[corners[a]] -= moved(b) * *value;
            if a != b {
                forces[corners[b]] -= moved(a) * *value;
            }
        }
    }

    /// Calls `visit` with the state in the middle of every cell between nodes of a part.
    pub(crate) fn visit(&self, x: &[&[DVec3]], part: Part, mut visit: impl FnMut(&CellState)) {
        self.each(&self.places_from(part.first(), |_, _| true), x, |element| {
            let columns = element.shape.sides.gradient(element.modes.linear);
            let (stress, equivalent) = element.law.response(columns);
            visit(&CellState {
                solid: element.solid,
                gradient: matrix(columns),
                stress: matrix(stress),
                equivalent,
                corners: element.cell.corners,
            });
        });
    }

    /// Calls `visit` with every cell of every layer at these places.
    pub(super) fn each<X: AsRef<[DVec3]>>(
        &self,
        places: &[Place],
        x: &[X],
        visit: impl FnMut(Element),
    ) {
        self.each_of(places, 0..self.rest.cells().len(), x, visit);
    }

    /// [`Self::each`] of some layers of cells.
    fn each_of<X: AsRef<[DVec3]>>(
        &self,
        places: &[Place],
        layers: Range<usize>,
        x: &[X],
        mut visit: impl FnMut(Element),
    ) {
        let spacing = self.sheet().spacing_mm();
        for &Place { cell, parity } in places {
            for layer in layers.clone() {
                let shape = self.shape(&cell, layer);
                let cells = self.rest.cells()[layer];
                let faces = [layer, layer + 1].map(|l| self.face(&cell, l, x[l].as_ref()));
                let modes = modes(&faces[0], &faces[1]);
                let sign = if layer % 2 == 0 { 1.0 } else { -1.0 };
                visit(Element {
                    cell,
                    layer,
                    solid: cells.solid,
                    law: &self.law.solids[cells.solid],
                    shape,
                    parity: parity
                        .filter(|_| is_large(spacing, cells.height_mm))
                        .map(|parity| sign * parity),
                    modes: shape.removed(modes),
                });
            }
        }
    }

    /// Elastic energy, and that of the dead load \[kPa·mm³\], at the positions `x` \[mm\]; infinite if a cell is inverted, or nearly so.
    pub fn energy(&self, places: &[Place], x: &[Vec<DVec3>]) -> f64 {
        let top = x.len() - 1;
        let mut energy = assembly::energy(self.rest.membrane(), &self.law.skin, &x[top]);
        for (layer, at_rest) in self.at_rest.iter().enumerate() {
            for (k, at_rest) in at_rest.iter().enumerate() {
                energy += at_rest.dot(x[layer][k] - self.rest.node(layer, k));
            }
        }
        let area = self.sheet().spacing_mm().powi(2);
        self.each(places, x, |element| {
            let Element { law, modes, shape, parity, .. } = &element;
            let CellShape { sides, variation, volume, .. } = shape;
            let of_cell = of_law!(law, law => cell::energy(law, modes, sides, variation, *parity));
            energy += of_cell * volume * area;
        });
        self.attached(|corners, integrals| {
            let moved = corners.map(|k| x[0][k] - self.rest.node(0, k));
            for (value, [a, b]) in integrals.iter().zip(PAIRS) {
                let twice = if a == b { 0.5 } else { 1.0 };
                energy += twice * value * moved[a].dot(moved[b]);
            }
        });
        energy
    }

    /// Calls `visit` with the corners and the integrals \[kPa·mm\] of every attached cell.
    pub(super) fn attached(&self, visit: impl FnMut([usize; 4], [f64; 10])) {
        self.attached_from([0; 2], |_, _| true, visit);
    }

    /// [`Self::attached`] of the cells from a column and row on that are `wanted`.
    fn attached_from(
        &self,
        [first, first_row]: [usize; 2],
        wanted: impl Fn(usize, usize) -> bool,
        mut visit: impl FnMut([usize; 4], [f64; 10]),
    ) {
        let Some(attachment) = self.attachment else { return };
        let sheet = self.sheet();
        let (n, spacing) = (sheet.nodes_per_side(), sheet.spacing_mm());
        let half = (n / 2) as f64;
        for j in first_row..n - 1 {
            for i in (first..n - 1).filter(|&i| wanted(i, j)) {
                let corners = sheet.corners(i, j);
                if !corners.iter().any(|&k| sheet.kinds()[k] == NodeKind::Free) {
                    continue;
                }
                let at = [i, j].map(|k| (k as f64 - half) * spacing);
                if let Some(integrals) = attachment.integrals(self.pocket, at, spacing) {
                    let area = self.rest.area(corners);
                    visit(corners, integrals.map(|value| value * area));
                }
            }
        }
    }
}

fn matrix(columns: Matrix<f64>) -> DMat3 {
    let [x, y, z] = columns.map(DVec3::from);
    DMat3::from_cols(x, y, z)
}

#[cfg(test)]
mod tests;
