//! The smoother: damped steps with the nodal blocks, each node kept out of the dome and above the
//! wall.
//!
//! A step that would lead into the dome is solved with the constraint inside it, H d = f + μn with
//! n·d = −gap, and put back onto the surface: its fixed points are those of the contact problem.

use super::force::{Vec3, add, dot};
use super::grid::{Field, Layout, load};
use crate::implant::Dome;
use wide::f32x4;

/// The greatest move of a node in one step \[grid spacings, along each axis\].
const MOST_STEP: f32 = 0.5;
/// A node that moves by d across a sheet stretches the springs around it by d²/2: they resist with
/// about this much times d³, which the blocks, taken before the move, do not know of.
const HARDENING: f32 = 4.0;
/// A node whose level is below this touches the dome \[-\].
const TOUCH: f32 = 3e-6;

/// The dome in spacings of a grid, about the grid's centre.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LaneDome {
    center: [f32; 2],
    base_height: f32,
    per_radius: f32,
    per_projection: f32,
}

/// Which nodes are held on the dome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contact {
    /// Those that would go into it.
    OneSided,
    /// On a coarse grid that corrects for a finer one: also those that the finer one holds, which stay
    /// as near to the dome as they are.
    Held,
}

impl LaneDome {
    /// Of a dome in grid spacings.
    pub(super) fn new(dome: &Dome) -> Self {
        Self {
            center: [dome.center.x as f32, dome.center.y as f32],
            base_height: dome.base_height as f32,
            per_radius: (1.0 / dome.base_radius) as f32,
            per_projection: (1.0 / dome.projection) as f32,
        }
    }

    /// Might a node touch? Without roots and divisions.
    #[inline(always)]
    pub(super) fn is_near(&self, rest: [f32; 2], u: [f32; 3]) -> bool {
        let x = (rest[0] + u[0] - self.center[0]) * self.per_radius;
        let y = (rest[1] + u[1] - self.center[1]) * self.per_radius;
        let z = (u[2] - self.base_height) * self.per_projection;
        x * x + y * y + z * z < 1.0 + 1e-3
    }

    /// The place relative to the ellipsoid's centre in units of its axes.
    #[inline(always)]
    fn scaled(&self, p: Vec3) -> Vec3 {
        [p[0] * self.per_radius, p[1] * self.per_radius, p[2] * self.per_projection]
    }

    /// What moves a place relative to the ellipsoid's centre to the given level plus one, along a
    /// gradient of the level nearby; as far as it leads there, and no farther than a step.
    #[inline(always)]
    fn back(&self, place: Vec3, gradient: Vec3, level: f32x4) -> Vec3 {
        let (s, g) = (self.scaled(place), self.scaled(gradient));
        let (a, b, c) = (dot(g, g), dot(s, g), dot(s, s) - level * level);
        let root = (b * b - a * c).fast_max(f32x4::ZERO).sqrt();
        let share = -c / (b + root).fast_max(f32x4::splat(1e-20));
        let most = f32x4::splat(MOST_STEP);
        gradient.map(|g| (g * share).fast_max(-most).fast_min(most))
    }

    /// What moves a place inside onto the surface: along the ray from the centre or upright, whichever is
    /// the shorter way. On a flat dome the ray leads far aside.
    #[inline(always)]
    fn out(&self, p: Vec3, length: f32x4) -> Vec3 {
        let zero = f32x4::ZERO;
        let ray = ((f32x4::ONE - length) / length.fast_max(f32x4::splat(1e-6))).fast_max(zero);
        let s = self.scaled(p);
        let height = (f32x4::ONE - s[0] * s[0] - s[1] * s[1]).fast_max(zero).sqrt();
        let upright = ((height - s[2]) / self.per_projection).fast_max(zero);
        let is_upright = (upright * upright).simd_lt(ray * ray * dot(p, p));
        let [x, y, z] = p.map(|p| p * ray);
        [
            is_upright.bitselect(zero, x),
            is_upright.bitselect(zero, y),
            is_upright.bitselect(upright, z),
        ]
    }

