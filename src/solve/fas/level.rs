//! One grid of the hierarchy at work: its shape, its scratch, and what a cycle does to it.

use super::force::{self, Scratch};
use super::grid::{Field, Layout};
use super::law::LaneLaw;
use super::smooth::{self, Contact, LaneDome, Pull};
use super::transfer;
use crate::implant::Dome;
use crate::solve::lift;
use glam::{DVec2, DVec3};

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
    pub(super) fn new(nodes_per_side: usize, is_mirrored: bool, is_finest: bool) -> Self {
        let mut layout = Layout::new(nodes_per_side, is_mirrored);
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
        let center = layout.center() as f64;
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
                    let rest = DVec3::new(i as f64 - center, j as f64 - center, 0.0);
                    (hold[k] <= 0.0).then(|| dome.level(rest + DVec3::new(x, y, z)))
                };
                let level = lift::lift(gap);
                greatest = greatest.max(level.abs());
                lift[at] = level as f32;
            }
        });
        greatest * dome.base_radius.max(dome.projection)
    }

    pub(super) fn invert_blocks(&mut self, law: &LaneLaw) {
        force::invert_blocks(&self.layout, law, &self.u, &mut self.inverse, &mut self.scratch);
    }

    pub(super) fn forces(&mut self, law: &LaneLaw) {
        force::forces(&self.layout, law, &self.u, &mut self.f, &mut self.scratch);
    }

    /// A damped step of the nodes by the forces found.
    pub(super) fn step(&mut self, contact: Contact, omega: f32) {
        let Self { layout, dome, u, f, tau, inverse, hold, lift, .. } = self;
        let tau = (contact == Contact::Held).then_some(&*tau);
        smooth::step(layout, dome, contact, omega, &Pull { inverse, f, tau, hold, lift }, u);
    }

    pub(super) fn find_residual(&mut self, law: &LaneLaw, contact: Contact) -> f64 {
        self.forces(law);
        let tau = (contact == Contact::Held).then_some(&self.tau);
        let Self { layout, dome, u, hold, f, lift, .. } = self;
        smooth::residual(layout, dome, contact, u, tau, (lift, hold), f)
    }

    pub(super) fn tension_squares(&mut self, law: &LaneLaw) -> f64 {
        force::tension_squares(&self.layout, law, &self.u, &mut self.scratch)
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
