//! Nested nodal block Gauss–Seidel: one node after the other goes to the minimum of the energy's
//! quadratic model in its three coordinates (vertex block descent, A. Chen et al., ACM TOG 43(4),
//! 2024), with contact inside the nodal solve; coarser grids give the start.

use super::guess;
use super::lanes::Triangle;
use super::law::{Corner, Law, Symmetric};
use super::watch::{End, Watch};
use crate::contact::Dome;
use crate::mesh::{NodeKind, Sheet};
use crate::solve::Problem;
use glam::{DVec2, DVec3};

/// A coarser grid is left when no node moves more in a sweep \[share of the base radius\], or after
/// this many sweeps.
const COARSE_MOVE: f64 = 2e-5;
const COARSE_SWEEPS: u32 = 300;
/// Successive over-relaxation.
const OVER_RELAXATION: f64 = 1.6;
/// The farthest that a node moves in a sweep \[spacings\].
const MOST_MOVE: f64 = 0.5;
/// Cost of a sweep in evaluations of all forces: every triangle is visited from its three corners,
/// for force and stiffness.
const SWEEP_UNITS: f64 = 6.0;

/// A triangle as one of its nodes sees it.
struct Visit {
    others: [u32; 2],
    corner: u32,
}

/// One grid.
struct Level {
    sheet: Sheet,
    /// In units of the spacing.
    dome: Dome,
    free: Vec<u32>,
    /// Where the visits of each free node begin, shape (free + 1, ).
    starts: Vec<u32>,
    visits: Vec<Visit>,
    /// Different corners; those of whole cells are shared.
    corners: Vec<Corner>,
    /// Level of the dome at which each node touches, shape (nodes_per_side², ).
    touch: Vec<f64>,
    /// First shape and positions \[spacings\], shape (nodes_per_side², ).
    guess: Vec<DVec3>,
    x: Vec<DVec3>,
}

/// All grids, from the coarsest to the finest.
pub(super) struct GaussSeidel<'a> {
    problem: &'a Problem,
    law: &'a Law,
    levels: Vec<Level>,
}

impl<'a> GaussSeidel<'a> {
    /// `touch`: the dome's levels at which nodes of the finest grid touch, where that is not zero.
    pub(super) fn new(problem: &'a Problem, law: &'a Law, touch: &[(usize, f64)]) -> Self {
        let mut sheets = vec![problem.sheet.clone()];
        while let Some(coarser) = sheets.last().and_then(Sheet::coarser) {
            sheets.push(coarser);
        }
        let mut levels: Vec<Level> = sheets
            .into_iter()
            .rev()
            .map(|sheet| Level::new(sheet, &problem.obstacle.dome))
            .collect();
        if let Some(finest) = levels.last_mut() {
            touch.iter().for_each(|&(k, level)| finest.touch[k] = level);
        }
        Self { problem, law, levels }
    }

    /// Goes on until the watch ends it.
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
            for sweep in 0..COARSE_SWEEPS {
                work_units += SWEEP_UNITS * level.sheet.len() as f64 / finest_nodes;
                let greatest = level.sweep(self.law, sweep % 2 == 1);
                if greatest <= COARSE_MOVE * level.dome.base_radius || watch.is_out_of_time() {
                    break;
                }
            }
            finer.take_over(level);
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
            if let Some(end) = watch.look(sweep, work_units, write) {
                return end;
            }
        }
        End::Finished
    }
}

