//! The result of a solve: owned, `Send`, independent of the solver.

use super::multigrid::Law;
use super::problem::{Method, Problem};
use super::reactions::{self, PartReactions, Reactions};
use super::validity::Invalid;
use crate::contact::SoftHalfBall;
use crate::mesh::lanes::Mirrored;
use crate::mesh::part::Part;
use crate::mesh::{Grown, NodeKind};
use crate::model::layered::LayeredLaw;
use crate::model::layered::exact::{CellState, Exact};
use crate::model::membrane::assembly;
use crate::model::membrane::deformation::Deformation;
use crate::model::membrane::stack::{Stack, log_area_stretch, solid_thickness_mm, thickness_at_mm};
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::cmp::Ordering;
use std::sync::{Arc, OnceLock};

/// Status of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// Still working, or ended above the tolerance.
    NotConverged,
    /// The estimated position error is within the tolerance.
    Converged,
    /// The springs have no stable equilibrium, the implant protrudes, or no valid shape of layered tissue was found.
    Unstable,
}

/// The origin of a solution's shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Displayed {
    /// The shape of the previous problem, or the sheet at rest.
    Previous,
    /// The shape of a coarser grid, interpolated.
    Coarse {
        /// Nodes a side of the coarser grid.
        nodes_per_side: usize,
    },
    /// A shape of this problem with an estimated error below the draft tolerance.
    Draft,
    /// An iterate of Newton's method, or the end of the solve.
    Final,
}

/// Method, status, work and accuracy of a solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Status of the solve.
    pub verdict: Verdict,
    /// Why the last shape of the solve was invalid; the solution contains the last valid shape.
    pub invalid: Option<Invalid>,
    /// Origin of the solution's shape.
    pub displayed: Displayed,
    /// The method that computed the shape.
    pub method: Method,
    /// V-cycles of the finest grid.
    pub cycles: u32,
    /// Free nodes solved for: of one quarter or half of the sheet under symmetry.
    pub nodes_solved: usize,
    /// Nodes that one pass over the finest grid visits: [`Self::nodes_solved`], each row filled up to whole
    /// groups of four.
    pub nodes_swept: usize,
    /// Did full multigrid not converge at first? Then Newton's method replaced it; for layered tissue a further attempt
    /// of multigrid with other constants, and Newton's method after the last attempt ([`Self::method`]).
    pub fell_back: bool,
    /// Did the sheet stay at rest because the insertion is below the tolerance?
    pub is_left_at_rest: bool,
    /// Work \[evaluations of all nodal forces on the finest grid, of the nodes solved for\].
    pub work_units: f64,
    /// Norm of the nodal forces without contact forces, relative to the forces of the triangles \[-\]; `None` while
    /// unknown.
    pub relative_residual: Option<f64>,
    /// Estimated greatest node position error against this grid's own equilibrium \[base radius\]; `None` while
    /// there is no estimate.
    pub estimated_position_error: Option<f64>,
    /// Estimated greatest position error of the skin's nodes of layered tissue against the equilibrium on ever finer grids
    /// \[base radius\], mostly within a factor of 2; `None` of a sheet and unless multigrid solved two grids.
    #[serde(default)]
    pub estimated_discretisation_error: Option<f64>,
}

/// Positions of the nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// Of the inner face \[mm\], shape (nodes_per_side², ).
    pub(super) inner: Vec<DVec3>,
    pub(super) offset_nodes: Vec<(usize, DVec3)>,
    /// Of the layers of nodes above the inner face \[mm\], shape (layers, nodes_per_side²); none in a sheet.
    pub(super) outer: Vec<Vec<DVec3>>,
    /// Is the shape mirrored along x, along y, to the last bit?
    pub(super) mirrored: Mirrored,
}

/// The shape of the tissue, the contact forces and how they were obtained.
///
/// Derived quantities are computed once, at their first use.
#[derive(Debug)]
pub struct Solution {
    problem: Arc<Problem>,
    law: Law,
    shape: Shape,
    report: Report,
    deformation: OnceLock<Deformation>,
    elastic: OnceLock<Deformation>,
    inner_deformation: OnceLock<Deformation>,
    stack: OnceLock<Stack>,
    part_reactions: OnceLock<PartReactions>,
    reactions: OnceLock<Reactions>,
}

