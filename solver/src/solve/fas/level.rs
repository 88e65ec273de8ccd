//! One grid of the hierarchy: state, right-hand side, and the operations of a cycle on the grid.

use super::smoother::{self, Conditions, Contact, Damping};
use super::transfer;
use crate::contact::contact_edge;
use crate::contact::lanes::LaneObstacle;
use crate::contact::{Dome, HalfBall, Modes, Obstacle};
use crate::mesh::Rest;
use crate::mesh::lanes::{Field, Layout, Mirrored};
use crate::model::columns::Stiffness;
use crate::model::{ElasticModel, Tension};
use crate::solve::yielding::Work;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Distance of the factor of a correction from one up to which the correction stays as it is \[-\].
const NEGLECTED_SCALING: f32 = 0.1;

/// A cycle of a grid.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    /// The change of the displacements.
    pub(super) change: Field,
    /// The displacements after the cycle, before mixing.
    pub(super) result: Field,
}

/// A grid with its state and scratch.
#[derive(Clone, Debug)]
pub(super) struct Level<M: ElasticModel> {
    pub(super) layout: Layout,
    pub(super) obstacle: LaneObstacle,
    /// [`Self::obstacle`] in f64.
    pub(super) exact_obstacle: Obstacle,
    /// Displacements \[spacings\].
    pub(super) u: Field,
    /// Forces, residuals or corrections.
    pub(super) f: Field,
    /// Does `f` contain the forces at `u`?
    are_forces_current: bool,
    /// The correction of the coarser grid that is scaled; empty in a sheet.
    correction: Field,
    /// Displacements at the start of a cycle, or restricted from the finer grid.
    pub(super) before: Field,
    /// The last cycles of this grid whose results are mixed, the last one first.
    pub(super) last_cycles: Vec<Cycle>,
    /// The FAS defect term of f(u) + τ = 0; unused while this grid is the one being solved, `None` on the finest grid.
    pub(super) tau: Option<Field>,
    pub(super) inverse: M::Stiffness,
    /// 1 at active nodes, else 0.
    pub(super) active: Vec<f32>,
    /// Contact offset of each node \[-\]. Its magnitude is the gauge at which an active node is held; the sign,
    /// negative if contact ends before the node, is read by `write_positions` alone.
    pub(super) contact_offset: Vec<f32>,
    scratch: M::Scratch,
    /// The tissue at rest on this grid, over a curved wall.
    pub(super) rest: Option<Arc<Rest>>,
    /// The least sum of squares of the residual above the inner face since the last blocks.
    least_squares: f64,
}

impl<M: ElasticModel> Level<M> {
    pub(super) fn new(
        nodes_per_side: usize,
        mirrored: Mirrored,
        is_finest: bool,
        kept_cycles: usize,
        model: &M,
    ) -> Self {
        let mut layout = Layout::new(nodes_per_side, mirrored);
        if !is_finest {
            layout.find_extrapolation();
        }
        let length = layout.len();
        let layers = model.layers();
        let field = || Field::new(length, layers);
        let cycle = |_| Cycle { change: field(), result: field() };
        let nowhere =
            Obstacle::on_flat_wall(Dome::new(DVec2::ZERO, HalfBall::round(1.0, 1.0), 1.0));
        Self {
            obstacle: LaneObstacle::new(&nowhere),
            exact_obstacle: nowhere,
            u: field(),
            f: field(),
            are_forces_current: false,
            correction: if layers > 1 { field() } else { Field::default() },
            before: field(),
            last_cycles: (0..kept_cycles).map(cycle).collect(),
            tau: (!is_finest).then(field),
            inverse: M::Stiffness::new(length, layers),
            active: vec![0.0; length],
            contact_offset: vec![0.0; length],
            scratch: model.scratch(&layout),
            layout,
            rest: None,
            least_squares: f64::INFINITY,
        }
    }

