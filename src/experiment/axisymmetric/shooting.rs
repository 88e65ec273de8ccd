//! Shooting: from the apex over the dome and off it to the border, and how to aim.

use super::AxisymmetricError;
use super::runge_kutta::{Steps, integrate};
use crate::contact::Dome;
use crate::springs::Material;
use crate::springs::coupled::equivalent_strain;

/// Local error of the last shots, relative to each variable's magnitude \[-\].
pub(super) const FINE: f64 = 1e-12;
/// Local error of the shots that bracket the answer.
const COARSE: f64 = 1e-5;
/// What a shot counts as whose meridian collapses: its apex is stretched far too much.
const COLLAPSED: f64 = 1.0;
/// Hoop stretch − 1 below which a shot is lost: its apex is stretched far too little.
const LOST: f64 = -0.4;
/// Where integration leaves the apex, by its series, as a share of the dome's radius of curvature.
const START: f64 = 1e-3;

/// One place of the profile: values and slopes by the material radius s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    /// Material radius \[mm\].
    pub(super) s: f64,
    /// Deformed radius \[mm\], height \[mm\], meridional strain \[-\].
    pub(super) value: [f64; 3],
    pub(super) slope: [f64; 3],
}

impl Knot {
    /// The cubic through two knots' values and slopes.
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

/// How a shot ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// Hoop stretch − 1 at the border \[-\]: negative where the apex is stretched too little.
    pub(super) hoop: f64,
    /// Height at the border \[mm\]; NaN for a shot that was lost.
    pub(super) height: f64,
    /// Material radius where contact ends \[mm\].
    pub(super) contact_radius: f64,
    /// Contact force / 2π \[kPa·mm²\].
    pub(super) vertical: f64,
    /// Deformed area / 2π \[mm²\].
    pub(super) area: f64,
}

impl Shot {
    fn lost(hoop: f64) -> Self {
        Self { hoop, height: f64::NAN, contact_radius: 0.0, vertical: 0.0, area: 0.0 }
    }
}

/// Tensions and their derivatives by the strains.
struct Response {
    /// T₁, T₂ \[kPa·mm\].
    tension: [f64; 2],
    /// ∂T₁/∂ε₁ and ∂T₁/∂ε₂ \[kPa·mm\].
    stiffness: [f64; 2],
}

/// A dome, a pocket and what the sheet is made of.
pub(super) struct Shooting<'a> {
    base_radius: f64,
    projection: f64,
    base_height: f64,
    pocket_radius: f64,
    materials: &'a [Material],
    /// θ where the dome meets the wall \[rad\].
    wall_angle: f64,
}

impl<'a> Shooting<'a> {
    pub(super) fn new(dome: &Dome, pocket_radius: f64, materials: &'a [Material]) -> Self {
        Self {
            base_radius: dome.base_radius,
            projection: dome.projection,
            base_height: dome.base_height,
            pocket_radius,
            materials,
            wall_angle: (-dome.base_height / dome.projection).clamp(0.0, 1.0).acos(),
        }
    }

