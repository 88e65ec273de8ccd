//! The maps of a body that yields: of determinant one everywhere, with the base in its plane, as inverses in closed form.
//!
//! Of eight numbers: ε flattens, κ widens upper sections, ν moves the body from its middle to its shoulders, e widens across and narrows along the body,
//! (s_x, s_y) shear, and the last two tilt it (`tilt`). With the height h and half-axes a and b at rest, λ = 1 − ε, t = z/(λh), c = 1 + κt and u = (x₁/a)² + (y₁/b)² a point (x, y, z)
//! of the upright body is the image of
//!
//! ```text
//! x₁ = (x − s_x z) √λ e^−e / √c,    y₁ = (y − s_y z) √λ e^e / √c,    z₁ = h (t + κt²/2)
//! X = x₁ √(1 + νu),                 Y = y₁ √(1 + νu),                Z = z₁ / (1 + 2νu)
//! ```
//!
//! Where c or 1 + 2νu would fall below a bound, beyond the body, they stay at the bound.

use super::tilt::{FARTHEST, LEAST, Tilt, Upright};
use crate::mesh::vec3::Block;
use crate::number::Real;

/// Numbers of a deformation.
pub(crate) const MODES: usize = 8;

/// Flattening ε, taper κ, shoulder ν, widening e, shears s_x and s_y, tilts τ_x and τ_y \[-\].
pub(crate) type Modes<R> = [R; MODES];

/// A deformation, in any unit of length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map<R> {
    height: R,
    flattened: R,
    taper: R,
    shoulder: R,
    /// √λ e^−e and √λ e^e.
    narrowing: [R; 2],
    shear: [R; 2],
    /// 1/a² and 1/b².
    per_square: [R; 2],
    /// Heights t within which c varies, and z₁/h there.
    within: [R; 2],
    within_source: [R; 2],
    /// u up to which 1 + 2νu varies.
    most: R,
    tilt: Tilt<R>,
}

/// A source and the derivatives of the map to it.
#[derive(Clone, Copy)]
pub(super) struct Source<R> {
    pub(super) place: [R; 3],
    /// (x₁, y₁, z₁).
    inner: [R; 3],
    /// t.
    height: R,
    /// c and its derivative by z.
    section: R,
    slope: R,
    /// 1/√c.
    per_root: R,
    /// u, √(1 + νu) and its derivatives by u.
    distance: R,
    wide: [R; 3],
    /// 1/(1 + 2νu) and its derivatives by u.
    low: [R; 3],
    /// The point without the tilt.
    upright: Upright<R>,
}

impl<R: Real> Source<R> {
    /// c.
    pub(super) fn section(&self) -> R {
        self.section
    }
}

impl<R: Real> Map<R> {
    /// Of a body of these half-axes.
    pub(crate) fn new([a, b, height]: [f64; 3], modes: Modes<f64>) -> Self {
        let [flattening, taper, shoulder, widening, across, along, tilts @ ..] = modes;
        let left = 1.0 - flattening;
        let turn = ((1.0 - LEAST) / taper.abs().max(1e-12)).min(FARTHEST);
        let within = if taper > 0.0 { [-turn, FARTHEST] } else { [-FARTHEST, turn] };
        let source = within.map(|t| t + 0.5 * taper * t * t);
        let most = if shoulder < 0.0 { 0.5 * (1.0 - LEAST) / -shoulder } else { FARTHEST };
        Self {
            height: R::splat(height),
            flattened: R::splat(left),
            taper: R::splat(taper),
            shoulder: R::splat(shoulder),
            narrowing: [-widening, widening].map(|e| R::splat(left.sqrt() * e.exp())),
            shear: [across, along].map(R::splat),
            per_square: [a, b].map(|axis| R::splat(1.0 / (axis * axis))),
            within: within.map(R::splat),
            within_source: source.map(R::splat),
            most: R::splat(most.min(FARTHEST)),
            tilt: Tilt::new([a, b], tilts),
        }
    }

    /// The source of a point, from the middle of the base.
    #[inline(always)]
    pub(super) fn source(&self, at: [R; 3]) -> Source<R> {
        let upright = self.tilt.source(at);
        let [x, y, z] = upright.place;
        let (zero, one, half) = (R::splat(0.0), R::splat(1.0), R::splat(0.5));
        let height = z / self.flattened / self.height;
        let within = height.max(self.within[0]).min(self.within[1]);
        let beyond = height - within;
        let section = one + self.taper * within;
        let per_root = one / section.sqrt();
        let inner = [
            (x - self.shear[0] * z) * self.narrowing[0] * per_root,
            (y - self.shear[1] * z) * self.narrowing[1] * per_root,
            self.height * (within + half * self.taper * within * within + section * beyond),
        ];
        let rate = self.taper / (self.height * self.flattened);
        let slope = R::select((beyond * beyond).is_above(zero), zero, rate);
        let distance =
            self.per_square[0] * inner[0] * inner[0] + self.per_square[1] * inner[1] * inner[1];
        let [wide, low] = self.shoulders(distance);
        let place = [inner[0] * wide[0], inner[1] * wide[0], inner[2] * low[0]];
        Source { place, inner, height, section, slope, per_root, distance, wide, low, upright }
    }

