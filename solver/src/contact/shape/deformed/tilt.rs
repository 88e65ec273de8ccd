//! The tilt of a body that yields: thicker towards one side, thinner towards the other, of determinant one, with the base in its plane.
//!
//! Of a number τ along each of the axes across and along the body, with the half-axes a and b at rest, x′ = x − m_x, y′ = y − m_y, r_x = 1 + τ_x x′/a
//! and r_y = 1 + τ_y y′/b a point (x, y, z) is the image of
//!
//! ```text
//! (x′ + τ_x x′²/2a,  y′ + τ_y y′²/2b,  z/(r_x r_y))
//! ```
//!
//! The moves m keep the middle of a base with these half-axes where it is, m_x/a = 1/(1 + √(1 − 2τ_x)) − 1/(1 + √(1 + 2τ_x)): the sections between its
//! ends move towards the thick side. Where r_x or r_y would fall below a bound, beyond the body, they stay at the bound.

use crate::mesh::vec3::Block;
use crate::number::Real;

/// Least 1 + τy/b, and c and 1 + 2νu of the other maps.
pub(super) const LEAST: f64 = 0.25;
/// Places \[b\], heights \[h\] and squared distances u up to which they vary at most.
pub(super) const FARTHEST: f64 = 8.0;

/// The last of the maps, in any unit of length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tilt<R> {
    /// Is τ zero along both axes?
    is_upright: bool,
    /// τ by the half-axes.
    rate: [R; 2],
    /// 1/a and 1/b.
    per_axis: [R; 2],
    /// m_x and m_y, and their derivatives by the numbers.
    moved: [[R; 2]; 2],
    /// Places within which r_x and r_y vary, and their sources.
    within: [[R; 2]; 2],
    within_source: [[R; 2]; 2],
}

/// A source and the derivatives of the map to it.
#[derive(Clone, Copy)]
pub(super) struct Upright<R> {
    pub(super) place: [R; 3],
    /// r_x and r_y, and their derivatives by x and y.
    rise: [R; 2],
    slope: [R; 2],
    /// Derivatives of the first two coordinates by the rates.
    by_rate: [R; 2],
    /// Derivatives of r_x and r_y by the rates.
    near: [R; 2],
}

impl<R: Real> Tilt<R> {
    /// Of a body of these half-axes.
    pub(super) fn new(axes: [f64; 2], tilts: [f64; 2]) -> Self {
        let rate = [0, 1].map(|axis| tilts[axis] / axes[axis]);
        let within = [0, 1].map(|axis| {
            let far = FARTHEST * axes[axis];
            let turn = ((1.0 - LEAST) / rate[axis].abs().max(1e-12)).min(far);
            [-turn, turn]
        });
        let source = [0, 1].map(|axis| within[axis].map(|at| at + 0.5 * rate[axis] * at * at));
        Self {
            is_upright: tilts.iter().all(|tilt| *tilt == 0.0),
            rate: rate.map(R::splat),
            per_axis: axes.map(|axis| R::splat(1.0 / axis)),
            moved: [0, 1].map(|axis| move_of(tilts[axis]).map(|part| R::splat(part * axes[axis]))),
            within: within.map(|ends| ends.map(R::splat)),
            within_source: source.map(|ends| ends.map(R::splat)),
        }
    }

    /// The source of a point.
    #[inline(always)]
    pub(super) fn source(&self, [x, y, z]: [R; 3]) -> Upright<R> {
        let (zero, one, half) = (R::splat(0.0), R::splat(1.0), R::splat(0.5));
        if self.is_upright {
            let by_rate = [half * x * x, half * y * y];
            let (rise, slope, near) = ([one; 2], [zero; 2], [x, y]);
            return Upright { place: [x, y, z], rise, slope, by_rate, near };
        }
        let at = [x - self.moved[0][0], y - self.moved[1][0]];
        let near = [0, 1].map(|k| at[k].max(self.within[k][0]).min(self.within[k][1]));
        let beyond = [0, 1].map(|k| at[k] - near[k]);
        let rise = [0, 1].map(|k| one + self.rate[k] * near[k]);
        let slope =
            [0, 1].map(|k| R::select((beyond[k] * beyond[k]).is_above(zero), zero, self.rate[k]));
        let by_rate = [0, 1].map(|k| near[k] * (half * near[k] + beyond[k]));
        let [x, y] = [0, 1].map(|k| at[k] + self.rate[k] * by_rate[k]);
        let place = [x, y, z / (rise[0] * rise[1])];
        Upright { place, rise, slope, by_rate, near }
    }