/// The serialised form of a solution; with its problem it restores the solution. Lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Positions of the inner face, shape (nodes_per_side², 3).
    pub inner: Vec<[f64; 3]>,
    /// Nodes with contact offsets and their positions with offset; see [`Solution::offset_nodes`].
    pub offset_nodes: Vec<(usize, [f64; 3])>,
    /// Positions of the layers of nodes above the inner face, shape (layers, nodes_per_side², 3); empty for a sheet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outer: Vec<Vec<[f64; 3]>>,
    /// Is the shape mirrored along x, along y, to the last bit? Then one half or quarter of it is measured.
    #[serde(default)]
    pub mirrored: [bool; 2],
    /// What has grown of the skin, numbers of its triangles \[-\]; empty without growth.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub grown: Vec<f32>,
    /// The numbers of the deformation of an implant that yields.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub implant: Option<[f64; 8]>,
    /// The suction of a void that is limited \[kPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suction_kpa: Option<f64>,
    /// Method, status, work and accuracy.
    pub report: Report,
}

impl Solution {
    pub(super) fn new(problem: &Arc<Problem>, law: &Law, shape: Shape, report: Report) -> Self {
        Self {
            problem: Arc::clone(problem),
            law: law.clone(),
            shape,
            report,
            deformation: OnceLock::new(),
            elastic: OnceLock::new(),
            inner_deformation: OnceLock::new(),
            stack: OnceLock::new(),
            part_reactions: OnceLock::new(),
            reactions: OnceLock::new(),
        }
    }

    /// The solution of a record; `None` if the record has another number of nodes than the problem.
    #[must_use]
    pub fn restore(mut problem: Problem, record: Record) -> Option<Self> {
        let nodes = problem.sheet().len();
        let is_node = |&(k, _): &(usize, [f64; 3])| k < nodes;
        let law = Law::new(&problem);
        let layers = problem.rest.cells().len();
        if record.inner.len() != nodes
            || !record.offset_nodes.iter().all(is_node)
            || record.outer.len() != layers
            || record.outer.iter().any(|layer| layer.len() != nodes)
        {
            return None;
        }
        if !record.grown.is_empty() {
            let cells = problem.sheet().nodes_per_side() - 1;
            let grown = Grown::of_numbers(cells, &record.grown)?;
            problem.rest = problem.rest.with_grown(Some(grown));
        }
        if let Some(modes) = record.implant {
            problem.obstacle.dome.set_modes(modes);
        }
        if let (Some(void), Some(suction_kpa)) = (&mut problem.void, record.suction_kpa) {
            void.suction_kpa = suction_kpa;
        }
        let positions = |layer: Vec<[f64; 3]>| layer.into_iter().map(DVec3::from).collect();
        let shape = Shape {
            inner: positions(record.inner),
            offset_nodes: record.offset_nodes.into_iter().map(|(k, x)| (k, x.into())).collect(),
            outer: record.outer.into_iter().map(positions).collect(),
            mirrored: record.mirrored,
        };
        Some(Self::new(&Arc::new(problem), &law, shape, record.report))
    }

    /// The serialised form of the solution.
    #[must_use]
    pub fn record(&self) -> Record {
        Record {
            inner: arrays(&self.shape.inner),
            offset_nodes: self.offset_nodes().iter().map(|(k, x)| (*k, x.to_array())).collect(),
            outer: self.shape.outer.iter().map(|layer| arrays(layer)).collect(),
            mirrored: self.shape.mirrored,
            grown: self.problem.rest.grown().map(Grown::numbers).unwrap_or_default(),
            implant: self.problem.obstacle.dome.shape.soft().map(SoftHalfBall::modes),
            suction_kpa: self.problem.void.map(|void| void.suction_kpa),
            report: self.report.clone(),
        }
    }

    /// The problem of the solution.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Method, status, work and accuracy.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Positions of the inner face \[mm\], shape (nodes_per_side², ); nodes outside of the patch are at rest.
    #[must_use]
    pub fn inner(&self) -> &[DVec3] {
        &self.shape.inner
    }

    /// Positions of the layers of nodes above the inner face \[mm\], shape (layers, nodes_per_side²); empty for a sheet.
    #[must_use]
    pub fn outer(&self) -> &[Vec<DVec3>] {
        &self.shape.outer
    }

    /// Positions of the membrane \[mm\]: the sheet, or the skin on the outermost solid. Shape (nodes_per_side², ).
    #[must_use]
    pub fn membrane(&self) -> &[DVec3] {
        self.shape.outer.last().unwrap_or(&self.shape.inner)
    }

    /// The layers of cells of layered tissue, from the inner face outwards: index of the tissue, counted from the skin, and
    /// height at rest \[mm\]. Empty for a sheet.
    #[must_use]
    pub fn cells(&self) -> Vec<(usize, f64)> {
        let innermost = self.problem.materials.len().saturating_sub(1);
        let cells = self.problem.rest.cells().iter();
        cells.map(|cells| (innermost - cells.solid, cells.height_mm)).collect()
    }