    /// The place relative to the ellipsoid's centre, the level plus one, and the level's gradient.
    #[inline(always)]
    fn level(&self, x: f32x4, y: f32x4, u: Vec3) -> (Vec3, f32x4, Vec3) {
        let p = [x + u[0] - self.center[0], y + u[1] - self.center[1], u[2] - self.base_height];
        let s = self.scaled(p);
        let length = dot(s, s).sqrt();
        let per = f32x4::ONE / length.fast_max(f32x4::splat(1e-6));
        let g = [
            s[0] * per * self.per_radius,
            s[1] * per * self.per_radius,
            s[2] * per * self.per_projection,
        ];
        (p, length, g)
    }
}

/// Rest places of four neighbouring nodes, about the grid's centre.
#[inline(always)]
fn rest(layout: &Layout, i: usize, j: usize) -> (f32x4, f32x4) {
    let [x, y] = layout.rest(i, j);
    (f32x4::new([0.0, 1.0, 2.0, 3.0]) + x, f32x4::splat(y))
}

/// Symmetric blocks of four neighbouring nodes.
#[inline(always)]
fn load_blocks(blocks: &[Vec<f32>; 6], k: usize) -> [f32x4; 6] {
    [0, 1, 2, 3, 4, 5].map(|p| load(&blocks[p], k))
}

#[inline(always)]
fn times([xx, xy, xz, yy, yz, zz]: [f32x4; 6], v: Vec3) -> Vec3 {
    [
        xx * v[0] + xy * v[1] + xz * v[2],
        xy * v[0] + yy * v[1] + yz * v[2],
        xz * v[0] + yz * v[1] + zz * v[2],
    ]
}

/// What nodes obey besides the springs.
pub(super) struct Pull<'a> {
    /// Inverse nodal blocks D⁻¹.
    pub(super) inverse: &'a [Vec<f32>; 6],
    /// A coarse grid's right-hand side.
    pub(super) tau: Option<&'a Field>,
    /// Level at which each node touches.
    pub(super) lift: &'a [f32],
}

/// One step of length `omega`: u += ω D⁻¹ (f + τ), under the constraints; `hold` marks nodes that are held.
pub(super) fn step(
    layout: &Layout,
    dome: &LaneDome,
    contact: Contact,
    omega: f32,
    (pull, f, hold): (&Pull, &Field, &[f32]),
    u: &mut Field,
) {
    let Pull { inverse, tau, lift } = *pull;
    let zero = f32x4::ZERO;
    layout.free_rows(|j, from, to| {
        let mut i = from;
        while i < to {
            let k = j * layout.pitch + i;
            let mut r = f.load(k);
            if let Some(tau) = tau {
                r = add(r, tau.load(k));
            }
            let blocks = load_blocks(inverse, k);
            let most = f32x4::splat(MOST_STEP);
            let mut d = times(blocks, r).map(|d| (d * omega).fast_max(-most).fast_min(most));
            let square = dot(d, d);
            let hardening =
                square * square * HARDENING / (dot(r, d) * omega).fast_max(f32x4::splat(1e-30));
            let share = f32x4::ONE / (hardening + 1.0).sqrt();
            d = d.map(|d| d * share);
            let at = u.load(k);
            let (x, y) = rest(layout, i, j);
            let (p, length, g) = dome.level(x, y, at);
            let towards = dot(g, d);
            let mut level = load(lift, k).abs() + 1.0;
            let mut is_held = f32x4::ZERO;
            if contact == Contact::Held {
                is_held = load(hold, k).simd_gt(zero);
                level = is_held.bitselect(length, level);
            }
            let over = length - level + towards;
            is_held |= over.simd_lt(zero);
            let is_movable = blocks[0].simd_gt(zero);
            is_held &= is_movable;
            let mut to_u = add(at, d);
            if is_held.any() {
                let s = times(blocks, g);
                let share = over / dot(g, s).fast_max(f32x4::splat(1e-30));
                d = [0, 1, 2].map(|a| d[a] - s[a] * share);
                let place = add(p, d);
                let back = dome.back(place, g, level);
                to_u = [0, 1, 2].map(|a| is_held.bitselect(at[a] + d[a] + back[a], to_u[a]));
            }
            to_u[2] = is_movable.bitselect(to_u[2].fast_max(zero), at[2]);
            u.store(k, to_u);
            i += 4;
        }
    });
    mirror(layout, u);
}

