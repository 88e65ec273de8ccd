//! The kernels of full multigrid one by one, for benchmarks (`benches/kernels.rs`) and for nothing
//! else: the solver itself does not use this.
//!
//! [`Kernels`] holds a solved grid and the next coarser one. Every kernel runs on them with the
//! numbers of the equilibrium and leaves the shape where it is, however often it is run.

use super::grid::Field;
use super::level::Level;
use super::smooth::{self, Contact, Pull};
use super::{FullMultigrid, SMOOTHING, State, transfer};
use crate::solve::Problem;
use crate::solve::law::SheetLaw;

/// One pass over the nodes of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Spring forces.
    Force,
    /// Inverse diagonal blocks of the stiffness.
    Blocks,
    /// A step of the smoother with contact, without the forces that it needs.
    Step,
    /// The residual with contact, without the forces that it needs.
    Residual,
    /// The residual's way to the coarser grid.
    Restriction,
    /// The coarser grid's correction: interpolated, and added under contact.
    Correction,
    /// The coarser grid's shape as a start: interpolated, and put outside of the dome.
    Refinement,
}

/// What a kernel computes and moves, counted in the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelCost {
    /// Additions (and subtractions), multiplications, divisions and square roots, one each.
    pub flops_per_node: f64,
    /// The divisions and square roots among them: they have a unit of their own.
    pub divisions_per_node: f64,
    /// Arrays streamed once in and once out \[bytes\].
    pub bytes_per_node: f64,
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

    /// What it is called in reports.
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

    /// The cost of a node of the finer grid that does not touch.
    ///
    /// How it is counted: every +, −, ×, ÷ and √ of the source is one, in each of the four lanes, for
    /// one group of layers and one-sided contact; comparisons, minima, signs, selections, shuffles,
    /// indices, and what is computed once a row are none. There is one regular cell a node; border
    /// triangles, whose share falls with the spacing, are left out, and so is a curve's line beyond its
    /// data. A coarse node is a quarter of a fine one. Of bytes, each array of f32 counts once if it
    /// is read and once if it is written, as if caches kept it between passes of one kernel.
    fn table(self) -> KernelCost {
        // (flops, divisions and roots, arrays of f32)
        let (flops, divisions, arrays) = match self {
            // measure_row: edges 16, eight products 40, four times s, I₁, t 8: 88. tension, four
            // times: ē 10, secant 6, inverse 2, P and Q 9: 108. pull_row: edges 16, shears 4, four
            // pulls of 20, sums at the corners 24: 124. Each of four triangles: √ of s, t, ē, one ÷.
            // u in; f in and out.
            Self::Force => (88 + 108 + 124, 16, 9.0),
            // cell_block: edges 16, means 12, metric 15, s and I₁ 5, stiffness 51 (t 3, ē 10, secant
            // and slope 9, sums 29), 1/s and 1/t 2, normal 12, across 4, nnᵀ 15, τ₁ and τ₂ 36, two
            // stretches of 42, isotropic 3, doubled 6; block_row 18; inverted 36. √ of s, t, ē; ÷:
            // two of the slope, sec′/ē, β/t, 1/s, 1/t, 1/det, 1/trace. u in; six arrays in and out.
            Self::Blocks => (261 + 18 + 36, 11, 15.0),
            // D⁻¹f 15, ω 3, square 5, hardening 9, share 3 and its product 3, rest 1, level 21, towards
            // 5, lift 1, over 2, sum 3. ÷: hardening, share, 1/length; √: share, length. f, D⁻¹, u
            // and lift in; u out.
            Self::Step => (71, 5, 16.0),
            // Rest 1, level 21, across 5, lift 1, share 6, projection 6, square 6. ÷: 1/length, share;
            // √: length. u, f and lift in; f and hold out.
            Self::Residual => (46, 3, 11.0),
            // Eleven a coarse component.
            Self::Restriction => (8, 0, 3.75),
            // Interpolation: 1.75 a component in columns that both grids have, 1 in between: 8.25.
            // Rest 1, level 21, normal part 11 and its removal 6, place 3, back 32, its direction 5, sum 6.
            // ÷: 1/length, normal part, back; √: length, back. Two coarse vectors in, the correction
            // out and in, u in and out, hold and lift in.
            Self::Correction => (8 + 85, 5, 15.5),
            // Scaled: 10 a coarse node. A component: 1.25 + 2.5 for the cubics, 7 for what multiplies
            // them; settle: rest 1, level 21, ray 2, upright 10, which is shorter 8, out 3, sum 3. ÷: a
            // quarter, 1/length, ray, upright; √: length, height. A coarse vector in, another out and
            // in, u out, in and out.
            Self::Refinement => (2 + 32 + 48, 5, 11.25),
        };
        KernelCost {
            flops_per_node: f64::from(flops),
            divisions_per_node: f64::from(divisions),
            bytes_per_node: 4.0 * arrays,
        }
    }
}