    /// The coupled law by the curves themselves.
    fn response(&self, [a, b]: [f64; 2]) -> Response {
        let mut sum = Response { tension: [0.0; 2], stiffness: [0.0; 2] };
        for material in self.materials {
            let nu = material.poisson_ratio;
            let plane = 1.0 / (1.0 - nu * nu);
            let equivalent = equivalent_strain([a, b], nu);
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

    /// dε₁/ds from (s T₁)′ = T₂ cos φ, which holds on the dome and off it, with the tensions.
    fn strain_slope(&self, s: f64, r: f64, strain: f64, cos: f64) -> (f64, [f64; 2]) {
        let around = (r - s) / s;
        let Response { tension: [t1, t2], stiffness: [along, across] } =
            self.response([strain, around]);
        let around_slope = ((1.0 + strain) * cos - 1.0 - around) / s;
        (((t2 * cos - t1) / s - across * around_slope) / along, [t1, t2])
    }

    /// cos φ, sin φ and arc length by θ of the dome's meridian.
    fn meridian(&self, angle: f64) -> (f64, f64, f64) {
        let (sin, cos) = angle.sin_cos();
        let along = [self.base_radius * cos, self.projection * sin];
        let arc = along[0].hypot(along[1]);
        (along[0] / arc, along[1] / arc, arc)
    }

    /// Series about the apex: at θ the material radius, and the meridional strain.
    fn leave_apex(&self, strain: f64, angle: f64) -> (f64, f64) {
        let stretch = 1.0 + strain;
        let curvature = self.projection / self.base_radius.powi(2);
        let Response { tension: [tension, _], stiffness: [along, across] } =
            self.response([strain; 2]);
        // λ₁ = λ₀ + c₁s², λ₂ = λ₀ + c₂s² in (s T₁)′ = T₂ cos φ with cos φ = 1 − (κλ₀s)²/2.
        let turn = curvature.powi(2) * stretch.powi(2);
        let bend = turn * stretch / 6.0;
        let c1 = -(0.5 * tension * turn + bend * (along - 3.0 * across)) / (8.0 / 3.0 * along);
        let c2 = c1 / 3.0 - bend;
        let even = self.base_radius * angle.sin() / stretch;
        (even * (1.0 - c2 * even * even / stretch), strain + c1 * even * even)
    }

    /// From the apex, stretched by 1 + `strain`, over the dome to θ = `angle` and off it to the border.
    pub(super) fn shoot(
        &self,
        strain: f64,
        angle: f64,
        tolerance: f64,
        mut knots: Option<&mut Vec<Knot>>,
    ) -> Shot {
        let (a, base_radius) = (self.pocket_radius, self.base_radius);
        let is_fine = knots.is_some();
        // Where every step is kept, cubics between them must do.
        let longest = |range: f64| {
            let slender = (base_radius / self.projection).min(1.0);
            if is_fine { range * slender / 200.0 } else { range / 4.0 }
        };
        let mut keep = |s: f64, value: [f64; 3], slope: [f64; 3]| {
            if let Some(knots) = &mut knots {
                knots.push(Knot { s, value, slope });
            }
        };
        let stretch = 1.0 + strain;
        keep(0.0, [0.0, self.base_height + self.projection, strain], [stretch, 0.0, 0.0]);

        // On the dome, against θ: s, ε₁, area/2π.
        let place = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            (base_radius * sin, self.base_height + self.projection * cos)
        };
        // Hoop strains are differences from 1: below this they have no further digits.
        let strain_scale = strain.max(3e-16 / tolerance);
        let start = (START * (base_radius / self.projection).min(1.0)).min(0.1 * angle);
        let (s, e) = self.leave_apex(strain, start);
        let first = place(start).0;
        let steps = Steps { tolerance, scale: [a, strain_scale, a * a], longest: longest(angle) };
        let on_dome = |angle: f64, &[s, e, _]: &[f64; 3]| {
            let (cos, _, arc) = self.meridian(angle);
            let r = base_radius * angle.sin();
            let by_angle = arc / (1.0 + e);
            [by_angle, self.strain_slope(s, r, e, cos).0 * by_angle, r * arc]
        };
        let mut lost = None;
        let contact = integrate(
            on_dome,
            (start, [s, e, 0.5 * first * first]),
            angle,
            &steps,
            |angle, &[s, e, _], slope| {
                let (r, z) = place(angle);
                let (cos, sin, _) = self.meridian(angle);
                keep(s, [r, z, e], [(1.0 + e) * cos, -(1.0 + e) * sin, slope[1] / slope[0]]);
                lost = (r / s - 1.0 < LOST).then_some(LOST - (1.0 - s / a));
                lost.is_none()
            },
        );
        let Some([s, e, area]) = contact else { return Shot::lost(COLLAPSED) };
        if let Some(hoop) = lost {
            return Shot::lost(hoop);
        }
        let (cos, sin, _) = self.meridian(angle);
        let (r, z) = place(angle);
        let vertical = s * self.strain_slope(s, r, e, cos).1[0] * sin;
        let ended = Shot { hoop: r / s - 1.0, height: z, contact_radius: s, vertical, area };
        if self.is_full_contact() || s >= a {
            return ended;
        }

        // Off the dome, against s: ε₁, r, z, φ, area/2π.
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
                lost = (r / s - 1.0 < LOST).then_some(LOST - (1.0 - s / a));
                lost.is_none()
            },
        );
        match (free, lost) {
            (Some([_, r, z, _, area]), None) => {
                Shot { hoop: r / a - 1.0, height: z, area, ..ended }
            }
            (_, hoop) => Shot::lost(hoop.unwrap_or(COLLAPSED)),
        }
    }

    /// Does the sheet lie on the dome up to the border? Only where the dome meets the wall there.
    fn is_full_contact(&self) -> bool {
        (self.base_radius * self.wall_angle.sin() / self.pocket_radius - 1.0).abs() < 1e-8
    }

    /// Apex strain and contact angle whose shot meets the border.
    pub(super) fn aim(&self) -> Result<(f64, f64), AxisymmetricError> {
        let (string_strain, string_angle) = self.tight_string();
        let not_found = AxisymmetricError::NotFound { miss: f64::NAN };
        if self.is_full_contact() {
            let hoop = |strain: f64| self.shoot(strain, self.wall_angle, FINE, None).hoop;
            let strain = root_near(hoop, string_strain, 1e-14).ok_or(not_found)?;
            return Ok((strain, self.wall_angle));
        }
        let bracketed = |tolerance: f64, accuracy: f64| {
            self.bracket(string_strain, string_angle, tolerance, accuracy)
        };
        let (strain, angle) = bracketed(COARSE, 1e-3).ok_or_else(|| not_found.clone())?;
        match self.refine(strain, angle) {
            Some(answer) => Ok(answer),
            None => bracketed(FINE, 1e-13).ok_or(not_found),
        }
    }

    /// Both unknowns by bracketing: for each contact angle the apex strain that meets the border's
    /// radius, and of those the one that meets its height. A tight string's contact is too short:
    /// the free sheet hangs below it; contact to the wall is too long.
    fn bracket(
        &self,
        strain: f64,
        string_angle: f64,
        tolerance: f64,
        accuracy: f64,
    ) -> Option<(f64, f64)> {
        let height = |angle: f64, guess: f64| {
            let hoop = |strain: f64| self.shoot(strain, angle, tolerance, None).hoop;
            let strain = root_near(hoop, guess, accuracy)?;
            // A sheet that dives so steeply that it is lost on its way ends far too low.
            let height = self.shoot(strain, angle, tolerance, None).height;
            Some((if height.is_nan() { -self.pocket_radius } else { height }, strain))
        };
        let (mut low, mut high) = (string_angle, self.wall_angle);
        let (mut above, strain) = height(low, strain)?;
        let (mut below, strain) = height(high, strain)?;
        let mut best = (strain, high);
        // Regula falsi, Illinois, with bisection now and then.
        let mut last_side = 0;
        for k in 0..200 {
            if high - low <= accuracy * high {
                break;
            }
            let share = if k % 4 == 3 { 0.5 } else { above / (above - below) };
            let angle = low + (high - low) * share.clamp(0.001, 0.999);
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

    /// Newton's method on both unknowns from a near start; `None` if it does not converge.
    fn refine(&self, strain: f64, angle: f64) -> Option<(f64, f64)> {
        let miss = |strain: f64, angle: f64| {
            let shot = self.shoot(strain, angle, FINE, None);
            [shot.hoop, shot.height / self.pocket_radius]
        };
        let (mut strain, mut angle) = (strain, angle);
        for _ in 0..12 {
            let here = miss(strain, angle);
            let steps = [1e-5 * strain, -1e-5 * angle];
            let by_strain = miss(strain + steps[0], angle);
            let by_angle = miss(strain, angle + steps[1]);
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
            // Small strains have fewer digits.
            if relative < 1e-11 + 1e-15 / strain {
                return Some((strain, angle));
            }
        }
        None
    }

    /// A string pulled tight over the dome to the border: its strain, and θ where it leaves the dome.
    fn tight_string(&self) -> (f64, f64) {
        let border = [self.pocket_radius / self.base_radius, -self.base_height / self.projection];
        let distance = border[0].hypot(border[1]).max(1.0);
        let angle = border[0].atan2(border[1]) - (1.0 / distance).acos();
        let angle = angle.clamp(1e-6 * self.wall_angle, self.wall_angle);
        let parts = 64;
        let arc: f64 = (0..parts)
            .map(|k| self.meridian(angle * (f64::from(k) + 0.5) / f64::from(parts)).2)
            .sum::<f64>()
            * angle
            / f64::from(parts);
        let (sin, cos) = angle.sin_cos();
        let straight = (self.pocket_radius - self.base_radius * sin)
            .hypot(self.base_height + self.projection * cos);
        (((arc + straight) / self.pocket_radius - 1.0).max(1e-9), angle)
    }
}

/// The positive root of a function that rises through zero, to a relative accuracy, starting near a
/// guess: stepping out until it is bracketed, then regula falsi (Illinois) with bisection now and then.
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
        let share = if k % 4 == 3 { 0.5 } else { below / (below - above) };
        let at = low + (high - low) * share.clamp(1e-6, 1.0 - 1e-6);
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
