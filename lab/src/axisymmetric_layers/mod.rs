//! Reference solution of the layered tissue for a centred dome: axisymmetric finite elements.
//!
//! The layered model of a section through the axis, over a flat wall or one curved as a sphere, with bilinear quadrilaterals in the
//! coordinates R, Z at rest:
//!
//! * the skin, first layer, is a membrane of the coupled law on the outer face, as a tension field if `skin_wrinkles`; every other layer is a solid, stacked
//!   inwards, with the law of `law`; J is averaged over each cell (mean dilatation);
//! * the skin may grow, by a power of its stretch along and around the axis: solves one after the other, without acceleration;
//! * an elastic attachment ½∫ k(R)|u|² dA holds the inner face; k rises linearly from 0 at the pocket's radius;
//! * the rim of the patch is clamped at every height;
//! * the nodes of the inner face are in frictionless one-sided contact with dome and wall.
//!
//! The solver: Newton's method with the exact Hessian, augmented Lagrangians for the contact, the dome raised on a
//! coarse mesh, nested iteration to the finer ones. The error of the force is of first order in the mesh width; compare
//! two meshes.
//!
//! The reference shares no code with the model of `model` in three dimensions: its tensions are from the curves
//! ([`principal_response`]), not from tables.
//!
//! [`principal_response`]: implant_preview_core::springs::coupled::principal_response
//!
//! Uses `springs`, `curve`. Used by `work_precision` and the tests.

mod assembly;
mod banded;
mod contact;
mod element;
mod law;
mod newton;
mod suction;
mod wall;

pub use wall::{Mound, RestShape, Wall};

use assembly::Tissue;
use contact::Section;
use implant_preview_core::mesh::Attachment;
use implant_preview_core::scene::Scene;
use implant_preview_core::solve::Problem;
use implant_preview_core::springs::Material;
use newton::Equilibrium;
use std::f64::consts::PI;

/// Number of points of a profile.
pub const PROFILE_POINTS: usize = 41;

/// Greatest number of cells of a mesh.
const MAX_CELLS: usize = 200_000;

/// Greatest number of changes of the skin's growth, one after the other without any acceleration, and the change of a length at the
/// end \[-\].
const MOST_GROWTHS: usize = 500;
const GROWN: f64 = 3e-5;

/// Least number of cells along the radius of a mesh of the nested iteration.
const COARSEST_COLUMNS: usize = 32;
/// Cells inside of the contact over which the pressure locates its edge.
const EDGE_CELLS: usize = 4;

/// Centred dome, patch of tissue and mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Base radius R of the dome \[mm\].
    pub base_radius_mm: f64,
    /// Projection p of the dome \[mm\].
    pub projection_mm: f64,
    /// Fullness of the dome, its volume by πR²p \[-\]: 2/3 of half of an ellipsoid.
    pub fullness: f64,
    /// Insertion t \[-\], 0 to 1: the base is at the height (t − 1)p.
    pub insertion: f64,
    /// Radius of the pocket, in which the inner face is free \[mm\].
    pub pocket_radius_mm: f64,
    /// Radius of the simulated patch, whose rim is clamped \[mm\].
    pub patch_radius_mm: f64,
    /// Attachment of the inner face outside of the pocket.
    pub attachment: Attachment,
    /// The skin, then the solids inwards; at least two layers.
    pub layers: Vec<Material>,
    /// Does the skin wrinkle instead of being compressed (tension field), as in every scene? The independent solutions compress it.
    pub skin_wrinkles: bool,
    /// Greatest void between tissue, dome and wall within the pocket \[mm³\], held by a suction; absent: as large as it gets.
    pub void_mm3: Option<f64>,
    /// Wall and mound at rest. On a curved wall pocket, patch and material radii are lengths along the wall, thickness is along its normals,
    /// and heights of the dome count from the wall below.
    pub rest: RestShape,
    /// Cells along the radius, nr, and through the solids, nz. Of nr, 1.2 times the fraction a/b (pocket's radius / patch
    /// radius) are in the pocket, a node at its edge. The solids share nz by thickness, rounded, at least one each.
    pub cells: [usize; 2],
}

