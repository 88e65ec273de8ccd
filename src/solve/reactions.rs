//! The dome's forces on the inner face, from the balance of forces at active nodes.

use super::Solution;
use crate::contact::TOUCH;
use crate::contact::active_set::LEAST_SPREAD;
use crate::mesh::NodeKind;
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

pub(super) fn of(solution: &Solution) -> Reactions {
    let problem = solution.problem();
    let (sheet, dome, wall) = (&problem.sheet, &problem.obstacle.dome, problem.obstacle.wall);
    let x = solution.inner();
    let touch = TOUCH * dome.base_radius;
    let mut normal = vec![DVec3::ZERO; sheet.len()];
    let mut touching = vec![false; sheet.len()];
    for k in (0..sheet.len()).filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
        let (gauge, gradient) = dome.gauge_and_gradient(x[k]);
        let steepness = gradient.length();
        if gauge <= touch * steepness {
            touching[k] = true;
            normal[k] = gradient / steepness;
        }
    }
    // Nodes with a contact offset carry a part of the load, on the dome or slightly above the dome.
    for &(k, _) in solution.offset_nodes() {
        touching[k] = true;
        normal[k] = dome.normal(x[k]);
    }
    let spring_force = solution.forces_on_inner(&touching);
    let mut force = vec![0.0; sheet.len()];
    for k in (0..sheet.len()).filter(|&k| touching[k]) {
        // At a node on dome and wall the wall carries the part along its own normal.
        let up = wall.normal(x[k]);
        let on_wall = wall.gap(x[k]) <= touch && spring_force[k].dot(up) < 0.0;
        let across = if on_wall { normal[k] - up * normal[k].dot(up) } else { normal[k] };
        let squared = across.length_squared();
        if squared > LEAST_SPREAD {
            force[k] = (-spring_force[k].dot(across) / squared).max(0.0);
        }
    }
    Reactions { force, normal }
}
