//! Shooting method: integration from the apex over the dome to the border, and the root search.

use super::AxisymmetricError;
use super::meridian::{Meridian, MeridianPoint};
use super::runge_kutta::{Steps, integrate};
use implant_preview_core::contact::Dome;
use implant_preview_core::springs::Material;

/// Local error of the final shots, relative to each variable's magnitude \[-\].
pub(super) const FINE: f64 = 1e-12;
/// Local error of the shots that bracket the solution.
const COARSE: f64 = 1e-5;
/// Hoop strain assigned to a shot whose meridian collapses (apex stretch much too large).
const COLLAPSED_HOOP_STRAIN: f64 = 1.0;
/// Smallest hoop strain of a shot; below, the apex stretch is much too small.
const MIN_HOOP_STRAIN: f64 = -0.4;
/// Start of the integration after the series at the apex \[fraction of the dome's radius of curvature\].
const START: f64 = 1e-3;

/// One point of the profile: values and derivatives by the material radius s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    /// Material radius \[mm\].
    pub(super) s: f64,
    /// Deformed radius \[mm\], height \[mm\], meridional strain \[-\].
    pub(super) value: [f64; 3],
    pub(super) slope: [f64; 3],
}

impl Knot {
    /// Cubic Hermite interpolation between two knots.
    pub(super) fn interpolate(&self, next: &Self, s: f64) -> [f64; 3] {
        let length = next.s - self.s;
        let t = if length > 0.0 { (s - self.s) / length } else { 0.0 };
        std::array::from_fn(|i| {
            let (a, b) = (self.value[i], next.value[i]);
            let (da, db) = (length * self.slope[i], length * next.slope[i]);
            let bend = 2.0 * (a - b) + da + db;
            a + t * (da + t * (3.0 * (b - a) - 2.0 * da - db + t * bend))
        })
    }
}

/// Result of a shot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// Hoop strain at the border \[-\]; negative if the apex stretch is too small.
    pub(super) hoop: f64,
    /// Height at the border \[mm\]; NaN for a failed shot.
    pub(super) height: f64,
    /// Material radius at the contact edge \[mm\].
    pub(super) contact_radius: f64,
    /// Contact force / 2π \[kPa·mm²\].
    pub(super) vertical: f64,
    /// Deformed area / 2π \[mm²\].
    pub(super) area: f64,
}

impl Shot {
    fn failed(hoop: f64) -> Self {
        Self { hoop, height: f64::NAN, contact_radius: 0.0, vertical: 0.0, area: 0.0 }
    }
}

/// Principal tensions and their derivatives by the strains.
struct Response {
    /// T₁, T₂ \[kPa·mm\].
    tension: [f64; 2],
    /// ∂T₁/∂ε₁ and ∂T₁/∂ε₂ \[kPa·mm\].
    stiffness: [f64; 2],
}

/// Shooting problem: dome, pocket and materials of the sheet.
pub(super) struct Shooting<'a> {
    meridian: Meridian,
    pocket_radius: f64,
    materials: &'a [Material],
    /// Parameter θ at the intersection of dome and wall \[rad\].
    wall_angle: f64,
}

impl<'a> Shooting<'a> {
    pub(super) fn new(dome: &Dome, pocket_radius: f64, materials: &'a [Material]) -> Self {
        let meridian = Meridian::new(dome);
        Self { meridian, pocket_radius, materials, wall_angle: meridian.wall_angle() }
    }

    /// Principal tensions of the coupled law, from the curves. A reference shares no formula with what it checks.
    fn response(&self, [a, b]: [f64; 2]) -> Response {
        let mut sum = Response { tension: [0.0; 2], stiffness: [0.0; 2] };
        for material in self.materials {
            let nu = material.poisson_ratio;
            let plane = 1.0 / (1.0 - nu * nu);
            let equivalent = ((a * a + b * b + 2.0 * nu * a * b) * plane).max(0.0).sqrt();
            let slope = material.curve.slope(equivalent);
            let (secant, bend) = if equivalent > 1e-9 {
                let secant = material.curve.stress(equivalent) / equivalent;
                (secant, (slope - secant) / (equivalent * equivalent))
            } else {
                (slope, 0.0)
            };
            let h = material.thickness_mm;
            let t = [(a + nu * b) * plane, (b + nu * a) * plane];
            sum.tension[0] += h * secant * t[0];
            sum.tension[1] += h * secant * t[1];
            sum.stiffness[0] += h * (secant * plane + bend * t[0] * t[0]);
            sum.stiffness[1] += h * (secant * plane * nu + bend * t[0] * t[1]);
        }
        sum
    }