    /// Fits grid and model to the grid's spacing \[mm\] and to the tissue at rest on the finest grid.
    pub(super) fn fit(&mut self, model: &M, spacing: f64, rest: &Rest) {
        let is_fitted = match &self.rest {
            Some(own) => own.is_alike(rest),
            None => rest.is_even(),
        };
        if !is_fitted {
            let n = self.layout.nodes_per_side;
            self.rest = (!rest.is_even()).then(|| Arc::new(rest.restricted(n)));
            self.layout.set_rest(self.rest.as_deref());
        }
        model.place(&self.layout, spacing, self.rest.as_ref(), &mut self.scratch);
    }

    /// Discards what the model has renewed.
    pub(super) fn forget(&mut self, model: &M) {
        model.forget(&mut self.scratch);
    }

    /// Fits the model to its growth, at the present displacements.
    pub(super) fn grow(&mut self, model: &M) {
        self.are_forces_current = false;
        model.grow(&self.layout, self.rest.as_ref(), &mut self.scratch);
        self.invert_blocks(model);
    }

    /// Places the obstacle, given in spacings of this grid.
    pub(super) fn place(&mut self, obstacle: Obstacle) {
        self.are_forces_current = false;
        self.obstacle = LaneObstacle::new(&obstacle);
        self.exact_obstacle = obstacle;
    }

    /// Replaces the numbers of the deformation of an implant that yields.
    pub(super) fn reshape(&mut self, modes: Modes<f64>) {
        self.are_forces_current = false;
        self.exact_obstacle.dome.set_modes(modes);
        self.obstacle.reshape(&self.exact_obstacle.dome.shape);
    }

    /// Replaces the numbers of the deformation; the tissue near the implant follows its surface. The forces stay those before.
    pub(super) fn reshape_with_tissue(&mut self, modes: Modes<f64>) {
        self.exact_obstacle.dome.set_modes(modes);
        let before = self.obstacle.reshape(&self.exact_obstacle.dome.shape);
        smoother::follow(&self.layout, &self.obstacle, &before, &mut self.u);
        smoother::project_feasible(&self.layout, &self.obstacle, &mut self.u);
    }

    /// Work of the reactions by the numbers of the implant's deformation, of the forces at `u` \[this grid's units\].
    pub(super) fn work(&mut self, model: &M) -> Work {
        if !self.are_forces_current {
            self.find_forces(model);
            self.are_forces_current = true;
        }
        let Self { layout, obstacle, u, f, tau, contact_offset, inverse, .. } = self;
        let conditions =
            Self::conditions(obstacle, Contact::OneSided, inverse, tau, contact_offset);
        smoother::work(layout, &conditions, u, f)
    }

    /// Computes the contact offsets; returns the greatest contact offset \[grid spacings\].
    pub(super) fn find_contact_offsets(&mut self) -> f64 {
        let Self { layout, exact_obstacle, u, active, contact_offset, .. } = self;
        let (layout, dome) = (&*layout, &exact_obstacle.dome);
        let mut greatest = 0.0_f64;
        contact_offset.fill(0.0);
        layout.free_rows(|j, from, to| {
            for i in from..to {
                let at = j * layout.pitch + i;
                // A node amid active nodes, away from ghosts, has no gap around it.
                let is_amid = || {
                    let rows = [at - layout.pitch, at, at + layout.pitch];
                    rows.iter().all(|k| active[k - 1..=k + 1].iter().all(|mark| *mark > 0.0))
                };
                if active[at] <= 0.0 || i > 1 && j > 1 && is_amid() {
                    continue;
                }
                let gap = |di: isize, dj: isize| {
                    let (i, j) = layout.free_node(i as isize + di, j as isize + dj)?;
                    let k = j * layout.pitch + i;
                    let [x, y, z] = u.at(k).map(f64::from);
                    let [rest_x, rest_y] = layout.rest(i, j).map(f64::from);
                    (active[k] <= 0.0).then(|| dome.gauge(DVec3::new(rest_x + x, rest_y + y, z)))
                };
                let offset = contact_edge::offset(gap);
                greatest = greatest.max(offset.abs());
                contact_offset[at] = offset as f32;
            }
        });
        greatest * dome.shape.greatest_length()
    }

