//! The dome's forces on the inner face, from the balance of forces at active nodes.

use super::Solution;
use super::yielding::Work;
use crate::contact::TOUCH;
use crate::contact::active_set::LEAST_SPREAD;
use crate::mesh::NodeKind;
use crate::mesh::part::Part;
use glam::DVec3;

/// Contact with the dome at every node; arrays of shape (nodes_per_side², ).
#[derive(Clone, Debug)]
pub struct Reactions {
    /// Normal force of the dome \[kPa·mm² = mN\]; zero at nodes that are not active.
    pub force: Vec<f64>,
    /// The dome's unit normal at nodes in contact, else zero.
    pub normal: Vec<DVec3>,
}

impl Reactions {
    /// Does the dome press on a node?
    #[must_use]
    pub fn is_active(&self, node: usize) -> bool {
        self.force[node] > 0.0
    }
}

/// [`Reactions`] on the part of the sheet that determines the shape; arrays over the part.
#[derive(Clone, Debug)]
pub(crate) struct PartReactions {
    part: Part,
    /// See [`Reactions::force`].
    pub(crate) force: Vec<f64>,
    normal: Vec<DVec3>,
}

impl PartReactions {
    /// Vertical force of the dome on the whole sheet \[kPa·mm²\].
    pub(crate) fn vertical_force(&self) -> f64 {
        let vertical = self.force.iter().zip(&self.normal).map(|(f, n)| f * n.z);
        let nodes = self.part.nodes().zip(vertical).filter(|(_, vertical)| *vertical != 0.0);
        nodes.map(|(k, vertical)| self.part.multiplicity(k) * vertical).sum()
    }

    /// Sum of the dome's forces on the whole sheet \[kPa·mm²\].
    pub(crate) fn resultant(&self) -> DVec3 {
        let forces = self.force.iter().zip(&self.normal).map(|(f, n)| *n * *f);
        let nodes = self.part.nodes().zip(forces);
        let sum: DVec3 = nodes.map(|(k, force)| self.part.multiplicity(k) * force).sum();
        // Forces of mirror images cancel along the mirrored axis.
        let [x, y] = self.part.first().map(|first| if first > 0 { 0.0 } else { 1.0 });
        sum * DVec3::new(x, y, 1.0)
    }

    /// Work of the forces by the numbers of the deformation of an implant that yields.
    pub(super) fn work(&self, solution: &Solution) -> Work {
        let (dome, x) = (&solution.problem().obstacle.dome, solution.inner());
        let mut work = Work::default();
        for (index, k) in
            self.part.nodes().enumerate().filter(|(index, _)| self.force[*index] > 0.0)
        {
            let steepness = dome.gauge_gradient(x[k]).length();
            let force = self.part.multiplicity(k) * self.force[index];
            work.add(force / steepness, steepness, dome.variation(x[k]));
        }
        work
    }

    pub(super) fn on_grid(&self) -> Reactions {
        let part = self.part;
        let normal = |k: usize| {
            let normal = self.normal[part.index(k)];
            let [x, y] = part.is_image(k).map(|is_image| if is_image { -1.0 } else { 1.0 });
            DVec3::new(x * normal.x, y * normal.y, normal.z)
        };
        Reactions {
            force: part.on_grid(self.force.clone()),
            normal: (0..part.nodes_of_grid()).map(normal).collect(),
        }
    }
}

pub(super) fn of(solution: &Solution) -> PartReactions {
    let problem = solution.problem();
    let (sheet, dome, wall) = (problem.sheet(), &problem.obstacle.dome, &problem.obstacle.wall);
    let x = solution.inner();
    let part = solution.part();
    let touch = TOUCH * dome.reference_length();
    let mut normal = vec![DVec3::ZERO; part.len()];
    let mut touching = vec![false; part.len()];
    for (index, k) in part.nodes().enumerate() {
        if sheet.kinds()[k] != NodeKind::Free {
            continue;
        }
        let (gauge, gradient) = dome.gauge_and_gradient(x[k]);
        let steepness = gradient.length();
        if gauge <= touch * steepness {
            touching[index] = true;
            normal[index] = gradient / steepness;
        }
    }
    // Nodes with a contact offset carry a part of the load, on the dome or slightly above the dome.
    for &(k, _) in solution.offset_nodes() {
        if part.is_image(k) == [false; 2] {
            let index = part.index(k);
            touching[index] = true;
            normal[index] = dome.normal(x[k]);
        }
    }
    let spring_forces = solution.forces_on_inner(&touching);
    let mut force = vec![0.0; part.len()];
    for (index, k) in part.nodes().enumerate().filter(|(index, _)| touching[*index]) {
        let (spring_force, normal) = (spring_forces[index], normal[index]);
        // At a node on dome and wall the wall carries the part along its own normal.
        let up = wall.normal(x[k]);
        let on_wall = wall.gap(x[k]) <= touch && spring_force.dot(up) < 0.0;
        let across = if on_wall { normal - up * normal.dot(up) } else { normal };
        let squared = across.length_squared();
        if squared > LEAST_SPREAD {
            force[index] = (-spring_force.dot(across) / squared).max(0.0);
        }
    }
    PartReactions { part, force, normal }
}