    /// dε₁/ds from (s T₁)′ = T₂ cos φ, valid on the dome and off the dome, and the tensions T₁, T₂.
    fn strain_slope(&self, s: f64, r: f64, strain: f64, cos: f64) -> (f64, [f64; 2]) {
        let around = (r - s) / s;
        let Response { tension: [t1, t2], stiffness: [along, across] } =
            self.response([strain, around]);
        let around_slope = ((1.0 + strain) * cos - 1.0 - around) / s;
        (((t2 * cos - t1) / s - across * around_slope) / along, [t1, t2])
    }

    /// Series about the apex: the material radius and the meridional strain at θ.
    fn apex_series(&self, strain: f64, angle: f64) -> (f64, f64) {
        let stretch = 1.0 + strain;
        let curvature = self.meridian.apex_curvature();
        let Response { tension: [tension, _], stiffness: [along, across] } =
            self.response([strain; 2]);
        // λ₁ = λ₀ + c₁s², λ₂ = λ₀ + c₂s² in (s T₁)′ = T₂ cos φ with cos φ = 1 − (κλ₀s)²/2.
        let turn = curvature.powi(2) * stretch.powi(2);
        let bend = turn * stretch / 6.0;
        let c1 = -(0.5 * tension * turn + bend * (along - 3.0 * across)) / (8.0 / 3.0 * along);
        let c2 = c1 / 3.0 - bend;
        let even = self.meridian.at(angle).r / stretch;
        (even * (1.0 - c2 * even * even / stretch), strain + c1 * even * even)
    }

    /// Integrates from the apex with the stretch 1 + `strain` over the dome to θ = `angle`, then to the border: in one piece, since both ways
    /// keep the same knots.
    pub(super) fn shoot(
        &self,
        strain: f64,
        angle: f64,
        tolerance: f64,
        mut knots: Option<&mut Vec<Knot>>,
    ) -> Shot {
        let (a, meridian) = (self.pocket_radius, &self.meridian);
        let slender = (meridian.base_radius / meridian.projection).min(1.0);
        let is_fine = knots.is_some();
        // Recorded steps are short enough for cubic interpolation.
        let longest = |range: f64| {
            if is_fine { range * slender / 200.0 } else { range / 4.0 }
        };
        let mut keep = |s: f64, value: [f64; 3], slope: [f64; 3]| {
            if let Some(knots) = &mut knots {
                knots.push(Knot { s, value, slope });
            }
        };
        let stretch = 1.0 + strain;
        keep(0.0, [0.0, meridian.at(0.0).z, strain], [stretch, 0.0, 0.0]);

        // On the dome, as functions of θ: s, ε₁, area/2π.
        // Lower bound from the rounding error of hoop strains, which are differences from 1.
        let strain_scale = strain.max(3e-16 / tolerance);
        let start = (START * slender).min(0.1 * angle);
        let (s, e) = self.apex_series(strain, start);
        let first = meridian.at(start).r;
        let steps = Steps { tolerance, scale: [a, strain_scale, a * a], longest: longest(angle) };
        let on_dome = |angle: f64, &[s, e, _]: &[f64; 3]| {
            let at = meridian.at(angle);
            let ((cos, _, arc), r) = (at.slope(), at.r);
            let by_angle = arc / (1.0 + e);
            [by_angle, self.strain_slope(s, r, e, cos).0 * by_angle, r * arc]
        };
        let mut failed = None;
        let contact = integrate(
            on_dome,
            (start, [s, e, 0.5 * first * first]),
            angle,
            &steps,
            |angle, &[s, e, _], slope| {
                let at = meridian.at(angle);
                let ((cos, sin, _), MeridianPoint { r, z, .. }) = (at.slope(), at);
                keep(s, [r, z, e], [(1.0 + e) * cos, -(1.0 + e) * sin, slope[1] / slope[0]]);
                failed = (r / s - 1.0 < MIN_HOOP_STRAIN).then_some(MIN_HOOP_STRAIN - (1.0 - s / a));
                failed.is_none()
            },
        );
        let Some([s, e, area]) = contact else { return Shot::failed(COLLAPSED_HOOP_STRAIN) };
        if let Some(hoop) = failed {
            return Shot::failed(hoop);
        }
        let at = meridian.at(angle);
        let ((cos, sin, _), MeridianPoint { r, z, .. }) = (at.slope(), at);
        let vertical = s * self.strain_slope(s, r, e, cos).1[0] * sin;
        let ended = Shot { hoop: r / s - 1.0, height: z, contact_radius: s, vertical, area };
        if self.is_full_contact() || s >= a {
            return ended;
        }

        // Off the dome, as functions of s: ε₁, r, z, φ, area/2π.
        let slope_angle = sin.atan2(cos);
        let scale = [strain_scale, a, a, slope_angle, a * a];
        let steps = Steps { tolerance, scale, longest: longest(a - s) };
        let off_dome = |s: f64, &[e, r, _, phi, _]: &[f64; 5]| {
            let (sin, cos) = phi.sin_cos();
            let (strain_slope, [t1, t2]) = self.strain_slope(s, r, e, cos);
            let stretch = 1.0 + e;
            [strain_slope, stretch * cos, -stretch * sin, -t2 * sin / (s * t1), r * stretch]
        };
        let free = integrate(
            off_dome,
            (s, [e, r, z, slope_angle, area]),
            a,
            &steps,
            |s, &[e, r, z, ..], slope| {
                keep(s, [r, z, e], [slope[1], slope[2], slope[0]]);
                failed = (r / s - 1.0 < MIN_HOOP_STRAIN).then_some(MIN_HOOP_STRAIN - (1.0 - s / a));
                failed.is_none()
            },
        );
        match (free, failed) {
            (Some([_, r, z, _, area]), None) => {
                Shot { hoop: r / a - 1.0, height: z, area, ..ended }
            }
            (_, hoop) => Shot::failed(hoop.unwrap_or(COLLAPSED_HOOP_STRAIN)),
        }
    }

