//! The solution of the finest grid in mm.

use super::FullMultigrid;
use super::level::Level;
use crate::contact::TOUCH_F32;
use crate::mesh::Rest;
use crate::model::ElasticModel;
use crate::solve::Problem;
use crate::solve::validity::{self, Invalid};
use glam::DVec3;

impl<M: ElasticModel> FullMultigrid<M> {
    /// Prolongates the solution of the grid being solved to the finest grid, for display; returns the number of nodes
    /// a side of the grid being solved.
    pub(in crate::solve) fn preview(&mut self) -> usize {
        for grid in self.grid..self.levels.len() - 1 {
            self.prolongate(grid);
        }
        self.levels[self.grid].layout.nodes_per_side
    }

    /// Why the shape of the finest grid is invalid; `None` for a valid shape.
    pub(in crate::solve) fn invalid(&self, problem: &Problem) -> Option<Invalid> {
        let Level { layout, u, .. } = self.finest();
        let n = layout.nodes_per_side;
        let stored = layout.first();
        let first = layout.mirrored.map(|is_mirrored| if is_mirrored { n / 2 } else { 0 });
        let Problem { rest, obstacle, tissue, tolerance, .. } = problem;
        validity::invalid((rest.sheet(), *tissue), &obstacle.dome, *tolerance, first, |i, j| {
            let moved = u.at((j - stored[1]) * layout.pitch + i - stored[0]).map(f64::from);
            rest.node(0, j * n + i) + DVec3::from(moved) * self.spacing
        })
    }

    /// Writes the positions \[mm\] of all free nodes of the finest grid, shape (n², ), nodes in contact projected onto
    /// the dome, and the positions of the nodes with contact offsets.
    pub(in crate::solve) fn write_positions(
        &self,
        problem: &Problem,
        x: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
    ) {
        let (rest, dome) = (&problem.rest, problem.obstacle.dome.draped::<f64>());
        offset_nodes.clear();
        let Level { layout, u, active, contact_offset, .. } = self.finest();
        let (n, first) = (layout.nodes_per_side, layout.first());
        let [along_x, along_y] = layout.mirrored;
        layout.free_rows(|j, from, to| {
            for i in from..to {
                let at = j * layout.pitch + i;
                let [ux, uy, uz] = u.at(at).map(f64::from);
                let (offset, is_active) = (contact_offset[at], active[at] > 0.0);
                let mut set = |i: usize, j: usize, u: DVec3| {
                    let k = j * n + i;
                    x[k] = rest.node(0, k) + u * self.spacing;
                    if offset != 0.0 && is_active {
                        // A node on an axis of symmetry is listed twice.
                        offset_nodes.push((k, x[k]));
                    }
                    let (point, is_lifted) = (x[k].to_array(), offset > 0.0 && is_active);
                    // Most nodes need no root.
                    let is_near = offset == 0.0 && dome.length_squared(point) < 1.0 + 1e-3;
                    if is_lifted || is_near {
                        let near = dome.near(point);
                        if is_lifted || near.length < 1.0 + TOUCH_F32 {
                            x[k] += DVec3::from(dome.way_to(&near, 1.0));
                        }
                    }
                };
                let (i, j) = (i + first[0], j + first[1]);
                let (i2, j2) = (n - 1 - i, n - 1 - j);
                set(i, j, DVec3::new(ux, uy, uz));
                if along_x {
                    set(i2, j, DVec3::new(-ux, uy, uz));
                }
                if along_y {
                    set(i, j2, DVec3::new(ux, -uy, uz));
                }
                if along_x && along_y {
                    set(i2, j2, DVec3::new(-ux, -uy, uz));
                }
            }
        });
    }

    /// Writes the positions \[mm\] of all free nodes above the inner face, layer by layer, shape (layers − 1, n²).
    pub(in crate::solve) fn write_layers(&self, rest: &Rest, x: &mut [Vec<DVec3>]) {
        let Level { layout, u, .. } = self.finest();
        let (n, first) = (layout.nodes_per_side, layout.first());
        let [along_x, along_y] = layout.mirrored;
        for ((layer, first_stored), x) in u.layers().enumerate().skip(1).zip(x) {
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let [ux, uy, uz] = u.at(first_stored + j * layout.pitch + i).map(f64::from);
                    let mut set = |i: usize, j: usize, u: [f64; 3]| {
                        let k = j * n + i;
                        x[k] = rest.node(layer, k) + DVec3::from(u) * self.spacing;
                    };
                    let (i, j) = (i + first[0], j + first[1]);
                    let (i2, j2) = (n - 1 - i, n - 1 - j);
                    set(i, j, [ux, uy, uz]);
                    if along_x {
                        set(i2, j, [-ux, uy, uz]);
                    }
                    if along_y {
                        set(i, j2, [ux, -uy, uz]);
                    }
                    if along_x && along_y {
                        set(i2, j2, [-ux, -uy, uz]);
                    }
                }
            });
        }
    }
}
