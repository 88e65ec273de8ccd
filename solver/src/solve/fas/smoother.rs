//! The smoother: damped steps with the nodal blocks under the contact conditions.
//!
//! The blocks' part of a step is here, the constraints' part in [`crate::contact::lanes`].

use crate::contact::ShapeGauge;
use crate::contact::lanes::{LaneObstacle, MAX_STEP, Touch};
use crate::mesh::lanes::{Field, Group, Layout, load, store_first};
use crate::mesh::part::Part;
use crate::mesh::vec3::{Block, Vec3, add, dot, scale, sub, times};
use crate::model::columns::Stiffness;
use crate::solve::yielding::Work;
use wide::f32x4;

/// Factor of the hardening in d ← d/√(1 + HARDENING·|d|⁴/(ω r·d)) \[-\], lengths in grid spacings: a move d across the
/// sheet strains the adjacent springs by d²/2, which D, the blocks at the old position, does not contain.
const HARDENING: f32 = 4.0;

/// Rule for the active nodes of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contact {
    /// Nodes that press on the dome: the grid being solved.
    OneSided,
    /// Coarse grid below the grid being solved: also the restricted active set of the finer grid, whose nodes keep
    /// their gauge.
    Inherited,
}

/// Length of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Damping {
    pub(super) omega: f32,
    /// Is the step shortened by the hardening of the adjacent springs?
    pub(super) has_hardening: bool,
    /// See [`super::parameters::Parameters::block_growth`].
    pub(super) block_growth: f64,
}

/// Conditions at the nodes of a grid.
pub(super) struct Conditions<'a, S> {
    pub(super) obstacle: &'a LaneObstacle,
    pub(super) contact: Contact,
    /// Inverse nodal blocks D⁻¹.
    pub(super) inverse: &'a S,
    /// The FAS defect term τ of a coarse grid.
    pub(super) tau: Option<&'a Field>,
    /// Contact offset of each node \[-\]. Its magnitude is the gauge at which an active node is held; the sign,
    /// negative if contact ends before the node, is read by `write_positions` alone.
    pub(super) contact_offset: &'a [f32],
}

/// One step of length ω: u += ω D⁻¹ (f + τ) under the constraints; `active` marks active nodes.
pub(super) fn step<S: Stiffness>(
    layout: &Layout,
    conditions: &Conditions<S>,
    damping: Damping,
    f: &Field,
    active: &[f32],
    u: &mut Field,
) {
    let Conditions { obstacle, contact, inverse, tau, contact_offset } = *conditions;
    let zero = f32x4::ZERO;
    layout.free_groups(|group| {
        let k = group.first;
        let residual = |k: usize| match tau {
            Some(tau) => add(f.load(k), tau.load(k)),
            None => f.load(k),
        };
        let touch = Touch {
            length: load(contact_offset, k).abs() + 1.0,
            active: match contact {
                Contact::OneSided => zero,
                Contact::Inherited => load(active, k).simd_gt(zero),
            },
        };
        let at = u.load(k);
        let mut moved = at;
        let inner = |r: Vec3, block: Block| {
            let newton_step = times(block, r);
            if damping.has_hardening {
                let d = hardened(r, newton_step, damping.omega);
                moved = obstacle.step(group.rest, at, d, block, touch);
                return sub(moved, at);
            }
            // The reaction of the dome is a large part of r: bounds come after the constraint.
            let d = scale(newton_step, f32x4::splat(damping.omega));
            let step = sub(obstacle.step(group.rest, at, d, block, touch), at);
            let bounded = scale(step, shortening(step));
            moved = add(at, bounded);
            bounded
        };
        inverse.solve(k, damping.omega, residual, inner, |k, step| {
            let to = u.load(k);
            u.store(k, add(to, step));
        });
        u.store(k, moved);
    });
    layout.mirror(u);
}

/// The factor that shortens a step to [`MAX_STEP`].
#[inline(always)]
fn shortening(step: Vec3) -> f32x4 {
    let length = dot(step, step).sqrt().fast_max(f32x4::splat(1e-20));
    (f32x4::splat(MAX_STEP) / length).fast_min(f32x4::ONE)
}