/// Moves every node that is inside the dome or below the wall onto it.
pub(super) fn settle(layout: &Layout, dome: &LaneDome, u: &mut Field) {
    layout.free_rows(|j, from, to| {
        let mut i = from;
        while i < to {
            let k = j * layout.pitch + i;
            let mut at = u.load(k);
            at[2] = at[2].fast_max(f32x4::ZERO);
            let (x, y) = rest(layout, i, j);
            let (p, length, _) = dome.level(x, y, at);
            let moved = add(at, dome.out(p, length));
            store_free(u, k, (to - i).min(4), moved);
            i += 4;
        }
    });
    mirror(layout, u);
}

/// Adds a finer grid's correction: nodes that are held move along the dome, none goes into it.
pub(super) fn correct(
    layout: &Layout,
    dome: &LaneDome,
    correction: &Field,
    (lift, hold): (&[f32], &[f32]),
    u: &mut Field,
) {
    layout.free_rows(|j, from, to| {
        let mut i = from;
        while i < to {
            let k = j * layout.pitch + i;
            let at = u.load(k);
            let (x, y) = rest(layout, i, j);
            let (p, before, g) = dome.level(x, y, at);
            let mut c = correction.load(k);
            let is_held = load(hold, k).simd_gt(f32x4::ZERO);
            let normal_part = dot(c, g) / dot(g, g);
            c = [0, 1, 2].map(|a| is_held.bitselect(c[a] - g[a] * normal_part, c[a]));
            let place = add(p, c);
            let level = is_held.bitselect(before, load(lift, k).abs() + 1.0);
            let back = dome.back(place, g, level);
            let is_put_back = is_held | dot(back, g).simd_gt(f32x4::ZERO);
            let mut moved =
                [0, 1, 2].map(|a| at[a] + c[a] + is_put_back.bitselect(back[a], f32x4::ZERO));
            moved[2] = moved[2].fast_max(f32x4::ZERO);
            store_free(u, k, (to - i).min(4), moved);
            i += 4;
        }
    });
    mirror(layout, u);
}

/// Adds τ to the forces, takes away what the dome and the wall carry, marks the nodes that the dome holds
/// (only where contact is one-sided), clears what is not free. Gives the sum of squares of what is
/// left.
pub(super) fn residual(
    layout: &Layout,
    dome: &LaneDome,
    contact: Contact,
    u: &Field,
    pull: &Pull,
    hold: &mut [f32],
    f: &mut Field,
) -> f64 {
    let Pull { inverse, tau, lift } = *pull;
    let zero = f32x4::ZERO;
    let mut squares = 0.0_f64;
    let mut last = 0;
    layout.free_rows(|j, from, to| {
        let row = j * layout.pitch;
        for part in [&mut f.x, &mut f.y, &mut f.z] {
            part[last..row + from].fill(0.0);
        }
        let mut i = from;
        while i < to {
            let k = row + i;
            let at = u.load(k);
            let (x, y) = rest(layout, i, j);
            let (_, length, g) = dome.level(x, y, at);
            let mut r = f.load(k);
            if let Some(tau) = tau {
                r = add(r, tau.load(k));
            }
            let across = dot(r, g);
            let is_held = match contact {
                Contact::OneSided => {
                    let level = load(lift, k).abs() + 1.0;
                    let mut is_held = length.simd_lt(level + TOUCH) & across.simd_lt(zero);
                    // What is that near may be free: it is held if it would go into the dome.
                    if is_held.any() {
                        let gap = (length - level).fast_max(zero);
                        is_held &= (gap + dot(g, times(load_blocks(inverse, k), r))).simd_lt(zero);
                    }
                    let marks = is_held.bitselect(f32x4::ONE, zero).to_array();
                    let count = (to - i).min(4);
                    hold[k..k + count].copy_from_slice(&marks[..count]);
                    is_held
                }
                Contact::Held => load(hold, k).simd_gt(zero),
            };
            let share = is_held.bitselect(across / dot(g, g), zero);
            r = [0, 1, 2].map(|a| r[a] - g[a] * share);
            let on_wall = at[2].simd_le(zero) & r[2].simd_lt(zero);
            r[2] = on_wall.bitselect(zero, r[2]);
            store_free(f, k, (to - i).min(4), r);
            let lanes = dot(r, r).to_array();
            squares += lanes[..(to - i).min(4)].iter().map(|&r| f64::from(r)).sum::<f64>();
            i += 4;
        }
        last = row + to;
    });
    for part in [&mut f.x, &mut f.y, &mut f.z] {
        part[last..].fill(0.0);
    }
    mirror(layout, f);
    mirror_hold(layout, hold);
    squares
}