    /// √(1 + νu) and 1/(1 + 2νu) with two derivatives by u.
    #[inline(always)]
    fn shoulders(&self, u: R) -> [[R; 3]; 2] {
        let (zero, one, half) = (R::splat(0.0), R::splat(1.0), R::splat(0.5));
        let near = u.min(self.most);
        let is_beyond = (u - near).is_above(zero);
        let twice = self.shoulder + self.shoulder;
        let steep = one + twice * near;
        let inside = one + self.shoulder * near;
        let outside = (near * inside + steep * (u - near)) / u.max(R::splat(1e-12));
        let square = R::select(is_beyond, outside, inside);
        let rate = R::select(is_beyond, (steep - square) / u.max(R::splat(1e-12)), self.shoulder);
        let root = square.sqrt();
        let slope = half * rate / root;
        let low = one / steep;
        let fall = R::select(is_beyond, zero, -(twice * low * low));
        [[root, slope, -(slope * slope / root)], [low, fall, (fall + fall) * fall * steep]]
    }

    /// The image of a source.
    #[inline(always)]
    pub(super) fn image(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let (one, two, four) = (R::splat(1.0), R::splat(2.0), R::splat(4.0));
        let far = self.per_square[0] * x * x + self.per_square[1] * y * y;
        // u + νu² = far within the bound.
        let bound = self.most * (one + self.shoulder * self.most);
        let near = far.min(bound);
        let within = two * near / (one + (one + four * self.shoulder * near).sqrt());
        let steep = one + two * self.shoulder * within;
        let u = within + (far - near) / steep;
        let wide = self.shoulders(u)[0][0];
        let height = z * steep / self.height;
        let inner = height.max(self.within_source[0]).min(self.within_source[1]);
        let section = (one + two * self.taper * inner).sqrt();
        let t = two * inner / (one + section) + (height - inner) / section;
        let (root, up) = (section.sqrt() / wide, self.flattened * self.height * t);
        self.tilt.image([
            x * root / self.narrowing[0] + self.shear[0] * up,
            y * root / self.narrowing[1] + self.shear[1] * up,
            up,
        ])
    }

    /// ∂(X, Y, Z)/∂(x₁, y₁, z₁), by rows.
    #[inline(always)]
    fn outer_jacobian(&self, of: &Source<R>) -> [[R; 3]; 3] {
        let ([x, y, z], zero) = (of.inner, R::splat(0.0));
        let [by_x, by_y] = self.by_distance(of);
        let ([wide, slope, _], [low, fall, _]) = (of.wide, of.low);
        [
            [wide + x * slope * by_x, x * slope * by_y, zero],
            [y * slope * by_x, wide + y * slope * by_y, zero],
            [z * fall * by_x, z * fall * by_y, low],
        ]
    }

    /// ∂u/∂(x₁, y₁).
    #[inline(always)]
    fn by_distance(&self, of: &Source<R>) -> [R; 2] {
        [0, 1].map(|axis| {
            let along = self.per_square[axis] * of.inner[axis];
            along + along
        })
    }

    /// Derivatives of (x₁, y₁, z₁) by the point without the tilt: x₁ by x and z, y₁ by y and z, z₁ by z.
    #[inline(always)]
    fn jacobian(&self, of: &Source<R>) -> [[R; 2]; 3] {
        let aside = R::splat(0.5) * of.slope / of.section;
        let [x, y] = [0, 1].map(|axis| {
            let own = self.narrowing[axis] * of.per_root;
            [own, -(self.shear[axis] * own) - of.inner[axis] * aside]
        });
        [x, y, [R::splat(0.0), of.section / self.flattened]]
    }

    /// Derivatives of the source by the point, by rows.
    #[cfg(test)]
    pub(super) fn whole_jacobian(&self, of: &Source<R>) -> [[R; 3]; 3] {
        let [[a, d], [b, e], [_, c]] = self.jacobian(of);
        let row = |[x, y, z]: [R; 3]| [x * a, y * b, x * d + y * e + z * c];
        self.outer_jacobian(of).map(|outer| self.tilt.pulled(&of.upright, row(outer)))
    }

    /// A gradient by the source as one by (x₁, y₁, z₁).
    #[inline(always)]
    fn inner_gradient(&self, of: &Source<R>, g: [R; 3]) -> [R; 3] {
        let [x, y, z] = self.outer_jacobian(of);
        [0, 1, 2].map(|axis| x[axis] * g[0] + y[axis] * g[1] + z[axis] * g[2])
    }

