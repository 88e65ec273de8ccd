//! Nested nodal block Gauss–Seidel: each nodal solve minimises the quadratic model of the energy in the
//! three coordinates of a node (vertex block descent, A. Chen et al., ACM TOG 43(4), 2024), with contact
//! inside the nodal solve. Coarser grids provide the initial guess.

use super::law::{Corner, Law};
use super::watch::{End, Watch};
use crate::contact::Obstacle;
use crate::contact::active_set::{Constraint, ON_DOME};
use crate::mesh::{NodeKind, Sheet};
use crate::model::membrane::triangle::Rest;
use crate::solve::linear::galerkin::safe_inverse;
use crate::solve::{Problem, initial_guess};
use glam::{DMat3, DVec3};

/// Greatest nodal step of the last sweep on a coarser grid \[fraction of the base radius\].
const COARSE_STEP: f64 = 2e-5;
/// Greatest number of sweeps on a coarser grid.
const MAX_COARSE_SWEEPS: u32 = 300;
/// Factor of successive over-relaxation \[-\].
const OVER_RELAXATION: f64 = 1.6;
/// Greatest step of a node in a sweep \[spacings\].
const MAX_STEP: f64 = 0.5;
/// Cost of a sweep \[evaluations of all forces\]: force and stiffness of every triangle at its three
/// corners.
const SWEEP_UNITS: f64 = 6.0;

/// A triangle, relative to one of its nodes.
struct Visit {
    others: [u32; 2],
    corner: u32,
}

/// One grid.
struct Level {
    sheet: Sheet,
    /// Dome and wall \[spacings\].
    obstacle: Obstacle,
    free: Vec<u32>,
    /// Index of the first visit of each free node, shape (free + 1, ).
    starts: Vec<u32>,
    visits: Vec<Visit>,
    /// Distinct corners; whole cells share their corners.
    corners: Vec<Corner>,
    /// Gauge of the dome at contact of each node, shape (nodes_per_side², ).
    touch: Vec<f64>,
    /// Initial guess \[spacings\], shape (nodes_per_side², ).
    guess: Vec<DVec3>,
    /// Positions \[spacings\], shape (nodes_per_side², ).
    x: Vec<DVec3>,
}

/// All grids, from the coarsest to the finest.
pub(super) struct GaussSeidel<'a> {
    problem: &'a Problem,
    law: &'a Law,
    levels: Vec<Level>,
}

impl<'a> GaussSeidel<'a> {
    /// Creates all grids; `touch` contains the nodes of the finest grid with a non-zero gauge of the dome at
    /// contact.
    pub(super) fn new(problem: &'a Problem, law: &'a Law, touch: &[(usize, f64)]) -> Self {
        let mut sheets = vec![problem.sheet.clone()];
        while let Some(coarser) = sheets.last().and_then(Sheet::coarser) {
            sheets.push(coarser);
        }
        let mut levels: Vec<Level> =
            sheets.into_iter().rev().map(|sheet| Level::new(sheet, &problem.obstacle)).collect();
        if let Some(finest) = levels.last_mut() {
            touch.iter().for_each(|&(k, gauge)| finest.touch[k] = gauge);
        }
        Self { problem, law, levels }
    }

    /// Runs until the watch ends the run.
    pub(super) fn run(&mut self, watch: &mut Watch) -> End {
        let mut work_units = 0.0;
        let finest = self.levels.len() - 1;
        let finest_nodes = self.problem.sheet.len() as f64;
        for level in &mut self.levels {
            level.start();
        }
        for l in 0..finest {
            let (coarser, finer) = self.levels.split_at_mut(l + 1);
            let (level, finer) = (&mut coarser[l], &mut finer[0]);
            for sweep in 0..MAX_COARSE_SWEEPS {
                work_units += SWEEP_UNITS * level.sheet.len() as f64 / finest_nodes;
                let greatest = level.sweep(self.law, sweep % 2 == 1);
                if greatest <= COARSE_STEP * level.obstacle.dome.base_radius
                    || watch.is_out_of_time()
                {
                    break;
                }
            }
            finer.prolongate_from(level);
        }
        let level = &mut self.levels[finest];
        let spacing = level.sheet.spacing_mm();
        for sweep in 1.. {
            work_units += SWEEP_UNITS;
            level.sweep(self.law, sweep % 2 == 1);
            if !watch.is_due(sweep) {
                continue;
            }
            let (free, positions) = (&level.free, &level.x);
            let write = |x: &mut [DVec3]| {
                for k in free.iter().map(|k| *k as usize) {
                    x[k] = positions[k] * spacing;
                }
            };
            if let Some(end) = watch.sample(sweep, work_units, write) {
                return end;
            }
        }
        End::Finished
    }
}