/// The greatest length of a vector that the free nodes have.
pub(super) fn greatest_length(layout: &Layout, vector: impl Fn(usize) -> [f32; 3]) -> f32 {
    let mut greatest = 0.0_f32;
    layout.free_rows(|j, from, to| {
        let row = j * layout.pitch;
        for k in row + from..row + to {
            let d = vector(k);
            let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            // Written so that what is not a number is kept.
            greatest = if square <= greatest { greatest } else { square };
        }
    });
    greatest.sqrt()
}

/// The greatest distance between two fields at a free node.
pub(super) fn greatest_difference(layout: &Layout, a: &Field, b: &Field) -> f32 {
    greatest_length(layout, |k| {
        let (p, q) = (a.at(k), b.at(k));
        [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
    })
}

/// ⟨u − before, step⟩ and ⟨step, step⟩ over the free nodes.
pub(super) fn products_of_steps(
    layout: &Layout,
    u: &Field,
    before: &Field,
    step: &Field,
) -> (f64, f64) {
    let (mut product, mut square) = (0.0, 0.0);
    layout.free_rows(|j, from, to| {
        let (mut row_product, mut row_square) = (0.0_f32, 0.0_f32);
        for k in j * layout.pitch + from..j * layout.pitch + to {
            let (p, q, s) = (u.at(k), before.at(k), step.at(k));
            row_product += (p[0] - q[0]) * s[0] + (p[1] - q[1]) * s[1] + (p[2] - q[2]) * s[2];
            row_square += s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
        }
        product += f64::from(row_product);
        square += f64::from(row_square);
    });
    (product, square)
}

/// u − before.
pub(super) fn difference(u: &Field, before: &Field, to: &mut Field) {
    let parts =
        [(&u.x, &before.x, &mut to.x), (&u.y, &before.y, &mut to.y), (&u.z, &before.z, &mut to.z)];
    for (u, before, to) in parts {
        for ((to, u), before) in to.iter_mut().zip(u).zip(before) {
            *to = u - before;
        }
    }
}

/// Moves u by a share of its way back to `before`.
pub(super) fn blend(before: &Field, share: f32, u: &mut Field) {
    let parts = [(&before.x, &mut u.x), (&before.y, &mut u.y), (&before.z, &mut u.z)];
    for (before, u) in parts {
        for (u, before) in u.iter_mut().zip(before) {
            *u += share * (before - *u);
        }
    }
}

/// Stores the first `count` lanes.
#[inline(always)]
fn store_free(field: &mut Field, k: usize, count: usize, lanes: [f32x4; 3]) {
    if count == 4 {
        field.store(k, lanes);
        return;
    }
    let [x, y, z] = lanes.map(f32x4::to_array);
    field.x[k..k + count].copy_from_slice(&x[..count]);
    field.y[k..k + count].copy_from_slice(&y[..count]);
    field.z[k..k + count].copy_from_slice(&z[..count]);
}

fn mirror_hold(layout: &Layout, hold: &mut [f32]) {
    let pitch = layout.pitch;
    let [along_x, along_y] = layout.mirrored;
    if along_x {
        for j in 0..layout.rows {
            hold[j * pitch] = hold[j * pitch + 2];
        }
    }
    if along_y {
        hold.copy_within(2 * pitch..3 * pitch, 0);
    }
}

/// Fills the ghosts of a mirrored grid.
pub(super) fn mirror(layout: &Layout, field: &mut Field) {
    let pitch = layout.pitch;
    let [along_x, along_y] = layout.mirrored;
    if along_x {
        for j in 0..layout.rows {
            let row = j * pitch;
            field.x[row + 1] = 0.0;
            field.x[row] = -field.x[row + 2];
            field.y[row] = field.y[row + 2];
            field.z[row] = field.z[row + 2];
        }
    }
    if along_y {
        field.y[pitch..2 * pitch].fill(0.0);
        for i in 0..layout.columns {
            field.x[i] = field.x[i + 2 * pitch];
            field.y[i] = -field.y[i + 2 * pitch];
            field.z[i] = field.z[i + 2 * pitch];
        }
    }
}