    /// All layers of nodes, the inner face first.
    fn node_layers(&self) -> Vec<&[DVec3]> {
        std::iter::once(&self.shape.inner).chain(&self.shape.outer).map(Vec::as_slice).collect()
    }

    /// The part of the sheet that determines the shape, and that is measured.
    pub(crate) fn part(&self) -> Part {
        Part::new(self.problem.sheet().nodes_per_side(), self.shape.mirrored)
    }

    /// The last active nodes at the contact edge and their positions with contact offset \[mm\], slightly above the
    /// dome: contact ends between nodes. If the edge lies beyond such a node, the node's position in [`Self::inner`]
    /// is on the dome.
    #[must_use]
    pub fn offset_nodes(&self) -> &[(usize, DVec3)] {
        &self.shape.offset_nodes
    }

    /// The shape with balanced forces: [`Self::inner`] with the positions of [`Self::offset_nodes`].
    #[must_use]
    pub fn balanced(&self) -> Cow<'_, [DVec3]> {
        let mut x = Cow::Borrowed(self.inner());
        for &(k, position) in &self.shape.offset_nodes {
            x.to_mut()[k] = position;
        }
        x
    }

    /// Stretch, normal and area of the membrane at every node, against the tissue at rest.
    #[must_use]
    pub fn deformation(&self) -> &Deformation {
        let surface = self.problem.rest.outermost();
        self.deformation.get_or_init(|| Deformation::of_part(surface, self.membrane(), self.part()))
    }

    /// The same against the membrane without stress, which determines its stress; [`Self::deformation`] without natural tension and growth.
    #[must_use]
    pub fn elastic_deformation(&self) -> &Deformation {
        if !self.problem.rest.has_own_skin() {
            return self.deformation();
        }
        let surface = self.problem.rest.membrane();
        self.elastic.get_or_init(|| Deformation::of_part(surface, self.membrane(), self.part()))
    }

    /// Stretch, normal and area of the inner face at every node.
    #[must_use]
    pub fn inner_deformation(&self) -> &Deformation {
        if self.shape.outer.is_empty() {
            return self.deformation();
        }
        let surface = self.problem.rest.surface(0);
        self.inner_deformation
            .get_or_init(|| Deformation::of_part(surface, &self.shape.inner, self.part()))
    }

    /// Has [`Self::deformation`] been computed?
    #[must_use]
    pub fn has_deformation(&self) -> bool {
        self.deformation.get().is_some()
    }

    /// Normals and deformed thicknesses of the layers at every node.
    #[must_use]
    pub fn stack(&self) -> &Stack {
        self.stack.get_or_init(|| match self.law.layered() {
            None => Stack::new(&self.problem.materials, self.deformation()),
            Some(_) => {
                let faces = self.solid_faces();
                Stack::layered(&self.problem.materials, self.deformation(), &faces)
            }
        })
    }

    /// The inner face and the outer face of each solid \[mm\], shape (solids + 1, nodes_per_side²).
    fn solid_faces(&self) -> Vec<&[DVec3]> {
        let outer = self.problem.rest.outer_faces().map(|l| &*self.shape.outer[l - 1]);
        std::iter::once(self.inner()).chain(outer).collect()
    }

    /// Layered tissue: least and greatest of [`Stack::thickness_mm`] of each layer over the free nodes, from the skin
    /// inwards, without the stack; of an innermost solid that ends within the patch where it is whole.
    pub(crate) fn thickness_ranges(&self) -> Vec<(f32, f32)> {
        if self.law.layered().is_none() {
            return Vec::new();
        }
        let (deformation, sheet) = (self.deformation(), self.problem.sheet());
        let faces = self.solid_faces();
        let mut ranges = vec![(f32::MAX, f32::MIN); faces.len()];
        for k in self.part().nodes().filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
            let solids = faces.windows(2).rev();
            let solid = |p: &[&[DVec3]]| solid_thickness_mm(deformation, p[0][k], p[1][k], k);
            let all = std::iter::once(self.skin_thickness_mm(k)).chain(solids.map(solid));
            let is_whole = self.problem.rest.innermost_part(k) >= 1.0;
            let count = if is_whole { faces.len() } else { faces.len() - 1 };
            for ((least, greatest), thickness) in ranges[..count].iter_mut().zip(all) {
                (*least, *greatest) = (least.min(thickness), greatest.max(thickness));
            }
        }
        ranges
    }

    /// [`Stack::thickness_mm`] of the skin at a node, zero outside of the sheet, without the stack.
    fn skin_thickness_mm(&self, node: usize) -> f32 {
        if self.problem.sheet().kinds()[node] == NodeKind::Outside {
            return 0.0;
        }
        let logarithm = log_area_stretch(self.deformation(), node);
        thickness_at_mm(&self.problem.materials[0], logarithm)
    }

    /// Layered tissue: position of the skin's outer surface at a node \[mm\], that of [`Self::faces`], without the stack.
    pub(crate) fn outer_surface_at(&self, node: usize) -> Vec3 {
        let normal = self.deformation().normal(node).as_vec3();
        self.membrane()[node].as_vec3() + normal * self.skin_thickness_mm(node)
    }

    /// Positions of the tissue's faces \[mm\]: the inner face, the faces between the layers, the skin; shape
    /// (layers + 1, nodes_per_side²).
    #[must_use]
    pub fn faces(&self) -> Vec<Vec<Vec3>> {
        let stack = self.stack();
        let inner = self.inner().iter().map(|p| p.as_vec3()).collect();
        stack.faces(inner)
    }

    /// Forces of the tissue on the inner face at the marked nodes \[kPa·mm²\]. Arrays over the part.
    pub(super) fn forces_on_inner(&self, wanted: &[bool]) -> Vec<DVec3> {
        let (surface, part) = (self.problem.rest.membrane(), self.part());
        match &self.law {
            Law::Sheet(law) => assembly::forces_at(surface, law, &self.balanced(), part, wanted),
            Law::Layered(law) => {
                let layers = self.node_layers();
                let mut forces = self.body_of_inner(law).forces_on_inner(&layers, part, wanted);
                if let Some(suction) = self.problem.suction() {
                    for (force, k) in forces.iter_mut().zip(part.nodes()) {
                        *force += suction.force(k, layers[0]);
                    }
                }
                forces
            }
        }
    }

    fn exact<'a>(&'a self, law: &'a LayeredLaw) -> Exact<'a> {
        let Problem { rest, patch, .. } = &*self.problem;
        Exact::new(rest, law, patch.pocket(), patch.attachment())
    }

    /// [`Self::exact`] without dead loads, which are no forces of the cells.
    fn cells_alone<'a>(&'a self, law: &'a LayeredLaw) -> Exact<'a> {
        let Problem { rest, patch, .. } = &*self.problem;
        let (pocket, attachment) = (patch.pocket(), patch.attachment());
        Exact { rest, law, pocket, attachment, at_rest: Cow::default() }
    }

    /// The body for forces on the inner face, which is the skin where there are no cells. Of dead loads a change of the weight acts on every face,
    /// that of a natural tension on the skin alone.
    fn body_of_inner<'a>(&'a self, law: &'a LayeredLaw) -> Exact<'a> {
        let Problem { rest, .. } = &*self.problem;
        let has_loads = rest.cells().is_empty() || !rest.weight().is_none();
        if has_loads { self.exact(law) } else { self.cells_alone(law) }
    }

    /// Elastic energy of tissue and attachment \[kPa·mm³ = µJ\] with balanced forces ([`Self::balanced`]).
    #[must_use]
    pub fn elastic_energy(&self) -> f64 {
        match &self.law {
            Law::Sheet(law) => {
                assembly::energy(self.problem.rest.membrane(), law, &self.balanced())
            }
            Law::Layered(law) => {
                let exact = self.exact(law);
                let layers: Vec<_> = self.node_layers().into_iter().map(<[_]>::to_vec).collect();
                exact.energy(&exact.places(), &layers)
            }
        }
    }

    /// Calls `visit` with the state in the middle of every cell of layered tissue between nodes of the part.
    #[doc(hidden)]
    pub fn visit_cells(&self, visit: impl FnMut(&CellState)) {
        if let Some(law) = self.law.layered() {
            self.cells_alone(law).visit(&self.node_layers(), self.part(), visit);
        }
    }

    /// Is a cell of layered tissue inverted in its middle?
    pub(crate) fn has_inverted_cell(&self) -> bool {
        let mut is_found = false;
        self.visit_cells(|cell| {
            let ratio = cell.gradient.determinant();
            // A ratio that is not a number counts as inverted.
            is_found |= !matches!(ratio.partial_cmp(&0.0), Some(Ordering::Greater));
        });
        is_found
    }

    /// [`Self::reactions`] on the part.
    pub(crate) fn part_reactions(&self) -> &PartReactions {
        self.part_reactions.get_or_init(|| reactions::of(self))
    }

    /// The active set and the forces of the dome on the inner face.
    #[must_use]
    pub fn reactions(&self) -> &Reactions {
        self.reactions.get_or_init(|| self.part_reactions().on_grid())
    }
}

fn arrays(layer: &[DVec3]) -> Vec<[f64; 3]> {
    layer.iter().map(DVec3::to_array).collect()
}