impl Level {
    fn new(sheet: Sheet, obstacle: &Obstacle) -> Self {
        let spacing = sheet.spacing_mm();
        let free: Vec<u32> = (0..sheet.len() as u32)
            .filter(|k| sheet.kinds()[*k as usize] == NodeKind::Free)
            .collect();
        let guess: Vec<DVec3> = initial_guess::taut_profile(&sheet, &obstacle.dome)
            .into_iter()
            .map(|x| x / spacing)
            .collect();
        // Whole cells share the twelve corners of the middle cell.
        let half = sheet.nodes_per_side() / 2;
        let rest = |(nodes, weight): ([usize; 3], f64)| {
            Rest::new(nodes.map(|k| sheet.rest()[k] / spacing), weight)
        };
        let middle = sheet.cell_triangles(half, half).map(rest);
        let mut corners: Vec<Corner> = middle.flat_map(|rest| Corner::all(&rest)).collect();
        let shared = corners.len();
        let mut of_node: Vec<Vec<Visit>> = (0..sheet.len()).map(|_| Vec::new()).collect();
        for (nodes, weight) in sheet.triangles() {
            let corners_of_triangle = Corner::all(&rest((nodes, weight)));
            for (c, corner) in corners_of_triangle.into_iter().enumerate() {
                let known = corners[..shared].iter().position(|known| known.is_like(&corner));
                let index = known.unwrap_or_else(|| {
                    corners.push(corner);
                    corners.len() - 1
                });
                let others = [nodes[(c + 1) % 3], nodes[(c + 2) % 3]].map(|k| k as u32);
                of_node[nodes[c]].push(Visit { others, corner: index as u32 });
            }
        }
        let (mut starts, mut visits) = (vec![0], Vec::new());
        for k in &free {
            visits.append(&mut of_node[*k as usize]);
            starts.push(visits.len() as u32);
        }
        Self {
            x: guess.clone(),
            touch: vec![0.0; sheet.len()],
            obstacle: obstacle.scaled(1.0 / spacing),
            sheet,
            free,
            starts,
            visits,
            corners,
            guess,
        }
    }

    fn start(&mut self) {
        self.x.copy_from_slice(&self.guess);
    }

    /// Runs one forward or backward sweep; returns the greatest nodal step \[spacings\].
    fn sweep(&mut self, law: &Law, is_backward: bool) -> f64 {
        let mut greatest = 0.0_f64;
        let count = self.free.len();
        for index in 0..count {
            let index = if is_backward { count - 1 - index } else { index };
            let k = self.free[index] as usize;
            let at = self.x[k];
            let (mut force, mut hessian) = (DVec3::ZERO, DMat3::ZERO);
            let visits = self.starts[index] as usize..self.starts[index + 1] as usize;
            for visit in &self.visits[visits] {
                let edges = visit.others.map(|other| self.x[other as usize] - at);
                law.add_corner(
                    &self.corners[visit.corner as usize],
                    edges,
                    &mut force,
                    &mut hessian,
                );
            }
            let moved = self.relaxed(at, self.touch[k], force, &hessian);
            greatest = greatest.max(moved.distance_squared(at));
            self.x[k] = moved;
        }
        greatest.sqrt()
    }

    /// Minimiser of the quadratic model of a node's energy outside of the dome and above the wall.
    #[inline]
    fn relaxed(&self, at: DVec3, touch: f64, force: DVec3, hessian: &DMat3) -> DVec3 {
        let constraint = Constraint::new(&self.obstacle.dome, self.obstacle.wall, at, touch);
        let inverse = safe_inverse(*hessian);
        let (step, active) = constraint.step(force * OVER_RELAXATION, hessian, &inverse);
        let moved = at + step.clamp_length_max(MAX_STEP);
        let is_on_dome = active & ON_DOME != 0;
        let moved = if is_on_dome { self.obstacle.dome.project(moved, touch) } else { moved };
        self.obstacle.project(moved, touch)
    }

    /// Prolongates the solution of the next coarser grid: linear interpolation of the difference from the
    /// initial guess.
    fn prolongate_from(&mut self, coarse: &Self) {
        let (n, nc) = (self.sheet.nodes_per_side(), coarse.sheet.nodes_per_side());
        let difference = |k: usize| (coarse.x[k] - coarse.guess[k]) * 2.0;
        for k in self.free.iter().map(|k| *k as usize) {
            let (i, j) = (k % n, k / n);
            let (low, right, up) = (j / 2 * nc + i / 2, i % 2, (j % 2) * nc);
            let mean = 0.25
                * (difference(low)
                    + difference(low + right)
                    + difference(low + up)
                    + difference(low + up + right));
            self.x[k] = self.obstacle.project(self.guess[k] + mean, 0.0);
        }
    }
}
