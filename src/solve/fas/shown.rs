//! The shape of the finest grid, as others see it.

use super::level::Level;
use super::{FullMultigrid, Problem, TOUCH};
use crate::solve::soundness::{self, Fault};
use glam::DVec3;

impl FullMultigrid {
    /// Carries the shape of the grid being solved up to the finest one, to be shown; gives the nodes a
    /// side of the grid that it comes from.
    pub(in crate::solve) fn preview(&mut self) -> usize {
        for l in self.current..self.levels.len() - 1 {
            self.raise(l);
        }
        self.levels[self.current].layout.nodes_per_side
    }

    /// What is wrong with the finest grid's shape, if anything is.
    pub(in crate::solve) fn fault(&self, problem: &Problem) -> Option<Fault> {
        let Level { layout, u, .. } = &self.levels[self.levels.len() - 1];
        let n = layout.nodes_per_side;
        let stored = layout.first();
        let seen = layout.mirrored.map(|is_mirrored| if is_mirrored { n / 2 } else { 0 });
        let rest = problem.sheet.rest();
        soundness::fault(&problem.sheet, &problem.dome, problem.tolerance, seen, |i, j| {
            let moved = u.at((j - stored[1]) * layout.pitch + i - stored[0]).map(f64::from);
            rest[j * n + i].extend(0.0) + DVec3::from(moved) * self.spacing
        })
    }

    /// Writes the positions \[mm\] of all free nodes of the finest grid, shape (n², ), the nodes that
    /// touch on the dome itself, and where those stand that are lifted.
    pub(in crate::solve) fn write_positions(
        &self,
        problem: &Problem,
        x: &mut [DVec3],
        lifted: &mut Vec<(usize, DVec3)>,
    ) {
        let (sheet, dome) = (&problem.sheet, &problem.dome);
        lifted.clear();
        let level = &self.levels[self.levels.len() - 1];
        let layout = &level.layout;
        let (n, first) = (layout.nodes_per_side, layout.first());
        let [along_x, along_y] = layout.mirrored;
        layout.free_rows(|j, from, to| {
            for i in from..to {
                let at = j * layout.pitch + i;
                let [ux, uy, uz] = level.u.at(at).map(f64::from);
                let (lift, is_held) = (level.lift[at], level.hold[at] > 0.0);
                let is_near = level.dome.is_near(layout.rest(i, j), level.u.at(at));
                let mut set = |i: usize, j: usize, u: DVec3| {
                    let k = j * n + i;
                    x[k] = sheet.rest()[k].extend(0.0) + u * self.spacing;
                    if lift != 0.0 && is_held {
                        // Twice on an axis of symmetry, which does no harm.
                        lifted.push((k, x[k]));
                    }
                    let is_on = || is_near && dome.level(x[k]) < TOUCH;
                    if lift > 0.0 && is_held || lift == 0.0 && is_on() {
                        x[k] = dome.onto_surface(x[k]);
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
}