    /// The image of a source.
    #[inline(always)]
    pub(super) fn image(&self, at: [R; 3]) -> [R; 3] {
        if self.is_upright {
            return at;
        }
        let (one, two) = (R::splat(1.0), R::splat(2.0));
        let near =
            [0, 1].map(|k| at[k].max(self.within_source[k][0]).min(self.within_source[k][1]));
        let rise = [0, 1].map(|k| (one + two * self.rate[k] * near[k]).sqrt());
        let [x, y] = [0, 1].map(|k| {
            let own = two * near[k] / (one + rise[k]) + (at[k] - near[k]) / rise[k];
            own + self.moved[k][0]
        });
        [x, y, at[2] * rise[0] * rise[1]]
    }

    /// ∂z of the source by the point's x and y, and by z.
    #[inline(always)]
    fn fall(of: &Upright<R>) -> [R; 3] {
        let [x, y] = [0, 1].map(|k| -(of.place[2] * of.slope[k] / of.rise[k]));
        [x, y, R::splat(1.0) / (of.rise[0] * of.rise[1])]
    }

    /// A gradient by the source as one by the point.
    #[inline(always)]
    pub(super) fn pulled(&self, of: &Upright<R>, g: [R; 3]) -> [R; 3] {
        if self.is_upright {
            return g;
        }
        let fall = Self::fall(of);
        [g[0] * of.rise[0] + g[2] * fall[0], g[1] * of.rise[1] + g[2] * fall[1], g[2] * fall[2]]
    }

    /// A second derivative by the source, with the gradient by it, as one by the point.
    #[inline(always)]
    pub(super) fn bent(&self, of: &Upright<R>, h: Block<R>, g: [R; 3]) -> Block<R> {
        if self.is_upright {
            return h;
        }
        let [xx, xy, xz, yy, yz, zz] = h;
        let ([p, q, w], [r, s]) = (Self::fall(of), of.rise);
        let [by_x, by_y] = [0, 1].map(|k| of.slope[k] / of.rise[k]);
        let down = g[2] * of.place[2];
        let two = R::splat(2.0);
        [
            r * r * xx
                + two * r * p * xz
                + p * p * zz
                + g[0] * of.slope[0]
                + two * down * by_x * by_x,
            r * s * xy + r * q * xz + p * s * yz + p * q * zz + down * by_x * by_y,
            w * (r * xz + p * zz - g[2] * by_x),
            s * s * yy
                + two * s * q * yz
                + q * q * zz
                + g[1] * of.slope[1]
                + two * down * by_y * by_y,
            w * (s * yz + q * zz - g[2] * by_y),
            w * w * zz,
        ]
    }

    /// Derivatives by the two numbers, at a fixed point, of a function of the source with this gradient.
    #[inline(always)]
    pub(super) fn variation(&self, of: &Upright<R>, g: [R; 3]) -> [R; 2] {
        let pulled = self.pulled(of, g);
        [0, 1].map(|k| {
            let lower = g[2] * of.place[2] * of.near[k] / of.rise[k];
            (g[k] * of.by_rate[k] - lower) * self.per_axis[k] - pulled[k] * self.moved[k][1]
        })
    }
}

/// m by the half-axis, of a number τ, and its derivative by τ.
fn move_of(tilt: f64) -> [f64; 2] {
    let side = |sign: f64| {
        let rise = (1.0 + 2.0 * sign * tilt).max(LEAST).sqrt();
        let part = 1.0 / (1.0 + rise);
        [-sign * part, part * part / rise]
    };
    let ([above, of_above], [below, of_below]) = (side(1.0), side(-1.0));
    [above + below, of_above + of_below]
}