/// The step d = ω D⁻¹r, shortened to [`MAX_STEP`], then by the hardening of the adjacent springs:
/// d ← d/√(1 + HARDENING·|d|⁴/(ω r·d)), see [`HARDENING`]. The direction stays: on the dome a large part of r is the reaction, and a
/// step in another direction would have other fixed points.
#[inline(always)]
fn hardened(r: Vec3, newton_step: Vec3, omega: f32) -> Vec3 {
    let d = scale(newton_step, f32x4::splat(omega));
    let d = scale(d, shortening(d));
    let square = dot(d, d);
    let hardening = square * square * HARDENING / (dot(r, d) * omega).fast_max(f32x4::splat(1e-30));
    let factor = f32x4::ONE / (hardening + 1.0).sqrt();
    d.map(|d| d * factor)
}

/// Moves every node that is inside the dome or below the wall onto the surface.
pub(super) fn project_feasible(layout: &Layout, obstacle: &LaneObstacle, u: &mut Field) {
    layout.free_groups(|group| {
        let at = u.load(group.first);
        let moved = obstacle.projected(group.rest, at, f32x4::ONE);
        store_first(u, group.first, group.count, moved);
        carry_column(u, &group, sub(moved, at), None);
    });
    layout.mirror(u);
}

/// Moves the columns near an implant that yields with its surface, from its shape before.
pub(super) fn follow(
    layout: &Layout,
    obstacle: &LaneObstacle,
    before: &ShapeGauge<f32x4>,
    u: &mut Field,
) {
    layout.free_groups(|group| {
        let at = u.load(group.first);
        let moved = obstacle.following(before, group.rest, at);
        store_first(u, group.first, group.count, moved);
        carry_column(u, &group, sub(moved, at), None);
    });
    layout.mirror(u);
}

/// Work of the dome's reactions to the forces by the numbers of its deformation, over the whole sheet.
pub(super) fn work<S: Stiffness>(
    layout: &Layout,
    conditions: &Conditions<S>,
    u: &Field,
    f: &Field,
) -> Work {
    let Conditions { obstacle, inverse, contact_offset, .. } = *conditions;
    let part = Part::new(layout.nodes_per_side, layout.mirrored);
    let mut work = Work::default();
    layout.free_groups(|group| {
        let k = group.first;
        let (at, force) = (u.load(k), f.load(k));
        let nodes = obstacle.nodes(group.rest, at);
        let touching = load(contact_offset, k).abs() + 1.0;
        let height = group.rest[2] + at[2];
        let compliance = inverse.inner().load(k);
        let (variation, pressing, square) =
            obstacle.work(&nodes, height, force, compliance, touching);
        let (pressing, square) = (pressing.to_array(), square.to_array());
        let variation = variation.map(f32x4::to_array);
        for lane in (0..group.count).filter(|&lane| pressing[lane] > 0.0) {
            let (i, j) = ((k + lane) % layout.pitch, (k + lane) / layout.pitch);
            let count = part.multiplicity(layout.node(i, j));
            let of_node = variation.map(|lanes| f64::from(lanes[lane]));
            let steepness = f64::from(square[lane]).sqrt();
            work.add(count * f64::from(pressing[lane]), steepness, of_node);
        }
    });
    work
}

/// Moves the nodes above the inner face with it, by `shift` and, if given, by their own corrections.
#[inline(always)]
fn carry_column(u: &mut Field, group: &Group, shift: Vec3, correction: Option<&Field>) {
    for layer in u.layers().skip(1) {
        let k = layer + group.first;
        let own = correction.map_or(shift, |correction| add(shift, correction.load(k)));
        let moved = add(u.load(k), own);
        store_first(u, k, group.count, moved);
    }
}

/// Adds the correction of a coarser grid: active nodes move along the dome, no node enters the dome. With `keeps_move` the
/// correction becomes the move.
pub(super) fn apply_correction(
    layout: &Layout,
    obstacle: &LaneObstacle,
    correction: &mut Field,
    contact_offset: &[f32],
    active: &[f32],
    u: &mut Field,
    keeps_move: bool,
) {
    layout.free_groups(|group| {
        let k = group.first;
        let touch = Touch {
            length: load(contact_offset, k).abs() + 1.0,
            active: load(active, k).simd_gt(f32x4::ZERO),
        };
        let (at, own) = (u.load(k), correction.load(k));
        let moved = obstacle.corrected(group.rest, at, own, touch);
        store_first(u, k, group.count, moved);
        let shift = sub(moved, add(at, own));
        carry_column(u, &group, shift, Some(correction));
        if keeps_move {
            carry_column(correction, &group, shift, None);
            store_first(correction, k, group.count, sub(moved, at));
        }
    });
    layout.mirror(u);
}