impl Input {
    /// The problem of a scene on a mesh: a centred round implant over a plane or a sphere, without a mound; `None` for a sheet.
    #[must_use]
    pub fn of(scene: &Scene, problem: &Problem, cells: [usize; 2]) -> Option<Self> {
        let Problem { patch, obstacle, materials, rest, .. } = problem;
        let attachment = patch.attachment()?;
        Some(Self {
            base_radius_mm: obstacle.dome.reference_length(),
            projection_mm: obstacle.dome.projection(),
            fullness: scene.implant.fullness(),
            insertion: scene.insertion,
            pocket_radius_mm: patch.pocket_radius_mm,
            patch_radius_mm: patch.radius_mm,
            attachment,
            layers: materials.clone(),
            skin_wrinkles: true,
            void_mm3: problem.void.map(|void| void.most_mm3),
            rest: RestShape {
                wall: Wall { radius_mm: scene.chest.map(|chest| chest.radius_across_mm) },
                mound: None,
                natural_strain: rest.natural().map_or(0.0, |natural| natural.stretches()[0] - 1.0),
                growth: rest.growth(),
            },
            cells,
        })
    }
}

/// Reason for the absence of a solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayersError {
    /// A number is outside of its range.
    #[error("{field} is {value}; allowed: {allowed}")]
    Number {
        /// Name of the number, with its unit.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        allowed: &'static str,
    },
    /// There is no skin or no solid.
    #[error("there are {count} layers; allowed: the skin and at least one solid")]
    Layers {
        /// Number of layers.
        count: usize,
    },
    /// The mesh is empty or too large.
    #[error("the mesh has {nr} × {nz} cells; allowed: at least 2 × 1, at most 200000 in all")]
    Cells {
        /// Cells along the radius.
        nr: usize,
        /// Cells through the solids.
        nz: usize,
    },
    /// Newton's method did not converge.
    #[error("no equilibrium was found beyond the insertion {insertion:.3}")]
    NotFound {
        /// Greatest insertion with an equilibrium \[-\].
        insertion: f64,
    },
}

/// The equilibrium. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Force between dome and tissue along the axis \[N\].
    pub contact_force_n: f64,
    /// Height of the inner face at the axis \[mm\].
    pub apex_inner_mm: f64,
    /// Height of the skin membrane at the axis \[mm\].
    pub apex_skin_mm: f64,
    /// Hoop stretch of the skin in the cell at the axis \[-\].
    pub skin_apex_stretch: f64,
    /// Deformed area of the skin over the pocket (material radius up to the pocket's) / its area at rest \[-\].
    pub skin_area_ratio_over_pocket: f64,
    /// Volume under the inner face over the pocket less the dome's over the wall \[mm³\].
    pub void_mm3: f64,
    /// Suction that holds the void \[kPa\].
    pub suction_kpa: f64,
    /// \[r, z\] of the inner face \[mm\] at [`PROFILE_POINTS`] equal steps of the material radius, 0 to the patch
    /// radius.
    pub inner: Vec<[f64; 2]>,
    /// \[r, z\] of the skin membrane \[mm\] at the same material radii.
    pub skin: Vec<[f64; 2]>,
    /// Pressure of the dome on the nodes of the inner face \[kPa\], from the axis outwards: normal force / area around the node.
    pressure_kpa: Vec<f64>,
    /// Material radii of the mesh \[mm\], rising, with \[r, z\] of inner face and skin \[mm\].
    mesh: Vec<(f64, [[f64; 2]; 2])>,
}

impl Solution {
    /// \[r, z\] of inner face and skin \[mm\] at a material radius \[mm\], linear in the cells.
    #[must_use]
    pub fn point(&self, radius_mm: f64) -> ([f64; 2], [f64; 2]) {
        let (cell, share) = self.locate(radius_mm);
        let [a, b] = [self.mesh[cell - 1].1, self.mesh[cell].1];
        let [inner, skin] = [0, 1]
            .map(|face: usize| [0, 1].map(|k| a[face][k] + share * (b[face][k] - a[face][k])));
        (inner, skin)
    }

    /// Pressure of the dome at a material radius \[mm\], linear in the cells \[kPa\].
    #[must_use]
    pub fn pressure_at(&self, radius_mm: f64) -> f64 {
        let (cell, share) = self.locate(radius_mm);
        let [a, b] = [self.pressure_kpa[cell - 1], self.pressure_kpa[cell]];
        a + share * (b - a)
    }

    /// Greatest pressure of the dome \[kPa\].
    #[must_use]
    pub fn greatest_pressure_kpa(&self) -> f64 {
        self.pressure_kpa.iter().copied().fold(0.0, f64::max)
    }

