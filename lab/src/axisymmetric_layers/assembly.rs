//! Mesh and elastic energy of the tissue: cells of the solids, rings of the skin and of the attachment.
//!
//! Node (i, j): column i from the axis, row j from the inner face; its coordinates r, z are the numbers 2(i·rows + j)
//! and the next one.
//!
//! Uses `springs`, `banded`, `element`, `law`, `wall`. Used by `newton`, `mod`.

use super::banded::Banded;
use super::element::{Quadrilateral, Skin, SkinRing, attached_ring};
use super::law::SolidLaw;
use super::suction::Suction;
use super::wall::RestShape;
use implant_preview_core::mesh::Attachment;
use implant_preview_core::springs::Material;

/// Fraction of the cells within the pocket, relative to the pocket's fraction of the patch radius \[-\]. A column of
/// nodes is at the pocket's radius.
const POCKET_REFINEMENT: f64 = 1.2;

/// The tissue: elements with their laws.
pub(super) struct Tissue {
    /// Numbers of columns and rows of nodes.
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Coordinates at rest \[mm\].
    pub(super) rest: Vec<f64>,
    /// Material radii of the columns \[mm\], lengths along the wall.
    radii: Vec<f64>,
    /// Heights of the rows above the inner face without a mound \[mm\].
    heights: Vec<f64>,
    skin: Skin,
    rings: Vec<SkinRing>,
    /// Gradient of the skin's energy at rest, which a dead load holds \[mN\].
    at_rest: Vec<f64>,
    laws: Vec<SolidLaw>,
    /// Number of the law of each row of cells.
    law_of_row: Vec<usize>,
    /// Cells, column after column.
    cells: Vec<Quadrilateral>,
    /// Attachment of each ring of the inner face, \[M₀₀, M₀₁, M₁₁\] \[kPa·mm\].
    attachment: Vec<[f64; 3]>,
    /// Suction on the inner face over the pocket.
    pub(super) suction: Suction,
}

