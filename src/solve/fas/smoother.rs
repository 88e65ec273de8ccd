//! The smoother: damped steps with the nodal blocks under the contact conditions.
//!
//! The blocks' part of a step is here, the constraints' part in [`crate::contact::lanes`].

use crate::contact::lanes::{LaneObstacle, MAX_STEP, Touch};
use crate::mesh::lanes::{Field, Layout, load, store_first};
use crate::mesh::vec3::{Vec3, add, dot, times};
use crate::model::NodeBlocks;
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

/// Conditions at the nodes of a grid.
pub(super) struct Conditions<'a> {
    pub(super) obstacle: &'a LaneObstacle,
    pub(super) contact: Contact,
    /// Inverse nodal blocks D⁻¹.
    pub(super) inverse: &'a NodeBlocks,
    /// The FAS defect term τ of a coarse grid.
    pub(super) tau: Option<&'a Field>,
    /// Contact offset of each node \[-\]. Its magnitude is the gauge at which an active node is held; the sign,
    /// negative if contact ends before the node, is read by `write_positions` alone.
    pub(super) contact_offset: &'a [f32],
}

/// One step of length `omega`: u += ω D⁻¹ (f + τ) under the constraints; `active` marks active nodes.
pub(super) fn step(
    layout: &Layout,
    conditions: &Conditions,
    omega: f32,
    f: &Field,
    active: &[f32],
    u: &mut Field,
) {
    let Conditions { obstacle, contact, inverse, tau, contact_offset } = *conditions;
    let zero = f32x4::ZERO;
    layout.free_groups(|group| {
        let k = group.first;
        let mut r = f.load(k);
        if let Some(tau) = tau {
            r = add(r, tau.load(k));
        }
        let block = inverse.load(k);
        let d = hardened(r, times(block, r), omega);
        let touch = Touch {
            length: load(contact_offset, k).abs() + 1.0,
            active: match contact {
                Contact::OneSided => zero,
                Contact::Inherited => load(active, k).simd_gt(zero),
            },
        };
        let moved = obstacle.step(group.rest, u.load(k), d, block, touch);
        u.store(k, moved);
    });
    layout.mirror(u);
}

/// The step d = ω D⁻¹r, bounded by [`MAX_STEP`], then shortened by the hardening of the adjacent springs:
/// d ← d/√(1 + HARDENING·|d|⁴/(ω r·d)), see [`HARDENING`].
#[inline(always)]
fn hardened(r: Vec3, newton_step: Vec3, omega: f32) -> Vec3 {
    let most = f32x4::splat(MAX_STEP);
    let d = newton_step.map(|d| (d * omega).fast_max(-most).fast_min(most));
    let square = dot(d, d);
    let hardening = square * square * HARDENING / (dot(r, d) * omega).fast_max(f32x4::splat(1e-30));
    let factor = f32x4::ONE / (hardening + 1.0).sqrt();
    d.map(|d| d * factor)
}

/// Moves every node that is inside the dome or below the wall onto the surface.
pub(super) fn project_feasible(layout: &Layout, obstacle: &LaneObstacle, u: &mut Field) {
    layout.free_groups(|group| {
        let moved = obstacle.projected(group.rest, u.load(group.first), f32x4::ONE);
        store_first(u, group.first, group.count, moved);
    });
    layout.mirror(u);
}

/// Adds the correction of a coarser grid: active nodes move along the dome, no node enters the dome.
pub(super) fn apply_correction(
    layout: &Layout,
    obstacle: &LaneObstacle,
    correction: &Field,
    contact_offset: &[f32],
    active: &[f32],
    u: &mut Field,
) {
    layout.free_groups(|group| {
        let k = group.first;
        let touch = Touch {
            length: load(contact_offset, k).abs() + 1.0,
            active: load(active, k).simd_gt(f32x4::ZERO),
        };
        let moved = obstacle.corrected(group.rest, u.load(k), correction.load(k), touch);
        store_first(u, k, group.count, moved);
    });
    layout.mirror(u);
}

/// Replaces f by the residual f + τ without the reactions of dome and wall; zero at nodes that are not free.
/// One-sided contact renews the active set. Returns the sum of squares.
pub(super) fn residual(
    layout: &Layout,
    conditions: &Conditions,
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
                let is_active = LaneObstacle::active(&nodes, r, || inverse.load(k), touching);
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
    layout.mirror(f);
    layout.mirror_marks(active);
    squares
}