/// ⟨f + τ, step⟩ over the free nodes, the forces without the reactions of dome and wall.
pub(super) fn power<S: Stiffness>(
    layout: &Layout,
    conditions: &Conditions<S>,
    (u, active): (&Field, &[f32]),
    f: &Field,
    step: &Field,
) -> f64 {
    let Conditions { obstacle, tau, .. } = *conditions;
    let mut power = 0.0_f64;
    layout.free_groups(|group| {
        let k = group.first;
        let force = |k: usize| match tau {
            Some(tau) => add(f.load(k), tau.load(k)),
            None => f.load(k),
        };
        let at = u.load(k);
        let nodes = obstacle.nodes(group.rest, at);
        let is_active = load(active, k).simd_gt(f32x4::ZERO);
        let inner = obstacle.unsupported(&nodes, group.rest, at, force(k), is_active);
        let mut lanes = dot(inner, step.load(k));
        for layer in f.layers().skip(1) {
            lanes += dot(force(layer + k), step.load(layer + k));
        }
        power += lanes.to_array()[..group.count].iter().map(|&lane| f64::from(lane)).sum::<f64>();
    });
    power
}

/// Replaces f by the residual f + τ without the reactions of dome and wall; zero at nodes that are not free.
/// One-sided contact renews the active set. Returns the sum of squares.
pub(super) fn residual<S: Stiffness>(
    layout: &Layout,
    conditions: &Conditions<S>,
    u: &Field,
    active: &mut [f32],
    f: &mut Field,
) -> f64 {
    let Conditions { obstacle, contact, inverse, tau, contact_offset } = *conditions;
    let zero = f32x4::ZERO;
    let mut squares = 0.0_f64;
    let mut last = 0;
    layout.free_groups(|group| {
        let (k, count) = (group.first, group.count);
        if group.is_row_start {
            for plane in f.planes_mut() {
                plane[last..k].fill(0.0);
            }
        }
        let at = u.load(k);
        let mut r = f.load(k);
        if let Some(tau) = tau {
            r = add(r, tau.load(k));
        }
        let nodes = obstacle.nodes(group.rest, at);
        let is_active = match contact {
            Contact::OneSided => {
                let touching = load(contact_offset, k).abs() + 1.0;
                let compliance = || inverse.inner().load(k);
                let height = group.rest[2] + at[2];
                let is_active = obstacle.active(&nodes, height, r, compliance, touching);
                let marks = is_active.bitselect(f32x4::ONE, zero).to_array();
                active[k..k + count].copy_from_slice(&marks[..count]);
                is_active
            }
            Contact::Inherited => load(active, k).simd_gt(zero),
        };
        let r = obstacle.unsupported(&nodes, group.rest, at, r, is_active);
        store_first(f, k, count, r);
        let lanes = dot(r, r).to_array();
        squares += lanes[..count].iter().map(|&r| f64::from(r)).sum::<f64>();
        last = k + count;
    });
    for plane in f.planes_mut() {
        plane[last..].fill(0.0);
    }
    if let Some(tau) = tau {
        add_above(layout, tau, f);
    }
    squares += outer_squares(layout, None, f);
    layout.mirror(f);
    layout.mirror_marks(active);
    squares
}

/// The sum of squares of the residual above the inner face.
pub(super) fn outer_squares(layout: &Layout, tau: Option<&Field>, f: &Field) -> f64 {
    let mut squares = 0.0;
    for layer in f.layers().skip(1) {
        layout.free_groups(|group| {
            let k = layer + group.first;
            let own = f.load(k);
            let r = tau.map_or(own, |tau| add(own, tau.load(k)));
            let lanes = dot(r, r).to_array();
            squares += lanes[..group.count].iter().map(|&r| f64::from(r)).sum::<f64>();
        });
    }
    squares
}

/// Adds τ above the inner face.
fn add_above(layout: &Layout, tau: &Field, f: &mut Field) {
    for layer in f.layers().skip(1) {
        layout.free_groups(|group| {
            let k = layer + group.first;
            let r = add(f.load(k), tau.load(k));
            store_first(f, k, group.count, r);
        });
    }
}