/// What a step adds for a node that touches (flops, divisions and roots, arrays): D⁻¹n 15, share 6, d 6,
/// place 3, back 32 (scaled 6, products 15, c 2, root 4, share 2, product 3), sum 6. Share, back; length.
const HELD_STEP: (f64, f64, f64) = (68.0, 3.0, 0.0);
/// What a residual adds: D⁻¹r 15, its normal part 5, gap 1, sum 1. D⁻¹ in.
const HELD_RESIDUAL: (f64, f64, f64) = (22.0, 0.0, 6.0);

/// A solved grid on which one kernel can be run at a time.
#[derive(Clone, Debug)]
pub struct Kernels {
    scheme: FullMultigrid,
    /// What the dome and the wall carry, as the springs' pull: where the smoother rests.
    carried: Field,
    /// What nothing carries.
    residual: Field,
    marks: Vec<f32>,
    shape: Field,
    held_share: f64,
}

impl Kernels {
    /// Solves a problem; `None` if full multigrid does not, or if there is no coarser grid.
    #[must_use]
    pub fn new(problem: &Problem) -> Option<Self> {
        let law = SheetLaw::new(problem.springs, &problem.materials);
        if !matches!(law, SheetLaw::Coupled(_)) {
            return None;
        }
        let mirrored = problem.dome.mirrored();
        let mut scheme = FullMultigrid::new(problem.sheet.nodes_per_side(), mirrored);
        scheme.set_law(&law);
        scheme.start(problem, None, None);
        let ended = loop {
            match scheme.step() {
                State::Working => {}
                ended => break ended,
            }
        };
        let FullMultigrid { levels, law, .. } = &mut scheme;
        let [.., coarse, fine] = levels.as_mut_slice() else { return None };
        if ended != State::Converged {
            return None;
        }
        fine.forces(law);
        let mut carried = fine.f.clone();
        fine.find_residual(law, Contact::OneSided);
        let residual = fine.f.clone();
        let parts = [
            (&mut carried.x, &residual.x),
            (&mut carried.y, &residual.y),
            (&mut carried.z, &residual.z),
        ];
        for (all, left) in parts {
            all.iter_mut().zip(left).for_each(|(all, left)| *all -= left);
        }
        // A correction of zero, which costs as much as any other.
        coarse.before.copy_from(&coarse.u);
        let (mut held, layout) = (0.0, &fine.layout);
        layout.free_rows(|j, from, to| {
            let row = &fine.hold[j * layout.pitch..];
            held += row[from..to].iter().map(|&mark| f64::from(mark)).sum::<f64>();
        });
        Some(Self {
            held_share: held / layout.free_nodes() as f64,
            carried,
            residual,
            marks: fine.hold.clone(),
            shape: fine.u.clone(),
            scheme,
        })
    }

