//! The kernels of full multigrid one by one, for benchmarks only (`benches/kernels.rs`).
//!
//! [`Kernels`] contains a solved grid and the next coarser grid. Every kernel runs on the equilibrium and leaves
//! the shape unchanged in any number of runs.

use super::level::Level;
use super::parameters::MEMBRANE;
use super::smoother::{Contact, Damping};
use super::{FullMultigrid, State, Stop, smoother, transfer};
use crate::mesh::lanes::Field;
use crate::model::membrane::lanes::Membrane;
use crate::model::membrane::law::SheetLaw;
use crate::solve::Problem;

/// One pass over the nodes of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Spring forces.
    Force,
    /// Inverse diagonal blocks of the stiffness.
    Blocks,
    /// A step of the smoother with contact, without the evaluation of forces.
    Step,
    /// The residual with contact, without the evaluation of forces.
    Residual,
    /// Restriction of the residual to the coarser grid.
    Restriction,
    /// Prolongation of the coarser grid's correction, added under contact.
    Correction,
    /// Prolongation of the coarser grid's solution, projected out of the dome.
    Refinement,
}

impl Kernel {
    /// All kernels.
    pub const ALL: [Self; 7] = [
        Self::Force,
        Self::Blocks,
        Self::Step,
        Self::Residual,
        Self::Restriction,
        Self::Correction,
        Self::Refinement,
    ];

    /// Name of the kernel in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Blocks => "blocks",
            Self::Step => "step",
            Self::Residual => "residual",
            Self::Restriction => "restriction",
            Self::Correction => "correction",
            Self::Refinement => "refinement",
        }
    }
}

/// A solved grid for runs of single kernels.
#[derive(Clone, Debug)]
pub struct Kernels {
    scheme: FullMultigrid<Membrane>,
    /// Spring forces in balance with dome and wall: fixed point of the smoother.
    carried: Field,
    /// The other forces.
    residual: Field,
    marks: Vec<f32>,
    shape: Field,
    active_fraction: f64,
}

impl Kernels {
    /// Solves a problem; `None` if full multigrid does not converge, or without a coarser grid.
    #[must_use]
    pub fn new(problem: &Problem) -> Option<Self> {
        let law = SheetLaw::new(problem.springs, &problem.materials);
        if !matches!(law, SheetLaw::Coupled(_)) {
            return None;
        }
        let mirrored = problem.obstacle.dome.mirrored();
        let n = problem.sheet.nodes_per_side();
        let mut scheme = FullMultigrid::new(n, mirrored, Membrane::new(&law), &MEMBRANE);
        scheme.start(problem, Stop::Tolerance, None);
        let ended = loop {
            match scheme.step() {
                State::Working => {}
                ended => break ended,
            }
        };
        let FullMultigrid { levels, model, .. } = &mut scheme;
        let [.., coarse, fine] = levels.as_mut_slice() else { return None };
        if ended != State::Converged {
            return None;
        }
        fine.find_forces(model);
        let mut carried = fine.f.clone();
        fine.find_residual(model, Contact::OneSided);
        let residual = fine.f.clone();
        for (all, left) in carried.planes_mut().zip(residual.planes()) {
            all.iter_mut().zip(left).for_each(|(all, left)| *all -= left);
        }
        // The cost of a correction does not depend on its values.
        coarse.before.copy_from(&coarse.u);
        let (mut active, layout) = (0.0, &fine.layout);
        layout.free_rows(|j, from, to| {
            let row = &fine.active[j * layout.pitch..];
            active += row[from..to].iter().map(|&mark| f64::from(mark)).sum::<f64>();
        });
        Some(Self {
            active_fraction: active / layout.free_nodes() as f64,
            carried,
            residual,
            marks: fine.active.clone(),
            shape: fine.u.clone(),
            scheme,
        })
    }

    /// Nodes solved for, under symmetry.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.scheme.nodes()
    }

    /// Fraction of nodes in contact with the dome \[-\].
    #[must_use]
    pub fn active_fraction(&self) -> f64 {
        self.active_fraction
    }

    /// Runs a kernel once.
    pub fn run(&mut self, kernel: Kernel) {
        let Self { scheme, carried, residual, marks, shape, .. } = self;
        let FullMultigrid { levels, model, row, .. } = scheme;
        let [.., coarse, fine] = levels.as_mut_slice() else { return };
        match kernel {
            Kernel::Force => fine.find_forces(model),
            Kernel::Blocks => fine.invert_blocks(model),
            Kernel::Step => fine.step_at(carried, MEMBRANE.smoothing.before[0]),
            Kernel::Residual => fine.residual_of(residual, marks),
            Kernel::Restriction => {
                let Level { layout, tau: Some(tau), .. } = coarse else { return };
                transfer::restrict(layout, &fine.layout, residual, tau);
            }
            Kernel::Correction => fine.correct(coarse, row),
            Kernel::Refinement => {
                let Level { layout, u, f, .. } = coarse;
                transfer::prolongate_solution(layout, &fine.layout, u, f, shape, row);
                smoother::project_feasible(&fine.layout, &fine.obstacle, shape);
            }
        }
    }

    /// Norm of the nodal forces without contact forces, relative to the forces of the cells \[-\].
    #[must_use]
    pub fn relative_residual(&mut self) -> f64 {
        let FullMultigrid { levels, model, .. } = &mut self.scheme;
        let [.., fine] = levels.as_mut_slice() else { return f64::INFINITY };
        let squares = fine.find_residual(model, Contact::OneSided);
        (squares / fine.tension(model).squares).sqrt()
    }
}