    /// Mean pressure of the dome \[kPa\]: the normal force over the area within the contact's edge, where the square of the pressure, extrapolated from the last
    /// nodes inside, is zero; `None` with a contact of too few nodes.
    #[must_use]
    pub fn mean_pressure_kpa(&self) -> Option<f64> {
        // The last node's own surroundings are partly free.
        let last =
            self.pressure_kpa.iter().rposition(|pressure| *pressure > 0.0)?.checked_sub(1)?;
        let first = last.checked_sub(EDGE_CELLS)?;
        let square = |node: usize| self.pressure_kpa[node].powi(2);
        let fall = (square(first) - square(last)) / EDGE_CELLS as f64;
        let edge = (last as f64 + square(last) / fall).max(last as f64);
        let (mut force, mut area) = (0.0, 0.0);
        for (cell, pair) in self.mesh.windows(2).enumerate() {
            let [[r, z], [r_next, z_next]] = [pair[0].1[0], pair[1].1[0]];
            let of_cell = PI * (r + r_next) * (r_next - r).hypot(z_next - z);
            force += 0.5 * (self.pressure_kpa[cell] + self.pressure_kpa[cell + 1]) * of_cell;
            area += (edge - cell as f64).clamp(0.0, 1.0) * of_cell;
        }
        Some(force / area)
    }

    /// The outer node of the cell at a material radius \[mm\] and the place in the cell, 0 to 1.
    fn locate(&self, radius_mm: f64) -> (usize, f64) {
        let above = self.mesh.partition_point(|(radius, _)| *radius < radius_mm);
        let cell = above.clamp(1, self.mesh.len() - 1);
        let [inner, outer] = [self.mesh[cell - 1].0, self.mesh[cell].0];
        (cell, ((radius_mm - inner) / (outer - inner)).clamp(0.0, 1.0))
    }
}

/// Solves the axisymmetric equilibrium of layered tissue over a centred dome. Run time: 0.1 s for 72 × 4 cells, 0.5 s
/// for 216 × 12. Tested for projections from 0.2 to 1.3 of the base radius; over softening tissue no equilibrium is
/// found for taller domes, from about 1.5 on.
///
/// # Errors
/// [`LayersError`] if a number of the input is outside of its range or if Newton's method does not converge.
pub fn solve(input: &Input) -> Result<Solution, LayersError> {
    check(input)?;
    let mesh = |cells| {
        let attachment = (input.attachment, input.pocket_radius_mm);
        let layers = (&*input.layers, input.skin_wrinkles);
        Tissue::new(layers, cells, input.patch_radius_mm, attachment, input.rest)
    };
    let mut cells = vec![input.cells];
    let mut nr = input.cells[0];
    while nr >= 2 * COARSEST_COLUMNS {
        nr /= 2;
        cells.insert(0, [nr, cells[0][1].div_ceil(2)]);
    }
    let mut meshes: Vec<Tissue> = cells.into_iter().map(mesh).collect();
    let section = Section {
        base_radius: input.base_radius_mm,
        projection: input.projection_mm,
        exponent: input.fullness / (1.0 - input.fullness),
        base_height: (input.insertion - 1.0) * input.projection_mm,
        wall: input.rest.wall,
    };
    let mut found = newton::equilibrium(&meshes, section)
        .map_err(|insertion| LayersError::NotFound { insertion })?;
    let not_found = || LayersError::NotFound { insertion: input.insertion };
    let mut tissue = meshes.pop().ok_or_else(not_found)?;
    if input.rest.growth > 0.0 {
        for _ in 0..MOST_GROWTHS {
            let change = tissue.grow(&found.x, input.rest.growth);
            found = newton::again(&tissue, found).ok_or_else(not_found)?;
            if change < GROWN {
                return Ok(measure(input, &tissue, &found));
            }
        }
        return Err(not_found());
    }
    if let Some(most) = input.void_mm3 {
        let filled = volume_over_wall(input);
        found = newton::limited(&mut tissue, found, (filled, most)).ok_or_else(not_found)?;
    }
    Ok(measure(input, &tissue, &found))
}

