//! The meridian of a dome: r = R √(1 − cᵐ), z = z₀ + pc with c = cos θ; m = 2 is the ellipse r = R sin θ.

use implant_preview_core::contact::Dome;
use std::f64::consts::FRAC_PI_2;

#[derive(Clone, Copy, Debug)]
pub(super) struct Meridian {
    pub(super) base_radius: f64,
    pub(super) projection: f64,
    pub(super) base_height: f64,
    /// Exponent m of the heights \[-\]; volume / (πR²p) = m/(m + 1).
    exponent: f64,
}

/// A point of the meridian and the derivatives by θ \[mm\].
#[derive(Clone, Copy, Debug)]
pub(super) struct MeridianPoint {
    pub(super) r: f64,
    pub(super) z: f64,
    by_angle: [f64; 2],
}

impl MeridianPoint {
    /// cos φ and sin φ of the slope φ, and the derivative of the arc length by θ.
    pub(super) fn slope(&self) -> (f64, f64, f64) {
        let [along, down] = self.by_angle;
        let arc = along.hypot(down);
        (along / arc, down / arc, arc)
    }
}

impl Meridian {
    pub(super) fn new(dome: &Dome) -> Self {
        let fullness = dome.volume()
            / (std::f64::consts::PI * dome.reference_length().powi(2) * dome.projection());
        Self {
            base_radius: dome.reference_length(),
            projection: dome.projection(),
            base_height: dome.base_height,
            exponent: fullness / (1.0 - fullness),
        }
    }

    pub(super) fn at(&self, angle: f64) -> MeridianPoint {
        let (sin, cos) = angle.sin_cos();
        let (radius, p, m) = (self.base_radius, self.projection, self.exponent);
        // 1 − cᵐ without cancellation about the apex.
        let log = 0.5 * (-sin * sin).ln_1p();
        let share = (-(m * log).exp_m1()).max(0.0).sqrt();
        let along = 0.5 * m * cos.max(0.0).powf(m - 1.0) * sin / share;
        MeridianPoint {
            r: radius * share,
            z: self.base_height + p * cos,
            by_angle: [
                if share > 0.0 { radius * along } else { radius * (0.5 * m).sqrt() },
                p * sin,
            ],
        }
    }

    /// Curvature at the apex \[1/mm\].
    pub(super) fn apex_curvature(&self) -> f64 {
        2.0 * self.projection / (self.exponent * self.base_radius.powi(2))
    }

    /// θ at the intersection with the wall.
    pub(super) fn wall_angle(&self) -> f64 {
        (-self.base_height / self.projection).clamp(0.0, 1.0).acos().min(FRAC_PI_2)
    }

    /// θ at which the tangent passes through a place on the wall at a distance from the axis \[mm\].
    pub(super) fn tangent_through(&self, distance: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.wall_angle());
        for _ in 0..60 {
            let angle = 0.5 * (low + high);
            let MeridianPoint { r, z, by_angle: [along, down] } = self.at(angle);
            if down * (distance - r) < along * z { low = angle } else { high = angle }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use implant_preview_core::contact::HalfBall;

    #[test]
    fn slopes_are_derivatives_and_the_ellipse_is_one_of_the_family() {
        for fullness in [0.55, 2.0 / 3.0, 0.8] {
            let shape = HalfBall::round(60.0, 40.0).filled(fullness);
            let meridian = Meridian::new(&Dome::new(DVec2::ZERO, shape, 0.9));
            for k in 1..60 {
                let angle = 0.025 * f64::from(k);
                let [before, after] = [-1e-6, 1e-6].map(|step| meridian.at(angle + step));
                let at = meridian.at(angle);
                let slopes = [after.r - before.r, before.z - after.z].map(|d| d / 2e-6);
                for (slope, found) in slopes.into_iter().zip(at.by_angle) {
                    assert!((slope - found).abs() < 1e-6, "{slope} {found}");
                }
                if (fullness - 2.0 / 3.0).abs() < 1e-9 {
                    assert!((at.r - 60.0 * angle.sin()).abs() < 1e-12);
                }
            }
            // The circle of the apex's curvature.
            let near = meridian.at(1e-3);
            let sag = meridian.at(0.0).z - near.z;
            let circle = 0.5 * meridian.apex_curvature() * near.r.powi(2);
            assert!((sag / circle - 1.0).abs() < 1e-6);
            let touch = meridian.at(meridian.tangent_through(80.0));
            let (cos, sin, _) = touch.slope();
            assert!((touch.z * cos - (80.0 - touch.r) * sin).abs() < 1e-9);
        }
    }
}
