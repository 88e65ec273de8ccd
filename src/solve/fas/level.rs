//! One grid of the hierarchy at work: its shape, its scratch, and what a cycle does to it.

use super::force::{self, Scratch, Tension};
use super::grid::{Field, Layout, Mirrored};
use super::law::CoupledLanes;
use super::smooth::{self, Contact, LaneDome, Pull};
use super::springs::{self, LaneSprings};
use super::transfer;
use crate::implant::Dome;
use crate::solve::law::SheetLaw;
use crate::solve::lift;
use glam::{DVec2, DVec3};

/// A step of no more than so many roundings of the greatest displacement is one of rounding.
const ROUNDINGS: f32 = 16.0;

/// What carries the sheet, in lanes; its stiffness at small strain is 1.
#[derive(Clone, Debug)]
pub(super) enum LaneLaw {
    Coupled(CoupledLanes),
    Paper(LaneSprings),
}

impl LaneLaw {
    pub(super) fn new(law: &SheetLaw) -> Self {
        let stiffness = law.stiffness();
        match law {
            SheetLaw::Coupled(law) => Self::Coupled(CoupledLanes::new(law, stiffness)),
            SheetLaw::Paper(law) => Self::Paper(LaneSprings::new(law, stiffness)),
        }
    }

    /// Does contact end between nodes? The paper's does not.
    pub(super) fn has_lifts(&self) -> bool {
        matches!(self, Self::Coupled(_))
    }
}

/// A grid with its shape and scratch.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub(super) layout: Layout,
    pub(super) dome: LaneDome,
    /// The same in f64.
    pub(super) exact_dome: Dome,
    pub(super) u: Field,
    /// Forces, then residuals, then corrections.
    pub(super) f: Field,
    /// The shape before the correction: at the start of a cycle, or as injected.
    pub(super) before: Field,
    /// Right-hand side of a coarse grid.
    pub(super) tau: Field,
    pub(super) inverse: [Vec<f32>; 6],
    pub(super) hold: Vec<f32>,
    /// Level of the dome at which a held node touches; negative where it is off the dome indeed.
    pub(super) lift: Vec<f32>,
    scratch: Scratch,
}

impl Level {
    pub(super) fn new(nodes_per_side: usize, mirrored: Mirrored, is_finest: bool) -> Self {
        let mut layout = Layout::new(nodes_per_side, mirrored);
        if !is_finest {
            layout.find_extrapolation();
        }
        let length = layout.len();
        let zeros = || vec![0.0; length];
        Self {
            dome: LaneDome::default(),
            exact_dome: Dome::new(DVec2::ZERO, 1.0, 1.0, 1.0),
            u: Field::new(length),
            f: Field::new(length),
            before: Field::new(length),
            tau: Field::new(if is_finest { 0 } else { length }),
            inverse: [zeros(), zeros(), zeros(), zeros(), zeros(), zeros()],
            hold: zeros(),
            lift: zeros(),
            scratch: Scratch::new(&layout),
            layout,
        }
    }
}

impl Level {
    /// Finds where contact ends between nodes; gives the greatest lift \[grid spacings\].
    pub(super) fn find_lifts(&mut self) -> f64 {
        let Self { layout, exact_dome: dome, u, hold, lift, .. } = self;
        let layout = &*layout;
        let mut greatest = 0.0_f64;
        lift.fill(0.0);
        layout.free_rows(|j, from, to| {
            for i in from..to {
                let at = j * layout.pitch + i;
                if hold[at] <= 0.0 {
                    continue;
                }
                let gap = |di: isize, dj: isize| {
                    let (i, j) = layout.place(i as isize + di, j as isize + dj)?;
                    let k = j * layout.pitch + i;
                    let [x, y, z] = u.at(k).map(f64::from);
                    let [rest_x, rest_y] = layout.rest(i, j).map(f64::from);
                    (hold[k] <= 0.0).then(|| dome.level(DVec3::new(rest_x + x, rest_y + y, z)))
                };
                let level = lift::lift(gap);
                greatest = greatest.max(level.abs());
                lift[at] = level as f32;
            }
        });
        greatest * dome.base_radius.max(dome.projection)
    }

    pub(super) fn invert_blocks(&mut self, law: &LaneLaw) {
        let Self { layout, u, inverse, scratch, .. } = self;
        match law {
            LaneLaw::Coupled(law) => force::add_blocks(layout, law, u, inverse, scratch),
            LaneLaw::Paper(law) => springs::add_blocks(layout, law, u, inverse, scratch),
        }
        force::invert_blocks(layout, inverse);
    }

    pub(super) fn forces(&mut self, law: &LaneLaw) {
        let Self { layout, u, f, scratch, .. } = self;
        match law {
            LaneLaw::Coupled(law) => force::forces(layout, law, u, f, scratch),
            LaneLaw::Paper(law) => springs::forces(layout, law, u, f, scratch),
        }
    }

    /// A damped step of the nodes by the forces found.
    pub(super) fn step(&mut self, contact: Contact, omega: f32) {
        let Self { layout, dome, u, f, tau, inverse, hold, lift, .. } = self;
        let tau = (contact == Contact::Held).then_some(&*tau);
        smooth::step(layout, dome, contact, omega, (&Pull { inverse, tau, lift }, f, hold), u);
    }

    pub(super) fn find_residual(&mut self, law: &LaneLaw, contact: Contact) -> f64 {
        self.forces(law);
        let tau = (contact == Contact::Held).then_some(&self.tau);
        let Self { layout, dome, u, hold, f, lift, inverse, .. } = self;
        smooth::residual(layout, dome, contact, u, &Pull { inverse, tau, lift }, hold, f)
    }