    /// Returns `true` if the sheet is in contact up to the border: the dome meets the wall at the border.
    fn is_full_contact(&self) -> bool {
        (self.meridian.at(self.wall_angle).r / self.pocket_radius - 1.0).abs() < 1e-8
    }

    /// Apex strain and contact angle that satisfy the boundary conditions.
    pub(super) fn solve(&self) -> Result<(f64, f64), AxisymmetricError> {
        let (taut_strain, taut_angle) = self.taut_profile();
        let not_found = AxisymmetricError::NotFound { miss: f64::NAN };
        if self.is_full_contact() {
            let hoop = |strain: f64| self.shoot(strain, self.wall_angle, FINE, None).hoop;
            let strain = root_near(hoop, taut_strain, 1e-14).ok_or(not_found)?;
            return Ok((strain, self.wall_angle));
        }
        let bracketed = |tolerance: f64, accuracy: f64| {
            self.bracket(taut_strain, taut_angle, tolerance, accuracy)
        };
        let (strain, angle) = bracketed(COARSE, 1e-3).ok_or_else(|| not_found.clone())?;
        match self.refine(strain, angle) {
            Some(answer) => Ok(answer),
            None => bracketed(FINE, 1e-13).ok_or(not_found),
        }
    }

    /// Solves for both unknowns by bracketing: the inner iteration varies the apex strain until the radius
    /// at the border is correct, the outer iteration varies the contact angle until the height is correct.
    ///
    /// The taut profile is a lower bound of the contact angle (the free sheet lies below the profile), the
    /// wall an upper bound.
    fn bracket(
        &self,
        strain: f64,
        taut_angle: f64,
        tolerance: f64,
        accuracy: f64,
    ) -> Option<(f64, f64)> {
        let height = |angle: f64, guess: f64| {
            let hoop = |strain: f64| self.shoot(strain, angle, tolerance, None).hoop;
            let strain = root_near(hoop, guess, accuracy)?;
            // A failed shot has a much too steep meridian and ends much too low.
            let height = self.shoot(strain, angle, tolerance, None).height;
            Some((if height.is_nan() { -self.pocket_radius } else { height }, strain))
        };
        let (mut low, mut high) = (taut_angle, self.wall_angle);
        let (mut above, strain) = height(low, strain)?;
        let (mut below, strain) = height(high, strain)?;
        let mut best = (strain, high);
        // Regula falsi (Illinois variant), with bisection in every fourth step.
        let mut last_side = 0;
        for k in 0..200 {
            if high - low <= accuracy * high {
                break;
            }
            let fraction = if k % 4 == 3 { 0.5 } else { above / (above - below) };
            let angle = low + (high - low) * fraction.clamp(0.001, 0.999);
            let (z, strain) = height(angle, best.0)?;
            best = (strain, angle);
            if z > 0.0 {
                (low, above) = (angle, z);
                below *= if last_side == 1 { 0.5 } else { 1.0 };
                last_side = 1;
            } else {
                (high, below) = (angle, z);
                above *= if last_side == -1 { 0.5 } else { 1.0 };
                last_side = -1;
            }
        }
        Some(best)
    }