    /// Nodes of the grid that are solved for: those that symmetry leaves.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.scheme.nodes()
    }

    /// Nodes that touch the dome \[share of all\].
    #[must_use]
    pub fn held_share(&self) -> f64 {
        self.held_share
    }

    /// What a kernel costs on this grid.
    #[must_use]
    pub fn cost(&self, kernel: Kernel) -> KernelCost {
        let mut cost = kernel.table();
        let (flops, divisions, arrays) = match kernel {
            Kernel::Step => HELD_STEP,
            Kernel::Residual => HELD_RESIDUAL,
            _ => return cost,
        };
        cost.flops_per_node += self.held_share * flops;
        cost.divisions_per_node += self.held_share * divisions;
        cost.bytes_per_node += self.held_share * 4.0 * arrays;
        cost
    }

    /// Runs a kernel once.
    pub fn run(&mut self, kernel: Kernel) {
        let Self { scheme, carried, residual, marks, shape, .. } = self;
        let FullMultigrid { levels, law, row, .. } = scheme;
        let [.., coarse, fine] = levels.as_mut_slice() else { return };
        match kernel {
            Kernel::Force => fine.forces(law),
            Kernel::Blocks => fine.invert_blocks(law),
            Kernel::Step => {
                let Level { layout, dome, u, inverse, hold, lift, .. } = fine;
                let pull = Pull { inverse, tau: None, lift };
                let step = (&pull, &*carried, hold.as_slice());
                smooth::step(layout, dome, Contact::OneSided, SMOOTHING[0], step, u);
            }
            Kernel::Residual => {
                let Level { layout, dome, u, inverse, lift, .. } = fine;
                let pull = Pull { inverse, tau: None, lift };
                smooth::residual(layout, dome, Contact::OneSided, u, &pull, marks, residual);
            }
            Kernel::Restriction => {
                transfer::restrict(&coarse.layout, &fine.layout, residual, &mut coarse.tau);
            }
            Kernel::Correction => fine.add_correction(coarse, row),
            Kernel::Refinement => {
                let (from, scaled) = (&coarse.u, &mut coarse.f);
                transfer::refine(&coarse.layout, &fine.layout, from, scaled, shape, row);
                smooth::settle(&fine.layout, &fine.dome, shape);
            }
        }
    }

    /// Norm of the forces that nothing carries, relative to those they are the sum of \[-\].
    #[must_use]
    pub fn relative_residual(&mut self) -> f64 {
        let FullMultigrid { levels, law, .. } = &mut self.scheme;
        let [.., fine] = levels.as_mut_slice() else { return f64::INFINITY };
        let squares = fine.find_residual(law, Contact::OneSided);
        (squares / fine.tension(law).squares).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::Layout;
    use super::*;
    use crate::curve::{Curve, CurveSpec};
    use crate::implant::Dome;
    use crate::sheet::Sheet;
    use crate::springs::{Material, Springs};
    use glam::DVec2;

    /// Skin over a hemisphere.
    fn problem(x: f64) -> Problem {
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        Problem {
            sheet: Sheet::new(65, 70.0),
            dome: Dome::new(DVec2::new(x, 0.0), 55.0, 55.0, 1.0),
            materials: vec![Material { curve, poisson_ratio: 0.45, thickness_mm: 1.5 }],
            springs: Springs::Coupled,
            tolerance: 1e-5,
        }
    }

    #[test]
    fn kernels_leave_a_balanced_grid_as_it_is() {
        for x in [0.0, 10.0] {
            let mut kernels = Kernels::new(&problem(x)).unwrap();
            let finest = |kernels: &Kernels| kernels.scheme.levels.last().unwrap().clone();
            let before = finest(&kernels);
            assert!((0.2..0.8).contains(&kernels.held_share()), "{}", kernels.held_share());
            assert!(kernels.relative_residual() < 1e-3, "{}", kernels.relative_residual());
            for kernel in Kernel::ALL {
                for _ in 0..50 {
                    kernels.run(kernel);
                }
                let (now, layout) = (finest(&kernels), &before.layout);
                let moved = smooth::greatest_difference(layout, &now.u, &before.u);
                assert!(moved < 1e-4, "{kernel:?} moves nodes by {moved}");
                // What the coarse shape interpolates to is not far from the fine one.
                let off = smooth::greatest_difference(layout, &kernels.shape, &before.u);
                assert!(off < 0.2, "{kernel:?}: {off}");
            }
            assert!(kernels.relative_residual() < 1e-3, "{}", kernels.relative_residual());
        }
    }

    #[test]
    fn every_kernel_has_a_cost() {
        let kernels = Kernels::new(&problem(0.0)).unwrap();
        for kernel in Kernel::ALL {
            let cost = kernels.cost(kernel);
            assert!(cost.flops_per_node > cost.divisions_per_node && cost.bytes_per_node > 0.0);
        }
        assert!(kernels.cost(Kernel::Step).flops_per_node > Kernel::Step.table().flops_per_node);
    }

    /// Numbers in (−1, 1) at free nodes, zero elsewhere, symmetric on a mirrored grid.
    fn noise(layout: &Layout, mut seed: u64) -> Field {
        let mut field = Field::new(layout.len());
        layout.free_rows(|j, from, to| {
            for k in j * layout.pitch + from..j * layout.pitch + to {
                for part in [&mut field.x, &mut field.y, &mut field.z] {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    part[k] = (seed >> 40) as f32 / (1 << 23) as f32 - 1.0;
                }
            }
        });
        smooth::mirror(layout, &mut field);
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
            let (coarse, fine) = (Layout::new(33, mirrored), Layout::new(65, mirrored));
            for seed in 1..4 {
                let (r, c) = (noise(&fine, seed), noise(&coarse, seed + 10));
                let mut down = Field::new(coarse.len());
                transfer::restrict(&coarse, &fine, &r, &mut down);
                let mut up = Field::new(fine.len());
                let still = Field::new(coarse.len());
                transfer::correction(&coarse, &fine, &c, &still, &mut up, &mut [0.0; 80]);
                // Work in units of the coarse grid, whose square of a spacing is four times the fine
                // one's: a force has half the number, a displacement too.
                let work = 4.0 * product(&coarse, &down, &c);
                let same = product(&fine, &r, &up);
                let size = (product(&fine, &r, &r) * product(&fine, &up, &up)).sqrt();
                assert!((work - same).abs() < 1e-6 * size, "{work} and {same} of {size}");
            }
        }
    }
}