    /// Is the residual found what f32 rounds? On a flat dome strains are small differences of places.
    pub(super) fn is_rounded(&self) -> bool {
        let Self { layout, u, f, inverse, .. } = self;
        let farthest = smooth::greatest_length(layout, |k| u.at(k)).max(1.0);
        let step = smooth::greatest_length(layout, |k| {
            let [xx, xy, xz, yy, yz, zz] = [0, 1, 2, 3, 4, 5].map(|p| inverse[p][k]);
            let [x, y, z] = f.at(k);
            [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
        });
        step <= ROUNDINGS * f32::EPSILON * farthest
    }

    pub(super) fn tension(&mut self, law: &LaneLaw) -> Tension {
        let Self { layout, u, scratch, .. } = self;
        match law {
            LaneLaw::Coupled(law) => force::tension(layout, law, u, scratch),
            LaneLaw::Paper(law) => springs::tension(layout, law, u),
        }
    }

    /// Takes shape, held nodes and residual of the finer grid; what is to be solved here is
    /// f(u) + τ = 0 with τ such that f + τ is the restricted residual at the shape taken.
    pub(super) fn take_over(&mut self, law: &LaneLaw, fine: &Self, hold_share: f32) {
        let Self { layout, u, hold, tau, .. } = self;
        transfer::inject(layout, &fine.layout, &fine.u, u);
        transfer::inject_hold(layout, &fine.layout, &fine.hold, hold_share, hold);
        smooth::mirror(layout, u);
        transfer::restrict(layout, &fine.layout, &fine.f, tau);
        self.before.copy_from(&self.u);
        self.forces(law);
        let Self { layout, tau, f, .. } = self;
        layout.free_rows(|j, from, to| {
            for k in j * layout.pitch + from..j * layout.pitch + to {
                tau.x[k] -= f.x[k];
                tau.y[k] -= f.y[k];
                tau.z[k] -= f.z[k];
            }
        });
    }

    pub(super) fn add_correction(&mut self, coarse: &Self, row: &mut [f32]) {
        let Self { layout, dome, u, hold, f, lift, .. } = self;
        transfer::correction(&coarse.layout, layout, &coarse.u, &coarse.before, f, row);
        smooth::correct(layout, dome, f, (lift, hold), u);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{Curve, CurveSpec};
    use crate::sheet::Sheet;
    use crate::solve::assemble;
    use crate::springs::{Material, Springs};

    /// Forces and blocks in lanes of f32 are those of the assembly in f64.
    #[test]
    fn lanes_pull_as_the_assembly_does() {
        let material = |spec: &CurveSpec, poisson_ratio| Material {
            curve: Curve::new(spec).unwrap(),
            poisson_ratio,
            thickness_mm: 2.0,
        };
        let skin = || material(&CurveSpec::Skin {}, 0.3);
        let stacks = [vec![skin()], vec![skin(), material(&CurveSpec::Adipose {}, 0.45)]];
        for (springs, materials) in [Springs::Coupled, Springs::Nikolaev]
            .into_iter()
            .flat_map(|s| stacks.clone().map(|m| (s, m)))
        {
            for mirrored in [[false; 2], [true, false], [false, true], [true; 2]] {
                let n = 33;
                let law = SheetLaw::new(springs, &materials);
                let sheet = Sheet::new(n, (n / 2) as f64);
                let mut level = Level::new(n, mirrored, true);
                let first = level.layout.first();
                // A bulge with ripples, symmetric about both axes.
                let bulge = |p: DVec2| {
                    let r = p.length() / 16.0;
                    let z = 6.0 * (1.0 - r * r) + 0.2 * (0.9 * p.x).cos() * (0.7 * p.y).cos();
                    DVec3::new(0.02 * p.x * (p.y * 0.5).cos(), -0.03 * p.y * (1.0 - r), z)
                };
                let Level { layout, u, .. } = &mut level;
                let mut x: Vec<DVec3> = sheet.rest().iter().map(|p| p.extend(0.0)).collect();
                layout.free_rows(|j, from, to| {
                    for i in from..to {
                        let k = (j + first[1]) * n + i + first[0];
                        let d = bulge(sheet.rest()[k]);
                        let at = j * layout.pitch + i;
                        (u.x[at], u.y[at], u.z[at]) = (d.x as f32, d.y as f32, d.z as f32);
                    }
                });
                smooth::mirror(layout, u);
                for (k, p) in sheet.rest().iter().enumerate() {
                    if sheet.kinds()[k] == crate::sheet::NodeKind::Free {
                        x[k] = p.extend(0.0) + bulge(*p);
                    }
                }
                let mut exact = vec![DVec3::ZERO; sheet.len()];
                assemble::forces(&sheet, &law, &x, &mut exact);
                let greatest = exact.iter().map(|f| f.length()).fold(0.0, f64::max);
                level.forces(&LaneLaw::new(&law));
                let Level { layout, f, .. } = &level;
                layout.free_rows(|j, from, to| {
                    for i in from..to {
                        let [x, y, z] = f.at(j * layout.pitch + i).map(f64::from);
                        let force = DVec3::new(x, y, z) * law.stiffness();
                        let error = force.distance(exact[(j + first[1]) * n + i + first[0]]);
                        assert!(error < 1e-4 * greatest, "{springs:?} ({i}, {j}): {error:.1e}");
                    }
                });
            }
        }
    }
}