impl Level {
    fn new(sheet: Sheet, dome: &Dome) -> Self {
        let spacing = sheet.spacing_mm();
        let free: Vec<u32> = (0..sheet.len() as u32)
            .filter(|k| sheet.kinds()[*k as usize] == NodeKind::Free)
            .collect();
        let guess: Vec<DVec3> =
            guess::tight_string(&sheet, dome).into_iter().map(|x| x / spacing).collect();
        // Whole cells come by the same twelve corners again and again: those of the middle one.
        let half = sheet.nodes_per_side() / 2;
        let mut corners: Vec<Corner> = sheet
            .cell_triangles(half, half)
            .flat_map(|(nodes, weight)| Corner::all(&Triangle::new(&sheet, nodes, weight)))
            .collect();
        let shared = corners.len();
        let mut of_node: Vec<Vec<Visit>> = (0..sheet.len()).map(|_| Vec::new()).collect();
        for (nodes, weight) in sheet.triangles() {
            let triangle = Triangle::new(&sheet, nodes, weight);
            for (c, corner) in Corner::all(&triangle).into_iter().enumerate() {
                let known = corners[..shared].iter().position(|known| known.is_like(&corner));
                let place = known.unwrap_or_else(|| {
                    corners.push(corner);
                    corners.len() - 1
                });
                let others = [nodes[(c + 1) % 3], nodes[(c + 2) % 3]].map(|k| k as u32);
                of_node[nodes[c]].push(Visit { others, corner: place as u32 });
            }
        }
        let (mut starts, mut visits) = (vec![0], Vec::new());
        for k in &free {
            visits.append(&mut of_node[*k as usize]);
            starts.push(visits.len() as u32);
        }
        let dome = Dome {
            center: dome.center / spacing,
            base_radius: dome.base_radius / spacing,
            projection: dome.projection / spacing,
            base_height: dome.base_height / spacing,
        };
        Self {
            x: guess.clone(),
            touch: vec![0.0; sheet.len()],
            sheet,
            dome,
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

    /// One sweep, there or back; the greatest move \[spacings\].
    fn sweep(&mut self, law: &Law, is_back: bool) -> f64 {
        let mut greatest = 0.0_f64;
        let count = self.free.len();
        for place in 0..count {
            let place = if is_back { count - 1 - place } else { place };
            let k = self.free[place] as usize;
            let at = self.x[k];
            let (mut force, mut hessian) = (DVec3::ZERO, Symmetric::default());
            let visits = self.starts[place] as usize..self.starts[place + 1] as usize;
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

    /// Where the quadratic model of a node's energy is least outside of the dome and above the wall.
    #[inline]
    fn relaxed(&self, at: DVec3, touch: f64, force: DVec3, hessian: &Symmetric) -> DVec3 {
        let inverse = inverted(hessian);
        let mut step = product(&inverse, force) * OVER_RELAXATION;
        let z = product(&inverse, DVec3::Z);
        let above = |step: DVec3| {
            let short = -at.z - step.z;
            if short > 0.0 { step + z * (short / z.z) } else { step }
        };
        step = above(step).clamp_length_max(MOST_MOVE);
        if self.dome.gauge(at + step) >= touch {
            return at + step;
        }
        let normal = self.dome.normal(at);
        let (gap, across) =
            ((self.dome.gauge(at) - touch) * self.dome.base_radius, product(&inverse, normal));
        let held = step - across * ((normal.dot(step) + gap) / normal.dot(across));
        let mut moved = at + held.clamp_length_max(MOST_MOVE);
        moved.z = moved.z.max(0.0);
        self.dome.project(moved, touch)
    }

    /// Takes its start from the next coarser grid: the difference from the first shape, interpolated
    /// linearly.
    fn take_over(&mut self, coarse: &Self) {
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
            let mut x = self.guess[k] + mean;
            x.z = x.z.max(0.0);
            self.x[k] = if self.dome.gauge(x) < 0.0 { self.dome.onto_surface(x) } else { x };
        }
    }
}

impl Corner {
    /// Those of a triangle, in the order of its nodes.
    fn all(triangle: &Triangle) -> [Self; 3] {
        let [a, b, c] = triangle.gradients;
        [[b, c], [c, a], [a, b]].map(|gradients| Self { area: triangle.area, gradients })
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |a: DVec2, b: DVec2| a.distance_squared(b) < 1e-24;
        (self.area - other.area).abs() < 1e-12
            && near(self.gradients[0], other.gradients[0])
            && near(self.gradients[1], other.gradients[1])
    }
}

/// The inverse of a symmetric positive matrix; of one that is singular, that of its trace.
#[inline]
fn inverted([xx, yy, zz, xy, xz, yz]: &Symmetric) -> Symmetric {
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * a + xy * b + xz * c;
    let trace = xx + yy + zz;
    if determinant <= 1e-15 * trace.powi(3) {
        let mobility = 1.0 / trace.max(f64::MIN_POSITIVE);
        return [mobility, mobility, mobility, 0.0, 0.0, 0.0];
    }
    [a, xx * zz - xz * xz, xx * yy - xy * xy, b, c, xy * xz - xx * yz].map(|m| m / determinant)
}

#[inline]
fn product([xx, yy, zz, xy, xz, yz]: &Symmetric, v: DVec3) -> DVec3 {
    DVec3::new(
        xx * v.x + xy * v.y + xz * v.z,
        xy * v.x + yy * v.y + yz * v.z,
        xz * v.x + yz * v.y + zz * v.z,
    )
}