    /// Newton's method for both unknowns from a close start; `None` without convergence.
    fn refine(&self, strain: f64, angle: f64) -> Option<(f64, f64)> {
        let residual = |strain: f64, angle: f64| {
            let shot = self.shoot(strain, angle, FINE, None);
            [shot.hoop, shot.height / self.pocket_radius]
        };
        let (mut strain, mut angle) = (strain, angle);
        for _ in 0..12 {
            let here = residual(strain, angle);
            let steps = [1e-5 * strain, -1e-5 * angle];
            let by_strain = residual(strain + steps[0], angle);
            let by_angle = residual(strain, angle + steps[1]);
            let slope = |there: [f64; 2], step: f64| [0, 1].map(|i| (there[i] - here[i]) / step);
            let (p, q) = (slope(by_strain, steps[0]), slope(by_angle, steps[1]));
            let determinant = p[0] * q[1] - p[1] * q[0];
            let strain_step = -(here[0] * q[1] - here[1] * q[0]) / determinant;
            let angle_step = -(p[0] * here[1] - p[1] * here[0]) / determinant;
            let relative = (strain_step / strain).abs().max((angle_step / angle).abs());
            if relative.is_nan() || relative > 0.5 {
                return None;
            }
            strain += strain_step;
            angle = (angle + angle_step).min(self.wall_angle);
            // Small strains have a larger relative rounding error.
            if relative < 1e-11 + 1e-15 / strain {
                return Some((strain, angle));
            }
        }
        None
    }

    /// Taut profile over the dome to the border: its strain, and θ at its contact edge.
    fn taut_profile(&self) -> (f64, f64) {
        let angle = self.meridian.tangent_through(self.pocket_radius);
        let angle = angle.clamp(1e-6 * self.wall_angle, self.wall_angle);
        let parts = 64;
        let arc: f64 = (0..parts)
            .map(|k| self.meridian.at(angle * (f64::from(k) + 0.5) / f64::from(parts)).slope().2)
            .sum::<f64>()
            * angle
            / f64::from(parts);
        let touch = self.meridian.at(angle);
        let straight = (self.pocket_radius - touch.r).hypot(touch.z);
        (((arc + straight) / self.pocket_radius - 1.0).max(1e-9), angle)
    }
}

/// Positive root of an increasing function to a relative accuracy, from an initial guess: bracketing by
/// growing steps, then regula falsi (Illinois variant) with bisection in every fourth step.
fn root_near(f: impl Fn(f64) -> f64, guess: f64, accuracy: f64) -> Option<f64> {
    let (mut low, mut high) = (guess, guess);
    let (mut below, mut above) = (f(guess), f64::NAN);
    if below > 0.0 {
        above = below;
        below = f64::NAN;
    }
    let mut factor = 1.1;
    for _ in 0..60 {
        if below.is_nan() {
            low /= factor;
            let value = f(low);
            if value > 0.0 { (high, above) = (low, value) } else { below = value }
        } else if above.is_nan() {
            high *= factor;
            let value = f(high);
            if value > 0.0 { above = value } else { (low, below) = (high, value) }
        } else {
            break;
        }
        factor *= 1.2;
    }
    if below.is_nan() || above.is_nan() {
        return None;
    }
    let mut last_side = 0;
    for k in 0..200 {
        if high - low <= accuracy * high {
            break;
        }
        let fraction = if k % 4 == 3 { 0.5 } else { below / (below - above) };
        let at = low + (high - low) * fraction.clamp(1e-6, 1.0 - 1e-6);
        let value = f(at);
        if value == 0.0 {
            return Some(at);
        }
        if value < 0.0 {
            (low, below) = (at, value);
            above *= if last_side == -1 { 0.5 } else { 1.0 };
            last_side = -1;
        } else {
            (high, above) = (at, value);
            below *= if last_side == 1 { 0.5 } else { 1.0 };
            last_side = 1;
        }
    }
    Some(if -below < above { low } else { high })
}