    pub(super) fn invert_blocks(&mut self, model: &M) {
        let Self { layout, u, inverse, scratch, .. } = self;
        model.blocks(layout, u, inverse, scratch);
        inverse.invert(layout);
        self.least_squares = f64::INFINITY;
    }

    /// Renews the model's constraints after a cycle.
    pub(super) fn renew(&mut self, model: &M) {
        self.are_forces_current = false;
        model.renew(&self.layout, &self.u, &mut self.scratch);
    }

    /// Mixes the model's constraints: see [`ElasticModel::mix`].
    pub(super) fn mix_constraints(&mut self, model: &M, thetas: [f32; 2]) {
        model.mix(&mut self.scratch, thetas);
    }

    /// Interpolates the model's constraints from a coarser grid.
    pub(super) fn take_over(&mut self, model: &M, coarse: &Self) {
        model.hand_on((&coarse.layout, &coarse.scratch), &self.layout, &mut self.scratch);
    }

    pub(super) fn find_forces(&mut self, model: &M) {
        let Self { layout, u, f, scratch, .. } = self;
        model.forces(layout, u, f, scratch);
    }

    pub(super) fn conditions<'a>(
        obstacle: &'a LaneObstacle,
        contact: Contact,
        inverse: &'a M::Stiffness,
        tau: &'a Option<Field>,
        contact_offset: &'a [f32],
    ) -> Conditions<'a, M::Stiffness> {
        let tau = tau.as_ref().filter(|_| contact == Contact::Inherited);
        Conditions { obstacle, contact, inverse, tau, contact_offset }
    }

    /// One damped step; returns the number of force evaluations.
    pub(super) fn smooth(&mut self, model: &M, contact: Contact, step: Damping) -> f64 {
        let is_known = std::mem::take(&mut self.are_forces_current);
        if !is_known {
            self.find_forces(model);
        }
        let has_stiffened = self.has_stiffened(contact, step.block_growth);
        if has_stiffened {
            self.invert_blocks(model);
        }
        let Self { layout, obstacle, u, f, tau, inverse, active, contact_offset, .. } = self;
        let conditions = Self::conditions(obstacle, contact, inverse, tau, contact_offset);
        smoother::step(layout, &conditions, step, f, active, u);
        f64::from(u8::from(!is_known) + u8::from(has_stiffened))
    }

    /// Has the residual above the inner face, where no reaction acts, grown by a factor since the last blocks?
    fn has_stiffened(&mut self, contact: Contact, growth: f64) -> bool {
        let tau = self.tau.as_ref().filter(|_| contact == Contact::Inherited);
        let squares = smoother::outer_squares(&self.layout, tau, &self.f);
        let has_grown = squares > growth * growth * self.least_squares;
        self.least_squares = self.least_squares.min(squares);
        has_grown
    }

    /// Sets `f` to the residual without contact forces; returns the sum of squares.
    pub(super) fn find_residual(&mut self, model: &M, contact: Contact) -> f64 {
        if !std::mem::take(&mut self.are_forces_current) {
            self.find_forces(model);
        }
        let Self { layout, obstacle, u, active, f, tau, contact_offset, inverse, .. } = self;
        let conditions = Self::conditions(obstacle, contact, inverse, tau, contact_offset);
        smoother::residual(layout, &conditions, u, active, f)
    }

    /// Is the step of the residual at the rounding level of f32? On a flat dome strains are small differences
    /// of positions.
    pub(super) fn is_rounded(&self, roundings: f32) -> bool {
        let Self { layout, u, .. } = self;
        let farthest = layout.greatest_length(|k| u.at(k)).max(1.0);
        self.greatest_step() <= roundings * f32::EPSILON * farthest
    }

    /// The greatest length of D⁻¹r on the inner face \[spacings\], `f` being the residual r.
    pub(super) fn greatest_step(&self) -> f32 {
        let Self { layout, f, inverse, .. } = self;
        layout.greatest_length(|k| inverse.inner().times(k, f.at(k)))
    }

    pub(super) fn tension(&mut self, model: &M) -> Tension {
        let Self { layout, u, scratch, .. } = self;
        model.tension(layout, u, scratch)
    }

    /// Sets up the coarse problem f(u) + τ = 0 from the state and the residual of the finer grid: τ is the
    /// restricted residual minus the forces at the restricted state. A coarse node is active if the weighted fraction of
    /// active fine nodes exceeds `active_weight`.
    pub(super) fn restrict_from(&mut self, model: &M, fine: &Self, active_weight: f32) {
        let Self { layout, u, before, active, .. } = self;
        transfer::inject(layout, &fine.layout, &fine.u, u);
        transfer::restrict_active_set(layout, &fine.layout, &fine.active, active_weight, active);
        layout.mirror(u);
        before.copy_from(u);
        self.find_forces(model);
        self.are_forces_current = true;
        let Self { layout, tau, f, .. } = self;
        let Some(tau) = tau else { return };
        transfer::restrict(layout, &fine.layout, &fine.f, tau);
        for (tau, f) in tau.planes_mut().zip(f.planes()) {
            layout.free_rows(|j, from, to| {
                for k in j * layout.pitch + from..j * layout.pitch + to {
                    tau[k] -= f[k];
                }
            });
        }
    }

    /// [`Self::correct`] with the correction c scaled by α = ⟨r, c⟩/⟨r − r′, c⟩, at least `least` and at most 1, where the parabola of the energy along c
    /// is least; r and r′ are the residuals before and after c. Coarse grids may be too soft where skin is slack on them alone. `f` is
    /// r; one force evaluation.
    pub(super) fn correct_scaled(
        &mut self,
        model: &M,
        contact: Contact,
        coarse: &Self,
        least: f32,
        row: &mut [f32],
    ) {
        let Self { layout, obstacle, u, active, f, correction, contact_offset, .. } = self;
        transfer::correction(&coarse.layout, layout, &coarse.u, &coarse.before, correction, row);
        smoother::apply_correction(layout, obstacle, correction, contact_offset, active, u, true);
        let before = layout.product(f, correction);
        self.find_forces(model);
        let Self {
            layout, obstacle, u, active, f, tau, correction, contact_offset, inverse, ..
        } = self;
        let conditions = Self::conditions(obstacle, contact, inverse, tau, contact_offset);
        let after = smoother::power(layout, &conditions, (u, active), f, correction);
        let scale = ((before / (before - after)) as f32).clamp(least, 1.0);
        let is_scaled = scale.is_finite() && (scale - 1.0).abs() > NEGLECTED_SCALING;
        self.are_forces_current = !is_scaled;
        if is_scaled {
            u.add_scaled(correction, scale - 1.0);
            self.project_feasible();
        }
    }

    /// Adds the interpolated correction of the coarser grid. `row` is scratch.
    pub(super) fn correct(&mut self, coarse: &Self, row: &mut [f32]) {
        let Self { layout, obstacle, u, active, f, contact_offset, .. } = self;
        transfer::correction(&coarse.layout, layout, &coarse.u, &coarse.before, f, row);
        smoother::apply_correction(layout, obstacle, f, contact_offset, active, u, false);
        self.are_forces_current = false;
    }

    /// Starts from the prolongated state of the coarser grid. `row` and a field of the coarser grid are scratch.
    pub(super) fn start_from(&mut self, coarse: &mut Self, row: &mut [f32]) {
        let Level { layout, u, f, correction, are_forces_current, .. } = coarse;
        // A shape to display may be asked for within a cycle, whose scaled correction still needs the residual.
        let scratch = if correction.x.is_empty() { f } else { &mut *correction };
        transfer::prolongate_solution(layout, &self.layout, u, scratch, &mut self.u, row);
        // Corrections are zero at nodes that are not free.
        correction.fill_zero();
        *are_forces_current = false;
        self.project_feasible();
    }

    /// Moves nodes out of the dome and above the wall.
    pub(super) fn project_feasible(&mut self) {
        smoother::project_feasible(&self.layout, &self.obstacle, &mut self.u);
        self.are_forces_current = false;
    }
}

#[cfg(test)]
mod tests;
