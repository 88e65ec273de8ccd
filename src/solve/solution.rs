//! The result of a solve: owned, `Send`, independent of the solver.

use super::multigrid::Law;
use super::problem::{Method, Problem};
use super::reactions::{self, Reactions};
use super::validity::Invalid;
use crate::model::layered::LayeredLaw;
use crate::model::layered::exact::{CellState, Exact};
use crate::model::membrane::assembly;
use crate::model::membrane::deformation::Deformation;
use crate::model::membrane::stack::Stack;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
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
    /// Did full multigrid not converge at first? Then Newton's method replaced it; for layered tissue a second attempt
    /// of multigrid with smaller steps, and Newton's method after the second attempt ([`Self::method`]).
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
}

/// Positions of the nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// Of the inner face \[mm\], shape (nodes_per_side², ).
    pub(super) inner: Vec<DVec3>,
    pub(super) offset_nodes: Vec<(usize, DVec3)>,
    /// Of the layers of nodes above the inner face \[mm\], shape (layers, nodes_per_side²); none in a sheet.
    pub(super) outer: Vec<Vec<DVec3>>,
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
    inner_deformation: OnceLock<Deformation>,
    stack: OnceLock<Stack>,
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
            inner_deformation: OnceLock::new(),
            stack: OnceLock::new(),
            reactions: OnceLock::new(),
        }
    }

    /// The solution of a record; `None` if the record has another number of nodes than the problem.
    #[must_use]
    pub fn restore(problem: Problem, record: Record) -> Option<Self> {
        let nodes = problem.sheet.len();
        let is_node = |&(k, _): &(usize, [f64; 3])| k < nodes;
        let law = Law::new(&problem);
        let layers = law.layered().map_or(0, |law| law.cells.len());
        if record.inner.len() != nodes
            || !record.offset_nodes.iter().all(is_node)
            || record.outer.len() != layers
            || record.outer.iter().any(|layer| layer.len() != nodes)
        {
            return None;
        }
        let positions = |layer: Vec<[f64; 3]>| layer.into_iter().map(DVec3::from).collect();
        let shape = Shape {
            inner: positions(record.inner),
            offset_nodes: record.offset_nodes.into_iter().map(|(k, x)| (k, x.into())).collect(),
            outer: record.outer.into_iter().map(positions).collect(),
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

    /// All layers of nodes, the inner face first.
    fn node_layers(&self) -> Vec<Vec<DVec3>> {
        std::iter::once(&self.shape.inner).chain(&self.shape.outer).cloned().collect()
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
    pub fn balanced(&self) -> Vec<DVec3> {
        let mut x = self.shape.inner.clone();
        for &(k, position) in &self.shape.offset_nodes {
            x[k] = position;
        }
        x
    }

    /// Stretch, normal and area of the membrane at every node.
    #[must_use]
    pub fn deformation(&self) -> &Deformation {
        self.deformation.get_or_init(|| Deformation::new(&self.problem.sheet, self.membrane()))
    }

    /// Stretch, normal and area of the inner face at every node.
    #[must_use]
    pub fn inner_deformation(&self) -> &Deformation {
        if self.shape.outer.is_empty() {
            return self.deformation();
        }
        self.inner_deformation
            .get_or_init(|| Deformation::new(&self.problem.sheet, &self.shape.inner))
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
            Some(law) => {
                let mut faces = vec![self.inner()];
                faces.extend(law.outer_nodes().into_iter().map(|l| &*self.shape.outer[l - 1]));
                Stack::layered(&self.problem.materials, self.deformation(), &faces)
            }
        })
    }

    /// Positions of the tissue's faces \[mm\]: the inner face, the faces between the layers, the skin; shape
    /// (layers + 1, nodes_per_side²).
    #[must_use]
    pub fn faces(&self) -> Vec<Vec<Vec3>> {
        let stack = self.stack();
        let inner = self.inner().iter().map(|p| p.as_vec3()).collect();
        stack.faces(inner)
    }

    /// Forces of the tissue on the inner face at the marked nodes \[kPa·mm²\], shape (nodes_per_side², ).
    pub(super) fn forces_on_inner(&self, wanted: &[bool]) -> Vec<DVec3> {
        let sheet = &self.problem.sheet;
        match &self.law {
            Law::Sheet(law) => assembly::forces_at(sheet, law, &self.balanced(), wanted),
            Law::Layered(law) => self.exact(law).forces(&self.node_layers()).swap_remove(0),
        }
    }

    fn exact<'a>(&'a self, law: &'a LayeredLaw) -> Exact<'a> {
        let Problem { sheet, patch, .. } = &*self.problem;
        let (pocket_radius, attachment) = (patch.pocket_radius_mm, patch.attachment());
        Exact { sheet, law, pocket_radius, attachment }
    }

    /// Calls `visit` with the state in the middle of every cell of layered tissue.
    pub(crate) fn visit_cells(&self, visit: impl FnMut(&CellState)) {
        if let Some(law) = self.law.layered() {
            self.exact(law).visit(&self.node_layers(), visit);
        }
    }

    /// The active set and the forces of the dome on the inner face.
    #[must_use]
    pub fn reactions(&self) -> &Reactions {
        self.reactions.get_or_init(|| reactions::of(self))
    }
}

fn arrays(layer: &[DVec3]) -> Vec<[f64; 3]> {
    layer.iter().map(DVec3::to_array).collect()
}