    /// A gradient by the source as one by the point.
    #[inline(always)]
    pub(super) fn pulled(&self, of: &Source<R>, g: [R; 3]) -> [R; 3] {
        self.tilt.pulled(&of.upright, self.upright_gradient(of, g))
    }

    /// A gradient by the source as one by the point without the tilt.
    #[inline(always)]
    fn upright_gradient(&self, of: &Source<R>, g: [R; 3]) -> [R; 3] {
        let g = self.inner_gradient(of, g);
        let [x, y, z] = self.jacobian(of);
        [x[0] * g[0], y[0] * g[1], x[1] * g[0] + y[1] * g[1] + z[1] * g[2]]
    }

    /// A second derivative by the source, with the gradient by it, as one by the point.
    #[inline(always)]
    pub(super) fn bent(&self, of: &Source<R>, block: Block<R>, g: [R; 3]) -> Block<R> {
        let inner = self.inner_block(of, block, g);
        let upright = self.own_block(of, inner, self.inner_gradient(of, g));
        self.tilt.bent(&of.upright, upright, self.upright_gradient(of, g))
    }

    /// The second derivative by (x₁, y₁, z₁).
    #[inline(always)]
    fn inner_block(
        &self,
        of: &Source<R>,
        [xx, xy, xz, yy, yz, zz]: Block<R>,
        g: [R; 3],
    ) -> Block<R> {
        let rows = self.outer_jacobian(of);
        let column = |axis: usize| rows.map(|row| row[axis]);
        let product = |axis: usize| {
            let [x, y, z] = column(axis);
            [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
        };
        let own = |i: usize, j: usize| {
            let (a, b) = (column(i), product(j));
            a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
        };
        let u = self.by_distance(of);
        let ([_, slope, bend], [_, fall, turn]) = (of.wide, of.low);
        let along = g[0] * of.inner[0] + g[1] * of.inner[1];
        let up = g[2] * of.inner[2];
        let (first, second) = (along * slope + up * fall, along * bend + up * turn);
        let twice = self.per_square.map(|square| square + square);
        let of_pair = |i: usize, j: usize| {
            own(i, j) + (g[i] * u[j] + g[j] * u[i]) * slope + second * u[i] * u[j]
        };
        [
            of_pair(0, 0) + first * twice[0],
            of_pair(0, 1),
            own(0, 2) + g[2] * fall * u[0],
            of_pair(1, 1) + first * twice[1],
            own(1, 2) + g[2] * fall * u[1],
            own(2, 2),
        ]
    }

    /// A second derivative by (x₁, y₁, z₁) as one by the point without the tilt.
    #[inline(always)]
    fn own_block(&self, of: &Source<R>, block: Block<R>, g: [R; 3]) -> Block<R> {
        let [[a, d], [b, e], [_, c]] = self.jacobian(of);
        let [xx, xy, xz, yy, yz, zz] = block;
        // H times the column of z.
        let (x, y, z) =
            (xx * d + xy * e + xz * c, xy * d + yy * e + yz * c, xz * d + yz * e + zz * c);
        let rate = of.slope / of.section;
        let half = R::splat(0.5);
        let mut out = [a * a * xx, a * b * xy, a * x, b * b * yy, b * y, d * x + e * y + c * z];
        for (axis, own, at) in [(0, a, 2), (1, b, 4)] {
            let cross = -(half * own * rate);
            out[at] += g[axis] * cross;
            let along =
                R::splat(0.75) * rate * rate * of.inner[axis] + self.shear[axis] * own * rate;
            out[5] += g[axis] * along;
        }
        out[5] += g[2] * of.slope / self.flattened;
        out
    }

    /// Derivatives by the numbers, at a fixed point, of a function of the source with this gradient.
    #[inline(always)]
    pub(super) fn variation(&self, of: &Source<R>, g: [R; 3]) -> Modes<R> {
        let (one, half) = (R::splat(1.0), R::splat(0.5));
        let inner = self.inner_gradient(of, g);
        let ([x, y, z], t) = (of.inner, of.height);
        let aside = inner[0] * x + inner[1] * y;
        let per_section = t / of.section;
        let up = self.height * t;
        let drag = [0, 1]
            .map(|axis| -(inner[axis] * up * self.flattened * self.narrowing[axis] * of.per_root));
        let [wide, low] = [of.wide[0], of.low[0]];
        let along = half * (g[0] * x + g[1] * y) / wide;
        let tilts = self.tilt.variation(&of.upright, self.upright_gradient(of, g));
        [
            (inner[2] * of.section * up - half * aside * (one + self.taper * per_section))
                / self.flattened,
            half * (inner[2] * up * t - aside * per_section),
            of.distance * (along - R::splat(2.0) * g[2] * z * low * low),
            inner[1] * y - inner[0] * x,
            drag[0],
            drag[1],
            tilts[0],
            tilts[1],
        ]
    }
}
