//! The result of a solve: owned, `Send`, independent of the solver.

use super::problem::{Method, Problem};
use super::reactions::{self, Reactions};
use super::validity::Invalid;
use crate::model::membrane::deformation::Deformation;
use crate::model::membrane::law::SheetLaw;
use crate::model::membrane::stack::Stack;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, OnceLock};

/// How a solve stands or ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// Still working, or ended above the tolerance.
    NotConverged,
    /// The estimated position error is within the tolerance.
    Converged,
    /// The springs have no stable equilibrium, or the implant protrudes.
    Unstable,
}

/// Which shape a solution has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Displayed {
    /// That of the problem before, or the sheet at rest.
    Previous,
    /// That of a coarser grid, interpolated.
    Coarse {
        /// Nodes a side of the coarser grid.
        nodes_per_side: usize,
    },
    /// This problem's, with an estimated error below the draft tolerance.
    Draft,
    /// An iterate of Newton's method, or the end of the solve.
    Final,
}

/// How a solution was obtained, and how accurate it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// How the solve stands or ended.
    pub verdict: Verdict,
    /// Why the last shape of the solve was invalid; the solution has the last valid one.
    pub invalid: Option<Invalid>,
    /// Which shape the solution has.
    pub displayed: Displayed,
    /// The method that the shape comes from.
    pub method: Method,
    /// V-cycles of the finest grid.
    pub cycles: u32,
    /// Free nodes solved for: those of one quarter or half where symmetry allows it.
    pub nodes_solved: usize,
    /// Nodes that one pass over the finest grid computes: [`Self::nodes_solved`], each row filled up to whole
    /// groups of four.
    pub nodes_swept: usize,
    /// Did Newton's method take over because full multigrid did not converge?
    pub fell_back: bool,
    /// Is the insertion below the tolerance, and was the sheet left at rest?
    pub is_left_at_rest: bool,
    /// Work \[evaluations of all nodal forces on the finest grid, of the nodes solved for\].
    pub work_units: f64,
    /// Norm of the forces that no contact takes, relative to the forces they are the sum of \[-\]; `None` while
    /// unknown.
    pub relative_residual: Option<f64>,
    /// Estimated greatest node position error against this grid's own equilibrium \[base radius\]; `None` while
    /// there is no estimate.
    pub estimated_position_error: Option<f64>,
}

/// The shape of the tissue, the contact forces and how they were obtained.
///
/// Derived quantities are computed when they are first read, and kept.
#[derive(Debug)]
pub struct Solution {
    problem: Arc<Problem>,
    law: Arc<SheetLaw>,
    /// Positions of the inner face \[mm\], shape (nodes_per_side², ).
    inner: Vec<DVec3>,
    offset_nodes: Vec<(usize, DVec3)>,
    report: Report,
    deformation: OnceLock<Deformation>,
    stack: OnceLock<Stack>,
    reactions: OnceLock<Reactions>,
}

/// What a solution is restored from, together with its problem. Lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Positions of the inner face, shape (nodes_per_side², 3).
    pub inner: Vec<[f64; 3]>,
    /// Nodes with contact offsets and their positions in balance; see [`Solution::offset_nodes`].
    pub offset_nodes: Vec<(usize, [f64; 3])>,
    /// How the solution was obtained.
    pub report: Report,
}

impl Solution {
    pub(super) fn new(
        problem: &Arc<Problem>,
        law: &Arc<SheetLaw>,
        inner: Vec<DVec3>,
        offset_nodes: Vec<(usize, DVec3)>,
        report: Report,
    ) -> Self {
        Self {
            problem: Arc::clone(problem),
            law: Arc::clone(law),
            inner,
            offset_nodes,
            report,
            deformation: OnceLock::new(),
            stack: OnceLock::new(),
            reactions: OnceLock::new(),
        }
    }

    /// The solution of a record; `None` if the record has another number of nodes than the problem.
    #[must_use]
    pub fn restore(problem: Problem, record: Record) -> Option<Self> {
        let nodes = problem.sheet.len();
        let is_node = |&(k, _): &(usize, [f64; 3])| k < nodes;
        if record.inner.len() != nodes || !record.offset_nodes.iter().all(is_node) {
            return None;
        }
        let law = SheetLaw::new(problem.springs, &problem.materials);
        let inner = record.inner.into_iter().map(DVec3::from).collect();
        let offset_nodes = record.offset_nodes.into_iter().map(|(k, x)| (k, x.into())).collect();
        Some(Self::new(&Arc::new(problem), &Arc::new(law), inner, offset_nodes, record.report))
    }

    /// What the solution can be restored from.
    #[must_use]
    pub fn record(&self) -> Record {
        Record {
            inner: self.inner.iter().map(DVec3::to_array).collect(),
            offset_nodes: self.offset_nodes.iter().map(|(k, x)| (*k, x.to_array())).collect(),
            report: self.report.clone(),
        }
    }

    /// The problem that was solved.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How the solution was obtained.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Positions of the inner face \[mm\], shape (nodes_per_side², ); nodes outside of the patch are at rest.
    #[must_use]
    pub fn inner(&self) -> &[DVec3] {
        &self.inner
    }

    /// The last active nodes before the contact's edge and their positions in the balance of forces \[mm\],
    /// slightly above the dome: contact ends between nodes. Where contact ends beyond such a node,
    /// [`Self::inner`] has the node on the dome.
    #[must_use]
    pub fn offset_nodes(&self) -> &[(usize, DVec3)] {
        &self.offset_nodes
    }

    /// The shape in which forces balance: [`Self::inner`] with the positions of [`Self::offset_nodes`].
    #[must_use]
    pub fn balanced(&self) -> Vec<DVec3> {
        let mut x = self.inner.clone();
        for &(k, position) in &self.offset_nodes {
            x[k] = position;
        }
        x
    }

    /// Stretch, normal and area at every node.
    #[must_use]
    pub fn deformation(&self) -> &Deformation {
        self.deformation.get_or_init(|| Deformation::new(&self.problem.sheet, &self.inner))
    }

    /// Has [`Self::deformation`] been computed?
    #[must_use]
    pub fn has_deformation(&self) -> bool {
        self.deformation.get().is_some()
    }

    /// Normals and deformed thicknesses of the layers at every node.
    #[must_use]
    pub fn stack(&self) -> &Stack {
        self.stack.get_or_init(|| Stack::new(&self.problem.materials, self.deformation()))
    }

    /// Positions of the tissue's faces \[mm\]: the inner face, the faces between the layers, the skin; shape
    /// (layers + 1, nodes_per_side²).
    #[must_use]
    pub fn faces(&self) -> Vec<Vec<Vec3>> {
        let stack = self.stack();
        let inner = self.inner.iter().map(|p| p.as_vec3()).collect();
        stack.faces(inner, &stack.normal)
    }

    /// The active set and the forces of the dome on the inner face.
    #[must_use]
    pub fn reactions(&self) -> &Reactions {
        self.reactions.get_or_init(|| reactions::of(self, &self.law))
    }
}