impl Tissue {
    /// Layers from the skin inwards, at least two, and whether the skin wrinkles; `cells`: along the radius, through the solids.
    pub(super) fn new(
        (layers, skin_wrinkles): (&[Material], bool),
        [columns, rows]: [usize; 2],
        patch_radius_mm: f64,
        (attachment, pocket_radius_mm): (Attachment, f64),
        RestShape { wall, mound, natural_strain, .. }: RestShape,
    ) -> Self {
        let solids: Vec<&Material> = layers[1..].iter().rev().collect();
        let thickness: Vec<f64> = solids.iter().map(|solid| solid.thickness_mm).collect();
        let mut heights = vec![0.0];
        let mut law_of_row = Vec::new();
        let mut total = 0.0;
        for (number, count) in shared_cells(&thickness, rows).into_iter().enumerate() {
            heights
                .extend((1..=count).map(|k| total + thickness[number] * k as f64 / count as f64));
            law_of_row.extend(std::iter::repeat_n(number, count));
            total += thickness[number];
        }
        let within = POCKET_REFINEMENT * pocket_radius_mm / patch_radius_mm * columns as f64;
        let within = (within.round() as usize).clamp(1, columns - 1);
        let radius = |i: usize| {
            if i <= within {
                pocket_radius_mm * i as f64 / within as f64
            } else {
                let share = (i - within) as f64 / (columns - within) as f64;
                pocket_radius_mm + share * (patch_radius_mm - pocket_radius_mm)
            }
        };
        let radii: Vec<f64> = (0..=columns).map(radius).collect();
        let factor = |s: f64| mound.map_or(1.0, |mound| mound.factor(s, total));
        let point = |i: usize, j: usize| wall.point(radii[i], heights[j] * factor(radii[i]));
        let top = heights.len() - 1;
        let nodes = (0..=columns).flat_map(|i| (0..=top).flat_map(move |j| point(i, j)));
        let cell = |i: usize, j: usize| {
            Quadrilateral::new([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)])
        };
        let cells = (0..columns).flat_map(|i| (0..top).map(move |j| cell(i, j)));
        let attached =
            |i: usize| attached_ring(attachment, [radii[i], radii[i + 1]], pocket_radius_mm, wall);
        let ring =
            |i: usize| SkinRing::new([point(i, top), point(i + 1, top)], 1.0 + natural_strain);
        let mut tissue = Self {
            columns: columns + 1,
            rows: top + 1,
            rest: nodes.collect(),
            skin: Skin { material: layers[0].clone(), wrinkles: skin_wrinkles },
            rings: (0..columns).map(ring).collect(),
            at_rest: Vec::new(),
            laws: solids.iter().map(|s| SolidLaw::new(&s.curve, s.poisson_ratio)).collect(),
            law_of_row,
            cells: cells.collect(),
            attachment: (0..columns).map(attached).collect(),
            suction: Suction { kpa: 0.0, rings: within, wall },
            radii,
            heights,
        };
        tissue.at_rest = tissue.skin_at_rest();
        tissue
    }

    /// Lets the skin grow by a part of its stretch at `x` \[-\]; the dead load stays. Returns the greatest change of a length \[-\].
    pub(super) fn grow(&mut self, x: &[f64], growth: f64) -> f64 {
        let mut greatest = 0.0_f64;
        for column in 0..self.columns - 1 {
            let numbers = self.ring_numbers(column, self.rows - 1);
            let [rest, x] = [&self.rest, x].map(|of| numbers.map(|n| of[n]));
            greatest = greatest.max(self.rings[column].grow(&rest, &x, growth));
        }
        greatest
    }

    fn skin_at_rest(&self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.rest.len()];
        for (column, ring) in self.rings.iter().enumerate() {
            let numbers = self.ring_numbers(column, self.rows - 1);
            let at_rest = ring.linearise(&self.skin, &numbers.map(|n| self.rest[n])).gradient;
            numbers.iter().zip(at_rest).for_each(|(n, pull)| gradient[*n] += pull);
        }
        gradient
    }

    /// Energy of the dead load \[µJ\].
    fn load_energy(&self, x: &[f64]) -> f64 {
        let moved = x.iter().zip(&self.rest).map(|(x, rest)| x - rest);
        -self.at_rest.iter().zip(moved).map(|(pull, moved)| pull * moved).sum::<f64>()
    }

    /// Material radius of a column \[mm\].
    pub(super) fn radius(&self, column: usize) -> f64 {
        self.radii[column]
    }

    /// The cell with a material radius \[mm\], and the fraction of its width within that radius \[-\].
    pub(super) fn locate(&self, radius_mm: f64) -> (usize, f64) {
        let (mut low, mut high) = (0, self.columns - 1);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.radius(middle) <= radius_mm { low = middle } else { high = middle }
        }
        (low, (radius_mm - self.radius(low)) / (self.radius(high) - self.radius(low)))
    }

    /// Positions of this mesh at the nodes of another one of the same tissue, bilinear in each cell.
    pub(super) fn interpolate(&self, x: &[f64], other: &Self) -> Vec<f64> {
        let heights = &self.heights;
        let node = |radius: f64, height: f64| {
            let (column, a) = self.locate(radius);
            let row = heights.partition_point(|h| *h <= height).clamp(1, self.rows - 1) - 1;
            let b = (height - heights[row]) / (heights[row + 1] - heights[row]);
            let corner = |i: usize, j: usize, k: usize| x[self.number(column + i, row + j) + k];
            [0, 1].map(|k| {
                (1.0 - b) * ((1.0 - a) * corner(0, 0, k) + a * corner(1, 0, k))
                    + b * ((1.0 - a) * corner(0, 1, k) + a * corner(1, 1, k))
            })
        };
        let column = |radius: &f64| {
            let radius = *radius;
            other.heights.iter().flat_map(move |height| node(radius, *height))
        };
        let mut found: Vec<f64> = other.radii.iter().flat_map(column).collect();
        for n in other.fixed() {
            found[n] = other.rest[n];
        }
        found
    }

    /// Number of the coordinate r of a node; the next number is z.
    pub(super) fn number(&self, column: usize, row: usize) -> usize {
        2 * (column * self.rows + row)
    }

    /// Coordinates without a degree of freedom: r on the axis, both on the rim.
    pub(super) fn fixed(&self) -> impl Iterator<Item = usize> + '_ {
        let axis = (0..self.rows).map(|row| self.number(0, row));
        axis.chain(self.number(self.columns - 1, 0)..self.rest.len())
    }

    pub(super) fn matrix(&self) -> Banded {
        Banded::zero(self.rest.len(), 2 * self.rows + 3)
    }

    fn cell_numbers(&self, column: usize, row: usize) -> [usize; 8] {
        let (a, b) = (self.number(column, row), self.number(column + 1, row));
        [a, a + 1, b, b + 1, b + 2, b + 3, a + 2, a + 3]
    }

    fn ring_numbers(&self, column: usize, row: usize) -> [usize; 4] {
        let (a, b) = (self.number(column, row), self.number(column + 1, row));
        [a, a + 1, b, b + 1]
    }

    /// Elastic energy \[µJ\]; infinite if a cell is inverted.
    pub(super) fn energy(&self, x: &[f64]) -> f64 {
        let mut sum = self.load_energy(x);
        for column in 0..self.columns - 1 {
            for (row, law) in self.law_of_row.iter().enumerate() {
                let at = self.cell_numbers(column, row).map(|n| x[n]);
                sum += self.cells[column * (self.rows - 1) + row].energy(&self.laws[*law], &at);
            }
            let top = self.ring_numbers(column, self.rows - 1).map(|n| x[n]);
            sum += self.rings[column].energy(&self.skin, &top);
            let bottom = self.ring_numbers(column, 0);
            let [r0, z0, r1, z1] = bottom.map(|n| x[n] - self.rest[n]);
            let [m00, m01, m11] = self.attachment[column];
            sum += 0.5 * (m00 * (r0 * r0 + z0 * z0) + m11 * (r1 * r1 + z1 * z1))
                + m01 * (r0 * r1 + z0 * z1);
        }
        sum + self.suction.energy(|column| self.at_inner(x, column))
    }

    /// [r, z] of a node of the inner face.
    fn at_inner(&self, x: &[f64], column: usize) -> [f64; 2] {
        let n = self.number(column, 0);
        [x[n], x[n + 1]]
    }

    /// Volume between wall and inner face over the pocket \[mm³\].
    pub(super) fn enclosed(&self, x: &[f64]) -> f64 {
        self.suction.volume(|column| self.at_inner(x, column))
    }

    /// Energy \[µJ\]; writes gradient \[mN\] and Hessian \[N/m\]. `None` if a cell is inverted.
    pub(super) fn linearise(
        &self,
        x: &[f64],
        gradient: &mut [f64],
        hessian: &mut Banded,
    ) -> Option<f64> {
        gradient.iter_mut().zip(&self.at_rest).for_each(|(to, pull)| *to = -pull);
        hessian.clear();
        let mut sum = self.load_energy(x);
        for column in 0..self.columns - 1 {
            for (row, law) in self.law_of_row.iter().enumerate() {
                let numbers = self.cell_numbers(column, row);
                let cell = self.cells[column * (self.rows - 1) + row]
                    .linearise(&self.laws[*law], &numbers.map(|n| x[n]))?;
                sum += cell.energy;
                scatter(&numbers, &cell.gradient, &cell.hessian, gradient, hessian);
            }
            let numbers = self.ring_numbers(column, self.rows - 1);
            let ring = self.rings[column].linearise(&self.skin, &numbers.map(|n| x[n]));
            sum += ring.energy;
            scatter(&numbers, &ring.gradient, &ring.hessian, gradient, hessian);
            let numbers = self.ring_numbers(column, 0);
            let u = numbers.map(|n| x[n] - self.rest[n]);
            let [m00, m01, m11] = self.attachment[column];
            let m = [
                [m00, 0.0, m01, 0.0],
                [0.0, m00, 0.0, m01],
                [m01, 0.0, m11, 0.0],
                [0.0, m01, 0.0, m11],
            ];
            let force = m.map(|row| row.iter().zip(&u).map(|(m, u)| m * u).sum());
            sum += 0.5 * force.iter().zip(&u).map(|(f, u): (&f64, &f64)| f * u).sum::<f64>();
            scatter(&numbers, &force, &m, gradient, hessian);
            if let Some((pull, bend)) = self.suction.ring(column, numbers.map(|n| x[n])) {
                scatter(&numbers, &pull, &bend, gradient, hessian);
            }
        }
        sum += self.suction.energy(|column| self.at_inner(x, column));
        Some(sum)
    }
}

fn scatter<const N: usize>(
    numbers: &[usize; N],
    from: &[f64; N],
    stiffness: &[[f64; N]; N],
    gradient: &mut [f64],
    hessian: &mut Banded,
) {
    for i in 0..N {
        gradient[numbers[i]] += from[i];
        for j in 0..N {
            hessian.add(numbers[i], numbers[j], stiffness[i][j]);
        }
    }
}

/// Numbers of cells of the solids: by thickness, rounded (ties to even), at least one each.
fn shared_cells(thickness: &[f64], cells: usize) -> Vec<usize> {
    let total: f64 = thickness.iter().sum();
    let one = |h: &f64| ((cells as f64 * h / total).round_ties_even() as usize).max(1);
    thickness.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_shared_by_thickness_and_every_solid_has_one() {
        assert_eq!(shared_cells(&[10.0], 4), [4]);
        assert_eq!(shared_cells(&[6.0, 10.0], 4), [2, 2]);
        assert_eq!(shared_cells(&[6.0, 10.0], 12), [4, 8]);
        assert_eq!(shared_cells(&[0.5, 30.0, 1.0], 1), [1, 1, 1]);
    }
}