fn check(input: &Input) -> Result<(), LayersError> {
    let number = |field, value: f64, is_allowed: bool, allowed| {
        if value.is_finite() && is_allowed {
            Ok(())
        } else {
            Err(LayersError::Number { field, value, allowed })
        }
    };
    let positive = |field, value: f64| number(field, value, value > 0.0, "greater than 0");
    positive("base_radius_mm", input.base_radius_mm)?;
    positive("projection_mm", input.projection_mm)?;
    positive("pocket_radius_mm", input.pocket_radius_mm)?;
    let f = input.fullness;
    number("fullness", f, f > 0.5 && f < 1.0, "greater than 1/2, less than 1")?;
    let t = input.insertion;
    number("insertion", t, (0.0..=1.0).contains(&t), "0 to 1")?;
    let patch = input.patch_radius_mm;
    let greatest = input.base_radius_mm.max(input.pocket_radius_mm);
    number("patch_radius_mm", patch, patch > greatest, "greater than dome and pocket")?;
    let Attachment { stiffness_kpa_per_mm: stiffness, ramp_mm: ramp } = input.attachment;
    number("stiffness_kpa_per_mm", stiffness, stiffness >= 0.0, "at least 0")?;
    number("ramp_mm", ramp, ramp >= 0.0, "at least 0")?;
    if input.layers.len() < 2 {
        return Err(LayersError::Layers { count: input.layers.len() });
    }
    for layer in &input.layers {
        positive("thickness_mm", layer.thickness_mm)?;
        let nu = layer.poisson_ratio;
        number("poisson_ratio", nu, (0.0..0.5).contains(&nu), "0 to less than 0.5")?;
    }
    let [nr, nz] = input.cells;
    if nr < 2 || nz < 1 || nr.saturating_mul(nz.max(input.layers.len() - 1)) > MAX_CELLS {
        return Err(LayersError::Cells { nr, nz });
    }
    Ok(())
}

/// Volume of the dome over the wall \[mm³\]: πR²p ∫ (1 − sᵐ) ds over the heights s \[p\].
fn volume_over_wall(input: &Input) -> f64 {
    let exponent = input.fullness / (1.0 - input.fullness);
    let lowest = 1.0 - input.insertion;
    let share = (1.0 - lowest) - (1.0 - lowest.powf(exponent + 1.0)) / (exponent + 1.0);
    PI * input.base_radius_mm.powi(2) * input.projection_mm * share
}

fn measure(input: &Input, tissue: &Tissue, found: &Equilibrium) -> Solution {
    let node_of = |x: &[f64], column: usize, row: usize| {
        let n = tissue.number(column, row);
        [x[n], x[n + 1]]
    };
    // Linear in the cell, as the elements are.
    let point_of = |x: &[f64], radius: f64, row: usize| {
        let (column, share) = tissue.locate(radius);
        let (a, b) = (node_of(x, column, row), node_of(x, column + 1, row));
        [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
    };
    let top = tissue.rows - 1;
    let profile = |row: usize| {
        let steps = PROFILE_POINTS - 1;
        let radius = |k: usize| input.patch_radius_mm * k as f64 / steps as f64;
        (0..=steps).map(|k| point_of(&found.x, radius(k), row)).collect()
    };
    // Cones of the skin up to the pocket's radius.
    let area = |x: &[f64]| {
        let mut area = 0.0;
        let mut inner = node_of(x, 0, top);
        for column in 1..tissue.columns {
            let radius = tissue.radius(column).min(input.pocket_radius_mm);
            let outer = point_of(x, radius, top);
            area += PI * (inner[0] + outer[0]) * (outer[0] - inner[0]).hypot(outer[1] - inner[1]);
            inner = outer;
        }
        area
    };
    let node = |column: usize, row: usize| node_of(&found.x, column, row);
    // The share of a node in the ring of a cell, by the cell's linear function.
    let mut areas = vec![0.0; tissue.columns];
    for column in 1..tissue.columns {
        let ([r, z], [next_r, next_z]) = (node(column - 1, 0), node(column, 0));
        let length = (next_r - r).hypot(next_z - z);
        areas[column - 1] += PI * length * (2.0 * r + next_r) / 3.0;
        areas[column] += PI * length * (r + 2.0 * next_r) / 3.0;
    }
    Solution {
        contact_force_n: found.contact_force_n,
        apex_inner_mm: node(0, 0)[1],
        apex_skin_mm: node(0, top)[1],
        skin_apex_stretch: node(1, top)[0] / node_of(&tissue.rest, 1, top)[0],
        skin_area_ratio_over_pocket: area(&found.x) / area(&tissue.rest),
        void_mm3: tissue.enclosed(&found.x) - volume_over_wall(input),
        suction_kpa: tissue.suction.kpa,
        inner: profile(0),
        skin: profile(top),
        pressure_kpa: found.normal_forces(tissue).iter().zip(areas).map(|(f, a)| f / a).collect(),
        mesh: (0..tissue.columns)
            .map(|column| (tissue.radius(column), [node(column, 0), node(column, top)]))
            .collect(),
    }
}