impl Level<Membrane> {
    /// A step of the smoother with given forces.
    fn step_at(&mut self, f: &Field, omega: f32) {
        let Self { layout, obstacle, u, tau, inverse, active, contact_offset, .. } = self;
        let conditions =
            Self::conditions(obstacle, Contact::OneSided, inverse, tau, contact_offset);
        let damping = Damping { omega, has_hardening: true, block_growth: f64::INFINITY };
        smoother::step(layout, &conditions, damping, f, active, u);
    }

    /// Replaces given forces by their residual.
    fn residual_of(&self, f: &mut Field, marks: &mut [f32]) {
        let Self { layout, obstacle, u, tau, inverse, contact_offset, .. } = self;
        let conditions =
            Self::conditions(obstacle, Contact::OneSided, inverse, tau, contact_offset);
        smoother::residual(layout, &conditions, u, marks, f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Dome, Obstacle};
    use crate::curve::{Curve, CurveSpec};
    use crate::mesh::lanes::Layout;
    use crate::mesh::{Patch, Sheet};
    use crate::springs::{Material, Springs};
    use glam::DVec2;

    /// Skin over a hemisphere.
    fn problem(x: f64) -> Problem {
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        Problem {
            sheet: Sheet::new(65, 70.0),
            patch: Patch::clamped_at_pocket(70.0),
            obstacle: Obstacle::on_flat_wall(Dome::new(DVec2::new(x, 0.0), 55.0, 55.0, 1.0)),
            materials: vec![Material { curve, poisson_ratio: 0.45, thickness_mm: 1.5 }],
            springs: Springs::Coupled,
            tissue: crate::solve::Tissue::Sheet,
            tolerance: 1e-5,
        }
    }

    #[test]
    fn kernels_leave_a_balanced_grid_as_it_is() {
        for x in [0.0, 10.0] {
            let mut kernels = Kernels::new(&problem(x)).unwrap();
            let finest = |kernels: &Kernels| kernels.scheme.levels.last().unwrap().clone();
            let before = finest(&kernels);
            assert!(
                (0.2..0.8).contains(&kernels.active_fraction()),
                "{}",
                kernels.active_fraction()
            );
            assert!(kernels.relative_residual() < 1e-3, "{}", kernels.relative_residual());
            for kernel in Kernel::ALL {
                for _ in 0..50 {
                    kernels.run(kernel);
                }
                let (now, layout) = (finest(&kernels), &before.layout);
                let moved = layout.greatest_difference(&now.u, &before.u);
                assert!(moved < 1e-4, "{kernel:?} moves nodes by {moved}");
                // The prolongated coarse shape is close to the fine shape.
                let off = layout.greatest_difference(&kernels.shape, &before.u);
                assert!(off < 0.2, "{kernel:?}: {off}");
            }
            assert!(kernels.relative_residual() < 1e-3, "{}", kernels.relative_residual());
        }
    }

    /// Numbers in (−1, 1) at free nodes, zero elsewhere, symmetric on a mirrored grid.
    fn noise(layout: &Layout, mut seed: u64) -> Field {
        let mut field = Field::new(layout.len(), 1);
        layout.free_rows(|j, from, to| {
            for k in j * layout.pitch + from..j * layout.pitch + to {
                for part in [&mut field.x, &mut field.y, &mut field.z] {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    part[k] = (seed >> 40) as f32 / (1 << 23) as f32 - 1.0;
                }
            }
        });
        layout.mirror(&mut field);
        field
    }

    /// Σ a·b over the whole sheet; nodes on an axis of a mirrored grid belong to both sides.
    fn product(layout: &Layout, a: &Field, b: &Field) -> f64 {
        let mut sum = 0.0;
        let share = |i: usize, is_mirrored| if is_mirrored && i == 1 { 0.5 } else { 1.0 };
        layout.free_rows(|j, from, to| {
            for i in from..to {
                let k = j * layout.pitch + i;
                let (p, q) = (a.at(k), b.at(k));
                let dot: f64 = (0..3).map(|c| f64::from(p[c]) * f64::from(q[c])).sum();
                sum += share(i, layout.mirrored[0]) * share(j, layout.mirrored[1]) * dot;
            }
        });
        sum
    }

    #[test]
    fn restriction_is_the_transpose_of_interpolation() {
        for mirrored in [[false; 2], [true, false], [false, true], [true; 2]] {
            let [(coarse, _), (fine, _)] = [33, 65].map(|n| Layout::new(n, mirrored));
            for seed in 1..4 {
                let (r, c) = (noise(&fine, seed), noise(&coarse, seed + 10));
                let mut down = Field::new(coarse.len(), 1);
                transfer::restrict(&coarse, &fine, &r, &mut down);
                let mut up = Field::new(fine.len(), 1);
                let still = Field::new(coarse.len(), 1);
                transfer::correction(&coarse, &fine, &c, &still, &mut up, &mut [0.0; 80]);
                // Work in units of the coarse grid: forces and displacements have half the value, the square of the
                // spacing is four times the fine grid's.
                let work = 4.0 * product(&coarse, &down, &c);
                let same = product(&fine, &r, &up);
                let size = (product(&fine, &r, &r) * product(&fine, &up, &up)).sqrt();
                assert!((work - same).abs() < 1e-6 * size, "{work} and {same} of {size}");
            }
        }
    }
}
